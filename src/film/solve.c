/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing at one speed: from its case to its numbers. */
#include <math.h>
#include <string.h>

#include "film/bearing.h"

static const double deg_per_rad = 180 / 3.14159265358979323846;

fg_status fg_film_workspace_open(fg_context *ctx, const fg_film_report *report,
                                 fg_film_workspace *workspace) {
  const fg_film_mesh mesh = fg_film_mesh_of(report);
  *workspace = (fg_film_workspace){.film = {.columns = 0}};
  fg_status status = fg_film_open(ctx, &mesh, report->options.top_foil == FG_FILM_TOP_FOIL_SAGGING,
                                  &workspace->film);
  if (status == FG_OK) status = fg_film_case_open(ctx, workspace->film.columns, &workspace->at);
  if (status == FG_OK) status = fg_film_case_open(ctx, workspace->film.columns, &workspace->before);
  if (status == FG_OK)
    status = fg_film_case_open(ctx, workspace->film.columns, &workspace->spare_before);
  if (status == FG_OK) status = fg_film_state_open(ctx, &workspace->film, &workspace->state);
  if (status == FG_OK) status = fg_film_state_open(ctx, &workspace->film, &workspace->spare);
  if (status != FG_OK) fg_film_workspace_close(workspace);
  return status;
}

void fg_film_workspace_close(fg_film_workspace *workspace) {
  fg_film_case_close(&workspace->at);
  fg_film_case_close(&workspace->before);
  fg_film_case_close(&workspace->spare_before);
  fg_film_state_close(&workspace->state);
  fg_film_state_close(&workspace->spare);
  fg_film_close(&workspace->film);
}

static void find_extremes(const fg_film_report *r, const fg_film_workspace *workspace,
                          fg_film_result *result) {
  double thinnest = INFINITY, highest = 0;
  size_t at = 0;
  for (size_t i = 0; i < workspace->film.columns; i++) {
    double thickness = fg_film_thickness(&workspace->film, &workspace->at, &workspace->state, i);
    if (thickness < thinnest) thinnest = thickness, at = i;
    for (size_t j = 0; j < workspace->film.nodes; j++)
      highest = fmax(highest, workspace->state.pressure[i * workspace->film.nodes + j]);
  }
  result->min_film_um = thinnest * r->clearance_um;
  result->min_film_deg =
      remainder(fg_film_angle_rad(&workspace->film.mesh, at) * deg_per_rad - 180, 360) + 180;
  result->max_pressure_kpa = highest * r->options.ambient_kpa;
}

/* Torque of the film times the speed, of a torque over mu omega R⁴ / C. */
static double find_power(const fg_film_report *r, const fg_film_workspace *workspace,
                         double speed_rpm) {
  double speed = fg_film_speed_rad_s(speed_rpm), radius = r->diameter_mm * 1e-3 / 2;
  double unit =
      r->options.viscosity_upa_s * 1e-6 * speed * pow(radius, 4) / (r->clearance_um * 1e-6);
  return unit * speed * fg_film_torque(&workspace->film, &workspace->at, &workspace->state);
}

/* The critical mass; where it is not asked, whether there is one. */
static fg_status find_threshold(fg_context *ctx, fg_film_workspace *workspace,
                                fg_film_threshold *threshold) {
  bool falls;
  if (!workspace->steady_only)
    return fg_film_find_threshold(ctx, &workspace->film, &workspace->at, &workspace->state,
                                  threshold);
  FG_TRY(fg_film_find_fall(ctx, &workspace->film, &workspace->at, &workspace->state, &falls));
  *threshold = (fg_film_threshold){falls ? 0 : NAN, falls ? INFINITY : NAN, falls ? 0 : NAN};
  return FG_OK;
}

static fg_status fill_result(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                             fg_film_result *result) {
  const double *place = workspace->state.place;
  fg_film_threshold threshold;
  for (int k = 0; k < 2; k++)
    result->place_um[k] = place[k] * r->clearance_um;
  result->eccentricity = hypot(place[0], place[1]);
  result->attitude_deg =
      remainder(atan2(place[1], place[0]) * deg_per_rad - r->options.load_deg, 360);
  find_extremes(r, workspace, result);
  result->power_w = find_power(r, workspace, result->speed_rpm);
  result->outcome =
      result->min_film_um < r->options.touching_um ? FG_FILM_TOUCHING : FG_FILM_SOLVED;
  FG_TRY(find_threshold(ctx, workspace, &threshold));
  double unit_kg = fg_film_mass_unit_kg(r, result->speed_rpm);
  result->critical_mass_kg = threshold.mass * unit_kg;
  result->stable_again_kg = threshold.stable_again * unit_kg;
  result->whirl_ratio = threshold.ratio;
  return FG_OK;
}

fg_status fg_film_solve_bearing(fg_context *ctx, const fg_film_report *report,
                                fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                double speed_rpm, fg_film_start start, fg_film_result *result) {
  *result = (fg_film_result){.outcome = FG_FILM_UNSOLVED,
                             .speed_rpm = speed_rpm,
                             .place_um = {NAN, NAN},
                             .eccentricity = NAN,
                             .attitude_deg = NAN,
                             .min_film_um = NAN,
                             .min_film_deg = NAN,
                             .max_pressure_kpa = NAN,
                             .power_w = NAN,
                             .critical_mass_kg = NAN,
                             .stable_again_kg = NAN,
                             .whirl_ratio = NAN,
                             .log_decrement = NAN,
                             .mass_over_perfect = NAN};
  fg_film_case_fill(report, &workspace->film, bearing, speed_rpm, &workspace->at);
  result->compressibility = workspace->at.lambda;
  fg_status status = start == FG_FILM_AFRESH
                         ? fg_film_solve(ctx, &workspace->film, &workspace->at, &workspace->state)
                         : fg_film_follow(ctx, &workspace->film, &workspace->before, &workspace->at,
                                          &workspace->state);
  if (status == FG_ERR_NUMERIC) return FG_OK;
  FG_TRY(status);
  fg_film_case_copy(&workspace->at, workspace->film.columns, &workspace->before);
  return fill_result(ctx, report, workspace, result);
}

fg_status fg_film_mark_open(fg_context *ctx, const fg_film_workspace *workspace,
                            fg_film_mark *mark) {
  *mark = (fg_film_mark){0};
  FG_TRY(fg_film_state_open(ctx, &workspace->film, &mark->state));
  fg_status status = fg_film_case_open(ctx, workspace->film.columns, &mark->before);
  if (status != FG_OK) {
    fg_film_state_close(&mark->state);
    return status;
  }
  fg_film_state_copy(&workspace->film, &workspace->state, &mark->state);
  fg_film_case_copy(&workspace->before, workspace->film.columns, &mark->before);
  return FG_OK;
}

void fg_film_mark_return(const fg_film_mark *mark, fg_film_workspace *workspace) {
  fg_film_state_copy(&workspace->film, &mark->state, &workspace->state);
  fg_film_case_copy(&mark->before, workspace->film.columns, &workspace->before);
  fg_film_case_copy(&mark->before, workspace->film.columns, &workspace->at);
}

void fg_film_mark_close(fg_film_mark *mark) {
  fg_film_state_close(&mark->state);
  fg_film_case_close(&mark->before);
}

fg_status fg_film_change_film(fg_context *ctx, const fg_film_report *r,
                              fg_film_workspace *workspace, const fg_film_bearing *bearing,
                              double speed_rpm, fg_film_result *result) {
  return fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_ONWARD, result);
}

/* Max move of the rotor across its direction, over C, that a short step of one film makes. */
static const double across_max = 0.15;

static bool has_jumped(const fg_film_workspace *workspace) {
  const double *from = workspace->spare.place, *to = workspace->state.place;
  double across = fabs(from[0] * to[1] - from[1] * to[0]);
  return across > across_max * fmax(hypot(from[0], from[1]), across_max);
}

fg_status fg_film_keep_film(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                            const fg_film_bearing *bearing, double speed_rpm,
                            fg_film_result *result) {
  size_t columns = workspace->film.columns;
  fg_film_state_copy(&workspace->film, &workspace->state, &workspace->spare);
  fg_film_case_copy(&workspace->before, columns, &workspace->spare_before);
  FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_ONWARD, result));
  if (result->outcome == FG_FILM_SOLVED && (has_jumped(workspace) || fg_film_falls_off(result)))
    result->outcome = FG_FILM_UNSOLVED;
  if (result->outcome == FG_FILM_SOLVED) return FG_OK;
  fg_film_state_copy(&workspace->film, &workspace->spare, &workspace->state);
  fg_film_case_copy(&workspace->spare_before, columns, &workspace->before);
  return FG_OK;
}
