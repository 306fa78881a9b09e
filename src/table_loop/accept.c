/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choice of the effect that a step accepts: the best claim that passes every gate, else a curve. */
#include <math.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "table_loop/accept_claim.h"
#include "table_loop/cycles.h"
#include "table_loop/exchange_columns.h"
#include "table_loop/serial.h"
#include "table_loop/step.h"

/* Factor by which the level is lowered after a first claim, on which the later null depends. */
enum { LATER_CLAIMS = 2 };
/* P-value at which an effect explains more beside another one (power and errors:
 * reports/loop_power.md). */
#define BESIDE_P 0.003
/* P-value that a claim needs beside the largest outlier: milder than a claim's, because the outlier
 * has absorbed part of it. */
#define HINGE_P 0.02

/* Share of the residual sum left, below which outlier rows are no matter of a scatter that changes:
 * they make most of it. */
#define HALF_OF_ALL 0.5

typedef enum family {
  LISTED,
  CURVES,
  NOISE,
} family;

static double bar(const fg_engine_run *run) {
  return run->options.accept_p / (run->set.count ? LATER_CLAIMS : 1);
}

static family family_of(const fg_loop_candidate *candidate) {
  if (fg_engine_is_noise(candidate)) return NOISE;
  return fg_engine_is_curve(candidate) ? CURVES : LISTED;
}

/* The best of a family that passes; candidates that are in the set already are none. */
static bool best_passing(const fg_engine_run *run, const fg_engine_step *step, family which,
                         size_t *best) {
  bool found = false;
  for (size_t c = 0; c < run->candidates; c++) {
    double z = step->stand[c].z;
    if (family_of(&run->candidate[c]) != which || !isfinite(z)) continue;
    if (which == NOISE && !fg_engine_may_join_noise(run, c)) continue;
    if (which == LISTED && fg_engine_is_random_factor(run, c)) continue;
    if (!(fg_engine_stand_p(run, step, c) < bar(run))) continue;
    if (found && z <= step->stand[*best].z) continue;
    *best = c;
    found = true;
  }
  return found;
}

/* Estimates the noise beside a stand. */
static fg_status noise_beside(fg_context *ctx, const fg_engine_run *run,
                              const fg_engine_stand *stand, fg_engine_noise *noise) {
  fg_engine_set with;
  fg_engine_set_extend(run, stand, &with);
  *noise = (fg_engine_noise){0};
  return fg_engine_fit_set(ctx, run->problem, run->train, &with, true, noise, NULL, NULL, NULL);
}

/* Refines a stand's shape off the grid of its start values. */
static fg_status refine_stand(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise,
                              fg_engine_stand *stand) {
  fg_engine_set with;
  fg_engine_set_extend(run, stand, &with);
  FG_TRY(fg_engine_refine(ctx, run->problem, run->train, noise, &with));
  memcpy(stand->shape, with.shape[with.count - 1 - run->has_curve], sizeof stand->shape);
  return FG_OK;
}

/* A curve that passes, and the listed effect that would be taken. */
typedef struct basis_choice {
  size_t winner, curve;
  bool wrong; /* the winner's basis is not the true one: the curve is right */
  bool pair;  /* the winner is right, beside a second effect that is still in the residual */
  fg_engine_noise noise;
} basis_choice;

/* Keeps the winner when another listed effect leaves the curve nothing to explain: levels of
 * alternating dies look like a wave over the foils. */
static fg_status right_basis(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                             basis_choice *choice) {
  double best = -INFINITY;
  for (size_t c = 0; c < run->means; c++) {
    double p;
    if (fg_engine_is_curve(&run->candidate[c]) || !isfinite(step->stand[c].z) ||
        !(fg_engine_stand_p(run, step, c) < bar(run)) || step->stand[c].z <= best)
      continue;
    fg_engine_stand listed;
    fg_engine_cycle_with_others(run, step, c, &listed);
    FG_TRY(fg_engine_beside(ctx, &step->training, choice->noise, &listed,
                            &step->stand[choice->curve], &p));
    if (p <= BESIDE_P) continue;
    best = step->stand[c].z;
    choice->winner = c;
    choice->wrong = false;
  }
  return FG_OK;
}

/* Returns the best listed effect over a coordinate that passes a step; run->means: there is none.
 * Only cycles where `cycles` is set. */
static size_t best_over(const fg_engine_run *run, const fg_engine_step *step, size_t coordinate,
                        bool cycles) {
  size_t best = run->means;
  for (size_t c = 0; c < run->means; c++) {
    const fg_loop_candidate *candidate = &run->candidate[c];
    if (fg_engine_is_curve(candidate) || candidate->effect->pair || candidate->a != coordinate ||
        (cycles && !candidate->effect->cycle) || !isfinite(step->stand[c].z) ||
        !(fg_engine_stand_p(run, step, c) < bar(run)))
      continue;
    if (best == run->means || step->stand[c].z > step->stand[best].z) best = c;
  }
  return best;
}

/* Share of a column's range that a cycle's period may have: one that does not return is any curve.
 */
#define RETURNS_WITHIN 0.55

static bool returns(const fg_engine_run *run, const fg_engine_stand *stand) {
  const fg_loop_coordinate *at = &run->problem->coordinate[stand->candidate.a];
  return stand->candidate.effect->cycle && stand->shape[0] <= RETURNS_WITHIN * (at->high - at->low);
}

/* Keeps the winner when a second listed effect beside it leaves no curve anything to explain: a
 * cycle of few turns on a trend or a step looks like a curve. */
static fg_status right_pair(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                            basis_choice *choice) {
  const fg_loop_candidate *winner = &step->stand[choice->winner].candidate;
  fg_engine_run beside = *run;
  fg_engine_step other;
  fg_engine_noise noise;
  double p = 0;
  if (run->set.count + 1 > FG_LOOP_CLAIMS) return FG_OK;
  fg_engine_set_extend(run, &step->stand[choice->winner], &beside.set);
  FG_TRY(fg_engine_step_open(ctx, &beside, &beside.set, false, &other));
  fg_status status = FG_OK;
  size_t second = best_over(&beside, &other, winner->a, !winner->effect->cycle);
  if (second == run->means) goto exit;
  FG_TRY_EXIT(noise_beside(ctx, &beside, &other.stand[second], &noise));
  FG_TRY_EXIT(refine_stand(ctx, &beside, noise, &other.stand[second]));
  if (!returns(run, &step->stand[choice->winner]) && !returns(run, &other.stand[second])) goto exit;
  choice->wrong = false;
  for (size_t c = 0; c < run->means && !choice->wrong; c++) {
    if (!fg_engine_is_curve(&run->candidate[c]) || run->candidate[c].a != winner->a ||
        !isfinite(other.stand[c].z))
      continue;
    FG_TRY_EXIT(
        fg_engine_beside(ctx, &other.training, noise, &other.stand[second], &other.stand[c], &p));
    choice->wrong = p <= BESIDE_P;
  }
  choice->pair = !choice->wrong;
exit:
  fg_engine_step_close(&other);
  return status;
}

/* Tests whether the best curve over the winner's coordinate explains more than the winner: then the
 * true basis is not in the table. */
static fg_status wrong_basis(fg_context *ctx, const fg_engine_run *run, const fg_engine_step *step,
                             basis_choice *choice) {
  fg_engine_stand winner;
  fg_engine_cycle_with_others(run, step, choice->winner, &winner);
  choice->wrong = false;
  if (winner.candidate.effect->pair || run->has_curve) return FG_OK;
  double best = -INFINITY;
  for (size_t c = 0; c < run->means; c++) {
    double p;
    if (!fg_engine_is_curve(&run->candidate[c]) || run->candidate[c].a != winner.candidate.a)
      continue;
    if (!isfinite(step->stand[c].z)) continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, choice->noise, &winner, &step->stand[c], &p));
    if (p > BESIDE_P || !(fg_engine_stand_p(run, step, c) < run->options.accept_p)) continue;
    if (step->stand[c].z > best) {
      best = step->stand[c].z;
      choice->curve = c;
      choice->wrong = true;
    }
  }
  if (choice->wrong) FG_TRY(right_basis(ctx, run, step, choice));
  return choice->wrong ? right_pair(ctx, run, step, choice) : FG_OK;
}

static fg_status gate(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *with,
                      fg_engine_noise noise, fg_loop_claim *claim, bool *passes) {
  FG_TRY(fg_engine_cross_validated_gain(ctx, run->problem, run->train, &run->set, with, noise,
                                        &claim->cv_gain, &claim->cv_gain_se));
  *passes = claim->cv_gain > claim->cv_gain_se;
  return FG_OK;
}

/* Tests whether a claim depends on one row: it must stay significant beside the row with the
 * largest residual. */
static fg_status hinges_on_a_row(fg_context *ctx, const fg_engine_run *run,
                                 const fg_engine_step *step, fg_engine_noise noise, size_t stand,
                                 bool *hinges) {
  double p;
  *hinges = false;
  if (run->problem->group_level || !step->outlier.known) return FG_OK;
  const fg_engine_stand row = {.candidate = step->outlier.first};
  FG_TRY(fg_engine_beside(ctx, &step->training, noise, &row, &step->stand[stand], &p));
  *hinges = p > HINGE_P;
  return FG_OK;
}

static fg_status take_curve(fg_context *ctx, fg_engine_run *run, fg_engine_step *step, size_t curve,
                            bool *accepted) {
  fg_engine_set with;
  fg_engine_noise noise;
  fg_loop_claim unused = {0};
  bool hinges;
  if (run->has_curve || run->set.count > FG_LOOP_CLAIMS) return FG_OK;
  FG_TRY(noise_beside(ctx, run, &step->stand[curve], &noise));
  FG_TRY(hinges_on_a_row(ctx, run, step, noise, curve, &hinges));
  if (hinges) return FG_OK;
  FG_TRY(refine_stand(ctx, run, noise, &step->stand[curve]));
  fg_engine_set_extend(run, &step->stand[curve], &with);
  FG_TRY(gate(ctx, run, &with, noise, &unused, accepted));
  if (!*accepted) return FG_OK;
  run->set = with;
  run->has_curve = true;
  run->curve_at = step->stand[curve].candidate.a;
  run->curve_p = fg_engine_stand_p(run, step, curve);
  return FG_OK;
}

/* Accepts the given curve, or the next best one over the same coordinate: cross-validation chooses
 * the knots. */
static fg_status accept_best_curve(fg_context *ctx, fg_engine_run *run, fg_engine_step *step,
                                   size_t curve, bool *accepted) {
  double below = step->stand[curve].z;
  size_t coordinate = step->stand[curve].candidate.a, next = curve;
  while (next < run->means) {
    FG_TRY(take_curve(ctx, run, step, next, accepted));
    if (*accepted) return FG_OK;
    double best = -INFINITY;
    next = run->means;
    for (size_t c = 0; c < run->means; c++) {
      double z = step->stand[c].z;
      if (!fg_engine_is_curve(&run->candidate[c]) || run->candidate[c].a != coordinate ||
          !(z < below) || !(z > best) || !(fg_engine_stand_p(run, step, c) < bar(run)))
        continue;
      best = z;
      next = c;
    }
    below = best;
  }
  return FG_OK;
}

static fg_status take_claim(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                            size_t winner, bool or_correlation, bool *accepted) {
  fg_loop_claim claim;
  fg_engine_set with;
  fg_engine_noise noise;
  fg_engine_stand refined = step->stand[winner];
  fg_engine_describe_claim(run, step, winner, &claim);
  FG_TRY(noise_beside(ctx, run, &refined, &noise));
  FG_TRY(refine_stand(ctx, run, noise, &refined));
  if (fg_engine_is_outlier(&claim.candidate)) {
    FG_TRY(fg_engine_find_exchanged_columns(ctx, run, noise, &refined.candidate));
    claim.candidate = refined.candidate;
    fg_engine_candidate_name(run->problem, &claim.candidate, claim.name);
  } else {
    bool passes, hinges;
    FG_TRY(hinges_on_a_row(ctx, run, step, noise, winner, &hinges));
    if (hinges) return FG_OK;
    fg_engine_set_extend(run, &refined, &with);
    FG_TRY(gate(ctx, run, &with, noise, &claim, &passes));
    if (!passes) return FG_OK;
  }
  if (or_correlation)
    fg_engine_add_alias(run->problem, &run->candidate[fg_engine_serial_candidate(run)], NAN, NAN,
                        &claim);
  FG_TRY(fg_engine_alias_class(ctx, &step->training, noise, step->stand, step->stands, &refined,
                               &claim));
  fg_engine_take(run, &refined, &claim);
  *accepted = true;
  return FG_OK;
}

/* Returns true when the outlier rows are two exchanged ones, or one of them: the exchange explains
 * as much without any parameter. A heavy tail would not make them fit in each other's places. */
static bool is_of_exchange(const fg_engine_run *run, const fg_engine_step *step) {
  const fg_loop_candidate *wrong = &step->outlier.candidate;
  const fg_engine_stand *exchange = &step->stand[fg_engine_exchanged_rows(run)];
  if (!isfinite(exchange->z) || wrong->rows > 2) return false;
  for (size_t k = 0; k < wrong->rows; k++)
    if (wrong->row[k] != exchange->candidate.row[0] && wrong->row[k] != exchange->candidate.row[1])
      return false;
  double dof = fmax((double)step->workspace.dof - 2, 1);
  /* Two wrong rows have two numbers of their own. */
  double slack = 1 + 2 * gsl_cdf_fdist_Qinv(BESIDE_P, 2, dof) / dof;
  if (wrong->rows < 2) slack = 1;
  return step->judgement.exchange_ratio <= slack * step->outlier.ratio;
}

/* Returns true when significant outlier rows explain at least as much as the best candidate. */
static bool outlier_first(const fg_engine_run *run, const fg_engine_step *step, bool listed,
                          size_t best, size_t *winner) {
  double ratio = listed ? step->judgement.score[best].ratio : 1;
  size_t wrong = fg_engine_wrong_rows(run), exchange = fg_engine_exchanged_rows(run);
  bool found = false;
  if (isfinite(step->stand[wrong].z) && step->outlier.ratio <= ratio) {
    bool of_exchange =
        is_of_exchange(run, step) && fg_engine_stand_p(run, step, exchange) < FG_LOOP_SUSPECTED_P;
    *winner = of_exchange ? exchange : wrong;
    if (step->outlier.p_value < bar(run)) return true;
  }
  if (isfinite(step->stand[exchange].z) && fg_engine_stand_p(run, step, exchange) < bar(run) &&
      step->judgement.exchange_ratio <= ratio) {
    *winner = exchange;
    found = true;
  }
  return found;
}

/* Drifts and cycles stand beside other effects of their coordinate. */
static bool stands_beside_others(const fg_engine_run *run, const fg_loop_candidate *candidate) {
  return candidate->effect->cycle || fg_engine_is_over_order(run->problem, candidate);
}

/* Handles a second basis over a claim's coordinate: two listed bases suggest one that is not
 * listed. A curve replaces the claim if one fits. */
static fg_status second_basis(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                              size_t winner, bool *accepted) {
  const fg_loop_candidate *candidate = &step->stand[winner].candidate;
  size_t m = 0, best = run->means;
  if (candidate->effect->pair || run->has_curve || stands_beside_others(run, candidate))
    return FG_OK;
  while (m < run->result->claims &&
         (run->set.candidate[m].effect->pair || fg_engine_is_outlier(&run->set.candidate[m]) ||
          fg_engine_is_noise(&run->set.candidate[m]) || run->set.candidate[m].a != candidate->a ||
          stands_beside_others(run, &run->set.candidate[m])))
    m++;
  if (m == run->result->claims) return FG_OK;
  fg_engine_run without = *run;
  fg_engine_step other;
  fg_engine_set_remove(&without.set, m);
  FG_TRY(fg_engine_step_open(ctx, &without, &without.set, true, &other));
  for (size_t c = 0; c < run->means; c++)
    if (fg_engine_is_curve(&run->candidate[c]) && run->candidate[c].a == candidate->a &&
        fg_engine_stand_p(run, &other, c) < run->options.accept_p &&
        (best == run->means || other.stand[c].z > other.stand[best].z))
      best = c;
  fg_status status = FG_OK;
  if (best < run->means) status = accept_best_curve(ctx, &without, &other, best, accepted);
  if (status == FG_OK && *accepted) {
    fg_engine_drop_claim(run, m);
    *run = without;
  }
  fg_engine_step_close(&other);
  return status;
}

/* Replaces a basis with a sought place or period, over an order that any table has, by a recorded
 * column without such parameters that explains as much. */
static fg_status prefer_recorded(fg_context *ctx, const fg_engine_run *run,
                                 const fg_engine_step *step, fg_engine_noise noise,
                                 size_t *winner) {
  const fg_engine_stand *searched = &step->stand[*winner];
  size_t recorded = run->means, fewest = SIZE_MAX;
  double best = -INFINITY;
  if (!searched->candidate.effect->shapes) return FG_OK;
  for (size_t c = 0; c < run->means; c++) {
    const fg_loop_effect *effect = run->candidate[c].effect;
    size_t columns = fg_engine_candidate_columns(run->problem, &run->candidate[c]);
    bool better = columns < fewest || (columns == fewest && step->stand[c].z > best);
    double p;
    if (effect->shapes || effect->unattributed ||
        fg_engine_is_over_order(run->problem, &run->candidate[c]) || !better ||
        !(fg_engine_stand_p(run, step, c) < bar(run)))
      continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, noise, &step->stand[c], searched, &p));
    if (p < FG_ENGINE_SHOWS && !fg_engine_nearly(run, step, c, *winner)) continue;
    best = step->stand[c].z;
    fewest = columns;
    recorded = c;
  }
  if (recorded < run->means) *winner = recorded;
  return FG_OK;
}

/* Refines what may be a simpler form of the winner: on the grid of its start values a cycle leaves
 * levels of its places something to explain. */
static fg_status refine_simpler(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise,
                                size_t winner, fg_engine_step *step) {
  const fg_loop_candidate *whole = &step->stand[winner].candidate;
  if (whole->effect->shapes || whole->effect->pair) return FG_OK;
  for (size_t c = 0; c < run->means; c++) {
    const fg_loop_candidate *part = &run->candidate[c];
    if (part->a == whole->a && part->effect->shapes && !part->effect->pair &&
        fg_engine_stand_p(run, step, c) < bar(run))
      FG_TRY(refine_stand(ctx, run, noise, &step->stand[c]));
  }
  return FG_OK;
}

/* Accepts the listed winner, or the effect that replaces it. */
static fg_status decide_listed(fg_context *ctx, fg_engine_run *run, fg_engine_step *step,
                               size_t winner, bool *accepted) {
  basis_choice choice = {.winner = winner};
  FG_TRY(noise_beside(ctx, run, &step->stand[winner], &choice.noise));
  FG_TRY(refine_stand(ctx, run, choice.noise, &step->stand[winner]));
  FG_TRY(prefer_recorded(ctx, run, step, choice.noise, &choice.winner));
  FG_TRY(fg_engine_prefer_base(ctx, run, step, choice.noise, &choice.winner));
  FG_TRY(wrong_basis(ctx, run, step, &choice));
  size_t stand = choice.wrong ? choice.curve : choice.winner;
  fg_engine_serial_word word = FG_ENGINE_EFFECT;
  if (!choice.pair)
    FG_TRY(
        fg_engine_weigh_serial(ctx, run, &step->stand[stand], stand, run->options.accept_p, &word));
  size_t serial = fg_engine_serial_candidate(run);
  if (word == FG_ENGINE_EITHER) {
    bool effect;
    FG_TRY(fg_engine_likelier(ctx, run, &step->stand[stand], &effect));
    bool shows = fg_engine_stand_p(run, step, serial) < bar(run);
    if (shows && (!effect || choice.wrong)) word = FG_ENGINE_CORRELATION;
  }
  if (word == FG_ENGINE_CORRELATION)
    return fg_engine_take_noise(ctx, run, step, serial, fg_engine_stand_p(run, step, stand),
                                accepted);
  if (choice.wrong) FG_TRY(accept_best_curve(ctx, run, step, choice.curve, accepted));
  if (choice.wrong && *accepted) return FG_OK;
  FG_TRY(refine_simpler(ctx, run, choice.noise, choice.winner, step));
  FG_TRY(fg_engine_simplify(ctx, &step->training, choice.noise, step->stand, run->means,
                            choice.winner, &choice.winner));
  FG_TRY(second_basis(ctx, run, step, choice.winner, accepted));
  if (*accepted) return FG_OK;
  return take_claim(ctx, run, step, choice.winner, word == FG_ENGINE_EITHER, accepted);
}

static fg_status decide_curve(fg_context *ctx, fg_engine_run *run, fg_engine_step *step,
                              size_t curve, bool *accepted) {
  fg_engine_serial_word word;
  FG_TRY(
      fg_engine_weigh_serial(ctx, run, &step->stand[curve], curve, run->options.accept_p, &word));
  if (word != FG_ENGINE_EFFECT)
    return fg_engine_take_noise(ctx, run, step, fg_engine_serial_candidate(run),
                                fg_engine_stand_p(run, step, curve), accepted);
  return accept_best_curve(ctx, run, step, curve, accepted);
}

static fg_status decide(fg_context *ctx, fg_engine_run *run, fg_engine_step *step, bool *accepted) {
  size_t winner = 0, curve = 0, noise = 0, outlier = 0;
  bool listed = best_passing(run, step, LISTED, &winner);
  bool scatter = best_passing(run, step, NOISE, &noise);
  bool spread = scatter && !fg_engine_is_serial(&run->candidate[noise]);
  bool rows_first = outlier_first(run, step, listed, winner, &outlier);
  bool of_scatter = rows_first && scatter && step->outlier.ratio > HALF_OF_ALL &&
                    step->judgement.p[noise] < fg_engine_stand_p(run, step, outlier);
  if (rows_first && !of_scatter) return take_claim(ctx, run, step, outlier, false, accepted);
  if (spread && (!listed || step->stand[noise].z > step->stand[winner].z))
    return fg_engine_take_noise(ctx, run, step, noise, 1, accepted);
  if (listed) FG_TRY(decide_listed(ctx, run, step, winner, accepted));
  if (!*accepted && best_passing(run, step, CURVES, &curve))
    FG_TRY(decide_curve(ctx, run, step, curve, accepted));
  if (!*accepted && scatter) FG_TRY(fg_engine_take_noise(ctx, run, step, noise, 1, accepted));
  return FG_OK;
}

fg_status fg_engine_accept_one(fg_context *ctx, fg_engine_run *run, bool *accepted, bool *last) {
  fg_engine_step step;
  *accepted = false;
  FG_TRY(fg_engine_step_open(ctx, run, &run->set, true, &step));
  if (run->set.count == 0) {
    run->result->family_p = 1;
    for (size_t s = 0; s < step.stands; s++)
      if (isfinite(step.stand[s].z))
        run->result->family_p = fmin(run->result->family_p, fg_engine_stand_p(run, &step, s));
  }
  fg_status status = decide(ctx, run, &step, accepted);
  *last = !*accepted;
  fg_engine_step_close(&step);
  return status;
}
