/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/land_deviation.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"

/* Length over which a deviation is averaged, and distance kept from the ends of a land, where the
 * blur of the fillets reaches in. */
#define WINDOW_MM 0.1
#define MARGIN_MM 0.05
/* Of clean rendered foils 1 in 100 may reach the limit; of 130 with smooth and rough edges none
 * did. Without noise the edge model itself deviates by 0.1 µm. */
#define SIGMAS      8.0
#define SMALLEST_MM 0.0003
#define BOTH_EDGES  0.5 /* max change of the half width, in deviations of the middle */
#define SEEN_SHARE  0.7 /* min share of a window's stations */
#define LONGEST     1.5 /* in median lands: a longer one has the place of a missing bump */
enum { WINDOWS_MIN = 20, WINDOW_MIN = 3 };

/* Deviations of windows, mm: of the middle and of the half width, each about its land's median. */
typedef struct window_list {
  double *middle, *half;
  size_t count, stations; /* stations per window */
} window_list;

/* A bump's stations between its two crossings with the overall circle; last 0: there are none. The
 * ends of the range that was fitted scatter by more. */
static fg_range find_crossings(const fg_layout *layout, size_t i) {
  const fg_circle *lands = &layout->overall.circle, *bump = &layout->bumps[i].circle;
  double cx = bump->x - lands->x, cy = bump->y - lands->y, x = hypot(cx, cy);
  double cosine = (x * x + lands->radius * lands->radius - bump->radius * bump->radius) /
                  (2 * x * lands->radius);
  fg_range range = layout->bump_ranges[i];
  size_t count = layout->line.strip->count;
  if (!layout->fitted[i] || !(fabs(cosine) < 1)) return (fg_range){0, 0};
  for (int side = 0; side < 2; side++) {
    size_t *k = side ? &range.last : &range.first;
    for (; *k > 0 && *k + 1 < count; *k += side ? 1 : (size_t)-1) {
      const fg_point p = layout->line.points[*k];
      double px = p.x - lands->x, py = p.y - lands->y;
      if ((px * cx + py * cy) / (x * hypot(px, py)) < cosine) break;
    }
  }
  return range;
}

/* Places of the lands, from crossing to crossing of neighbouring bumps; returns their number. */
static size_t list_gaps(const fg_layout *layout, fg_range *gaps) {
  size_t n = 0;
  fg_range before = find_crossings(layout, 0);
  for (size_t i = 1; i < layout->turning.bump_count; i++) {
    fg_range next = find_crossings(layout, i);
    if (before.last && next.last && next.first > before.last)
      gaps[n++] = (fg_range){before.last, next.first};
    before = next;
  }
  return n;
}

/* Returns the median number of stations from a crossing to the land that was found beside it. */
static size_t typical_inset(const fg_layout *layout, const fg_range *gaps, size_t count,
                            double *lengths) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < layout->land_count; k++) {
      const fg_range land = layout->lands[k];
      if (land.first <= gaps[i].first || land.last >= gaps[i].last) continue;
      lengths[n++] = (double)(land.first - gaps[i].first);
      lengths[n++] = (double)(gaps[i].last - land.last);
    }
  return n ? (size_t)fg_select(lengths, n, n / 2) : 0;
}

/* Stores the usable stations' values of one land, NaN for others; returns the median. */
static double list_land(const fg_layout *layout, fg_range land, bool half, double *values,
                        double *sorted) {
  size_t n = 0;
  for (size_t k = land.first; k <= land.last; k++) {
    double r = fg_arc_residual(&layout->line, &layout->overall.circle, k);
    double value = half && isfinite(r) ? layout->line.half_width[k] : r;
    values[k - land.first] = value;
    if (isfinite(value)) sorted[n++] = value;
  }
  return n ? fg_median(sorted, n) : NAN;
}

static bool find_window_mean(const double *values, size_t count, double *mean) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(values[i])) {
      sum += values[i];
      n++;
    }
  *mean = sum / n;
  return n > 0 && n >= SEEN_SHARE * (double)count;
}

/* `work` has room for three times the stations. */
static void add_land(const fg_layout *layout, fg_range land, double *work, window_list *windows) {
  size_t count = land.last - land.first + 1, strip = layout->line.strip->count;
  double *middle = work, *half = work + strip, *sorted = half + strip, m, h;
  double middle_median = list_land(layout, land, false, middle, sorted);
  double half_median = list_land(layout, land, true, half, sorted);
  for (size_t i = 0; i + windows->stations <= count; i++) {
    if (!find_window_mean(middle + i, windows->stations, &m) ||
        !find_window_mean(half + i, windows->stations, &h))
      continue;
    windows->middle[windows->count] = m - middle_median;
    windows->half[windows->count++] = h - half_median;
  }
}

static void list_windows(const fg_layout *layout, fg_range *gaps, double *work,
                         window_list *windows) {
  const fg_strip *strip = layout->line.strip;
  size_t count = list_gaps(layout, gaps);
  size_t inset = typical_inset(layout, gaps, count, work);
  inset += (size_t)ceil(MARGIN_MM / strip->step_mm);
  for (size_t i = 0; i < count; i++)
    work[i] = (double)(gaps[i].last - gaps[i].first);
  double longest = count ? LONGEST * fg_median(work, count) : 0;
  for (size_t i = 0; i < count; i++) {
    size_t length = gaps[i].last - gaps[i].first;
    if ((double)length > longest || length < 2 * inset) continue;
    add_land(layout, (fg_range){gaps[i].first + inset, gaps[i].last - inset}, work, windows);
  }
}

static bool has_deviation(const window_list *windows, double *sizes) {
  if (windows->count < WINDOWS_MIN) return false;
  for (size_t i = 0; i < windows->count; i++)
    sizes[i] = fabs(windows->middle[i]);
  double limit = fmax(fg_spread_limit(sizes, windows->count, SIGMAS), SMALLEST_MM);
  for (size_t i = 0; i < windows->count; i++) {
    double size = fabs(windows->middle[i]);
    if (size > limit && fabs(windows->half[i]) < BOTH_EDGES * size) return true;
  }
  return false;
}

fg_status fg_land_deviation_find(fg_context *ctx, const fg_layout *layout, bool *deviates) {
  size_t count = layout->line.strip->count, bumps = layout->turning.bump_count;
  double *memory = NULL;
  fg_range *gaps = NULL;
  window_list windows = {.count = 0};
  fg_status status = FG_OK;
  *deviates = false;
  if (bumps < 2) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 5 * count, sizeof *memory, (void **)&memory));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof *gaps, (void **)&gaps));
  windows.middle = memory;
  windows.half = memory + count;
  windows.stations = (size_t)lround(WINDOW_MM / layout->line.strip->step_mm);
  if (windows.stations < WINDOW_MIN) windows.stations = WINDOW_MIN;
  list_windows(layout, gaps, memory + 2 * count, &windows);
  *deviates = has_deviation(&windows, memory + 2 * count);
exit:
  free(gaps);
  free(memory);
  return status;
}
