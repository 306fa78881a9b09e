/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The critical mass over the shape of the bumps: a change of all of them alike, by one percent, and
 * a scatter of them, one percent from bump to bump. */
#include <math.h>

#include "film/bearing.h"
#include "foilgauge/stiffness.h"

const char *const fg_film_parameter_words[] = {[FG_FILM_RADIUS] = "bump radius",
                                               [FG_FILM_ANGLE] = "bump angle",
                                               [FG_FILM_RADIUS_AT_ARC] =
                                                   "radius at constant arc length",
                                               [FG_FILM_THICKNESS] = "thickness",
                                               NULL};

static const double step_pct = 0.1;

/* Changes a design by a share: powers of radius, angle, thickness. */
static void change_design(fg_film_parameter parameter, double share, fg_design *design) {
  static const double power[FG_FILM_PARAMETERS][3] = {[FG_FILM_RADIUS] = {1, 0, 0},
                                                      [FG_FILM_ANGLE] = {0, 1, 0},
                                                      [FG_FILM_RADIUS_AT_ARC] = {1, -1, 0},
                                                      [FG_FILM_THICKNESS] = {0, 0, 1}};
  design->bumps.radius_mm *= pow(1 + share, power[parameter][0]);
  design->bumps.angle_deg *= pow(1 + share, power[parameter][1]);
  design->thickness_mm *= pow(1 + share, power[parameter][2]);
}

/* Clearance and logarithm of a bump's stiffness of the changed design. */
static fg_status derive_changed(fg_context *ctx, const fg_film_report *r,
                                fg_film_parameter parameter, double share, double *clearance_mm,
                                double *stiffness) {
  fg_design design = r->design;
  fg_nominal nominal;
  double n_mm2;
  change_design(parameter, share, &design);
  FG_TRY(fg_design_derive(ctx, &design, &nominal));
  const fg_arch arch =
      fg_design_arch(&design, design.thickness_mm, design.bumps.radius_mm, design.bumps.angle_deg);
  const fg_stiffness_model *model = fg_film_stiffness_model(r->options.model);
  FG_TRY(model->stiffness(ctx, &arch, &r->options.material, &n_mm2));
  *clearance_mm = nominal.clearance_mm;
  *stiffness = log(n_mm2);
  return FG_OK;
}

static fg_status find_slopes(fg_context *ctx, const fg_film_report *r,
                             fg_film_sensitivity *sensitivity) {
  double clearance[2], stiffness[2];
  for (int side = 0; side < 2; side++)
    FG_TRY(derive_changed(ctx, r, sensitivity->parameter, (side ? 1 : -1) * step_pct / 100,
                          &clearance[side], &stiffness[side]));
  sensitivity->clearance_um_per_pct = (clearance[1] - clearance[0]) / (2 * step_pct) * 1e3;
  sensitivity->stiffness_pct_per_pct = (stiffness[1] - stiffness[0]) / (2 * step_pct) * 100;
  return FG_OK;
}

/* Critical mass of bumps that all differ by `pct` percent; NaN where it has no film. */
static fg_status solve_changed(fg_context *ctx, const fg_film_report *r,
                               const fg_film_bearing *perfect, fg_film_workspace *workspace,
                               const fg_film_sensitivity *s, double pct, double *mass_kg) {
  fg_film_bearing changed = *perfect;
  fg_film_result result;
  for (size_t i = 0; i < changed.count; i++)
    fg_film_change_bump(s, pct, i, &changed);
  FG_TRY(fg_film_solve_bearing(ctx, r, workspace, &changed, r->options.speed_rpm, FG_FILM_ONWARD,
                               &result));
  *mass_kg = result.critical_mass_kg;
  return FG_OK;
}

void fg_film_change_bump(const fg_film_sensitivity *s, double pct, size_t bump,
                         fg_film_bearing *bearing) {
  bearing->clearance_mm[bump] += pct * s->clearance_um_per_pct * 1e-3;
  bearing->stiffness_n_mm2[bump] *= exp(pct / 100 * s->stiffness_pct_per_pct);
}

static fg_status find_changes(fg_context *ctx, const fg_film_report *r,
                              const fg_film_bearing *perfect, fg_film_workspace *workspace,
                              const fg_film_mark *solved, fg_film_sensitivity *s) {
  double mass[2];
  FG_TRY(find_slopes(ctx, r, s));
  for (int side = 0; side < 2; side++) {
    fg_film_mark_return(solved, workspace);
    FG_TRY(solve_changed(ctx, r, perfect, workspace, s, side ? step_pct : -step_pct, &mass[side]));
  }
  s->mass_pct_per_pct = 100 * log(mass[1] / mass[0]) / (2 * step_pct);
  fg_film_mark_return(solved, workspace);
  return FG_OK;
}

fg_status fg_film_find_sensitivities(fg_context *ctx, fg_film_report *r,
                                     const fg_film_bearing *perfect, fg_film_workspace *workspace) {
  fg_film_mark solved;
  if (!r->options.sensitivity) return FG_OK;
  FG_TRY(fg_film_mark_open(ctx, workspace, &solved));
  fg_status status = FG_OK;
  for (int i = 0; i < FG_FILM_PARAMETERS && status == FG_OK; i++) {
    r->sensitivity[i].parameter = (fg_film_parameter)i;
    status = find_changes(ctx, r, perfect, workspace, &solved, &r->sensitivity[i]);
    if (status == FG_OK)
      status = fg_film_draw_scatter(ctx, r, perfect, workspace, &r->sensitivity[i]);
  }
  fg_film_mark_close(&solved);
  r->sensitivities = FG_FILM_PARAMETERS;
  return status;
}
