/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the loop on scans share. */
#ifndef FG_SCAN_LOOP_STATE_H
#define FG_SCAN_LOOP_STATE_H

#include "effect_search/cross_fit.h"
#include "effect_search/effect_search.h"
#include "effect_search/joint_fit.h"
#include "effect_search/width_search.h"
#include "foilgauge/scan_loop.h"
#include "rows/edge_fit.h"
#include "scan_loop/benefit.h"
#include "scan_loop/bumps.h"
#include "scan_loop/scanner_model_tone.h"
#include "scan_loop/verdict.h"

/* Lowest and highest value of a dimension over the tied explanations. */
typedef struct fg_scan_loop_range {
  double radius_mm[2], height_mm[2];
} fg_scan_loop_range;

struct fg_scan_loop {
  fg_scan_loop_options options;
  fg_measurement *before, *after; /* one per scan */
  bool *hold_out;
  size_t scan_count;
  size_t left_out;                          /* foils that were not measured, or are none */
  fg_edge_fit edge_fit;                     /* all views; geometry of the final model */
  fg_explanations explanations;             /* what was tried, and which sets explain */
  fg_effect_set set;                        /* the winner, fitted */
  double *residual_before, *residual_after; /* um, per row of points */
  fg_scan_loop_error error_before, error_after;
  fg_cross_fit cross_fit; /* no folds: scans were kept aside, or nothing was found */
  double noise_floor_um;
  bool tied;
  bool scale_tied;                        /* scale_doubt.c */
  fg_effect_set tie[FG_EXPLANATIONS_MAX]; /* the other explanations, fitted */
  bool unlikely[FG_EXPLANATIONS_MAX];     /* of them: in the ranges, and no more */
  size_t tie_count;
  fg_scan_loop_range *
      *ranges;             /* per scan and foil: bump_count + 1 (the last: overall); NULL: no tie */
  fg_benefits *benefits;   /* per scan: what the explanations would move; NULL: no effects */
  fg_width_findings width; /* what moves the strip's edges apart; with the set in force */
  fg_scan_loop_bumps bumps; /* the bumps of `after` against the declared springback model */
  fg_model_tone tone;       /* the level of the discs' edges, where their diameters are known */
  bool levelled;            /* and the edges were moved to it */
  fg_loop_outcome verdict;
  fg_scan_result result; /* what is said of all of it */
};

/* fg_scan_loop_run on scans of one resolution that are measured already; takes them over. */
fg_status fg_scan_loop_run_measured(fg_context *ctx, fg_measurement *measurements,
                                    const bool *hold_out, size_t count,
                                    const fg_scan_loop_options *options, fg_scan_loop **result);

/* Turns foils that are none of the design's into foils that were not measured, and counts them.
 * FG_ERR_NOT_MEASURED when no foil is left. */
fg_status fg_scan_loop_leave_out(fg_context *ctx, fg_scan_loop *loop);
/* A note for each. */
fg_status fg_scan_loop_say_left_out(fg_context *ctx, fg_scan_loop *loop);

/* What single bumps deviate by where the search found none of it: joins what was found. */
fg_status fg_scan_loop_find_single_bumps(fg_context *ctx, fg_scan_loop *loop);

/* Under same_foil, once the points are settled: FG_ERR_DATA when the scans show different foils. */
fg_status fg_scan_loop_check_one_foil(fg_context *ctx, const fg_scan_loop *loop);

/* Held-out errors of the set in force; a note where they did not fall. */
fg_status fg_scan_loop_find_held_out(fg_context *ctx, fg_scan_loop *loop);
fg_status fg_scan_loop_say_held_out(fg_context *ctx, fg_scan_loop *loop);
/* "bumps"; NULL: they were not cross-fitted. */
const char *fg_scan_loop_fold_of(const fg_scan_loop *loop);

/* Marks a stretch of the part as tied where a scale of the scanner would do as well. */
fg_status fg_scan_loop_scale_uncertainty(fg_context *ctx, fg_scan_loop *loop);

/* Copies a measurement with corrected edges and measures its foils and discs again: fields move an
 * edge by d(x, y). NULL: there are none. */
fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, unsigned threads,
                               fg_measurement *corrected);

/* The same by a fit to these edges: its fields, then what its part moved, with the uncertainties
 * that its effects add. */
fg_status fg_scan_loop_correct_fitted(fg_context *ctx, const fg_measurement *m,
                                      const fg_joint_fit_result *fit, unsigned threads,
                                      fg_measurement *corrected);
/* All of the loop's measurements. */
fg_status fg_scan_loop_correct_all(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_joint_fit_result *fit, fg_measurement *after);

/* In a tie, the dimensions under every explanation. */
fg_status fg_scan_loop_find_ranges(fg_context *ctx, fg_scan_loop *loop);
/* As ranges of those of `after`, which hold what is reported too. */
void fg_scan_loop_put_ranges(fg_scan_loop *loop);

/* What is tied leaves no more than it may; but of sets that do, one may leave far more than
 * another. Such a one is in the ranges and has no say in what is moved, nor in a model. */
bool fg_scan_loop_is_unlikely(const fg_explanations *explanations, size_t explanation);

/* What an explanation would move, unless it is far less likely than others: `corrected` are all
 * scans by its fit. In their order, the one in force first. */
fg_status fg_scan_loop_take_moves(fg_context *ctx, fg_scan_loop *loop, size_t explanation,
                                  const fg_joint_fit_result *fit, const fg_measurement *corrected);
/* Leaves in `after` of the corrections those that pay (pays.h). */
fg_status fg_scan_loop_keep_beneficial(fg_context *ctx, fg_scan_loop *loop);

#endif
