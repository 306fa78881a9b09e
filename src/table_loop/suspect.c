/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suspects: candidates that are not proven, over which noise alone would be as clear in one table
 * of ten at most. Each is fitted alone, with its own p-value, what else would look so, and the rows
 * that would decide. */
#include "table_loop/suspect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include "core/memory.h"
#include "core/text.h"
#include "table_loop/accept_claim.h"
#include "table_loop/serial.h"

/* Power with which the advised rows decide, and its normal quantile. */
static const double wanted_power = 0.9, power_90 = 1.2816;
/* Terms of a Poisson mixture beyond which nothing is added; limit of rows that one would add. */
enum { TERMS_MAX = 400, ROWS_MAX = 100000, HALVINGS = 60 };

typedef struct suspects {
  fg_engine_run *run;
  const fg_engine_step *step;
  fg_engine_noise noise;
  double sd; /* of a row beside the suspect */
} suspects;

/* Probability that F of k and nu dof with noncentrality lambda exceeds f: a mixture of central
 * beta distributions with Poisson weights. */
static double power_of_f(double f, double k, double nu, double lambda) {
  double x = k * f / (k * f + nu), sum = 0;
  for (unsigned j = 0; j < TERMS_MAX; j++)
    sum += gsl_ran_poisson_pdf(j, lambda / 2) * gsl_cdf_beta_Q(x, k / 2 + j, nu / 2);
  return sum;
}

/* Noncentrality at which F exceeds its critical value with the wanted power. */
static double needed_noncentrality(double critical, double k, double nu) {
  double low = 0, high = TERMS_MAX;
  for (int i = 0; i < HALVINGS; i++) {
    double middle = (low + high) / 2;
    if (power_of_f(critical, k, nu, middle) < wanted_power)
      low = middle;
    else
      high = middle;
  }
  return high;
}

static size_t whole_rows(double more) {
  return isfinite(more) && more < ROWS_MAX ? (size_t)fmax(ceil(more), 2) : 0;
}

/* The same kind of rows again: a deviate grows with the root of their number. */
static size_t more_of_the_same(const suspects *of, size_t stand) {
  const fg_engine_judgement *judgement = &of->step->judgement;
  size_t c = stand < of->run->candidates ? stand : of->run->candidates;
  double critical =
      fg_engine_family_critical(&judgement->family, judgement->kind[c], of->run->options.accept_p);
  double ratio = (critical + power_90) / judgement->z[c];
  return whole_rows((double)of->step->training.n * (ratio * ratio - 1));
}

/* One value of a candidate's columns at a row, in words: "machine = M1". */
static void describe_place(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                           size_t row, char *text, size_t size) {
  *text = 0;
  for (int second = 0; second <= candidate->effect->pair; second++) {
    const fg_loop_coordinate *at = &problem->coordinate[second ? candidate->b : candidate->a];
    size_t used = strlen(text);
    if (at->levels)
      fg_text_clip(text + used, size - used, "%s%s = %s", second ? ", " : "", at->name,
                   at->level_name[(size_t)at->value[row]]);
    else
      fg_text_clip(text + used, size - used, "%s%s = %.6g", second ? ", " : "", at->name,
                   at->value[row]);
  }
}

/* Half of the rows at the highest effect measured, half at the lowest: each adds the square of the
 * amplitude over the noise to the noncentrality that these rows have (kF and what noise alone adds
 * to it). */
static fg_status at_the_ends(fg_context *ctx, const suspects *of, size_t stand,
                             fg_loop_suspect *suspect) {
  const fg_engine_step *step = of->step;
  const fg_engine_score *score = &step->judgement.score[stand];
  const fg_engine_version *version = &step->workspace.version[score->version];
  const fg_loop_problem *problem = of->run->problem;
  double k = fg_engine_version_dof(&step->workspace, version);
  double nu = fg_engine_version_whole(&step->workspace, version) - k;
  double f = (1 / score->own - 1) * nu / k, *effect = NULL;
  double now = fmax(k * f * (nu - 2) / nu - k, 0);
  double needed = needed_noncentrality(step->judgement.f_critical[stand], k, nu);
  double a = suspect->claim.amplitude / of->sd;
  char low[FG_LOOP_NAME + 40], high[FG_LOOP_NAME + 40];
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *effect, (void **)&effect));
  fg_status status = fg_loop_claim_evaluate(ctx, problem, &suspect->claim, effect);
  size_t lowest = 0, highest = 0;
  for (size_t i = 1; i < problem->rows; i++) {
    if (effect[i] < effect[lowest]) lowest = i;
    if (effect[i] > effect[highest]) highest = i;
  }
  free(effect);
  suspect->more_rows = whole_rows((needed - now) / (a * a));
  suspect->more_rows += suspect->more_rows % 2;
  describe_place(problem, &suspect->claim.candidate, highest, high, sizeof high);
  describe_place(problem, &suspect->claim.candidate, lowest, low, sizeof low);
  fg_text_clip(suspect->at, sizeof suspect->at, "half of them at %s, half at %s", high, low);
  return status;
}

/* Repeats of a row tell whether it is wrong: its distance from their mean against the scatter of
 * both. */
static void repeat_rows(const suspects *of, fg_loop_suspect *suspect) {
  double needed = gsl_cdf_ugaussian_Qinv(of->run->options.accept_p / 2) + power_90;
  double size = of->step->outlier.size / needed;
  bool exchange = fg_engine_is_exchange(&suspect->claim.candidate);
  suspect->repeats = true;
  suspect->more_rows = exchange ? 2 : size > 1 ? whole_rows(1 / (size * size - 1)) : 0;
}

/* Settings that can be chosen: a column that is no order, of an effect between all rows. */
static bool can_be_chosen(const suspects *of, size_t stand) {
  const fg_engine_step *step = of->step;
  const fg_loop_candidate *candidate = &step->stand[stand].candidate;
  if (stand >= of->run->means || fg_engine_is_curve(candidate)) return false;
  if (step->workspace.version[step->judgement.score[stand].version].between) return false;
  fg_loop_kind kind = fg_loop_kind_of(of->run->problem, candidate);
  return kind != FG_LOOP_KIND_ORDER && isfinite(step->judgement.f_critical[stand]);
}

static fg_status advise(fg_context *ctx, const suspects *of, size_t stand,
                        fg_loop_suspect *suspect) {
  if (stand >= of->run->candidates)
    repeat_rows(of, suspect);
  else if (can_be_chosen(of, stand))
    return at_the_ends(ctx, of, stand, suspect);
  else
    suspect->more_rows = more_of_the_same(of, stand);
  return FG_OK;
}

/* P-value had nothing else been tried: of an F ratio where the basis has no shape, of a single row
 * that of normal noise, else of the score among its own draws. */
static double find_own_p(const suspects *of, size_t stand) {
  const fg_engine_step *step = of->step;
  if (stand == fg_engine_wrong_rows(of->run))
    return fmin(step->outlier.normal_p / (double)step->training.n, 1);
  size_t c = stand < of->run->candidates ? stand : of->run->candidates;
  if (c >= of->run->means || step->stand[c].candidate.effect->shapes)
    return gsl_cdf_ugaussian_Q(step->judgement.z[c]);
  const fg_engine_score *score = &step->judgement.score[c];
  const fg_engine_version *version = &step->workspace.version[score->version];
  double k = fg_engine_version_dof(&step->workspace, version);
  double nu = fg_engine_version_whole(&step->workspace, version) - k;
  return gsl_cdf_fdist_Q((1 / score->own - 1) * nu / k, k, nu);
}

/* Fits the declared model and the suspect. */
static fg_status fit_alone(fg_context *ctx, suspects *of, const fg_engine_stand *stand,
                           fg_loop_suspect *suspect) {
  fg_engine_run *run = of->run;
  fg_loop_result *result = run->result;
  fg_engine_set alone = {.count = 1, .candidate = {stand->candidate}};
  fg_loop_claim fit = {0};
  double *parameter = NULL;
  bool first = result->suspects == 0;
  memcpy(alone.shape[0], stand->shape, sizeof alone.shape[0]);
  FG_TRY(fg_memory_allocate(ctx, run->problem->parameters + 1, 2 * sizeof *parameter,
                            (void **)&parameter));
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_engine_refine(ctx, run->problem, run->train, of->noise, &alone));
  FG_TRY_EXIT(fg_engine_fit_set(ctx, run->problem, NULL, &alone, true, &of->noise,
                                first ? result->suspect_fit : NULL, NULL, &of->sd));
  FG_TRY_EXIT(fg_engine_fit_claims(ctx, run->problem, NULL, &alone, of->noise, &fit, parameter,
                                   parameter + run->problem->parameters));
  fg_engine_claim_take_fit(&suspect->claim, &fit);
exit:
  free(parameter);
  return status;
}

/* Neighbours that are alike look like many effects: where a suspect would be none beside their
 * correlation, the correlation is in its class. */
static fg_status tie_correlation(fg_context *ctx, const suspects *of, size_t stand,
                                 fg_loop_claim *claim) {
  fg_engine_run *run = of->run;
  fg_engine_serial_word word;
  if (stand >= run->means) return FG_OK;
  FG_TRY(
      fg_engine_weigh_serial(ctx, run, &of->step->stand[stand], stand, FG_LOOP_SUSPECTED_P, &word));
  if (word != FG_ENGINE_EFFECT)
    fg_engine_add_alias(run->problem, &run->candidate[fg_engine_serial_candidate(run)], NAN, NAN,
                        claim);
  return FG_OK;
}

static fg_status describe(fg_context *ctx, suspects *of, size_t stand, fg_loop_suspect *suspect) {
  const fg_engine_step *step = of->step;
  *suspect = (fg_loop_suspect){.own_p = NAN};
  of->noise = step->workspace.noise[step->judgement.noise];
  fg_engine_describe_claim(of->run, step, stand, &suspect->claim);
  suspect->own_p = find_own_p(of, stand);
  FG_TRY(tie_correlation(ctx, of, stand, &suspect->claim));
  if (!fg_engine_is_noise(&suspect->claim.candidate))
    FG_TRY(fg_engine_alias_class(ctx, &step->training, of->noise, step->stand, step->stands,
                                 &step->stand[stand], &suspect->claim));
  suspect->claim.verdict = suspect->claim.aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
  FG_TRY(fit_alone(ctx, of, &step->stand[stand], suspect));
  return advise(ctx, of, stand, suspect);
}

/* Returns true where a suspect of the same columns, of the mean or of the scatter alike, is listed:
 * another basis of one cause. */
static bool is_of_listed(const suspects *of, const fg_loop_candidate *candidate) {
  const fg_loop_result *result = of->run->result;
  for (size_t i = 0; i < result->suspects; i++) {
    const fg_loop_candidate *other = &result->suspect[i].claim.candidate;
    bool single = fg_engine_is_outlier(candidate) || fg_engine_is_outlier(other);
    if (!single && candidate->a == other->a && candidate->b == other->b &&
        fg_engine_is_noise(candidate) == fg_engine_is_noise(other))
      return true;
  }
  return false;
}

fg_status fg_engine_list_suspects(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step) {
  fg_loop_result *result = run->result;
  suspects of = {.run = run, .step = step};
  FG_TRY(fg_memory_allocate(ctx, run->problem->rows, sizeof *result->suspect_fit,
                            (void **)&result->suspect_fit));
  double above = -1;
  size_t last = step->stands;
  while (result->suspects < FG_LOOP_SUSPECTS) {
    size_t best = step->stands;
    for (size_t s = 0; s < step->stands; s++) {
      double p = fg_engine_stand_p(run, step, s);
      bool later = p > above || (p == above && s > last);
      if (!isfinite(step->stand[s].z) || p > FG_LOOP_SUSPECTED_P || !later) continue;
      if (s < run->means && fg_engine_is_random_factor(run, s)) continue;
      if (best == step->stands || p < fg_engine_stand_p(run, step, best)) best = s;
    }
    if (best == step->stands) break;
    above = fg_engine_stand_p(run, step, best);
    last = best;
    if (is_of_listed(&of, &step->stand[best].candidate)) continue;
    FG_TRY(describe(ctx, &of, best, &result->suspect[result->suspects]));
    result->suspects++;
  }
  if (result->suspects) result->verdict = FG_LOOP_SUSPECTED;
  return FG_OK;
}
