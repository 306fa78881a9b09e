/* Whitening: first-order correlation along series, then a level shared in groups.
 *
 * A series of unit variance has covariance R with R_ij = rho^|i-j|. L = (v_t - rho v_t-1) /
 * sqrt(1 - rho²) makes it white. A shared level adds lambda 1 1'; with c = L 1 the covariance is
 * then I + lambda c c', whose inverse root takes (1 - 1/sqrt(1 + lambda c'c)) of the part along c
 * away. In groups, rows of a group are one series. */
#include <math.h>

#include "loop/engine.h"

static double level_size(double rho, size_t count) {
  return 1 + (double)(count - 1) * (1 - rho) / (1 + rho);
}

static double level_weight(double rho, size_t i) {
  return i == 0 ? 1 : sqrt((1 - rho) / (1 + rho));
}

/* v += factor × (part of v along c), for one group. */
static void scale_level(double *v, size_t count, double rho, double factor) {
  double size = level_size(rho, count), along = 0;
  for (size_t i = 0; i < count; i++)
    along += level_weight(rho, i) * v[i];
  for (size_t i = 0; i < count; i++)
    v[i] += factor * along / size * level_weight(rho, i);
}

static void scale_levels(const fg_engine_training *training, fg_engine_noise noise, double *y,
                         bool inverse) {
  for (size_t b = 0; b < training->levels; b++) {
    size_t from = training->level_start[b], count = training->level_start[b + 1] - from;
    double root = sqrt(1 + noise.lambda * level_size(noise.rho, count));
    scale_level(y + from, count, noise.rho, (inverse ? root : 1 / root) - 1);
  }
}

void fg_engine_whiten(const fg_engine_training *training, fg_engine_noise noise, double *y) {
  double root = sqrt(1 - noise.rho * noise.rho);
  if (noise.rho > 0)
    for (size_t b = 0; b < training->blocks; b++)
      for (size_t i = training->start[b + 1] - 1; i > training->start[b]; i--)
        y[i] = (y[i] - noise.rho * y[i - 1]) / root;
  if (noise.lambda > 0) scale_levels(training, noise, y, false);
}

void fg_engine_colour(const fg_engine_training *training, fg_engine_noise noise, double *y) {
  double root = sqrt(1 - noise.rho * noise.rho);
  if (noise.lambda > 0) scale_levels(training, noise, y, true);
  if (noise.rho > 0)
    for (size_t b = 0; b < training->blocks; b++)
      for (size_t i = training->start[b] + 1; i < training->start[b + 1]; i++)
        y[i] = noise.rho * y[i - 1] + root * y[i];
}

double fg_engine_log_det(const fg_engine_training *training, fg_engine_noise noise) {
  double sum = 0;
  for (size_t b = 0; noise.rho > 0 && b < training->blocks; b++)
    sum +=
        (double)(training->start[b + 1] - training->start[b] - 1) * log1p(-noise.rho * noise.rho);
  for (size_t b = 0; noise.lambda > 0 && b < training->levels; b++) {
    size_t count = training->level_start[b + 1] - training->level_start[b];
    sum += log1p(noise.lambda * level_size(noise.rho, count));
  }
  return sum;
}

/* Finer where rows are many: then the estimate is sharp. */
size_t fg_engine_noise_grid(const fg_engine_training *training,
                            fg_engine_noise grid[FG_ENGINE_NOISES]) {
  static const double small_rho[] = {0, 0.25, 0.5, 0.7, 0.85}, lot_rho[] = {0, 0.3, 0.6, 0.85};
  static const double large_rho[] = {0,   0.05, 0.1,  0.15, 0.2,  0.3,  0.4,  0.5,   0.6,
                                     0.7, 0.8,  0.85, 0.9,  0.93, 0.95, 0.97, 0.985, 0.995};
  static const double lambda[] = {0, 0.1, 0.3, 1, 3, 10};
  const double *rho = small_rho;
  size_t rhos = sizeof small_rho / sizeof *small_rho, lambdas = training->levels ? 6 : 1, count = 0;
  if (training->levels) {
    rho = lot_rho;
    rhos = 4;
  } else if (training->n > FG_ENGINE_SMALL_ROWS) {
    rho = large_rho;
    rhos = sizeof large_rho / sizeof *large_rho;
  }
  if (!training->problem->correlated) rhos = 1;
  for (size_t i = 0; i < rhos; i++)
    for (size_t j = 0; j < lambdas; j++)
      grid[count++] = (fg_engine_noise){rho[i], lambda[j]};
  return count;
}
