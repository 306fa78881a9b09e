/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lift-off speed measured as a rotor coasts down (thesis section 6.6), against the model: the
 * clearance with which the model lifts off there. A wider bearing lifts off later. */
#include <math.h>

#include "film/bearing.h"

/* Shifts that are tried, over the reference clearance. */
static const double stride = 0.02, farthest = 0.6;
enum { HALVINGS = 10 };
/* Speeds beside the measured one, for the slope. */
static const double speed_step = 0.02;

static fg_status carries_shifted(fg_context *ctx, const fg_film_report *r,
                                 fg_film_workspace *workspace, double shift, double rpm,
                                 bool *does) {
  fg_film_bearing shifted = r->bearing;
  fg_film_result result;
  for (size_t i = 0; i < shifted.count; i++)
    shifted.clearance_mm[i] += shift * r->clearance_um * 1e-3;
  FG_TRY(fg_film_seek_onward(ctx, r, workspace, &shifted, rpm, &result));
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
    at = direction * fmin(farthest, fmax(stride, 2 * fabs(before)));
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

static fg_status compare_lift_off(fg_context *ctx, const fg_film_report *r,
                                  fg_film_workspace *workspace, fg_film_lift_off *found) {
  double shift, beside[2];
  FG_TRY(find_shift(ctx, r, workspace, found->rpm, &shift));
  for (int k = 0; k < 2; k++)
    FG_TRY(find_shift(ctx, r, workspace, found->rpm * (1 + (k ? speed_step : -speed_step)),
                      &beside[k]));
  double um_per_rpm = (beside[1] - beside[0]) * r->clearance_um / (2 * speed_step * found->rpm);
  found->shift_um = shift * r->clearance_um;
  found->u_shift_um = fabs(um_per_rpm) * found->u_rpm;
  found->clearance_um = mean_clearance(r, &found->u_bearing_um) + found->shift_um;
  found->predicted_rpm = r->lift_off_rpm;
  found->u_predicted_rpm = found->u_bearing_um > 0 ? found->u_bearing_um / fabs(um_per_rpm) : NAN;
  found->agrees = fabs(found->shift_um) <= 2 * hypot(found->u_shift_um, found->u_bearing_um);
  return FG_OK;
}

fg_status fg_film_hold_lift_off(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  if (isnan(r->options.lift_off_rpm)) return FG_OK;
  r->lift_off = (fg_film_lift_off){
      .asked = true, .rpm = r->options.lift_off_rpm, .u_rpm = r->options.u_lift_off_rpm};
  return compare_lift_off(ctx, r, workspace, &r->lift_off);
}
