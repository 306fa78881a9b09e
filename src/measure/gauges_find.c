/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges among the objects of a scan of foils: measured with the edge models of foils and discs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/foil_kind.h"
#include "measure/discs.h"
#include "measure/gauges.h"
#include "vision/disc_find.h"
#include "vision/edges.h"

/* Limits of a leaf's bend. A leaf stands straight, or is bent evenly by less than this share of its
 * length; where the foil itself is a plain arc, by less than this share of the foil's bend. Evenly:
 * a parabola runs within half its width all along, which is not so for a strip with bumps. */
#define BEND_MAX       0.1
#define BEND_ARC_SHARE 0.4
#define EVEN_WIDTHS    0.5
/* Tolerances of a round object's box: its aspect, and its width against a stated gauge's, beside
 * the blocks at its borders. */
#define ASPECT_SHARE 0.1
#define SIZE_SHARE   0.1
/* Max distance of an object's outline outside its edge: blocks that hold part of an edge count to
 * the object. */
#define OUTLINE_PX 3.0
#define U_PX       8.0
/* Min radius of a disc's edge, and share of the smallest gauge's width (vision/disc_find.h). */
#define RADIUS_MIN_PX  14.0
#define DISC_MIN_SHARE 0.5

static bool is_stated(const fg_design *design, fg_gauge_kind from, fg_gauge_kind to) {
  for (size_t i = 0; i < design->gauge_count; i++)
    if (design->gauges[i].kind >= from && design->gauges[i].kind <= to) return true;
  return false;
}

/* ---- leaves ---- */

/* Distance of a point of the trace from the chord of its ends, px, and its place along it, -1 to 1.
 */
static double off_chord(const fg_trace *trace, size_t i, double *along) {
  fg_point a = trace->points[0], b = trace->points[trace->count - 1], p = trace->points[i];
  double dx = b.x - a.x, dy = b.y - a.y, chord = hypot(dx, dy);
  *along = 2 * ((p.x - a.x) * dx + (p.y - a.y) * dy) / (chord * chord) - 1;
  return ((p.x - a.x) * dy - (p.y - a.y) * dx) / chord;
}

/* Sagitta over the chord of a strip that is bent evenly; INFINITY of any other. */
static double bend_of(const fg_trace *trace) {
  fg_point a = trace->points[0], b = trace->points[trace->count - 1];
  double chord = hypot(b.x - a.x, b.y - a.y), sum = 0, squares = 0, along, off = 0;
  if (!(chord > trace->width_px)) return INFINITY;
  for (size_t i = 0; i < trace->count; i++) {
    double distance = off_chord(trace, i, &along), arch = 1 - along * along;
    sum += arch * distance;
    squares += arch * arch;
  }
  double sagitta = squares > 0 ? sum / squares : 0;
  for (size_t i = 0; i < trace->count; i++) {
    double distance = off_chord(trace, i, &along);
    off = fmax(off, fabs(distance - sagitta * (1 - along * along)));
  }
  return off > EVEN_WIDTHS * trace->width_px ? INFINITY : fabs(sagitta) / chord;
}

static double bend_max(const fg_design *design) {
  const fg_foil_row *kind = fg_foil_row_of(design->kind);
  if (!kind->sagitta_over_chord) return BEND_MAX;
  return fmin(BEND_MAX, BEND_ARC_SHARE * kind->sagitta_over_chord(design));
}

static const char *why_spoiled(const fg_strip *strip) {
  if (strip->facts & FG_STRIP_TOUCHES_OTHER) return "it touches another part: lay it apart";
  if (!isfinite(strip->u_thickness_mm)) return "too little of its edges can be seen";
  if (strip->plain_side_band) return "a wall or a shadow shows beside an edge: stand it upright";
  return NULL;
}

static fg_gauge_sighting sighting_of(const fg_gauge_object *object, const fg_strip *strip) {
  const double *dpi = object->measurement->dpi;
  fg_gauge_sighting one = {.kind = FG_GAUGE_LEAF,
                           .width_mm = strip->plain_mm,
                           .u_mm = strip->u_thickness_mm,
                           .length_mm = strip->stations[strip->count - 1].s_mm,
                           .blur_mm = strip->plain_blur_um / 1000,
                           .contrast = strip->plain_counts,
                           .bright = strip->bright,
                           .spoiled = why_spoiled(strip)};
  for (int k = 0; k < 2; k++) {
    one.place_mm[k] = (double)(strip->box_px[k] + object->origin_px[k]) * 25.4 / dpi[k];
    one.place_mm[2 + k] = (double)strip->box_px[2 + k] * 25.4 / dpi[k];
  }
  return one;
}

fg_status fg_gauge_test_leaf(fg_context *ctx, const fg_gauge_object *object, const fg_trace *trace,
                             unsigned threads, fg_gauge_sightings *sightings, bool *taken) {
  const fg_measurement *m = object->measurement;
  fg_strip strip = {0};
  *taken = false;
  if (!is_stated(&m->design, FG_GAUGE_LEAF, FG_GAUGE_LEAF)) return FG_OK;
  if (trace->count < 2 || bend_of(trace) > bend_max(&m->design)) return FG_OK;
  *taken = true;
  const fg_edge_options options = {
      .dpi = m->dpi, .threads = threads, .linear = m->design.tone == FG_TONE_LINEAR, .plain = true};
  fg_status status =
      fg_edges_measure(ctx, object->tiles, object->segmentation, trace, &options, &strip);
  if (status == FG_ERR_NUMERIC) return FG_OK;
  if (status == FG_OK && strip.count && isfinite(strip.plain_mm)) {
    const fg_gauge_sighting one = sighting_of(object, &strip);
    status = fg_gauge_sightings_add(ctx, sightings, &one);
  }
  fg_strip_free(&strip);
  return status;
}

fg_status fg_gauge_trace_leaf(fg_context *ctx, const fg_gauge_object *object, unsigned threads,
                              fg_gauge_sightings *sightings, bool *taken) {
  const fg_measurement *m = object->measurement;
  *taken = false;
  for (size_t i = 0; i < m->design.gauge_count && !*taken; i++) {
    const fg_gauge *gauge = &m->design.gauges[i];
    fg_trace_list list;
    if (gauge->kind != FG_GAUGE_LEAF) continue;
    FG_TRY(fg_trace_object(ctx, object->tiles, object->segmentation, object->object,
                           gauge->width_mm * sqrt(m->dpi[0] * m->dpi[1]) / 25.4, &list));
    fg_status status = FG_OK;
    for (size_t k = 0; k < list.count && status == FG_OK && !*taken; k++)
      status = fg_gauge_test_leaf(ctx, object, &list.traces[k], threads, sightings, taken);
    fg_trace_list_free(&list);
    FG_TRY(status);
  }
  return FG_OK;
}

/* ---- discs ---- */

static bool is_square(const fg_pixel_shape *shape, const fg_object *o) {
  double width = o->width * shape->scale[0], height = o->height * shape->scale[1];
  return fabs(width - height) <= ASPECT_SHARE * fmax(width, height) + 1.5;
}

/* A disc wider than a few tiles shows by its rim alone, as its middle counts as background: its box
 * gives its size. */
static bool is_round(const fg_design *design, const fg_pixel_shape *shape, const fg_object *o) {
  double width = o->width * shape->scale[0], height = o->height * shape->scale[1];
  double diameter_mm = 0.5 * (width + height) * FG_BLOCK_PX * shape->um / 1000;
  if (!is_square(shape, o)) return false;
  for (size_t i = 0; i < design->gauge_count; i++) {
    const fg_gauge *gauge = &design->gauges[i];
    double slack = (2 * FG_BLOCK_PX * shape->um) / 1000 + SIZE_SHARE * gauge->width_mm;
    if (gauge->kind != FG_GAUGE_LEAF && fabs(diameter_mm - gauge->width_mm) < slack) return true;
  }
  return false;
}

/* The circle in the object's box, in square pixels. */
static fg_disc_candidate circle_of(const fg_pixel_shape *shape, const fg_object *o) {
  double x = (o->x + 0.5 * o->width) * FG_BLOCK_PX - 0.5;
  double y = (o->y + 0.5 * o->height) * FG_BLOCK_PX - 0.5;
  double size = 0.5 * (o->width * shape->scale[0] + o->height * shape->scale[1]);
  double radius = 0.5 * size * FG_BLOCK_PX - OUTLINE_PX;
  return (fg_disc_candidate){{x * shape->scale[0], y * shape->scale[1], radius}, U_PX, 1};
}

/* Measures one round feature; *taken: it is a gauge. */
static fg_status measure_circle(fg_context *ctx, const fg_gauge_object *object,
                                const fg_disc_candidate *candidate, bool hole,
                                fg_gauge_sightings *sightings, bool *taken) {
  const fg_measurement *m = object->measurement;
  const fg_pixel_shape shape = fg_pixel_shape_of(m->dpi);
  fg_measurement one = {.disc_count = 1};
  fg_disc disc = {0};
  FG_TRY(fg_measure_disc_near(ctx, object->tiles, &shape, m, candidate, &disc));
  if (!disc.points) return FG_OK;
  disc.hole = hole || !is_stated(&m->design, FG_GAUGE_PIN, FG_GAUGE_PIN);
  disc.centre_mm.x += (double)object->origin_px[0] * 25.4 / m->dpi[0];
  disc.centre_mm.y += (double)object->origin_px[1] * 25.4 / m->dpi[1];
  one.discs = &disc;
  fg_status status = fg_gauge_find_discs(ctx, &one, sightings);
  fg_disc_free(&disc);
  *taken = true;
  return status;
}

static fg_status measure_outline(fg_context *ctx, const fg_gauge_object *object,
                                 fg_gauge_sightings *sightings, bool *taken) {
  const fg_pixel_shape shape = fg_pixel_shape_of(object->measurement->dpi);
  const fg_object *o = object->object;
  const fg_disc_candidate candidate = circle_of(&shape, o);
  if (!is_round(&object->measurement->design, &shape, o) || candidate.circle.radius < RADIUS_MIN_PX)
    return FG_OK;
  return measure_circle(ctx, object, &candidate, false, sightings, taken);
}

/* A circle inside the object's outline, as wide as a stated ring or hole. */
static bool is_hole(const fg_gauge_object *object, const fg_pixel_shape *shape,
                    const fg_circle *circle) {
  const fg_design *design = &object->measurement->design;
  const fg_object *o = object->object;
  double min = fmin(o->width * shape->scale[0], o->height * shape->scale[1]);
  double width_mm = 2 * circle->radius * shape->um / 1000;
  fg_circle outline = circle_of(shape, o).circle;
  if (hypot(circle->x - outline.x, circle->y - outline.y) + circle->radius >
      0.5 * min * FG_BLOCK_PX - FG_BLOCK_PX)
    return false;
  for (size_t i = 0; i < design->gauge_count; i++) {
    const fg_gauge *gauge = &design->gauges[i];
    if ((gauge->kind == FG_GAUGE_RING || gauge->kind == FG_GAUGE_HOLE) &&
        fabs(width_mm - gauge->width_mm) < SIZE_SHARE * gauge->width_mm)
      return true;
  }
  return false;
}

/* Finds holes by the outlines of their levels, as in a scan of discs. The middle of a wide disc, or
 * of its hole, is background to some tiles and not to others, depending on the corners of tiles. */
static fg_status find_holes(fg_context *ctx, const fg_gauge_object *object,
                            fg_gauge_sightings *sightings, bool *taken) {
  const fg_pixel_shape shape = fg_pixel_shape_of(object->measurement->dpi);
  double min = DISC_MIN_SHARE * fg_gauge_min_px(object->measurement);
  fg_disc_candidates found = {0};
  if (!is_square(&shape, object->object)) return FG_OK;
  FG_TRY(fg_discs_find(ctx, object->tiles, &shape, fmax(min, RADIUS_MIN_PX), 1, &found));
  fg_status status = FG_OK;
  for (size_t i = 0; i < found.count && status == FG_OK; i++)
    if (is_hole(object, &shape, &found.list[i].circle))
      status = measure_circle(ctx, object, &found.list[i], true, sightings, taken);
  fg_disc_candidates_free(&found);
  return status;
}

fg_status fg_gauge_find_round(fg_context *ctx, const fg_gauge_object *object,
                              fg_gauge_sightings *sightings, bool *taken) {
  const fg_design *design = &object->measurement->design;
  *taken = false;
  if (!is_stated(design, FG_GAUGE_PIN, FG_GAUGE_HOLE)) return FG_OK;
  FG_TRY(measure_outline(ctx, object, sightings, taken));
  if (is_stated(design, FG_GAUGE_RING, FG_GAUGE_HOLE))
    FG_TRY(find_holes(ctx, object, sightings, taken));
  return FG_OK;
}
