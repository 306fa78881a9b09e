/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a lot against its prediction, and its sentence. */
#include <math.h>

#include "compensation/members.h"
#include "core/file.h"
#include "report/design/members.h"

/* ---- values ---- */

static const fg_member held_rows[] = {
    {FG_NUMBER("expected", fg_expected_held, expected), .words = "of the process with the die"},
    {FG_RANGE("mean_of_foils", fg_expected_held, low, high),
     .words = "95 % interval of the mean of as many foils"},
    {FG_NUMBER("measured", fg_expected_held, measured), .words = "mean of the lot's foils"},
    {FG_FLAG("inside", fg_expected_held, inside), .words = "the interval holds it"},
};
static const fg_members held_members = FG_MEMBERS_DEFINED(held_rows, "held");

static const fg_expected_held_bump *held_bump_of(const fg_subject *subject) {
  return subject->object;
}

#define HELD(function, field)                                                                      \
  static double function(const fg_subject *subject) {                                              \
    return held_bump_of(subject)->field;                                                           \
  }
HELD(find_held_radius, radius_mm.measured)
HELD(find_held_radius_low, radius_mm.low)
HELD(find_held_radius_high, radius_mm.high)
HELD(find_held_angle, bump_angle_deg.measured)
HELD(find_held_angle_low, bump_angle_deg.low)
HELD(find_held_angle_high, bump_angle_deg.high)
HELD(find_held_height, height_mm.measured)
HELD(find_held_height_low, height_mm.low)
HELD(find_held_height_high, height_mm.high)

static const char *row_class(bool inside) {
  return inside ? "pass" : "fail";
}

static const char *look_of_radius(const fg_subject *subject) {
  return row_class(held_bump_of(subject)->radius_mm.inside);
}

static const char *look_of_angle(const fg_subject *subject) {
  return row_class(held_bump_of(subject)->bump_angle_deg.inside);
}

static const char *look_of_height(const fg_subject *subject) {
  return row_class(held_bump_of(subject)->height_mm.inside);
}

#define SHOWN(rank_, heading_, decimals_)                                                          \
  .page = {.rank = (rank_), .heading = (heading_), .decimals = (decimals_)}
#define OF_PAGE(function_, words_, rank_, heading_, decimals_)                                     \
  FG_NUMBER_BY(#function_, function_), .options = FG_MEMBER_NOT_IN_JSON, .words = (words_),        \
                                       SHOWN(rank_, heading_, decimals_)

static const fg_member held_bump_rows[] = {
    {FG_INTEGER("number", fg_expected_held_bump, number), .words = "from 1", SHOWN(1, "bump", 0)},
    {FG_OBJECT("radius_mm", fg_expected_held_bump, radius_mm, &held_members), .words = "R"},
    {OF_PAGE(find_held_radius, "mean of the lot's foils", 2, "R,\nmm", 4), .look = look_of_radius},
    {OF_PAGE(find_held_radius_low, "95 % interval as predicted", 3, "from,\nmm", 4)},
    {OF_PAGE(find_held_radius_high, "95 % interval as predicted", 4, "to,\nmm", 4)},
    {FG_OBJECT("bump_angle_deg", fg_expected_held_bump, bump_angle_deg, &held_members),
     .words = "alpha"},
    {OF_PAGE(find_held_angle, "mean of the lot's foils", 5, "α,\n°", 3), .look = look_of_angle},
    {OF_PAGE(find_held_angle_low, "95 % interval as predicted", 6, "from,\n°", 3)},
    {OF_PAGE(find_held_angle_high, "95 % interval as predicted", 7, "to,\n°", 3)},
    {FG_OBJECT("height_mm", fg_expected_held_bump, height_mm, &held_members), .words = "h"},
    {OF_PAGE(find_held_height, "mean of the lot's foils", 8, "h,\nmm", 4), .look = look_of_height},
    {OF_PAGE(find_held_height_low, "95 % interval as predicted", 9, "from,\nmm", 4)},
    {OF_PAGE(find_held_height_high, "95 % interval as predicted", 10, "to,\nmm", 4)},
};
const fg_members fg_held_bump_members = FG_MEMBERS(held_bump_rows);

bool fg_held_bump_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_expected_check *check = list->whole;
  element->object = &check->bump[i];
  return i < check->bumps;
}

/* ---- iterations ---- */

static const fg_member iteration_rows[] = {
    {FG_STRING("lot", fg_iteration, lot), .words = "its name",
     .page = {.rank = 1, .heading = "lot", .words = true}},
    {FG_COUNT("foils", fg_iteration, foils), .words = "measured", SHOWN(2, "foils", 0)},
    {FG_NUMBER("mean_error_pct", fg_iteration, mean_error_pct),
     .words = "of the bump radii, or of a plain strip's radius, against the target",
     .page = {.rank = 3, .heading = "mean error,\n%", .decimals = 3, .plus = true}},
    {FG_NUMBER("rms_error_pct", fg_iteration, rms_error_pct), .words = "over the bumps' means",
     SHOWN(4, "rms over the bumps,\n%", 3)},
    {FG_NUMBER("springback_pct", fg_iteration, springback_pct),
     .words = "mean of 100 ln(formed / die)", SHOWN(5, "springback,\n%", 3)},
};
const fg_members fg_iteration_members = FG_MEMBERS(iteration_rows);

bool fg_iteration_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_expected_check *check = list->whole;
  element->object = &check->iteration[i];
  return i < check->iterations;
}

static const fg_iteration *last_iteration(const fg_expected_check *check, size_t back) {
  return check->iterations > back ? &check->iteration[check->iterations - 1 - back] : NULL;
}

static double find_error_before(const fg_subject *subject) {
  const fg_iteration *before = last_iteration(subject->object, 1);
  return before ? before->rms_error_pct : NAN;
}

static double find_error_after(const fg_subject *subject) {
  const fg_iteration *after = last_iteration(subject->object, 0);
  return after ? after->rms_error_pct : NAN;
}

/* ---- the report ---- */

void fg_expected_check_sentence(const fg_expected_check *check, char *text, size_t size) {
  const fg_subject subject = {.object = check, .whole = check};
  int used =
      snprintf(text, size,
               "Error of the %s, rms: before %.3f %%, after %.3f %%. %zu of %zu values lie in "
               "their predicted intervals of 95 %%",
               check->bumps ? "bump radii" : "radius", find_error_before(&subject),
               find_error_after(&subject), check->inside, check->of);
  if (used < 0 || (size_t)used >= size) return;
  if (!isfinite(check->p_value))
    snprintf(text + used, size - (size_t)used, ".");
  else
    snprintf(text + used, size - (size_t)used, "; of lots as predicted %.2g %% are as far off: %s.",
             100 * check->p_value,
             check->p_value < 0.01   ? "the prediction was wrong"
             : check->p_value < 0.05 ? "the prediction is questionable"
                                     : "the prediction holds");
}

static const char *find_check_sentence(const fg_subject *subject, char *buffer) {
  fg_expected_check_sentence(subject->object, buffer, FG_MEMBER_TEXT_MAX);
  return buffer;
}

static double find_holds(const fg_subject *subject) {
  double p = ((const fg_expected_check *)subject->object)->p_value;
  return isfinite(p) ? p >= 0.01 : NAN;
}

static const fg_member loop_rows[] = {
    {FG_TEXT("verdict", fg_expected_check, loop_verdict), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "as of `foilgauge loop`"},
    {FG_TEXT("name", fg_expected_check, loop_name), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of the first effect found"},
    {FG_TEXT("sentence", fg_expected_check, loop_sentence), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "for a process engineer"},
};
static const fg_members loop_members = FG_MEMBERS(loop_rows);

static const fg_member before_rows[] = {
    {FG_OBJECT("radius", fg_expected_check, before[FG_FORMED_RADIUS], &fg_formed_law_members),
     .words = "of the bumps"},
    {FG_OBJECT("arc_length", fg_expected_check, before[FG_FORMED_ARC_LENGTH],
               &fg_formed_law_members),
     .words = "R alpha of the bumps"},
    {FG_OBJECT("overall_radius", fg_expected_check, before[FG_FORMED_OVERALL],
               &fg_formed_law_members),
     .words = "of the foils"},
    {FG_OBJECT("pitch", fg_expected_check, before[FG_FORMED_PITCH], &fg_formed_law_members),
     .words = "angle from bump to bump"},
};
static const fg_members before_members = FG_MEMBERS(before_rows);

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/expected/1")},
    {FG_TEXT_BY("summary", find_check_sentence), .options = FG_MEMBER_NEVER_NULL,
     .words = "outcome in a sentence"},
    {FG_NUMBER_BY("error_before_pct", find_error_before),
     .words = "of the lot before, rms over the bumps"},
    {FG_NUMBER_BY("error_after_pct", find_error_after), .words = "of this lot"},
    {FG_FLAG_BY("holds", find_holds), .options = FG_MEMBER_NULLABLE,
     .words = "p_value is 0.01 or more; null: not known"},
    {FG_COUNT("inside", fg_expected_check, inside), .words = "values inside their intervals"},
    {FG_COUNT("values", fg_expected_check, of), .words = "values held"},
    {FG_NUMBER("p_value", fg_expected_check, p_value),
     .words = "that a lot of the predicted process is as far off in all radii together"},
    {FG_TEXT("prediction", fg_expected_check, path), .options = FG_MEMBER_ANY_TEXT,
     .words = "report of `foilgauge die --target`"},
    {FG_SHA256("prediction_sha256", fg_expected_check, sha256), .words = "of that file"},
    {FG_COUNT("foils", fg_expected_check, foils), .words = "of the lot"},
    {FG_OBJECT("overall_radius_mm", fg_expected_check, overall_radius_mm, &held_members),
     .words = "R0"},
    {FG_OBJECT("pitch_deg", fg_expected_check, pitch_deg, &held_members),
     .words = "from bump to bump; 0 without bumps"},
    {FG_ARRAY("bumps", fg_expected_check, bump, bumps, &fg_held_bump_members),
     .words = "in the order of numbers"},
    {FG_ARRAY("iterations", fg_expected_check, iteration, iterations, &fg_iteration_members),
     .options = FG_MEMBER_ON_LINE, .words = "each die with its lot, the oldest first"},
    {FG_GROUP("loop", &loop_members),
     .words = "over the springback of all lots, against the law without single bumps"},
    {FG_GROUP("law_before", &before_members), .words = "that predicted"},
    {FG_OBJECT("target", fg_expected_check, next.target, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_OBJECT("die", fg_expected_check, next.die, &fg_die_dimensions_members),
     .words = "of the lot, as it was to be cut"},
    {FG_POINTED("law", fg_expected_check, next.law, &fg_law_members), .words = "with this lot"},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_expected_document = {
    .file = "expected",
    .title = "foilgauge lot --expected report",
    .description = "A lot against its prediction. Units are in the names. u_ is a standard "
                   "uncertainty. null is a value that is not known.",
    .made_by = "`foilgauge lot --expected`",
    .members = &report_members,
};

fg_status fg_expected_check_write_json(fg_context *ctx, const fg_expected_check *check, FILE *out) {
  fg_document_json(out, &report_members, check);
  return fg_stream_finish(ctx, out, "the JSON report");
}
