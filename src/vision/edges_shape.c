/* The shape of the edges along a strip: mean profiles of segments, fitted and smoothed. */
#include "vision/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"

#define BIN_PX 0.25
enum {
  BINS_MAX = 512,
  SEGMENT_STATIONS = 48, /* stations in one mean profile */
  GAMMA_SEGMENTS = 8,    /* profiles that are asked for the tone curve */
  BASIS_MAX = 7,
};

typedef struct segment {
  fg_profile_bin *bins;
  fg_profile_fit fit;
  double basis[BASIS_MAX]; /* direction and place of its middle */
} segment;

typedef struct segment_list {
  segment *items;
  fg_profile_bin *bins;
  size_t count, bin_count;
} segment_list;

static void free_segments(segment_list *list) {
  free(list->items);
  free(list->bins);
}

/* Functions of the normal's direction (two harmonics) and of the place (linear), about -1 to 1. */
static void fill_basis(const fg_reference *reference, size_t station, double *basis) {
  const fg_reference_station *s = &reference->stations[station];
  const fg_reference_station *m = &reference->stations[reference->count / 2];
  double scale = 1.0 / (1 + (double)reference->count * reference->step_px * 0.5);
  double c = -s->ty, n = s->tx;
  basis[0] = 1;
  basis[1] = c;
  basis[2] = n;
  basis[3] = c * c - n * n;
  basis[4] = 2 * c * n;
  basis[5] = (s->x - m->x) * scale;
  basis[6] = (s->y - m->y) * scale;
}

static fg_status stack_profiles(fg_context *ctx, const fg_edge_work *work, segment_list *list) {
  size_t stations = work->reference->count;
  double half = work->width_px / 2 + work->reach_px;
  list->count = (stations + SEGMENT_STATIONS - 1) / SEGMENT_STATIONS;
  list->bin_count = (size_t)(2 * half / BIN_PX) + 1;
  if (list->bin_count > BINS_MAX) list->bin_count = BINS_MAX;
  FG_TRY(fg_memory_allocate(ctx, list->count, sizeof *list->items, (void **)&list->items));
  FG_TRY(fg_memory_allocate(ctx, list->count * list->bin_count, sizeof *list->bins,
                            (void **)&list->bins));
  for (size_t i = 0; i < list->count; i++) {
    list->items[i].bins = list->bins + i * list->bin_count;
    size_t middle = i * SEGMENT_STATIONS + SEGMENT_STATIONS / 2;
    fill_basis(work->reference, middle < stations ? middle : stations - 1, list->items[i].basis);
  }
  for (size_t i = 0; i < work->band->count; i++) {
    const fg_band_pixel *p = &work->band->pixels[i];
    double across = p->across_px - work->stations[p->station].middle_px;
    double at = (across + half) / BIN_PX;
    if (at < 0 || at >= (double)list->bin_count) continue;
    fg_profile_bin *bin = &list->items[p->station / SEGMENT_STATIONS].bins[(size_t)at];
    bin->across_px += across;
    bin->value += p->value;
    bin->count += 1;
  }
  for (size_t i = 0; i < list->count * list->bin_count; i++) {
    fg_profile_bin *bin = &list->bins[i];
    if (bin->count <= 0) continue;
    bin->across_px /= bin->count;
    bin->value /= bin->count;
  }
  return FG_OK;
}

/* A start for the fit: levels from the ends and the middle of the profile. */
static void start_fit(const fg_edge_work *work, const segment *s, size_t bins,
                      fg_profile_fit *fit) {
  double level[3] = {0}, weight[3] = {0};
  double half = work->width_px / 2;
  for (size_t i = 0; i < bins; i++) {
    const fg_profile_bin *b = &s->bins[i];
    int where = b->across_px < -half - 6 ? 0 : b->across_px > half + 6 ? 2 : 1;
    if (where == 1 && fabs(b->across_px) > half / 3) continue;
    level[where] += b->value * b->count;
    weight[where] += b->count;
  }
  for (int i = 0; i < 3; i++) level[i] = weight[i] > 0 ? level[i] / weight[i] : 0;
  memset(fit, 0, sizeof *fit);
  double gamma = work->tables->gamma;
  fit->shape = (fg_edge_shape){.plateau = fg_edge_light(gamma, level[1]),
                               .level = {fg_edge_light(gamma, level[0]),
                                         fg_edge_light(gamma, level[2])},
                               .blur_px = {1.5, 1.5}};
  fit->edge_px[0] = -half;
  fit->edge_px[1] = half;
  fit->gamma = gamma;
}

/* gamma from a few profiles; 1 when it does not differ from 1 by more than its uncertainty. The
 * middle of the sorted values stands for all: a profile that holds a fillet or dust is no vote. */
static double find_gamma(const fg_edge_work *work, const segment_list *list) {
  double values[GAMMA_SEGMENTS], u = 0;
  int count = 0;
  for (int i = 0; i < GAMMA_SEGMENTS; i++) {
    size_t at = (size_t)((i + 1) * (double)list->count / (GAMMA_SEGMENTS + 1));
    fg_profile_fit fit;
    start_fit(work, &list->items[at], list->bin_count, &fit);
    fg_profile_fit_model(list->items[at].bins, list->bin_count, 0, &fit);
    if (!fit.good) continue;
    fg_profile_fit_model(list->items[at].bins, list->bin_count, 1, &fit);
    if (!fit.good) continue;
    int j = count++;
    for (; j > 0 && values[j - 1] > fit.gamma; j--) values[j] = values[j - 1];
    values[j] = fit.gamma;
    u += fit.u_gamma;
  }
  if (count < 3) return 1;
  double gamma = values[count / 2], spread = values[count * 3 / 4] - values[count / 4];
  double doubt = fmax(u / count, spread) / sqrt(count);
  return fabs(gamma - 1) > fmax(3 * doubt, 0.02) ? fmin(fmax(gamma, 0.33), 3.5) : 1;
}

static double *shape_value(fg_edge_shape *shape, int i) {
  double *values[FG_EDGE_SHAPE_VALUES] = {&shape->plateau,   &shape->level[0],   &shape->level[1],
                                          &shape->slope[0],  &shape->slope[1],
                                          &shape->blur_px[0], &shape->blur_px[1]};
  return values[i];
}

static size_t basis_size(size_t good) {
  return good >= 20 ? BASIS_MAX : good >= 8 ? 3 : 1;
}

/* Fits value i of all good segments by the basis; two rounds, the second without those that lie
 * more than four robust deviations off. Returns how far the scatter exceeds the segments' own
 * uncertainty, as the share of it that is real (0 to 1). */
static double smooth_value(segment_list *list, int i, size_t unknowns, double *coefficients) {
  double limit = INFINITY, real = 0;
  for (int round = 0; round < 3; round++) {
    fg_normal_equations system;
    fg_normal_clear(&system, unknowns);
    double sum = 0, expected = 0, count = 0;
    for (size_t s = 0; s < list->count; s++) {
      segment *item = &list->items[s];
      if (!item->fit.good) continue;
      double value = *shape_value(&item->fit.shape, i), predicted = 0;
      for (size_t b = 0; b < unknowns; b++) predicted += coefficients[b] * item->basis[b];
      if (round > 0 && fabs(value - predicted) > limit) continue;
      if (round > 0) {
        sum += (value - predicted) * (value - predicted);
        expected += item->fit.sd[i] * item->fit.sd[i];
        count++;
      }
      fg_normal_add(&system, item->basis, value, 1);
    }
    for (size_t b = 1; b < unknowns; b++) system.matrix[b][b] += 1e-3 * system.matrix[0][0];
    double x[FG_SMALL_MAX];
    if (!fg_normal_solve(&system, 0, x, NULL)) return 0;
    memcpy(coefficients, x, unknowns * sizeof *x);
    double absolute[1024];
    size_t n = 0;
    for (size_t s = 0; s < list->count && n < 1024; s++) {
      segment *item = &list->items[s];
      if (!item->fit.good) continue;
      double predicted = 0;
      for (size_t b = 0; b < unknowns; b++) predicted += coefficients[b] * item->basis[b];
      double a = fabs(*shape_value(&item->fit.shape, i) - predicted);
      size_t j = n++;
      for (; j > 0 && absolute[j - 1] > a; j--) absolute[j] = absolute[j - 1];
      absolute[j] = a;
    }
    limit = n ? 4 * 1.4826 * absolute[n / 2] + 1e-9 : INFINITY;
    if (count > (double)unknowns + 4 && sum > 0)
      real = fmax(0, 1 - 2 * expected / (sum * count / (count - (double)unknowns)));
  }
  return real;
}

/* The smoothed value at every station: basis plus the real share of the segments' own deviation,
 * linear between segment middles. */
static void spread_value(const fg_edge_work *work, segment_list *list, int i, size_t unknowns,
                         const double *coefficients, double real) {
  double basis[BASIS_MAX];
  for (size_t k = 0; k < work->reference->count; k++) {
    fill_basis(work->reference, k, basis);
    double value = 0;
    for (size_t b = 0; b < unknowns; b++) value += coefficients[b] * basis[b];
    double at = ((double)k - SEGMENT_STATIONS / 2.0) / SEGMENT_STATIONS;
    at = fmin(fmax(at, 0), (double)list->count - 1);
    size_t s0 = (size_t)at, s1 = s0 + 1 < list->count ? s0 + 1 : s0;
    for (int side = 0; side < 2 && real > 0; side++) {
      segment *item = &list->items[side ? s1 : s0];
      double share = side ? at - (double)s0 : 1 - (at - (double)s0);
      if (!item->fit.good) continue;
      double predicted = 0;
      for (size_t b = 0; b < unknowns; b++) predicted += coefficients[b] * item->basis[b];
      value += real * share * (*shape_value(&item->fit.shape, i) - predicted);
    }
    fg_edge_station *st = &work->stations[k];
    float *targets[FG_EDGE_SHAPE_VALUES] = {&st->plateau, &st->step[0], &st->step[1],
                                            &st->slope[0], &st->slope[1], &st->blur_px[0],
                                            &st->blur_px[1]};
    *targets[i] = (float)(i >= 5 ? fmax(value, 0.3) : value);
  }
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Median over the good segments of some value. */
static double median_of(segment_list *list, double (*get)(const segment *)) {
  double values[1024];
  size_t n = 0;
  for (size_t s = 0; s < list->count && n < 1024; s++)
    if (list->items[s].fit.good) values[n++] = get(&list->items[s]);
  if (!n) return NAN;
  qsort(values, n, sizeof *values, compare_doubles);
  return values[n / 2];
}

static double get_left(const segment *s) {
  return s->fit.edge_px[0];
}
static double get_right(const segment *s) {
  return s->fit.edge_px[1];
}
static double get_step(const segment *s) {
  return fabs(s->fit.shape.plateau - 0.5 * (s->fit.shape.level[0] + s->fit.shape.level[1]));
}
static double get_band(const segment *s) {
  return fabs(s->fit.shape.level[1] - s->fit.shape.level[0]);
}
static double get_blur_left(const segment *s) {
  return s->fit.shape.blur_px[0];
}
static double get_blur_right(const segment *s) {
  return s->fit.shape.blur_px[1];
}
static double get_extreme(const segment *s) {
  double high = fmax(s->fit.shape.plateau, fmax(s->fit.shape.level[0], s->fit.shape.level[1]));
  return high;
}

static void summarise(fg_edge_work *work, segment_list *list) {
  double left = median_of(list, get_left), right = median_of(list, get_right);
  work->thickness_px = right - left;
  work->contrast = median_of(list, get_step);
  work->blur_px[0] = median_of(list, get_blur_left);
  work->blur_px[1] = median_of(list, get_blur_right);
  work->side_band = median_of(list, get_band) > 0.08 * work->contrast;
  work->clipped = median_of(list, get_extreme) > 253.5;
  for (size_t k = 0; k < work->reference->count; k++) {
    fg_edge_station *st = &work->stations[k];
    st->edge_px[0] = st->middle_px + (float)left;
    st->edge_px[1] = st->middle_px + (float)right;
    st->step[0] -= st->plateau;
    st->step[1] -= st->plateau;
  }
}

fg_status fg_edges_find_shape(fg_context *ctx, fg_edge_work *work, bool find_tone) {
  segment_list list = {0};
  fg_status status = FG_OK;
  size_t good = 0;
  FG_TRY_EXIT(stack_profiles(ctx, work, &list));
  if (find_tone) {
    work->gamma = find_gamma(work, &list);
    fg_edge_tables_init(work->tables, work->gamma);
  }
  for (size_t i = 0; i < list.count; i++) {
    start_fit(work, &list.items[i], list.bin_count, &list.items[i].fit);
    fg_profile_fit_model(list.items[i].bins, list.bin_count, 0, &list.items[i].fit);
    good += list.items[i].fit.good != 0;
  }
  if (good < 3 || good * 3 < list.count) {
    status = fg_fail(ctx, FG_ERR_NUMERIC, "no pair of edges along the strip");
    goto exit;
  }
  for (int i = 0; i < FG_EDGE_SHAPE_VALUES; i++) {
    double coefficients[BASIS_MAX] = {0};
    size_t unknowns = basis_size(good);
    double real = smooth_value(&list, i, unknowns, coefficients);
    spread_value(work, &list, i, unknowns, coefficients, real);
  }
  summarise(work, &list);
exit:
  free_segments(&list);
  return status;
}
