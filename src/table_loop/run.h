/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One run of the loop: what is accepted so far, and the steps. */
#ifndef FG_TABLE_LOOP_RUN_H
#define FG_TABLE_LOOP_RUN_H

#include "table_loop/alias.h"
#include "table_loop/assess.h"
#include "table_loop/fit.h"
#include "table_loop/units.h"

typedef struct fg_engine_run {
  const fg_loop_problem *problem; /* in the engine's units */
  const fg_engine_units *units;
  fg_loop_options options;
  fg_loop_result *result;
  bool *train;
  fg_loop_candidate *candidate; /* listed effects first, then curves, then those of the noise */
  size_t means, candidates;     /* without those of the noise; all */
  fg_engine_set set;            /* claims in the order of result->claim; the curve, if any, last */
  bool has_curve;
  double curve_p;
  size_t curve_at; /* coordinate */
  fg_engine_noise noise;
  bool fell;  /* the error of rows that took no part */
  double sd;  /* of the null at this step, whitened rows */
  bool worth; /* the residual is more than rounding */
} fg_engine_run;

/* Accepts what passes, one after the other, and looks at all again at the end. */
fg_status fg_engine_search(fg_context *ctx, fg_engine_run *run);
/* How many folds the search is made again without. */
size_t fg_engine_folds(size_t rows);
/* Errors of rows that took no part: before, and with what the search without them finds; whether it
 * fell by more than a standard error. */
fg_status fg_engine_cross_fit(fg_context *ctx, const fg_engine_run *run, double *before_rms,
                              double *after_rms, bool *fell);
/* Tries to accept one effect; *accepted says whether there was one. */
fg_status fg_engine_accept_one(fg_context *ctx, fg_engine_run *run, bool *accepted, bool *last);
/* With the others fitted, would another candidate serve better in a claim's place? */
fg_status fg_engine_swap(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_list_rejected(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_advise(fg_context *ctx, fg_engine_run *run);
/* Fills the result's checks, beside everything in the set. battery.c */
fg_status fg_engine_check(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise);
fg_status fg_engine_finish(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_note(fg_context *ctx, fg_loop_result *result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
