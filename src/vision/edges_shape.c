/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of the edges along a strip: mean profiles of segments, and their fits. */
#include "vision/edge_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"

#define BIN_PX 0.25
/* Limit of a pixel of the background that is no dust: noise sd plus a share of the contrast. */
#define FOREIGN_SIGMAS 4.0
#define FOREIGN_SHARE  0.01
enum {
  GAMMA_SEGMENTS = 8, /* number of profiles in the tone curve's fit */
};
/* Pixels are clipped when more than this share of them has one value, twice as many as the next,
 * and less than that share lies beyond. */
#define PILE_SHARE  0.05
#define PILE_BEYOND 0.002
#define LEVEL_SHARE 1e-4

static fg_status allocate_segments(fg_context *ctx, fg_edge_work *work) {
  if (work->segments) return FG_OK;
  double half = work->width_px / 2 + work->reach_px;
  work->segment_count = (work->reference->count + FG_SEGMENT_STATIONS - 1) / FG_SEGMENT_STATIONS;
  work->bin_count = (size_t)(2 * half / BIN_PX) + 1;
  FG_TRY(fg_memory_allocate(ctx, work->segment_count, sizeof *work->segments,
                            (void **)&work->segments));
  FG_TRY(fg_memory_allocate(ctx, work->segment_count * work->bin_count, sizeof *work->bins,
                            (void **)&work->bins));
  for (size_t i = 0; i < work->segment_count; i++)
    work->segments[i].bins = work->bins + i * work->bin_count;
  return FG_OK;
}

/* Returns true when a pixel lies outside the reach of the edges' fit and differs from the
 * background there. */
static bool is_foreign(const fg_edge_work *work, const fg_edge_station *s, float across_px,
                       float value) {
  float left = s->edge_px[0] - across_px, right = across_px - s->edge_px[1];
  int side = right > left;
  float d = side ? right : left, model, rate;
  float blur = s->blur_px[side];
  if (d < (float)FG_REACH_BLURS * blur) return false;
  if (work->driver) blur = hypotf(blur, (float)work->driver->values[FG_DRIVER_RADIUS]);
  if (d < (float)FG_REACH_BLURS * blur) return false;
  fg_edge_tone(work->tables, s->plateau + s->step[side] + s->slope[side] * d, &model, &rate);
  return fabs(value - model) > FOREIGN_SIGMAS * work->noise + FOREIGN_SHARE * work->contrast;
}

/* Adds a station's pixels to the bins of its segment. */
static void stack_station(const fg_edge_work *work, const fg_pixel_band *band, size_t k,
                          fg_profile_bin *bins) {
  const fg_edge_station *s = &work->stations[band->first + k];
  double half = work->width_px / 2 + work->reach_px;
  if (work->again && s->facts & FG_STATION_DISTURBED) return;
  for (size_t i = band->begin[k]; i < band->begin[k + 1]; i++) {
    float across_px = band->across_px[i], value = band->value[i];
    if (work->again && is_foreign(work, s, across_px, value)) continue;
    double across = across_px - s->middle_px;
    double at = (across + half) * (1 / BIN_PX);
    if (at < 0 || at >= (double)work->bin_count) continue;
    fg_profile_bin *bin = &bins[(size_t)at];
    bin->across_px += across;
    bin->value += value;
    bin->count += 1;
  }
}

/* Mean profiles of the segments of one chunk, across from the stations' middles. */
static void stack_chunk(const fg_edge_work *work, size_t chunk) {
  size_t first = chunk * FG_CHUNK_SEGMENTS, last = first + FG_CHUNK_SEGMENTS;
  if (last > work->segment_count) last = work->segment_count;
  fg_profile_bin *bins = work->bins + first * work->bin_count;
  size_t count = (last - first) * work->bin_count;
  memset(bins, 0, count * sizeof *bins);
  const fg_pixel_band *band = &work->bands[chunk];
  for (size_t k = 0; k < band->stations; k++)
    stack_station(work, band, k, work->segments[first + k / FG_SEGMENT_STATIONS].bins);
  for (size_t i = 0; i < count; i++) {
    if (bins[i].count <= 0) continue;
    bins[i].across_px /= bins[i].count;
    bins[i].value /= bins[i].count;
  }
}

/* A start for the fit: levels from the ends and the middle of the profile. */
static void start_fit(const fg_edge_work *work, const fg_segment_profile *s, fg_profile_fit *fit) {
  double level[3] = {0}, weight[3] = {0};
  double half = work->width_px / 2;
  for (size_t i = 0; i < work->bin_count; i++) {
    const fg_profile_bin *b = &s->bins[i];
    int where = b->across_px < -half - 6 ? 0 : b->across_px > half + 6 ? 2 : 1;
    if (where == 1 && fabs(b->across_px) > half / 3) continue;
    level[where] += b->value * b->count;
    weight[where] += b->count;
  }
  for (int i = 0; i < 3; i++)
    level[i] = weight[i] > 0 ? level[i] / weight[i] : 0;
  memset(fit, 0, sizeof *fit);
  fit->shape =
      (fg_edge_shape){.plateau = fg_edges_light(work, level[1]),
                      .level = {fg_edges_light(work, level[0]), fg_edges_light(work, level[2])},
                      .blur_px = {1.5, 1.5}};
  fit->edge_px[0] = -half;
  fit->edge_px[1] = half;
  fit->gamma = work->gamma;
}

static fg_status stack_task(fg_context *ctx, void *shared, size_t chunk) {
  (void)ctx;
  stack_chunk(shared, chunk);
  return FG_OK;
}

static fg_status fit_task(fg_context *ctx, void *shared, size_t i) {
  fg_edge_work *work = shared;
  fg_segment_profile *s = &work->segments[i];
  size_t first, count;
  fg_edges_reach(work, s, &first, &count);
  start_fit(work, s, &s->fit);
  if (work->driver) return fg_edges_fit_driven(ctx, work, s);
  fg_profile_fit_model(work->tables, s->bins + first, count, 0, &s->fit);
  return FG_OK;
}

/* The tone curve from one of a few profiles spread along the strip. */
typedef struct tone_task {
  fg_edge_work *work;
  fg_profile_fit fits[GAMMA_SEGMENTS];
} tone_task;

static fg_status fit_tone(fg_context *ctx, void *shared, size_t i) {
  (void)ctx;
  tone_task *task = shared;
  fg_edge_work *work = task->work;
  size_t at = (i + 1) * work->segment_count / (GAMMA_SEGMENTS + 1);
  fg_profile_fit *fit = &task->fits[i];
  const fg_segment_profile *s = &work->segments[at];
  start_fit(work, s, fit);
  fg_profile_fit_model(work->tables, s->bins, work->bin_count, 0, fit);
  if (fit->good) fg_profile_fit_model(work->tables, s->bins, work->bin_count, 1, fit);
  return FG_OK;
}

/* Numbers of a strip's pixels by value. */
typedef struct value_counts {
  size_t of[256], total;
} value_counts;

/* Number of pixels of one value, to less than a step of 16 bits: the outermost within a count of
 * `end`. */
static size_t count_equal(const fg_edge_work *work, int end, bool high) {
  double outermost = high ? -INFINITY : INFINITY;
  size_t count = 0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t c = 0; c < work->chunk_count; c++)
      for (size_t i = 0; i < work->bands[c].count; i++) {
        double value = work->bands[c].value[i];
        if ((int)(value + 0.5) != end) continue;
        if (pass)
          count += fabs(value - outermost) < 0.002;
        else
          outermost = high ? fmax(outermost, value) : fmin(outermost, value);
      }
  return count;
}

static bool piles_up(const fg_edge_work *work, const value_counts *counts, bool high) {
  size_t seen = 0;
  int step = high ? -1 : 1, end = high ? 255 : 0;
  while (end + step >= 0 && end + step <= 255 &&
         (double)(seen + counts->of[end]) < PILE_BEYOND * (double)counts->total) {
    seen += counts->of[end];
    end += step;
  }
  if (end + step < 0 || end + step > 255) return false;
  double min = PILE_SHARE * (double)counts->total;
  return (double)counts->of[end] > min && counts->of[end] > 2 * counts->of[end + step] &&
         (double)count_equal(work, end, high) > min;
}

/* Returns true when values pile up at one end of the strip's pixels, wherever the scanner's driver
 * cut them off. In a picture without noise both ends do. */
static bool find_clipping(const fg_edge_work *work, const value_counts *counts) {
  return counts->total && piles_up(work, counts, true) != piles_up(work, counts, false);
}

typedef struct count_task {
  const fg_edge_work *work;
  value_counts *chunks;
} count_task;

static fg_status count_chunk(fg_context *ctx, void *shared, size_t chunk) {
  const count_task *task = shared;
  const fg_pixel_band *band = &task->work->bands[chunk];
  value_counts *counts = &task->chunks[chunk];
  (void)ctx;
  for (size_t i = 0; i < band->count; i++) {
    float value = band->value[i];
    value = value > 0 ? value : 0;
    counts->of[(int)((value < 255 ? value : 255) + 0.5f)]++;
  }
  counts->total = band->count;
  return FG_OK;
}

static fg_status count_values(fg_context *ctx, const fg_edge_work *work, value_counts *counts) {
  count_task task = {.work = work};
  FG_TRY(fg_memory_allocate(ctx, work->chunk_count, sizeof *task.chunks, (void **)&task.chunks));
  fg_status status = fg_parallel_run(ctx, work->threads, work->chunk_count, count_chunk, &task);
  for (size_t c = 0; c < work->chunk_count; c++) {
    for (int i = 0; i < 256; i++)
      counts->of[i] += task.chunks[c].of[i];
    counts->total += task.chunks[c].total;
  }
  free(task.chunks);
  return status;
}

/* Returns the mean distance of the counts in use; values of too few pixels are dust's. */
static double find_level_step(const value_counts *counts) {
  int first = -1, last = -1, used = 0;
  for (int i = 0; i < 256; i++) {
    if (!((double)counts->of[i] > LEVEL_SHARE * (double)counts->total)) continue;
    if (first < 0) first = i;
    last = i;
    used++;
  }
  return used > 1 ? (double)(last - first) / (used - 1) : 1;
}

/* Uncertainty of gamma = 1 beside a halo, a wall or a clipped level, which hide gamma. */
#define GAMMA_U 0.4

/* Finds gamma from a few profiles; 1 when it does not differ from 1 by more than its uncertainty.
 * Only the middle of the sorted values counts: a profile with a fillet or dust has no vote. */
static fg_status find_gamma(fg_context *ctx, fg_edge_work *work) {
  tone_task task = {.work = work};
  double values[GAMMA_SEGMENTS], u = 0;
  int count = 0;
  value_counts pixels = {.total = 0};
  FG_TRY(count_values(ctx, work, &pixels));
  work->gamma = 1;
  /* A clipped level looks like a tone curve, and so does a staircase. */
  work->clipped = find_clipping(work, &pixels);
  work->level_step = find_level_step(&pixels);
  if (work->linear) return FG_OK;
  FG_TRY(fg_parallel_run(ctx, work->threads, GAMMA_SEGMENTS, fit_tone, &task));
  for (int i = 0; i < GAMMA_SEGMENTS; i++) {
    if (!task.fits[i].good) continue;
    int j = count++;
    for (; j > 0 && values[j - 1] > task.fits[i].gamma; j--)
      values[j] = values[j - 1];
    values[j] = task.fits[i].gamma;
    u += task.fits[i].u_gamma;
  }
  work->u_gamma = GAMMA_U;
  if (count >= 3 && !work->clipped && work->level_step < FG_LEVEL_STEP_MAX) {
    double gamma = values[count / 2], spread = values[count * 3 / 4] - values[count / 4];
    double uncertainty = fmax(u / count, spread) / sqrt(count);
    if (fabs(gamma - 1) > fmax(3 * uncertainty, 0.02)) work->gamma = fmin(fmax(gamma, 0.33), 3.5);
    work->u_gamma = hypot(uncertainty, gamma - work->gamma);
  }
  if (work->gamma != 1) fg_edge_tables_init(work->tables, work->gamma);
  return FG_OK;
}

/* Moves the stations' middles to those of the fitted edges, which are more accurate than the
 * threshold's. */
static void move_middles(fg_edge_work *work) {
  enum { REACH = 4 };
  size_t count = work->reference->count;
  for (size_t i = 0; i < count; i++) {
    double sum = 0, good = 0;
    for (size_t k = i > REACH ? i - REACH : 0; k <= i + REACH && k < count; k++) {
      const fg_edge_station *s = &work->stations[k];
      if (!(s->weight > 0)) continue;
      sum += 0.5 * (s->edge_px[0] + s->edge_px[1]);
      good++;
    }
    if (good > 0) work->stations[i].middle_px = (float)(sum / good);
  }
}

static fg_status fit_all(fg_context *ctx, fg_edge_work *work) {
  size_t good = 0;
  FG_TRY(fg_parallel_run(ctx, work->threads, work->segment_count, fit_task, work));
  for (size_t i = 0; i < work->segment_count; i++)
    good += work->segments[i].fit.good != 0;
  if (good < 3 || good * 3 < work->segment_count)
    return fg_fail(ctx, FG_ERR_NUMERIC, "no pair of edges along the strip");
  work->good_segments = good;
  return FG_OK;
}

/* Copies a work whose segments are fitted, for counts used as light: work->start. */
static fg_status keep_start(fg_context *ctx, const fg_edge_work *before, fg_edge_work *work) {
  size_t count = before->reference->count, bins = before->segment_count * before->bin_count;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->start, (void **)&work->start));
  fg_edge_work *start = work->start;
  *start = *before;
  start->fitted = start->borrowed = true;
  start->stations = NULL;
  start->segments = NULL;
  start->bins = NULL;
  start->tables = NULL;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *start->stations, (void **)&start->stations));
  FG_TRY(allocate_segments(ctx, start));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *start->tables, (void **)&start->tables));
  fg_edge_tables_init(start->tables, 1);
  memcpy(start->stations, before->stations, count * sizeof *start->stations);
  memcpy(start->bins, before->bins, bins * sizeof *start->bins);
  for (size_t i = 0; i < start->segment_count; i++) {
    fg_profile_bin *own = start->segments[i].bins;
    start->segments[i] = before->segments[i];
    start->segments[i].bins = own;
  }
  return FG_OK;
}

static fg_status find_driver(fg_context *ctx, fg_edge_work *work, bool *found) {
  const fg_edge_work before = *work;
  FG_TRY(fg_edges_find_driver(ctx, work, found));
  bool plain_differs = work->gamma != 1 || work->driver;
  bool wanted = work->keeps_start && before.gamma == 1 && plain_differs;
  return wanted ? keep_start(ctx, &before, work) : FG_OK;
}

static fg_status fit_segments(fg_context *ctx, fg_edge_work *work) {
  bool found = false;
  FG_TRY(fit_all(ctx, work));
  if (!work->again) FG_TRY(fg_edges_find_walls(ctx, work));
  if (!work->again && work->outer_px > 0) FG_TRY(fit_all(ctx, work));
  if (!work->again && !work->plain) FG_TRY(find_driver(ctx, work, &found));
  if (found) FG_TRY(fit_all(ctx, work));
  return fg_edges_smooth_shape(ctx, work, true);
}

fg_status fg_edges_repeat_shape(fg_context *ctx, fg_edge_work *work) {
  move_middles(work);
  FG_TRY(fg_edges_smooth_shape(ctx, work, false));
  work->again = true;
  FG_TRY(fg_parallel_run(ctx, work->threads, work->chunk_count, stack_task, work));
  return fit_segments(ctx, work);
}

fg_status fg_edges_find_shape(fg_context *ctx, fg_edge_work *work) {
  if (work->fitted) return fg_edges_smooth_shape(ctx, work, true);
  FG_TRY(allocate_segments(ctx, work));
  FG_TRY(fg_parallel_run(ctx, work->threads, work->chunk_count, stack_task, work));
  FG_TRY(find_gamma(ctx, work));
  return fit_segments(ctx, work);
}
