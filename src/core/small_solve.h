/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small dense systems, at most FG_SMALL_MAX unknowns, without the heap. */
#ifndef FG_CORE_SMALL_SOLVE_H
#define FG_CORE_SMALL_SOLVE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_SMALL_MAX = 28 };

/* Normal equations of a least-squares problem, filled row by row. */
typedef struct fg_normal_equations {
  size_t unknowns;
  double matrix[FG_SMALL_MAX][FG_SMALL_MAX]; /* lower triangle */
  double right[FG_SMALL_MAX];
  double sum_squares; /* of the weighted right-hand sides */
} fg_normal_equations;

void fg_normal_clear(fg_normal_equations *system, size_t unknowns);

/* Adds weight × (row · x = value). */
void fg_normal_add(fg_normal_equations *system, const double *row, double value, double weight);

/* An equation: weight × (values · x = right). Values beyond the unknowns are 0. */
enum { FG_NORMAL_ROW_VALUES = 12 };
typedef struct fg_normal_row {
  double values[FG_NORMAL_ROW_VALUES], right, weight;
} fg_normal_row;

/* Adds equations of at most FG_NORMAL_ROW_VALUES unknowns; nine, an edge's profile, are fastest. */
void fg_normal_add_rows(fg_normal_equations *system, const fg_normal_row *rows, size_t count);

/* Solves (matrix + damping × diagonal) x = right by Cholesky. False when it is not positive
 * definite. `inverse`, where not NULL, gets the inverse of the damped matrix. */
bool fg_normal_solve(const fg_normal_equations *system, double damping, double *x,
                     double inverse[FG_SMALL_MAX][FG_SMALL_MAX]);

#ifdef __cplusplus
}
#endif
#endif
