/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/influence_members.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

static const fg_loop_report *influence_report(const fg_subject *subject) {
  return subject->whole;
}

static double find_influence_row(const fg_subject *subject) {
  const fg_loop_influence *influence = subject->object;
  return (double)influence_report(subject)->problem->row[influence->row] + 1;
}

static const char *find_led_parameter(const fg_subject *subject, char *buffer) {
  const fg_loop_influence *influence = subject->object;
  (void)buffer;
  return influence_report(subject)->problem->problem.parameter_name[influence->parameter];
}

static const char *find_influence_words(const fg_subject *subject, char *buffer) {
  fg_loop_influence_words(influence_report(subject), subject->object, buffer);
  return buffer;
}

static const fg_member influence_rows[] = {
    {FG_COUNT_BY("row", find_influence_row), .lowest = 1},
    {FG_NUMBER("leverage", fg_loop_influence, leverage), .lowest = 0, .highest = 1},
    {FG_NUMBER("studentised_residual", fg_loop_influence, studentised),
     .words = "from what the fit without the row predicts, in its standard deviations"},
    {FG_NUMBER("cook_distance", fg_loop_influence, cook)},
    {FG_TEXT_BY("parameter", find_led_parameter), .options = FG_MEMBER_NEVER_NULL,
     .words = "the declared one that it moves most"},
    {FG_NUMBER("dfbetas", fg_loop_influence, dfbetas),
     .words = "its move of that parameter, in standard errors without the row"},
    {FG_NUMBER("parameter_without", fg_loop_influence, without)},
    {FG_TEXT_BY("words", find_influence_words), .options = FG_MEMBER_NEVER_NULL},
};
const fg_members fg_loop_influence_members = FG_MEMBERS(influence_rows);

static void lead_words(const char *name, char text[FG_LOOP_WORDS]) {
  if (!strcmp(name, "(constant)"))
    fg_text_clip(text, FG_LOOP_WORDS, "the constant");
  else
    fg_text_clip(text, FG_LOOP_WORDS, "%s %s",
                 strpbrk(name, "[(:^") ? "the parameter" : "the slope of", name);
}

void fg_loop_influence_words(const fg_loop_report *report, const fg_loop_influence *influence,
                             char text[FG_LOOP_WORDS]) {
  size_t row = report->problem->row[influence->row];
  char name[FG_LOOP_WORDS], led[FG_LOOP_WORDS];
  if (report->row_name)
    fg_text_clip(name, sizeof name, "%s", report->row_name[row]);
  else
    fg_text_clip(name, sizeof name, "row %zu", row + 1);
  lead_words(report->problem->problem.parameter_name[influence->parameter], led);
  fg_text_clip(text, FG_LOOP_WORDS,
               "%.60s leads %.120s: without it %.4g instead of %.4g, %.1f standard errors apart "
               "(Cook's distance %.2g, leverage %.2g, studentised residual %.1f)",
               name, led, influence->without, influence->without + influence->change,
               fabs(influence->dfbetas), influence->cook, influence->leverage,
               influence->studentised);
}
