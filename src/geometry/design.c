/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Designs of every kind: their common members, and the change from one kind to another. */
#include "geometry/foil_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

fg_status fg_design_check_positive(fg_context *ctx, const char *member, double value) {
  if (isfinite(value) && value > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s is %g; it must be a number above 0", member, value);
}

/* A thickness this many times the design's, or its inverse, is in another unit. */
static const double thickness_times = 10;

/* 0: not stated. The scan of what lies flat, or is round, shows no thickness. */
static fg_status check_thickness_measured(fg_context *ctx, const fg_design *design) {
  static const char *const name = "thickness_measured";
  double value = design->thickness_measured_mm, u = design->u_thickness_measured_mm;
  if (value == 0 && u == 0) return FG_OK;
  const char *why_not = fg_foil_traits_of(design->kind)->why_no_thickness_measured;
  if (why_not) return fg_fail(ctx, FG_ERR_DATA, "%s %s", name, why_not);
  if (!(value > 0) || !isfinite(value))
    return fg_fail(ctx, FG_ERR_DATA, "%s.value_mm is %g; it must be a number above 0, in mm", name,
                   value);
  if (design->thickness_mm > 0 && fabs(log(value / design->thickness_mm)) > log(thickness_times))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s.value_mm is %g, and thickness_mm %g: is it in mm? 100 µm is 0.1 mm", name,
                   value, design->thickness_mm);
  if (!(u > 0 && u < value / 2))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s.u_mm is %g; a standard uncertainty, in mm, must be above 0, as no "
                   "micrometer is exact, and below half of the value %g",
                   name, u, value);
  return FG_OK;
}
static fg_status check_tolerances(fg_context *ctx, const fg_design *design) {
  if (design->tolerance_count > FG_TOLERANCES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "tolerances has %zu entries; at most %d",
                   design->tolerance_count, FG_TOLERANCES_MAX);
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *t = &design->tolerances[i];
    if (!(t->lower <= t->upper))
      return fg_fail(ctx, FG_ERR_DATA, "tolerances.%.47s: min %g is above max %g", t->quantity,
                     t->lower, t->upper);
  }
  return FG_OK;
}

static fg_status check_gauges(fg_context *ctx, const fg_design *design) {
  if (design->gauge_count > FG_GAUGES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "gauges has %zu entries; at most %d", design->gauge_count,
                   FG_GAUGES_MAX);
  const char *why_not = fg_foil_traits_of(design->kind)->why_no_gauges;
  if (design->gauge_count && why_not) return fg_fail(ctx, FG_ERR_DATA, "gauges: %s", why_not);
  for (size_t i = 0; i < design->gauge_count; i++) {
    char name[48];
    snprintf(name, sizeof name, "gauges[%zu]", i);
    FG_TRY(fg_gauge_check(ctx, name, &design->gauges[i]));
  }
  return FG_OK;
}

fg_status fg_design_check_common(fg_context *ctx, const fg_design *design) {
  FG_TRY(check_tolerances(ctx, design));
  FG_TRY(fg_calibration_check(ctx, &design->calibration));
  FG_TRY(check_thickness_measured(ctx, design));
  return check_gauges(ctx, design);
}

fg_status fg_design_check(fg_context *ctx, const fg_design *design) {
  FG_TRY(fg_design_check_common(ctx, design));
  return fg_foil_row_of(design->kind)->check(ctx, design);
}

static const fg_design_bumps gen2_bumps = {
    .count = 9,
    .radius_mm = 3.32,
    .angle_deg = 63.15,
    .sleeve_radius_mm = 20.73,
    .pitch_deg = 40.0 / 3,
    .fillet_radius_mm = 0.35,
    .rotor_diameter_mm = 40,
};

void fg_design_default(fg_design *design) {
  *design = (fg_design){
      .name = "gen2-classical",
      .kind = FG_FOIL_CLASSICAL,
      .datum = FG_DATUM_MID,
      .overall_radius_mm = 20.73,
      .thickness_mm = 0.1,
      .bumps = gen2_bumps,
  };
}

void fg_design_group_default(fg_design_group group, fg_design_values *values) {
  memset(values, 0, sizeof *values);
  if (group == FG_DESIGN_BUMPS) values->bumps = gen2_bumps;
}

/* One member of a group, for the question whether it is stated. */
typedef struct stated_member {
  fg_design_group group;
  const char *name;
  bool is_count;
  size_t offset;
} stated_member;

#define NUMBER(group, type, name, member)                                                          \
  { group, name, false, offsetof(type, member) }
#define COUNT(group, type, name, member)                                                           \
  { group, name, true, offsetof(type, member) }
static const stated_member stated_members[] = {
    COUNT(FG_DESIGN_BEAMS, fg_design_beams, "beam_count", count),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "beam_length_mm", length_mm),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "beam_width_mm", width_mm),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "u_thickness_mm", u_thickness_mm),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "sagitta_mm", sagitta_mm),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "elastic_modulus_gpa", elastic_modulus_gpa),
    NUMBER(FG_DESIGN_BEAMS, fg_design_beams, "clearance_mm", clearance_mm),
    COUNT(FG_DESIGN_DISCS, fg_design_discs, "diameters_mm", count),
    NUMBER(FG_DESIGN_DISCS, fg_design_discs, "diameters_mm", u_diameters_mm),
    NUMBER(FG_DESIGN_GRID, fg_design_grid, "u_pitch_mm", u_pitch_mm),
    NUMBER(FG_DESIGN_GRID, fg_design_grid, "u_place_mm", u_place_mm),
    NUMBER(FG_DESIGN_GRID, fg_design_grid, "certificate", certificate),
    NUMBER(FG_DESIGN_ARC, fg_design_arc, "subtended_angle_deg", subtended_angle_deg),
};
#undef NUMBER
#undef COUNT

static bool is_stated(const stated_member *member, const fg_design_values *values) {
  const char *place = (const char *)values + member->offset;
  size_t count;
  double number;
  memcpy(&count, place, sizeof count);
  memcpy(&number, place, sizeof number);
  return member->is_count ? count != 0 : number != 0;
}

/* The first kind whose dimensions are of this group. */
static const char *owner_of(fg_design_group group) {
  int kind = 0;
  while (kind + 1 < FG_FOIL_KINDS && fg_foil_traits_of((fg_foil_kind)kind)->group != group)
    kind++;
  return fg_foil_traits_of((fg_foil_kind)kind)->name;
}

fg_status fg_design_check_refused(fg_context *ctx, fg_foil_kind kind, fg_design_group group,
                                  const fg_design_values *values) {
  if (!(fg_foil_traits_of(kind)->refused & 1u << group)) return FG_OK;
  for (size_t i = 0; i < sizeof stated_members / sizeof *stated_members; i++)
    if (stated_members[i].group == group && is_stated(&stated_members[i], values))
      return fg_fail(ctx, FG_ERR_DATA, "%s belongs to form \"%s\" only", stated_members[i].name,
                     owner_of(group));
  return FG_OK;
}

fg_status fg_design_become(fg_context *ctx, fg_foil_kind kind, fg_design *design) {
  const fg_design_group from = fg_foil_traits_of(design->kind)->group;
  const fg_design_group to = fg_foil_traits_of(kind)->group;
  if (from != to) {
    FG_TRY(fg_design_check_refused(ctx, kind, from, &design->values));
    fg_design_group_default(to, &design->values);
  }
  design->kind = kind;
  return FG_OK;
}

fg_status fg_design_derive(fg_context *ctx, const fg_design *design, fg_nominal *nominal) {
  const fg_foil_row *kind = fg_foil_row_of(design->kind);
  FG_TRY(fg_design_check(ctx, design));
  *nominal = (fg_nominal){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
  if (kind->derive) kind->derive(design, nominal);
  return FG_OK;
}
