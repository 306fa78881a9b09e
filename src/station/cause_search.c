/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on tables over the foils of a database.
 *
 * Foils of a day share what the day has, foils of a lot what the lot has: as single rows they would
 * make chance look like a cause. So columns that vary within days are sought first, in rows that
 * are means of foils alike in all columns within two hours, with a random level per day. Findings
 * are taken out; then all other columns are sought in means of days, with a random level per lot. A
 * short record (fewer than DAYS_MIN days) is sought foil by foil, with a level per day. Each of the
 * two searches has half of the error rate. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "effect/table_effects.h"
#include "station/cause_rows.h"

enum { DAYS_MIN = 20, GROUPS_MIN = 4, FOILS_MIN = 12 };
/* A claim without a cause in one of 200 searches: half of FG_LOOP_ACCEPT_P for each of the two. */
#define ACCEPT_P (FG_LOOP_ACCEPT_P / 2)

/* Of a shop's columns only time has cycles. */
static bool accepts_cycle_of_time(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_effect *row = fg_loop_table_effects();
  while (row->id && !(row->cycle && !row->held))
    row++;
  return row->id && !strcmp(problem->coordinate[a].name, FG_CAUSE_TIME) &&
         row->accepts(problem, a, b);
}

/* Effects of one column of a table. Interactions of two are left to the command `loop`. */
static void find_shop_effects(fg_loop_effect effects[FG_CAUSE_EFFECTS]) {
  size_t count = 0;
  for (const fg_loop_effect *row = fg_loop_table_effects(); row->id; row++) {
    if (row->pair || row->held || strncmp(row->id, "table.", 6) != 0) continue;
    if (count + 1 == FG_CAUSE_EFFECTS) break;
    effects[count] = *row;
    if (row->cycle) effects[count].accepts = accepts_cycle_of_time;
    count++;
  }
  effects[count] = (fg_loop_effect){.id = NULL};
}

/* Groups are levels, no candidate: what changes with their number is sought over time. */
static void drop_group_coordinate(fg_loop_problem *problem) {
  for (size_t c = 0; c < problem->coordinates; c++) {
    if (strcmp(problem->coordinate[c].name, FG_CAUSE_GROUP) != 0) continue;
    free(problem->coordinate[c].value);
    for (size_t k = 0; k < problem->coordinate[c].levels; k++)
      free(problem->coordinate[c].level_name[k]);
    free(problem->coordinate[c].level_name);
    problem->coordinate[c] = problem->coordinate[--problem->coordinates];
    return;
  }
}

static fg_status run_loop(fg_context *ctx, const fg_table *table, fg_cause_pass *pass,
                          fg_loop_table_problem *problem, fg_loop_result *result) {
  const fg_loop_table_spec spec = {.response = FG_CAUSE_VALUE,
                                   .model = "1",
                                   .group = pass->group ? FG_CAUSE_GROUP : NULL,
                                   .order = FG_CAUSE_TIME,
                                   .seed = 1};
  const fg_loop_options options = {
      .effects = pass->effects, .seed = 1, .accept_p = ACCEPT_P, .search_once = true};
  find_shop_effects(pass->effects);
  FG_TRY(fg_loop_table_problem_build(ctx, table, &spec, problem));
  drop_group_coordinate(&problem->problem);
  fg_status status = fg_loop_run(ctx, &problem->problem, &options, result);
  if (status != FG_OK) fg_loop_table_problem_free(problem);
  return status;
}

/* ---- findings ---- */

double fg_cause_shift(const fg_cause *cause, const fg_cause_column *column, size_t foil) {
  const fg_cause_point *point = cause->point;
  if (!column || column->words != cause->words || !cause->points) return 0;
  if (cause->words) {
    const char *level = column->level_name[column->level[foil]];
    if (!level[0]) level = "(not given)";
    for (size_t k = 0; k < cause->points; k++)
      if (!strcmp(point[k].level, level)) return point[k].shift;
    return 0;
  }
  double x = column->number[foil];
  if (isnan(x)) return 0;
  if (x <= point[0].x) return point[0].shift;
  for (size_t k = 1; k < cause->points; k++)
    if (x <= point[k].x) {
      double width = point[k].x - point[k - 1].x;
      double share = width > 0 ? (x - point[k - 1].x) / width : 1;
      return point[k - 1].shift + share * (point[k].shift - point[k - 1].shift);
    }
  return point[cause->points - 1].shift;
}

static fg_status find_level_shifts(fg_context *ctx, const fg_loop_problem *problem,
                                   const fg_loop_claim *claim, fg_cause *cause) {
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  double *effect;
  cause->words = true;
  cause->points = at->levels;
  FG_TRY(fg_memory_allocate(ctx, at->levels, sizeof *cause->point, (void **)&cause->point));
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *effect, (void **)&effect));
  fg_status status = fg_loop_claim_evaluate(ctx, problem, claim, effect);
  for (size_t i = 0; status == FG_OK && i < problem->rows; i++)
    cause->point[(size_t)at->value[i]].shift = effect[i];
  for (size_t k = 0; k < at->levels; k++)
    fg_text_clip(cause->point[k].level, sizeof cause->point[k].level, "%s", at->level_name[k]);
  free(effect);
  return status;
}

/* The curve at FAR of the rows' places, evenly chosen of the sorted ones: a step stays between two
 * neighbours. */
static fg_status find_curve_shifts(fg_context *ctx, const fg_loop_problem *problem,
                                   const fg_loop_claim *claim, fg_cause *cause) {
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  double *place = NULL, effect[FG_CAUSE_POINTS], chosen[FG_CAUSE_POINTS];
  size_t count = problem->rows < FG_CAUSE_POINTS ? problem->rows : FG_CAUSE_POINTS;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->rows, sizeof *place, (void **)&place));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *cause->point, (void **)&cause->point));
  memcpy(place, at->value, problem->rows * sizeof *place);
  fg_sort(place, problem->rows);
  for (size_t k = 0; k < count; k++)
    chosen[k] = place[count > 1 ? k * (problem->rows - 1) / (count - 1) : 0];
  FG_TRY_EXIT(fg_loop_claim_curve(ctx, problem, claim, chosen, count, effect));
  for (size_t k = 0; k < count; k++)
    cause->point[k] = (fg_cause_point){.x = chosen[k], .shift = effect[k]};
  cause->points = count;
exit:
  free(place);
  return status;
}

/* Makes the mean shift of all foils 0, and takes the shifts out of the values. */
static void subtract_cause(const fg_cause_data *data, fg_cause *cause, double *value) {
  const fg_cause_column *column = fg_cause_column_find(data, cause->name);
  double mean = 0;
  for (size_t i = 0; i < data->foils; i++)
    mean += fg_cause_shift(cause, column, i) / (double)data->foils;
  for (size_t k = 0; k < cause->points; k++)
    cause->point[k].shift -= mean;
  for (size_t i = 0; i < data->foils; i++)
    value[i] -= fg_cause_shift(cause, column, i);
}

static void add_words(char words[FG_CAUSE_WORDS], const char *more) {
  size_t length = strlen(words);
  fg_text_clip(words + length, FG_CAUSE_WORDS - length, "%s%s", length ? "; " : "", more);
}

/* Single rows and the scatter have no column to accept: they are told. */
static void note_other_claim(const fg_loop_problem *problem, const fg_loop_claim *claim,
                             fg_cause_report *report) {
  char words[2 * FG_LOOP_NAME], line[4 * FG_LOOP_NAME], day[FG_DATE_TEXT];
  fg_loop_effect_words(problem, &claim->candidate, words, sizeof words);
  if (claim->candidate.effect->outlier != FG_LOOP_WRONG_ROW) {
    add_words(report->unexplained, words);
    return;
  }
  const fg_loop_coordinate *when = NULL;
  for (size_t c = 0; c < problem->coordinates; c++)
    if (!strcmp(problem->coordinate[c].name, FG_CAUSE_TIME)) when = &problem->coordinate[c];
  if (!when || !claim->candidate.rows) return;
  fg_date_format(floor(when->value[claim->candidate.row[0]]), day);
  fg_text_clip(line, sizeof line, "%s stands out by %+.3g", day, claim->coefficient[0]);
  add_words(report->unexplained, line);
}

static fg_status add_cause(fg_context *ctx, fg_cause_pass *pass, const fg_loop_problem *problem,
                           const fg_loop_claim *claim, fg_cause_report *report) {
  if (claim->candidate.effect->outlier || claim->candidate.effect->scatter) {
    note_other_claim(problem, claim, report);
    return FG_OK;
  }
  if (report->causes == FG_CAUSES) return FG_OK;
  fg_cause *cause = &report->cause[report->causes];
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  *cause = (fg_cause){.p_value = claim->p_value, .u = 2 * claim->amplitude_u};
  report->causes++;
  fg_text_clip(cause->name, sizeof cause->name, "%s", at->name);
  if (at->levels)
    FG_TRY(find_level_shifts(ctx, problem, claim, cause));
  else
    FG_TRY(find_curve_shifts(ctx, problem, claim, cause));
  subtract_cause(pass->data, cause, pass->value);
  fg_cause_describe(pass->data, problem, claim, pass->group == pass->data->lot, cause);
  return FG_OK;
}

/* Residuals that no column explains are told of days; within days they are not sought. */
static void note_rest(const fg_cause_pass *pass, const fg_loop_table_problem *problem,
                      const fg_loop_result *result, fg_cause_report *report) {
  char line[4 * FG_LOOP_NAME];
  if (pass->between && result->has_curve) {
    const char *over = problem->problem.coordinate[result->curve.coordinate].name;
    fg_text_clip(line, sizeof line, "something over %s that no column here explains (rms %.3g)",
                 over, result->curve.rms);
    add_words(report->unexplained, line);
  }
  for (size_t k = 0; k < result->suspects && k < 1; k++) {
    char words[2 * FG_LOOP_NAME];
    fg_loop_effect_words(&problem->problem, &result->suspect[k].claim.candidate, words,
                         sizeof words);
    fg_text_clip(line, sizeof line, "%s (p = %.2g)", words, result->suspect[k].claim.p_value);
    add_words(report->suspected, line);
  }
}

static fg_status note_result(fg_context *ctx, fg_cause_pass *pass,
                             const fg_loop_table_problem *problem, const fg_loop_result *result,
                             fg_cause_report *report) {
  for (size_t m = 0; m < result->claims; m++)
    FG_TRY(add_cause(ctx, pass, &problem->problem, &result->claim[m], report));
  note_rest(pass, problem, result, report);
  if (pass->between) {
    report->cv_before = result->before.cross_validated_rms;
    report->cv_after = result->after.cross_validated_rms;
  }
  return FG_OK;
}

static fg_status search_pass(fg_context *ctx, fg_cause_pass *pass, fg_cause_report *report) {
  fg_table table = {0};
  fg_loop_table_problem problem = {0};
  fg_loop_result result = {0};
  fg_context inner = {.message = ""};
  fg_status status = fg_cause_table(ctx, pass, &table);
  if (status == FG_OK) {
    status = run_loop(&inner, &table, pass, &problem, &result);
    if (status == FG_ERR_DATA) {
      add_words(report->note, inner.message);
    } else if (status == FG_OK) {
      status = note_result(ctx, pass, &problem, &result, report);
      fg_loop_result_free(&result);
      fg_loop_table_problem_free(&problem);
    } else
      status = fg_fail(ctx, status, "%s", inner.message);
    if (status == FG_ERR_DATA) status = FG_OK;
  }
  fg_table_free(&table);
  return status;
}

/* ---- both searches ---- */

static fg_status search_days(fg_context *ctx, const fg_cause_data *data, double *value,
                             fg_cause_report *report) {
  size_t *day_cell = NULL;
  fg_cause_pass pass = {.data = data, .value = value};
  fg_status status = fg_cause_split_days(ctx, &pass);
  if (status == FG_OK)
    status = fg_memory_allocate(ctx, data->foils, sizeof *day_cell, (void **)&day_cell);
  if (status == FG_OK) {
    memcpy(day_cell, pass.cell, data->foils * sizeof *day_cell);
    size_t days = pass.cells;
    status = fg_cause_split_columns(ctx, &pass, true);
    if (status == FG_OK) status = fg_cause_split_hours(ctx, &pass);
    pass.within = true;
    pass.group = day_cell;
    if (status == FG_OK) status = search_pass(ctx, &pass, report);
    memcpy(pass.cell, day_cell, data->foils * sizeof *day_cell);
    pass.cells = days;
    pass.within = false;
    pass.between = true;
    pass.group = data->lots >= GROUPS_MIN ? data->lot : NULL;
    if (status == FG_OK) status = search_pass(ctx, &pass, report);
  }
  free(day_cell);
  free(pass.cell);
  return status;
}

static fg_status search_foils(fg_context *ctx, const fg_cause_data *data, double *value,
                              fg_cause_report *report) {
  fg_cause_pass pass = {.data = data, .value = value, .within = true, .between = true};
  FG_TRY(fg_memory_allocate(ctx, data->foils, sizeof *pass.cell, (void **)&pass.cell));
  for (size_t i = 0; i < data->foils; i++)
    pass.cell[i] = i;
  pass.cells = data->foils;
  pass.group = data->days >= GROUPS_MIN ? data->day : NULL;
  fg_status status = search_pass(ctx, &pass, report);
  free(pass.cell);
  return status;
}

static double find_sd(const double *value, size_t count, double *mean) {
  double squares = 0;
  *mean = 0;
  for (size_t i = 0; i < count; i++)
    *mean += value[i] / (double)count;
  for (size_t i = 0; i < count; i++)
    squares += (value[i] - *mean) * (value[i] - *mean);
  return count > 1 ? sqrt(squares / (double)(count - 1)) : NAN;
}

static int compare_causes(const void *a, const void *b) {
  double one = fabs(((const fg_cause *)a)->value), other = fabs(((const fg_cause *)b)->value);
  return (one < other) - (one > other);
}

fg_status fg_cause_search(fg_context *ctx, const fg_cause_data *data, const fg_cause *accepted,
                          size_t accepted_count, fg_cause_report *report) {
  double *value, unused, begin = fg_clock_seconds();
  *report = (fg_cause_report){.foils = data->foils,
                              .days = data->days,
                              .lots = data->lots,
                              .cv_before = NAN,
                              .cv_after = NAN};
  if (data->foils < FOILS_MIN)
    return fg_fail(ctx, FG_ERR_DATA, "%zu foils with this quantity: a search for causes needs %d.",
                   data->foils, FOILS_MIN);
  FG_TRY(fg_memory_allocate(ctx, data->foils, sizeof *value, (void **)&value));
  memcpy(value, data->value, data->foils * sizeof *value);
  find_sd(value, data->foils, &report->mean);
  for (size_t k = 0; k < accepted_count; k++) {
    const fg_cause_column *column = fg_cause_column_find(data, accepted[k].name);
    for (size_t i = 0; i < data->foils; i++)
      value[i] -= fg_cause_shift(&accepted[k], column, i);
  }
  report->before = find_sd(value, data->foils, &unused);
  fg_status status = data->days >= DAYS_MIN ? search_days(ctx, data, value, report)
                                            : search_foils(ctx, data, value, report);
  report->after = find_sd(value, data->foils, &unused);
  free(value);
  fg_sort_items(report->cause, report->causes, sizeof *report->cause, compare_causes);
  fg_text_clip(report->note + strlen(report->note), FG_CAUSE_WORDS - strlen(report->note), "%s%s",
               report->note[0] && data->left_out[0] ? "; " : "", data->left_out);
  report->seconds = fg_clock_seconds() - begin;
  if (status != FG_OK) fg_cause_report_free(report);
  return status;
}

void fg_cause_report_free(fg_cause_report *report) {
  for (size_t k = 0; k < report->causes; k++)
    free(report->cause[k].point);
  *report = (fg_cause_report){0};
}
