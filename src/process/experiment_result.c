/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions to an analysed experiment, its notes, and freeing it. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "process/experiment_parts.h"

fg_status fg_experiment_note(fg_context *ctx, fg_experiment *e, const char *format, ...) {
  va_list values;
  va_start(values, format);
  fg_status status = fg_notes_add(ctx, &e->note, &e->notes, &e->note_capacity, format, values);
  va_end(values);
  return status;
}

double fg_factor_real(const fg_factor *factor, double x) {
  return factor->coded ? fg_coding_to_real(&factor->coding, x) : x;
}

const fg_experiment *fg_experiment_best(const fg_experiment *e) {
  return e->reduced ? e->reduced : e;
}

void fg_experiment_free(fg_experiment *e) {
  if (!e) return;
  fg_experiment_free(e->reduced);
  free(e->reduced);
  for (size_t i = 0; i < e->askeds; i++)
    free(e->asked[i].text);
  free(e->asked);
  fg_notes_free(e->note, e->notes);
  for (size_t i = 0; i < e->constraints; i++)
    free(e->constraint[i]);
  free(e->constraint);
  fg_split_plot_free(&e->split_plot);
  fg_regression_free(&e->regression);
  fg_model_free(&e->model);
  fg_table_free(&e->table);
  free(e->effect);
  free(e->setting);
  free(e->measurement.u);
  free(e->measurement.weight);
  free(e->measurement.weight_gram);
  free(e->subtracted.effects);
  free(e->subtracted.sum);
  free(e->order_value);
  free(e->response);
  free(e->formula);
  free(e->block);
  free(e->whole_plot);
  *e = (fg_experiment){0};
}

static bool is_factor(const fg_experiment *e, const char *column) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (v != e->block_variable && !strcmp(e->model.formula.variable[v].column, column)) return true;
  return false;
}

bool fg_experiment_is_of_factors(const fg_experiment *e, const fg_subtracted_effect *effect) {
  if (!effect->applied || !(effect->high > effect->low) || !*effect->column[0]) return false;
  for (int k = 0; k < 2; k++)
    if (*effect->column[k] && !is_factor(e, effect->column[k])) return false;
  return true;
}

double fg_experiment_p_value(const fg_experiment *e, size_t column) {
  double p_value = e->effect[column].p_value;
  return e->regression.residual_dof ? p_value : e->effect[column].lenth_p_value;
}

bool fg_experiment_of_interest(const fg_experiment *e, size_t column) {
  const fg_coefficient *c = &e->regression.coefficient[column];
  return c->term != FG_MODEL_CONSTANT && !c->aliased && !e->effect[column].block;
}

double fg_experiment_cost(const fg_experiment *e, double response) {
  if (e->best.goal == FG_GOAL_TARGET) return fabs(response - e->best.target);
  return e->best.goal == FG_GOAL_HIGHEST ? -response : response;
}

bool fg_experiment_lacks_fit(const fg_experiment *e) {
  const fg_regression *r = &e->regression;
  return r->pure_dof && r->lack_dof && !e->has_split_plot && r->lack_p_value < 1 - e->confidence;
}

bool fg_order_shows(double p_value) {
  return isfinite(p_value) && p_value < FG_ORDER_LEVEL;
}

bool fg_order_seen(const fg_order_check *order) {
  return fg_order_shows(order->drift_p) || fg_order_shows(order->neighbours_p) ||
         fg_order_shows(order->farthest_p);
}

const fg_factor *fg_surface_factor(const fg_experiment *e, size_t k) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == e->surface.variable[k]) return &e->factor[f];
  return NULL;
}

const fg_factor *fg_experiment_main_factor(const fg_experiment *e, size_t column) {
  const fg_model_column *c = &e->model.column[column];
  if (c->parts != 1 || c->part[0].level != FG_PART_NUMBER || c->part[0].power != 1) return NULL;
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == c->part[0].variable && e->factor[f].coded) return &e->factor[f];
  return NULL;
}

const fg_optimum *fg_experiment_best_point(const fg_experiment *e) {
  const fg_experiment *best = fg_experiment_best(e);
  return best->best.has_rounded ? &best->best.rounded : &best->best.optimum;
}
