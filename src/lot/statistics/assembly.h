/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bearings drawn from the foils that a lot has: what a stock of foils would give.
 *
 * A bearing takes `pads` different foils, whole ones, for the bumps of a foil belong together.
 * Every foil goes back after it: the lot stands for the process that made it. Each draw of a
 * bearing and each pad of it has a seed of its own, so that one stock and another of as many foils
 * (a lot and the same lot changed) give the same draws.
 *
 * A share over N draws is doubtful in two ways, which are kept apart: there are N draws only
 * (Clopper and Pearson 1934, exact), and there are few foils. For the second the foils are drawn
 * anew, with replacement, and so are bearings of them (bootstrap; Efron 1979), the scatter of those
 * few bearings taken out: so many independent bearings would scatter as much, and the interval is
 * Clopper and Pearson's of those (Korn and Graubard 1998). Where sets show nothing, because all
 * bearings or none are within, it is that of foils / pads bearings: a share over all draws is known
 * no worse than over bearings that share no foil (Hoeffding 1948). In made lots of 4 to 60 foils
 * these intervals of 95 % held the truth in 88 to 100 %, plain quantiles of the sets in 82 to 93.
 */
#ifndef FG_LOT_STATISTICS_ASSEMBLY_H
#define FG_LOT_STATISTICS_ASSEMBLY_H

#include "foilgauge/bearing.h"
#include "foilgauge/quantity.h"

/* Clearances of `foils` foils at the `places` places of a pad, foil after foil; all are finite. */
typedef struct fg_stock {
  size_t foils, places;
  double *clearance_mm, *shared_mm, *own_mm; /* and their u, as in fg_bearing_uncertainty; owned */
} fg_stock;

fg_status fg_stock_allocate(fg_context *ctx, size_t foils, size_t places, fg_stock *stock);
fg_status fg_stock_copy(fg_context *ctx, const fg_stock *stock, fg_stock *copy);
void fg_stock_free(fg_stock *stock);

/* Requirement of a bearing: lower <= value <= upper. */
typedef struct fg_assembly_limit {
  const fg_quantity *row; /* of a bearing */
  double lower, upper;
  bool asked; /* a bearing beyond the limit does not count as assembled */
} fg_assembly_limit;

enum { FG_ASSEMBLY_LIMITS_MAX = 8, FG_ASSEMBLY_QUANTILES = 5, FG_ASSEMBLY_VALUES = 3 };

/* Probabilities of the quantiles; their quantities are circularity_mm, min_mm, centred_min_mm. */
extern const double fg_assembly_probability[FG_ASSEMBLY_QUANTILES];
const fg_quantity *fg_assembly_row(size_t value);

/* Limits of drawn bearings as evidence: a sentence for every report of them. */
extern const char fg_assembly_scope[];

typedef struct fg_assembly_plan {
  fg_bearing_layout layout;
  size_t bearings;
  uint64_t seed;
  double confidence;
  fg_assembly_limit limit[FG_ASSEMBLY_LIMITS_MAX];
  size_t limits;
} fg_assembly_plan;

/* Share of the drawn bearings. */
typedef struct fg_assembly_share {
  size_t count;
  double share;
  double draws_low, draws_high; /* interval by the number of draws */
  double foils_low, foils_high; /* interval by the number of foils; NaN: not asked */
  const char *foils_by;         /* way to that interval, in JSON; NULL: not asked */
  double surely, possibly;      /* shares: value ± U within the limit; not surely outside */
} fg_assembly_share;

/* Ways to the interval by the number of foils: resampling them, or, where that shows nothing, as
 * many bearings as they make. */
#define FG_ASSEMBLY_BY_BOOTSTRAP "bootstrap"
#define FG_ASSEMBLY_BY_BEARINGS  "independent bearings"

typedef struct fg_assembly_result {
  fg_assembly_share assembled;
  fg_assembly_share within[FG_ASSEMBLY_LIMITS_MAX];
  size_t rejected[FG_ASSEMBLY_LIMITS_MAX]; /* bearings that the limit rejects */
  size_t alone[FG_ASSEMBLY_LIMITS_MAX];    /* bearings that only this limit rejects */
  double quantile[FG_ASSEMBLY_VALUES][FG_ASSEMBLY_QUANTILES];
  double *value[FG_ASSEMBLY_VALUES]; /* known values of the bearings, ascending; owned */
  size_t values[FG_ASSEMBLY_VALUES]; /* number of known values */
} fg_assembly_result;

/* Draws bearings of different foils. FG_ERR_DATA for fewer foils than pads. `resample` adds the
 * intervals by the number of foils. */
fg_status fg_assembly_draw(fg_context *ctx, const fg_stock *stock, const fg_assembly_plan *plan,
                           bool resample, fg_assembly_result *result);
void fg_assembly_result_free(fg_assembly_result *result);

/* Counts the assembled bearings when the foils are sorted by mean clearance into `classes` boxes
 * and a bearing takes its foils from one box. */
fg_status fg_assembly_draw_sorted(fg_context *ctx, const fg_stock *stock,
                                  const fg_assembly_plan *plan, size_t classes, size_t *assembled);

/* Draws bearings of the design, with each place's clearance uniform within ± deviation. */
fg_status fg_assembly_draw_design(fg_context *ctx, double clearance_mm, double deviation_mm,
                                  const fg_assembly_plan *plan, fg_assembly_result *result);

/* Interval of Clopper and Pearson of a share; `count` may be fractional. */
void fg_assembly_interval(double count, double of, double confidence, double *low, double *high);

/* Picks the foils of the pads of draw `draw` from a stock of `foils`. */
void fg_assembly_pick(uint64_t seed, size_t draw, size_t foils, size_t pads, size_t *foil);

#endif
