/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Means, interactions and profiles: the response over the factors. */
#include "report/doe/plots.h"

#include <math.h>
#include <string.h>

#include "page/page.h"
#include "report/doe/axes.h"
#include "report/doe/words.h"
#include "report/unit_words.h"

enum { LEVELS_SHOWN = 12, PAIRS_SHOWN = 6 };

static void put_x_title(const fg_plot *at, const char *name) {
  char words[300];
  fg_axis_words(name, words, sizeof words);
  fg_plot_x_title(at, words);
}

/* Titles the axis with the statistic and its unit; the response's name is at the head of the
 * page. */
static void put_y_axis(const fg_plot *at, const fg_experiment *e, const char *what) {
  const char *unit = fg_unit_of_name(e->response);
  char words[80];
  snprintf(words, sizeof words, "%s%s%s", what, *unit ? ", " : "", unit);
  fg_plot_y_axis(at, words);
}

static double response_at(const fg_experiment *e, size_t run) {
  return e->regression.fitted[run] + e->regression.residual[run];
}

/* Mean response at every value of a variable. */
typedef struct level_means {
  double value[LEVELS_SHOWN], mean[LEVELS_SHOWN];
  size_t runs[LEVELS_SHOWN], count;
  bool too_many;
} level_means;

static void find_level_means(const fg_experiment *e, size_t variable, level_means *m) {
  size_t variables = e->model.formula.variables;
  *m = (level_means){0};
  for (size_t i = 0; i < e->regression.rows; i++) {
    double x = e->setting[i * variables + variable];
    size_t k = 0;
    while (k < m->count && fabs(m->value[k] - x) > 1e-9)
      k++;
    if (k == LEVELS_SHOWN) {
      m->too_many = true;
      return;
    }
    if (k == m->count) m->value[m->count++] = x;
    m->runs[k]++;
    m->mean[k] += (response_at(e, i) - m->mean[k]) / (double)m->runs[k];
  }
}

static void sort_means(level_means *m) {
  for (size_t i = 1; i < m->count; i++)
    for (size_t k = i; k > 0 && m->value[k] < m->value[k - 1]; k--) {
      double value = m->value[k], mean = m->mean[k];
      m->value[k] = m->value[k - 1];
      m->mean[k] = m->mean[k - 1];
      m->value[k - 1] = value;
      m->mean[k - 1] = mean;
    }
}

static const fg_factor *factor_of_variable(const fg_experiment *e, size_t variable) {
  for (size_t f = 0; f < e->factors; f++)
    if (!strcmp(e->factor[f].name, e->model.formula.variable[variable].column))
      return &e->factor[f];
  return NULL;
}

static void put_means(FILE *out, const fg_experiment *e, size_t variable, const level_means *m,
                      const double y[2]) {
  const fg_levels *levels = &e->model.levels[variable];
  const fg_factor *factor = levels->count ? NULL : factor_of_variable(e, variable);
  const char *name = e->model.formula.variable[variable].column;
  double x[2] = {INFINITY, -INFINITY}, real[LEVELS_SHOWN];
  for (size_t k = 0; k < m->count; k++) {
    real[k] = factor ? fg_factor_real(factor, m->value[k]) : m->value[k];
    fg_range_add(x, real[k], 0);
  }
  char title[300];
  fg_name_words(name, title, sizeof title);
  fg_plot at = fg_axes_begin(out, &(fg_plot_frame){title, .x = x, .y = y, .ticks = FG_TICKS_OWN});
  put_y_axis(&at, e, "mean");
  for (size_t k = 0; k < m->count && levels->count; k++)
    fg_plot_x_label(&at, fg_plot_x(&at, real[k]), levels->name[(size_t)m->value[k]]);
  if (!levels->count) fg_plot_x_numbers(&at);
  put_x_title(&at, name);
  for (size_t k = 0; k + 1 < m->count; k++)
    fg_plot_segment(&at, real[k], m->mean[k], real[k + 1], m->mean[k + 1], "s1");
  for (size_t k = 0; k < m->count; k++)
    fg_axes_dot(&at, "s1", real[k], m->mean[k], 5);
  fg_axes_end(&at);
}

void fg_doe_plot_main_effects(FILE *out, const fg_experiment *e) {
  double y[2] = {INFINITY, -INFINITY};
  level_means m;
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    find_level_means(e, v, &m);
    for (size_t k = 0; !m.too_many && k < m.count; k++)
      fg_range_add(y, m.mean[k], 0);
  }
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    find_level_means(e, v, &m);
    sort_means(&m);
    if (!m.too_many) put_means(out, e, v, &m, y);
  }
}

/* Everything in the middle of the data; words at the optimum's level. */
static void middle_setting(const fg_experiment *e, double *setting) {
  memcpy(setting, e->best.levels, e->model.formula.variables * sizeof *setting);
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    const fg_factor *f = e->model.levels[v].count ? NULL : factor_of_variable(e, v);
    if (f) setting[v] = (f->lowest + f->highest) / 2;
  }
}

/* A variable and every other variable of the same column (log(t) beside t). */
static void set_column(const fg_experiment *e, const fg_factor *f, double x, double *setting) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (!strcmp(e->model.formula.variable[v].column, f->name)) setting[v] = x;
}

enum { CURVE = 24 };

/* The model along a, b held low (0) and high (1). */
static fg_status sample_pair(fg_context *ctx, const fg_experiment *e, const fg_factor *a,
                             const fg_factor *b, double y[2][CURVE + 1]) {
  double setting[FG_FORMULA_VARIABLES];
  middle_setting(e, setting);
  for (int side = 0; side < 2; side++)
    for (int i = 0; i <= CURVE; i++) {
      fg_prediction p;
      set_column(e, a, a->lowest + (a->highest - a->lowest) * i / CURVE, setting);
      set_column(e, b, side ? b->highest : b->lowest, setting);
      FG_TRY(fg_experiment_predict(ctx, e, setting, &p));
      y[side][i] = p.mean;
    }
  return FG_OK;
}

static fg_status put_pair(fg_context *ctx, FILE *out, const fg_experiment *e, const fg_factor *a,
                          const fg_factor *b) {
  double y[2][CURVE + 1], place[CURVE + 1], range[2] = {INFINITY, -INFINITY};
  double x[2] = {fg_factor_real(a, a->lowest), fg_factor_real(a, a->highest)};
  char title[600], text[600], name[300], other[300];
  FG_TRY(sample_pair(ctx, e, a, b, y));
  for (int i = 0; i <= CURVE; i++) {
    place[i] = x[0] + (x[1] - x[0]) * i / CURVE;
    fg_range_add(range, y[0][i], 0);
    fg_range_add(range, y[1][i], 0);
  }
  fg_name_words(a->name, name, sizeof name);
  fg_name_words(b->name, other, sizeof other);
  snprintf(title, sizeof title, "%.250s × %.250s", name, other);
  /* The legend stands above. */
  fg_plot at = fg_axes_begin(
      out, &(fg_plot_frame){title, .top = 48, .x = x, .y = range, .ticks = FG_TICKS_OWN});
  put_y_axis(&at, e, "model");
  fg_plot_x_numbers(&at);
  put_x_title(&at, a->name);
  for (int side = 0; side < 2; side++) {
    fg_plot_line(&at, place, y[side], CURVE + 1, side ? "s2" : "s1");
    fg_axes_dot(&at, side ? "s2" : "s1", x[0], y[side][0], 5);
    fg_axes_dot(&at, side ? "s2" : "s1", x[1], y[side][CURVE], 5);
    char value[80];
    fg_value_with_unit(b->name, fg_factor_real(b, side ? b->highest : b->lowest), 5, value,
                       sizeof value);
    snprintf(text, sizeof text, "%.250s %s", other, value);
    fprintf(out,
            "<circle class=\"%s\" cx=\"%d\" cy=\"%d\" r=\"5\"/><text class=\"start\" x=\"%d\" "
            "y=\"%d\">",
            side ? "s2" : "s1", 84, 12 + 20 * side, 96, 17 + 20 * side);
    fg_html_text(out, text);
    fputs("</text>\n", out);
  }
  fg_axes_end(&at);
  return FG_OK;
}

fg_status fg_doe_plot_interactions(fg_context *ctx, FILE *out, const fg_experiment *e) {
  size_t shown = 0;
  for (size_t a = 0; a < e->factors; a++)
    for (size_t b = a + 1; b < e->factors && shown < PAIRS_SHOWN; b++, shown++)
      FG_TRY(put_pair(ctx, out, e, &e->factor[a], &e->factor[b]));
  return FG_OK;
}

/* The mean with its interval along one factor, the others in the middle. */
static fg_status put_profile(fg_context *ctx, FILE *out, const fg_experiment *e,
                             const fg_factor *f) {
  fg_prediction p;
  double place[2 * CURVE + 1], mean[2 * CURVE + 1], low[2 * CURVE + 1], high[2 * CURVE + 1];
  double setting[FG_FORMULA_VARIABLES], y[2] = {INFINITY, -INFINITY};
  double x[2] = {fg_factor_real(f, f->lowest), fg_factor_real(f, f->highest)};
  size_t variables = e->model.formula.variables,
         step = e->regression.rows / FG_DOE_POINTS_SHOWN + 1;
  char title[400], name[300];
  middle_setting(e, setting);
  for (int i = 0; i <= 2 * CURVE; i++) {
    set_column(e, f, f->lowest + (f->highest - f->lowest) * i / (2 * CURVE), setting);
    FG_TRY(fg_experiment_predict(ctx, e, setting, &p));
    place[i] = x[0] + (x[1] - x[0]) * i / (2 * CURVE);
    mean[i] = p.mean;
    low[i] = p.low;
    high[i] = p.high;
    fg_range_add(y, mean[i], 0);
  }
  for (size_t i = 0; i < e->regression.rows; i++)
    fg_range_add(y, response_at(e, i), 0);
  double lowest = y[0] - (y[1] - y[0]), highest = y[1] + (y[1] - y[0]);
  for (int i = 0; i <= 2 * CURVE && isfinite(low[0]); i++) { /* the curve must not look flat */
    fg_range_add(y, fmax(low[i], lowest), 0);
    fg_range_add(y, fmin(high[i], highest), 0);
  }
  fg_name_words(f->name, name, sizeof name);
  snprintf(title, sizeof title, "Response along %.300s", name);
  fg_plot at = fg_axes_begin(out, &(fg_plot_frame){title, .x = x, .y = y, .ticks = FG_TICKS_OWN});
  put_y_axis(&at, e, "response");
  fg_plot_x_numbers(&at);
  put_x_title(&at, f->name);
  if (isfinite(low[0])) fg_plot_ribbon(&at, place, low, high, 2 * CURVE + 1, "ci", "fill:#1f6fd0");
  fg_plot_line(&at, place, mean, 2 * CURVE + 1, "s2");
  for (size_t i = 0; i < e->regression.rows; i += step)
    fg_axes_dot(&at, "run", fg_factor_real(f, e->setting[i * variables + f->variable]),
                response_at(e, i), 4);
  fg_axes_end(&at);
  return FG_OK;
}

fg_status fg_doe_plot_profiles(fg_context *ctx, FILE *out, const fg_experiment *e) {
  for (size_t f = 0; f < e->factors && f < PAIRS_SHOWN; f++)
    FG_TRY(put_profile(ctx, out, e, &e->factor[f]));
  return FG_OK;
}
