/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables as a source of the residual's analysis (levels `runs` and `bumps`): declaration, problem
 * and reports. */
#ifndef FOILGAUGE_LOOP_TABLE_H
#define FOILGAUGE_LOOP_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "foilgauge/design.h"
#include "foilgauge/loop.h"
#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the effects of tables, of parts over bumps, and of heat treatment. */
const fg_loop_effect *fg_loop_table_effects(void);

/* Base period that is known of a column: 360 of an angle, the lead of a screw. */
typedef struct fg_loop_known_period {
  const char *column;
  double period;
} fg_loop_known_period;
enum { FG_LOOP_PERIODS = 16 };

typedef struct fg_loop_table_spec {
  const char *response; /* column */
  const char *model;    /* a formula, or "arc_length" */
  const char *group;    /* column, or NULL */
  const char *offset;   /* column of predictions, subtracted from the response before the model is
                           fitted (of a beam model of forming, say); or NULL */
  const char *order;    /* column, or NULL: `bump` in groups, `run` or the like, else the rows */
  const char *hold_out; /* "0.2", "COLUMN=VALUE"; "0" or NULL: no row is held out */
  const fg_design *design; /* arc_length only */
  uint64_t seed;
  fg_loop_known_period period[FG_LOOP_PERIODS];
  size_t periods;
} fg_loop_table_spec;

/* Declared model in a file: {"response", "model", "group", "order", "design": {...}}. Members
 * already set in `spec` stay; its other members point into `declaration`, which must outlive their
 * use. FG_ERR_DATA names the file and the member, or line and column of invalid JSON. */
typedef struct fg_loop_declaration fg_loop_declaration;
fg_status fg_loop_declaration_load(fg_context *ctx, const char *path, fg_loop_table_spec *spec,
                                   fg_design *design, fg_loop_declaration **declaration);
bool fg_loop_declaration_has_design(
    const fg_loop_declaration
        *declaration); /* Returns true when the declaration has a design; false for NULL. */
void fg_loop_declaration_free(fg_loop_declaration *declaration);

/* A problem built from a table; owns everything in it. `row` maps its rows to the table's. */
typedef struct fg_loop_table_problem {
  fg_loop_problem problem;
  size_t *row;
  char *excluded;                /* words: excluded columns with reasons; NULL: none */
  struct fg_loop_formula *model; /* of problem.declared; NULL: arc_length, which has no columns */
} fg_loop_table_problem;

/* Makes dates with hardly any twice (2026-03-01 08:15) days since the first, and those of the
 * declared order. They become spec->order, wherever their rows stand in the file, unless another
 * column is the order (run, sequence ...) or rows are grouped. `said` (appended to; may be NULL at
 * first) tells which columns; the caller frees it. */
fg_status fg_loop_table_count_times(fg_context *ctx, fg_table *table, fg_loop_table_spec *spec,
                                    char **said);

/* Missing cells, missing columns or a formula that cannot be built are FG_ERR_DATA or FG_ERR_USAGE
 * with a message. Columns that are results of the same measurement (bump radius and angle, height
 * ...) are no causes and are excluded. */
fg_status fg_loop_table_problem_build(fg_context *ctx, const fg_table *table,
                                      const fg_loop_table_spec *spec,
                                      fg_loop_table_problem *problem);
void fg_loop_table_problem_free(fg_loop_table_problem *problem);

/* Source file of the table: a scan of a run, a part of a lot. */
typedef struct fg_loop_input {
  const char *path, *sha256;
} fg_loop_input;

typedef struct fg_loop_report {
  const char *path, *sha256;
  const fg_loop_table_spec *spec;
  const fg_loop_table_problem *problem;
  const fg_loop_result *result;
  uint64_t seed;
  const fg_loop_input *input; /* sources other than `path` */
  size_t inputs;
  const char *const
      *row_name;    /* names of the table's rows: "foil 3, bump 5"; NULL: their numbers */
  const char *said; /* note on the table's making; NULL: none */
} fg_loop_report;

/* "foilgauge/loop/1" (reports/schema/loop.schema.json). */
fg_status fg_loop_write_json(fg_context *ctx, const fg_loop_report *report, FILE *out);
fg_status fg_loop_write_html(fg_context *ctx, const fg_loop_report *report, FILE *out);
fg_status fg_loop_write_text(fg_context *ctx, const fg_loop_report *report, FILE *out);
/* Writes one sentence for a process engineer; the caller frees it. */
fg_status fg_loop_sentence(fg_context *ctx, const fg_loop_report *report, char **text);
/* Returns the assumed noise model in words. */
const char *fg_loop_noise_model(const fg_loop_result *result);

#ifdef __cplusplus
}
#endif
#endif
