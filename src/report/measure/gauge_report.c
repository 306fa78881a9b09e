/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/gauge_report.h"

#include <math.h>

#include "core/text.h"
#include "foilgauge/report.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "report/design/members.h"

enum { GAUGE_WORDS = 400 };

/* Values of a gauge that was not found. */
static const fg_gauge_reading not_found = {
    .measured_mm = NAN, .u_measured_mm = NAN, .level = NAN, .u_level = NAN};

static fg_subject find_reading(const fg_subject *subject) {
  const fg_gauge_reading *reading = subject->object;
  return (fg_subject){.object = reading->found ? reading : &not_found};
}

static fg_subject find_stated(const fg_subject *subject) {
  const fg_measurement *m = subject->whole;
  return (fg_subject){.object = &m->design.gauges[subject->index]};
}

static const double *list_gauge_place(const fg_subject *subject, double *values, size_t *count) {
  const fg_gauge_reading *reading = subject->object;
  (void)values;
  *count = reading->found ? 4 : 0;
  return reading->place_mm;
}

static const fg_member measured_rows[] = {
    {FG_NUMBER_U("measured_mm", fg_gauge_reading, measured_mm, u_measured_mm),
     .words = "with its edges at half of the counts, before anything was moved; u by the scatter "
              "of its edges"},
    {FG_NUMBERS_BY("place_mm", list_gauge_place), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NULLABLE | FG_MEMBER_NEVER_NULL,
     .words = "box in the scan: x, y, width, height"},
    {FG_NUMBER_U("level", fg_gauge_reading, level, u_level),
     .words = "level of the edges by this gauge alone, less half, share of the contrast"},
};
static const fg_members measured_members = FG_MEMBERS(measured_rows);

static const fg_member gauge_rows[] = {
    {FG_SAME(&fg_gauge_members), .part = find_stated, .options = FG_MEMBER_NEVER_NULL},
    {FG_FLAG("found", fg_gauge_reading, found)},
    {FG_FLAG("used", fg_gauge_reading, used),
     .words = "it tells the level of the scan's edges, and they were moved to it"},
    {FG_SAME(&measured_members), .part = find_reading, .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT("note", fg_gauge_reading, note), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why it was not found, or is not used"},
};
const fg_members fg_gauge_reading_members = FG_MEMBERS_OF_FILE(gauge_rows, "gauge", "measure");

bool fg_gauge_reading_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_measurement *m = list->object;
  element->object = &m->gauges[i];
  element->whole = m;
  return i < m->design.gauge_count;
}

/* "leaf of 0.1 mm: read 0.1043 ± 0.0002 mm at x 18.0, y 17.9 mm, ..." */
static void describe_gauge(const fg_gauge *gauge, const fg_gauge_reading *r,
                           char words[GAUGE_WORDS]) {
  if (!r->found) {
    fg_text_clip(words, GAUGE_WORDS,
                 "%s of %g mm: NOT FOUND: %s. Widths keep the uncertainty of an unknown tone curve",
                 fg_gauge_word(gauge->kind), gauge->width_mm, r->note);
    return;
  }
  fg_text_clip(words, GAUGE_WORDS,
               "%s of %g ± %g mm: reads %.5f ± %.5f mm at x %.1f, y %.1f mm; edges lie at a level "
               "%+.3f ± %.3f of the contrast from half of the counts%s%s",
               fg_gauge_word(gauge->kind), gauge->width_mm, FG_COVERAGE_FACTOR * gauge->u_mm,
               r->measured_mm, FG_COVERAGE_FACTOR * r->u_measured_mm, r->place_mm[0],
               r->place_mm[1], r->level, FG_COVERAGE_FACTOR * r->u_level,
               !r->note[0] ? ""
               : r->used   ? "; "
                           : "; NOT USED: ",
               r->note);
}

static const char contradiction[] =
    "The gauges contradict each other by more than their uncertainties: check the stated widths, "
    "and whether each is clean and stands upright. Uncertainties are widened by it.";

void fg_text_gauges(FILE *out, const fg_measurement *m) {
  char words[GAUGE_WORDS];
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    describe_gauge(&m->design.gauges[i], &m->gauges[i], words);
    fprintf(out, "gauge: %s.\n", words);
  }
  if (m->gauges_contradict) fprintf(out, "gauges: %s\n", contradiction);
  if (m->tone_note[0]) fprintf(out, "tone: %s\n", m->tone_note);
}

void fg_html_gauges(FILE *out, const fg_measurement *m) {
  char words[GAUGE_WORDS];
  if (m->tone_note[0]) fprintf(out, "<p class=\"note\">%s</p>\n", m->tone_note);
  if (!m->design.gauge_count) return;
  fputs("<h2>Gauges on the glass</h2>\n<ul class=\"flags\">\n", out);
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    describe_gauge(&m->design.gauges[i], &m->gauges[i], words);
    fputs("<li>", out);
    fg_html_text(out, words);
    fputs(".</li>\n", out);
  }
  if (m->gauges_contradict) fprintf(out, "<li>%s</li>\n", contradiction);
  fputs("</ul>\n", out);
}
