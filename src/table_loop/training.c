/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames: the rows that are used, with the columns of the null. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/engine.h"

static size_t set_columns(const fg_loop_problem *problem, const fg_engine_set *set) {
  size_t count = 0;
  for (size_t i = 0; set && i < set->count; i++)
    if (!fg_engine_is_exchange(&set->candidate[i]) && !fg_engine_is_noise(&set->candidate[i]))
      count += fg_engine_candidate_columns(problem, &set->candidate[i]);
  return count;
}

static fg_status allocate_training(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set) {
  const fg_loop_problem *problem = training->problem;
  training->columns = problem->parameters + set_columns(problem, set);
  size_t n = training->n;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *training->row, (void **)&training->row));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *training->group, (void **)&training->group));
  FG_TRY(fg_memory_allocate(ctx, n + 1, sizeof *training->start, (void **)&training->start));
  FG_TRY(fg_memory_allocate(ctx, n + 1, sizeof *training->start, (void **)&training->level_start));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *training->y, (void **)&training->y));
  return fg_memory_allocate(ctx, n, sizeof *training->x * (training->columns + 1),
                            (void **)&training->x);
}

/* Groups and series get new numbers in order of appearance. */
static fg_status number_rows(fg_context *ctx, fg_engine_training *training) {
  const fg_loop_problem *problem = training->problem;
  size_t *number = NULL;
  FG_TRY(fg_memory_allocate(ctx, problem->groups, sizeof *number, (void **)&number));
  for (size_t i = 0; i < training->n; i++) {
    size_t group = problem->group[training->row[i]];
    if (!number[group]) number[group] = ++training->groups;
    training->group[i] = number[group] - 1;
    bool first = i == 0;
    if (first || problem->series[training->row[i]] != problem->series[training->row[i - 1]])
      training->start[training->blocks++] = i;
    if (problem->group_level && (first || training->group[i] != training->group[i - 1]))
      training->level_start[training->levels++] = i;
  }
  training->start[training->blocks] = training->n;
  training->level_start[training->levels] = training->n;
  free(number);
  return FG_OK;
}

static void put_back(fg_engine_training *training, const fg_loop_candidate *exchange) {
  const double *response = training->problem->response;
  double change = response[exchange->row[1]] - response[exchange->row[0]];
  for (size_t i = 0; i < training->n; i++) {
    if (training->row[i] == exchange->row[0]) training->y[i] += change;
    if (training->row[i] == exchange->row[1]) training->y[i] -= change;
  }
}

static fg_status fill_null_columns(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set) {
  const fg_loop_problem *problem = training->problem;
  double *next = training->x;
  for (size_t k = 0; k < problem->parameters; k++)
    for (size_t i = 0; i < training->n; i++)
      *next++ = problem->jacobian[k * problem->rows + training->row[i]];
  for (size_t i = 0; i < training->n; i++)
    training->y[i] = problem->residual[training->row[i]];
  for (size_t c = 0; set && c < set->count; c++) {
    training->serial |= fg_engine_is_serial(&set->candidate[c]);
    if (fg_engine_is_noise(&set->candidate[c])) continue;
    if (fg_engine_is_exchange(&set->candidate[c])) {
      put_back(training, &set->candidate[c]);
      continue;
    }
    FG_TRY(fg_engine_gather(ctx, training, &set->candidate[c], set->shape[c], next));
    next += training->n * fg_engine_candidate_columns(problem, &set->candidate[c]);
  }
  return FG_OK;
}

fg_status fg_engine_training_build(fg_context *ctx, const fg_loop_problem *problem,
                                   const bool *keep, const fg_engine_set *set,
                                   fg_engine_training *training) {
  fg_status status = FG_OK;
  *training = (fg_engine_training){.problem = problem};
  for (size_t i = 0; i < problem->rows; i++)
    training->n += !keep || keep[i];
  FG_TRY_EXIT(allocate_training(ctx, training, set));
  for (size_t i = 0, k = 0; i < problem->rows; i++)
    if (!keep || keep[i]) training->row[k++] = i;
  FG_TRY_EXIT(number_rows(ctx, training));
  if (set) FG_TRY_EXIT(fg_engine_group_by_levels(ctx, set, training));
  FG_TRY_EXIT(fill_null_columns(ctx, training, set));
  FG_TRY_EXIT(fg_engine_estimate_scale(ctx, training, set));
exit:
  if (status != FG_OK) fg_engine_training_free(training);
  return status;
}

void fg_engine_training_free(fg_engine_training *training) {
  free(training->row);
  free(training->group);
  free(training->scale);
  free(training->start);
  free(training->level_start);
  free(training->level_row);
  free(training->outer_block);
  free(training->outer_start);
  free(training->y);
  free(training->x);
  *training = (fg_engine_training){0};
}

double fg_engine_response(const fg_engine_training *training, size_t i) {
  const fg_loop_problem *problem = training->problem;
  size_t row = training->row[i];
  return training->y[i] - problem->residual[row] + problem->response[row];
}

/* Zeroes a basis that overflows at some row: columns of zeros explain nothing. */
static void refuse_overflow(double *columns, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(columns[i])) {
      memset(columns, 0, count * sizeof *columns);
      return;
    }
}

fg_status fg_engine_gather(fg_context *ctx, const fg_engine_training *training,
                           const fg_loop_candidate *candidate, const double *shape,
                           double *columns) {
  const fg_loop_problem *problem = training->problem;
  size_t count = fg_engine_candidate_columns(problem, candidate);
  double *all = NULL;
  if (training->n == problem->rows) {
    candidate->effect->basis(problem, candidate, shape, columns);
    refuse_overflow(columns, problem->rows * count);
    return FG_OK;
  }
  FG_TRY(fg_memory_allocate(ctx, problem->rows, (count + 1) * sizeof *all, (void **)&all));
  candidate->effect->basis(problem, candidate, shape, all);
  refuse_overflow(all, problem->rows * count);
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < training->n; i++)
      columns[k * training->n + i] = all[k * problem->rows + training->row[i]];
  free(all);
  return FG_OK;
}
