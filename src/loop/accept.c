/* Which effect a step accepts: the best claim that passes every gate, else a curve. */
#include <math.h>
#include <string.h>

#include "loop/step.h"

/* What comes after a first claim must be so many times as sure: its null leans on the first. */
enum { LATER_CLAIMS = 2 };
/* Beside an effect another one explains more when chance would do so less often than this
 * (what that finds and misses: reports/loop_tables.md). */
#define BESIDE_P 0.003
/* Beside the best outlier a claim still shows when chance would do as much less often than this:
 * milder than a claim, for the outlier has taken some of it. */
#define HINGE_P 0.02

static double bar(const fg_engine_run *run) {
  return run->options.accept_p / (run->set.count ? LATER_CLAIMS : 1);
}

/* The best of a family that passes; candidates that are in the set already are none. */
static bool best_passing(const fg_engine_run *run, const fg_engine_step *step, bool curves,
                         size_t *best) {
  bool found = false;
  for (size_t c = 0; c < run->candidates; c++) {
    const fg_engine_score *score = &step->judgement.score[c];
    if (fg_engine_is_curve(&run->candidate[c]) != curves || !isfinite(score->z)) continue;
    if (!(fg_engine_total_p(&step->judgement, c) < bar(run))) continue;
    if (found && score->z <= step->judgement.score[*best].z) continue;
    *best = c;
    found = true;
  }
  return found;
}

/* Nothing is judged at the noise that flatters the winner. */
static fg_engine_noise step_noise(const fg_engine_step *step) {
  return step->bench.noise[step->judgement.cautious_noise];
}

static void extend_set(const fg_engine_run *run, const fg_engine_stand *stand, fg_engine_set *set) {
  *set = run->set;
  if (run->has_curve) { /* the curve stays last */
    set->candidate[set->count] = set->candidate[set->count - 1];
    memcpy(set->shape[set->count], set->shape[set->count - 1], sizeof set->shape[0]);
    set->candidate[set->count - 1] = stand->candidate;
    memcpy(set->shape[set->count - 1], stand->shape, sizeof stand->shape);
  } else {
    set->candidate[set->count] = stand->candidate;
    memcpy(set->shape[set->count], stand->shape, sizeof stand->shape);
  }
  set->count++;
}

/* Moves a stand's shape off the grid of its start values. */
static fg_status sharpen(fg_context *ctx, const fg_engine_run *run, fg_engine_step *step,
                         size_t stand) {
  fg_engine_set with;
  extend_set(run, &step->stand[stand], &with);
  FG_TRY(fg_engine_refine(ctx, run->problem, run->train, step_noise(step), &with));
  memcpy(step->stand[stand].shape, with.shape[with.count - 1 - run->has_curve],
         sizeof step->stand[stand].shape);
  return FG_OK;
}

/* Unless another listed effect leaves the curve nothing to explain: levels of a die in turn look
 * like a wave over the foils. */
static fg_status right_form(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                            size_t curve, size_t *winner, bool *wrong) {
  double best = -INFINITY;
  for (size_t c = 0; c < run->candidates; c++) {
    double p;
    if (fg_engine_is_curve(&run->candidate[c]) || !isfinite(step->stand[c].z) ||
        !(fg_engine_total_p(&step->judgement, c) < bar(run)) || step->stand[c].z <= best)
      continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, fg_engine_step_noises(step).at, &step->stand[c],
                            &step->stand[curve], &p));
    if (p <= BESIDE_P) continue;
    best = step->stand[c].z;
    *winner = c;
    *wrong = false;
  }
  return FG_OK;
}

/* The best curve over the winner's coordinate explains what the winner does not: the form is not in
 * the table, whatever its nearest relative. */
static fg_status wrong_form(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                            size_t *winner, size_t *curve, bool *wrong) {
  const fg_loop_candidate *candidate = &step->stand[*winner].candidate;
  *wrong = false;
  if (candidate->effect->pair || run->has_curve) return FG_OK;
  double best = -INFINITY;
  for (size_t c = 0; c < run->candidates; c++) {
    double p;
    if (!fg_engine_is_curve(&run->candidate[c]) || run->candidate[c].a != candidate->a) continue;
    if (!isfinite(step->stand[c].z)) continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, fg_engine_step_noises(step).at,
                            &step->stand[*winner], &step->stand[c], &p));
    if (p > BESIDE_P || !(fg_engine_total_p(&step->judgement, c) < run->options.accept_p)) continue;
    if (step->stand[c].z > best) {
      best = step->stand[c].z;
      *curve = c;
      *wrong = true;
    }
  }
  return *wrong ? right_form(ctx, run, step, *curve, winner, wrong) : FG_OK;
}

static fg_status gate(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *with,
                      fg_engine_noise noise, double *gain, double *se, bool *passes) {
  FG_TRY(fg_engine_cross_validated_gain(ctx, run->problem, run->train, &run->set, with, noise, gain,
                                        se));
  *passes = *gain > *se;
  return FG_OK;
}

/* What hinges on one row is that row's doing: beside the best outlier it must still show. In groups
 * the flips see to that. */
static fg_status hinges_on_a_row(fg_context *ctx, const fg_engine_run *run,
                                 const fg_engine_step *step, size_t stand, bool *hinges) {
  *hinges = false;
  if (run->problem->group_level) return FG_OK;
  for (size_t s = run->candidates; s < step->stands && !*hinges; s++) {
    double p;
    if (fg_engine_is_exchange(&step->stand[s].candidate)) continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, fg_engine_step_noises(step).at, &step->stand[s],
                            &step->stand[stand], &p));
    *hinges = p > HINGE_P;
  }
  return FG_OK;
}

static fg_status take_curve(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                            size_t curve, bool *accepted) {
  fg_engine_set with;
  double gain, se;
  bool hinges;
  if (run->has_curve) return FG_OK;
  FG_TRY(hinges_on_a_row(ctx, run, step, curve, &hinges));
  if (hinges) return FG_OK;
  extend_set(run, &step->stand[curve], &with);
  FG_TRY(fg_engine_refine(ctx, run->problem, run->train, step_noise(step), &with));
  FG_TRY(gate(ctx, run, &with, step_noise(step), &gain, &se, accepted));
  if (!*accepted) return FG_OK;
  run->set = with;
  run->has_curve = true;
  run->curve_at = step->stand[curve].candidate.a;
  run->curve_p = fg_engine_total_p(&step->judgement, curve);
  return FG_OK;
}

/* The curve given, then the next best over the same coordinate: knots are chosen by what predicts.
 */
static fg_status take_best_curve(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                                 size_t curve, bool *accepted) {
  double below = step->stand[curve].z;
  size_t coordinate = step->stand[curve].candidate.a, next = curve;
  while (next < run->candidates) {
    FG_TRY(take_curve(ctx, run, step, next, accepted));
    if (*accepted) return FG_OK;
    double best = -INFINITY;
    next = run->candidates;
    for (size_t c = 0; c < run->candidates; c++) {
      double z = step->stand[c].z;
      if (!fg_engine_is_curve(&run->candidate[c]) || run->candidate[c].a != coordinate ||
          !(z < below) || !(z > best) || !(fg_engine_total_p(&step->judgement, c) < bar(run)))
        continue;
      best = z;
      next = c;
    }
    below = best;
  }
  return FG_OK;
}

static void describe(const fg_engine_run *run, const fg_engine_step *step, size_t winner,
                     fg_loop_claim *claim) {
  const fg_engine_judgement *judgement = &step->judgement;
  claim->candidate = step->stand[winner].candidate;
  fg_engine_candidate_name(run->problem, &claim->candidate, claim->name);
  claim->p_flip = claim->p_simulated = claim->cv_gain = claim->cv_gain_se = NAN;
  if (winner < run->candidates) {
    const fg_engine_version *version = &step->bench.version[judgement->score[winner].version];
    claim->p_value = fg_engine_total_p(judgement, winner);
    claim->p_flip = judgement->p_flip[winner];
    claim->p_simulated = judgement->p_simulated[winner];
    claim->retained_share = version->share;
    return;
  }
  const fg_engine_lone *lone = &step->lone[fg_engine_is_exchange(&claim->candidate)];
  claim->p_value = claim->p_simulated = lone->p_value;
  claim->retained_share = fmin(lone->length, 1);
}

static fg_status take_claim(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                            size_t winner, bool *accepted) {
  fg_loop_claim claim = {0};
  fg_engine_set with;
  fg_engine_noise noise = step_noise(step);
  describe(run, step, winner, &claim);
  extend_set(run, &step->stand[winner], &with);
  FG_TRY(fg_engine_refine(ctx, run->problem, run->train, noise, &with));
  if (!fg_engine_is_lone(&claim.candidate)) {
    bool passes, hinges;
    FG_TRY(hinges_on_a_row(ctx, run, step, winner, &hinges));
    if (hinges) return FG_OK;
    FG_TRY(gate(ctx, run, &with, noise, &claim.cv_gain, &claim.cv_gain_se, &passes));
    if (!passes) return FG_OK;
  }
  fg_engine_stand refined = step->stand[winner];
  memcpy(refined.shape, with.shape[with.count - 1 - run->has_curve], sizeof refined.shape);
  FG_TRY(fg_engine_alias_class(ctx, &step->training, fg_engine_step_noises(step).at, step->stand,
                               step->stands, &refined, &claim));
  claim.verdict = claim.aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
  run->set = with;
  run->result->claim[run->result->claims++] = claim;
  *accepted = true;
  return FG_OK;
}

/* Lone rows that pass, when they explain at least as much as the best candidate. */
static bool lone_first(const fg_engine_run *run, const fg_engine_step *step, bool listed,
                       size_t best, size_t *winner) {
  double ratio = listed ? step->judgement.score[best].ratio : 1;
  bool found = false;
  for (size_t s = run->candidates; s < step->stands; s++) {
    const fg_engine_lone *lone = &step->lone[fg_engine_is_exchange(&step->stand[s].candidate)];
    if (lone->p_value < bar(run) && lone->ratio <= ratio) {
      ratio = lone->ratio;
      *winner = s;
      found = true;
    }
  }
  return found;
}

/* A second form over a coordinate that a claim lives on already: two forms that the table lists
 * make one that it does not. The claim gives way to a curve, where one serves. */
static fg_status second_form(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                             size_t winner, bool *accepted) {
  const fg_loop_candidate *candidate = &step->stand[winner].candidate;
  size_t m = 0, best = run->candidates;
  if (candidate->effect->pair || run->has_curve) return FG_OK;
  while (m < run->result->claims &&
         (run->set.candidate[m].effect->pair || fg_engine_is_lone(&run->set.candidate[m]) ||
          run->set.candidate[m].a != candidate->a))
    m++;
  if (m == run->result->claims) return FG_OK;
  fg_engine_run without = *run;
  fg_engine_step other;
  fg_engine_set_remove(&without.set, m);
  FG_TRY(fg_engine_step_open(ctx, &without, &without.set, true, &other));
  for (size_t c = 0; c < run->candidates; c++)
    if (fg_engine_is_curve(&run->candidate[c]) && run->candidate[c].a == candidate->a &&
        fg_engine_total_p(&other.judgement, c) < run->options.accept_p &&
        (best == run->candidates || other.stand[c].z > other.stand[best].z))
      best = c;
  fg_status status = FG_OK;
  if (best < run->candidates) status = take_best_curve(ctx, &without, &other, best, accepted);
  if (status == FG_OK && *accepted) {
    fg_engine_drop_claim(run, m);
    *run = without;
  }
  fg_engine_step_close(&other);
  return status;
}

static fg_status decide(fg_context *ctx, fg_engine_run *run, fg_engine_step *step, bool *accepted) {
  size_t winner = 0, curve = 0;
  bool listed = best_passing(run, step, false, &winner), wrong = false;
  if (lone_first(run, step, listed, winner, &winner))
    return take_claim(ctx, run, step, winner, accepted);
  if (listed) {
    FG_TRY(sharpen(ctx, run, step, winner));
    FG_TRY(wrong_form(ctx, run, step, &winner, &curve, &wrong));
    if (wrong) FG_TRY(take_best_curve(ctx, run, step, curve, accepted));
    if (wrong && *accepted) return FG_OK;
    FG_TRY(fg_engine_simplify(ctx, &step->training, fg_engine_step_noises(step).at, step->stand,
                              run->candidates, winner, &winner));
    FG_TRY(second_form(ctx, run, step, winner, accepted));
    if (!*accepted) FG_TRY(take_claim(ctx, run, step, winner, accepted));
    if (*accepted) return FG_OK;
  }
  if (best_passing(run, step, true, &curve))
    return take_best_curve(ctx, run, step, curve, accepted);
  return FG_OK;
}

fg_status fg_engine_accept_one(fg_context *ctx, fg_engine_run *run, bool *accepted, bool *last) {
  fg_engine_step step;
  *accepted = false;
  FG_TRY(fg_engine_step_open(ctx, run, &run->set, true, &step));
  run->result->smallest_p = step.judgement.smallest_p;
  fg_status status = decide(ctx, run, &step, accepted);
  *last = !*accepted;
  fg_engine_step_close(&step);
  return status;
}
