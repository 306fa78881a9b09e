/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots over time and against each other: what a page over lots says, from their reports.
 *
 * A lot is read from lot.json, foils.csv and bumps.csv (or beams.csv), not from its records: lots
 * of years come from many versions of the program, and the names in these files stay. */
#ifndef FG_LOTS_INDEX_H
#define FG_LOTS_INDEX_H

#include <stdbool.h>
#include <stdio.h>

#include "core/member.h"
#include "foilgauge/density.h"
#include "foilgauge/lot.h"
#include "foilgauge/quantity.h"
#include "lot/run/date.h"
#include "stats/between_groups.h"

#define FG_INDEX_NONE ((size_t)-1)

/* Quantity of a lot. Lengths and angles are relative to the design where designs differ. */
typedef struct fg_index_stat {
  const fg_quantity *row;
  fg_quantity_owner owner;
  size_t count; /* number of bumps or foils, as in lot.json */
  double mean, sd, median, mode, min, max;
  double lower, upper; /* tolerance; infinite: none */
  double *foil;        /* by foil: its value or the mean of its bumps; NaN: none; owned */
  size_t foils;        /* foils with a value */
  double foil_mean, foil_sd;
  /* Interval in which the other lots expect this mean; NaN: too few lots. */
  double expected_low, expected_high;
  bool unexpected;
} fg_index_stat;

/* Radii of a lot's bumps relative to the design's (thesis figure 5.22). */
typedef struct fg_index_spread {
  size_t count;
  double mean, mode, relative_sd_pct, min, max;
  bool has_density;
  fg_density density;
} fg_index_spread;

/* A lot against the prediction of its die, from its expected.json. */
typedef struct fg_index_prediction {
  bool known;
  double error_before_pct, error_after_pct, p_value;
  double springback_pct, u_springback_pct; /* of the law with this lot */
  size_t inside, values;
} fg_index_prediction;

typedef struct fg_index_lot {
  const char *folder; /* as given */
  char *name;
  char *problem;       /* reason why it could not be read, and advice; NULL: it was read */
  char *foils_unknown; /* reason why its foils are not known one by one; NULL: they are */
  fg_lot_date date;
  double day;                   /* first day; NaN: unknown */
  char version[32], sha256[65]; /* version of the program, and SHA-256 of lot.json */
  fg_verdict verdict;
  size_t scans, failed_scans, foils, by_verdict[FG_VERDICT_NONE + 1], exceeded;
  fg_design design;
  fg_nominal nominal;
  char design_sum[65];  /* SHA-256 of the design without its name and tolerances */
  size_t design_number; /* number of the design among the different ones, from 1 */
  char (*scan_sum)[65]; /* SHA-256 of its scans; owned */
  size_t scan_sums;
  fg_index_stat *stats; /* owned */
  size_t stat_count;
  /* Foils of the design, one by one. */
  size_t foil_count;
  size_t *die;             /* die by foil: index in fg_index.dies, or FG_INDEX_NONE; owned */
  char *die_names, *coils; /* "A, B"; NULL: none */
  double *ratio;           /* radius of every bump over the design's; owned */
  size_t *ratio_foil, ratios;
  fg_index_spread spread;
  fg_index_prediction prediction;
} fg_index_lot;

/* Scale of a quantity. */
typedef enum fg_index_scale {
  FG_INDEX_AS_IS,
  FG_INDEX_OVER_DESIGN, /* designs differ: each value over its own design's */
  FG_INDEX_APART,       /* designs differ and state no value: no common axis */
} fg_index_scale;

typedef struct fg_index_axis {
  const fg_quantity *row;
  fg_quantity_owner owner;
  fg_index_scale scale;
  size_t same_as; /* earlier axis that is equivalent; FG_INDEX_NONE: none */
  bool limited;   /* one of the lots has a tolerance for it */
  size_t lots;    /* lots with known foils, at least two */
  fg_between between;
  double within_sd; /* pooled sd of foils within their lots */
  double p_equal;   /* p-value of one mean for all lots (analysis of variance); NaN */
} fg_index_axis;

/* Pair of lots in a quantity: Welch's test of the means of their foils. */
typedef struct fg_index_pair {
  size_t axis, a, b; /* a is the larger */
  size_t foils_a, foils_b;
  double difference, u, dof, low, high; /* a - b */
  double p, p_holm;
} fg_index_pair;

typedef enum fg_index_basis {
  FG_INDEX_WITHIN_LOTS, /* from foils of both dies in the same lots */
  FG_INDEX_OVER_LOTS,   /* from means of lots that have one of them */
  FG_INDEX_CONFOUNDED,  /* confounded with the lots: none has both dies, and there are too few of
                           each */
} fg_index_basis;

typedef struct fg_index_die_pair {
  fg_index_pair pair; /* a and b are indices of dies */
  fg_index_basis basis;
  size_t lots;
} fg_index_die_pair;

typedef struct fg_index_die {
  char *name;
  size_t foils, lots;
  fg_index_spread spread;
} fg_index_die;

typedef struct fg_index {
  const char *page;   /* path of the page, which its links begin at */
  fg_index_lot *lots; /* in order of date; unread ones last */
  size_t count, read;
  size_t doubles; /* folders that were named again */
  size_t designs;
  fg_index_die *dies;
  size_t die_count, die_capacity;
  fg_index_axis *axes;
  size_t axis_count;
  fg_index_pair *pairs; /* by p-value */
  size_t pair_count, pair_capacity, differing;
  fg_index_die_pair *die_pairs;
  size_t die_pair_count, die_pair_capacity, dies_differing;
  char **sentences; /* sentences, the most important first; owned */
  size_t sentence_count, sentence_capacity;
  char *notes; /* one line each; NULL: none */
} fg_index;

/* Confidence of every statement, and of the limits of a mean over lots: three sigma. */
#define FG_INDEX_CONFIDENCE 0.95
#define FG_INDEX_EXPECTED   0.9973

/* Minimum of lots that tell how lots scatter. (Student's t with three degrees of freedom reaches 9
 * standard deviations at three sigma, with two 19.) */
enum { FG_INDEX_LOTS_MIN = 5 };

/* Maximum of dies that are compared; more are serial numbers, and are only listed. */
enum { FG_INDEX_DIES_MAX = 24 };

/* Reads lot.json into `lot`, whose folder is set. A defect of the lot becomes its `problem`; only
 * lack of memory is an error. */
fg_status fg_index_read_lot(fg_context *ctx, fg_index_lot *lot);

/* Reads foils.csv and bumps.csv or beams.csv; a defect becomes `foils_unknown`. */
fg_status fg_index_read_foils(fg_context *ctx, fg_index *index, fg_index_lot *lot);

/* Reads expected.json, where there is one. */
fg_status fg_index_read_prediction(fg_context *ctx, fg_index_lot *lot);

/* Sorts the lots, and finds their designs and axes. */
fg_status fg_index_arrange(fg_context *ctx, fg_index *index);
fg_status fg_index_spreads(fg_context *ctx, fg_index *index);
fg_status fg_index_compare(fg_context *ctx, fg_index *index);
fg_status fg_index_compare_dies(fg_context *ctx, fg_index *index);

/* Fills difference, u, dof, interval and p of Welch's test of two means. */
void fg_index_welch(fg_index_pair *pair, const double mean[2], const double u[2],
                    const double dof[2]);

void fg_index_free(fg_index *index);

/* Returns the lot's values of an axis; NULL: it has none. */
fg_index_stat *fg_index_stat_of(const fg_index_axis *axis, const fg_index_lot *lot);

/* Makes the sentences of page and JSON. */
fg_status fg_index_make_sentences(fg_context *ctx, fg_index *index);

/* Formats a value of an axis with its unit, and a difference as "0.0312 ± 0.0041 mm" with half its
 * interval. */
void fg_index_value(const fg_index_axis *axis, double value, char *text, size_t size);
void fg_index_difference(const fg_index_axis *axis, const fg_index_pair *pair, char *text,
                         size_t size);

/* Formats a p-value behind "p = ": "0.0004", "below 0.0001". */
void fg_index_p(double p, char *text, size_t size);

/* Clips a name to `letters` whole characters, with … for the rest. */
void fg_index_clip_name(const char *name, size_t letters, char *text, size_t size);

/* Returns the number of a lot on the page: its place in order of date, from 1. */
size_t fg_index_number(const fg_index *index, const fg_index_lot *lot);

/* Lists the names of the dies of every lot. */
fg_status fg_index_name_dies(fg_context *ctx, fg_index *index);

/* Outputs; each checks the stream at its end. */
fg_status fg_index_write_json(fg_context *ctx, const fg_index *index, FILE *out);
fg_status fg_index_write_csv(fg_context *ctx, const fg_index *index, FILE *out);
fg_status fg_index_write_page(fg_context *ctx, const fg_index *index, FILE *out);

/* Sections of the page. */
void fg_index_put_pairs(FILE *out, const fg_index *index);
void fg_index_put_dies(FILE *out, const fg_index *index);
void fg_index_put_predictions(FILE *out, const fg_index *index);

/* Cells of the table of lots, which a lot is the object of. */
void fg_index_put_lot_link(FILE *out, const fg_subject *lot);
void fg_index_put_lot_date(FILE *out, const fg_subject *lot);
void fg_index_put_lot_verdict(FILE *out, const fg_subject *lot);
void fg_index_put_lot_design(FILE *out, const fg_subject *lot);

/* Figures of the page: densities of R / R_D by lot or die, and a quantity over the lots. */
void fg_index_plot_lots(FILE *out, const fg_index *index);
void fg_index_plot_dies(FILE *out, const fg_index *index);
void fg_index_plot_axis(FILE *out, const fg_index *index, const fg_index_axis *axis);

/* Returns the unit of an axis: "mm", or "" where it is relative to the design. */
const char *fg_index_unit(const fg_index_axis *axis);

#endif
