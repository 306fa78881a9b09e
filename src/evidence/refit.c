/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/refit.h"

#include <math.h>

#include "evidence/fit.h"

/* Sweeps over a model at most, and the gain from which there is another. */
enum { SWEEPS = 3 };
#define GAIN_MIN 0.5

/* Fits part k beside the others of the model. */
static fg_status refit_part(fg_context *ctx, fg_evidence_search *s, fg_evidence_model *model,
                            size_t k) {
  if (s->stored == FG_EVIDENCE_STORE) return FG_OK;
  fg_evidence_model others = *model;
  fg_evidence_part *part = &s->store[s->stored];
  fg_evidence_factor factor;
  double evidence = model->evidence;
  others.part[k] = others.part[--others.parts];
  *part = *model->part[k];
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, &others, &factor));
  fg_status status = fg_evidence_refit_effect(ctx, s, &factor, part, &evidence);
  fg_evidence_factor_close(&factor);
  if (status != FG_OK || !(evidence > model->evidence)) return status;
  s->stored++;
  model->score += evidence - model->evidence;
  model->evidence = evidence;
  model->part[k] = part;
  return FG_OK;
}

fg_status fg_evidence_refit_model(fg_context *ctx, fg_evidence_search *s,
                                  fg_evidence_model *model) {
  double before = -INFINITY;
  for (int sweep = 0; sweep < SWEEPS && model->score > before + GAIN_MIN; sweep++) {
    before = model->score;
    for (size_t k = 0; k < model->parts; k++)
      if (model->part[k]->effect) FG_TRY(refit_part(ctx, s, model, k));
  }
  return FG_OK;
}
