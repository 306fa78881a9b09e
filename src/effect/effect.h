/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every effect of scanner and part that the loop on scans knows: one row says everything that
 * anybody asks of it.
 *
 * A scanner's effect moves places of the glass (`glass`), a part's the strip's midline (`midline`)
 * or its edges apart (`width`).
 * A free curve is for what no listed effect explains. An effect that comes in two forms has two
 * rows with one id; the first speaks for both where the form does not matter.
 */
#ifndef FG_EFFECT_EFFECT_H
#define FG_EFFECT_EFFECT_H

#include <stdbool.h>

#include "field/field.h"
#include "rows/edge_fit.h"

/* How the search comes to it. */
typedef enum fg_effect_sought {
  FG_EFFECT_SMOOTH,   /* a candidate from the start; a shape is sought beside the geometry alone */
  FG_EFFECT_PLACED,   /* its shape is sought over a grid: it stands alone even in one scan */
  FG_EFFECT_CURVE,    /* where no listed effect is right */
  FG_EFFECT_OF_WIDTH, /* in the strip's width alone, once the points have settled */
} fg_effect_sought;

/* The coordinate that it lives on. */
typedef enum fg_effect_coordinate {
  FG_EFFECT_X, /* of the scan */
  FG_EFFECT_Y,
  FG_EFFECT_FOIL,   /* psi, from the foil's middle */
  FG_EFFECT_PHI,    /* in the bump's arc, -1 to 1 */
  FG_EFFECT_INDEX,  /* number of the bump */
  FG_EFFECT_NORMAL, /* direction of the edge's normal */
  FG_EFFECT_COORDINATES
} fg_effect_coordinate;

/* What its coefficients and shapes are called and how they are told. */
typedef enum fg_effect_numbers {
  FG_EFFECT_AMPLITUDE, /* one coefficient, um; then its shapes */
  FG_EFFECT_RATIO,     /* one coefficient, per length */
  FG_EFFECT_WAVE,      /* a sine's and a cosine's: amplitude, period, phase */
  FG_EFFECT_OVAL,      /* a cosine's and a sine's of twice an angle: amplitude, phase */
  FG_EFFECT_LED,       /* the first leads */
  FG_EFFECT_SHAPE,     /* none: the curve itself */
} fg_effect_numbers;

/* What a polynomial of the scanner is made of in the search: powers of one axis about the middle of
 * the picture, which all polynomials over it share. Its own middle is found with every set. */
typedef enum fg_effect_polynomial {
  FG_EFFECT_NO_POLYNOMIAL,
  FG_EFFECT_LINEAR,    /* u */
  FG_EFFECT_QUADRATIC, /* a ((x - c) / w)²: u² and u, which give a and c */
  FG_EFFECT_CUBIC,     /* a ((x - c) / w)³: u³, u² and u in the proportion that c gives */
} fg_effect_polynomial;

/* Of a curve's columns, the part that all effects at once have in the search: with all of them a
 * curve would take the noise that is correlated along the edge for its own. */
typedef enum fg_effect_coarse {
  FG_EFFECT_WHOLE,
  FG_EFFECT_SPLINES,  /* every two neighbours as one */
  FG_EFFECT_SMOOTHER, /* without the columns [rough[0], rough[1]) */
  FG_EFFECT_LEFT_OUT, /* nothing of it: the other form of the curve stands for it */
} fg_effect_coarse;

/* In one circle an oval of it and a scale with a shear of the scanner are the same. */
typedef enum fg_effect_ring {
  FG_EFFECT_NOT_IN_RING,
  FG_EFFECT_RING_OF_SCANNER,
  FG_EFFECT_RING_OF_PART,
} fg_effect_ring;

/* Which discs show it; a disc's own form must not be taken for it. */
typedef enum fg_effect_on_discs {
  FG_EFFECT_NOT_ON_DISCS,
  FG_EFFECT_ON_DISCS,
  FG_EFFECT_ON_ONE_DISC,    /* on several every one has its own */
  FG_EFFECT_ON_KNOWN_DISCS, /* of known diameter */
  FG_EFFECT_ON_CLEAN_DISCS, /* on `discs_min` clean ones, or more */
} fg_effect_on_discs;

/* A midline's deviation of every column at one row, along the row's normal; returns how many. */
typedef size_t fg_effect_midline(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                                 double *values);

/* Half the width's change at one row, um per um of amplitude. */
typedef double fg_effect_width(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row);

/* Start i of `count` of the search for a shape. */
typedef double fg_effect_start(const fg_field_frame *frame, size_t i, size_t count);

typedef struct fg_effect {
  const char *id;
  const char *direction; /* "normal", "radial": of an effect in two forms; else NULL */
  bool second;           /* form: the first row speaks for both */
  const char *words;     /* for people */
  const char *says[2];   /* what a positive and a negative amplitude mean; NULL: `words` say all */
  const char *equation;
  fg_effect_sought sought;
  fg_effect_coordinate coordinate;
  const char *moves; /* a curve: what it moves, in a report's word */
  fg_effect_numbers numbers;
  const char *amplitude_name, *amplitude_symbol; /* NULL: "amplitude_um", "a" */
  bool off_foils;                                /* foils cannot show it */
  fg_effect_on_discs on_discs;
  size_t discs_min;

  size_t columns, shapes; /* linear, non-linear; of a part's effect the basis says the columns */
  const char *shape_name[FG_FIELD_SHAPES], *shape_symbol[FG_FIELD_SHAPES]; /* mm; for people */
  bool spans; /* its shape is a length, not a place */
  fg_field_basis *glass;
  fg_effect_midline *midline;
  fg_effect_width *width;

  int axis; /* of the scanner: where a polynomial's middle or a sought place lies */
  fg_effect_polynomial polynomial;
  fg_effect_start *start;
  size_t starts;
  bool jumps; /* its shape is a place where the picture jumps: rows on both sides must speak of it,
                 rows across it do not count, and no derivative by it exists */

  fg_effect_coarse coarse;
  size_t rough[2];
  double hold; /* weight of a curve's coefficients beside rows that weigh FG_EDGE_FIT_BLOCK each: of
                  all curves that leave the same residual the smallest one is meant */
  bool bends;  /* bumps are no circles with it */
  bool of_carriage; /* an error of the carriage along its way, the same for all x: the lines of a
                       colour sensor see it at their own moments */
  bool scales;      /* both axes alike: parts of known size tell it from larger ones */
  fg_effect_ring ring;
} fg_effect;

/* All rows, in the order in which they are searched and reported: the first, and the one after
 * `effect`; NULL: there is none. */
const fg_effect *fg_effect_first(void);
const fg_effect *fg_effect_next(const fg_effect *effect);

/* The first row of an id; NULL: none. */
const fg_effect *fg_effect_find(const char *id);

/* The polynomial of a degree along an axis; NULL: none. */
const fg_effect *fg_effect_find_polynomial(fg_effect_polynomial polynomial, int axis);

/* An effect of the glass as a field without numbers. */
fg_field fg_effect_field(const fg_effect *effect);

/* Whether two rows are one effect, in whatever form. */
bool fg_effect_same(const fg_effect *a, const fg_effect *b);

static inline bool fg_effect_is_free(const fg_effect *effect) {
  return effect->sought == FG_EFFECT_CURVE;
}

/* "scan.x", "foil.s", ... */
const char *fg_effect_coordinate_name(fg_effect_coordinate coordinate);
/* With what it is and its unit, for an axis. */
const char *fg_effect_coordinate_title(fg_effect_coordinate coordinate);

/* Whether an effect can be sought in these points' residuals: not every one leaves a trace in a
 * disc, nor is every trace another one than the disc's own form. */
bool fg_effect_shows(const fg_edge_fit *edge_fit, const fg_effect *effect);

#endif
