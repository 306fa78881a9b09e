/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The layout of a foil: its arcs in order, from the turning of its midline. */
#ifndef FG_GEOMETRY_LAYOUT_H
#define FG_GEOMETRY_LAYOUT_H

#include "geometry/arcs.h"
#include "geometry/turning.h"

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
  fg_arc overall;      /* over the lands */
} fg_layout;

/* Finds and fits all arcs. `error` gets words (NULL: none) when the foil cannot be laid out:
 * no bumps, or too little land for an overall circle. Errors are FG_ERR_MEMORY only. */
fg_status fg_layout_find(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                         unsigned threads, fg_layout *layout, const char **error);

void fg_layout_free(fg_layout *layout);

/* Returns the mean distance of a land's stations from the overall circle, mm, outwards; NaN: it has
 * none. */
double fg_layout_land_distance(const fg_layout *layout, fg_range land);

/* Fills `overall` from its circle's fit, without the contribution of the pixels' noise to its
 * covariance. */
void fg_layout_overall(const fg_layout *layout, const fg_design *design, fg_overall *overall);

#endif
