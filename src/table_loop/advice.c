/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Advice for resolving a tie: the two settings between which the predictions of the winner and its
 * nearest rival, each fitted to these rows, differ most. The level of a table is free, so a single
 * setting has no information. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "effect/table_effects.h"
#include "table_loop/grid.h"
#include "table_loop/response_scale.h"
#include "table_loop/run.h"

/* Normal quantiles of a power of 80 %, and of the surplus test of an alias (p = 0.002). */
static const double power_80 = 0.8416, surplus = 3.09;

/* Whole model: the declared one with its parameters, and all effects found. */
typedef struct whole_model {
  fg_loop_claim member[FG_LOOP_CLAIMS + 1];
  size_t members;
  double *parameter, *parameter_u; /* one block */
} whole_model;

/* The set with a candidate in the place of its member m. */
static fg_status fit_whole(fg_context *ctx, const fg_engine_run *run, size_t m,
                           const fg_loop_candidate *candidate, const double *shape,
                           whole_model *whole) {
  const fg_loop_problem *problem = run->problem;
  fg_engine_set set = run->set;
  *whole = (whole_model){.members = set.count};
  set.candidate[m] = *candidate;
  memcpy(set.shape[m], shape, sizeof set.shape[m]);
  FG_TRY(fg_engine_refine(ctx, problem, run->train, run->noise, &set));
  FG_TRY(fg_memory_allocate(ctx, problem->parameters + 1, 2 * sizeof *whole->parameter,
                            (void **)&whole->parameter));
  whole->parameter_u = whole->parameter + problem->parameters;
  return fg_engine_fit_claims(ctx, problem, NULL, &set, run->noise, whole->member, whole->parameter,
                              whole->parameter_u);
}

/* Axes of the grid: coordinates of both, each at feasible values. These are every level of words;
 * the measured values where they are few or an effect gives each its own level; else the measured
 * values nearest to seven equal steps. More runs come at the end of an order. */
enum { AXES = 4, STEPS = 7 };

/* At either setting a user makes so many more runs, or half as many as the table has. */
enum { RUNS_MAX = 50 };

static bool is_order(const fg_loop_coordinate *at) {
  return at->roles & FG_LOOP_ORDER;
}

typedef struct setting_axes {
  size_t coordinate[AXES], steps[AXES], count;
  double value[AXES][FG_LOOP_COLUMNS + 1];
} setting_axes;

static double nearest_measured(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                               double value) {
  double best = at->value[0];
  for (size_t i = 1; i < problem->rows; i++)
    if (fabs(at->value[i] - value) < fabs(best - value)) best = at->value[i];
  return best;
}

static void add_axis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                     size_t coordinate, setting_axes *axes) {
  const fg_loop_coordinate *at = &problem->coordinate[coordinate];
  size_t max = candidate->effect->own_levels ? FG_LOOP_COLUMNS + 1 : STEPS;
  bool measured = at->distinct <= max, last = is_order(at);
  size_t k = 0;
  while (k < axes->count && axes->coordinate[k] != coordinate)
    k++;
  if (k < axes->count && (!measured || last)) return;
  if (k == axes->count) axes->count++;
  axes->coordinate[k] = coordinate;
  axes->steps[k] = last ? 1 : at->levels ? at->levels : measured ? at->distinct : STEPS;
  for (size_t i = 0; i < axes->steps[k]; i++) {
    double step = at->low + (at->high - at->low) * (double)i / (STEPS - 1);
    axes->value[k][i] = last         ? at->high
                        : at->levels ? (double)i
                        : measured   ? at->few[i]
                                     : nearest_measured(problem, at, step);
  }
}

static void list_axes(const fg_loop_problem *problem, const fg_loop_candidate *winner,
                      const fg_loop_candidate *rival, setting_axes *axes) {
  *axes = (setting_axes){0};
  add_axis(problem, winner, winner->a, axes);
  add_axis(problem, winner, winner->b, axes);
  add_axis(problem, rival, rival->a, axes);
  add_axis(problem, rival, rival->b, axes);
}

static double axis_value(const setting_axes *axes, size_t axis, size_t setting) {
  for (size_t k = 0; k < axis; k++)
    setting /= axes->steps[k];
  return axes->value[axis][setting % axes->steps[axis]];
}

/* Holds other coordinates of the models at their middle. */
static fg_status hold_coordinate(fg_context *ctx, const setting_axes *axes, size_t coordinate,
                                 fg_loop_problem *grid) {
  const fg_loop_coordinate *at = &grid->coordinate[coordinate];
  double *value = NULL;
  for (size_t k = 0; k < axes->count; k++)
    if (axes->coordinate[k] == coordinate) return FG_OK;
  FG_TRY(fg_engine_grid_axis(ctx, grid, coordinate, &value));
  for (size_t i = 0; i < grid->rows; i++)
    value[i] = at->levels ? 0 : (at->low + at->high) / 2;
  return FG_OK;
}

/* Every combination of the axes' steps. */
static fg_status open_settings(fg_context *ctx, const fg_engine_run *run, const setting_axes *axes,
                               fg_loop_problem *grid) {
  const fg_loop_problem *problem = run->problem;
  size_t rows = 1;
  double *value = NULL;
  for (size_t k = 0; k < axes->count; k++)
    rows *= axes->steps[k];
  FG_TRY(fg_engine_grid_open(ctx, problem, rows, grid));
  for (size_t k = 0; k < axes->count; k++) {
    FG_TRY(fg_engine_grid_axis(ctx, grid, axes->coordinate[k], &value));
    for (size_t i = 0; i < rows; i++)
      value[i] = axis_value(axes, k, i);
  }
  for (size_t c = 0; c < problem->coordinates; c++)
    if (problem->coordinate[c].roles & FG_LOOP_DECLARED)
      FG_TRY(hold_coordinate(ctx, axes, c, grid));
  for (size_t m = 0; m < run->set.count; m++) {
    if (fg_engine_is_outlier(&run->set.candidate[m])) continue;
    FG_TRY(hold_coordinate(ctx, axes, run->set.candidate[m].a, grid));
    FG_TRY(hold_coordinate(ctx, axes, run->set.candidate[m].b, grid));
  }
  return FG_OK;
}

/* value += sign × prediction of the whole model at the rows of a grid. Effects of single rows do
 * not apply. */
static fg_status add_prediction(fg_context *ctx, const fg_engine_run *run, const whole_model *whole,
                                const fg_loop_problem *grid, double sign, double *value) {
  size_t rows = grid->rows, parameters = run->problem->parameters;
  const int *column = run->units->column;
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, rows, (parameters + 1) * sizeof *work, (void **)&work));
  if (grid->declared) {
    FG_TRY_EXIT(grid->declared(ctx, grid->declared_model, grid, work));
    for (size_t k = 0; k < parameters; k++)
      for (size_t i = 0; i < rows; i++)
        value[i] += sign * whole->parameter[k] * ldexp(work[k * rows + i], -column[k]);
  }
  for (size_t m = 0; m < whole->members; m++) {
    if (fg_engine_is_outlier(&whole->member[m].candidate)) continue;
    FG_TRY_EXIT(fg_loop_claim_evaluate(ctx, grid, &whole->member[m], work));
    for (size_t i = 0; i < rows; i++)
      value[i] += sign * work[i];
  }
exit:
  free(work);
  return status;
}

/* The settings where winner less rival is largest and smallest, and how far these are apart. */
static fg_status best_settings(fg_context *ctx, const fg_engine_run *run, const setting_axes *axes,
                               const whole_model *winner, const whole_model *rival, size_t best[2],
                               double *apart) {
  fg_loop_problem grid = {0};
  double *difference = NULL, highest = -INFINITY, lowest = INFINITY;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_settings(ctx, run, axes, &grid));
  FG_TRY_EXIT(fg_memory_allocate(ctx, grid.rows, sizeof *difference, (void **)&difference));
  FG_TRY_EXIT(add_prediction(ctx, run, winner, &grid, 1, difference));
  FG_TRY_EXIT(add_prediction(ctx, run, rival, &grid, -1, difference));
  for (size_t i = 0; i < grid.rows; i++) {
    if (!isfinite(difference[i])) continue;
    if (difference[i] > highest) highest = difference[i], best[0] = i;
    if (difference[i] < lowest) lowest = difference[i], best[1] = i;
  }
  *apart = highest > lowest ? highest - lowest : 0;
exit:
  free(difference);
  fg_engine_grid_close(&grid);
  return status;
}

static void describe_setting(const fg_loop_problem *problem, const setting_axes *axes,
                             size_t setting, char *text, size_t size) {
  *text = 0;
  for (size_t k = 0; k < axes->count; k++) {
    const fg_loop_coordinate *at = &problem->coordinate[axes->coordinate[k]];
    double value = axis_value(axes, k, setting);
    size_t used = strlen(text);
    const char *with = used ? " with " : "";
    if (is_order(at)) continue;
    if (at->levels)
      fg_text_clip(text + used, size - used, "%s%s = %s", with, at->name,
                   at->level_name[(size_t)value]);
    else
      fg_text_clip(text + used, size - used, "%s%s = %.4g", with, at->name, value);
  }
}

/* A claim and its nearest rival in words. */
typedef struct pair_words {
  char claim[4 * FG_LOOP_NAME], rival[8 * FG_LOOP_NAME];
} pair_words;

static void say_pair(const fg_loop_problem *problem, const fg_loop_claim *claim, const char *and,
                     pair_words *words) {
  const fg_loop_alias *nearest = &claim->alias[0];
  fg_loop_effect_words(problem, &claim->candidate, words->claim, sizeof words->claim);
  fg_loop_effect_words(problem, &nearest->candidate, words->rival, sizeof words->rival);
  if (!nearest->sum) return;
  size_t used = strlen(words->rival);
  fg_text_clip(words->rival + used, sizeof words->rival - used, "%s", and);
  used = strlen(words->rival);
  fg_loop_effect_words(problem, &nearest->second, words->rival + used, sizeof words->rival - used);
}

static void say_repeats(const fg_loop_problem *problem, const fg_loop_claim *claim,
                        fg_loop_advice *advice) {
  bool outlier = fg_engine_is_outlier(&claim->candidate),
       rival = fg_engine_is_outlier(&claim->alias[0].candidate);
  pair_words words;
  say_pair(problem, claim, " together with ", &words);
  fg_text_clip(advice->text, sizeof advice->text,
               "Repeat the rows that are named: a repeat tells a wrong or exchanged response from "
               "%s.",
               outlier && rival ? "a right one"
               : outlier        ? words.rival
                                : words.claim);
  advice->runs = 2;
}

/* Advises to repeat the settings of the first runs at the end: a lasting effect changes them,
 * correlation of neighbours does not. */
static void advise_order(const fg_loop_problem *problem, const fg_loop_claim *claim,
                         fg_loop_advice *advice) {
  enum { REPEATS = 4 };
  pair_words words;
  say_pair(problem, claim, " together with ", &words);
  fg_text_clip(advice->text, sizeof advice->text,
               "Repeat the settings of %d of the first rows at the end, some time apart: %s and %s "
               "part there.",
               REPEATS, words.claim, words.rival);
  advice->runs = REPEATS;
}

static void say_sum(const fg_loop_problem *problem, const fg_loop_claim *claim,
                    fg_loop_advice *advice) {
  pair_words words;
  say_pair(problem, claim, " and ", &words);
  fg_text_clip(advice->text, sizeof advice->text,
               "Measure rows in which %s do not go together as they do here: that parts them from "
               "%s.",
               words.rival, words.claim);
  advice->runs = NAN;
}

/* Two columns that the scatter may follow. */
static void say_spread(const fg_loop_problem *problem, const fg_loop_claim *claim,
                       fg_loop_advice *advice) {
  pair_words words;
  say_pair(problem, claim, " together with ", &words);
  fg_text_clip(advice->text, sizeof advice->text,
               "Measure several rows at each of some settings at which the two do not go together "
               "as they do here: that parts %s from %s.",
               words.claim, words.rival);
  advice->runs = NAN;
}

static bool over_order(const fg_loop_problem *problem, const setting_axes *axes) {
  for (size_t k = 0; k < axes->count; k++)
    if (is_order(&problem->coordinate[axes->coordinate[k]])) return true;
  return false;
}

static bool can_be_set(const fg_loop_problem *problem, const setting_axes *axes) {
  for (size_t k = 0; k < axes->count; k++)
    if (!is_order(&problem->coordinate[axes->coordinate[k]])) return true;
  return false;
}

/* n rows at either setting: their means differ by `apart` with a variance of 2 sd² / n. */
static void say_settings(const fg_engine_run *run, const fg_loop_claim *claim,
                         const setting_axes *axes, const size_t best[2], double apart,
                         fg_loop_advice *advice) {
  double max = fmax(RUNS_MAX, (double)run->problem->rows / 2);
  double needed = apart > 0 ? ceil(2 * pow((surplus + power_80) * run->sd / apart, 2)) : INFINITY;
  char first[400], second[400];
  pair_words words;
  say_pair(run->problem, claim, " together with ", &words);
  describe_setting(run->problem, axes, best[0], first, sizeof first);
  describe_setting(run->problem, axes, best[1], second, sizeof second);
  advice->runs = needed <= max ? fmax(needed, 2) : NAN;
  if (advice->runs > 0)
    fg_text_clip(advice->text, sizeof advice->text,
                 "%s%.0f %s at %s and as many at %s part %s from %s (from one to the other these "
                 "differ by %.3g; power 80 %%).",
                 over_order(run->problem, axes) ? "At the end, " : "", advice->runs,
                 run->problem->group_level ? "more rows" : "more runs", first, second, words.claim,
                 words.rival, ldexp(apart, run->units->response));
  else
    fg_text_clip(advice->text, sizeof advice->text,
                 "No number of runs that one would make parts %s from %s inside the measured range "
                 "(at most they differ by %.2g times the scatter of a row): measure outside it.",
                 words.claim, words.rival, run->sd > 0 ? apart / run->sd : 0);
}

static fg_status advise_settings(fg_context *ctx, const fg_engine_run *run, size_t m,
                                 const fg_loop_candidate *rival, fg_loop_advice *advice) {
  const fg_loop_problem *problem = run->problem;
  const fg_loop_candidate *winner = &run->set.candidate[m];
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES] = {0}, apart = 0;
  whole_model with = {0}, other = {0};
  size_t best[2] = {0};
  setting_axes axes;
  fg_status status = FG_OK;
  size_t count = rival->effect->starts ? rival->effect->starts(problem, rival, starts) : 1;
  FG_TRY_EXIT(fit_whole(ctx, run, m, winner, run->set.shape[m], &with));
  FG_TRY_EXIT(fit_whole(ctx, run, m, rival, starts[count / 2], &other));
  list_axes(problem, winner, rival, &axes);
  FG_TRY_EXIT(best_settings(ctx, run, &axes, &with, &other, best, &apart));
  if (can_be_set(problem, &axes))
    say_settings(run, &run->result->claim[m], &axes, best, apart, advice);
  else
    advise_order(problem, &run->result->claim[m], advice);
exit:
  free(with.parameter);
  free(other.parameter);
  return status;
}

static void say_scale(const fg_engine_run *run, fg_loop_advice *advice) {
  char name[FG_LOOP_NAME];
  fg_loop_scale_name(run->result->scale.chosen, "the response", name, sizeof name);
  fg_text_clip(advice->text, sizeof advice->text,
               "Declare the model for %s, given as a column, and run again: on that scale this "
               "does not show. Rows at settings with more extreme responses part both.",
               name);
  advice->runs = NAN;
}

static void say_levels(const fg_loop_problem *problem, const fg_loop_claim *claim,
                       fg_loop_advice *advice) {
  const char *levels = problem->coordinate[claim->candidate.a].name;
  fg_text_clip(advice->text, sizeof advice->text,
               "Rows of one level of %s under different settings of the others, and of different "
               "levels under the same, part them.",
               levels);
  advice->runs = NAN;
}

static fg_status advise_one(fg_context *ctx, const fg_engine_run *run, size_t m,
                            fg_loop_advice *advice) {
  const fg_loop_claim *claim = &run->result->claim[m];
  const fg_loop_alias *nearest = &claim->alias[0];
  if (nearest->candidate.effect == fg_loop_scale_effect())
    say_scale(run, advice);
  else if (fg_engine_is_outlier(&claim->candidate) ||
           (!nearest->sum && fg_engine_is_outlier(&nearest->candidate)))
    say_repeats(run->problem, claim, advice);
  else if (claim->candidate.effect->scatter == FG_LOOP_SPREAD)
    say_spread(run->problem, claim, advice);
  else if (fg_engine_is_levels(&claim->candidate))
    say_levels(run->problem, claim, advice);
  else if (fg_engine_is_noise(&claim->candidate) || fg_engine_is_noise(&nearest->candidate))
    advise_order(run->problem, claim, advice);
  else if (nearest->sum)
    say_sum(run->problem, claim, advice);
  else
    return advise_settings(ctx, run, m, &nearest->candidate, advice);
  return FG_OK;
}

fg_status fg_engine_advise(fg_context *ctx, fg_engine_run *run) {
  fg_loop_result *result = run->result;
  /* Points are not had by repeating rows: their advice is another scan. */
  if (!strcmp(run->problem->level, "points")) return FG_OK;
  for (size_t m = 0; m < result->claims; m++)
    if (result->claim[m].aliases)
      FG_TRY(advise_one(ctx, run, m, &result->advice[result->advices++]));
  return FG_OK;
}
