/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Form error: the peak-to-valley deviation of the part from its least-squares circle, ISO 12181.
 *
 * Peaks of measured edges are peaks of noise. So the deviation is the one that the models hold for
 * the part's: draws from the posterior of its columns, beside their circles, model by model, give
 * the mean of the peak-to-valley deviation and its standard deviation. Effects too small for a
 * model widen it. */
#include "scan_loop/form_errors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"
#include "evidence/options.h"
#include "foilgauge/report.h"
#include "scan_loop/form_error_draws.h"

enum { MODELS_MAX = 48 };
/* Models of less weight, relative to the likeliest, change no mean; and a range leaves out what has
 * no such share of the whole at either end. */
#define WEIGHT_MIN 1e-3
#define SHARE_MIN  0.05
/* Weight of an explanation that the verdict lists, relative to the likeliest: at least this. */
#define LISTED_MIN 0.1
/* Share of the largest deviation that the smallest one must reach: else its cause is open. */
#define OPEN_SHARE 0.5
/* Share of a deviation that rows, which are means, lose. */
#define SHAPE_SHARE 0.01

/* Returns true for a part of a model that moves the strip's midline. */
static bool is_of_part(const fg_evidence_part *part) {
  if (part->effect) return part->effect->midline != NULL;
  return part->rival->columns && part->rival->coordinate != FG_EFFECT_NORMAL;
}

/* Lower factor of a covariance; a number that is known exactly has zeros. */
static void factorise_covariance(size_t n, double *a) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++) {
      double value = a[i * n + k];
      for (size_t j = 0; j < k; j++)
        value -= a[i * n + j] * a[k * n + j];
      if (k < i)
        a[i * n + k] = a[k * n + k] > 0 ? value / a[k * n + k] : 0;
      else
        a[i * n + i] = value > 1e-12 * fabs(a[i * n + i]) ? sqrt(value) : 0;
    }
}

static void fill_rival_columns(const fg_circles *c, const fg_evidence_part *part, double *to) {
  double values[FG_RIVAL_COLUMNS];
  size_t skip = part->rival->stretch ? part->stretch * part->count : 0;
  for (size_t i = 0; i < c->rows; i++) {
    fg_rival_columns(part->rival, c->edge_fit, &c->edge_fit->rows[c->row[i]], values);
    for (size_t k = 0; k < part->count; k++)
      to[k * c->rows + i] = values[skip + k];
  }
}

static fg_status fill_effect_columns(fg_context *ctx, const fg_circles *c,
                                     const fg_evidence_part *part, double *to) {
  size_t rows = c->edge_fit->row_count;
  double *columns = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns, (void **)&columns));
  fg_effect_columns(c->edge_fit, part->effect, part->shape, columns);
  for (size_t k = 0; k < part->count; k++)
    for (size_t i = 0; i < c->rows; i++)
      to[k * c->rows + i] = columns[k * rows + c->row[i]];
  free(columns);
  return FG_OK;
}

/* Columns of one part of a model at the rows of the circles, beside them. */
static fg_status fill_columns(fg_context *ctx, const fg_circles *c, const fg_evidence_part *part,
                              double *to) {
  if (part->effect)
    FG_TRY(fill_effect_columns(ctx, c, part, to));
  else
    fill_rival_columns(c, part, to);
  for (size_t k = 0; k < part->count; k++)
    fg_circles_remove(c, to + k * c->rows);
  return FG_OK;
}

static fg_status find_deviations(fg_context *ctx, fg_evidence_search *s, const fg_circles *c,
                                 const fg_evidence_model *model, fg_form_error_deviations *d) {
  fg_evidence_posterior posterior;
  size_t count = 0, *index = NULL;
  fg_status status = FG_OK;
  *d = (fg_form_error_deviations){.count = 0};
  for (size_t k = 0; k < model->parts; k++)
    count += is_of_part(model->part[k]) ? model->part[k]->count : 0;
  if (!count) return FG_OK;
  FG_TRY(fg_evidence_find_posterior(ctx, s, model, &posterior));
  FG_TRY_EXIT(fg_form_error_deviations_open(ctx, c, count, d));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *index, (void **)&index));
  size_t at = 0;
  for (size_t k = 0; k < model->parts; k++) {
    if (!is_of_part(model->part[k])) continue;
    FG_TRY_EXIT(fill_columns(ctx, c, model->part[k], d->columns + at * c->rows));
    for (size_t i = 0; i < model->part[k]->count; i++)
      index[at++] = fg_evidence_first_of(s, model, k) + i;
  }
  for (size_t i = 0; i < count; i++) {
    d->mean[i] = posterior.mean[index[i]];
    for (size_t k = 0; k < count; k++)
      d->lower[i * count + k] = posterior.covariance[index[i] * posterior.count + index[k]];
  }
  factorise_covariance(count, d->lower);
exit:
  if (status != FG_OK) fg_form_error_deviations_close(d);
  free(index);
  fg_evidence_posterior_close(&posterior);
  return status;
}

static fg_status find_moments(fg_context *ctx, fg_evidence_search *s, const fg_circles *c,
                              const fg_evidence_model *model, fg_form_error_moments *m) {
  fg_form_error_deviations d;
  FG_TRY(find_deviations(ctx, s, c, model, &d));
  fg_status status = fg_form_error_draw(ctx, c, &d, m);
  fg_form_error_deviations_close(&d);
  return status;
}

/* Models that deviations are averaged over, the likeliest first, with weights that sum to 1. */
typedef struct weighted_models {
  const fg_evidence_model *model[MODELS_MAX];
  double weight[MODELS_MAX];
  size_t count;
} weighted_models;

/* ---- deviations too small for a model ---- */

/* Returns true for an effect of the part that no model of weight shows. */
static bool is_hidden(const fg_evidence_option *option, const weighted_models *models) {
  if (!option->effect || !option->effect->midline || option->effect->starts) return false;
  for (size_t m = 0; m < models->count; m++)
    if ((!m || models->weight[m] >= SHARE_MIN) &&
        fg_evidence_holds(models->model[m], option->effect))
      return false;
  return true;
}

/* The likeliest model's moments, room behind them for those of a model with one effect more, and by
 * circle the uncertainty that hidden effects give. */
typedef struct hidden_effects {
  fg_form_error_moments likeliest, with_one_more;
  double *u_um;
} hidden_effects;

/* Widens by an effect of the part that the model lacks: mean square distance of the deviation with
 * it from that without. */
static fg_status widen_by_option(fg_context *ctx, fg_evidence_search *s, const fg_circles *c,
                                 const fg_evidence_model *model, const fg_evidence_option *option,
                                 hidden_effects *hidden) {
  fg_evidence_part part = {.effect = option->effect, .first = option->first, .count = option->each};
  fg_evidence_model with = *model;
  fg_form_error_moments *own = &hidden->with_one_more;
  fg_evidence_effect_variances(&s->request.prior, option->effect, option->each, part.variance);
  with.part[with.parts++] = &part;
  memset(own->mean, 0, FG_FORM_ERROR_MOMENTS * c->count * sizeof *own->mean);
  FG_TRY(find_moments(ctx, s, c, &with, own));
  for (size_t k = 0; k < c->count; k++) {
    double before = hidden->likeliest.mean[k];
    double square = own->square[k] - 2 * before * own->mean[k] + before * before;
    hidden->u_um[k] = fmax(hidden->u_um[k], sqrt(fmax(0, square)));
  }
  return FG_OK;
}

/* Uncertainty by effects of the part that the models lack, whether or not they are worth one: a
 * foil is not round because nothing was found. */
static fg_status find_hidden(fg_context *ctx, fg_evidence_search *s, const fg_circles *c,
                             const weighted_models *models, hidden_effects *hidden) {
  const fg_evidence_model *model = models->model[0];
  if (model->parts == FG_EVIDENCE_PARTS) return FG_OK;
  FG_TRY(find_moments(ctx, s, c, model, &hidden->likeliest));
  for (size_t o = 0; o < s->option_count; o++)
    if (is_hidden(&s->options[o], models))
      FG_TRY(widen_by_option(ctx, s, c, model, &s->options[o], hidden));
  return FG_OK;
}

/* ---- all models ---- */

/* Returns true where the models of such values and smaller ones have a share, and those of larger
 * ones: of many scanner's faults each may be unlikely, not one of them. */
static bool is_in_range(const fg_form_error_moments *m, size_t models, size_t circle,
                        double value) {
  double below = 0, above = 0;
  for (size_t k = 0; k < models; k++) {
    below += m[k].mean[circle] <= value ? m[k].weight : 0;
    above += m[k].mean[circle] >= value ? m[k].weight : 0;
  }
  return below >= SHARE_MIN && above >= SHARE_MIN;
}

/* One circle over all models. Where one takes for the part's what another takes for the scanner's,
 * there is a range and no value. */
static fg_form_error combine_models(const fg_form_error_moments *m, size_t models, size_t circle,
                                    double hidden) {
  double mean = 0, square = 0, low = INFINITY, high = 0, smallest = INFINITY, largest = 0;
  double within = 0, ends = 0;
  for (size_t k = 0; k < models; k++) {
    double own = m[k].mean[circle];
    double of_end = hypot(m[k].ends[circle], SHAPE_SHARE * own);
    double known = hypot(sqrt(fmax(0, m[k].square[circle] - own * own)), of_end);
    double sd = hypot(known, hidden);
    mean += m[k].weight * own;
    ends += m[k].weight * of_end * of_end;
    square += m[k].weight * m[k].square[circle];
    if (!is_in_range(m, models, circle, own)) continue;
    smallest = fmin(smallest, own);
    largest = fmax(largest, own);
    within = fmax(within, FG_COVERAGE_FACTOR * known);
    low = fmin(low, fmax(0, own - FG_COVERAGE_FACTOR * sd));
    high = fmax(high, own + FG_COVERAGE_FACTOR * sd);
  }
  double u = sqrt(fmax(0, square - mean * mean) + ends + hidden * hidden);
  if (largest - smallest > fmax(within, hidden) && smallest < OPEN_SHARE * largest)
    return (fg_form_error){.um = NAN, .u_um = NAN, .range_um = {low, high}};
  return (fg_form_error){.um = mean, .u_um = u};
}

static void list_models(const fg_evidence_search *s, const fg_evidence_verdict *verdict,
                        weighted_models *models) {
  bool named = verdict->outcome == FG_EVIDENCE_FOUND || verdict->outcome == FG_EVIDENCE_TIED;
  const fg_evidence_model *from = named ? verdict->tie : s->models;
  size_t available = named ? verdict->ties : s->count;
  double top = -INFINITY, total = 0;
  for (size_t m = 0; m < available; m++)
    top = fmax(top, from[m].score);
  models->count = 0;
  for (size_t m = 0; m < available && models->count < MODELS_MAX; m++) {
    double own = fmax(exp(from[m].score - top), named ? LISTED_MIN : 0);
    if (own < WEIGHT_MIN) continue;
    models->model[models->count] = &from[m];
    models->weight[models->count++] = own;
    total += own;
  }
  for (size_t m = 0; m < models->count; m++)
    models->weight[m] /= total;
}

fg_status fg_scan_loop_find_form_errors(fg_context *ctx, fg_scan_loop *loop, fg_evidence_search *s,
                                        const fg_evidence_verdict *verdict) {
  weighted_models models;
  double *numbers = NULL;
  fg_form_error_moments m[MODELS_MAX];
  fg_circles circles;
  fg_status status = FG_OK;
  list_models(s, verdict, &models);
  FG_TRY(fg_circles_open(ctx, &loop->edge_fit, &circles));
  /* of every model, of the likeliest again, and of it with one effect more */
  size_t each = FG_FORM_ERROR_MOMENTS * circles.count, count = models.count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, each * (count + 2) + circles.count, sizeof *numbers,
                                 (void **)&numbers));
  for (size_t k = 0; k < count; k++) {
    m[k] = fg_form_error_moments_in(numbers + k * each, &circles);
    m[k].weight = models.weight[k];
    FG_TRY_EXIT(find_moments(ctx, s, &circles, models.model[k], &m[k]));
  }
  hidden_effects hidden = {.likeliest = fg_form_error_moments_in(numbers + count * each, &circles),
                           .with_one_more =
                               fg_form_error_moments_in(numbers + (count + 1) * each, &circles),
                           .u_um = numbers + (count + 2) * each};
  FG_TRY_EXIT(find_hidden(ctx, s, &circles, &models, &hidden));
  if (!loop->form_errors)
    FG_TRY_EXIT(fg_memory_allocate(ctx, circles.count, sizeof *loop->form_errors,
                                   (void **)&loop->form_errors));
  for (size_t k = 0; k < circles.count; k++)
    loop->form_errors[k] = circles.first[k + 1] == circles.first[k] ? (fg_form_error){.um = 0}
                           : circles.cut[k] ? (fg_form_error){.um = NAN, .u_um = NAN}
                                            : combine_models(m, count, k, hidden.u_um[k]);
exit:
  free(numbers);
  fg_circles_close(&circles);
  return status;
}

/* ---- the set that is fitted ---- */

/* Finds the deviations by the effects of the part in force: coefficients with their uncertainties.
 */
static fg_status find_fitted(fg_context *ctx, const fg_circles *c, const fg_effect_set *set,
                             fg_form_error_moments *m) {
  fg_form_error_deviations d;
  size_t count = 0, at = 0;
  fg_status status = FG_OK;
  for (size_t e = 0; e < set->count; e++)
    count += set->effects[e].kind->midline ? set->effects[e].columns : 0;
  FG_TRY(fg_form_error_deviations_open(ctx, c, count, &d));
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    fg_evidence_part part = {.effect = effect->kind, .count = effect->columns};
    memcpy(part.shape, effect->shape, sizeof part.shape);
    if (!effect->kind->midline) continue;
    FG_TRY_EXIT(fill_columns(ctx, c, &part, d.columns + at * c->rows));
    for (size_t i = 0; i < effect->columns; i++, at++) {
      d.mean[at] = effect->coefficient_um[i];
      d.lower[at * count + at] = effect->u_coefficient_um[i];
    }
  }
  FG_TRY_EXIT(fg_form_error_draw(ctx, c, &d, m));
exit:
  fg_form_error_deviations_close(&d);
  return status;
}

/* A model has few bumps of their own shape, the set that is fitted may have a curve over all of
 * them: a larger deviation by it, beyond both uncertainties, is taken, and half of the difference
 * counts to u. */
static fg_status compare_with_set(fg_context *ctx, fg_scan_loop *loop) {
  fg_circles circles;
  double *numbers = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_circles_open(ctx, &loop->edge_fit, &circles));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_FORM_ERROR_MOMENTS * circles.count, sizeof *numbers,
                                 (void **)&numbers));
  fg_form_error_moments m = fg_form_error_moments_in(numbers, &circles);
  FG_TRY_EXIT(find_fitted(ctx, &circles, &loop->set, &m));
  for (size_t k = 0; k < circles.count; k++) {
    fg_form_error *error = &loop->form_errors[k];
    double own = m.mean[k], u = sqrt(fmax(0, m.square[k] - own * own) + m.ends[k] * m.ends[k]);
    if (!(own - error->um > FG_COVERAGE_FACTOR * hypot(u, error->u_um))) continue;
    *error = (fg_form_error){.um = own, .u_um = hypot(u, 0.5 * (own - error->um))};
  }
exit:
  free(numbers);
  fg_circles_close(&circles);
  return status;
}

/* ---- into the foils ---- */

/* Reasons why form errors have no value. */
typedef struct reasons {
  bool open, cut;
} reasons;

static void put_error(const fg_form_error *from, fg_form_error *to, reasons *why) {
  *to = *from;
  if (!isnan(from->um)) return;
  *(from->range_um[1] > 0 ? &why->open : &why->cut) = true;
}

static void put_in_foil(const fg_edge_fit_part *part, const fg_form_error *errors, fg_foil *foil,
                        reasons *why) {
  put_error(&errors[0], &foil->overall.form_error, why);
  for (size_t b = 0; b < foil->bump_count; b++)
    for (size_t k = 0; k < part->bump_count; k++)
      if (part->bumps[k].number == foil->bumps[b].number)
        put_error(&errors[1 + k], &foil->bumps[b].form_error, why);
}

static fg_status note_reasons(fg_context *ctx, fg_scan_loop *loop, const reasons *why) {
  if (why->open)
    FG_TRY(fg_scan_loop_bumps_note(ctx, &loop->bumps,
                                   "points: form errors are ranges: the edges cannot tell whether "
                                   "the foil or the scanner deviates from circles; scan the same "
                                   "foil again, turned by about 90 degrees"));
  if (!why->cut) return FG_OK;
  return fg_scan_loop_bumps_note(ctx, &loop->bumps,
                                 "points: the form error of a bump is not stated: more than a "
                                 "tenth of its arc is no circle at an end and passes for its "
                                 "fillet; is fillet_radius_mm of the design right?");
}

fg_status fg_scan_loop_put_form_errors(fg_context *ctx, fg_scan_loop *loop) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  reasons why = {false, false};
  if (edge_fit->discs || edge_fit->coarse) return FG_OK;
  if (!loop->form_errors)
    return fg_scan_loop_bumps_note(
        ctx, &loop->bumps,
        "points: form errors are not stated: there are too many bumps to "
        "weigh all causes; give fewer foils");
  FG_TRY(compare_with_set(ctx, loop));
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    size_t foil = (size_t)(view->foil - loop->before[view->scan].foils);
    if (foil >= loop->after[view->scan].foil_count) continue;
    put_in_foil(&edge_fit->parts[view->part],
                loop->form_errors + fg_circles_of_part(edge_fit, view->part),
                &loop->after[view->scan].foils[foil], &why);
  }
  return note_reasons(ctx, loop, &why);
}
