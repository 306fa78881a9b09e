/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots as sets of foils from one die each, and dies from their reports. */
#ifndef FG_COMPENSATION_SETS_H
#define FG_COMPENSATION_SETS_H

#include "foilgauge/compensation.h"
#include "lot/run/lot.h"

/* One foil of a set: logarithms of formed over die, and heights; NaN: not known. */
typedef struct fg_formed_foil {
  double log_ratio[2]
                  [FG_COMPENSATION_BUMPS]; /* radius, arc length, by index of the target's bump */
  double height_mm[FG_COMPENSATION_BUMPS];
  double overall, pitch;
} fg_formed_foil;

/* A lot in memory with its die. */
typedef struct fg_formed_lot {
  fg_lot lot;
  char folder[1024], sha256[65], scans_sha256[65], date[16];
} fg_formed_lot;

/* FG_ERR_DATA: the folder holds no whole lot. */
fg_status fg_formed_lot_read(fg_context *ctx, const char *folder, fg_formed_lot *lot);
void fg_formed_lot_free(fg_formed_lot *lot);

/* Dimensions of a design, as a die that makes it without springback. */
fg_status fg_die_dimensions_of_design(fg_context *ctx, const fg_design *design, size_t bumps,
                                      fg_die_dimensions *die);
/* Derives the heights and places of a die's bumps; FG_ERR_DATA where the circles do not meet. */
fg_status fg_die_dimensions_derive(fg_context *ctx, const fg_design *design,
                                   fg_die_dimensions *die);

/* Reads the report of a die, measured or to be cut. */
fg_status fg_die_dimensions_load(fg_context *ctx, const char *path, const fg_design *design,
                                 size_t bumps, fg_die_dimensions *die, fg_die_origin *origin);

/* Makes the sets of a lot: one of all foils where `die` is given, else one for each die that the
 * manifest names. `foils` gets the foils of all of them. */
typedef struct fg_formed_sets {
  fg_formed_set *set; /* owned */
  size_t count, capacity;
  fg_formed_foil *foil; /* of the lots that were read; owned */
  size_t *foil_set;     /* owned */
  size_t foils, foil_capacity, set_capacity;
} fg_formed_sets;

fg_status fg_formed_sets_add(fg_context *ctx, const fg_formed_lot *lot,
                             const fg_die_dimensions *die, fg_die_origin origin, size_t bumps,
                             fg_formed_sets *sets);
void fg_formed_sets_free(fg_formed_sets *sets);

#endif
