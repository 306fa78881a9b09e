/* Ripples and steps stand alone even in one scan: they are sought beside all smooth effects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "effect/columns.h"
#include "explain/search.h"

enum { REFINE_STEPS = 24, REFINE_LEVELS = 4, SIDE_ROWS = 12 };
enum { COARSER = 40 };

/* A step elsewhere that leaves no more than this is as good; one so near is the same. */
#define OTHER_STEP_CHI2 10.0
#define OTHER_STEP_MM   0.3

/* A step needs rows on both sides that speak of it: one bad row at the foil's end is none. */
static bool has_both_sides(const fg_explain_columns *c, const fg_effect *kind, double at_mm) {
  size_t low = 0, all = 0;
  for (size_t i = 0; i < c->rows; i++) {
    const fg_points_row *row = &c->points->rows[c->row[i]];
    low += row->weight > 0 && (kind->axis ? row->at.y : row->at.x) < at_mm;
    all += row->weight > 0;
  }
  return low >= SIDE_ROWS && all - low >= SIDE_ROWS;
}

/* Gain beside everything else, in chi². */
static fg_explain_hit gain_at(const fg_explain_search *s, size_t rank, const fg_effect *kind,
                              double place, double *work) {
  const fg_explain_columns *c = &s->columns;
  if (kind->jumps && !has_both_sides(c, kind, place)) return (fg_explain_hit){0, 0, place};
  double shape[FG_FIELD_SHAPES] = {place}, x[FG_SMALL_MAX], square = 0;
  size_t count = fg_explain_gather(c, kind, shape, work);
  fg_normal_equations system;
  fg_explain_hit none = {0, 0, place}, found = none;
  fg_normal_clear(&system, count);
  for (size_t a = 0; a < count; a++) {
    /* What is left stands beside the basis already, and the basis takes its share of the products.
     */
    system.right[a] = fg_explain_dot(c->rows, work + a * c->rows, c->left);
    for (size_t b = 0; b <= a; b++)
      system.matrix[a][b] = fg_explain_dot(c->rows, work + a * c->rows, work + b * c->rows);
  }
  for (size_t k = 0; k < rank; k++) {
    double along[FG_SMALL_MAX];
    for (size_t a = 0; a < count; a++) {
      along[a] = fg_explain_along(c, k, work + a * c->rows);
      for (size_t b = 0; b <= a; b++)
        system.matrix[a][b] -= along[a] * along[b];
    }
  }
  for (size_t a = 0; a < count; a++)
    if (!(system.matrix[a][a] > 1e-3 * (double)c->rows / 64)) return none;
  if (!fg_normal_solve(&system, 1e-9, x, NULL)) return none;
  for (size_t a = 0; a < count; a++) {
    found.gain += x[a] * system.right[a];
    square += x[a] * x[a];
  }
  found.gain /= s->out->noise_um * s->out->noise_um * s->out->integral;
  found.amplitude = sqrt(square);
  return found;
}

/* The best place over a grid of starts, then finer around it. */
fg_explain_hit fg_explain_find_place(const fg_explain_search *s, size_t rank, const fg_effect *kind,
                                     double *work) {
  const fg_field_frame *frame = &s->columns.points->frame;
  fg_explain_hit best = {0};
  bool coarse = s->columns.points->coarse;
  size_t which = 0, starts = kind->starts / (coarse ? COARSER : 1);
  for (size_t i = 0; i < starts; i++) {
    fg_explain_hit tried = gain_at(s, rank, kind, kind->start(frame, i, starts), work);
    if (tried.gain <= best.gain) continue;
    best = tried;
    which = i;
  }
  double low = kind->start(frame, which > 0 ? which - 1 : 0, starts);
  double high = kind->start(frame, which + 1 < starts ? which + 1 : which, starts);
  for (int level = 0; level < (coarse ? 1 : REFINE_LEVELS) && best.gain > 0; level++) {
    double step = (high - low) / REFINE_STEPS;
    for (size_t i = 0; i <= REFINE_STEPS; i++) {
      fg_explain_hit tried = gain_at(s, rank, kind, low + step * (double)i, work);
      if (tried.gain > best.gain) best = tried;
    }
    low = best.at - step;
    high = best.at + step;
  }
  return best;
}

/* Adds what stands out most, once. */
static bool add_best(fg_explain_search *s, bool listed_only, double *work) {
  size_t rank = fg_explain_noise(s, false);
  double noise_um = s->out->noise_um, integral = s->out->integral;
  if (listed_only) rank = fg_explain_noise(s, true);
  /* What the listed effects leave may be the very thing that is sought: it is no noise. */
  s->out->noise_um = noise_um;
  s->out->integral = integral;
  fg_explain_hit best = {0};
  const fg_effect *which = NULL;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_PLACED || !fg_effect_shows(s->columns.points, kind)) continue;
    fg_explain_hit found = fg_explain_find_place(s, rank, kind, work);
    if (found.gain <= FG_EXPLAIN_SHAPED_CHI2 || found.amplitude <= FG_EXPLAIN_SHAPED_LEAST_UM)
      continue;
    if (which && found.gain <= best.gain) continue;
    best = found;
    which = kind;
  }
  if (!which || s->out->candidate_count >= FG_CANDIDATES_MAX) return false;
  s->unfitted |= 1u << s->out->candidate_count;
  fg_explain_add(s, &(fg_candidate){.kind = which, .shape = {best.at}});
  s->new_shapes++;
  return true;
}

/* The shape with which it takes most beside the geometry alone. */
static fg_status find_alone(fg_context *ctx, fg_explain_search *s, const fg_effect *kind,
                            double *shape) {
  const fg_field_frame *frame = &s->columns.points->frame;
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, 2 * sizeof *work, (void **)&work));
  memcpy(s->columns.left, s->columns.residual, s->columns.rows * sizeof *s->columns.left);
  s->out->noise_um = s->out->integral = 1; /* nothing is judged yet: the largest gain is wanted */
  fg_explain_hit hit = fg_explain_find_place(s, s->columns.geometry_rank, kind, work);
  *shape = hit.gain > 0 ? hit.at : kind->start(frame, kind->starts / 2, kind->starts);
  free(work);
  return FG_OK;
}

fg_status fg_explain_add_shaped(fg_context *ctx, fg_explain_search *s, const fg_effect *kind,
                                const fg_effect_set *known) {
  double alone, fitted = NAN;
  FG_TRY(find_alone(ctx, s, kind, &alone));
  for (size_t e = 0; known && e < known->count; e++)
    if (known->effects[e].kind == kind) fitted = known->effects[e].shape[0];
  if (isfinite(fitted)) fg_explain_add(s, &(fg_candidate){.kind = kind, .shape = {fitted}});
  if (isfinite(fitted) && fabs(alone / fitted - 1) < FG_EXPLAIN_TWIN_SHARE) return FG_OK;
  s->unfitted |= 1u << s->out->candidate_count;
  fg_explain_add(s, &(fg_candidate){.kind = kind, .shape = {alone}});
  return FG_OK;
}

/* What a step at this place leaves beside the basis, its mean square being 1 per um. */
static double rest_of_step(const fg_explain_columns *c, size_t rank, const fg_effect *kind,
                           double at_mm, double *work) {
  double shape[FG_FIELD_SHAPES] = {at_mm};
  if (!has_both_sides(c, kind, at_mm)) return INFINITY;
  fg_explain_gather(c, kind, shape, work);
  double rest = fg_explain_dot(c->rows, work, work);
  for (size_t k = 0; k < rank; k++) {
    double along = fg_explain_along(c, k, work);
    rest -= along * along;
  }
  return rest;
}

static void add_step_at(fg_explain_search *s, const fg_effect *kind, double at_mm) {
  fg_candidate other = {.kind = kind, .shape = {at_mm}};
  if (isfinite(at_mm) && s->out->candidate_count < FG_CANDIDATES_MAX) fg_explain_add(s, &other);
}

fg_status fg_explain_add_other_steps(fg_context *ctx, fg_explain_search *s,
                                     const fg_effect_set *known) {
  double *work = NULL;
  size_t steps = 0;
  for (size_t e = 0; known && e < known->count; e++)
    steps += known->effects[e].kind->jumps;
  if (!steps) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, sizeof *work, (void **)&work));
  fg_explain_noise(s, false);
  double unit = s->out->noise_um * s->out->noise_um * s->out->integral;
  size_t rank = fg_explain_columns_span(&s->columns, 0, s->free_end); /* geometry, what is known */
  for (size_t e = 0; e < known->count; e++) {
    const fg_effect_found *step = &known->effects[e];
    if (!step->kind->jumps) continue;
    size_t places = 2 * step->kind->starts;
    double above = NAN, below = NAN, square = step->coefficient_um[0] * step->coefficient_um[0];
    for (size_t i = 0; i < places; i++) {
      double y = step->kind->start(&s->columns.points->frame, i, places);
      if (fabs(y - step->shape[0]) < OTHER_STEP_MM) continue;
      if (square * rest_of_step(&s->columns, rank, step->kind, y, work) > OTHER_STEP_CHI2 * unit)
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

/* Free curves can follow a long ripple: it is sought beside the listed effects too. What is found
 * there is a candidate like any other; a curve that is no ripple stays the better explanation. */
fg_status fg_explain_find_shaped(fg_context *ctx, fg_explain_search *s) {
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, 2 * sizeof *work, (void **)&work));
  for (int pass = 0; pass < 2; pass++)
    for (int round = 0; round < 2; round++)
      if (!add_best(s, pass == 0, work)) break;
  free(work);
  return FG_OK;
}
