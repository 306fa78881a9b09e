/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions at settings that the user requests, and the best value along each factor from there:
 * for testing a setting that others call the best. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "process/experiment_parts.h"

/* Number of values along a factor; a parabola through the best ones refines the optimum. */
enum { PLACES = 200 };
/* Share of the distance between places down to which a best value is refined: the reports show no
 * more digits. */
#define STEP_MIN 1e-6

static fg_status fail_at(fg_context *ctx, const char *text, const char *at, const char *what) {
  return fg_fail(ctx, FG_ERR_USAGE,
                 "--at '%s', character %zu: %s; write it like 'temperature_C=650, duration_h=4'",
                 text, (size_t)(at - text) + 1, what);
}

static const fg_factor *find_asked_factor(const fg_experiment *e, size_t variable) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == variable) return &e->factor[f];
  return NULL;
}

static double coded(const fg_factor *f, double real) {
  double middle = fg_factor_real(f, 0), half = fg_factor_real(f, 1) - middle;
  return (real - middle) / half;
}

static size_t variable_of(const fg_experiment *e, const char *name, size_t length) {
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    const char *column = e->model.formula.variable[v].column;
    if (v != e->block_variable && strlen(column) == length && !memcmp(column, name, length))
      return v;
  }
  return FG_FORMULA_VARIABLES;
}

/* A level of words, or a number. */
static bool read_value(const fg_experiment *e, size_t v, const char *text, size_t length,
                       double *value) {
  const fg_levels *levels = &e->model.levels[v];
  const fg_factor *factor = find_asked_factor(e, v);
  char *end;
  for (size_t k = 0; k < levels->count; k++)
    if (strlen(levels->name[k]) == length && !memcmp(levels->name[k], text, length)) {
      *value = (double)k;
      return true;
    }
  if (levels->count || !factor) return false;
  double real = strtod(text, &end);
  *value = coded(factor, real);
  return end == text + length && length && isfinite(real);
}

static size_t without_blanks(const char *text, size_t length) {
  while (length && text[length - 1] == ' ')
    length--;
  return length;
}

/* NAME=VALUE up to a comma; the place behind it. */
static fg_status read_one(fg_context *ctx, const fg_experiment *e, const char *text,
                          const char **at, double *setting) {
  const char *name = *at + strspn(*at, " ");
  size_t length = strcspn(name, "=,");
  if (name[length] != '=') return fail_at(ctx, text, name + length, "'=' is expected");
  size_t v = variable_of(e, name, without_blanks(name, length));
  if (v == FG_FORMULA_VARIABLES) return fail_at(ctx, text, name, "this is no factor of the model");
  const char *value = name + length + 1;
  value += strspn(value, " ");
  length = strcspn(value, ",");
  if (!read_value(e, v, value, without_blanks(value, length), &setting[v]))
    return fail_at(ctx, text, value, "this is no value of the factor");
  *at = value + length + (value[length] == ',');
  return FG_OK;
}

static fg_status read_setting(fg_context *ctx, const fg_experiment *e, const char *text,
                              double *setting) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    setting[v] = v == e->block_variable ? 0 : NAN;
  for (const char *at = text; *at;)
    FG_TRY(read_one(ctx, e, text, &at, setting));
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (isnan(setting[v]))
      return fg_fail(ctx, FG_ERR_USAGE, "--at '%s': '%s' has no value", text,
                     e->model.formula.variable[v].column);
  return FG_OK;
}

/* Tries a value of one factor, and keeps it where its cost is below the lowest so far. */
static fg_status try_value(fg_context *ctx, const fg_experiment *e, size_t variable, double value,
                           double *lowest_cost, fg_asked *asked) {
  double setting[FG_FORMULA_VARIABLES];
  fg_prediction p;
  memcpy(setting, asked->setting, sizeof setting);
  setting[variable] = value;
  FG_TRY(fg_experiment_predict(ctx, e, setting, &p));
  double cost = fg_experiment_cost(e, p.mean);
  if (!(cost < *lowest_cost)) return FG_OK;
  *lowest_cost = cost;
  asked->best_at[variable] = value;
  asked->best_mean[variable] = p.mean;
  return FG_OK;
}

/* Finds the best value of this factor within the runs, with the others as requested. */
static fg_status best_along(fg_context *ctx, const fg_experiment *e, const fg_factor *factor,
                            fg_asked *asked) {
  size_t v = factor->variable;
  double low = factor->lowest, step = (factor->highest - low) / PLACES, cost = INFINITY;
  for (int i = 0; i <= PLACES; i++)
    FG_TRY(try_value(ctx, e, v, low + step * i, &cost, asked));
  for (double half = step; half > STEP_MIN * step; half /= 2)
    for (int side = -1; side <= 1; side += 2) {
      double x = fmin(fmax(asked->best_at[v] + side * half, low), factor->highest);
      FG_TRY(try_value(ctx, e, v, x, &cost, asked));
    }
  return FG_OK;
}

static fg_status predict_request(fg_context *ctx, const fg_experiment *e, const char *text,
                                 fg_asked *asked) {
  *asked = (fg_asked){.text = NULL};
  FG_TRY(read_setting(ctx, e, text, asked->setting));
  FG_TRY(fg_experiment_predict(ctx, e, asked->setting, &asked->prediction));
  asked->inside = true;
  for (size_t f = 0; f < e->factors; f++) {
    const fg_factor *factor = &e->factor[f];
    double x = asked->setting[factor->variable];
    asked->inside = asked->inside && x >= factor->lowest - 1e-9 && x <= factor->highest + 1e-9;
    FG_TRY(best_along(ctx, e, factor, asked));
  }
  return fg_text_print(ctx, &asked->text, "%s", text);
}

fg_status fg_experiment_ask(fg_context *ctx, const fg_experiment_options *options,
                            fg_experiment *e) {
  if (!options->ats) return FG_OK;
  FG_TRY(fg_experiment_check_subtracted(ctx, e));
  e->best.goal = options->goal;
  e->best.target = options->target;
  FG_TRY(fg_memory_allocate(ctx, options->ats, sizeof *e->asked, (void **)&e->asked));
  for (size_t i = 0; i < options->ats; i++) {
    FG_TRY(predict_request(ctx, e, options->at[i], &e->asked[i]));
    e->askeds++;
  }
  return FG_OK;
}
