/* Effects and residuals. */
#include "report/doe/doe_plots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/distribution.h"
#include "report/doe/doe_frame.h"
#include "report/doe/doe_words.h"
#include "report/measure/measure_page_parts.h"

enum { LEVELS_SHOWN = 12, PAIRS_SHOWN = 6, BARS_SHOWN = 20, POINTS_SHOWN = 2000 };

static double response_at(const fg_experiment *e, size_t run) {
  return e->regression.fitted[run] + e->regression.residual[run];
}

/* Mean response at every value that a variable takes. */
typedef struct level_means {
  double value[LEVELS_SHOWN], mean[LEVELS_SHOWN];
  size_t runs[LEVELS_SHOWN], count;
  bool too_many;
} level_means;

static void find_means(const fg_experiment *e, size_t variable, level_means *m) {
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
    fg_range_add(x, real[k]);
  }
  fg_plot at = fg_frame_begin(out, name, x, y);
  fg_plot_y_axis(&at, "mean response");
  for (size_t k = 0; k < m->count && levels->count; k++)
    fg_plot_x_label(&at, fg_plot_x(&at, real[k]), levels->name[(size_t)m->value[k]]);
  if (!levels->count) fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, name);
  for (size_t k = 0; k + 1 < m->count; k++)
    fg_frame_line(&at, "s1", real[k], m->mean[k], real[k + 1], m->mean[k + 1]);
  for (size_t k = 0; k < m->count; k++)
    fg_frame_dot(&at, "s1", real[k], m->mean[k], 5);
  fg_frame_end(&at);
}

void fg_doe_plot_main_effects(FILE *out, const fg_experiment *e) {
  double y[2] = {INFINITY, -INFINITY};
  level_means m;
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    find_means(e, v, &m);
    for (size_t k = 0; !m.too_many && k < m.count; k++)
      fg_range_add(y, m.mean[k]);
  }
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    find_means(e, v, &m);
    sort_means(&m);
    if (!m.too_many) put_means(out, e, v, &m, y);
  }
}

/* Everything in the middle of the data; words at the optimum's level. */
static void middle_setting(const fg_experiment *e, double *setting) {
  memcpy(setting, e->best_setting, e->model.formula.variables * sizeof *setting);
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
  double y[2][CURVE + 1], range[2] = {INFINITY, -INFINITY};
  double x[2] = {fg_factor_real(a, a->lowest), fg_factor_real(a, a->highest)};
  char title[600], text[300];
  FG_TRY(sample_pair(ctx, e, a, b, y));
  for (int i = 0; i <= CURVE; i++) {
    fg_range_add(range, y[0][i]);
    fg_range_add(range, y[1][i]);
  }
  snprintf(title, sizeof title, "%.250s × %.250s", a->name, b->name);
  fg_plot at = fg_frame_begin(out, title, x, range);
  at.top = 48; /* the legend stands above */
  fg_plot_y_axis(&at, "response (model)");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, a->name);
  for (int side = 0; side < 2; side++) {
    fprintf(out, "<path class=\"%s\" d=\"", side ? "s2" : "s1");
    for (int i = 0; i <= CURVE; i++)
      fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(&at, x[0] + (x[1] - x[0]) * i / CURVE),
              fg_plot_y(&at, y[side][i]));
    fputs("\"/>\n", out);
    fg_frame_dot(&at, side ? "s2" : "s1", x[0], y[side][0], 5);
    fg_frame_dot(&at, side ? "s2" : "s1", x[1], y[side][CURVE], 5);
    snprintf(text, sizeof text, "%.200s = %.5g", b->name,
             fg_factor_real(b, side ? b->highest : b->lowest));
    fprintf(out,
            "<circle class=\"%s\" cx=\"%d\" cy=\"%d\" r=\"5\"/><text class=\"start\" x=\"%d\" "
            "y=\"%d\">",
            side ? "s2" : "s1", 84, 12 + 20 * side, 96, 17 + 20 * side);
    fg_html_text(out, text);
    fputs("</text>\n", out);
  }
  fg_frame_end(&at);
  return FG_OK;
}

fg_status fg_doe_plot_interactions(fg_context *ctx, FILE *out, const fg_experiment *e) {
  size_t shown = 0;
  for (size_t a = 0; a < e->factors; a++)
    for (size_t b = a + 1; b < e->factors && shown < PAIRS_SHOWN; b++, shown++)
      FG_TRY(put_pair(ctx, out, e, &e->factor[a], &e->factor[b]));
  return FG_OK;
}

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
  bool has_error = e->regression.residual_freedom > 0;
  size_t count = 0;
  for (size_t j = 0; j < e->regression.columns; j++) {
    double size = fabs(has_error ? e->effect[j].t : e->effect[j].contrast);
    if (fg_effect_of_interest(e, j) && isfinite(size)) bars[count++] = (bar){j, size};
  }
  qsort(bars, count, sizeof *bars, compare_bars);
  return count;
}

static bool is_on(const fg_experiment *e, size_t column) {
  return fg_effect_p_value(e, column) < 1 - e->confidence;
}

static void put_pareto(FILE *out, const fg_experiment *e, const bar *bars, size_t count) {
  bool has_error = e->regression.residual_freedom > 0;
  size_t shown = count < BARS_SHOWN ? count : BARS_SHOWN;
  int height = 66 + 24 * (int)shown;
  double limit = has_error ? fg_distribution_t_quantile((1 + e->confidence) / 2,
                                                        (double)e->regression.residual_freedom)
                           : e->lenth.margin;
  double longest = bars[0].size;
  if (!e->has_split_plot && limit > 0) longest = fmax(longest, limit);
  fg_plot at = {out, FG_FRAME_WIDTH, 190, FG_FRAME_WIDTH - 14, 8, height - 50, 0, longest * 1.05, 0,
                1};
  fputs("<figure><h3>Pareto of effects</h3>", out);
  fg_plot_begin(&at, height, "Pareto of effects");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, has_error ? "|t|" : "|effect|, coefficient of ±1");
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
    fg_frame_line(&at, "limit", limit, 0, limit, 1);
  fg_plot_end(&at);
  fprintf(out, "<figcaption>%s%s</figcaption></figure>\n",
          has_error ? "Orange: told from the scatter. "
                    : "Orange: told from the others by Lenth's method. ",
          e->has_split_plot ? "Each is judged by its own stratum." : "Red: the limit.");
}

static fg_status put_half_normal(fg_context *ctx, FILE *out, const fg_experiment *e,
                                 const bar *bars, size_t count, fg_half_normal *points,
                                 double *contrast) {
  double x[2] = {0, 0}, y[2] = {0, 0};
  for (size_t i = 0; i < count; i++)
    contrast[i] = e->effect[bars[i].column].contrast;
  FG_TRY(fg_half_normal_points(ctx, contrast, count, points));
  for (size_t i = 0; i < count; i++) {
    fg_range_add(x, points[i].magnitude);
    fg_range_add(y, points[i].quantile);
  }
  fg_plot at = fg_frame_begin(out, "Half-normal plot of effects", x, y);
  fg_plot_y_axis(&at, "half-normal quantile");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, "|effect|, coefficient of ±1");
  double sd = e->lenth.pseudo_standard_error;
  if (e->has_lenth) fg_frame_line(&at, "hint", 0, 0, fmin(x[1], sd * y[1]), fmin(x[1] / sd, y[1]));
  for (size_t i = 0; i < count; i++) {
    size_t column = bars[points[i].effect].column;
    fg_frame_dot(&at, is_on(e, column) ? "s1" : "s2", points[i].magnitude, points[i].quantile, 5);
    if (i + 4 >= count || is_on(e, column))
      fg_frame_text(&at, points[i].magnitude, points[i].quantile,
                    e->regression.coefficient[column].name);
  }
  fg_plot_end(&at);
  fputs("<figcaption>Effects that are nothing lie along the dashed line; what matters lies to its "
        "right.</figcaption></figure>\n",
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
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *points, (void **)&points));
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

/* Externally studentised where they exist: what a run does not fit, in standard deviations. */
static double residual_of(const fg_experiment *e, size_t run, bool studentised) {
  return studentised ? e->regression.external[run] : e->regression.residual[run];
}

typedef struct scatter {
  const char *title, *x_title, *y_title;
  const double *x, *y;
  size_t count;
} scatter;

static void put_scatter(FILE *out, const scatter *s, bool zero) {
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  size_t step = s->count / POINTS_SHOWN + 1;
  for (size_t i = 0; i < s->count; i++) {
    fg_range_add(x, s->x[i]);
    fg_range_add(y, s->y[i]);
  }
  if (zero) fg_range_add(y, 0);
  fg_plot at = fg_frame_begin(out, s->title, x, y);
  fg_plot_y_axis(&at, s->y_title);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, s->x_title);
  for (size_t i = 0; i < s->count; i += step)
    fg_frame_dot(&at, "s2", s->x[i], s->y[i], s->count > 200 ? 2 : 4.5);
  fg_frame_end(&at);
}

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

fg_status fg_doe_plot_residuals(fg_context *ctx, FILE *out, const fg_experiment_report *report) {
  const fg_experiment *e = report->experiment;
  size_t rows = e->regression.rows, finite = 0;
  bool studentised = true;
  double *x = NULL, *y = NULL;
  fg_status status = FG_OK;
  if (!e->regression.residual_freedom) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *x, (void **)&x));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *y, (void **)&y));
  for (size_t i = 0; i < rows; i++)
    studentised = studentised && isfinite(e->regression.external[i]);
  const char *name = studentised ? "studentised residual" : "residual";
  for (size_t i = 0; i < rows; i++)
    y[i] = residual_of(e, i, studentised);
  put_scatter(out,
              &(scatter){"Residual over fitted value", "fitted response", name,
                         e->regression.fitted, y, rows},
              true);
  for (size_t i = 0; i < rows; i++)
    x[i] = (double)(report->row ? report->row[i] : i + 1);
  put_scatter(out, &(scatter){"Residual in the order of the sheet", "row", name, x, y, rows}, true);
  put_scatter(
      out,
      &(scatter){"Influence of the runs", "row", "Cook's distance", x, e->regression.cook, rows},
      true);
  for (size_t i = 0; i < rows; i++)
    if (isfinite(y[i])) y[finite++] = y[i];
  qsort(y, finite, sizeof *y, compare_doubles);
  for (size_t i = 0; i < finite; i++)
    x[i] = fg_distribution_normal_quantile(((double)i + 0.5) / (double)finite);
  put_scatter(out, &(scatter){"Normal plot of residuals", "normal quantile", name, x, y, finite},
              true);
exit:
  free(x);
  free(y);
  return status;
}

/* The mean with its interval along one factor, the others in the middle. */
static fg_status put_profile(fg_context *ctx, FILE *out, const fg_experiment *e,
                             const fg_factor *f) {
  fg_prediction p[2 * CURVE + 1];
  double setting[FG_FORMULA_VARIABLES], y[2] = {INFINITY, -INFINITY};
  double x[2] = {fg_factor_real(f, f->lowest), fg_factor_real(f, f->highest)};
  size_t variables = e->model.formula.variables, step = e->regression.rows / POINTS_SHOWN + 1;
  char title[400];
  middle_setting(e, setting);
  for (int i = 0; i <= 2 * CURVE; i++) {
    set_column(e, f, f->lowest + (f->highest - f->lowest) * i / (2 * CURVE), setting);
    FG_TRY(fg_experiment_predict(ctx, e, setting, &p[i]));
    fg_range_add(y, p[i].mean);
  }
  for (size_t i = 0; i < e->regression.rows; i++)
    fg_range_add(y, response_at(e, i));
  double lowest = y[0] - (y[1] - y[0]), highest = y[1] + (y[1] - y[0]);
  for (int i = 0; i <= 2 * CURVE && isfinite(p[0].low); i++) { /* the curve must not look flat */
    fg_range_add(y, fmax(p[i].low, lowest));
    fg_range_add(y, fmin(p[i].high, highest));
  }
  snprintf(title, sizeof title, "Response along %.300s", f->name);
  fg_plot at = fg_frame_begin(out, title, x, y);
  fg_plot_y_axis(&at, "response");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, f->name);
  double at_x[2 * CURVE + 1];
  for (int i = 0; i <= 2 * CURVE; i++)
    at_x[i] = fg_plot_x(&at, x[0] + (x[1] - x[0]) * i / (2 * CURVE));
  if (isfinite(p[0].low)) {
    fputs("<path class=\"ci\" style=\"fill:#1f6fd0\" d=\"", out);
    for (int i = 0; i <= 2 * CURVE; i++)
      fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', at_x[i],
              fg_plot_y(&at, fmin(at.y_high, fmax(at.y_low, p[i].high))));
    for (int i = 2 * CURVE; i >= 0; i--)
      fprintf(out, "L%.1f %.1f", at_x[i],
              fg_plot_y(&at, fmin(at.y_high, fmax(at.y_low, p[i].low))));
    fputs("Z\"/>\n", out);
  }
  fputs("<path class=\"s2\" d=\"", out);
  for (int i = 0; i <= 2 * CURVE; i++)
    fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', at_x[i], fg_plot_y(&at, p[i].mean));
  fputs("\"/>\n", out);
  for (size_t i = 0; i < e->regression.rows; i += step)
    fg_frame_dot(&at, "run", fg_factor_real(f, e->setting[i * variables + f->variable]),
                 response_at(e, i), 4);
  fg_frame_end(&at);
  return FG_OK;
}

fg_status fg_doe_plot_profiles(fg_context *ctx, FILE *out, const fg_experiment *e) {
  for (size_t f = 0; f < e->factors && f < PAIRS_SHOWN; f++)
    FG_TRY(put_profile(ctx, out, e, &e->factor[f]));
  return FG_OK;
}
