/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour_drift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "foilgauge/distribution.h"

enum {
  WINDOW_ROWS = 6, /* min mean number of cross-sections in a window */
  WINDOW_PX = 4,   /* min length of a window */
  COARSE = 8,      /* number of windows in the test for slow drifts */
  ROUNDS = 3,
  SHARED = FG_COLOUR_SHARED, /* unknowns beside dy */
  BANDWIDTHS = 16, /* number of bandwidths tried, each shorter than the one before by the factor */
};
#define BANDWIDTH_FACTOR 1.5
/* Min information of a window, as a share of the middle one's. */
#define TELLING_SHARE 0.1
/* Limit of a row's deviation from its own window, in standard deviations: a larger one has another
 * cause than the carriage. */
#define OUTLIER_SIGMAS 4.5

/* Sums over the rows of one window: of w ny², w ny value, w ny a (a: coefficients of the shared
 * unknowns), w ny² y. */
typedef struct window {
  double weight, value, shared[SHARED], y, dy;
  size_t rows;
} window;

/* A separate dy for every window, beside the unknowns that they share. */
typedef struct windows {
  window list[FG_COLOUR_WINDOWS_MAX];
  size_t count;
  double low_mm, length_mm;
  double shared[SHARED], covariance[SHARED][SHARED]; /* for rows of variance 1 / weight */
  double factor[SHARED][SHARED];                     /* its lower Cholesky factor */
  double misfit;                                     /* weighted sum of squares */
} windows;

static const int shared_unknowns[SHARED] = {FG_COLOUR_DX, FG_COLOUR_MAGNIFICATION, FG_COLOUR_SKEW,
                                            FG_COLOUR_SWELL};

static size_t window_of(const windows *w, double y_mm) {
  double place = (y_mm - w->low_mm) / w->length_mm;
  if (!(place > 0)) return 0;
  return place >= (double)w->count ? w->count - 1 : (size_t)place;
}

/* Lays out windows of equal length over all rows; at most `max`. */
static void lay_out(const fg_colour_rows *rows, size_t max, windows *w) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < rows->count; i++) {
    low = fmin(low, rows->list[i].y_mm);
    high = fmax(high, rows->list[i].y_mm);
  }
  double count =
      fmin((high - low) / (WINDOW_PX * rows->pixel_mm[1]), (double)rows->count / WINDOW_ROWS);
  memset(w, 0, sizeof *w);
  w->count = (size_t)fmax(1, fmin((double)max, count));
  w->low_mm = low;
  w->length_mm = fmax((high - low) / (double)w->count, 1e-9);
}

/* Number of shared unknowns; only discs swell. */
static size_t shared_count(const fg_colour_rows *rows) {
  return rows->unknowns - 1;
}

static void fill_shared(const fg_colour_rows *rows, const fg_colour_row *row, double to[SHARED]) {
  double all[FG_COLOUR_UNKNOWNS];
  fg_colour_row_coefficients(rows, row, all);
  for (int k = 0; k < SHARED; k++)
    to[k] = all[shared_unknowns[k]];
}

static void fill_windows(const fg_colour_rows *rows, windows *w, fg_normal_equations *system) {
  double a[SHARED];
  memset(w->list, 0, sizeof w->list);
  fg_normal_clear(system, shared_count(rows));
  for (size_t i = 0; i < rows->count; i++) {
    const fg_colour_row *row = &rows->list[i];
    if (!row->used) continue;
    window *to = &w->list[window_of(w, row->y_mm)];
    fill_shared(rows, row, a);
    fg_normal_add(system, a, row->value, row->weight);
    to->weight += row->weight * row->ny * row->ny;
    to->value += row->weight * row->ny * row->value;
    to->y += row->weight * row->ny * row->ny * row->y_mm;
    for (int k = 0; k < SHARED; k++)
      to->shared[k] += row->weight * row->ny * a[k];
    to->rows++;
  }
}

/* Residual of a row beyond the shared unknowns, and beyond its window's dy. */
static double residual_of(const fg_colour_rows *rows, const windows *w, const fg_colour_row *row) {
  double a[SHARED], rest = row->value - row->ny * w->list[window_of(w, row->y_mm)].dy;
  fill_shared(rows, row, a);
  for (size_t k = 0; k < shared_count(rows); k++)
    rest -= a[k] * w->shared[k];
  return rest;
}

/* Finds every window's dy with the shared unknowns held. */
static void find_window_means(windows *w, size_t shared) {
  for (size_t i = 0; i < w->count; i++) {
    window *at = &w->list[i];
    if (!(at->weight > 0)) continue;
    at->dy = at->value;
    for (size_t k = 0; k < shared; k++)
      at->dy -= at->shared[k] * w->shared[k];
    at->dy /= at->weight;
  }
}

static void factorise_shared(windows *w, size_t count) {
  memset(w->factor, 0, sizeof w->factor);
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k <= i; k++) {
      double rest = w->covariance[i][k];
      for (size_t j = 0; j < k; j++)
        rest -= w->factor[i][j] * w->factor[k][j];
      w->factor[i][k] = i == k ? sqrt(fmax(rest, 0)) : rest / fmax(w->factor[k][k], 1e-300);
    }
}

/* Least squares over the used rows: every window's dy is eliminated, which leaves a small system in
 * the shared unknowns. False: beside so free a drift they are not determined. */
static bool solve_windows(const fg_colour_rows *rows, windows *w) {
  fg_normal_equations system;
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  size_t shared = shared_count(rows);
  fill_windows(rows, w, &system);
  for (size_t i = 0; i < w->count; i++)
    if (w->list[i].weight > 0)
      fg_normal_add(&system, w->list[i].shared, w->list[i].value, -1 / w->list[i].weight);
  if (!fg_normal_solve(&system, 1e-9, w->shared, inverse)) return false;
  for (size_t k = 0; k < shared; k++)
    memcpy(w->covariance[k], inverse[k], sizeof w->covariance[k]);
  factorise_shared(w, shared);
  find_window_means(w, shared);
  w->misfit = 0;
  for (size_t i = 0; i < rows->count; i++) {
    double rest = rows->list[i].used ? residual_of(rows, w, &rows->list[i]) : 0;
    w->misfit += rest * rest * rows->list[i].weight;
  }
  return true;
}

/* Solves from all rows: an outlier of a constant dy may be the carriage's, an outlier of its own
 * window is not. */
static bool find_windows(fg_colour_rows *rows, windows *w) {
  for (size_t i = 0; i < rows->count; i++)
    rows->list[i].used = true;
  bool told = solve_windows(rows, w);
  for (int round = 0; round < ROUNDS && told; round++) {
    for (size_t i = 0; i < rows->count; i++)
      rows->list[i].size = fabs(residual_of(rows, w, &rows->list[i])) * sqrt(rows->list[i].weight);
    if (!fg_colour_rows_keep(rows, OUTLIER_SIGMAS)) break;
    told = solve_windows(rows, w);
  }
  return told;
}

static double middle_weight(const windows *w) {
  double weights[FG_COLOUR_WINDOWS_MAX];
  for (size_t i = 0; i < w->count; i++)
    weights[i] = w->list[i].weight;
  return fg_select(weights, w->count, w->count / 2);
}

/* Returns a window's dy with its uncertainty: its own, and that of the shared unknowns. */
static fg_colour_window point_of(const fg_colour_rows *rows, const windows *w, const window *from) {
  double um = 1e3 * rows->pixel_mm[1], variance = rows->scatter * rows->correlation;
  double own = um * sqrt(variance / from->weight), lean[SHARED] = {0};
  fg_colour_window point = {.y_mm = (float)(from->y / from->weight),
                            .dy_um = (float)(um * from->dy),
                            .u_own_um = (float)own};
  double all = own * own;
  for (size_t k = 0; k < shared_count(rows); k++)
    lean[k] = -from->shared[k] / from->weight;
  /* With the Cholesky factor L of the covariance of the shared unknowns, L' lean are independent.
   */
  for (size_t k = 0; k < shared_count(rows); k++) {
    double sum = 0;
    for (size_t i = k; i < shared_count(rows); i++)
      sum += w->factor[i][k] * lean[i];
    point.shared_um[k] = (float)(um * sqrt(variance) * sum);
    all += um * um * variance * sum * sum;
  }
  point.u_dy_um = (float)sqrt(all);
  return point;
}

/* Writes the windows with enough information, as points of the drift. */
static void write_points(const fg_colour_rows *rows, const windows *w, fg_colour_shift *shift) {
  double min = TELLING_SHARE * middle_weight(w);
  shift->window_count = 0;
  for (size_t i = 0; i < w->count; i++)
    if (w->list[i].rows >= 2 && w->list[i].weight > min)
      shift->windows[shift->window_count++] = point_of(rows, w, &w->list[i]);
}

/* Weight of a neighbour: 1 / u² of its own, times its nearness (tricube). */
static double window_weight(const fg_colour_window *p, double away_mm, double reach_mm) {
  double near = fabs(away_mm) / reach_mm, u = (double)p->u_own_um;
  if (near >= 1) return 0;
  double rest = 1 - near * near * near;
  return rest * rest * rest / (u * u);
}

/* The line through the neighbours at y: its value there is (c0 + c1 d) weight, summed over them. */
typedef struct line {
  double value, c0, c1;
} line;

static line fit_line(const fg_colour_shift *shift, double y_mm, double reach_mm) {
  double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *p = &shift->windows[i];
    double d = (double)p->y_mm - y_mm, weight = window_weight(p, d, reach_mm),
           value = (double)p->dy_um;
    s0 += weight;
    s1 += weight * d;
    s2 += weight * d * d;
    t0 += weight * value;
    t1 += weight * d * value;
  }
  double det = s0 * s2 - s1 * s1;
  if (!(det > 1e-9 * s0 * s2)) return (line){t0 / s0, 1 / s0, 0};
  return (line){(s2 * t0 - s1 * t1) / det, s2 / det, -s1 / det};
}

/* Uncertainty of the line's value: from the windows' own errors, and from shared ones. */
static double uncertainty_of(const fg_colour_shift *shift, const line *at, double y_mm,
                             double reach_mm) {
  double own = 0, lean[SHARED] = {0};
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *p = &shift->windows[i];
    double d = (double)p->y_mm - y_mm, u = (double)p->u_own_um;
    double share = (at->c0 + at->c1 * d) * window_weight(p, d, reach_mm);
    own += share * share * u * u;
    for (int k = 0; k < SHARED; k++)
      lean[k] += share * (double)p->shared_um[k];
  }
  for (int k = 0; k < SHARED; k++)
    own += lean[k] * lean[k];
  return sqrt(own);
}

/* Weighted error of predicting every point from the others. */
static double left_out_error(const fg_colour_shift *shift, double reach_mm) {
  double sum = 0;
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *p = &shift->windows[i];
    line at = fit_line(shift, (double)p->y_mm, reach_mm);
    double share = at.c0 * window_weight(p, 0, reach_mm); /* of the point in its own value */
    if (share >= 0.999) return INFINITY;
    double error = ((double)p->dy_um - at.value) / (1 - share) / (double)p->u_own_um;
    sum += error * error;
  }
  return sum;
}

/* Smooths with the reach of smallest cross-validation error. */
static void smooth_drift(fg_colour_shift *shift) {
  size_t count = shift->window_count;
  if (!count) return;
  double span = (double)(shift->windows[count - 1].y_mm - shift->windows[0].y_mm);
  double best = 2 * span + 1e-6, reach = best, min = left_out_error(shift, best);
  for (int k = 0; k < BANDWIDTHS; k++, reach /= BANDWIDTH_FACTOR) {
    double error = left_out_error(shift, reach);
    if (!(error < min)) continue;
    min = error;
    best = reach;
  }
  for (size_t i = 0; i < count; i++) {
    fg_colour_window *p = &shift->windows[i];
    line at = fit_line(shift, (double)p->y_mm, best);
    p->smooth_um = (float)at.value;
    p->u_smooth_um = (float)uncertainty_of(shift, &at, (double)p->y_mm, best);
  }
}

double fg_colour_drift_at(const fg_colour_shift *shift, double y_mm) {
  size_t count = shift->window_count, next = 0;
  if (!count) return 0;
  while (next < count && (double)shift->windows[next].y_mm < y_mm)
    next++;
  if (next == 0 || next == count) return (double)shift->windows[next ? count - 1 : 0].smooth_um;
  const fg_colour_window *a = &shift->windows[next - 1], *b = &shift->windows[next];
  double share = (y_mm - (double)a->y_mm) / (double)(b->y_mm - a->y_mm);
  return (1 - share) * (double)a->smooth_um + share * (double)b->smooth_um;
}

/* The drift about its mean, px. */
typedef struct about_mean {
  const fg_colour_shift *shift;
  double mean_um, pixel_um;
} about_mean;

static double drift_px(const void *user, double y_mm) {
  const about_mean *about = user;
  return (fg_colour_drift_at(about->shift, y_mm) - about->mean_um) / about->pixel_um;
}

static about_mean find_mean(const fg_colour_rows *rows, fg_colour_shift *shift) {
  double weight = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *p = &shift->windows[i];
    double w = 1 / ((double)p->u_own_um * (double)p->u_own_um), at = (double)p->smooth_um;
    weight += w;
    sum += w * at;
    squares += w * at * at;
  }
  double mean = weight > 0 ? sum / weight : 0;
  shift->drift_rms_um = weight > 0 ? sqrt(fmax(0, squares / weight - mean * mean)) : NAN;
  return (about_mean){shift, mean, 1e3 * rows->pixel_mm[1]};
}

/* Puts the shared unknowns and the mean of the windows' dy into the values of the rows. */
static void set_shared_values(fg_colour_rows *rows, const windows *w) {
  double weight = 0, sum = 0, lean[SHARED] = {0}, variance = 0;
  size_t shared = shared_count(rows);
  memset(rows->covariance, 0, sizeof rows->covariance);
  for (size_t i = 0; i < w->count; i++) {
    weight += w->list[i].weight;
    sum += w->list[i].weight * w->list[i].dy;
    for (size_t k = 0; k < shared; k++)
      lean[k] -= w->list[i].shared[k];
  }
  for (size_t i = 0; i < shared; i++)
    for (size_t k = 0; k < shared; k++) {
      rows->covariance[shared_unknowns[i]][shared_unknowns[k]] = w->covariance[i][k];
      variance += lean[i] * lean[k] * w->covariance[i][k] / (weight * weight);
    }
  for (size_t k = 0; k < shared; k++)
    rows->values[shared_unknowns[k]] = w->shared[k];
  rows->values[FG_COLOUR_DY] = sum / weight;
  rows->covariance[FG_COLOUR_DY][FG_COLOUR_DY] = 1 / weight + variance;
}

/* Takes the shared unknowns from a fit with one dy, when nothing contradicts a constant dy. Beside
 * a drift as free as the windows' their uncertainty would stay in every window. */
static void use_constant_fit(const fg_colour_rows *rows, windows *w) {
  size_t shared = shared_count(rows);
  for (size_t i = 0; i < shared; i++) {
    w->shared[i] = rows->values[shared_unknowns[i]];
    for (size_t k = 0; k < shared; k++)
      w->covariance[i][k] = rows->covariance[shared_unknowns[i]][shared_unknowns[k]];
  }
  factorise_shared(w, shared);
  find_window_means(w, shared);
}

/* F of a dy for every window against one for all, on the same rows. Slow drifts show in few
 * windows, steps and ripples in many: the better of two tests. */
static double test_constant(fg_colour_rows *rows, const windows *fine, windows *scratch) {
  double used = 0, constant, min = 1;
  for (size_t i = 0; i < rows->count; i++)
    used += rows->list[i].used;
  double dof = used - (double)fine->count - (double)shared_count(rows);
  if (fine->count < 3 || dof < 1) return NAN;
  double variance = rows->correlation * fine->misfit / dof;
  lay_out(rows, 1, scratch);
  if (!solve_windows(rows, scratch)) return NAN;
  constant = scratch->misfit;
  lay_out(rows, COARSE, scratch);
  const windows *both[2] = {fine, solve_windows(rows, scratch) ? scratch : fine};
  for (int k = 0; k < 2; k++) {
    double between = (double)both[k]->count - 1;
    double f = fmax(0, constant - both[k]->misfit) / between / variance;
    min = fmin(min, fg_distribution_f_upper(f, between, dof / rows->correlation));
  }
  return fmin(1, 2 * min);
}

/* Finds the drift. The rows' scatter and its correlation are those about the smooth drift:
 * about a constant they would hold the drift itself. */
static bool fit_drift(fg_colour_rows *rows, windows *w, windows *scratch, fg_colour_shift *shift) {
  fg_colour_rows constant = *rows;
  lay_out(rows, FG_COLOUR_WINDOWS_MAX, w);
  shift->window_mm = w->length_mm;
  if (!find_windows(rows, w)) return false;
  set_shared_values(rows, w);
  write_points(rows, w, shift);
  smooth_drift(shift);
  about_mean about = find_mean(rows, shift);
  fg_colour_rows_scatter(rows, drift_px, &about);
  shift->p_constant = test_constant(rows, w, scratch);
  if (!(shift->p_constant < FG_COLOUR_UNEVEN_P)) {
    memcpy(rows->values, constant.values, sizeof rows->values);
    memcpy(rows->covariance, constant.covariance, sizeof rows->covariance);
    use_constant_fit(rows, w);
  }
  write_points(rows, w, shift);
  smooth_drift(shift);
  find_mean(rows, shift);
  return true;
}

fg_status fg_colour_drift_find(fg_context *ctx, fg_colour_rows *rows, fg_colour_shift *shift,
                               bool *told) {
  windows *w;
  FG_TRY(fg_memory_allocate(ctx, 2, sizeof *w, (void **)&w));
  *told = fit_drift(rows, &w[0], &w[1], shift);
  free(w);
  return FG_OK;
}
