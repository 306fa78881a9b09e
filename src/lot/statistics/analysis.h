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
#include "lot/run/lot.h"
#include "lot/statistics/assembly.h"
#include "quantity/parts.h"
#include "report/stiffness/table.h"

/* One foil of the lot. */
typedef struct fg_lot_foil {
  size_t item;         /* of the manifest */
  const fg_foil *foil; /* of its record */
  fg_verdict verdict;  /* fg_foil_decide's */
  bool exceeded;       /* a value fails */
  bool row;            /* the page's list has a line of it */
  double severity;     /* the farthest value: 1 at its limit; without tolerances in sd of the lot */
  int worst_number;    /* of its part; 0: the whole foil */
  const fg_quantity *worst_row;
  double worst_value, worst_u;
  double worst_limit;  /* the nearer one; NaN: there is no tolerance */
  double worst_margin; /* how far the value is within it; negative: beyond it; NaN */
} fg_lot_foil;

/* What a chart's signals come from: foils of groups that have a mean of their own. */
typedef struct fg_lot_cause {
  size_t column; /* of the manifest; FG_NO_COLUMN: none is known */
  size_t groups;
  const char *name[FG_LOT_GROUPS_MAX]; /* in order of appearance */
  double mean[FG_LOT_GROUPS_MAX];
  size_t foils[FG_LOT_GROUPS_MAX];
  double p_value;      /* of groups that are alike */
  size_t signals_left; /* of the same chart with all groups moved to one mean */
  bool in_turn;        /* one foil of each group after the other */
} fg_lot_cause;

/* A trend of a quantity over the order of the foils. */
typedef struct fg_lot_trend {
  bool known;                       /* told from noise; else all is 0 */
  double per_foil, u_per_foil, dof; /* slope, its u and degrees of freedom */
  double correlation;               /* of neighbours beside it, for which u is widened */
  double p_value;                   /* of no trend */
  size_t foils, signals_left;       /* of the same chart without the trend */
} fg_lot_trend;

/* Mean and spread of one bump (or other part) of the foils, by its number. */
typedef struct fg_lot_place {
  size_t count;
  double mean, sd; /* NaN where there are too few */
} fg_lot_place;

/* One quantity over the lot. */
typedef struct fg_lot_quantity {
  const fg_quantity *row;
  fg_quantity_owner owner;       /* the foil, or the parts of the form */
  const fg_tolerance *tolerance; /* NULL: none */
  double *value;                 /* what is known, foil by foil; owned */
  size_t count;
  size_t *size; /* values of each foil; owned */
  double mean, sd, min, max, median;
  fg_lot_place *place; /* by number of the part - 1; owned */
  size_t places;
  bool has_density, has_chart, has_subgroups, has_capability;
  fg_density density;
  double mode;
  fg_chart chart; /* individuals: the mean of each foil */
  double chart_sigma;
  fg_chart means, deviations; /* subgroups: the parts of each foil */
  double within_sigma;
  bool stable;        /* no signal on the chart of individuals, nor on that of the deviations */
  fg_lot_cause cause; /* of the signals of the chart of individuals */
  fg_lot_trend trend; /* looked for where there are such signals */
  fg_capability capability;
} fg_lot_quantity;

/* Radius and angle errors (thesis figure 5.8), trimmed by the radius. At constant arc length R
 * alpha stays, so ln(alpha / alpha_D) = -ln(R / R_D): the slope of the logarithms is -1 exactly.
 * Its interval takes the bumps as they come, in foils (stats/cluster_line.h). */
typedef struct fg_lot_correlation {
  size_t count, trimmed, foils; /* foils: that the bumps of the lines come from */
  double r;
  double slope, intercept;                       /* of the errors in percent, least squares */
  double log_slope, log_low, log_high;           /* of the logarithms, with its interval */
  double log_dof;                                /* of that interval; NaN: the foils are too few */
  double arc_length_mean_pct, arc_length_sd_pct; /* 100 (R alpha / R_D alpha_D - 1), all bumps */
} fg_lot_correlation;

typedef struct fg_lot_spread {
  size_t count;
  double mean, mode, sd, relative_sd_pct, min, max;
} fg_lot_spread;

/* The strips' thickness. Its doubt is the scanner's tone curve for the most part, the same in every
 * scan: a mean of many foils is no better known than one. */
typedef struct fg_lot_thickness {
  size_t foils; /* that have one */
  fg_thickness mean;
  bool differs; /* from the design's, by more than U */
} fg_lot_thickness;

/* One cause of the spread: d ln K = sensitivity × d ln of it. */
typedef struct fg_lot_budget_term {
  double spread_pct, sensitivity; /* relative sd over the bumps; NaN: not known */
  double variance_pct2;           /* of the stiffness: their product, squared */
  double share_pct;               /* of the observed variance, 0 to 100; NaN: not known */
} fg_lot_budget_term;

/* Standard uncertainty of a mean over a lot's values; NaN: not known. */
typedef struct fg_lot_known {
  double u_statistical, u_calibration, u;
} fg_lot_known;

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
  double correlation, together_pct2; /* of radius and arc length; what that adds */
  double sum_pct2;                   /* of what is known of the above */
  double observed_pct;               /* rsd of the measured bumps */
  double unexplained_pct2;           /* observed² - sum: curvature, what is not measured; may be
                                        negative */
  double measurement_pct;            /* of the observed, by the bumps' own uncertainties; NaN */
  double parts_pct;                  /* what is left of the observed without it */
  double rest_share_pct;             /* of the observed variance: explained by no cause */
} fg_lot_budget;

enum { FG_LOT_CASE_DESIGN, FG_LOT_CASE_MEAN, FG_LOT_CASES };

/* Stiffness of the bumps over that of the design's. */
typedef struct fg_lot_stiffness {
  fg_stiffness_case cases[FG_LOT_CASES];       /* by every model; the mean where there are bumps */
  fg_lot_spread by_model[FG_STIFFNESS_MODELS]; /* measured, over the design's by that model; a count
                                                  of 0: not known */
  fg_lot_budget budget;
  fg_arch_stiffness design_free, design_welded;
  fg_arch_sensitivity sensitivity;
  double *normalised; /* by bump of the lot, foil after foil, thickness as measured; NaN; owned */
  fg_lot_spread measured;
  fg_lot_spread at_design_thickness; /* the same bumps, all strips as thick as the design */
  double u_by_thickness;   /* of measured.mean: the thickness' uncertainty, which all foils share */
  double u_by_calibration; /* of measured.mean: what the calibration leaves, thickness included */
  fg_lot_spread resampled; /* radius drawn from its density, arc length from its own */
  fg_lot_spread foot;      /* sideways stiffness of the feet over the design's, measured */
} fg_lot_stiffness;

typedef struct fg_lot_bearing {
  const char *name; /* of the column; NULL: assumed, three foils in a row */
  size_t number;
  const fg_lot_foil *pad[FG_BEARING_BUMPS_MAX]; /* layout.pads; NULL: missing */
  /* Of the foils fitted into the sleeve; NaN: no value, or a crushed bump's. */
  double angle_deg[FG_BEARING_BUMPS_MAX], clearance_mm[FG_BEARING_BUMPS_MAX];
  double u_clearance_mm[FG_BEARING_BUMPS_MAX];
  size_t places;
  bool known;
  fg_bearing_clearance clearance;
  fg_decision decision; /* fg_bearing_decide's; owned */
} fg_lot_bearing;

/* What of the foils is in no bearing, and why. */
typedef struct fg_lot_unplaced {
  size_t without;   /* the manifest names no bearing; of assumed ones: left over */
  size_t displaced; /* the pad is taken, or the bearing has all its pads */
  size_t bad_pads;  /* a pad that is no number from 1 to pads: the next free one was taken */
} fg_lot_unplaced;

/* Why a foil takes no part in the drawn bearings. */
typedef enum fg_lot_left_out {
  FG_LOT_IN_STOCK,
  FG_LOT_NOT_MEASURED,
  FG_LOT_DEFECT,        /* fg_foil_defect */
  FG_LOT_FAILS,         /* its own tolerances */
  FG_LOT_FLAGGED,       /* what is seen of it may not be the foil's */
  FG_LOT_CRUSHED,       /* a bump of it is */
  FG_LOT_NO_CLEARANCE,  /* at one of its places: fewer bumps than the layout asks, or no value */
  FG_LOT_SCANNED_AGAIN, /* a part has several scans: the first that can be built in counts */
  FG_LOT_LEFT_OUT
} fg_lot_left_out;

/* For people: "crushed bump". */
const char *fg_lot_left_out_words(fg_lot_left_out why);

/* What would change the share of bearings that assemble: the same lot, changed in one thing. */
typedef struct fg_lot_change {
  const char *name;  /* in JSON */
  const char *words; /* for people: "the mean bump radius at the design's" */
  double share, gain;
  bool clear; /* more than twice the scatter of the draws, up or down */
} fg_lot_change;

enum { FG_LOT_CHANGES_MAX = 4 };

typedef struct fg_lot_assembly {
  bool asked;    /* the recipe asks for bearings */
  char why[200]; /* why nothing was drawn; "": it was */
  size_t left_out[FG_LOT_LEFT_OUT];
  fg_lot_left_out *reason; /* of each foil of the lot; owned */
  fg_stock stock;          /* owned */
  fg_assembly_plan plan;
  bool centred; /* the crowns surround the rotor, so that it has a place of most room */
  fg_assembly_result drawn, design;
  fg_lot_change change[FG_LOT_CHANGES_MAX];
  size_t changes, classes; /* boxes that sorted foils would lie in */
  char statement[3][400];
} fg_lot_assembly;

/* Tests of a pair of groups in one quantity. */
typedef enum fg_lot_group_test {
  FG_LOT_TEST_MEANS,     /* of the foils: Welch */
  FG_LOT_TEST_VARIANCES, /* of the foils: F, by relabelling */
  FG_LOT_TEST_LEVENE,    /* of the foils: Levene, by relabelling */
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
  double within_sd_a, within_sd_b;   /* of parts within a foil; NaN: of the whole foil */
  double p[FG_LOT_GROUP_TESTS];      /* of each test alone; NaN: not made */
  double p_holm[FG_LOT_GROUP_TESTS]; /* adjusted for all tests of the lot (Holm 1979) */
  fg_comparison comparison;          /* of the foils' levels */
} fg_lot_difference;

typedef struct fg_lot_gauge {
  const fg_lot_quantity *quantity;
  int number; /* of the part; 0: the whole foil */
  fg_gauge_study study;
} fg_lot_gauge;

/* Whether the process runs as it did, in the quantities that the release of the lot rests on. */
typedef struct fg_lot_process {
  size_t watched, unstable;
  size_t explained; /* of the unstable: by groups, every signal of it */
} fg_lot_process;

typedef struct fg_lot_analysis {
  const fg_lot *lot;
  const char *folder; /* that the report is written to, from which links lead; NULL: not known */
  char *const *pages; /* by item of the manifest, from the folder; NULL: none; not owned */
  fg_quantity_owner parts; /* what the foils' parts are */
  fg_lot_foil *foils;
  size_t foil_count, failed_scans;
  size_t part_count; /* of measured foils */
  size_t left_out;   /* of them: what is in no statistics, as crushed bumps and torn beams */
  size_t by_verdict[FG_VERDICT_NONE + 1], exceeded; /* foils */
  fg_report_outcome outcome;                        /* of all foils, scans and bearings */
  const fg_lot_foil *worst[3];
  fg_lot_quantity *quantities;
  size_t quantity_count;
  fg_lot_process process;
  bool has_correlation, has_stiffness;
  fg_lot_correlation correlation;
  fg_lot_thickness thickness;
  fg_lot_stiffness stiffness;
  fg_bearing_layout layout; /* in force: the recipe's, what it leaves open the design's */
  char layout_note[400];    /* what of it contradicts the design; "": nothing */
  fg_lot_bearing *bearings;
  size_t bearing_count, bearing_capacity;
  fg_lot_unplaced unplaced;
  size_t bearings_by_verdict[FG_VERDICT_NONE + 1];
  fg_lot_assembly assembly;
  /* Of the local clearance relative to the design's, in percent: foils free, and fitted. */
  fg_lot_spread clearance_pct, clearance_fitted_pct;
  fg_lot_difference *differences;
  size_t difference_count, difference_capacity;
  size_t group_tests, group_tests_differ; /* made; of them those that differ by Holm's p */
  fg_lot_gauge *gauges;
  size_t gauge_count, gauge_capacity;
} fg_lot_analysis;

fg_status fg_lot_analyse(fg_context *ctx, const fg_lot *lot, fg_lot_analysis *analysis);
void fg_lot_analysis_free(fg_lot_analysis *analysis);

/* A crushed bump says what became of it, not what the process makes, and so does a torn or bent
 * beam: it is counted, and left out of the statistics, stiffness and clearances. It is judged as
 * every other. So is a bump of what is no foil of the design. */
enum { FG_LOT_BEAM_DAMAGED = FG_BEAM_NOT_FITTED | FG_BEAM_TORN_TIP | FG_BEAM_BENT };
bool fg_lot_bump_counts(const fg_foil *foil, const fg_bump *bump);
bool fg_lot_part_counts(const fg_foil *foil, fg_quantity_owner owner, const fg_foil_part *part);
/* For statistics by number: 0 where the foil does not tell which of its places are empty. */
int fg_lot_part_number(const fg_foil *foil, const fg_foil_part *part);

/* What a lot calls the parts of its foils. */
typedef struct fg_lot_words {
  const char *one, *many;             /* "bump", "bumps"; the members of JSON and CSV, too */
  const char *counted;                /* "Bumps measured" */
  const char *how;                    /* those are that are left out: "crushed" */
  const char *damaged, *json_damaged; /* "Crushed bumps", "bumps_crushed" */
  const char *json_worst;             /* "worst_bump" */
  const char *numbers;                /* how they are numbered */
  const char *before_number;          /* of a part, behind the words of its quantity */
  const char *mean;                   /* of a foil: "foil (mean of its bumps)" */
} fg_lot_words;

const fg_lot_words *fg_lot_words_of(const fg_lot_analysis *analysis);

/* Clearance over a bump of the foil fitted into the sleeve, NaN where there is none that counts; of
 * its u what all foils share, and the rest. */
typedef struct fg_lot_clearance {
  double mm, u_shared_mm, u_own_mm;
} fg_lot_clearance;
fg_lot_clearance fg_lot_clearance_of(const fg_lot_analysis *analysis, const fg_lot_foil *foil,
                                     int number);

/* owner[i]: the foil of the lot that foil i is a scan of, itself where no part is named. */
fg_status fg_lot_find_owners(fg_context *ctx, const fg_lot_analysis *analysis, size_t *owner);

/* What the arch model leaves out of this lot's form; NULL: nothing. */
const char *fg_lot_stiffness_note(const fg_lot_analysis *analysis);

bool fg_lot_foil_is_good(const fg_lot_foil *foil);

/* Of the parts: the first with a tolerance, else what a lot of this form is first asked for. NULL:
 * there is none. */
const fg_lot_quantity *fg_lot_leading_quantity(const fg_lot_analysis *analysis);

/* NULL when the lot has none of it. */
const fg_lot_quantity *fg_lot_find_quantity(const fg_lot_analysis *analysis, const char *name);

/* Whether the release of the lot rests on it; and whether groups explain all its signals. */
/* Looks for a trend, which is known where noise alone makes one with less than `level`. */
fg_status fg_lot_find_trend(fg_context *ctx, unsigned rules, double level,
                            fg_lot_quantity *quantity);

/* True where the trend leaves fewer signals than the groups do, both being known. */
bool fg_lot_is_trend(const fg_lot_quantity *quantity);
bool fg_lot_is_watched(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);
bool fg_lot_is_explained(const fg_lot_quantity *quantity);
/* No chart, or no signal on one of so few foils that it could hardly show any. */
bool fg_lot_tells_nothing(const fg_lot_quantity *quantity);

/* Names of the quantities whose charts are drawn where none has a tolerance, then NULL. */
extern const char *const fg_lot_charted[];

/* What the scanner's model did to the foils, the largest of each; NaN: there is none. */
fg_correction fg_lot_correction_largest(const fg_lot_analysis *analysis);

/* Foils whose lines the page has: those that do not pass, then others, so many at most. */
enum { FG_LOT_FOIL_ROWS_MAX = 300 };

/* Parts of the analysis, each in its own file. */
fg_status fg_lot_analyse_quantities(fg_context *ctx, fg_lot_analysis *analysis);
/* Of a quantity whose values and sizes are known: its charts, whether it is stable; and, where it
 * has a tolerance and a chart, its capability. The second asks for `sd`. */
fg_status fg_lot_chart_quantity(fg_context *ctx, unsigned rules, size_t foils,
                                fg_lot_quantity *quantity);
fg_status fg_lot_judge_capability(fg_context *ctx, double confidence, fg_lot_quantity *quantity);
/* Why charts signal; and what the process as a whole comes to. */
fg_status fg_lot_analyse_causes(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_correlation(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_analyse_thickness(fg_lot_analysis *analysis);
fg_status fg_lot_analyse_stiffness(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_find_layout(fg_lot_analysis *analysis);
fg_status fg_lot_analyse_bearings(fg_context *ctx, fg_lot_analysis *analysis);
fg_status fg_lot_analyse_assembly(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_assembly_free(fg_lot_assembly *assembly);
void fg_lot_say_assembly(fg_lot_analysis *analysis); /* the statements */
fg_status fg_lot_analyse_groups(fg_context *ctx, fg_lot_analysis *analysis);
/* True where an adjusted p-value lies below 1 minus the recipe's confidence. */
bool fg_lot_group_differs(const fg_lot_analysis *analysis, double p_holm);
fg_status fg_lot_analyse_gauge(fg_context *ctx, fg_lot_analysis *analysis);

/* Mean, sd, range of `count` finite values, and the mode of their density. */
fg_status fg_lot_spread_of(fg_context *ctx, const double *values, size_t count,
                           fg_bandwidth_rule rule, fg_lot_spread *spread);

/* Of the mean of a quantity's values: statistics average out over the foils, what the calibration
 * leaves is the same error in each and does not. */
fg_lot_known fg_lot_mean_known(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);

/* Relative, of the mean stiffness: what the calibration leaves. */
double fg_lot_stiffness_calibration(const fg_lot_analysis *analysis);

enum { FG_LOT_WORDS_MAX = 4096 };

/* In order of appearance; the words belong to the manifest. */
typedef struct fg_manifest_words {
  const char *word[FG_LOT_WORDS_MAX];
  size_t count;
} fg_manifest_words;

/* The word's place, which is added where it is new; FG_LOT_WORDS_MAX when there is no room. */
size_t fg_manifest_word_index(fg_manifest_words *words, const char *word);

/* Cells of the lot's foils that are not empty. */
void fg_lot_list_words(const fg_lot_analysis *analysis, size_t column, fg_manifest_words *words);

#endif
