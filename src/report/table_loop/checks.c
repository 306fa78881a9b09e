/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/checks.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

const char *const fg_loop_finding_kinds[] = {"curve",
                                             "lack_of_fit",
                                             "lack_of_fit_all_columns",
                                             "correlation_beyond_neighbours",
                                             "correlation_at_one_lag",
                                             NULL};

static void append_check_words(char text[FG_LOOP_WORDS], const char *words) {
  size_t used = strlen(text);
  fg_text_clip(text + used, FG_LOOP_WORDS - used, "%s", words);
}

static const fg_loop_coordinate *order_of(const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  for (size_t i = 0; i < problem->coordinates; i++)
    if (problem->coordinate[i].roles & FG_LOOP_BUMP) return &problem->coordinate[i];
  for (size_t i = 0; i < problem->coordinates; i++)
    if (problem->coordinate[i].roles & FG_LOOP_ORDER) return &problem->coordinate[i];
  return NULL;
}

/* Returns true for columns that define a setting: those of the declared model, or all but orders.
 */
static bool is_setting(const fg_loop_coordinate *at, fg_loop_check check) {
  unsigned no = FG_LOOP_ORDER | FG_LOOP_BUMP | FG_LOOP_SENSITIVITY | FG_LOOP_LEVEL;
  if (check == FG_LOOP_CHECK_REPEATS) return at->roles & FG_LOOP_DECLARED;
  return !(at->roles & no);
}

static void settings_of(const fg_loop_report *report, fg_loop_check check,
                        char text[FG_LOOP_WORDS]) {
  const fg_loop_problem *problem = &report->problem->problem;
  *text = 0;
  for (size_t i = 0; i < problem->coordinates; i++) {
    if (!is_setting(&problem->coordinate[i], check)) continue;
    if (*text) append_check_words(text, ", ");
    append_check_words(text, problem->coordinate[i].name);
  }
}

void fg_loop_failed_coordinate(const fg_loop_report *report, char text[FG_LOOP_WORDS]) {
  const fg_loop_coordinate *order = order_of(report);
  fg_loop_check check = report->result->failed;
  if (check < FG_LOOP_CHECK_LAGS)
    settings_of(report, check, text);
  else
    fg_text_clip(text, FG_LOOP_WORDS, "%s", order ? order->name : "row");
}

void fg_loop_check_words(const fg_loop_report *report, fg_loop_check check,
                         char text[FG_LOOP_WORDS]) {
  const fg_loop_checked *checked = &report->result->check[check];
  const char *rows = fg_loop_row_words(order_of(report));
  char names[FG_LOOP_WORDS];
  settings_of(report, check, names);
  if (check == FG_LOOP_CHECK_REPEATS)
    fg_text_clip(text, FG_LOOP_WORDS, "Does the model fit what repeats at the same settings (%s)?",
                 names);
  else if (check == FG_LOOP_CHECK_SETTINGS)
    fg_text_clip(text, FG_LOOP_WORDS, "Does it fit what repeats in every recorded column (%s)?",
                 names);
  else if (check == FG_LOOP_CHECK_LAGS)
    fg_text_clip(text, FG_LOOP_WORDS, "Are %s 2 to %zu apart independent?", rows, checked->lag);
  else
    fg_text_clip(text, FG_LOOP_WORDS,
                 "Are %s independent at every single distance (least so: %zu apart)?", rows,
                 checked->lag);
}

static void name_worst(const fg_loop_report *report, const fg_loop_checked *checked,
                       char text[FG_LOOP_WORDS]) {
  for (size_t k = 0; k < checked->worst_count; k++) {
    size_t row = report->problem->row[checked->worst[k]];
    char number[FG_LOOP_NAME];
    if (report->row_name)
      fg_text_clip(number, sizeof number, "%s", report->row_name[row]);
    else
      fg_text_clip(number, sizeof number, "%zu", row + 1);
    append_check_words(text, !k                              ? "; most at the settings of "
                             : k + 1 == checked->worst_count ? " and "
                                                             : ", ");
    if (!k && !report->row_name)
      append_check_words(text, checked->worst_count > 1 ? "rows " : "row ");
    append_check_words(text, number);
  }
}

void fg_loop_failed_words(const fg_loop_report *report, char text[FG_LOOP_WORDS]) {
  const fg_loop_result *result = report->result;
  const fg_loop_checked *failed = &result->check[result->failed];
  const fg_loop_coordinate *order = order_of(report);
  const char *rows = fg_loop_row_words(order);
  char names[FG_LOOP_WORDS];
  if (result->failed < FG_LOOP_CHECK_LAGS) {
    settings_of(report, result->failed, names);
    fg_text_clip(text, FG_LOOP_WORDS,
                 "rows of the same settings (%s) agree better with each other than with the model: "
                 "lack of fit of %.3g rms (F = %.3g, %s)",
                 names, failed->rms, failed->statistic, fg_loop_p_text(failed->p_value).text);
    name_worst(report, failed, text);
    return;
  }
  const char *along = order ? order->name : "the rows";
  if (result->failed == FG_LOOP_CHECK_LAGS)
    fg_text_clip(text, FG_LOOP_WORDS, "%s 2 to %zu apart along %s are not independent (%s)", rows,
                 failed->lag, along, fg_loop_p_text(failed->p_value).text);
  else
    fg_text_clip(text, FG_LOOP_WORDS,
                 "%s that are %zu apart along %s are %s (correlation %.2f, %s)", rows, failed->lag,
                 along, failed->correlation > 0 ? "alike" : "opposite to each other",
                 failed->correlation, fg_loop_p_text(failed->p_value).text);
}

void fg_loop_failed_advice(const fg_loop_report *report, char text[FG_LOOP_WORDS]) {
  const fg_loop_result *result = report->result;
  const fg_loop_checked *failed = &result->check[result->failed];
  const char *rows = fg_loop_row_words(order_of(report));
  char names[FG_LOOP_WORDS];
  settings_of(report, result->failed, names);
  if (result->failed < FG_LOOP_CHECK_LAGS)
    fg_text_clip(text, FG_LOOP_WORDS,
                 "Declare a richer model over %s (a square, an interaction, levels by "
                 "factor(…)) and run again; look first at the settings that are named.",
                 names);
  else if (result->failed == FG_LOOP_CHECK_ONE_LAG && failed->correlation < 0)
    fg_text_clip(
        text, FG_LOOP_WORDS,
        "Find out what drives %s %zu apart in opposite directions (a control that corrects "
        "too much, a swing of about %zu), give it as a column, and run again. Until then "
        "uncertainties from this table are wrong.",
        rows, failed->lag, 2 * failed->lag);
  else if (result->failed == FG_LOOP_CHECK_ONE_LAG)
    fg_text_clip(text, FG_LOOP_WORDS,
                 "Find out what returns every %zu %s (a shift, a place in the furnace, a coil, a "
                 "season), give it as a column, and run again. Until then uncertainties from this "
                 "table are too small.",
                 failed->lag, rows);
  else
    fg_text_clip(text, FG_LOOP_WORDS,
                 "Find out what lasts for several %s or returns (a shift, a batch, a season), give "
                 "it as a column, and run again. Until then uncertainties from this table are too "
                 "small.",
                 rows);
}
