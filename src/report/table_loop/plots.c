/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of the page of the loop on tables: every finding over its coordinate, and the residual. */
#include "report/table_loop/plots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"
#include "core/text.h"
#include "page/page.h"
#include "report/table_loop/fitted.h"
#include "report/table_loop/panel.h"
#include "report/table_loop/words.h"

/* Points of a curve: finer than the pixels of a panel. */
enum { CURVE_POINTS = 600 };

static size_t order_coordinate(const fg_loop_problem *problem) {
  for (size_t i = 0; i < problem->coordinates; i++)
    if (problem->coordinate[i].roles & (FG_LOOP_ORDER | FG_LOOP_BUMP)) return i;
  return 0;
}

/* Computes the residual beside the mean. Where neighbours are correlated the result has the
 * innovations, which are summed up again. Beside unequal spread that is not possible; then the
 * innovations are shown. */
static void find_left_over(const fg_loop_report *report, double *left) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_result *result = report->result;
  bool sum = fg_loop_claims_scatter(result, FG_LOOP_SERIAL) &&
             !fg_loop_claims_scatter(result, FG_LOOP_SPREAD);
  for (size_t i = 0; i < problem->rows; i++) {
    bool follows = sum && i > 0 && problem->series[i] == problem->series[i - 1];
    left[i] = result->after_fit[i] + (follows ? result->noise.rho * left[i - 1] : 0);
  }
}

/* Returns true when the effect is known between the rows too. Effects of two coordinates, of
 * levels, and effects that do not change along one axis alone are known at the rows only. */
static bool is_curve(const fg_loop_problem *problem, const fg_loop_claim *claim) {
  const fg_loop_effect *effect = claim->candidate.effect;
  return !effect->pair && !effect->own_levels && effect->accepts &&
         !problem->coordinate[claim->candidate.a].levels &&
         !(problem->coordinate[claim->candidate.a].roles & FG_LOOP_SENSITIVITY);
}

static fg_status draw_curve(fg_context *ctx, const fg_loop_problem *problem,
                            const fg_loop_claim *claim, double mean, fg_loop_panel *panel) {
  const fg_loop_coordinate *at = panel->at;
  double *value = NULL, *effect = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, CURVE_POINTS, sizeof *effect, (void **)&effect));
  FG_TRY_EXIT(fg_memory_allocate(ctx, CURVE_POINTS, sizeof *value, (void **)&value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, CURVE_POINTS, sizeof *panel->line, (void **)&panel->line));
  for (size_t i = 0; i < CURVE_POINTS; i++)
    value[i] = at->low + (at->high - at->low) * (double)i / (CURVE_POINTS - 1);
  FG_TRY_EXIT(fg_loop_claim_curve(ctx, problem, claim, value, CURVE_POINTS, effect));
  for (size_t i = 0; i < CURVE_POINTS; i++)
    if (isfinite(effect[i]))
      panel->line[panel->points++] = (fg_loop_point){value[i], effect[i] - mean};
exit:
  free(effect);
  free(value);
  return status;
}

static int by_x(const void *a, const void *b) {
  const fg_loop_point *p = a, *q = b;
  return (p->x > q->x) - (p->x < q->x);
}

/* Its mean over the rows of every value, a dash each. */
static fg_status draw_levels(fg_context *ctx, const fg_loop_problem *problem, const double *effect,
                             double mean, fg_loop_panel *panel) {
  fg_loop_point *line = NULL;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *line, (void **)&line));
  size_t rows = 0;
  for (size_t i = 0; i < problem->rows; i++)
    if (isfinite(panel->at->value[i]))
      line[rows++] = (fg_loop_point){panel->at->value[i], effect[i] - mean};
  fg_sort_items(line, rows, sizeof *line, by_x);
  for (size_t i = 0, next; i < rows; i = next) {
    double x = line[i].x, sum = 0;
    for (next = i; next < rows && line[next].x == x; next++)
      sum += line[next].y;
    line[panel->points++] = (fg_loop_point){x, sum / (double)(next - i)};
  }
  panel->line = line;
  panel->dashes = true;
  return FG_OK;
}

/* One direction up the places, the other back. */
static fg_status draw_loop(fg_context *ctx, const fg_loop_problem *problem,
                           const fg_loop_claim *claim, const double *effect, double mean,
                           fg_loop_panel *panel) {
  const fg_loop_coordinate *direction = &problem->coordinate[claim->candidate.b];
  size_t up = 0;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *panel->line, (void **)&panel->line));
  for (int back = 0; back < 2; back++) {
    for (size_t i = 0; i < problem->rows; i++)
      if ((direction->value[i] == direction->low) == back)
        panel->line[panel->points++] = (fg_loop_point){panel->at->value[i], effect[i] - mean};
    if (!back) up = panel->points;
  }
  fg_sort_items(panel->line, up, sizeof *panel->line, by_x);
  fg_sort_items(panel->line + up, panel->points - up, sizeof *panel->line, by_x);
  for (size_t i = up, k = panel->points; i + 1 < k; i++) {
    fg_loop_point other = panel->line[--k];
    panel->line[k] = panel->line[i];
    panel->line[i] = other;
  }
  return FG_OK;
}

static void set_limit(const fg_loop_problem *problem, fg_loop_panel *panel) {
  double size = 0;
  for (size_t i = 0; i < problem->rows; i++)
    size = fmax(size, fabs(panel->residual[i]));
  for (size_t i = 0; i < panel->points; i++)
    size = fmax(size, fabs(panel->line[i].y));
  panel->limit = size > 0 && isfinite(size) ? 1.08 * size : 1;
}

static void open_section(FILE *out, const char *words, const char *id) {
  char heading[FG_LOOP_WORDS];
  fg_text_clip(heading, sizeof heading, "%s", words);
  if (*heading >= 'a' && *heading <= 'z') *heading = (char)(*heading - 'a' + 'A');
  fputs("<section><h2>", out);
  fg_html_text(out, heading);
  fputs(" <small>", out);
  fg_html_text(out, id);
  fputs("</small></h2><div class=\"pair\">\n", out);
}

static bool any_held_out(const fg_loop_problem *problem) {
  for (size_t i = 0; problem->held_out && i < problem->rows; i++)
    if (problem->held_out[i]) return true;
  return false;
}

static void close_section(const fg_loop_report *report, FILE *out) {
  fputs("</div>", out);
  if (any_held_out(&report->problem->problem))
    fputs("<p class=\"soft\">Filled: rows that took part. Rings: rows kept aside.</p>", out);
  fputs("</section>\n", out);
}

/* Draws the finding over residual plus effect, and the residual, on one scale. */
static fg_status put_finding_and_residual(fg_context *ctx, FILE *out, const fg_loop_report *report,
                                          fg_loop_panel *first, const double *left) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel second = {.at = first->at, .residual = left, .caption = "What is left with it"};
  set_limit(problem, first);
  second.limit = first->limit;
  FG_TRY(fg_loop_panel_put(ctx, out, report, first));
  return fg_loop_panel_put(ctx, out, report, &second);
}

static fg_status put_mean_claim(fg_context *ctx, FILE *out, const fg_loop_report *report,
                                const fg_loop_claim *claim, const double *left, double *work) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_effect *effect = claim->candidate.effect;
  size_t rows = problem->rows;
  fg_loop_panel panel = {.residual = work + rows};
  fg_status status = FG_OK;
  bool outlier = !effect->accepts;
  panel.at = &problem->coordinate[outlier ? order_coordinate(problem) : claim->candidate.a];
  panel.caption = outlier ? "Residual of the model without it; the rows that it concerns are marked"
                          : "What the model lacks, over what is left";
  panel.marked = outlier ? &claim->candidate : NULL;
  FG_TRY(fg_loop_claim_evaluate(ctx, problem, claim, work));
  double mean = outlier ? 0 : fg_mean(work, rows);
  for (size_t i = 0; i < rows; i++)
    work[rows + i] = left[i] + work[i] - mean;
  if (effect->reads == FG_LOOP_READS_LOOP)
    FG_TRY_EXIT(draw_loop(ctx, problem, claim, work, mean, &panel));
  else if (is_curve(problem, claim))
    FG_TRY_EXIT(draw_curve(ctx, problem, claim, mean, &panel));
  else if (!outlier)
    FG_TRY_EXIT(draw_levels(ctx, problem, work, mean, &panel));
  FG_TRY_EXIT(put_finding_and_residual(ctx, out, report, &panel, left));
  FG_TRY_EXIT(fg_loop_fitted_put(ctx, out, report, panel.at, left));
exit:
  free(panel.line);
  return status;
}

static fg_status put_serial(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const fg_loop_claim *claim, const double *left) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel panel = {.at = &problem->coordinate[claim->candidate.a],
                         .residual = left,
                         .joined = true,
                         .caption = "Residual over the order: neighbours are alike"};
  set_limit(problem, &panel);
  FG_TRY(fg_loop_panel_put(ctx, out, report, &panel));
  panel.residual = report->result->after_fit;
  panel.joined = false;
  panel.caption = "What the row before does not say";
  return fg_loop_panel_put(ctx, out, report, &panel);
}

/* exp(slope × x): the spread as it was claimed; its size from the rows. */
static void spread_curve(const fg_loop_report *report, const fg_loop_claim *claim,
                         fg_loop_panel *panel) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_coordinate *at = panel->at;
  double slope =
      fg_loop_spread_direction(report, claim) * log(claim->noise_value) / (at->high - at->low);
  double sum = 0;
  for (size_t i = 0; i < problem->rows; i++)
    sum += pow(panel->residual[i] / exp(slope * (at->value[i] - at->low)), 2);
  double sd = sqrt(sum / (double)problem->rows);
  for (size_t i = 0; i < CURVE_POINTS; i++) {
    double x = at->low + (at->high - at->low) * (double)i / (CURVE_POINTS - 1);
    panel->line[panel->points++] = (fg_loop_point){x, 2 * sd * exp(slope * (x - at->low))};
  }
}

static fg_status put_spread(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const fg_loop_claim *claim, double *work) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel panel = {.at = &problem->coordinate[claim->candidate.a],
                         .residual = report->result->after_fit,
                         .band = true,
                         .caption = "What is left, and twice its standard deviation"};
  fg_status status = FG_OK;
  if (fg_loop_spread_direction(report, claim)) {
    FG_TRY(fg_memory_allocate(ctx, CURVE_POINTS, sizeof *panel.line, (void **)&panel.line));
    spread_curve(report, claim, &panel);
  } else {
    for (size_t i = 0; i < problem->rows; i++)
      work[i] = panel.residual[i] * panel.residual[i];
    FG_TRY(draw_levels(ctx, problem, work, 0, &panel));
    for (size_t i = 0; i < panel.points; i++)
      panel.line[i].y = 2 * sqrt(panel.line[i].y);
  }
  set_limit(problem, &panel);
  FG_TRY_EXIT(fg_loop_panel_put(ctx, out, report, &panel));
exit:
  free(panel.line);
  return status;
}

static fg_status put_levels(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const fg_loop_claim *claim) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel panel = {.at = &problem->coordinate[claim->candidate.a],
                         .residual = report->result->after_fit,
                         .caption = "What is left, and the mean of every level"};
  fg_status status = draw_levels(ctx, problem, panel.residual, 0, &panel);
  set_limit(problem, &panel);
  if (status == FG_OK) status = fg_loop_panel_put(ctx, out, report, &panel);
  free(panel.line);
  return status;
}

static fg_status put_claim_plots(fg_context *ctx, FILE *out, const fg_loop_report *report,
                                 const fg_loop_claim *claim, const double *left, double *work) {
  fg_loop_scatter scatter = claim->candidate.effect->scatter;
  char words[FG_LOOP_WORDS + 16];
  const char *suspected = report->result->suspects ? "Suspected: " : "";
  size_t used = strlen(suspected);
  fg_text_clip(words, sizeof words, "%s", suspected);
  fg_loop_claim_words(report, claim, words + used);
  open_section(out, words, claim->name);
  FG_TRY(scatter == FG_LOOP_SERIAL   ? put_serial(ctx, out, report, claim, left)
         : scatter == FG_LOOP_SPREAD ? put_spread(ctx, out, report, claim, work)
         : scatter == FG_LOOP_LEVELS ? put_levels(ctx, out, report, claim)
                                     : put_mean_claim(ctx, out, report, claim, left, work));
  close_section(report, out);
  return FG_OK;
}

static fg_status put_unattributed(fg_context *ctx, FILE *out, const fg_loop_report *report,
                                  const double *left, double *work) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_curve *curve = &report->result->curve;
  fg_loop_panel panel = {.at = &problem->coordinate[curve->coordinate],
                         .residual = work,
                         .caption = "A curve that no listed effect explains"};
  char words[FG_LOOP_WORDS];
  fg_text_clip(words, sizeof words, "Something over %s that no listed effect explains",
               curve->name);
  for (size_t i = 0; i < problem->rows; i++)
    work[i] = left[i] + fg_loop_curve_at(curve, panel.at->value[i]);
  FG_TRY(fg_memory_allocate(ctx, curve->count, sizeof *panel.line, (void **)&panel.line));
  for (size_t i = 0; i < curve->count; i++)
    panel.line[panel.points++] = (fg_loop_point){curve->shape[i][0], curve->shape[i][1]};
  open_section(out, words, "unattributed");
  fg_status status = put_finding_and_residual(ctx, out, report, &panel, left);
  close_section(report, out);
  free(panel.line);
  return status;
}

/* Plots of the failed residual tests: the settings with their means; the order, and rows against
 * those at the lag before. */
static fg_status put_settings(fg_context *ctx, FILE *out, const fg_loop_report *report,
                              const double *left, double *work) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_coordinate settings = {.value = work, .low = 1};
  fg_loop_panel panel = {
      .at = &settings, .residual = left, .caption = "What is left; dashes: the mean of a setting"};
  fg_text_clip(settings.name, sizeof settings.name, "settings, in the order of their columns");
  for (size_t i = 0; i < problem->rows; i++) {
    size_t own = report->result->setting[i];
    work[i] = own ? (double)own : NAN;
    settings.high = fmax(settings.high, (double)own);
  }
  FG_TRY(draw_levels(ctx, problem, left, 0, &panel));
  set_limit(problem, &panel);
  fg_status status = fg_loop_panel_put(ctx, out, report, &panel);
  free(panel.line);
  return status;
}

static fg_status put_lag(fg_context *ctx, FILE *out, const fg_loop_report *report,
                         const double *left, double *work) {
  const fg_loop_problem *problem = &report->problem->problem;
  size_t lag = report->result->check[FG_LOOP_CHECK_ONE_LAG].lag;
  fg_loop_coordinate before = {.value = work};
  fg_loop_panel panel = {.at = &problem->coordinate[order_coordinate(problem)],
                         .residual = left,
                         .joined = true,
                         .caption = "What is left, over the order"};
  set_limit(problem, &panel);
  FG_TRY(fg_loop_panel_put(ctx, out, report, &panel));
  for (size_t i = 0; i < problem->rows; i++) {
    bool same = i >= lag && problem->series[i] == problem->series[i - lag];
    work[i] = same ? left[i - lag] : NAN;
  }
  before.low = -panel.limit;
  before.high = panel.limit;
  fg_text_clip(before.name, sizeof before.name, "the same, %zu %s before", lag,
               fg_loop_row_words(panel.at));
  panel.at = &before;
  panel.joined = false;
  panel.caption = "Each against the one so far before it: noise alone would show no direction";
  return fg_loop_panel_put(ctx, out, report, &panel);
}

static fg_status put_failed(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const double *left, double *work) {
  bool settings = report->result->failed < FG_LOOP_CHECK_LAGS;
  open_section(out,
               settings ? "What repeats is not met by the model"
                        : "A pattern over the order that no listed effect explains",
               "unattributed");
  fg_status status =
      settings ? put_settings(ctx, out, report, left, work) : put_lag(ctx, out, report, left, work);
  close_section(report, out);
  return status;
}

static fg_status put_no_effects(fg_context *ctx, FILE *out, const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel panel = {.at = &problem->coordinate[order_coordinate(problem)],
                         .residual = report->result->before_fit,
                         .caption = "Residual of the declared model"};
  set_limit(problem, &panel);
  open_section(out, "The residual, in which nothing shows", "");
  FG_TRY(fg_loop_panel_put(ctx, out, report, &panel));
  close_section(report, out);
  return FG_OK;
}

fg_status fg_loop_plots_put(fg_context *ctx, FILE *out, const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_result *result = report->result;
  double *left = NULL;
  fg_status status = FG_OK;
  if (!problem->coordinates || !result->after_fit) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, 3 * sizeof *left, (void **)&left));
  find_left_over(report, left);
  for (size_t m = 0; m < result->claims; m++)
    FG_TRY_EXIT(put_claim_plots(ctx, out, report, &result->claim[m], left, left + problem->rows));
  if (result->has_curve)
    FG_TRY_EXIT(put_unattributed(ctx, out, report, left, left + problem->rows));
  if (result->fails) FG_TRY_EXIT(put_failed(ctx, out, report, left, left + problem->rows));
  if (result->verdict == FG_LOOP_CLEAN) FG_TRY_EXIT(put_no_effects(ctx, out, report));
  if (result->suspects)
    FG_TRY_EXIT(put_claim_plots(ctx, out, report, &result->suspect[0].claim, result->suspect_fit,
                                left + problem->rows));
exit:
  free(left);
  return status;
}
