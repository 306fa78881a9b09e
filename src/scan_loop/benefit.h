/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Benefit of a correction, dimension by dimension.
 *
 * A correction moves a dimension by m, with standard uncertainty u. Uncorrected, the dimension
 * keeps the error b that m estimates, E(m²) = b² + u²; corrected, it has u instead of b. The
 * correction has a benefit where b² > u². The estimate of b² is m² - u², so the condition is m² > 2
 * u².
 *
 * Explanations i that the data cannot tell apart propose moves m_i, and one of them is true. A move
 * t leaves |m_i - t|² of |m_i|², over all values of the dimension: its gain is 2 t·m_i - |t|². The
 * move of the largest minimum gain is the shortest vector t of the convex hull of the m_i (Wolfe
 * 1976): there t·m_i >= |t|², so the gain is at least |t|², whichever explanation is true. It is
 * the part that the explanations agree about, and 0 where they contradict each other. The mean of
 * the m_i is best on average: t moves from the shortest vector towards the mean as far as each
 * explanation keeps half of that gain. u² is then the mean of the u_i², and the reported
 * uncertainty includes the distances of the m_i from t.
 *
 * One dimension of all bumps of a foil, or of all discs of a scan, is decided at once, by sums of
 * squares, so that neighbours stay comparable. Scans of one foil are decided together.
 *
 * A foil's geometry is three numbers for each bump: R0, R and h (fg_corrected). They are decided
 * one by one, and everything else follows from the reported values, so that a report never
 * contradicts itself: X = R0 + R - h, from (X, R, R0) angles and clearances; O and the bumps'
 * directions follow R0, thickness, residuals and edges follow the corrected edges when any
 * dimension is moved.
 *
 * Where evidence weighs the explanations, t is the weighted mean of the m_i, and u² includes their
 * weighted scatter about it: nothing is nearer.
 *
 * The u of a reported value includes the second moment, about that value, of the possible
 * corrections, all explanations with equal weight where none is known: moved, u² of the move; left,
 * m² + u². */
#ifndef FG_SCAN_LOOP_BENEFIT_H
#define FG_SCAN_LOOP_BENEFIT_H

#include "effect_search/effect_search.h"
#include "foilgauge/foil.h"

enum { FG_BENEFIT_EXPLANATIONS_MAX = FG_EXPLANATIONS_MAX + 1 };

/* Numbers of a bump or a disc in the order of fg_corrected, mm; a disc has R only, else NaN. */
typedef struct fg_benefit_item {
  double u[FG_CORRECTED]; /* own, as measured */
  double move[FG_BENEFIT_EXPLANATIONS_MAX][FG_CORRECTED];
  double turn_deg[FG_BENEFIT_EXPLANATIONS_MAX]; /* of a bump's direction from O */
  double noise[FG_CORRECTED][FG_CORRECTED];     /* sum of covariances of the moves, mm² */
} fg_benefit_item;

/* Moves that the explanations propose for one foil, or for the discs of one scan. */
typedef struct fg_benefit {
  fg_benefit_item *item; /* owned; the bumps, and after them R0 alone; or the discs */
  size_t items;
  fg_point centre[FG_BENEFIT_EXPLANATIONS_MAX]; /* moves of O */
  size_t explanations;                          /* measured successfully; the first is in force */
  double weight[FG_BENEFIT_EXPLANATIONS_MAX];   /* of explanations, where `mean`; 0: equal */
  double noises;                                /* number of sums in `noise` */
  bool misfit;  /* the residual of the explanation in force exceeds noise: the fit's own u is too
                   small */
  bool curve;   /* an explanation holds a free curve */
  bool mean;    /* the mean of its moves is that over all models by their evidence: nothing is
                   nearer */
  bool refused; /* by known sizes, from which the corrected ones lie farther */
  bool lost;    /* the explanation in force does not show the same bumps: the moves are unknown */
} fg_benefit;

/* Benefits of every foil, and of the discs, of one measurement. */
typedef struct fg_benefits {
  fg_benefit *foil; /* owned */
  size_t foils;
  fg_benefit discs;
} fg_benefits;

fg_status fg_benefits_open(fg_context *ctx, const fg_measurement *before, fg_benefits *benefits);
void fg_benefits_close(fg_benefits *benefits);

/* Weights that evidence gives the explanations, in the order in which they are added. */
typedef struct fg_benefit_weights {
  const double *weight;
  size_t count;
  bool curve, loose; /* the explanation in force holds a free curve; one that is loose */
} fg_benefit_weights;

void fg_benefits_weigh(fg_benefits *benefits, const fg_benefit_weights *weights);
/* Returns the share of one explanation in the mean. */
double fg_benefit_weight(const fg_benefit *benefit, size_t explanation);

/* Adds one explanation by its corrected measurement. The first one added is the one in force. */
void fg_benefits_add(fg_benefits *benefits, const fg_measurement *before,
                     const fg_measurement *corrected);
/* Adds the uncertainty of one number of the correction: `stepped` is `corrected` with that number
 * moved by its standard uncertainty. */
void fg_benefits_add_step(fg_benefits *benefits, const fg_measurement *corrected,
                          const fg_measurement *stepped);
/* Adds a covariance of (R0, R, h), mm²; the caller counts `noises`. */
void fg_benefit_add_noise(fg_benefit *benefit, size_t item,
                          double noise[FG_CORRECTED][FG_CORRECTED]);

/* Decision: its reason code, and the share of every explanation's move that is made (0: left; sum
 * 1). */
typedef struct fg_benefit_decision {
  fg_correction_choice choice[FG_CORRECTED];
  double part[FG_CORRECTED][FG_BENEFIT_EXPLANATIONS_MAX];
} fg_benefit_decision;

/* Decides all of `benefit` as one; every decision reports its own numbers. */
void fg_benefit_decide(const fg_benefit *const *benefit, size_t count,
                       fg_benefit_decision *const *decision);

/* Computes the move of one item, and the second moment of (R0, R, h) about the reported values. */
void fg_benefit_move(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                     double move[FG_CORRECTED]);
void fg_benefit_moment(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                       double moment[FG_CORRECTED][FG_CORRECTED]);

/* Returns true when the decision equals the explanation in force: then its measurement stands. */
bool fg_benefit_is_whole(const fg_benefit *benefit, const fg_benefit_decision *decision);
bool fg_benefit_is_moved(const fg_correction_choice choice[FG_CORRECTED]);

/* ---- reported values (kept.c) ---- */

typedef struct fg_benefit_foil {
  const fg_measurement *m; /* for its design and nominal values */
  const fg_foil *before;
  const fg_benefit *benefit;
  const fg_benefit_decision *decision;
} fg_benefit_foil;

/* Sets values, flags and choices: `after` is the foil as corrected by the explanation in force.
 * Where its values are reported they stay; else its u_ become those of its circles alone. */
fg_status fg_benefit_keep_foil(fg_context *ctx, const fg_benefit_foil *of, fg_foil *after);
/* Adds the correction's uncertainty to everything that follows from (X, R, R0). */
void fg_benefit_widen_foil(const fg_benefit_foil *of, fg_foil *after);

/* As fg_benefit_keep_foil and fg_benefit_widen_foil, for discs. */
void fg_benefit_keep_discs(const fg_measurement *before, const fg_benefit *benefit,
                           const fg_benefit_decision *decision, fg_measurement *after);
void fg_benefit_widen_discs(const fg_benefit *benefit, const fg_benefit_decision *decision,
                            fg_measurement *after);

#endif
