/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model file of the loop on tables: the declared model and the effects found. */
#ifndef FOILGAUGE_LOOP_MODEL_H
#define FOILGAUGE_LOOP_MODEL_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_loop_model fg_loop_model;

/* "foilgauge/loop-model/1". */
fg_status fg_loop_write_model(fg_context *ctx, const fg_loop_report *report, FILE *out);
/* FG_ERR_DATA for a file that is no model. Free with fg_loop_model_free. */
fg_status fg_loop_model_load(fg_context *ctx, const char *path, fg_loop_model **model);
/* Subtracts the effects of the model from the response column of a table, so that an analysis with
 * the declared formula starts from the better model. Effects of single rows (outlier, exchanged
 * runs) belong to the model's own table and are not applied. A value outside the model's range, or
 * a level unknown to it, is FG_ERR_DATA with its row. */
fg_status fg_loop_model_apply(fg_context *ctx, const fg_loop_model *model, fg_table *table);

/* Effect that a model subtracted from a table. */
typedef struct fg_loop_taken {
  char id[FG_LOOP_NAME], words[4 * FG_LOOP_NAME]; /* "a trend with humidity" */
  char sentence[10 * FG_LOOP_NAME]; /* with its effect on the response, in the file's own words; or
                                       empty */
  double amplitude, u_amplitude;    /* with standard uncertainty, as in the file; NaN: unknown */
  size_t parameters;                /* number of parameters estimated for it */
  double low, high;                 /* range of the subtracted effect over the rows */
  bool applied;                     /* false: it belongs to rows of the model's own table */
  char column[2][FG_LOOP_NAME];     /* that it is over; empty: none */
} fg_loop_taken;

typedef struct fg_loop_takings {
  fg_loop_taken *one;
  size_t count;
  double *change; /* rows: the subtracted sum */
} fg_loop_takings;

/* As fg_loop_model_apply, with a list of the subtracted effects. Free with fg_loop_takings_free. */
fg_status fg_loop_model_take(fg_context *ctx, const fg_loop_model *model, fg_table *table,
                             fg_loop_takings *takings);
void fg_loop_takings_free(fg_loop_takings *takings);
const char *fg_loop_model_response(const fg_loop_model *model);
const char *fg_loop_model_formula(const fg_loop_model *model);
void fg_loop_model_free(fg_loop_model *model);

#ifdef __cplusplus
}
#endif
#endif
