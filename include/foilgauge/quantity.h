/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every reported quantity: one row of a table each.
 *
 * A row says what a quantity is called, where it and its standard uncertainty lie, and what is done
 * with it. JSON, CSV, page, terminal and picture, tolerances, a scanner's model that widens u_,
 * tables, lots and the schemas' test loop over the rows: whatever asks something new of quantities
 * asks the row.
 */
#ifndef FOILGAUGE_QUANTITY_H
#define FOILGAUGE_QUANTITY_H

#include "foilgauge/foil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a quantity belongs to: its offsets are into that struct. */
typedef enum fg_quantity_owner {
  FG_QUANTITY_OF_FOIL,    /* fg_foil; "overall.", "arc.", "correction." are JSON objects; the second
                             is there of form arc, the third where a scanner's model corrected
                             the foil */
  FG_QUANTITY_OF_BUMP,    /* fg_bump */
  FG_QUANTITY_OF_BEAM,    /* fg_beam; of form cantilever */
  FG_QUANTITY_OF_DISC,    /* fg_disc */
  FG_QUANTITY_OF_STRIP,   /* fg_strip */
  FG_QUANTITY_OF_BEARING, /* fg_bearing_clearance (bearing.h); of a lot */
  FG_QUANTITY_OWNERS,
} fg_quantity_owner;

typedef enum fg_quantity_kind {
  FG_QUANTITY_NUMBER, /* double */
  FG_QUANTITY_PAIR,   /* two doubles, x and y */
  FG_QUANTITY_COUNT,  /* size_t */
} fg_quantity_kind;

/* What is done with a quantity beyond what is done with all: each is in JSON, CSV and a lot's
 * journal, and can have a tolerance (pairs cannot). */
typedef enum fg_quantity_use {
  FG_QUANTITY_ON_PAGE = 1u << 0,     /* a column of the page's table, with a tolerance or without */
  FG_QUANTITY_ON_TERMINAL = 1u << 1, /* of the terminal's */
  FG_QUANTITY_ON_PICTURE = 1u << 2,  /* of the legend beside the picture */
  FG_QUANTITY_IN_LOT = 1u << 3,      /* lots do statistics of it without a tolerance, too */
  /* A table may take its column for a cause: where a thing lay, what it was made of. What
   * springback and the scanner make of it is a consequence. */
  FG_QUANTITY_IS_CAUSE = 1u << 4,
  /* The bump's own circle alone says it: its errors are independent from bump to bump, while all
   * that rests on the overall circle errs alike within a foil. */
  FG_QUANTITY_IS_OWN = 1u << 5,
  FG_QUANTITY_OF_ARC = 1u << 6,  /* of form arc alone */
  FG_QUANTITY_OF_FLAT = 1u << 7, /* of a foil: of form cantilever, too */
  /* Lengths between two edges of opposite sense, and what follows from them: an unknown tone curve
   * is in their uncertainty. */
  FG_QUANTITY_BETWEEN_EDGES = 1u << 8,
  FG_QUANTITY_OF_DATUM = 1u << 9, /* as well, where an edge is the datum */
} fg_quantity_use;

#define FG_NO_UNCERTAINTY ((size_t)-1)

typedef struct fg_quantity {
  const char *name; /* JSON name, unit included */
  /* Of a bearing: the name that a design's tolerances have for it; NULL: it can have none. What is
   * of a part has tolerances by its name. */
  const char *tolerance;
  const char *unit;   /* for people: "mm", "°", "%", "µm", "" */
  const char *symbol; /* heading of a column, UTF-8 */
  const char *words;  /* what it is, for people */
  fg_quantity_kind kind;
  size_t offset;   /* in its owner */
  size_t u_offset; /* of its standard uncertainty; FG_NO_UNCERTAINTY without */
  /* Where a covariance of the object (double [3][3]) holds the square of u_ too: its offset, 0 when
   * none does, and which row of it is this (the first of a pair's). */
  size_t covariance;
  size_t covariance_row;
  int decimals;  /* at least, where people read it */
  unsigned uses; /* fg_quantity_use */
  int rank;      /* among those that people read, from 1; 0: behind them, in order of the rows */
  /* For quality systems, which know lengths and angles: QIF's name of the characteristic (NULL:
   * not exported; ratios and percentages follow from the others). */
  const char *characteristic;
  /* What the design asks for: quality systems state it, and lots of different designs are
   * compared over it. NULL: nothing. */
  double (*nominal)(const fg_design *design, const fg_nominal *nominal);
  /* What the springback model of constant arc length makes of it; NULL: it says nothing. */
  double (*by_arc_length)(const fg_design *design, const fg_springback *springback);
} fg_quantity;

/* The rows of one owner, in the order of the report. */
const fg_quantity *fg_quantities(fg_quantity_owner owner, size_t *count);

/* Whether parts of that form have it: an arc has no bumps, and ends; a cantilever has beams. */
bool fg_quantity_applies(fg_quantity_owner owner, const fg_quantity *quantity, fg_foil_kind kind);

/* The row of that name, or NULL. */
const fg_quantity *fg_quantity_find(fg_quantity_owner owner, const char *name);

/* The row of a bearing that a tolerance of that name is about, or NULL. */
const fg_quantity *fg_quantity_of_bearing_for(const char *tolerance);

/* A number or a count of the object (of its owner's type) as double; NaN for a pair. */
double fg_quantity_value(const fg_quantity *quantity, const void *object);

/* Its standard uncertainty; NaN when there is none. */
double fg_quantity_uncertainty(const fg_quantity *quantity, const void *object);

#ifdef __cplusplus
}
#endif
#endif
