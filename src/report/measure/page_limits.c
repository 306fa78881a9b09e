/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every toleranced quantity of the bumps, or beams, over their numbers, with its limits. */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "core/utf8.h"
#include "page/plot_frame.h"
#include "report/measure/foil_parts.h"
#include "report/measure/page_tables.h"

/* Values farther beyond their limits than this share of the limits' distance are drawn at the
 * plot's edge, with their number: one crushed bump must not flatten the others. */
static const double shown_beyond = 1.5;
/* Margin around the drawn range, as a share of it. */
static const double margin_share = 0.12;

typedef struct panel {
  fg_plot at;
  const fg_design *design;
  const fg_foil *foil;
  const fg_foil_parts *parts;
  const fg_quantity *row;
  const fg_tolerance *limit;
} panel;

/* Returns the width between the limits. For a single limit it is twice the median distance of
 * the values from it, which a few damaged bumps do not move. */
static double width_of(const panel *p) {
  double low = p->limit->lower, high = p->limit->upper, width = high - low;
  if (isfinite(width) && width > 0) return width;
  double *distance = calloc(p->parts->count, sizeof *distance);
  size_t count = 0;
  for (size_t i = 0; distance && i < p->parts->count; i++) {
    double value = fg_quantity_value(p->row, fg_foil_part_at(p->parts, i));
    double inside = fg_margin_to(low, high, value).inside;
    if (isfinite(inside)) distance[count++] = fabs(inside);
  }
  width = count ? 2 * fg_select(distance, count, count / 2) : 0;
  free(distance);
  return width > 0 ? width : fmax(fabs(isfinite(low) ? low : high), 1);
}

/* All that does not fail is drawn where it lies, however far it is from its limit. */
static void find_limit_range(const panel *p, double range[2]) {
  double low = p->limit->lower, high = p->limit->upper, reach = shown_beyond * width_of(p);
  double from = isfinite(low) ? low : high, to = isfinite(high) ? high : low;
  const double max[2] = {from - reach, to + reach};
  for (size_t i = 0; i < p->parts->count; i++) {
    double value = fg_quantity_value(p->row, fg_foil_part_at(p->parts, i));
    double u = fg_quantity_uncertainty(p->row, fg_foil_part_at(p->parts, i));
    double expanded = isfinite(u) ? FG_COVERAGE_FACTOR * u : 0;
    if (!isfinite(value)) continue;
    bool fails = fg_judge_measured(p->design, p->limit, p->row, value, u) == FG_VERDICT_FAIL;
    from = fmin(from, fmin(fails ? INFINITY : value, fmax(max[0], value - expanded)));
    to = fmax(to, fmax(fails ? -INFINITY : value, fmin(max[1], value + expanded)));
  }
  range[0] = from;
  range[1] = to;
  fg_range_pad(range, margin_share, to > from ? 0 : margin_share * fmax(fabs(to), 1e-9));
}

size_t fg_html_limit_labels(const fg_tolerance *limit, const char *words, fg_plot_label labels[2]) {
  size_t count = 0;
  if (isfinite(limit->lower)) labels[count++].y = limit->lower;
  if (isfinite(limit->upper)) labels[count++].y = limit->upper;
  for (size_t i = 0; i < count; i++) {
    bool upper = labels[i].y == limit->upper;
    labels[i].style = "told";
    snprintf(labels[i].text, sizeof labels[i].text, "%s %s%.7g%s", upper ? "max" : "min",
             labels[i].y < 0 ? "−" : "", fabs(labels[i].y), words);
  }
  return count;
}

double fg_html_limit_room(const fg_plot_label *labels, size_t count) {
  const double letter_px = 10.5, gap_px = 8;
  size_t longest = 0;
  for (size_t i = 0; i < count; i++) {
    size_t letters = fg_utf8_count(labels[i].text);
    if (letters > longest) longest = letters;
  }
  return longest ? letter_px * (double)longest + gap_px : 0;
}

void fg_html_limit_lines(const fg_plot *at, fg_plot_label *labels, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double y = fg_plot_y(at, labels[i].y);
    fprintf(at->out, "<path class=\"limits-of\" d=\"M%.1f %.1fH%.1f\"/>\n", at->left, y, at->right);
  }
  fg_plot_labels(at, labels, count, FG_PLOT_LABEL_GAP_PX);
}

/* Writes a cross over values that fail, a question mark over undecided ones: the sign goes with
 * the colour. */
static void put_verdict(const panel *p, fg_verdict verdict, double x, double y) {
  if (verdict == FG_VERDICT_FAIL)
    fprintf(p->at.out, "<path class=\"beyond-limit\" d=\"M%.1f %.1fl16 16m0 -16l-16 16\"/>\n",
            x - 8, y - 8);
  else if (verdict == FG_VERDICT_UNDECIDED)
    fprintf(p->at.out, "<text class=\"told open\" x=\"%.1f\" y=\"%.1f\">?</text>\n", x + 8, y + 5);
}

/* Draws an arrow at the plot's edge and the value below it, upright: columns are as narrow as a
 * letter is high. */
static void put_beyond(const panel *p, double x, double value) {
  const double arrow_px = 24, half_letter_px = 5;
  bool above = value > p->at.y_high;
  double y = above ? p->at.top : p->at.bottom, away = above ? 1 : -1;
  fprintf(p->at.out,
          "<path class=\"beyond-limit\" d=\"M%.1f %.1fl0 %.1fM%.1f %.1fl-6 %.1fm6 %.1fl6 %.1f\"/>"
          "<text class=\"told\" style=\"text-anchor:%s\" transform=\"translate(%.1f %.1f) "
          "rotate(-90)\">%s%.*f</text>\n",
          x, y + 20 * away, -18 * away, x, y + 2 * away, 7 * away, -7 * away, 7 * away,
          above ? "end" : "start", x + half_letter_px, y + arrow_px * away, value < 0 ? "−" : "",
          p->row->decimals, fabs(value));
}

/* A part without a value: why, upright in its column. */
static void put_missing_value(const panel *p, int number, const char *why) {
  fprintf(p->at.out,
          "<text class=\"x told\" transform=\"translate(%.1f %.1f) rotate(-90)\">%s</text>\n",
          fg_plot_x(&p->at, number) + 5, (p->at.top + p->at.bottom) / 2, why);
}

static void put_limit_value(const panel *p, size_t i) {
  const void *part = fg_foil_part_at(p->parts, i);
  int number = fg_foil_part_number(p->parts, i);
  double value = fg_quantity_value(p->row, part), u = fg_quantity_uncertainty(p->row, part);
  double x = fg_plot_x(&p->at, number);
  if (!isfinite(value)) {
    put_missing_value(p, number, fg_foil_part_lack(p->parts, i));
    return;
  }
  if (value > p->at.y_high || value < p->at.y_low) {
    put_beyond(p, x, value);
    return;
  }
  double expanded = isfinite(u) ? FG_COVERAGE_FACTOR * u : 0, y = fg_plot_y(&p->at, value);
  fprintf(p->at.out,
          "<path class=\"s2\" d=\"M%.1f %.1fV%.1f\"/><circle class=\"s2\" cx=\"%.1f\" cy=\"%.1f\" "
          "r=\"4.5\"/>\n",
          x, fg_plot_y(&p->at, fmax(p->at.y_low, value - expanded)),
          fg_plot_y(&p->at, fmin(p->at.y_high, value + expanded)), x, y);
  put_verdict(p, fg_judge_measured(p->design, p->limit, p->row, value, u), x, y);
}

static void put_panel(FILE *out, const fg_design *design, const fg_foil *foil,
                      const fg_tolerance *limit, const fg_quantity *row) {
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  int last = fg_foil_parts_last(&parts);
  panel p = {.design = design, .foil = foil, .parts = &parts, .row = row, .limit = limit};
  fg_plot_label labels[2];
  char title[160];
  double range[2];
  size_t count = fg_html_limit_labels(limit, "", labels);
  find_limit_range(&p, range);
  snprintf(title, sizeof title, "%s, %s", row->symbol, row->unit);
  fputs("<figure><h3>", out);
  fg_html_text(out, row->words);
  fputs("</h3>", out);
  p.at = fg_plot_frame_begin(
      out, &(fg_plot_frame){
               row->words, .width = 500, .height = 258, .left = 70,
               .right = 10 + fg_html_limit_room(labels, count), .bottom = 48,
               .x = (double[]){0.4, last + 0.6}, .y = range,
               .y_title = row->unit[0] ? title : row->symbol, .ticks = FG_TICKS_OWN,
               .band = (double[]){fmax(range[0], limit->lower), fmin(range[1], limit->upper)},
               .band_style = "inside"});
  fg_html_limit_lines(&p.at, labels, count);
  for (int number = 1; number <= last; number++) {
    fg_plot_x_number(&p.at, number);
    if (!fg_foil_parts_have(&parts, number) && !(foil->flags & FG_FOIL_TOUCHES_BORDER))
      put_missing_value(&p, number, "missing");
  }
  fg_plot_x_title(&p.at, parts.name);
  for (size_t i = 0; i < parts.count; i++)
    put_limit_value(&p, i);
  fputs("</svg></figure>\n", out);
}

void fg_html_limits(FILE *out, const fg_design *design, const fg_foil *foil) {
  bool opened = false;
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  if (!parts.count) return;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *limit = &design->tolerances[i];
    const fg_quantity *row = fg_quantity_find(parts.owner, limit->quantity);
    if (!row || row->kind == FG_QUANTITY_PAIR) continue;
    if (!opened)
      fprintf(
          out,
          "<h2>Every %s against its limits</h2>\n<p class=\"note\">Green: inside the limits. A "
          "cross fails, a question mark cannot be told, an arrow lies farther out than the plot "
          "reaches. Bars: ±.</p>\n<div class=\"panels\">\n",
          parts.name);
    opened = true;
    put_panel(out, design, foil, limit, row);
  }
  if (opened) fputs("</div>\n", out);
}
