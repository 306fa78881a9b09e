/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sets of candidates: their order, the right ones, and the curve when none is right. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "effect_search/policy.h"

/* Schwarz's criterion is -2 ln of a probability up to a constant; a difference of 10 is very strong
 * (Kass and Raftery 1995, section 3.2). */
#define SCORE_GAIN 10.0
/* Maximum residual of a set with an unfitted shape, as a share of the residual without effects, */
#define FITTING_SHARE 0.1
/* and as a multiple of a curve's residual (both tuned on reports/loop_scans.md). */
#define FITTING_TIMES 30.0
/* Penalty of a place, a middle, a length or a period sought over a grid, as -2 ln of a probability:
 * of some eight values that rows this noisy tell apart one is right. A column costs 2. An oracle
 * that orders single effects by this names 87 of 100 turned pairs; with every number at 2, 85;
 * without a penalty, 81; Bayes' rule over the grid itself, 89 (tests/bench/loop_oracle.py). */
#define SHAPE 4.0
/* Number of effects from which one curve does not replace them. */
enum { FEW = 2 };

/* The next set of some candidates, in ascending order; 0 behind the last one. */
static unsigned next_of(unsigned all, unsigned mask) {
  return (mask - all) & all;
}

/* ---- listed effects ---- */

/* Ripples and steps, those in force and all; none where they count as any other effect. */
typedef struct placed_masks {
  unsigned known, all;
} placed_masks;

static placed_masks find_placed_masks(const fg_search *s) {
  placed_masks masks = {0, 0};
  size_t count = s->out->candidate_count;
  for (size_t e = 0; s->policy->placed_beside && e < count; e++) {
    if (s->out->candidates[e].kind->sought != FG_EFFECT_PLACED) continue;
    masks.all |= 1u << e;
    if (e + s->new_shapes < count) masks.known |= 1u << e;
  }
  return masks;
}

/* Returns true for a set of few smooth effects. Smooth effects are nearly collinear; ripples and
 * steps are distinct and do not count. */
static bool is_small(unsigned mask, placed_masks placed, size_t max) {
  unsigned held = mask & placed.all, more = held & ~placed.known;
  bool one_more = (held & placed.known) == placed.known && fg_search_bits(more) <= 1;
  return fg_search_bits(mask & ~placed.all) <= max &&
         (fg_search_bits(mask) <= max || one_more || held == placed.all);
}

/* Returns true when a mask holds exactly the effects of a set. */
static bool is_mask_of(const fg_search *s, const fg_effect_set *set, unsigned mask) {
  size_t count = 0;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if (!(mask >> e & 1)) continue;
    if (count == set->count || set->effects[count].kind != s->out->candidates[e].kind) return false;
    count++;
  }
  return count > 0 && count == set->count;
}

static bool was_given_up(const fg_search *s, unsigned mask) {
  for (size_t i = 0; i < s->given_up_count; i++)
    if (is_mask_of(s, &s->given_up[i], mask)) return true;
  return false;
}

static bool is_set(const fg_search *s, unsigned mask) {
  if (was_given_up(s, mask)) return false;
  return s->policy->keeps_collinear || !fg_search_has_collinear(s->out, mask);
}

/* Returns the gain of one more effect by chance, with its columns. An effect sought over places
 * gains more by chance. */
static double chance_of(const fg_search *s, size_t e, double columns) {
  const fg_search_policy *policy = s->policy;
  if (!policy->counts_columns) return policy->one_more_chi2;
  double p = gsl_cdf_chisq_Q(policy->one_more_chi2, 1);
  double chance = gsl_cdf_chisq_Qinv(p, fmax(columns, 1));
  bool placed = s->out->candidates[e].kind->sought == FG_EFFECT_PLACED;
  return placed ? fmax(chance, policy->placed_chi2) : chance;
}

/* Returns true when one more listed effect, or a smooth curve, explains more than allowed. */
static bool one_more_helps(const fg_search *s, const fg_search_baseline *y,
                           const fg_explanation *m) {
  unsigned more = fg_search_mask_of(s->out, false) & ~m->mask;
  double error = s->policy->more_error, taken = fmax(0, y->none - m->excess);
  double known_to = s->policy->counts_columns ? y->allowance + error * error * taken : 0;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if (!(more >> e & 1)) continue;
    fg_explanation with = fg_search_try(s, y, m->mask | 1u << e);
    double gain = m->excess - with.excess;
    if (gain > known_to + chance_of(s, e, m->dof - with.dof)) return true;
  }
  return s->policy->has_rivals && fg_search_curve_helps(s, y, m->mask, known_to);
}

/* Criteria of a pass over the sets of one size. */
typedef struct pass {
  placed_masks placed;
  size_t size, max;
  bool exact; /* right without the allowance for errors of the effects' bases */
  double min; /* and with less than this */
} pass;

/* Keeps the right sets of one size; `best` gets the best set tried. */
static void try_size(fg_search *s, const fg_search_baseline *y, const pass *p,
                     fg_explanation *best) {
  unsigned listed = fg_search_mask_of(s->out, false);
  for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = next_of(listed, mask)) {
    if (fg_search_bits(mask) != p->size || !is_small(mask, p->placed, p->max) || !is_set(s, mask))
      continue;
    fg_explanation explanation = fg_search_try(s, y, mask);
    bool right = fg_search_is_right(s, y, &explanation) && explanation.excess < p->min &&
                 (!p->exact || fg_search_is_exact(s, y, &explanation));
    if (right && !one_more_helps(s, y, &explanation)) fg_search_keep(s->out, &explanation);
    if (s->policy->is_better(s, &explanation, best)) *best = explanation;
  }
}

/* Replaces sets that are right only by the allowance for errors of the bases: one effect more that
 * is right without it is better, if the difference exceeds the whole allowance. */
static void try_exact(fg_search *s, const fg_search_baseline *y, pass p) {
  fg_explanations *out = s->out;
  fg_explanation each[FG_EXPLANATIONS_MAX], best = {.excess = INFINITY};
  size_t count = out->count, total = out->total;
  memcpy(each, out->each, sizeof each);
  for (size_t m = 0; m < count; m++) {
    if (fg_search_is_exact(s, y, &each[m])) return;
    p.min = fmin(p.min, each[m].excess - fg_search_known_to(s, y, &each[m]));
  }
  p.exact = true;
  p.size++;
  out->count = out->total = 0;
  try_size(s, y, &p, &best);
  if (out->count) return;
  memcpy(out->each, each, sizeof each);
  out->count = count;
  out->total = total;
}

/* Tries listed sets by size, up to the first size with a right one. Returns the best set tried. */
static fg_explanation try_listed(fg_search *s, const fg_search_baseline *y) {
  fg_explanation best = {.excess = INFINITY};
  pass p = {.placed = find_placed_masks(s),
            .max = s->policy->effects_max(s->columns.edge_fit),
            .min = INFINITY};
  size_t largest = p.max + fg_search_bits(p.placed.all);
  if (largest > FG_EFFECT_SET_MAX) largest = FG_EFFECT_SET_MAX;
  for (; p.size <= largest && !s->out->count; p.size++)
    try_size(s, y, &p, &best);
  p.size--;
  if (s->out->count && s->policy->has_rivals && p.size < largest) try_exact(s, y, p);
  return best;
}

/* Members that are worse than the best as far as the data can show leave. */
static void drop_worse(const fg_search *s, const fg_search_baseline *y) {
  fg_explanations *out = s->out;
  size_t kept = 0;
  double min = INFINITY;
  for (size_t m = 0; m < out->count; m++)
    min = fmin(min, out->each[m].excess);
  for (size_t m = 0; m < out->count; m++)
    if (out->each[m].excess <= min + s->policy->worse_chi2 + y->allowance)
      out->each[kept++] = out->each[m];
  out->total -= out->count - kept;
  out->count = kept;
}

/* Returns the number of shape parameters, which are no columns and which Akaike's criterion lacks.
 */
static double shapes_of(const fg_search *s, unsigned mask) {
  double cost = 0;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_effect *kind = s->out->candidates[e].kind;
    bool is_column = kind->polynomial > FG_EFFECT_LINEAR || fg_effect_is_free(kind);
    if (mask >> e & 1) cost += (double)kind->shapes * (is_column ? SHAPE - 2 : SHAPE);
  }
  return cost;
}

static double likelihood(const fg_search *s, const fg_explanation *m) {
  return fg_search_akaike(m) + m->width + fg_search_causes(m->mask) + shapes_of(s, m->mask);
}

/* Orders tied sets by the width of the strip. Its noise is the residual of the best of them. */
static void order_by_width(const fg_search *s) {
  fg_explanations *out = s->out;
  double width = INFINITY;
  for (size_t m = 0; m < out->count; m++)
    width = fmin(width, out->each[m].width);
  for (size_t m = 0; m < out->count; m++)
    out->each[m].width = width > 0 ? (out->each[m].width / width - 1) * (double)s->columns.rows : 0;
  for (size_t m = 1; m < out->count; m++)
    for (size_t k = m; k > 0 && likelihood(s, &out->each[k]) < likelihood(s, &out->each[k - 1]);
         k--) {
      fg_explanation swap = out->each[k];
      out->each[k] = out->each[k - 1];
      out->each[k - 1] = swap;
    }
}

/* ---- free curves ---- */

/* Returns Schwarz's criterion of a set with a free curve, relative to a listed effect beside it. */
static double free_score(const fg_search *s, const fg_search_baseline *y, fg_explanation m) {
  double share = s->policy->curve_share;
  if (!isfinite(m.excess)) return INFINITY;
  m.excess = fmax(0, m.excess - share * share * y->none);
  return fg_search_schwarz(s, &m);
}

/* The best set with a curve so far, and its score. */
typedef struct curve_trial {
  fg_explanation best;
  double score;
} curve_trial;

/* Every curve of a mask beside a listed set. Every further effect must be worth its while. */
static void try_curves(const fg_search *s, const fg_search_baseline *y, unsigned curves,
                       unsigned beside, curve_trial *trial) {
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if (!(curves >> e & 1) || was_given_up(s, beside | 1u << e)) continue;
    fg_explanation explanation = fg_search_try(s, y, beside | 1u << e);
    double gained = trial->score - fg_search_schwarz(s, &explanation);
    if (beside)
      gained = fmin(gained, free_score(s, y, trial->best) - free_score(s, y, explanation));
    if (!(gained > SCORE_GAIN)) continue;
    *trial = (curve_trial){explanation, fg_search_schwarz(s, &explanation)};
  }
}

static void try_curves_beside(const fg_search *s, const fg_search_baseline *y, unsigned curves,
                              size_t size, curve_trial *trial) {
  unsigned listed = fg_search_mask_of(s->out, false);
  for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = next_of(listed, mask))
    if (fg_search_bits(mask) == size && !fg_search_has_collinear(s->out, mask))
      try_curves(s, y, curves, mask, trial);
}

/* Tries a free curve, alone or beside few listed effects: the best one for its number of columns;
 * the best listed set stays when none is better. */
static fg_explanation try_free(const fg_search *s, const fg_search_baseline *y,
                               fg_explanation best) {
  unsigned free = fg_search_mask_of(s->out, true);
  const fg_edge_fit *edge_fit = s->columns.edge_fit;
  size_t max = edge_fit->coarse || edge_fit->proposes ? 0 : s->policy->beside_curve;
  curve_trial trial = {best, isfinite(best.excess) ? fg_search_schwarz(s, &best) : INFINITY};
  for (size_t size = 0; size <= max && !s->policy->curves_alone_last; size++)
    try_curves_beside(s, y, free, size, &trial);
  for (size_t e = 0; e < s->out->candidate_count && s->policy->curves_alone_last; e++)
    for (size_t size = max + 1; size-- > 0;)
      try_curves_beside(s, y, free & 1u << e, size, &trial);
  return trial.best;
}

/* Tries two curves, alone or beside one listed effect: a carriage that runs unevenly also sways.
 * One view cannot separate them. */
static fg_explanation try_two_free(const fg_search *s, const fg_search_baseline *y,
                                   fg_explanation best) {
  const fg_explanations *out = s->out;
  unsigned listed = fg_search_mask_of(out, false), free = fg_search_mask_of(out, true);
  if (!s->two_curves || fg_search_is_right(s, y, &best)) return best;
  for (unsigned two = 0, first = 1; first || two; first = 0, two = next_of(free, two)) {
    if (fg_search_bits(two) != 2 || fg_search_has_collinear(out, two)) continue;
    for (size_t with = 0; with <= out->candidate_count; with++) {
      unsigned mask = two | (with < out->candidate_count ? 1u << with & listed : 0);
      if (with < out->candidate_count && mask == two) continue;
      fg_explanation explanation = fg_search_try(s, y, mask);
      double gained = fmin(fg_search_schwarz(s, &best) - fg_search_schwarz(s, &explanation),
                           free_score(s, y, best) - free_score(s, y, explanation));
      if (gained > SCORE_GAIN) best = explanation;
    }
  }
  return best;
}

bool fg_search_hopes_for_shape(const fg_search *s, const fg_search_baseline *y,
                               const fg_explanation *best, const fg_explanation *curve) {
  double share = s->policy->curve_share;
  bool one_curve = fg_search_bits(curve->mask) == 1 && curve->excess < share * share * y->none;
  if (one_curve && fg_search_bits(best->mask) > FEW) return false;
  return (best->mask & s->unfitted) && best->excess < FITTING_SHARE * y->none &&
         !(s->tried && is_mask_of(s, s->tried, best->mask)) &&
         best->excess < FITTING_TIMES * (curve->excess + y->dof);
}

/* ---- all of them ---- */

/* Finds the curve that replaces the listed sets where none is right. */
static void stand_in(fg_search *s, const fg_search_baseline *y, fg_explanation best) {
  fg_explanation curve = try_free(s, y, best);
  if (s->policy->has_rivals) {
    double score;
    fg_explanation smooth = fg_search_best_smooth(s, y, &score);
    double gain = fg_search_schwarz(s, &curve) + fg_search_causes(curve.mask) - score -
                  fg_search_causes(smooth.mask);
    if (isfinite(smooth.excess) && gain > 0) curve = smooth;
  }
  bool hope = !s->hopeless && s->policy->is_worth_fitting(s, y, &best, &curve);
  if (!hope) curve = try_two_free(s, y, curve);
  s->out->right = !hope && fg_search_is_right(s, y, &curve);
  fg_search_keep(s->out, hope ? &best : &curve);
  bool one_curve =
      fg_search_bits(curve.mask) == 1 && (curve.mask & fg_search_mask_of(s->out, true));
  if (s->policy->has_rivals && s->out->right && one_curve)
    fg_search_add_curves(s, y, fg_search_schwarz(s, &curve));
}

void fg_search_try_sets(fg_search *s, const fg_search_baseline *y) {
  fg_explanation best = try_listed(s, y);
  s->out->right = s->out->count > 0;
  if (!s->out->right) {
    stand_in(s, y, best);
    return;
  }
  if (s->policy->has_rivals) fg_search_add_rivals(s, y);
  drop_worse(s, y);
  order_by_width(s);
}
