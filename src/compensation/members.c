/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/members.h"

#include <math.h>

#include "compensation/springback.h"
#include "core/file.h"
#include "report/design/members.h"

static const fg_next_die *next_of(const fg_subject *subject) {
  return subject->whole;
}

/* ---- the law ---- */

static const fg_member place_rows[] = {
    {FG_INTEGER("number", fg_formed_place, number), .lowest = 0, .highest = FG_COMPENSATION_BUMPS,
     .words = "of the bump; 0: the whole foil"},
    {FG_NUMBER("foils", fg_formed_place, foils), .options = FG_MEMBER_ABOVE_0,
     .words = "with a value"},
    {FG_NUMBER("die", fg_formed_place, die), .options = FG_MEMBER_ABOVE_0 | FG_MEMBER_EXACT,
     .words = "size of the die there: mm, of a pitch degrees"},
    {FG_NUMBER("log_ratio", fg_formed_place, log_ratio), .options = FG_MEMBER_EXACT,
     .words = "mean of ln(formed / die)"},
};
static const fg_members place_members = FG_MEMBERS(place_rows);

#define SQUARES .options = FG_MEMBER_EXACT | FG_MEMBER_NOT_NEGATIVE
static const fg_member data_rows[] = {
    {FG_NUMBER("level_squares", fg_formed_data, level_squares), SQUARES,
     .words = "sum of squares of the foils' levels, of logarithms, times their places"},
    {FG_NUMBER("level_dof", fg_formed_data, level_dof), SQUARES, .words = "degrees of freedom"},
    {FG_NUMBER("rest_squares", fg_formed_data, rest_squares), SQUARES,
     .words = "sum of squares within foils"},
    {FG_NUMBER("rest_dof", fg_formed_data, rest_dof), SQUARES, .words = "degrees of freedom"},
    {FG_ARRAY("places", fg_formed_data, place, places, &place_members),
     .options = FG_MEMBER_ON_LINE, .highest = FG_COMPENSATION_BUMPS,
     .words = "means by bump, or of the foil"},
};
static const fg_members data_members = FG_MEMBERS_DEFINED(data_rows, "formed");

static const char *const origin_words[] = {"designed", "measured", "cut", NULL};

static double find_mean_springback(const fg_subject *subject) {
  const fg_formed_data *data = &((const fg_formed_set *)subject->object)->of[FG_FORMED_RADIUS];
  double sum = 0;
  for (size_t i = 0; i < data->places; i++)
    sum += 100 * data->place[i].log_ratio / (double)data->places;
  return data->places ? sum : NAN;
}

static double find_mean_die(const fg_subject *subject) {
  const fg_formed_data *data = &((const fg_formed_set *)subject->object)->of[FG_FORMED_RADIUS];
  double sum = 0;
  for (size_t i = 0; i < data->places; i++)
    sum += data->place[i].die / (double)data->places;
  return data->places ? sum : NAN;
}

static double find_overall_springback(const fg_subject *subject) {
  const fg_formed_data *data = &((const fg_formed_set *)subject->object)->of[FG_FORMED_OVERALL];
  return data->places ? 100 * data->place[0].log_ratio : NAN;
}

#define SHOWN(rank_, heading_, decimals_)                                                          \
  .page = {.rank = (rank_), .heading = (heading_), .decimals = (decimals_)},                       \
  .terminal = {.rank = (rank_), .heading = (heading_), .decimals = (decimals_)}
#define SHOWN_WORDS(rank_, heading_)                                                               \
  .page = {.rank = (rank_), .heading = (heading_), .words = true},                                 \
  .terminal = {.rank = (rank_), .heading = (heading_), .words = true}

static const fg_member set_rows[] = {
    {FG_TEXT("lot", fg_formed_set, lot), .options = FG_MEMBER_ANY_TEXT, .words = "its name",
     SHOWN_WORDS(1, "lot")},
    {FG_TEXT("die", fg_formed_set, die), .options = FG_MEMBER_ANY_TEXT,
     .words = "its name in the lot's manifest; empty: the lot has one", SHOWN_WORDS(1, "die")},
    {FG_WORD("die_from", fg_formed_set, origin, origin_words),
     .words = "designed: as the lot's design says; measured: by foilgauge die; cut: as an earlier "
              "next die said",
     SHOWN_WORDS(2, "die as")},
    {FG_TEXT("folder", fg_formed_set, folder), .options = FG_MEMBER_ANY_TEXT, .words = "as named"},
    {FG_TEXT("sha256", fg_formed_set, sha256), .words = "of its results.jsonl"},
    {FG_TEXT("scans_sha256", fg_formed_set, scans_sha256),
     .words = "of the sums of its scans: a copy of the lot has the same"},
    {FG_TEXT("date", fg_formed_set, date), .words = "of its first scan; empty: not known"},
    {FG_COUNT("foils", fg_formed_set, foils), .lowest = 1, .highest = 1e9,
     .words = "measured foils of that die", SHOWN(3, "foils", 0)},
    {FG_NUMBER_BY("mean_die", find_mean_die), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "mean radius of the die's bumps", SHOWN(4, "die R,\nmm", 4)},
    {FG_NUMBER_BY("mean_springback", find_mean_springback), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "100 ln(formed / die) of the bump radius, mean over the bumps",
     SHOWN(5, "springback R,\n%", 3)},
    {FG_NUMBER_BY("overall_springback", find_overall_springback), .options = FG_MEMBER_NOT_IN_JSON,
     .words = "of the overall radius", SHOWN(6, "R0,\n%", 3)},
    {FG_OBJECT("radius", fg_formed_set, of[FG_FORMED_RADIUS], &data_members),
     .words = "of the bumps"},
    {FG_OBJECT("arc_length", fg_formed_set, of[FG_FORMED_ARC_LENGTH], &data_members),
     .words = "R alpha of the bumps"},
    {FG_OBJECT("overall_radius", fg_formed_set, of[FG_FORMED_OVERALL], &data_members),
     .words = "of the foils"},
    {FG_OBJECT("pitch", fg_formed_set, of[FG_FORMED_PITCH], &data_members),
     .words = "angle from bump to bump, of the foils"},
};
const fg_members fg_formed_set_members = FG_MEMBERS_DEFINED(set_rows, "formed_set");

bool fg_formed_set_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_next_die *next = list->whole;
  element->object = &next->law->set[i];
  return i < next->law->sets;
}

static const char *find_law_words(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_formed_words((fg_formed)subject->index);
}

static const fg_member law_rows[] = {
    {FG_TEXT_BY("quantity", find_law_words), .options = FG_MEMBER_NOT_IN_JSON,
     SHOWN_WORDS(1, "quantity")},
    {FG_NUMBER_U("springback_pct", fg_formed_law, springback_pct, u_springback_pct),
     .words = "100 ln(formed / die) for a die of the target's size, mean over the bumps",
     SHOWN(2, "springback,\n%", 3)},
    {FG_NUMBER_U("exponent", fg_formed_law, exponent, u_exponent),
     .words = "how springback depends on the die's own size: d ln(formed / die) / d ln(die)",
     SHOWN(3, "exponent", 3)},
    {FG_NUMBER("bump_sd_pct", fg_formed_law, bump_sd_pct),
     .words = "of the bumps' own springback about their mean", SHOWN(4, "bumps s,\n%", 2)},
    {FG_NUMBER("set_sd_pct", fg_formed_law, set_sd_pct),
     .words = "from set to set: lots, coils and dies", SHOWN(5, "lots s,\n%", 2)},
    {FG_NUMBER("foil_sd_pct", fg_formed_law, foil_sd_pct), .words = "from foil to foil of a set",
     SHOWN(6, "foils s,\n%", 2)},
    {FG_NUMBER("rest_sd_pct", fg_formed_law, rest_sd_pct),
     .words = "of single bumps within a foil, measuring noise included",
     SHOWN(7, "within s,\n%", 2)},
    {FG_NUMBER("drift_probability", fg_formed_law, drift_probability),
     .words = "that each set goes on from the one before it, against each by itself",
     SHOWN(8, "P(drift)", 2)},
};
const fg_members fg_formed_law_members = FG_MEMBERS_DEFINED(law_rows, "formed_law");

bool fg_formed_law_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_next_die *next = list->whole;
  bool known = i < FG_FORMED && (next->die.bumps || i == FG_FORMED_OVERALL);
  element->object = known ? &next->law->of[i] : NULL;
  return i < FG_FORMED;
}

static const fg_member springback_rows[] = {
    {FG_OBJECT("radius", fg_springback_law, of[FG_FORMED_RADIUS], &fg_formed_law_members),
     .words = "of the bumps"},
    {FG_OBJECT("arc_length", fg_springback_law, of[FG_FORMED_ARC_LENGTH], &fg_formed_law_members),
     .words = "R alpha of the bumps"},
    {FG_OBJECT("overall_radius", fg_springback_law, of[FG_FORMED_OVERALL], &fg_formed_law_members),
     .words = "of the foils"},
    {FG_OBJECT("pitch", fg_springback_law, of[FG_FORMED_PITCH], &fg_formed_law_members),
     .words = "angle from bump to bump"},
    {FG_ARRAY("sets", fg_springback_law, set, sets, &fg_formed_set_members),
     .highest = FG_COMPENSATION_SETS,
     .words = "foils of one lot from one die each, the oldest first: all that the law rests on"},
};
const fg_members fg_law_members = FG_MEMBERS_DEFINED(springback_rows, "springback_law");

/* ---- the die ---- */

static const fg_die_bump_dimensions *present_of(const fg_subject *subject) {
  return &next_of(subject)->present.bump[subject->index];
}

static double find_present_radius(const fg_subject *subject) {
  return present_of(subject)->radius_mm;
}

static const fg_expected_bump *expected_of(const fg_subject *subject) {
  return &next_of(subject)->expected.bump[subject->index];
}

#define EXPECTED(function, field)                                                                  \
  static double function(const fg_subject *subject) {                                              \
    return expected_of(subject)->field;                                                            \
  }
EXPECTED(find_radius_low, radius_mm.low)
EXPECTED(find_radius_high, radius_mm.high)
EXPECTED(find_height_low, height_mm.low)
EXPECTED(find_height_high, height_mm.high)

#define OF_TABLE FG_MEMBER_NOT_IN_JSON
static const fg_member bump_rows[] = {
    {FG_INTEGER("number", fg_die_bump_dimensions, number), .words = "from 1, next to the lip",
     SHOWN(1, "bump", 0)},
    {FG_NUMBER_BY("present_radius", find_present_radius), .options = OF_TABLE,
     .words = "radius in the die of the last set", SHOWN(2, "R now,\nmm", 4)},
    {FG_NUMBER_U("radius_mm", fg_die_bump_dimensions, radius_mm, u_radius_mm),
     .words = "to be cut; u of the law, without what sets differ by", SHOWN(3, "R,\nmm", 4)},
    {FG_NUMBER_U("bump_angle_deg", fg_die_bump_dimensions, bump_angle_deg, u_bump_angle_deg),
     .words = "between its ends on the die's overall circle", SHOWN(4, "α,\n°", 3)},
    {FG_NUMBER_U("height_mm", fg_die_bump_dimensions, height_mm, u_height_mm),
     .words = "over the die's overall circle", SHOWN(5, "h,\nmm", 4)},
    {FG_NUMBER_U("place_deg", fg_die_bump_dimensions, place_deg, u_place_deg),
     .words = "direction from the die's centre, from the middle of all bumps",
     SHOWN(6, "place,\n°", 3)},
    {FG_NUMBER_BY("radius_low", find_radius_low), .options = OF_TABLE,
     .words = "of the mean of the next lot's foils, 95 %", SHOWN(7, "lot R from,\nmm", 4)},
    {FG_NUMBER_BY("radius_high", find_radius_high), .options = OF_TABLE,
     .words = "of the mean of the next lot's foils, 95 %", SHOWN(8, "to,\nmm", 4)},
    {FG_NUMBER_BY("height_low", find_height_low), .options = OF_TABLE,
     .words = "of the mean of the next lot's foils, 95 %", SHOWN(9, "lot h from,\nmm", 4)},
    {FG_NUMBER_BY("height_high", find_height_high), .options = OF_TABLE,
     .words = "of the mean of the next lot's foils, 95 %", SHOWN(10, "to,\nmm", 4)},
};
const fg_members fg_next_bump_members = FG_MEMBERS_DEFINED(bump_rows, "die_bump");

bool fg_next_bump_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_next_die *next = list->whole;
  element->object = &next->die.bump[i];
  return i < next->die.bumps;
}

static const fg_member dimensions_rows[] = {
    {FG_NUMBER_U("overall_radius_mm", fg_die_dimensions, overall_radius_mm, u_overall_radius_mm),
     .options = FG_MEMBER_EXACT, .words = "of the lands; of a plain strip: the mandrel's"},
    {FG_NUMBER_U("pitch_deg", fg_die_dimensions, pitch_deg, u_pitch_deg),
     .options = FG_MEMBER_EXACT | FG_MEMBER_EMPTY_IS_NULL, .words = "from bump to bump"},
    {FG_NUMBER("fillet_radius_mm", fg_die_dimensions, fillet_radius_mm),
     .options = FG_MEMBER_EMPTY_IS_NULL, .words = "as designed"},
    {FG_ARRAY("bumps", fg_die_dimensions, bump, bumps, &fg_next_bump_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_EXACT, .words = "in the order of numbers"},
};
const fg_members fg_die_dimensions_members = FG_MEMBERS_DEFINED(dimensions_rows, "die");

/* ---- the expected lot ---- */

static const fg_member value_rows[] = {
    {FG_NUMBER_U("mean", fg_expected_value, value, u), .words = "of the process with this die"},
    {FG_RANGE("mean_of_foils", fg_expected_value, low, high),
     .words = "95 % interval of the mean of the lot's foils"},
    {FG_NUMBER("sd", fg_expected_value, sd), .options = FG_MEMBER_NOT_NEGATIVE,
     .words = "of single foils"},
};
static const fg_members value_members = FG_MEMBERS_DEFINED(value_rows, "expected_value");

static const fg_member expected_bump_rows[] = {
    {FG_INTEGER("number", fg_expected_bump, number), .words = "from 1"},
    {FG_OBJECT("radius_mm", fg_expected_bump, radius_mm, &value_members), .words = "R"},
    {FG_OBJECT("bump_angle_deg", fg_expected_bump, bump_angle_deg, &value_members),
     .words = "alpha"},
    {FG_OBJECT("height_mm", fg_expected_bump, height_mm, &value_members), .words = "h"},
};
const fg_members fg_expected_bump_members = FG_MEMBERS(expected_bump_rows);

static double find_share_lower(const fg_subject *subject) {
  double limit = ((const fg_expected_share *)subject->object)->lower;
  return isfinite(limit) ? limit : NAN;
}

static double find_share_upper(const fg_subject *subject) {
  double limit = ((const fg_expected_share *)subject->object)->upper;
  return isfinite(limit) ? limit : NAN;
}

#define SHARE(name_, field, rank_, heading_)                                                       \
  FG_NUMBER(name_, fg_expected_share, field),                                                      \
      .page = {.rank = (rank_), .heading = (heading_), .decimals = 1, .scale = 100, .unit = " %"}, \
      .terminal = {                                                                                \
          .rank = (rank_), .heading = (heading_), .decimals = 1, .scale = 100, .unit = " %"}

static const fg_member share_rows[] = {
    {FG_TEXT("quantity", fg_expected_share, quantity), .words = "of every bump, or of the foil",
     SHOWN_WORDS(1, "tolerance of")},
    {FG_NUMBER_BY("min", find_share_lower), .words = "null: no such limit",
     .page = {.rank = 2, .heading = "min", .digits = 6},
     .terminal = {.rank = 2, .heading = "min", .digits = 6}},
    {FG_NUMBER_BY("max", find_share_upper), .words = "null: no such limit",
     .page = {.rank = 3, .heading = "max", .digits = 6},
     .terminal = {.rank = 3, .heading = "max", .digits = 6}},
    {SHARE("share", share, 4, "foils within"), .words = "of the foils, mean over drawn lots"},
    {SHARE("low", low, 5, "from"), .words = "95 % of the drawn lots"},
    {SHARE("high", high, 6, "to"), .words = "95 % of the drawn lots"},
};
const fg_members fg_expected_share_members = FG_MEMBERS(share_rows);

bool fg_expected_share_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_expected_lot *expected = &((const fg_next_die *)list->whole)->expected;
  element->object = &expected->tolerance[i];
  return i < expected->tolerances;
}

static const fg_member expected_rows[] = {
    {FG_COUNT("foils", fg_expected_lot, foils), .words = "of the lot"},
    {FG_OBJECT("overall_radius_mm", fg_expected_lot, overall_radius_mm, &value_members),
     .words = "R0"},
    {FG_OBJECT("pitch_deg", fg_expected_lot, pitch_deg, &value_members),
     .words = "from bump to bump; 0 without bumps"},
    {FG_ARRAY("bumps", fg_expected_lot, bump, bumps, &fg_expected_bump_members),
     .words = "in the order of numbers"},
    {FG_ARRAY("tolerances", fg_expected_lot, tolerance, tolerances, &fg_expected_share_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "of the target that springback decides; a foil is within with all of its bumps"},
    {FG_NUMBER("share_within", fg_expected_lot, share),
     .words = "of foils within all of these; null: there is none"},
    {FG_RANGE("share_within_of_lots", fg_expected_lot, share_low, share_high),
     .words = "95 % of the drawn lots"},
    {FG_NUMBER("assembled", fg_expected_lot, assembled),
     .words = "share of drawn bearings that a rotor fits into; null: too few foils for one"},
    {FG_RANGE("assembled_of_lots", fg_expected_lot, assembled_low, assembled_high),
     .words = "95 % of the drawn lots"},
};
static const fg_members expected_members = FG_MEMBERS(expected_rows);

/* ---- the heat treatment ---- */

static double is_chosen(const fg_subject *subject) {
  const fg_next_die *next = subject->whole;
  return subject->object == &next->setting[next->chosen];
}

static const char *look_at_setting(const fg_subject *subject) {
  return is_chosen(subject) > 0 ? "on" : NULL;
}

static const fg_member trade_rows[] = {
    {FG_TEXT("setting", fg_setting_trade, text), .words = "of the heat treatment",
     SHOWN_WORDS(1, "setting")},
    {FG_FLAG_BY("chosen", is_chosen), .words = "its u_next_pct is the smallest"},
    {FG_NUMBER_U("share", fg_setting_trade, share, u_share),
     .words = "springback over that of the lots' setting", SHOWN(2, "springback,\nshare", 3)},
    {FG_NUMBER("springback_pct", fg_setting_trade, springback_pct),
     .words = "100 ln(formed / die); null: the experiment does not tell it",
     SHOWN(3, "springback,\n%", 2)},
    {FG_NUMBER("radius_mm", fg_setting_trade, radius_mm),
     .words = "of the die, mean over its bumps", SHOWN(4, "die R,\nmm", 4)},
    {FG_NUMBER("overall_radius_mm", fg_setting_trade, overall_radius_mm), .words = "of the die",
     SHOWN(5, "die R0,\nmm", 4)},
    {FG_NUMBER("u_next_pct", fg_setting_trade, u_next_pct),
     .words = "standard uncertainty of the next lot's mean radius",
     SHOWN(6, "u of the lot,\n%", 2)},
};
const fg_members fg_setting_trade_members = FG_MEMBERS_LOOKED_AT(trade_rows, look_at_setting);

bool fg_setting_trade_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_next_die *next = list->whole;
  element->object = &next->setting[i];
  return i < next->settings;
}

/* ---- the report ---- */

static const char *find_next_sentence(const fg_subject *subject, char *buffer) {
  fg_next_die_sentence(subject->object, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

static const char *find_next_note(const fg_subject *subject, size_t i) {
  const fg_next_die *next = subject->object;
  return i < next->notes ? next->note[i] : NULL;
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/next_die/1")},
    {FG_TEXT_BY("summary", find_next_sentence), .options = FG_MEMBER_NEVER_NULL,
     .words = "outcome in a sentence"},
    {FG_OBJECT("target", fg_next_die, target, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_TEXT("target_path", fg_next_die, target_path), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of its file"},
    {FG_TEXT("target_sha256", fg_next_die, target_sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of that file"},
    {FG_NUMBER("step_um", fg_next_die, step_um), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of radii that the shop can cut; null: any"},
    {FG_NUMBER("min_radius_mm", fg_next_die, min_radius_mm), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "that the shop can cut; null: any"},
    {FG_NUMBER("max_move_pct", fg_next_die, max_move_pct),
     .words = "largest step from the present die"},
    {FG_FLAG("common", fg_next_die, common), .words = "one radius and angle for all bumps"},
    {FG_NUMBER("step_share", fg_next_die, step_share),
     .words = "of the bumps' own deviations in the last set that the die takes; null: none"},
    {FG_OBJECT("die", fg_next_die, die, &fg_die_dimensions_members), .words = "to be cut"},
    {FG_OBJECT("present_die", fg_next_die, present, &fg_die_dimensions_members),
     .words = "of the last set"},
    {FG_OBJECT("expected", fg_next_die, expected, &expected_members),
     .words = "the lot that comes of the die"},
    {FG_TEXT("experiment", fg_next_die, doe_path),
     .options = FG_MEMBER_EMPTY_IS_NULL | FG_MEMBER_ANY_TEXT, .words = "its runs"},
    {FG_TEXT("experiment_sha256", fg_next_die, doe_sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of that file"},
    {FG_ARRAY("settings", fg_next_die, setting, settings, &fg_setting_trade_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "heat treatments with their dies, that of the lots first; the die above is of that"},
    {FG_POINTED("law", fg_next_die, law, &fg_law_members), .words = "springback, from all lots"},
    {FG_TEXTS_BY("notes", find_next_note), .words = "limits of what the lots tell"},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_next_die_document = {
    .file = "next_die",
    .title = "foilgauge die --target report",
    .description = "The next die, and the lot that comes of it. Units are in the names. u_ is a "
                   "standard uncertainty. null is a value that is not known.",
    .made_by = "`foilgauge die --target`",
    .members = &report_members,
};

fg_status fg_next_die_write_json(fg_context *ctx, const fg_next_die *next, FILE *out) {
  fg_document_json(out, &report_members, next);
  return fg_stream_finish(ctx, out, "the JSON report");
}
