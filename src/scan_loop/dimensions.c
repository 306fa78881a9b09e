/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choice of the dimensions that the loop corrects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan_loop/state.h"

static fg_status open_all(fg_context *ctx, fg_scan_loop *loop) {
  FG_TRY(
      fg_memory_allocate(ctx, loop->scan_count, sizeof *loop->benefits, (void **)&loop->benefits));
  for (size_t i = 0; i < loop->scan_count; i++)
    FG_TRY(fg_benefits_open(ctx, &loop->before[i], &loop->benefits[i]));
  return FG_OK;
}

/* (X, R, R0) to (R0, R, h), h = R0 - X + R. */
static void turn_covariance(double from[3][3], double to[FG_CORRECTED][FG_CORRECTED]) {
  static const double turn[FG_CORRECTED][3] = {{0, 0, 1}, {0, 1, 0}, {-1, 1, 1}};
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++) {
      to[a][b] = 0;
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          to[a][b] += turn[a][i] * from[i][k] * turn[b][k];
    }
}

/* Birge ratio of a set that is not right. It leaves a smooth residual, of which its own fit absorbs
 * as much as any other fit would, so the variances of the effects are widened by the ratio of the
 * residual to that expected from noise. */
static double misfit_of(const fg_explanations *explanations, size_t explanation) {
  const fg_explanation *one = &explanations->each[explanation];
  if (explanations->right || explanation >= explanations->count || !(one->dof > 0)) return 1;
  return isfinite(one->excess) ? fmax(1, one->excess / one->dof) : 1;
}

/* Excess beyond the noise's share in the columns that a set leaves out, for comparing sets of
 * different size. */
static double excess_beyond(const fg_explanation *one) {
  return one->excess - one->dof;
}

double fg_scan_loop_excess_over_best(const fg_explanations *explanations, size_t explanation) {
  double min = INFINITY;
  for (size_t m = 0; m < explanations->count; m++)
    min = fmin(min, excess_beyond(&explanations->each[m]));
  return excess_beyond(&explanations->each[explanation]) - min;
}

bool fg_scan_loop_is_unlikely(const fg_explanations *explanations, size_t explanation) {
  return fg_scan_loop_excess_over_best(explanations, explanation) > FG_UNLIKELY_CHI2;
}

static void add_scaled(fg_benefit *benefit, size_t item, double noise[FG_CORRECTED][FG_CORRECTED],
                       double scale) {
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++)
      noise[a][b] *= scale;
  fg_benefit_add_noise(benefit, item, noise);
}

static void add_foil_noise(const fg_edge_fit_part *part, const fg_joint_fit_part *adds,
                           const fg_foil *foil, double scale, fg_benefit *benefit) {
  double noise[FG_CORRECTED][FG_CORRECTED], alone[FG_CORRECTED][FG_CORRECTED] = {{0}};
  for (size_t b = 0; b < foil->bump_count; b++)
    for (size_t k = 0; k < part->bump_count; k++)
      if (part->bumps[k].number == foil->bumps[b].number) {
        turn_covariance(adds->bumps[k], noise);
        add_scaled(benefit, b, noise, scale);
      }
  alone[FG_CORRECTED_OVERALL_RADIUS][FG_CORRECTED_OVERALL_RADIUS] = adds->overall;
  add_scaled(benefit, foil->bump_count, alone, scale);
  benefit->noises++;
}

/* A gauge's radius is given to a search without evidence: its fit does not determine it. */
static void add_disc_noise(const fg_edge_fit_part *part, const fg_joint_fit_part *adds, size_t disc,
                           double scale, fg_benefit *benefit) {
  double noise[FG_CORRECTED][FG_CORRECTED] = {{0}};
  if (!part->radius_known) noise[FG_CORRECTED_RADIUS][FG_CORRECTED_RADIUS] = adds->overall;
  add_scaled(benefit, disc, noise, scale);
}

static bool holds_curve(const fg_explanations *explanations, size_t explanation) {
  if (explanation >= explanations->count) return false;
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if ((explanations->each[explanation].mask >> e & 1) &&
        fg_effect_is_free(explanations->candidates[e].kind) &&
        explanations->candidates[e].kind->glass)
      return true;
  return false;
}

static void take_noise(fg_scan_loop *loop, const fg_joint_fit_result *fit, size_t view,
                       double scale, bool curve) {
  const fg_edge_fit_view *one = &fit->edge_fit->views[view];
  const fg_edge_fit_part *part = &fit->edge_fit->parts[one->part];
  const fg_joint_fit_part *adds = &fit->parts[one->part];
  const fg_measurement *before = &loop->before[one->scan];
  fg_benefits *benefits = &loop->benefits[one->scan];
  fg_benefit *benefit = one->foil ? &benefits->foil[one->foil - before->foils] : &benefits->discs;
  if (one->foil)
    add_foil_noise(part, adds, one->foil, scale, benefit);
  else
    add_disc_noise(part, adds, (size_t)(one->disc - before->discs), scale, benefit);
  benefit->misfit =
      benefit->misfit || (one->foil && scale > 1) || (loop->by_evidence && loop->misfit);
  benefit->curve =
      benefit->curve || ((one->foil || loop->by_evidence) && curve) || loop->beside_foil_field;
  benefit->mean = loop->by_evidence;
}

/* Effects of the part move no dimension: where no explanation holds one of the scanner, nothing is
 * to decide. */
static bool any_moves_edges(const fg_scan_loop *loop, const fg_joint_fit_result *fit) {
  const fg_explanations *explanations = &loop->explanations;
  for (size_t m = 0; m < explanations->count; m++)
    for (size_t e = 0; e < explanations->candidate_count; e++)
      if ((explanations->each[m].mask >> e & 1) && explanations->candidates[e].kind->glass)
        return true;
  return fit->fields.count > 0;
}

fg_status fg_scan_loop_record_moves(fg_context *ctx, fg_scan_loop *loop, size_t explanation,
                                    const fg_joint_fit_result *fit,
                                    const fg_measurement *corrected) {
  double scale = misfit_of(&loop->explanations, explanation);
  if (explanation && fg_scan_loop_is_unlikely(&loop->explanations, explanation)) return FG_OK;
  if (!any_moves_edges(loop, fit)) return FG_OK;
  if (!loop->benefits) FG_TRY(open_all(ctx, loop));
  for (size_t i = 0; i < loop->scan_count; i++) {
    fg_benefits_add(&loop->benefits[i], &loop->before[i], &corrected[i]);
    loop->benefits[i].discs.noises++;
  }
  bool curve = holds_curve(&loop->explanations, explanation);
  for (size_t v = 0; v < fit->edge_fit->view_count; v++)
    take_noise(loop, fit, v, scale, curve);
  return FG_OK;
}

/* All scans of one foil are decided as one. */
static void decide_foil(const fg_scan_loop *loop, size_t scan, size_t foil,
                        const fg_benefit **benefit, fg_benefit_decision *each,
                        fg_benefit_decision **to) {
  bool same = loop->options.same_foil;
  size_t count = 0;
  for (size_t i = same ? 0 : scan; i < (same ? loop->scan_count : scan + 1); i++) {
    benefit[count] = &loop->benefits[i].foil[foil];
    to[count++] = &each[i];
  }
  fg_benefit_decide(benefit, count, to);
}

static fg_status keep_foil(fg_context *ctx, fg_scan_loop *loop, size_t scan, size_t foil,
                           const fg_benefit_decision *decision) {
  const fg_measurement *before = &loop->before[scan];
  fg_foil *after = &loop->after[scan].foils[foil];
  if (before->foils[foil].flags & FG_FOIL_NOT_MEASURED) return FG_OK;
  const fg_benefit_foil of = {before, &before->foils[foil], &loop->benefits[scan].foil[foil],
                              decision};
  FG_TRY(fg_benefit_keep_foil(ctx, &of, after));
  fg_benefit_widen_foil(&of, after);
  return FG_OK;
}

static void keep_discs(fg_scan_loop *loop, size_t scan) {
  fg_benefit_decision decision;
  fg_benefit *own = &loop->benefits[scan].discs;
  own->refused = fg_scan_loop_gauges_refuse(loop, scan);
  const fg_benefit *benefit = own;
  fg_benefit_decide(&benefit, 1, &(fg_benefit_decision *){&decision});
  fg_benefit_keep_discs(&loop->before[scan], benefit, &decision, &loop->after[scan]);
  fg_benefit_widen_discs(benefit, &decision, &loop->after[scan]);
}

fg_status fg_scan_loop_keep_beneficial(fg_context *ctx, fg_scan_loop *loop) {
  fg_status status = FG_OK;
  const fg_benefit **benefit = NULL;
  fg_benefit_decision *each = NULL, **to = NULL;
  if (!loop->benefits) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, loop->scan_count, sizeof *benefit, (void **)&benefit));
  FG_TRY_EXIT(fg_memory_allocate(ctx, loop->scan_count, sizeof *each, (void **)&each));
  FG_TRY_EXIT(fg_memory_allocate(ctx, loop->scan_count, sizeof *to, (void **)&to));
  for (size_t i = 0; i < loop->scan_count; i++) {
    for (size_t f = 0; f < loop->after[i].foil_count; f++) {
      decide_foil(loop, i, f, benefit, each, to);
      FG_TRY_EXIT(keep_foil(ctx, loop, i, f, &each[i]));
    }
    keep_discs(loop, i);
  }
exit:
  free(benefit);
  free(each);
  free(to);
  return status;
}
