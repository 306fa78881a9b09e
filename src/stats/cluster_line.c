/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/cluster_line.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/memory.h"

/* Sums over one cluster: S = Z'Z and Z'e. */
typedef struct sums {
  double s[2][2], score[2];
} sums;

/* Values and vectors of a symmetric 2 × 2 matrix: (c, n), (-n, c) with c² + n² = 1. */
static void decompose(double s[2][2], double value[2], double *c, double *n) {
  double half = (s[0][0] - s[1][1]) / 2, mean = (s[0][0] + s[1][1]) / 2;
  double reach = hypot(half, s[0][1]), angle = atan2(s[0][1], half) / 2;
  value[0] = mean + reach;
  value[1] = mean - reach;
  *c = cos(angle);
  *n = sin(angle);
}

/* (V diag(f) V' v) for the decomposition above. */
static void apply_decomposition(const double f[2], double c, double n, const double v[2],
                                double out[2]) {
  double first = f[0] * (c * v[0] + n * v[1]), second = f[1] * (-n * v[0] + c * v[1]);
  out[0] = c * first - n * second;
  out[1] = n * first + c * second;
}

/* Sums over the clusters: the variance, and the terms of its dof. */
typedef struct total {
  double variance, trace, squares, products[2][2];
} total;

static void add_cluster(sums *cluster, total *t) {
  static const double slope[2] = {0, 1};
  double value[2], c, n, root[2], weight[2], image[2] = {0}, score[2], p[2], d[2];
  decompose(cluster->s, value, &c, &n);
  for (int i = 0; i < 2; i++) {
    double rest = 1 - value[i]; /* 0: the cluster alone determines the fit; its residuals have no
                                   information there */
    root[i] = rest > 1e-9 ? 1 / sqrt(rest) : 0;
    weight[i] = rest > 1e-9 ? value[i] / rest : 0;
    image[i] = root[i] * value[i];
  }
  apply_decomposition(root, c, n, cluster->score, score);
  apply_decomposition(weight, c, n, slope, d);
  apply_decomposition(image, c, n, slope, p);
  t->variance += score[1] * score[1];
  double own = d[1], shared = p[0] * p[0] + p[1] * p[1];
  t->trace += own - shared;
  t->squares += own * own - 2 * own * shared;
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      t->products[i][k] += p[i] * p[k];
}

static void fit_line(const double *x, const double *y, size_t count, double mean[2], double *sxx,
                     fg_cluster_line *line) {
  double sxy = 0, syy = 0;
  mean[0] = mean[1] = *sxx = 0;
  for (size_t i = 0; i < count; i++) {
    mean[0] += x[i] / (double)count;
    mean[1] += y[i] / (double)count;
  }
  for (size_t i = 0; i < count; i++) {
    *sxx += (x[i] - mean[0]) * (x[i] - mean[0]);
    sxy += (x[i] - mean[0]) * (y[i] - mean[1]);
    syy += (y[i] - mean[1]) * (y[i] - mean[1]);
  }
  line->slope = sxy / *sxx;
  line->intercept = mean[1] - line->slope * mean[0];
  line->r = sxy / sqrt(*sxx * syy);
}

fg_status fg_cluster_line_fit(fg_context *ctx, const double *x, const double *y,
                              const size_t *cluster, size_t count, size_t clusters,
                              fg_cluster_line *line) {
  double mean[2], sxx;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, clusters, sizeof(sums), &block));
  sums *all = block;
  fit_line(x, y, count, mean, &sxx, line);
  for (size_t i = 0; i < count; i++) {
    sums *own = &all[cluster[i]];
    double residual = y[i] - line->intercept - line->slope * x[i];
    const double z[2] = {1 / sqrt((double)count), (x[i] - mean[0]) / sqrt(sxx)};
    for (int a = 0; a < 2; a++) {
      own->score[a] += z[a] * residual;
      for (int b = 0; b < 2; b++)
        own->s[a][b] += z[a] * z[b];
    }
  }
  total t = {0};
  for (size_t g = 0; g < clusters; g++)
    add_cluster(&all[g], &t);
  free(all);
  for (int i = 0; i < 4; i++)
    t.squares += t.products[i / 2][i % 2] * t.products[i / 2][i % 2];
  bool known = t.trace > 1e-9 && sxx > 0;
  line->u_slope = known ? sqrt(t.variance / sxx) : NAN;
  line->dof = known ? t.trace * t.trace / t.squares : NAN;
  return FG_OK;
}
