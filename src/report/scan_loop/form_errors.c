/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Form errors of a foil, circle by circle: on the page and in the terminal. */
#include <math.h>

#include "core/member.h"
#include "core/text.h"
#include "foilgauge/report.h"
#include "page/table.h"
#include "report/scan_loop/parts.h"

/* Decimals that give U two digits. */
static int decimals_of(double expanded) {
  return (int)fmin(3, fmax(0, 1 - floor(log10(expanded))));
}

void fg_form_error_words(const fg_form_error *error, const char *plus_minus, char *words,
                         size_t size) {
  double expanded = FG_COVERAGE_FACTOR * error->u_um;
  words[0] = 0;
  if (isnan(error->um) && !(error->range_um[1] > 0)) {
    fg_text_clip(words, size, "not known");
  } else if (isnan(error->um)) {
    fg_text_clip(words, size, "%.2g to %.2g", error->range_um[0], error->range_um[1]);
  } else if (error->u_um > 0 && error->um < expanded) {
    fg_text_clip(words, size, "below %.2g", error->um + expanded);
  } else if (error->u_um > 0) {
    int decimals = decimals_of(expanded);
    fg_text_clip(words, size, "%.*f %s %.*f", decimals, error->um, plus_minus, decimals, expanded);
  }
}

/* Circles of a foil: the lands, then the bumps. */
static bool find_circle(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_foil *foil = list->object;
  *element = (fg_subject){.object = foil, .whole = foil, .index = i};
  return i <= foil->bump_count;
}

static const fg_form_error *error_of(const fg_subject *circle) {
  const fg_foil *foil = circle->whole;
  return circle->index ? &foil->bumps[circle->index - 1].form_error : &foil->overall.form_error;
}

static const char *find_circle_name(const fg_subject *circle, char *buffer) {
  const fg_foil *foil = circle->whole;
  if (!circle->index) return "lands, R0";
  fg_text_clip(buffer, 32, "bump %d", foil->bumps[circle->index - 1].number);
  return buffer;
}

static const char *find_error_words(const fg_subject *circle, char *buffer) {
  fg_form_error_words(error_of(circle), "±", buffer, FG_FORM_ERROR_WORDS);
  return buffer[0] ? buffer : "–";
}

static const fg_member circle_rows[] = {
    {FG_TEXT_BY("circle", find_circle_name), .page = {.rank = 1, .heading = "circle"}},
    {FG_TEXT_BY("form_error", find_error_words), .page = {.rank = 1, .heading = "form error, µm"}},
};
static const fg_members circle_members = FG_MEMBERS(circle_rows);

bool fg_has_form_error(const fg_form_error *error) {
  return isnan(error->um) || error->u_um > 0;
}

void fg_scan_loop_page_form_errors(FILE *out, const fg_foil *foil) {
  bool open = false, cut = false, any = false;
  for (size_t k = 0; k <= foil->bump_count; k++) {
    const fg_form_error *error = k ? &foil->bumps[k - 1].form_error : &foil->overall.form_error;
    any = any || fg_has_form_error(error);
    open = open || (isnan(error->um) && error->range_um[1] > 0);
    cut = cut || (isnan(error->um) && !(error->range_um[1] > 0));
  }
  if (!any) return;
  fputs("<p class=\"note\">Form error: how far the foil itself deviates from its least-squares "
        "circle, peak to valley. It is in no correction.",
        out);
  if (open)
    fputs(" A range: the edges do not tell whether the foil or the scanner deviates. The same "
          "foil, scanned again turned by about 90°, tells.",
          out);
  if (cut)
    fputs(" Not known: more than a tenth of the bump's arc is no circle at an end and passes for "
          "its fillet.",
          out);
  fputs("</p>\n", out);
  fg_html_table(out, &circle_members, &(fg_subject){.object = foil, .whole = foil}, find_circle);
}
