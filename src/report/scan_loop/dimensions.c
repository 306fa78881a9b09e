/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dimensions before and after, with their uncertainties. */
#include <math.h>
#include <string.h>

#include "foilgauge/report.h"
#include "report/correction_words.h"
#include "report/scan_loop/parts.h"

typedef struct value {
  double value, u;
} value;

/* A reported quantity of one owner, before and after. `to_fine` makes the change readable. */
typedef struct quantity {
  const char *title, *unit, *fine;
  double to_fine;
  value before, after;
  const double *range; /* over tied explanations; NULL or both 0: none */
  bool left;           /* as measured: its correction has no benefit */
} quantity;

/* Returns the decimals that give U two digits, at most six. */
static int decimals_for(double u) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!(expanded > 0) || !isfinite(expanded)) return 5;
  return (int)fmin(6, fmax(0, 1 - floor(log10(expanded))));
}

static void put_dimension(FILE *out, value v) {
  if (!isfinite(v.value)) {
    fputs("<td>–</td>", out);
    return;
  }
  int decimals = decimals_for(v.u);
  fprintf(out, "<td>%.*f", decimals, v.value);
  if (isfinite(v.u)) fprintf(out, "<i>± %.*f</i>", decimals, FG_COVERAGE_FACTOR * v.u);
  fputs("</td>", out);
}

static void put_change(FILE *out, const quantity *q) {
  double change = q->after.value - q->before.value;
  if (q->left) {
    fputs("<td><i>left</i></td>", out);
    return;
  }
  if (!isfinite(change)) {
    fputs("<td>–</td>", out);
    return;
  }
  double expanded = FG_COVERAGE_FACTOR * q->after.u;
  bool large = fabs(change) > expanded;
  int decimals = isfinite(expanded) && expanded > 0 ? decimals_for(q->after.u * q->to_fine) : 2;
  double step = pow(10, decimals), rounded = round(change * q->to_fine * step) / step;
  fprintf(out, "<td class=\"%s\">%+.*f</td>", large ? "moved-on" : "", decimals,
          rounded == 0 ? 0.0 : rounded);
}

static bool has_range(const quantity *q) {
  return q->range && q->range[1] > 0;
}

static void put_range(FILE *out, const quantity *q) {
  if (!q->range) return;
  if (has_range(q))
    fprintf(out, "<td>%.5f<i>to %.5f</i></td>", q->range[0], q->range[1]);
  else
    fputs("<td>–</td>", out);
}

static void put_quantity(FILE *out, const quantity *q, bool corrected, bool tied) {
  put_dimension(out, q->before);
  if (!corrected) return;
  put_dimension(out, q->after);
  put_change(out, q);
  if (tied) put_range(out, q);
}

enum { BUMP_QUANTITIES = 4, BESIDE = 2 };

static void bump_quantities(const fg_bump *b, const fg_bump *a, quantity q[BUMP_QUANTITIES]) {
  q[0] = (quantity){"R",
                    "mm",
                    "µm",
                    1000,
                    {b->radius_mm, b->u_radius_mm},
                    {a->radius_mm, a->u_radius_mm},
                    a->radius_range_mm,
                    false};
  q[1] = (quantity){"height h, free",
                    "mm",
                    "µm",
                    1000,
                    {b->height_mm, b->u_height_mm},
                    {a->height_mm, a->u_height_mm},
                    a->height_range_mm,
                    false};
  q[2] = (quantity){"angle α",
                    "°",
                    "°",
                    1,
                    {b->bump_angle_deg, b->u_bump_angle_deg},
                    {a->bump_angle_deg, a->u_bump_angle_deg},
                    NULL,
                    false};
  q[3] = (quantity){"clearance, free",
                    "mm",
                    "µm",
                    1000,
                    {b->clearance_mm, b->u_clearance_mm},
                    {a->clearance_mm, a->u_clearance_mm},
                    NULL,
                    false};
}

static void put_heads(FILE *out, const quantity *q, size_t count, const char *first, bool corrected,
                      bool tied) {
  fprintf(
      out,
      "<div class=\"scroll\"><table class=\"dimensions%s\"><thead><tr><th rowspan=\"2\">%s</th>",
      count == 1 ? " narrow" : "", first);
  for (size_t i = 0; i < count; i++)
    fprintf(out, "<th class=\"group\" colspan=\"%d\">%s, %s</th>",
            !corrected           ? 1
            : tied && q[i].range ? 4
                                 : 3,
            q[i].title, q[i].unit);
  fputs("</tr><tr>", out);
  for (size_t i = 0; i < count; i++) {
    fputs(corrected ? "<th>before</th><th>after</th>" : "<th>measured</th>", out);
    if (corrected) fprintf(out, "<th>change, %s</th>", q[i].fine);
    if (corrected && tied && q[i].range) fputs("<th>range</th>", out);
  }
  fputs("</tr></thead>\n<tbody>\n", out);
}

static const fg_bump *find_foil_bump(const fg_foil *foil, int number) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number == number) return &foil->bumps[i];
  return NULL;
}

/* Writes two quantities side by side: more of them, each before, after, changed and with its range,
 * would be wider than a sheet of paper. */
static void put_bump_table(FILE *out, const fg_foil *b, const fg_foil *a, size_t from,
                           bool corrected, bool tied) {
  quantity q[BUMP_QUANTITIES];
  bool opened = false;
  for (size_t i = 0; i < b->bump_count; i++) {
    const fg_bump *after = find_foil_bump(a, b->bumps[i].number);
    if (!after) continue;
    bump_quantities(&b->bumps[i], after, q);
    q[0].left = fg_correction_is_left_out(&a->choice[FG_CORRECTED_RADIUS]);
    q[1].left = fg_correction_is_left_out(&a->choice[FG_CORRECTED_HEIGHT]);
    if (!opened) put_heads(out, q + from, BESIDE, "bump", corrected, tied);
    opened = true;
    fprintf(out, "<tr><td>%d</td>", b->bumps[i].number);
    for (size_t k = from; k < from + BESIDE; k++)
      put_quantity(out, &q[k], corrected, tied);
    fputs("</tr>\n", out);
  }
  if (opened) fputs("</tbody></table></div>\n", out);
}

static void put_overall(FILE *out, const fg_foil *b, const fg_foil *a, bool corrected, bool tied) {
  quantity q = {"R0",
                "mm",
                "µm",
                1000,
                {b->overall.radius_mm, b->overall.u_radius_mm},
                {a->overall.radius_mm, a->overall.u_radius_mm},
                a->overall.radius_range_mm,
                fg_correction_is_left_out(&a->choice[FG_CORRECTED_OVERALL_RADIUS])};
  put_heads(out, &q, 1, "circle", corrected, tied);
  fputs("<tr><td>overall</td>", out);
  put_quantity(out, &q, corrected, tied);
  fputs("</tr></tbody></table></div>\n", out);
}

static void put_foil_dimensions(FILE *out, const fg_scan_result *result, size_t scan, size_t f) {
  const fg_foil *b = &result->scan[scan].before->foils[f], *a = &result->scan[scan].after->foils[f];
  fputs("<h3>", out);
  fg_html_text(out, result->scan[scan].before->scan);
  fprintf(out, ", foil %d</h3>\n", b->number);
  if ((b->flags | a->flags) & FG_FOIL_NOT_MEASURED) {
    fputs("<p class=\"note\">Not measured: ", out);
    fg_html_text(out, b->flags & FG_FOIL_NOT_MEASURED ? b->error : a->error);
    fputs("</p>\n", out);
    return;
  }
  bool tied = result->tied || result->scale_tied;
  fg_html_choices(out, a);
  put_overall(out, b, a, result->corrected, tied);
  for (size_t from = 0; from < BUMP_QUANTITIES; from += BESIDE)
    put_bump_table(out, b, a, from, result->corrected, tied);
  fg_scan_loop_page_form_errors(out, a);
}

static void put_disc_dimensions(FILE *out, const fg_scan_result *result, size_t scan) {
  const fg_measurement *b = result->scan[scan].before, *a = result->scan[scan].after;
  bool corrected = result->corrected;
  size_t count = b->disc_count < a->disc_count ? b->disc_count : a->disc_count;
  for (size_t i = 0; i < count; i++) {
    const fg_disc *x = &b->discs[i], *y = &a->discs[i];
    quantity q[2] = {{"diameter",
                      "mm",
                      "µm",
                      1000,
                      {x->diameter_mm, x->u_diameter_mm},
                      {y->diameter_mm, y->u_diameter_mm},
                      NULL,
                      fg_correction_is_left_out(&y->choice)},
                     {"roundness",
                      "µm",
                      "µm",
                      1,
                      {x->roundness_um, x->u_roundness_um},
                      {y->roundness_um, y->u_roundness_um},
                      NULL,
                      false}};
    if (i == 0) {
      fputs("<h3>", out);
      fg_html_text(out, b->scan);
      fputs(", discs</h3>\n", out);
      put_heads(out, q, 2, "disc", corrected, false);
    }
    fprintf(out, "<tr><td>%d</td>", x->number);
    for (int k = 0; k < 2; k++)
      put_quantity(out, &q[k], corrected, false);
    fputs("</tr>\n", out);
  }
  if (count) fputs("</tbody></table></div>\n", out);
  if (count) fg_html_disc_choice(out, &a->discs[0]);
}

/* Returns the disagreement of scans of one foil: rms, over the bumps, of the difference in radius
 * to the first scan, um. It needs no true value. */
static double disagreement(const fg_scan_result *result, bool after) {
  double sum = 0, n = 0;
  const fg_measurement *first = after ? result->scan[0].after : result->scan[0].before;
  for (size_t s = 1; s < result->scans; s++) {
    const fg_measurement *m = after ? result->scan[s].after : result->scan[s].before;
    for (size_t f = 0; f < m->foil_count && f < first->foil_count; f++)
      for (size_t i = 0; i < m->foils[f].bump_count; i++) {
        const fg_bump *one = &m->foils[f].bumps[i];
        const fg_bump *other = find_foil_bump(&first->foils[f], one->number);
        if (!other || !isfinite(one->radius_mm) || !isfinite(other->radius_mm)) continue;
        sum += pow(1000 * (one->radius_mm - other->radius_mm), 2);
        n++;
      }
  }
  return sqrt(sum / n);
}

static void put_agreement(FILE *out, const fg_scan_result *result) {
  char before[32], after[32];
  if (!result->same_foil || result->scans < 2) return;
  double b = disagreement(result, false), a = disagreement(result, true);
  if (!isfinite(a) || !isfinite(b)) return;
  fg_scan_loop_length_words(b, before, sizeof before);
  fg_scan_loop_length_words(a, after, sizeof after);
  fprintf(out, "<p class=\"say\">The radius of one bump differs between the scans by %s rms",
          before);
  if (result->corrected) fprintf(out, " before, and by %s after", after);
  fputs(".</p>\n", out);
}

void fg_scan_loop_page_dimensions(FILE *out, const fg_scan_result *result) {
  fputs("<section><h2 class=\"first\">Dimensions</h2>\n<p class=\"note\">± is U = 2u.", out);
  if (result->corrected)
    fputs(" A change larger than U of the corrected value is marked. A dimension is moved only "
          "where that makes its expected error smaller; what was left as measured has in its ± "
          "what was not corrected.",
          out);
  if (result->tied || result->scale_tied)
    fputs(" Range: lowest and highest value, U included, over the explanations that the data "
          "cannot tell apart, and the value that is reported.",
          out);
  fputs("</p>\n", out);
  put_agreement(out, result);
  for (size_t i = 0; i < result->scans; i++) {
    const fg_scan_result_scan *scan = &result->scan[i];
    for (size_t f = 0; f < scan->before->foil_count && f < scan->after->foil_count; f++)
      put_foil_dimensions(out, result, i, f);
    put_disc_dimensions(out, result, i);
  }
  fputs("</section>\n", out);
}
