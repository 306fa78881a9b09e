/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/mark_model.h"

#include <math.h>

static double normal_share(double t) {
  return 0.5 * erfc(-t * M_SQRT1_2);
}

static double normal_density(double t) {
  const double scale = 0.3989422804014327; /* 1 / sqrt(2 pi) */
  return scale * exp(-0.5 * t * t);
}

/* An edge that rises along `distance`: share, derivatives by distance and by blur. */
typedef struct blurred_edge {
  double share, slope, by_blur;
} blurred_edge;

static blurred_edge edge_at(double distance, double blur) {
  double t = distance / blur;
  if (t > 6) return (blurred_edge){1, 0, 0};
  if (t < -6) return (blurred_edge){0, 0, 0};
  double slope = normal_density(t) / blur;
  return (blurred_edge){normal_share(t), slope, -t * slope};
}

static double dot_value(const double *p, double dx, double dy, double *gradient) {
  double r = hypot(dx, dy), a = p[FG_MARK_CONTRAST];
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

static double dot_distance(const double *p, double dx, double dy) {
  return fabs(hypot(dx, dy) - p[FG_MARK_SHAPE]);
}

/* Distances from two lines through the mark, and their derivatives by the lines' angles. */
typedef struct two_lines {
  double u, v, u_turn, v_turn, cosine[2], sine[2];
} two_lines;

static two_lines lines_at(const double *angle, double dx, double dy) {
  two_lines l;
  for (int i = 0; i < 2; i++) {
    l.cosine[i] = cos(angle[i]);
    l.sine[i] = sin(angle[i]);
  }
  l.u = dx * l.cosine[0] + dy * l.sine[0];
  l.v = dx * l.cosine[1] + dy * l.sine[1];
  l.u_turn = dy * l.cosine[0] - dx * l.sine[0];
  l.v_turn = dy * l.cosine[1] - dx * l.sine[1];
  return l;
}

/* Derivatives of `a` times a share that changes by (by_u, by_v) with the distances. */
static void turn_into_gradient(const two_lines *l, double by_u, double by_v, double *gradient) {
  gradient[FG_MARK_X] = -(by_u * l->cosine[0] + by_v * l->cosine[1]);
  gradient[FG_MARK_Y] = -(by_u * l->sine[0] + by_v * l->sine[1]);
  gradient[FG_MARK_LEVEL] = 1;
  gradient[FG_MARK_SHAPE] = by_u * l->u_turn;
  gradient[FG_MARK_SHAPE + 1] = by_v * l->v_turn;
}

/* Two squares that meet in the corner, grown by the spread w of the ink: they cover
 * D = a b + c d, a, c = Phi((w +- u) / s), b, d = Phi((w +- v) / s), less the square of 2 w that
 * both cover, (a + c - 1) (b + d - 1); where w < 0 they do not meet, and nothing is less. */
static double chessboard_value(const double *p, double dx, double dy, double *gradient) {
  double contrast = p[FG_MARK_CONTRAST], s = p[FG_MARK_BLUR], w = p[FG_MARK_SHAPE + 2];
  two_lines l = lines_at(&p[FG_MARK_SHAPE], dx, dy);
  blurred_edge a = edge_at(w + l.u, s), c = edge_at(w - l.u, s);
  blurred_edge b = edge_at(w + l.v, s), d = edge_at(w - l.v, s);
  bool meet = w > 0;
  double by_a = meet ? 1 - d.share : b.share, by_b = meet ? 1 - c.share : a.share;
  double by_c = meet ? 1 - b.share : d.share, by_d = meet ? 1 - a.share : c.share;
  double both = meet ? (a.share + c.share - 1) * (b.share + d.share - 1) : 0;
  turn_into_gradient(&l, contrast * (by_a * a.slope - by_c * c.slope),
                     contrast * (by_b * b.slope - by_d * d.slope), gradient);
  gradient[FG_MARK_CONTRAST] = a.share * b.share + c.share * d.share - both;
  gradient[FG_MARK_BLUR] =
      contrast * (by_a * a.by_blur + by_b * b.by_blur + by_c * c.by_blur + by_d * d.by_blur);
  gradient[FG_MARK_SHAPE + 2] =
      contrast * (by_a * a.slope + by_b * b.slope + by_c * c.slope + by_d * d.slope);
  return p[FG_MARK_LEVEL] + contrast * gradient[FG_MARK_CONTRAST];
}

static double chessboard_distance(const double *p, double dx, double dy) {
  two_lines l = lines_at(&p[FG_MARK_SHAPE], dx, dy);
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

static double cross_value(const double *p, double dx, double dy, double *gradient) {
  double contrast = p[FG_MARK_CONTRAST], s = p[FG_MARK_BLUR], w = p[FG_MARK_SHAPE + 2];
  two_lines l = lines_at(&p[FG_MARK_SHAPE], dx, dy);
  blurred_stroke a = stroke_at(l.u, w, s), b = stroke_at(l.v, w, s);
  double by_a = 1 - b.share, by_b = 1 - a.share;
  turn_into_gradient(&l, contrast * by_a * a.slope, contrast * by_b * b.slope, gradient);
  gradient[FG_MARK_CONTRAST] = a.share + b.share - a.share * b.share;
  gradient[FG_MARK_BLUR] = contrast * (by_a * a.by_blur + by_b * b.by_blur);
  gradient[FG_MARK_SHAPE + 2] = contrast * (by_a * a.by_width + by_b * b.by_width);
  return p[FG_MARK_LEVEL] + contrast * gradient[FG_MARK_CONTRAST];
}

static double cross_distance(const double *p, double dx, double dy) {
  two_lines l = lines_at(&p[FG_MARK_SHAPE], dx, dy);
  return fmin(fabs(fabs(l.u) - p[FG_MARK_SHAPE + 2]), fabs(fabs(l.v) - p[FG_MARK_SHAPE + 2]));
}

static double line_value(const double *p, double dx, double dy, double *gradient) {
  double contrast = p[FG_MARK_CONTRAST], cosine = cos(p[FG_MARK_SHAPE]),
         sine = sin(p[FG_MARK_SHAPE]);
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

static double line_distance(const double *p, double dx, double dy) {
  double u = dx * cos(p[FG_MARK_SHAPE]) + dy * sin(p[FG_MARK_SHAPE]);
  return fabs(fabs(u) - p[FG_MARK_SHAPE + 1]);
}

static const fg_mark_model models[FG_MARK_KINDS] = {
    [FG_MARKS_DOTS] = {6, false, dot_value, dot_distance},
    [FG_MARKS_CHESSBOARD] = {8, false, chessboard_value, chessboard_distance},
    [FG_MARKS_CROSSES] = {8, false, cross_value, cross_distance},
    [FG_MARKS_LINES] = {7, true, line_value, line_distance},
};

const fg_mark_model *fg_mark_model_of(fg_mark_kind kind) {
  return &models[kind];
}
