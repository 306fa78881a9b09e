/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Candidates that are not claimed: the share that they explain, and their detectable amplitude. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "table_loop/cycles.h"
#include "table_loop/suspect.h"

static const double power_80 = 0.8416; /* normal quantile of a power of 80 % */

/* Detectable amplitude a, with a² |M W f|² / s² = (sqrt(k F) + 0.84)²: found with a power of 80 %.
 */
static double detectable(double f_critical, double k, double sd_white, double length) {
  if (!isfinite(f_critical) || !(length > 0)) return NAN;
  return (sqrt(k * f_critical) + power_80) * sd_white / sqrt(length);
}

static bool is_claimed(const fg_engine_run *run, const fg_loop_candidate *candidate) {
  for (size_t m = 0; m < run->result->claims; m++)
    if (fg_engine_same_candidate(&run->result->claim[m].candidate, candidate) ||
        fg_engine_same_cycle(&run->result->claim[m].candidate, candidate))
      return true;
  return false;
}

static bool is_alias(const fg_engine_run *run, const fg_loop_candidate *candidate) {
  for (size_t m = 0; m < run->result->claims; m++) {
    const fg_loop_claim *claim = &run->result->claim[m];
    for (size_t k = 0; k < claim->aliases; k++)
      if (!claim->alias[k].sum && fg_engine_same_candidate(&claim->alias[k].candidate, candidate))
        return true;
  }
  return false;
}

/* Less of an effect than this beside the null is the rounding of the projection. */
#define ABSORBED_SHARE 1e-8

static fg_loop_verdict judge_rejected(const fg_engine_run *run, const fg_loop_rejected *one) {
  double matters = run->options.matters > 0 ? run->options.matters : run->sd;
  if (is_alias(run, &one->candidate)) return FG_LOOP_EXPLAINED_BY_OTHERS;
  if (one->retained_share < ABSORBED_SHARE) return FG_LOOP_ABSORBED;
  if (isfinite(one->smallest_detectable) && one->smallest_detectable <= matters)
    return FG_LOOP_ABSENT;
  return FG_LOOP_INCONCLUSIVE;
}

static void describe_rejected(const fg_engine_step *step, size_t c, double sd_white,
                              const double *amplitude, fg_loop_rejected *one) {
  const fg_engine_judgement *judgement = &step->judgement;
  const fg_engine_version *version = &step->workspace.version[judgement->score[c].version];
  if (isfinite(judgement->score[c].z)) {
    double k = fg_engine_version_dof(&step->workspace, version);
    one->would_explain = 1 - judgement->score[c].ratio;
    one->retained_share = version->share;
    one->smallest_detectable =
        amplitude ? amplitude[c] * sd_white
                  : detectable(judgement->f_critical[c], k, sd_white, version->length);
  } else {
    for (size_t v = 0; v < step->workspace.versions; v++)
      if (step->workspace.version[v].candidate == c)
        one->retained_share = fmax(one->retained_share, step->workspace.version[v].share);
  }
}

/* Describes single rows; candidates of the scatter have no detectable amplitude. */
static void describe_rows(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                          double sd_white, fg_loop_rejected *one) {
  one->would_explain = stand < run->candidates ? NAN : 0;
  one->retained_share = 1;
  if (stand < run->candidates) return;
  one->retained_share = fmin(step->outlier.length, 1);
  one->smallest_detectable =
      detectable(step->outlier.f_critical, 1, sd_white, step->outlier.length);
  if (stand == fg_engine_wrong_rows(run)) {
    one->would_explain = 1 - fmin(step->outlier.ratio, 1);
    return;
  }
  one->would_explain = 1 - step->judgement.exchange_ratio;
  one->smallest_detectable /= sqrt(2.0);
}

/* Of a cycle over one column, of a known base and of any period, the likelier is listed. */
static bool is_less_likely_cycle(const fg_engine_run *run, const fg_engine_step *step,
                                 size_t stand) {
  const fg_loop_candidate *own = &step->stand[stand].candidate;
  for (size_t c = 0; own->effect && own->effect->cycle && c < run->means; c++) {
    if (c == stand || !fg_engine_same_cycle(&run->candidate[c], own)) continue;
    double p = fg_engine_stand_p(run, step, c), own_p = fg_engine_stand_p(run, step, stand);
    if (p < own_p || (p == own_p && c < stand)) return true;
  }
  return false;
}

static void list_one(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                     double sd_white, const double *amplitude) {
  const fg_loop_candidate *candidate = &step->stand[stand].candidate;
  if (fg_engine_is_curve(candidate) || is_claimed(run, candidate)) return;
  if (is_less_likely_cycle(run, step, stand)) return;
  if (stand >= run->candidates && !isfinite(step->stand[stand].z)) return;
  fg_loop_rejected *one = &run->result->rejected[run->result->rejects++];
  *one = (fg_loop_rejected){.candidate = *candidate, .smallest_detectable = NAN};
  fg_engine_candidate_name(run->problem, candidate, one->name);
  one->p_value = fg_engine_stand_p(run, step, stand);
  if (stand < run->means)
    describe_rejected(step, stand, sd_white, amplitude, one);
  else
    describe_rows(run, step, stand, sd_white, one);
  one->verdict = judge_rejected(run, one);
}

/* A row that normal noise does not reach, and that the others do not show to be wrong. */
static fg_status note_tail(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step) {
  const fg_engine_outlier *outlier = &step->outlier;
  double level = run->options.accept_p;
  if (!outlier->known || !(outlier->normal_p < level) || outlier->p_value < level) return FG_OK;
  run->result->far_row = outlier->first;
  return fg_engine_note(ctx, run->result,
                        "Row %zu lies %.1f standard deviations of the others from where they have "
                        "it: more than normal noise reaches. These rows cannot tell a wrong value "
                        "from a scatter with heavy tails, so none is claimed; look at how that row "
                        "was measured.",
                        fg_engine_row_number(run->problem, outlier->first.row[0]), outlier->size);
}

fg_status fg_engine_list_rejected(fg_context *ctx, fg_engine_run *run) {
  fg_loop_result *result = run->result;
  fg_engine_step step;
  FG_TRY(fg_engine_step_open(ctx, run, &run->set, true, &step));
  fg_status status =
      fg_memory_allocate(ctx, step.stands, sizeof *result->rejected, (void **)&result->rejected);
  double sd_white = sqrt(step.workspace.rss[step.judgement.noise] / (double)step.workspace.dof);
  double *amplitude = NULL;
  if (status == FG_OK && step.training.n <= FG_ENGINE_SMALL_ROWS) {
    status = fg_memory_allocate(ctx, run->means, sizeof *amplitude, (void **)&amplitude);
    if (status == FG_OK)
      status = fg_engine_smallest_amplitudes(ctx, &step.workspace, &step.judgement,
                                             run->options.seed + 2, amplitude);
  }
  for (size_t s = 0; status == FG_OK && s < step.stands; s++)
    list_one(run, &step, s, sd_white, amplitude);
  if (status == FG_OK) status = note_tail(ctx, run, &step);
  if (status == FG_OK && result->verdict == FG_LOOP_CLEAN)
    status = fg_engine_list_suspects(ctx, run, &step);
  free(amplitude);
  fg_engine_step_close(&step);
  return status;
}
