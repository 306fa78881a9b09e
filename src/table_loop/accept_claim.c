/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Acceptance of a claim: its description, its place in the set, and the alias classes of findings
 * about the noise. */
#include "table_loop/accept_claim.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

#include "table_loop/serial.h"

void fg_engine_describe_claim(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                              fg_loop_claim *claim) {
  const fg_engine_judgement *judgement = &step->judgement;
  *claim = (fg_loop_claim){.candidate = step->stand[stand].candidate, .retained_share = 1};
  fg_engine_candidate_name(run->problem, &claim->candidate, claim->name);
  claim->cv_gain = claim->cv_gain_se = NAN;
  claim->p_value = fg_engine_stand_p(run, step, stand);
  if (stand == fg_engine_exchanged_rows(run))
    claim->p_value = fmin(claim->p_value, step->outlier.apart_p);
  if (stand < run->means)
    claim->retained_share = step->workspace.version[judgement->score[stand].version].share;
  else if (stand >= run->candidates)
    claim->retained_share = fmin(step->outlier.length, 1);
}

void fg_engine_take(fg_engine_run *run, const fg_engine_stand *stand, fg_loop_claim *claim) {
  fg_engine_set with;
  fg_engine_set_extend(run, stand, &with);
  claim->verdict = claim->aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
  run->set = with;
  run->result->claim[run->result->claims++] = *claim;
}

/* Ties correlation with effects of the mean beside which it is not needed: at most as many as a
 * class has room for, the best first. */
static fg_status tie_correlation(fg_context *ctx, const fg_engine_run *run,
                                 const fg_engine_step *step, fg_loop_claim *claim) {
  enum { TRIED = 2 * FG_LOOP_ALIASES };
  double below = INFINITY;
  for (size_t tried = 0; tried < TRIED; tried++) {
    size_t best = run->means;
    for (size_t c = 0; c < run->means; c++)
      if (step->stand[c].z < below && !fg_engine_is_curve(&run->candidate[c]) &&
          (best == run->means || step->stand[c].z > step->stand[best].z))
        best = c;
    if (best == run->means || !(fg_engine_stand_p(run, step, best) < FG_ENGINE_ALIAS_P)) break;
    below = step->stand[best].z;
    fg_engine_set with;
    double gain;
    fg_engine_set_extend(run, &step->stand[best], &with);
    FG_TRY(fg_engine_serial_gain(ctx, run, &with, &gain));
    if (gain < FG_ENGINE_SERIAL_NEEDED)
      fg_engine_add_alias(run->problem, &run->candidate[best], NAN, NAN, claim);
  }
  return FG_OK;
}

/* Two columns of random levels stand beside each other where one lies within the other; within the
 * problem's groups there is none. */
static bool nests(const fg_engine_run *run, const fg_loop_candidate *levels,
                  const fg_loop_candidate *held) {
  if (!fg_engine_is_levels(levels) || !fg_engine_is_levels(held) || run->problem->group_level)
    return false;
  return fg_engine_is_nested(run->problem, levels->a, held->a) ||
         fg_engine_is_nested(run->problem, held->a, levels->a);
}

bool fg_engine_may_join_noise(const fg_engine_run *run, size_t candidate) {
  const fg_loop_candidate *noise = &run->candidate[candidate];
  size_t levels = fg_engine_is_levels(noise);
  if (fg_engine_set_holds(&run->set, noise)) return false;
  for (size_t m = 0; m < run->set.count; m++) {
    const fg_loop_candidate *held = &run->set.candidate[m];
    bool series = fg_engine_is_serial(noise) || fg_engine_is_levels(noise);
    levels += fg_engine_is_levels(held);
    if (series && (fg_engine_is_levels(held) || fg_engine_is_serial(held)) &&
        !nests(run, noise, held))
      return false;
  }
  return levels <= 2;
}

bool fg_engine_is_random_factor(const fg_engine_run *run, size_t candidate) {
  const fg_loop_candidate *factor = &run->candidate[candidate];
  if (factor->effect->reads != FG_LOOP_READS_LEVELS || fg_engine_is_noise(factor)) return false;
  for (size_t c = run->means; c < run->candidates; c++)
    if (fg_engine_is_levels(&run->candidate[c]) && run->candidate[c].a == factor->a)
      return fg_engine_may_join_noise(run, c);
  return false;
}

/* Effects of the mean beside which the levels need not scatter: at most as many as a class has
 * room for, the best first. */
static fg_status tie_levels(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                            size_t winner, fg_loop_claim *claim) {
  enum { TRIED = 2 * FG_LOOP_ALIASES };
  double below = INFINITY;
  for (size_t tried = 0; tried < TRIED; tried++) {
    size_t best = run->means;
    for (size_t c = 0; c < run->means; c++)
      if (step->stand[c].z < below && !fg_engine_is_curve(&run->candidate[c]) &&
          run->candidate[c].a != claim->candidate.a &&
          (best == run->means || step->stand[c].z > step->stand[best].z))
        best = c;
    if (best == run->means || !(fg_engine_stand_p(run, step, best) < FG_ENGINE_ALIAS_P)) break;
    below = step->stand[best].z;
    fg_engine_set with;
    double z;
    fg_engine_set_extend(run, &step->stand[best], &with);
    FG_TRY(fg_engine_spread_beside(ctx, run, &with, &run->candidate[winner], &z));
    if (!(gsl_cdf_ugaussian_Q(z) < FG_ENGINE_ALIAS_P))
      fg_engine_add_alias(run->problem, &run->candidate[best], NAN, NAN, claim);
  }
  return FG_OK;
}

/* Other ways in which the scatter may change, beside which the winner's is not needed. */
static fg_status tie_spread(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                            size_t winner, fg_loop_claim *claim) {
  for (size_t c = run->means; c < run->candidates; c++) {
    fg_engine_set with;
    double z;
    if (c == winner || fg_engine_is_serial(&run->candidate[c]) ||
        fg_engine_is_levels(&run->candidate[c]) ||
        fg_engine_set_holds(&run->set, &run->candidate[c]) ||
        !(fg_engine_stand_p(run, step, c) < FG_ENGINE_ALIAS_P))
      continue;
    fg_engine_set_extend(run, &step->stand[c], &with);
    FG_TRY(fg_engine_spread_beside(ctx, run, &with, &run->candidate[winner], &z));
    double columns = (double)fg_engine_candidate_columns(run->problem, &run->candidate[winner]);
    if (gsl_cdf_chisq_Q(z * z, columns) > FG_LOOP_ACCEPT_P)
      fg_engine_add_alias(run->problem, &run->candidate[c], NAN, NAN, claim);
  }
  return FG_OK;
}

fg_status fg_engine_take_noise(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                               size_t winner, double p_value, bool *accepted) {
  fg_loop_claim claim;
  fg_engine_describe_claim(run, step, winner, &claim);
  claim.p_value = fmin(claim.p_value, p_value);
  if (fg_engine_is_serial(&claim.candidate))
    FG_TRY(tie_correlation(ctx, run, step, &claim));
  else if (fg_engine_is_levels(&claim.candidate))
    FG_TRY(tie_levels(ctx, run, step, winner, &claim));
  else
    FG_TRY(tie_spread(ctx, run, step, winner, &claim));
  fg_engine_take(run, &step->stand[winner], &claim);
  *accepted = true;
  return FG_OK;
}
