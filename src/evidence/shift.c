/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/shift.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

/* Ridge of the bumps' own sizes where they are not bounded: their sum over the bumps lies in the
 * flat directions. */
#define RIDGE 1e-9

bool fg_evidence_is_of_scanner(const fg_evidence_part *part) {
  return part->effect ? part->effect->glass != NULL : part->rival->glass != NULL;
}

static size_t parameter_of(const fg_edge_fit *edge_fit, size_t index) {
  size_t at = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t bumps = edge_fit->parts[p].bump_count;
    if (index < 1 + 2 * bumps)
      return index ? at + 1 + 3 * ((index - 1) / 2) + 2 * ((index - 1) % 2) : at;
    index -= 1 + 2 * bumps;
    at += 1 + 3 * bumps;
  }
  return at;
}

fg_status fg_evidence_shift_open(fg_context *ctx, fg_evidence_search *s, fg_evidence_shift *w) {
  fg_status status = FG_OK;
  *w = (fg_evidence_shift){.count = 0};
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t n = s->scatter.count;
  for (size_t part = 0; part < edge_fit->part_count; part++)
    w->count += 1 + 2 * edge_fit->parts[part].bump_count;
  size_t numbers = w->count * (w->count + 1) + 1;
  FG_TRY_EXIT(fg_memory_allocate(ctx, w->count * p->rank + 1, sizeof *w->flat, (void **)&w->flat));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * n + 1, sizeof *w->scatter, (void **)&w->scatter));
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *w->mean, (void **)&w->mean));
  w->second = w->mean + w->count;
  for (size_t i = 0; i < w->count; i++)
    for (size_t k = 0; k < p->rank; k++)
      w->flat[i * p->rank + k] =
          p->directions[k * edge_fit->parameters + parameter_of(edge_fit, i)];
  for (size_t i = 0; i < n; i++) {
    double *row = w->scatter + i * n;
    fg_evidence_products(p, s->scatter.first + i, s->scatter.first, i + 1, row);
    row[i] += RIDGE + 1e-6 * row[i];
    for (size_t k = 0; k <= i; k++) {
      double value = row[k] - fg_dot(row, w->scatter + k * n, k);
      row[k] = k < i ? value / w->scatter[k * n + k] : sqrt(fmax(value, RIDGE));
    }
  }
exit:
  if (status != FG_OK) fg_evidence_shift_close(w);
  return status;
}

void fg_evidence_shift_close(fg_evidence_shift *w) {
  free(w->flat);
  free(w->scatter);
  free(w->mean);
  *w = (fg_evidence_shift){.count = 0};
}

/* Radii of gauges are no flat directions: each follows by its own column, which no other disc has.
 */
static void follow_gauges(fg_evidence_search *s, size_t column, double *to) {
  const fg_edge_fit *edge_fit = s->problem.edge_fit;
  size_t gauge = s->scatter.first + s->scatter.count;
  for (size_t part = 0; s->scatter.gauges && part < edge_fit->part_count; part++) {
    double along, square;
    if (!(edge_fit->parts[part].known_radius_mm > 0)) continue;
    fg_evidence_products(&s->problem, column, gauge, 1, &along);
    fg_evidence_products(&s->problem, gauge, gauge, 1, &square);
    to[part] -= square > 0 ? along / square : 0; /* a disc's only number */
    gauge++;
  }
}

/* Least squares of the geometry to one column, without any prior. `sizes`: room for the scatter. */
static void follow_column(fg_evidence_search *s, const fg_evidence_shift *w, size_t column,
                          double *sizes, double *to) {
  fg_evidence_problem *p = &s->problem;
  size_t n = s->scatter.count, rank = p->rank, at = 0;
  fg_evidence_products(p, column, s->scatter.first, n, sizes);
  for (size_t i = 0; i < n; i++)
    sizes[i] = (sizes[i] - fg_dot(w->scatter + i * n, sizes, i)) / w->scatter[i * n + i];
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++)
      sizes[i] -= w->scatter[k * n + i] * sizes[k];
    sizes[i] /= w->scatter[i * n + i];
  }
  for (size_t i = 0; i < w->count; i++) {
    double sum = 0;
    for (size_t k = 0; k < rank; k++) {
      double along = p->along[column * rank + k];
      for (size_t c = 0; c < n; c++)
        along -= p->along[(s->scatter.first + c) * rank + k] * sizes[c];
      sum += w->flat[i * rank + k] * along;
    }
    to[i] = sum;
  }
  follow_gauges(s, column, to);
  size_t bump = 0;
  for (size_t part = 0; part < p->edge_fit->part_count; part++) {
    for (size_t b = 0; b < p->edge_fit->parts[part].bump_count && 3 * bump < n; b++, bump++) {
      to[at + 1 + 2 * b] += sizes[3 * bump];
      to[at + 2 + 2 * b] += sizes[3 * bump + 1];
    }
    at += 1 + 2 * p->edge_fit->parts[part].bump_count;
  }
}

fg_status fg_evidence_shift_add(fg_context *ctx, fg_evidence_search *s,
                                const fg_evidence_model *model, double weight,
                                fg_evidence_shift *w) {
  fg_evidence_posterior posterior;
  FG_TRY(fg_evidence_find_posterior(ctx, s, model, &posterior));
  fg_status status = fg_evidence_shift_add_posterior(ctx, s, model, &posterior, weight, w);
  fg_evidence_posterior_close(&posterior);
  return status;
}

size_t fg_evidence_list_scanner_columns(const fg_evidence_search *s, const fg_evidence_model *model,
                                        size_t list[FG_EVIDENCE_MODEL_COLUMNS]) {
  size_t n = 0;
  for (size_t k = 0; k < model->parts; k++)
    for (size_t c = 0; fg_evidence_is_of_scanner(model->part[k]) && c < model->part[k]->count; c++)
      list[n++] = fg_evidence_first_of(s, model, k) + c;
  return n;
}

fg_status fg_evidence_shift_add_posterior(fg_context *ctx, fg_evidence_search *s,
                                          const fg_evidence_model *model,
                                          const fg_evidence_posterior *posterior, double weight,
                                          fg_evidence_shift *w) {
  size_t list[FG_EVIDENCE_MODEL_COLUMNS], n = fg_evidence_list_scanner_columns(s, model, list);
  double *follow = NULL;
  FG_TRY(fg_memory_allocate(ctx, (n + 1) * (2 * w->count + 2) + s->scatter.count, sizeof *follow,
                            (void **)&follow));
  double *times = follow + n * w->count, *own = times + w->count, *sizes = own + w->count;
  for (size_t c = 0; c < n; c++)
    follow_column(s, w, posterior->column[list[c]], sizes, follow + c * w->count);
  memset(own, 0, w->count * sizeof *own);
  for (size_t c = 0; c < n; c++)
    for (size_t i = 0; i < w->count; i++)
      own[i] += follow[c * w->count + i] * posterior->mean[list[c]];
  for (size_t c = 0; c < n; c++) {
    memset(times, 0, w->count * sizeof *times);
    for (size_t k = 0; k < n; k++)
      for (size_t i = 0; i < w->count; i++)
        times[i] +=
            posterior->covariance[list[c] * posterior->count + list[k]] * follow[k * w->count + i];
    for (size_t i = 0; i < w->count; i++)
      for (size_t k = 0; k < w->count; k++)
        w->second[i * w->count + k] += weight * follow[c * w->count + i] * times[k];
  }
  for (size_t i = 0; i < w->count; i++) {
    w->mean[i] += weight * own[i];
    for (size_t k = 0; k < w->count; k++)
      w->second[i * w->count + k] += weight * own[i] * own[k];
  }
  free(follow);
  return FG_OK;
}

/* Covariance of numbers i and k about a mean, less the known one. */
static double spread_of(const fg_evidence_shift *w, const fg_evidence_shift *known, size_t i,
                        size_t k) {
  size_t n = w->count;
  const double *mean = known ? known->mean : w->mean;
  double value = w->second[i * n + k] - mean[i] * w->mean[k] - w->mean[i] * mean[k];
  value += mean[i] * mean[k];
  if (known) value -= known->second[i * n + k] - mean[i] * mean[k];
  return 1e-6 * value;
}

static void fill_bump(const fg_evidence_shift *w, const fg_evidence_shift *known,
                      const size_t index[3], double to[3][3]) {
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      double a = fmax(0, spread_of(w, known, index[i], index[i]));
      double b = fmax(0, spread_of(w, known, index[k], index[k])), max = sqrt(a * b);
      to[i][k] = fmax(-max, fmin(max, spread_of(w, known, index[i], index[k])));
    }
}

void fg_evidence_shift_spread(const fg_edge_fit *edge_fit, const fg_evidence_shift *w,
                              const fg_evidence_shift *known, fg_displacement_part *parts) {
  size_t at = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    parts[p].overall = fmax(0, spread_of(w, known, at, at));
    for (size_t b = 0; b < edge_fit->parts[p].bump_count; b++)
      fill_bump(w, known, (const size_t[3]){at + 1 + 2 * b, at + 2 + 2 * b, at}, parts[p].bumps[b]);
    at += 1 + 2 * edge_fit->parts[p].bump_count;
  }
}
