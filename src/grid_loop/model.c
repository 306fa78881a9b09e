/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scanner's model of a loop on grids. Its uncertainty is that of effects and map together: the
 * principal modes of their covariance over the region, as maps. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "field/map_fit.h"
#include "grid_loop/grid_loop.h"

enum { RANDOM_MODES = 4 };
_Static_assert((int)FG_MAP_PRINCIPAL_MODES + (int)RANDOM_MODES <= (int)FG_MAP_MODES_MAX,
               "a model that is written can be read");

/* A ripple or step is no smooth displacement: its numbers keep their own uncertainty. */
static bool is_smooth(const fg_effect *kind) {
  return kind->sought != FG_EFFECT_PLACED;
}

typedef struct mode_work {
  const fg_grid_loop *loop;
  fg_map_fit fit;
  size_t first, count; /* columns of effects and map */
  gsl_matrix *factor;  /* L of their covariance, without placed effects */
  gsl_matrix *moves;   /* 2 places × count: displacement by L's columns */
} mode_work;

static void free_mode_work(mode_work *work) {
  fg_map_fit_close(&work->fit);
  gsl_matrix_free(work->factor);
  gsl_matrix_free(work->moves);
}

static fg_status factor_covariance(fg_context *ctx, mode_work *work) {
  const fg_grid_loop *loop = work->loop;
  size_t n = work->count, at = 0;
  work->factor = gsl_matrix_calloc(n, n);
  if (!work->factor) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", n);
  double widening = loop->widening * loop->widening;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(
          work->factor, i, j,
          widening * gsl_matrix_get(loop->solution.covariance, work->first + i, work->first + j));
  for (size_t e = 0; e < loop->problem.model.effects; e++) {
    size_t columns = fg_grid_effect_columns(&loop->problem.model.effect[e]);
    for (size_t k = 0; k < columns; k++, at++) {
      if (is_smooth(loop->problem.model.effect[e].kind)) continue;
      for (size_t j = 0; j < n; j++) {
        gsl_matrix_set(work->factor, at, j, 0);
        gsl_matrix_set(work->factor, j, at, 0);
      }
    }
  }
  for (size_t i = 0; i < n; i++)
    *gsl_matrix_ptr(work->factor, i, i) += 1e-16;
  if (gsl_linalg_cholesky_decomp1(work->factor))
    return fg_fail(ctx, FG_ERR_NUMERIC, "the map's covariance cannot be factored");
  for (size_t i = 0; i < n; i++)
    for (size_t j = i + 1; j < n; j++)
      gsl_matrix_set(work->factor, i, j, 0);
  return FG_OK;
}

static fg_status find_moves_of_columns(fg_context *ctx, mode_work *work) {
  const fg_grid_loop *loop = work->loop;
  size_t rows = 2 * work->fit.places, index[GRID_ROW_MAX];
  fg_point value[GRID_ROW_MAX];
  gsl_matrix *columns = gsl_matrix_calloc(rows, work->count);
  work->moves = gsl_matrix_calloc(rows, work->count);
  if (!columns || !work->moves) {
    gsl_matrix_free(columns);
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", work->count);
  }
  for (size_t p = 0; p < work->fit.places; p++) {
    size_t n = fg_grid_displacement_columns(&loop->problem, &loop->solution.columns,
                                            work->fit.at[p], index, value);
    for (size_t k = 0; k < n; k++) {
      gsl_matrix_set(columns, 2 * p, index[k] - work->first, value[k].x);
      gsl_matrix_set(columns, 2 * p + 1, index[k] - work->first, value[k].y);
    }
  }
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, columns, work->factor, 0, work->moves);
  gsl_matrix_free(columns);
  return FG_OK;
}

/* The carriage's random part differs from scan to scan: cosines over its travel, of equal variance.
 */
static fg_status add_random_modes(fg_context *ctx, const mode_work *work, fg_field_map *map) {
  double um = work->loop->result.carriage_um, *moves;
  if (!(um > 0)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 2 * work->fit.places, sizeof *moves, (void **)&moves));
  fg_status status = FG_OK;
  for (int k = 1; k <= RANDOM_MODES && status == FG_OK; k++) {
    for (size_t p = 0; p < work->fit.places; p++) {
      double v = (work->fit.at[p].y - map->frame.low_mm[1]) /
                 (map->frame.high_mm[1] - map->frame.low_mm[1]);
      moves[2 * p] = 0;
      moves[2 * p + 1] = um / 1000 * sqrt(2.0 / RANDOM_MODES) * cos(k * M_PI * v);
    }
    status = fg_map_fit_add_mode(ctx, &work->fit, moves, map);
  }
  free(moves);
  return status;
}

static fg_status make_map(fg_context *ctx, fg_grid_loop *loop, fg_scanner_model *model) {
  const grid_columns *columns = &loop->solution.columns;
  fg_field_map *map = &model->map;
  mode_work work = {
      .loop = loop, .first = columns->effect, .count = columns->board_map - columns->effect};
  fg_status status = FG_OK;
  map->frame = loop->problem.model.map;
  size_t numbers = 2 * fg_map_splines(&map->frame);
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *map->mm, (void **)&map->mm));
  for (size_t k = 0; k < numbers; k++)
    map->mm[k] = gsl_vector_get(loop->solution.estimate, columns->map + k);
  FG_TRY_EXIT(fg_map_fit_open(ctx, &map->frame, &work.fit));
  FG_TRY_EXIT(factor_covariance(ctx, &work));
  FG_TRY_EXIT(find_moves_of_columns(ctx, &work));
  FG_TRY_EXIT(fg_map_fit_add_principal_modes(ctx, &work.fit, work.moves, map));
  FG_TRY_EXIT(add_random_modes(ctx, &work, map));
  model->fields.map = &map->frame;
  model->fields.map_mm = map->mm;
exit:
  free_mode_work(&work);
  return status;
}

/* The u of each amplitude that moves the region, rms, by as much as all numbers of the effect
 * together: amplitudes and a shape depend on each other. */
static double u_of_effect(const fg_grid_loop *loop, const grid_effect *effect, size_t first) {
  enum { STEPS = 40 };
  const fg_field_frame *frame = &loop->problem.model.frame;
  size_t own = effect->kind->columns, n = fg_grid_effect_columns(effect);
  double variance = 0, unit = 0;
  for (int i = 0; i <= STEPS; i++) {
    fg_point d[FG_FIELD_COLUMNS];
    double share = i / (double)STEPS;
    fg_point at = {frame->low_mm[0] + share * (frame->high_mm[0] - frame->low_mm[0]),
                   frame->low_mm[1] + share * (frame->high_mm[1] - frame->low_mm[1])};
    fg_grid_effect_moves(effect, frame, at, d);
    for (size_t a = 0; a < n; a++) {
      if (a < own) unit += d[a].x * d[a].x + d[a].y * d[a].y;
      for (size_t b = 0; b < n; b++)
        variance += (d[a].x * d[b].x + d[a].y * d[b].y) *
                    gsl_matrix_get(loop->solution.covariance, first + a, first + b);
    }
  }
  return unit > 0 ? loop->widening * sqrt(fmax(0, variance) / unit) : 0;
}

/* A tied value is in no model: it may be the board's. */
static void make_fields(const fg_grid_loop *loop, fg_scanner_model *model) {
  const grid_problem *problem = &loop->problem;
  size_t at = loop->solution.columns.effect;
  model->fields.frame = problem->model.frame;
  for (size_t e = 0; e < problem->model.effects; e++) {
    const grid_effect *effect = &problem->model.effect[e];
    fg_field field = fg_effect_field(effect->kind);
    bool tied = loop->result.claim[e].verdict == FG_GRID_TIED;
    bool in_modes = problem->model.has_map && is_smooth(effect->kind);
    double u = in_modes ? 0 : u_of_effect(loop, effect, at);
    for (size_t k = 0; k < effect->kind->columns; k++) {
      field.amplitude_mm[k] = gsl_vector_get(loop->solution.estimate, at + k);
      field.u_amplitude_mm[k] = u;
    }
    memcpy(field.shape, effect->shape, sizeof field.shape);
    field.u_shape[0] = fg_grid_jump_u_mm(problem, effect);
    at += fg_grid_effect_columns(effect);
    if (!tied && model->fields.count < FG_FIELDS_MAX)
      model->fields.fields[model->fields.count++] = field;
  }
}

fg_status fg_grid_loop_make_model(fg_context *ctx, fg_grid_loop *loop) {
  const fg_measurement *first = &loop->measurements[0];
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *loop->model, (void **)&loop->model));
  fg_scanner_model *model = loop->model;
  if (loop->options.scanner)
    fg_text_clip(model->scanner, sizeof model->scanner, "%s", loop->options.scanner);
  fg_date_format_utc(loop->options.date, model->date);
  for (int axis = 0; axis < 2; axis++)
    model->dpi[axis] = first->dpi[axis] * fg_calibration_factor(&first->design.calibration);
  model->scans = loop->scan_count;
  model->known_grids = loop->result.scale_known ? loop->scan_count : 0;
  model->artefact = first->design.artefact;
  fg_scanner_model_set_temperature(&first->design.calibration, model);
  make_fields(loop, model);
  if (loop->problem.model.has_map && loop->result.axes_known) FG_TRY(make_map(ctx, loop, model));
  return FG_OK;
}

fg_status fg_grid_loop_write_model(fg_context *ctx, const fg_grid_loop *loop, FILE *out) {
  fg_scanner_model_input inputs[FG_GRID_SCANS];
  if (!loop->result.axes_known)
    return fg_fail(ctx, FG_ERR_DATA, "no model is written: %s", loop->result.advice);
  size_t count = loop->scan_count + loop->held_out_count;
  for (size_t i = 0; i < count; i++) {
    const fg_measurement *m = &loop->measurements[i];
    inputs[i] = (fg_scanner_model_input){m->scan, m->sha256, i >= loop->scan_count};
    FG_TRY(fg_scanner_model_check_picture(ctx, m));
  }
  return fg_scanner_model_write(ctx, loop->model, inputs, count, out);
}
