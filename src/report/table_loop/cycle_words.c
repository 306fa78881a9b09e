/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/cycle_words.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/unit_words.h"
#include "report/value_words.h"

enum { PLACE_WORDS = 60 };

static const fg_loop_coordinate *coordinate_of(const fg_loop_report *report,
                                               const fg_loop_claim *claim) {
  return &report->problem->problem.coordinate[claim->candidate.a];
}

static void append_text(char *text, size_t size, const char *more) {
  size_t used = strlen(text);
  fg_text_clip(text + used, size - used, "%s", more);
}

/* With as many digits as its u leaves. */
static void put_value(const char *name, double value, double u, char text[PLACE_WORDS]) {
  int digits = 3;
  if (u > 0 && value != 0) digits = (int)fmin(fmax(ceil(log10(fabs(value) / u)) + 1, 2), 8);
  if (u == 0) digits = 8;
  fg_value_with_unit(name, value, digits, text, PLACE_WORDS);
}

/* "90°" of a known base; "90.1 ± 0.4 mm". */
static void put_period(const char *name, double period, double u, char text[PLACE_WORDS]) {
  const char *unit = fg_unit_of_name(name);
  if (!(u > 0)) {
    put_value(name, period, u, text);
    return;
  }
  fg_scan_loop_value_words(period, u, text, PLACE_WORDS);
  append_text(text, PLACE_WORDS, *unit && strcmp(unit, "°") != 0 ? " " : "");
  append_text(text, PLACE_WORDS, unit);
}

/* "orders 1, 2 and 4". */
static void append_orders(const fg_loop_claim *claim, char *text, size_t size) {
  char number[40];
  for (size_t k = 0; k < claim->orders; k++) {
    const char *before = !k ? " " : k + 1 == claim->orders ? " and " : ", ";
    fg_text_clip(number, sizeof number, "%s%zu", before, claim->order[k].order);
    append_text(text, size, number);
  }
}

void fg_loop_period_words(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                          size_t size) {
  const char *name = coordinate_of(report, claim)->name;
  double base = claim->shape[0], order = claim->orders == 1 ? (double)claim->order[0].order : 1;
  char period[PLACE_WORDS], whole[PLACE_WORDS];
  put_period(name, base / order, claim->shape_u[0] / order, period);
  put_value(name, base, claim->shape_u[0], whole);
  fg_text_clip(text, size, " that returns every %s", period);
  if (order > 1) {
    size_t used = strlen(text);
    fg_text_clip(text + used, size - used, " (order %.0f of %s)", order, whole);
  }
  if (claim->orders < 2) return;
  append_text(text, size, ", in its orders");
  append_orders(claim, text, size);
}

void fg_loop_order_words(const fg_loop_report *report, const fg_loop_claim *claim, double times,
                         char *text, size_t size) {
  const char *unit = fg_unit_of_name(report->spec->response);
  *text = '\0';
  for (size_t k = 0; k < claim->orders; k++) {
    const fg_loop_order_fit *fit = &claim->order[k];
    char amplitude[80], place[PLACE_WORDS], one[240];
    fg_scan_loop_value_words(fit->amplitude, fit->amplitude_u * times, amplitude, sizeof amplitude);
    put_value(coordinate_of(report, claim)->name, fit->peak_at, fit->peak_at_u, place);
    fg_text_clip(one, sizeof one, "%sof order %zu %s%s%s, highest at %s", k ? "; " : "amplitude ",
                 fit->order, amplitude, *unit && strcmp(unit, "°") != 0 ? " " : "", unit, place);
    append_text(text, size, one);
  }
}

/* Members. */
static const fg_member order_rows[] = {
    {FG_COUNT("order", fg_loop_order_fit, order), .lowest = 1,
     .words = "cycles in a base period, which is `period` of `parameters`"},
    {FG_NUMBER_U("amplitude", fg_loop_order_fit, amplitude, amplitude_u),
     .words = "half of peak to valley"},
    {FG_NUMBER_U("phase_deg", fg_loop_order_fit, phase_deg, phase_u_deg),
     .words = "amplitude cos(360° order x / period - phase)"},
    {FG_NUMBER_U("peak_at", fg_loop_order_fit, peak_at, peak_at_u),
     .words = "place of its peak nearest to the middle of the column's range"},
};
const fg_members fg_loop_order_members = FG_MEMBERS(order_rows);
