/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `points`: the residuals of all arcs and lands of one or more scans, against one geometry.
 *
 * Geometry of a foil, in its own frame (origin in the overall centre): R0, and for each bump the
 * distance X and direction beta of its centre and its radius R. A scan of it adds a pose: O and,
 * from the second scan on, a turn. Scans of one foil share the geometry; that is what tells the
 * scanner (it stays with the glass) from the part (it turns with the foil).
 *
 * Rows are means over FG_EDGE_FIT_BLOCK stations: the search's rows must be few and nearly
 * independent, and no effect is shorter.
 */
#ifndef FG_ROWS_EDGE_FIT_H
#define FG_ROWS_EDGE_FIT_H

#include <math.h>

#include "field/field.h"
#include "foilgauge/foil.h"

enum { FG_EDGE_FIT_BLOCK = 4 };
/* A block is a row when this share of its stations is usable. */
#define FG_EDGE_FIT_BLOCK_SHARE 0.75

/* One foil or disc on one scan. */
typedef struct fg_edge_fit_view {
  const fg_foil *foil;
  const fg_disc *disc; /* in a foil's place; NULL: a foil */
  const fg_measurement *measurement;
  size_t scan;   /* which input */
  size_t part;   /* which physical foil; views of one part share its geometry */
  bool held_out; /* of a scan that only confirms */
} fg_edge_fit_view;

/* One row. */
typedef struct fg_edge_fit_row {
  size_t view, part;
  int bump;          /* number; 0: a land */
  size_t bump_index; /* in the part's bumps */
  size_t group;      /* bump of a part, land of a view */
  fg_point at;       /* nominal position of the datum line, mm of the scan */
  fg_point ideal;    /* on its circle: columns of fields are taken there. Anywhere else a dilation
                        of the picture, which the geometry follows, leaves the residual itself */
  double half_width_mm;
  double spread_mm;  /* sd of the places along the edge that the row is a mean of */
  double s_mm;       /* along the foil, from the lip's side */
  double phi;        /* place in the arc, -1 to 1, towards higher numbers; a bump's from its axis
                        and in units of the part's mean arc: where labels end is no place */
  double psi;        /* direction from O, from the foil's middle towards the free end, rad */
  double normal_rad; /* direction of the outward normal of the residual in the scan */
  fg_point normal;   /* that normal; outwards from the arc's own centre */
  fg_point radial;   /* from O outwards */
  double weight;     /* stations in the mean */
} fg_edge_fit_row;

typedef struct fg_edge_fit_bump {
  int number;
  double distance_mm, direction_rad, radius_mm; /* X, beta, R */
} fg_edge_fit_bump;

typedef struct fg_edge_fit_part {
  double overall_radius_mm;
  fg_edge_fit_bump *bumps; /* owned */
  size_t bump_count;
  double sense;          /* +1: numbers rise with the angle (clockwise as seen) */
  double middle_rad;     /* beta of the foil's middle */
  double half_arc_rad;   /* mean over the bumps of half the arc that is used */
  double mean_radius_mm; /* of the bumps, as measured */
  size_t arcs;
  double half_span_rad;
  double end_to_end_rad; /* the strip as O sees it; 0: not known */
  bool radius_known;     /* the overall radius is a gauge's and is not fitted */
} fg_edge_fit_part;

typedef struct fg_edge_fit_pose {
  fg_point origin_mm; /* O */
  double turn_rad;    /* 0 in a part's first view */
} fg_edge_fit_pose;

/* Noise along an arc (rows/scatter.h). */
typedef enum fg_scatter_model { FG_SCATTER_GAUSSIAN, FG_SCATTER_EXPONENTIAL } fg_scatter_model;
typedef struct fg_scatter {
  double share; /* of a row's variance that neighbours have in common; 0: rows are independent */
  double range_mm;
  fg_scatter_model model;
  double row_um;   /* standard deviation of a row that is a mean of a whole block */
  double integral; /* of the correlation along the edge: noise in n rows averages like that in n
                      over it */
  double swell;    /* noise of long waves over what share, range and form say of it: at least 1 */
  double dof;      /* that the noise of long waves is known with; 0: exactly */
} fg_scatter;

typedef struct fg_edge_fit {
  fg_edge_fit_view *views; /* owned */
  fg_edge_fit_pose *poses; /* owned; one per view */
  size_t view_count;
  fg_edge_fit_part *parts; /* owned */
  size_t part_count;
  fg_edge_fit_row *rows; /* owned */
  size_t row_count, row_capacity;
  size_t group_count;
  fg_field_frame frame; /* the picture all fields live in */
  double psi_rad[2];    /* range of the rows' psi */
  size_t parameters;    /* of the geometry */
  bool coarse;          /* searches are a quick look */
  bool discs;           /* parts are discs: an overall circle each, and nothing else */
  size_t known_count;   /* parts whose radius is known */
  fg_scatter scatter;   /* as it was found last */
} fg_edge_fit;

/* Rows and a start of the geometry from measured foils. Views of one part must have the same bumps
 * (by number) and the same hand: FG_ERR_DATA. Foils that were not measured are left out. Views are
 * all of foils or all of discs. */
fg_status fg_edge_fit_build(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                            fg_edge_fit *edge_fit);

void fg_edge_fit_free(fg_edge_fit *edge_fit);

/* A copy with those rows alone that `keep` says (NULL: all), and with all of the geometry. What
 * views point to is shared. */
fg_status fg_edge_fit_subset(fg_context *ctx, const fg_edge_fit *edge_fit, const bool *keep,
                             fg_edge_fit *subset);

/* The same for foils, and for discs; fg_edge_fit_build calls them. */
fg_status fg_edge_fit_build_foils(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit);
fg_status fg_edge_fit_build_discs(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit);

fg_status fg_edge_fit_add_row(fg_context *ctx, fg_edge_fit *edge_fit, const fg_edge_fit_row *row);
/* The frame of the fields, from the pictures. */
void fg_edge_fit_find_frame(fg_edge_fit *edge_fit);
/* The parameters of the geometry, from views and parts. */
void fg_edge_fit_count_parameters(fg_edge_fit *edge_fit);

/* Corrections in force: fields of the scanner, and shifts of the midline in the part's frame
 * (`shift_mm`, one per row along the row's normal; NULL: none). */
typedef struct fg_edge_fit_correction {
  const fg_field_list *fields;
  const double *shift_mm;
} fg_edge_fit_correction;

/* The places whose mean a row sees of a field: both edges of the strip, and on each two places
 * along it, `spread_mm` to either side, which stand for its length and the blur to second order. */
enum { FG_EDGE_FIT_PLACES = 4 };
void fg_edge_fit_places(const fg_edge_fit_row *row, fg_point middle,
                        fg_point at[FG_EDGE_FIT_PLACES]);

/* Residual of every row (mm, along its normal, outwards positive) and, unless NULL, its Jacobian
 * by the geometry (parameters × row_count). Updates the rows' normals. */
void fg_edge_fit_residual(fg_edge_fit *edge_fit, const fg_edge_fit_correction *correction,
                          double *residual, double *jacobian);

/* Parameters that a row's residual depends on, ascending; returns how many. */
enum { FG_EDGE_FIT_ROW_PARAMETERS = 7 };
size_t fg_edge_fit_row_parameters(const fg_edge_fit *edge_fit, size_t row,
                                  size_t parameter[FG_EDGE_FIT_ROW_PARAMETERS]);

/* A place along x (axis 0) or y (1). */
static inline double fg_point_along(fg_point at, int axis) {
  return axis ? at.y : at.x;
}

/* Place along the row of bumps: its number, and beside it the place in its arc; NaN on a land. */
static inline double fg_edge_fit_along_bumps(const fg_edge_fit_row *row) {
  const double half = 0.45; /* of the way to the next one */
  return row->bump ? row->bump + half * row->phi : NAN;
}

/* Integral of the correlation of values along the edge, at least 1: noise in n rows averages like
 * that in n over it. `row` (NULL: all) are the rows that the values are of, ascending. */
double fg_edge_fit_integral(const fg_edge_fit *edge_fit, const size_t *row, size_t count,
                            const double *value);

/* Least squares of the geometry under a correction, Gauss-Newton to convergence. */
fg_status fg_edge_fit_fit(fg_context *ctx, fg_edge_fit *edge_fit,
                          const fg_edge_fit_correction *correction);

/* The geometry's numbers, to come back to: fg_edge_fit_geometry_size doubles. */
size_t fg_edge_fit_geometry_size(const fg_edge_fit *edge_fit);
void fg_edge_fit_geometry_save(const fg_edge_fit *edge_fit, double *numbers);
void fg_edge_fit_geometry_load(fg_edge_fit *edge_fit, double *numbers);

/* Name of a geometry parameter, for reports; `name` holds 48 bytes. */
void fg_edge_fit_parameter_name(const fg_edge_fit *edge_fit, size_t parameter, char *name);

#endif
