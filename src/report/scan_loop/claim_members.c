/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"

static const char *const level_words[] = {"points", "bumps", NULL};
static const char *const found_words[] = {"found", "tied", NULL};

#define LEVEL_ROW                                                                                  \
  {                                                                                                \
    FG_WORD_BY("level", find_effect_level, level_words),                                           \
        .options = FG_MEMBER_NEVER_NULL,                                                           \
        .words = "points: rows of the edges; bumps: dimensions of the bumps"                       \
  }
#define RETAINED_WORDS "share of the effect that the geometry beside it leaves"

static int find_effect_level(const fg_subject *subject) {
  return subject->index > 0;
}

/* Response of an effect of the bumps. */
static const fg_scan_result_response *response_of(const fg_subject *subject) {
  return &fg_scan_result_of(subject)->bumps.response[subject->index - 1];
}

static fg_subject select_of_rows(const fg_subject *subject) {
  return (fg_subject){subject->index ? NULL : subject->object, subject->whole, 0};
}

static fg_subject select_of_bumps(const fg_subject *subject) {
  return (fg_subject){subject->index ? subject->object : NULL, subject->whole, subject->index};
}

static const char *find_response_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return response_of(subject)->name;
}

static const char *find_response_unit(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return response_of(subject)->unit;
}

static const char *const response_words[] = {"bump_radius_mm", "bump_angle_deg", NULL};
static const char *const unit_words[] = {"um", "deg", NULL};

static const fg_member response_rows[] = {
    {FG_TEXT_BY("response", find_response_name), .choices = response_words,
     .options = FG_MEMBER_NEVER_NULL, .words = "level bumps only: what of the bumps"},
    {FG_TEXT_BY("unit", find_response_unit), .choices = unit_words, .options = FG_MEMBER_NEVER_NULL,
     .words = "level bumps only: of the amplitude"},
};
static const fg_members response_members = FG_MEMBERS(response_rows);

/* A point of a curve: coordinate and value. */
static const fg_member point_rows[] = {
    {.kind = FG_MEMBER_NUMBERS, .lowest = 2, .highest = 2, .options = FG_MEMBER_NEVER_NULL}};
static const fg_members point_members = FG_MEMBERS(point_rows);

/* Parameters of a claim of the rows. */
static const char *name_parameter(const fg_subject *parameter) {
  return ((const fg_scan_result_parameter *)parameter->object)->name;
}

static const fg_member value_rows[] = {{FG_NUMBER(NULL, fg_scan_result_parameter, value)}};
static const fg_members value_members = FG_MEMBERS(value_rows);
static const fg_member u_rows[] = {{FG_NUMBER(NULL, fg_scan_result_parameter, u)}};
static const fg_members u_members = FG_MEMBERS(u_rows);

#define CLAIM_PARAMETERS(name_, members_)                                                          \
  .name = (name_), .kind = FG_MEMBER_MAP, .offset = offsetof(fg_scan_result_claim, parameter),     \
  .count_offset = FG_FIELD(fg_scan_result_claim, parameters, size_t),                              \
  .stride = sizeof(fg_scan_result_parameter), .key = name_parameter, .members = (members_)

/* Colour lines of a scan on an effect of the carriage. */
static const char *const check_words[] = {"for", "against", "cannot_tell", NULL};

static int find_check_word(const fg_subject *check) {
  return (int)((const fg_channel_check *)check->object)->verdict - (int)FG_CHANNEL_CHECK_FOR;
}

static const fg_member gap_rows[] = {
    {FG_NUMBER("red", fg_channel_check, gap_px[0])},
    {FG_NUMBER("green", fg_channel_check, gap_px[1])},
    {FG_NUMBER("blue", fg_channel_check, gap_px[2])},
};
static const fg_members gap_members = FG_MEMBERS(gap_rows);

static const fg_member check_rows[] = {
    {FG_WORD_BY("verdict", find_check_word, check_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "on the effect"},
    {FG_STRING("reason", fg_channel_check, reason), .options = FG_MEMBER_NEVER_NULL,
     .words = "in a sentence"},
    {FG_NUMBER("p_value", fg_channel_check, p_value),
     .words = "that lines which show nothing of it look like that"},
    {FG_NUMBER("p_against", fg_channel_check, p_against),
     .words = "the same of lines that show it as it is claimed; null: gaps not stated"},
    {FG_NUMBER_U("factor", fg_channel_check, factor, u_factor),
     .words = "what they show over what they must"},
    {FG_NUMBER("expected_um", fg_channel_check, expected_um),
     .words = "rms of what they must show, about its mean"},
    {FG_FLAG("gap_stated", fg_channel_check, gap_stated),
     .words = "--colour-gap; else the gaps are those that fit best"},
    {FG_GROUP("gap_px", &gap_members), .words = "of the colour lines from each other"},
};
static const fg_members check_members = FG_MEMBERS(check_rows);

/* A claim of the rows. */
static const char *const direction_words[] = {"normal", "radial", NULL};
static const char *const basis_words[] = {"deviation of every bump from its best-fit circle", NULL};

static bool has_basis(const fg_subject *claim) {
  return ((const fg_scan_result_claim *)claim->object)->basis;
}

static bool has_channel_check(const fg_subject *claim) {
  const fg_scan_result_claim *c = claim->object;
  return c->channel_check.verdict != FG_CHANNEL_CHECK_NONE;
}

/* Explanation `i`; none of an effect that every explanation includes. */
static const char *explanation_at(const fg_subject *claim, size_t i) {
  const fg_scan_result *result = fg_scan_result_of(claim);
  bool sure = ((const fg_scan_result_claim *)claim->object)->sure;
  return sure || i >= result->explanations ? NULL : result->explanation[i].name;
}

static const fg_member row_claim_rows[] = {
    {FG_STRING("id", fg_scan_result_claim, id), .options = FG_MEMBER_NEVER_NULL,
     .pattern = "^(scan|part|table)\\.", .words = "name of the effect"},
    {FG_STRING("form", fg_scan_result_claim, direction), .choices = direction_words,
     .options = FG_MEMBER_LEFT_OUT,
     .words = "normal: along the midline's normal; radial: along the radius from O"},
    LEVEL_ROW,
    {FG_WORD("verdict", fg_scan_result_claim, verdict, found_words),
     .words = "tied: other effects do as well"},
    {CLAIM_PARAMETERS("parameters", &value_members), .words = "numbers of the effect"},
    {CLAIM_PARAMETERS("uncertainty", &u_members), .words = "their standard uncertainties"},
    {FG_NUMBER("amplitude", fg_scan_result_claim, amplitude_um), .words = "size of the effect"},
    {FG_NUMBER("p_value", fg_scan_result_claim, p_value), .lowest = 0, .highest = 1,
     .options = FG_MEMBER_NEVER_NULL, .words = "that the effect is not needed"},
    {FG_NUMBER("retained_share", fg_scan_result_claim, retained_share), .words = RETAINED_WORDS},
    {FG_STRING("basis", fg_scan_result_claim, basis), .choices = basis_words,
     .options = FG_MEMBER_LEFT_OUT,
     .words = "crown and skew: a bump that is no circle has no one radius; what the radius is of, "
              "and the shape beside it"},
    {FG_LIST("shape", fg_scan_result_claim, shape, shape_points, &point_members),
     .present = has_basis, .words = "as in `unattributed`, over bump.phi"},
    {FG_TEXTS_BY("alias_class", explanation_at),
     .words = "sets of effects that do equally well; the first is the one in use; of what is found "
              "none"},
    {FG_OBJECT("witness", fg_scan_result_claim, channel_check, &check_members),
     .present = has_channel_check,
     .words = "of an effect of the carriage in colour scans: what their colour lines say, between "
              "which neither part nor optics shows"},
};
static const fg_members row_claim_members = FG_MEMBERS(row_claim_rows);

/* A claim of the bumps. */
static bool find_bump_parameter(const fg_subject *claim, size_t i, fg_subject *element) {
  element->object = claim->object;
  return i < ((const fg_scan_result_bump_claim *)claim->object)->parameters;
}

static const char *name_bump_parameter(const fg_subject *parameter) {
  const fg_scan_result_bump_claim *claim = parameter->object;
  return claim->parameter_name[parameter->index];
}

static double find_bump_parameter_value(const fg_subject *parameter) {
  return ((const fg_scan_result_bump_claim *)parameter->object)->parameter[parameter->index];
}

static double find_bump_parameter_u(const fg_subject *parameter) {
  return ((const fg_scan_result_bump_claim *)parameter->object)->parameter_u[parameter->index];
}

static const fg_member bump_value_rows[] = {{FG_NUMBER_BY(NULL, find_bump_parameter_value)}};
static const fg_members bump_value_members = FG_MEMBERS(bump_value_rows);
static const fg_member bump_u_rows[] = {{FG_NUMBER_BY(NULL, find_bump_parameter_u)}};
static const fg_members bump_u_members = FG_MEMBERS(bump_u_rows);

/* Alias `i`, the claim itself first; none where it is found. */
static const char *bump_alias_at(const fg_subject *subject, size_t i) {
  const fg_scan_result_bump_claim *claim = subject->object;
  if (claim->verdict != FG_LOOP_TIED || i > claim->ties) return NULL;
  return i ? claim->tied[i - 1].id : claim->id;
}

static const fg_member bump_claim_rows[] = {
    {FG_STRING("id", fg_scan_result_bump_claim, id), .options = FG_MEMBER_NEVER_NULL},
    LEVEL_ROW,
    {FG_WORD("verdict", fg_scan_result_bump_claim, verdict, found_words)},
    {FG_SAME(&response_members)},
    {FG_MAP_BY("parameters", find_bump_parameter, name_bump_parameter, &bump_value_members)},
    {FG_MAP_BY("uncertainty", find_bump_parameter, name_bump_parameter, &bump_u_members)},
    {FG_NUMBER_U("amplitude", fg_scan_result_bump_claim, amplitude, u_amplitude),
     .words = "half the range over the bumps"},
    {FG_NUMBER("p_value", fg_scan_result_bump_claim, p_value)},
    {FG_NUMBER("retained_share", fg_scan_result_bump_claim, retained_share)},
    {FG_TEXTS_BY("alias_class", bump_alias_at)},
};
static const fg_members bump_claim_members = FG_MEMBERS(bump_claim_rows);

static const fg_member claim_rows[] = {
    {FG_SAME(&row_claim_members), .part = select_of_rows, .options = FG_MEMBER_NEVER_NULL},
    {FG_SAME(&bump_claim_members), .part = select_of_bumps},
};
const fg_members fg_scan_claim_members = FG_MEMBERS(claim_rows);

bool fg_scan_find_claim(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scan_result *result = fg_scan_result_of(list);
  element->index = 0;
  if (i < result->claims) {
    element->object = result->claim[i].free ? NULL : &result->claim[i];
    return true;
  }
  i -= result->claims;
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; i -= result->bumps.response[r++].claims)
    if (i < result->bumps.response[r].claims) {
      element->object = &result->bumps.response[r].claim[i];
      element->index = r + 1;
      return true;
    }
  return false;
}

/* Effects that are not claimed. */
static const char *const verdict_words[] = {
    "found", "tied", "absent", "inconclusive", "absorbed by geometry", "explained by others", NULL};
#define NOT_CLAIMED_SCHEMA                                                                         \
  "{\"enum\": [\"absent\", \"inconclusive\", \"absorbed by geometry\", \"explained by others\"]}"

static bool is_barred(const fg_subject *subject) {
  return ((const fg_scan_result_unclaimed *)subject->object)->barred;
}

static const fg_member row_rejected_rows[] = {
    {FG_STRING("id", fg_scan_result_unclaimed, id), .options = FG_MEMBER_NEVER_NULL,
     .words = "name of the effect"},
    LEVEL_ROW,
    {FG_WORD("verdict", fg_scan_result_unclaimed, verdict, verdict_words),
     .schema = NOT_CLAIMED_SCHEMA, .words = "absent: so much of it would have shown"},
    {FG_FLAG("not_confirmed", fg_scan_result_unclaimed, barred), .present = is_barred,
     .words = "seen, but not confirmed from disc to disc"},
    {FG_NUMBER("would_explain", fg_scan_result_unclaimed, would_explain),
     .words = "share of the residual's square it takes alone; of half the width's for an "
              "effect of the width"},
    {FG_NUMBER("smallest_amplitude", fg_scan_result_unclaimed, smallest_um),
     .words = "um that would have shown; null where discs do not confirm it from one to the next"},
    {FG_NUMBER("retained_share", fg_scan_result_unclaimed, retained_share),
     .words = RETAINED_WORDS},
};
static const fg_members row_rejected_members = FG_MEMBERS(row_rejected_rows);

static const fg_member bump_rejected_rows[] = {
    {FG_STRING("id", fg_scan_result_bump_unclaimed, id), .options = FG_MEMBER_NEVER_NULL},
    LEVEL_ROW,
    {FG_WORD("verdict", fg_scan_result_bump_unclaimed, verdict, verdict_words),
     .schema = NOT_CLAIMED_SCHEMA},
    {FG_SAME(&response_members)},
    {FG_NUMBER("would_explain", fg_scan_result_bump_unclaimed, would_explain)},
    {FG_NUMBER("p_value", fg_scan_result_bump_unclaimed, p_value),
     .words = "level bumps only: that the effect is not needed"},
    {FG_NUMBER("smallest_amplitude", fg_scan_result_bump_unclaimed, smallest)},
    {FG_NUMBER("retained_share", fg_scan_result_bump_unclaimed, retained_share)},
};
static const fg_members bump_rejected_members = FG_MEMBERS(bump_rejected_rows);

static const fg_member rejected_rows[] = {
    {FG_SAME(&row_rejected_members), .part = select_of_rows, .options = FG_MEMBER_NEVER_NULL},
    {FG_SAME(&bump_rejected_members), .part = select_of_bumps},
};
const fg_members fg_scan_rejected_members = FG_MEMBERS(rejected_rows);

bool fg_scan_find_rejected(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scan_result *result = fg_scan_result_of(list);
  element->index = 0;
  if (i < result->unclaimeds) { /* tied ones are in `alias_class` */
    const fg_scan_result_unclaimed *one = &result->unclaimed[i];
    element->object = one->verdict == FG_LOOP_TIED ? NULL : one;
    return true;
  }
  i -= result->unclaimeds;
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; i -= result->bumps.response[r++].unclaimeds)
    if (i < result->bumps.response[r].unclaimeds) {
      element->object = &result->bumps.response[r].unclaimed[i];
      element->index = r + 1;
      return true;
    }
  return false;
}

/* Curves that no listed effect explains. */
static const char *const coordinate_words[] = {"scan.x",     "scan.y",      "foil.s", "bump.phi",
                                               "bump.index", "edge.normal", NULL};
static const char *const moves_words[] = {
    "x", "y", "x and y", "along the normal", "along the radius", "bump_radius_mm", "bump_angle_deg",
    NULL};

static const fg_member curve_rows[] = {
    {FG_STRING("coordinate", fg_scan_result_claim, coordinate_name), .choices = coordinate_words,
     .options = FG_MEMBER_NEVER_NULL, .words = "that the curve runs over"},
    {FG_STRING("moves", fg_scan_result_claim, moves), .choices = moves_words,
     .options = FG_MEMBER_NEVER_NULL, .words = "what the curve changes"},
    {FG_LIST("shape", fg_scan_result_claim, shape, shape_points, &point_members),
     .words =
         "coordinate and value in um (angles: degrees). scan.x, scan.y in mm, where edges were "
         "measured; foil.s from -1 at the lip's end to 1 at the free end, outwards from O; "
         "bump.phi from -1 to 1 between the fillets, away from the centre of the bump's circle "
         "and beside that circle; edge.normal in degrees; bump.index: its number"},
};
static const fg_members curve_members = FG_MEMBERS(curve_rows);

static bool find_other_curve(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scan_result *result = fg_scan_result_of(list);
  const fg_scan_result_claim *other = &result->claim[i];
  if (i >= result->claims) return false;
  element->object = other->free && other != result->curve ? other : NULL;
  return true;
}

static bool is_of_rows(const fg_subject *curve) {
  return curve->index == 0;
}

static double find_curve_rms(const fg_subject *curve) {
  return fg_scan_result_of(curve)->before.rms;
}

static double find_curve_p_value(const fg_subject *curve) {
  return fg_scan_result_of(curve)->p_value;
}

static const char *nearest_at(const fg_subject *curve, size_t i) {
  const fg_scan_result *result = fg_scan_result_of(curve);
  return i < result->nearests ? result->nearest[i] : NULL;
}

static const fg_member row_curve_rows[] = {
    {FG_SAME(&curve_members)},
    {FG_LIST_BY("others", find_other_curve, &curve_members), .present = is_of_rows,
     .words = "further curves, smaller ones"},
    {FG_TEXTS_BY("alias_class", explanation_at), .present = is_of_rows,
     .words = "what could stand in the curve's place without a loss that the data show: curves "
              "over other coordinates, sums of listed effects"},
    {FG_NUMBER_BY("rms", find_curve_rms), .words = "of the residual that it explains"},
    {FG_NUMBER_BY("p_value", find_curve_p_value), .words = "that no effect is needed"},
    {FG_TEXTS_BY("nearest", nearest_at), .words = "listed effects that resemble it"},
};
static const fg_members row_curve_members = FG_MEMBERS(row_curve_rows);

static const char *find_number_coordinate(const fg_subject *curve, char *buffer) {
  (void)buffer;
  return fg_scan_result_of(curve)->bumps.coordinate_name;
}

static const char *bump_nearest_at(const fg_subject *curve, size_t i) {
  const fg_scan_result_response *response = curve->object;
  return i < response->nearests ? response->nearest[i] : NULL;
}

static const fg_member bump_curve_rows[] = {
    {FG_TEXT_BY("coordinate", find_number_coordinate)},
    {FG_STRING("moves", fg_scan_result_response, name)},
    {FG_LIST("shape", fg_scan_result_response, curve, curve_points, &point_members)},
    {FG_NUMBER("rms", fg_scan_result_response, curve_rms)},
    {FG_NUMBER("p_value", fg_scan_result_response, curve_p)},
    {FG_TEXTS_BY("nearest", bump_nearest_at)},
};
static const fg_members bump_curve_members = FG_MEMBERS(bump_curve_rows);

static const fg_member either_curve_rows[] = {
    {FG_SAME(&row_curve_members), .part = select_of_rows, .options = FG_MEMBER_NEVER_NULL},
    {FG_SAME(&bump_curve_members), .part = select_of_bumps},
};
const fg_members fg_scan_curve_members = FG_MEMBERS(either_curve_rows);

fg_subject fg_scan_find_curve(const fg_subject *subject) {
  const fg_scan_result *result = fg_scan_result_of(subject);
  bool of_rows = result->curve;
  return (fg_subject){of_rows ? (const void *)result->curve : result->bumps.curve, subject->whole,
                      !of_rows};
}
