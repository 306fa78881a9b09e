/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots over time and against each other: what a page over lots says, from their reports.
 *
 * A lot is read from lot.json, foils.csv and bumps.csv (or beams.csv), not from its records: lots
 * of years come from many versions of the program, and the names in these files stay. */
#ifndef FG_LOTS_INDEX_H
#define FG_LOTS_INDEX_H

#include <stdbool.h>
#include <stdio.h>

#include "foilgauge/density.h"
#include "foilgauge/lot.h"
#include "foilgauge/quantity.h"
#include "lot/run/date.h"
#include "stats/between_groups.h"

#define FG_INDEX_NONE ((size_t)-1)

/* One quantity of one lot. Lengths and angles are over the design's where designs differ. */
typedef struct fg_index_stat {
  const fg_quantity *row;
  fg_quantity_owner owner;
  size_t count; /* of bumps or foils, as lot.json has them */
  double mean, sd, median, mode, min, max;
  double lower, upper; /* tolerance; infinite: none */
  double *foil;        /* of every foil of the lot its value or the mean of its bumps; NaN; owned */
  size_t foils;        /* with a value */
  double foil_mean, foil_sd;
  /* Where the other lots put the mean of this one; NaN: they are too few. */
  double expected_low, expected_high;
  bool unexpected;
} fg_index_stat;

/* The radii of a lot's bumps over the design's (thesis figure 5.22). */
typedef struct fg_index_spread {
  size_t count;
  double mean, mode, relative_sd_pct, min, max;
  bool has_density;
  fg_density density;
} fg_index_spread;

typedef struct fg_index_lot {
  const char *folder; /* as given */
  char *name;
  char *problem;       /* why nothing is known of it, and what to do; NULL: it is read */
  char *foils_unknown; /* why its foils are not known one by one; NULL: they are */
  fg_lot_date date;
  double day;                   /* the first; NaN: not known */
  char version[32], sha256[65]; /* of the program, and of lot.json */
  fg_verdict verdict;
  size_t scans, failed_scans, foils, by_verdict[FG_VERDICT_NONE + 1], exceeded;
  fg_design design;
  fg_nominal nominal;
  char design_sum[65];  /* of what the design asks for, without its name and tolerances */
  size_t design_number; /* of different designs, from 1 */
  char (*scan_sum)[65]; /* SHA-256 of its scans; owned */
  size_t scan_sums;
  fg_index_stat *stats; /* owned */
  size_t stat_count;
  /* Foil by foil, those that are foils of the design. */
  size_t foil_count;
  size_t *die;   /* of each: number among fg_index.dies, or FG_INDEX_NONE; owned */
  char *coils;   /* "A, B"; NULL: none */
  double *ratio; /* radius of every bump over the design's; owned */
  size_t *ratio_foil, ratios;
  fg_index_spread spread;
} fg_index_lot;

/* How a quantity is shown. */
typedef enum fg_index_scale {
  FG_INDEX_AS_IS,
  FG_INDEX_OVER_DESIGN, /* the designs differ: each value over its own design's */
  FG_INDEX_APART,       /* the designs differ, and ask for no value: on no axis with another */
} fg_index_scale;

typedef struct fg_index_axis {
  const fg_quantity *row;
  fg_quantity_owner owner;
  fg_index_scale scale;
  size_t same_as; /* an earlier axis that says the same of every foil; FG_INDEX_NONE: none */
  bool limited;   /* a lot has a tolerance for it */
  size_t lots;    /* with foils whose values are known, two at least */
  fg_between between;
  double within_sd; /* of foils within their lots, pooled */
  double p_equal;   /* of all lots having one mean (analysis of variance); NaN */
} fg_index_axis;

/* Two lots in one quantity: Welch's test of the means of their foils. */
typedef struct fg_index_pair {
  size_t axis, a, b; /* a is the larger */
  size_t foils_a, foils_b;
  double difference, u, dof, low, high; /* a - b */
  double p, p_holm;
} fg_index_pair;

typedef enum fg_index_basis {
  FG_INDEX_WITHIN_LOTS, /* of foils of both dies in the same lots */
  FG_INDEX_OVER_LOTS,   /* means of lots that have one of them */
  FG_INDEX_CONFOUNDED,  /* no lot has both, and there are too few of each */
} fg_index_basis;

typedef struct fg_index_die_pair {
  fg_index_pair pair; /* a and b are dies */
  fg_index_basis basis;
  size_t lots;
} fg_index_die_pair;

typedef struct fg_index_die {
  char *name;
  size_t foils, lots;
  fg_index_spread spread;
} fg_index_die;

typedef struct fg_index {
  fg_index_lot *lots; /* in order of date; those that could not be read behind */
  size_t count, read;
  size_t doubles; /* folders that were named once more */
  size_t designs;
  fg_index_die *dies;
  size_t die_count, die_capacity;
  fg_index_axis *axes;
  size_t axis_count;
  fg_index_pair *pairs; /* by p-value */
  size_t pair_count, pair_capacity, differing;
  fg_index_die_pair *die_pairs;
  size_t die_pair_count, die_pair_capacity, dies_differing;
  char **sentences; /* what there is to say, first things first; owned */
  size_t sentence_count, sentence_capacity;
  char *notes; /* a line each; NULL: none */
} fg_index;

/* The level of every statement, and of the limits of a mean over lots: three sigma. */
#define FG_INDEX_CONFIDENCE 0.95
#define FG_INDEX_EXPECTED   0.9973

/* Fewer lots than these say nothing of how lots scatter (Student's t with three degrees of freedom
 * reaches 9 standard deviations at three sigma; with two it would be 19). */
enum { FG_INDEX_LOTS_MIN = 5 };

/* More dies than these are no dies but serial numbers: they are listed, not compared. */
enum { FG_INDEX_DIES_MAX = 24 };

/* Reads lot.json into `lot`, whose folder is set. What is wrong with the lot is its `problem`; an
 * error is only one of memory. */
fg_status fg_index_read_lot(fg_context *ctx, fg_index_lot *lot);

/* Reads foils.csv and bumps.csv or beams.csv; what is wrong is its `doubt`. */
fg_status fg_index_read_foils(fg_context *ctx, fg_index *index, fg_index_lot *lot);

/* Order, designs, axes and what is asked of them. */
fg_status fg_index_arrange(fg_context *ctx, fg_index *index);
fg_status fg_index_spreads(fg_context *ctx, fg_index *index);
fg_status fg_index_compare(fg_context *ctx, fg_index *index);
fg_status fg_index_compare_dies(fg_context *ctx, fg_index *index);

/* Welch's test of two means: fills difference, u, freedom, interval, p. */
void fg_index_welch(fg_index_pair *pair, const double mean[2], const double u[2],
                    const double dof[2]);

void fg_index_free(fg_index *index);

/* The lot's values of an axis; NULL: it has none. */
fg_index_stat *fg_index_stat_of(const fg_index_axis *axis, const fg_index_lot *lot);

/* The sentences, for page and JSON. */
fg_status fg_index_say(fg_context *ctx, fg_index *index);

/* A value of an axis with its unit, and a difference "0.0312 ± 0.0041 mm" with half its interval.
 */
void fg_index_value(const fg_index_axis *axis, double value, char *text, size_t size);
void fg_index_difference(const fg_index_axis *axis, const fg_index_pair *pair, char *text,
                         size_t size);

/* "0.0004", "below 0.0001" behind "p = ": what is left of the digits of a p-value. */
void fg_index_p(double p, char *text, size_t size);

/* At most `letters` characters of a name, whole ones, and … for the rest. */
void fg_index_clip_name(const char *name, size_t letters, char *text, size_t size);

/* How people find a lot on the page: its place in order of date, from 1. */
size_t fg_index_number(const fg_index *index, const fg_index_lot *lot);

/* Names of the lot's dies, "A, B"; the caller frees. NULL: none. */
fg_status fg_index_die_names(fg_context *ctx, const fg_index *index, const fg_index_lot *lot,
                             char **names);

/* The outputs. Each checks the stream at its end. */
fg_status fg_index_write_json(fg_context *ctx, const fg_index *index, FILE *out);
fg_status fg_index_write_csv(fg_context *ctx, const fg_index *index, FILE *out);
fg_status fg_index_write_page(fg_context *ctx, const fg_index *index, const char *page, FILE *out);

/* Sections of the page; a row's cells of a spread, which end the row, and their heads. */
void fg_index_put_pairs(FILE *out, const fg_index *index);
void fg_index_put_dies(FILE *out, const fg_index *index);
void fg_index_put_spread(FILE *out, const fg_index_spread *spread);
extern const char fg_index_spread_heads[];

/* Figures of the page: densities of R / R_D of lots, or of dies; a quantity over the lots. */
void fg_index_plot_lots(FILE *out, const fg_index *index);
void fg_index_plot_dies(FILE *out, const fg_index *index);
void fg_index_plot_axis(FILE *out, const fg_index *index, const fg_index_axis *axis);

/* Unit of an axis: "mm", or "" where it is over the design's. */
const char *fg_index_unit(const fg_index_axis *axis);

#endif
