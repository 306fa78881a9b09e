/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects by their size: Pareto and half-normal. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/distribution.h"
#include "page/page.h"
#include "report/doe/axes.h"
#include "report/doe/plots.h"
#include "report/doe/words.h"

enum { BARS_SHOWN = 20 };

typedef struct bar {
  size_t column;
  double size;
} bar;

static int compare_bars(const void *a, const void *b) {
  const bar *x = a, *y = b;
  if (x->size != y->size) return x->size < y->size ? 1 : -1;
  return (x->column > y->column) - (x->column < y->column);
}

/* |t| where there is an error, else |contrast|. */
static size_t collect_bars(const fg_experiment *e, bar *bars) {
  bool has_error = e->regression.residual_dof > 0;
  size_t count = 0;
  for (size_t j = 0; j < e->regression.columns; j++) {
    double size = fabs(has_error ? e->effect[j].t : e->effect[j].contrast);
    if (fg_experiment_of_interest(e, j) && isfinite(size)) bars[count++] = (bar){j, size};
  }
  fg_sort_items(bars, count, sizeof *bars, compare_bars);
  return count;
}

static bool is_on(const fg_experiment *e, size_t column) {
  return fg_experiment_p_value(e, column) < 1 - e->confidence;
}

static void put_pareto(FILE *out, const fg_experiment *e, const bar *bars, size_t count) {
  bool has_error = e->regression.residual_dof > 0;
  size_t shown = count < BARS_SHOWN ? count : BARS_SHOWN;
  int height = 66 + 24 * (int)shown;
  double limit = has_error ? fg_distribution_t_quantile((1 + e->confidence) / 2,
                                                        (double)e->regression.residual_dof)
                           : e->lenth.margin;
  double longest = bars[0].size;
  if (!e->has_split_plot && limit > 0) longest = fmax(longest, limit);
  fputs("<figure><h3>Pareto of effects</h3>", out);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Pareto of effects", .width = FG_AXES_WIDTH, .height = height,
                            .left = 190, .right = 14, .top = 8, .x = (double[]){0, longest * 1.05},
                            .y = (double[]){0, 1},
                            .x_title = has_error ? "|t|" : "|effect|, coefficient of ±1"});
  for (size_t i = 0; i < shown; i++) {
    char name[64];
    snprintf(name, sizeof name, "%.60s", e->regression.coefficient[bars[i].column].name);
    double y = 10 + 24 * (double)i;
    fprintf(out,
            "<rect class=\"bar%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"17\"/><text "
            "class=\"y\" x=\"182\" y=\"%.1f\"%s>",
            is_on(e, bars[i].column) ? " on" : "", at.left, y,
            fg_plot_x(&at, bars[i].size) - at.left, y + 13,
            strlen(name) > 20 ? " textLength=\"178\" lengthAdjust=\"spacingAndGlyphs\"" : "");
    fg_html_text(out, name);
    fputs("</text>\n", out);
  }
  if (!e->has_split_plot && (has_error || e->has_lenth))
    fg_plot_segment(&at, limit, 0, limit, 1, "limit");
  fg_plot_end(&at);
  fprintf(out, "<figcaption>%s%s</figcaption></figure>\n",
          has_error ? "Orange: told from the scatter. "
                    : "Orange: told from the others by Lenth's method. ",
          e->has_split_plot ? "Each is judged by its own stratum." : "Red: the limit.");
}

/* Keeps, of the points by size, those of effects that cannot be told from noise. Returns their
 * number. */
static size_t keep_untold(const fg_experiment *e, const bar *bars, const fg_half_normal *points,
                          size_t count, fg_half_normal *small) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++)
    if (isfinite(fg_experiment_p_value(e, bars[points[i].effect].column)) &&
        !is_on(e, bars[points[i].effect].column))
      small[kept++] = points[i];
  return kept;
}

/* Factor by which Lenth (1989) trims effects before he estimates the error. */
static const double TRIM = 2.5;

/* Returns the slope of the line of small effects: magnitude = slope × quantile. Not small are
 * effects that are told from noise, by their own error or Lenth's, and those far right of a line
 * through the smaller half of the others. Small effects fill the lower quantiles among all
 * effects, so the line is fitted where they are plotted. Leaves the small ones in `small`; 0:
 * there are none, or all are 0. */
static double small_slope(fg_half_normal *small, size_t *count) {
  size_t half = (*count + 1) / 2, kept = 0;
  double products = 0, squares = 0, first = 0;
  for (size_t i = 0; i < half; i++)
    first = fmax(first, small[i].magnitude / small[i].quantile);
  for (size_t i = 0; i < *count; i++) {
    if (i >= half && small[i].magnitude > TRIM * first * small[i].quantile) break;
    products += small[i].magnitude * small[i].quantile;
    squares += small[i].quantile * small[i].quantile;
    kept++;
  }
  *count = kept;
  return squares > 0 ? products / squares : 0;
}

static fg_status put_half_normal(fg_context *ctx, FILE *out, const fg_experiment *e,
                                 const bar *bars, size_t count, fg_half_normal *points,
                                 double *contrast) {
  fg_half_normal *line = points + count;
  double x[2] = {0, 0}, y[2] = {0, 0};
  for (size_t i = 0; i < count; i++)
    contrast[i] = e->effect[bars[i].column].contrast;
  FG_TRY(fg_half_normal_points(ctx, contrast, count, points));
  for (size_t i = 0; i < count; i++) {
    fg_range_add(x, points[i].magnitude, 0);
    fg_range_add(y, points[i].quantile, 0);
  }
  fg_plot at = fg_axes_begin(out, &(fg_plot_frame){"Half-normal plot of effects", .x = x, .y = y,
                                                   .y_title = "half-normal quantile",
                                                   .x_title = "|effect|, coefficient of ±1"});
  size_t small = keep_untold(e, bars, points, count, line);
  double slope = small_slope(line, &small);
  if (slope > 0)
    fg_plot_segment(&at, 0, 0, fmin(x[1], slope * y[1]), fmin(x[1] / slope, y[1]), "hint");
  for (size_t i = 0; i < count; i++) {
    size_t column = bars[points[i].effect].column;
    fg_axes_dot(&at, is_on(e, column) ? "s1" : "s2", points[i].magnitude, points[i].quantile, 5);
    if (i + 4 >= count || is_on(e, column))
      fg_axes_text(&at, points[i].magnitude, points[i].quantile,
                   e->regression.coefficient[column].name);
  }
  fg_plot_end(&at);
  if (slope > 0)
    fprintf(out,
            "<figcaption>The dashed line belongs to the %zu small effect%s, which cannot be told "
            "from nothing; what matters lies to its right.</figcaption></figure>\n",
            small, small == 1 ? "" : "s");
  else
    fputs("<figcaption>No effect is small enough to draw the line of those that are "
          "nothing.</figcaption></figure>\n",
          out);
  return FG_OK;
}

fg_status fg_doe_plot_effects(fg_context *ctx, FILE *out, const fg_experiment *e) {
  fg_status status = FG_OK;
  size_t columns = e->regression.columns;
  bar *bars = NULL;
  fg_half_normal *points = NULL;
  double *contrast = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *bars, (void **)&bars));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * columns, sizeof *points, (void **)&points));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *contrast, (void **)&contrast));
  size_t count = collect_bars(e, bars);
  if (!count || !(bars[0].size > 0)) goto exit;
  put_pareto(out, e, bars, count);
  FG_TRY_EXIT(put_half_normal(ctx, out, e, bars, count, points, contrast));
exit:
  free(bars);
  free(points);
  free(contrast);
  return status;
}
