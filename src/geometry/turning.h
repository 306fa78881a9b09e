/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recognition of a foil from the turning of its midline.
 *
 * Along a foil the tangent's direction goes back and forth: a bump turns it one way, the fillet,
 * land and fillet between two bumps turn it the other way, and by one pitch more, since all of it
 * goes round the overall circle. The turning points of the direction are the inflections between
 * bump arcs and fillets. The lip is a tight bend at one end, in either sense.
 */
#ifndef FG_GEOMETRY_TURNING_H
#define FG_GEOMETRY_TURNING_H

#include <stdbool.h>

#include "foilgauge/strip.h"

/* Stations [first, last] between two turning points of the direction. */
typedef struct fg_turn {
  size_t first, last;
  double turn_rad; /* signed */
  double length_mm;
  double bend_radius_mm; /* mean radius where 80 % of the turn happens */
  double tightest_mm;    /* radius where it turns fastest */
  double sharp_rad;      /* turn on radii far below a bump's */
} fg_turn;

typedef struct fg_turning {
  fg_turn *bumps; /* in the order of the stations; owned */
  size_t bump_count;
  bool lip_first, lip_last; /* a lip was seen at the first, the last station's end */
  size_t lip_end[2];        /* station where the lip's bend ends; valid where there is a lip */
  double sense;             /* +1: bumps turn towards the normal (right), -1: away from it */
} fg_turning;

/* Finds the bumps and the lip. No bump is no error: bump_count is 0. */
fg_status fg_turning_find(fg_context *ctx, const fg_strip *strip, fg_turning *turning);

void fg_turning_free(fg_turning *turning);

/* Returns the middle between the edges at a station. */
static inline fg_point fg_strip_middle(const fg_strip *strip, size_t i) {
  const fg_station *s = &strip->stations[i];
  return (fg_point){0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)};
}

#endif
