/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Score of one set of effects: its least squares, and the decision whether it is right. */
#include <math.h>
#include <string.h>

#include "effect_search/policy.h"

/* P-value of the excess over all effects, above which a set is right. */
#define ACCEPT_P 0.001
/* Largest distance of a polynomial's middle from the picture's, in picture sizes: beyond it the
 * effect is a scale. */
#define MIDDLE_REACH 1.5
/* Minimum share of the lowest polynomial in a deviation of every bump: below it, it is neither a
 * crown nor a skew but a curve (tuned on reports/loop_scans.md, tier curves). */
#define LOWEST_SHARE 0.6
/* Steps of the grid for a middle; of the finer ones around its best, each over two of its steps. */
enum { MIDDLE_STEPS = 60, MIDDLE_LEVELS = 3, MIDDLE_FINER = 10 };

typedef struct set_terms {
  fg_search_term term[FG_SEARCH_TERMS];
  size_t count, first[FG_CANDIDATES_MAX], cubic; /* cubic: that effect, or FG_CANDIDATES_MAX */
} set_terms;

static void put_cubic(const fg_candidate *e, double t, fg_search_term *term) {
  *term = (fg_search_term){3, {e->column[0], e->column[1], e->column[2]}, {1, -3 * t, 3 * t * t}};
}

static void put_quadratic(const fg_candidate *e, double t, fg_search_term *term) {
  *term = (fg_search_term){2, {e->column[0], e->column[1]}, {1, -2 * t}};
}

static void list_terms(const fg_explanations *out, unsigned mask, set_terms *set) {
  set->count = 0;
  set->cubic = FG_CANDIDATES_MAX;
  for (size_t e = 0; e < out->candidate_count; e++) {
    const fg_candidate *effect = &out->candidates[e];
    set->first[e] = set->count;
    if (!(mask >> e & 1)) continue;
    if (effect->polynomial == FG_EFFECT_CUBIC) {
      put_cubic(effect, 0, &set->term[set->count++]);
      set->cubic = e;
      continue;
    }
    for (size_t c = 0; c < effect->terms && set->count < FG_SEARCH_TERMS; c++)
      set->term[set->count++] = (fg_search_term){1, {effect->column[c]}, {1}};
  }
}

/* The middle of a cubic: the best of a grid, then finer. */
static double find_middle(const fg_search *s, const fg_search_baseline *y, set_terms *set) {
  fg_search_term *term = &set->term[set->first[set->cubic]];
  const fg_candidate *effect = &s->out->candidates[set->cubic];
  double low = -y->reach, high = y->reach, best = INFINITY, at = 0;
  for (int level = 0; level < MIDDLE_LEVELS; level++) {
    int steps = level || s->columns.edge_fit->coarse ? MIDDLE_FINER : MIDDLE_STEPS;
    for (int i = 0; i <= steps; i++) {
      size_t rank;
      double t = low + (high - low) * i / steps;
      put_cubic(effect, t, term);
      double sum = fg_search_solve(&s->columns, set->term, set->count, NULL, NULL, &rank);
      if (sum >= best) continue;
      best = sum;
      at = t;
    }
    double step = (high - low) / steps;
    low = at - step;
    high = at + step;
  }
  put_cubic(effect, at, term);
  return at;
}

static double find_polynomial_middle(const fg_search *s, const fg_candidate *effect, double t) {
  return s->columns.edge_fit->frame.centre_mm[effect->kind->axis] + FG_FIELD_HALF_MM * t;
}

static bool scanned_again(const fg_search *s) {
  return s->columns.edge_fit->view_count > s->columns.edge_fit->part_count;
}

/* Holds the middles that the data do not determine. In one view a quadratic gains little over its
 * slope, and its middle may come out anywhere. A middle out of reach is held at the end of the
 * reach, on the side with the smaller residual. Returns the number of middles held. */
static size_t hold_middles(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                           const double *x, set_terms *set) {
  size_t held = 0;
  if (s->policy->quadratic_chi2 > 0 || scanned_again(s)) return 0;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_candidate *effect = &s->out->candidates[e];
    if (!(mask >> e & 1) || effect->polynomial != FG_EFFECT_QUADRATIC) continue;
    const double *own = x + set->first[e] + held;
    if (fabs(0.5 * own[1]) <= y->reach * fabs(own[0])) continue;
    size_t at = set->first[e], rank;
    memmove(&set->term[at + 1], &set->term[at + 2], (set->count - at - 2) * sizeof set->term[0]);
    set->count--;
    held++;
    for (size_t k = e + 1; k < s->out->candidate_count; k++)
      set->first[k]--;
    double left[2], middle[2] = {-y->reach, y->reach};
    for (int side = 0; side < 2; side++) {
      put_quadratic(effect, middle[side], &set->term[at]);
      left[side] = fg_search_solve(&s->columns, set->term, set->count, NULL, NULL, &rank);
    }
    if (left[0] < left[1]) put_quadratic(effect, middle[0], &set->term[at]);
  }
  return held;
}

/* Returns true for a quadratic that gains over its slope; with a far middle, or without a gain, it
 * is a scale. */
static bool is_quadratic(const fg_search *s, const fg_search_baseline *y, const set_terms *set,
                         size_t e, const double *x, double sum, double *t) {
  const double *own = x + set->first[e];
  const fg_search_term *term = &set->term[set->first[e]];
  if (term->count > 1) { /* its middle is held */
    *t = -0.5 * term->weight[1];
    return true;
  }
  *t = own[0] != 0 ? -0.5 * own[1] / own[0] : INFINITY;
  if (!(fabs(*t) <= y->reach)) return false;
  set_terms without = *set;
  size_t at = set->first[e], rank;
  memmove(&without.term[at], &without.term[at + 1], (set->count - at - 1) * sizeof without.term[0]);
  without.count--;
  double alone = fg_search_solve(&s->columns, without.term, without.count, NULL, NULL, &rank);
  double min = scanned_again(s) ? FG_SEARCH_GAIN_MIN : s->policy->quadratic_chi2;
  return alone - sum >= min * y->unit;
}

/* Crown and skew are led by their lowest polynomial. */
static bool is_led(const fg_search_columns *c, const fg_candidate *effect, const double *own) {
  double lead = 0, rest = 0;
  for (size_t k = 0; k < effect->terms; k++) {
    size_t column = effect->column[k];
    double square = own[k] * own[k] * c->gram[column * FG_SEARCH_COLUMNS + column];
    *(k ? &rest : &lead) += square;
  }
  return lead > 0 && lead >= LOWEST_SHARE * (lead + rest);
}

static bool has_forming(const fg_search *s, const fg_search_baseline *y, const set_terms *set,
                        size_t e, const double *x, double sum, fg_explanation *explanation) {
  const fg_candidate *effect = &s->out->candidates[e];
  double t = 0;
  if (effect->polynomial == FG_EFFECT_QUADRATIC) {
    if (!is_quadratic(s, y, set, e, x, sum, &t)) return false;
    explanation->middle_mm[e] = find_polynomial_middle(s, effect, t);
  }
  if (effect->kind->numbers == FG_EFFECT_LED) return is_led(&s->columns, effect, x + set->first[e]);
  return true;
}

fg_explanation fg_search_try(const fg_search *s, const fg_search_baseline *y, unsigned mask) {
  const fg_explanations *out = s->out;
  fg_explanation explanation = {.mask = mask};
  set_terms set;
  double x[FG_SEARCH_TERMS];
  size_t rank;
  list_terms(out, mask, &set);
  if (set.cubic < FG_CANDIDATES_MAX)
    explanation.middle_mm[set.cubic] =
        find_polynomial_middle(s, &out->candidates[set.cubic], find_middle(s, y, &set));
  double sum = fg_search_solve(&s->columns, set.term, set.count, x, NULL, &rank);
  size_t held = hold_middles(s, y, mask, x, &set);
  if (held) sum = fg_search_solve(&s->columns, set.term, set.count, x, NULL, &rank);
  rank += held;
  explanation.excess = fmax(0, sum - y->full) / y->unit;
  explanation.dof = y->dof - (double)rank - (set.cubic < FG_CANDIDATES_MAX);
  for (size_t e = 0; e < out->candidate_count; e++)
    if ((mask >> e & 1) && !has_forming(s, y, &set, e, x, sum, &explanation))
      explanation.excess = INFINITY;
  if (s->columns.has_width)
    explanation.width = fg_search_width_sum(&s->columns, set.term, set.count, x);
  return explanation;
}

double fg_search_known_to(const fg_search *s, const fg_search_baseline *y,
                          const fg_explanation *m) {
  double taken = fmax(0, y->none - m->excess);
  double error = m->mask & y->bends ? s->policy->bend_error : s->policy->effect_error;
  return y->allowance + error * error * taken;
}

bool fg_search_is_right(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m) {
  double chance = fg_search_chance_limit(s, ACCEPT_P, m->dof);
  return m->excess <= chance + fg_search_known_to(s, y, m);
}

bool fg_search_is_exact(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m) {
  return m->excess <= fg_search_chance_limit(s, ACCEPT_P, m->dof) + y->allowance;
}

double fg_search_schwarz(const fg_search *s, const fg_explanation *m) {
  return m->excess - log((double)s->columns.rows / s->out->integral) * m->dof;
}

double fg_search_gain_of_more(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                              const fg_search_term *more, size_t count, size_t *numbers) {
  set_terms set;
  size_t before, after;
  list_terms(s->out, mask, &set);
  if (set.cubic < FG_CANDIDATES_MAX) find_middle(s, y, &set);
  if (set.count + count > FG_SEARCH_TERMS) return 0;
  double sum = fg_search_solve(&s->columns, set.term, set.count, NULL, NULL, &before);
  memcpy(set.term + set.count, more, count * sizeof *more);
  double less = fg_search_solve(&s->columns, set.term, set.count + count, NULL, NULL, &after);
  *numbers = after - before;
  return (sum - less) / y->unit;
}

double fg_search_sum_of_one(const fg_search *s, const fg_search_baseline *y, size_t e) {
  set_terms set;
  size_t rank;
  list_terms(s->out, 1u << e, &set);
  if (set.cubic < FG_CANDIDATES_MAX) find_middle(s, y, &set);
  return fg_search_solve(&s->columns, set.term, set.count, NULL, NULL, &rank);
}

double fg_search_amplitude_u(const fg_search *s, unsigned others, size_t e) {
  const fg_candidate *effect = &s->out->candidates[e];
  size_t own = s->policy->smallest_beside_own ? effect->terms : 1, before, rank;
  set_terms set;
  double u = INFINITY;
  list_terms(s->out, others & ~(1u << e), &set);
  if (set.count + own > FG_SEARCH_TERMS) return INFINITY;
  fg_search_solve(&s->columns, set.term, set.count, NULL, NULL, &before);
  for (size_t c = 0; c < own; c++)
    set.term[set.count++] = (fg_search_term){1, {effect->column[c]}, {1}};
  fg_search_solve(&s->columns, set.term, set.count, NULL, &u, &rank);
  return rank == before ? INFINITY : u;
}

fg_search_baseline fg_search_find_baseline(fg_search *s) {
  fg_explanations *out = s->out;
  const fg_field_frame *frame = &s->columns.edge_fit->frame;
  double extent = fmax(frame->high_mm[0] - frame->low_mm[0], frame->high_mm[1] - frame->low_mm[1]);
  fg_search_baseline y = {.full = s->full,
                          .dof = (double)s->dof,
                          .unit = out->noise_um * out->noise_um * out->integral,
                          .none = (s->columns.square - s->full) /
                                  (out->noise_um * out->noise_um * out->integral),
                          .reach = MIDDLE_REACH * extent / FG_FIELD_HALF_MM};
  for (size_t e = 0; e < out->candidate_count; e++)
    if (out->candidates[e].kind->numbers == FG_EFFECT_LED) y.bends |= 1u << e;
  double edge = s->policy->edge_error_um, edge_um = sqrt(edge * edge + s->columns.width_part);
  if (s->columns.has_width) out->edge_error_um = edge_um; /* else nothing showed it */
  y.allowance = (double)s->columns.rows * edge_um * edge_um / y.unit;
  return y;
}
