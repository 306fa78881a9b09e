/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include <gsl/gsl_multimin.h>

#include "core/numerics.h"
#include "geometry/circle_arc.h"

/* Nelder-Mead over the curvature and the direction to the centre, as seen from a point of the
 * starting arc; the radius is the mean distance from that centre, so the simplex is a triangle. */
typedef struct search {
  const fg_circle_scaled *scaled;
  fg_circle_arc start;
} search;

static double search_objective(const gsl_vector *at, void *parameters) {
  const search *s = parameters;
  double mean;
  fg_circle_arc arc =
      fg_circle_arc_step(&s->start, gsl_vector_get(at, 0), gsl_vector_get(at, 1), 0);
  double ms = fg_circle_arc_profile_ms(s->scaled, &arc, &mean);
  return isfinite(ms) ? ms : GSL_POSINF;
}

/* The arc at the minimum: its circle about the same centre, grown by the mean distance. */
static fg_circle_arc search_result(const search *s, const gsl_vector *at) {
  double mean;
  fg_circle_arc arc =
      fg_circle_arc_step(&s->start, gsl_vector_get(at, 0), gsl_vector_get(at, 1), 0);
  fg_circle_arc_profile_ms(s->scaled, &arc, &mean);
  arc.qx -= mean * arc.nx;
  arc.qy -= mean * arc.ny;
  arc.curvature /= 1 + arc.curvature * mean;
  return arc;
}

enum { SEARCH_ITERATIONS_MAX = 400 };
static const double search_size_end = 1e-6; /* of the simplex; the polish gives the last digits */

static fg_status nelder_mead(fg_context *ctx, search *s, size_t *iterations) {
  double at[2] = {0, 0}, steps[2] = {0.02 + 0.02 * s->start.curvature, 0.02};
  gsl_vector_view start = gsl_vector_view_array(at, 2), step = gsl_vector_view_array(steps, 2);
  gsl_multimin_function function = {search_objective, 2, s};
  gsl_multimin_fminimizer *minimiser =
      gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2);
  if (!minimiser) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: Nelder-Mead");
  int code = gsl_multimin_fminimizer_set(minimiser, &function, &start.vector, &step.vector);
  while (code == GSL_SUCCESS && *iterations < SEARCH_ITERATIONS_MAX) {
    code = gsl_multimin_fminimizer_iterate(minimiser);
    ++*iterations;
    if (gsl_multimin_fminimizer_size(minimiser) < search_size_end) break;
  }
  s->start = search_result(s, gsl_multimin_fminimizer_x(minimiser));
  gsl_multimin_fminimizer_free(minimiser);
  return FG_OK;
}

/* Descends to the minimum from one start. *reached is true for a minimum: finite, converged, and no
 * worse than the best line, which every proper minimum beats. */
static fg_status descend_simplex(fg_context *ctx, const fg_circle_scaled *scaled,
                                 fg_circle_arc *arc, size_t *iterations, bool *reached) {
  search s = {scaled, fg_circle_arc_rebase(arc)};
  FG_TRY(nelder_mead(ctx, &s, iterations));
  *arc = s.start;
  *reached = fg_circle_arc_polish(scaled, arc) && arc->curvature > FG_CIRCLE_FLAT &&
             fg_circle_arc_ms(scaled, arc) <= scaled->line_ms * (1 + 1e-9);
  return FG_OK;
}

enum { STARTS_MAX = 4 };

static bool is_usable_circle(const fg_circle *circle) {
  return isfinite(circle->x) && isfinite(circle->y) && isfinite(circle->radius) &&
         circle->radius > 0;
}

/* Lists starts in the order of their trial: the better of the given and the algebraic circle, then
 * the other, then the best line bent a little to either side (near the minimum when the points are
 * nearly straight but scatter more than their sagitta). A start that is far off costs one
 * evaluation. */
static size_t list_starts(const fg_circle_scaled *scaled, const fg_circle *given,
                          fg_circle_arc starts[STARTS_MAX]) {
  size_t count = 0;
  fg_circle circle;
  if (given && is_usable_circle(given)) {
    circle = fg_circle_into_scaled(scaled, given);
    if (is_usable_circle(&circle)) starts[count++] = fg_circle_arc_from(&circle);
  }
  if (fg_circle_estimate_scaled(NULL, scaled, &circle) == FG_OK)
    starts[count++] = fg_circle_arc_from(&circle);
  if (count == 2 &&
      !(fg_circle_arc_ms(scaled, &starts[0]) <= fg_circle_arc_ms(scaled, &starts[1]))) {
    fg_circle_arc bad = starts[0];
    starts[0] = starts[1];
    starts[1] = bad;
  }
  starts[count++] = (fg_circle_arc){.ny = 1, .curvature = 1e-3};
  starts[count++] = (fg_circle_arc){.ny = -1, .curvature = 1e-3};
  return count;
}

/* Points that clearly lie on an arc have one minimum. Where a circle explains little more than a
 * line there may be several, and every start is tried. */
static const double clear_share = 0.1;

static fg_status best_arc(fg_context *ctx, const fg_circle_scaled *scaled, const fg_circle *given,
                          fg_circle_arc *best, size_t *iterations) {
  fg_circle_arc starts[STARTS_MAX];
  size_t count = list_starts(scaled, given, starts);
  double best_ms = INFINITY;
  for (size_t i = 0; i < count && best_ms > clear_share * scaled->line_ms; i++) {
    bool reached = false;
    FG_TRY(descend_simplex(ctx, scaled, &starts[i], iterations, &reached));
    double ms = fg_circle_arc_ms(scaled, &starts[i]);
    if (!reached || !(ms < best_ms)) continue;
    best_ms = ms;
    *best = starts[i];
  }
  if (best_ms < INFINITY) return FG_OK;
  return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: a line fits %zu points better than any circle",
                 scaled->count);
}

static fg_status fit_scaled(fg_context *ctx, const fg_circle_scaled *scaled, const fg_circle *given,
                            fg_circle_fit *fit) {
  fg_circle_arc arc;
  fg_circle_fit found = {0};
  FG_TRY(best_arc(ctx, scaled, given, &arc, &found.iterations));
  if (!fg_circle_arc_covariance(scaled, &arc, found.covariance))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: the points do not determine a circle");
  fg_circle local = fg_circle_arc_circle(&arc);
  found.circle = fg_circle_out_of_scaled(scaled, &local);
  found.rms = scaled->scale * sqrt(fg_circle_arc_ms(scaled, &arc));
  *fit = found;
  return FG_OK;
}

fg_status fg_circle_fit_geometric(fg_context *ctx, const fg_point *points, const double *weights,
                                  size_t count, const fg_circle *start, fg_circle_fit *fit) {
  fg_circle_scaled scaled;
  fg_numerics_start();
  FG_TRY(fg_circle_scale_points(ctx, points, weights, count, &scaled));
  fg_status status = fit_scaled(ctx, &scaled, start, fit);
  fg_circle_scaled_free(&scaled);
  return status;
}
