#include "vision/trace.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/strip.h"

enum {
  PROFILE_MAX = 1024, /* samples across */
  SEED_ANGLES = 24,   /* directions tried at a seed */
  TANGENT_POINTS = 3, /* the tangent is taken over so many steps */
  STRIPS_MAX = 16,    /* strips in one object */
};
#define GAP_WIDTHS   4.0  /* longest gap that is bridged, in strip widths */
#define LENGTH_LEAST 12.0 /* shortest strip, in strip widths */
/* The contrast follows the illumination: a share of every step's own, within these factors of the
 * seed's. */
#define CONTRAST_SHARE 0.1
#define CONTRAST_RANGE 3.0
/* Two traces are one strip when so much of the shorter lies on the longer. */
#define OVERLAP_SHARE 0.5
/* A strip that ends so many widths from the scan's border is cut by it. */
#define BORDER_WIDTHS 1.5
/* Wider than so many widths is more than one strip. */
#define JOINED_WIDTHS 1.6

typedef struct walker {
  const fg_tiles *tiles;
  const fg_segmentation *segmentation;
  const fg_object *object;
  double half_window_px; /* of a cut */
  double width_px;       /* of the strip at the seed */
  double contrast;
  double blur_sum; /* over the cuts of a walk */
  size_t blur_count;
} walker;

typedef struct cut {
  double offset_px; /* of the middle, along the normal */
  double width_px;
  double blur_px; /* sd of the edges' blur */
  double peak;
} cut;

/* Excess over a background, positive inside the strip. 0 where nothing was kept. */
static float excess_over(const walker *w, float background, double x, double y) {
  float value = fg_tiles_pixel(w->tiles, (int64_t)floor(x + 0.5), (int64_t)floor(y + 0.5));
  if (isnan(value)) return 0;
  return w->segmentation->light_on_dark ? value - background : background - value;
}

static float background_at(const walker *w, fg_point p) {
  double right = (double)w->tiles->width_px - 1, low = (double)w->tiles->height_px - 1;
  return fg_segmentation_background(w->segmentation,
                                    (int32_t)(fmin(fmax(p.x, 0), right) / FG_BLOCK_PX),
                                    (int32_t)(fmin(fmax(p.y, 0), low) / FG_BLOCK_PX));
}

/* Blur of the flank that falls from inside the strip through j in the direction `step`: the way
 * from 75 to 25 % of the contrast is 1.349 sd. */
static double flank(const float *profile, int count, int j, int step, float half) {
  int inner = j, outer = j;
  while (inner - step >= 0 && inner - step < count && profile[inner] < 1.5f * half &&
         profile[inner - step] > profile[inner])
    inner -= step;
  while (outer + step >= 0 && outer + step < count && profile[outer] > 0.5f * half &&
         profile[outer + step] < profile[outer])
    outer += step;
  double drop = profile[inner] - profile[outer];
  double pixels = abs(outer - inner);
  return drop > 0 ? pixels * half / drop / 1.349 : 0;
}

/* Cuts across at p: the run above half of `contrast` that lies nearest to p. False when there is
 * none (width 0) or when it leaves the window (width infinite). */
static bool cut_across(const walker *w, fg_point p, fg_point tangent, double contrast, cut *out) {
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
  out->blur_px =
      0.5 * (flank(profile, count, from, -1, limit) + flank(profile, count, to, 1, limit));
  return true;
}

static fg_point along(fg_point p, fg_point direction, double length) {
  return (fg_point){p.x + length * direction.x, p.y + length * direction.y};
}

static fg_point normal_of(fg_point tangent) {
  return (fg_point){-tangent.y, tangent.x};
}

/* The direction across which the strip at p is narrowest; moves p into its middle. */
static bool find_direction(walker *w, fg_point *p, fg_point *tangent) {
  for (int round = 0; round < 3; round++) {
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
    *p = along(*p, normal_of(direction), narrowest.offset_px);
    *tangent = direction;
    w->width_px = narrowest.width_px;
  }
  return true;
}

static bool outside(const walker *w, fg_point p, double margin) {
  return p.x < margin || p.y < margin || p.x > (double)w->tiles->width_px - 1 - margin ||
         p.y > (double)w->tiles->height_px - 1 - margin;
}

static fg_status append(fg_context *ctx, fg_trace *trace, fg_point p) {
  FG_TRY(fg_memory_reserve(ctx, trace->count + 1, sizeof *trace->points, &trace->capacity,
                           (void **)&trace->points));
  trace->points[trace->count++] = p;
  return FG_OK;
}

/* The walk may not come back to where it was: a strip is no ring. Every other point is looked at,
 * they are closer than half a width. */
static bool visited(const fg_trace *trace, fg_point p, double width) {
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

/* The strip's cut one step ahead of p, which lies `missed` past the last good point. Where it is
 * not straight ahead, a little to either side is tried: a tight bend in few pixels turns faster
 * than the direction follows. */
static bool step_ahead(const walker *w, fg_point p, fg_point *direction, double length,
                       double missed, double contrast, fg_point *next, cut *c) {
  static const double turns[] = {0, 0.26, -0.26, 0.52, -0.52};
  size_t tries = missed > 0 ? 1 : sizeof turns / sizeof turns[0];
  double straight_px = 0;
  for (size_t i = 0; i < tries; i++) {
    double cosine = cos(turns[i]), sine = sin(turns[i]);
    fg_point d = {cosine * direction->x - sine * direction->y,
                  sine * direction->x + cosine * direction->y};
    *next = along(p, d, length);
    if (outside(w, *next, 0)) continue;
    bool found = cut_across(w, *next, d, contrast, c);
    if (i == 0) straight_px = c->width_px;
    if (!found || c->width_px >= JOINED_WIDTHS * w->width_px || c->width_px <= 0.5 * w->width_px ||
        fabs(c->offset_px) >= 0.5 * w->width_px + 0.5 * missed)
      continue;
    *direction = d;
    return true;
  }
  *next = along(p, *direction, length);
  c->width_px = straight_px;
  return false;
}

/* Walks from p in one direction, appending points (p itself excluded). */
static fg_status walk(fg_context *ctx, walker *w, fg_point p, fg_point tangent, fg_trace *trace) {
  double step = fmax(3.0, w->width_px / 3), missed = 0, contrast = w->contrast;
  fg_point direction = tangent;
  bool joined = false; /* since the last good point the strip was too wide: something lies on it */
  while (missed <= GAP_WIDTHS * w->width_px) {
    fg_point next = along(p, direction, step + missed);
    if (outside(w, next, 0)) break;
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
    p = along(next, normal_of(direction), c.offset_px);
    if (visited(trace, p, w->width_px)) break;
    w->blur_sum += c.blur_px;
    w->blur_count++;
    FG_TRY(append(ctx, trace, p));
    direction = tangent_at_end(trace, direction);
  }
  if (joined) trace->facts |= FG_STRIP_TOUCHES_OTHER;
  if (outside(w, p, BORDER_WIDTHS * w->width_px)) trace->facts |= FG_STRIP_TOUCHES_BORDER;
  return FG_OK;
}

static void reverse(fg_trace *trace) {
  for (size_t i = 0, j = trace->count; i + 1 < j; i++, j--) {
    fg_point swap = trace->points[i];
    trace->points[i] = trace->points[j - 1];
    trace->points[j - 1] = swap;
  }
}

static fg_status trace_from_seed(fg_context *ctx, walker *w, fg_point seed, fg_trace *trace) {
  fg_point tangent;
  if (!find_direction(w, &seed, &tangent)) return FG_OK;
  w->half_window_px = w->width_px + 6;
  FG_TRY(walk(ctx, w, seed, (fg_point){-tangent.x, -tangent.y}, trace));
  reverse(trace);
  FG_TRY(append(ctx, trace, seed));
  FG_TRY(walk(ctx, w, seed, tangent, trace));
  trace->width_px = w->width_px;
  trace->contrast = w->contrast;
  trace->blur_px = w->blur_count ? w->blur_sum / (double)w->blur_count : 2;
  return FG_OK;
}

/* Clears the blocks of the object that lie along a trace, and returns how many are left. */
static int32_t clear_along(const fg_trace *trace, const walker *w, fg_point seed, uint8_t *open) {
  const fg_object *o = w->object;
  int32_t reach = (int32_t)((w->width_px / 2 + 2 * FG_BLOCK_PX) / FG_BLOCK_PX) + 1, left = 0;
  for (size_t i = 0; i <= trace->count; i++) {
    fg_point p = i < trace->count ? trace->points[i] : seed;
    int32_t bx = (int32_t)(p.x / FG_BLOCK_PX) - o->x, by = (int32_t)(p.y / FG_BLOCK_PX) - o->y;
    for (int32_t y = by - reach; y <= by + reach; y++)
      for (int32_t x = bx - reach; x <= bx + reach; x++)
        if (x >= 0 && y >= 0 && x < o->width && y < o->height)
          open[(size_t)y * (size_t)o->width + (size_t)x] = 0;
  }
  for (size_t i = 0; i < (size_t)o->width * (size_t)o->height; i++)
    left += open[i];
  return left;
}

/* The open block with the largest excess: the middle of the strip, away from its fringes. */
static bool find_seed(const walker *w, const uint8_t *open, fg_point *seed) {
  const fg_object *o = w->object;
  const fg_segmentation *s = w->segmentation;
  float best = 0;
  for (int32_t y = 0; y < o->height; y++)
    for (int32_t x = 0; x < o->width; x++) {
      if (!open[(size_t)y * (size_t)o->width + (size_t)x]) continue;
      float excess = fg_segmentation_excess(s, x + o->x, y + o->y);
      if (excess <= best) continue;
      best = excess;
      *seed =
          (fg_point){(x + o->x + 0.5) * FG_BLOCK_PX - 0.5, (y + o->y + 0.5) * FG_BLOCK_PX - 0.5};
    }
  return best > 0;
}

/* The strip's own contrast at a seed: the largest excess of the pixels around it, less the
 * extremes (a 90th percentile over 16 × 16). */
static double contrast_at(const walker *w, fg_point seed) {
  float values[16 * 16], background = background_at(w, seed);
  size_t count = 0;
  for (int y = -8; y < 8; y++)
    for (int x = -8; x < 8; x++) {
      float value = excess_over(w, background, seed.x + x, seed.y + y);
      size_t i = count++;
      for (; i > 0 && values[i - 1] > value; i--)
        values[i] = values[i - 1];
      values[i] = value;
    }
  return values[count * 9 / 10];
}

static void open_blocks(const walker *w, uint8_t *open) {
  const fg_object *o = w->object;
  for (int32_t y = 0; y < o->height; y++)
    for (int32_t x = 0; x < o->width; x++)
      open[(size_t)y * (size_t)o->width + (size_t)x] =
          fg_segmentation_label(w->segmentation, x + o->x, y + o->y) == o->label;
}

static void free_trace(fg_trace *trace) {
  free(trace->points);
  memset(trace, 0, sizeof *trace);
}

bool fg_trace_is_same(const fg_trace *a, const fg_trace *b) {
  const fg_trace *brief = a->count < b->count ? a : b, *full = brief == a ? b : a;
  double limit = 0.25 * full->width_px * full->width_px;
  size_t on = 0;
  for (size_t i = 0; i < brief->count; i++)
    for (size_t j = 0; j < full->count; j++) {
      double dx = brief->points[i].x - full->points[j].x;
      double dy = brief->points[i].y - full->points[j].y;
      if (dx * dx + dy * dy >= limit) continue;
      on++;
      break;
    }
  return (double)on > OVERLAP_SHARE * (double)brief->count;
}

/* Keeps a trace that is long enough to be a strip; of one strip the longest trace stays. */
static void keep_or_drop(fg_trace *trace, fg_trace_list *list) {
  double length = 0;
  for (size_t k = 0; k < list->count; k++) {
    fg_trace *other = &list->traces[k];
    if (!fg_trace_is_same(trace, other)) continue;
    if (trace->count > other->count) {
      fg_trace swap = *other;
      *other = *trace;
      *trace = swap;
    }
    free_trace(trace);
    return;
  }
  for (size_t i = 1; i < trace->count; i++)
    length += hypot(trace->points[i].x - trace->points[i - 1].x,
                    trace->points[i].y - trace->points[i - 1].y);
  if (trace->count < 8 || length < LENGTH_LEAST * trace->width_px)
    free_trace(trace);
  else
    list->traces[list->count++] = *trace;
}

fg_status fg_trace_object(fg_context *ctx, const fg_tiles *tiles,
                          const fg_segmentation *segmentation, const fg_object *object,
                          double width_px, fg_trace_list *list) {
  memset(list, 0, sizeof *list);
  walker w = {.tiles = tiles, .segmentation = segmentation, .object = object};
  uint8_t *open = NULL;
  fg_status status = FG_OK;
  fg_trace trace = {0};
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, (size_t)object->width * (size_t)object->height, 1, (void **)&open));
  FG_TRY_EXIT(fg_memory_allocate(ctx, STRIPS_MAX, sizeof *list->traces, (void **)&list->traces));
  open_blocks(&w, open);
  fg_point seed = {0, 0};
  int32_t left = object->blocks, little = (int32_t)(LENGTH_LEAST * width_px / FG_BLOCK_PX);
  for (int i = 0; i < STRIPS_MAX && left > little && find_seed(&w, open, &seed); i++) {
    trace = (fg_trace){0};
    w.contrast = contrast_at(&w, seed);
    w.half_window_px = 3 * width_px + 8;
    w.width_px = width_px;
    w.blur_sum = 0;
    w.blur_count = 0;
    FG_TRY_EXIT(trace_from_seed(ctx, &w, seed, &trace));
    left = clear_along(&trace, &w, seed, open);
    keep_or_drop(&trace, list);
    trace = (fg_trace){0};
  }
  if (list->count > 1)
    for (size_t i = 0; i < list->count; i++)
      list->traces[i].facts |= FG_STRIP_TOUCHES_OTHER;
exit:
  free(open);
  free_trace(&trace);
  if (status != FG_OK) fg_trace_list_free(list);
  return status;
}

void fg_trace_list_free(fg_trace_list *list) {
  if (!list) return;
  for (size_t i = 0; i < list->count; i++)
    free_trace(&list->traces[i]);
  free(list->traces);
  memset(list, 0, sizeof *list);
}
