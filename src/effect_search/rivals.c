/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rivals: free curves of few numbers that fit as well as the listed effects. An example is a curve
 * in x that an oval follows within the noise. */
#include <math.h>

#include "effect_search/state.h"

/* Gain by Schwarz's criterion that a curve able to follow the one listed effect needs (Kass and
 * Raftery 1995, section 3.2: strong). */
#define FOLLOWER_GAIN 10.0
/* It follows an effect of which it leaves no more than this share. */
#define FOLLOWED_SHARE 0.05
/* Loss by Schwarz's criterion up to which a curve may be the true one (Kass and Raftery 1995,
 * section 3.2: "positive" below 6, "very strong" from 10). */
#define CURVE_LOSS 6.0
/* P-value at which a smooth curve is accepted: of some ten curves of five sizes each, 1 in 2000. */
#define CURVE_P 1e-5
/* Numbers of a smooth curve, beside its mean. */
enum { NUMBERS_MAX = 16 };

/* Single bumps have no neighbours: a curve over them is judged by itself. */
static bool is_smooth(const fg_effect *kind) {
  return fg_effect_is_free(kind) && kind->coordinate != FG_EFFECT_INDEX;
}

/* Legendre's polynomial of a degree. */
static double legendre(size_t degree, double x) {
  double before = 1, now = x;
  if (degree == 0) return 1;
  for (size_t n = 1; n < degree; n++) {
    double next = ((double)(2 * n + 1) * x * now - (double)n * before) / (double)(n + 1);
    before = now;
    now = next;
  }
  return now;
}

/* Lists the lowest terms of a curve. Splines whose coefficients follow a polynomial are one term
 * each; other curves have their lowest columns first. */
static size_t list_terms(const fg_search *s, const fg_candidate *curve, size_t numbers,
                         fg_search_term *term) {
  size_t knots = s->columns.edge_fit->frame.knots, count = 0;
  bool splines = curve->kind->coarse != FG_EFFECT_SMOOTHER;
  for (size_t n = 0; n < numbers + splines && n < curve->columns; n++) {
    fg_search_term *to = &term[count++];
    *to = (fg_search_term){.count = 1, .column = {curve->column[n]}, .weight = {1}};
    if (!splines) continue;
    to->count = curve->columns < knots ? curve->columns : knots;
    for (size_t i = 0; i < to->count; i++) {
      to->column[i] = curve->column[i];
      to->weight[i] = legendre(n, 2 * (double)i / (double)(to->count - 1) - 1);
    }
  }
  return count;
}

/* Makes the explanation of one candidate, whose residual sum is `sum`. */
static fg_explanation of_candidate(const fg_search_baseline *y, size_t e, double sum, size_t rank) {
  return (fg_explanation){
      .mask = 1u << e, .excess = fmax(0, sum - y->full) / y->unit, .dof = y->dof - (double)rank};
}

/* Returns the curve with the number of terms that Schwarz's criterion prefers; with `right`, among
 * those that are right. */
static fg_explanation smoothest(const fg_search *s, const fg_search_baseline *y, size_t e,
                                bool right) {
  fg_explanation best = {.excess = INFINITY};
  fg_search_term term[NUMBERS_MAX + 1];
  double x[NUMBERS_MAX + 1];
  for (size_t numbers = 1; numbers <= NUMBERS_MAX; numbers++) {
    size_t count = list_terms(s, &s->out->candidates[e], numbers, term), rank;
    double sum = fg_search_solve(&s->columns, term, count, x, NULL, &rank);
    fg_explanation m = of_candidate(y, e, sum, rank);
    if (rank == 0 || (right && !fg_search_is_right(s, y, &m))) continue;
    if (isfinite(best.excess) && fg_search_schwarz(s, &m) >= fg_search_schwarz(s, &best)) continue;
    best = m;
    if (s->columns.has_width) best.width = fg_search_width_sum(&s->columns, term, count, x);
  }
  return best;
}

/* Returns the single bump that deviates most, its number being a parameter. `score` gets Schwarz's
 * criterion. */
static fg_explanation single_bump(const fg_search *s, const fg_search_baseline *y, size_t e,
                                  bool right, double *score) {
  const fg_candidate *curve = &s->out->candidates[e];
  fg_explanation best = {.excess = INFINITY};
  for (size_t k = 0; k < curve->columns; k++) {
    const fg_search_term term = {.count = 1, .column = {curve->column[k]}, .weight = {1}};
    size_t rank;
    double x, sum = fg_search_solve(&s->columns, &term, 1, &x, NULL, &rank);
    fg_explanation m = of_candidate(y, e, sum, rank);
    if (rank == 0 || m.excess >= best.excess || (right && !fg_search_is_right(s, y, &m))) continue;
    best = m;
    if (s->columns.has_width) best.width = fg_search_width_sum(&s->columns, &term, 1, &x);
  }
  *score = isfinite(best.excess) ? fg_search_schwarz(s, &best) + 2 * log((double)curve->columns)
                                 : INFINITY;
  return best;
}

/* Returns true when a curve can follow every effect of a set. */
static bool follows(const fg_search *s, const fg_candidate *curve, unsigned mask) {
  fg_search_term term[FG_EFFECT_COLUMNS_MAX];
  for (size_t k = 0; k < curve->columns; k++)
    term[k] = (fg_search_term){1, {curve->column[k]}, {1}};
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_candidate *effect = &s->out->candidates[e];
    if (!(mask >> e & 1)) continue;
    for (size_t k = 0; k < effect->terms; k++)
      if (fg_search_residual_share(&s->columns, term, curve->columns, effect->column[k]) >
          FOLLOWED_SHARE)
        return false;
  }
  return true;
}

/* A free curve of few numbers, or one bump, and its score. */
static fg_explanation simplest(const fg_search *s, const fg_search_baseline *y, size_t e,
                               bool right, double *score) {
  if (!is_smooth(s->out->candidates[e].kind)) return single_bump(s, y, e, right, score);
  fg_explanation m = smoothest(s, y, e, right);
  *score = isfinite(m.excess) ? fg_search_schwarz(s, &m) : INFINITY;
  return m;
}

fg_explanation fg_search_best_smooth(const fg_search *s, const fg_search_baseline *y,
                                     double *score) {
  fg_explanation best = {.excess = INFINITY};
  *score = INFINITY;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    double own;
    if (!fg_effect_is_free(s->out->candidates[e].kind)) continue;
    fg_explanation m = simplest(s, y, e, false, &own);
    if (!(own < *score)) continue;
    *score = own;
    best = m;
  }
  return best;
}

bool fg_search_curve_helps(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                           double known_to) {
  fg_search_term term[NUMBERS_MAX + 1];
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if (!is_smooth(s->out->candidates[e].kind)) continue;
    for (size_t numbers = 1; numbers <= NUMBERS_MAX; numbers *= 2) {
      size_t count = list_terms(s, &s->out->candidates[e], numbers, term), columns;
      double gain = fg_search_gain_of_more(s, y, mask, term, count, &columns) - known_to;
      if (columns > 0 && gain > fg_search_chance_limit(s, CURVE_P, (double)columns)) return true;
    }
  }
  return false;
}

/* Returns Schwarz's criterion of a listed set. A sought place is a parameter too, with a penalty of
 * ln of the number of places. */
static double listed_score(const fg_search *s, const fg_explanation *m) {
  double score = fg_search_schwarz(s, m), number = log((double)s->columns.rows / s->out->integral);
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_effect *kind = s->out->candidates[e].kind;
    if ((m->mask >> e & 1) && kind->sought == FG_EFFECT_PLACED)
      score += number + 2 * log((double)kind->starts);
  }
  return score;
}

void fg_search_add_curves(fg_search *s, const fg_search_baseline *y, double score) {
  unsigned first = s->out->each[0].mask;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if ((first >> e & 1) || !is_smooth(s->out->candidates[e].kind)) continue;
    fg_explanation rival = smoothest(s, y, e, true);
    if (isfinite(rival.excess) && fg_search_schwarz(s, &rival) < score + CURVE_LOSS)
      fg_search_keep(s->out, &rival);
  }
}

void fg_search_add_rivals(fg_search *s, const fg_search_baseline *y) {
  fg_explanations *out = s->out;
  const fg_explanation *best = &out->each[0];
  for (size_t m = 1; m < out->count; m++)
    if (listed_score(s, &out->each[m]) < listed_score(s, best)) best = &out->each[m];
  unsigned listed = best->mask;
  double score = listed_score(s, best) + fg_search_causes(listed);
  bool one = fg_search_bits(listed) == 1; /* several that make one curve are none the likelier */
  for (size_t e = 0; listed && e < out->candidate_count; e++) {
    const fg_candidate *curve = &out->candidates[e];
    if (!fg_effect_is_free(curve->kind)) continue;
    if (curve->kind->bends && (listed & y->bends))
      continue; /* the leading column tells it from a curve */
    double own;
    fg_explanation rival = simplest(s, y, e, true, &own);
    if (!isfinite(rival.excess)) continue;
    double gain = score - own - fg_search_causes(rival.mask);
    if (gain >= (one && follows(s, curve, listed) ? FOLLOWER_GAIN : 0)) fg_search_keep(out, &rival);
  }
}
