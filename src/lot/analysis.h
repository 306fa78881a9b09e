/* Every number of a lot's report. */
#ifndef FG_LOT_ANALYSIS_H
#define FG_LOT_ANALYSIS_H

#include "foilgauge/capability.h"
#include "foilgauge/comparison.h"
#include "foilgauge/control.h"
#include "foilgauge/density.h"
#include "lot/report.h"

/* One foil of the lot. */
typedef struct fg_lot_foil {
  size_t item;         /* of the manifest */
  const fg_foil *foil; /* of its record */
  fg_verdict verdict;
  bool exceeded;    /* a value itself lies outside its tolerance */
  double severity;  /* the farthest value: 1 at its limit; without tolerances in sd of the lot */
  int worst_number; /* its bump; 0: the whole foil */
  const fg_report_field *worst_field;
  double worst_value;
} fg_lot_foil;

/* Mean and spread of one bump number. */
typedef struct fg_lot_place {
  size_t count;
  double mean, sd; /* NaN where there are too few */
} fg_lot_place;

/* One quantity over the lot. */
typedef struct fg_lot_quantity {
  const fg_report_field *field;
  fg_report_owner owner;
  const fg_tolerance *tolerance; /* NULL: none */
  double *value;                 /* what is known, foil by foil; owned */
  size_t count;
  size_t *size; /* values of each foil; owned */
  double mean, sd, least, most, median;
  fg_lot_place *place; /* by bump number - 1; owned */
  size_t places;
  bool has_density, has_chart, has_subgroups, has_capability;
  fg_density density;
  double mode;
  fg_chart chart; /* individuals: the mean of each foil */
  double chart_sigma;
  fg_chart means, deviations; /* subgroups: the bumps of each foil */
  double within_sigma;
  bool stable; /* no signal on the chart of individuals, nor on that of the deviations */
  fg_capability capability;
} fg_lot_quantity;

/* Radius and angle errors (thesis figure 5.8), trimmed. At constant arc length R alpha stays, so
 * ln(alpha / alpha_D) = -ln(R / R_D): the slope of the logarithms is -1 exactly. */
typedef struct fg_lot_correlation {
  size_t count, trimmed;
  double r;
  double slope, intercept;                       /* of the errors in percent, least squares */
  double log_slope, log_low, log_high;           /* of the logarithms, with its interval */
  double arc_length_mean_pct, arc_length_sd_pct; /* 100 (R alpha / R_D alpha_D - 1) */
} fg_lot_correlation;

typedef struct fg_lot_spread {
  size_t count;
  double mean, mode, sd, relative_sd_pct, least, most;
} fg_lot_spread;

/* Stiffness of the bumps over that of the design's. */
typedef struct fg_lot_stiffness {
  fg_arch_stiffness design_free, design_welded;
  fg_arch_sensitivity sensitivity;
  double *normalised; /* by bump of the lot in order of the quantity radius_mm; NaN; owned */
  fg_lot_spread measured;
  fg_lot_spread resampled; /* radius drawn from its density, arc length from its own */
  fg_lot_spread foot;      /* sideways stiffness of the feet over the design's, measured */
} fg_lot_stiffness;

typedef struct fg_lot_bearing {
  const char *name; /* of the column; NULL: assumed, three foils in a row */
  size_t number;
  const fg_lot_foil *pad[FG_BEARING_BUMPS_MAX]; /* layout.pads; NULL: missing */
  double angle_deg[FG_BEARING_BUMPS_MAX], clearance_mm[FG_BEARING_BUMPS_MAX];
  size_t places;
  bool known;
  fg_bearing_clearance clearance;
} fg_lot_bearing;

/* Two groups of the lot (dies, coils) in one quantity. */
typedef struct fg_lot_difference {
  const fg_lot_quantity *quantity;
  const char *a, *b;
  size_t count_a, count_b;
  double mean_a, mean_b, sd_a, sd_b;
  fg_comparison comparison;
} fg_lot_difference;

typedef struct fg_lot_gauge {
  const fg_lot_quantity *quantity;
  int bump; /* 0: the whole foil */
  fg_gauge_study study;
} fg_lot_gauge;

typedef struct fg_lot_analysis {
  const fg_lot *lot;
  fg_lot_foil *foils;
  size_t foil_count, failed_scans;
  size_t by_verdict[FG_VERDICT_NONE + 1], exceeded;
  fg_verdict verdict;
  const fg_lot_foil *worst[3];
  fg_lot_quantity *quantities;
  size_t quantity_count;
  bool has_correlation, has_stiffness;
  fg_lot_correlation correlation;
  fg_lot_stiffness stiffness;
  fg_lot_bearing *bearings;
  size_t bearing_count, bearing_capacity;
  fg_lot_spread clearance_pct; /* of the local clearance relative to the design's, in percent */
  fg_lot_difference *differences;
  size_t difference_count, difference_capacity;
  fg_lot_gauge *gauges;
  size_t gauge_count, gauge_capacity;
} fg_lot_analysis;

fg_status fg_lot_analyse(fg_context *ctx, const fg_lot *lot, fg_lot_analysis *analysis);
void fg_lot_analysis_free(fg_lot_analysis *analysis);

/* NULL when the lot has none of it. */
const fg_lot_quantity *fg_lot_find_quantity(const fg_lot_analysis *analysis, const char *name);

/* Parts of the analysis, each in its own file. */
fg_status fg_lot_analyse_quantities(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_stiffness(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_bearings(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_groups(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_gauge(fg_context *ctx, fg_lot_analysis *analysis);

/* Mean, sd, range of `count` finite values, and the mode of their density. */
fg_status fg_lot_spread_of(fg_context *ctx, const double *values, size_t count,
                           fg_bandwidth_rule rule, fg_lot_spread *spread);

#endif
