/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intervals that hold at every setting of the region of the runs at once, so also at the one that
 * the same runs chose.
 *
 * The error of a predicted mean is a·z with z standard normal, one element per estimated
 * coefficient, and a of length standard_error. Over all settings |a·z| / |a| is at most |z|, which
 * gives Scheffé's interval. In a bounded region it reaches only the share max |a·z| / (|a| |z|),
 * that depends on the direction of z alone and is independent of |z|. So P(all intervals of k
 * standard errors hold) is the mean of F(k² / (rank share²); rank, dof) over the directions
 * (Naiman 1986; the quantile by draws as in Edwards and Berry 1987). A new run adds one dimension,
 * its own error. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/select.h"
#include "foilgauge/distribution.h"
#include "process/experiment_parts.h"
#include "stats/mixed_model.h"

enum {
  NODES = FG_SIMULTANEOUS_NODES,
  DRAWS_PER_NODE = 32,
  DRAWS = NODES * DRAWS_PER_NODE,
  POINTS = 1024,      /* settings over all combinations of levels */
  POINTS_MIN = 128,   /* of one combination */
  CORNER_FACTORS = 8, /* the corners of more are too many to visit */
  COLUMNS_MAX = 128,
};

/* Settings where the errors of the predictions are compared. */
typedef struct settings {
  const fg_experiment *e;
  fg_region region;
  double *root;      /* columns²: restricted likelihood's covariance is root root'; NULL: none */
  double *row;       /* columns */
  double *direction; /* settings × columns: a / |a| */
  double *run_share; /* settings × 2: |a| and a run's own sd, over the root of their squares' sum */
  size_t columns, count, capacity;
} settings;

static size_t count_combinations(const fg_experiment *e) {
  size_t count = 1;
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (e->model.levels[v].count && v != e->block_variable) count *= e->model.levels[v].count;
  return count;
}

/* Cholesky's factor of a covariance that has zeros where coefficients are aliased; false: it has
 * none. */
static bool factorise(const double *covariance, size_t columns, double *root) {
  for (size_t i = 0; i < columns; i++)
    for (size_t j = 0; j <= i; j++) {
      double rest = covariance[i * columns + j] - fg_dot(root + i * columns, root + j * columns, j);
      double pivot = root[j * columns + j];
      if (i == j && covariance[i * columns + i] > 0 && !(rest > 0)) return false;
      root[i * columns + j] = i == j ? sqrt(fmax(rest, 0)) : pivot > 0 ? rest / pivot : 0;
    }
  return true;
}

static void find_error_direction(const settings *s, double *direction) {
  if (!s->root) {
    fg_experiment_direction(s->e, s->row, direction);
    return;
  }
  memset(direction, 0, s->columns * sizeof *direction);
  for (size_t i = 0; i < s->columns; i++)
    for (size_t j = 0; j <= i; j++)
      direction[j] += s->root[i * s->columns + j] * s->row[i];
}

static fg_status add_setting(fg_context *ctx, settings *s, const double *levels, const double *x) {
  double setting[FG_FORMULA_VARIABLES];
  fg_prediction p;
  memcpy(setting, levels, sizeof setting);
  for (size_t k = 0; k < s->e->surface.factors; k++)
    setting[s->e->surface.variable[k]] = x[k];
  FG_TRY(fg_experiment_row(ctx, s->e, setting, s->row));
  FG_TRY(fg_experiment_predict(ctx, s->e, setting, &p));
  if (!(p.standard_error > 0)) return FG_OK;
  double *direction = s->direction + s->count * s->columns;
  find_error_direction(s, direction);
  double length = sqrt(fg_dot(direction, direction, s->columns));
  for (size_t j = 0; j < s->columns; j++)
    direction[j] /= length;
  double share = fmin(p.standard_error / p.run_standard_error, 1);
  s->run_share[2 * s->count] = share;
  s->run_share[2 * s->count + 1] = sqrt(1 - share * share);
  s->count++;
  return FG_OK;
}

static size_t corners_of(const fg_experiment *e) {
  return (size_t)1 << e->surface.factors;
}

/* Corners of the box, as far as they are in the ball, and a cover of the region. */
static fg_status add_combination(fg_context *ctx, settings *s, const double *levels,
                                 size_t points) {
  double x[FG_SURFACE_FACTORS];
  for (size_t corner = 0; corner < corners_of(s->e); corner++) {
    for (size_t k = 0; k < s->region.factors; k++)
      x[k] = corner >> k & 1 ? s->region.high[k] : s->region.low[k];
    FG_TRY(fg_region_project(ctx, &s->region, x));
    FG_TRY(add_setting(ctx, s, levels, x));
  }
  FG_TRY(add_setting(ctx, s, levels, s->region.centre));
  for (size_t i = 0; i < points; i++) {
    fg_region_scatter(&s->region, i, x);
    FG_TRY(add_setting(ctx, s, levels, x));
  }
  return FG_OK;
}

static fg_status add_settings(fg_context *ctx, settings *s) {
  double levels[FG_FORMULA_VARIABLES] = {0};
  size_t combinations = count_combinations(s->e), points = POINTS / combinations;
  if (points < POINTS_MIN) points = POINTS_MIN;
  if (!s->e->surface.factors) points = 0;
  s->capacity = combinations * (points + corners_of(s->e) + 1);
  FG_TRY(fg_memory_allocate(ctx, 2 * s->capacity, sizeof *s->run_share, (void **)&s->run_share));
  FG_TRY(fg_memory_allocate(ctx, s->capacity * s->columns, sizeof *s->direction,
                            (void **)&s->direction));
  do {
    FG_TRY(add_combination(ctx, s, levels, points));
  } while (fg_experiment_next_levels(s->e, levels));
  return FG_OK;
}

/* The largest shares of one error of the coefficients, and of the same with a run's own. */
static void find_shares(const settings *s, const double *z, double own, double *share,
                        double *run_share) {
  double square = fg_dot(z, z, s->columns), max = 0, run_max = 0;
  for (size_t i = 0; i < s->count; i++) {
    double error = fg_dot(s->direction + i * s->columns, z, s->columns);
    double run = fabs(s->run_share[2 * i] * error - s->run_share[2 * i + 1] * own);
    max = fabs(error) > max ? fabs(error) : max;
    run_max = run > run_max ? run : run_max;
  }
  *share = fmin(max / sqrt(square), 1);
  *run_share = fmin(run_max / sqrt(square + own * own), 1);
}

static void average_nodes(double *drawn, double *node) {
  fg_sort(drawn, DRAWS);
  for (size_t n = 0; n < NODES; n++) {
    double sum = 0;
    for (size_t i = 0; i < DRAWS_PER_NODE; i++)
      sum += drawn[n * DRAWS_PER_NODE + i];
    node[n] = sum / DRAWS_PER_NODE;
  }
}

static bool is_estimated(const fg_experiment *e, size_t column) {
  return !e->regression.coefficient[column].aliased;
}

static fg_status draw_shares(fg_context *ctx, const settings *s, fg_simultaneous *simultaneous) {
  double *drawn = NULL;
  FG_TRY(fg_memory_allocate(ctx, 2 * DRAWS + s->columns, sizeof *drawn, (void **)&drawn));
  gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
  double *z = drawn + (size_t)(2 * DRAWS);
  if (!random) {
    free(drawn);
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: random numbers");
  }
  for (size_t i = 0; i < DRAWS; i++) {
    for (size_t j = 0; j < s->columns; j++)
      z[j] = is_estimated(s->e, j) ? gsl_ran_gaussian_ziggurat(random, 1) : 0;
    find_shares(s, z, gsl_ran_gaussian_ziggurat(random, 1), &drawn[i], &drawn[DRAWS + i]);
  }
  average_nodes(drawn, simultaneous->share);
  average_nodes(drawn + DRAWS, simultaneous->run_share);
  gsl_rng_free(random);
  free(drawn);
  return FG_OK;
}

static fg_status compute_shares(fg_context *ctx, settings *s, fg_simultaneous *simultaneous) {
  const fg_mixed_model *mixed = s->e->has_split_plot ? s->e->split_plot.mixed : NULL;
  FG_TRY(fg_memory_allocate(ctx, s->columns, sizeof *s->row, (void **)&s->row));
  if (mixed) {
    FG_TRY(fg_memory_allocate(ctx, s->columns * s->columns, sizeof *s->root, (void **)&s->root));
    if (!factorise(mixed->adjusted, s->columns, s->root)) return FG_OK;
  }
  FG_TRY(add_settings(ctx, s));
  return s->count ? draw_shares(ctx, s, simultaneous) : FG_OK;
}

static double all_hold(const double *share, double factor, double rank, double dof) {
  double sum = 0;
  for (size_t n = 0; n < NODES; n++)
    sum += 1 - fg_distribution_f_upper(pow(factor / share[n], 2) / rank, rank, dof);
  return sum / NODES;
}

/* Between Student's factor, for one setting, and Scheffé's, for all; that where `share` is NULL. */
static double find_coverage_factor(const double *share, double rank, double dof,
                                   double confidence) {
  double low = fg_distribution_t_quantile((1 + confidence) / 2, dof),
         high = sqrt(rank * fg_distribution_f_quantile(confidence, rank, dof));
  if (!share || !(low < high)) return high;
  for (int i = 0; i < 24; i++) {
    double middle = (low + high) / 2;
    if (all_hold(share, middle, rank, dof) < confidence)
      low = middle;
    else
      high = middle;
  }
  return high;
}

/* All settings have the same dof, except with whole plots: by restricted likelihood that of the
 * middle counts, by strata the smallest. */
static fg_status find_middle_coverage(fg_context *ctx, const fg_experiment *e, fg_simultaneous *s) {
  fg_prediction middle;
  double setting[FG_FORMULA_VARIABLES] = {0}, rank = (double)s->rank;
  for (size_t k = 0; k < e->surface.factors; k++)
    setting[e->surface.variable[k]] = e->region.centre[k];
  FG_TRY(fg_experiment_predict(ctx, e, setting, &middle));
  s->dof = middle.dof;
  s->run_dof = middle.run_dof;
  if (e->has_split_plot && e->split_plot.of_plots) {
    const fg_split_plot *strata = &e->split_plot;
    double min_dof = fmin((double)strata->plot_dof, (double)strata->run_dof);
    s->dof = fmin(s->dof, min_dof);
    s->run_dof = fmin(s->run_dof, min_dof);
  }
  if (!(s->dof > 0)) return FG_OK;
  s->factor = find_coverage_factor(s->share, rank, s->dof, e->confidence);
  s->run_factor = find_coverage_factor(s->run_share, rank + 1, s->run_dof, e->confidence);
  return FG_OK;
}

/* The shares stay 1, and the interval is Scheffé's, where the settings are too many. */
fg_status fg_experiment_simultaneous(fg_context *ctx, const fg_experiment *whole,
                                     fg_experiment *e) {
  fg_simultaneous *simultaneous = &e->simultaneous;
  const fg_experiment *chosen_from = whole ? whole : e;
  settings s = {
      .e = chosen_from, .region = chosen_from->region, .columns = chosen_from->regression.columns};
  *simultaneous = (fg_simultaneous){.rank = 0};
  s.region.planes = 0;
  for (size_t j = 0; j < s.columns; j++)
    simultaneous->rank += is_estimated(chosen_from, j);
  for (size_t n = 0; n < NODES; n++)
    simultaneous->share[n] = simultaneous->run_share[n] = 1;
  bool few = chosen_from->surface.factors <= CORNER_FACTORS && s.columns <= COLUMNS_MAX &&
             count_combinations(chosen_from) <= POINTS / POINTS_MIN;
  fg_status status = few ? compute_shares(ctx, &s, simultaneous) : FG_OK;
  free(s.root);
  free(s.row);
  free(s.direction);
  free(s.run_share);
  FG_TRY(status);
  return find_middle_coverage(ctx, e, simultaneous);
}

static bool is_in_runs(const fg_experiment *e, const double *x) {
  fg_region runs = e->region;
  double size = 0;
  runs.planes = 0;
  for (size_t k = 0; k < runs.factors; k++)
    size = fmax(size, runs.high[k] - runs.low[k]);
  return fg_region_contains(&runs, x, 1e-6 * size);
}

void fg_experiment_widen(const fg_experiment *e, const double *x, fg_prediction *p) {
  const fg_simultaneous *s = &e->simultaneous;
  bool inside = is_in_runs(e, x), same = p->dof == s->dof && p->run_dof == s->run_dof;
  double rank = (double)s->rank, run = s->run_factor;
  if (!s->rank || !(p->dof > 0) || !isfinite(p->standard_error)) return;
  p->coverage_factor = s->factor;
  if (!inside || !same) {
    p->coverage_factor =
        find_coverage_factor(inside ? s->share : NULL, rank, p->dof, e->confidence);
    run = find_coverage_factor(inside ? s->run_share : NULL, rank + 1, p->run_dof, e->confidence);
  }
  p->low = p->mean - p->coverage_factor * p->standard_error;
  p->high = p->mean + p->coverage_factor * p->standard_error;
  p->run_low = p->mean - run * p->run_standard_error;
  p->run_high = p->mean + run * p->run_standard_error;
}
