/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge fit: the residuals of all arcs and lands of one or more scans against one geometry (level
 * `points` of reports).
 *
 * Geometry of a foil, in its own frame (origin in the overall centre): R0, and for each bump the
 * distance X and direction beta of its centre and its radius R. A scan of it adds a pose: O and,
 * from the second scan on, a turn. Scans of one foil share the geometry. That separates the
 * scanner, whose effects stay with the glass, from the part, whose effects turn with the foil.
 *
 * Rows are means over FG_EDGE_FIT_BLOCK stations: the search needs few and nearly independent rows,
 * and no effect is shorter. */
#ifndef FG_ROWS_EDGE_FIT_H
#define FG_ROWS_EDGE_FIT_H

#include <math.h>

#include "field/field.h"
#include "foilgauge/foil.h"

enum { FG_EDGE_FIT_BLOCK = 4 };
/* Share of usable stations from which a block is a row. */
#define FG_EDGE_FIT_BLOCK_SHARE 0.75

/* One foil or disc on one scan. */
typedef struct fg_edge_fit_view {
  const fg_foil *foil;
  const fg_disc *disc; /* for a disc; NULL: a foil */
  const fg_measurement *measurement;
  size_t scan;   /* index of the input */
  size_t part;   /* index of the physical foil; views of one part share its geometry */
  bool held_out; /* of a held-out scan, which only confirms */
} fg_edge_fit_view;

/* Mean of a block of stations. */
typedef struct fg_edge_fit_row {
  size_t view, part;
  int bump;          /* number; 0: a land */
  size_t bump_index; /* index into the part's bumps */
  size_t group;      /* index of the bump of a part, or of the land of a view */
  fg_point at;       /* nominal position of the datum line, mm of the scan */
  fg_point ideal; /* on its circle: columns of fields are evaluated there. At the measured place a
                     dilation of the picture, which the geometry follows, would leave the residual
                     itself */
  double half_width_mm;
  double spread_mm; /* sd of the row's stations along the edge */
  double s_mm;      /* along the foil, from the lip's side */
  double phi; /* place in the arc, -1 to 1, towards higher numbers; of a bump from its axis and in
                 units of the part's mean arc, because the ends of labels are no reference */
  double psi; /* direction from O, from the foil's middle towards the free end, rad */
  double normal_rad; /* direction of the outward normal of the residual in the scan */
  fg_point normal;   /* that normal as a vector; outward from the arc's own centre */
  fg_point radial;   /* outward from O */
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
  double sense;          /* +1: numbers increase with the angle (clockwise in the picture) */
  double middle_rad;     /* beta of the foil's middle */
  double half_arc_rad;   /* mean over the bumps of half the usable arc */
  double mean_radius_mm; /* of the bumps, as measured */
  size_t arcs;
  double half_span_rad;
  double end_to_end_rad;  /* end-to-end angle of the strip about O; 0: unknown */
  double known_radius_mm; /* a gauge's; 0: not known */
  bool radius_known;      /* the overall radius is held at the gauge's and is not fitted */
} fg_edge_fit_part;

typedef struct fg_edge_fit_pose {
  fg_point origin_mm; /* O */
  double turn_rad;    /* 0 in a part's first view */
} fg_edge_fit_pose;

/* Noise along an arc (rows/scatter.h). */
typedef enum fg_scatter_model { FG_SCATTER_GAUSSIAN, FG_SCATTER_EXPONENTIAL } fg_scatter_model;
typedef struct fg_scatter {
  double
      share; /* share of a row's variance that is common to neighbours; 0: rows are independent */
  double range_mm;
  fg_scatter_model model;
  double row_um;   /* standard deviation of a row that is a mean of a whole block */
  double integral; /* integral of the correlation along the edge: the mean of n rows has the noise
                      of n / integral independent ones */
  double swell;    /* ratio of the noise of long waves to the model's: at least 1 */
  double dof;      /* dof of the noise of long waves; 0: exactly known */
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
  fg_field_frame frame; /* common frame of all fields */
  double psi_rad[2];    /* range of the rows' psi */
  size_t parameters;    /* of the geometry */
  bool coarse;          /* searches are fast (few starts) */
  unsigned threads;     /* of a search on these rows; 0: one for each core */
  bool proposes;        /* the search proposes, evidence decides (scan_loop/evidence.c) */
  const char *left_out; /* ids of effects that no search looks for, with commas; NULL: none */
  bool discs;           /* parts are discs: one circle each */
  size_t known_count;   /* number of parts of known radius */
  double gauge_um;    /* standard deviation of known radii that are not held: the joint fit's prior;
                         0: none */
  fg_scatter scatter; /* as found last */
} fg_edge_fit;

/* Builds rows and a start of the geometry from measured foils. Views of one part must have the same
 * bumps (by number) and the same sense: FG_ERR_DATA. Foils without measurement are left out. Views
 * are all of foils or all of discs. */
fg_status fg_edge_fit_build(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                            fg_edge_fit *edge_fit);

void fg_edge_fit_free(fg_edge_fit *edge_fit);

/* Copies an edge fit with the rows that `keep` selects (NULL: all) and the whole geometry. Objects
 * that views point to are shared. */
fg_status fg_edge_fit_subset(fg_context *ctx, const fg_edge_fit *edge_fit, const bool *keep,
                             fg_edge_fit *subset);

/* As fg_edge_fit_build, which calls them, for foils and for discs. */
fg_status fg_edge_fit_build_foils(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit);
fg_status fg_edge_fit_build_discs(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                                  fg_edge_fit *edge_fit);

fg_status fg_edge_fit_add_row(fg_context *ctx, fg_edge_fit *edge_fit, const fg_edge_fit_row *row);
/* Finds the frame of the fields from the pictures. */
void fg_edge_fit_find_frame(fg_edge_fit *edge_fit);
/* Counts the parameters of the geometry of views and parts. */
void fg_edge_fit_count_parameters(fg_edge_fit *edge_fit);

/* Correction in force: fields of the scanner, and shifts of the midline in the part's frame
 * (`shift_mm`, one per row along the row's normal; NULL: none). */
typedef struct fg_edge_fit_correction {
  const fg_field_list *fields;
  const double *shift_mm;
} fg_edge_fit_correction;

/* Number of places at which a row samples a field: on each edge of the strip two places,
 * `spread_mm` to either side along it, which represent the row's length and the blur to second
 * order. */
enum { FG_EDGE_FIT_PLACES = 4 };
void fg_edge_fit_places(const fg_edge_fit_row *row, fg_point middle,
                        fg_point at[FG_EDGE_FIT_PLACES]);

/* Computes the residual of every row (mm, along its normal, outward positive) and, unless NULL, its
 * Jacobian by the geometry (parameters × row_count). Updates the rows' normals. */
void fg_edge_fit_residual(fg_edge_fit *edge_fit, const fg_edge_fit_correction *correction,
                          double *residual, double *jacobian);

/* Lists the parameters that a row's residual depends on, ascending; returns their number. */
enum { FG_EDGE_FIT_ROW_PARAMETERS = 7 };
size_t fg_edge_fit_row_parameters(const fg_edge_fit *edge_fit, size_t row,
                                  size_t parameter[FG_EDGE_FIT_ROW_PARAMETERS]);

/* Returns the component of a place along x (axis 0) or y (1). */
static inline double fg_point_along(fg_point at, int axis) {
  return axis ? at.y : at.x;
}

/* Returns the place along the row of bumps: the number plus a fraction for the place in the arc;
 * NaN on a land. */
static inline double fg_edge_fit_along_bumps(const fg_edge_fit_row *row) {
  const double half = 0.45; /* of the distance to the next bump */
  return row->bump ? row->bump + half * row->phi : NAN;
}

/* Returns the integral of the correlation of values along the edge, at least 1: the mean of n rows
 * has the noise of n / integral independent ones. `row` (NULL: all) are the rows of the values,
 * ascending. */
double fg_edge_fit_integral(const fg_edge_fit *edge_fit, const size_t *row, size_t count,
                            const double *value);

/* Returns the sum of squares of residuals, each by its row's weight. */
double fg_edge_fit_weighted_square(const fg_edge_fit *edge_fit, const double *residual);

/* Fits the geometry under a correction by least squares, Gauss-Newton to convergence. */
fg_status fg_edge_fit_fit(fg_context *ctx, fg_edge_fit *edge_fit,
                          const fg_edge_fit_correction *correction);

/* Holds known radii at those of the gauges, or lets the fit find them. */
void fg_edge_fit_hold_radii(fg_edge_fit *edge_fit, bool hold);

/* Saves and restores the geometry's numbers: fg_edge_fit_geometry_size doubles. */
size_t fg_edge_fit_geometry_size(const fg_edge_fit *edge_fit);
void fg_edge_fit_geometry_save(const fg_edge_fit *edge_fit, double *numbers);
void fg_edge_fit_geometry_load(fg_edge_fit *edge_fit, double *numbers);

#endif
