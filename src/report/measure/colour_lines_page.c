/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channels of a colour scan against each other, on a page. */
#include <math.h>

#include "foilgauge/words.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "report/measure/colour_lines_report.h"

/* Windows without edges from which on a line has a gap. */
#define GAP_WINDOWS 4

/* Styles of the two channels. They are not drawn in their own colours, which the colour-blind
 * could not tell apart. */
static const char *const line_style[2] = {"s1", "s2"};
static const char *const uncertainty_style[2] = {"s1 uncertain", "s2 uncertain"};

static void put_channel_value(FILE *out, double value, double u, int decimals) {
  fprintf(out, "<td>%+.*f ± %.*f</td>", decimals, value, decimals, FG_COVERAGE_FACTOR * u);
}

static const char *without_values(fg_colour_state state) {
  switch (state) {
  case FG_COLOUR_IDENTICAL:
    return "the same picture: a gray one saved as RGB";
  case FG_COLOUR_NO_CONTRAST:
    return "shows no edges";
  case FG_COLOUR_FEW_EDGES:
    return "shows too few edges to tell";
  case FG_COLOUR_MEASURED:
    break;
  }
  return "";
}

static void put_channel_row(FILE *out, const fg_measurement *m, const fg_colour_shift *shift) {
  fprintf(out, "<tr><td>%s</td>", fg_channel_word(shift->channel));
  if (shift->state != FG_COLOUR_MEASURED) {
    fprintf(out, "<td colspan=\"8\">%s</td></tr>\n", without_values(shift->state));
    return;
  }
  put_channel_value(out, shift->dx_px, shift->u_dx_px, 3);
  put_channel_value(out, shift->dy_px, shift->u_dy_px, 3);
  put_channel_value(out, shift->dx_px * 25400 / m->dpi[0], shift->u_dx_px * 25400 / m->dpi[0], 2);
  put_channel_value(out, shift->dy_px * 25400 / m->dpi[1], shift->u_dy_px * 25400 / m->dpi[1], 2);
  put_channel_value(out, shift->magnification_ppm, shift->u_magnification_ppm, 1);
  put_channel_value(out, shift->skew_ppm, shift->u_skew_ppm, 1);
  fprintf(out, "<td>%.2g</td><td>%.2g</td></tr>\n", shift->drift_rms_um, shift->p_constant);
}

static void put_channel_table(FILE *out, const fg_measurement *m) {
  fputs("<div class=\"scroll\"><table>\n<thead><tr><th>channel</th><th>dx, px</th><th>dy, px</th>"
        "<th>dx, µm</th><th>dy, µm</th><th>magnified, ppm</th><th>skew, ppm</th>"
        "<th>uneven, µm rms</th><th>p</th></tr></thead>\n<tbody>\n",
        out);
  for (int k = 0; k < 2; k++)
    put_channel_row(out, m, &m->colour_lines.shifts[k]);
  fputs("</tbody></table></div>\n", out);
}

/* About the mean of each, so that both fit one plot. */
static double level_of(const fg_measurement *m, const fg_colour_shift *shift) {
  return shift->dy_px * 25400 / m->dpi[1];
}

static bool find_ranges(const fg_measurement *m, double x[2], double y[2]) {
  x[0] = y[0] = INFINITY;
  x[1] = y[1] = -INFINITY;
  for (int k = 0; k < 2; k++) {
    const fg_colour_shift *shift = &m->colour_lines.shifts[k];
    for (size_t i = 0; i < shift->window_count; i++) {
      const fg_colour_window *w = &shift->windows[i];
      fg_range_add(x, (double)w->y_mm, 0);
      fg_range_add(y, (double)w->smooth_um - level_of(m, shift),
                   FG_COVERAGE_FACTOR * (double)w->u_smooth_um);
    }
  }
  fg_range_pad(y, 0.15, 0.05);
  return x[1] > x[0];
}

/* Draws a line, with gaps where there are no edges. */
static void put_channel_line(const fg_plot *at, const fg_colour_shift *shift, const double *x,
                             const double *y, const char *style) {
  size_t first = 0;
  for (size_t i = 1; i <= shift->window_count; i++) {
    if (i < shift->window_count && x[i] - x[i - 1] < GAP_WINDOWS * shift->window_mm) continue;
    fg_plot_line(at, x + first, y + first, i - first, style);
    first = i;
  }
}

static void put_shift_profile(const fg_plot *at, const fg_measurement *m, int k) {
  const fg_colour_shift *shift = &m->colour_lines.shifts[k];
  double x[FG_COLOUR_WINDOWS_MAX], y[3][FG_COLOUR_WINDOWS_MAX];
  char words[80];
  if (!shift->window_count) return;
  for (size_t i = 0; i < shift->window_count; i++) {
    const fg_colour_window *w = &shift->windows[i];
    x[i] = (double)w->y_mm;
    for (int side = -1; side <= 1; side++)
      y[side + 1][i] = (double)w->smooth_um - level_of(m, shift) +
                       side * FG_COVERAGE_FACTOR * (double)w->u_smooth_um;
    double dot = (double)w->dy_um - level_of(m, shift);
    if (dot > at->y_low && dot < at->y_high) fg_plot_dot(at, x[i], dot, 2, line_style[k]);
  }
  for (int side = 0; side < 3; side++)
    put_channel_line(at, shift, x, y[side], side == 1 ? line_style[k] : uncertainty_style[k]);
  snprintf(words, sizeof words, "%s, about %+.2f µm", fg_channel_word(shift->channel),
           level_of(m, shift));
  fg_plot_key(at, 80 + 330 * k, line_style[k], words);
}

static void put_plot(FILE *out, const fg_measurement *m) {
  double x[2], y[2];
  if (!find_ranges(m, x, y)) return;
  fputs("<figure>", out);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Course of dy along y", .height = 280, .left = 70, .top = 34, .x = x,
                            .y = y, .y_title = "dy about its mean, µm",
                            .x_title = "y of the scan, mm (the carriage's way)"});
  for (int k = 0; k < 2; k++)
    put_shift_profile(&at, m, k);
  fg_plot_end(&at);
  fputs("</figure>\n", out);
}

static const char *describe_profile(const fg_colour_lines *lines) {
  bool uneven = false;
  for (int k = 0; k < 2; k++)
    uneven = uneven || lines->shifts[k].p_constant < FG_COLOUR_UNEVEN_P;
  return uneven ? "It is not constant: the carriage was uneven."
                : "Nothing says that it is not constant.";
}

void fg_html_colour_lines(FILE *out, const fg_measurement *m) {
  const fg_colour_lines *lines = &m->colour_lines;
  if (!lines->seen) return;
  fputs("<h2>Colour lines</h2>\n", out);
  if (lines->apart)
    fprintf(
        out,
        "<p class=\"next\"><b>The channels lie apart</b> by more than %.1f px: %s was measured. "
        "Measure one channel; do not average channels or convert the scan to gray.</p>\n",
        FG_COLOUR_APART_PX, fg_channel_word(m->file.channel));
  fprintf(
      out,
      "<p class=\"note\">Where each channel shows the edges, minus where %s does (x right, y "
      "down). The sensor's lines see an edge at different moments, so the course of dy along y "
      "is what the carriage's error differs by over the lines' gap, without anything that "
      "optics, part or edges do. Magnified: "
      "along x, by the colour of the optics; skew: dy over x, of a line that is turned. %s</p>\n",
      fg_channel_word(lines->against), describe_profile(lines));
  put_channel_table(out, m);
  put_plot(out, m);
}
