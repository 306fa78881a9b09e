#include "explain/explain.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "effect/columns.h"
#include "explain/search.h"

/* Sets this much worse than the best of their size are worse as far as data can show. */
#define WORSE 25.0
/* A set with a shape that is not fitted yet may leave this share of what there is. */
#define FITTING_SHARE 0.1
/* and this many times what a curve leaves */
#define FITTING_TIMES 30.0
/* No coefficient is larger, um: columns that nearly cancel would explain anything. */
#define LARGEST_UM 400.0
/* A curve is known to this share of itself: no listed effect stands beside it for less. */
#define CURVE_SHARE 0.03
/* A curve with all its columns leaves less than this share of what a smoother one does. */
#define FINER 0.9
/* No row is better known, um: exact data are not of a scanner. */
#define NOISE_LEAST_UM 1e-4
/* Rows beyond the numbers that are fitted to them: fewer tell no noise. */
enum { FREEDOM_LEAST = 12 };
/* Effects that one curve does not stand for. */
enum { FEW = 2 };

/* ---- effects and their columns ---- */

void fg_explain_add(fg_explain_search *s, const fg_candidate *effect) {
  fg_explanations *out = s->out;
  size_t e = out->candidate_count++, first;
  fg_candidate *to = &out->candidates[e];
  *to = *effect;
  to->shapes = effect->kind->shapes;
  to->columns = to->terms =
      fg_explain_columns_add(&s->columns, effect->kind, effect->shape, &first, &out->share[e]);
  for (size_t c = 0; c < to->columns; c++)
    to->column[c] = first + c;
}

/* Of the curves, what all effects at once have: half as many columns, and one form. */
static void choose_parts(fg_explain_columns *c, const fg_candidate *effect) {
  const fg_effect *kind = effect->kind;
  for (size_t k = 0; k < effect->columns; k++) {
    bool splines = kind->coarse == FG_EFFECT_SPLINES;
    bool rough = kind->coarse == FG_EFFECT_LEFT_OUT || (splines && k % 2 > 0) ||
                 (kind->coarse == FG_EFFECT_SMOOTHER && k >= kind->rough[0] && k < kind->rough[1]);
    c->part[effect->column[k]] = rough     ? FG_EXPLAIN_LEFT_OUT
                                 : splines ? FG_EXPLAIN_WITH_NEXT
                                           : FG_EXPLAIN_ITSELF;
  }
}

/* A polynomial of the scanner, made of the powers of its axis from column `first` on: its own is
 * the highest, and those below give its middle. */
static void add_polynomial(fg_explain_search *s, const fg_effect *kind, size_t first) {
  size_t e = s->out->candidate_count++, degree = kind->polynomial - FG_EFFECT_LINEAR;
  fg_candidate *to = &s->out->candidates[e];
  *to = (fg_candidate){.kind = kind,
                       .polynomial = kind->polynomial,
                       .columns = kind->columns,
                       .shapes = kind->shapes,
                       .terms = kind->polynomial == FG_EFFECT_QUADRATIC ? 2 : 1};
  for (size_t k = 0; k <= degree; k++)
    to->column[k] = first + degree - k;
  size_t lead = to->column[0];
  s->out->share[e] = s->columns.gram[lead * FG_EXPLAIN_COLUMNS + lead] / (double)s->columns.rows;
}

/* The powers are shared by the polynomials that are made of them. */
static fg_status add_smooth(fg_context *ctx, fg_explain_search *s, const fg_effect_set *known) {
  size_t first[2] = {0, 0};
  double share[2] = {0, 0}, none[FG_FIELD_SHAPES] = {0};
  for (int axis = 0; axis < 2; axis++)
    fg_explain_columns_add(&s->columns, &fg_effect_powers[axis], none, &first[axis], &share[axis]);
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought == FG_EFFECT_PLACED || !fg_effect_shows(s->columns.points, kind)) continue;
    if (fg_effect_is_free(kind) && !s->free_column) s->free_column = s->columns.count;
    if (kind->polynomial) {
      add_polynomial(s, kind, first[kind->axis]);
      continue;
    }
    if (kind->start) {
      FG_TRY(fg_explain_add_shaped(ctx, s, kind, known));
      continue;
    }
    fg_explain_add(s, &(fg_candidate){.kind = kind});
    if (fg_effect_is_free(kind))
      choose_parts(&s->columns, &s->out->candidates[s->out->candidate_count - 1]);
  }
  s->free_end = s->columns.count;
  return FG_OK;
}

double fg_explain_integral(const fg_explain_columns *s) {
  return fg_points_integral(s->points, s->row, s->rows, s->left);
}

static double noise_of(const fg_explain_columns *c, size_t rank) {
  double freedom = fmax((double)c->rows - (double)rank, 1);
  return fmax(sqrt(fg_explain_dot(c->rows, c->left, c->left) / freedom), NOISE_LEAST_UM);
}

fg_status fg_explain_check_rows(fg_context *ctx, const fg_explain_search *s) {
  size_t numbers = s->columns.geometry_rank + s->freedom;
  if (s->columns.rows >= numbers + FREEDOM_LEAST) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%zu edge rows are too few to look for effects: %zu numbers would be fitted to "
                 "them; scan more bumps, or at a higher resolution",
                 s->columns.rows, numbers);
}

static void take_noise(fg_explain_search *s, size_t rank) {
  s->full = fg_explain_dot(s->columns.rows, s->columns.left, s->columns.left);
  s->freedom = rank - s->columns.geometry_rank;
  s->out->noise_um = noise_of(&s->columns, rank);
  s->out->integral = fg_explain_integral(&s->columns);
}

size_t fg_explain_noise(fg_explain_search *s, bool listed_only) {
  size_t end = listed_only ? s->free_end : s->free_column;
  size_t rank = fg_explain_columns_span(&s->columns, s->free_column, end);
  take_noise(s, rank);
  return rank;
}

/* A curve that is there is no noise: the one that leaves far less with all its columns has them. */
static void refine_noise(fg_explain_search *s) {
  const fg_candidate *best = NULL;
  size_t rank = fg_explain_noise(s, false);
  double least = FINER * s->out->noise_um;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_candidate *curve = &s->out->candidates[e];
    if (!fg_effect_is_free(curve->kind)) continue;
    size_t from = curve->column[0];
    size_t more = fg_explain_columns_span_more(&s->columns, rank, from, from + curve->columns);
    double noise = noise_of(&s->columns, more);
    if (noise >= least) continue;
    least = noise;
    best = curve;
  }
  if (!best) return;
  size_t from = best->column[0];
  take_noise(s, fg_explain_columns_span_more(&s->columns, rank, from, from + best->columns));
}

/* ---- all sets ---- */

size_t fg_explain_bits(unsigned mask) {
  size_t n = 0;
  for (; mask; mask &= mask - 1)
    n++;
  return n;
}

unsigned fg_explain_mask_of(const fg_explanations *out, bool of_free) {
  unsigned mask = 0;
  for (size_t e = 0; e < out->candidate_count; e++)
    if (fg_effect_is_free(out->candidates[e].kind) == of_free) mask |= 1u << e;
  return mask;
}

/* Two forms of one effect, and two ripples of one period or two steps at one place, are no set. */
static bool are_twins(const fg_candidate *a, const fg_candidate *b) {
  if (!fg_effect_same(a->kind, b->kind)) return false;
  if (b->kind->sought == FG_EFFECT_SMOOTH) return true;
  return b->kind->second || fabs(a->shape[0] / b->shape[0] - 1) < FG_EXPLAIN_TWIN_SHARE;
}

static bool has_twins(const fg_explanations *out, unsigned mask) {
  for (size_t a = 0; a < out->candidate_count; a++)
    for (size_t b = a + 1; (mask >> a & 1) && b < out->candidate_count; b++)
      if ((mask >> b & 1) && are_twins(&out->candidates[a], &out->candidates[b])) return true;
  return false;
}

void fg_explain_keep(fg_explanations *out, const fg_explanation *explanation) {
  out->total++;
  size_t at = out->count < FG_EXPLANATIONS_MAX ? out->count++ : FG_EXPLANATIONS_MAX;
  if (at == FG_EXPLANATIONS_MAX && explanation->excess >= out->each[FG_EXPLANATIONS_MAX - 1].excess)
    return;
  if (at == FG_EXPLANATIONS_MAX) at--;
  for (; at > 0 && out->each[at - 1].excess > explanation->excess; at--)
    out->each[at] = out->each[at - 1];
  out->each[at] = *explanation;
}

/* Schwarz's criterion. */
static double score_of(const fg_explain_search *s, const fg_explanation *m) {
  return m->excess - log((double)s->columns.rows / s->out->integral) * m->freedom;
}

/* Ripples and steps, those in force and all. */
typedef struct shaped_masks {
  unsigned known, all;
} shaped_masks;

static shaped_masks find_shaped_masks(const fg_explain_search *s) {
  shaped_masks masks = {0, 0};
  size_t count = s->out->candidate_count;
  for (size_t e = 0; e < count; e++) {
    if (s->out->candidates[e].kind->sought != FG_EFFECT_PLACED) continue;
    masks.all |= 1u << e;
    if (e + s->new_shapes < count) masks.known |= 1u << e;
  }
  return masks;
}

/* Few smooth effects, which can stand for each other; ripples and steps stand alone, and all that
 * are there may be. */
static bool is_small(unsigned mask, shaped_masks shaped, size_t most) {
  unsigned held = mask & shaped.all, more = held & ~shaped.known;
  bool one_more = (held & shaped.known) == shaped.known && fg_explain_bits(more) <= 1;
  return fg_explain_bits(mask & ~shaped.all) <= most &&
         (fg_explain_bits(mask) <= most || one_more || held == shaped.all);
}

/* Listed sets by size; the first size with one that is right ends the search. Returns the best by
 * Schwarz's criterion of those that were tried. */
static fg_explanation try_listed(fg_explain_search *s, const fg_explain_yardstick *y, size_t most) {
  fg_explanations *out = s->out;
  unsigned listed = fg_explain_mask_of(out, false);
  shaped_masks shaped = find_shaped_masks(s);
  fg_explanation best = {.excess = INFINITY};
  size_t largest = most + fg_explain_bits(shaped.all);
  if (largest > FG_EFFECT_SET_MAX) largest = FG_EFFECT_SET_MAX;
  for (size_t size = 0; size <= largest && !out->count; size++)
    for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = (mask - listed) & listed) {
      if (fg_explain_bits(mask) != size || !is_small(mask, shaped, most) || has_twins(out, mask))
        continue;
      fg_explanation explanation = fg_explain_try(s, y, mask);
      if (fg_explain_is_right(y, &explanation)) fg_explain_keep(out, &explanation);
      if (isfinite(explanation.excess) &&
          (!isfinite(best.excess) || score_of(s, &explanation) < score_of(s, &best)))
        best = explanation;
    }
  return best;
}

/* Members that are worse than the best as far as the data can show leave; the width of the strip
 * puts those that stay in order. Its noise is what the best of them leaves of it. */
static void order_explanations(fg_explain_search *s, const fg_explain_yardstick *y) {
  fg_explanations *out = s->out;
  size_t kept = 0;
  double width = INFINITY;
  for (size_t m = 0; m < out->count; m++)
    if (out->each[m].excess <= out->each[0].excess + WORSE + y->allowance)
      out->each[kept++] = out->each[m];
  out->total -= out->count - kept;
  out->count = kept;
  for (size_t m = 0; m < kept; m++)
    width = fmin(width, out->each[m].width);
  for (size_t m = 0; m < kept; m++)
    out->each[m].width = width > 0 ? (out->each[m].width / width - 1) * (double)s->columns.rows : 0;
  for (size_t m = 1; m < kept; m++)
    for (size_t k = m; k > 0 && out->each[k].excess + out->each[k].width <
                                    out->each[k - 1].excess + out->each[k - 1].width;
         k--) {
      fg_explanation swap = out->each[k];
      out->each[k] = out->each[k - 1];
      out->each[k - 1] = swap;
    }
}

/* The same for a set with a free curve, as far as a listed effect beside it goes. */
static double free_score(const fg_explain_search *s, const fg_explain_yardstick *y,
                         fg_explanation m) {
  if (!isfinite(m.excess)) return INFINITY;
  m.excess = fmax(0, m.excess - CURVE_SHARE * CURVE_SHARE * y->none);
  return score_of(s, &m);
}

static bool scanned_again(const fg_points *points) {
  return points->view_count > points->part_count;
}

/* Smooth effects in a set, at most. */
static size_t effects_most(const fg_points *points) {
  return points->coarse ? 1 : scanned_again(points) ? 3 : 2;
}

/* A free curve, alone or beside up to two listed effects: the one that leaves least for its
 * columns; the best listed set stands when none does better. */
static fg_explanation try_free(fg_explain_search *s, const fg_explain_yardstick *y,
                               fg_explanation best) {
  fg_explanations *out = s->out;
  unsigned listed = fg_explain_mask_of(out, false);
  double score = isfinite(best.excess) ? score_of(s, &best) : INFINITY;
  for (size_t size = 0; size <= (s->columns.points->coarse ? 0 : 2); size++)
    for (unsigned mask = 0, first = 1; first || mask; first = 0, mask = (mask - listed) & listed) {
      if (fg_explain_bits(mask) != size || has_twins(out, mask)) continue;
      for (size_t e = 0; e < out->candidate_count; e++) {
        if (!fg_effect_is_free(out->candidates[e].kind)) continue;
        fg_explanation explanation = fg_explain_try(s, y, mask | 1u << e);
        /* Every further effect must be worth its while. */
        double gained = score - score_of(s, &explanation);
        if (size) gained = fmin(gained, free_score(s, y, best) - free_score(s, y, explanation));
        if (!(gained > 10)) continue;
        score = score_of(s, &explanation);
        best = explanation;
      }
    }
  return best;
}

/* Two curves, alone or beside one listed effect: a carriage that runs unevenly also sways. One view
 * could not tell them. */
static fg_explanation try_two_free(fg_explain_search *s, const fg_explain_yardstick *y,
                                   fg_explanation best) {
  fg_explanations *out = s->out;
  unsigned listed = fg_explain_mask_of(out, false), free = fg_explain_mask_of(out, true);
  if (!s->two_curves || fg_explain_is_right(y, &best)) return best;
  for (unsigned two = 0, first = 1; first || two; first = 0, two = (two - free) & free) {
    if (fg_explain_bits(two) != 2 || has_twins(out, two)) continue;
    for (size_t with = 0; with <= out->candidate_count; with++) {
      unsigned mask = two | (with < out->candidate_count ? 1u << with & listed : 0);
      if (with < out->candidate_count && mask == two) continue;
      fg_explanation explanation = fg_explain_try(s, y, mask);
      double gained = fmin(score_of(s, &best) - score_of(s, &explanation),
                           free_score(s, y, best) - free_score(s, y, explanation));
      if (gained > 10) best = explanation;
    }
  }
  return best;
}

static bool was_tried(const fg_explain_search *s, const fg_explanation *m) {
  size_t count = 0;
  for (size_t e = 0; s->tried && e < s->out->candidate_count; e++) {
    if (!(m->mask >> e & 1)) continue;
    if (count == s->tried->count || s->tried->effects[count].kind != s->out->candidates[e].kind)
      return false;
    count++;
  }
  return s->tried && count > 0 && count == s->tried->count;
}

/* A shape that was found just now has not been fitted with the geometry yet: a set that holds one
 * and takes most of what there is to take gets its chance before any curve that is not far better.
 */
static bool is_worth_fitting(const fg_explain_search *s, const fg_explain_yardstick *y,
                             const fg_explanation *best, const fg_explanation *curve) {
  bool one_curve =
      fg_explain_bits(curve->mask) == 1 && curve->excess < CURVE_SHARE * CURVE_SHARE * y->none;
  if (one_curve && fg_explain_bits(best->mask) > FEW) return false;
  return (best->mask & s->unfitted) && best->excess < FITTING_SHARE * y->none &&
         !was_tried(s, best) && best->excess < FITTING_TIMES * (curve->excess + y->freedom);
}

static void try_sets(fg_explain_search *s) {
  fg_explanations *out = s->out;
  fg_explain_yardstick y = fg_explain_yardstick_of(s);
  fg_explanation best = try_listed(s, &y, effects_most(s->columns.points));
  out->right = out->count > 0;
  if (out->right) order_explanations(s, &y);
  if (!out->count) {
    fg_explanation curve = try_free(s, &y, best);
    bool hope = is_worth_fitting(s, &y, &best, &curve);
    if (!hope) curve = try_two_free(s, &y, curve);
    out->right = !hope && fg_explain_is_right(&y, &curve);
    fg_explain_keep(out, hope ? &best : &curve);
  }
  fg_explain_describe_effects(s, &y);
  fg_explain_describe_width(s, &y);
}

static void add_known(fg_explain_search *s, const fg_effect_set *known) {
  for (size_t e = 0; known && e < known->count; e++) {
    const fg_effect_found *from = &known->effects[e];
    fg_candidate effect = {.kind = from->kind};
    memcpy(effect.shape, from->shape, sizeof effect.shape);
    if (from->kind->sought == FG_EFFECT_PLACED && s->out->candidate_count < FG_CANDIDATES_MAX)
      fg_explain_add(s, &effect);
  }
}

fg_status fg_explain_find(fg_context *ctx, const fg_points *points,
                          const fg_explain_request *request, fg_explanations *explanations) {
  memset(explanations, 0, sizeof *explanations);
  fg_explain_search s = {
      .out = explanations, .tried = request->tried, .two_curves = request->two_curves};
  fg_status status = FG_OK;
  FG_TRY(fg_explain_columns_open(ctx, points, request->residual_um, request->jacobian, &s.columns));
  FG_TRY_EXIT(add_smooth(ctx, &s, request->known));
  add_known(&s, request->known);
  FG_TRY_EXIT(fg_explain_add_other_steps(ctx, &s, request->known));
  FG_TRY_EXIT(fg_explain_width_doubt(ctx, &s.columns));
  if (request->look) FG_TRY_EXIT(fg_explain_find_shaped(ctx, &s));
  refine_noise(&s);
  FG_TRY_EXIT(fg_explain_check_rows(ctx, &s));
  try_sets(&s);
exit:
  fg_explain_columns_close(&s.columns);
  return status;
}
