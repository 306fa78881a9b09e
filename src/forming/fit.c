/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constants of the beam model from the runs of a designed experiment. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/regression.h"
#include "forming/forming.h"
#include "forming/search.h"
#include "forming/section.h"

enum {
  HALVINGS = 12, /* to 1/4000 of a stride */
  STRIDES = 16,  /* each half as long again: some 1300 standard uncertainties */
};
static const double confidence = 0.95;
/* Layers for a fit: the error of the springback of the thesis's runs is at most 0.003 points. */
enum { FIT_LAYERS = 40 };

/* ---- how well each constant is known ---- */

/* One end of a profile interval: the smallest sum of squares over the others, with this constant
 * held ever farther away, until it exceeds `limit`. */
typedef struct profile {
  const fg_forming_search *whole;
  const gsl_vector *at;
  size_t held;
  double limit;
} profile;

static fg_status min_at(const profile *p, double step, gsl_vector *others, double *sum) {
  fg_forming_search s = *p->whole;
  s.material.value[s.constant[p->held]] = fg_forming_from_step(s.constant[p->held], step);
  s.free--;
  memmove(&s.constant[p->held], &s.constant[p->held + 1], (s.free - p->held) * sizeof *s.constant);
  *sum = INFINITY;
  if (s.free) return fg_forming_search_from(&s, others, sum, NULL);
  gsl_vector *f = gsl_vector_alloc(fg_forming_search_rows(&s));
  if (!f) return fg_fail(s.ctx, FG_ERR_MEMORY, "out of memory: a fit");
  *sum = 0;
  for (size_t i = 0; i < s.fit->runs; i++)
    *sum += pow(fg_forming_search_predict(&s, &s.fit->run[i]) - s.fit->run[i].measured, 2);
  gsl_vector_free(f);
  return s.status;
}

/* The range that a constant may have, as the search moves it. */
static double kept_inside(fg_forming_constant c, double step) {
  return fg_forming_to_step(c, fg_forming_from_step(c, step));
}

static fg_status find_end(const profile *p, double stride, gsl_vector *others, double *end) {
  fg_forming_constant c = p->whole->constant[p->held];
  double from = gsl_vector_get(p->at, p->held), inside = from, outside = NAN, sum = 0;
  *end = NAN;
  for (int i = 0; i < STRIDES && isnan(outside); i++) {
    double step = kept_inside(c, inside + stride);
    if (step == inside) return FG_OK;
    FG_TRY(min_at(p, step, others, &sum));
    if (sum > p->limit)
      outside = step;
    else
      inside = step;
    stride *= 1.5;
  }
  for (int i = 0; i < HALVINGS && isfinite(outside); i++) {
    double step = 0.5 * (inside + outside);
    FG_TRY(min_at(p, step, others, &sum));
    *(sum > p->limit ? &outside : &inside) = step;
  }
  if (isfinite(outside)) *end = fg_forming_from_step(c, 0.5 * (inside + outside));
  return FG_OK;
}

static void others_of(const gsl_vector *x, size_t held, gsl_vector *others) {
  for (size_t k = 0, at = 0; k < x->size; k++)
    if (k != held) gsl_vector_set(others, at++, gsl_vector_get(x, k));
}

static fg_status find_interval(const fg_forming_search *s, const gsl_vector *x, double min,
                               size_t held, fg_forming_found *found) {
  double dof = (double)(fg_forming_search_rows(s) - s->free);
  double t = gsl_cdf_tdist_Pinv(0.5 + confidence / 2, dof);
  const profile p = {s, x, held, min * (1 + t * t / dof)};
  double stride = found->u / (fg_forming_constant_of(found->constant)->by_factors
                                  ? 1
                                  : fg_forming_constant_of(found->constant)->value);
  gsl_vector *others = s->free > 1 ? gsl_vector_alloc(s->free - 1) : NULL;
  if (s->free > 1 && !others) return fg_fail(s->ctx, FG_ERR_MEMORY, "out of memory: a fit");
  fg_status status = FG_OK;
  for (int side = 0; side < 2 && status == FG_OK && stride > 0 && isfinite(stride); side++) {
    if (others) others_of(x, held, others);
    status = find_end(&p, side ? stride : -stride, others, &found->interval[side]);
  }
  gsl_vector_free(others);
  return status;
}

bool fg_forming_identified(const fg_forming_found *found) {
  return !found->at_bound && isfinite(found->interval[0]) && isfinite(found->interval[1]);
}

/* A search that wants beyond stops there, to the digits of its tolerance. */
static bool is_at_bound(fg_forming_constant c, double step) {
  const fg_forming_constant_row *row = fg_forming_constant_of(c);
  double low = fg_forming_to_step(c, row->low), high = fg_forming_to_step(c, row->high);
  double near = 1e-6 * (high - low);
  return !(step > low + near && step < high - near);
}

static fg_status take_found(fg_forming_search *s, const gsl_vector *x, double min,
                            const gsl_matrix *inverse, fg_forming_fit *fit) {
  double variance = min / (double)(fg_forming_search_rows(s) - s->free);
  for (size_t k = 0; k < s->free; k++) {
    const fg_forming_constant_row *row = fg_forming_constant_of(s->constant[k]);
    fg_forming_found *found = &fit->found[k];
    found->constant = s->constant[k];
    found->value = fg_forming_from_step(s->constant[k], gsl_vector_get(x, k));
    found->u = sqrt(variance * gsl_matrix_get(inverse, k, k)) * (row->by_factors ? 1 : row->value);
    found->interval[0] = found->interval[1] = NAN;
    found->at_bound = is_at_bound(s->constant[k], gsl_vector_get(x, k));
    fit->material.value[s->constant[k]] = found->value;
    for (size_t j = 0; j < s->free; j++)
      fit->correlation[k][j] = gsl_matrix_get(inverse, k, j) /
                               sqrt(gsl_matrix_get(inverse, k, k) * gsl_matrix_get(inverse, j, j));
    FG_TRY(find_interval(s, x, min, k, found));
    fg_text_clip(fit->material.source[s->constant[k]], FG_FORMING_SOURCE,
                 "fitted to %zu runs (%s)%s", fit->runs, fit->response_name,
                 found->at_bound                ? "; at its bound: not identified"
                 : fg_forming_identified(found) ? ""
                                                : "; not identified");
  }
  return FG_OK;
}

/* ---- the fit, and each run without itself ---- */

static fg_status fit_all(fg_forming_search *s, gsl_vector *x, gsl_matrix *inverse,
                         fg_forming_fit *fit) {
  double min;
  FG_TRY(fg_forming_search_all(s, NULL, x, &min, inverse));
  if (!(min < INFINITY))
    return fg_fail(
        s->ctx, FG_ERR_DATA,
        "no values of the constants predict these runs: check their units, and the design");
  fit->model =
      (fg_forming_errors){.residual_sd = sqrt(min / (double)(fg_forming_search_rows(s) - s->free)),
                          .parameters = s->free};
  FG_TRY(take_found(s, x, min, inverse, fit));
  for (size_t k = 0; k < s->free; k++)
    s->material.value[s->constant[k]] = fit->found[k].value;
  for (size_t i = 0; i < fit->runs; i++)
    fit->run[i].fitted = fg_forming_search_predict(s, &fit->run[i]);
  return s->status;
}

static fg_status leave_out_each(fg_forming_search *s, const gsl_vector *x, fg_forming_fit *fit) {
  double sum = 0, min;
  gsl_vector *moved = gsl_vector_alloc(s->free);
  fg_status status = moved ? FG_OK : fg_fail(s->ctx, FG_ERR_MEMORY, "out of memory: a fit");
  for (size_t i = 0; i < fit->runs && status == FG_OK; i++) {
    s->left_out = i;
    status = fg_forming_search_all(s, x, moved, &min, NULL);
    for (size_t k = 0; status == FG_OK && k < s->free; k++)
      s->material.value[s->constant[k]] =
          fg_forming_from_step(s->constant[k], gsl_vector_get(moved, k));
    fit->run[i].left_out = status == FG_OK ? fg_forming_search_predict(s, &fit->run[i]) : NAN;
    sum += pow(fit->run[i].left_out - fit->run[i].measured, 2);
  }
  gsl_vector_free(moved);
  fit->model.left_out_rms = sqrt(sum / (double)fit->runs);
  return status;
}

static fg_status run_search(fg_forming_search *s, fg_forming_fit *fit) {
  gsl_vector *x = gsl_vector_calloc(s->free);
  gsl_matrix *inverse = gsl_matrix_alloc(s->free, s->free);
  fg_status status = x && inverse ? fit_all(s, x, inverse, fit)
                                  : fg_fail(s->ctx, FG_ERR_MEMORY, "out of memory: a fit");
  if (status == FG_OK) status = leave_out_each(s, x, fit);
  gsl_vector_free(x);
  gsl_matrix_free(inverse);
  return status;
}

/* ---- for comparison: a quadratic surface, and repeats ---- */

static fg_status fit_surface(fg_context *ctx, const fg_table *table, fg_forming_fit *fit) {
  static const char formula[] = "1 + temperature_C + duration_h + temperature_C:duration_h + "
                                "temperature_C^2 + duration_h^2";
  fg_model model = {0};
  fg_regression r = {0};
  fg_context words = {0};
  fit->surface = (fg_forming_errors){NAN, NAN, 6};
  fit->repeat_sd = NAN;
  /* Runs that do not carry a surface are no error of the fit. */
  fg_status status =
      fg_regression_analyse(&words, table, formula, fit->response_name, NULL, &model, &r);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", words.message);
  if (status != FG_OK) return FG_OK;
  fit->surface.parameters = r.rank;
  if (r.residual_dof) {
    fit->surface.residual_sd = r.residual_sd;
    fit->surface.left_out_rms = sqrt(r.press / (double)r.rows);
  }
  fit->repeats = r.pure_dof;
  if (r.pure_dof) fit->repeat_sd = sqrt(r.pure_ss / (double)r.pure_dof);
  fg_regression_free(&r);
  fg_model_free(&model);
  return FG_OK;
}

/* ---- request ---- */

#define ABSOLUTE_ZERO_C (-273.15)

static fg_status find_columns(fg_context *ctx, const fg_table *table, const char *response,
                              const fg_extended *columns[3]) {
  const char *const names[] = {"temperature_C", "duration_h", response};
  for (size_t i = 0; i < 3; i++) {
    fg_status status = fg_table_numbers(ctx, table, names[i], &columns[i]);
    const fg_column *column;
    fg_context ignored = {0};
    if (status == FG_OK) continue;
    if (fg_table_find(&ignored, table, names[i], &column) == FG_OK) return status;
    char words[sizeof ctx->message];
    fg_text_clip(words, sizeof words, "%s", ctx->message);
    return fg_fail(ctx, status,
                   "%.600s; runs have temperature_C in degrees Celsius, duration_h in hours and %s "
                   "in percent (another response: --response)",
                   words, response);
  }
  return FG_OK;
}

static fg_status take_runs(fg_context *ctx, const fg_table *table, fg_forming_fit *fit) {
  const fg_extended *columns[3];
  FG_TRY(find_columns(ctx, table, fit->response_name, columns));
  const fg_extended *temperature = columns[0], *duration = columns[1], *response = columns[2];
  FG_TRY(fg_memory_allocate(ctx, table->rows, sizeof *fit->run, (void **)&fit->run));
  fit->runs = table->rows;
  for (size_t i = 0; i < table->rows; i++) {
    fit->run[i] = (fg_forming_run_fit){.temperature_C = temperature[i].value,
                                       .duration_h = duration[i].value,
                                       .measured = response[i].value};
    if (!(temperature[i].value > ABSOLUTE_ZERO_C))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: row %zu: temperature_C is %g, below absolute zero: degrees Celsius",
                     table->source, i + 1, temperature[i].value);
    if (!isfinite(fg_section_yield_share(&fit->material, temperature[i].value))) {
      char where[300];
      fg_text_clip(where, sizeof where, "%s: row %zu: temperature_C: ", table->source, i + 1);
      return fg_forming_too_hot(ctx, where, &fit->material, temperature[i].value);
    }
    if (!(duration[i].value > 0))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: duration_h is %g; it must be above 0",
                     table->source, i + 1, duration[i].value);
    if (!(response[i].value < 100 && response[i].value > -FG_FORMING_NOWHERE))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: %s is %g; it must be below 100 %%",
                     table->source, i + 1, fit->response_name, response[i].value);
  }
  return FG_OK;
}

static fg_status check_request(fg_context *ctx, const fg_table *table,
                               const fg_forming_fit_request *request) {
  if (!request->free_count || request->free_count > FG_FORMING_FREE_MAX)
    return fg_fail(ctx, FG_ERR_USAGE, "a fit finds 1 to %d constants", FG_FORMING_FREE_MAX);
  for (size_t k = 0; k < request->free_count; k++)
    for (size_t j = 0; j < k; j++)
      if (request->free[j] == request->free[k])
        return fg_fail(ctx, FG_ERR_USAGE, "%s is to be found, and named twice",
                       fg_forming_constant_of(request->free[k])->name);
  if (table->rows < request->free_count + 2)
    return fg_fail(ctx, FG_ERR_DATA, "%s: %zu runs; to find %zu constants takes %zu at least",
                   table->source, table->rows, request->free_count, request->free_count + 2);
  if (fg_foil_traits_of(request->design->kind)->why_no_forming)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "the design's foil is not bent in a die (its form), so that it cannot be formed");
  return fg_forming_material_check(ctx, request->material);
}

/* The lands for themselves: a plain strip of the same overall circle. */
static fg_design design_of(const fg_forming_fit_request *request) {
  fg_design design = *request->design;
  if (request->response == FG_FORMING_OF_FOIL || fg_foil_traits_of(design.kind)->is_plain_strip)
    return design;
  fg_design_become_lands(90, &design);
  return design;
}

static fg_status fit_table(fg_context *ctx, const fg_table *table,
                           const fg_forming_fit_request *request, fg_forming_fit *fit) {
  FG_TRY(check_request(ctx, table, request));
  *fit = (fg_forming_fit){.design = *request->design,
                          .material = *request->material,
                          .response = request->response,
                          .options = request->options,
                          .free = request->free_count};
  if (!fit->options.layers) fit->options.layers = FIT_LAYERS;
  fg_text_clip(fit->response_name, sizeof fit->response_name, "%s",
               request->column ? request->column : "springback_error_pct");
  fg_text_clip(fit->file.path, sizeof fit->file.path, "%s", table->source ? table->source : "");
  if (request->sha256)
    fg_text_clip(fit->file.sha256, sizeof fit->file.sha256, "%s", request->sha256);
  FG_TRY(take_runs(ctx, table, fit));
  FG_TRY(fit_surface(ctx, table, fit));
  fg_forming_search s = {.ctx = ctx,
                         .fit = fit,
                         .design = design_of(request),
                         .material = *request->material,
                         .free = request->free_count,
                         .left_out = SIZE_MAX,
                         .status = FG_OK};
  memcpy(s.constant, request->free, s.free * sizeof *s.constant);
  return run_search(&s, fit);
}

fg_status fg_forming_fit_runs(fg_context *ctx, const fg_table *table,
                              const fg_forming_fit_request *request, fg_forming_fit *fit) {
  fg_numerics_start();
  *fit = (fg_forming_fit){0};
  fg_status status = fit_table(ctx, table, request, fit);
  if (status != FG_OK) fg_forming_fit_free(fit);
  return status;
}

void fg_forming_fit_free(fg_forming_fit *fit) {
  free(fit->run);
  *fit = (fg_forming_fit){0};
}
