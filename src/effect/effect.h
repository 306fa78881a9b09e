/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of all effects of scanner and part that the loop on scans knows. A row holds everything
 * that search, fit, reports and models need of its effect.
 *
 * A scanner's effect moves places of the glass (`glass`), a part's effect moves the strip's midline
 * (`midline`) or its edges apart (`width`). A free curve stands for the part that no listed effect
 * explains. An effect with two bases has two rows of one id; the first stands for both where the
 * basis does not matter. */
#ifndef FG_EFFECT_EFFECT_H
#define FG_EFFECT_EFFECT_H

#include <stdbool.h>

#include "field/field.h"
#include "rows/edge_fit.h"

/* Ways in which the search finds an effect. */
typedef enum fg_effect_sought {
  FG_EFFECT_SMOOTH, /* a candidate from the start; a shape is sought beside the geometry alone */
  FG_EFFECT_PLACED, /* its shape is sought over a grid: it is told from all others even in one scan
                     */
  FG_EFFECT_CURVE,  /* used when no listed effect is right */
  FG_EFFECT_OF_WIDTH, /* sought in the strip's width alone, once the search has converged */
} fg_effect_sought;

/* Coordinate that an effect acts on. */
typedef enum fg_effect_coordinate {
  FG_EFFECT_X, /* of the scan */
  FG_EFFECT_Y,
  FG_EFFECT_FOIL,   /* psi, from the foil's middle */
  FG_EFFECT_PHI,    /* in the bump's arc, -1 to 1 */
  FG_EFFECT_INDEX,  /* number of the bump */
  FG_EFFECT_NORMAL, /* direction of the edge's normal */
  FG_EFFECT_COORDINATES
} fg_effect_coordinate;

/* Names and format of an effect's coefficients and shapes. */
typedef enum fg_effect_numbers {
  FG_EFFECT_AMPLITUDE, /* one coefficient, um; then its shapes */
  FG_EFFECT_RATIO,     /* one coefficient, per length */
  FG_EFFECT_WAVE,      /* a sine's and a cosine's: amplitude, period, phase */
  FG_EFFECT_OVAL,      /* a cosine's and a sine's of twice an angle: amplitude, phase */
  FG_EFFECT_LED,       /* the first leads */
  FG_EFFECT_SHAPE,     /* none: the report shows the curve itself */
} fg_effect_numbers;

/* Powers that make a scanner's polynomial in the search. They are of one axis, about the middle of
 * the picture, and all polynomials over that axis share them. A polynomial's own middle c is
 * determined with every set. */
typedef enum fg_effect_polynomial {
  FG_EFFECT_NO_POLYNOMIAL,
  FG_EFFECT_LINEAR,    /* u */
  FG_EFFECT_QUADRATIC, /* a ((x - c) / w)²: u² and u, which give a and c */
  FG_EFFECT_CUBIC,     /* a ((x - c) / w)³: u³, u² and u in the proportion that c gives */
} fg_effect_polynomial;

/* Part of a curve's columns that the set of all effects uses: a curve with all columns would absorb
 * the noise that is correlated along the edge. */
typedef enum fg_effect_coarse {
  FG_EFFECT_WHOLE,
  FG_EFFECT_SPLINES,  /* neighbouring columns summed in pairs */
  FG_EFFECT_SMOOTHER, /* without the columns [rough[0], rough[1]) */
  FG_EFFECT_LEFT_OUT, /* none: the curve's other basis stands for it */
} fg_effect_coarse;

/* On one circle, a part's ovality and a scanner's scale with shear are collinear. */
typedef enum fg_effect_ring {
  FG_EFFECT_NOT_IN_RING,
  FG_EFFECT_RING_OF_SCANNER,
  FG_EFFECT_RING_OF_PART,
} fg_effect_ring;

/* Discs on which an effect can be told from the disc's own form error. */
typedef enum fg_effect_on_discs {
  FG_EFFECT_NOT_ON_DISCS,
  FG_EFFECT_ON_DISCS,
  FG_EFFECT_ON_ONE_DISC,    /* one disc; of several each has an effect of its own */
  FG_EFFECT_ON_KNOWN_DISCS, /* discs of known diameter */
  FG_EFFECT_ON_CLEAN_DISCS, /* `discs_min` clean discs, or more */
} fg_effect_on_discs;

/* Computes the midline's deviation of every column at one row, along the row's normal; returns the
 * number of columns. */
typedef size_t fg_effect_midline(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                                 const double *shape, double *values);

/* Returns the change of half the width at one row, um per um of amplitude. */
typedef double fg_effect_width(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row);

/* Returns start i of `count` of the search for a shape. */
typedef double fg_effect_start(const fg_field_frame *frame, size_t i, size_t count);

/* Fills start i of `count` of the search for two shapes, and how far from it the best may lie. */
typedef void fg_effect_grid(const fg_edge_fit *edge_fit, size_t i, size_t count,
                            double shape[FG_FIELD_SHAPES], double reach[FG_FIELD_SHAPES]);

/* Kinds of shapes. */
typedef enum fg_effect_shape {
  FG_EFFECT_PLACE,
  FG_EFFECT_LENGTH,
  FG_EFFECT_GROWTH, /* relative, per mm */
} fg_effect_shape;

/* Columns that have a prior size of their own; further ones have the last one's. */
enum { FG_EFFECT_SIZES = 7 };

typedef struct fg_effect {
  const char *id;
  const char *direction; /* of an effect with two bases: "normal", "radial"; else NULL */
  bool second;           /* another basis of an effect: its first row stands for all */
  const char *words;     /* name for people */
  const char
      *says[2]; /* meaning of a positive and a negative amplitude; NULL: `words` are complete */
  const char *equation;
  fg_effect_sought sought;
  fg_effect_coordinate coordinate;
  const char *moves; /* of a curve: the thing that it moves, in one word */
  fg_effect_numbers numbers;
  const char *amplitude_name, *amplitude_symbol; /* NULL: "amplitude_um", "a" */
  bool off_foils;                                /* foils cannot show it */
  fg_effect_on_discs on_discs;
  size_t discs_min;

  size_t columns, shapes; /* linear, non-linear; of a part's effect the basis returns the columns */
  const char *shape_name[FG_FIELD_SHAPES], *shape_symbol[FG_FIELD_SHAPES]; /* mm; for people */
  fg_effect_shape shape_is[FG_FIELD_SHAPES];
  fg_field_basis *glass;
  fg_point
      wave; /* of a glass effect whose columns are the sine and the cosine of a wave over `axis`
               with the first shape as its period: the direction that they move; else 0 */
  fg_effect_midline *midline;
  fg_effect_width *width;

  int axis; /* of the scanner: axis of a polynomial's middle or of a sought place */
  fg_effect_polynomial polynomial;
  fg_effect_start *start; /* of one shape */
  fg_effect_grid *grid;   /* of two */
  size_t starts;
  bool jumps; /* the first shape is a place where the picture jumps, a second one the pitch at which
                 it does so again: it needs rows on both sides, rows across it do not count, and no
                 derivative by it exists */
  const char
      *rival;     /* unnamed rival that is the same (evidence/rivals.h, evidence/unnamed.h), and */
  size_t stretch; /* which of its stretches */
  const char *extends; /* id of the effect that this one is with a number of 0; NULL: of none */
  int lobes;           /* of a part's harmonic: its number; 0: an oval */

  fg_effect_coarse coarse;
  size_t rough[2];
  double hold; /* weight of a curve's coefficients beside rows of weight FG_EDGE_FIT_BLOCK: of all
                  curves with the same residual the smallest one is chosen */
  bool bends;  /* bumps are no circles with it */
  bool loose;  /* of so many numbers that a scan leaves some of them open: explains a residual, but
                  corrects no other scan */
  bool by_evidence; /* not a candidate of the search for sets: evidence alone asks for it */
  bool of_carriage; /* error of the carriage along its travel, the same for all x: the lines of a
                       colour sensor see it at different times */
  bool scales;      /* both axes alike: parts of known size determine it */
  fg_effect_ring ring;
  double size_um[FG_EFFECT_SIZES]; /* standard deviation of each column's amplitude over scanners or
                                      parts; 0: as the one before
                                      it. Half of it, a quarter, ... are as likely */
  const char *size_from;           /* source of these sizes; "assumed": none */
} fg_effect;

/* Iterates over all rows in the order of search and report: the first one, and the one after
 * `effect`; NULL: none. */
const fg_effect *fg_effect_first(void);
const fg_effect *fg_effect_next(const fg_effect *effect);

/* Returns the first row of an id; NULL: none. */
const fg_effect *fg_effect_find(const char *id);

/* Returns the polynomial of a degree along an axis; NULL: none. */
const fg_effect *fg_effect_find_polynomial(fg_effect_polynomial polynomial, int axis);

/* Makes a field without numbers from an effect of the glass. */
fg_field fg_effect_field(const fg_effect *effect);

/* Returns true when two rows are one effect, in any of its bases. */
bool fg_effect_same(const fg_effect *a, const fg_effect *b);

/* Returns the distance of a place from the nearest jump, along the effect's axis. */
double fg_effect_from_jump_mm(const fg_effect *effect, const double *shape, double along_mm);

static inline bool fg_effect_is_free(const fg_effect *effect) {
  return effect->sought == FG_EFFECT_CURVE;
}

/* "scan.x", "foil.s", ... */
const char *fg_effect_coordinate_name(fg_effect_coordinate coordinate);
/* Coordinate with description and unit, for an axis. */
const char *fg_effect_coordinate_title(fg_effect_coordinate coordinate);

/* Returns true when an effect can be sought in the residuals of these rows, and is not left out.
 * Not every effect leaves a trace on a disc, and some traces are the same as the disc's own form
 * error.
 */
bool fg_effect_shows(const fg_edge_fit *edge_fit, const fg_effect *effect);

/* Returns true when an effect is in a list of ids that are separated by commas (NULL: none). */
bool fg_effect_is_listed(const char *ids, const fg_effect *effect);

/* Refuses a list that holds something else than listed effects: FG_ERR_USAGE. */
fg_status fg_effect_check_list(fg_context *ctx, const char *ids);

/* Rows of the table by subject, for table.c; each list ends with id NULL. */
extern const fg_effect fg_effects_scanner[], fg_effects_part[], fg_effects_curves[];

#endif
