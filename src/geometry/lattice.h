/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Square lattices: indices of scattered places, whatever their number, pose and gaps. */
#ifndef FG_GEOMETRY_LATTICE_H
#define FG_GEOMETRY_LATTICE_H

#include "foilgauge/grid.h"
#include "foilgauge/status.h"

/* A place, before it is known to be a mark of the lattice. */
typedef struct fg_lattice_place {
  fg_point at;
  double direction_rad; /* of the lattice at this place, modulo a quarter turn; NaN: not seen */
  int column, row;
  bool on; /* it belongs to the lattice */
} fg_lattice_place;

/* Steps of a lattice. */
typedef struct fg_lattice {
  fg_point origin, axis[2];
  bool one_axis; /* of lines: axis[1] is across it, of the same length */
} fg_lattice;

/* Finds the lattice that holds most places; `places` get their indices, from 0. FG_ERR_DATA: there
 * is none. With `one_axis` places are projected onto the direction of their normals. */
fg_status fg_lattice_find(fg_context *ctx, fg_lattice_place *places, size_t count, bool one_axis,
                          fg_lattice *lattice);

#endif
