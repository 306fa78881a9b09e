/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction between the strokes over the force: the radial hysteresis. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "foilgauge/distribution.h"
#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Number of places between the ends of all strokes, less a share of the travel at each end; number
 * of lengths l that are tried, up to a quarter of the travel. */
enum { PLACES = 49, WAYS = 51 };
static const double end_left_out = 0.05, way_share_max = 0.25;

/* Half of the regression's window, in distances between places. It is constant: a window widened by
 * noise would reach to the reversal of friction and bias the slope. All places together average the
 * noise. */
static const double window_places = 1.5;

typedef struct between {
  double x[PLACES], half[PLACES], middle[PLACES]; /* H, M */
  double low, high;                               /* turns of the strokes */
  size_t count;                                   /* of strokes that are means */
} between;

static bool spans_travel(const fg_load_stroke *s, const fg_load_direction *direction) {
  return s->high_mm - s->low_mm > 0.9 * direction->travel_mm;
}

/* Force of every whole stroke at the places; NaN of the others. */
static fg_status fit_forces(fg_context *ctx, const fg_load_strokes *strokes,
                            const fg_load_direction *direction, between *b, double **forces) {
  b->low = -INFINITY, b->high = INFINITY;
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    if (!spans_travel(s, direction)) continue;
    b->low = fmax(b->low, s->low_mm);
    b->high = fmin(b->high, s->high_mm);
  }
  FG_TRY(fg_memory_allocate(ctx, strokes->count * PLACES, sizeof **forces, (void **)forces));
  double window = window_places * (1 - 2 * end_left_out) * (b->high - b->low) / (PLACES - 1);
  for (size_t k = 0; k < PLACES; k++) {
    double share = end_left_out + (1 - 2 * end_left_out) * (double)k / (PLACES - 1);
    b->x[k] = b->low + share * (b->high - b->low);
    for (size_t i = 0; i < strokes->count; i++) {
      fg_local_fit fit;
      bool known = spans_travel(&strokes->stroke[i], direction) &&
                   fg_local_fit_near(&strokes->stroke[i], b->x[k], window, &fit);
      (*forces)[i * PLACES + k] = known ? fit.value : NAN;
    }
  }
  return FG_OK;
}

static bool follows(const fg_load_strokes *strokes, const double *forces, size_t i) {
  return i + 1 < strokes->count && strokes->stroke[i].last == strokes->stroke[i + 1].first &&
         strokes->stroke[i].record == strokes->stroke[i + 1].record &&
         isfinite(forces[i * PLACES]) && isfinite(forces[(i + 1) * PLACES]);
}

/* Share of the stroke's time until it passes x: of its samples, which are taken at even times. */
static double time_until(const fg_load_stroke *s, double x) {
  double share = (double)fg_load_stroke_from(s, x) / (double)s->count;
  return s->sense > 0 ? share : 1 - share;
}

/* Compares each stroke with those before and after it, at the time when it passes the place, which
 * removes drift. A place that it passes at p of its time was passed p before its begin and will be
 * passed 1 - p after its end. A stroke with only one neighbour is compared with that. */
static void compare_strokes(const fg_load_strokes *strokes, const double *forces, between *b) {
  for (int pairs = 0; pairs < 2 && !b->count; pairs++)
    for (size_t i = 1; i <= strokes->count; i++) {
      bool before = follows(strokes, forces, i - 1);
      if (!before || (!pairs && !follows(strokes, forces, i))) continue;
      for (size_t k = 0; k < PLACES; k++) {
        double here = forces[i * PLACES + k], there = forces[(i - 1) * PLACES + k];
        double p = time_until(&strokes->stroke[i], b->x[k]);
        if (!pairs) there = (1 - p) * there + p * forces[(i + 1) * PLACES + k];
        b->half[k] += strokes->stroke[i].sense * (here - there) / 2;
        b->middle[k] += (here + there) / 2;
      }
      b->count++;
    }
  for (size_t k = 0; k < PLACES && b->count; k++) {
    b->half[k] /= (double)b->count;
    b->middle[k] /= (double)b->count;
  }
}

static double turned(const between *b, size_t k, double way) {
  if (!(way > 0)) return 1;
  return 1 - exp(-(b->x[k] - b->low) / way) - exp(-(b->high - b->x[k]) / way);
}

/* Sum of squares of the fit with this way; a and b. */
static double try_way(const between *b, double zero, double way, double ab[2]) {
  fg_normal_equations system;
  fg_normal_clear(&system, 2);
  for (size_t k = 0; k < PLACES; k++) {
    double g = turned(b, k, way), row[2] = {g, g * fabs(b->middle[k] - zero)};
    fg_normal_add(&system, row, b->half[k], 1);
  }
  if (!fg_normal_solve(&system, 0, ab, NULL)) return INFINITY;
  return fmax(0, system.sum_squares - ab[0] * system.right[0] - ab[1] * system.right[1]);
}

/* Covariance of a and b with the way free too; neighbouring residuals are alike. */
static void find_uncertainty(const between *b, double zero, double step, fg_load_friction *f) {
  fg_normal_equations system;
  double unused[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], last = 0, sum = 0, cross = 0;
  size_t unknowns = f->way_mm > 0 ? 3 : 2;
  fg_normal_clear(&system, unknowns);
  for (size_t k = 0; k < PLACES; k++) {
    double load = fabs(b->middle[k] - zero), g = turned(b, k, f->way_mm);
    double change =
        (turned(b, k, f->way_mm + step / 2) - turned(b, k, f->way_mm - step / 2)) / step;
    double row[3] = {g, g * load, (f->a_n + f->b * load) * change};
    double off = b->half[k] - (f->a_n + f->b * load) * g;
    fg_normal_add(&system, row, 0, 1);
    sum += off * off;
    cross += k ? off * last : 0;
    last = off;
  }
  if (!fg_normal_solve(&system, 0, unused, inverse)) return;
  double alike = fmax(0, fmin(0.9, sum > 0 ? cross / sum : 0));
  double variance = sum / (double)(PLACES - unknowns) * (1 + alike) / (1 - alike);
  f->u_a_n = sqrt(variance * inverse[0][0]);
  f->u_b = sqrt(variance * inverse[1][1]);
}

static fg_load_friction fit_friction(const between *b, double zero) {
  fg_load_friction f = {NAN, NAN, NAN, NAN, NAN};
  double min = INFINITY, step = way_share_max * (b->high - b->low) / (WAYS - 1), ab[2];
  for (int i = 0; i < WAYS; i++) {
    double squares = try_way(b, zero, i * step, ab);
    if (squares >= min) continue;
    min = squares;
    f.a_n = ab[0], f.b = ab[1], f.way_mm = i * step;
  }
  find_uncertainty(b, zero, step, &f);
  return f;
}

/* Share of the gap about its middle where no foil pulls, whatever it was rounded to. */
static const double gap_share = 0.7;

/* Returns the u of a from the scatter of the strokes' mean forces between two places about a drift:
 * this includes noise that is correlated from sample to sample. Widened by Student's t, as the
 * strokes are few; 0 without dof. */
static double scatter_of_strokes(const fg_load_strokes *strokes, double low, double high) {
  enum { LEVEL, DRIFT, SENSE, UNKNOWNS };
  fg_normal_equations system;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], count = 0;
  fg_normal_clear(&system, UNKNOWNS);
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    size_t first = fg_load_stroke_from(s, low + s->shift_mm);
    size_t end = fg_load_stroke_from(s, high + s->shift_mm);
    double sum = 0;
    for (size_t k = first; k < end; k++)
      sum += s->f[k];
    if (end == first) continue;
    fg_normal_add(&system, (const double[UNKNOWNS]){1, (double)i, s->sense},
                  sum / (double)(end - first), 1);
    count++;
  }
  if (count <= UNKNOWNS || !fg_normal_solve(&system, 0, x, inverse)) return 0;
  double squares = system.sum_squares;
  for (int k = 0; k < UNKNOWNS; k++)
    squares -= x[k] * system.right[k];
  double dof = count - UNKNOWNS;
  double wide = fg_distribution_t_quantile(0.975, dof) / fg_distribution_normal_quantile(0.975);
  return wide * sqrt(fmax(0, squares) / dof * inverse[SENSE][SENSE]);
}

static double count_between(const fg_load_strokes *strokes, int sense, double low, double high) {
  double count = 0;
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    if (s->sense != sense) continue;
    count += (double)(fg_load_stroke_from(s, high + s->shift_mm) -
                      fg_load_stroke_from(s, low + s->shift_mm));
  }
  return count;
}

/* Computes a in a gap: the mean of H over it, without any model of the foils. Its u is the largest
 * of three: by the places' scatter, whose neighbours are correlated, by the samples' noise, by the
 * strokes. */
static void average_gap(const between *b, const fg_load_strokes *strokes,
                        const fg_load_direction *direction, double centre, fg_load_friction *f) {
  enum { GAP_PLACES_MIN = 4 };
  double reach = gap_share * direction->gap.value / 2, low = centre - reach, high = centre + reach;
  double count = 0, mean = 0, sum = 0, cross = 0, last = NAN;
  for (size_t k = 0; k < PLACES; k++)
    if (b->x[k] > low && b->x[k] < high && isfinite(b->half[k])) mean += b->half[k], count++;
  if (count < GAP_PLACES_MIN) return;
  mean /= count;
  for (size_t k = 0; k < PLACES; k++) {
    if (!(b->x[k] > low && b->x[k] < high && isfinite(b->half[k]))) continue;
    double off = b->half[k] - mean;
    sum += off * off;
    cross += isfinite(last) ? off * last : 0;
    last = off;
  }
  double alike = fmax(0, fmin(0.9, sum > 0 ? cross / sum : 0));
  double scatter = sum / (count - 1) / count * (1 + alike) / (1 - alike);
  double up = count_between(strokes, 1, low, high), down = count_between(strokes, -1, low, high);
  double noise = strokes->noise_n * strokes->noise_n / 4 * (1 / up + 1 / down);
  f->a_n = mean;
  f->u_a_n = fmax(sqrt(fmax(scatter, noise)), scatter_of_strokes(strokes, low, high));
}

fg_status fg_load_find_friction(fg_context *ctx, const fg_load_strokes *strokes,
                                fg_load_direction *direction) {
  between b = {0};
  double *forces = NULL, centre = (direction->push_mm + direction->pull_mm) / 2;
  size_t zero = 0;
  direction->friction = (fg_load_friction){NAN, NAN, NAN, NAN, NAN};
  fg_status status = fit_forces(ctx, strokes, direction, &b, &forces);
  if (status == FG_OK) compare_strokes(strokes, forces, &b);
  free(forces);
  if (status != FG_OK || !b.count || !isfinite(centre)) return status;
  for (size_t k = 0; k < PLACES; k++)
    if (fabs(b.x[k] - centre) < fabs(b.x[zero] - centre)) zero = k;
  /* In the middle between the points no foil pulls: the cell's reading there is its zero. */
  direction->friction = fit_friction(&b, b.middle[zero]);
  average_gap(&b, strokes, direction, centre, &direction->friction);
  return FG_OK;
}

/* Means of a and b over the directions but one. */
static size_t mean_of(const fg_load_test *test, size_t bearing, size_t but,
                      fg_load_friction *mean) {
  size_t count = 0;
  double square_a = 0, square_b = 0;
  *mean = (fg_load_friction){0};
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_friction *f = &test->directions[i].friction;
    if (test->directions[i].bearing != bearing || i == but || !isfinite(f->a_n + f->b)) continue;
    mean->a_n += f->a_n;
    mean->b += f->b;
    square_a += f->u_a_n * f->u_a_n;
    square_b += f->u_b * f->u_b;
    count++;
  }
  double n = (double)count;
  mean->a_n /= n, mean->b /= n;
  mean->u_a_n = sqrt(square_a) / n, mean->u_b = sqrt(square_b) / n;
  return count;
}

/* Scatter of a and b over the directions, by leaving out one at a time (jackknife). */
static void leave_out(const fg_load_test *test, size_t bearing, const fg_load_friction *all,
                      size_t count, double u[2]) {
  double sum[2] = {0};
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    fg_load_friction but;
    if (d->bearing != bearing || !isfinite(d->friction.a_n + d->friction.b)) continue;
    mean_of(test, bearing, i, &but);
    sum[0] += pow(but.a_n - all->a_n, 2);
    sum[1] += pow(but.b - all->b, 2);
  }
  for (int k = 0; k < 2; k++)
    u[k] = sqrt(sum[k] * (double)(count - 1) / (double)count);
}

void fg_load_sum_hysteresis(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  enum { SCATTER_DIRECTIONS_MIN = 4 };
  fg_load_friction all;
  double u[2];
  sum->hysteresis_n = (fg_load_value){NAN, NAN, NAN};
  sum->slope = sum->u_slope = NAN;
  size_t count = mean_of(test, bearing, SIZE_MAX, &all);
  if (!count) return;
  if (count >= SCATTER_DIRECTIONS_MIN) {
    leave_out(test, bearing, &all, count, u);
    all.u_a_n = fmax(u[0], all.u_a_n);
    all.u_b = fmax(u[1], all.u_b);
  }
  double scale = test->options.u_force_pct / 100;
  sum->hysteresis_n = (fg_load_value){all.a_n, hypot(all.u_a_n, scale * all.a_n), all.u_a_n};
  sum->slope = all.b, sum->u_slope = all.u_b;
}
