/* Candidates that were not claimed: what they would have explained, what would have shown, and the
 * measurement that would part a tie. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "loop/run.h"

/* Normal quantiles of a power of 80 %, and of the surplus test of an alias (p = 0.002). */
static const double power_80 = 0.8416, surplus = 3.09;

/* Amplitude a with a² |M W f|² / s² = (sqrt(k F) + 0.84)²: found four times in five. */
static double detectable(double f_critical, double k, double sd_white, double length) {
  if (!isfinite(f_critical) || !(length > 0)) return NAN;
  return (sqrt(k * f_critical) + power_80) * sd_white / sqrt(length);
}

static bool is_claimed(const loop_run *run, const fg_loop_candidate *candidate) {
  for (size_t m = 0; m < run->result->claims; m++)
    if (loop_same_candidate(&run->result->claim[m].candidate, candidate)) return true;
  return false;
}

static bool is_alias(const loop_run *run, const fg_loop_candidate *candidate) {
  for (size_t m = 0; m < run->result->claims; m++) {
    const fg_loop_claim *claim = &run->result->claim[m];
    for (size_t k = 0; k < claim->aliases; k++)
      if (!claim->alias[k].sum && loop_same_candidate(&claim->alias[k].candidate, candidate))
        return true;
  }
  return false;
}

static fg_loop_verdict judge_rejected(const loop_run *run, const fg_loop_rejected *one) {
  double matters = run->options.matters > 0 ? run->options.matters : run->sd;
  if (is_alias(run, &one->candidate)) return FG_LOOP_EXPLAINED_BY_OTHERS;
  if (one->retained_share < 1e-8) return FG_LOOP_ABSORBED;
  if (isfinite(one->smallest_detectable) && one->smallest_detectable <= matters)
    return FG_LOOP_ABSENT;
  return FG_LOOP_INCONCLUSIVE;
}

static void describe(const loop_run *run, const loop_step *step, size_t c, double sd_white,
                     const double *amplitude, fg_loop_rejected *one) {
  const loop_judgement *judgement = &step->judgement;
  const loop_version *version = &step->bench.version[judgement->score[c].version];
  *one = (fg_loop_rejected){.candidate = run->candidate[c], .smallest_detectable = NAN};
  loop_candidate_name(run->problem, &one->candidate, one->name);
  if (isfinite(judgement->score[c].z)) {
    double k = loop_version_freedom(&step->bench, version);
    one->would_explain = 1 - judgement->score[c].ratio;
    one->p_value = fmax(judgement->p_flip[c],
                        isfinite(judgement->p_simulated[c]) ? judgement->p_simulated[c] : 0);
    one->retained_share = version->share;
    if (step->judgement.smallest_p >= run->options.accept_p)
      one->smallest_detectable = NAN;
    else if (amplitude)
      one->smallest_detectable = amplitude[c] * sd_white;
    else
      one->smallest_detectable = detectable(judgement->f_critical[c], k, sd_white, version->length);
  } else {
    one->p_value = 1;
    for (size_t v = 0; v < step->bench.versions; v++)
      if (step->bench.version[v].candidate == c)
        one->retained_share = fmax(one->retained_share, step->bench.version[v].share);
  }
  one->verdict = judge_rejected(run, one);
}

static void describe_lone(const loop_run *run, const loop_lone *lone, double sd_white,
                          fg_loop_rejected *one) {
  *one = (fg_loop_rejected){.candidate = lone->candidate, .retained_share = fmin(lone->length, 1)};
  loop_candidate_name(run->problem, &one->candidate, one->name);
  one->would_explain = 1 - fmin(lone->ratio, 1);
  one->p_value = lone->p_value;
  one->smallest_detectable = detectable(lone->f_critical, 1, sd_white, lone->length);
  if (loop_is_exchange(&lone->candidate)) one->smallest_detectable /= sqrt(2.0);
  one->verdict = judge_rejected(run, one);
}

fg_status loop_list_rejected(fg_context *ctx, loop_run *run) {
  fg_loop_result *result = run->result;
  loop_step step;
  FG_TRY(loop_step_open(ctx, run, &run->set, true, &step));
  fg_status status = fg_memory_allocate(ctx, run->candidates + 2, sizeof *result->rejected,
                                        (void **)&result->rejected);
  double sd_white = sqrt(step.bench.flip_rss / (double)step.bench.freedom), *amplitude = NULL;
  if (status == FG_OK && step.frame.n <= LOOP_SMALL_ROWS) {
    status = fg_memory_allocate(ctx, run->candidates, sizeof *amplitude, (void **)&amplitude);
    if (status == FG_OK)
      status = loop_smallest_amplitudes(ctx, &step.bench, &step.judgement, run->options.seed + 2,
                                        amplitude);
  }
  result->smallest_p = step.judgement.smallest_p;
  for (size_t c = 0; status == FG_OK && c < run->candidates; c++)
    if (!loop_is_curve(&run->candidate[c]) && !is_claimed(run, &run->candidate[c]))
      describe(run, &step, c, sd_white, amplitude, &result->rejected[result->rejects++]);
  for (size_t k = 0; status == FG_OK && k < 2; k++)
    if (step.lone[k].known)
      describe_lone(run, &step.lone[k], sd_white, &result->rejected[result->rejects++]);
  free(amplitude);
  loop_step_close(&step);
  return status;
}

/* Advice: where the winner and its nearest rival, each fitted to these rows, differ most. */

static fg_status fit_alone(fg_context *ctx, const loop_run *run, size_t m,
                           const fg_loop_candidate *candidate, const double *shape,
                           fg_loop_claim *fit) {
  loop_set set = run->set;
  fg_loop_claim claims[FG_LOOP_CLAIMS + 1] = {0};
  double *parameter = NULL;
  set.candidate[m] = *candidate;
  memcpy(set.shape[m], shape, sizeof set.shape[m]);
  FG_TRY(loop_refine(ctx, run->problem, run->train, run->noise, &set));
  FG_TRY(fg_memory_allocate(ctx, run->problem->parameters + 1, 2 * sizeof *parameter,
                            (void **)&parameter));
  fg_status status = loop_fit_claims(ctx, run->problem, NULL, &set, run->noise, claims, parameter,
                                     parameter + run->problem->parameters);
  *fit = claims[m];
  free(parameter);
  return status;
}

static fg_status difference(fg_context *ctx, const fg_loop_problem *problem,
                            const fg_loop_claim *winner, const fg_loop_claim *rival, double *work,
                            double *apart) {
  FG_TRY(fg_loop_claim_evaluate(ctx, problem, winner, apart));
  FG_TRY(fg_loop_claim_evaluate(ctx, problem, rival, work));
  for (size_t i = 0; i < problem->rows; i++)
    apart[i] -= work[i];
  return FG_OK;
}

/* Every row in turn with the two coordinates exchanged among rows: settings inside what was
 * measured, but in combinations that were not. */
static fg_status best_setting(fg_context *ctx, const loop_run *run, const fg_loop_claim *winner,
                              const fg_loop_claim *rival, double value[2], double *apart) {
  enum { STEPS = 7 };
  const fg_loop_problem *problem = run->problem;
  const size_t at[2] = {winner->candidate.a, rival->candidate.a};
  fg_loop_problem grid = *problem;
  fg_loop_coordinate *coordinate = NULL;
  double values[2][STEPS * STEPS], difference_at[STEPS * STEPS], work[STEPS * STEPS], mean = 0;
  FG_TRY(fg_memory_allocate(ctx, problem->coordinates, sizeof *coordinate, (void **)&coordinate));
  memcpy(coordinate, problem->coordinate, problem->coordinates * sizeof *coordinate);
  for (size_t k = 0; k < 2; k++) {
    const fg_loop_coordinate *from = &problem->coordinate[at[k]];
    for (size_t i = 0; i < STEPS * STEPS; i++) {
      double share = (double)(k ? i / STEPS : i % STEPS) / (STEPS - 1);
      values[k][i] = from->low + share * (from->high - from->low);
      if (from->levels) values[k][i] = floor(values[k][i] + 0.5);
    }
    coordinate[at[k]].value = values[k];
  }
  grid.coordinate = coordinate;
  grid.rows = STEPS * STEPS;
  fg_status status = difference(ctx, &grid, winner, rival, work, difference_at);
  for (size_t i = 0; i < grid.rows; i++)
    mean += difference_at[i] / (double)grid.rows;
  *apart = 0;
  for (size_t i = 0; status == FG_OK && i < grid.rows; i++)
    if (fabs(difference_at[i] - mean) > *apart) {
      *apart = fabs(difference_at[i] - mean);
      value[0] = values[at[0] == at[1]][i];
      value[1] = values[1][i];
    }
  free(coordinate);
  return status;
}

static void describe_value(const fg_loop_coordinate *at, double value, char *text, size_t size) {
  if (at->levels)
    fg_text_clip(text, size, "%s = %s", at->name, at->level_name[(size_t)value]);
  else
    fg_text_clip(text, size, "%s = %.4g", at->name, value);
}

static fg_status advise_one(fg_context *ctx, loop_run *run, size_t m, fg_loop_advice *advice) {
  const fg_loop_claim *claim = &run->result->claim[m];
  const fg_loop_alias *alias = &claim->alias[0];
  const fg_loop_candidate *rival = &alias->candidate;
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES] = {0}, value[2] = {0}, apart = 0;
  fg_loop_claim other;
  char first[160], second[160];
  if (alias->sum || loop_is_lone(rival) || loop_is_lone(&claim->candidate)) {
    fg_text_clip(advice->text, sizeof advice->text,
                 "Repeat the rows that %s rests on: a repeat tells a wrong or exchanged response "
                 "from %s.",
                 claim->name, alias->name);
    advice->runs = 2;
    return FG_OK;
  }
  size_t count = rival->effect->starts ? rival->effect->starts(run->problem, rival, starts) : 1;
  FG_TRY(fit_alone(ctx, run, m, rival, starts[count / 2], &other));
  FG_TRY(best_setting(ctx, run, claim, &other, value, &apart));
  const fg_loop_coordinate *a = &run->problem->coordinate[claim->candidate.a];
  const fg_loop_coordinate *b = &run->problem->coordinate[rival->a];
  describe_value(a, value[0], first, sizeof first);
  describe_value(b, value[1], second, sizeof second);
  bool same = claim->candidate.a == rival->a;
  double needed = apart > 0 ? ceil(pow((surplus + power_80) * run->sd / apart, 2)) : INFINITY;
  advice->runs = needed < 1e6 ? fmax(needed, 2) : NAN;
  if (!(advice->runs > 0)) {
    fg_text_clip(advice->text, sizeof advice->text,
                 "No setting inside the measured range parts %s from %s: measure outside it.",
                 claim->name, alias->name);
    return FG_OK;
  }
  fg_text_clip(advice->text, sizeof advice->text,
               "%.0f %s at %s%s%s and as many at the middle part %s from %s (they differ by %.3g "
               "there; power 80 %%).",
               advice->runs, run->problem->group_level ? "more rows" : "more runs", first,
               same ? "" : " with ", same ? "" : second, claim->name, alias->name, apart);
  return FG_OK;
}

fg_status loop_advise(fg_context *ctx, loop_run *run) {
  fg_loop_result *result = run->result;
  /* Points are not had by repeating rows: their advice is another scan. */
  if (!strcmp(run->problem->level, "points")) return FG_OK;
  for (size_t m = 0; m < result->claims; m++)
    if (result->claim[m].aliases)
      FG_TRY(advise_one(ctx, run, m, &result->advice[result->advices++]));
  return FG_OK;
}
