/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whitening: the rows' own scale, first-order correlation along series, then a level shared in
 * groups.
 *
 * A series of unit variance has covariance R with R_ij = rho^|i-j|. L = (v_t - rho v_t-1) /
 * sqrt(1 - rho²) makes it white. A shared level adds lambda 1 1'; with c = L 1 the covariance is
 * then I + lambda c c', whose inverse root removes (1 - 1/sqrt(1 + lambda c'c)) of the part along
 * c. In groups, rows of a group are one series.
 *
 * An outer level d of several groups comes behind: whitened by its groups it is W d, again c over
 * sqrt(1 + lambda c'c), and one more such root removes it. */
#include <math.h>

#include "core/splitmix.h"
#include "table_loop/engine.h"

/* c at one row of a group that begins at `first`. */
static double level_weight(const fg_engine_training *training, double rho, size_t first, size_t i) {
  const double *scale = training->scale;
  double own = scale ? 1 / scale[fg_engine_level_row(training, i)] : 1;
  if (i == first || training->level_row) return own;
  return (own - rho * (scale ? 1 / scale[i - 1] : 1)) / sqrt(1 - rho * rho);
}

static double level_size(const fg_engine_training *training, double rho, size_t block) {
  size_t first = training->level_start[block], end = training->level_start[block + 1];
  double sum = 0;
  if (!training->scale) return 1 + (double)(end - first - 1) * (1 - rho) / (1 + rho);
  for (size_t i = first; i < end; i++)
    sum += pow(level_weight(training, rho, first, i), 2);
  return sum;
}

/* As scale_level, for rows of equal scale: c is 1 at the first row, `weight` at the others. */
static void scale_equal_level(size_t rows, double weight, double factor, double *y) {
  double along = 0;
  for (size_t i = 1; i < rows; i++)
    along += y[i];
  along = factor * (y[0] + weight * along);
  y[0] += along;
  for (size_t i = 1; i < rows; i++)
    y[i] += weight * along;
}

/* y += factor × (part of y along c), for one group. */
static void scale_level(const fg_engine_training *training, double rho, size_t block, double factor,
                        double *y) {
  size_t first = training->level_start[block], end = training->level_start[block + 1];
  double size = level_size(training, rho, block), along = 0;
  if (!training->scale && !training->level_row) {
    scale_equal_level(end - first, sqrt((1 - rho) / (1 + rho)), factor / size, y + first);
    return;
  }
  for (size_t i = first; i < end; i++)
    along += level_weight(training, rho, first, i) * y[fg_engine_level_row(training, i)];
  for (size_t i = first; i < end; i++)
    y[fg_engine_level_row(training, i)] +=
        factor * along / size * level_weight(training, rho, first, i);
}

static void scale_levels(const fg_engine_training *training, fg_engine_noise noise, double *y,
                         bool inverse) {
  for (size_t b = 0; b < training->levels; b++) {
    double root = sqrt(1 + noise.lambda * level_size(training, noise.rho, b));
    scale_level(training, noise.rho, b, (inverse ? root : 1 / root) - 1, y);
  }
}

/* Factor by which whitening in its group has shortened c. */
static double outer_share(const fg_engine_training *training, fg_engine_noise noise, size_t block) {
  return 1 / sqrt(1 + noise.lambda * level_size(training, noise.rho, block));
}

static double outer_size(const fg_engine_training *training, fg_engine_noise noise, size_t outer) {
  double sum = 0;
  for (size_t k = training->outer_start[outer]; k < training->outer_start[outer + 1]; k++) {
    size_t block = training->outer_block[k];
    sum += level_size(training, noise.rho, block) * pow(outer_share(training, noise, block), 2);
  }
  return sum;
}

/* The part of y along c in one group. */
static double along_level(const fg_engine_training *training, double rho, size_t block,
                          const double *y) {
  size_t first = training->level_start[block], end = training->level_start[block + 1];
  double along = 0;
  for (size_t i = first; i < end; i++)
    along += level_weight(training, rho, first, i) * y[fg_engine_level_row(training, i)];
  return along;
}

static void add_level(const fg_engine_training *training, double rho, size_t block, double level,
                      double *y) {
  size_t first = training->level_start[block], end = training->level_start[block + 1];
  for (size_t i = first; i < end; i++)
    y[fg_engine_level_row(training, i)] += level * level_weight(training, rho, first, i);
}

static void scale_outer_levels(const fg_engine_training *training, fg_engine_noise noise, double *y,
                               bool inverse) {
  for (size_t o = 0; o < training->outers; o++) {
    double size = outer_size(training, noise, o), root = sqrt(1 + noise.outer * size), along = 0;
    for (size_t k = training->outer_start[o]; k < training->outer_start[o + 1]; k++) {
      size_t block = training->outer_block[k];
      along += outer_share(training, noise, block) * along_level(training, noise.rho, block, y);
    }
    along *= ((inverse ? root : 1 / root) - 1) / size;
    for (size_t k = training->outer_start[o]; k < training->outer_start[o + 1]; k++) {
      size_t block = training->outer_block[k];
      add_level(training, noise.rho, block, along * outer_share(training, noise, block), y);
    }
  }
}

void fg_engine_whiten(const fg_engine_training *training, fg_engine_noise noise, double *y) {
  double root = sqrt(1 - noise.rho * noise.rho);
  for (size_t i = 0; training->scale && i < training->n; i++)
    y[i] /= training->scale[i];
  if (noise.rho != 0)
    for (size_t b = 0; b < training->blocks; b++)
      for (size_t i = training->start[b + 1] - 1; i > training->start[b]; i--)
        y[i] = (y[i] - noise.rho * y[i - 1]) / root;
  fg_engine_whiten_levels(training, noise, y);
}

void fg_engine_whiten_levels(const fg_engine_training *training, fg_engine_noise noise, double *y) {
  if (noise.lambda > 0) scale_levels(training, noise, y, false);
  if (noise.outer > 0) scale_outer_levels(training, noise, y, false);
}

void fg_engine_whiten_levels_back(const fg_engine_training *training, fg_engine_noise noise,
                                  double *y) {
  if (noise.outer > 0) scale_outer_levels(training, noise, y, false);
  if (noise.lambda > 0) scale_levels(training, noise, y, false);
}

static double rms(const double *y, size_t n) {
  double square = 0;
  for (size_t i = 0; i < n; i++)
    square += y[i] * y[i] / (double)n;
  return sqrt(square);
}

void fg_engine_colour_rows(const fg_engine_training *training, fg_engine_noise noise,
                           uint64_t *seed, double *y) {
  double row = rms(y, training->n), sd = sqrt(noise.lambda) * row;
  double outer_sd = sqrt(noise.outer) * row;
  for (size_t b = 0; noise.lambda > 0 && b < training->levels; b++)
    add_level(training, noise.rho, b, sd * fg_splitmix_normal(seed), y);
  for (size_t o = 0; noise.outer > 0 && o < training->outers; o++) {
    double level = outer_sd * fg_splitmix_normal(seed);
    for (size_t k = training->outer_start[o]; k < training->outer_start[o + 1]; k++)
      add_level(training, noise.rho, training->outer_block[k], level, y);
  }
  fg_engine_colour(training, (fg_engine_noise){.rho = noise.rho}, y);
}

void fg_engine_colour(const fg_engine_training *training, fg_engine_noise noise, double *y) {
  double root = sqrt(1 - noise.rho * noise.rho);
  if (noise.outer > 0) scale_outer_levels(training, noise, y, true);
  if (noise.lambda > 0) scale_levels(training, noise, y, true);
  if (noise.rho != 0)
    for (size_t b = 0; b < training->blocks; b++)
      for (size_t i = training->start[b] + 1; i < training->start[b + 1]; i++)
        y[i] = noise.rho * y[i - 1] + root * y[i];
  for (size_t i = 0; training->scale && i < training->n; i++)
    y[i] *= training->scale[i];
}

double fg_engine_log_det(const fg_engine_training *training, fg_engine_noise noise) {
  double sum = 0;
  for (size_t i = 0; training->scale && i < training->n; i++)
    sum += 2 * log(training->scale[i]);
  for (size_t b = 0; noise.rho != 0 && b < training->blocks; b++)
    sum +=
        (double)(training->start[b + 1] - training->start[b] - 1) * log1p(-noise.rho * noise.rho);
  for (size_t b = 0; noise.lambda > 0 && b < training->levels; b++) {
    sum += log1p(noise.lambda * level_size(training, noise.rho, b));
  }
  for (size_t o = 0; noise.outer > 0 && o < training->outers; o++)
    sum += log1p(noise.outer * outer_size(training, noise, o));
  return sum;
}

/* Ratios of variances that are tried; those of found levels may be any. */
enum { LAMBDAS_OF_A_GROUP = 6 };

/* Two strata: few of either, which the choice then polishes. */
static size_t nested_grid(fg_engine_noise grid[FG_ENGINE_NOISES]) {
  static const double lambda[] = {0, 0.3, 1.5, 8, 60}, outer[] = {0, 0.1, 0.5, 2.5, 12, 80};
  size_t count = 0;
  for (size_t i = 0; i < sizeof lambda / sizeof *lambda; i++)
    for (size_t j = 0; j < sizeof outer / sizeof *outer; j++)
      grid[count++] = (fg_engine_noise){.lambda = lambda[i], .outer = outer[j]};
  return count;
}

/* Correlation only when it is in force: it is a finding like others. The grid is coarser where a
 * level is estimated too. */
size_t fg_engine_noise_grid(const fg_engine_training *training,
                            fg_engine_noise grid[FG_ENGINE_NOISES]) {
  static const double alone[] = {-0.6, -0.3, 0, 0.2, 0.4, 0.55, 0.7, 0.8, 0.88, 0.94, 0.98};
  static const double beside_level[] = {-0.3, 0, 0.3, 0.6, 0.85}, none[] = {0};
  static const double lambda[] = {0, 0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000};
  const double *rho = none;
  size_t rhos = 1, count = 0;
  if (training->outers) return nested_grid(grid);
  size_t lambdas = training->level_row ? sizeof lambda / sizeof *lambda
                   : training->levels  ? LAMBDAS_OF_A_GROUP
                                       : 1;
  if (training->serial && !training->level_row) {
    rho = training->levels ? beside_level : alone;
    rhos = training->levels ? sizeof beside_level / sizeof *beside_level
                            : sizeof alone / sizeof *alone;
  }
  for (size_t i = 0; i < rhos; i++)
    for (size_t j = 0; j < lambdas; j++)
      grid[count++] = (fg_engine_noise){.rho = rho[i], .lambda = lambda[j]};
  return count;
}
