/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the report of `foilgauge film`. */
#ifndef FG_REPORT_FILM_MEMBERS_H
#define FG_REPORT_FILM_MEMBERS_H

#include <math.h>

#include "core/member.h"
#include "foilgauge/film.h"

/* Of an fg_film_result in an fg_film_report: also columns of tables and CSV. */
extern const fg_members fg_film_result_members;
/* The bearing, and beside it the perfect one where foils were measured; the speeds; the draws. */
fg_member_element fg_film_bearing_at, fg_film_speed_at, fg_film_draw_at;

/* Of an fg_film_share of the draws. */
extern const fg_members fg_film_share_members;
fg_member_element fg_film_share_at;

/* Of an fg_film_mode. */
extern const fg_members fg_film_mode_members;
fg_member_element fg_film_mode_at;

/* Of an fg_film_tolerance, an fg_film_uncertainty, an fg_film_lift_off. */
extern const fg_members fg_film_lift_off_members;
extern const fg_members fg_film_tolerance_members, fg_film_uncertainty_members;

/* Of an fg_film_report in a lot's report; whole: the film. */
extern const fg_members fg_film_of_lot_members;

extern const fg_document fg_film_document;

/* Of an fg_film_sensitivity. */
extern const fg_members fg_film_sensitivity_members;
fg_member_element fg_film_sensitivity_at;

/* Describes the draws: "1000 bearings of 3 different foils each, drawn from 40". */
void fg_film_draws_words(const fg_film_report *report, char *text, size_t size);

/* Says which tolerance on the clearance keeps the threshold speed. */
void fg_film_tolerance_words(const fg_film_report *report, char *text, size_t size);

/* Says how the orbit's amplitude goes on, and the critical masses of the draws over the perfect
 * bearing's. */
void fg_film_orbit_words(const fg_film_orbit *orbit, char *text, size_t size);
void fg_film_quantile_words(const fg_film_draws *draws, char *text, size_t size);

/* Returns true where the threshold lies at a speed at which the rotor has not lifted off. */
static inline bool fg_film_whirls_from_lift_off(const fg_film_report *report) {
  return report->threshold_rpm <= report->lift_off_rpm; /* false for NaN */
}

/* Returns true for a film on which rotors of all masses are stable, or none of them. */
static inline bool fg_film_is_alike(const fg_film_result *result) {
  bool at_none = result->critical_mass_kg <= 0 && isinf(result->stable_again_kg);
  return at_none || isinf(result->critical_mass_kg);
}

/* "stable", "unstable", "stable at every mass" or "unstable at every mass" for the rotor of the
 * report; NULL: not known. */
const char *fg_film_stability_word(const fg_film_report *report, const fg_film_result *result);

enum { FG_FILM_NOTES = 9, FG_FILM_NOTE = 400 };
/* Writes what the reader must know of this run; returns the number of notes. */
size_t fg_film_notes(const fg_film_report *report, char notes[FG_FILM_NOTES][FG_FILM_NOTE]);

#endif
