/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks as they appear in a picture: value and derivatives of a pixel by the mark's parameters.
 *
 * An edge blurred by a Gaussian of sd s is Phi(distance / s). A mark is made of such edges, so that
 * a fit of all its pixels finds the place to the bound that noise sets. */
#ifndef FG_VISION_MARK_MODEL_H
#define FG_VISION_MARK_MODEL_H

#include "foilgauge/grid.h"

enum {
  FG_MARK_X, /* px */
  FG_MARK_Y,
  FG_MARK_LEVEL,    /* of the surroundings, counts */
  FG_MARK_CONTRAST, /* inside less outside */
  FG_MARK_BLUR,     /* s, px */
  FG_MARK_SHAPE,    /* first of the kind's own */
  FG_MARK_PARAMETERS_MAX = 8
};

/* Parameters of a mark, and cosine and sine of those that are angles of normals (two at most): they
 * are the same for all its pixels. */
typedef struct fg_mark_shape {
  const double *p;
  double cosine[2], sine[2];
} fg_mark_shape;

/* Parameters of a mark: those above, then
 *   dot: radius; chessboard: angles of the normals of both edges, spread of the ink;
 *   cross: angles of the normals of both strokes, half width; line: angle of the normal, half
 * width. */
typedef struct fg_mark_model {
  size_t parameters;
  size_t angles; /* the first of the kind's own */
  bool one_axis; /* a line: its place moves across it, which the derivative by x tells */
  /* Pixel at (dx, dy) from the mark, value and derivatives by all parameters. */
  double (*value)(const fg_mark_shape *shape, double dx, double dy, double *gradient);
  /* Least distance of the place to an edge, px. */
  double (*edge_distance)(const fg_mark_shape *shape, double dx, double dy);
} fg_mark_model;

fg_mark_shape fg_mark_shape_of(const fg_mark_model *model, const double *p);

const fg_mark_model *fg_mark_model_of(fg_mark_kind kind);

#endif
