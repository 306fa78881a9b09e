/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/ends.h"

#include <math.h>
#include <string.h>

#include "core/small_solve.h"

/* Number of stations whose middle is continued beyond the last one: 1 mm at 4800 dpi. */
enum { TAIL_STATIONS = 96, TAIL_MIN = 12 };
/* Reach of the search for a cut beyond the last usable station, in strip widths. */
#define REACH_WIDTHS 4.0
/* Window of fitted pixels to either side of the cut: blurs, and more pixels. */
#define WINDOW_BLURS 4.0
#define WINDOW_PX    5.0
/* Distance of the fitted pixels from the strip's edges, in blurs; of a narrow strip this share. */
#define INSIDE_BLURS 1.0
#define INSIDE_SHARE 0.35
/* Limits of a cut: its step is at least this share of the sides', its blur and slope at most so
 * much. */
#define STEP_SHARE 0.5
#define BLUR_MAX   12.0
#define SKEW_MAX   0.7
/* Limit of a pixel that is no dust, as at the sides: noise sd and a share of the contrast. The cut
 * is hidden by so many dust pixels, and a misfit of this share of the contrast means that there is
 * no cut. */
#define OUTLIER_SIGMAS 6.0
#define OUTLIER_SHARE  0.25
#define USED_SHARE     0.75
#define MISFIT_SHARE   0.12
enum { ROUNDS = 40, REWEIGHTS = 3, ROWS_MAX = 256, ROWS_TOGETHER = 3, BLOCKS_MIN = 3 };

enum { PLACE, SKEW, BLUR, LEVEL, SLOPE, GAIN, FALL, UNKNOWNS };

/* One end of the strip in work. */
typedef struct end_view {
  const fg_edge_work *work;
  double x, y, ux, uy; /* origin of u, and its direction, outwards; v runs along (vx, vy) */
  double vx, vy;
  double parabola[3]; /* v of the middle: a + b u + c u² */
  double half_px;     /* of the strip's width */
  double inside_px;   /* max distance of used pixels from the middle */
  const fg_edge_station *shape;
  double fit[UNKNOWNS], limit;
} end_view;

static bool is_good(const fg_edge_work *work, size_t i) {
  return work->stations[i].weight > 0;
}

/* Returns the usable station next to an end; the count where there is none. */
static size_t last_good(const fg_edge_work *work, bool last) {
  size_t count = work->reference->count;
  for (size_t k = 0; k < count; k++) {
    size_t i = last ? count - 1 - k : k;
    if (is_good(work, i)) return i;
  }
  return count;
}

/* Fits the middle near the end as a parabola, and the mean half width. */
static bool fit_middle(end_view *view, size_t from, bool last) {
  const fg_edge_work *work = view->work;
  const fg_reference_station *at = &work->reference->stations[from];
  size_t count = work->reference->count, used = 0;
  double width = 0;
  fg_normal_equations system;
  view->x = at->x;
  view->y = at->y;
  view->ux = last ? at->tx : -at->tx;
  view->uy = last ? at->ty : -at->ty;
  view->vx = -at->ty;
  view->vy = at->tx;
  fg_normal_clear(&system, 3);
  for (size_t k = 0; k < TAIL_STATIONS && k < count; k++) {
    if (last ? k > from : from + k >= count) break;
    size_t i = last ? from - k : from + k;
    if (!is_good(work, i)) continue;
    const fg_reference_station *r = &work->reference->stations[i];
    const float *edge = work->stations[i].edge_px;
    double middle = 0.5 * ((double)edge[0] + edge[1]);
    double dx = r->x - middle * r->ty - view->x, dy = r->y + middle * r->tx - view->y;
    double u = dx * view->ux + dy * view->uy;
    const double row[3] = {1, u, u * u};
    fg_normal_add(&system, row, dx * view->vx + dy * view->vy, 1);
    width += edge[1] - edge[0];
    used++;
  }
  if (used < TAIL_MIN || !fg_normal_solve(&system, 0, view->parabola, NULL)) return false;
  view->half_px = 0.5 * width / (double)used;
  view->shape = &work->stations[from];
  double blur = fmax(work->blur_px[0], work->blur_px[1]);
  view->inside_px = fmax(view->half_px - INSIDE_BLURS * blur, INSIDE_SHARE * view->half_px);
  return true;
}

static double middle_at(const end_view *view, double u) {
  return view->parabola[0] + u * (view->parabola[1] + u * view->parabola[2]);
}

static fg_point point_at(const end_view *view, double u, double v) {
  v += middle_at(view, u);
  return (fg_point){view->x + u * view->ux + v * view->vx, view->y + u * view->uy + v * view->vy};
}

/* One side's part of the strip's profile, in light. */
static double side_part(const end_view *view, int side, double d) {
  const fg_edge_station *s = view->shape;
  double t = d / s->blur_px[side], cum = 0.5 * erfc(-t * M_SQRT1_2);
  double phi = exp(-0.5 * t * t) / sqrt(2 * M_PI);
  return (s->step[side] + s->slope[side] * d) * cum + s->slope[side] * s->blur_px[side] * phi;
}

static double strip_light(const end_view *view, double v) {
  return view->shape->plateau + side_part(view, 0, -view->half_px - v) +
         side_part(view, 1, v - view->half_px);
}

/* The count at (u, v), and its derivatives. */
static double model_at(const end_view *view, const double *x, double u, double v, double *row) {
  double d = u - x[PLACE] - x[SKEW] * v, t = d / x[BLUR];
  double cum = 0.5 * erfc(-t * M_SQRT1_2), phi = exp(-0.5 * t * t) / sqrt(2 * M_PI);
  double own = strip_light(view, v), strip = x[GAIN] * own * (1 + x[FALL] * d);
  double beyond = x[LEVEL] + x[SLOPE] * d, blur = x[BLUR];
  double light = fmax(strip + (beyond - strip) * cum + x[SLOPE] * blur * phi, 1e-3);
  double rate, value = fg_edges_count(view->work, light, &rate);
  double fall = x[GAIN] * own * x[FALL];
  double by_d =
      fall * (1 - cum) + x[SLOPE] * cum + (beyond - strip) * phi / blur - x[SLOPE] * phi * t;
  row[PLACE] = -rate * by_d;
  row[SKEW] = -rate * by_d * v;
  row[BLUR] = rate * (-(beyond - strip) * t * phi / blur + x[SLOPE] * phi * (1 + t * t));
  row[LEVEL] = rate * cum;
  row[SLOPE] = rate * (d * cum + blur * phi);
  row[GAIN] = rate * (1 - cum) * own * (1 + x[FALL] * d);
  row[FALL] = rate * (1 - cum) * x[GAIN] * own * d;
  return value;
}

typedef void visit_pixel(const end_view *view, double u, double v, double value, void *data);

/* Visits every pixel between two places along, within `inside` of the middle. */
static void visit_pixels(const end_view *view, double from, double to, visit_pixel *take,
                         void *data) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int k = 0; k < 6; k++) {
    double u = from + (to - from) * (k / 2) / 2;
    fg_point p = point_at(view, u, k % 2 ? view->inside_px : -view->inside_px);
    low[0] = fmin(low[0], p.x);
    low[1] = fmin(low[1], p.y);
    high[0] = fmax(high[0], p.x);
    high[1] = fmax(high[1], p.y);
  }
  for (int64_t y = (int64_t)floor(low[1]); y <= (int64_t)ceil(high[1]); y++)
    for (int64_t x = (int64_t)floor(low[0]); x <= (int64_t)ceil(high[0]); x++) {
      double dx = (double)x - view->x, dy = (double)y - view->y;
      double u = dx * view->ux + dy * view->uy;
      double v = dx * view->vx + dy * view->vy - middle_at(view, u);
      double value = fg_tiles_pixel(view->work->tiles, x, y);
      if (u < from || u > to || fabs(v) > view->inside_px || isnan(value)) continue;
      take(view, u, v, value, data);
    }
}

/* Mean depth of the pixels by place: 0 at the strip's level, 1 at the background's. */
typedef struct depth {
  double from, sum[1024], count[1024];
  size_t bins;
} depth;

static double background_light(const end_view *view) {
  const fg_edge_station *s = view->shape;
  return (double)s->plateau + 0.5 * ((double)s->step[0] + s->step[1]);
}

static void add_depth(const end_view *view, double u, double v, double value, void *data) {
  depth *all = data;
  double light = fg_edges_light(view->work, value), own = strip_light(view, v);
  size_t bin = (size_t)(u - all->from);
  if (bin >= all->bins) return;
  all->sum[bin] += (light - own) / (background_light(view) - own);
  all->count[bin]++;
}

/* Finds the place where the strip's level falls by half for good; false: nowhere. */
static bool find_rough(const end_view *view, double *u) {
  double reach = REACH_WIDTHS * 2 * view->half_px;
  depth all = {.from = -reach / 4, .bins = (size_t)fmin(1.25 * reach, 1023)};
  visit_pixels(view, all.from, all.from + (double)all.bins, add_depth, &all);
  size_t first = 0;
  while (first < all.bins && all.count[first] > 0 && all.sum[first] < 0.5 * all.count[first])
    first++;
  if (first == 0 || first + 2 >= all.bins || !(all.count[first] > 0)) return false;
  for (size_t i = first; i < first + 3; i++)
    if (!(all.sum[i] > 0.4 * all.count[i])) return false;
  *u = all.from + (double)first;
  return true;
}

typedef struct sums {
  fg_normal_equations system;
  const double *x;
  size_t used, seen;
} sums;

static void add_sums(const end_view *view, double u, double v, double value, void *data) {
  sums *all = data;
  double row[UNKNOWNS], residual = value - model_at(view, all->x, u, v, row);
  all->seen++;
  if (fabs(residual) > view->limit) return;
  fg_normal_add(&all->system, row, residual, 1);
  all->used++;
}

static void find_window(const end_view *view, double at, double blur, double *from, double *to) {
  double skew = fabs(view->fit[SKEW]) * view->inside_px;
  double reach = WINDOW_BLURS * blur + WINDOW_PX + skew;
  *from = at - reach;
  *to = at + reach;
}

static bool is_sensible(const end_view *view, const double *x, double from, double to) {
  double side = fabs(background_light(view) - view->shape->plateau);
  double step = fabs(x[LEVEL] - x[GAIN] * view->shape->plateau);
  return x[PLACE] > from && x[PLACE] < to && fabs(x[SKEW]) < SKEW_MAX && x[BLUR] > 0.2 &&
         x[BLUR] < BLUR_MAX && step > STEP_SHARE * side && x[GAIN] > 0.3 && x[GAIN] < 3;
}

static void gather_sums(const end_view *view, const double *x, double from, double to, sums *all) {
  fg_normal_clear(&all->system, UNKNOWNS);
  all->x = x;
  all->used = all->seen = 0;
  visit_pixels(view, from, to, add_sums, all);
}

/* Damped Gauss-Newton within one window; *all holds the sums at the result. */
static bool fit_window(end_view *view, double from, double to, sums *all) {
  double damping = 1e-4, dx[FG_SMALL_MAX], trial[UNKNOWNS];
  sums next;
  gather_sums(view, view->fit, from, to, all);
  bool moved = false;
  for (int i = 0; i < ROUNDS && damping < 1e6; i++) {
    if (all->used < 3 * UNKNOWNS || !fg_normal_solve(&all->system, damping, dx, NULL)) return false;
    for (int k = 0; k < UNKNOWNS; k++)
      trial[k] = view->fit[k] + dx[k];
    bool sensible = is_sensible(view, trial, from, to);
    if (sensible) gather_sums(view, trial, from, to, &next);
    if (!sensible || !(next.system.sum_squares / (double)next.used <=
                       all->system.sum_squares / (double)all->used)) {
      damping = fmax(10 * damping, 1e-6);
      continue;
    }
    double gain = all->system.sum_squares - next.system.sum_squares;
    memcpy(view->fit, trial, sizeof trial);
    *all = next;
    all->x = view->fit;
    damping *= 0.1;
    moved = true;
    if (fabs(gain) <= 1e-9 * all->system.sum_squares) break;
  }
  return moved;
}

/* Deviation of the cut's place in each row of pixels along it. */
typedef struct rows {
  const double *x;
  double top[ROWS_MAX], weight[ROWS_MAX];
} rows;

static void add_end_row(const end_view *view, double u, double v, double value, void *data) {
  rows *all = data;
  double row[UNKNOWNS], residual = value - model_at(view, all->x, u, v, row);
  size_t bin = (size_t)(v + view->inside_px);
  if (fabs(residual) > view->limit || bin >= ROWS_MAX) return;
  all->top[bin] += row[PLACE] * residual;
  all->weight[bin] += row[PLACE] * row[PLACE];
}

/* Standard deviation of the place from the differences of blocks of rows: it includes correlation
 * of pixels, and the cut's own roughness. */
static double scatter_of_rows(const end_view *view, double from, double to) {
  rows all = {.x = view->fit};
  double mean = 0, squares = 0, weights = 0, value[ROWS_MAX], weight[ROWS_MAX];
  size_t count = (size_t)fmin(2 * view->inside_px, ROWS_MAX), blocks = 0;
  visit_pixels(view, from, to, add_end_row, &all);
  for (size_t i = 0; i + ROWS_TOGETHER <= count; i += ROWS_TOGETHER) {
    double top = 0, sum = 0;
    for (size_t k = i; k < i + ROWS_TOGETHER; k++) {
      top += all.top[k];
      sum += all.weight[k];
    }
    if (!(sum > 0)) continue;
    value[blocks] = top / sum;
    weight[blocks++] = sum;
    mean += top;
    weights += sum;
  }
  if (blocks < BLOCKS_MIN) return 0;
  mean /= weights;
  for (size_t i = 0; i < blocks; i++)
    squares += weight[i] * (value[i] - mean) * (value[i] - mean);
  /* Place and skew use two of the blocks' degrees of freedom. */
  return sqrt(squares / weights / (double)(blocks - 2));
}

/* Converts the cut from pixels to mm. */
static void fill_end(const end_view *view, const sums *all, double from, double to,
                     const double dpi[2], fg_strip_end *end) {
  double kx = 25.4 / dpi[0], ky = 25.4 / dpi[1], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  double x[FG_SMALL_MAX], um = 1000 * hypot(view->ux * kx, view->uy * ky);
  if (!fg_normal_solve(&all->system, 0, x, inverse)) return;
  double noise = sqrt(all->system.sum_squares / (double)(all->used - UNKNOWNS));
  if (noise > fmax(3 * view->work->noise, MISFIT_SHARE * view->work->contrast)) return;
  double u = fmax(noise * sqrt(inverse[PLACE][PLACE]), scatter_of_rows(view, from, to));
  for (int k = 0; k < 2; k++) {
    double v = k ? view->half_px : -view->half_px;
    fg_point p = point_at(view, view->fit[PLACE] + view->fit[SKEW] * v, v);
    *(k ? &end->right : &end->left) = (fg_point){p.x * kx, p.y * ky};
  }
  end->u_um = u * um;
  end->u_skew = noise * sqrt(inverse[SKEW][SKEW]);
  end->blur_um = view->fit[BLUR] * um;
  end->found = true;
}

static bool fit_end(end_view *view, double rough, const double dpi[2], fg_strip_end *end) {
  const fg_edge_work *work = view->work;
  double blur = fmax(0.5 * (work->blur_px[0] + work->blur_px[1]), 0.5), from, to;
  const double start[UNKNOWNS] = {rough, 0, blur, background_light(view), 0, 1, 0};
  sums all;
  memcpy(view->fit, start, sizeof start);
  for (int round = 0; round < REWEIGHTS; round++) {
    view->limit = round ? OUTLIER_SIGMAS * work->noise + OUTLIER_SHARE * work->contrast : INFINITY;
    find_window(view, view->fit[PLACE], fmax(view->fit[BLUR], blur), &from, &to);
    if (!fit_window(view, from, to, &all) && round == 0) return false;
  }
  if ((double)all.used < USED_SHARE * (double)all.seen || all.used < 3 * UNKNOWNS) return false;
  fill_end(view, &all, from, to, dpi, end);
  return end->found;
}

static bool is_outside(const fg_tiles *tiles, fg_point p) {
  return p.x < 0 || p.y < 0 || p.x > (double)tiles->width_px - 1 ||
         p.y > (double)tiles->height_px - 1;
}

static void measure_end(const fg_edge_work *work, bool last, const double dpi[2],
                        fg_strip_end *end) {
  end_view view = {.work = work};
  size_t from = last_good(work, last);
  double rough = 0;
  if (from == work->reference->count || !fit_middle(&view, from, last)) return;
  if (find_rough(&view, &rough) && fit_end(&view, rough, dpi, end)) return;
  end->at_border = is_outside(work->tiles, point_at(&view, REACH_WIDTHS * 2 * view.half_px, 0));
}

void fg_ends_measure(const fg_edge_work *work, const double dpi[2], fg_strip *strip) {
  for (int i = 0; i < 2; i++) {
    strip->ends[i] = (fg_strip_end){
        .left = {NAN, NAN}, .right = {NAN, NAN}, .u_um = NAN, .u_skew = NAN, .blur_um = NAN};
    measure_end(work, i == 1, dpi, &strip->ends[i]);
  }
}
