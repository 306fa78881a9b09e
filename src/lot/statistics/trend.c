/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trend of a quantity over the order of the foils: a tool wears, a coil hardens. The line is fitted
 * to the foils' values. Successive foils may resemble each other without a trend. So the slope's u
 * counts only n (1 - rho) / (1 + rho) of the n foils as independent (Bartlett 1935), with rho the
 * serial correlation of the residuals. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "foilgauge/distribution.h"
#include "lot/statistics/analysis.h"

/* Limits: fewer foils have a line by chance; a stronger correlation cannot be told from a trend. */
enum { FOILS_MIN = 6 };
static const double rho_max = 0.95;

/* value = mean + slope (i - middle) + residual. */
typedef struct line {
  double mean, slope, middle, squares; /* squares: of the places about their middle */
  double residual_ss, rho;
} line;

static double residual_at(const line *l, const fg_chart *chart, size_t i) {
  return chart->point[i].value - l->mean - l->slope * ((double)i - l->middle);
}

/* Returns the serial correlation, corrected for its bias beside a line, about -(2 + 4 r) / n. */
static double serial_correlation(const line *l, const fg_chart *chart) {
  double cross = 0, n = (double)chart->count;
  for (size_t i = 1; i < chart->count; i++)
    cross += residual_at(l, chart, i - 1) * residual_at(l, chart, i);
  double r = l->residual_ss > 0 ? cross / l->residual_ss : 0;
  return fmin(fmax(r + (2 + 4 * r) / n, 0), rho_max);
}

static line fit_trend(const fg_chart *chart) {
  double n = (double)chart->count, cross = 0;
  line l = {.middle = (n - 1) / 2, .squares = n * (n * n - 1) / 12};
  for (size_t i = 0; i < chart->count; i++) {
    l.mean += chart->point[i].value / n;
    cross += ((double)i - l.middle) * chart->point[i].value;
  }
  l.slope = cross / l.squares;
  for (size_t i = 0; i < chart->count; i++)
    l.residual_ss += pow(residual_at(&l, chart, i), 2);
  l.rho = serial_correlation(&l, chart);
  return l;
}

/* Counts the chart's signals without the line. */
static fg_status count_signals_left(fg_context *ctx, unsigned rules, const line *l,
                                    const fg_chart *chart, size_t *signals) {
  void *block;
  fg_chart flat;
  FG_TRY(fg_memory_allocate(ctx, chart->count, sizeof(double), &block));
  double *value = block;
  for (size_t i = 0; i < chart->count; i++)
    value[i] = l->mean + residual_at(l, chart, i);
  fg_status status = fg_chart_individuals(ctx, value, chart->count, rules, &flat);
  free(block);
  FG_TRY(status);
  *signals = flat.signals;
  fg_chart_free(&flat);
  return FG_OK;
}

fg_status fg_lot_find_trend(fg_context *ctx, unsigned rules, double level,
                            fg_lot_quantity *quantity) {
  const fg_chart *chart = &quantity->chart;
  quantity->trend = (fg_lot_trend){0};
  if (chart->count < FOILS_MIN) return FG_OK;
  line l = fit_trend(chart);
  double n = (double)chart->count, factor = (1 + l.rho) / (1 - l.rho);
  double dof = fmax(n / factor - 2, 1);
  double u = sqrt(l.residual_ss / (n - 2) / l.squares * factor);
  double p_value = u > 0 ? fg_distribution_t_two_sided(l.slope / u, dof) : l.slope != 0 ? 0 : 1;
  if (!(p_value < level)) return FG_OK;
  quantity->trend = (fg_lot_trend){.known = true,
                                   .per_foil = l.slope,
                                   .u_per_foil = u,
                                   .first_to_last = (double)(chart->count - 1) * l.slope,
                                   .dof = dof,
                                   .correlation = l.rho,
                                   .foils = chart->count,
                                   .p_value = p_value};
  return count_signals_left(ctx, rules, &l, chart, &quantity->trend.signals_left);
}
