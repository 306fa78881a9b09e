/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Both eigenvalues of the film's impedance over the ratio of whirl.
 *
 * Steps are halved until each eigenvalue has one continuation and neither moves so far that it
 * could pass the real axis and come back unseen: a film whose pressures resonate turns an
 * eigenvalue around within a tenth of the speed. */
#include <math.h>

#include "film/film.h"

enum { HALVINGS = 5 };

/* One continuation is this much nearer than the other. */
static const double nearer = 0.5;
/* A step's length over the way to the axis and back. */
static const double share_of_way = 0.5;

static double distance(const double complex *from, const double complex *to) {
  return cabs(to[0] - from[0]) + cabs(to[1] - from[1]);
}

static bool is_followed(const fg_film_trace_point *from, const fg_film_trace_point *to) {
  const double complex turned[] = {to->value[1], to->value[0]};
  if (distance(from->value, to->value) > nearer * distance(from->value, turned)) return false;
  for (int k = 0; k < FG_FILM_ROOTS; k++) {
    double before = cimag(from->value[k]), now = cimag(to->value[k]);
    bool passes = (before < 0) != (now < 0);
    double way = fabs(before) + fabs(now);
    if (!passes && cabs(to->value[k] - from->value[k]) > share_of_way * way) return false;
  }
  return true;
}

/* Adds the trace's points up to a ratio. */
static fg_status trace_to(fg_context *ctx, fg_film *film, const fg_film_case *at, double ratio,
                          int halvings, fg_film_trace *trace) {
  if (trace->count == FG_FILM_TRACE_MAX) return FG_OK;
  const fg_film_trace_point *last = trace->count ? &trace->point[trace->count - 1] : NULL;
  fg_film_trace_point next = {.ratio = ratio};
  FG_TRY(fg_film_eigenvalues(ctx, film, at, I * ratio, last ? last->value : NULL, next.value));
  if (last && halvings && !is_followed(last, &next)) {
    FG_TRY(trace_to(ctx, film, at, sqrt(last->ratio * ratio), halvings - 1, trace));
    return trace_to(ctx, film, at, ratio, halvings - 1, trace);
  }
  trace->point[trace->count++] = next;
  return FG_OK;
}

fg_status fg_film_trace_eigenvalues(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                    const double ratios[2], int steps, fg_film_trace *trace) {
  trace->count = 0;
  for (int i = 0; i <= steps; i++) {
    double ratio = ratios[0] * pow(ratios[1] / ratios[0], (double)i / steps);
    FG_TRY(trace_to(ctx, film, at, ratio, HALVINGS, trace));
  }
  return FG_OK;
}
