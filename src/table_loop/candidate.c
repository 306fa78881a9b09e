/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Properties of a candidate. */
#include <stdio.h>
#include <string.h>

#include "core/text.h"
#include "table_loop/engine.h"

bool fg_engine_is_outlier(const fg_loop_candidate *candidate) {
  return candidate->effect->outlier != FG_LOOP_NOT_OUTLIER;
}

bool fg_engine_is_exchange(const fg_loop_candidate *candidate) {
  return candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS;
}

bool fg_engine_is_noise(const fg_loop_candidate *candidate) {
  return candidate->effect->scatter != FG_LOOP_OF_THE_MEAN;
}

bool fg_engine_is_serial(const fg_loop_candidate *candidate) {
  return candidate->effect->scatter == FG_LOOP_SERIAL;
}

bool fg_engine_is_levels(const fg_loop_candidate *candidate) {
  return candidate->effect->scatter == FG_LOOP_LEVELS;
}

bool fg_engine_is_curve(const fg_loop_candidate *candidate) {
  return candidate->effect->unattributed;
}

size_t fg_engine_candidate_columns(const fg_loop_problem *problem,
                                   const fg_loop_candidate *candidate) {
  return candidate->effect->columns(problem, candidate);
}

bool fg_engine_same_candidate(const fg_loop_candidate *a, const fg_loop_candidate *b) {
  if (a->effect != b->effect || a->a != b->a || a->b != b->b || a->rows != b->rows) return false;
  return !a->rows || !memcmp(a->row, b->row, a->rows * sizeof *a->row);
}

bool fg_engine_same_cycle(const fg_loop_candidate *a, const fg_loop_candidate *b) {
  return a->effect->cycle && b->effect->cycle && a->a == b->a;
}

size_t fg_engine_row_number(const fg_loop_problem *problem, size_t row) {
  return (problem->table_row ? problem->table_row[row] : row) + 1;
}

static void name_rows(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                      char name[FG_LOOP_NAME]) {
  size_t used = (size_t)snprintf(name, FG_LOOP_NAME, "%s", candidate->effect->id);
  for (size_t k = 0; k < candidate->rows && used < FG_LOOP_NAME; k++, used = strlen(name))
    fg_text_clip(name + used, FG_LOOP_NAME - used, "%s%zu%s", k ? ", " : "(",
                 fg_engine_row_number(problem, candidate->row[k]),
                 k + 1 == candidate->rows ? ")" : "");
}

/* "the runs" for a column `run`; others by their name. */
static const char *coordinate_words(const fg_loop_coordinate *at) {
  static const char *const plural[][2] = {
      {"run", "the runs"}, {"row", "the rows"}, {"bump", "the bumps"}};
  for (size_t i = 0; i < sizeof plural / sizeof *plural; i++)
    if (!strcmp(at->name, plural[i][0]) && at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP))
      return plural[i][1];
  return at->name;
}

void fg_loop_effect_words(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          char *text, size_t size) {
  const fg_loop_effect *effect = candidate->effect;
  const fg_loop_coordinate *at = problem->coordinate;
  if (!effect->accepts)
    fg_text_clip(text, size, "%s", effect->words);
  else if (effect->pair)
    fg_text_clip(text, size, "%s %s and %s", effect->words, coordinate_words(&at[candidate->a]),
                 coordinate_words(&at[candidate->b]));
  else
    fg_text_clip(text, size, "%s %s", effect->words, coordinate_words(&at[candidate->a]));
}

void fg_engine_candidate_name(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                              char name[FG_LOOP_NAME]) {
  const char *id = candidate->effect->id;
  if (fg_engine_is_exchange(candidate))
    fg_text_clip(name, FG_LOOP_NAME, "%s(%zu, %zu)", id,
                 fg_engine_row_number(problem, candidate->row[0]),
                 fg_engine_row_number(problem, candidate->row[1]));
  else if (fg_engine_is_outlier(candidate) && candidate->effect->pair)
    fg_text_clip(name, FG_LOOP_NAME, "%s(%.24s, %.24s, %zu)", id,
                 problem->coordinate[candidate->a].name, problem->coordinate[candidate->b].name,
                 fg_engine_row_number(problem, candidate->row[0]));
  else if (fg_engine_is_outlier(candidate))
    name_rows(problem, candidate, name);
  else if (candidate->effect->pair)
    fg_text_clip(name, FG_LOOP_NAME, "%s(%s, %s)", id, problem->coordinate[candidate->a].name,
                 problem->coordinate[candidate->b].name);
  else
    fg_text_clip(name, FG_LOOP_NAME, "%s(%s)", id, problem->coordinate[candidate->a].name);
}

const char *const fg_loop_kind_words[] = {"columns", "interactions", "curves",    "order",
                                          "scatter", "rows",         "exchanges", NULL};

/* Share of the error rate of every kind. Recorded columns have the largest: a table is kept for
 * them. Many candidates of one kind cost that kind alone. */
static const double kind_share[FG_LOOP_KINDS] = {
    [FG_LOOP_KIND_COLUMNS] = 0.3,    [FG_LOOP_KIND_INTERACTIONS] = 0.1,
    [FG_LOOP_KIND_CURVES] = 0.08,    [FG_LOOP_KIND_ORDER] = 0.15,
    [FG_LOOP_KIND_SCATTER] = 0.1,    [FG_LOOP_KIND_ROWS] = 0.2,
    [FG_LOOP_KIND_EXCHANGES] = 0.07,
};

fg_loop_kind fg_loop_kind_of(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  const fg_loop_effect *effect = candidate->effect;
  if (effect->outlier == FG_LOOP_WRONG_ROW) return FG_LOOP_KIND_ROWS;
  if (effect->outlier == FG_LOOP_EXCHANGED_ROWS) return FG_LOOP_KIND_EXCHANGES;
  if (effect->scatter == FG_LOOP_SPREAD) return FG_LOOP_KIND_SCATTER;
  if (effect->pair) return FG_LOOP_KIND_INTERACTIONS;
  bool order = problem->coordinate[candidate->a].roles & (FG_LOOP_ORDER | FG_LOOP_BUMP);
  if (order || !strcmp(effect->frame, "order")) return FG_LOOP_KIND_ORDER;
  bool sought = effect->cycle && !effect->held;
  return effect->unattributed || effect->stepwise || sought ? FG_LOOP_KIND_CURVES
                                                            : FG_LOOP_KIND_COLUMNS;
}

void fg_loop_kind_shares(const bool expected[FG_LOOP_KINDS], double share[FG_LOOP_KINDS]) {
  double of_expected = 0;
  for (size_t k = 0; k < FG_LOOP_KINDS; k++)
    if (expected[k]) of_expected += kind_share[k];
  for (size_t k = 0; k < FG_LOOP_KINDS; k++) {
    share[k] = kind_share[k];
    if (of_expected > 0) share[k] /= 2;
    if (expected[k]) share[k] += kind_share[k] / of_expected / 2;
  }
}
