/* Whether a correction pays, dimension by dimension.
 *
 * A correction moves a dimension by m, which is known to u. Left as it is the dimension keeps the
 * error b that m estimates, E(m²) = b² + u²; moved, it gets u for b. Moving pays where b² > u²,
 * and m² - u² is what the data say of b²: m² > 2 u². Explanations i that the data cannot tell apart
 * count alike: m is the mean of their m_i, u² the mean of their u_i² and how the m_i scatter about
 * m; and since only one of them is true, moving by m must bring the dimension nearer to every m_i.
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
 * The u of a reported value holds the second moment about it of what the correction could be:
 * moved, u² of the move; left, m² + u². */
#ifndef FG_SCAN_LOOP_PAYS_H
#define FG_SCAN_LOOP_PAYS_H

#include "explain/explain.h"
#include "foilgauge/foil.h"

enum { FG_PAYS_EXPLANATIONS_MAX = FG_EXPLANATIONS_MAX + 1 };

/* A bump's or a disc's numbers in the order of fg_corrected, mm; a disc has R only, else NaN. */
typedef struct fg_pay_item {
  double u[FG_CORRECTED]; /* own, as measured */
  double move[FG_PAYS_EXPLANATIONS_MAX][FG_CORRECTED];
  double turn_deg[FG_PAYS_EXPLANATIONS_MAX]; /* of a bump's direction from O */
  double noise[FG_CORRECTED][FG_CORRECTED];  /* sum of covariances of the moves, mm² */
} fg_pay_item;

/* What the explanations would do to one foil, or to the discs of one scan. */
typedef struct fg_pay {
  fg_pay_item *item; /* owned; the bumps, and behind them R0 alone; or the discs */
  size_t items;
  fg_point centre[FG_PAYS_EXPLANATIONS_MAX]; /* moves of O */
  size_t explanations;                       /* that could be measured; the first is in force */
  double noises;                             /* sums in `noise` */
  bool misfit; /* the explanation in force leaves more than noise: the fit's own u is too small */
  bool lost; /* the explanation in force does not show the same bumps: nothing is known */
} fg_pay;

/* Of every foil, and of the discs, of one measurement. */
typedef struct fg_pays {
  fg_pay *foil; /* owned */
  size_t foils;
  fg_pay discs;
} fg_pays;

fg_status fg_pays_open(fg_context *ctx, const fg_measurement *before, fg_pays *pays);
void fg_pays_close(fg_pays *pays);

/* One explanation: the measurement as it corrects it. The first is the one in force. */
void fg_pays_add(fg_pays *pays, const fg_measurement *before, const fg_measurement *corrected);
/* A number of the correction that lies elsewhere by its standard uncertainty makes `stepped` of
 * `corrected`. */
void fg_pays_add_step(fg_pays *pays, const fg_measurement *corrected,
                      const fg_measurement *stepped);
/* Adds a covariance of (R0, R, h), mm²; the caller counts `noises`. */
void fg_pay_add_noise(fg_pay *pay, size_t item, double noise[FG_CORRECTED][FG_CORRECTED]);

/* Decides about all of `pay` as one; `choice`, FG_CORRECTED for each, tells its own numbers. */
void fg_pay_decide(const fg_pay *const *pay, size_t count, fg_correction_choice *const *choice);

/* Mean of the moves of one item, and the second moment of (R0, R, h) about what is reported. */
void fg_pay_mean(const fg_pay *pay, size_t item, double mean[FG_CORRECTED]);
void fg_pay_moment(const fg_pay *pay, size_t item, const fg_correction_choice *choice,
                   double moment[FG_CORRECTED][FG_CORRECTED]);

/* Whether everything is what the one explanation says: then what it measured stands. */
bool fg_pay_is_whole(const fg_pay *pay, const fg_correction_choice choice[FG_CORRECTED]);

bool fg_pay_is_moved(const fg_correction_choice choice[FG_CORRECTED]);

/* ---- what is reported (kept.c) ---- */

typedef struct fg_pay_foil {
  const fg_measurement *m; /* of its design and nominal values */
  const fg_foil *before;
  const fg_pay *pay;
  const fg_correction_choice *choice; /* FG_CORRECTED */
} fg_pay_foil;

/* Values, flags and choices: `after` is what the explanation in force makes of the foil. Where that
 * is what is reported it stays; else its u_ become those of its circles alone. */
fg_status fg_pay_keep_foil(fg_context *ctx, const fg_pay_foil *of, fg_foil *after);
/* Adds the correction's doubt to what follows from (X, R, R0). */
void fg_pay_widen_foil(const fg_pay_foil *of, fg_foil *after);

/* The same of discs. */
void fg_pay_keep_discs(const fg_measurement *before, const fg_pay *pay,
                       const fg_correction_choice *choice, fg_measurement *after);
void fg_pay_widen_discs(const fg_pay *pay, const fg_correction_choice *choice,
                        fg_measurement *after);

#endif
