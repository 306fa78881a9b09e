/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grid of sizes, its weights by the marginal likelihood, and the mixture's moments. */
#include "compensation/springback.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "compensation/springback_state.h"
#include "core/memory.h"
#include "core/numerics.h"
#include "core/select.h"

/* Priors of a quantity, logarithms. `mean_sd`: the thesis's experiments opened foils by 2 to 20 %;
 * arc length and pitch are kept by a strip that is bent, but for its stretch. The sizes' priors are
 * log-normal about these medians: a factor of three either way is one sd. */
typedef struct quantity_prior {
  double mean_sd, bump, set, foil, rest;
  bool by_bump, has_exponent;
} quantity_prior;

static const quantity_prior priors[FG_FORMED] = {
    [FG_FORMED_RADIUS] = {0.10, 0.01, 0.003, 0.005, 0.01, true, true},
    [FG_FORMED_ARC_LENGTH] = {0.02, 0.003, 0.001, 0.002, 0.003, true, false},
    [FG_FORMED_OVERALL] = {0.15, 0, 0.003, 0.003, 0, false, true},
    [FG_FORMED_PITCH] = {0.03, 0, 0.001, 0.001, 0, false, false},
};
static const double log_factor = 1.0986122886681098; /* ln 3, sd of a size's logarithm */

/* Stands for an absent random term, and for an exponent that is known to be 0. */
static const double absent = 1e-5;

enum { SIZE_NODES = 9, REST_NODES = 5, FOIL_NODES = 10, POINTS_MAX = 400 };

/* Share of the posterior that the kept points have. */
static const double kept_share = 0.9995;

/* A size's nodes with the logarithms of their prior weights. */
typedef struct size_nodes {
  double value[FOIL_NODES], log_weight[FOIL_NODES];
  size_t count;
} size_nodes;

typedef struct weighted_sizes {
  fg_springback_sizes sizes;
  double log_weight;
} weighted_sizes;

typedef struct size_grid {
  weighted_sizes *at;
  size_t count;
} size_grid;

bool fg_formed_is_by_bump(fg_formed formed) {
  return priors[formed].by_bump;
}

static double log_prior_of(double size, double median) {
  double z = log(size / median) / log_factor;
  return -0.5 * z * z;
}

static size_nodes spread_nodes(double median) {
  size_nodes nodes = {.count = 0};
  if (median <= 0) return (size_nodes){.value = {absent}, .count = 1};
  for (; nodes.count < SIZE_NODES; nodes.count++) {
    double z = 0.5 * (double)nodes.count - 2;
    nodes.value[nodes.count] = median * exp(z * log_factor);
    nodes.log_weight[nodes.count] = -0.5 * z * z;
  }
  return nodes;
}

/* Sums of squares over all sets. */
static fg_formed_data pool_squares(const fg_formed_set *sets, size_t count, fg_formed formed) {
  fg_formed_data sum = {.places = 0};
  for (size_t i = 0; i < count; i++) {
    const fg_formed_data *data = &sets[i].of[formed];
    sum.level_squares += data->level_squares;
    sum.level_dof += data->level_dof;
    sum.rest_squares += data->rest_squares;
    sum.rest_dof += data->rest_dof;
    sum.places = data->places > sum.places ? data->places : sum.places;
  }
  return sum;
}

/* Nodes around the estimate of the data and the prior, as far apart as both leave it open. */
static size_nodes rest_nodes(double median, const fg_formed_data *pooled) {
  size_nodes nodes = {.count = REST_NODES};
  double precision = 1 / (log_factor * log_factor), dof = pooled->rest_dof, centre = log(median);
  if (median <= 0) return (size_nodes){.value = {absent}, .count = 1};
  if (dof > 0 && pooled->rest_squares > 0) {
    centre = (precision * centre + dof * log(pooled->rest_squares / dof)) / (precision + 2 * dof);
    precision += 2 * dof;
  }
  for (size_t i = 0; i < nodes.count; i++) {
    double size = exp(centre + ((double)i - 2) / sqrt(precision)), v = size * size;
    nodes.value[i] = size;
    nodes.log_weight[i] =
        log_prior_of(size, median) - 0.5 * dof * log(v) - 0.5 * pooled->rest_squares / v;
  }
  return nodes;
}

/* Nodes of the foils' level; their likelihood depends on the remainder. */
static size_nodes foil_nodes(double median, const fg_formed_data *pooled) {
  static const double factor[FOIL_NODES] = {0.05, 0.2, 0.4, 0.6, 0.8, 1, 1.25, 1.6, 2.2, 3.5};
  if (!(pooled->level_dof > 0) || !(pooled->level_squares > 0)) return spread_nodes(median);
  double places = fmax(1, (double)pooled->places);
  double whole = pooled->level_squares / pooled->level_dof;
  double rest = pooled->rest_dof > 0 ? pooled->rest_squares / pooled->rest_dof : 0;
  double size = sqrt(fmax(whole - rest, 0.05 * whole) / places);
  size_nodes nodes = {.count = FOIL_NODES};
  for (size_t i = 0; i < FOIL_NODES; i++) {
    size_t next = i + 1 < FOIL_NODES ? i + 1 : i, before = i ? i - 1 : i;
    nodes.value[i] = size * factor[i];
    nodes.log_weight[i] = log(log(factor[next] / factor[before]) / (double)(next - before)) +
                          log_prior_of(nodes.value[i], median);
  }
  return nodes;
}

static double level_likelihood(const fg_formed_data *pooled, double foil, double rest) {
  double v = fmax(1, (double)pooled->places) * foil * foil + rest * rest;
  return -0.5 * pooled->level_dof * log(v) - 0.5 * pooled->level_squares / v;
}

static double max_weight(const size_grid *grid) {
  double max = -INFINITY;
  for (size_t i = 0; i < grid->count; i++)
    max = fmax(max, grid->at[i].log_weight);
  return max;
}

/* Nodes far below the best one carry nothing: exp(-14) is 1e-6. */
static void drop_light_points(size_grid *grid) {
  double max = max_weight(grid);
  size_t kept = 0;
  for (size_t i = 0; i < grid->count; i++)
    if (grid->at[i].log_weight > max - 14) grid->at[kept++] = grid->at[i];
  grid->count = kept;
}

/* The scatter within the sets first, then with it the sizes of bump and set. */
static fg_status make_size_grid(fg_context *ctx, const quantity_prior *prior,
                                const fg_formed_data *pooled, size_grid *grid) {
  const size_nodes rest = rest_nodes(prior->rest, pooled), foil = foil_nodes(prior->foil, pooled);
  const size_nodes bump = spread_nodes(prior->bump), set = spread_nodes(prior->set);
  size_grid scatter = {.count = 0};
  weighted_sizes at[REST_NODES * FOIL_NODES];
  void *block;
  scatter.at = at;
  for (size_t r = 0; r < rest.count; r++)
    for (size_t f = 0; f < foil.count; f++)
      at[scatter.count++] =
          (weighted_sizes){{.rest = rest.value[r], .foil = foil.value[f]},
                           rest.log_weight[r] + foil.log_weight[f] +
                               level_likelihood(pooled, foil.value[f], rest.value[r])};
  drop_light_points(&scatter);
  FG_TRY(fg_memory_allocate(ctx, scatter.count * bump.count * set.count * 2, sizeof *grid->at,
                            &block));
  grid->at = block;
  for (size_t i = 0; i < scatter.count; i++)
    for (size_t b = 0; b < bump.count; b++)
      for (size_t s = 0; s < set.count; s++)
        for (int drift = 0; drift < 2; drift++) {
          weighted_sizes *point = &grid->at[grid->count++];
          *point = at[i];
          point->sizes.bump = bump.value[b];
          point->sizes.set = set.value[s];
          point->sizes.drift = drift;
          point->log_weight += bump.log_weight[b] + set.log_weight[s];
        }
  return FG_OK;
}

static int compare_weights(const void *left, const void *right) {
  const weighted_sizes *a = left, *b = right;
  return (a->log_weight < b->log_weight) - (a->log_weight > b->log_weight);
}

/* Turns logarithms into weights, and keeps the heaviest that have nearly all of the posterior. */
static void normalise_grid(size_grid *grid) {
  double max = max_weight(grid), sum = 0, kept = 0;
  size_t count = 0;
  for (size_t i = 0; i < grid->count; i++)
    sum += exp(grid->at[i].log_weight - max);
  fg_sort_items(grid->at, grid->count, sizeof *grid->at, compare_weights);
  while (count < grid->count && count < POINTS_MAX && kept < kept_share * sum)
    kept += exp(grid->at[count++].log_weight - max);
  for (size_t i = 0; i < count; i++)
    grid->at[i].log_weight = exp(grid->at[i].log_weight - max) / kept;
  grid->count = count;
}

/* Mean springback of the earliest set, which the prior of the exponent is about. */
static double first_springback(const fg_formed_data *data) {
  double sum = 0;
  for (size_t i = 0; i < data->places; i++)
    sum += data->place[i].log_ratio;
  return data->places ? sum / (double)data->places : 0;
}

/* The exponent is m where the curvature that is lost does not depend on the radius, 0 where the
 * ratio does not, and m again beyond for a strip that is partly elastic. */
static void set_exponent_prior(const quantity_prior *prior, double springback,
                               fg_state_prior *state) {
  state->mean_sd = prior->mean_sd;
  state->exponent = prior->has_exponent ? springback : 0;
  state->exponent_sd = prior->has_exponent ? hypot(springback, 0.01) : absent;
}

static fg_status allocate_points(fg_context *ctx, fg_springback_fit *fit, size_t points) {
  size_t states = fit->places + 3, each = states + states * states;
  void *block;
  fit->states = states;
  FG_TRY(fg_memory_allocate(ctx, points, sizeof *fit->point, &block));
  fit->point = block;
  FG_TRY(fg_memory_allocate(ctx, (points + 1) * each, sizeof *fit->block, &block));
  fit->block = block;
  for (size_t i = 0; i < points; i++) {
    fit->point[i].mean = fit->block + i * each;
    fit->point[i].root = fit->point[i].mean + states;
  }
  fit->state_mean = fit->block + points * each;
  fit->points = points;
  return FG_OK;
}

static fg_status fill_points(fg_context *ctx, const size_grid *grid, fg_state_space *space,
                             fg_springback_fit *fit) {
  FG_TRY(allocate_points(ctx, fit, grid->count));
  for (size_t i = 0; i < grid->count; i++) {
    fg_springback_point *point = &fit->point[i];
    point->weight = grid->at[i].log_weight;
    point->sizes = grid->at[i].sizes;
    FG_TRY(fg_state_posterior(ctx, space, &point->sizes, point->mean, point->root));
    for (size_t k = 0; k < fit->states; k++)
      fit->state_mean[k] += point->weight * point->mean[k];
  }
  return FG_OK;
}

static void list_places(const fg_springback_data *data, fg_springback_fit *fit) {
  bool by_bump = fg_formed_is_by_bump(data->formed);
  fit->places = by_bump ? data->bump_count : 1;
  for (size_t i = 0; i < fit->places; i++) {
    fit->number[i] = by_bump ? data->bump_numbers[i] : 0;
    for (size_t s = 0; s < data->set_count; s++) {
      const fg_formed_data *of = &data->sets[s].of[data->formed];
      for (size_t k = 0; k < of->places; k++)
        fit->seen[i] |= of->place[k].number == fit->number[i];
    }
  }
}

fg_status fg_springback_find(fg_context *ctx, const fg_springback_data *data,
                             fg_springback_fit *fit) {
  const fg_formed formed = data->formed;
  const fg_formed_data pooled = pool_squares(data->sets, data->set_count, formed);
  fg_state_space space = {.states = 0};
  size_grid grid = {.count = 0};
  fg_status status = FG_OK;
  *fit = (fg_springback_fit){.reference = log(data->target)};
  list_places(data, fit);
  set_exponent_prior(&priors[formed], first_springback(&data->sets[0].of[formed]), &space.prior);
  FG_TRY_EXIT(make_size_grid(ctx, &priors[formed], &pooled, &grid));
  FG_TRY_EXIT(fg_state_begin(ctx, data->sets, data->set_count, formed, fit, &space));
  for (size_t i = 0; i < grid.count; i++) {
    double evidence;
    FG_TRY_EXIT(fg_state_evidence(ctx, &space, &grid.at[i].sizes, &evidence));
    grid.at[i].log_weight += evidence;
  }
  normalise_grid(&grid);
  FG_TRY_EXIT(fill_points(ctx, &grid, &space, fit));
exit:
  free(grid.at);
  fg_state_end(&space);
  return status;
}

void fg_springback_fit_free(fg_springback_fit *fit) {
  free(fit->point);
  free(fit->block);
  *fit = (fg_springback_fit){.places = 0};
}

/* Gradient of ln(formed / die) of the next set at a place by the states. */
static void fill_gradient(const fg_springback_fit *fit, size_t place, double log_die,
                          double *gradient) {
  memset(gradient, 0, fit->states * sizeof *gradient);
  gradient[FG_STATE_COMMON] = 1;
  gradient[FG_STATE_EXPONENT] = log_die - fit->reference;
  gradient[FG_STATE_BUMP + place] = 1;
  gradient[fit->states - 1] = 1;
}

double fg_springback_mean(const fg_springback_fit *fit, size_t place, double log_die) {
  double gradient[FG_COMPENSATION_BUMPS + 3];
  fill_gradient(fit, place, log_die, gradient);
  return fg_dot(gradient, fit->state_mean, fit->states);
}

double fg_springback_invert(const fg_springback_fit *fit, size_t place) {
  double at_target = fg_springback_mean(fit, place, fit->reference);
  return fit->reference - at_target / (1 + fit->state_mean[FG_STATE_EXPONENT]);
}

/* Variance of a linear form: within the points, and of their means. */
static double variance_of_states(const fg_springback_fit *fit, const double *gradient) {
  double sum = 0, mean = fg_dot(gradient, fit->state_mean, fit->states);
  for (size_t i = 0; i < fit->points; i++) {
    const fg_springback_point *point = &fit->point[i];
    double step = fg_dot(gradient, point->mean, fit->states) - mean, within = 0;
    for (size_t column = 0; column < fit->states; column++) {
      double part = 0;
      for (size_t row = column; row < fit->states; row++)
        part += gradient[row] * point->root[row * fit->states + column];
      within += part * part;
    }
    sum += point->weight * (step * step + within);
  }
  return sum;
}

/* The next set's own step is new; what a drift has brought until now is the law's. */
double fg_springback_u(const fg_springback_fit *fit, size_t place, double log_die, bool with_set) {
  double gradient[FG_COMPENSATION_BUMPS + 3];
  fill_gradient(fit, place, log_die, gradient);
  double variance = variance_of_states(fit, gradient);
  for (size_t i = 0; i < fit->points && !with_set; i++)
    variance -= fit->point[i].weight * fit->point[i].sizes.set * fit->point[i].sizes.set;
  return sqrt(fmax(0, variance));
}

void fg_springback_describe(const fg_springback_fit *fit, fg_formed_law *law) {
  double gradient[FG_COMPENSATION_BUMPS + 3] = {0}, steps = 0;
  *law = (fg_formed_law){.exponent = fit->state_mean[FG_STATE_EXPONENT]};
  gradient[FG_STATE_EXPONENT] = 1;
  law->u_exponent = sqrt(variance_of_states(fit, gradient));
  gradient[FG_STATE_EXPONENT] = 0;
  gradient[FG_STATE_COMMON] = gradient[fit->states - 1] = 1;
  for (size_t i = 0; i < fit->places; i++)
    gradient[FG_STATE_BUMP + i] = 1 / (double)fit->places;
  for (size_t i = 0; i < fit->points; i++)
    steps += fit->point[i].weight * fit->point[i].sizes.set * fit->point[i].sizes.set;
  law->springback_pct = 100 * fg_dot(gradient, fit->state_mean, fit->states);
  law->u_springback_pct = 100 * sqrt(fmax(0, variance_of_states(fit, gradient) - steps));
  for (size_t i = 0; i < fit->points; i++) {
    const fg_springback_point *point = &fit->point[i];
    law->bump_sd_pct += 100 * point->weight * point->sizes.bump;
    law->set_sd_pct += 100 * point->weight * point->sizes.set;
    law->foil_sd_pct += 100 * point->weight * point->sizes.foil;
    law->rest_sd_pct += 100 * point->weight * point->sizes.rest;
    law->drift_probability += point->sizes.drift ? point->weight : 0;
  }
}
