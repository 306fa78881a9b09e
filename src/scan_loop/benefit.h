/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a correction pays, dimension by dimension.
 *
 * A correction moves a dimension by m, which is known to u. Left as it is the dimension keeps the
 * error b that m estimates, E(m²) = b² + u²; moved, it gets u for b. Moving pays where b² > u²,
 * and m² - u² is what the data say of b²: m² > 2 u². Explanations i that the data cannot tell apart
 * ask for moves m_i, and one of them is true. A move t leaves |m_i - t|² of |m_i|², over all values
 * of the dimension: it gains 2 t·m_i - |t|². What gains most where it gains least is the shortest
 * t between the m_i (of their convex hull, Wolfe 1976): there t·m_i >= |t|², so that it gains |t|²
 * at least, whichever is true. That is what the explanations agree about; where they pull apart it
 * is nothing. Their mean is best on average: t goes from the shortest one towards it as far as each
 * keeps half of that gain. u² is then the mean of the u_i², and what is reported holds how far the
 * m_i lie from t as well.
 *
 * One dimension of all bumps of a foil, or of all discs of a scan, is decided as one, by sums of
 * squares: neighbours stay comparable. Scans of one foil are decided together.
 *
 * A foil's geometry is three numbers for each bump: R0, R and h (fg_corrected). They are decided
 * one by one, and all else follows from what is reported of them, so that a report never
 * contradicts itself: X = R0 + R - h, from (X, R, R0) angles and clearances; O and the bumps'
 * directions go with R0, thickness, residuals and edges with the corrected edges where anything is
 * moved.
 *
 * The u of a reported value holds the second moment about it of what the correction could be, all
 * explanations alike: moved, u² of the move; left, m² + u². */
#ifndef FG_SCAN_LOOP_BENEFIT_H
#define FG_SCAN_LOOP_BENEFIT_H

#include "effect_search/effect_search.h"
#include "foilgauge/foil.h"

enum { FG_BENEFIT_EXPLANATIONS_MAX = FG_EXPLANATIONS_MAX + 1 };

/* A bump's or a disc's numbers in the order of fg_corrected, mm; a disc has R only, else NaN. */
typedef struct fg_benefit_item {
  double u[FG_CORRECTED]; /* own, as measured */
  double move[FG_BENEFIT_EXPLANATIONS_MAX][FG_CORRECTED];
  double turn_deg[FG_BENEFIT_EXPLANATIONS_MAX]; /* of a bump's direction from O */
  double noise[FG_CORRECTED][FG_CORRECTED];     /* sum of covariances of the moves, mm² */
} fg_benefit_item;

/* What the explanations would do to one foil, or to the discs of one scan. */
typedef struct fg_benefit {
  fg_benefit_item *item; /* owned; the bumps, and behind them R0 alone; or the discs */
  size_t items;
  fg_point centre[FG_BENEFIT_EXPLANATIONS_MAX]; /* moves of O */
  size_t explanations;                          /* that could be measured; the first is in force */
  double noises;                                /* sums in `noise` */
  bool misfit; /* the explanation in force leaves more than noise: the fit's own u is too small */
  bool curve;  /* an explanation holds a free curve */
  bool lost;   /* the explanation in force does not show the same bumps: nothing is known */
} fg_benefit;

/* Of every foil, and of the discs, of one measurement. */
typedef struct fg_benefits {
  fg_benefit *foil; /* owned */
  size_t foils;
  fg_benefit discs;
} fg_benefits;

fg_status fg_benefits_open(fg_context *ctx, const fg_measurement *before, fg_benefits *benefits);
void fg_benefits_close(fg_benefits *benefits);

/* One explanation: the measurement as it corrects it. The first is the one in force. */
void fg_benefits_add(fg_benefits *benefits, const fg_measurement *before,
                     const fg_measurement *corrected);
/* A number of the correction that lies elsewhere by its standard uncertainty makes `stepped` of
 * `corrected`. */
void fg_benefits_add_step(fg_benefits *benefits, const fg_measurement *corrected,
                          const fg_measurement *stepped);
/* Adds a covariance of (R0, R, h), mm²; the caller counts `noises`. */
void fg_benefit_add_noise(fg_benefit *benefit, size_t item,
                          double noise[FG_CORRECTED][FG_CORRECTED]);

/* What came of it: told, and how much of every explanation's move is made (0: left; sum 1). */
typedef struct fg_benefit_decision {
  fg_correction_choice choice[FG_CORRECTED];
  double part[FG_CORRECTED][FG_BENEFIT_EXPLANATIONS_MAX];
} fg_benefit_decision;

/* Decides about all of `pay` as one; every decision tells its own numbers. */
void fg_benefit_decide(const fg_benefit *const *benefit, size_t count,
                       fg_benefit_decision *const *decision);

/* By how much one item is moved, and the second moment of (R0, R, h) about what is reported. */
void fg_benefit_move(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                     double move[FG_CORRECTED]);
void fg_benefit_moment(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                       double moment[FG_CORRECTED][FG_CORRECTED]);

/* Whether everything is what the one explanation says: then what it measured stands. */
bool fg_benefit_is_whole(const fg_benefit *benefit, const fg_benefit_decision *decision);
bool fg_benefit_is_moved(const fg_correction_choice choice[FG_CORRECTED]);

/* ---- what is reported (kept.c) ---- */

typedef struct fg_benefit_foil {
  const fg_measurement *m; /* of its design and nominal values */
  const fg_foil *before;
  const fg_benefit *benefit;
  const fg_benefit_decision *decision;
} fg_benefit_foil;

/* Values, flags and choices: `after` is what the explanation in force makes of the foil. Where that
 * is what is reported it stays; else its u_ become those of its circles alone. */
fg_status fg_benefit_keep_foil(fg_context *ctx, const fg_benefit_foil *of, fg_foil *after);
/* Adds the correction's doubt to what follows from (X, R, R0). */
void fg_benefit_widen_foil(const fg_benefit_foil *of, fg_foil *after);

/* The same of discs. */
void fg_benefit_keep_discs(const fg_measurement *before, const fg_benefit *benefit,
                           const fg_benefit_decision *decision, fg_measurement *after);
void fg_benefit_widen_discs(const fg_benefit *benefit, const fg_benefit_decision *decision,
                            fg_measurement *after);

#endif
