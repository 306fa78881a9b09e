/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a seed along a strip: cuts across it, steps ahead, gaps. */
#include "vision/trace_walk.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "foilgauge/strip.h"

enum {
  PROFILE_MAX = 1024,   /* samples across */
  SEED_ANGLES = 24,     /* directions tried at a seed */
  SEED_ROUNDS = 3,      /* each from the middle that the round before found */
  TANGENT_POINTS = 3,   /* steps over which the tangent is taken */
  CONTRAST_HALF_PX = 8, /* pixels to either side of the seed that give the contrast */
};
/* Contrast along the walk: it follows the illumination by a share of every step's own, within these
 * factors of the seed's. */
#define CONTRAST_SHARE 0.1
#define CONTRAST_RANGE 3.0
/* Distance from the scan's border, in widths, within which a strip that ends is cut by it. */
#define BORDER_WIDTHS 1.5
/* Limits of the width: a wider cut is more than one strip, a narrower one is none. */
#define JOINED_WIDTHS 1.6
#define NARROW_WIDTHS 0.5
/* Steps of the walk are not shorter than this. */
#define STEP_MIN_PX 3.0
/* Background on either side of a cut along the strip. */
#define WINDOW_MARGIN_PX 6.0
/* Blur without a visible flank. */
#define BLUR_UNKNOWN_PX 2.0
/* From 75 to 25 % of a normal distribution, in its sd. */
#define QUARTILES_SD 1.349

typedef struct cut {
  double offset_px; /* of the middle, along the normal */
  double width_px;
  double blur_px; /* sd of the edges' blur */
  double peak;
} cut;

/* Excess over a background, positive inside the strip. 0 where nothing was kept. */
static float excess_over(const fg_trace_walker *w, float background, double x, double y) {
  float value = fg_tiles_pixel(w->tiles, (int64_t)floor(x + 0.5), (int64_t)floor(y + 0.5));
  if (isnan(value)) return 0;
  return w->segmentation->light_on_dark ? value - background : background - value;
}

static float background_at(const fg_trace_walker *w, fg_point p) {
  double right = (double)w->tiles->width_px - 1, low = (double)w->tiles->height_px - 1;
  return fg_segmentation_background(w->segmentation,
                                    (int32_t)(fmin(fmax(p.x, 0), right) / FG_BLOCK_PX),
                                    (int32_t)(fmin(fmax(p.y, 0), low) / FG_BLOCK_PX));
}

/* Blur of the flank that falls from inside the strip through j in the direction `step`: the
 * distance from 75 to 25 % of the contrast is 1.349 sd. */
static double flank_blur(const float *profile, int count, int j, int step, float half) {
  int inner = j, outer = j;
  while (inner - step >= 0 && inner - step < count && profile[inner] < 1.5f * half &&
         profile[inner - step] > profile[inner])
    inner -= step;
  while (outer + step >= 0 && outer + step < count && profile[outer] > 0.5f * half &&
         profile[outer + step] < profile[outer])
    outer += step;
  double drop = profile[inner] - profile[outer];
  double pixels = abs(outer - inner);
  return drop > 0 ? pixels * half / drop / QUARTILES_SD : 0;
}

/* Cuts across at p: the run above half of `contrast` that lies nearest to p. False when there is
 * none (width 0) or when it leaves the window (width infinite). */
static bool cut_across(const fg_trace_walker *w, fg_point p, fg_point tangent, double contrast,
                       cut *out) {
  int half = (int)w->half_window_px;
  if (2 * half + 1 > PROFILE_MAX) half = (PROFILE_MAX - 1) / 2;
  float profile[PROFILE_MAX], background = background_at(w, p);
  int count = 2 * half + 1;
  for (int j = 0; j < count; j++) {
    double n = j - half, x = p.x - n * tangent.y, y = p.y + n * tangent.x;
    profile[j] = 0.5f * (excess_over(w, background, x - tangent.x, y - tangent.y) +
                         excess_over(w, background, x + tangent.x, y + tangent.y));
  }
  float limit = (float)(0.5 * contrast);
  int best = -1;
  for (int d = 0; d <= half && best < 0; d++) {
    if (profile[half + d] > limit)
      best = half + d;
    else if (profile[half - d] > limit)
      best = half - d;
  }
  out->width_px = 0;
  if (best < 0) return false;
  out->width_px = INFINITY;
  int from = best, to = best;
  while (from > 0 && profile[from - 1] > limit)
    from--;
  while (to < count - 1 && profile[to + 1] > limit)
    to++;
  if (from == 0 || to == count - 1) return false;
  double a = from - (double)(profile[from] - limit) / (profile[from] - profile[from - 1]);
  double b = to + (double)(profile[to] - limit) / (profile[to] - profile[to + 1]);
  out->offset_px = 0.5 * (a + b) - half;
  out->width_px = b - a;
  out->peak = 0;
  for (int j = from; j <= to; j++)
    out->peak = fmax(out->peak, profile[j]);
  out->blur_px = 0.5 * (flank_blur(profile, count, from, -1, limit) +
                        flank_blur(profile, count, to, 1, limit));
  return true;
}

static fg_point point_along(fg_point p, fg_point direction, double length) {
  return (fg_point){p.x + length * direction.x, p.y + length * direction.y};
}

static fg_point normal_of(fg_point tangent) {
  return (fg_point){-tangent.y, tangent.x};
}

/* The direction across which the strip at p is narrowest; moves p into its middle. */
static bool find_direction(fg_trace_walker *w, fg_point *p, fg_point *tangent) {
  for (int round = 0; round < SEED_ROUNDS; round++) {
    cut narrowest = {.width_px = INFINITY}, c;
    fg_point direction = {1, 0};
    for (int i = 0; i < SEED_ANGLES; i++) {
      double angle = M_PI * i / SEED_ANGLES;
      fg_point t = {cos(angle), sin(angle)};
      if (!cut_across(w, *p, t, w->contrast, &c) || c.width_px >= narrowest.width_px) continue;
      narrowest = c;
      direction = t;
    }
    if (!isfinite(narrowest.width_px)) return false;
    *p = point_along(*p, normal_of(direction), narrowest.offset_px);
    *tangent = direction;
    w->width_px = narrowest.width_px;
  }
  return true;
}

static bool is_outside(const fg_trace_walker *w, fg_point p, double margin) {
  return p.x < margin || p.y < margin || p.x > (double)w->tiles->width_px - 1 - margin ||
         p.y > (double)w->tiles->height_px - 1 - margin;
}

static fg_status append_point(fg_context *ctx, fg_trace *trace, fg_point p) {
  FG_TRY(fg_memory_reserve(ctx, trace->count + 1, sizeof *trace->points, &trace->capacity,
                           (void **)&trace->points));
  trace->points[trace->count++] = p;
  return FG_OK;
}

/* Returns true when the walk comes back to an earlier place: a strip is no ring. Every other point
 * is tested, they are closer than half a width. */
static bool is_visited(const fg_trace *trace, fg_point p, double width) {
  size_t recent = (size_t)(8 * TANGENT_POINTS);
  double limit = 0.25 * width * width;
  for (size_t i = 0; i + recent < trace->count; i += 2) {
    double dx = trace->points[i].x - p.x, dy = trace->points[i].y - p.y;
    if (dx * dx + dy * dy < limit) return true;
  }
  return false;
}

static fg_point tangent_at_end(const fg_trace *trace, fg_point fallback) {
  if (trace->count <= TANGENT_POINTS) return fallback;
  fg_point a = trace->points[trace->count - 1 - TANGENT_POINTS];
  fg_point b = trace->points[trace->count - 1];
  double length = hypot(b.x - a.x, b.y - a.y);
  return length > 0 ? (fg_point){(b.x - a.x) / length, (b.y - a.y) / length} : fallback;
}

/* Cuts the strip one step ahead of p, which lies `missed` past the last good point. When it is not
 * straight ahead, a little to either side is tried: a tight bend in few pixels turns faster than
 * the direction follows. */
static bool step_ahead(const fg_trace_walker *w, fg_point p, fg_point *direction, double length,
                       double missed, double contrast, fg_point *next, cut *c) {
  static const double turns[] = {0, 0.26, -0.26, 0.52, -0.52};
  size_t tries = missed > 0 ? 1 : sizeof turns / sizeof turns[0];
  double straight_px = 0;
  for (size_t i = 0; i < tries; i++) {
    double cosine = cos(turns[i]), sine = sin(turns[i]);
    fg_point d = {cosine * direction->x - sine * direction->y,
                  sine * direction->x + cosine * direction->y};
    *next = point_along(p, d, length);
    if (is_outside(w, *next, 0)) continue;
    bool found = cut_across(w, *next, d, contrast, c);
    if (i == 0) straight_px = c->width_px;
    if (!found || c->width_px >= JOINED_WIDTHS * w->width_px ||
        c->width_px <= NARROW_WIDTHS * w->width_px ||
        fabs(c->offset_px) >= 0.5 * w->width_px + 0.5 * missed)
      continue;
    *direction = d;
    return true;
  }
  *next = point_along(p, *direction, length);
  c->width_px = straight_px;
  return false;
}

/* Walks from p in one direction, appending points (p itself excluded). */
static fg_status walk_strip(fg_context *ctx, fg_trace_walker *w, fg_point p, fg_point tangent,
                            fg_trace *trace) {
  double step = fmax(STEP_MIN_PX, w->width_px / FG_TRACE_STEPS_PER_WIDTH), missed = 0,
         contrast = w->contrast;
  fg_point direction = tangent;
  bool joined = false; /* since the last good point the strip was too wide: an object lies on it */
  while (missed <= FG_TRACE_MISSED_WIDTHS * w->width_px) {
    fg_point next = point_along(p, direction, step + missed);
    if (is_outside(w, next, 0)) break;
    cut c;
    bool good = step_ahead(w, p, &direction, step + missed, missed, contrast, &next, &c);
    if (!good) {
      joined |= c.width_px >= JOINED_WIDTHS * w->width_px;
      missed += step;
      continue;
    }
    if (missed > 2 * step) trace->facts |= FG_STRIP_GAP;
    if (missed > 2 * step && joined) trace->facts |= FG_STRIP_TOUCHES_OTHER;
    joined = false;
    missed = 0;
    contrast += CONTRAST_SHARE * (c.peak - contrast);
    contrast = fmin(fmax(contrast, w->contrast / CONTRAST_RANGE), w->contrast * CONTRAST_RANGE);
    p = point_along(next, normal_of(direction), c.offset_px);
    if (is_visited(trace, p, w->width_px)) break;
    w->blur_sum += c.blur_px;
    w->blur_count++;
    FG_TRY(append_point(ctx, trace, p));
    direction = tangent_at_end(trace, direction);
  }
  if (joined) trace->facts |= FG_STRIP_TOUCHES_OTHER;
  if (is_outside(w, p, BORDER_WIDTHS * w->width_px)) trace->facts |= FG_STRIP_TOUCHES_BORDER;
  return FG_OK;
}

static void reverse_trace(fg_trace *trace) {
  for (size_t i = 0, j = trace->count; i + 1 < j; i++, j--) {
    fg_point swap = trace->points[i];
    trace->points[i] = trace->points[j - 1];
    trace->points[j - 1] = swap;
  }
}

fg_status fg_trace_from_seed(fg_context *ctx, fg_trace_walker *w, fg_point seed, fg_trace *trace) {
  fg_point tangent;
  if (!find_direction(w, &seed, &tangent)) return FG_OK;
  w->half_window_px = w->width_px + WINDOW_MARGIN_PX;
  FG_TRY(walk_strip(ctx, w, seed, (fg_point){-tangent.x, -tangent.y}, trace));
  reverse_trace(trace);
  FG_TRY(append_point(ctx, trace, seed));
  FG_TRY(walk_strip(ctx, w, seed, tangent, trace));
  trace->width_px = w->width_px;
  trace->contrast = w->contrast;
  trace->blur_px = w->blur_count ? w->blur_sum / (double)w->blur_count : BLUR_UNKNOWN_PX;
  return FG_OK;
}

double fg_trace_contrast_at(const fg_trace_walker *w, fg_point seed) {
  float values[4 * CONTRAST_HALF_PX * CONTRAST_HALF_PX], background = background_at(w, seed);
  size_t count = 0;
  for (int y = -CONTRAST_HALF_PX; y < CONTRAST_HALF_PX; y++)
    for (int x = -CONTRAST_HALF_PX; x < CONTRAST_HALF_PX; x++) {
      float value = excess_over(w, background, seed.x + x, seed.y + y);
      size_t i = count++;
      for (; i > 0 && values[i - 1] > value; i--)
        values[i] = values[i - 1];
      values[i] = value;
    }
  return values[count * 9 / 10];
}
