/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residual against each coordinate, before and after. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "page/plot_frame.h"
#include "report/scan_loop/parts.h"

enum { POINTS_MAX = 1300, BINS = 150, ROWS_IN_BIN = 8, COLOURS = 4 };

/* A plot's data: rows over one coordinate, before or after. */
typedef struct series {
  const fg_scan_result *result;
  fg_scan_coordinate coordinate;
  bool after;
} series;

/* Colour class of a scan's marks: "k0" to "k3", "k4" from the fifth on. */
static const char *colour(size_t scan) {
  static const char *const names[] = {"k0", "k1", "k2", "k3", "k4"};
  return names[scan < COLOURS ? scan : COLOURS];
}

static bool point_at(const series *s, size_t i, double *x, double *y) {
  const fg_scan_result_row *row = &s->result->row[i];
  *y = row->residual_um[s->after];
  *x = row->place[s->coordinate];
  return row->weight > 0 && isfinite(*y) && isfinite(*x);
}

static size_t scan_of(const series *s, size_t i) {
  return s->result->row[i].scan;
}

/* Drawn pale, and not in the mean. */
static bool is_light(const series *s, size_t i) {
  return s->result->row[i].weight <= s->result->light_weight;
}

static void put_points(const fg_plot *at, const series *s, size_t scan, bool light) {
  size_t rows = s->result->rows, stride = 1 + rows / POINTS_MAX;
  bool held_out = s->result->scan[scan].hold_out;
  fprintf(at->out, "<path class=\"%s %s\" d=\"", held_out ? "held-out" : "dots",
          light ? "pale" : colour(scan));
  for (size_t i = 0; i < rows; i += stride) {
    double x, y;
    if (scan_of(s, i) != scan || is_light(s, i) != light || !point_at(s, i, &x, &y)) continue;
    fprintf(at->out, held_out ? "M%.1f %.1fm-2-2l4 4m0-4l-4 4" : "M%.1f %.1fh0", fg_plot_x(at, x),
            fg_plot_y(at, fg_plot_inside(at, y)));
  }
  fputs("\"/>\n", at->out);
}

/* Draws the mean of all rows in each bin, as a guide to the eye. */
static void put_bin_means(const fg_plot *at, const series *s, size_t scan) {
  double sum[BINS] = {0}, n[BINS] = {0}, x, y, place[BINS];
  size_t rows = s->result->rows, count = 0;
  for (size_t i = 0; i < rows; i++)
    count += scan_of(s, i) == scan && !is_light(s, i) && point_at(s, i, &x, &y);
  size_t bins = count / ROWS_IN_BIN < BINS ? count / ROWS_IN_BIN : BINS;
  if (bins < 4) return;
  for (size_t i = 0; i < rows; i++) {
    if (scan_of(s, i) != scan || is_light(s, i) || !point_at(s, i, &x, &y)) continue;
    double share = (x - at->x_low) / (at->x_high - at->x_low);
    size_t bin = (size_t)fmin((double)bins - 1, share * (double)bins);
    sum[bin] += y;
    n[bin]++;
  }
  for (size_t b = 0; b < bins; b++) {
    place[b] = at->x_low + ((double)b + 0.5) / (double)bins * (at->x_high - at->x_low);
    sum[b] = n[b] >= 2 ? fg_plot_inside(at, sum[b] / n[b]) : NAN;
  }
  char style[16];
  snprintf(style, sizeof style, "mean %s", colour(scan));
  fg_plot_line(at, place, sum, bins, style);
}

static void put_noise_band(const fg_plot *at, double noise_um) {
  double top = fmin(2 * noise_um, at->y_high);
  fprintf(at->out, "<rect class=\"noise\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
          at->left, fg_plot_y(at, top), at->right - at->left,
          fmax(1, fg_plot_y(at, -top) - fg_plot_y(at, top)));
}

static void put_residual_plot(FILE *out, const series *s, const double range[2], double limit_um,
                              const char *caption) {
  fprintf(out, "<figure><figcaption><b>%s</b></figcaption>", caption);
  fg_plot at = fg_plot_open(
      out,
      &(fg_plot_frame){caption, .width = 520, .height = 264, .left = 70, .right = 10, .top = 12,
                       .x = range, .y = (double[]){-limit_um, limit_um}, .y_title = "residual, µm",
                       .x_title = s->result->coordinate_title[s->coordinate]});
  put_noise_band(&at, s->result->noise_floor_um);
  fg_plot_axes(&at);
  for (size_t scan = 0; scan < s->result->scans; scan++)
    for (int light = 1; light >= 0; light--)
      put_points(&at, s, scan, light);
  for (size_t scan = 0; scan < s->result->scans && scan < COLOURS; scan++)
    put_bin_means(&at, s, scan);
  fg_plot_end(&at);
  fputs("</figure>\n", out);
}

static bool find_abscissa_range(const series *s, double range[2]) {
  double x, y;
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (size_t i = 0; i < s->result->rows; i++)
    if (point_at(s, i, &x, &y)) fg_range_add(range, x, 0);
  return range[1] > range[0];
}

/* Pairs of before and after; without a correction one plot each. */
static void put_all(FILE *out, const fg_scan_result *result, const double limit_um[2]) {
  fputs("<div class=\"two\">\n", out);
  for (int c = 0; c < FG_SCAN_COORDINATES; c++) {
    series s = {result, (fg_scan_coordinate)c, false};
    double range[2];
    if (!find_abscissa_range(&s, range)) continue;
    put_residual_plot(out, &s, range, limit_um[0], result->corrected ? "Before" : "As measured");
    s.after = true;
    if (result->corrected)
      put_residual_plot(out, &s, range, limit_um[0], "After, to the same scale");
  }
  fputs("</div>\n", out);
}

/* Draws the residual after correction enlarged: on the scale of the one before it is often a line,
 * and does not show whether it is noise. */
static void put_enlarged(FILE *out, const fg_scan_result *result, const double limit_um[2]) {
  static const double worth = 3;
  char caption[80];
  if (!result->corrected || limit_um[0] < worth * limit_um[1]) return;
  snprintf(caption, sizeof caption, "After, enlarged %.3g times", limit_um[0] / limit_um[1]);
  fprintf(out,
          "<details open><summary>What is left, enlarged %.3g times: is it noise?</summary><div "
          "class=\"two\">\n",
          limit_um[0] / limit_um[1]);
  for (int c = 0; c < FG_SCAN_COORDINATES; c++) {
    series s = {result, (fg_scan_coordinate)c, true};
    double range[2];
    if (find_abscissa_range(&s, range)) put_residual_plot(out, &s, range, limit_um[1], caption);
  }
  fputs("</div></details>\n", out);
}

static bool has_light(const fg_scan_result *result) {
  for (size_t i = 0; i < result->rows; i++)
    if (result->row[i].weight > 0 && result->row[i].weight <= result->light_weight) return true;
  return false;
}

static void put_scan_keys(FILE *out, const fg_scan_result *result) {
  fputs(" Scans:", out);
  for (size_t i = 0; i < result->scans && i <= COLOURS; i++) {
    fprintf(out, " <span class=\"key %s\">", colour(i));
    if (i == COLOURS)
      fputs("others", out);
    else
      fg_html_text(out, result->scan[i].before->scan);
    fputs(result->scan[i].hold_out && i < COLOURS ? " (crosses: kept aside)</span>" : "</span>",
          out);
  }
  fputs(".", out);
}

static void put_plot_key(FILE *out, const fg_scan_result *result) {
  fputs("<p class=\"note\">Dots: edge rows (thinned). Line: their mean. Grey band: two sd of the "
        "noise of one row.",
        out);
  if (has_light(result))
    fputs(" Pale: rows that hardly weigh, at the frame where they lie beyond it.", out);
  if (result->scans > 1) put_scan_keys(out, result);
  fputs("</p>\n", out);
}

/* Residuals larger than all but this share of them lie at the frame. */
#define BEYOND_SHARE 0.003

fg_status fg_scan_loop_page_residuals(fg_context *ctx, FILE *out, const fg_scan_result *result) {
  double limit[2];
  FG_TRY(fg_scan_loop_residual_limit(ctx, result, false, BEYOND_SHARE, &limit[0]));
  FG_TRY(fg_scan_loop_residual_limit(ctx, result, true, BEYOND_SHARE, &limit[1]));
  for (int i = 0; i < 2; i++)
    limit[i] = fmax(1.15 * limit[i], 3 * result->noise_floor_um);
  if (!(limit[0] > 0)) return FG_OK;
  fputs("<section><h2 class=\"first\">Residual against each coordinate</h2>\n", out);
  put_plot_key(out, result);
  put_all(out, result, limit);
  put_enlarged(out, result, limit);
  fputs("</section>\n", out);
  return FG_OK;
}
