/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every reported quantity: one row of a table each.
 *
 * A row holds a quantity's name, the place of its value and standard uncertainty, and its uses.
 * JSON, CSV, page, terminal and picture, tolerances, a scanner's model that widens u_, tables, lots
 * and the schemas' test loop over the rows. A new use of quantities is a new member of the row.
 */
#ifndef FOILGAUGE_QUANTITY_H
#define FOILGAUGE_QUANTITY_H

#include "foilgauge/foil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Struct to which a quantity's offsets belong. */
typedef enum fg_quantity_owner {
  FG_QUANTITY_OF_FOIL, /* fg_foil; "overall.", "arc.", "correction." are JSON objects; the second is
                          there for kind arc, the third after a correction by a scanner's model */
  FG_QUANTITY_OF_BUMP, /* fg_bump */
  FG_QUANTITY_OF_BEAM, /* fg_beam; of kind cantilever */
  FG_QUANTITY_OF_DISC, /* fg_disc */
  FG_QUANTITY_OF_STRIP,   /* fg_strip */
  FG_QUANTITY_OF_BEARING, /* fg_bearing_clearance (bearing.h); of a lot */
  FG_QUANTITY_OWNERS,
} fg_quantity_owner;

typedef enum fg_quantity_kind {
  FG_QUANTITY_NUMBER, /* double */
  FG_QUANTITY_PAIR,   /* two doubles, x and y */
  FG_QUANTITY_COUNT,  /* size_t */
} fg_quantity_kind;

/* Uses of a quantity beyond those of all: each is in JSON, CSV and a lot's journal, and can have a
 * tolerance (pairs cannot). */
typedef enum fg_quantity_use {
  FG_QUANTITY_ON_PAGE = 1u << 0,     /* column of the page's table, with a tolerance or without */
  FG_QUANTITY_ON_TERMINAL = 1u << 1, /* column of the terminal's table */
  FG_QUANTITY_ON_PICTURE = 1u << 2,  /* line of the legend beside the picture */
  FG_QUANTITY_IN_LOT = 1u << 3,      /* lots do its statistics without a tolerance, too */
  /* A table may use its column as a cause: a thing's place or material. Consequences of springback
     and scanner are no causes. */
  FG_QUANTITY_IS_CAUSE = 1u << 4,
  /* The value depends on the bump's own circle alone: its errors are independent from bump to bump,
     while values that use the overall circle err alike within a foil. */
  FG_QUANTITY_IS_OWN = 1u << 5,
  FG_QUANTITY_OF_ARC = 1u << 6,  /* of kind arc alone */
  FG_QUANTITY_OF_FLAT = 1u << 7, /* of a foil: of kind cantilever, too */
  /* Lengths between two edges of opposite sense, and their dependents: their uncertainty includes
     an unknown tone curve. */
  FG_QUANTITY_BETWEEN_EDGES = 1u << 8,
  FG_QUANTITY_OF_DATUM = 1u << 9, /* depends on the level, too, where an edge is the datum */
} fg_quantity_use;

#define FG_NO_UNCERTAINTY ((size_t)-1)

typedef struct fg_quantity {
  const char *name; /* JSON name, unit included */
  /* Of a bearing: its name in a design's tolerances; NULL: it can have none. Quantities of a part
   * have tolerances by their own name. */
  const char *tolerance;
  const char *unit;   /* for people: "mm", "°", "%", "µm", "" */
  const char *symbol; /* heading of a column, UTF-8 */
  const char *words;  /* meaning, for people */
  fg_quantity_kind kind;
  size_t offset;   /* in its owner */
  size_t u_offset; /* of its standard uncertainty; FG_NO_UNCERTAINTY without */
  /* Offset of a covariance of the object (double [3][3]) that holds the square of u_ too, 0: none;
   * and this quantity's row in it (the first of a pair's). */
  size_t covariance;
  size_t covariance_row;
  int decimals;  /* min number of decimals for people */
  unsigned uses; /* fg_quantity_use */
  int rank;      /* rank for people, from 1, no two alike; 0: after the ranked, in their order */
  /* For quality systems, which know lengths and angles: QIF's name of the characteristic (NULL:
   * not exported; ratios and percentages follow from the others). */
  const char *characteristic;
  /* The design's value: quality systems state it, and lots of different designs are compared over
   * it. NULL: none. */
  double (*nominal)(const fg_design *design, const fg_nominal *nominal);
  /* Prediction of the springback model of constant arc length; NULL: none. */
  double (*by_arc_length)(const fg_design *design, const fg_springback *springback);
} fg_quantity;

/* The rows of one owner, in the order of the report. */
const fg_quantity *fg_quantities(fg_quantity_owner owner, size_t *count);

/* Returns true when parts of that kind have it: an arc has ends and no bumps; a cantilever has
 * beams. */
bool fg_quantity_applies(fg_quantity_owner owner, const fg_quantity *quantity, fg_foil_kind kind);

/* The row of that name, or NULL. */
const fg_quantity *fg_quantity_find(fg_quantity_owner owner, const char *name);

/* Returns the row of a bearing for a tolerance of that name, or NULL. */
const fg_quantity *fg_quantity_of_bearing_for(const char *tolerance);

/* A number or a count of the object (of its owner's type) as double; NaN for a pair. */
double fg_quantity_value(const fg_quantity *quantity, const void *object);

/* Its standard uncertainty; NaN when there is none. */
double fg_quantity_uncertainty(const fg_quantity *quantity, const void *object);

#ifdef __cplusplus
}
#endif
#endif
