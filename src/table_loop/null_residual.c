/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/null_residual.h"

#include <string.h>

/* Returns the share of a row's own error in the variance of its residual beside its group's level;
 * `unit` has room for n. */
static double own_share(const fg_engine_training *training, fg_engine_noise noise,
                        const fg_engine_span *null, size_t i, double *unit) {
  size_t n = training->n;
  if (noise.lambda == 0 && noise.outer == 0) return null->kept[i];
  memset(unit, 0, n * sizeof *unit);
  unit[i] = 1;
  fg_engine_whiten_levels(training, noise, unit);
  return fg_engine_project_out(n, null->basis, null->rank, unit);
}

void fg_engine_null_residual(const fg_engine_training *training, fg_engine_noise noise,
                             const fg_engine_span *null, const double *y, double *white) {
  size_t n = training->n;
  double *own = white + n;
  memcpy(white, y, n * sizeof *white);
  fg_engine_whiten(training, noise, white);
  fg_engine_project_out(n, null->basis, null->rank, white);
  fg_engine_whiten_levels_back(training, noise, white);
  for (size_t i = 0; i < n; i++) {
    own[i] = own_share(training, noise, null, i, white + 2 * n);
    white[i] /= fg_engine_kept_sd(own[i]);
  }
}
