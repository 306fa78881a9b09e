/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/film/1" and its CSV files. */
#include "report/film/members.h"

#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "report/design/members.h"

static const fg_film_report *report_of(const fg_subject *subject) {
  return subject->whole;
}

/* ---- a bearing at one speed ---- */

enum { STABLE, UNSTABLE, STABLE_AT_EVERY_MASS, UNSTABLE_AT_EVERY_MASS };
static const char *const stability_words[] = {[STABLE] = "stable",
                                              [UNSTABLE] = "unstable",
                                              [STABLE_AT_EVERY_MASS] = "stable at every mass",
                                              [UNSTABLE_AT_EVERY_MASS] = "unstable at every mass",
                                              NULL};

static int find_stability(const fg_film_report *report, const fg_film_result *result) {
  if (isnan(result->critical_mass_kg)) return -1;
  if (fg_film_is_alike(result))
    return isinf(result->critical_mass_kg) ? STABLE_AT_EVERY_MASS : UNSTABLE_AT_EVERY_MASS;
  return fg_film_is_stable(result, report->options.rotor_mass_kg) ? STABLE : UNSTABLE;
}

const char *fg_film_stability_word(const fg_film_report *report, const fg_film_result *result) {
  int word = find_stability(report, result);
  return word < 0 ? NULL : stability_words[word];
}

static int find_stability_word(const fg_subject *s) {
  return find_stability(report_of(s), s->object);
}

static double find_whirl_hz(const fg_subject *s) {
  const fg_film_result *result = s->object;
  return result->whirl_ratio * result->speed_rpm / 60;
}

static const char *find_result_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  const fg_film_report *report = report_of(s);
  if (s->object == &report->perfect) return "as designed";
  if (s->object == &report->other_film) return "the same, another film";
  return fg_film_is_measured(&report->options) ? "as measured" : "as designed";
}

static double find_draw_number(const fg_subject *s) {
  size_t draw = ((const fg_film_result *)s->object)->draw;
  return draw ? (double)draw : NAN;
}

static bool lists_draws(const fg_subject *list) {
  return list->object == &report_of(list)->draws;
}

static bool lists_no_draws(const fg_subject *list) {
  return !lists_draws(list);
}

static bool lists_bearings(const fg_subject *list) {
  return list->object == report_of(list);
}

/* A column of all tables. */
#define RESULT(name, field, heading_, digits_)                                                     \
  FG_NUMBER(name, fg_film_result, field), .heading = (heading_), .csv = {.rank = 3},               \
                                          .page = {.rank = 3, .digits = (digits_)},                \
                                          .terminal = {.rank = 3, .digits = (digits_)}

static const fg_member result_rows[] = {
    {FG_TEXT_BY("bearing", find_result_name), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "bearing", .page = {.rank = 1}, .terminal = {.rank = 1}, .column = lists_bearings},
    {FG_COUNT_BY("draw", find_draw_number), .options = FG_MEMBER_NOT_IN_JSON, .csv = {.rank = 1},
     .column = lists_draws},
    {FG_WORD("outcome", fg_film_result, outcome, fg_film_outcome_words),
     .words =
         "touching: solved, with a film thinner than touching_um; unsolved: no steady film was "
         "found at this load",
     .heading = "film", .csv = {.rank = 2}, .page = {.rank = 2}, .terminal = {.rank = 2}},
    {RESULT("speed_rpm", speed_rpm, "speed,\nrpm", 6), .words = "of the rotor"},
    {RESULT("compressibility_number", compressibility, "Λ", 4),
     .words = "6 mu omega (R / C)² / p_a"},
    {RESULT("eccentricity_ratio", eccentricity, "e / C", 4),
     .words = "of the rotor, over the reference clearance: above 1 where foils yield"},
    {RESULT("attitude_deg", attitude_deg, "attitude,\n°", 4),
     .words = "from the load to the displaced rotor, in the sense of rotation"},
    {FG_PAIR("rotor_um", fg_film_result, place_um),
     .words = "place of the rotor from the bearing's centre: towards 0 degrees, towards 90"},
    {RESULT("min_film_um", min_film_um, "min film,\nµm", 4), .words = "thinnest film"},
    {FG_NUMBER("min_film_deg", fg_film_result, min_film_deg), .words = "where it is",
     .csv = {.rank = 3}},
    {RESULT("max_pressure_kpa", max_pressure_kpa, "max p,\nkPa", 4), .words = "absolute"},
    {RESULT("power_loss_w", power_w, "loss,\nW", 3), .words = "of the film's shear"},
    {RESULT("critical_mass_kg", critical_mass_kg, "critical\nmass, kg", 4),
     .words = "mass on this bearing from which on the rotor whirls (Pan 1964); null also where it "
              "is stable at every mass, 0 where it is stable at none"},
    {FG_NUMBER("stable_again_kg", fg_film_result, stable_again_kg), .csv = {.rank = 4},
     .column = lists_no_draws,
     .words = "mass from which on it does not whirl again; null: whirls at all above the critical "
              "mass"},
    {RESULT("whirl_ratio", whirl_ratio, "whirl\nratio", 3),
     .words = "whirl over speed at the critical mass"},
    {FG_NUMBER_BY("whirl_hz", find_whirl_hz), .words = "that whirl", .csv = {.rank = 3}},
    {RESULT("log_decrement", log_decrement, "log.\ndecrement", 3), .column = lists_no_draws,
     .words = "of the rotor's least stable whirl on its film; below 0 it grows; null: no whirl of "
              "its own, or not asked"},
    {FG_WORD_BY("stability", find_stability_word, stability_words), .heading = "rotor",
     .words = "of the rotor's mass", .csv = {.rank = 4}, .page = {.rank = 4},
     .terminal = {.rank = 4}, .column = lists_no_draws},
    {FG_NUMBER("mass_over_perfect", fg_film_result, mass_over_perfect), .csv = {.rank = 4},
     .words = "critical mass over that of the bearing as designed, at the same speed",
     .column = lists_draws},
};
const fg_members fg_film_result_members = FG_MEMBERS_DEFINED(result_rows, "result");

bool fg_film_bearing_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_film_report *report = report_of(list);
  const fg_film_result *row[3] = {&report->actual};
  size_t rows = 1;
  if (report->has_other_film) row[rows++] = &report->other_film;
  if (fg_film_is_measured(&report->options)) row[rows++] = &report->perfect;
  element->object = row[i < rows ? i : 0];
  return i < rows;
}

bool fg_film_speed_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &report_of(list)->by_speed[i];
  return i < report_of(list)->speed_count;
}

bool fg_film_draw_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &report_of(list)->draws.result[i];
  return i < report_of(list)->draws.count;
}

/* ---- stiffness and damping ---- */

static const fg_member coefficient_rows[] = {
    {FG_NUMBER("whirl_ratio", fg_film_coefficients, whirl_ratio), .words = "whirl over speed"},
    {FG_NUMBER("frequency_hz", fg_film_coefficients, frequency_hz), .words = "of the whirl"},
    {FG_NUMBERS("stiffness_n_um", fg_film_coefficients, stiffness_n_um),
     .words = "K: xx, xy, yx, yy; x towards 0 degrees, y towards 90"},
    {FG_NUMBERS("damping_n_s_mm", fg_film_coefficients, damping_n_s_mm),
     .words = "C: xx, xy, yx, yy"},
};
static const fg_members coefficient_members = FG_MEMBERS(coefficient_rows);

/* ---- the field ---- */

static const double *list_pressures(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = report_of(s)->nodes;
  return ((const fg_film_column *)s->object)->pressure_kpa;
}

static const fg_member column_rows[] = {
    {FG_COUNT("pad", fg_film_column, pad), .words = "from 1"},
    {FG_NUMBER("angle_deg", fg_film_column, angle_deg), .words = "from the first bump of pad 1"},
    {FG_NUMBER("clearance_um", fg_film_column, clearance_um), .words = "without load"},
    {FG_NUMBER("film_um", fg_film_column, film_um), .words = "thickness of the film"},
    {FG_NUMBER("deflection_um", fg_film_column, deflection_um), .words = "of the foil"},
    {FG_NUMBERS_BY("pressure_kpa", list_pressures),
     .words = "absolute, from the middle of the length to its end, in equal steps"},
};
static const fg_members column_members = FG_MEMBERS(column_rows);

/* ---- random bearings ---- */

static const char *find_share_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  const fg_film_draws *draws = &report_of(s)->draws;
  if (s->object == &draws->solved) return "solved";
  if (s->object == &draws->touching) return "touching";
  if (s->object == &draws->within) return "threshold within the asked percentage";
  if (s->object == &draws->not_lower) return "threshold lower by no more than that";
  return s->object == &draws->more_stable ? "more stable, of those solved"
                                          : "less stable, of those solved";
}

static double find_percent(const fg_subject *s) {
  return 100 * ((const fg_film_share *)s->object)->share;
}

static const char *find_interval(const fg_subject *s, char *buffer) {
  const fg_film_share *share = s->object;
  if (isnan(share->low)) return NULL;
  snprintf(buffer, FG_MEMBER_TEXT_MAX, "%.1f to %.1f", 100 * share->low, 100 * share->high);
  return buffer;
}

static const fg_member share_rows[] = {
    {FG_TEXT_BY("bearings", find_share_name), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "bearings", .page = {.rank = 1}, .terminal = {.rank = 1}},
    {FG_COUNT("count", fg_film_share, count), .words = "of bearings", .heading = "count",
     .page = {.rank = 2}, .terminal = {.rank = 2}},
    {FG_NUMBER_BY("percent", find_percent), .options = FG_MEMBER_NOT_IN_JSON, .heading = "share, %",
     .page = {.rank = 3, .decimals = 1}, .terminal = {.rank = 3, .decimals = 1}},
    {FG_TEXT_BY("interval", find_interval), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "95 % interval", .page = {.rank = 4}, .terminal = {.rank = 4}},
    {FG_NUMBER("share", fg_film_share, share), .words = "of all, or of those solved"},
    {FG_RANGE("interval_95", fg_film_share, low, high), .words = "Clopper and Pearson's, exact"},
};
const fg_members fg_film_share_members = FG_MEMBERS_DEFINED(share_rows, "share");

bool fg_film_share_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_film_draws *draws = &report_of(list)->draws;
  const fg_film_share *const shares[] = {&draws->solved,      &draws->touching, &draws->more_stable,
                                         &draws->less_stable, &draws->within,   &draws->not_lower};
  if (i >= (isfinite(report_of(list)->tolerance.threshold_rpm) ? 6 : 4)) return false;
  element->object = shares[i];
  return true;
}

/* ---- tolerance and uncertainty ---- */

static bool has_tolerance(const fg_subject *s) {
  return report_of(s)->tolerance.asked;
}

static bool knows_threshold(const fg_subject *s) {
  return isfinite(report_of(s)->tolerance.threshold_rpm);
}

static bool has_lift_off(const fg_subject *s) {
  return report_of(s)->lift_off.asked;
}

static bool has_uncertainty(const fg_subject *s) {
  return report_of(s)->uncertainty.draws > 0;
}

static const fg_member quantile_rows[] = {
    {FG_NUMBER("at_5_pct", fg_film_draws, quantile[0])},
    {FG_NUMBER("at_25_pct", fg_film_draws, quantile[1])},
    {FG_NUMBER("median", fg_film_draws, quantile[2])},
    {FG_NUMBER("at_75_pct", fg_film_draws, quantile[3])},
    {FG_NUMBER("at_95_pct", fg_film_draws, quantile[4])},
};
static const fg_members quantile_members = FG_MEMBERS(quantile_rows);

static const fg_member draws_rows[] = {
    {FG_COUNT("count", fg_film_draws, count), .words = "of bearings"},
    {FG_COUNT("asked", fg_film_draws, asked),
     .words = "for; more than count where this is a part of them (--shard)"},
    {FG_COUNT("foils", fg_film_draws, foils),
     .words = "of a lot, that they are drawn from; 0: random shims"},
    {FG_COUNT("foils_left_out", fg_film_draws, left_out),
     .words = "of the lot: failed, not measured, crushed, without a clearance at a place, or "
              "scanned again"},
    {FG_OBJECT("solved", fg_film_draws, solved, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .words = "with a steady film, touching or not"},
    {FG_OBJECT("touching", fg_film_draws, touching, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .words = "of all: with a film thinner than touching_um"},
    {FG_OBJECT("more_stable", fg_film_draws, more_stable, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "of those solved: critical mass above the perfect bearing's"},
    {FG_OBJECT("less_stable", fg_film_draws, less_stable, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .words = "of those solved: below"},
    {FG_OBJECT("within", fg_film_draws, within, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .present = knows_threshold,
     .words = "of all: with a threshold speed within the asked percentage of the perfect "
              "bearing's, and a film that does not touch there"},
    {FG_OBJECT("not_lower", fg_film_draws, not_lower, &fg_film_share_members),
     .options = FG_MEMBER_ON_LINE, .present = knows_threshold,
     .words = "of all: the same, or with a higher one"},
    {FG_GROUP("mass_over_perfect", &quantile_members), .options = FG_MEMBER_ON_LINE,
     .words = "quantiles over those solved of the critical mass over the perfect bearing's; null "
              "where such bearings are stable at every mass, or the perfect one has no such mass"},
};
static const fg_members draws_members = FG_MEMBERS(draws_rows);

static bool has_draws(const fg_subject *s) {
  return report_of(s)->draws.count > 0;
}

/* ---- sensitivities ---- */

static bool has_sensitivities(const fg_subject *s) {
  return report_of(s)->sensitivities > 0;
}

/* ---- the orbit ---- */

static const fg_member place_rows[] = {
    {FG_NUMBER("turn", fg_film_orbit_place, turn), .words = "of the rotor", .csv = {.rank = 1}},
    {FG_NUMBER("x_um", fg_film_orbit_place, place_um[0]), .words = "towards 0 degrees",
     .csv = {.rank = 2}},
    {FG_NUMBER("y_um", fg_film_orbit_place, place_um[1]), .words = "towards 90 degrees",
     .csv = {.rank = 3}},
    {FG_NUMBER("min_film_um", fg_film_orbit_place, min_film_um), .words = "thinnest film",
     .csv = {.rank = 4}},
};
static const fg_members place_members = FG_MEMBERS(place_rows);

static bool find_orbit_place(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &report_of(list)->orbit.point[i];
  return i < report_of(list)->orbit.count;
}

static const fg_member orbit_rows[] = {
    {FG_WORD("fate", fg_film_orbit, fate, fg_film_fate_words),
     .words = "touches: the film ends before the turns do; unknown: too few whirls in these turns"},
    {FG_NUMBER("growth_per_turn", fg_film_orbit, growth_per_turn),
     .words = "logarithm of the amplitude per turn of the rotor"},
    {FG_NUMBER("whirl_ratio", fg_film_orbit, whirl_ratio), .words = "whirl over speed"},
    {FG_LIST("places", fg_film_orbit, point, count, &place_members), .options = FG_MEMBER_ON_LINE,
     .words = "of the rotor, in equal times"},
};
static const fg_members orbit_members = FG_MEMBERS(orbit_rows);

static bool has_orbit(const fg_subject *s) {
  return report_of(s)->orbit.count > 0;
}

fg_status fg_film_write_orbit(fg_context *ctx, const fg_film_report *report, FILE *out) {
  fg_members_csv(out, &place_members, &(fg_subject){.object = report, .whole = report},
                 find_orbit_place);
  return fg_stream_finish(ctx, out, "the orbit");
}

/* ---- the report ---- */

static const char *const top_words[] = {
    [FG_FILM_TOP_FOIL_STIFF] = "stiff", [FG_FILM_TOP_FOIL_SAGGING] = "sagging", NULL};

static const fg_member option_rows[] = {
    {FG_NUMBER("load_n", fg_film_report, options.load_n), .words = "force on the rotor"},
    {FG_NUMBER("load_deg", fg_film_report, options.load_deg), .words = "its direction"},
    {FG_NUMBER("speed_rpm", fg_film_report, options.speed_rpm), .words = "of the rotor"},
    {FG_NUMBER("rotor_mass_kg", fg_film_report, options.rotor_mass_kg), .words = "on this bearing"},
    {FG_NUMBER("diameter_mm", fg_film_report, diameter_mm), .words = "of the rotor"},
    {FG_NUMBER("length_mm", fg_film_report, length_mm), .words = "of the bearing"},
    {FG_NUMBER("clearance_um", fg_film_report, clearance_um), .words = "C, the reference"},
    {FG_NUMBER("compliance", fg_film_report, compliance), .words = "alpha = p_a s / (C K)"},
    {FG_NUMBER("stiffness_n_mm2", fg_film_report, stiffness_n_mm2),
     .words = "K of a bump per width; null: rigid"},
    {FG_NUMBER("loss_factor", fg_film_report, options.loss_factor), .words = "of the bumps"},
    {FG_NUMBER("viscosity_upa_s", fg_film_report, options.viscosity_upa_s), .words = "of the gas"},
    {FG_NUMBER("ambient_kpa", fg_film_report, options.ambient_kpa), .words = "pressure around"},
    {FG_COUNT("pads", fg_film_report, options.pads), .words = "0: a closed ring of bumps"},
    {FG_COUNT("bumps_per_pad", fg_film_report, options.bumps_per_pad), .words = "from first_bump"},
    {FG_COUNT("first_bump", fg_film_report, options.first_bump), .words = "of each foil"},
    {FG_NUMBER("pitch_deg", fg_film_report, options.pitch_deg), .words = "from bump to bump"},
    {FG_WORD("top_foil", fg_film_report, options.top_foil, top_words),
     .words = "between the bumps: stiff, or sagging as a beam on them"},
    {FG_NUMBER("top_foil_mm", fg_film_report, options.top_foil_mm), .words = "its thickness"},
    {FG_COUNT("cells_per_bump", fg_film_report, options.cells_per_bump), .words = "of the mesh"},
    {FG_COUNT("cells_axial", fg_film_report, options.cells_axial),
     .words = "of the mesh, over half the length"},
    {FG_NUMBER("touching_um", fg_film_report, options.touching_um),
     .words = "a thinner film touches"},
    {FG_SEED("seed", fg_film_report, options.seed), .words = "of the random shims"},
    {FG_RANGE("shims_pct", fg_film_report, options.draw.shim_low_pct, options.draw.shim_high_pct),
     .words = "heights of random shims, percent of the clearance"},
};
static const fg_members option_members = FG_MEMBERS(option_rows);

static const fg_member foils_rows[] = {
    {FG_TEXT("path", fg_film_report, foils_path)},
    {FG_SHA256("sha256", fg_film_report, foils_sha256)},
};
static const fg_members foils_members = FG_MEMBERS(foils_rows);

static bool has_foils(const fg_subject *s) {
  return report_of(s)->options.foils != NULL;
}

static const fg_member bore_rows[] = {
    {FG_TEXT("path", fg_film_report, bore_path)},
    {FG_SHA256("sha256", fg_film_report, bore_sha256)},
};
static const fg_members bore_members = FG_MEMBERS(bore_rows);

static bool has_other_film(const fg_subject *s) {
  return report_of(s)->has_other_film;
}

static bool has_bore(const fg_subject *s) {
  return report_of(s)->options.bore != NULL;
}

static void write_film_notes(fg_json *json, const char *name, const fg_subject *s) {
  char notes[FG_FILM_NOTES][FG_FILM_NOTE];
  size_t count = fg_film_notes(report_of(s), notes);
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++)
    fg_json_string(json, NULL, notes[i]);
  fg_json_array_end(json);
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/film/1")},
    {FG_OBJECT("design", fg_film_report, design, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_GROUP("foils", &foils_members), .present = has_foils, .options = FG_MEMBER_ON_LINE,
     .words = "report whose foils are the pads, or folder of a lot with its bumps.csv"},
    {FG_GROUP("bore", &bore_members), .present = has_bore, .options = FG_MEMBER_ON_LINE,
     .words = "its measured profile, which shifts the clearance"},
    {FG_GROUP("conditions", &option_members), .words = "as stated, or by default"},
    {FG_OBJECT("bearing", fg_film_report, actual, &fg_film_result_members),
     .words = "as measured; without foils as designed"},
    {FG_OBJECT("other_film", fg_film_report, other_film, &fg_film_result_members),
     .present = has_other_film,
     .words = "of the bearing, with the rotor at another place, at the same load and speed"},
    {FG_OBJECT("perfect", fg_film_report, perfect, &fg_film_result_members),
     .words = "as designed"},
    {FG_NUMBER("threshold_rpm", fg_film_report, threshold_rpm),
     .words = "lowest speed at which the rotor's mass is critical; null: none among the speeds"},
    {FG_NUMBER("threshold_eigen_rpm", fg_film_report, threshold_eigen_rpm),
     .words = "lowest speed at which the least stable eigenvalue of rotor and film gets unstable"},
    {FG_ARRAY("eigenvalues", fg_film_report, mode, modes, &fg_film_mode_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "whirls of the rotor on its film by itself, the least stable first"},
    {FG_NUMBER("load_capacity_n", fg_film_report, load_capacity_n),
     .words = "largest load at this speed with any film of touching_um at least"},
    {FG_NUMBER("lift_off_rpm", fg_film_report, lift_off_rpm),
     .words = "lowest speed under this load with such a film"},
    {FG_NUMBER("film_ends_n", fg_film_report, film_ends_n),
     .words = "load, rising at this speed, at which the film of this load and speed ends and the "
              "rotor passes to another one; null: it does not"},
    {FG_NUMBER("film_ends_rpm", fg_film_report, film_ends_rpm),
     .words = "speed, falling under this load, at which it does"},
    {FG_OBJECT("lift_off_test", fg_film_report, lift_off, &fg_film_lift_off_members),
     .present = has_lift_off, .words = "lift-off speed as measured, against the bearing's"},
    {FG_ARRAY("coefficients", fg_film_report, coefficients, coefficient_count,
              &coefficient_members),
     .options = FG_MEMBER_ON_LINE, .words = "stiffness and damping of the film over the whirl"},
    {FG_LIST("speeds", fg_film_report, by_speed, speed_count, &fg_film_result_members),
     .options = FG_MEMBER_ON_LINE, .words = "the same bearing under the same load"},
    {FG_OBJECT("draws", fg_film_report, draws, &draws_members), .present = has_draws,
     .words = "bearings of the lot's foils, or as designed with random shims"},
    {FG_ARRAY("sensitivities", fg_film_report, sensitivity, sensitivities,
              &fg_film_sensitivity_members),
     .present = has_sensitivities,
     .words = "of the critical mass over the shape of the bumps, about the design"},
    {FG_OBJECT("uncertainty", fg_film_report, uncertainty, &fg_film_uncertainty_members),
     .present = has_uncertainty, .words = "of the bearing as measured, by that of its clearances"},
    {FG_OBJECT("tolerance", fg_film_report, tolerance, &fg_film_tolerance_members),
     .present = has_tolerance, .words = "on the clearance, that keeps the threshold speed"},
    {FG_OBJECT("orbit", fg_film_report, orbit, &orbit_members), .present = has_orbit,
     .words = "of the rotor in time, after a pulse of 2 % of the load during the first turn"},
    {FG_LIST("field", fg_film_report, column, columns, &column_members),
     .options = FG_MEMBER_ON_LINE, .words = "the film of the bearing, unwrapped"},
    {FG_WRITTEN("notes", write_film_notes,
                "{\"type\": \"array\", \"items\": {\"type\": \"string\"}}")},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

/* Of a lot's foils the field and the coefficients, which are the design's, are left out. */
static const fg_member of_lot_rows[] = {
    {FG_GROUP("conditions", &option_members), .words = "of the recipe, or by default"},
    {FG_OBJECT("perfect", fg_film_report, perfect, &fg_film_result_members),
     .words = "the bearing as designed"},
    {FG_NUMBER("threshold_rpm", fg_film_report, threshold_rpm),
     .words = "of that: lowest speed at which the rotor's mass is critical; null: none among the "
              "speeds"},
    {FG_OBJECT("tolerance", fg_film_report, tolerance, &fg_film_tolerance_members),
     .present = has_tolerance, .words = "on the clearance, that keeps the threshold speed"},
    {FG_OBJECT("draws", fg_film_report, draws, &draws_members), .present = has_draws,
     .words = "bearings of the lot's foils"},
};
const fg_members fg_film_of_lot_members = FG_MEMBERS_OF_FILE(of_lot_rows, "of_lot", "film");
static const fg_members *const film_descriptions[] = {&fg_film_of_lot_members, NULL};

const fg_document fg_film_document = {
    .file = "film",
    .title = "foilgauge film report",
    .description = "The gas film under a bearing's foils, and the stability of a rotor on it. "
                   "Directions are counted from the first bump of pad 1, in the sense of "
                   "rotation. null is a value that is not known.",
    .made_by = "`foilgauge film -o`",
    .members = &report_members,
    .describes = film_descriptions,
};

fg_status fg_film_write_json(fg_context *ctx, const fg_film_report *report, FILE *out) {
  fg_document_json(out, &report_members, report);
  return fg_stream_finish(ctx, out, "the report");
}

fg_status fg_film_write_draws(fg_context *ctx, const fg_film_report *report, FILE *out) {
  fg_members_csv(out, &fg_film_result_members,
                 &(fg_subject){.object = &report->draws, .whole = report}, fg_film_draw_at);
  return fg_stream_finish(ctx, out, "the draws");
}

fg_status fg_film_write_speeds(fg_context *ctx, const fg_film_report *report, FILE *out) {
  fg_members_csv(out, &fg_film_result_members,
                 &(fg_subject){.object = report->by_speed, .whole = report}, fg_film_speed_at);
  return fg_stream_finish(ctx, out, "the speeds");
}
