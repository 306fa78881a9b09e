/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The midline of one foil: lip, lands, fillets, bumps, in its own coordinates. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/spec.h"

static const double pi = 3.14159265358979323846;

/* One bump as drawn: its circle, and its joints with the fillets and lands. */
typedef struct bump_plan {
  double axis_rad; /* direction of C seen from O */
  double radius, centre_distance;
  double land_rad; /* gamma: from the axis to the joint of fillet and land, at O */
  double arc_rad;  /* delta: from the axis to the joint of fillet and bump, at C */
  bool present;
} bump_plan;

typedef struct outline {
  const fg_place *place;
  const fg_render_spec *spec;
  const fg_foil_request *request;
  fg_scene *scene;
  size_t foil;
  double s_mm;
} outline;

static double safe_acos(double value) {
  return acos(value > 1 ? 1 : value < -1 ? -1 : value);
}

/* Keeps the two crossings with the overall circle and moves the crown: with a the distance from
 * the chord to the crown and b half the chord, the circle through the three has radius
 * (a² + b²) / (2 a). */
static void crush_bump(double factor, double overall, fg_render_bump *bump) {
  double half = 0.5 * bump->bump_angle_deg * pi / 180;
  double half_chord = bump->radius_mm * sin(half);
  double to_chord = sqrt(overall * overall - half_chord * half_chord);
  double crown = overall - factor * bump->height_mm;
  double sagitta = to_chord - crown;
  if (sagitta <= 0) {
    bump->radius_mm = NAN;
    return;
  }
  bump->radius_mm = (sagitta * sagitta + half_chord * half_chord) / (2 * sagitta);
  bump->centre_to_centre_mm = crown + bump->radius_mm;
  bump->bump_angle_deg = 2 * 180 / pi * asin(fmin(1, half_chord / bump->radius_mm));
  bump->crushed = factor != 1;
}

/* The law of cosines gives X from R, alpha and R0; theta and h follow (eq 5.3 to 5.5). */
static void derive_bump(const fg_foil_request *request, fg_render_bump *bump) {
  double overall = request->overall_radius_mm;
  double half = 0.5 * bump->bump_angle_deg * pi / 180;
  double rest = overall * overall - pow(bump->radius_mm * sin(half), 2);
  bump->centre_to_centre_mm = bump->radius_mm * cos(half) + sqrt(rest);
  bump->height_mm = overall - (bump->centre_to_centre_mm - bump->radius_mm);
  double factor = request->height_factor[bump->index - 1];
  if (factor != 1) crush_bump(factor, overall, bump);
  double x = bump->centre_to_centre_mm, r = bump->radius_mm;
  bump->height_mm = overall - (x - r);
  bump->intersection_angle_deg =
      180 / pi * safe_acos((x * x - r * r - overall * overall) / (2 * r * overall));
}

/* Moves the circle towards O; the law of cosines gives its new crossings with the overall circle,
 * and the fillets follow. */
static void raise_bump(double overall, double by_mm, fg_render_bump *bump) {
  if (by_mm == 0) return;
  double x = bump->centre_to_centre_mm - by_mm, r = bump->radius_mm;
  bump->centre_to_centre_mm = x;
  bump->bump_angle_deg =
      2 * 180 / pi * safe_acos((x * x + r * r - overall * overall) / (2 * x * r));
  bump->height_mm = overall - (x - r);
  bump->intersection_angle_deg =
      180 / pi * safe_acos((x * x - r * r - overall * overall) / (2 * r * overall));
}

fg_render_bump fg_outline_nominal(const fg_render_design *design) {
  fg_foil_request request = {.overall_radius_mm = design->overall_radius_mm, .height_factor = {1}};
  fg_render_bump bump = {
      .index = 1, .radius_mm = design->bump_radius_mm, .bump_angle_deg = design->bump_angle_deg};
  derive_bump(&request, &bump);
  return bump;
}

static fg_status plan_bump(const outline *o, const fg_render_bump *bump, bump_plan *plan) {
  double overall = o->request->overall_radius_mm;
  double fillet = o->request->design.fillet_radius_mm;
  double x = bump->centre_to_centre_mm;
  /* The fillet's centre F lies inside the overall circle and outside the bump's:
   * |OF| = R0 - r_f, |CF| = R + r_f, |OC| = X. */
  double of = overall - fillet, cf = bump->radius_mm + fillet;
  double cos_land = (of * of + x * x - cf * cf) / (2 * of * x);
  double cos_arc = (x * x + cf * cf - of * of) / (2 * x * cf);
  if (!(fabs(cos_land) < 1) || !(fabs(cos_arc) < 1) || !(bump->bump_angle_deg > 0) ||
      !(bump->bump_angle_deg < 180))
    return fg_fail(o->place->ctx, FG_ERR_DATA,
                   "%s: %s: bump %d (radius_mm %g, bump_angle_deg %g, fillet_radius_mm %g) cannot "
                   "meet the overall circle (overall_radius_mm %g)",
                   o->place->path, o->place->member, bump->index, bump->radius_mm,
                   bump->bump_angle_deg, fillet, overall);
  plan->radius = bump->radius_mm;
  plan->centre_distance = x;
  plan->land_rad = acos(cos_land);
  plan->arc_rad = acos(cos_arc);
  return FG_OK;
}

fg_status fg_scene_append(fg_context *ctx, fg_scene *scene, size_t foil, double *s_mm,
                          fg_segment segment) {
  FG_TRY(fg_memory_reserve(ctx, scene->segment_count + 1, sizeof segment, &scene->segment_capacity,
                           (void **)&scene->segments));
  segment.s_mm = *s_mm;
  segment.foil = foil;
  *s_mm += segment.length_mm;
  scene->segments[scene->segment_count++] = segment;
  return FG_OK;
}

static fg_status append_segment(outline *o, fg_segment segment) {
  return fg_scene_append(o->place->ctx, o->scene, o->foil, &o->s_mm, segment);
}

static fg_status append_arc(outline *o, fg_segment arc) {
  /* Half-plane tests decide the points of an arc; they need less than half a turn. */
  int pieces = (int)ceil(fabs(arc.sweep) / 3.0);
  if (fabs(arc.sweep) < 1e-12) return FG_OK;
  arc.sweep /= pieces;
  arc.length_mm = fabs(arc.sweep) * arc.radius;
  for (int i = 0; i < pieces; i++) {
    FG_TRY(append_segment(o, arc));
    arc.angle += arc.sweep;
  }
  return FG_OK;
}

static fg_status append_lip(outline *o, double land_start_rad) {
  const fg_render_lip *lip = &o->request->lip;
  double ux = cos(land_start_rad), uy = sin(land_start_rad), out = lip->outwards ? 1 : -1;
  double centre = o->request->overall_radius_mm + out * lip->bend_radius_mm;
  double x = centre * ux + lip->bend_radius_mm * uy, y = centre * uy - lip->bend_radius_mm * ux;
  FG_TRY(append_segment(o, (fg_segment){.line = true,
                                        .x = x + out * lip->length_mm * ux,
                                        .y = y + out * lip->length_mm * uy,
                                        .ax = -out * ux,
                                        .ay = -out * uy,
                                        .bx = out * uy,
                                        .by = -out * ux,
                                        .side = 1,
                                        .length_mm = lip->length_mm}));
  /* From the lip's foot, a quarter turn to the land; the bend's centre is on the lip's side. */
  return append_arc(o, (fg_segment){.x = centre * ux,
                                    .y = centre * uy,
                                    .radius = lip->bend_radius_mm,
                                    .angle = land_start_rad - pi / 2,
                                    .sweep = -out * pi / 2,
                                    .side = out});
}

static fg_status append_land(outline *o, double from_rad, double to_rad) {
  return append_arc(o, (fg_segment){.radius = o->request->overall_radius_mm,
                                    .angle = from_rad,
                                    .sweep = to_rad - from_rad,
                                    .side = -1});
}

static fg_status append_bump(outline *o, const bump_plan *plan, int index) {
  double fillet = o->request->design.fillet_radius_mm;
  double of = o->request->overall_radius_mm - fillet;
  double turn = plan->land_rad + plan->arc_rad;
  double first = plan->axis_rad - plan->land_rad, last = plan->axis_rad + plan->land_rad;
  double bump_mm = 2 * plan->arc_rad * plan->radius;
  FG_TRY(append_arc(o, (fg_segment){.x = of * cos(first),
                                    .y = of * sin(first),
                                    .radius = fillet,
                                    .angle = first,
                                    .sweep = turn,
                                    .side = -1,
                                    .joins = -1,
                                    .bump_mm = bump_mm}));
  FG_TRY(append_arc(o, (fg_segment){.x = plan->centre_distance * cos(plan->axis_rad),
                                    .y = plan->centre_distance * sin(plan->axis_rad),
                                    .radius = plan->radius,
                                    .angle = plan->axis_rad + pi + plan->arc_rad,
                                    .sweep = -2 * plan->arc_rad,
                                    .side = 1,
                                    .bump = index}));
  return append_arc(o, (fg_segment){.x = of * cos(last),
                                    .y = of * sin(last),
                                    .radius = fillet,
                                    .angle = last - turn,
                                    .sweep = turn,
                                    .side = -1,
                                    .joins = 1,
                                    .bump_mm = bump_mm});
}

static fg_status make_bumps(outline *o, bump_plan *plans, fg_render_bump *bumps, size_t *count) {
  const fg_foil_request *request = o->request;
  const fg_render_design *design = &request->design;
  fg_random random;
  fg_random_seed(&random, o->spec->seed, FG_STREAM_SPRINGBACK, o->foil);
  *count = 0;
  for (int i = 0; i < design->bump_count; i++) {
    /* Drawn for missing bumps too, so that removing one does not change the others. */
    double scatter = request->springback_sd * fg_random_normal(&random);
    plans[i] =
        (bump_plan){.axis_rad = (i - 0.5 * (design->bump_count - 1)) * design->pitch_deg * pi / 180,
                    .present = !request->missing[i]};
    if (!plans[i].present) continue;
    fg_render_bump bump = {.index = i + 1, .radius_mm = request->radius_mm[i]};
    if (isnan(bump.radius_mm))
      bump.radius_mm = design->bump_radius_mm * (1 + request->springback_mean + scatter) *
                       fg_render_effects_shape(&o->spec->effects, FG_RENDER_EFFECT_TABLE, i + 1,
                                               design->bump_count);
    bump.bump_angle_deg = request->bump_angle_deg[i];
    if (isnan(bump.bump_angle_deg))
      bump.bump_angle_deg = design->bump_angle_deg * design->bump_radius_mm / bump.radius_mm *
                            fg_render_effects_shape(&o->spec->effects, FG_RENDER_EFFECT_STRETCH,
                                                    bump.radius_mm - design->bump_radius_mm, 1);
    derive_bump(request, &bump);
    raise_bump(request->overall_radius_mm, fg_render_effects_lift(&o->spec->effects, i + 1, true),
               &bump);
    FG_TRY(plan_bump(o, &bump, &plans[i]));
    bump.centre_px = (fg_point){bump.centre_to_centre_mm * cos(plans[i].axis_rad),
                                bump.centre_to_centre_mm * sin(plans[i].axis_rad)};
    bumps[(*count)++] = bump;
  }
  return FG_OK;
}

/* Appends lands, fillets and bumps; a missing bump leaves its place to the land. */
static fg_status append_all(outline *o, const bump_plan *plans, double start_rad, double end_rad) {
  double land_from = start_rad;
  if (o->request->has_lip) FG_TRY(append_lip(o, start_rad));
  for (int i = 0; i < o->request->design.bump_count; i++) {
    if (!plans[i].present) continue;
    double land_to = plans[i].axis_rad - plans[i].land_rad;
    if (land_to < land_from)
      return fg_fail(o->place->ctx, FG_ERR_DATA,
                     "%s: %s: bump %d overlaps the one before it: no land is left at pitch_deg %g",
                     o->place->path, o->place->member, i + 1, o->request->design.pitch_deg);
    FG_TRY(append_land(o, land_from, land_to));
    FG_TRY(append_bump(o, &plans[i], i + 1));
    land_from = plans[i].axis_rad + plans[i].land_rad;
  }
  return append_land(o, land_from, end_rad);
}

static fg_status finish_outline(outline *o, double start_rad, double end_rad) {
  fg_scene *scene = o->scene;
  fg_drawn_foil *drawn = &scene->drawn[o->foil];
  drawn->segment_count = scene->segment_count - drawn->first_segment;
  if (drawn->segment_count == 0)
    return fg_fail(o->place->ctx, FG_ERR_DATA, "%s: %s: the foil has no length", o->place->path,
                   o->place->member);
  scene->segments[drawn->first_segment].open_start = true;
  scene->segments[scene->segment_count - 1].open_end = true;
  drawn->length_mm = o->s_mm;
  drawn->half_span_rad = 0.5 * (end_rad - start_rad);
  drawn->half_thickness_mm = 0.5 * o->request->design.thickness_mm;
  return FG_OK;
}

/* Builds a plain strip, with a lip if requested. */
static fg_status build_arc(outline *o) {
  double half_rad = 0.5 * o->request->subtended_angle_deg * pi / 180;
  fg_drawn_foil *drawn = &o->scene->drawn[o->foil];
  drawn->first_segment = o->scene->segment_count;
  drawn->rough_cuts = true;
  if (!(half_rad < pi))
    return fg_fail(o->place->ctx, FG_ERR_DATA, "%s: %s: the foil is longer than a full turn",
                   o->place->path, o->place->member);
  o->scene->foils[o->foil].subtended_angle_deg = o->request->subtended_angle_deg;
  if (o->request->has_lip) FG_TRY(append_lip(o, -half_rad));
  FG_TRY(append_land(o, -half_rad, half_rad));
  return finish_outline(o, -half_rad, half_rad);
}

fg_status fg_outline_build(const fg_place *place, const fg_render_spec *spec,
                           const fg_foil_request *request, fg_scene *scene, size_t foil) {
  outline o = {.place = place, .spec = spec, .request = request, .scene = scene, .foil = foil};
  bump_plan plans[FG_RENDER_BUMPS_MAX];
  fg_render_bump *bumps = NULL;
  FG_TRY(fg_memory_allocate(place->ctx, (size_t)request->design.bump_count, sizeof *bumps,
                            (void **)&bumps));
  fg_render_foil *truth = &scene->foils[foil];
  truth->bumps = bumps;
  FG_TRY(make_bumps(&o, plans, bumps, &truth->bump_count));
  truth->overall_radius_mm = request->overall_radius_mm;
  truth->thickness_mm = request->design.thickness_mm;
  truth->mirror = request->mirror;
  if (request->design.arc) return build_arc(&o);

  const bump_plan *first = &plans[0], *last = &plans[request->design.bump_count - 1];
  double start =
      first->axis_rad - first->land_rad - request->first_land_mm / request->overall_radius_mm;
  double end = last->axis_rad + last->land_rad + request->last_land_mm / request->overall_radius_mm;
  fg_drawn_foil *drawn = &scene->drawn[foil];
  drawn->first_segment = scene->segment_count;
  if (!(end - start < 2 * pi))
    return fg_fail(place->ctx, FG_ERR_DATA, "%s: %s: the foil is longer than a full turn",
                   place->path, place->member);
  FG_TRY(append_all(&o, plans, start, end));
  return finish_outline(&o, start, end);
}
