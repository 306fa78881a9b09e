/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scale that the edges cannot see.
 *
 * Two optical polynomials with different middles differ by a stretch of x. A stretch of x equals an
 * opposite stretch of y beside a scale of both axes, and a scale of both axes leaves no residual.
 * So with a free middle, a polynomial in x and `scan.scale_y` are equivalent, except for the size
 * of every length. Only the design separates them: heat treatment keeps the arc length of a bump.
 * Where all bumps miss their arc length by the same share, the scanner's scale explains that as
 * well as the part's stretch. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/report.h"
#include "scan_loop/state.h"

static const fg_effect *find_optical(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->polynomial && set->effects[e].kind->axis == 0)
      return set->effects[e].kind;
  return NULL;
}

static fg_loop_claim *find_stretch(fg_scan_loop_bumps *bumps, double *rel) {
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    for (size_t i = 0; i < bumps->level[r].result.claims; i++) {
      fg_loop_claim *claim = &bumps->level[r].result.claim[i];
      const char *name;
      double u;
      if (claim->candidate.effect->over_bumps != FG_LOOP_BUMP_STRETCH) continue;
      if (!fg_scan_loop_bumps_parameter(bumps, r, claim, 0, &name, rel, &u)) continue;
      if (!strcmp(name, "arc_length_rel")) return claim;
    }
  return NULL;
}

static void widen_interval(double range[2], double value, double u, double scale) {
  if (!isfinite(value)) return;
  if (range[0] == 0 && range[1] == 0) range[0] = range[1] = value;
  for (int side = -1; side <= 1; side += 2)
    for (int scaled = 0; scaled < 2; scaled++) {
      double at = (value + side * FG_COVERAGE_FACTOR * u) * (scaled ? scale : 1);
      range[0] = fmin(range[0], at);
      range[1] = fmax(range[1], at);
    }
}

static void widen_foil(fg_foil *foil, double scale) {
  for (size_t b = 0; b < foil->bump_count; b++) {
    fg_bump *bump = &foil->bumps[b];
    widen_interval(bump->radius_range_mm, bump->radius_mm, bump->u_radius_mm, scale);
    widen_interval(bump->height_range_mm, bump->height_mm, bump->u_height_mm, scale);
  }
  fg_overall *overall = &foil->overall;
  widen_interval(overall->radius_range_mm, overall->radius_mm, overall->u_radius_mm, scale);
}

/* Names the same effects with the scale instead of the stretch; a scale that is in the set already
 * stands, beside a cubic, for a quadratic. */
static void name_alias(const fg_effect_set *set, fg_loop_claim *claim) {
  fg_loop_alias *alias = &claim->alias[0];
  const fg_effect *scale = fg_effect_find_polynomial(FG_EFFECT_LINEAR, 1), *last = scale;
  size_t used = 0;
  *alias = (fg_loop_alias){.sum = true, .correlation = 1};
  for (size_t e = 0; e < set->count && used < sizeof alias->name; e++) {
    const fg_effect *kind = set->effects[e].kind;
    if (kind == scale)
      last = fg_effect_find_polynomial(FG_EFFECT_QUADRATIC, 0);
    else
      used += (size_t)snprintf(alias->name + used, sizeof alias->name - used, "%s + ", kind->id);
  }
  if (used < sizeof alias->name)
    snprintf(alias->name + used, sizeof alias->name - used, "%s", last->id);
  claim->aliases = 1;
  claim->aliases_unlisted = 0;
  claim->verdict = FG_LOOP_TIED;
}

fg_status fg_scan_loop_scale_uncertainty(fg_context *ctx, fg_scan_loop *loop) {
  double rel = 0;
  const fg_effect *optical = find_optical(&loop->set);
  fg_loop_claim *stretch = find_stretch(&loop->bumps, &rel);
  if (!optical || !stretch) return FG_OK;
  loop->scale_tied = true;
  name_alias(&loop->set, stretch);
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->after[i].foil_count; f++)
      widen_foil(&loop->after[i].foils[f], 1 / (1 + rel));
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: %s about another middle, beside a scale of the carriage, "
      "leaves the same edges and makes every length %.0f ppm %s; the arc "
      "lengths of the bumps speak for it or for %s: the ranges "
      "hold both",
      optical->id, fabs(1e6 * rel), rel > 0 ? "smaller" : "larger", stretch->candidate.effect->id);
}
