/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is found of one direction, and then of a bearing's directions together. */
#ifndef FG_LOAD_TEST_ANALYSIS_H
#define FG_LOAD_TEST_ANALYSIS_H

#include "load_test/strokes.h"

/* How far repeats of one thing lie apart over what their uncertainties say. */
typedef struct fg_load_scatter {
  double chi2, dof;
} fg_load_scatter;

/* max(1, sqrt(chi2 / freedom)) (R. T. Birge, The calculation of errors by the method of least
 * squares, Phys. Rev. 40, 1932); 1 without repeats. */
double fg_load_birge(const fg_load_scatter *scatter);

/* Readings that jump away from both neighbours and back, at most two together, are replaced by the
 * line between these, and flagged: one of them moves a contact, a turn or a loop by any amount. */
fg_status fg_load_bridge_outliers(fg_context *ctx, fg_load_test *test,
                                  fg_load_direction *direction);

typedef struct fg_load_findings {
  fg_load_scatter points, slopes;
  double compliance_mm_n; /* sum of both points' 1 / (dF/dx): what the threshold's u moves */
} fg_load_findings;

/* Between the strokes where the mean of both rises least: the load cell's zero, and the friction
 * that is passed without a foil; the place is that of strokes that have not drifted. NaN where no
 * such place stands out. */
typedef struct fg_load_zero {
  double force_n, friction_n, place_mm;
  double u_n; /* of both forces */
} fg_load_zero;
fg_status fg_load_find_zero(fg_context *ctx, const fg_load_strokes *strokes, fg_load_zero *zero);

/* Clearance of the loading and of the unloading strokes, and where the loading ones pass
 * zero + T and zero - T; what each stroke has drifted. */
typedef struct fg_load_levels {
  double threshold_n, zero_n;
} fg_load_levels;
fg_status fg_load_find_points(fg_context *ctx, fg_load_strokes *strokes, fg_load_levels levels,
                              fg_load_direction *direction, fg_load_findings *findings);

/* Flags of contacts that contradict each other: push and pull on one side of the gap, loading and
 * unloading further apart than friction can part them. */
fg_status fg_load_check_contacts(fg_context *ctx, const fg_load_strokes *strokes, double gap_at_mm,
                                 fg_load_direction *direction);

/* Free travel, its u_repeat before repeats widen it; `yield_mm`: what both foils yield under the
 * threshold at most. */
void fg_load_find_gap(const fg_load_strokes *strokes, fg_load_zero zero, double yield_mm,
                      fg_load_direction *direction);

/* Whether a stroke goes as far as the record does, on one side. */
bool fg_load_stroke_reaches(const fg_load_stroke *stroke, const fg_load_direction *direction,
                            double low, double high, int side);

/* Course of the stiffness on both sides, its largest value. */
fg_status fg_load_find_stiffness(fg_context *ctx, const fg_load_strokes *strokes,
                                 fg_load_direction *direction, fg_load_findings *findings);

/* Whole strokes of a direction. */
typedef struct fg_load_loop_strokes {
  const fg_load_stroke **stroke;
  size_t count;
  double noise_mm;
} fg_load_loop_strokes;

/* Turning point of the strokes of a sense: force and place on the loading branch.
 * `compliance_mm_n`: dx/dF there. `found` is false where there are too few samples. */
typedef struct fg_load_turn {
  bool found;
  double force_n, u_force_n;
  double place_mm, u_place_mm; /* at that force */
  double compliance_mm_n;
} fg_load_turn;
fg_status fg_load_find_turn(fg_context *ctx, const fg_load_sample *samples,
                            const fg_load_loop_strokes *strokes, int sense, fg_load_turn *turn);

/* Area, secant, loss factors (need contacts and stiffness; without the stiffness's uncertainty,
 * which repeats widen); whether the loops give energy by more than U. */
fg_status fg_load_find_loops(fg_context *ctx, const fg_load_test *test,
                             const fg_load_strokes *strokes, const fg_load_zero *zero,
                             fg_load_direction *direction);

/* Friction over force. */
fg_status fg_load_find_friction(fg_context *ctx, const fg_load_strokes *strokes,
                                fg_load_direction *direction);

/* Of a bearing, from its directions with their final uncertainties. */
void fg_load_sum_bearing(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);
void fg_load_sum_hysteresis(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);

/* Of a bearing, from its pulls; needs its clearances. */
void fg_load_sum_break_away(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);

/* What test->options.lot says of the bearings. */
fg_status fg_load_predict(fg_context *ctx, fg_load_test *test);

#endif
