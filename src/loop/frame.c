/* Frames: the rows that are used, with the columns of the null. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "loop/engine.h"

static size_t set_columns(const fg_loop_problem *problem, const fg_engine_set *set) {
  size_t count = 0;
  for (size_t i = 0; set && i < set->count; i++)
    if (!fg_engine_is_exchange(&set->candidate[i]))
      count += fg_engine_candidate_columns(problem, &set->candidate[i]);
  return count;
}

static fg_status allocate(fg_context *ctx, fg_engine_frame *frame, const fg_engine_set *set) {
  const fg_loop_problem *problem = frame->problem;
  frame->columns = problem->parameters + set_columns(problem, set);
  size_t n = frame->n;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *frame->row, (void **)&frame->row));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *frame->group, (void **)&frame->group));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *frame->flip, (void **)&frame->flip));
  FG_TRY(fg_memory_allocate(ctx, n + 1, sizeof *frame->start, (void **)&frame->start));
  FG_TRY(fg_memory_allocate(ctx, n + 1, sizeof *frame->start, (void **)&frame->level_start));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *frame->y, (void **)&frame->y));
  return fg_memory_allocate(ctx, n, sizeof *frame->x * (frame->columns + 1), (void **)&frame->x);
}

/* Groups and series get new numbers in order of appearance. */
static fg_status number_rows(fg_context *ctx, fg_engine_frame *frame) {
  const fg_loop_problem *problem = frame->problem;
  size_t *number = NULL;
  FG_TRY(fg_memory_allocate(ctx, problem->groups, sizeof *number, (void **)&number));
  for (size_t i = 0; i < frame->n; i++) {
    size_t group = problem->group[frame->row[i]];
    if (!number[group]) number[group] = ++frame->groups;
    frame->group[i] = number[group] - 1;
    bool first = i == 0;
    if (first || problem->series[frame->row[i]] != problem->series[frame->row[i - 1]])
      frame->start[frame->blocks++] = i;
    if (problem->group_level && (first || frame->group[i] != frame->group[i - 1]))
      frame->level_start[frame->levels++] = i;
  }
  frame->start[frame->blocks] = frame->n;
  frame->level_start[frame->levels] = frame->n;
  frame->flips = frame->groups < FG_ENGINE_FLIP_GROUPS ? frame->groups : FG_ENGINE_FLIP_GROUPS;
  for (size_t i = 0; i < frame->n; i++)
    frame->flip[i] = frame->group[i] * frame->flips / frame->groups;
  free(number);
  return FG_OK;
}

static void put_back(fg_engine_frame *frame, const fg_loop_candidate *exchange) {
  const double *response = frame->problem->response;
  double change = response[exchange->row[1]] - response[exchange->row[0]];
  for (size_t i = 0; i < frame->n; i++) {
    if (frame->row[i] == exchange->row[0]) frame->y[i] += change;
    if (frame->row[i] == exchange->row[1]) frame->y[i] -= change;
  }
}

static fg_status fill_columns(fg_context *ctx, fg_engine_frame *frame, const fg_engine_set *set) {
  const fg_loop_problem *problem = frame->problem;
  double *next = frame->x;
  for (size_t k = 0; k < problem->parameters; k++)
    for (size_t i = 0; i < frame->n; i++)
      *next++ = problem->jacobian[k * problem->rows + frame->row[i]];
  for (size_t i = 0; i < frame->n; i++)
    frame->y[i] = problem->residual[frame->row[i]];
  for (size_t c = 0; set && c < set->count; c++) {
    if (fg_engine_is_exchange(&set->candidate[c])) {
      put_back(frame, &set->candidate[c]);
      continue;
    }
    FG_TRY(fg_engine_gather(ctx, frame, &set->candidate[c], set->shape[c], next));
    next += frame->n * fg_engine_candidate_columns(problem, &set->candidate[c]);
  }
  return FG_OK;
}

fg_status fg_engine_frame_build(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                                const fg_engine_set *set, fg_engine_frame *frame) {
  fg_status status = FG_OK;
  *frame = (fg_engine_frame){.problem = problem};
  for (size_t i = 0; i < problem->rows; i++)
    frame->n += !keep || keep[i];
  FG_TRY_EXIT(allocate(ctx, frame, set));
  for (size_t i = 0, k = 0; i < problem->rows; i++)
    if (!keep || keep[i]) frame->row[k++] = i;
  FG_TRY_EXIT(number_rows(ctx, frame));
  FG_TRY_EXIT(fill_columns(ctx, frame, set));
exit:
  if (status != FG_OK) fg_engine_frame_free(frame);
  return status;
}

void fg_engine_frame_free(fg_engine_frame *frame) {
  free(frame->row);
  free(frame->group);
  free(frame->flip);
  free(frame->start);
  free(frame->level_start);
  free(frame->y);
  free(frame->x);
  *frame = (fg_engine_frame){0};
}

/* A form that overflows at some row is no candidate: columns of zeros explain nothing. */
static void refuse_overflow(double *columns, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (!isfinite(columns[i])) {
      memset(columns, 0, count * sizeof *columns);
      return;
    }
}

fg_status fg_engine_gather(fg_context *ctx, const fg_engine_frame *frame,
                           const fg_loop_candidate *candidate, const double *shape,
                           double *columns) {
  const fg_loop_problem *problem = frame->problem;
  size_t count = fg_engine_candidate_columns(problem, candidate);
  double *all = NULL;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, count * sizeof *all, (void **)&all));
  candidate->effect->basis(problem, candidate, shape, all);
  refuse_overflow(all, problem->rows * count);
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < frame->n; i++)
      columns[k * frame->n + i] = all[k * problem->rows + frame->row[i]];
  free(all);
  return FG_OK;
}
