/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawings of the effects: curves over their coordinates, with the parameters. */
#include <math.h>
#include <string.h>

#include "page/plot_frame.h"
#include "report/scan_loop/parts.h"

enum { SAMPLES = FG_SCAN_RESULT_SAMPLES };

/* Marks the range of the foils' edges: beyond it, data do not determine a curve. */
static void put_reach(const fg_plot *at, const fg_scan_result *result,
                      fg_scan_coordinate coordinate) {
  double range[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < result->rows; i++)
    fg_range_add(range, result->row[i].place[coordinate], 0);
  if (!(range[1] > range[0])) return;
  fg_plot_band(at, at->y_low, at->y_high, "beyond");
  fg_plot_rect(at, range, (double[]){at->y_low, at->y_high}, "reach");
}

static void put_band(const fg_plot *at, const fg_scan_result_line *line) {
  double low[SAMPLES], high[SAMPLES];
  if (!isfinite(line->expanded_um[0])) return;
  for (size_t i = 0; i < SAMPLES; i++) {
    low[i] = line->um[i] - line->expanded_um[i];
    high[i] = line->um[i] + line->expanded_um[i];
  }
  fg_plot_ribbon(at, line->x, low, high, SAMPLES, "ci shape", NULL);
}

static const char *moves_words(const fg_scan_result_line *line) {
  if (!line->glass) return "deviation";
  return line->axis == 'y' ? "displacement in y" : "displacement in x";
}

static const char *caption_words(const fg_scan_result_line *line) {
  static const char *const captions[2][FG_SCAN_COORDINATES] = {
      {[FG_SCAN_FOIL] = "Deviation of the foil, outwards from O positive",
       [FG_SCAN_PHI] = "Deviation of every bump from its circle, away from its centre positive",
       [FG_SCAN_NORMAL] = "What the direction of the edge does, outwards positive"},
      {[FG_SCAN_FOIL] = "Deviation of the foil from its best circle, outwards positive",
       [FG_SCAN_INDEX] = "Deviation of single bumps from their circles, away from their centres "
                         "positive",
       [FG_SCAN_PHI] = "Deviation of every bump from its best circle, away from its centre "
                       "positive",
       [FG_SCAN_NORMAL] = "What the direction of the edge does, outwards positive"}};
  return line->glass ? "What must be added to the picture's coordinate. White: where edges lie "
                       "that were measured"
                     : captions[line->free][line->coordinate];
}

/* The range with the band; returns how wide the band is. */
static double find_curve_range(const fg_scan_result_line *line, double range[2]) {
  double widest = 0;
  range[0] = range[1] = 0;
  for (size_t i = 0; i < SAMPLES; i++) {
    if (!isfinite(line->um[i])) continue;
    widest = fmax(widest, line->expanded_um[i]);
    fg_range_add(range, line->um[i], line->expanded_um[i]);
  }
  fg_range_pad(range, 0.08, 1e-6);
  return widest;
}

static void put_curve_line(FILE *out, const fg_scan_result *result,
                           const fg_scan_result_line *line) {
  double range[2], widest = find_curve_range(line, range);
  char title[64];
  snprintf(title, sizeof title, "%s, µm", moves_words(line));
  fputs("<figure>", out);
  fg_plot at = fg_plot_open(
      out, &(fg_plot_frame){title, .width = 520, .height = 290, .left = 72, .right = 12,
                            .x = (double[]){line->x[0], line->x[SAMPLES - 1]}, .y = range,
                            .y_title = title,
                            .x_title = line->coordinate == FG_SCAN_FOIL
                                           ? "angle from the foil's middle about O, °"
                                           : result->coordinate_title[line->coordinate]});
  if (line->glass) put_reach(&at, result, line->coordinate);
  fg_plot_axes(&at);
  put_band(&at, line);
  fg_plot_line(&at, line->x, line->um, SAMPLES, "effect");
  fg_plot_end(&at);
  fprintf(out, "<figcaption>%s", caption_words(line));
  if (widest > 0) {
    fg_scan_loop_length_words(widest, title, sizeof title);
    fprintf(out, "; band: U = 2u, at most %s", title);
  }
  fputs(".</figcaption></figure>\n", out);
}

static void put_effect_details(FILE *out, const fg_scan_result_claim *claim) {
  char words[120];
  fputs("<tr><td class=\"words\">", out);
  fg_html_text(out, claim->words);
  fputs("<i>", out);
  fg_html_text(out, claim->id);
  if (claim->direction)
    fprintf(out, ", along the %s", strcmp(claim->direction, "radial") ? "normal" : "radius");
  fprintf(out, "</i></td><td class=\"words\">%s</td><td class=\"words\">", claim->equation);
  for (size_t i = 0; i < claim->parameters; i++) {
    const fg_scan_result_parameter *p = &claim->parameter[i];
    fg_scan_loop_value_words(p->told, p->u_told, words, sizeof words);
    fprintf(out, "%s<span class=\"nobreak\">%s = %s %s</span>", i ? "<br>" : "", p->symbol, words,
            p->unit);
  }
  fputs(claim->free ? "the curve itself</td></tr>\n" : "</td></tr>\n", out);
}

static void put_parameters(FILE *out, const fg_scan_result *result) {
  fputs("<div class=\"scroll\"><table><thead><tr><th>effect</th><th class=\"w\">equation</th>"
        "<th class=\"w\">parameters, ± U = 2u</th></tr></thead>\n",
        out);
  for (size_t i = 0; i < result->claims; i++)
    put_effect_details(out, &result->claim[i]);
  fputs(
      "</table></div>\n<p class=\"note\">x, y: of scale and shear from the middle of the picture, "
      "else from its top left. ψ: about O from the foil's middle.</p>\n",
      out);
}

void fg_scan_loop_page_effects(FILE *out, const fg_scan_result *result) {
  if (!result->claims) return;
  fputs("<section><h2 class=\"first\">What was found, drawn</h2>\n", out);
  put_parameters(out, result);
  fputs("<div class=\"two\">\n", out);
  fg_scan_loop_page_grid(out, result);
  for (size_t i = 0; i < result->lines; i++)
    put_curve_line(out, result, &result->line[i]);
  fputs("</div></section>\n", out);
}
