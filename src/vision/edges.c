/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "vision/edge_spread.h"
#include "vision/edge_work.h"
#include "vision/ends.h"
#include "vision/picture.h"

/* Distance of stations, and half window of the reference line. Both are lengths of the foil, whose
 * fillets are 0.2 mm long: a line smoothed over more cuts the corner and bends the scale across.
 * Pixels set their lower limits. */
#define STEP_MM        0.022
#define STEP_MIN_PX    1.0
#define STEP_MAX_PX    2.0
#define SMOOTH_MM      0.32
#define SMOOTH_MIN_PX  8.0
#define SMOOTH_MAX_PX  30.0
#define BAND_BLURS     4.0 /* reach of the band beyond the strip's edges, in blurs */
#define BAND_MARGIN_PX 4.0 /* and the background beyond that */
#define BAND_MAX_PX    18.0
enum { SOLVE_ROUNDS = 2 };

/* Marks the ends. They are round and cut: within a width of them there is no edge of the strip's
 * side. */
static void mark_ends(fg_edge_work *work) {
  size_t count = work->reference->count;
  size_t margin = (size_t)((work->width_px + 2 * fmax(work->blur_px[0], work->blur_px[1])) /
                           work->reference->step_px);
  for (size_t i = 0; i < count; i++)
    if (i < margin || i + margin >= count) work->stations[i].weight = 0;
}

/* Scales the standard deviations by the scatter of neighbouring edges. It exceeds that of white
 * pixel noise when pixels are correlated or the edge itself is rough. The second difference of
 * three independent neighbours has the variance 1.5 u². */
static void scale_uncertainties(fg_edge_work *work) {
  double sum = 0, expected = 0;
  for (size_t i = 1; i + 1 < work->reference->count; i++) {
    const fg_edge_station *s = &work->stations[i];
    if (s[-1].weight <= 0 || s->weight <= 0 || s[1].weight <= 0) continue;
    for (int side = 0; side < 2; side++) {
      double d = s->edge_px[side] - 0.5 * (s[-1].edge_px[side] + s[1].edge_px[side]);
      if (fabs(d) > 8 * s->u_px[side] + 0.5) continue;
      sum += d * d;
      expected += 1.5 * (double)s->u_px[side] * s->u_px[side];
    }
  }
  double factor = expected > 0 ? sqrt(fmax(1, sum / expected)) : 1;
  for (size_t i = 0; i < work->reference->count; i++)
    for (int side = 0; side < 2; side++)
      work->stations[i].u_px[side] *= (float)factor;
}

/* Stations of the strip in mm. */
static void fill_stations(const fg_edge_work *work, const double dpi[2], fg_strip *strip) {
  double kx = 25.4 / dpi[0], ky = 25.4 / dpi[1], s_mm = 0;
  for (size_t i = 0; i < work->reference->count; i++) {
    const fg_reference_station *r = &work->reference->stations[i];
    const fg_edge_station *e = &work->stations[i];
    double nx = -r->ty, ny = r->tx;
    fg_station *out = &strip->stations[i];
    if (i > 0) s_mm += hypot((r->x - r[-1].x) * kx, (r->y - r[-1].y) * ky);
    const float *at = e->edge_px;
    double norm = hypot(nx / kx, ny / ky), scale = hypot(nx * kx, ny * ky) * 1000;
    *out = (fg_station){.s_mm = s_mm,
                        .left = {(r->x + at[0] * nx) * kx, (r->y + at[0] * ny) * ky},
                        .right = {(r->x + at[1] * nx) * kx, (r->y + at[1] * ny) * ky},
                        .normal = {nx / kx / norm, ny / ky / norm},
                        .u_left_um = e->weight > 0 ? (float)(e->u_px[0] * scale) : NAN,
                        .u_right_um = e->weight > 0 ? (float)(e->u_px[1] * scale) : NAN,
                        .weight = e->weight,
                        .facts = e->facts};
  }
}

/* Adds the segments' mean profiles to the spread, each side up to the strip's middle. */
static void add_strip_spread(const fg_edge_work *work, fg_strip *strip) {
  fg_edge_spread spread = {.sum = {0}};
  for (size_t k = 0; k < work->segment_count; k++) {
    const fg_profile_fit *fit = &work->segments[k].fit;
    if (!fit->good) continue;
    double middle = 0.5 * (fit->edge_px[0] + fit->edge_px[1]), rate;
    double inside = fg_edges_count(work, fmax(fit->shape.plateau, 0), &rate);
    for (size_t i = 0; i < work->bin_count; i++) {
      const fg_profile_bin *bin = &work->segments[k].bins[i];
      int side = bin->across_px > middle;
      double outside = fg_edges_count(work, fmax(fit->shape.level[side], 0), &rate);
      double inwards = side ? fit->edge_px[1] - bin->across_px : bin->across_px - fit->edge_px[0];
      double share = (bin->value - fmin(inside, outside)) / fabs(inside - outside);
      if (bin->count > 0)
        fg_edge_spread_add(&spread, inside > outside ? inwards : -inwards, share, bin->count);
    }
  }
  fg_edge_spread_measure(&spread, &strip->spread_px, &strip->asymmetry);
}

static fg_status summarise_strip(fg_context *ctx, const fg_edge_work *work, const double dpi[2],
                                 fg_strip *strip) {
  double um = 25400 / sqrt(dpi[0] * dpi[1]);
  FG_TRY(fg_strip_measure_thickness(ctx, strip));
  strip->step_mm = work->reference->step_px * um / 1000;
  strip->blur_left_um = work->blur_px[0] * um;
  strip->blur_right_um = work->blur_px[1] * um;
  strip->contrast = work->contrast / 255;
  strip->noise = work->noise / 255;
  fg_edges_describe_driver(work, &strip->picture);
  strip->gamma = work->gamma;
  strip->u_gamma = work->u_gamma;
  add_strip_spread(work, strip);
  strip->bright = work->bright;
  strip->tone_um = work->tone_px * um;
  if (work->clipped) strip->facts |= FG_STRIP_CLIPPED;
  if (work->side_band) strip->facts |= FG_STRIP_SIDE_BAND;
  return FG_OK;
}

static void find_box(const fg_reference *reference, fg_strip *strip) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < reference->count; i++) {
    const double at[2] = {reference->stations[i].x, reference->stations[i].y};
    for (int axis = 0; axis < 2; axis++) {
      low[axis] = fmin(low[axis], at[axis]);
      high[axis] = fmax(high[axis], at[axis]);
    }
  }
  for (int axis = 0; axis < 2; axis++) {
    strip->box_px[axis] = (int64_t)floor(low[axis]);
    strip->box_px[2 + axis] = (int64_t)ceil(high[axis] - low[axis]) + 1;
  }
}

static fg_status allocate_work(fg_context *ctx, fg_edge_work *work) {
  size_t count = work->reference->count;
  work->chunk_count = (count + FG_CHUNK_STATIONS - 1) / FG_CHUNK_STATIONS;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *work->stations, (void **)&work->stations));
  if (!work->borrowed)
    FG_TRY(fg_memory_allocate(ctx, work->chunk_count, sizeof *work->bands, (void **)&work->bands));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->tables, (void **)&work->tables));
  fg_edge_tables_init(work->tables, 1);
  return FG_OK;
}

static void free_work(fg_edge_work *work) {
  for (size_t i = 0; work->bands && !work->borrowed && i < work->chunk_count; i++)
    fg_pixel_band_free(&work->bands[i]);
  if (!work->borrowed) free(work->bands);
  free(work->stations);
  free(work->segments);
  free(work->bins);
  free(work->tables);
  fg_edges_free_driver(work);
}

/* Solves again without disturbed stations: an object on the strip has bent the shape of a whole
 * segment, too. */
static fg_status solve_again(fg_context *ctx, fg_edge_work *work, size_t *disturbed) {
  FG_TRY(fg_edges_repeat_shape(ctx, work));
  FG_TRY(fg_edges_solve(ctx, work, SOLVE_ROUNDS));
  return fg_edges_drop_disturbed(ctx, work, disturbed);
}

static fg_status measure_edges(fg_context *ctx, fg_edge_work *work, unsigned *facts) {
  size_t disturbed;
  if (!work->fitted) FG_TRY(fg_edges_collect(ctx, work));
  FG_TRY(fg_edges_find_shape(ctx, work));
  FG_TRY(fg_edges_solve(ctx, work, SOLVE_ROUNDS));
  FG_TRY(fg_edges_drop_disturbed(ctx, work, &disturbed));
  if (disturbed) FG_TRY(solve_again(ctx, work, &disturbed));
  if (disturbed) FG_TRY(fg_edges_name_defect(ctx, work, facts));
  mark_ends(work);
  scale_uncertainties(work);
  return FG_OK;
}

static double length_px(double mm, const double dpi[2], double min_px, double max_px) {
  return fmin(fmax(mm * sqrt(dpi[0] * dpi[1]) / 25.4, min_px), max_px);
}

static fg_status build_reference(fg_context *ctx, const fg_trace *trace, const double dpi[2],
                                 fg_reference *reference) {
  double smooth_px = length_px(SMOOTH_MM, dpi, SMOOTH_MIN_PX, SMOOTH_MAX_PX);
  double step_px = length_px(STEP_MM, dpi, STEP_MIN_PX, STEP_MAX_PX);
  return fg_reference_build(ctx, trace->points, trace->count, smooth_px, step_px, reference);
}

static fg_edge_work begin_work(const fg_tiles *tiles, const fg_segmentation *segmentation,
                               const fg_trace *trace, const fg_reference *reference,
                               const fg_edge_options *options) {
  return (fg_edge_work){.tiles = tiles,
                        .segmentation = segmentation,
                        .trace = trace,
                        .reference = reference,
                        .threads = options->threads,
                        .linear = options->linear,
                        .keeps_start = options->plain,
                        .width_px = trace->width_px,
                        .reach_px = fmin(BAND_BLURS * trace->blur_px + BAND_MARGIN_PX, BAND_MAX_PX),
                        .noise = 1,
                        .gamma = 1,
                        .u_driver_px = NAN,
                        .contrast = trace->contrast};
}

static void copy_plain(const fg_edge_work *work, const fg_strip *from, const double dpi[2],
                       fg_strip *strip) {
  double um = 25400 / sqrt(dpi[0] * dpi[1]);
  strip->plain_mm = from->thickness_mm;
  strip->plain_blur_um = 0.5 * (work->blur_px[0] + work->blur_px[1]) * um;
  strip->plain_counts = work->contrast;
  strip->plain_side_band = work->side_band;
}

/* Measures the strip once more with counts used as light. */
static fg_status find_plain(fg_context *ctx, const fg_edge_work *model,
                            const fg_edge_options *options, fg_strip *strip) {
  fg_edge_work fresh =
      begin_work(model->tiles, model->segmentation, model->trace, model->reference, options);
  fg_edge_work *work = model->start ? model->start : &fresh;
  fg_strip plain = {0};
  unsigned facts = 0;
  fg_status status = FG_OK;
  work->linear = work->plain = work->borrowed = true;
  work->bands = model->bands;
  if (!work->fitted) FG_TRY_EXIT(allocate_work(ctx, work));
  FG_TRY_EXIT(fg_memory_allocate(ctx, model->reference->count, sizeof *plain.stations,
                                 (void **)&plain.stations));
  plain.count = model->reference->count;
  FG_TRY_EXIT(measure_edges(ctx, work, &facts));
  fill_stations(work, options->dpi, &plain);
  FG_TRY_EXIT(fg_strip_measure_thickness(ctx, &plain));
  copy_plain(work, &plain, options->dpi, strip);
exit:
  if (!work->fitted) free_work(work);
  fg_strip_free(&plain);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* The last steps, which do not need each other. */
typedef struct last_steps {
  const fg_edge_work *work;
  const fg_edge_options *options;
  fg_strip *strip;
} last_steps;

enum { PLACE_STRIP, SEE_PICTURE, FIND_PLAIN, LAST_STEPS };

static fg_status take_last_step(fg_context *ctx, void *shared, size_t step) {
  const last_steps *steps = shared;
  fg_strip *strip = steps->strip;
  if (step == FIND_PLAIN) return find_plain(ctx, steps->work, steps->options, strip);
  if (step == SEE_PICTURE) return fg_picture_of_strip(ctx, steps->work, &strip->picture);
  strip->count = steps->work->reference->count;
  fill_stations(steps->work, steps->options->dpi, strip);
  find_box(steps->work->reference, strip);
  fg_ends_measure(steps->work, steps->options->dpi, strip);
  return FG_OK;
}

/* Describes the measured strip. */
static fg_status finish_strip(fg_context *ctx, const fg_edge_work *work,
                              const fg_edge_options *options, fg_strip *strip) {
  last_steps steps = {work, options, strip};
  bool is_plain = work->gamma == 1 && !work->driver;
  size_t count = !is_plain && options->plain ? LAST_STEPS : FIND_PLAIN;
  FG_TRY(fg_parallel_run(ctx, options->threads, count, take_last_step, &steps));
  FG_TRY(summarise_strip(ctx, work, options->dpi, strip));
  if (is_plain) copy_plain(work, strip, options->dpi, strip);
  return FG_OK;
}

fg_status fg_edges_measure(fg_context *ctx, const fg_tiles *tiles,
                           const fg_segmentation *segmentation, const fg_trace *trace,
                           const fg_edge_options *options, fg_strip *strip) {
  const double *dpi = options->dpi;
  fg_reference reference = {0};
  fg_edge_work work = begin_work(tiles, segmentation, trace, &reference, options);
  fg_status status = FG_OK;
  FG_TRY_EXIT(build_reference(ctx, trace, dpi, &reference));
  FG_TRY_EXIT(allocate_work(ctx, &work));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, reference.count, sizeof *strip->stations, (void **)&strip->stations));
  strip->facts = trace->facts;
  strip->picture = fg_picture_unknown();
  FG_TRY_EXIT(measure_edges(ctx, &work, &strip->facts));
  strip->plain_mm = strip->plain_blur_um = strip->plain_counts = NAN;
  FG_TRY_EXIT(finish_strip(ctx, &work, options, strip));
exit:
  fg_reference_free(&reference);
  if (work.start) free_work(work.start);
  free(work.start);
  free_work(&work);
  if (status != FG_OK) fg_strip_free(strip);
  return status;
}
