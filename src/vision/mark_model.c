/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/mark_model.h"

#include <math.h>

fg_mark_shape fg_mark_shape_of(const fg_mark_model *model, const double *p) {
  fg_mark_shape shape = {.p = p};
  for (size_t i = 0; i < model->angles; i++) {
    shape.cosine[i] = cos(p[FG_MARK_SHAPE + i]);
    shape.sine[i] = sin(p[FG_MARK_SHAPE + i]);
  }
  return shape;
}

/* An edge that rises along `distance`: share, derivatives by distance and by blur. */
typedef struct blurred_edge {
  double share, slope, by_blur;
} blurred_edge;

/* The normal distribution by its density, with an error below 7.5e-8 (Abramowitz and Stegun 1964,
 * 26.2.17): a picture has 16 bits at most, and the density is needed beside it. */
static double upper_tail(double t, double density) {
  double k = 1 / (1 + 0.2316419 * t);
  return density * k *
         (0.319381530 +
          k * (-0.356563782 + k * (1.781477937 + k * (-1.821255978 + k * 1.330274429))));
}

static blurred_edge edge_at(double distance, double blur) {
  const double scale = 0.3989422804014327; /* 1 / sqrt(2 pi) */
  double t = distance / blur;
  if (t > 6) return (blurred_edge){1, 0, 0};
  if (t < -6) return (blurred_edge){0, 0, 0};
  double density = scale * exp(-0.5 * t * t), tail = upper_tail(fabs(t), density);
  double slope = density / blur;
  return (blurred_edge){t > 0 ? 1 - tail : tail, slope, -t * slope};
}

static double dot_value(const fg_mark_shape *shape, double dx, double dy, double *gradient) {
  const double *p = shape->p;
  double r = sqrt(dx * dx + dy * dy), a = p[FG_MARK_CONTRAST];
  blurred_edge e = edge_at(p[FG_MARK_SHAPE] - r, p[FG_MARK_BLUR]);
  double outward = r > 0 ? a * e.slope / r : 0;
  gradient[FG_MARK_X] = outward * dx;
  gradient[FG_MARK_Y] = outward * dy;
  gradient[FG_MARK_LEVEL] = 1;
  gradient[FG_MARK_CONTRAST] = e.share;
  gradient[FG_MARK_BLUR] = a * e.by_blur;
  gradient[FG_MARK_SHAPE] = a * e.slope;
  return p[FG_MARK_LEVEL] + a * e.share;
}

static double dot_distance(const fg_mark_shape *shape, double dx, double dy) {
  return fabs(sqrt(dx * dx + dy * dy) - shape->p[FG_MARK_SHAPE]);
}

/* Distances from two lines through the mark, and their derivatives by the lines' angles. */
typedef struct two_lines {
  double u, v, u_turn, v_turn;
} two_lines;

static two_lines lines_at(const fg_mark_shape *shape, double dx, double dy) {
  const double *c = shape->cosine, *s = shape->sine;
  return (two_lines){.u = dx * c[0] + dy * s[0],
                     .v = dx * c[1] + dy * s[1],
                     .u_turn = dy * c[0] - dx * s[0],
                     .v_turn = dy * c[1] - dx * s[1]};
}

/* Derivatives of `a` times a share that changes by (by_u, by_v) with the distances. */
static void turn_into_gradient(const fg_mark_shape *shape, const two_lines *l, double by_u,
                               double by_v, double *gradient) {
  gradient[FG_MARK_X] = -(by_u * shape->cosine[0] + by_v * shape->cosine[1]);
  gradient[FG_MARK_Y] = -(by_u * shape->sine[0] + by_v * shape->sine[1]);
  gradient[FG_MARK_LEVEL] = 1;
  gradient[FG_MARK_SHAPE] = by_u * l->u_turn;
  gradient[FG_MARK_SHAPE + 1] = by_v * l->v_turn;
}

/* Two squares that meet in the corner, grown by the spread w of the ink: they cover
 * D = a b + c d, a, c = Phi((w +- u) / s), b, d = Phi((w +- v) / s), less the square of 2 w that
 * both cover, (a + c - 1) (b + d - 1); where w < 0 they do not meet, and nothing is less. */
static double chessboard_value(const fg_mark_shape *shape, double dx, double dy, double *gradient) {
  const double *p = shape->p;
  double contrast = p[FG_MARK_CONTRAST], s = p[FG_MARK_BLUR], w = p[FG_MARK_SHAPE + 2];
  two_lines l = lines_at(shape, dx, dy);
  blurred_edge a = edge_at(w + l.u, s), c = edge_at(w - l.u, s);
  blurred_edge b = edge_at(w + l.v, s), d = edge_at(w - l.v, s);
  bool meet = w > 0;
  double by_a = meet ? 1 - d.share : b.share, by_b = meet ? 1 - c.share : a.share;
  double by_c = meet ? 1 - b.share : d.share, by_d = meet ? 1 - a.share : c.share;
  double both = meet ? (a.share + c.share - 1) * (b.share + d.share - 1) : 0;
  turn_into_gradient(shape, &l, contrast * (by_a * a.slope - by_c * c.slope),
                     contrast * (by_b * b.slope - by_d * d.slope), gradient);
  gradient[FG_MARK_CONTRAST] = a.share * b.share + c.share * d.share - both;
  gradient[FG_MARK_BLUR] =
      contrast * (by_a * a.by_blur + by_b * b.by_blur + by_c * c.by_blur + by_d * d.by_blur);
  gradient[FG_MARK_SHAPE + 2] =
      contrast * (by_a * a.slope + by_b * b.slope + by_c * c.slope + by_d * d.slope);
  return p[FG_MARK_LEVEL] + contrast * gradient[FG_MARK_CONTRAST];
}

static double chessboard_distance(const fg_mark_shape *shape, double dx, double dy) {
  two_lines l = lines_at(shape, dx, dy);
  return fmin(fabs(l.u), fabs(l.v));
}

/* A stroke of half width w: share, derivatives by the distance, the blur and w. */
typedef struct blurred_stroke {
  double share, slope, by_blur, by_width;
} blurred_stroke;

static blurred_stroke stroke_at(double distance, double w, double blur) {
  blurred_edge a = edge_at(w + distance, blur), b = edge_at(w - distance, blur);
  return (blurred_stroke){a.share + b.share - 1, a.slope - b.slope, a.by_blur + b.by_blur,
                          a.slope + b.slope};
}

static double cross_value(const fg_mark_shape *shape, double dx, double dy, double *gradient) {
  const double *p = shape->p;
  double contrast = p[FG_MARK_CONTRAST], s = p[FG_MARK_BLUR], w = p[FG_MARK_SHAPE + 2];
  two_lines l = lines_at(shape, dx, dy);
  blurred_stroke a = stroke_at(l.u, w, s), b = stroke_at(l.v, w, s);
  double by_a = 1 - b.share, by_b = 1 - a.share;
  turn_into_gradient(shape, &l, contrast * by_a * a.slope, contrast * by_b * b.slope, gradient);
  gradient[FG_MARK_CONTRAST] = a.share + b.share - a.share * b.share;
  gradient[FG_MARK_BLUR] = contrast * (by_a * a.by_blur + by_b * b.by_blur);
  gradient[FG_MARK_SHAPE + 2] = contrast * (by_a * a.by_width + by_b * b.by_width);
  return p[FG_MARK_LEVEL] + contrast * gradient[FG_MARK_CONTRAST];
}

static double cross_distance(const fg_mark_shape *shape, double dx, double dy) {
  const double *p = shape->p;
  two_lines l = lines_at(shape, dx, dy);
  return fmin(fabs(fabs(l.u) - p[FG_MARK_SHAPE + 2]), fabs(fabs(l.v) - p[FG_MARK_SHAPE + 2]));
}

static double line_value(const fg_mark_shape *shape, double dx, double dy, double *gradient) {
  const double *p = shape->p;
  double contrast = p[FG_MARK_CONTRAST], cosine = shape->cosine[0], sine = shape->sine[0];
  blurred_stroke a = stroke_at(dx * cosine + dy * sine, p[FG_MARK_SHAPE + 1], p[FG_MARK_BLUR]);
  double by_u = contrast * a.slope;
  gradient[FG_MARK_X] = -by_u; /* by a shift across the line */
  gradient[FG_MARK_Y] = 0;
  gradient[FG_MARK_LEVEL] = 1;
  gradient[FG_MARK_CONTRAST] = a.share;
  gradient[FG_MARK_BLUR] = contrast * a.by_blur;
  gradient[FG_MARK_SHAPE] = by_u * (dy * cosine - dx * sine);
  gradient[FG_MARK_SHAPE + 1] = contrast * a.by_width;
  return p[FG_MARK_LEVEL] + contrast * a.share;
}

static double line_distance(const fg_mark_shape *shape, double dx, double dy) {
  double u = dx * shape->cosine[0] + dy * shape->sine[0];
  return fabs(fabs(u) - shape->p[FG_MARK_SHAPE + 1]);
}

static const fg_mark_model models[FG_MARK_KINDS] = {
    [FG_MARKS_DOTS] = {6, 0, false, dot_value, dot_distance},
    [FG_MARKS_CHESSBOARD] = {8, 2, false, chessboard_value, chessboard_distance},
    [FG_MARKS_CROSSES] = {8, 2, false, cross_value, cross_distance},
    [FG_MARKS_LINES] = {7, 1, true, line_value, line_distance},
};

const fg_mark_model *fg_mark_model_of(fg_mark_kind kind) {
  return &models[kind];
}
