/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings in words: the foils that a cause moves, by how much, its ties, foils that would tell. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/file.h"
#include "core/text.h"
#include "foilgauge/report.h"
#include "page/page.h"
#include "station/cause.h"

/* SINCE_SHARE: a level began at its first foil when no more of the foils behind it than this have
 * another level. */
#define SINCE_SHARE 0.05
/* SAME_SHARE: two levels have the same foils when so large a share of both has both. */
#define SAME_SHARE 0.95
/* SAME_DAYS: a step lies between two days of work, with a weekend between them at most. */
#define SAME_DAYS 3.0
#define WEEK      7.0
enum { TIES_SHOWN = 4 };

/* Foils of a level: their number, the first and the last. */
typedef struct level_use {
  size_t foils, first, last;
  size_t lots, last_lot;
} level_use;

static level_use find_use(const fg_cause_data *data, const fg_cause_column *column, size_t level) {
  level_use use = {.first = SIZE_MAX, .last_lot = SIZE_MAX};
  for (size_t i = 0; i < data->foils; i++) {
    if (column->level[i] != level) continue;
    if (use.first == SIZE_MAX) use.first = i;
    use.last = i;
    use.foils++;
    use.lots += data->lot[i] != use.last_lot;
    use.last_lot = data->lot[i];
  }
  return use;
}

static bool began(const fg_cause_data *data, const level_use *use) {
  size_t behind = data->foils - use->first;
  return use->first > 0 && (double)(behind - use->foils) <= SINCE_SHARE * (double)behind;
}

static double mean_of_others(const fg_cause *cause, const level_use *uses, size_t level) {
  double sum = 0, count = 0;
  for (size_t k = 0; k < cause->points; k++) {
    if (k == level) continue;
    sum += cause->point[k].shift * (double)uses[k].foils;
    count += (double)uses[k].foils;
  }
  return count > 0 ? sum / count : 0;
}

/* Index of a column's level by the word of a point. */
static size_t find_word(const fg_cause_column *column, const char *level) {
  for (size_t k = 0; k < column->levels; k++)
    if (!strcmp(column->level_name[k], level) ||
        (!column->level_name[k][0] && !strcmp(level, "(not given)")))
      return k;
  return 0;
}

/* The level that stands apart: of two the later one, of more that farthest from the others. */
static size_t choose_level(const fg_cause *cause, const level_use *uses) {
  size_t chosen = 0;
  double farthest = -1;
  if (cause->points == 2) return uses[1].first > uses[0].first;
  for (size_t k = 0; k < cause->points; k++) {
    double apart = fabs(cause->point[k].shift - mean_of_others(cause, uses, k));
    if (apart > farthest) chosen = k, farthest = apart;
  }
  return chosen;
}

/* Writes the day; of foils that were all measured on one day the time, as "2026-03-01 14:02". */
static void write_time(const fg_cause_data *data, double days, char text[FG_DATE_TEXT]) {
  bool one_day = data->foils && floor(fg_cause_days(data->at[0])) ==
                                    floor(fg_cause_days(data->at[data->foils - 1]));
  fg_date_format(one_day ? days : floor(days), text);
  char *clock = strchr(text, 'T');
  if (clock) *clock = ' ';
}

/* A level of another column that (nearly) the same foils have; SIZE_MAX: none. */
static size_t find_same_foils(const fg_cause_data *data, const fg_cause_column *column,
                              size_t level, const fg_cause_column *other) {
  size_t both[FG_LOOP_COLUMNS + 1] = {0}, all[FG_LOOP_COLUMNS + 1] = {0}, foils = 0;
  for (size_t i = 0; i < data->foils; i++) {
    bool in = column->level[i] == level;
    foils += in;
    all[other->level[i]]++;
    both[other->level[i]] += in;
  }
  for (size_t m = 0; m < other->levels; m++) {
    double joined = (double)(foils + all[m] - both[m]);
    if ((double)both[m] >= SAME_SHARE * joined) return m;
  }
  return SIZE_MAX;
}

/* Adds columns that changed with this one; the loop prefers the simplest of them. Returns the
 * first, or the one that the loop had. */
static const char *add_same_foils(const fg_cause_data *data, const fg_cause_column *column,
                                  size_t level, const char *tied, fg_cause *cause) {
  for (size_t c = 0; c < data->columns; c++) {
    const fg_cause_column *other = &data->column[c];
    if (other == column || !other->words || other->levels > FG_LOOP_COLUMNS) continue;
    if (tied && !strcmp(tied, other->name)) continue;
    size_t same = find_same_foils(data, column, level, other), length = strlen(cause->ties);
    if (same == SIZE_MAX) continue;
    fg_text_clip(cause->ties + length, FG_CAUSE_WORDS - length, "%s%s %s on the same foils",
                 length ? ", " : "", other->name, other->level_name[same]);
    if (!tied) tied = other->name;
  }
  return tied;
}

/* The level of the foils before its first one, or the one with most foils. */
static const char *find_level_before(const fg_cause_data *data, const fg_cause_column *column,
                                     const level_use *use) {
  size_t i = use->first > 0 && use->first < data->foils ? use->first - 1 : 0;
  while (i < data->foils && column->level[i] == column->level[use->first])
    i++;
  return i < data->foils ? column->level_name[column->level[i]] : "";
}

static void describe_levels(const fg_cause_data *data, bool by_lots, const char *tied_column,
                            fg_cause *cause) {
  level_use uses[FG_LOOP_COLUMNS + 1] = {{0}};
  const fg_cause_column *column = fg_cause_column_find(data, cause->name);
  char day[FG_DATE_TEXT];
  if (!column) return;
  for (size_t k = 0; k < cause->points && k <= FG_LOOP_COLUMNS; k++)
    uses[k] = find_use(data, column, find_word(column, cause->point[k].level));
  size_t level = choose_level(cause, uses);
  const char *word = cause->point[level].level, *before;
  const level_use *use = &uses[level];
  cause->value = cause->point[level].shift - mean_of_others(cause, uses, level);
  cause->since = began(data, use) ? data->at[use->first] : 0;
  write_time(data, fg_cause_days(data->at[use->first]), day);
  if (cause->since)
    fg_text_clip(cause->words_of, FG_CAUSE_WORDS, "since %s %s (%s)", cause->name, word, day);
  else
    fg_text_clip(cause->words_of, FG_CAUSE_WORDS, "with %s %s", cause->name, word);
  before = find_level_before(data, column, use);
  tied_column = add_same_foils(data, column, find_word(column, word), tied_column, cause);
  const fg_cause_column *other = tied_column ? fg_cause_column_find(data, tied_column) : NULL;
  bool one_lot = by_lots && use->lots == 1;
  if (one_lot) {
    size_t length = strlen(cause->ties);
    fg_text_clip(cause->ties + length, FG_CAUSE_WORDS - length,
                 "%sits lot, as all its foils are of one", length ? ", " : "");
  }
  if (other && other->words && use->first < data->foils)
    fg_text_clip(cause->tells, FG_CAUSE_WORDS, "a foil of %s %s with %s %s", cause->name, before,
                 other->name, other->level_name[other->level[use->first]]);
  else if (cause->ties[0])
    fg_text_clip(cause->tells, FG_CAUSE_WORDS, "foils of %s %s made now%s%s%s", cause->name, before,
                 one_lot ? ", or another lot of " : "", one_lot ? cause->name : "",
                 one_lot ? " " : "");
  if (one_lot && !other) {
    size_t length = strlen(cause->tells);
    fg_text_clip(cause->tells + length, FG_CAUSE_WORDS - length, "%s", word);
  }
}

/* First foil at or behind a place over time. */
static int64_t find_time(const fg_cause_data *data, double days) {
  for (size_t i = 0; i < data->foils; i++)
    if (fg_cause_days(data->at[i]) >= days) return data->at[i];
  return 0;
}

static void write_place(const fg_cause_data *data, const char *column, double x,
                        char text[FG_DATE_TEXT]) {
  if (!strcmp(column, FG_CAUSE_TIME))
    write_time(data, x, text);
  else
    snprintf(text, FG_DATE_TEXT, "%.4g", x);
}

/* Share of the foils with a level in the days before a place (days < 0), or behind it. */
static double share_near(const fg_cause_data *data, const fg_cause_column *column, size_t level,
                         double place, double days) {
  size_t foils = 0, of_level = 0;
  for (size_t i = 0; i < data->foils; i++) {
    double apart = fg_cause_days(data->at[i]) - place;
    if (days < 0 ? apart < days || apart >= 0 : apart < 0 || apart > days) continue;
    foils++;
    of_level += column->level[i] == level;
  }
  return foils ? (double)of_level / (double)foils : NAN;
}

/* First foil near a place with which a column changes for good; 0: none. */
static size_t find_change(const fg_cause_data *data, const fg_cause_column *column, double place,
                          double reach) {
  for (size_t i = 1; i < data->foils; i++) {
    double days = fg_cause_days(data->at[i]);
    size_t level = column->level[i];
    if (level == column->level[i - 1] || fabs(days - place) > reach) continue;
    if (share_near(data, column, level, days, WEEK) >= SAME_SHARE &&
        share_near(data, column, level, days, -WEEK) <= 1 - SAME_SHARE)
      return i;
  }
  return 0;
}

/* A step over time where a recorded column changes is tied with that change: the loop prefers the
 * step, which needs one number. */
static void tie_changes(const fg_cause_data *data, const fg_loop_claim *claim, fg_cause *cause) {
  double reach = SAME_DAYS + (isfinite(claim->shape_u[0]) ? 2 * claim->shape_u[0] : 0);
  for (size_t c = 0; c < data->columns; c++) {
    const fg_cause_column *column = &data->column[c];
    if (!column->words || column->within_days) continue;
    size_t i = find_change(data, column, claim->shape[0], reach), length = strlen(cause->ties);
    if (!i) continue;
    char day[FG_DATE_TEXT];
    write_time(data, fg_cause_days(data->at[i]), day);
    fg_text_clip(cause->ties + length, FG_CAUSE_WORDS - length, "%s%s %s since %s",
                 length ? ", " : "", column->name, column->level_name[column->level[i]], day);
    fg_text_clip(cause->tells, FG_CAUSE_WORDS, "foils of %s %s made now", column->name,
                 column->level_name[column->level[i - 1]]);
  }
}

static void describe_curve(const fg_cause_data *data, const fg_loop_claim *claim, fg_cause *cause) {
  char from[FG_DATE_TEXT], to[FG_DATE_TEXT];
  const fg_cause_point *first = &cause->point[0], *last = &cause->point[cause->points - 1];
  bool over_time = !strcmp(cause->name, FG_CAUSE_TIME);
  cause->value = last->shift - first->shift;
  if (claim->candidate.effect->reads == FG_LOOP_READS_STEP) {
    write_place(data, cause->name, claim->shape[0], from);
    cause->since = over_time ? find_time(data, claim->shape[0]) : 0;
    if (over_time) tie_changes(data, claim, cause);
    if (over_time)
      fg_text_clip(cause->words_of, FG_CAUSE_WORDS, "since %s", from);
    else
      fg_text_clip(cause->words_of, FG_CAUSE_WORDS, "with %s above %s", cause->name, from);
  } else {
    const fg_cause_point *low = first, *high = first;
    for (size_t k = 1; k < cause->points; k++) {
      if (cause->point[k].shift < low->shift) low = &cause->point[k];
      if (cause->point[k].shift > high->shift) high = &cause->point[k];
    }
    bool rises = high->x > low->x;
    cause->value = (rises ? 1 : -1) * (high->shift - low->shift);
    write_place(data, cause->name, rises ? low->x : high->x, from);
    write_place(data, cause->name, rises ? high->x : low->x, to);
    fg_text_clip(cause->words_of, FG_CAUSE_WORDS, "%s%s%sfrom %s to %s", over_time ? "" : "with ",
                 over_time ? "" : cause->name, over_time ? "" : " ", from, to);
  }
  if (cause->tells[0]) return;
  if (cause->ties[0] && over_time)
    fg_text_clip(cause->tells, FG_CAUSE_WORDS, "a column of what changed then (--context)");
  else if (cause->ties[0])
    fg_text_clip(cause->tells, FG_CAUSE_WORDS, "foils at another %s on one day", cause->name);
}

/* Lists the ties, and finds the first column of words among them. */
static const char *list_ties(const fg_loop_problem *problem, const fg_loop_claim *claim,
                             fg_cause *cause) {
  const char *column = NULL;
  char words[2 * FG_LOOP_NAME];
  for (size_t k = 0; k < claim->aliases; k++) {
    const fg_loop_alias *alias = &claim->alias[k];
    const fg_loop_coordinate *at = &problem->coordinate[alias->candidate.a];
    size_t length = strlen(cause->ties);
    if (alias->sum || k >= TIES_SHOWN) continue;
    fg_loop_effect_words(problem, &alias->candidate, words, sizeof words);
    if (!column && at->levels) column = at->name;
    fg_text_clip(cause->ties + length, FG_CAUSE_WORDS - length, "%s%s", length ? ", " : "", words);
  }
  return column;
}

void fg_cause_describe(const fg_cause_data *data, const fg_loop_problem *problem,
                       const fg_loop_claim *claim, bool by_lots, fg_cause *cause) {
  const char *tied = list_ties(problem, claim, cause);
  if (cause->words)
    describe_levels(data, by_lots, tied, cause);
  else
    describe_curve(data, claim, cause);
}

static void write_signed(FILE *out, double value, const char *format, const char *unit) {
  fputs(value < 0 ? "−" : "+", out);
  fprintf(out, format, fabs(value));
  if (unit[0]) fprintf(out, " %s", unit);
}

void fg_cause_write_text(FILE *out, const fg_cause *cause, const fg_quantity *row, double mean) {
  double U = FG_COVERAGE_FACTOR * cause->u, percent = 100 / fabs(mean);
  fprintf(out, "%s: %s ", cause->words_of, row->words);
  if (mean != 0) {
    write_signed(out, percent * cause->value, "%.2f", "%");
    fputs(" (", out);
  }
  write_signed(out, cause->value, "%.3g", row->unit);
  if (mean != 0)
    fprintf(out, "), U %.2f %%", percent * U);
  else
    fprintf(out, ", U %.2g", U);
  if (cause->ties[0]) fprintf(out, "; tied with %s", cause->ties);
  if (cause->tells[0]) fprintf(out, "; %s would tell", cause->tells);
}

void fg_cause_write(FILE *out, const fg_cause *cause, const fg_quantity *row, double mean) {
  char *text = NULL;
  size_t size;
  FILE *words = fg_stream_open(&text, &size);
  if (!words) return;
  fg_cause_write_text(words, cause, row, mean);
  fg_html_text(out, fg_stream_keep(words, &text) ? text : "");
  free(text);
}
