/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A second measurement from moved edges. */
#ifndef FG_MEASURE_AGAIN_H
#define FG_MEASURE_AGAIN_H

#include "foilgauge/foil.h"

/* Functions that move the edges of a copy; `foil` or `disc` is its original. Several threads call
 * them. */
typedef struct fg_measure_mover {
  void (*strip)(const void *user, const fg_foil *foil, fg_strip *strip);
  fg_point (*point)(const void *user, const fg_disc *disc, fg_point at); /* of a disc */
  fg_point (*flat)(const void *user,
                   fg_point at); /* of a beam or mark; NULL: they cannot be moved */
  const void *user;
} fg_measure_mover;

/* Moves every edge of a strip, and its ends, according to its place. */
void fg_strip_move(fg_strip *strip, fg_point (*move)(const void *user, fg_point at),
                   const void *user);

/* Measures again from moved edges. The caller frees `again`, whose foils and discs are its own. */
fg_status fg_measure_again(fg_context *ctx, const fg_measurement *m, const fg_measure_mover *mover,
                           unsigned threads, fg_measurement *again);

/* Measures again with places multiplied by a factor along x and along y. */
fg_status fg_measure_stretched(fg_context *ctx, const fg_measurement *m, const double factor[2],
                               unsigned threads, fg_measurement *again);

#endif
