/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares for many profiles and one driver.
 *
 * Every profile has unknowns p of its own; the driver's q are common. Of each profile's normal
 * equations (A B'; B D) only the Schur complement D - B A⁻¹ B' enters the sum over profiles.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/small_solve.h"
#include "vision/driver_places.h"

enum { ITERATIONS_MAX = 25, ALL = FG_DRIVEN_VALUES + FG_DRIVER_VALUES };
#define GAIN_MIN    1e-4
#define DAMPING_MAX 1e5
/* Share of the contrast to which optics are Gaussian. Where a tone curve is steep, the little light
 * of a blur's tails beside the edge moves many counts. */
#define TAIL_SHARE 0.001

/* Steps of numerical derivatives, ranges, and priors (sd 0: none). */
static const struct {
  double step, low, high, prior, prior_sd;
} driver_values[FG_DRIVER_VALUES] = {
    [FG_DRIVER_LN_GAMMA] = {0.005, -1.6, 1.6, 0, 1.5}, [FG_DRIVER_STEEPNESS] = {0.02, 0, 16, 0, 8},
    [FG_DRIVER_CENTRE] = {0.003, 0, 1, 0.5, 0.2},      [FG_DRIVER_AMOUNT] = {0.01, -0.5, 4, 0, 0},
    [FG_DRIVER_RADIUS] = {0.01, 0.35, 6, 1, 2},        [FG_DRIVER_HALO] = {0.003, 0, 0.5, 0, 0},
    [FG_DRIVER_HALO_PX] = {0.1, 2, 60, 10, 10},
};
static const struct {
  double step, low, high;
} profile_values[FG_DRIVEN_VALUES] = {
    {0.005, -1e9, 1e9}, {0.005, -1e9, 1e9}, {0.05, 0, 255},    {0.05, 0, 255},    {0.05, 0, 255},
    {0.005, -9, 9},     {0.005, -9, 9},     {0.005, 0.25, 12}, {0.005, 0.25, 12},
};

/* The normal equations of one profile, and its sum of squares. */
typedef struct profile_equations {
  fg_normal_equations system; /* of the profile's own unknowns */
  double cross[FG_DRIVER_VALUES][FG_DRIVEN_VALUES];
  double common[FG_DRIVER_VALUES][FG_DRIVER_VALUES], right[FG_DRIVER_VALUES];
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], own[FG_SMALL_MAX];
} profile_equations;

typedef struct solver {
  fg_driven_profile *profiles;
  size_t count;
  fg_driver_fit *fit;
  size_t q, index[FG_DRIVER_VALUES]; /* free values of the driver */
  profile_equations *equations;
  fg_driver_tone *tone, *moved; /* moved: one per free value */
  fg_driven_places places;      /* of one profile at a time */
  size_t bins_max;
  double *counts; /* of a profile, then of each derivative */
  double *trial;  /* profiles' values */
} solver;

static double *derivative_column(const solver *s, size_t i) {
  return s->counts + i * s->bins_max;
}

static bool is_free(const solver *s, size_t value) {
  return s->fit->free >> value & 1;
}

/* Sets the places to a profile's. */
static void place_profile(solver *s, const fg_driven_profile *p, const fg_driver *driver) {
  bool masked = driver->values[FG_DRIVER_AMOUNT] != 0 || is_free(s, FG_DRIVER_AMOUNT);
  double radius = driver->values[FG_DRIVER_RADIUS] + driver_values[FG_DRIVER_RADIUS].step;
  fg_driven_places_of_bins(p, masked, radius, &s->places);
}

static const fg_driver_tone *held_tone(const solver *s) {
  return s->fit->tone && !s->q ? s->fit->tone : s->tone;
}

/* The tone curve where the k-th free value is moved by its step. */
static const fg_driver_tone *moved_tone(const solver *s, size_t k) {
  return s->index[k] <= FG_DRIVER_CENTRE ? &s->moved[k] : held_tone(s);
}

/* The model and its derivatives for one profile. */
static void differentiate_profile(solver *s, const fg_driven_profile *p, const fg_driver *driver) {
  double *base = derivative_column(s, 0), values[FG_DRIVEN_VALUES];
  bool lossy = driver->values[FG_DRIVER_HALO] > 0 || is_free(s, FG_DRIVER_HALO);
  place_profile(s, p, driver);
  fg_driven_places_keep(driver, held_tone(s), p->values, lossy, &s->places, base);
  for (size_t k = 0; k < FG_DRIVEN_VALUES + s->q; k++) {
    double *to = derivative_column(s, 1 + k), step;
    if (k < FG_DRIVEN_VALUES) {
      if (p->held >> k & 1) {
        memset(to, 0, p->count * sizeof *to);
        continue;
      }
      memcpy(values, p->values, sizeof values);
      values[k] += step = profile_values[k].step;
      fg_driven_places_vary(driver, held_tone(s), values, &s->places, to);
    } else {
      size_t i = s->index[k - FG_DRIVEN_VALUES];
      fg_driver other = *driver;
      other.values[i] += step = driver_values[i].step;
      fg_driven_places_vary(&other, moved_tone(s, k - FG_DRIVEN_VALUES), p->values, &s->places, to);
    }
    for (size_t i = 0; i < p->count; i++)
      to[i] = (to[i] - base[i]) / step;
  }
}

/* Weight of a bin; the uncertainty of the optics' tails, in counts, adds to its variance. */
static double weight_of(const fg_driven_profile *p, size_t i, double noise) {
  const fg_profile_bin *b = &p->bins[i];
  double tails = p->tails ? TAIL_SHARE * p->tails[i] : 0;
  return 1 / (noise * noise / b->count + tails * tails);
}

/* Turns the first column from the model's counts to residuals, and fills the weights; returns the
 * weighted squares. */
static double weigh_residuals(const solver *s, const fg_driven_profile *p, double *weights) {
  double *residuals = derivative_column(s, 0), squares = 0;
  for (size_t i = 0; i < p->count; i++) {
    residuals[i] = p->bins[i].value - residuals[i];
    weights[i] = weight_of(p, i, s->fit->noise);
    squares += weights[i] * residuals[i] * residuals[i];
  }
  return squares;
}

static double add_profile(const solver *s, const fg_driven_profile *p, profile_equations *part) {
  double weights[FG_DRIVEN_MAX], weighted[FG_DRIVEN_MAX];
  double squares = weigh_residuals(s, p, weights);
  memset(part, 0, sizeof *part);
  fg_normal_clear(&part->system, FG_DRIVEN_VALUES);
  for (size_t k = 0; k < FG_DRIVEN_VALUES + s->q; k++) {
    const double *column = derivative_column(s, 1 + k);
    bool own = k < FG_DRIVEN_VALUES;
    size_t common = own ? 0 : k - FG_DRIVEN_VALUES;
    for (size_t i = 0; i < p->count; i++)
      weighted[i] = weights[i] * column[i];
    for (size_t j = 0; j <= k; j++) {
      double product = fg_dot_in_lanes(weighted, derivative_column(s, 1 + j), p->count);
      if (own)
        part->system.matrix[k][j] = product;
      else if (j < FG_DRIVEN_VALUES)
        part->cross[common][j] = product;
      else
        part->common[common][j - FG_DRIVEN_VALUES] = product;
    }
    double right = fg_dot_in_lanes(weighted, derivative_column(s, 0), p->count);
    *(own ? &part->system.right[k] : &part->right[common]) = right;
  }
  part->system.sum_squares = squares;
  for (size_t k = 0; k < FG_DRIVEN_VALUES; k++)
    if (p->held >> k & 1) part->system.matrix[k][k] = 1;
  return squares;
}

/* Sum of squares of the driver's priors. */
static double prior_squares(const solver *s, const fg_driver *driver) {
  double sum = 0;
  for (size_t k = 0; k < s->q; k++) {
    size_t i = s->index[k];
    if (driver_values[i].prior_sd <= 0) continue;
    double d = (driver->values[i] - driver_values[i].prior) / driver_values[i].prior_sd;
    sum += d * d;
  }
  return sum;
}

static double build_equations(solver *s) {
  const fg_driver *driver = &s->fit->driver;
  double squares = prior_squares(s, driver);
  if (held_tone(s) == s->tone) fg_driver_tone_fill(driver, s->tone);
  for (size_t k = 0; k < s->q; k++) {
    fg_driver other = *driver;
    if (s->index[k] > FG_DRIVER_CENTRE) continue;
    other.values[s->index[k]] += driver_values[s->index[k]].step;
    fg_driver_tone_fill(&other, &s->moved[k]);
  }
  for (size_t i = 0; i < s->count; i++) {
    differentiate_profile(s, &s->profiles[i], driver);
    squares += add_profile(s, &s->profiles[i], &s->equations[i]);
  }
  return squares;
}

static double squares_at(solver *s, const fg_driver *driver, const double *values) {
  double squares = prior_squares(s, driver);
  if (held_tone(s) == s->tone) fg_driver_tone_fill(driver, s->tone);
  for (size_t i = 0; i < s->count; i++) {
    const fg_driven_profile *p = &s->profiles[i];
    place_profile(s, p, driver);
    fg_driven_places_keep(driver, held_tone(s), values + i * FG_DRIVEN_VALUES,
                          driver->values[FG_DRIVER_HALO] > 0, &s->places, derivative_column(s, 0));
    for (size_t k = 0; k < p->count; k++) {
      double residual = p->bins[k].value - derivative_column(s, 0)[k];
      squares += weight_of(p, k, s->fit->noise) * residual * residual;
    }
  }
  return squares;
}

/* Eliminates a profile's own unknowns: subtracts B A⁻¹ B' and B A⁻¹ g from the driver's system. */
static bool eliminate_unknowns(const solver *s, profile_equations *part, double damping,
                               fg_normal_equations *system) {
  if (!fg_normal_solve(&part->system, damping, part->own, part->inverse)) return false;
  for (size_t k = 0; k < s->q; k++) {
    double row[FG_DRIVEN_VALUES] = {0};
    for (size_t j = 0; j < FG_DRIVEN_VALUES; j++)
      for (size_t i = 0; i < FG_DRIVEN_VALUES; i++)
        row[j] += part->cross[k][i] * part->inverse[i][j];
    system->right[k] += part->right[k];
    for (size_t j = 0; j < FG_DRIVEN_VALUES; j++)
      system->right[k] -= part->cross[k][j] * part->own[j];
    for (size_t l = 0; l <= k; l++) {
      system->matrix[k][l] += part->common[k][l];
      for (size_t j = 0; j < FG_DRIVEN_VALUES; j++)
        system->matrix[k][l] -= row[j] * part->cross[l][j];
    }
  }
  return true;
}

/* Builds the system of the driver's free values; false where a profile cannot be solved. */
static bool reduce_system(const solver *s, double damping, fg_normal_equations *system) {
  fg_normal_clear(system, s->q);
  for (size_t k = 0; k < s->q; k++) {
    size_t i = s->index[k];
    if (driver_values[i].prior_sd <= 0) continue;
    double weight = 1 / (driver_values[i].prior_sd * driver_values[i].prior_sd);
    system->matrix[k][k] += weight;
    system->right[k] += weight * (driver_values[i].prior - s->fit->driver.values[i]);
  }
  for (size_t i = 0; i < s->count; i++)
    if (!eliminate_unknowns(s, &s->equations[i], damping, system)) return false;
  return true;
}

static double clamp_value(double value, double low, double high) {
  return fmin(fmax(value, low), high);
}

/* Proposes a damped step of all values in s->trial and *driver. */
static bool propose_step(const solver *s, double damping, fg_driver *driver) {
  fg_normal_equations system;
  double step[FG_SMALL_MAX] = {0};
  if (!reduce_system(s, damping, &system)) return false;
  if (s->q && !fg_normal_solve(&system, damping, step, NULL)) return false;
  *driver = s->fit->driver;
  for (size_t k = 0; k < s->q; k++) {
    size_t i = s->index[k];
    double to = driver->values[i] + step[k];
    driver->values[i] = clamp_value(to, driver_values[i].low, driver_values[i].high);
    step[k] = driver->values[i] - s->fit->driver.values[i];
  }
  for (size_t i = 0; i < s->count; i++) {
    const profile_equations *part = &s->equations[i];
    for (size_t j = 0; j < FG_DRIVEN_VALUES; j++) {
      double move = part->own[j];
      for (size_t k = 0; k < s->q; k++)
        for (size_t l = 0; l < FG_DRIVEN_VALUES; l++)
          move -= part->inverse[j][l] * part->cross[k][l] * step[k];
      double to = s->profiles[i].values[j] + (s->profiles[i].held >> j & 1 ? 0 : move);
      s->trial[i * FG_DRIVEN_VALUES + j] =
          clamp_value(to, profile_values[j].low, profile_values[j].high);
    }
  }
  return true;
}

static void accept_step(const solver *s, const fg_driver *driver) {
  s->fit->driver = *driver;
  for (size_t i = 0; i < s->count; i++)
    memcpy(s->profiles[i].values, s->trial + i * FG_DRIVEN_VALUES, sizeof s->profiles[i].values);
}

/* Mean of the edges' places outwards, and its derivatives by the driver's free values. */
static double edge_place(const solver *s, double *by_driver) {
  double sum = 0;
  memset(by_driver, 0, s->q * sizeof *by_driver);
  for (size_t i = 0; i < s->count; i++) {
    const fg_driven_profile *p = &s->profiles[i];
    const profile_equations *part = &s->equations[i];
    double right = p->single ? 1 : 0.5, left = p->single ? 0 : -0.5;
    sum += right * p->values[FG_DRIVEN_RIGHT] + left * p->values[FG_DRIVEN_LEFT];
    for (size_t k = 0; k < s->q; k++)
      for (size_t l = 0; l < FG_DRIVEN_VALUES; l++)
        by_driver[k] -= part->cross[k][l] * (right * part->inverse[FG_DRIVEN_RIGHT][l] +
                                             left * part->inverse[FG_DRIVEN_LEFT][l]);
  }
  for (size_t k = 0; k < s->q; k++)
    by_driver[k] /= (double)s->count;
  return sum / (double)s->count;
}

/* Variance of v' θ from the differences among the profiles: the sandwich C J C. */
static double scattered_variance(const solver *s, double inverse[FG_SMALL_MAX][FG_SMALL_MAX],
                                 const double *v) {
  double sum = 0;
  for (size_t i = 0; i < s->count; i++) {
    const profile_equations *part = &s->equations[i];
    double along = 0;
    for (size_t k = 0; k < s->q; k++) {
      double score = part->right[k];
      for (size_t j = 0; j < FG_DRIVEN_VALUES; j++)
        score -= part->cross[k][j] * part->own[j];
      for (size_t l = 0; l < s->q; l++)
        along += v[l] * inverse[l][k] * score;
    }
    sum += along * along;
  }
  return sum * (double)s->count / fmax(1, (double)s->count - (double)s->q);
}

static double variance_of(const solver *s, double inverse[FG_SMALL_MAX][FG_SMALL_MAX],
                          const double *v, double scale) {
  double own = 0;
  for (size_t k = 0; k < s->q; k++)
    for (size_t l = 0; l < s->q; l++)
      own += v[k] * inverse[k][l] * v[l];
  return fmax(own * scale, scattered_variance(s, inverse, v));
}

/* Standard deviations; the squares are in units of fit->noise. */
static void find_deviations(const solver *s, double squares) {
  fg_normal_equations system;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], by_driver[FG_DRIVER_VALUES] = {0};
  double dof = -(double)s->q;
  fg_driver_fit *fit = s->fit;
  for (size_t i = 0; i < s->count; i++)
    dof += (double)s->profiles[i].count - FG_DRIVEN_VALUES;
  double scale = dof > 0 ? squares / dof : 1;
  fit->good = reduce_system(s, 0, &system) && (!s->q || fg_normal_solve(&system, 0, x, inverse));
  if (!fit->good) return;
  fit->edge_px = edge_place(s, by_driver);
  fit->u_edge_px = sqrt(variance_of(s, inverse, by_driver, fmax(scale, 1)));
  for (size_t k = 0; k < s->q; k++) {
    double unit[FG_DRIVER_VALUES] = {0};
    unit[k] = 1;
    fit->sd[s->index[k]] = sqrt(variance_of(s, inverse, unit, fmax(scale, 1)));
  }
  for (size_t i = 0; i < s->count; i++)
    for (size_t j = 0; j < FG_DRIVEN_VALUES; j++)
      s->profiles[i].sd[j] =
          s->profiles[i].held >> j & 1 ? 0 : sqrt(fmax(scale, 1) * s->equations[i].inverse[j][j]);
  fit->noise *= sqrt(scale);
}

static void iterate_steps(solver *s) {
  double damping = 1e-3, squares = build_equations(s);
  fg_driver driver;
  for (int i = 0; i < ITERATIONS_MAX && damping < DAMPING_MAX; i++) {
    if (!propose_step(s, damping, &driver)) {
      damping *= 10;
      continue;
    }
    double next = squares_at(s, &driver, s->trial);
    if (!(next < squares)) {
      damping *= 10;
      continue;
    }
    double gain = squares - next;
    accept_step(s, &driver);
    squares = build_equations(s);
    damping = fmax(damping * 0.1, 1e-9);
    if (gain < GAIN_MIN * squares) break;
  }
  find_deviations(s, squares);
}

fg_status fg_driver_fit_profiles(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                                 fg_driver_fit *fit) {
  solver s = {.profiles = profiles, .count = count, .fit = fit};
  fg_status status = FG_OK;
  fit->good = false;
  for (size_t i = 0; i < FG_DRIVER_VALUES; i++)
    if (fit->free >> i & 1) s.index[s.q++] = i;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *s.equations, (void **)&s.equations));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1 + s.q, sizeof *s.tone, (void **)&s.tone));
  for (size_t i = 0; i < count; i++)
    if (profiles[i].count > s.bins_max) s.bins_max = profiles[i].count;
  bool masked = fit->driver.values[FG_DRIVER_AMOUNT] != 0 || is_free(&s, FG_DRIVER_AMOUNT);
  FG_TRY_EXIT(fg_driven_places_create(ctx, s.bins_max, masked, &s.places));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, (1 + ALL) * s.bins_max, sizeof *s.counts, (void **)&s.counts));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, count * FG_DRIVEN_VALUES, sizeof *s.trial, (void **)&s.trial));
  s.moved = s.tone + 1;
  iterate_steps(&s);
exit:
  free(s.equations);
  free(s.tone);
  fg_driven_places_free(&s.places);
  free(s.counts);
  free(s.trial);
  return status;
}
