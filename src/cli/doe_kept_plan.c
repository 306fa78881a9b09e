/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/doe_kept_plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "foilgauge/formula.h"
#include "foilgauge/text.h"

static bool is_coded(const fg_doe_plan_request *r, const char *name) {
  for (size_t i = 0; i < r->options->codings; i++)
    if (!strcmp(r->coding[i].name, name)) return true;
  return false;
}

static bool is_rounded(const fg_doe_plan_request *r, const char *name) {
  for (size_t i = 0; i < r->options->rounds; i++)
    if (!strcmp(r->round[i].name, name)) return true;
  return false;
}

/* True for a number that enters the formula untransformed: only that can be coded. */
static bool is_factor(const fg_formula *formula, const char *name) {
  bool found = false;
  for (size_t v = 0; v < formula->variables; v++) {
    if (strcmp(formula->variable[v].column, name) != 0) continue;
    if (formula->variable[v].transform != FG_TRANSFORM_NONE) return false;
    found = true;
  }
  return found;
}

/* The plan's limits and steps of the factors of the model; options go before them. */
static void apply_plan(const fg_doe_plan_request *r, const fg_plan_limits *plan,
                       const fg_formula *formula) {
  fg_experiment_options *options = r->options;
  for (size_t k = 0; k < plan->factors; k++) {
    const fg_coding *coding = &plan->coding[k];
    if (!is_factor(formula, coding->name)) continue;
    if (!options->uncoded && !is_coded(r, coding->name) && options->codings < FG_FORMULA_VARIABLES)
      r->coding[options->codings++] = *coding;
    if (plan->step[k] > 0 && !is_rounded(r, coding->name) &&
        options->rounds < FG_FORMULA_VARIABLES) {
      fg_rounding *round = &r->round[options->rounds++];
      memcpy(round->name, coding->name, sizeof round->name);
      round->step = plan->step[k];
    }
  }
}

/* Notes that the plan of a run sheet is gone: the sheet is analysed by its data. */
static void note_lost(const fg_table *sheet, fg_doe_plan *plan) {
  const fg_column *column;
  if (fg_table_find(NULL, sheet, "standard_order", &column) != FG_OK ||
      fg_table_find(NULL, sheet, "point", &column) != FG_OK)
    return;
  snprintf(plan->note, sizeof plan->note,
           "The table was a run sheet of `doe plan`, and its plan is not beside it (%.200s): "
           "factors are coded by their lowest and highest value; --plan names it.",
           plan->path);
}

static void note_changed(const fg_table *sheet, fg_doe_plan *plan) {
  size_t first = 0, changed = fg_plan_limits_differ(&plan->limits, sheet, &first);
  if (changed)
    snprintf(
        plan->note, sizeof plan->note,
        "%zu run%s made at another setting than planned, the first in row %zu: counted as made.",
        changed, fg_plural(changed), first);
}

/* Loads the plan; a message says what to do about a fault. */
static fg_status load_plan(fg_context *ctx, fg_doe_plan *plan) {
  fg_context inner = {.message = ""};
  fg_status status = fg_plan_limits_load(&inner, plan->path, &plan->limits);
  if (status == FG_OK || status == FG_ERR_MEMORY) return status;
  return fg_fail(
      ctx, status,
      "%s; `foilgauge doe plan` wrote it beside the run sheet: put its copy back, or move "
      "it away and give the limits with --code NAME=LOW:HIGH",
      inner.message);
}

fg_status fg_doe_plan_find(fg_context *ctx, const fg_doe_plan_request *request, fg_doe_plan *plan) {
  fg_formula formula;
  if (!request->path && !strcmp(request->data, "-")) return FG_OK;
  if (request->path)
    FG_TRY(fg_text_print(ctx, &plan->path, "%s", request->path));
  else
    FG_TRY(fg_plan_beside(ctx, request->data, &plan->path));
  if (!request->path && access(plan->path, F_OK) != 0) {
    note_lost(request->sheet, plan);
    free(plan->path);
    plan->path = NULL;
    return FG_OK;
  }
  FG_TRY(load_plan(ctx, plan));
  FG_TRY(fg_formula_parse(ctx, request->options->formula, &formula));
  apply_plan(request, &plan->limits, &formula);
  fg_formula_free(&formula);
  note_changed(request->sheet, plan);
  return FG_OK;
}

void fg_doe_plan_free(fg_doe_plan *plan) {
  free(plan->path);
  fg_plan_limits_free(&plan->limits);
}
