/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State and steps of one run of the loop. */
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
  double share[FG_LOOP_KINDS]; /* of each kind in the error rate */
  fg_loop_result *result;
  bool *train;
  fg_loop_candidate *candidate; /* listed effects first, then curves, then those of the noise */
  size_t means, candidates;     /* of the mean alone; all */
  fg_engine_set set;            /* claims in the order of result->claim; the curve, if any, last */
  bool has_curve;
  double curve_p;
  size_t curve_at; /* index of the curve's coordinate */
  fg_engine_noise noise;
  bool fell;  /* the error of held-out rows fell */
  double sd;  /* of the null at this step, whitened rows */
  bool worth; /* the residual is larger than rounding */
} fg_engine_run;

/* Accepts significant effects one after the other, then tests all of them again. */
fg_status fg_engine_search(fg_context *ctx, fg_engine_run *run);
/* Returns the number of folds of the cross-validation. */
size_t fg_engine_folds(size_t rows);
/* Computes errors of held-out rows, without effects and with those that the search finds without
 * them; `fell` when it fell by more than a standard error. */
fg_status fg_engine_cross_fit(fg_context *ctx, const fg_engine_run *run, double *before_rms,
                              double *after_rms, bool *fell);
/* Tries to accept one effect; *accepted is true if there was one. */
fg_status fg_engine_accept_one(fg_context *ctx, fg_engine_run *run, bool *accepted, bool *last);
/* Replaces a claim by another candidate that explains more with the others fitted. */
fg_status fg_engine_swap(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_list_rejected(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_advise(fg_context *ctx, fg_engine_run *run);
/* Fills the result's checks beside the whole set (residual_tests.c). */
fg_status fg_engine_check(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise);
/* Notes the declared uncertainty that random levels change most, before and after. */
fg_status fg_engine_note_levels(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise);
fg_status fg_engine_finish(fg_context *ctx, fg_engine_run *run);
fg_status fg_engine_note(fg_context *ctx, fg_loop_result *result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
