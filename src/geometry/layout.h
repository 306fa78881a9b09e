/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The layout of a foil: its arcs in order, from the turning of its midline. */
#ifndef FG_GEOMETRY_LAYOUT_H
#define FG_GEOMETRY_LAYOUT_H

#include "geometry/arcs.h"
#include "geometry/jump.h"
#include "geometry/turning.h"

/* A jump of the scan between lands. */
typedef struct fg_land_step {
  double chance;    /* of distances as far from one circle without a jump; 1: no jump was sought */
  double jump_mm;   /* size of the jump; NaN: none was sought */
  double change[3]; /* of the circle's x, y and radius, if the scan jumps */
} fg_land_step;

typedef struct fg_layout {
  fg_turning turning;
  fg_datum_line line;
  bool inner_is_right;   /* the shaft's side of the strip */
  fg_range *bump_ranges; /* turning.bump_count; owned */
  fg_arc *bumps;         /* one range each; owned */
  bool *fitted;          /* true when the bump's circle was found; owned */
  fg_range *lands;       /* owned */
  size_t land_count;
  bool land_displaced; /* the land of a gap lies beside the circle, and is in no fit */
  double *gap_off_mm;  /* per gap, bump_count + 1: by how much its land does; 0: not; owned */
  fg_arc overall;      /* over the lands */
  fg_land_step land_step;
} fg_layout;

/* Finds and fits all arcs. `error` gets words (NULL: none) when the foil cannot be laid out:
 * no bumps, or too little land for an overall circle. Errors are FG_ERR_MEMORY only. */
fg_status fg_layout_find(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                         unsigned threads, fg_layout *layout, const char **error);

void fg_layout_free(fg_layout *layout);

/* Returns the mean distance of a land's stations from the overall circle, in the direction of its
 * middle; its mm are NaN where it has none. */
fg_distance fg_layout_land_distance(const fg_layout *layout, fg_range land);

/* Fills `overall` from its circle's fit, without the contribution of the pixels' noise to its
 * covariance. */
void fg_layout_overall(const fg_layout *layout, const fg_design *design, fg_overall *overall);

#endif
