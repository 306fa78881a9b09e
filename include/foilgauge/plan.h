/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans of experiments: the runs and their order.
 *
 * Two-level factorials, full or fractional (Box and Hunter 1961), with replicates, centre points
 * and blocks; central composite designs with any axial distance (the thesis's modified one: corners
 * at ±1, axial points at ±3, one centre point); Box-Behnken designs (1960) for 3 to 7 factors. The
 * order is random by a seed; a factor that is hard to change forms whole plots: all runs at one of
 * its settings stay together (one oven load), and the loads are in random order.
 */
#ifndef FOILGAUGE_PLAN_H
#define FOILGAUGE_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "foilgauge/doe.h"
#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_PLAN_FACTORS = 20, FG_PLAN_RUNS = 100000 };

typedef enum fg_plan_kind {
  FG_PLAN_FACTORIAL,
  FG_PLAN_COMPOSITE,
  FG_PLAN_BOX_BEHNKEN,
} fg_plan_kind;

typedef struct fg_plan_factor {
  const char *name;
  double low, high; /* real values of -1 and +1 */
  bool hard_to_change;
  double step; /* settings are rounded to its multiples, as the oven offers them; 0: not rounded.
                  Settings between the levels stay between them */
} fg_plan_factor;

typedef struct fg_plan_options {
  fg_plan_kind kind;
  const fg_plan_factor *factor;
  size_t factors;
  const char *const *generator; /* "D=A:B:C" or "D=-A:B", names of factors; for the corners */
  size_t generators;
  const char *const *block_generator; /* "A:B:C": its sign is the block; b of them make 2^b blocks;
                                         for factorials only */
  size_t block_generators;
  size_t replicates;     /* of every run but the centre points; 0 means 1 */
  size_t centre_points;  /* per block */
  bool replicate_blocks; /* every replicate is a block of its own */
  bool composite_blocks; /* corners and axial points are two blocks, centre points in both */
  double axial;          /* composite designs: distance in coded units; 0: rotatable, the fourth
                            root of the number of corners */
  uint64_t seed;
} fg_plan_options;

typedef struct fg_plan_run {
  size_t standard;   /* place in the standard order, from 1 */
  size_t block;      /* from 1 */
  size_t plot;       /* whole plot, from 1; 0 without hard factors */
  size_t replicate;  /* from 1 */
  const char *point; /* "corner", "axial", "centre", "edge" */
  double coded[FG_PLAN_FACTORS];
} fg_plan_run;

typedef struct fg_plan {
  size_t factors;
  char *name[FG_PLAN_FACTORS];
  double low[FG_PLAN_FACTORS], high[FG_PLAN_FACTORS];
  double step[FG_PLAN_FACTORS]; /* 0: settings are not rounded */
  fg_plan_run *run;             /* in the order to be made */
  size_t runs, capacity;
  size_t blocks, plots; /* plots 0: no restriction */
  double axial;         /* as used; 0 for other kinds */
  int resolution;       /* length of the shortest word of the defining relation; 0: full */
  uint32_t *word;       /* the defining relation: bit k is factor k; without the empty word */
  int *word_sign;
  size_t words, word_capacity, sign_capacity;
} fg_plan;

/* FG_ERR_USAGE names the fault: unknown names, contradicting generators, equal levels, too many
 * runs, a kind of plan that does not exist for the number of factors. Free with fg_plan_free. */
fg_status fg_plan_make(fg_context *ctx, const fg_plan_options *options, fg_plan *plan);

/* The run sheet: run, standard_order, point, block (when there are several), whole_plot (when
 * restricted), the factors in real units. Free with fg_table_free. */
fg_status fg_plan_table(fg_context *ctx, const fg_plan *plan, fg_table *table);

/* Returns the setting of a factor in a run, in real units, rounded to its step. */
double fg_plan_setting(const fg_plan *plan, size_t run, size_t factor);

/* Lists settings that differ from the levels, a line each: rounded ones, and ones below 0 of a
 * factor with positive levels. "": none. The caller frees it. */
fg_status fg_plan_notes(fg_context *ctx, const fg_plan *plan, char **text);

/* Companion file of a run sheet, for facts that the sheet has no column for: RUNS.csv has
 * RUNS.plan.json, "foilgauge/plan/1". A spreadsheet program that edits the sheet leaves it
 * unchanged. */
fg_status fg_plan_write_json(fg_context *ctx, const fg_plan *plan, FILE *out);
/* Returns "RUNS.plan.json" for "RUNS.csv" or any other name; the caller frees it. */
fg_status fg_plan_beside(fg_context *ctx, const char *sheet, char **path);

/* Members of a plan that an analysis uses. */
typedef struct fg_plan_limits {
  fg_coding coding[FG_PLAN_FACTORS];
  double step[FG_PLAN_FACTORS]; /* 0: not rounded */
  size_t factors, runs;
  double *setting; /* of run i of the standard order: i × factors; owned */
} fg_plan_limits;
/* FG_ERR_IO when there is no file; FG_ERR_DATA when it is no plan. Free with fg_plan_limits_free.
 */
fg_status fg_plan_limits_load(fg_context *ctx, const char *path, fg_plan_limits *limits);
void fg_plan_limits_free(fg_plan_limits *limits);
/* Counts the rows of a table, made from a run sheet, whose settings differ from the plan (the
 * analysis uses the table's). `first` gets the first of them, from 1. 0 also when the table lacks
 * the standard order or the factors. */
size_t fg_plan_limits_differ(const fg_plan_limits *limits, const fg_table *table, size_t *first);

/* Writes a page to print and fill in at the oven: a line per run in their order, with room for
 * `column`s and a note. */
fg_status fg_plan_write_html(fg_context *ctx, const fg_plan *plan, const char *const *column,
                             size_t columns, FILE *out);

/* Lists the aliased effects of the fraction: one line "A = B:C:E = -D:E" per effect of at most
 * `order` factors, with aliases of at most `alias_order`; "" for a full factorial. The caller frees
 * it. */
fg_status fg_plan_alias_text(fg_context *ctx, const fg_plan *plan, size_t order, size_t alias_order,
                             char **text);
/* The defining relation: "I = A:B:C:D = ..."; "" for a full factorial. The caller frees it. */
fg_status fg_plan_relation_text(fg_context *ctx, const fg_plan *plan, char **text);

void fg_plan_free(fg_plan *plan);

#ifdef __cplusplus
}
#endif
#endif
