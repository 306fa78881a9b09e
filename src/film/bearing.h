/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing in its units, and the same without dimensions. */
#ifndef FG_FILM_BEARING_H
#define FG_FILM_BEARING_H

#include <math.h>

#include "film/film.h"
#include "foilgauge/film.h"
#include "foilgauge/stiffness.h"

/* Completes the report's clearance, compliance, stiffness, length and diameter, and fills the
 * perfect bearing. */
fg_status fg_film_describe(fg_context *ctx, fg_film_report *report, fg_film_bearing *perfect);

/* Reads the foils of options.foils into the bearing, which is the perfect one on entry. */
fg_status fg_film_read_foils(fg_context *ctx, fg_film_report *report, fg_film_bearing *bearing);

/* Takes clearances and stiffness of a report of `foilgauge stiffness`, which is parsed. */
struct cJSON;
fg_status fg_film_read_tested(fg_context *ctx, fg_film_report *report, const struct cJSON *root,
                              fg_film_bearing *bearing);

fg_film_mesh fg_film_mesh_of(const fg_film_report *report);

/* The case of a bearing under the options' load at a speed. */
void fg_film_case_fill(const fg_film_report *report, const fg_film *film,
                       const fg_film_bearing *bearing, double speed_rpm, fg_film_case *at);

/* Unit of critical masses at a speed: p_a R² / (C omega²). */
double fg_film_mass_unit_kg(const fg_film_report *report, double speed_rpm);
/* p_a R². */
double fg_film_load_unit_n(const fg_film_report *report);
double fg_film_speed_rad_s(double speed_rpm);

/* A critical mass over the perfect bearing's; NaN where that one is stable at every mass, or at
 * none. */
static inline double fg_film_mass_over(const fg_film_report *report, double mass_kg) {
  double perfect_kg = report->perfect.critical_mass_kg;
  return perfect_kg > 0 && isfinite(perfect_kg) ? mass_kg / perfect_kg : NAN;
}

/* Returns true for a rotor on a whole film, from which it does not fall. */
static inline bool fg_film_rests(const fg_film_result *result) {
  return result->outcome == FG_FILM_SOLVED && !fg_film_falls_off(result);
}

/* Mesh, case and state of one thread. */
typedef struct fg_film_workspace {
  fg_film film;
  fg_film_case at, before;
  fg_film_state state;
  fg_film_case spare_before; /* of fg_film_keep_film */
  fg_film_state spare;
  bool steady_only; /* no critical masses, which take most of the time, are asked for */
} fg_film_workspace;
fg_status fg_film_workspace_open(fg_context *ctx, const fg_film_report *report,
                                 fg_film_workspace *workspace);
void fg_film_workspace_close(fg_film_workspace *workspace);

/* Solves a bearing at a speed from nothing, or on from the workspace's case `before` and state.
 * A bearing without a film is FG_OK with its outcome. `before` becomes the solved case. */
typedef enum fg_film_start { FG_FILM_AFRESH, FG_FILM_ONWARD } fg_film_start;
fg_status fg_film_solve_bearing(fg_context *ctx, const fg_film_report *report,
                                fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                double speed_rpm, fg_film_start start, fg_film_result *result);

/* The same from nothing, and where no whole film is found so, on from a faster rotor, and from
 * places towards the load: a bearing of pads may have a film before and behind a gap between them,
 * and one path finds one of both. */
fg_status fg_film_seek_film(fg_context *ctx, const fg_film_report *report,
                            fg_film_workspace *workspace, const fg_film_bearing *bearing,
                            double speed_rpm, fg_film_result *result);

/* The last of these ways alone, which finds films under heavy loads. */
fg_status fg_film_solve_from_places(fg_context *ctx, const fg_film_report *report,
                                    fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                    double speed_rpm, fg_film_result *result);

/* Another film on which the rotor rests at the options' speed than that at a place. */
fg_status fg_film_seek_beside(fg_context *ctx, const fg_film_report *report,
                              fg_film_workspace *workspace, const fg_film_bearing *bearing,
                              const double place[2], fg_film_result *result, bool *found);

/* The workspace's case and state, to return to. */
typedef struct fg_film_mark {
  fg_film_state state;
  fg_film_case before;
} fg_film_mark;
fg_status fg_film_mark_open(fg_context *ctx, const fg_film_workspace *workspace,
                            fg_film_mark *mark);
void fg_film_mark_return(const fg_film_mark *mark, fg_film_workspace *workspace);
void fg_film_mark_close(fg_film_mark *mark);

/* On from the workspace's case and state, to whichever film that leads. */
fg_status fg_film_change_film(fg_context *ctx, const fg_film_report *report,
                              fg_film_workspace *workspace, const fg_film_bearing *bearing,
                              double speed_rpm, fg_film_result *result);

/* On from the workspace's case and state along one film: where it touches, ends, or gives way to
 * another one behind a gap between pads, the outcome is none or touching, and case and state stay.
 * The next step must be a short one. */
fg_status fg_film_keep_film(fg_context *ctx, const fg_film_report *report,
                            fg_film_workspace *workspace, const fg_film_bearing *bearing,
                            double speed_rpm, fg_film_result *result);

/* Draws the random bearings; the state of the perfect one is the workspace's. */
fg_status fg_film_draw(fg_context *ctx, fg_film_report *report, const fg_film_bearing *perfect,
                       const fg_film_workspace *workspace);

/* NULL for an unknown id. */
const fg_stiffness_model *fg_film_stiffness_model(const char *id);

/* Fills the sensitivities of the critical mass, where the options ask; the workspace's state is
 * that of the perfect bearing, before and after. */
fg_status fg_film_find_sensitivities(fg_context *ctx, fg_film_report *report,
                                     const fg_film_bearing *perfect, fg_film_workspace *workspace);
/* Changes a bump's parameter by percents. */
void fg_film_change_bump(const fg_film_sensitivity *sensitivity, double pct, size_t bump,
                         fg_film_bearing *bearing);
/* Draws bearings whose parameter scatters by one percent from bump to bump. */
fg_status fg_film_draw_scatter(fg_context *ctx, fg_film_report *report,
                               const fg_film_bearing *perfect, const fg_film_workspace *solved,
                               fg_film_sensitivity *scatter);

/* Draws bearings whose clearances differ from the perfect one's by up to `spread_mm`, each bump by
 * itself (uniform), or from the measured one's by their uncertainties. The result's array is the
 * caller's to free. */
fg_status fg_film_draw_spread(fg_context *ctx, fg_film_report *report,
                              const fg_film_bearing *perfect, const fg_film_workspace *solved,
                              double spread_mm, size_t count, fg_film_draws *draws);
fg_status fg_film_draw_measured(fg_context *ctx, fg_film_report *report,
                                const fg_film_workspace *solved, size_t count,
                                fg_film_draws *draws);

/* Finds the perfect bearing's threshold speed and the tolerances on the clearance, where the
 * options ask; the workspace's state is that of the perfect bearing, before and after. */
fg_status fg_film_find_tolerance(fg_context *ctx, fg_film_report *report,
                                 const fg_film_bearing *perfect, fg_film_workspace *workspace);
/* Compares a bearing's threshold speed with the perfect one's, on from the workspace's state. */
fg_status fg_film_compare_threshold(fg_context *ctx, const fg_film_report *report,
                                    fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                    fg_film_threshold_verdict *threshold);
/* Threshold speed of a bearing among the options' speeds; NaN: none. The workspace's film is that
 * below it. */
fg_status fg_film_find_threshold_speed(fg_context *ctx, const fg_film_report *report,
                                       fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                       double *rpm);

/* Finds the uncertainties of the measured bearing's results; the workspace's state is its own. */
fg_status fg_film_find_uncertainty(fg_context *ctx, fg_film_report *report,
                                   const fg_film_workspace *workspace);

/* Finds the largest load and the lift-off speed of the bearing, which is solved. */
fg_status fg_film_find_capacity(fg_context *ctx, fg_film_report *report,
                                fg_film_workspace *workspace);

/* Holds a measured lift-off speed, where the options have one, against the bearing; behind
 * fg_film_find_capacity. */
fg_status fg_film_hold_lift_off(fg_context *ctx, fg_film_report *report,
                                fg_film_workspace *workspace);

/* Reads the bore's profile, where there is one; adds it to the clearances. */
fg_status fg_film_read_bore(fg_context *ctx, fg_film_report *report);
void fg_film_add_bore(const fg_film_report *report, fg_film_bearing *bearing);

/* Integrates the orbit of the workspace's solved bearing, where the options ask for one. */
fg_status fg_film_follow_orbit(fg_context *ctx, fg_film_report *report,
                               fg_film_workspace *workspace);

/* Finds the whirls of the rotor on the workspace's solved bearing. */
typedef struct fg_film_modes {
  fg_film_mode mode[FG_FILM_MODES];
  size_t count;
} fg_film_modes;
fg_status fg_film_find_modes(fg_context *ctx, const fg_film_report *report,
                             fg_film_workspace *workspace, fg_film_result *result,
                             fg_film_modes *modes);

/* Fills the stability map and finds the thresholds. */
fg_status fg_film_map_speeds(fg_context *ctx, fg_film_report *report, fg_film_workspace *workspace);

#endif
