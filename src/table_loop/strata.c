/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strata of the rows: random levels of a column group them, and those of a second column, in which
 * the groups lie, are the outer ones. */
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "table_loop/engine.h"

typedef struct level_key {
  double level;
  size_t at;
} level_key;

static int by_level(const void *a, const void *b) {
  const level_key *x = a, *y = b;
  if (x->level != y->level) return x->level < y->level ? -1 : 1;
  return (x->at > y->at) - (x->at < y->at);
}

static double level_at(const fg_loop_problem *problem, size_t coordinate, size_t row) {
  return coordinate == SIZE_MAX ? (double)problem->group[row]
                                : problem->coordinate[coordinate].value[row];
}

/* Random levels of a column group the rows, wherever they stand. */
static fg_status group_rows(fg_context *ctx, size_t coordinate, fg_engine_training *training) {
  level_key *key = NULL;
  size_t n = training->n;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *training->level_row, (void **)&training->level_row));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *key, (void **)&key));
  for (size_t i = 0; i < n; i++)
    key[i] = (level_key){level_at(training->problem, coordinate, training->row[i]), i};
  fg_sort_items(key, n, sizeof *key, by_level);
  training->levels = 0;
  for (size_t i = 0; i < n; i++) {
    training->level_row[i] = key[i].at;
    if (i == 0 || key[i].level != key[i - 1].level) training->level_start[training->levels++] = i;
  }
  training->level_start[training->levels] = n;
  free(key);
  return FG_OK;
}

/* Levels of a second column group the groups. */
static fg_status group_blocks(fg_context *ctx, size_t coordinate, fg_engine_training *training) {
  size_t blocks = training->levels, size = sizeof *training->outer_block;
  level_key *key = NULL;
  FG_TRY(fg_memory_allocate(ctx, blocks + 1, size, (void **)&training->outer_block));
  FG_TRY(fg_memory_allocate(ctx, blocks + 1, size, (void **)&training->outer_start));
  FG_TRY(fg_memory_allocate(ctx, blocks + 1, sizeof *key, (void **)&key));
  for (size_t b = 0; b < blocks; b++) {
    size_t row = training->row[fg_engine_level_row(training, training->level_start[b])];
    key[b] = (level_key){level_at(training->problem, coordinate, row), b};
  }
  fg_sort_items(key, blocks, sizeof *key, by_level);
  for (size_t b = 0; b < blocks; b++) {
    training->outer_block[b] = key[b].at;
    if (b == 0 || key[b].level != key[b - 1].level) training->outer_start[training->outers++] = b;
  }
  training->outer_start[training->outers] = blocks;
  training->outer_at = coordinate;
  free(key);
  return FG_OK;
}

bool fg_engine_is_nested(const fg_loop_problem *problem, size_t inner, size_t outer) {
  size_t levels = inner == SIZE_MAX ? problem->groups : problem->coordinate[inner].levels;
  double *held = levels ? malloc(levels * sizeof *held) : NULL;
  bool nested = held && problem->coordinate[outer].levels < levels;
  for (size_t k = 0; held && k < levels; k++)
    held[k] = -1;
  for (size_t i = 0; nested && i < problem->rows; i++) {
    double *own = &held[(size_t)level_at(problem, inner, i)];
    double level = problem->coordinate[outer].value[i];
    nested = *own < 0 || *own == level;
    *own = level;
  }
  free(held);
  return nested;
}

bool fg_engine_is_outer_levels(const fg_engine_training *training,
                               const fg_loop_candidate *levels) {
  return training->outers > 0 && fg_engine_is_levels(levels) && levels->a == training->outer_at;
}

fg_status fg_engine_group_by_levels(fg_context *ctx, const fg_engine_set *set,
                                    fg_engine_training *training) {
  const fg_loop_problem *problem = training->problem;
  size_t column[2] = {SIZE_MAX, SIZE_MAX}, count = 0;
  for (size_t c = 0; c < set->count && count < 2; c++)
    if (fg_engine_is_levels(&set->candidate[c])) column[count++] = set->candidate[c].a;
  if (count == 0) return FG_OK;
  if (problem->group_level) return group_blocks(ctx, column[0], training);
  if (count == 1) return group_rows(ctx, column[0], training);
  bool first = fg_engine_is_nested(problem, column[0], column[1]);
  FG_TRY(group_rows(ctx, column[first ? 0 : 1], training));
  return group_blocks(ctx, column[first ? 1 : 0], training);
}
