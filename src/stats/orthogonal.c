/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/orthogonal.h"

#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"

/* x -= a q */
static void subtract_multiple(fg_extended *x, fg_extended a, const fg_extended *q, size_t rows) {
  for (size_t i = 0; i < rows; i++)
    x[i] = fg_extended_subtract(x[i], fg_extended_multiply(a, q[i]));
}

static void scale_column(fg_extended *x, fg_extended factor, size_t rows) {
  for (size_t i = 0; i < rows; i++)
    x[i] = fg_extended_multiply(x[i], factor);
}

/* A power of two near the largest element: scaling by it is exact and the squares stay finite. */
static double binary_scale(const fg_extended *x, size_t rows) {
  double largest = 0;
  int exponent = 0;
  for (size_t i = 0; i < rows; i++)
    largest = fmax(largest, fabs(x[i].value));
  if (largest == 0) return 1;
  frexp(largest, &exponent);
  return ldexp(1.0, exponent);
}

/* Projects column j beside the earlier columns, one after the other (modified Gram-Schmidt). */
static void orthogonalise(fg_orthogonal *s, size_t j, double tolerance) {
  fg_extended *x = s->q + j * s->rows;
  double unit = binary_scale(x, s->rows);
  scale_column(x, fg_extended_of(1 / unit), s->rows);
  double length = sqrt(fg_extended_dot(x, x, s->rows).value);
  for (size_t k = 0; k < s->rank; k++) {
    const fg_extended *q = s->q + s->kept[k] * s->rows;
    fg_extended shadow = fg_extended_dot(q, x, s->rows);
    subtract_multiple(x, shadow, q, s->rows);
    s->r[s->kept[k] * s->columns + j] = fg_extended_multiply(shadow, fg_extended_of(unit));
  }
  fg_extended left = fg_extended_sqrt(fg_extended_dot(x, x, s->rows));
  if (s->rank == s->rows || !(left.value > tolerance * length)) {
    s->aliased[j] = true;
    for (size_t i = 0; i < s->rows; i++)
      x[i] = fg_extended_of(0.0);
    return;
  }
  scale_column(x, fg_extended_divide(fg_extended_of(1.0), left), s->rows);
  s->r[j * s->columns + j] = fg_extended_multiply(left, fg_extended_of(unit));
  s->kept[s->rank++] = j;
}

/* Treats the response as one more column, which makes the solution stable. */
static void project_response(fg_orthogonal *s) {
  for (size_t k = 0; k < s->rank; k++) {
    const fg_extended *q = s->q + s->kept[k] * s->rows;
    s->z[s->kept[k]] = fg_extended_dot(q, s->residual, s->rows);
    subtract_multiple(s->residual, s->z[s->kept[k]], q, s->rows);
  }
}

/* Column by column: R U = I, from the diagonal upwards. */
static void invert(fg_orthogonal *s) {
  size_t n = s->columns;
  for (size_t b = 0; b < s->rank; b++) {
    size_t j = s->kept[b];
    s->inverse[j * n + j] = fg_extended_divide(fg_extended_of(1.0), s->r[j * n + j]);
    for (size_t a = b; a-- > 0;) {
      size_t i = s->kept[a];
      fg_extended sum = {0, 0};
      for (size_t c = a + 1; c <= b; c++) {
        size_t k = s->kept[c];
        sum = fg_extended_add(sum, fg_extended_multiply(s->r[i * n + k], s->inverse[k * n + j]));
      }
      s->inverse[i * n + j] = fg_extended_negate(fg_extended_divide(sum, s->r[i * n + i]));
    }
  }
}

static fg_status allocate_factors(fg_context *ctx, fg_orthogonal *s) {
  size_t n = s->columns, square = n * n, cells = n * s->rows;
  if (n && (square / n != n || cells / n != s->rows))
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu rows of %zu columns", s->rows, n);
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *s->kept, (void **)&s->kept));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *s->aliased, (void **)&s->aliased));
  FG_TRY(fg_memory_allocate(ctx, cells, sizeof *s->q, (void **)&s->q));
  FG_TRY(fg_memory_allocate(ctx, square, sizeof *s->r, (void **)&s->r));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *s->z, (void **)&s->z));
  FG_TRY(fg_memory_allocate(ctx, s->rows, sizeof *s->residual, (void **)&s->residual));
  return fg_memory_allocate(ctx, square, sizeof *s->inverse, (void **)&s->inverse);
}

static void copy_scaled(const fg_extended *from, const fg_extended *scale, size_t rows,
                        fg_extended *to) {
  for (size_t i = 0; i < rows; i++)
    to[i] = scale ? fg_extended_multiply(from[i], scale[i]) : from[i];
}

fg_status fg_orthogonal_solve(fg_context *ctx, const fg_least_squares *problem,
                              fg_orthogonal *solution) {
  fg_status status = FG_OK;
  *solution = (fg_orthogonal){.rows = problem->rows, .columns = problem->columns};
  FG_TRY_EXIT(allocate_factors(ctx, solution));
  copy_scaled(problem->response, problem->scale, problem->rows, solution->residual);
  for (size_t j = 0; j < problem->columns; j++) {
    copy_scaled(problem->matrix + j * problem->rows, problem->scale, problem->rows,
                solution->q + j * problem->rows);
    orthogonalise(solution, j, problem->tolerance);
  }
  project_response(solution);
  invert(solution);
exit:
  if (status != FG_OK) fg_orthogonal_free(solution);
  return status;
}

void fg_orthogonal_free(fg_orthogonal *solution) {
  free(solution->kept);
  free(solution->aliased);
  free(solution->q);
  free(solution->r);
  free(solution->z);
  free(solution->residual);
  free(solution->inverse);
  *solution = (fg_orthogonal){0};
}
