/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of the segments and shapes near each block of 8 × 8 pixels, for one band of rows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "render/sampler.h"

static size_t thing_count(const fg_sampler *sampler) {
  return sampler->spec->scene.segment_count + sampler->spec->scene.shape_count;
}

/* Place of a true position in the picture: p + d(p) = P, by iteration (d is small and smooth;
 * blocks are marked with a margin). Pixels. */
static fg_point nominal_px(const fg_sampler *sampler, double x, double y) {
  double px = x, py = y, d[2];
  for (int i = 0; sampler->has_field && i < 3; i++) {
    fg_render_effects_field(&sampler->spec->effects, px, py, (double[]){px, py}, d);
    px = x - d[0];
    py = y - d[1];
  }
  return (fg_point){px / sampler->pixel_mm[0], py / sampler->pixel_mm[1]};
}

/* Reach in pixels, with margin for the step between marks and for jumps of a field. */
static double reach_px(const fg_sampler *sampler, double half_width_mm, double reach_mm) {
  double pixel = fmin(sampler->pixel_mm[0], sampler->pixel_mm[1]);
  double field = fg_jumps_reach_mm(&sampler->spec->effects.jumps);
  for (size_t i = 0; i < sampler->spec->effects.count; i++)
    if (sampler->spec->effects.effects[i].row->target == FG_RENDER_EFFECT_STEP)
      field += 1e-3 * fabs(sampler->spec->effects.effects[i].p[0]);
  return (half_width_mm + reach_mm + field) / pixel + 3;
}

static void shape_box(const fg_sampler *sampler, const fg_shape *shape, double box_px[4]) {
  double half = shape->radius + fabs(shape->lobe_mm);
  double reach = reach_px(sampler, half + (sampler->has_field ? 0.1 * half : 0),
                          sampler->edge_reach_mm + (shape->adds ? 0 : sampler->disc_band_mm));
  fg_point a = nominal_px(sampler, shape->x0, shape->y0);
  fg_point b = nominal_px(sampler, shape->x1, shape->y1);
  box_px[0] = fmin(a.x, b.x) - reach;
  box_px[1] = fmin(a.y, b.y) - reach;
  box_px[2] = fmax(a.x, b.x) + reach;
  box_px[3] = fmax(a.y, b.y) + reach;
}

enum { MARK_STEP_PX = 4 };

static int mark_steps(const fg_sampler *sampler, const fg_segment *segment) {
  return 1 + (int)(segment->length_mm / (MARK_STEP_PX * sampler->pixel_mm[0]));
}

static fg_point mark_point(const fg_sampler *sampler, const fg_segment *segment, int k, int steps) {
  fg_point p = fg_segment_point(segment, segment->length_mm * k / steps);
  return nominal_px(sampler, p.x, p.y);
}

/* Reach of a segment. The outlines of a sheet are marked over a block's diagonal more: a block
 * without any of them in its list is away from all, and wholly inside or outside. */
static double segment_reach_px(const fg_sampler *sampler, const fg_segment *segment) {
  const fg_drawn_foil *drawn = &sampler->spec->scene.drawn[segment->foil];
  return reach_px(sampler, drawn->half_thickness_mm, sampler->reach_mm) +
         (drawn->sheet ? 1.5 * FG_BLOCK_PX : 0);
}

static void find_spans(const fg_sampler *sampler, fg_band *band) {
  const fg_scene *scene = &sampler->spec->scene;
  for (size_t i = 0; i < scene->segment_count; i++) {
    const fg_segment *segment = &scene->segments[i];
    int steps = mark_steps(sampler, segment);
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k <= steps; k++) {
      double y = mark_point(sampler, segment, k, steps).y;
      low = fmin(low, y);
      high = fmax(high, y);
    }
    double reach = segment_reach_px(sampler, segment);
    band->spans_px[i][0] = low - reach;
    band->spans_px[i][1] = high + reach;
  }
  for (size_t i = 0; i < scene->shape_count; i++) {
    double box[4];
    shape_box(sampler, &scene->shapes[i], box);
    band->spans_px[scene->segment_count + i][0] = box[1];
    band->spans_px[scene->segment_count + i][1] = box[3];
  }
}

fg_status fg_band_create(fg_context *ctx, const fg_sampler *sampler, int64_t rows_px,
                         int64_t margin_px, fg_band *band) {
  *band = (fg_band){0};
  int64_t width = sampler->spec->sensor.width_px;
  band->columns = (width + 2 * margin_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX + 1;
  band->rows = (rows_px + 2 * margin_px) / FG_BLOCK_PX + 1;
  band->column0 = -margin_px / FG_BLOCK_PX;
  FG_TRY(fg_memory_allocate(ctx, (size_t)band->columns * (size_t)band->rows, sizeof *band->heads,
                            (void **)&band->heads));
  FG_TRY(fg_memory_allocate(ctx, (size_t)band->columns * (size_t)band->rows, sizeof *band->filled,
                            (void **)&band->filled));
  FG_TRY(fg_memory_allocate(ctx, thing_count(sampler), sizeof *band->spans_px,
                            (void **)&band->spans_px));
  find_spans(sampler, band);
  return FG_OK;
}

void fg_band_free(fg_band *band) {
  free(band->heads);
  free(band->filled);
  free(band->nodes);
  free(band->spans_px);
  *band = (fg_band){0};
}

/* Marks the blocks that the box touches. All blocks of a thing are marked in one go, so a block
 * that has it already has it at its head. */
static fg_status mark_blocks(fg_context *ctx, fg_band *band, const double box_px[4], size_t id) {
  int64_t x0 = (int64_t)floor(box_px[0] / FG_BLOCK_PX) - band->column0;
  int64_t y0 = (int64_t)floor(box_px[1] / FG_BLOCK_PX) - band->row0;
  int64_t x1 = (int64_t)floor(box_px[2] / FG_BLOCK_PX) - band->column0;
  int64_t y1 = (int64_t)floor(box_px[3] / FG_BLOCK_PX) - band->row0;
  if (x0 < 0) x0 = 0;
  if (y0 < 0) y0 = 0;
  if (x1 >= band->columns) x1 = band->columns - 1;
  if (y1 >= band->rows) y1 = band->rows - 1;
  for (int64_t y = y0; y <= y1; y++)
    for (int64_t x = x0; x <= x1; x++) {
      int32_t *head = &band->heads[y * band->columns + x];
      if (*head >= 0 && band->nodes[*head].id == id) continue;
      FG_TRY(fg_memory_reserve(ctx, band->node_count + 1, sizeof *band->nodes, &band->node_capacity,
                               (void **)&band->nodes));
      band->nodes[band->node_count] = (fg_band_node){(uint32_t)id, *head};
      *head = (int32_t)band->node_count++;
    }
  return FG_OK;
}

static fg_status mark_segment(fg_context *ctx, const fg_sampler *sampler, size_t id,
                              fg_band *band) {
  const fg_segment *segment = &sampler->spec->scene.segments[id];
  double reach = segment_reach_px(sampler, segment);
  int steps = mark_steps(sampler, segment);
  double top = (double)band->row0 * FG_BLOCK_PX - reach;
  double bottom = (double)(band->row0 + band->rows) * FG_BLOCK_PX + reach;
  for (int k = 0; k <= steps; k++) {
    fg_point p = mark_point(sampler, segment, k, steps);
    if (p.y < top || p.y > bottom) continue;
    double box[4] = {p.x - reach, p.y - reach, p.x + reach, p.y + reach};
    FG_TRY(mark_blocks(ctx, band, box, id));
  }
  return FG_OK;
}

static bool lists_foil(const fg_band *band, const fg_scene *scene, int32_t at, size_t foil) {
  for (; at >= 0; at = band->nodes[at].next)
    if (band->nodes[at].id < scene->segment_count &&
        scene->segments[band->nodes[at].id].foil == foil)
      return true;
  return false;
}

/* A block's middle in true coordinates. */
static fg_point true_middle(const fg_sampler *sampler, const fg_band *band, int64_t x, int64_t y) {
  double mm[2] = {((double)(x + band->column0) + 0.5) * FG_BLOCK_PX * sampler->pixel_mm[0],
                  ((double)(y + band->row0) + 0.5) * FG_BLOCK_PX * sampler->pixel_mm[1]};
  double d[2] = {0, 0};
  if (sampler->has_field) fg_render_effects_field(&sampler->spec->effects, mm[0], mm[1], mm, d);
  return (fg_point){mm[0] + d[0], mm[1] + d[1]};
}

/* Fills a row of blocks: inside and outside change only across blocks that list the outlines. */
static void fill_sheet_row(const fg_sampler *sampler, size_t foil, int64_t y, fg_band *band) {
  const fg_scene *scene = &sampler->spec->scene;
  bool known = false, inside = false;
  for (int64_t x = 0; x < band->columns; x++) {
    int64_t block = y * band->columns + x;
    if (lists_foil(band, scene, band->heads[block], foil)) {
      known = false;
      continue;
    }
    if (!known) {
      fg_point p = true_middle(sampler, band, x, y);
      inside = fg_sheet_inside(scene, &scene->drawn[foil], p.x, p.y);
    }
    known = true;
    if (inside) band->filled[block] = true;
  }
}

static void fill_sheets(const fg_sampler *sampler, fg_band *band) {
  const fg_scene *scene = &sampler->spec->scene;
  memset(band->filled, 0, (size_t)(band->columns * band->rows) * sizeof *band->filled);
  for (size_t foil = 0; foil < scene->foil_count; foil++) {
    const fg_drawn_foil *drawn = &scene->drawn[foil];
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; drawn->sheet && i < drawn->segment_count; i++) {
      low = fmin(low, band->spans_px[drawn->first_segment + i][0]);
      high = fmax(high, band->spans_px[drawn->first_segment + i][1]);
    }
    for (int64_t y = 0; y < band->rows; y++) {
      double top = (double)(y + band->row0) * FG_BLOCK_PX;
      if (top + FG_BLOCK_PX >= low && top <= high) fill_sheet_row(sampler, foil, y, band);
    }
  }
}

fg_status fg_band_fill(fg_context *ctx, const fg_sampler *sampler, int64_t y0_px, int64_t margin_px,
                       fg_band *band) {
  const fg_scene *scene = &sampler->spec->scene;
  band->row0 = (y0_px - margin_px) / FG_BLOCK_PX;
  band->node_count = 0;
  for (int64_t i = 0; i < band->columns * band->rows; i++)
    band->heads[i] = -1;
  double top = (double)band->row0 * FG_BLOCK_PX;
  double bottom = top + (double)band->rows * FG_BLOCK_PX;
  for (size_t i = 0; i < thing_count(sampler); i++) {
    if (band->spans_px[i][1] < top || band->spans_px[i][0] > bottom) continue;
    if (i < scene->segment_count) {
      FG_TRY(mark_segment(ctx, sampler, i, band));
    } else {
      double box[4];
      shape_box(sampler, &scene->shapes[i - scene->segment_count], box);
      FG_TRY(mark_blocks(ctx, band, box, i));
    }
  }
  fill_sheets(sampler, band);
  return FG_OK;
}

void fg_band_gather(const fg_band *band, int64_t block_x, int64_t block_y, fg_near *near) {
  near->count = 0;
  near->filled = false;
  int64_t x = block_x - band->column0, y = block_y - band->row0;
  if (x < 0 || y < 0 || x >= band->columns || y >= band->rows) return;
  near->filled = band->filled[y * band->columns + x];
  for (int32_t at = band->heads[y * band->columns + x]; at >= 0; at = band->nodes[at].next) {
    /* The list runs from the last thing to the first. */
    if (near->count == FG_NEAR_MAX) {
      near->count--;
      memmove(near->ids, near->ids + 1, near->count * sizeof *near->ids);
    }
    near->ids[near->count++] = band->nodes[at].id;
  }
  for (size_t i = 0; i < near->count / 2; i++) {
    size_t other = near->count - 1 - i, id = near->ids[i];
    near->ids[i] = near->ids[other];
    near->ids[other] = id;
  }
}

bool fg_band_any(const fg_band *band, int64_t x0, int64_t y0, int64_t x1, int64_t y1) {
  for (int64_t y = y0 - band->row0; y <= y1 - band->row0; y++)
    for (int64_t x = x0 - band->column0; x <= x1 - band->column0; x++)
      if (x >= 0 && y >= 0 && x < band->columns && y < band->rows &&
          (band->heads[y * band->columns + x] >= 0 || band->filled[y * band->columns + x]))
        return true;
  return false;
}
