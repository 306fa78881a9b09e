/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

static void list_columns(const fg_evidence_scatter *scatter, const fg_evidence_model *model,
                         fg_evidence_factor *f) {
  for (size_t c = 0; c < scatter->count; c++) {
    double um = model->scatter_um[c % FG_EVIDENCE_SCATTERS];
    f->column[f->count] = scatter->first + c;
    f->root[f->count++] = um;
  }
  for (size_t c = scatter->count; c < fg_evidence_common_columns(scatter); c++) {
    bool gauge = c < scatter->count + scatter->gauges;
    f->column[f->count] = scatter->first + c;
    f->root[f->count++] = gauge ? model->scatter_um[FG_EVIDENCE_GAUGE] : scatter->level_um;
  }
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    for (size_t c = 0; c < part->count && f->count < FG_EVIDENCE_MODEL_COLUMNS; c++) {
      f->column[f->count] = part->first + c;
      f->root[f->count++] = sqrt(part->variance[c]);
    }
  }
}

/* Sums in lanes pay from a few numbers on. */
static double dot(const double *a, const double *b, size_t count) {
  const size_t few = 12;
  return count < few ? fg_dot(a, b, count) : fg_dot_in_lanes(a, b, count);
}

/* Cholesky in place of a symmetric matrix of which the lower half is given; returns half the ln of
 * its determinant. */
static double factorise(size_t n, double *a) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    double *row = a + i * n;
    for (size_t k = 0; k <= i; k++) {
      double value = row[k] - dot(row, a + k * n, k);
      row[k] = k < i ? value / a[k * n + k] : sqrt(fmax(value, 1e-12));
    }
    sum += log(row[i]);
  }
  return sum;
}

static void solve_forward(size_t n, const double *lower, double *v) {
  for (size_t i = 0; i < n; i++)
    v[i] = (v[i] - dot(lower + i * n, v, i)) / lower[i * n + i];
}

fg_status fg_evidence_factor_open(fg_context *ctx, fg_evidence_problem *p,
                                  const fg_evidence_scatter *scatter,
                                  const fg_evidence_model *model, fg_evidence_factor *f) {
  *f = (fg_evidence_factor){.count = 0};
  fg_status status = FG_OK;
  list_columns(scatter, model, f);
  size_t n = f->count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * n + 1, sizeof *f->lower, (void **)&f->lower));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n + 1, sizeof *f->solved, (void **)&f->solved));
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k <= i; k++) {
      double value;
      fg_evidence_products(p, f->column[i], f->column[k], 1, &value);
      f->lower[i * n + k] = f->root[i] * f->root[k] * value + (i == k);
    }
    f->solved[i] = f->root[i] * p->right[f->column[i]];
  }
  double half_log = factorise(n, f->lower);
  solve_forward(n, f->lower, f->solved);
  f->evidence = 0.5 * fg_dot(f->solved, f->solved, n) - half_log;
exit:
  if (status != FG_OK) fg_evidence_factor_close(f);
  return status;
}

void fg_evidence_factor_close(fg_evidence_factor *f) {
  free(f->lower);
  free(f->solved);
  *f = (fg_evidence_factor){.count = 0};
}

/* Turns row i of `forward` from products with `count` columns into number i of the forward solution
 * of each; the rows before are done. */
static void solve_row(const fg_evidence_factor *f, size_t i, size_t count, double *forward) {
  size_t n = f->count;
  double *own = forward + i * count, own_root = f->root[i], pivot = 1 / f->lower[i * n + i];
  for (size_t c = 0; c < count; c++)
    own[c] *= own_root;
  for (size_t k = 0; k < i; k++) {
    double l = f->lower[i * n + k];
    const double *before = forward + k * count;
    for (size_t c = 0; c < count; c++)
      own[c] -= l * before[c];
  }
  for (size_t c = 0; c < count; c++)
    own[c] *= pivot;
}

/* Forward solutions of all columns [first, first + count), each beside the next: row i of
 * `forward` holds number i of each. */
static fg_status solve_columns(fg_context *ctx, fg_evidence_problem *p, const fg_evidence_factor *f,
                               size_t first, size_t count, double **forward) {
  FG_TRY(fg_memory_allocate(ctx, f->count * count + 1, sizeof **forward, (void **)forward));
  for (size_t i = 0; i < f->count; i++) {
    fg_evidence_products(p, f->column[i], first, count, *forward + i * count);
    solve_row(f, i, count, *forward);
  }
  return FG_OK;
}

static fg_status solve_trial(fg_context *ctx, const fg_evidence_problem *p,
                             const fg_evidence_factor *f, const fg_evidence_trial *trial,
                             double **forward) {
  size_t count = trial->count;
  FG_TRY(fg_memory_allocate(ctx, f->count * count + 1, sizeof **forward, (void **)forward));
  for (size_t i = 0; i < f->count; i++) {
    size_t column = f->column[i];
    const double *own = p->values + column * p->rows;
    for (size_t c = 0; c < count; c++)
      (*forward)[i * count + c] =
          fg_evidence_dot(own, p->span[column], trial->column[c].values, trial->column[c].span);
    solve_row(f, i, count, *forward);
  }
  return FG_OK;
}

double fg_evidence_of(size_t n, const double *gram, const double *right, const double *variance,
                      double *work) {
  double *lower = work, *v = work + n * n;
  for (size_t i = 0; i < n; i++) {
    double root = sqrt(variance[i]);
    for (size_t k = 0; k <= i; k++)
      lower[i * n + k] = root * sqrt(variance[k]) * gram[i * n + k] + (i == k);
    v[i] = root * right[i];
  }
  double half_log = factorise(n, lower);
  solve_forward(n, lower, v);
  return 0.5 * fg_dot(v, v, n) - half_log;
}

fg_status fg_evidence_gram_beside(fg_context *ctx, fg_evidence_problem *p,
                                  const fg_evidence_factor *f, size_t first, size_t count,
                                  double *gram, double *right) {
  double *forward = NULL;
  FG_TRY(solve_columns(ctx, p, f, first, count, &forward));
  for (size_t a = 0; a < count; a++) {
    fg_evidence_products(p, first + a, first, a + 1, gram + a * count);
    right[a] = p->right[first + a];
  }
  for (size_t i = 0; i < f->count; i++) {
    const double *own = forward + i * count;
    for (size_t a = 0; a < count; a++) {
      double l = own[a];
      right[a] -= l * f->solved[i];
      for (size_t b = 0; b <= a; b++)
        gram[a * count + b] -= l * own[b];
    }
  }
  free(forward);
  return FG_OK;
}

enum { EACH_MAX = 24 };

/* Products of one set's columns, with each other and with the residual. */
typedef struct set_products {
  size_t each;
  double gram[EACH_MAX * EACH_MAX], right[EACH_MAX];
} set_products;

/* Scores set s of those whose forward solutions are given. */
static void score_set(const fg_evidence_factor *f, const double *forward, size_t count, size_t s,
                      set_products *of, const double *variance, double *evidence) {
  double scaled[EACH_MAX], work[EACH_MAX * EACH_MAX + EACH_MAX];
  size_t each = of->each;
  for (size_t i = 0; i < f->count; i++) {
    const double *own = forward + i * count + s * each;
    for (size_t a = 0; a < each; a++) {
      of->right[a] -= own[a] * f->solved[i];
      for (size_t b = 0; b <= a; b++)
        of->gram[a * each + b] -= own[a] * own[b];
    }
  }
  for (int size = 0; size < FG_EVIDENCE_SIZES; size++) {
    for (size_t a = 0; a < each; a++)
      scaled[a] = ldexp(variance[a], -2 * size);
    evidence[s * FG_EVIDENCE_SIZES + (size_t)size] =
        f->evidence + fg_evidence_of(each, of->gram, of->right, scaled, work);
  }
}

fg_status fg_evidence_score_sets(fg_context *ctx, fg_evidence_problem *p,
                                 const fg_evidence_factor *f, const fg_evidence_sets *sets,
                                 const double *variance, double *evidence) {
  double *forward = NULL;
  set_products of = {.each = sets->each};
  size_t each = sets->each, count = sets->count * each;
  FG_TRY(solve_columns(ctx, p, f, sets->first, count, &forward));
  for (size_t s = 0; s < sets->count; s++) {
    size_t first = sets->first + s * each;
    for (size_t a = 0; a < each; a++) {
      fg_evidence_products(p, first + a, first, a + 1, of.gram + a * each);
      of.right[a] = p->right[first + a];
    }
    score_set(f, forward, count, s, &of, variance, evidence);
  }
  free(forward);
  return FG_OK;
}

fg_status fg_evidence_score_trial(fg_context *ctx, const fg_evidence_problem *p,
                                  const fg_evidence_factor *f, const fg_evidence_trial *trial,
                                  const double *variance, double *evidence) {
  double *forward = NULL;
  set_products of = {.each = trial->each};
  FG_TRY(solve_trial(ctx, p, f, trial, &forward));
  for (size_t s = 0; s * trial->each < trial->count; s++) {
    const fg_evidence_column *own = trial->column + s * trial->each;
    for (size_t a = 0; a < trial->each; a++) {
      for (size_t b = 0; b <= a; b++)
        of.gram[a * trial->each + b] =
            fg_evidence_dot(own[a].values, own[a].span, own[b].values, own[b].span);
      of.right[a] = own[a].right;
    }
    score_set(f, forward, trial->count, s, &of, variance, evidence);
  }
  free(forward);
  return FG_OK;
}
