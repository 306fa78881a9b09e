/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stages of the analysis of one direction, and of a bearing's directions together. */
#ifndef FG_LOAD_TEST_ANALYSIS_H
#define FG_LOAD_TEST_ANALYSIS_H

#include "load_test/strokes.h"

/* Observed over expected scatter of repeats. */
typedef struct fg_load_scatter {
  double chi2, dof;
} fg_load_scatter;

/* Returns max(1, sqrt(chi2 / dof)) (R. T. Birge, The calculation of errors by the method of least
 * squares, Phys. Rev. 40, 1932); 1 without repeats. */
double fg_load_birge(const fg_load_scatter *scatter);

/* Replaces isolated wrong readings by the line between their neighbours, and flags them: at most
 * two successive readings that jump away from both neighbours and back. One of them would move a
 * contact, a turn or a loop by any amount. */
fg_status fg_load_bridge_outliers(fg_context *ctx, fg_load_test *test,
                                  fg_load_direction *direction);

typedef struct fg_load_findings {
  fg_load_scatter points, slopes;
  double compliance_mm_n; /* sum of both points' 1 / (dF/dx): sensitivity of the clearance to the
                             threshold */
} fg_load_findings;

/* Place between the strokes where the slope of their mean is smallest: the load cell's zero, and
 * the friction without foil contact; the place is corrected for drift. NaN where no such place
 * stands out. */
typedef struct fg_load_zero {
  double force_n, friction_n, place_mm;
  double u_n; /* of both forces */
} fg_load_zero;
fg_status fg_load_find_zero(fg_context *ctx, const fg_load_strokes *strokes, fg_load_zero *zero);

/* Clearance of the loading and of the unloading strokes, the places where the loading ones pass
 * zero + T and zero - T, and each stroke's drift. */
typedef struct fg_load_levels {
  double threshold_n, zero_n;
} fg_load_levels;
fg_status fg_load_find_points(fg_context *ctx, fg_load_strokes *strokes, fg_load_levels levels,
                              fg_load_direction *direction, fg_load_findings *findings);

/* Flags contacts that contradict each other: push and pull on one side of the gap, loading and
 * unloading further apart than friction explains. */
fg_status fg_load_check_contacts(fg_context *ctx, const fg_load_strokes *strokes, double gap_at_mm,
                                 fg_load_direction *direction);

/* Finds the free travel, with its u_repeat before widening by repeats; `yield_mm`: maximum
 * deflection of both foils under the threshold. */
void fg_load_find_gap(const fg_load_strokes *strokes, fg_load_zero zero, double yield_mm,
                      fg_load_direction *direction);

/* Returns true when a stroke covers the record's range on one side. */
bool fg_load_stroke_reaches(const fg_load_stroke *stroke, const fg_load_direction *direction,
                            double low, double high, int side);

/* Finds the stiffness profile on both sides, and its maximum. */
fg_status fg_load_find_stiffness(fg_context *ctx, const fg_load_strokes *strokes,
                                 fg_load_direction *direction, fg_load_findings *findings);

/* Whole strokes of a direction. */
typedef struct fg_load_loop_strokes {
  const fg_load_stroke **stroke;
  size_t count;
  double noise_mm;
} fg_load_loop_strokes;

/* Turning point of the strokes of a sense: force and place on the loading branch.
 * `compliance_mm_n`: dx/dF there. `found` is false for too few samples. */
typedef struct fg_load_turn {
  bool found;
  double force_n, u_force_n;
  double place_mm, u_place_mm; /* at that force */
  double compliance_mm_n;
} fg_load_turn;
fg_status fg_load_find_turn(fg_context *ctx, const fg_load_sample *samples,
                            const fg_load_loop_strokes *strokes, int sense, fg_load_turn *turn);

/* Finds area, secant and loss factors (needs contacts and stiffness; without the stiffness's
 * uncertainty, which repeats widen); flags loops that release energy by more than U. */
fg_status fg_load_find_loops(fg_context *ctx, const fg_load_test *test,
                             const fg_load_strokes *strokes, const fg_load_zero *zero,
                             fg_load_direction *direction);

/* Finds the friction as a function of force. */
fg_status fg_load_find_friction(fg_context *ctx, const fg_load_strokes *strokes,
                                fg_load_direction *direction);

/* Sums up a bearing from its directions with their final uncertainties. */
void fg_load_sum_bearing(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);
void fg_load_sum_hysteresis(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);

/* Sums up a bearing's pulls; needs its clearances. */
void fg_load_sum_break_away(const fg_load_test *test, size_t bearing, fg_load_bearing *sum);

/* Predicts the bearings from the lot in test->options.lot. */
fg_status fg_load_predict(fg_context *ctx, fg_load_test *test);

#endif
