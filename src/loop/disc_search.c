/* Which effects explain the points of discs.
 *
 * A plate tells the smooth effects apart, so sets of up to five are tried, and a set must not leave
 * one out that takes more than chance: the discs' own forms are in the noise and in the free curves
 * alike. Ripples and steps are looked for one at a time, in units of the noise that they leave.
 */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "loop/scan_loop.h"
#include "loop/subset_search.h"

enum {
  COLUMNS_MOST = 192,
  RIPPLE_STEPS = 400,
  STEP_STEPS = 200,
  REFINE_STEPS = 24,
  REFINE_LEVELS = 4
};
/* A column whose mean square is less than this beside the geometry is nothing. */
#define VANISHED 1e-8
/* A set is right when what it leaves beyond all effects is likelier than this. */
#define ACCEPT_P 0.001
/* Gain in chi² of one effect that is no chance. */
#define ONE_MORE_CHI2 12.0
/* Error of the edge model, um: effects below it are not told apart. */
#define EDGE_ERROR_UM 0.01
/* Gain in chi² that makes a ripple or a step worth a place in the search: its best of some hundred
 * places stands for ln of their number more. */
#define SHAPED_CHI2     45.0
#define SHAPED_LEAST_UM 0.15

static const fg_subset_effect smooth[] = {
    {.id = "scan.scale_y"},
    {.id = "scan.scale"},
    {.id = "scan.shear"},
    {.id = "scan.optical_quadratic", .shapes = 1},
    {.id = "scan.optical_cubic", .shapes = 1},
    {.id = "scan.carriage_quadratic", .shapes = 1},
    {.id = "part.ovality"},
    {.id = "free.scan.x.dx", .free = true},
    {.id = "free.scan.x.dy", .free = true},
    {.id = "free.scan.y.dx", .free = true},
    {.id = "free.scan.y.dy", .free = true},
    {.id = "free.edge.normal", .free = true},
};

typedef struct search {
  const fg_points *points;
  size_t rows; /* that are not kept aside */
  size_t *row;
  double *basis; /* orthonormal columns of the geometry, then of all effects */
  size_t geometry_rank;
  double *residual; /* beside the geometry */
  double *columns;  /* COLUMNS_MOST × rows: effects beside the geometry */
  size_t column_count, first_column[FG_SUBSET_EFFECTS];
  double *work; /* FG_SCAN_COLUMNS × all rows */
  double full;  /* residual sum beside everything, and the columns that took it */
  size_t full_rank;
  size_t new_shapes; /* ripples and steps that were found in this round */
  fg_subset *out;
} search;

static void take_out(const search *s, size_t rank, double *v) {
  for (int twice = 0; twice < 2; twice++)
    for (size_t k = 0; k < rank; k++) {
      double d = fg_subset_dot(s->rows, s->basis + k * s->rows, v);
      for (size_t i = 0; i < s->rows; i++)
        v[i] -= d * s->basis[k * s->rows + i];
    }
}

/* Adds v to the basis unless it lies in it already, or what it adds has no more than `least`. */
static bool extend(search *s, size_t rank, const double *v, double least) {
  double *to = s->basis + rank * s->rows, whole = fg_subset_dot(s->rows, v, v);
  memcpy(to, v, s->rows * sizeof *to);
  take_out(s, rank, to);
  double left = fg_subset_dot(s->rows, to, to);
  if (!(left > fmax(1e-12 * whole, least))) return false;
  for (size_t i = 0; i < s->rows; i++)
    to[i] /= sqrt(left);
  return true;
}

static double weight_of(const search *s, size_t i) {
  return sqrt(s->points->rows[s->row[i]].weight / FG_POINTS_BLOCK);
}

/* Weighted columns of an effect at the rows in use; returns how many. */
static size_t gather(const search *s, const char *id, const double *shape, double *out) {
  size_t all = s->points->row_count;
  size_t count = fg_points_effect_columns(s->points, id, shape, s->work);
  for (size_t c = 0; c < count; c++)
    for (size_t i = 0; i < s->rows; i++)
      out[c * s->rows + i] = weight_of(s, i) * s->work[c * all + s->row[i]];
  return count;
}

static void add_effect(search *s, const fg_subset_effect *effect) {
  fg_subset *out = s->out;
  size_t e = out->effect_count++;
  out->effects[e] = *effect;
  s->first_column[e] = s->column_count;
  double *to = s->columns + s->column_count * s->rows;
  out->effects[e].columns = out->effects[e].terms = gather(s, effect->id, effect->shape, to);
  effect = &out->effects[e];
  double whole = 0, left = 0;
  for (size_t c = 0; c < effect->columns; c++) {
    whole += fg_subset_dot(s->rows, to + c * s->rows, to + c * s->rows);
    take_out(s, s->geometry_rank, to + c * s->rows);
    left += fg_subset_dot(s->rows, to + c * s->rows, to + c * s->rows);
  }
  out->share[e] = whole > 0 ? left / whole : 0;
  s->column_count += effect->columns;
}

/* Residual sum with the columns of a mask fitted; the geometry is out already. */
static double residual_sum(const search *s, unsigned mask, double *freedom, double *amplitude_u) {
  fg_normal_equations system;
  size_t index[FG_SMALL_MAX], n = 0;
  for (size_t e = 0; e < s->out->effect_count; e++)
    for (size_t c = 0; (mask >> e & 1) && c < s->out->effects[e].columns && n < FG_SMALL_MAX; c++) {
      const double *p = s->columns + (s->first_column[e] + c) * s->rows;
      if (fg_subset_dot(s->rows, p, p) > VANISHED * (double)s->rows)
        index[n++] = s->first_column[e] + c;
    }
  fg_normal_clear(&system, n);
  double sum = fg_subset_dot(s->rows, s->residual, s->residual), x[FG_SMALL_MAX];
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], scale[FG_SMALL_MAX];
  for (size_t a = 0; a < n; a++) {
    const double *p = s->columns + index[a] * s->rows;
    scale[a] = 1 / sqrt(fmax(fg_subset_dot(s->rows, p, p), 1e-30));
    system.right[a] = scale[a] * fg_subset_dot(s->rows, p, s->residual);
    for (size_t b = 0; b <= a; b++)
      system.matrix[a][b] =
          scale[a] * scale[b] * fg_subset_dot(s->rows, p, s->columns + index[b] * s->rows);
  }
  *freedom = (double)n;
  if (n && fg_normal_solve(&system, 1e-12, x, inverse))
    for (size_t a = 0; a < n; a++)
      sum -= x[a] * system.right[a];
  if (amplitude_u && n) *amplitude_u = scale[n - 1] * sqrt(inverse[n - 1][n - 1]);
  return sum;
}

/* Integral of the correlation of what all effects leave. */
static double find_integral(const search *s, const double *left) {
  enum { LAGS = 16 };
  double products[LAGS] = {0}, pairs[LAGS] = {0}, integral = 1;
  for (size_t i = 0; i < s->rows; i++)
    for (size_t lag = 0; lag < LAGS && i + lag < s->rows; lag++) {
      const fg_points_row *a = &s->points->rows[s->row[i]], *b = &s->points->rows[s->row[i + lag]];
      if (a->view != b->view || a->group != b->group) break;
      products[lag] += left[i] * left[i + lag];
      pairs[lag]++;
    }
  for (size_t lag = 1; lag < LAGS && pairs[lag] > 0 && products[0] > 0; lag++) {
    double rho = products[lag] / pairs[lag] / (products[0] / pairs[0]);
    if (rho < 2 / sqrt(pairs[lag])) break;
    integral += 2 * rho;
  }
  return integral;
}

/* Noise of a row and its correlation, from what is left beside geometry and all effects. */
static size_t find_noise(search *s, double *left) {
  size_t rank = s->geometry_rank;
  for (size_t c = 0; c < s->column_count; c++)
    if (extend(s, rank, s->columns + c * s->rows, VANISHED * (double)s->rows)) rank++;
  memcpy(left, s->residual, s->rows * sizeof *left);
  take_out(s, rank, left);
  double freedom = fmax((double)s->rows - (double)rank, 1);
  s->full = fg_subset_dot(s->rows, left, left);
  s->full_rank = rank - s->geometry_rank;
  s->out->noise_um = sqrt(fg_subset_dot(s->rows, left, left) / freedom);
  s->out->integral = find_integral(s, left);
  return rank;
}

/* Gain of a shaped effect beside everything else, in chi². `best` (amplitude um) is set. */
static double shaped_gain(const search *s, size_t rank, const double *left, const char *id,
                          double shape, double *columns, double *amplitude) {
  double shapes[FG_LOOP_SHAPES] = {shape};
  size_t count = gather(s, id, shapes, columns);
  fg_normal_equations system;
  double x[FG_SMALL_MAX], gain = 0, square = 0;
  fg_normal_clear(&system, count);
  for (size_t a = 0; a < count; a++)
    take_out(s, rank, columns + a * s->rows);
  for (size_t a = 0; a < count; a++) {
    system.right[a] = fg_subset_dot(s->rows, columns + a * s->rows, left);
    for (size_t b = 0; b <= a; b++)
      system.matrix[a][b] = fg_subset_dot(s->rows, columns + a * s->rows, columns + b * s->rows);
    if (!(system.matrix[a][a] > 1e-3 * (double)s->rows / 64)) return 0;
  }
  if (!fg_normal_solve(&system, 1e-9, x, NULL)) return 0;
  for (size_t a = 0; a < count; a++) {
    gain += x[a] * system.right[a];
    square += x[a] * x[a];
  }
  *amplitude = sqrt(square);
  return gain / (s->out->noise_um * s->out->noise_um * s->out->integral);
}

/* The same gain in units of the noise that the effect leaves: where it is most of the residual, the
 * noise that it stands against must not hold it. */
static double gain_over_rest(search *s, size_t rank, const double *left, const char *id,
                             double shape, double *columns) {
  double amplitude, basis_left = fg_subset_dot(s->rows, left, left);
  double gain = shaped_gain(s, rank, left, id, shape, columns, &amplitude) * s->out->noise_um *
                s->out->noise_um * s->out->integral;
  size_t count = gather(s, id, &shape, columns), added = 0;
  double *rest = s->work; /* has room: FG_SCAN_COLUMNS per row */
  for (size_t c = 0; c < count; c++)
    added += extend(s, rank + added, columns + c * s->rows, VANISHED * (double)s->rows);
  memcpy(rest, left, s->rows * sizeof *rest);
  take_out(s, rank + added, rest);
  double freedom = fmax((double)s->rows - (double)(rank + added), 1);
  double noise = (basis_left - gain) / freedom;
  return noise > 0 ? gain / (noise * find_integral(s, rest)) : 0;
}

/* The best place of a shaped effect over a grid of `count` starts, then finer around it; its gain,
 * 0 when that is too little. */
static double find_shaped(search *s, size_t rank, const double *left,
                          const fg_subset_effect *effect,
                          double (*start)(const fg_points *, size_t, size_t), size_t count,
                          double *columns, fg_subset_effect *found) {
  double best = 0, amplitude = 0, at = 0, size = 0;
  size_t which = 0;
  for (size_t i = 0; i < count; i++) {
    double place = start(s->points, i, count);
    double gain = shaped_gain(s, rank, left, effect->id, place, columns, &amplitude);
    if (gain <= best) continue;
    best = gain;
    which = i;
    at = place;
    size = amplitude;
  }
  double low = start(s->points, which > 0 ? which - 1 : 0, count);
  double high = start(s->points, which + 1 < count ? which + 1 : which, count);
  for (int level = 0; level < REFINE_LEVELS && best > 0; level++) {
    double step = (high - low) / REFINE_STEPS;
    for (size_t i = 0; i <= REFINE_STEPS; i++) {
      double place = low + step * (double)i;
      double gain = shaped_gain(s, rank, left, effect->id, place, columns, &amplitude);
      if (gain <= best) continue;
      best = gain;
      at = place;
      size = amplitude;
    }
    low = at - step;
    high = at + step;
  }
  *found = *effect;
  found->shape[0] = at;
  if (s->points->discs && best > 0) best = gain_over_rest(s, rank, left, effect->id, at, columns);
  return best > SHAPED_CHI2 && size > SHAPED_LEAST_UM ? best : 0;
}

/* Ripples and steps stand alone even in one scan: they are sought beside all smooth effects. */
static fg_status find_shaped_effects(fg_context *ctx, search *s, double *left) {
  static const fg_subset_effect ripple = {.id = "scan.carriage_ripple", .columns = 2, .shapes = 1};
  static const fg_subset_effect step = {.id = "scan.row_step", .columns = 1, .shapes = 1};
  double *columns = NULL;
  FG_TRY(fg_memory_allocate(ctx, s->rows, 2 * sizeof *columns, (void **)&columns));
  /* One at a time: what a step leaves across itself would be read as a second one. */
  if (s->out->effect_count < FG_SUBSET_EFFECTS) {
    size_t rank = find_noise(s, left);
    fg_subset_effect wave, jump; /* each can be read as several of the other: the better one */
    double waves = 0, jumps = 0;
    if (fg_points_shows(s->points, ripple.id))
      waves = find_shaped(s, rank, left, &ripple, fg_subset_ripple_period, RIPPLE_STEPS, columns,
                          &wave);
    if (fg_points_shows(s->points, step.id))
      jumps = find_shaped(s, rank, left, &step, fg_subset_step_place, STEP_STEPS, columns, &jump);
    if (waves > 0 || jumps > 0) {
      add_effect(s, waves > jumps ? &wave : &jump);
      s->new_shapes++;
    }
  }
  find_noise(s, left);
  free(columns);
  return FG_OK;
}

/* What the search compares with: everything at once. */
typedef struct yardstick {
  double full, freedom, unit, allowance;
} yardstick;

static fg_subset_member try_set(const search *s, const yardstick *y, unsigned mask) {
  double used, left = residual_sum(s, mask, &used, NULL);
  return (fg_subset_member){
      .mask = mask, .excess = fmax(0, left - y->full) / y->unit, .freedom = y->freedom - used};
}

static bool is_right(const yardstick *y, const fg_subset_member *m) {
  return m->excess <=
         (m->freedom > 0 ? gsl_cdf_chisq_Qinv(ACCEPT_P, m->freedom) : 0) + y->allowance;
}

/* Whether one more listed effect takes more than chance. The forms of the discs are in the noise
 * and in the free curves alike, so that the sum of all of them says little of one. */
static bool one_more_helps(const search *s, const yardstick *y, const fg_subset_member *m) {
  for (size_t e = 0; e < s->out->effect_count; e++) {
    if (s->out->effects[e].free || (m->mask >> e & 1)) continue;
    if (m->excess - try_set(s, y, m->mask | 1u << e).excess > ONE_MORE_CHI2) return true;
  }
  return false;
}

/* Listed sets by size; the first size with one that is right ends the search. */
static fg_subset_member try_listed(search *s, const yardstick *y, size_t most) {
  unsigned listed = fg_subset_mask_of(s->out, false);
  fg_subset_member best = {.excess = INFINITY};
  for (size_t size = 0; size <= most && !s->out->member_count; size++)
    for (unsigned mask = 0; mask <= listed; mask++) {
      if ((mask & ~listed) || fg_subset_bits(mask) != size) continue;
      fg_subset_member member = try_set(s, y, mask);
      if (is_right(y, &member) && !one_more_helps(s, y, &member))
        fg_subset_keep_member(s->out, &member);
      if (member.excess < best.excess - 12) best = member;
    }
  return best;
}

/* A free curve, alone or beside one listed effect: the one that leaves least for its columns
 * (Schwarz's criterion); the best listed set stands when none does better. */
static void try_free(search *s, const yardstick *y, fg_subset_member best) {
  fg_subset *out = s->out;
  double price = log((double)s->rows / out->integral);
  double score = best.excess - price * best.freedom;
  for (size_t e = 0; e < out->effect_count; e++)
    for (size_t with = 0; with <= out->effect_count && out->effects[e].free; with++) {
      if (with < out->effect_count && out->effects[with].free) continue;
      unsigned mask = 1u << e | (with < out->effect_count ? 1u << with : 0);
      fg_subset_member member = try_set(s, y, mask);
      if (member.excess - price * member.freedom >= score - 10) continue;
      score = member.excess - price * member.freedom;
      best = member;
    }
  out->right = is_right(y, &best);
  fg_subset_keep_member(out, &best);
}

/* How many effects the points can tell apart. */
static size_t effects_most(const fg_points *points) {
  return points->part_count > 2 ? 5 : 2;
}

static void try_sets(search *s) {
  fg_subset *out = s->out;
  yardstick y = {.unit = out->noise_um * out->noise_um * out->integral};
  y.full = s->full;
  y.freedom = (double)s->full_rank;
  y.allowance = (double)s->rows * EDGE_ERROR_UM * EDGE_ERROR_UM / y.unit;
  fg_subset_member best = try_listed(s, &y, effects_most(s->points));
  out->right = out->member_count > 0;
  /* A ripple or step that was found just now has not been fitted with the geometry yet. */
  if (!out->member_count && s->new_shapes) fg_subset_keep_member(out, &best);
  if (!out->member_count) try_free(s, &y, best);
  double used, none = residual_sum(s, 0, &used, NULL);
  out->p_value =
      gsl_cdf_chisq_Q(fmax(0, none - y.full) / y.unit / (1 + y.allowance / y.freedom), y.freedom);
  for (size_t e = 0; e < out->effect_count; e++) {
    double u = 0;
    unsigned lone = 1u << e;
    out->alone[e] = 1 - residual_sum(s, lone, &used, NULL) / none;
    if (out->effects[e].free) continue;
    /* Three and a half standard deviations beside the winner: found in most cases. */
    residual_sum(s, (out->members[0].mask & fg_subset_mask_of(out, false) & ~lone) | lone, &used,
                 &u);
    out->smallest_um[e] = 3.5 * sqrt(y.unit) * u;
  }
}

static fg_status list_rows(fg_context *ctx, search *s) {
  const fg_points *points = s->points;
  FG_TRY(fg_memory_allocate(ctx, points->row_count, sizeof *s->row, (void **)&s->row));
  for (size_t i = 0; i < points->row_count; i++)
    if (!points->views[points->rows[i].view].aside) s->row[s->rows++] = i;
  return FG_OK;
}

static fg_status span_geometry(fg_context *ctx, search *s, const double *residual_um,
                               const double *jacobian) {
  const fg_points *points = s->points;
  FG_TRY(fg_memory_allocate(ctx, points->parameters + COLUMNS_MOST, s->rows * sizeof *s->basis,
                            (void **)&s->basis));
  FG_TRY(fg_memory_allocate(ctx, s->rows, sizeof *s->residual, (void **)&s->residual));
  FG_TRY(fg_memory_allocate(ctx, COLUMNS_MOST, s->rows * sizeof *s->columns, (void **)&s->columns));
  FG_TRY(fg_memory_allocate(ctx, points->row_count, FG_SCAN_COLUMNS * sizeof *s->work,
                            (void **)&s->work));
  double *column = s->residual; /* borrowed until the residual is put there */
  for (size_t a = 0; a < points->parameters; a++) {
    for (size_t i = 0; i < s->rows; i++)
      column[i] = weight_of(s, i) * jacobian[a * points->row_count + s->row[i]];
    if (fg_subset_dot(s->rows, column, column) > 0 && extend(s, s->geometry_rank, column, 0))
      s->geometry_rank++;
  }
  for (size_t i = 0; i < s->rows; i++)
    s->residual[i] = weight_of(s, i) * residual_um[s->row[i]];
  take_out(s, s->geometry_rank, s->residual);
  return FG_OK;
}

static const fg_scan_effect *find_known(const fg_scan_set *known, const char *id) {
  for (size_t e = 0; known && e < known->count; e++)
    if (!strcmp(known->effects[e].id, id)) return &known->effects[e];
  return NULL;
}

/* The smooth ones; the middle of a polynomial is the picture's until a fit has found it. */
static void add_smooth(search *s, const fg_scan_set *known) {
  for (size_t e = 0; e < sizeof smooth / sizeof smooth[0]; e++) {
    fg_subset_effect effect = smooth[e];
    const fg_scan_effect *from = find_known(known, effect.id);
    if (!fg_points_shows(s->points, effect.id)) continue;
    if (effect.shapes)
      effect.shape[0] = s->points->frame.centre_mm[!strncmp(effect.id, "scan.carriage", 13)];
    if (effect.shapes && from) effect.shape[0] = from->shape[0];
    add_effect(s, &effect);
  }
}

static bool is_listed_smooth(const char *id) {
  for (size_t e = 0; e < sizeof smooth / sizeof smooth[0]; e++)
    if (!strcmp(smooth[e].id, id)) return true;
  return false;
}

/* Ripples and steps that are in force. */
static void add_known(search *s, const fg_scan_set *known) {
  for (size_t e = 0; known && e < known->count; e++) {
    const fg_scan_effect *from = &known->effects[e];
    fg_subset_effect effect = {.id = from->id, .shapes = from->shapes};
    memcpy(effect.shape, from->shape, sizeof effect.shape);
    if (from->shapes && !is_listed_smooth(from->id) && s->out->effect_count < FG_SUBSET_EFFECTS)
      add_effect(s, &effect);
  }
}

fg_status fg_disc_effects_find(fg_context *ctx, const fg_points *points, const double *residual_um,
                               const double *jacobian, const fg_scan_set *known,
                               fg_subset *subset) {
  memset(subset, 0, sizeof *subset);
  search s = {.points = points, .out = subset};
  double *left = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(list_rows(ctx, &s));
  FG_TRY_EXIT(span_geometry(ctx, &s, residual_um, jacobian));
  FG_TRY_EXIT(fg_memory_allocate(ctx, s.rows, sizeof *left, (void **)&left));
  add_smooth(&s, known);
  add_known(&s, known);
  FG_TRY_EXIT(find_shaped_effects(ctx, &s, left));
  try_sets(&s);
exit:
  free(s.row);
  free(s.basis);
  free(s.residual);
  free(s.columns);
  free(s.work);
  free(left);
  return status;
}
