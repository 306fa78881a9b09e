/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a design and its options to the numbers of a bearing, and to a case without dimensions. */
#include "film/bearing.h"

#include <math.h>
#include <string.h>

#include "foilgauge/stiffness.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;
static const double gravity_m_s2 = 9.80665;

const char *const fg_film_outcome_words[] = {[FG_FILM_SOLVED] = "solved",
                                             [FG_FILM_TOUCHING] = "touching",
                                             [FG_FILM_UNSOLVED] = "unsolved",
                                             NULL};

fg_film_options fg_film_options_default(void) {
  return (fg_film_options){.load_n = NAN,
                           .load_deg = 270,
                           .speed_rpm = NAN,
                           .rotor_mass_kg = NAN,
                           .length_mm = NAN,
                           .clearance_um = NAN,
                           .compliance = NAN,
                           .material = fg_arch_material_default(),
                           .loss_factor = 0.14,
                           .viscosity_upa_s = 18.5,
                           .ambient_kpa = 101.325,
                           .pads = 3,
                           .first_bump = 1,
                           .top_foil_mm = NAN,
                           .cells_per_bump = 6,
                           .cells_axial = 8,
                           .touching_um = 1,
                           .within_pct = NAN,
                           .lift_off = {.rpm = NAN},
                           .map = {.low_rpm = NAN, .high_rpm = NAN, .speeds = 25},
                           .draw = {.shim_low_pct = NAN, .shim_high_pct = NAN},
                           .seed = 1};
}

double fg_film_speed_rad_s(double speed_rpm) {
  return speed_rpm * 360 * rad_per_deg / 60;
}

double fg_film_load_unit_n(const fg_film_report *report) {
  double radius_mm = report->diameter_mm / 2;
  return report->options.ambient_kpa * 1e-3 * radius_mm * radius_mm;
}

double fg_film_mass_unit_kg(const fg_film_report *report, double speed_rpm) {
  double speed = fg_film_speed_rad_s(speed_rpm);
  return fg_film_load_unit_n(report) / (report->clearance_um * 1e-6 * speed * speed);
}

const fg_stiffness_model *fg_film_stiffness_model(const char *id) {
  const fg_stiffness_model *models = fg_stiffness_models();
  if (!id) return models;
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++)
    if (!strcmp(models[i].id, id)) return &models[i];
  return NULL;
}

/* Stiffness per width of a bump of the design; of a stated compliance, that which it follows from:
 * K = p_a s / (C alpha). */
static fg_status find_stiffness(fg_context *ctx, fg_film_report *r) {
  const fg_film_options *o = &r->options;
  double pitch_mm = o->pitch_deg * rad_per_deg * r->design.bumps.sleeve_radius_mm;
  double scale = o->ambient_kpa * pitch_mm / r->clearance_um;
  if (isfinite(o->compliance)) {
    r->compliance = o->compliance;
    r->stiffness_n_mm2 = scale / o->compliance; /* infinite: a rigid bearing */
    return FG_OK;
  }
  const fg_stiffness_model *model = fg_film_stiffness_model(o->model);
  if (!model)
    return fg_fail(
        ctx, FG_ERR_USAGE,
        "no model of a bump's stiffness is called '%s'; `foilgauge film --help` lists them",
        o->model);
  const fg_design_bumps *bumps = &r->design.bumps;
  const fg_arch arch =
      fg_design_arch(&r->design, r->design.thickness_mm, bumps->radius_mm, bumps->angle_deg);
  FG_TRY(model->stiffness(ctx, &arch, &o->material, &r->stiffness_n_mm2));
  r->compliance = scale / r->stiffness_n_mm2;
  return FG_OK;
}

static fg_status complete_options(fg_context *ctx, fg_film_report *r) {
  fg_film_options *o = &r->options;
  const fg_design_bumps *bumps = &r->design.bumps;
  if (!o->bumps_per_pad) o->bumps_per_pad = bumps->count ? bumps->count : 7;
  size_t pads = o->pads ? o->pads : 1;
  if (o->bumps_per_pad > FG_BEARING_BUMPS_MAX / pads)
    return fg_fail(ctx, FG_ERR_USAGE, "%zu pads of %zu bumps: a bearing has at most %d", pads,
                   o->bumps_per_pad, FG_BEARING_BUMPS_MAX);
  double room = 360 / (double)(pads * o->bumps_per_pad);
  if (!(o->pitch_deg > 0) || !o->pads) o->pitch_deg = room;
  if (o->pitch_deg > room * (1 + 1e-9))
    return fg_fail(ctx, FG_ERR_USAGE, "%zu pads of %zu bumps do not fit at a pitch of %g degrees",
                   pads, o->bumps_per_pad, o->pitch_deg);
  if (!isfinite(o->rotor_mass_kg)) o->rotor_mass_kg = o->load_n / gravity_m_s2;
  if (!isfinite(o->top_foil_mm)) o->top_foil_mm = bumps->top_foil_thickness_mm;
  if (o->top_foil == FG_FILM_TOP_FOIL_SAGGING && !(o->top_foil_mm > 0))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "a top foil that sags needs its thickness: the design states none");
  if (o->top_foil == FG_FILM_TOP_FOIL_SAGGING && o->compliance == 0)
    return fg_fail(ctx, FG_ERR_USAGE, "a top foil does not sag on rigid bumps: compliance 0");
  if (!isfinite(o->map.low_rpm)) o->map.low_rpm = o->speed_rpm / 4;
  if (!isfinite(o->map.high_rpm)) o->map.high_rpm = o->speed_rpm * 4;
  return FG_OK;
}

static void fill_perfect(const fg_film_report *r, fg_film_bearing *perfect) {
  const fg_film_options *o = &r->options;
  const fg_bearing_layout layout = {.pads = o->pads ? o->pads : 1,
                                    .bumps_per_pad = o->bumps_per_pad,
                                    .first_bump = o->first_bump,
                                    .pitch_deg = o->pitch_deg};
  *perfect = (fg_film_bearing){.count = layout.pads * layout.bumps_per_pad};
  for (size_t i = 0; i < perfect->count; i++) {
    perfect->angle_deg[i] =
        fg_bearing_angle_deg(&layout, i / layout.bumps_per_pad, i % layout.bumps_per_pad);
    perfect->clearance_mm[i] = r->clearance_um * 1e-3;
    perfect->stiffness_n_mm2[i] = r->stiffness_n_mm2;
  }
}

fg_status fg_film_describe(fg_context *ctx, fg_film_report *r, fg_film_bearing *perfect) {
  fg_nominal nominal;
  FG_TRY(fg_design_derive(ctx, &r->design, &nominal));
  if (isnan(nominal.height_mm))
    return fg_fail(ctx, FG_ERR_DATA, "%s: a film needs a design with bumps", r->design.name);
  FG_TRY(complete_options(ctx, r));
  r->diameter_mm = r->design.bumps.rotor_diameter_mm;
  r->length_mm = isfinite(r->options.length_mm) ? r->options.length_mm : r->diameter_mm;
  r->clearance_um =
      isfinite(r->options.clearance_um) ? r->options.clearance_um : nominal.clearance_mm * 1e3;
  if (!(r->clearance_um > 0))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: its clearance is %g um; state one above 0 (--clearance), to which the film "
                   "is referred",
                   r->design.name, r->clearance_um);
  FG_TRY(find_stiffness(ctx, r));
  fill_perfect(r, perfect);
  return FG_OK;
}

fg_film_mesh fg_film_mesh_of(const fg_film_report *r) {
  const fg_film_options *o = &r->options;
  double pitch = o->pitch_deg * rad_per_deg;
  return (fg_film_mesh){.pads = o->pads ? o->pads : 1,
                        .cells = o->bumps_per_pad * o->cells_per_bump,
                        .axial = o->cells_axial,
                        .ring = o->pads == 0,
                        .start_rad = -pitch / 2,
                        .arc_rad = pitch * (double)o->bumps_per_pad,
                        .half_length = r->length_mm / r->diameter_mm};
}

/* Two bumps of a pad beside a column, and the share of the second. */
typedef struct bump_pair {
  size_t first, second;
  double share;
} bump_pair;

static bump_pair find_bumps(const fg_film_report *r, size_t column) {
  const fg_film_options *o = &r->options;
  size_t per_pad = o->bumps_per_pad, nodes = per_pad * o->cells_per_bump + (o->pads ? 1 : 0);
  size_t pad = column / nodes, node = column % nodes;
  double at = (double)node / (double)o->cells_per_bump - 0.5;
  double low = floor(at), last = (double)per_pad - 1;
  if (o->pads) {
    at = fmin(fmax(at, 0), last);
    low = fmin(floor(at), fmax(last - 1, 0));
  }
  size_t first = (size_t)(low + (double)per_pad) % per_pad;
  return (bump_pair){pad * per_pad + first, pad * per_pad + (first + 1) % per_pad, at - low};
}

/* The springs of bumps at their nodes: K over the step, without dimensions. */
static double spring_at(const fg_film_report *r, const fg_film *film,
                        const fg_film_bearing *bearing, size_t column) {
  bump_pair pair = find_bumps(r, column);
  static const double near = 1e-6;
  bool second = pair.share > 1 - near;
  if (pair.share > near && !second) return 0;
  size_t per_bump = r->options.cells_per_bump, node = column;
  if (!film->mesh.ring) node %= film->mesh.cells + 1;
  if (node % per_bump != per_bump / 2) return 0; /* beyond the outer bumps of a pad */
  double stiffness = bearing->stiffness_n_mm2[second ? pair.second : pair.first];
  double step_mm = film->step * r->diameter_mm / 2;
  return stiffness / step_mm * r->clearance_um / r->options.ambient_kpa;
}

static double bending_of(const fg_film_report *r) {
  const fg_film_options *o = &r->options;
  if (o->top_foil != FG_FILM_TOP_FOIL_SAGGING) return 0;
  double modulus = o->material.youngs_modulus_gpa * 1e3 /
                   (1 - o->material.poisson_ratio * o->material.poisson_ratio);
  double per_width = modulus * pow(o->top_foil_mm, 3) / 12;
  return per_width / pow(r->diameter_mm / 2, 4) * r->clearance_um / o->ambient_kpa;
}

void fg_film_case_fill(const fg_film_report *r, const fg_film *film, const fg_film_bearing *bearing,
                       double speed_rpm, fg_film_case *at) {
  const fg_film_options *o = &r->options;
  double slenderness = r->diameter_mm * 1e3 / 2 / r->clearance_um;
  double load = o->load_n / fg_film_load_unit_n(r);
  at->lambda = 6 * o->viscosity_upa_s * 1e-6 * fg_film_speed_rad_s(speed_rpm) * slenderness *
               slenderness / (o->ambient_kpa * 1e3);
  at->load[0] = load * cos(o->load_deg * rad_per_deg);
  at->load[1] = load * sin(o->load_deg * rad_per_deg);
  at->loss = o->loss_factor;
  at->bending = bending_of(r);
  for (size_t i = 0; i < film->columns; i++) {
    bump_pair pair = find_bumps(r, i);
    double c[2] = {bearing->clearance_mm[pair.first], bearing->clearance_mm[pair.second]};
    double soft[2] = {r->stiffness_n_mm2 / bearing->stiffness_n_mm2[pair.first],
                      r->stiffness_n_mm2 / bearing->stiffness_n_mm2[pair.second]};
    at->clearance[i] = (c[0] + pair.share * (c[1] - c[0])) * 1e3 / r->clearance_um;
    bool rigid = r->compliance == 0, sags = at->bending > 0;
    double over = rigid ? 0 : r->compliance * (soft[0] + pair.share * (soft[1] - soft[0]));
    at->spring[i] = sags ? spring_at(r, film, bearing, i) : 1;
    at->yield[i] = sags ? 1 : over;
    /* The leading edge of a top foil is held. */
    if (sags && film->edge[i] && i % (film->mesh.cells + 1) == 0) at->spring[i] = 1;
  }
}
