/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field/map_fit.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Places of the region per spline and axis. */
enum { PLACES_PER_SPLINE = 2 };
#define RIDGE 1e-9

static fg_status list_places(fg_context *ctx, fg_map_fit *fit) {
  const fg_map_frame *frame = &fit->frame;
  size_t nx = PLACES_PER_SPLINE * frame->side[0], ny = PLACES_PER_SPLINE * frame->side[1];
  fit->places = nx * ny;
  FG_TRY(fg_memory_allocate(ctx, fit->places, sizeof *fit->at, (void **)&fit->at));
  for (size_t k = 0; k < fit->places; k++) {
    double x = (double)(k % nx) / (double)(nx - 1), y = (double)(k / nx) / (double)(ny - 1);
    fit->at[k] = fg_map_place(frame, x, y);
  }
  return FG_OK;
}

static fg_status factor_splines(fg_context *ctx, fg_map_fit *fit) {
  size_t n = fg_map_splines(&fit->frame);
  fg_map_weight weights[FG_MAP_WEIGHTS];
  fit->splines = gsl_matrix_calloc(n, n);
  if (!fit->splines) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu splines", n);
  for (size_t p = 0; p < fit->places; p++) {
    fg_map_weigh(&fit->frame, fit->at[p], weights);
    for (int a = 0; a < FG_MAP_WEIGHTS; a++)
      for (int b = 0; b < FG_MAP_WEIGHTS; b++)
        *gsl_matrix_ptr(fit->splines, weights[a].spline, weights[b].spline) +=
            weights[a].value * weights[b].value;
  }
  for (size_t k = 0; k < n; k++)
    *gsl_matrix_ptr(fit->splines, k, k) += RIDGE;
  if (gsl_linalg_cholesky_decomp1(fit->splines))
    return fg_fail(ctx, FG_ERR_NUMERIC, "the map's splines cannot be fitted");
  return FG_OK;
}

fg_status fg_map_fit_open(fg_context *ctx, const fg_map_frame *frame, fg_map_fit *fit) {
  *fit = (fg_map_fit){.frame = *frame};
  fg_status status = list_places(ctx, fit);
  if (status == FG_OK) status = factor_splines(ctx, fit);
  if (status != FG_OK) fg_map_fit_close(fit);
  return status;
}

void fg_map_fit_close(fg_map_fit *fit) {
  free(fit->at);
  gsl_matrix_free(fit->splines);
  *fit = (fg_map_fit){.places = 0};
}

static void fit_component(const fg_map_fit *fit, const double *moves, size_t component,
                          double *mm) {
  size_t n = fg_map_splines(&fit->frame);
  fg_map_weight weights[FG_MAP_WEIGHTS];
  gsl_vector_view right = gsl_vector_view_array(mm, n);
  memset(mm, 0, n * sizeof *mm);
  for (size_t p = 0; p < fit->places; p++) {
    fg_map_weigh(&fit->frame, fit->at[p], weights);
    for (int k = 0; k < FG_MAP_WEIGHTS; k++)
      mm[weights[k].spline] += weights[k].value * moves[2 * p + component];
  }
  gsl_linalg_cholesky_svx(fit->splines, &right.vector);
}

void fg_map_fit_splines(const fg_map_fit *fit, const double *moves, double *mm) {
  for (size_t component = 0; component < 2; component++)
    fit_component(fit, moves, component, mm + component * fg_map_splines(&fit->frame));
}

fg_status fg_map_fit_add_mode(fg_context *ctx, const fg_map_fit *fit, const double *moves,
                              fg_field_map *map) {
  double **mm = &map->modes[map->mode_count];
  FG_TRY(fg_memory_allocate(ctx, 2 * fg_map_splines(&fit->frame), sizeof **mm, (void **)mm));
  map->mode_count++;
  fg_map_fit_splines(fit, moves, *mm);
  return FG_OK;
}

/* Sign of a mode in a mixture, which looks random: the last bit of splitmix64 (Steele 2014). */
static double sign_of_mode(size_t mode, size_t mixture) {
  uint64_t bits =
      (mode + 1) * UINT64_C(0x9E3779B97F4A7C15) + mixture * UINT64_C(0xD1B54A32D192ED03);
  bits = (bits ^ (bits >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
  bits = (bits ^ (bits >> 27)) * UINT64_C(0x94D049BB133111EB);
  return (bits >> 63) ? 1 : -1;
}

/* Columns of `mixtures`: the first `kept` vectors one by one; the others, which are short waves and
 * many, in mixtures with random signs. Whatever is measured, the squares of its moves by mixtures
 * have the expectation that those by the vectors have (Hutchinson 1989). */
static void mix_modes(const gsl_matrix *vectors, size_t kept, gsl_matrix *mixtures) {
  size_t n = vectors->size2, mixed = mixtures->size2 - kept;
  for (size_t k = 0; k < n; k++) {
    gsl_vector_const_view vector = gsl_matrix_const_column(vectors, k);
    for (size_t m = k < kept ? k : kept; m < (k < kept ? k + 1 : mixtures->size2); m++) {
      double weight = k < kept ? 1 : sign_of_mode(k, m) / sqrt((double)mixed);
      gsl_vector_view mixture = gsl_matrix_column(mixtures, m);
      gsl_blas_daxpy(weight, &vector.vector, &mixture.vector);
    }
  }
}

/* The eigenvectors of movesᵀ moves with the largest variance, and mixtures of the others. */
fg_status fg_map_fit_add_principal_modes(fg_context *ctx, const fg_map_fit *fit,
                                         const gsl_matrix *moves, fg_field_map *map) {
  size_t n = moves->size2, kept = n < FG_MAP_MODES_KEPT ? n : FG_MAP_MODES_KEPT;
  size_t modes = n > kept ? FG_MAP_PRINCIPAL_MODES : kept;
  gsl_matrix *square = gsl_matrix_calloc(n, n), *vectors = gsl_matrix_calloc(n, n);
  gsl_matrix *mixtures = gsl_matrix_calloc(n, modes);
  gsl_vector *values = gsl_vector_calloc(n), *mode = gsl_vector_calloc(2 * fit->places);
  gsl_eigen_symmv_workspace *space = gsl_eigen_symmv_alloc(n);
  fg_status status = FG_OK;
  if (!square || !vectors || !mixtures || !values || !mode || !space) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", n);
    goto exit;
  }
  gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, moves, moves, 0, square);
  gsl_eigen_symmv(square, values, vectors, space);
  gsl_eigen_symmv_sort(values, vectors, GSL_EIGEN_SORT_VAL_DESC);
  mix_modes(vectors, kept, mixtures);
  for (size_t k = 0; k < modes; k++) {
    gsl_vector_const_view mixture = gsl_matrix_const_column(mixtures, k);
    gsl_blas_dgemv(CblasNoTrans, 1, moves, &mixture.vector, 0, mode);
    FG_TRY_EXIT(fg_map_fit_add_mode(ctx, fit, mode->data, map));
  }
exit:
  gsl_matrix_free(square);
  gsl_matrix_free(vectors);
  gsl_matrix_free(mixtures);
  gsl_vector_free(values);
  gsl_vector_free(mode);
  gsl_eigen_symmv_free(space);
  return status;
}
