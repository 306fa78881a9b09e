/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils and discs at their places, the size of the picture, litter, truth. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/resample.h"
#include "render/spec.h"

static const double pi = 3.14159265358979323846;

fg_point fg_segment_point(const fg_segment *segment, double t_mm) {
  if (segment->line)
    return (fg_point){segment->x + t_mm * segment->ax, segment->y + t_mm * segment->ay};
  double angle = segment->angle + segment->sweep * t_mm / segment->length_mm;
  return (fg_point){segment->x + segment->radius * cos(angle),
                    segment->y + segment->radius * sin(angle)};
}

double fg_segment_bump_shift(const fg_render_effect_list *effects, const fg_segment *segment,
                             double t_mm) {
  if (segment->bump) {
    double u = 2 * t_mm / segment->length_mm - 1, flat = 1 - u * u;
    return fg_render_effects_shape(effects, FG_RENDER_EFFECT_BUMP, u, 1) +
           fg_render_effects_lift(effects, segment->bump, false) * flat * flat;
  }
  if (!segment->joins) return 0;
  double value, slope;
  fg_render_effects_bump_end(effects, segment->joins, &value, &slope);
  double from = segment->joins > 0 ? t_mm : segment->length_mm - t_mm;
  double s = fmin(1, fmax(0, from / segment->length_mm));
  /* Hermite's cubic from (value, slope) to (0, 0); du = 2 / bump_mm. */
  return (1 - s) * (1 - s) *
         (value * (1 + 2 * s) + slope * 2 / segment->bump_mm * s * segment->length_mm);
}

double fg_foil_psi(const fg_drawn_foil *drawn, double x_mm, double y_mm) {
  double angle = atan2(y_mm - drawn->y, x_mm - drawn->x) - drawn->axis_rad;
  return drawn->mirror * remainder(angle, 2 * pi);
}

/* From the foil's own coordinates (middle along x) to the true ones. */
static fg_point turn_point(const fg_drawn_foil *drawn, double x, double y) {
  double c = cos(drawn->axis_rad), s = sin(drawn->axis_rad);
  y *= drawn->mirror;
  return (fg_point){c * x - s * y, s * x + c * y};
}

static void turn_segment(const fg_drawn_foil *drawn, fg_segment *segment) {
  fg_point at = turn_point(drawn, segment->x, segment->y);
  segment->x = at.x;
  segment->y = at.y;
  if (segment->line) {
    fg_point a = turn_point(drawn, segment->ax, segment->ay),
             b = turn_point(drawn, segment->bx, segment->by);
    segment->ax = a.x;
    segment->ay = a.y;
    segment->bx = b.x;
    segment->by = b.y;
    return;
  }
  segment->angle = drawn->axis_rad + drawn->mirror * segment->angle;
  segment->sweep *= drawn->mirror;
  segment->ax = cos(segment->angle);
  segment->ay = sin(segment->angle);
  segment->bx = cos(segment->angle + segment->sweep);
  segment->by = sin(segment->angle + segment->sweep);
  segment->mx = cos(segment->angle + 0.5 * segment->sweep);
  segment->my = sin(segment->angle + 0.5 * segment->sweep);
}

typedef struct box {
  double low[2], high[2];
} box;

static void box_add(box *b, double x, double y, double reach) {
  b->low[0] = fmin(b->low[0], x - reach);
  b->low[1] = fmin(b->low[1], y - reach);
  b->high[0] = fmax(b->high[0], x + reach);
  b->high[1] = fmax(b->high[1], y + reach);
}

static box foil_box(const fg_scene *scene, const fg_drawn_foil *drawn) {
  box b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (size_t i = 0; i < drawn->segment_count; i++) {
    const fg_segment *segment = &scene->segments[drawn->first_segment + i];
    int steps = 1 + (int)(segment->length_mm / 0.05);
    for (int k = 0; k <= steps; k++) {
      fg_point p = fg_segment_point(segment, segment->length_mm * k / steps);
      box_add(&b, p.x, p.y, drawn->half_thickness_mm);
    }
  }
  return b;
}

static void move_foil(fg_scene *scene, fg_drawn_foil *drawn, double x_mm, double y_mm) {
  drawn->x += x_mm;
  drawn->y += y_mm;
  for (size_t i = 0; i < drawn->segment_count; i++) {
    scene->segments[drawn->first_segment + i].x += x_mm;
    scene->segments[drawn->first_segment + i].y += y_mm;
  }
}

/* Foils without a place of their own fill shelves from the top; without a given width every shelf
 * holds one foil. */
typedef struct shelf {
  double x_px, y_px, height_px;
} shelf;

static void place_automatically(fg_render_spec *spec, fg_drawn_foil *drawn, const box *b,
                                size_t foil, shelf *at) {
  double margin = spec->margin_px;
  double width = (b->high[0] - b->low[0]) / spec->pixel_mm[0];
  double height = (b->high[1] - b->low[1]) / spec->pixel_mm[1];
  double limit = isnan(spec->width_px) ? 0 : spec->width_px;
  if (at->x_px > margin && at->x_px + width + margin > limit) {
    *at = (shelf){margin, at->y_px + at->height_px + margin, 0};
  }
  /* a random part of a pixel, so that no foil lies on the grid */
  fg_random random;
  fg_random_seed(&random, spec->seed, FG_STREAM_PLACE, foil);
  double dx = fg_random_uniform(&random), dy = fg_random_uniform(&random);
  move_foil(&spec->scene, drawn, (at->x_px + dx) * spec->pixel_mm[0] - b->low[0],
            (at->y_px + dy) * spec->pixel_mm[1] - b->low[1]);
  at->x_px += ceil(width + 1 + margin);
  at->height_px = fmax(at->height_px, ceil(height + 1));
}

static void finish_foil_truth(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                              fg_render_foil *foil) {
  foil->rotate_deg = remainder(drawn->axis_rad * 180 / pi, 360);
  foil->overall_centre_px = (fg_point){drawn->x / spec->pixel_mm[0], drawn->y / spec->pixel_mm[1]};
  fg_render_bump *bumps = (fg_render_bump *)foil->bumps;
  for (size_t i = 0; i < foil->bump_count; i++) {
    fg_point c = turn_point(drawn, bumps[i].centre_px.x, bumps[i].centre_px.y);
    bumps[i].centre_px =
        (fg_point){(drawn->x + c.x) / spec->pixel_mm[0], (drawn->y + c.y) / spec->pixel_mm[1]};
  }
  fg_render_beam *beams = (fg_render_beam *)foil->beams;
  for (size_t i = 0; i < foil->beam_count; i++) {
    fg_point *const ends[] = {&beams[i].root_px, &beams[i].tip_px};
    for (int k = 0; k < 2; k++) {
      fg_point p = turn_point(drawn, ends[k]->x, ends[k]->y);
      *ends[k] =
          (fg_point){(drawn->x + p.x) / spec->pixel_mm[0], (drawn->y + p.y) / spec->pixel_mm[1]};
    }
  }
}

static fg_status build_foil(const fg_place *place, fg_render_spec *spec,
                            const fg_foil_request *request, int copy, shelf *at, box *all) {
  fg_scene *scene = &spec->scene;
  size_t foil = scene->foil_count++;
  fg_drawn_foil *drawn = &scene->drawn[foil];
  drawn->axis_rad = (request->rotate_deg + copy * request->rotate_step_deg) * pi / 180;
  drawn->mirror = request->mirror ? -1 : 1;
  FG_TRY((request->design.cantilever ? fg_sheet_build : fg_outline_build)(place, spec, request,
                                                                          scene, foil));
  for (size_t i = 0; i < drawn->segment_count; i++)
    turn_segment(drawn, &scene->segments[drawn->first_segment + i]);
  box b = foil_box(scene, drawn);
  if (isnan(request->centre_mm[0]))
    place_automatically(spec, drawn, &b, foil, at);
  else
    move_foil(scene, drawn, request->centre_mm[0], request->centre_mm[1]);
  b = foil_box(scene, drawn);
  box_add(all, b.low[0], b.low[1], 0);
  box_add(all, b.high[0], b.high[1], 0);
  finish_foil_truth(spec, drawn, &scene->foils[foil]);
  return fg_roughness_build(place->ctx, spec, foil, drawn);
}

static fg_status build_foils(const fg_place *place, fg_render_spec *spec, box *all) {
  size_t count = 0;
  for (size_t i = 0; i < spec->request_count; i++)
    count += (size_t)spec->requests[i].repeat;
  if (count > FG_RENDER_FOILS_MAX)
    return fg_member_fail(place, "foils", NULL, "at most 4096 foils, copies counted");
  fg_scene *scene = &spec->scene;
  FG_TRY(fg_memory_allocate(place->ctx, count, sizeof *scene->drawn, (void **)&scene->drawn));
  FG_TRY(fg_memory_allocate(place->ctx, count, sizeof *scene->foils, (void **)&scene->foils));
  shelf at = {spec->margin_px, spec->margin_px, 0};
  for (size_t i = 0; i < spec->request_count; i++) {
    fg_place inner = fg_place_item(place, "foils", (int)i);
    for (int copy = 0; copy < spec->requests[i].repeat; copy++)
      FG_TRY(build_foil(&inner, spec, &spec->requests[i], copy, &at, all));
  }
  return FG_OK;
}

static fg_status build_discs(const fg_place *place, fg_render_spec *spec, box *all) {
  fg_scene *scene = &spec->scene;
  for (size_t i = 0; i < spec->disc_request_count; i++) {
    const fg_disc_request *request = &spec->disc_requests[i];
    double x = request->centre_mm[0], y = request->centre_mm[1];
    scene->shapes[scene->shape_count++] =
        (fg_shape){.x0 = x,
                   .y0 = y,
                   .x1 = x,
                   .y1 = y,
                   .radius = request->radius_mm,
                   .value = request->hole ? 0 : 1,
                   .lobes = request->lobes,
                   .lobe_mm = 1e-3 * request->lobe_um,
                   .lobe_phase_rad = request->lobe_phase_deg * pi / 180};
    FG_TRY(fg_roughness_build_disc(place->ctx, spec, i, &scene->shapes[scene->shape_count - 1]));
    scene->discs[scene->disc_count++] =
        (fg_render_disc){.centre_px = {x / spec->pixel_mm[0], y / spec->pixel_mm[1]},
                         .radius_mm = request->radius_mm,
                         .hole = request->hole};
    box_add(all, x, y, request->radius_mm);
  }
  return FG_OK;
}

static fg_status build_grids(const fg_place *place, fg_render_spec *spec, box *all) {
  double reach[2][2] = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  FG_TRY(fg_grids_build(place, spec, reach));
  for (int end = 0; end < 2 && spec->grid_request_count; end++)
    box_add(all, reach[end][0], reach[end][1], 0);
  return FG_OK;
}

/* Sizes vary from half to one and a half, contrast from half to full. */
static void scatter_litter(fg_render_spec *spec, const fg_litter *litter, fg_random_stream stream) {
  fg_random random;
  fg_random_seed(&random, spec->seed, stream, 0);
  double pixel = spec->pixel_mm[0];
  for (int i = 0; i < litter->count; i++) {
    double x = fg_random_uniform(&random) * spec->width_px * spec->pixel_mm[0];
    double y = fg_random_uniform(&random) * spec->height_px * spec->pixel_mm[1];
    double angle = fg_random_uniform(&random) * 2 * pi;
    double size = 0.5 + fg_random_uniform(&random);
    double strength = 0.5 + 0.5 * fg_random_uniform(&random);
    double length = litter->length_px * size * pixel;
    double lobes = fg_random_uniform(&random);
    double radius = litter->radius_px * pixel * (litter->length_px > 0 ? 1 : size);
    spec->scene.shapes[spec->scene.shape_count++] =
        (fg_shape){.x0 = x,
                   .y0 = y,
                   .x1 = x + length * cos(angle),
                   .y1 = y + length * sin(angle),
                   .radius = radius,
                   .value = strength * litter->contrast / spec->scanner.contrast,
                   .adds = true,
                   .lobes = litter->length_px > 0 ? 0 : 2 + (int)(3 * lobes),
                   .lobe_mm = litter->length_px > 0 ? 0 : 0.2 * radius,
                   .lobe_phase_rad = angle};
  }
}

int fg_scene_max_bumps(const fg_render_spec *spec) {
  int max = 0;
  for (size_t i = 0; i < spec->request_count; i++)
    if (spec->requests[i].design.bump_count > max) max = spec->requests[i].design.bump_count;
  return max;
}

/* Checks that every bump raised by its number exists on some foil. */
static fg_status check_lifts(const fg_place *place, const fg_render_spec *spec) {
  int max = fg_scene_max_bumps(spec);
  for (size_t i = 0; i < spec->effects.count; i++)
    if (spec->effects.effects[i].lift.last > max)
      return fg_fail(place->ctx, FG_ERR_DATA,
                     "%s: effects[%zu] raises bump %d: no foil has so many", place->path, i,
                     spec->effects.effects[i].lift.last);
  return FG_OK;
}

/* Refuses effects on a midline for a flat sheet, which has none. */
static fg_status check_sheets(const fg_place *place, const fg_render_spec *spec) {
  bool sheets = false;
  for (size_t i = 0; i < spec->request_count; i++)
    sheets = sheets || spec->requests[i].design.cantilever;
  for (size_t i = 0; sheets && i < spec->effects.count; i++) {
    const fg_render_effect *effect = &spec->effects.effects[i];
    if (effect->target != FG_RENDER_EFFECT_SCANNER && effect->target != FG_RENDER_EFFECT_STEP &&
        effect->target != FG_RENDER_EFFECT_EDGE)
      return fg_fail(place->ctx, FG_ERR_DATA,
                     "%s: effects[%zu] is %s: it moves the midline of a bent strip, and a "
                     "cantilever has none; draw it in a spec of its own",
                     place->path, i, effect->row->id);
  }
  return FG_OK;
}

static fg_status fit_size(const fg_place *place, fg_render_spec *spec, const box *all) {
  const char *names[2] = {"width_px", "height_px"};
  double *sizes[2] = {&spec->width_px, &spec->height_px};
  for (int axis = 0; axis < 2; axis++) {
    double need = all->high[axis] / spec->pixel_mm[axis] + spec->margin_px;
    if (axis == 1)
      need +=
          fg_jumps_rows_more(&spec->scanner.jumps) * spec->sensor.pixel_mm[1] / spec->pixel_mm[1];
    if (isnan(*sizes[axis])) *sizes[axis] = ceil(need);
    if (!(*sizes[axis] >= 16 && *sizes[axis] <= 200000))
      return fg_fail(place->ctx, FG_ERR_DATA,
                     "%s: %s would be %g to hold what is drawn: must be from 16 to 200000",
                     place->path, names[axis], *sizes[axis]);
    if (*sizes[axis] != floor(*sizes[axis]))
      return fg_fail(place->ctx, FG_ERR_DATA, "%s: %s is %g: must be a whole number", place->path,
                     names[axis], *sizes[axis]);
  }
  return FG_OK;
}

static void set_pixels(fg_render_spec *spec, int axis) {
  const fg_scanner *scanner = &spec->scanner;
  bool resampled = !isnan(scanner->sensor_dpi[axis]);
  spec->pixel_mm[axis] = 25.4 / scanner->dpi[axis];
  spec->sensor.pixel_mm[axis] = 25.4 / (resampled ? scanner->sensor_dpi[axis] : scanner->dpi[axis]);
}

fg_status fg_scene_build(const fg_place *place, fg_render_spec *spec) {
  fg_scene *scene = &spec->scene;
  const fg_scanner *scanner = &spec->scanner;
  for (int axis = 0; axis < 2; axis++)
    set_pixels(spec, axis);
  box all = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  FG_TRY(check_lifts(place, spec));
  FG_TRY(check_sheets(place, spec));
  FG_TRY(build_foils(place, spec, &all));
  size_t litter = (size_t)scanner->dust.count + (size_t)scanner->specks.count +
                  (size_t)scanner->scratches.count;
  FG_TRY(fg_memory_allocate(place->ctx, spec->disc_request_count + fg_grids_shapes(spec) + litter,
                            sizeof *scene->shapes, (void **)&scene->shapes));
  FG_TRY(fg_memory_allocate(place->ctx, spec->disc_request_count, sizeof *scene->discs,
                            (void **)&scene->discs));
  FG_TRY(build_discs(place, spec, &all));
  FG_TRY(build_grids(place, spec, &all));
  FG_TRY(fit_size(place, spec, &all));
  scatter_litter(spec, &scanner->dust, FG_STREAM_DUST);
  scatter_litter(spec, &scanner->specks, FG_STREAM_SPECKS);
  scatter_litter(spec, &scanner->scratches, FG_STREAM_SCRATCHES);
  const double size_mm[2] = {spec->width_px * spec->pixel_mm[0],
                             spec->height_px * spec->pixel_mm[1]};
  fg_render_effects_resolve(&spec->effects, size_mm[0], size_mm[1]);
  FG_TRY(
      fg_jumps_build(place, &scanner->jumps, spec->sensor.pixel_mm, size_mm, &spec->effects.jumps));
  for (size_t i = 0; i < scene->foil_count; i++)
    FG_TRY(fg_measurand_build(place->ctx, spec, i));
  spec->sensor.width_px =
      fg_resampling_need((int64_t)spec->width_px, spec->pixel_mm[0] / spec->sensor.pixel_mm[0]);
  spec->sensor.height_px =
      fg_resampling_need((int64_t)spec->height_px, spec->pixel_mm[1] / spec->sensor.pixel_mm[1]);
  spec->truth = (fg_render_truth){.width_px = (int64_t)spec->width_px,
                                  .height_px = (int64_t)spec->height_px,
                                  .bits = scanner->bits,
                                  .channels = scanner->colour.stated ? FG_COLOUR_LINES : 1,
                                  .dpi = {scanner->dpi[0], scanner->dpi[1]},
                                  .foils = scene->foils,
                                  .foil_count = scene->foil_count,
                                  .discs = scene->discs,
                                  .disc_count = scene->disc_count,
                                  .marks = scene->marks,
                                  .mark_count = scene->mark_count};
  return FG_OK;
}

void fg_scene_free(fg_scene *scene) {
  for (size_t i = 0; i < scene->foil_count; i++) {
    free((void *)scene->foils[i].bumps);
    free((void *)scene->foils[i].beams);
    free(scene->drawn[i].roughness[0]);
    free(scene->drawn[i].roughness[1]);
    free(scene->drawn[i].cut[0]);
    free(scene->drawn[i].cut[1]);
  }
  for (size_t i = 0; i < scene->shape_count; i++)
    free(scene->shapes[i].roughness);
  free(scene->segments);
  free(scene->drawn);
  free(scene->foils);
  free(scene->shapes);
  free(scene->discs);
  free(scene->marks);
  memset(scene, 0, sizeof *scene);
}

/* Unit vector to the strip's inner side. */
static fg_point inner_side(const fg_segment *segment, fg_point at) {
  if (segment->line) return (fg_point){segment->bx, segment->by};
  double scale = segment->side / segment->radius;
  return (fg_point){scale * (at.x - segment->x), scale * (at.y - segment->y)};
}

/* Point of the midline with the part's effects, and `edges_mm` more to its inner side. */
static fg_point move_point(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                           const fg_segment *segment, double t_mm, double edges_mm) {
  fg_point p = fg_segment_point(segment, t_mm), inner = inner_side(segment, p);
  double w = fg_segment_bump_shift(&spec->effects, segment, t_mm) + edges_mm;
  w -= fg_render_effects_shape(&spec->effects, FG_RENDER_EFFECT_NORMAL,
                               fg_foil_psi(drawn, p.x, p.y), drawn->half_span_rad);
  p.x += w * inner.x;
  p.y += w * inner.y;
  double dx = p.x - drawn->x, dy = p.y - drawn->y;
  double radial = fg_render_effects_shape(&spec->effects, FG_RENDER_EFFECT_PART,
                                          fg_foil_psi(drawn, p.x, p.y), drawn->half_span_rad);
  double outward = radial / hypot(dx, dy);
  return (fg_point){p.x + outward * dx, p.y + outward * dy};
}

fg_point fg_segment_part_point(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                               const fg_segment *segment, double t_mm) {
  return move_point(spec, drawn, segment, t_mm, 0);
}

fg_status fg_render_midline(fg_context *ctx, const fg_render_spec *spec, size_t foil, double s_mm,
                            fg_point *point_px) {
  const fg_scene *scene = &spec->scene;
  if (foil >= scene->foil_count || !(s_mm >= 0 && s_mm <= scene->drawn[foil].length_mm))
    return fg_fail(ctx, FG_ERR_USAGE, "there is no foil %zu with a midline of %g mm", foil, s_mm);
  const fg_drawn_foil *drawn = &scene->drawn[foil];
  if (drawn->sheet)
    return fg_fail(ctx, FG_ERR_USAGE, "foil %zu is a flat sheet: it has no midline", foil);
  size_t i = drawn->first_segment, last = i + drawn->segment_count - 1;
  while (i < last && s_mm > scene->segments[i].s_mm + scene->segments[i].length_mm)
    i++;
  const fg_segment *segment = &scene->segments[i];
  double t = s_mm - segment->s_mm;
  fg_point inner = inner_side(segment, fg_segment_point(segment, t));
  double shift[2];
  fg_render_effects_edges(&spec->effects, inner.x, inner.y, shift);
  fg_point p = move_point(spec, drawn, segment, t, 0.5 * (shift[0] + shift[1]));
  point_px->x = p.x / spec->pixel_mm[0];
  point_px->y = p.y / spec->pixel_mm[1];
  return FG_OK;
}
