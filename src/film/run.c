/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `foilgauge film`: the perfect bearing, the one as measured, its field, coefficients and map. */
#include <math.h>
#include <stdlib.h>

#include "film/bearing.h"
#include "foilgauge/memory.h"

static const double deg_per_rad = 180 / 3.14159265358979323846;

/* Ratios of whirl of the coefficients: a fifth to five times the speed, 1 in their middle. */
static const double ratio_span = 5;

static void put_coefficients(const fg_film_report *r, double ratio, double complex z[2][2],
                             fg_film_coefficients *at) {
  double speed = fg_film_speed_rad_s(r->options.speed_rpm);
  double unit_n_um = fg_film_load_unit_n(r) / r->clearance_um;
  at->whirl_ratio = ratio;
  at->frequency_hz = ratio * r->options.speed_rpm / 60;
  for (int k = 0; k < 4; k++) {
    at->stiffness_n_um[k] = creal(z[k / 2][k % 2]) * unit_n_um;
    at->damping_n_s_mm[k] = cimag(z[k / 2][k % 2]) * unit_n_um / (ratio * speed) * 1e3;
  }
}

static fg_status find_coefficients(fg_context *ctx, fg_film_report *r,
                                   fg_film_workspace *workspace) {
  fg_film_assemble(ctx, &workspace->film, &workspace->at, &workspace->state);
  for (int i = 0; i < FG_FILM_FREQUENCIES; i++) {
    double share = 2. * i / (FG_FILM_FREQUENCIES - 1) - 1, ratio = pow(ratio_span, share);
    double complex z[2][2];
    FG_TRY(fg_film_impedance(ctx, &workspace->film, &workspace->at, I * ratio, z));
    put_coefficients(r, ratio, z, &r->coefficients[i]);
  }
  r->coefficient_count = FG_FILM_FREQUENCIES;
  return FG_OK;
}

static fg_status keep_field(fg_context *ctx, fg_film_report *r,
                            const fg_film_workspace *workspace) {
  const fg_film *film = &workspace->film;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, film->columns, sizeof *r->column, &block));
  r->column = block;
  r->columns = film->columns;
  r->nodes = film->nodes;
  FG_TRY(fg_memory_allocate(ctx, film->columns * film->nodes, sizeof(double), &block));
  r->pressure_kpa = block;
  for (size_t i = 0; i < film->columns; i++) {
    double *pressure = r->pressure_kpa + i * film->nodes;
    r->column[i] = (fg_film_column){
        .pad = film->mesh.ring ? 1 : 1 + i / (film->mesh.cells + 1),
        .angle_deg = fg_film_angle_rad(&film->mesh, i) * deg_per_rad,
        .clearance_um = workspace->at.clearance[i] * r->clearance_um,
        .film_um = fg_film_thickness(film, &workspace->at, &workspace->state, i) * r->clearance_um,
        .deflection_um = workspace->state.deflection[i] * r->clearance_um,
        .pressure_kpa = pressure};
    for (size_t j = 0; j < film->nodes; j++)
      pressure[j] = workspace->state.pressure[i * film->nodes + j] * r->options.ambient_kpa;
  }
  return FG_OK;
}

/* Returns true for a film that the rotor is stable on, where it is not on the other one, or else
 * for the thicker one. */
static bool is_better(const fg_film_report *r, const fg_film_result *film,
                      const fg_film_result *other) {
  double mass_kg = r->options.rotor_mass_kg;
  bool stable = fg_film_is_stable(film, mass_kg), other_is = fg_film_is_stable(other, mass_kg);
  return stable != other_is ? stable : film->min_film_um > other->min_film_um;
}

/* Seeks another film at the same load and speed, with the rotor at another place, and takes the
 * better one of both. */
static fg_status choose_film(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace,
                             const fg_film_bearing *bearing, fg_film_result *at) {
  fg_film_mark first;
  fg_film_result other, own = *at;
  r->has_other_film = false;
  if (at->outcome != FG_FILM_SOLVED) return FG_OK;
  FG_TRY(fg_film_mark_open(ctx, workspace, &first));
  fg_status status = fg_film_seek_beside(ctx, r, workspace, bearing, first.state.place, &other,
                                         &r->has_other_film);
  bool changes = r->has_other_film && is_better(r, &other, at);
  if (r->has_other_film) *(changes ? at : &r->other_film) = other;
  if (changes) r->other_film = own;
  if (!changes) fg_film_mark_return(&first, workspace);
  fg_film_mark_close(&first);
  return status;
}

static fg_status solve_perfect(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace,
                               const fg_film_bearing *perfect) {
  FG_TRY(fg_film_seek_film(ctx, r, workspace, perfect, r->options.speed_rpm, &r->perfect));
  if (r->perfect.outcome == FG_FILM_UNSOLVED)
    return fg_fail(ctx, FG_ERR_NUMERIC,
                   "the design's bearing has no film at %g N and %g rpm: lower the load, raise the "
                   "speed, or state another clearance or compliance",
                   r->options.load_n, r->options.speed_rpm);
  FG_TRY(choose_film(ctx, r, workspace, perfect, &r->perfect));
  r->perfect.mass_over_perfect = 1;
  fg_film_modes unused;
  return fg_film_find_modes(ctx, r, workspace, &r->perfect, &unused);
}

/* The rotor's whirls on the bearing, to which the workspace's state belongs. */
static fg_status find_modes(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  fg_film_modes modes;
  FG_TRY(fg_film_find_modes(ctx, r, workspace, &r->actual, &modes));
  r->modes = modes.count;
  for (size_t i = 0; i < modes.count; i++)
    r->mode[i] = modes.mode[i];
  return FG_OK;
}

bool fg_film_is_measured(const fg_film_options *options) {
  return options->bore || (options->foils && !fg_film_draws_from_lot(options));
}

/* From the lowest speed on, where the search for it ends, a measured lift-off is compared. */
static fg_status find_limits(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  workspace->steady_only = true;
  fg_status status = fg_film_find_capacity(ctx, r, workspace);
  if (status == FG_OK) status = fg_film_hold_lift_off(ctx, r, workspace);
  workspace->steady_only = false;
  return status;
}

/* Studies of the bearing, to which the workspace's state belongs: each goes on from there. */
static fg_status run_studies(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  typedef fg_status study(fg_context *, fg_film_report *, fg_film_workspace *);
  static study *const studies[] = {fg_film_follow_orbit, fg_film_map_speeds, find_limits};
  fg_status status = FG_OK;
  fg_film_mark solved;
  FG_TRY(fg_film_mark_open(ctx, workspace, &solved));
  for (size_t i = 0; i < sizeof studies / sizeof *studies && status == FG_OK; i++) {
    fg_film_mark_return(&solved, workspace);
    status = studies[i](ctx, r, workspace);
  }
  fg_film_mark_close(&solved);
  return status;
}

static fg_status run_bearings(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  fg_film_bearing perfect = r->bearing;
  FG_TRY(solve_perfect(ctx, r, workspace, &perfect));
  FG_TRY(fg_film_read_bore(ctx, r));
  FG_TRY(fg_film_find_sensitivities(ctx, r, &perfect, workspace));
  FG_TRY(fg_film_find_tolerance(ctx, r, &perfect, workspace));
  FG_TRY(fg_film_draw(ctx, r, &perfect, workspace));
  r->actual = r->perfect;
  if (fg_film_is_measured(&r->options)) {
    if (r->options.foils && !fg_film_draws_from_lot(&r->options))
      FG_TRY(fg_film_read_foils(ctx, r, &r->bearing));
    fg_film_add_bore(r, &r->bearing);
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, &r->bearing, r->options.speed_rpm,
                                 FG_FILM_ONWARD, &r->actual));
    FG_TRY(choose_film(ctx, r, workspace, &r->bearing, &r->actual));
    r->actual.mass_over_perfect = fg_film_mass_over(r, r->actual.critical_mass_kg);
    if (r->actual.outcome != FG_FILM_UNSOLVED) FG_TRY(fg_film_find_uncertainty(ctx, r, workspace));
  }
  if (r->actual.outcome == FG_FILM_UNSOLVED) return FG_OK;
  FG_TRY(find_modes(ctx, r, workspace));
  FG_TRY(find_coefficients(ctx, r, workspace));
  FG_TRY(keep_field(ctx, r, workspace));
  return run_studies(ctx, r, workspace);
}

fg_status fg_film_run(fg_context *ctx, const fg_design *design, const fg_film_options *options,
                      fg_film_report *report) {
  fg_film_workspace workspace;
  *report = (fg_film_report){.design = *design,
                             .options = *options,
                             .threshold_rpm = NAN,
                             .threshold_eigen_rpm = NAN,
                             .load_capacity_n = NAN,
                             .lift_off_rpm = NAN,
                             .film_ends_n = NAN,
                             .film_ends_rpm = NAN};
  FG_TRY(fg_film_describe(ctx, report, &report->bearing));
  FG_TRY(fg_film_workspace_open(ctx, report, &workspace));
  fg_status status = run_bearings(ctx, report, &workspace);
  fg_film_workspace_close(&workspace);
  return status;
}

void fg_film_report_free(fg_film_report *report) {
  free(report->by_speed);
  free(report->column);
  free(report->pressure_kpa);
  free(report->draws.result);
  free(report->orbit.point);
  *report = (fg_film_report){.speed_count = 0};
}

int fg_film_exit_code(const fg_film_report *report) {
  return report->actual.outcome == FG_FILM_UNSOLVED ? 2 : 0;
}
