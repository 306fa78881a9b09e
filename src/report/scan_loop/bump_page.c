/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` on the page of the loop on scans: every bump's deviation from the declared
 * springback over its number, the effects found, the residual. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "page/plot_frame.h"
#include "page/table.h"
#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"

/* ---- drawings ---- */

typedef struct view {
  const fg_scan_result_bumps *bumps;
  const fg_scan_result_response *response;
} view;

static double bump_abscissa(const view *v, const fg_scan_result_bump *bump) {
  double parts = (double)v->bumps->parts;
  return bump->number + (parts > 1 ? 0.5 * ((double)bump->part / (parts - 1) - 0.5) : 0);
}

static void put_bump_marks(const fg_plot *at, const view *v, bool after) {
  for (size_t i = 0; i < v->response->bumps; i++) {
    const fg_scan_result_bump *bump = &v->response->bump[i];
    double x = bump_abscissa(v, bump), y = after ? bump->after : bump->before;
    if (!after && bump->effect != 0)
      fg_plot_segment(at, x - 0.3, bump->effect, x + 0.3, bump->effect, "effect");
    fg_plot_dot(at, x, y, v->bumps->parts > 4 ? 3 : 5, bump->held_out ? "run" : "bar");
  }
}

static void put_bump_plot(FILE *out, const view *v, const double x[2], const double y[2],
                          bool after, const char *caption) {
  char title[64];
  snprintf(title, sizeof title, "off the model, %s", fg_scan_loop_unit_words(v->response->unit));
  fprintf(out, "<figure><figcaption><b>%s</b></figcaption>", caption);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){caption, .width = 520, .height = 264, .left = 72, .right = 10,
                            .top = 12, .x = x, .y = y, .y_title = title,
                            .x_title = v->bumps->lip ? "bump, 1 is next to the lip" : "bump"});
  put_bump_marks(&at, v, after);
  fg_plot_end(&at);
  fputs("</figure>\n", out);
}

static void find_bump_range(const view *v, double x[2], double y[2]) {
  for (size_t i = 0; i < v->response->bumps; i++) {
    const fg_scan_result_bump *bump = &v->response->bump[i];
    fg_range_add(x, bump_abscissa(v, bump), 0.6);
    fg_range_add(y, bump->before, 0);
    fg_range_add(y, bump->after, 0);
  }
  fg_range_pad(y, 0.08, 1e-9);
}

static void put_response(FILE *out, const fg_scan_result_bumps *bumps,
                         const fg_scan_result_response *response) {
  const view v = {bumps, response};
  bool found = response->claims || response->has_curve;
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  char caption[120];
  if (!response->bumps) return;
  find_bump_range(&v, x, y);
  fg_text_clip(caption, sizeof caption, "%s, off %s%s", response->words, response->model,
               found ? ": before" : "");
  put_bump_plot(out, &v, x, y, false, caption);
  fg_text_clip(caption, sizeof caption, "%s: after", response->words);
  if (found) put_bump_plot(out, &v, x, y, true, caption);
}

/* ---- tables ---- */

static void put_bump_effect_name(FILE *out, const char *id, const char *words,
                                 const fg_scan_result_response *response) {
  fputs("<td class=\"words\">", out);
  fg_html_text(out, words);
  fprintf(out, ", %s<i>%s</i></td>", response->words, id);
}

static void put_bump_claim(FILE *out, const fg_scan_result_response *response,
                           const fg_scan_result_bump_claim *claim) {
  char words[64];
  fputs("<tr class=\"on\">", out);
  put_bump_effect_name(out, claim->id, claim->words, response);
  bool tied = claim->verdict == FG_LOOP_TIED;
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"words\">",
          tied ? "tied" : "found", fg_loop_verdict_word(claim->verdict));
  for (size_t i = 0; i < claim->parameters; i++) {
    fg_scan_loop_value_words(claim->parameter[i], claim->parameter_u[i], words, sizeof words);
    fprintf(out, "%s%s = %s", i ? "<br>" : "", claim->parameter_name[i], words);
  }
  for (size_t i = 0; i < claim->ties; i++) {
    fputs(i ? ", " : "<i>or ", out);
    fg_html_text(out, claim->tied[i].name);
  }
  fprintf(out, "%s</td><td>%.2g</td></tr>\n", claim->ties ? "</i>" : "", claim->p_value);
}

static void put_bump_unclaimed(FILE *out, const fg_scan_result_response *response,
                               const fg_scan_result_bump_unclaimed *one) {
  fputs("<tr>", out);
  put_bump_effect_name(out, one->id, one->words, response);
  fprintf(out, "<td class=\"w\"><span class=\"tag %s\">%s</span></td><td class=\"w\">",
          one->verdict == FG_LOOP_ABSENT ? "absent" : "open", fg_loop_verdict_word(one->verdict));
  if (isfinite(one->smallest))
    fprintf(out, "would have shown from %.3g %s", one->smallest,
            fg_scan_loop_unit_words(response->unit));
  else
    fputs("–", out);
  fprintf(out, "</td><td>%.2g</td></tr>\n", one->p_value);
}

static void put_candidates(FILE *out, const fg_scan_result_bumps *bumps) {
  fputs("<div class=\"scroll\"><table><thead><tr><th>effect over the bumps</th><th "
        "class=\"w\">verdict</th>"
        "<th class=\"w\">size, ± U = 2u</th><th>p</th></tr></thead>\n",
        out);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t m = 0; m < bumps->response[r].claims; m++)
      put_bump_claim(out, &bumps->response[r], &bumps->response[r].claim[m]);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t k = 0; k < bumps->response[r].unclaimeds; k++)
      put_bump_unclaimed(out, &bumps->response[r], &bumps->response[r].unclaimed[k]);
  fputs("</table></div>\n", out);
}

/* Writes the declared forming, and the deviation of its level. */
static void put_declared(FILE *out, const fg_scan_result_bumps *bumps) {
  if (!bumps->declared_path) return;
  fputs("<p class=\"note\">Declared is what <code>", out);
  fg_html_text(out, bumps->declared_path);
  fprintf(
      out,
      "</code> (<code>foilgauge forming</code>, SHA-256 <code>%.12s</code>) predicts of each bump "
      "by its number: its radius beside one level, and its arc length.",
      bumps->declared_sha256);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++) {
    const fg_scan_result_response *one = &bumps->response[r];
    if (isfinite(one->level))
      fprintf(out, " Measured minus declared is <b>%+.3g ± %.2g %s</b> of the %s on average.",
              one->level, 2 * one->u_level, fg_scan_loop_unit_words(one->unit), one->words);
  }
  fputs("</p>\n", out);
}

static void put_drawings(FILE *out, const fg_scan_result_bumps *bumps) {
  fputs("<p class=\"note\">The bumps as corrected. Dots: bumps, rings: kept aside. Orange: what "
        "was "
        "found.</p>\n<div class=\"two\">\n",
        out);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    put_response(out, bumps, &bumps->response[r]);
  fputs("</div>\n", out);
}

void fg_scan_loop_page_bumps(FILE *out, const fg_scan_result *result) {
  const fg_scan_report report = {.result = result};
  const fg_scan_result_bumps *bumps = &result->bumps;
  bool judged = false, any = bumps->count + bumps->held_out > 0;
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    judged |= bumps->response[r].judged;
  if (!any && !result->notes) return;
  fprintf(out, "<section><h2 class=\"first\">The bumps against %s</h2>\n",
          bumps->declared_path ? "the declared forming" : "the declared springback");
  put_declared(out, bumps);
  if (judged) put_drawings(out, bumps);
  if (any) put_candidates(out, bumps);
  if (judged)
    fg_html_table(out, &fg_scan_response_members, &(fg_subject){.whole = &report},
                  fg_scan_find_judged);
  for (size_t i = 0; i < result->notes; i++) {
    fputs("<p class=\"note\">", out);
    fg_html_text(out, result->note[i]);
    fputs("</p>\n", out);
  }
  fputs("</section>\n", out);
}
