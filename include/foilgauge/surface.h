/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Response surfaces: stationary point, optimum and ridge path of a fitted quadratic.
 *
 * The surface is y = b0 + b'x + x'Bx in the numeric factors of a model of degree two at most (Box
 * and Wilson 1951); factors of words keep a given level. All x are in the units that
 * the model was fitted in, usually coded ones; fg_coding_to_real translates.
 */
#ifndef FOILGAUGE_SURFACE_H
#define FOILGAUGE_SURFACE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/regression.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_SURFACE_FACTORS = 12 };

typedef enum fg_surface_kind {
  FG_SURFACE_MINIMUM,
  FG_SURFACE_MAXIMUM,
  FG_SURFACE_SADDLE,
  FG_SURFACE_RIDGE, /* an eigenvalue is negligible beside the largest: no single stationary point */
  FG_SURFACE_PLANE, /* no term of degree two */
} fg_surface_kind;

typedef struct fg_surface {
  size_t factors;
  size_t variable[FG_SURFACE_FACTORS]; /* index into the model's variables */
  double constant;
  double linear[FG_SURFACE_FACTORS];
  double quadratic[FG_SURFACE_FACTORS][FG_SURFACE_FACTORS]; /* symmetric */

  fg_surface_kind kind;
  bool has_stationary; /* not on a plane or a ridge */
  double stationary[FG_SURFACE_FACTORS], stationary_value;
  double eigenvalue[FG_SURFACE_FACTORS];                      /* descending */
  double eigenvector[FG_SURFACE_FACTORS][FG_SURFACE_FACTORS]; /* [k] belongs to eigenvalue[k] */
} fg_surface;

/* Reads from `setting`, one number per variable of the model's formula, only the levels of word
 * factors (index of the level); NULL: baselines. FG_ERR_USAGE for a degree above two, a transformed
 * number, no numeric factor or more than 12. */
fg_status fg_surface_make(fg_context *ctx, const fg_model *model, const fg_regression *regression,
                          const double *setting, fg_surface *surface);

double fg_surface_value(const fg_surface *surface, const double *x);

/* Finds the lowest (or highest) point of the box low <= x <= high, exactly: every face of the box
 * is searched for its own stationary point. A user's constraint (temperature below 700 °C) is a
 * smaller box. FG_ERR_USAGE for an empty box. */
fg_status fg_surface_optimum_box(fg_context *ctx, const fg_surface *surface, bool highest,
                                 const double *low, const double *high, double *x);

/* Finds the lowest (or highest) point of the ball |x| <= radius. */
fg_status fg_surface_optimum_ball(fg_context *ctx, const fg_surface *surface, bool highest,
                                  double radius, double *x);

enum { FG_REGION_PLANES = 16 };

/* Region of an optimum: the intersection of a box, a ball and half-spaces (convex). */
typedef struct fg_region {
  size_t factors;
  double low[FG_SURFACE_FACTORS], high[FG_SURFACE_FACTORS];
  double centre[FG_SURFACE_FACTORS], radius; /* INFINITY: no ball */
  double normal[FG_REGION_PLANES][FG_SURFACE_FACTORS], limit[FG_REGION_PLANES];
  size_t planes; /* normal·x <= limit */
} fg_region;

typedef enum fg_goal { FG_GOAL_LOWEST, FG_GOAL_HIGHEST, FG_GOAL_TARGET } fg_goal;

/* Returns true inside the region, or outside by no more than `tolerance` (in the unit of x). */
bool fg_region_contains(const fg_region *region, const double *x, double tolerance);
/* Moves x to the nearest point of the region (Dykstra 1983). FG_ERR_USAGE when the region is empty.
 */
fg_status fg_region_project(fg_context *ctx, const fg_region *region, double *x);
/* Writes point `index` of an even cover of the region: Halton's sequence over the box, projected.
 */
void fg_region_scatter(const fg_region *region, size_t index, double *x);
/* Writes the region in coordinates (x - centre) / scale: without a ball, half ranges of the
 * factors, whose units may differ by many powers of ten; with a ball, whose factors have one
 * unit, 1. */
void fg_region_scale(const fg_region *region, fg_region *scaled, double scale[FG_SURFACE_FACTORS]);
/* Finds the lowest or highest point of the surface in the region, or the point where it is nearest
 * to `target` (of several, the one nearest to the region's centre). Method: projected gradients
 * from the best of a fixed set of scattered points, so the result is reproducible. FG_ERR_USAGE
 * when the region is empty. */
fg_status fg_surface_optimum_region(fg_context *ctx, const fg_surface *surface, fg_goal goal,
                                    double target, const fg_region *region, double *x);

/* Finds the ridge path (Draper 1963): the best point on each sphere of radius radii[i] about the
 * centre; on a plane this is the path of steepest ascent or descent. `path` has room for count ×
 * factors. */
fg_status fg_surface_ridge_path(fg_context *ctx, const fg_surface *surface, bool highest,
                                const double *radii, size_t count, double *path);

#ifdef __cplusplus
}
#endif
#endif
