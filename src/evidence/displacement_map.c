/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/displacement_map.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "field/map_fit.h"

/* Weight up to which models that have no map are left out. */
#define WEIGHT_WITHOUT 0.02
/* Share of the displacement that splines may miss. */
#define MISSED_SHARE 0.003
enum { SPLINES_MAX = 220, TESTS = 41 };
#define MM_PER_UM 1e-3
#define RIDGE_MM2 1e-16

/* A jump is no spline; a scale of known sizes keeps its own uncertainty. */
static bool has_no_map(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_effect *effect = model->part[k]->effect;
    if (effect && effect->glass && (effect->jumps || effect->scales)) return true;
  }
  return false;
}

/* Keeps the models that have a map; none where one of the others has weight. */
static void keep_mapped(fg_evidence_window *w) {
  size_t kept = 0;
  double without = 0;
  for (size_t m = 0; m < w->count; m++) {
    if (has_no_map(w->model[m])) {
      without += w->weight[m];
      continue;
    }
    w->model[kept] = w->model[m];
    w->weight[kept++] = w->weight[m];
  }
  for (size_t m = 0; m < kept; m++)
    w->weight[m] /= 1 - without;
  w->count = without > WEIGHT_WITHOUT ? 0 : kept;
}

/* ---- splines ---- */

static void fit_mean(const fg_map_fit *fit, const fg_displacement *mean, double *moves,
                     double *mm) {
  for (size_t p = 0; p < fit->places; p++) {
    fg_point d = fg_displacement_at(mean, fit->at[p]);
    moves[2 * p] = d.x;
    moves[2 * p + 1] = d.y;
  }
  fg_map_fit_splines(fit, moves, mm);
}

/* Returns true where a map follows the mean, between the places of its fit as well. */
static bool follows_mean(const fg_map_frame *frame, const double *mm, const fg_displacement *mean) {
  double missed = 0, all = 0;
  for (int i = 0; i < TESTS * TESTS; i++) {
    fg_point at = fg_map_place(frame, (i % TESTS + 0.5) / TESTS, (i / TESTS + 0.5) / TESTS);
    fg_point d = fg_displacement_at(mean, at), m = fg_map_at(frame, mm, at);
    missed += pow(d.x - m.x, 2) + pow(d.y - m.y, 2);
    all += d.x * d.x + d.y * d.y;
  }
  return missed <= MISSED_SHARE * MISSED_SHARE * all;
}

/* Fits the coarsest splines that follow the mean; none: `map` has no numbers. */
static fg_status choose_splines(fg_context *ctx, const fg_displacement *mean, fg_map_fit *fit,
                                fg_field_map *map) {
  static const size_t sides[][2] = {{6, 6},  {9, 9},  {6, 14}, {14, 6}, {14, 14},
                                    {9, 19}, {19, 9}, {9, 24}, {24, 9}};
  const fg_field_frame *frame = &mean->frame;
  double *moves = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 10 * SPLINES_MAX, sizeof *moves, (void **)&moves));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * SPLINES_MAX, sizeof *map->mm, (void **)&map->mm));
  for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
    map->frame = (fg_map_frame){{frame->low_mm[0], frame->low_mm[1]},
                                {frame->high_mm[0], frame->high_mm[1]},
                                {sides[k][0], sides[k][1]}};
    FG_TRY_EXIT(fg_map_fit_open(ctx, &map->frame, fit));
    fit_mean(fit, mean, moves, map->mm);
    if (follows_mean(&map->frame, map->mm, mean)) goto exit;
    fg_map_fit_close(fit);
  }
  fg_field_map_free(map);
exit:
  if (status != FG_OK) fg_field_map_free(map);
  free(moves);
  return status;
}

/* ---- covariance of the splines' numbers ---- */

static size_t displacements_of(const fg_evidence_part *part, const fg_field_frame *frame,
                               fg_point at, fg_point *d) {
  if (part->rival) {
    fg_point all[FG_RIVAL_COLUMNS];
    part->rival->glass(frame, at, all);
    memcpy(d, all + (part->rival->stretch ? part->stretch * part->count : 0),
           part->count * sizeof *d);
    return part->count;
  }
  fg_evidence_glass_effect(part)->glass(frame, part->shape, at, d);
  return part->count;
}

typedef struct covariance_work {
  fg_evidence_search *search;
  const fg_map_fit *fit;
  size_t numbers;
  gsl_matrix *second; /* moments of the numbers, mm², over the models */
  gsl_vector *mean;
} covariance_work;

/* Splines of every scanner's column of a model, row by row, um per um. */
static fg_status fit_columns(fg_context *ctx, const covariance_work *work,
                             const fg_evidence_model *model, gsl_matrix *splines) {
  const fg_map_fit *fit = work->fit;
  size_t at = 0;
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    fg_point d[FG_RIVAL_COLUMNS];
    double *moves = NULL;
    if (!fg_evidence_is_of_scanner(part)) continue;
    FG_TRY(fg_memory_allocate(ctx, part->count, 2 * fit->places * sizeof *moves, (void **)&moves));
    for (size_t p = 0; p < fit->places; p++) {
      size_t count = displacements_of(part, &work->search->problem.edge_fit->frame, fit->at[p], d);
      for (size_t c = 0; c < count; c++) {
        moves[2 * (c * fit->places + p)] = d[c].x;
        moves[2 * (c * fit->places + p) + 1] = d[c].y;
      }
    }
    for (size_t c = 0; c < part->count; c++)
      fg_map_fit_splines(fit, moves + 2 * c * fit->places, gsl_matrix_ptr(splines, at++, 0));
    free(moves);
  }
  return FG_OK;
}

static fg_status add_moments(fg_context *ctx, const fg_evidence_model *model,
                             const fg_evidence_posterior *posterior, double weight,
                             covariance_work *work) {
  size_t index[FG_EVIDENCE_MODEL_COLUMNS];
  size_t n = fg_evidence_list_scanner_columns(work->search, model, index);
  if (!n) return FG_OK;
  gsl_matrix *splines = gsl_matrix_calloc(n, work->numbers);
  gsl_matrix *covariance = gsl_matrix_calloc(n, n), *times = gsl_matrix_calloc(n, work->numbers);
  gsl_vector *mean = gsl_vector_calloc(n), *own = gsl_vector_calloc(work->numbers);
  fg_status status = FG_OK;
  if (!splines || !covariance || !times || !mean || !own) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu splines", work->numbers);
    goto exit;
  }
  FG_TRY_EXIT(fit_columns(ctx, work, model, splines));
  for (size_t i = 0; i < n; i++) {
    gsl_vector_set(mean, i, MM_PER_UM * posterior->mean[index[i]]);
    for (size_t k = 0; k < n; k++)
      gsl_matrix_set(covariance, i, k,
                     MM_PER_UM * MM_PER_UM *
                         posterior->covariance[index[i] * posterior->count + index[k]]);
  }
  gsl_blas_dgemv(CblasTrans, 1, splines, mean, 0, own);
  gsl_blas_daxpy(weight, own, work->mean);
  gsl_blas_dger(weight, own, own, work->second);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, covariance, splines, 0, times);
  gsl_blas_dgemm(CblasTrans, CblasNoTrans, weight, splines, times, 1, work->second);
exit:
  gsl_matrix_free(splines);
  gsl_matrix_free(covariance);
  gsl_matrix_free(times);
  gsl_vector_free(mean);
  gsl_vector_free(own);
  return status;
}

/* Columns of moves at the fit's places, independent of each other: those of the covariance's lower
 * factor. */
static fg_status find_moves(fg_context *ctx, const covariance_work *work, gsl_matrix *moves) {
  const fg_map_fit *fit = work->fit;
  gsl_matrix *factor = work->second;
  gsl_blas_dger(-1, work->mean, work->mean, factor);
  for (size_t i = 0; i < work->numbers; i++)
    *gsl_matrix_ptr(factor, i, i) += RIDGE_MM2 + 1e-6 * fabs(gsl_matrix_get(factor, i, i));
  if (gsl_linalg_cholesky_decomp1(factor))
    return fg_fail(ctx, FG_ERR_NUMERIC, "the covariance of the scanner's map has no factor");
  size_t splines = fg_map_splines(&fit->frame);
  fg_map_weight weights[FG_MAP_WEIGHTS];
  for (size_t p = 0; p < fit->places; p++) {
    fg_map_weigh(&fit->frame, fit->at[p], weights);
    for (size_t c = 0; c < work->numbers; c++)
      for (size_t component = 0; component < 2; component++) {
        double sum = 0;
        for (int k = 0; k < FG_MAP_WEIGHTS; k++) {
          size_t row = component * splines + weights[k].spline;
          if (row >= c) sum += weights[k].value * gsl_matrix_get(factor, row, c);
        }
        gsl_matrix_set(moves, 2 * p + component, c, sum);
      }
  }
  return FG_OK;
}

static fg_status find_modes(fg_context *ctx, fg_evidence_search *s, const fg_evidence_window *w,
                            const fg_map_fit *fit, fg_field_map *map) {
  size_t numbers = 2 * fg_map_splines(&fit->frame);
  covariance_work work = {.search = s, .fit = fit, .numbers = numbers};
  gsl_matrix *moves = gsl_matrix_calloc(2 * fit->places, numbers);
  fg_status status = FG_OK;
  work.second = gsl_matrix_calloc(numbers, numbers);
  work.mean = gsl_vector_calloc(numbers);
  if (!moves || !work.second || !work.mean) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu splines", numbers);
    goto exit;
  }
  for (size_t m = 0; m < w->count && status == FG_OK; m++) {
    fg_evidence_posterior posterior;
    FG_TRY_EXIT(fg_evidence_find_posterior(ctx, s, w->model[m], &posterior));
    status = add_moments(ctx, w->model[m], &posterior, w->weight[m], &work);
    fg_evidence_posterior_close(&posterior);
  }
  for (size_t k = 0; k < numbers; k++)
    map->mm[k] = gsl_vector_get(work.mean, k);
  if (status == FG_OK) status = find_moves(ctx, &work, moves);
  if (status == FG_OK) status = fg_map_fit_add_principal_modes(ctx, fit, moves, map);
exit:
  gsl_matrix_free(moves);
  gsl_matrix_free(work.second);
  gsl_vector_free(work.mean);
  return status;
}

fg_status fg_evidence_find_map(fg_context *ctx, fg_evidence_search *s,
                               const fg_evidence_window *window, const fg_displacement *about,
                               fg_field_map *map) {
  fg_evidence_window w = *window;
  fg_map_fit fit = {.places = 0};
  *map = (fg_field_map){.mm = NULL};
  keep_mapped(&w);
  if (!w.count) return FG_OK;
  FG_TRY(choose_splines(ctx, about, &fit, map));
  if (!map->mm) return FG_OK;
  fg_status status = find_modes(ctx, s, &w, &fit, map);
  fg_map_fit_close(&fit);
  if (status != FG_OK) fg_field_map_free(map);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}
