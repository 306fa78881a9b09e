/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every number of a lot's report. */
#ifndef FG_LOT_STATISTICS_ANALYSIS_H
#define FG_LOT_STATISTICS_ANALYSIS_H

#include "foilgauge/capability.h"
#include "foilgauge/comparison.h"
#include "foilgauge/control.h"
#include "foilgauge/density.h"
#include "foilgauge/stiffness.h"
#include "lot/input/recipe.h"
#include "lot/run/date.h"
#include "lot/run/lot.h"
#include "lot/statistics/assembly.h"
#include "quantity/parts.h"
#include "report/stiffness/table.h"

/* Foil of the lot. */
typedef struct fg_lot_foil {
  size_t item;         /* of the manifest */
  const fg_foil *foil; /* of its record */
  fg_verdict verdict;  /* as fg_foil_decide says */
  bool exceeded;       /* a value fails its tolerance */
  size_t owner;        /* first foil of the lot that is a scan of the same foil; mostly itself */
  bool again;          /* an earlier scan of the same foil was measured */
  bool row;            /* listed on the page */
  double severity;     /* of the worst value: 1 at its limit; without tolerances in sd of the lot */
  int worst_number;    /* number of the part with the worst value; 0: the whole foil */
  const fg_quantity *worst_row;
  double worst_value, worst_u;
  double worst_limit;  /* nearer limit; NaN: there is no tolerance */
  double worst_margin; /* distance to the limit; negative: beyond it; NaN: unknown */
} fg_lot_foil;

/* Cause of a chart's signals: groups of foils with a mean each. */
typedef struct fg_lot_cause {
  size_t column; /* of the manifest; FG_NO_COLUMN: none is known */
  size_t groups;
  const char *name[FG_LOT_GROUPS_MAX]; /* in order of appearance */
  double mean[FG_LOT_GROUPS_MAX];
  size_t foils[FG_LOT_GROUPS_MAX];
  double p_value;      /* p-value of groups with one mean */
  size_t signals_left; /* signals of the chart once all groups have one mean */
  bool in_turn;        /* foils of the groups alternate */
} fg_lot_cause;

/* A trend of a quantity over the order of the foils. */
typedef struct fg_lot_trend {
  bool known;                       /* distinguished from noise; else all is 0 */
  double per_foil, u_per_foil, dof; /* slope, its u and degrees of freedom */
  double correlation;         /* serial correlation of the residuals, for which u is widened */
  double first_to_last;       /* per_foil times the steps */
  double p_value;             /* p-value of no trend */
  size_t foils, signals_left; /* number of foils; signals of the chart without the trend */
} fg_lot_trend;

/* Mean and spread of the parts with one number over the foils. */
typedef struct fg_lot_place {
  size_t count;
  double mean, sd; /* NaN with too few values */
} fg_lot_place;

/* Standard uncertainty of the mean of a lot's values; NaN: unknown. */
typedef struct fg_lot_mean_u {
  double u_statistical, u_calibration, u;
} fg_lot_mean_u;

/* Quantity over the lot. */
typedef struct fg_lot_quantity {
  const fg_quantity *row;
  fg_quantity_owner owner;       /* the foil, or its parts */
  const fg_tolerance *tolerance; /* NULL: none */
  double *value;                 /* known values, foil by foil; owned */
  size_t count;
  size_t *size; /* number of values of each foil; owned */
  double mean, sd, min, max, median;
  fg_lot_mean_u mean_u;
  fg_lot_place *place; /* by number - 1 of the part; owned */
  size_t places;
  bool has_density, has_chart, has_subgroups, has_capability;
  fg_density density;
  double mode;
  fg_chart chart;                        /* chart of individuals: means of the foils */
  fg_chart means, deviations;            /* charts of subgroups: the parts of a foil */
  fg_chart_chance chance, spread_chance; /* of `chart` and of `deviations` */
  bool stable;        /* chance explains the charts of individuals and deviations */
  fg_lot_cause cause; /* cause of the signals of the chart of individuals */
  fg_lot_trend trend; /* sought where there are such signals */
  fg_capability capability;
} fg_lot_quantity;

/* Radius and angle errors (thesis figure 5.8), trimmed by the radius. At constant arc length R
 * alpha stays, so ln(alpha / alpha_D) = -ln(R / R_D): the slope of the logarithms is -1 exactly.
 * Its interval takes the bumps as they come, in foils (stats/cluster_line.h). */
typedef struct fg_lot_correlation {
  size_t count, trimmed, foils; /* `foils`: of the bumps of the lines */
  double r;
  double slope, intercept;             /* line of the errors in percent, by least squares */
  double log_slope, log_low, log_high; /* slope of the logarithms with its interval */
  double log_dof;                      /* dof of that interval; NaN: too few foils */
  double arc_length_mean_pct, arc_length_sd_pct; /* 100 (R alpha / R_D alpha_D - 1), all bumps */
} fg_lot_correlation;

typedef struct fg_lot_spread {
  size_t count;
  double mean, mode, sd, relative_sd_pct, min, max;
} fg_lot_spread;

/* Thickness of the strips. Its uncertainty comes mainly from the scanner's tone curve, which all
 * scans share: a mean of many foils is known no better than one. */
typedef struct fg_lot_thickness {
  size_t foils; /* foils with a thickness */
  fg_thickness mean;
  bool differs; /* differs from the design's by more than U */
} fg_lot_thickness;

/* Cause of the spread of stiffness: d ln K = sensitivity × d ln of the cause. */
typedef struct fg_lot_budget_term {
  double spread_pct, sensitivity; /* relative sd over the bumps; NaN: unknown */
  double variance_pct2;           /* variance of the stiffness from it: (spread × sensitivity)² */
  double share_pct;               /* share of the observed variance, 0 to 100; NaN: unknown */
} fg_lot_budget_term;

/* Sources of the relative sd of the stiffness (arch), to first order about the lot's mean:
 *   rsd² = (s_arc sigma_R)² + (s_alpha sigma_arc)² + 2 r s_arc sigma_R s_alpha sigma_arc
 *          + (s_t sigma_t)²,   s_t = 3 for slender bumps, r the correlation of R and arc length.
 * All scans share the uncertainty of the thickness: it belongs to the mean (u_by_thickness), not to
 * the budget.
 *
 * These terms do not add up where the causes are correlated or stiffness curves. The shares do. A
 * share is the variance that a cause adds to the part explained by a regression on the causes,
 * averaged over the orders in which they may enter (Lindeman, Merenda and Gold 1980). None is
 * negative, and with the rest they are 100 %. */
typedef struct fg_lot_budget {
  bool known;
  fg_lot_budget_term radius; /* at constant arc length */
  fg_lot_budget_term arc_length, thickness;
  double correlation, together_pct2; /* of radius and arc length; variance by it */
  double sum_pct2;                   /* sum of the known terms above */
  double observed_pct;               /* relative sd of the measured bumps */
  double unexplained_pct2; /* observed² - sum: curvature and causes without a measurement; may be
                              negative */
  double measurement_pct; /* part of the observed from the bumps' own uncertainties; NaN: unknown */
  double parts_pct;       /* rest of the observed without it */
  double rest_share_pct;  /* share of the observed variance that no cause explains */
} fg_lot_budget;

enum { FG_LOT_CASE_DESIGN, FG_LOT_CASE_MEAN, FG_LOT_CASES };

/* Stiffness of the bumps relative to the design's. */
typedef struct fg_lot_stiffness {
  fg_stiffness_case cases[FG_LOT_CASES]; /* one for each model; `mean` where there are bumps */
  fg_lot_spread by_model[FG_STIFFNESS_MODELS]; /* over the design's; count 0: unknown */
  fg_lot_budget budget;
  fg_arch_stiffness design_free, design_welded;
  fg_arch_sensitivity sensitivity;
  double *normalised; /* by bump of the lot, foil after foil, thickness as measured; NaN; owned */
  fg_lot_spread measured;
  fg_lot_spread at_design_thickness; /* same bumps, with the design's thickness */
  double u_by_thickness;   /* u of measured.mean from the thickness, which all foils share */
  double u_by_calibration; /* u of measured.mean from the calibration, thickness included */
  fg_lot_spread resampled; /* radius and arc length drawn from their densities */
  fg_lot_spread foot;      /* tangential stiffness of the feet over the design's, measured */
} fg_lot_stiffness;

typedef struct fg_lot_bearing {
  const char *name; /* from the column; NULL: assumed, three foils in a row */
  size_t number;
  const fg_lot_foil **pad; /* layout.pads; NULL: missing; owned */
  /* Angles and clearances of the foils fitted into the sleeve. NaN: no value, or of a crushed bump.
   */
  double *angle_deg, *clearance_mm, *u_clearance_mm; /* `places` each; owned: one block */
  size_t places;
  bool known;
  fg_bearing_clearance clearance;
  fg_decision decision; /* as fg_bearing_decide says; owned */
} fg_lot_bearing;

/* Sums over the bumps of a die's foils. */
typedef struct fg_lot_die_sum {
  const fg_lot_die *die; /* NULL: of all dies, with bumps and standard deviations alone */
  size_t foils, bumps, by_mean;
  double die_error_pct, u_die_error_pct; /* mean of the references relative to the design */
  double design_mean_pct, design_sd_pct; /* errors of the bumps against the design */
  double die_mean_pct, die_sd_pct;       /* errors of the bumps against the die */
  double explained_pct;                  /* share of design_mean that the die explains */
} fg_lot_die_sum;

typedef struct fg_lot_dies {
  fg_lot_die_sum sum[FG_LOT_DIES_MAX];
  size_t count;                  /* 0: the recipe names no die, or no foil has one */
  fg_lot_die_sum all;            /* sd: NaN with fewer than two bumps */
  double explained_variance_pct; /* percentage of the variance that the dies explain */
  /* With two dies: the difference of their foils (second minus first), of the dies, and its share.
   * NaN otherwise. */
  double foils_differ_pct, dies_differ_pct, explained_difference_pct;
} fg_lot_dies;

/* Foils that are in no bearing, by reason. */
typedef struct fg_lot_unplaced {
  size_t without;   /* the manifest names no bearing; of assumed bearings: the remainder */
  size_t displaced; /* the pad is occupied, or the bearing is full */
  size_t bad_pads;  /* pads that are no number from 1 to `pads`: the next free one was used */
} fg_lot_unplaced;

/* Reasons to leave a foil out of the drawn bearings. */
typedef enum fg_lot_left_out {
  FG_LOT_IN_STOCK,
  FG_LOT_NOT_MEASURED,
  FG_LOT_DEFECT,        /* fg_foil_defect */
  FG_LOT_FAILS,         /* fails its own tolerances */
  FG_LOT_FLAGGED,       /* flags make its values unreliable */
  FG_LOT_CRUSHED,       /* a bump is crushed */
  FG_LOT_NO_CLEARANCE,  /* fewer bumps than the layout asks for, or a bump without a value */
  FG_LOT_SCANNED_AGAIN, /* of several scans of a part the first usable one counts */
  FG_LOT_LEFT_OUT
} fg_lot_left_out;

/* Returns words for people: "crushed bump". */
const char *fg_lot_left_out_words(fg_lot_left_out why);

/* Change of one property of the lot, and the share of bearings that would assemble then. */
typedef struct fg_lot_change {
  const char *name;  /* in JSON */
  const char *words; /* for people: "the mean bump radius at the design's" */
  double share, gain;
  bool clear; /* changes the share by more than twice the scatter of the draws */
} fg_lot_change;

enum { FG_LOT_CHANGES_MAX = 4 };

typedef struct fg_lot_assembly {
  bool asked;    /* the recipe asks for drawn bearings */
  char why[200]; /* reason why nothing was drawn; "": bearings were drawn */
  size_t left_out[FG_LOT_LEFT_OUT];
  fg_lot_left_out *reason; /* by foil of the lot; owned */
  fg_stock stock;          /* owned */
  fg_assembly_plan plan;
  bool centred; /* the crowns surround the rotor, so that it has a place with most room */
  fg_assembly_result drawn, design;
  double clearance_mm, deviation_pct; /* of the design's bearings */
  fg_lot_change change[FG_LOT_CHANGES_MAX];
  size_t changes, classes; /* boxes of the sorted foils */
  char statement[3][400];
} fg_lot_assembly;

/* Tests of a pair of groups in one quantity. */
typedef enum fg_lot_group_test {
  FG_LOT_TEST_MEANS,     /* means of the foils, by Welch */
  FG_LOT_TEST_VARIANCES, /* variances of the foils, by F and relabelling */
  FG_LOT_TEST_LEVENE,    /* variances of the foils, by Levene and relabelling */
  FG_LOT_TEST_WITHIN,    /* spread of the parts within a foil: Welch of its logarithm */
  FG_LOT_GROUP_TESTS
} fg_lot_group_test;

/* Two groups of the lot (dies, coils) in one quantity. Foils are the unit
 * (lot/statistics/foil_levels.h): the parts of a foil share its strip, its heat and its die, and
 * are no independent values. */
typedef struct fg_lot_difference {
  const fg_lot_quantity *quantity;
  const char *a, *b;
  size_t count_a, count_b; /* values */
  size_t foils_a, foils_b;
  double mean_a, mean_b, sd_a, sd_b; /* of the foils' levels */
  double within_sd_a, within_sd_b;   /* sd of the parts within a foil; NaN: none */
  double p[FG_LOT_GROUP_TESTS];      /* p-value of each test alone; NaN: not made */
  double p_holm[FG_LOT_GROUP_TESTS]; /* p-values adjusted for all tests of the lot (Holm 1979) */
  fg_comparison comparison;          /* of the foils' levels */
} fg_lot_difference;

typedef struct fg_lot_gauge {
  const fg_lot_quantity *quantity;
  int number; /* of the part; 0: the whole foil */
  fg_gauge_study study;
} fg_lot_gauge;

/* State of the process in the quantities that the release of the lot rests on. */
typedef struct fg_lot_process {
  size_t watched, unstable;
  size_t explained; /* unstable ones whose signals groups explain entirely */
} fg_lot_process;

enum { FG_LOT_WORST = 3 };

typedef struct fg_lot_analysis {
  const fg_lot *lot;
  const char *folder;      /* folder of the report, to which links are relative; NULL: unknown */
  char *const *pages;      /* page of each item, from the folder; NULL: none; not owned */
  fg_quantity_owner parts; /* kind of the foils' parts */
  fg_lot_foil *foils;
  size_t foil_count, failed_scans;
  size_t scanned_again;    /* foils with `again` */
  fg_lot_finding repeated; /* scans with the bytes of an earlier one; among those that failed */
  fg_lot_date date;
  fg_lot_finding invalid_dates; /* cells of the manifest's column that are no date */
  size_t part_count;            /* parts of measured foils */
  size_t left_out;              /* parts left out of statistics, as crushed bumps and torn beams */
  size_t by_verdict[FG_VERDICT_NONE + 1], exceeded; /* foils */
  fg_report_outcome outcome;                        /* of all foils, scans and bearings */
  const fg_lot_foil *worst[FG_LOT_WORST];
  fg_lot_quantity *quantities;
  size_t quantity_count;
  fg_lot_process process;
  bool has_correlation, has_stiffness;
  fg_lot_correlation correlation;
  fg_lot_thickness thickness;
  fg_lot_stiffness stiffness;
  fg_bearing_layout layout; /* layout in force: the recipe's, completed by the design's */
  char layout_note[400];    /* contradiction of the layout and the design; "": none */
  fg_lot_bearing *bearings;
  size_t bearing_count, bearing_capacity;
  fg_lot_unplaced unplaced;
  size_t bearings_by_verdict[FG_VERDICT_NONE + 1];
  fg_lot_assembly assembly;
  /* Film of bearings drawn from the stock (film/lot_film.h, who frees it); NULL: not asked, or
   * `film_why` says why there is none. */
  struct fg_film_report *film;
  char film_why[300];
  /* Local clearance relative to the design's, percent: of free foils, and of foils fitted into the
   * sleeve. */
  fg_lot_spread clearance_pct, clearance_fitted_pct;
  fg_lot_difference *differences;
  size_t difference_count;
  size_t group_tests, group_tests_differ; /* tests made, and tests whose adjusted p-value differs */
  fg_lot_dies dies;
  fg_lot_gauge *gauges;
  size_t gauge_count, gauge_capacity;
} fg_lot_analysis;

fg_status fg_lot_analyse(fg_context *ctx, const fg_lot *lot, fg_lot_analysis *analysis);
void fg_lot_analysis_free(fg_lot_analysis *analysis);

/* Damaged bumps and beams (crushed, torn, bent) are judged as every other, but left out of
 * statistics, stiffness and clearances: they show the damage, not the process. So are the bumps of
 * foils that are not of the design. */
enum { FG_LOT_BEAM_DAMAGED = FG_BEAM_NOT_FITTED | FG_BEAM_TORN_TIP | FG_BEAM_BENT };
bool fg_lot_bump_counts(const fg_foil *foil, const fg_bump *bump);
bool fg_lot_part_counts(const fg_foil *foil, fg_quantity_owner owner, const fg_foil_part *part);
/* Number of a part for statistics by number; 0 where the foil does not tell which of its places are
 * empty. */
int fg_lot_part_number(const fg_foil *foil, const fg_foil_part *part);

/* Words for the parts of a lot's foils. */
typedef struct fg_lot_words {
  const char *one, *many;             /* "bump", "bumps"; members of JSON and CSV, too */
  const char *counted;                /* "Bumps measured" */
  const char *how;                    /* state of those left out: "crushed" */
  const char *damaged, *json_damaged; /* "Crushed bumps", "bumps_crushed" */
  const char *json_worst;             /* "worst_bump" */
  const char *numbers;                /* numbering, in words */
  const char *before_number;          /* of a part, after the words of its quantity */
  const char *mean;                   /* name of a foil's mean: "foil (mean of its bumps)" */
} fg_lot_words;

const fg_lot_words *fg_lot_words_of(const fg_lot_analysis *analysis);

/* Clearance over a bump of the foil fitted into the sleeve; NaN where no such bump counts. Its u is
 * split into the part that all foils share and the rest. */
typedef struct fg_lot_clearance {
  double mm, u_shared_mm, u_own_mm;
} fg_lot_clearance;
fg_lot_clearance fg_lot_clearance_of(const fg_lot_analysis *analysis, const fg_lot_foil *foil,
                                     int number);

/* Finds for each foil i the foil owner[i] of the lot that it is a scan of; itself where no part is
 * named. */
fg_status fg_lot_find_owners(fg_context *ctx, const fg_lot_analysis *analysis, size_t *owner);

/* Limits of the arch model for this lot's kind of foil, in words; NULL: none. */
const char *fg_lot_stiffness_note(const fg_lot_analysis *analysis);

bool fg_lot_foil_is_good(const fg_lot_foil *foil);

/* Returns the first quantity of the parts with a tolerance, else the leading one of this kind of
 * foil; NULL: none. */
const fg_lot_quantity *fg_lot_leading_quantity(const fg_lot_analysis *analysis);

/* Returns NULL when the lot has no such quantity. */
const fg_lot_quantity *fg_lot_find_quantity(const fg_lot_analysis *analysis, const char *name);

/* Returns true when the release of the lot rests on the quantity, or when groups explain all its
 * signals. */
/* Seeks a trend. It is known where noise alone makes one with a probability below `level`. */
fg_status fg_lot_find_trend(fg_context *ctx, unsigned rules, double level,
                            fg_lot_quantity *quantity);

/* Returns true when both are known and the trend leaves fewer signals than the groups do. */
bool fg_lot_is_trend(const fg_lot_quantity *quantity);
bool fg_lot_is_watched(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);
bool fg_lot_is_explained(const fg_lot_quantity *quantity);
/* Returns true when there is no chart, or too few foils for a signal and none. */
bool fg_lot_is_uninformative(const fg_lot_quantity *quantity);

/* Names of the quantities whose charts are drawn where none has a tolerance; ends with NULL. */
extern const char *const fg_lot_charted[];

/* Returns the largest correction of the foils by the scanner's model; NaN: there is none. */
fg_correction fg_lot_correction_largest(const fg_lot_analysis *analysis);

/* Number of foils listed on the page: those that do not pass come first. */
enum { FG_LOT_FOIL_ROWS_MAX = 300 };

/* Parts of the analysis, each in a file of its own. */
fg_status fg_lot_analyse_quantities(fg_context *ctx, fg_lot_analysis *analysis);
/* Level at which a chart's signals are more than chance explains, percent, and as text. */
#define FG_LOT_CHART_LEVEL_PCT       1
#define FG_LOT_CHART_TEXT_OF(number) #number
#define FG_LOT_CHART_AS_TEXT(number) FG_LOT_CHART_TEXT_OF(number)
#define FG_LOT_CHART_LEVEL_TEXT      FG_LOT_CHART_AS_TEXT(FG_LOT_CHART_LEVEL_PCT)

/* Fills the charts of a quantity whose values and sizes are known, and whether it is stable; where
 * it has a tolerance and a chart, also its capability, which needs `sd`. */
fg_status fg_lot_chart_quantity(fg_context *ctx, unsigned rules, size_t foils,
                                fg_lot_quantity *quantity);
fg_status fg_lot_judge_capability(fg_context *ctx, double confidence, size_t foils,
                                  fg_lot_quantity *quantity);
/* Widens the intervals of Ppk and Cpk by the error that all values share: the scatter of foils does
 * not show it, and it moves their mean against the limits. u: its standard uncertainty; NaN: it has
 * no bound. */
void fg_lot_widen_capability(double confidence, double u, fg_lot_quantity *quantity);
/* Finds causes of the charts' signals, and the state of the process as a whole. */
fg_status fg_lot_analyse_causes(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_analyse_dies(fg_lot_analysis *analysis);
fg_status fg_lot_analyse_correlation(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_analyse_thickness(fg_lot_analysis *analysis);
fg_status fg_lot_analyse_stiffness(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_find_layout(fg_lot_analysis *analysis);
fg_status fg_lot_analyse_bearings(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_assembly(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_assembly_free(fg_lot_assembly *assembly);
void fg_lot_summarise_assembly(fg_lot_analysis *analysis); /* fills the statements */
fg_status fg_lot_analyse_groups(fg_context *ctx, fg_lot_analysis *analysis);
/* Returns true when an adjusted p-value lies below 1 - confidence of the recipe. */
bool fg_lot_group_differs(const fg_lot_analysis *analysis, double p_holm);
fg_status fg_lot_analyse_gauge(fg_context *ctx, fg_lot_analysis *analysis);

/* Computes mean, sd and range of `count` finite values, and the mode of their density. */
fg_status fg_lot_find_spread(fg_context *ctx, const double *values, size_t count,
                             fg_bandwidth_rule rule, fg_lot_spread *spread);
/* The same, and leaves the density, which the caller frees; count 0: the values do not scatter. */
fg_status fg_lot_find_spread_and_density(fg_context *ctx, const double *values, size_t count,
                                         fg_bandwidth_rule rule, fg_lot_spread *spread,
                                         fg_density *density);

/* Finds the uncertainty of the means of all quantities. Statistical errors average out over the
 * foils; the error of the calibration is the same in each and does not. */
void fg_lot_find_mean_u(fg_lot_analysis *analysis);

/* Returns the relative u of the mean stiffness from the calibration. */
double fg_lot_stiffness_calibration(const fg_lot_analysis *analysis);

enum { FG_LOT_WORDS_MAX = 4096 };

/* Distinct cells of a column in order of appearance; the words belong to the manifest. */
typedef struct fg_manifest_words {
  const char *word[FG_LOT_WORDS_MAX];
  size_t count;
} fg_manifest_words;

/* Returns the index of the word, which is added if new; FG_LOT_WORDS_MAX when there is no room. */
size_t fg_manifest_word_index(fg_manifest_words *words, const char *word);

/* Lists the distinct cells of the lot's foils that are not empty. */
void fg_lot_list_words(const fg_lot_analysis *analysis, size_t column, fg_manifest_words *words);

#endif
