/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/small_solve.h"

#include <math.h>
#include <string.h>

void fg_normal_clear(fg_normal_equations *system, size_t unknowns) {
  system->unknowns = unknowns;
  system->sum_squares = 0;
  size_t size = (unknowns + 3) / 4 * 4 * sizeof *system->right; /* whole registers of add_nine */
  memset(system->right, 0, size);
  for (size_t i = 0; i < unknowns; i++)
    memset(system->matrix[i], 0, size);
}

static inline __attribute__((always_inline)) void add_equation(fg_normal_equations *system,
                                                               const double *row, double value,
                                                               double weight, size_t unknowns) {
  for (size_t i = 0; i < unknowns; i++) {
    double scaled = weight * row[i];
    for (size_t j = 0; j <= i; j++)
      system->matrix[i][j] += scaled * row[j];
    system->right[i] += scaled * value;
  }
  system->sum_squares += weight * value * value;
}

/* Four numbers of a register. */
typedef double four __attribute__((vector_size(32), aligned(8)));
enum { FOURS = FG_NORMAL_ROW_VALUES / 4, ROW_UNKNOWNS = FG_NORMAL_ROW_VALUES - 3 };

/* Sums stay in registers over all rows. Each is added up in the order of the rows, as add_equation
 * does it. */
__attribute__((target_clones("avx2", "default"))) static void
add_nine(fg_normal_equations *system, const fg_normal_row *rows, size_t count) {
  four sums[ROW_UNKNOWNS][FOURS], right[FOURS];
  memcpy(right, system->right, sizeof right);
  for (int i = 0; i < ROW_UNKNOWNS; i++)
    memcpy(sums[i], system->matrix[i], sizeof sums[i]);
  for (size_t k = 0; k < count; k++) {
    const fg_normal_row *row = &rows[k];
    four values[FOURS];
    memcpy(values, row->values, sizeof values);
    for (int i = 0; i < ROW_UNKNOWNS; i++)
      for (int j = 0; j <= i / 4; j++)
        sums[i][j] += row->weight * row->values[i] * values[j];
    for (int j = 0; j < FOURS; j++)
      right[j] += row->weight * values[j] * row->right;
    system->sum_squares += row->weight * row->right * row->right;
  }
  memcpy(system->right, right, sizeof right);
  for (int i = 0; i < ROW_UNKNOWNS; i++)
    memcpy(system->matrix[i], sums[i], sizeof sums[i]);
}

void fg_normal_add_rows(fg_normal_equations *system, const fg_normal_row *rows, size_t count) {
  if (system->unknowns == ROW_UNKNOWNS) {
    add_nine(system, rows, count);
    return;
  }
  for (size_t k = 0; k < count; k++)
    fg_normal_add(system, rows[k].values, rows[k].right, rows[k].weight);
}

/* The compiler unrolls the loops for a known number of unknowns, a parabola's. */
void fg_normal_add(fg_normal_equations *system, const double *row, double value, double weight) {
  if (system->unknowns == 3)
    add_equation(system, row, value, weight, 3);
  else
    add_equation(system, row, value, weight, system->unknowns);
}

/* Lower Cholesky factor of the damped matrix. */
static bool factor_cholesky(const fg_normal_equations *system, double damping,
                            double lower[FG_SMALL_MAX][FG_SMALL_MAX]) {
  for (size_t i = 0; i < system->unknowns; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = system->matrix[i][j];
      if (i == j) sum += damping * sum;
      for (size_t k = 0; k < j; k++)
        sum -= lower[i][k] * lower[j][k];
      if (i == j) {
        if (!(sum > 1e-14 * system->matrix[i][i])) return false;
        lower[i][i] = sqrt(sum);
      } else {
        lower[i][j] = sum / lower[j][j];
      }
    }
  return true;
}

/* x is 0 before `first`. */
static void substitute_lower(size_t n, double lower[FG_SMALL_MAX][FG_SMALL_MAX], size_t first,
                             double *x) {
  for (size_t i = first; i < n; i++) {
    for (size_t k = first; k < i; k++)
      x[i] -= lower[i][k] * x[k];
    x[i] /= lower[i][i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++)
      x[i] -= lower[k][i] * x[k];
    x[i] /= lower[i][i];
  }
}

bool fg_normal_solve(const fg_normal_equations *system, double damping, double *x,
                     double inverse[FG_SMALL_MAX][FG_SMALL_MAX]) {
  double lower[FG_SMALL_MAX][FG_SMALL_MAX];
  size_t n = system->unknowns;
  if (!factor_cholesky(system, damping, lower)) return false;
  memcpy(x, system->right, n * sizeof *x);
  substitute_lower(n, lower, 0, x);
  for (size_t c = 0; inverse && c < n; c++) {
    double unit[FG_SMALL_MAX] = {0};
    unit[c] = 1;
    substitute_lower(n, lower, c, unit);
    for (size_t r = 0; r < n; r++)
      inverse[r][c] = unit[r];
  }
  return true;
}
