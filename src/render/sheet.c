/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A flat sheet with beams: its outlines as lines and arcs, the material to their left in the
 * sheet's own coordinates. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/spec.h"

static const double pi = 3.14159265358979323846;

/* Radius of the round ends of slits: two corners of nearly half the kerf, so that a piece of the
 * line between them remains in spite of rounding. */
static const double ROUND_END = 0.5 * (1 - 1e-9);

/* Teeth across a torn end, in widths of the beam: places and heights. */
enum { TEETH = 4 };
static const double TOOTH_AT[TEETH] = {-0.5, -0.2, 0.15, 0.5};
static const double TOOTH_OUT[TEETH] = {0.07, -0.1, 0.08, -0.06};

enum { CORNERS_OF_BEAM = 2 + TEETH, CORNERS_MAX = FG_RENDER_BUMPS_MAX * CORNERS_OF_BEAM + 4 };

/* A corner of an outline, rounded. */
typedef struct corner {
  double x, y, radius;
} corner;

typedef struct outline {
  corner corners[CORNERS_MAX];
  size_t count;
} outline;

/* One beam about the middle of its root. */
typedef struct beam_plan {
  double root_y, length, half_root, half_tip, angle_rad;
  bool torn;
} beam_plan;

typedef struct sheet {
  const fg_place *place;
  const fg_foil_request *request;
  fg_scene *scene;
  size_t foil;
  double s_mm;
} sheet;

static void add_corner(outline *o, double x, double y, double radius) {
  o->corners[o->count++] = (corner){x, y, radius};
}

static const corner *corner_at(const outline *o, size_t i) {
  return &o->corners[i % o->count];
}

static double signed_area(const outline *o) {
  double sum = 0;
  for (size_t i = 0; i < o->count; i++) {
    const corner *a = corner_at(o, i), *b = corner_at(o, i + 1);
    sum += 0.5 * (a->x * b->y - b->x * a->y);
  }
  return sum;
}

/* Orients an outline, with the material to its left: an outer one counterclockwise, a hole
 * clockwise. */
static void orient_outline(outline *o, bool hole) {
  if ((signed_area(o) > 0) != hole) return;
  for (size_t i = 0; i < o->count / 2; i++) {
    corner kept = o->corners[i];
    o->corners[i] = o->corners[o->count - 1 - i];
    o->corners[o->count - 1 - i] = kept;
  }
}

/* The line from a corner to the next. */
typedef struct leg {
  double x, y, length;
} leg;

static leg leg_from(const outline *o, size_t i) {
  const corner *a = corner_at(o, i), *b = corner_at(o, i + 1);
  double dx = b->x - a->x, dy = b->y - a->y, length = hypot(dx, dy);
  return (leg){dx / length, dy / length, length};
}

static double turn_at(const leg *in, const leg *out) {
  return atan2(in->x * out->y - in->y * out->x, in->x * out->x + in->y * out->y);
}

/* Length of the lines that the rounding of a corner replaces. */
static double cut_at(const outline *o, size_t i) {
  leg in = leg_from(o, i + o->count - 1), out = leg_from(o, i);
  return corner_at(o, i)->radius * tan(0.5 * fabs(turn_at(&in, &out)));
}

static fg_status append_corner(sheet *s, const outline *o, size_t i) {
  const corner *c = corner_at(o, i);
  leg in = leg_from(o, i + o->count - 1), out = leg_from(o, i);
  double turn = turn_at(&in, &out), cut = cut_at(o, i), left = turn > 0 ? 1 : -1;
  if (fabs(turn) < 1e-9) return FG_OK;
  /* The centre lies on the side of the turn; a turn to the left has the material there. */
  double x = c->x - cut * in.x - left * c->radius * in.y;
  double y = c->y - cut * in.y + left * c->radius * in.x;
  return fg_scene_append(s->place->ctx, s->scene, s->foil, &s->s_mm,
                         (fg_segment){.x = x,
                                      .y = y,
                                      .radius = c->radius,
                                      .angle = atan2(-left * in.x, left * in.y),
                                      .sweep = turn,
                                      .side = -left,
                                      .length_mm = fabs(turn) * c->radius});
}

static fg_status append_line(sheet *s, const outline *o, size_t i) {
  const corner *from = corner_at(o, i);
  leg w = leg_from(o, i);
  double cut = cut_at(o, i), length = w.length - cut - cut_at(o, i + 1);
  if (length < -1e-9 || !isfinite(length))
    return fg_fail(s->place->ctx, FG_ERR_DATA,
                   "%s: %s: no room is left for the corners between (%.4g, %.4g) and (%.4g, %.4g) "
                   "mm: take smaller corner_radius_mm or root_radius_mm, or a wider pitch_mm",
                   s->place->path, s->place->member, from->x, from->y, corner_at(o, i + 1)->x,
                   corner_at(o, i + 1)->y);
  if (length <= 0) return FG_OK;
  return fg_scene_append(s->place->ctx, s->scene, s->foil, &s->s_mm,
                         (fg_segment){.line = true,
                                      .x = from->x + cut * w.x,
                                      .y = from->y + cut * w.y,
                                      .ax = w.x,
                                      .ay = w.y,
                                      .bx = -w.y,
                                      .by = w.x,
                                      .side = 1,
                                      .length_mm = length});
}

static fg_status append_outline(sheet *s, outline *o, bool hole) {
  orient_outline(o, hole);
  for (size_t i = 0; i < o->count; i++) {
    FG_TRY(append_corner(s, o, i));
    FG_TRY(append_line(s, o, i));
  }
  return FG_OK;
}

/* Adds a point of a beam: along its middle line from the root, and across. */
static void add_on_beam(outline *o, const beam_plan *beam, double along, double across,
                        double radius) {
  double c = cos(beam->angle_rad), s = sin(beam->angle_rad);
  add_corner(o, along * c - across * s, beam->root_y + along * s + across * c, radius);
}

static double half_width(const beam_plan *beam, double along) {
  return beam->half_root + (beam->half_tip - beam->half_root) * along / beam->length;
}

/* Place where the beam's edge on one side (-1, 1) leaves the line of the roots, x = 0. */
static double root_along(const beam_plan *beam, double side) {
  double c = cos(beam->angle_rad), s = sin(beam->angle_rad);
  double slope = (beam->half_tip - beam->half_root) / beam->length;
  return side * beam->half_root * s / (c - side * slope * s);
}

/* The beam's outline from one side of its root to the other. */
static void add_beam(outline *o, const beam_plan *beam, double root_radius, double tip_radius) {
  double along = root_along(beam, -1);
  add_on_beam(o, beam, along, -half_width(beam, along), root_radius);
  for (int k = 0; k < TEETH && beam->torn; k++) {
    double out = beam->length + 2 * TOOTH_OUT[k] * half_width(beam, beam->length);
    add_on_beam(o, beam, out, 2 * TOOTH_AT[k] * half_width(beam, out), fmin(tip_radius, 0.01));
  }
  for (int side = -1; side <= 1 && !beam->torn; side += 2)
    add_on_beam(o, beam, beam->length, side * beam->half_tip, tip_radius);
  along = root_along(beam, 1);
  add_on_beam(o, beam, along, half_width(beam, along), root_radius);
}

static fg_status fail_beam(const sheet *s, int beam, const char *what) {
  return fg_fail(s->place->ctx, FG_ERR_DATA, "%s: %s: beam %d %s", s->place->path, s->place->member,
                 beam, what);
}

/* Plans the beams. Deviations are drawn for missing beams too, so that removing one does not change
 * the others. */
static fg_status plan_beams(const sheet *s, const fg_render_spec *spec, beam_plan *plans) {
  const fg_render_design *design = &s->request->design;
  const fg_beams_request *beams = &s->request->beams;
  fg_random random;
  fg_random_seed(&random, spec->seed, FG_STREAM_SPRINGBACK, s->foil);
  for (int i = 0; i < design->beam_count; i++) {
    double length_um = beams->length.mean_um + beams->length.sd_um * fg_random_normal(&random);
    double width_um = beams->width.mean_um + beams->width.sd_um * fg_random_normal(&random);
    double width = design->beam_width_mm + 1e-3 * (width_um + beams->width_um[i]);
    double taper = 1e-3 * beams->taper_um[i];
    plans[i] = (beam_plan){.root_y = (i - 0.5 * (design->beam_count - 1)) * beams->pitch_mm,
                           .length = beams->torn[i] * (design->beam_length_mm +
                                                       1e-3 * (length_um + beams->length_um[i])),
                           .half_root = 0.5 * (width + 0.5 * taper),
                           .half_tip = 0.5 * (width - 0.5 * taper),
                           .angle_rad = beams->bent_deg[i] * pi / 180,
                           .torn = beams->torn[i] < 1};
    if (!(plans[i].length > 0) || !(plans[i].half_root > 0) || !(plans[i].half_tip > 0))
      return fail_beam(s, i + 1, "has no length or no width left with its deviations");
  }
  return FG_OK;
}

/* Reach of a beam to one side of its row, at its root or its free end. */
static double reach_y(const beam_plan *beam, double side, bool tip) {
  if (!tip) return beam->root_y + side * beam->half_root;
  return beam->root_y + beam->length * sin(beam->angle_rad) +
         side * beam->half_tip * cos(beam->angle_rad);
}

static fg_status check_room(const sheet *s, const beam_plan *plans) {
  const fg_beams_request *beams = &s->request->beams;
  double between = beams->slits ? 2 * beams->kerf_mm : 0;
  const beam_plan *before = NULL;
  for (int i = 0; i < s->request->design.beam_count; i++) {
    if (beams->missing[i]) continue;
    const beam_plan *beam = &plans[i];
    double sideways = beam->length * fabs(sin(beam->angle_rad));
    if (beams->slits && beam->angle_rad != 0 && sideways > 0.8 * beams->kerf_mm)
      return fail_beam(s, i + 1,
                       "is bent beyond its slit: take a smaller angle_deg or a wider "
                       "kerf_mm");
    for (int tip = 0; before && tip < 2; tip++)
      if (reach_y(before, 1, tip) + between >= reach_y(beam, -1, tip))
        return fail_beam(s, i + 1, "meets the one before it: take a wider pitch_mm");
    before = beam;
  }
  return FG_OK;
}

static double half_row(const sheet *s) {
  const fg_render_design *design = &s->request->design;
  return 0.5 * ((design->beam_count - 1) * s->request->beams.pitch_mm + design->beam_width_mm);
}

static fg_status build_comb(sheet *s, const beam_plan *plans) {
  const fg_beams_request *beams = &s->request->beams;
  double half = half_row(s) + beams->shoulder_mm, corner_radius = beams->corner_radius_mm;
  outline *o = NULL;
  FG_TRY(fg_memory_allocate(s->place->ctx, 1, sizeof *o, (void **)&o));
  add_corner(o, -beams->base_mm, -half, corner_radius);
  add_corner(o, 0, -half, corner_radius);
  for (int i = 0; i < s->request->design.beam_count; i++)
    if (!beams->missing[i]) add_beam(o, &plans[i], beams->root_radius_mm, corner_radius);
  add_corner(o, 0, half, corner_radius);
  add_corner(o, -beams->base_mm, half, corner_radius);
  fg_status status = append_outline(s, o, false);
  free(o);
  return status;
}

/* Appends a slit, which goes around the beam as it was cut: before it was torn or bent. */
static fg_status append_slit(sheet *s, outline *o, const beam_plan *beam, double whole_mm) {
  const fg_beams_request *beams = &s->request->beams;
  double kerf = beams->kerf_mm, end = ROUND_END * kerf, y = beam->root_y;
  double grown = beams->corner_radius_mm + kerf, out = whole_mm + kerf;
  o->count = 0;
  add_beam(o, beam, end, beams->corner_radius_mm);
  add_corner(o, 0, y + beam->half_root + kerf, end);
  add_corner(o, out, y + beam->half_tip + kerf, grown);
  add_corner(o, out, y - beam->half_tip - kerf, grown);
  add_corner(o, 0, y - beam->half_root - kerf, end);
  return append_outline(s, o, true);
}

static fg_status build_slits(sheet *s, const beam_plan *plans) {
  const fg_beams_request *beams = &s->request->beams;
  const fg_render_design *design = &s->request->design;
  double half = half_row(s) + beams->shoulder_mm, corner_radius = beams->corner_radius_mm;
  double far = beams->kerf_mm + beams->base_mm + design->beam_length_mm;
  fg_status status = FG_OK;
  outline *o = NULL;
  FG_TRY(fg_memory_allocate(s->place->ctx, 1, sizeof *o, (void **)&o));
  add_corner(o, -beams->base_mm, -half, corner_radius);
  add_corner(o, far, -half, corner_radius);
  add_corner(o, far, half, corner_radius);
  add_corner(o, -beams->base_mm, half, corner_radius);
  FG_TRY_EXIT(append_outline(s, o, false));
  for (int i = 0; i < design->beam_count; i++)
    if (!beams->missing[i])
      FG_TRY_EXIT(append_slit(s, o, &plans[i], plans[i].length / beams->torn[i]));
exit:
  free(o);
  return status;
}

static void put_truth(const sheet *s, const beam_plan *plans, fg_render_beam *beams,
                      size_t *count) {
  for (int i = 0; i < s->request->design.beam_count; i++) {
    const beam_plan *plan = &plans[i];
    if (s->request->beams.missing[i]) continue;
    beams[(*count)++] =
        (fg_render_beam){.number = i + 1,
                         .length_mm = plan->length,
                         .width_mm = plan->half_root + plan->half_tip,
                         .taper_um = 2e3 * (plan->half_root - plan->half_tip),
                         .bent_deg = s->request->beams.bent_deg[i],
                         .torn = plan->torn,
                         .root_px = {0, plan->root_y},
                         .tip_px = {plan->length * cos(plan->angle_rad),
                                    plan->root_y + plan->length * sin(plan->angle_rad)}};
  }
}

fg_status fg_sheet_build(const fg_place *place, const fg_render_spec *spec,
                         const fg_foil_request *request, fg_scene *scene, size_t foil) {
  sheet s = {.place = place, .request = request, .scene = scene, .foil = foil};
  beam_plan plans[FG_RENDER_BUMPS_MAX];
  fg_render_foil *truth = &scene->foils[foil];
  fg_drawn_foil *drawn = &scene->drawn[foil];
  fg_render_beam *beams = NULL;
  FG_TRY(fg_memory_allocate(place->ctx, (size_t)request->design.beam_count, sizeof *beams,
                            (void **)&beams));
  truth->beams = beams;
  truth->overall_radius_mm = NAN;
  truth->thickness_mm = request->design.thickness_mm;
  truth->mirror = request->mirror;
  drawn->sheet = true;
  drawn->first_segment = scene->segment_count;
  FG_TRY(plan_beams(&s, spec, plans));
  FG_TRY(check_room(&s, plans));
  FG_TRY((request->beams.slits ? build_slits : build_comb)(&s, plans));
  put_truth(&s, plans, beams, &truth->beam_count);
  drawn->segment_count = scene->segment_count - drawn->first_segment;
  drawn->length_mm = s.s_mm;
  return FG_OK;
}
