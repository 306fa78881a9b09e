/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/displacement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "effect/columns.h"
#include "evidence/verdict.h"

/* Models of less weight than this, relative to the likeliest, change nothing. */
#define WEIGHT_MIN 1e-3
/* Weight of a model that the likeliest leads by FG_EVIDENCE_LEAD: models that a verdict does not
 * tell apart have weight. */
#define WEIGHT_AT_MARGIN 0.1

fg_point fg_displacement_at(const fg_displacement *d, fg_point at) {
  fg_point each[FG_RIVAL_COLUMNS], sum = {0, 0};
  for (size_t e = 0; e < d->effects; e++) {
    d->effect[e].effect->glass(&d->frame, d->effect[e].shape, at, each);
    for (size_t c = 0; c < d->effect[e].columns; c++) {
      sum.x += 1e-3 * d->effect[e].um[c] * each[c].x;
      sum.y += 1e-3 * d->effect[e].um[c] * each[c].y;
    }
  }
  for (size_t r = 0; r < d->rivals; r++) {
    size_t count = d->rival[r].rival->glass(&d->frame, at, each);
    for (size_t c = 0; c < count; c++) {
      sum.x += 1e-3 * d->rival[r].um[c] * each[c].x;
      sum.y += 1e-3 * d->rival[r].um[c] * each[c].y;
    }
  }
  return sum;
}

/* ---- the mean ---- */

const fg_effect *fg_evidence_glass_effect(const fg_evidence_part *part) {
  return part->effect->polynomial ? &fg_effect_powers[part->effect->axis] : part->effect;
}

static double *amplitudes_of_effect(const fg_evidence_part *part, fg_displacement *d) {
  const fg_effect *effect = fg_evidence_glass_effect(part);
  for (size_t e = 0; e < d->effects; e++)
    if (d->effect[e].effect == effect && d->effect[e].columns == part->count &&
        !memcmp(d->effect[e].shape, part->shape, sizeof part->shape))
      return d->effect[e].um;
  if (d->effects == FG_DISPLACEMENT_EFFECTS) return NULL;
  memset(&d->effect[d->effects], 0, sizeof d->effect[0]);
  d->effect[d->effects].effect = effect;
  d->effect[d->effects].columns = part->count;
  memcpy(d->effect[d->effects].shape, part->shape, sizeof part->shape);
  return d->effect[d->effects++].um;
}

static double *amplitudes_of_rival(const fg_rival *rival, fg_displacement *d) {
  for (size_t r = 0; r < d->rivals; r++)
    if (d->rival[r].rival == rival) return d->rival[r].um;
  if (d->rivals == FG_DISPLACEMENT_RIVALS) return NULL;
  memset(&d->rival[d->rivals], 0, sizeof d->rival[0]);
  d->rival[d->rivals].rival = rival;
  return d->rival[d->rivals++].um;
}

static void add_mean(const fg_evidence_search *s, const fg_evidence_model *model,
                     const fg_evidence_posterior *posterior, double weight, fg_displacement *d) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    if (!fg_evidence_is_of_scanner(part)) continue;
    double *um = part->effect ? amplitudes_of_effect(part, d) : amplitudes_of_rival(part->rival, d);
    if (um && part->rival && part->rival->stretch) um += part->stretch * part->count;
    const double *mean = posterior->mean + fg_evidence_first_of(s, model, k);
    for (size_t c = 0; um && c < part->count; c++)
      um[c] += weight * mean[c];
  }
}

static bool includes_listed(const fg_evidence_model *model, const fg_evidence_window *w) {
  for (size_t k = 0; k < w->count; k++)
    if (fg_evidence_includes(model, w->model[k])) return true;
  return false;
}

fg_status fg_evidence_list_window(fg_context *ctx, fg_evidence_search *s,
                                  const fg_evidence_model *found, fg_evidence_window *w) {
  double per_nat = found ? 1 : log(1 / WEIGHT_AT_MARGIN) / FG_EVIDENCE_LEAD, total = 0;
  w->count = 0;
  for (size_t m = 0; m < s->count && w->count < FG_EVIDENCE_WINDOW; m++) {
    const fg_evidence_model *model = &s->models[m];
    double below = w->count ? per_nat * (w->model[0]->score - model->score) : 0;
    bool defined;
    if (below > log(1 / WEIGHT_MIN)) break; /* sorted */
    if (includes_listed(model, w) || (found && !fg_evidence_includes(model, found))) continue;
    FG_TRY(fg_evidence_has_defining_columns(ctx, s, model, &defined));
    if (!defined) continue;
    w->model[w->count] = model;
    total += w->weight[w->count++] = exp(-below);
  }
  for (size_t m = 0; m < w->count; m++)
    w->weight[m] /= total;
  return FG_OK;
}

fg_status fg_evidence_find_displacement(fg_context *ctx, fg_evidence_search *s,
                                        const fg_evidence_window *w, fg_displacement *d,
                                        fg_displacement_part *parts) {
  fg_evidence_shift shift;
  fg_status status = FG_OK;
  *d = (fg_displacement){.frame = s->problem.edge_fit->frame};
  FG_TRY(fg_evidence_shift_open(ctx, s, &shift));
  for (size_t m = 0; m < w->count && status == FG_OK; m++) {
    fg_evidence_posterior posterior;
    FG_TRY_EXIT(fg_evidence_find_posterior(ctx, s, w->model[m], &posterior));
    add_mean(s, w->model[m], &posterior, w->weight[m], d);
    status = fg_evidence_shift_add_posterior(ctx, s, w->model[m], &posterior, w->weight[m], &shift);
    fg_evidence_posterior_close(&posterior);
  }
  fg_evidence_shift_spread(s->problem.edge_fit, &shift, NULL, parts);
exit:
  fg_evidence_shift_close(&shift);
  return status;
}
