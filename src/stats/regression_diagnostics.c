/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Influence of each run on the fit (Cook and Weisberg 1982). */
#include <math.h>

#include "core/extended.h"
#include "core/memory.h"
#include "stats/regression_parts.h"

/* A run with less than this of its variance left determines a coefficient alone. */
static const double MIN_DOF = 1e-10;

static fg_status allocate_diagnostics(fg_context *ctx, fg_regression *reg) {
  double **vectors[] = {&reg->fitted,   &reg->residual, &reg->leverage,
                        &reg->internal, &reg->external, &reg->cook};
  for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
    FG_TRY(fg_memory_allocate(ctx, reg->rows, sizeof **vectors[i], (void **)vectors[i]));
  return FG_OK;
}

/* h_i = sum of squares of row i of Q. */
static void leverages(const fg_orthogonal *s, double *leverage) {
  for (size_t k = 0; k < s->rank; k++) {
    const fg_extended *q = s->q + s->kept[k] * s->rows;
    for (size_t i = 0; i < s->rows; i++)
      leverage[i] += q[i].value * q[i].value;
  }
}

/* `e` is the residual times the square root of the weight. */
static void judge_run(fg_regression *reg, size_t i, double e) {
  double left = 1 - reg->leverage[i], s = reg->residual_sd;
  double dof = (double)reg->residual_dof;
  reg->internal[i] = reg->external[i] = reg->cook[i] = NAN;
  if (left < MIN_DOF || !(s > 0)) return;
  double r = e / (s * sqrt(left));
  reg->internal[i] = r;
  reg->cook[i] = r * r * reg->leverage[i] / (left * (double)reg->rank);
  /* s without the run: (n - p - 1) s(i)² = (n - p) s² - e² / (1 - h). */
  if (reg->residual_dof > 1) {
    double rest = (dof - r * r) / (dof - 1);
    reg->external[i] = rest > 0 ? r / sqrt(rest) : copysign(INFINITY, r);
  }
}

static fg_status sum_press(fg_context *ctx, fg_regression *reg, const fg_orthogonal *s) {
  fg_extended press = {0, 0};
  for (size_t i = 0; i < reg->rows; i++) {
    double left = 1 - reg->leverage[i];
    if (left < MIN_DOF) {
      reg->press = reg->predicted_r2 = NAN;
      if (!reg->residual_dof) return FG_OK;
      return fg_regression_note(ctx, reg,
                                "run %zu alone determines a coefficient (leverage 1): it cannot "
                                "be predicted from the others, so PRESS is not defined",
                                i + 1);
    }
    fg_extended deleted = fg_extended_divide(s->residual[i], fg_extended_of(left));
    press = fg_extended_add(press, fg_extended_square(deleted));
  }
  reg->press = press.value;
  reg->predicted_r2 = reg->total_ss > 0 ? 1 - reg->press / reg->total_ss : NAN;
  return FG_OK;
}

fg_status fg_regression_diagnostics(fg_context *ctx, const fg_fit *fit, fg_regression *reg) {
  const fg_orthogonal *s = &fit->solution;
  double lowest = INFINITY, highest = -INFINITY;
  FG_TRY(allocate_diagnostics(ctx, reg));
  leverages(s, reg->leverage);
  for (size_t i = 0; i < reg->rows; i++) {
    fg_extended root = fg_extended_sqrt(fg_extended_of(fit->weights ? fit->weights[i] : 1));
    fg_extended residual = fg_extended_divide(s->residual[i], root);
    reg->residual[i] = residual.value;
    reg->fitted[i] = fg_extended_subtract(fit->response[i], residual).value;
    lowest = fmin(lowest, reg->fitted[i]);
    highest = fmax(highest, reg->fitted[i]);
    judge_run(reg, i, s->residual[i].value);
  }
  double mean_error = reg->residual_sd * sqrt((double)reg->rank / (double)reg->rows);
  reg->adequate_precision = (highest - lowest) / mean_error;
  return sum_press(ctx, reg, s);
}
