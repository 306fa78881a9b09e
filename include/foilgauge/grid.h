/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids: plates and boards with marks on a square lattice. Places are mm of the scan; a mark's
 * index counts steps of the lattice. */
#ifndef FOILGAUGE_GRID_H
#define FOILGAUGE_GRID_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/circle.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_mark_kind {
  FG_MARKS_DOTS,       /* round marks */
  FG_MARKS_CHESSBOARD, /* corners of squares */
  FG_MARKS_CROSSES,    /* crossings of two strokes */
  FG_MARKS_LINES,      /* graduation of a ruler: one axis */
} fg_mark_kind;

enum { FG_MARK_KINDS = FG_MARKS_LINES + 1 };

const char *fg_mark_kind_word(fg_mark_kind kind);

/* A mark as found. */
typedef struct fg_mark {
  int column, row;      /* steps along the lattice's axes, from 0; of lines the row is 0 */
  fg_point at_mm;       /* of the scan */
  double u_mm;          /* standard uncertainty along x and along y, from the picture's noise */
  fg_point residual_mm; /* measured less fitted; of lines across the line only */
  double blur_um;       /* sd of the edges' blur */
  double contrast;      /* counts, inside less outside */
  double reach_mm;      /* a dot's radius, half the length of a corner's edges; 0: not known */
  int polarity; /* of a chessboard's corner: 1 or -1, which alternate from corner to corner */
  bool used;    /* not an outlier of the lattice */
} fg_mark;

/* A value with its standard uncertainty. */
typedef struct fg_grid_value {
  double value, u;
} fg_grid_value;

/* A grid in a scan. The lattice is fitted as square steps behind a linear distortion S of the scan:
 * place = origin + S (rotation (step (column, row))), S = [1 + ex, q; 0, 1 + ey]. The step along x
 * is that times 1 + ex. A grid of lines shows one axis only; the other values are NaN. */
typedef struct fg_grid {
  fg_mark_kind kind;
  fg_mark *marks; /* owned; row by row */
  size_t count, used;
  int columns, rows;        /* of the smallest rectangle that holds all marks */
  size_t missing;           /* places of it without a mark */
  int squares_per_step;     /* of a chessboard: 2 where all corners seen lie two squares apart */
  fg_grid_value step_px[2]; /* along x and along y of the scan */
  fg_grid_value step_mm[2];
  fg_grid_value axis_ratio; /* step along x over step along y, mm */
  fg_grid_value shear;      /* q: shift along x per length along y */
  double rotation_deg;      /* of the columns' direction from x towards y, -45 to 45 */
  fg_point origin_mm;       /* of column 0, row 0 */
  double axis_mm[2][2];     /* step along columns (x, y) and along rows, mm of the scan */
  double rms_um;            /* of the residuals, each component */
  double largest_um;        /* residual of a used mark */
  double mark_u_um;         /* root mean square u of a mark */
  double blur_um;           /* median */
  /* Through a scanner's model: rms of the residuals without it, and of the part of their
   * uncertainty that the model has. */
  bool corrected;
  double uncorrected_rms_um, u_model_um;
  /* The board in its own frame, by which scans of it are told apart when it is turned: gray levels
   * from 1, 0 beyond the scan; it begins one step before the first mark. */
  unsigned char *picture; /* owned; (columns + 1) per_step × (rows + 1) per_step */
  int per_step;           /* samples of it per step */
} fg_grid;

/* Fits the lattice to the marks, whose columns, rows, places and u_mm are set, and fills everything
 * that follows. False: the marks lie on one line. */
bool fg_grid_fit(fg_grid *grid, const double dpi[2]);

/* Differences of a lattice from another fit of the same marks: of step x, step y, ratio and shear,
 * and the mean square of the marks' residuals along one axis. */
typedef struct fg_grid_moves {
  double step_mm[2], axis_ratio, shear, residual_mm2;
} fg_grid_moves;

fg_grid_moves fg_grid_find_moves(const fg_grid *grid, const fg_grid *other);

/* Adds the squares of moves, each times `share`², to the variances of a lattice's numbers. */
void fg_grid_widen(fg_grid *grid, const fg_grid_moves *moves, double share);

void fg_grid_free(fg_grid *grid); /* frees its members; NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
