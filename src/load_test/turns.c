/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turning point of a loading branch: its force, and the place of the branch at that force.
 *
 * The extreme of a noisy displacement lies beyond the turn, and under force control its sample may
 * be any of several about it. An error d of the place causes an error (s - K) d of the force
 * between the ends, s the slope there, K the secant: several percent, as s is a multiple of K. At
 * the ends the force determines the place better than the displacement does, because s times the
 * displacement's noise exceeds the force's noise. So the turn is sought in the force over time, and
 * the place is from a regression of displacement over force. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "load_test/analysis.h"

/* Samples before a turn that a parabola is fitted to. */
enum { BEFORE = 12, PARAMETERS = 3 };

/* Range of the search for the turn: displacement within this many times its noise of its extreme.
 */
static const double candidate_reach = 4;
enum { CANDIDATES_MAX = 60 };

/* The largest of several fits to nearly the same samples exceeds its own mean by up to this share
 * of their standard uncertainty. */
static const double selection_share = 1;

/* Turns below the outermost one by more than this many standard uncertainties lost their tip in a
 * dropout, or are not the loop's. The smallest uncertainty of all is used: noise is the same at
 * every turn, and a dropout just before a turn makes that turn's own uncertainty large. */
static const double turn_reach = 4;

/* A stretch beside a turn is a dropout where it is as many times as wide as the others there. */
static const double leap_factor = 7;

/* Range of forces at the turn, and minimum number of samples, for the regression of the place. */
static const double window_share = 0.2;
enum { PLACE_SAMPLES_MIN = 24 };

typedef struct turn {
  double force, u, rise; /* of one sample */
  double lost;           /* jump of the force in a dropout beside the turn; 0: none */
  size_t at;
} turn;

/* y = c0 + c1 z + c2 z²; variances of c0 and c1 by the residuals. */
typedef struct parabola {
  double c0, c1, u_c0;
} parabola;

static bool solve_parabola(const fg_normal_equations *system, size_t count, parabola *p) {
  double c[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  if (count <= PARAMETERS || !fg_normal_solve(system, 0, c, inverse)) return false;
  double squares = system->sum_squares;
  for (size_t k = 0; k < PARAMETERS; k++)
    squares -= c[k] * system->right[k];
  double variance = fmax(0, squares) / (double)(count - PARAMETERS);
  *p = (parabola){c[0], c[1], sqrt(variance * inverse[0][0])};
  return true;
}

static void add_parabola_point(fg_normal_equations *system, double z, double y) {
  fg_normal_add(system, (const double[PARAMETERS]){1, z, z * z}, y, 1);
}

/* Force at sample `at` by the samples before it. */
static bool fit_force(const fg_load_sample *samples, size_t at, int sign, turn *t) {
  fg_normal_equations system;
  parabola p;
  double here = samples[at].force_n;
  fg_normal_clear(&system, PARAMETERS);
  for (size_t i = 0; i < BEFORE; i++)
    add_parabola_point(&system, -(double)i / BEFORE, sign * (samples[at - i].force_n - here));
  if (!solve_parabola(&system, BEFORE, &p)) return false;
  double rise = fmax(0, p.c1) / BEFORE;
  *t = (turn){sign * here + p.c0 + rise / 2, p.u_c0, rise, 0, at};
  return true;
}

/* Returns the force skipped by a dropout beside sample `at`: an interval whose travel is many times
 * that of the intervals before it and of the displacement's noise. */
static double leap_at(const fg_load_sample *samples, const fg_load_stroke *s, size_t at,
                      double noise_mm) {
  double way = 0, leap = 0;
  for (size_t i = at - BEFORE + 1; i < at; i++)
    way += fabs(samples[i].x_mm - samples[i - 1].x_mm) / (BEFORE - 1);
  double limit = leap_factor * fmax(way, noise_mm);
  for (size_t i = at; i <= at + 1 && i < s->end; i++)
    if (fabs(samples[i].x_mm - samples[i - 1].x_mm) > limit)
      leap = fmax(leap, fabs(samples[i].force_n - samples[i - 1].force_n));
  return leap;
}

/* Finds the largest force about the end of a stroke; never beyond the extreme reading, which a
 * parabola exceeds at the end of a rest under a weight. Forces count outward. */
static bool find_turn(const fg_load_sample *samples, const fg_load_stroke *s, double noise_mm,
                      turn *best) {
  double reach = candidate_reach * noise_mm, x = samples[s->last].x_mm, extreme = -INFINITY;
  size_t from = s->last, to = s->last;
  bool found = false;
  if (s->last < s->first + BEFORE) return false;
  while (from > s->first + BEFORE && s->last - from < CANDIDATES_MAX &&
         fabs(samples[from - 1].x_mm - x) < reach)
    from--;
  while (to + 1 < s->end && to - s->last < CANDIDATES_MAX && fabs(samples[to + 1].x_mm - x) < reach)
    to++;
  for (size_t at = from; at <= to; at++) {
    turn next;
    extreme = fmax(extreme, s->sense * samples[at].force_n);
    if (!fit_force(samples, at, s->sense, &next)) continue;
    if (!found || next.force > best->force) *best = next;
    found = true;
  }
  if (!found) return false;
  best->force = fmin(best->force, extreme);
  best->lost = leap_at(samples, s, best->at, noise_mm);
  return true;
}

typedef struct branch {
  const fg_load_stroke **stroke;
  turn *turns;
  size_t count;
} branch;

/* Turns beside a dropout go where there is any other. */
static void drop_lost(branch *b) {
  size_t kept = 0, whole = 0;
  for (size_t i = 0; i < b->count; i++)
    whole += !(b->turns[i].lost > 0);
  for (size_t i = 0; i < b->count; i++) {
    if (whole && b->turns[i].lost > 0) continue;
    b->turns[kept] = b->turns[i];
    b->stroke[kept++] = b->stroke[i];
  }
  b->count = kept;
}

/* Strokes that load this side and turn as far out as any. */
static void choose_turning_strokes(const fg_load_sample *samples,
                                   const fg_load_loop_strokes *strokes, int sense, branch *b) {
  size_t outermost = 0, kept = 0;
  for (size_t i = 0; i < strokes->count; i++)
    if (strokes->stroke[i]->sense == sense &&
        find_turn(samples, strokes->stroke[i], strokes->noise_mm, &b->turns[b->count])) {
      b->stroke[b->count] = strokes->stroke[i];
      if (b->turns[b->count].force > b->turns[outermost].force) outermost = b->count;
      b->count++;
    }
  if (!b->count) return;
  double limit = b->turns[outermost].force, u = INFINITY;
  for (size_t i = 0; i < b->count; i++)
    u = fmin(u, M_SQRT2 * b->turns[i].u + b->turns[i].rise);
  for (size_t i = 0; i < b->count; i++) {
    if (b->turns[i].force < limit - turn_reach * u) continue;
    b->turns[kept] = b->turns[i];
    b->stroke[kept++] = b->stroke[i];
  }
  b->count = kept;
  drop_lost(b);
}

/* Averages the turns' forces. A turn lies anywhere between two samples: `rise` of a rectangular
 * distribution, the same at every turn. When all turns were lost in dropouts, it may lie as far
 * beyond the samples as the force jumps there. */
static void mean_force(const branch *b, int sense, fg_load_turn *t) {
  double n = (double)b->count, sum = 0, squares = 0, own = 0, rise = 0, lost = 0;
  for (size_t i = 0; i < b->count; i++) {
    sum += b->turns[i].force / n;
    own += b->turns[i].u * b->turns[i].u / n;
    rise += b->turns[i].rise / n;
    lost += b->turns[i].lost / n;
  }
  for (size_t i = 0; i < b->count; i++)
    squares += pow(b->turns[i].force - sum, 2);
  double scatter = n > 1 ? squares / (n - 1) : 0;
  t->force_n = sense * sum;
  t->u_force_n = sqrt(fmax(own, scatter) / n + pow(selection_share, 2) * own + rise * rise / 12 +
                      lost * lost / 3);
}

static double force_span(const fg_load_sample *samples, const branch *b, double force) {
  double span = 0;
  for (size_t i = 0; i < b->count; i++)
    span = fmax(span, fabs(force - samples[b->stroke[i]->first].force_n));
  return span;
}

/* Adds the samples before a turn within the window of force, the turn's own first. */
static size_t add_samples(const fg_load_sample *samples, const fg_load_stroke *s, size_t at,
                          double window, const fg_load_turn *t, fg_normal_equations *system) {
  size_t count = 0;
  for (size_t i = at + 1; i-- > s->first;) {
    double z = s->sense * (samples[i].force_n - t->force_n) / window;
    double share = ((double)(i - s->first) + 0.5) / (double)(s->last - s->first + 1);
    if (z < -1) continue;
    add_parabola_point(system, z, samples[i].x_mm - fg_load_stroke_drifted(s, share) - t->place_mm);
    count++;
  }
  return count;
}

/* Place at the turn's force by the displacement's regression over the force. */
static bool find_place(const fg_load_sample *samples, const branch *b, fg_load_turn *t) {
  double max = force_span(samples, b, t->force_n);
  fg_normal_equations system;
  t->place_mm = samples[b->turns[0].at].x_mm; /* datum of the regression */
  for (double window = fmin(max, window_share * fabs(t->force_n)); window > 0;
       window = fmin(max, 1.25 * window)) {
    size_t count = 0;
    parabola p;
    fg_normal_clear(&system, PARAMETERS);
    for (size_t i = 0; i < b->count; i++)
      count += add_samples(samples, b->stroke[i], b->turns[i].at, window, t, &system);
    if (count < PLACE_SAMPLES_MIN && window < max) continue;
    if (!solve_parabola(&system, count, &p)) return false;
    t->place_mm += p.c0;
    t->u_place_mm = p.u_c0;
    t->compliance_mm_n = fabs(p.c1) / window;
    return true;
  }
  return false;
}

fg_status fg_load_find_turn(fg_context *ctx, const fg_load_sample *samples,
                            const fg_load_loop_strokes *strokes, int sense, fg_load_turn *t) {
  branch b = {0};
  fg_status status = FG_OK;
  *t = (fg_load_turn){0};
  FG_TRY_EXIT(fg_memory_allocate(ctx, strokes->count + 1, sizeof *b.stroke, (void **)&b.stroke));
  FG_TRY_EXIT(fg_memory_allocate(ctx, strokes->count + 1, sizeof *b.turns, (void **)&b.turns));
  choose_turning_strokes(samples, strokes, sense, &b);
  if (b.count) {
    mean_force(&b, sense, t);
    t->found = find_place(samples, &b, t);
  }
exit:
  free(b.stroke);
  free(b.turns);
  return status;
}
