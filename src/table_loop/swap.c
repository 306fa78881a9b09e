/* SPDX-License-Identifier: GPL-3.0-or-later */
/* With the others fitted, would another candidate serve better in a claim's place? */
#include <math.h>
#include <string.h>

#include "table_loop/cycles.h"
#include "table_loop/serial.h"
#include "table_loop/step.h"

/* Deviate below which a claim explains nothing beside the others (one-sided 1 %), unless another
 * candidate reaches the second one in its place. */
static const double OWN_Z = 2.33, BEST_Z = 4;

static bool tied_with_correlation(const fg_loop_claim *claim, fg_loop_candidate *tied) {
  for (size_t i = 0; i < claim->aliases; i++)
    if (fg_engine_is_serial(&claim->alias[i].candidate)) {
      *tied = claim->alias[i].candidate;
      return true;
    }
  return false;
}

/* Drops correlation that later effects, or a curve, have made unnecessary: its p-value is that of
 * the state before them. */
static fg_status drop_correlation(fg_context *ctx, fg_engine_run *run) {
  for (size_t m = 0; m < run->result->claims; m++) {
    if (!fg_engine_is_serial(&run->result->claim[m].candidate)) continue;
    fg_engine_set others = run->set;
    double gain;
    fg_engine_set_remove(&others, m);
    FG_TRY(fg_engine_serial_gain(ctx, run, &others, &gain));
    bool others_explain = run->result->claims > 1 || run->has_curve;
    if (gain < FG_ENGINE_SERIAL_NEEDED && others_explain) fg_engine_drop_claim(run, m--);
  }
  return FG_OK;
}

/* A claim stays where another explains nothing beside it. */
static fg_status stays(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                       size_t own, size_t *best) {
  double p;
  FG_TRY(fg_engine_beside(ctx, &step->training, run->noise, &step->stand[own], &step->stand[*best],
                          &p));
  if (p >= FG_ENGINE_SHOWS || fg_engine_nearly(run, step, own, *best)) *best = own;
  return FG_OK;
}

fg_status fg_engine_swap(fg_context *ctx, fg_engine_run *run) {
  FG_TRY(drop_correlation(ctx, run));
  for (size_t m = 0; m < run->result->claims && run->result->claims > 1; m++) {
    fg_engine_set others = run->set;
    fg_engine_step step;
    fg_loop_claim *claim = &run->result->claim[m];
    if (fg_engine_is_outlier(&claim->candidate) || fg_engine_is_serial(&claim->candidate) ||
        fg_engine_has_orders(&claim->candidate))
      continue;
    fg_engine_set_remove(&others, m);
    FG_TRY(fg_engine_step_open(ctx, run, &others, false, &step));
    size_t best = 0, own = 0;
    for (size_t c = 0; c < run->candidates; c++) {
      if (fg_engine_same_candidate(&run->candidate[c], &claim->candidate)) own = c;
      if (fg_engine_is_noise(&run->candidate[c]) != fg_engine_is_noise(&claim->candidate)) continue;
      if (fg_engine_is_serial(&run->candidate[c])) continue;
      if (fg_engine_is_curve(&run->candidate[c]) || !isfinite(step.stand[c].z)) continue;
      if (!isfinite(step.stand[best].z) || step.stand[c].z > step.stand[best].z) best = c;
    }
    fg_status status = FG_OK;
    if (!(step.stand[own].z > OWN_Z) && !(step.stand[best].z > BEST_Z)) {
      fg_engine_drop_claim(run, m--);
      fg_engine_step_close(&step);
      continue;
    }
    bool mean = !fg_engine_is_noise(&claim->candidate);
    if (mean && best != own) status = stays(ctx, run, &step, own, &best);
    if (status == FG_OK && mean && step.stand[best].z > step.stand[own].z)
      status =
          fg_engine_simplify(ctx, &step.training, run->noise, step.stand, run->means, best, &best);
    if (status == FG_OK && mean) {
      size_t chosen = step.stand[best].z > step.stand[own].z ? best : own;
      claim->candidate = run->candidate[chosen];
      fg_loop_candidate tied;
      bool correlation = tied_with_correlation(claim, &tied);
      claim->aliases = claim->aliases_unlisted = 0;
      fg_engine_candidate_name(run->problem, &claim->candidate, claim->name);
      run->set.candidate[m] = claim->candidate;
      memcpy(run->set.shape[m], step.stand[chosen].shape, sizeof run->set.shape[m]);
      status = fg_engine_alias_class(ctx, &step.training, run->noise, step.stand, step.stands,
                                     &step.stand[chosen], claim);
      if (correlation) fg_engine_add_alias(run->problem, &tied, NAN, NAN, claim);
      claim->verdict = claim->aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
    }
    fg_engine_step_close(&step);
    FG_TRY(status);
    FG_TRY(fg_engine_refine(ctx, run->problem, run->train, run->noise, &run->set));
  }
  return FG_OK;
}
