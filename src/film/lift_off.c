/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lift-off speed measured as a rotor coasts down (thesis section 6.6), against the model: the
 * clearance with which the model lifts off there. A wider bearing lifts off later. */
#include <math.h>

#include "film/bearing.h"

/* Shifts that are tried, over the reference clearance; a step's share of the last one. Steps are
 * short, so that it is one film that ends. */
static const double stride = 0.02, farthest = 0.6, stride_share = 0.2;
enum { HALVINGS = 10 };
/* Speeds and loads beside the measured ones, for the slopes: beyond the kinks where the thinnest
 * film passes from one place to another. */
static const double step_beside = 0.05;
static const double speed_stride = 1.06;

static fg_status carries_shifted(fg_context *ctx, const fg_film_report *r,
                                 fg_film_workspace *workspace, double shift, double rpm,
                                 bool *does) {
  fg_film_bearing shifted = r->bearing;
  fg_film_result result;
  for (size_t i = 0; i < shifted.count; i++)
    shifted.clearance_mm[i] += shift * r->clearance_um * 1e-3;
  FG_TRY(fg_film_keep_film(ctx, r, workspace, &shifted, rpm, &result));
  *does = result.outcome == FG_FILM_SOLVED;
  return FG_OK;
}

/* Shift of all clearances, over the reference, at which the film begins to touch at a speed; NaN
 * where none within reach does. */
static fg_status find_shift(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                            double rpm, double *shift) {
  bool carried, does;
  double at = 0, before;
  *shift = NAN;
  FG_TRY(carries_shifted(ctx, r, workspace, 0, rpm, &carried));
  double direction = carried ? 1 : -1;
  do {
    before = at;
    if (fabs(before) >= farthest) return FG_OK;
    at = direction * fmin(farthest, fabs(before) + fmax(stride, stride_share * fabs(before)));
    FG_TRY(carries_shifted(ctx, r, workspace, at, rpm, &does));
  } while (does == carried);
  for (int i = 0; i < HALVINGS; i++) {
    double middle = (before + at) / 2;
    FG_TRY(carries_shifted(ctx, r, workspace, middle, rpm, &does));
    *(does == carried ? &before : &at) = middle;
  }
  *shift = (before + at) / 2;
  return FG_OK;
}

/* Mean of the bearing's clearances and its u: own ones of every bump, and the shared ones. */
static double mean_clearance(const fg_film_report *r, double *u_um) {
  double sum = 0, own = 0, shared = 0, n = (double)r->bearing.count;
  for (size_t i = 0; i < r->bearing.count; i++) {
    sum += r->bearing.clearance_mm[i];
    own += r->u_own_mm[i] * r->u_own_mm[i];
    shared += r->u_shared_mm[i];
  }
  *u_um = 1e3 * hypot(sqrt(own), shared) / n;
  return 1e3 * sum / n;
}

/* Follows the bearing's film from its lift-off towards another speed, as far as it reaches. */
static fg_status follow_speed(fg_context *ctx, const fg_film_report *r,
                              fg_film_workspace *workspace, double rpm) {
  fg_film_result result = {.outcome = FG_FILM_SOLVED};
  double at = r->lift_off_rpm;
  while (at != rpm && isfinite(at) && result.outcome == FG_FILM_SOLVED) {
    at = fmax(at / speed_stride, fmin(at * speed_stride, rpm));
    FG_TRY(fg_film_keep_film(ctx, r, workspace, &r->bearing, at, &result));
  }
  return FG_OK;
}

/* Slopes of the shift by the speed and by the load, each over its relative change. */
static fg_status find_slopes(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                             const fg_film_mark *there, double rpm, double slopes[2]) {
  for (int by_load = 0; by_load < 2; by_load++) {
    double beside[2];
    for (int k = 0; k < 2; k++) {
      fg_film_report changed = *r;
      double factor = 1 + (k ? step_beside : -step_beside);
      fg_film_mark_return(there, workspace);
      if (by_load) changed.options.load_n *= factor;
      FG_TRY(find_shift(ctx, &changed, workspace, by_load ? rpm : factor * rpm, &beside[k]));
    }
    slopes[by_load] = (beside[1] - beside[0]) * r->clearance_um / (2 * step_beside);
  }
  return FG_OK;
}

static fg_status find_shifts(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                             double rpm, double *shift, double slopes[2]) {
  fg_film_mark there;
  FG_TRY(follow_speed(ctx, r, workspace, rpm));
  FG_TRY(fg_film_mark_open(ctx, workspace, &there));
  fg_status status = find_shift(ctx, r, workspace, rpm, shift);
  if (status == FG_OK) status = find_slopes(ctx, r, workspace, &there, rpm, slopes);
  fg_film_mark_close(&there);
  return status;
}

static fg_status compare_lift_off(fg_context *ctx, const fg_film_report *r,
                                  fg_film_workspace *workspace, fg_film_lift_off *found) {
  double shift, slopes[2], u_load = r->options.lift_off.u_load_n / r->options.load_n;
  FG_TRY(find_shifts(ctx, r, workspace, found->rpm, &shift, slopes));
  found->shift_um = shift * r->clearance_um;
  found->u_by_load_um = u_load > 0 ? fabs(slopes[1]) * u_load : 0;
  found->u_shift_um = hypot(fabs(slopes[0]) * found->u_rpm / found->rpm, found->u_by_load_um);
  found->clearance_um = mean_clearance(r, &found->u_bearing_um) + found->shift_um;
  found->predicted_rpm = r->lift_off_rpm;
  double u_predicted_um = hypot(found->u_bearing_um, found->u_by_load_um);
  found->u_predicted_rpm =
      found->u_bearing_um > 0 ? u_predicted_um * found->rpm / fabs(slopes[0]) : NAN;
  found->agrees = fabs(found->shift_um) <= 2 * hypot(found->u_shift_um, found->u_bearing_um);
  return FG_OK;
}

fg_status fg_film_hold_lift_off(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  if (isnan(r->options.lift_off.rpm)) return FG_OK;
  r->lift_off = (fg_film_lift_off){
      .asked = true, .rpm = r->options.lift_off.rpm, .u_rpm = r->options.lift_off.u_rpm};
  return compare_lift_off(ctx, r, workspace, &r->lift_off);
}
