/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the loop on scans, shared by its files. */
#ifndef FG_SCAN_LOOP_STATE_H
#define FG_SCAN_LOOP_STATE_H

#include "effect_search/cross_fit.h"
#include "effect_search/effect_search.h"
#include "effect_search/joint_fit.h"
#include "effect_search/width_search.h"
#include "evidence/displacement.h"
#include "foilgauge/loop.h"
#include "foilgauge/scan_loop.h"
#include "rows/edge_fit.h"
#include "scan_loop/benefit.h"
#include "scan_loop/bumps.h"
#include "scan_loop/scanner_model_tone.h"

/* Lowest and highest value of a dimension over the tied explanations. */
typedef struct fg_scan_loop_range {
  double radius_mm[2], height_mm[2];
} fg_scan_loop_range;

struct fg_scan_loop {
  fg_scan_loop_options options;
  fg_measurement *before, *after; /* one per scan */
  bool *hold_out;
  size_t scan_count;
  size_t left_out;                          /* foils without measurement, or not of the design */
  fg_edge_fit edge_fit;                     /* all views; geometry of the final model */
  fg_explanations explanations;             /* sets tried, and those that explain */
  fg_effect_set set;                        /* the winner, fitted */
  double *residual_before, *residual_after; /* um, per row of the edge fit */
  fg_scan_loop_error error_before, error_after;
  fg_cross_fit cross_fit;       /* no folds: scans are held out, or no effect was found */
  bool by_evidence;             /* evidence decided: the correction is its mean over all models */
  double edge_error_um, margin; /* by evidence: error of the edge's model, and the gain over it, ln,
                                   from which a deviation counts; 0: none */
  bool misfit; /* no model follows all of the residual, or the foil alone may be the cause */
  bool beside_foil_field; /* one scan: the scanner's share is seen beside a free form of the foil */
  bool scanner_is_suspect;      /* an explanation holds what a scanner does */
  fg_displacement displacement; /* of the scanner, by evidence */
  fg_field_map map; /* owned; likewise, for other scans; mm: NULL: the set's fields are */
  fg_displacement_part *displacement_parts; /* owned; per part of the edge fit */
  fg_displacement_part *unseen_parts;       /* owned; likewise: by what the scanner may do unseen */
  fg_form_error *form_errors; /* owned; per circle of the parts (circles.h); NULL: not found */
  double noise_floor_um;
  bool tied;
  bool scale_tied;                        /* in scale_uncertainty.c */
  fg_effect_set tie[FG_EXPLANATIONS_MAX]; /* the other explanations, fitted */
  /* Of each, chi² over that of the likeliest; above FG_UNLIKELY_CHI2 it is in the ranges, but has
   * no influence on corrections. */
  double tie_excess[FG_EXPLANATIONS_MAX];
  size_t tie_count;
  fg_scan_loop_range *
      *ranges;             /* per scan and foil: bump_count + 1 (the last: overall); NULL: no tie */
  fg_benefits *benefits;   /* per scan: moves by the explanations; NULL: no effects */
  fg_width_findings width; /* effects that move the strip's edges apart; beside the set in force */
  fg_scan_loop_bumps bumps; /* the bumps of `after` against the declared springback model */
  fg_model_tone tone;       /* edge level of the discs of known diameter */
  int levelled;             /* how often the edges were moved to that level */
  double level_half;        /* where they are */
  fg_scatter scatter_min;   /* of the edges of discs, over the searches by evidence */
  double gauge_um;          /* standard deviation of known radii, by evidence */
  double u_scale; /* relative, by known diameters that show no scale; 0: they do not bound it */
  fg_loop_outcome verdict;
  fg_scan_result result; /* public result */
};

/* Runs the loop on measured scans of one resolution; takes ownership of them. */
fg_status fg_scan_loop_run_measured(fg_context *ctx, fg_measurement *measurements,
                                    const bool *hold_out, size_t count,
                                    const fg_scan_loop_options *options, fg_scan_loop **result);

/* Marks foils that are not of the design as not measured, and counts them. FG_ERR_NOT_MEASURED when
 * no foil is left. */
fg_status fg_scan_loop_leave_out(fg_context *ctx, fg_scan_loop *loop);
/* Adds a note for each foil left out, and for each stretch of the others that no fit holds. */
fg_status fg_scan_loop_note_left_out(fg_context *ctx, fg_scan_loop *loop);

/* Weighs the search's explanation against all named effects and all rivals by their evidence. */
fg_status fg_scan_loop_weigh_evidence(fg_context *ctx, fg_scan_loop *loop);
/* Gives a fit the uncertainties of the mean over all models. */
void fg_scan_loop_set_uncertainties(const fg_scan_loop *loop, fg_joint_fit_result *fit);

/* Finds deviations of single bumps where the search found none, and adds them to the set. */
fg_status fg_scan_loop_find_single_bumps(fg_context *ctx, fg_scan_loop *loop);

/* Under same_foil, once the search has converged: FG_ERR_DATA when the scans show different foils.
 */
fg_status fg_scan_loop_check_one_foil(fg_context *ctx, const fg_scan_loop *loop);

/* Computes held-out errors of the set in force; adds a note when they did not fall. */
fg_status fg_scan_loop_find_held_out(fg_context *ctx, fg_scan_loop *loop);
fg_status fg_scan_loop_note_held_out(fg_context *ctx, fg_scan_loop *loop);
/* "bumps"; NULL: no cross-fit. */
const char *fg_scan_loop_fold_of(const fg_scan_loop *loop);

/* Marks a stretch of the part as tied when a scale of the scanner would explain it as well. */
fg_status fg_scan_loop_scale_uncertainty(fg_context *ctx, fg_scan_loop *loop);

/* Copies a measurement with corrected edges and measures its foils and discs again: fields move an
 * edge by d(x, y). NULL: no fields. */
fg_status fg_scan_loop_correct(fg_context *ctx, const fg_measurement *m,
                               const fg_field_list *fields, unsigned threads,
                               fg_measurement *corrected);

/* Corrects by the scanner's fields of a joint fit to these edges, with the uncertainties that they
 * add. Effects of the part move no edge: they are form. */
fg_status fg_scan_loop_correct_fitted(fg_context *ctx, const fg_measurement *m,
                                      const fg_joint_fit_result *fit, unsigned threads,
                                      fg_measurement *corrected);
/* Corrects all of the loop's measurements. */
fg_status fg_scan_loop_correct_all(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_joint_fit_result *fit, fg_measurement *after);

/* Standard uncertainty of a known diameter if the design does not state it: a pin gauge within 1
 * um. */
#define FG_U_DIAMETER_MM 0.0005
static inline double fg_scan_loop_u_diameter_mm(const fg_measurement *measurement) {
  double stated_mm = measurement->design.discs.u_diameters_mm;
  return stated_mm > 0 ? stated_mm : FG_U_DIAMETER_MM;
}

/* Tells what known diameters leave open where no scale was found, and from which size on one would
 * have shown. Needs the tone. */
fg_status fg_scan_loop_note_known_sizes(fg_context *ctx, fg_scan_loop *loop);
/* Returns true where the corrected radii of a scan's discs lie clearly farther from the known ones
 * than those before, beside a level and a scale. */
bool fg_scan_loop_gauges_refuse(const fg_scan_loop *loop, size_t scan);

/* Finds the edge level from the scans' discs of known diameter, together with a scale. After a
 * search it uses the discs as scanned or as corrected, whichever agree better. gauges is 0 where
 * the discs do not determine the level. */
fg_model_tone fg_scan_loop_find_tone(const fg_scan_loop *loop, bool searched);

/* Finds effects of the strip's width beside its stretch by the scanner. */
fg_status fg_scan_loop_find_width(fg_context *ctx, fg_scan_loop *loop);

/* Corrects all of the loop's measurements by the mean displacement of the scanner over all models;
 * the fit has the uncertainties that this adds. */
fg_status fg_scan_loop_correct_by_evidence(fg_context *ctx, const fg_scan_loop *loop,
                                           const fg_joint_fit_result *fit, fg_measurement *after);

/* Finds, in a tie, the dimensions under every explanation. */
fg_status fg_scan_loop_find_ranges(fg_context *ctx, fg_scan_loop *loop);
/* Writes the ranges of the dimensions of `after`, extended to the reported values. */
void fg_scan_loop_put_ranges(fg_scan_loop *loop);

/* Excess chi² of an explanation a hundred times less likely than the likeliest, 2 ln 100: the level
 * of the loop's claims. */
#define FG_UNLIKELY_CHI2 9.2

/* Returns true for an explanation much less likely than the first. All tied sets leave no more than
 * allowed, but one may leave far more than another. Such a set widens the ranges, but corrects
 * nothing and is in no model. */
bool fg_scan_loop_is_unlikely(const fg_explanations *explanations, size_t explanation);
/* Returns the excess, chi², of an explanation over that of the likeliest. */
double fg_scan_loop_excess_over_best(const fg_explanations *explanations, size_t explanation);

/* Records the moves of an explanation, unless it is unlikely: `corrected` are all scans by its fit.
 * Call in their order, the one in force first. */
fg_status fg_scan_loop_record_moves(fg_context *ctx, fg_scan_loop *loop, size_t explanation,
                                    const fg_joint_fit_result *fit,
                                    const fg_measurement *corrected);
/* Writes the form errors into the foils of `after`; notes where they are ranges or unknown. */
fg_status fg_scan_loop_put_form_errors(fg_context *ctx, fg_scan_loop *loop);

/* Widens the uncertainties of `after` by what the scanner may do unseen. */
void fg_scan_loop_widen_by_unseen(fg_scan_loop *loop);

/* Keeps in `after` only the corrections with a benefit (benefit.h). */
fg_status fg_scan_loop_keep_beneficial(fg_context *ctx, fg_scan_loop *loop);

#endif
