/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flat foils with beams: islands of a scan become parts of foils, and parts become foils.
 *
 * The edges of a slit in a sheet need not be connected with those of the sheet's outline by tiles
 * of contrast: they are islands of their own, each with beams. All parts inside one outline are one
 * foil. So nothing larger than an island is in memory.
 */
#ifndef FG_MEASURE_BEAMS_H
#define FG_MEASURE_BEAMS_H

#include "foilgauge/foil.h"
#include "vision/islands.h"

/* The area inside one rim, and the beams along it. Lengths in mm of the scan. */
typedef struct fg_flat_part {
  fg_point *corners; /* of the rim's polygon; owned */
  size_t corner_count;
  int64_t box_px[4];
  bool hole, touches_border, light;
  fg_beam *beams; /* owned */
  size_t beam_count;
} fg_flat_part;

typedef struct fg_flat_parts {
  fg_flat_part *list; /* owned */
  size_t count, capacity;
  size_t specks;
} fg_flat_parts;

void fg_flat_parts_free(fg_flat_parts *parts);

/* Moves the parts of one list to another, which then owns them. FG_ERR_MEMORY. */
fg_status fg_flat_parts_move(fg_context *ctx, fg_flat_parts *from, fg_flat_parts *to);

/* An island and its place. */
typedef struct fg_flat_island {
  const fg_tiles *view;
  const fg_island *island;
  const int64_t *origin_px; /* of the view in the scan */
  double background;        /* the scan's level around all objects, 8-bit counts */
} fg_flat_island;

/* Adds the parts of one island. The result does not depend on `threads`. FG_ERR_MEMORY. */
fg_status fg_flat_island_measure(fg_context *ctx, const fg_flat_island *island,
                                 const fg_measurement *m, unsigned threads, fg_flat_parts *parts);

/* Makes foils of all parts: fills foils, foil_count, specks and light_on_dark of `m`, in no order.
 * A part with beams, or as large as a foil of the design, is a foil; the others are specks. */
fg_status fg_flat_foils_assemble(fg_context *ctx, fg_flat_parts *parts, fg_measurement *m);

#endif
