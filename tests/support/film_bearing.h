/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing without dimensions, for tests of its film: rings and pads of clearance 1, held at a
 * place or under a load. */
#ifndef TESTS_SUPPORT_FILM_BEARING_H
#define TESTS_SUPPORT_FILM_BEARING_H

#include <math.h>
#include <string.h>

#include "film/film.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;

typedef struct bearing {
  fg_context ctx;
  fg_film film;
  fg_film_case at;
  fg_film_state state;
} bearing;

static inline void open_bearing(bearing *b, const fg_film_mesh *mesh, double lambda,
                                double compliance) {
  memset(b, 0, sizeof *b);
  assert_int_equal(fg_film_open(&b->ctx, mesh, false, &b->film), FG_OK);
  assert_int_equal(fg_film_case_open(&b->ctx, b->film.columns, &b->at), FG_OK);
  assert_int_equal(fg_film_state_open(&b->ctx, &b->film, &b->state), FG_OK);
  b->at.lambda = lambda;
  for (size_t i = 0; i < b->film.columns; i++) {
    b->at.clearance[i] = b->at.spring[i] = 1;
    b->at.yield[i] = compliance;
  }
  for (size_t i = 0; i < b->film.columns * b->film.nodes; i++)
    b->state.pressure[i] = 1;
}

static inline void close_bearing(bearing *b) {
  fg_film_state_close(&b->state);
  fg_film_case_close(&b->at);
  fg_film_close(&b->film);
}

static inline fg_film_mesh ring_of(size_t cells, size_t axial, double half_length) {
  return (fg_film_mesh){.pads = 1,
                        .cells = cells,
                        .axial = axial,
                        .ring = true,
                        .arc_rad = 2 * pi,
                        .half_length = half_length};
}

static inline fg_film_mesh pads_of(size_t pads, size_t cells, size_t axial) {
  return (fg_film_mesh){.pads = pads,
                        .cells = cells,
                        .axial = axial,
                        .arc_rad = 2 * pi / (double)pads,
                        .half_length = 1};
}

static inline void hold_at(bearing *b, double x, double y) {
  b->state.place[0] = x;
  b->state.place[1] = y;
  assert_int_equal(fg_film_newton(&b->ctx, &b->film, &b->at, FG_FILM_PRESSURE, &b->state), FG_OK);
}

static inline void balance(bearing *b, double load, double towards_rad) {
  b->at.load[0] = load * cos(towards_rad);
  b->at.load[1] = load * sin(towards_rad);
  assert_int_equal(fg_film_solve(&b->ctx, &b->film, &b->at, &b->state), FG_OK);
}

static inline void assert_ratio(double value, double expected, double relative) {
  if (fabs(value - expected) <= relative * fabs(expected)) return;
  fail_msg("%.12g is not %.12g within %g", value, expected, relative);
}

#endif
