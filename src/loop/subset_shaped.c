/* Ripples and steps stand alone even in one scan: they are sought beside all smooth effects. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "loop/subset_search.h"

enum { RIPPLE_STEPS = 400, STEP_STEPS = 200, REFINE_STEPS = 24, REFINE_LEVELS = 4, SIDE_ROWS = 12 };

/* A step elsewhere that leaves no more than this is as good; one so near is the same. */
#define OTHER_STEP_CHI2 10.0
#define OTHER_STEP_MM   0.3

/* Evenly in frequency. */
static double ripple_period(const fg_points *points, size_t i, size_t count) {
  double span = points->frame.high_mm[1] - points->frame.low_mm[1];
  double low = 1.5 / span, high = 2.5;
  return 1 / (low + (high - low) * (double)i / (double)count);
}

static double step_place(const fg_points *points, size_t i, size_t count) {
  double low = points->frame.low_mm[1], high = points->frame.high_mm[1];
  return low + (high - low) * ((double)i + 1) / ((double)count + 1);
}

const fg_subset_shaped fg_subset_shaped_kinds[FG_SUBSET_SHAPED] = {
    {{.id = "scan.carriage_ripple", .columns = 2, .shapes = 1}, ripple_period, RIPPLE_STEPS},
    {{.id = "scan.row_step", .columns = 1, .shapes = 1}, step_place, STEP_STEPS},
};

/* A step needs rows on both sides that speak of it: one bad row at the foil's end is none. */
static bool has_both_sides(const fg_subset_columns *c, double y_mm) {
  size_t low = 0, all = 0;
  for (size_t i = 0; i < c->rows; i++) {
    const fg_points_row *row = &c->points->rows[c->row[i]];
    low += row->weight > 0 && row->at.y < y_mm;
    all += row->weight > 0;
  }
  return low >= SIDE_ROWS && all - low >= SIDE_ROWS;
}

/* Gain beside everything else, in chi². */
static fg_subset_hit gain_at(const fg_subset_search *s, size_t rank, const char *id, double place,
                             double *work) {
  const fg_subset_columns *c = &s->columns;
  if (!strcmp(id, "scan.row_step") && !has_both_sides(c, place))
    return (fg_subset_hit){0, 0, place};
  double shape[FG_LOOP_SHAPES] = {place}, x[FG_SMALL_MAX], square = 0;
  size_t count = fg_subset_gather(c, id, shape, work);
  fg_normal_equations system;
  fg_subset_hit none = {0, 0, place}, found = none;
  fg_normal_clear(&system, count);
  for (size_t a = 0; a < count; a++) {
    /* What is left stands beside the basis already, and the basis takes its share of the products.
     */
    system.right[a] = fg_subset_dot(c->rows, work + a * c->rows, c->left);
    for (size_t b = 0; b <= a; b++)
      system.matrix[a][b] = fg_subset_dot(c->rows, work + a * c->rows, work + b * c->rows);
  }
  for (size_t k = 0; k < rank; k++) {
    double along[FG_SMALL_MAX];
    for (size_t a = 0; a < count; a++) {
      along[a] = fg_subset_along(c, k, work + a * c->rows);
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
fg_subset_hit fg_subset_find_place(const fg_subset_search *s, size_t rank,
                                   const fg_subset_shaped *kind, double *work) {
  const fg_points *points = s->columns.points;
  fg_subset_hit best = {0};
  size_t which = 0;
  for (size_t i = 0; i < kind->starts; i++) {
    fg_subset_hit tried =
        gain_at(s, rank, kind->effect.id, kind->start(points, i, kind->starts), work);
    if (tried.gain <= best.gain) continue;
    best = tried;
    which = i;
  }
  double low = kind->start(points, which > 0 ? which - 1 : 0, kind->starts);
  double high = kind->start(points, which + 1 < kind->starts ? which + 1 : which, kind->starts);
  for (int level = 0; level < REFINE_LEVELS && best.gain > 0; level++) {
    double step = (high - low) / REFINE_STEPS;
    for (size_t i = 0; i <= REFINE_STEPS; i++) {
      fg_subset_hit tried = gain_at(s, rank, kind->effect.id, low + step * (double)i, work);
      if (tried.gain > best.gain) best = tried;
    }
    low = best.at - step;
    high = best.at + step;
  }
  return best;
}

/* Adds what stands out most, once. */
static bool add_best(fg_subset_search *s, bool listed_only, double *work) {
  size_t rank = fg_subset_noise(s, false);
  double noise_um = s->out->noise_um, integral = s->out->integral;
  if (listed_only) rank = fg_subset_noise(s, true);
  /* What the listed effects leave may be the very thing that is sought: it is no noise. */
  s->out->noise_um = noise_um;
  s->out->integral = integral;
  fg_subset_hit best = {0};
  const fg_subset_shaped *which = NULL;
  for (size_t k = 0; k < FG_SUBSET_SHAPED; k++) {
    fg_subset_hit found = fg_subset_find_place(s, rank, &fg_subset_shaped_kinds[k], work);
    if (found.gain <= FG_SUBSET_SHAPED_CHI2 || found.amplitude <= FG_SUBSET_SHAPED_LEAST_UM)
      continue;
    if (which && found.gain <= best.gain) continue;
    best = found;
    which = &fg_subset_shaped_kinds[k];
  }
  if (!which || s->out->effect_count >= FG_SUBSET_EFFECTS) return false;
  fg_subset_effect found = which->effect;
  found.shape[0] = best.at;
  fg_subset_add(s, &found);
  s->new_shapes++;
  return true;
}

/* What a step at this place leaves beside the basis, its mean square being 1 per um. */
static double rest_of_step(const fg_subset_columns *c, size_t rank, double y_mm, double *work) {
  double shape[FG_LOOP_SHAPES] = {y_mm};
  if (!has_both_sides(c, y_mm)) return INFINITY;
  fg_subset_gather(c, "scan.row_step", shape, work);
  double rest = fg_subset_dot(c->rows, work, work);
  for (size_t k = 0; k < rank; k++) {
    double along = fg_subset_along(c, k, work);
    rest -= along * along;
  }
  return rest;
}

static void add_step_at(fg_subset_search *s, double y_mm) {
  fg_subset_effect other = {.id = "scan.row_step", .columns = 1, .shapes = 1, .shape = {y_mm}};
  if (isfinite(y_mm) && s->out->effect_count < FG_SUBSET_EFFECTS) fg_subset_add(s, &other);
}

fg_status fg_subset_add_other_steps(fg_context *ctx, fg_subset_search *s,
                                    const fg_scan_set *known) {
  double *work = NULL;
  size_t steps = 0;
  for (size_t e = 0; known && e < known->count; e++)
    steps += !strcmp(known->effects[e].id, "scan.row_step");
  if (!steps) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, sizeof *work, (void **)&work));
  fg_subset_noise(s, false);
  double unit = s->out->noise_um * s->out->noise_um * s->out->integral;
  size_t rank = fg_subset_columns_span(&s->columns, 0, s->free_end); /* geometry, what is known */
  for (size_t e = 0; e < known->count; e++) {
    const fg_scan_effect *step = &known->effects[e];
    if (strcmp(step->id, "scan.row_step") != 0) continue;
    double above = NAN, below = NAN, square = step->coefficient_um[0] * step->coefficient_um[0];
    for (size_t i = 0; i < 2 * STEP_STEPS; i++) {
      double y = step_place(s->columns.points, i, 2 * STEP_STEPS);
      if (fabs(y - step->shape[0]) < OTHER_STEP_MM) continue;
      if (square * rest_of_step(&s->columns, rank, y, work) > OTHER_STEP_CHI2 * unit) continue;
      if (y > step->shape[0]) above = y;
      if (y < step->shape[0] && !(below < y)) below = y;
    }
    add_step_at(s, above);
    add_step_at(s, below);
  }
  free(work);
  return FG_OK;
}

/* Free curves can follow a long ripple: it is sought beside the listed effects too. What is found
 * there is a candidate like any other; a curve that is no ripple stays the better explanation. */
fg_status fg_subset_find_shaped(fg_context *ctx, fg_subset_search *s) {
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, 2 * sizeof *work, (void **)&work));
  for (int pass = 0; pass < 2; pass++)
    for (int round = 0; round < 2; round++)
      if (!add_best(s, pass == 0, work)) break;
  free(work);
  return FG_OK;
}
