/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/gauge_report.h"

#include <math.h>

#include "core/text.h"
#include "foilgauge/report.h"
#include "foilgauge/words.h"
#include "page/page.h"

enum { GAUGE_WORDS = 400 };

static void write_stated_gauge(fg_json *json, const fg_gauge *gauge) {
  fg_json_string(json, "kind", fg_gauge_word(gauge->kind));
  fg_json_number(json, "width_mm", gauge->width_mm);
  fg_json_number(json, "u_mm", gauge->u_mm);
}

static void write_reading(fg_json *json, const fg_gauge_reading *reading) {
  fg_json_bool(json, "found", reading->found);
  fg_json_bool(json, "used", reading->used);
  fg_json_number(json, "measured_mm", reading->found ? reading->measured_mm : NAN);
  fg_json_number(json, "u_measured_mm", reading->found ? reading->u_measured_mm : NAN);
  if (reading->found)
    fg_json_numbers(json, "place_mm", reading->place_mm, 4);
  else
    fg_json_string(json, "place_mm", NULL);
  fg_json_number(json, "level", reading->found ? reading->level : NAN);
  fg_json_number(json, "u_level", reading->found ? reading->u_level : NAN);
  fg_json_string(json, "note", reading->note[0] ? reading->note : NULL);
}

void fg_json_gauges(fg_json *json, const fg_measurement *m) {
  fg_json_array(json, "gauges");
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    fg_json_object(json, NULL);
    write_stated_gauge(json, &m->design.gauges[i]);
    write_reading(json, &m->gauges[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  if (m->gauges_contradict) fg_json_bool(json, "gauges_contradict", true);
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
