/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for ripples and steps. They are distinct from all smooth effects even in one scan, so they
 * are sought beside them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "effect_search/policy.h"

/* A step elsewhere is as good when its residual exceeds the best one's by no more than this (1 in
 * 600 by chance); one nearer than this is the same. */
#define OTHER_STEP_CHI2 10.0
#define OTHER_STEP_MM   0.3

/* Finds the shape that explains most beside the geometry alone. */
static fg_status find_alone(fg_context *ctx, fg_search *s, const fg_effect *kind, double *shape) {
  const fg_field_frame *frame = &s->columns.edge_fit->frame;
  fg_search_hit hit;
  memcpy(s->columns.left, s->columns.residual, s->columns.rows * sizeof *s->columns.left);
  s->out->noise_um = s->out->integral = 1; /* nothing is judged yet: the largest gain is wanted */
  FG_TRY(fg_search_find_place(ctx, s, s->columns.geometry_rank, kind, &hit));
  *shape = hit.gain > 0 ? hit.at : kind->start(frame, kind->starts / 2, kind->starts);
  return FG_OK;
}

fg_status fg_search_add_shaped(fg_context *ctx, fg_search *s, const fg_effect *kind,
                               const fg_effect_set *known) {
  double alone, fitted = NAN;
  FG_TRY(find_alone(ctx, s, kind, &alone));
  for (size_t e = 0; known && e < known->count; e++)
    if (known->effects[e].kind == kind) fitted = known->effects[e].shape[0];
  if (isfinite(fitted)) fg_search_add(s, &(fg_candidate){.kind = kind, .shape = {fitted}});
  if (isfinite(fitted) && fabs(alone / fitted - 1) < FG_SEARCH_COLLINEAR_SHARE) return FG_OK;
  s->unfitted |= 1u << s->out->candidate_count;
  fg_search_add(s, &(fg_candidate){.kind = kind, .shape = {alone}});
  return FG_OK;
}

static void add_step_at(fg_search *s, const fg_effect *kind, double at_mm) {
  fg_candidate other = {.kind = kind, .shape = {at_mm}};
  if (isfinite(at_mm) && s->out->candidate_count < FG_CANDIDATES_MAX) fg_search_add(s, &other);
}

fg_status fg_search_add_other_steps(fg_context *ctx, fg_search *s, const fg_effect_set *known) {
  double *work = NULL;
  size_t steps = 0;
  for (size_t e = 0; known && e < known->count; e++)
    steps += known->effects[e].kind->jumps;
  if (!steps) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, sizeof *work, (void **)&work));
  fg_search_noise(s, false);
  double unit = s->out->noise_um * s->out->noise_um * s->out->integral;
  size_t rank =
      fg_search_columns_span(&s->columns, 0, s->free_end); /* geometry and known effects */
  for (size_t e = 0; e < known->count; e++) {
    const fg_effect_found *step = &known->effects[e];
    if (!step->kind->jumps || !step->kind->start) continue;
    size_t places = 2 * step->kind->starts;
    double above = NAN, below = NAN, square = step->coefficient_um[0] * step->coefficient_um[0];
    for (size_t i = 0; i < places; i++) {
      double y = step->kind->start(&s->columns.edge_fit->frame, i, places);
      if (fabs(y - step->shape[0]) < OTHER_STEP_MM) continue;
      if (square * fg_search_rest_of_step(&s->columns, rank, step->kind, y, work) >
          OTHER_STEP_CHI2 * unit)
        continue;
      if (y > step->shape[0]) above = y;
      if (y < step->shape[0] && !(below < y)) below = y;
    }
    add_step_at(s, step->kind, above);
    add_step_at(s, step->kind, below);
  }
  free(work);
  return FG_OK;
}

/* ---- ripples and steps that stand out ---- */

/* Adds the most significant candidate, once. */
static fg_status add_best(fg_context *ctx, fg_search *s, bool listed_only, bool *added) {
  size_t rank = fg_search_noise(s, false);
  double noise_um = s->out->noise_um, integral = s->out->integral;
  if (listed_only) rank = fg_search_noise(s, true);
  /* The residual beside listed effects may contain the effect sought: it is no noise. */
  s->out->noise_um = noise_um;
  s->out->integral = integral;
  fg_search_hit best = {0}, found;
  const fg_effect *which = NULL;
  *added = false;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_PLACED || !fg_search_seeks(s, kind)) continue;
    FG_TRY(fg_search_find_place(ctx, s, rank, kind, &found));
    if (found.gain <= s->policy->placed_chi2 || found.amplitude <= FG_SEARCH_SHAPED_MIN_UM)
      continue;
    if (which && found.gain <= best.gain) continue;
    best = found;
    which = kind;
  }
  if (!which || s->out->candidate_count >= FG_CANDIDATES_MAX) return FG_OK;
  s->unfitted |= 1u << s->out->candidate_count;
  fg_search_add(s, &(fg_candidate){.kind = which, .shape = {best.at}});
  s->new_shapes++;
  *added = true;
  return FG_OK;
}

/* Searches beside the listed effects too, because free curves can follow a long ripple. A ripple
 * found there is a candidate like any other; a curve that is no ripple stays the better
 * explanation. */
fg_status fg_search_find_on_foils(fg_context *ctx, fg_search *s) {
  for (int pass = 0; pass < 2; pass++) {
    bool added = true;
    for (int round = 0; round < 2 && added; round++)
      FG_TRY(add_best(ctx, s, pass == 0, &added));
  }
  return FG_OK;
}

/* Returns the gain of the best smooth effect alone. */
static double best_alone(fg_search *s) {
  const fg_search_baseline y = fg_search_find_baseline(s);
  double min = s->columns.square;
  for (size_t e = 0; e < s->out->candidate_count; e++)
    if (!fg_effect_is_free(s->out->candidates[e].kind))
      min = fmin(min, fg_search_sum_of_one(s, &y, e));
  return (s->columns.square - min) / y.unit;
}

static bool is_there(const fg_search *s, const fg_candidate *placed) {
  unsigned both = 1u << s->out->candidate_count;
  fg_explanations *out = s->out;
  if (out->candidate_count == FG_CANDIDATES_MAX) return true;
  out->candidates[out->candidate_count++] = *placed; /* on trial */
  bool duplicate = false;
  for (size_t e = 0; e + 1 < out->candidate_count; e++)
    duplicate = duplicate || fg_search_has_collinear(out, both | 1u << e);
  out->candidate_count--;
  return duplicate;
}

fg_status fg_search_find_in_place(fg_context *ctx, fg_search *s) {
  fg_search_hit hit;
  fg_search_noise(s, false);
  double max = best_alone(s);
  memcpy(s->columns.left, s->columns.residual, s->columns.rows * sizeof *s->columns.left);
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_PLACED || !fg_search_seeks(s, kind)) continue;
    FG_TRY(fg_search_find_place(ctx, s, s->columns.geometry_rank, kind, &hit));
    fg_candidate found = {.kind = kind, .shape = {hit.at}};
    if (hit.gain < fmax(s->policy->one_more_chi2, max - s->policy->worse_chi2)) continue;
    if (is_there(s, &found)) continue;
    s->unfitted |= 1u << s->out->candidate_count;
    fg_search_add(s, &found);
    s->new_shapes++;
  }
  return FG_OK;
}

/* Returns the gain in units of the noise beside the effect: when the effect is most of the
 * residual, the noise estimate must not include it. */
static double gain_over_rest(fg_search *s, size_t rank, const fg_candidate *effect) {
  double before = fg_dot_in_lanes(s->columns.left, s->columns.left, s->columns.rows), share;
  size_t first, kept = s->columns.count;
  size_t count = fg_search_columns_add(&s->columns, effect->kind, effect->shape, &first, &share);
  rank = fg_search_columns_span_more(&s->columns, rank, first, first + count);
  double after = fg_dot_in_lanes(s->columns.left, s->columns.left, s->columns.rows);
  double noise = after / fmax((double)s->columns.rows - (double)rank, 1);
  double gain = noise > 0 ? (before - after) / (noise * fg_search_integral(&s->columns)) : 0;
  s->columns.count = kept; /* it was on trial */
  return gain;
}

/* Searches ripples and steps beside all smooth effects, one at a time: the residual of a step
 * across itself would be read as a second step. A ripple can be read as several steps and vice
 * versa: the better one is added. */
fg_status fg_search_find_on_discs(fg_context *ctx, fg_search *s) {
  fg_candidate best = {0};
  fg_search_hit hit;
  double max = 0;
  if (s->out->candidate_count >= FG_CANDIDATES_MAX) return FG_OK;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_PLACED || !fg_search_seeks(s, kind)) continue;
    size_t rank = fg_search_noise(s, false);
    FG_TRY(fg_search_find_place(ctx, s, rank, kind, &hit));
    fg_candidate found = {.kind = kind, .shape = {hit.at}};
    if (!(hit.gain > 0) || hit.amplitude <= FG_SEARCH_SHAPED_MIN_UM) continue;
    double gain = gain_over_rest(s, rank, &found);
    if (gain <= fmax(max, s->policy->placed_chi2)) continue;
    max = gain;
    best = found;
  }
  if (max > 0) {
    fg_search_add(s, &best);
    s->new_shapes++;
  }
  return FG_OK;
}
