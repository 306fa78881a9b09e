/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/die/members.h"
#include "quantity/parts.h"

#include "core/file.h"
#include "foilgauge/die_report.h"
#include "report/design/members.h"
#include "report/verdict_members.h"

static const fg_die *die_of(const fg_subject *subject) {
  return subject->whole;
}

/* Value, sd_ and u_ of an fg_die_value. */
#define DIE_VALUE(name, object, field)                                                             \
  FG_NUMBER_U(name, object, field.value, field.u), .sd_offset = FG_FIELD(object, field.sd, double)

/* The quantities of an array of fg_die_value. */
static bool make_value_row(size_t q, fg_member *row) {
  if (q >= FG_DIE_QUANTITIES) return false;
  const fg_die_row *of = fg_die_row_of((fg_die_quantity)q);
  *row = (fg_member){.name = of->name,
                     .kind = FG_MEMBER_NUMBER,
                     .offset = q * sizeof(fg_die_value) + offsetof(fg_die_value, value),
                     .sd_offset = q * sizeof(fg_die_value) + offsetof(fg_die_value, sd),
                     .u_offset = q * sizeof(fg_die_value) + offsetof(fg_die_value, u),
                     .words = of->words};
  return true;
}

static const fg_member value_rows[] = {{FG_SAME_BY(make_value_row)}};
static const fg_members value_members = FG_MEMBERS_DEFINED(value_rows, "values");

static fg_subject find_values(const fg_subject *subject) {
  const fg_die_bump *bump = subject->object;
  return (fg_subject){.object = bump->value, .whole = subject->whole};
}

static int judge_die_bump(const fg_subject *subject) {
  return (int)fg_die_judge_bump(die_of(subject), subject->object);
}

#define BUMP_ROWS(count_name)                                                                      \
  {FG_INTEGER("number", fg_die_bump, number), .words = "of the design, from 1"},                   \
      {FG_COUNT(count_name, fg_die_bump, count), .lowest = 1,                                      \
       .words = "that the values are means of"},                                                   \
      {FG_WORD_BY("verdict", judge_die_bump, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,   \
       .words = FG_VERDICT_WORDS},                                                                 \
  {                                                                                                \
    FG_SAME(&value_members), .part = find_values, .options = FG_MEMBER_NEVER_NULL                  \
  }

static const fg_member half_bump_rows[] = {BUMP_ROWS("repeats")};
static const fg_members half_bump_members = FG_MEMBERS_DEFINED(half_bump_rows, "half_bump");
static const fg_member die_bump_rows[] = {BUMP_ROWS("halves")};
static const fg_members die_bump_members = FG_MEMBERS_DEFINED(die_bump_rows, "die_bump");

static const fg_member overall_rows[] = {
    {DIE_VALUE("radius_mm", fg_die_side, overall_radius_mm), .words = "of the lands"},
    {DIE_VALUE("radius_error_pct", fg_die_side, overall_error_pct), .words = "of the design's"},
};
static const fg_members overall_members = FG_MEMBERS_DEFINED(overall_rows, "overall");

#define SIDE_ROWS(bump_members)                                                                    \
  {FG_GROUP("overall", &overall_members), .words = "the circle through the lands"},                \
      {FG_OBJECT("mean", fg_die_side, mean, &value_members), .words = "over the bumps"}, {         \
    FG_LIST("bumps", fg_die_side, bumps, bump_count, &(bump_members)),                             \
        .words = "in the order of numbers"                                                         \
  }

static const fg_member die_rows[] = {SIDE_ROWS(die_bump_members)};
static const fg_members die_members = FG_MEMBERS(die_rows);

/* A half: the subject's index is its fg_die_half. */
static bool find_half(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_die *die = list->object;
  if (i >= FG_DIE_HALVES) return false;
  element->object = die->half[i].traces ? &die->half[i] : NULL;
  return true;
}

static const char *const half_words[] = {
    [FG_DIE_CONCAVE] = "concave", [FG_DIE_CONVEX] = "convex", [FG_DIE_HALVES] = NULL};

static int find_half_word(const fg_subject *subject) {
  return (int)subject->index;
}

static const char *find_unseen(const fg_subject *subject, char *buffer) {
  fg_die_unseen(die_of(subject), (fg_die_half)subject->index, FG_DIE_UNSEEN, buffer, 200);
  return buffer;
}

static const char *find_lost(const fg_subject *subject, char *buffer) {
  fg_die_unseen(die_of(subject), (fg_die_half)subject->index, FG_DIE_LOST, buffer, 200);
  return buffer;
}

static const fg_member half_rows[] = {
    {FG_WORD_BY("half", find_half_word, half_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "by its bumps: grooves, ridges"},
    {FG_COUNT("traces", fg_die_side, traces), .lowest = 1, .words = "of the half"},
    {FG_TEXT_BY("bumps_not_seen", find_unseen), .options = FG_MEMBER_NEVER_NULL,
     .words = "numbers of the design's bumps that no trace measured"},
    {FG_TEXT_BY("bumps_lost", find_lost), .options = FG_MEMBER_NEVER_NULL,
     .words = "of these, the ones that were traced: dust, a burr, a lost contact"},
    SIDE_ROWS(half_bump_members),
};
static const fg_members half_members = FG_MEMBERS(half_rows);

/* A trace. */
static const fg_member trace_bump_rows[] = {
    {FG_INTEGER("number", fg_bump, number), .words = "of the design, from 1"},
    {FG_NUMBER_U("radius_mm", fg_bump, radius_mm, u_radius_mm), .words = "of its circle"},
    {FG_RANGE("centre_mm", fg_bump, centre_mm.x, centre_mm.y), .words = "x, z as traced"},
    {FG_NUMBER_U("bump_angle_deg", fg_bump, bump_angle_deg, u_bump_angle_deg),
     .words = "between its ends on the overall circle"},
    {FG_NUMBER_U("height_mm", fg_bump, height_mm, u_height_mm), .words = "over the overall circle"},
    {FG_NUMBER("rms_um", fg_bump, rms_um), .words = "of its residuals"},
    {FG_COUNT("points", fg_bump, points), .words = "stations of its arc"},
};
static const fg_members trace_bump_members = FG_MEMBERS_DEFINED(trace_bump_rows, "trace_bump");

static double find_form_error_sd_um(const fg_subject *subject) {
  return 1000 * ((const fg_die_form_error *)subject->object)->sd_mm;
}

static int find_correlation(const fg_subject *subject) {
  return ((const fg_die_form_error *)subject->object)->smooth;
}

static const char *const correlation_words[] = {"exponential", "smooth", NULL};

static const fg_member form_error_rows[] = {
    {FG_NUMBER_BY("sd_um", find_form_error_sd_um), .words = "of means over a small part of an arc"},
    {FG_NUMBER("white_share", fg_die_form_error, white_share),
     .words = "of the variance; the rest is correlated"},
    {FG_NUMBER("length_mm", fg_die_form_error, length_mm), .words = "of the correlation"},
    {FG_WORD_BY("correlation", find_correlation, correlation_words),
     .options = FG_MEMBER_NEVER_NULL},
};
static const fg_members form_error_members = FG_MEMBERS(form_error_rows);

static const fg_member lands_rows[] = {
    {FG_NUMBER_U("radius_mm", fg_overall, radius_mm, u_radius_mm), .words = "of the lands"},
    {FG_RANGE("centre_mm", fg_overall, centre_mm.x, centre_mm.y), .words = "x, z as traced"},
    {FG_NUMBER("rms_um", fg_overall, rms_um), .words = "of its residuals"},
};
static const fg_members lands_members = FG_MEMBERS(lands_rows);

static const fg_member lost_rows[] = {{.kind = FG_MEMBER_INTEGER}};
static const fg_members lost_members = FG_MEMBERS(lost_rows);

static const char *const unit_words[] = {"mm", "um", "nm", NULL};

static const char *find_x_unit(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_die_unit_word(((const fg_die_trace *)subject->object)->unit[0]);
}

static const char *find_z_unit(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_die_unit_word(((const fg_die_trace *)subject->object)->unit[1]);
}

static const char *find_bump_range(const fg_subject *subject, char *buffer) {
  const fg_die_trace *trace = subject->object;
  snprintf(buffer, 40, "%d…%d", trace->bumps[0].number, trace->bumps[trace->bump_count - 1].number);
  return buffer;
}

static const char *find_half_of_trace(const fg_subject *subject, char *buffer) {
  const fg_die_trace *trace = subject->object;
  snprintf(buffer, 40, "%s %d", half_words[trace->half], trace->repeat);
  return buffer;
}

static const char *find_units(const fg_subject *subject, char *buffer) {
  const fg_die_trace *trace = subject->object;
  snprintf(buffer, 40, "%s, %s", fg_die_unit_word(trace->unit[0]),
           fg_die_unit_word(trace->unit[1]));
  return buffer;
}

static const char *find_short_sum(const fg_subject *subject, char *buffer) {
  snprintf(buffer, 40, "%.12s…", ((const fg_die_trace *)subject->object)->sha256);
  return buffer;
}

static double find_trace_median(const fg_subject *subject) {
  const fg_die_trace *trace = subject->object;
  return fg_bump_radius_median(trace->bumps, trace->bump_count);
}

static const fg_member trace_rows[] = {
    {FG_STRING("path", fg_die_trace, path), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the trace", .page = {.rank = 1, .heading = "profile", .words = true}},
    {FG_TEXT_BY("half", find_half_of_trace), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "half", .words = true}},
    {FG_SHA256("sha256", fg_die_trace, sha256)},
    {FG_WORD("half", fg_die_trace, half, half_words), .words = "by its bumps: grooves, ridges"},
    {FG_INTEGER("repeat", fg_die_trace, repeat), .lowest = 1,
     .words = "among its half's traces, from 1"},
    {FG_TEXT_BY("x_unit", find_x_unit), .choices = unit_words, .options = FG_MEMBER_NEVER_NULL,
     .words = "of the file"},
    {FG_TEXT_BY("z_unit", find_z_unit), .choices = unit_words, .options = FG_MEMBER_NEVER_NULL,
     .words = "of the file"},
    {FG_NUMBER("tip_um", fg_die_trace, tip_um), .words = "radius of the stylus",
     .options = FG_MEMBER_NEVER_NULL | FG_MEMBER_NOT_NEGATIVE,
     .page = {.rank = 3, .heading = "tip,\nµm", .digits = 6}},
    {FG_NUMBER("shift_mm", fg_die_trace, shift_mm), .options = FG_MEMBER_NEVER_NULL,
     .words = "tip and datum: added to a bump's traced radius, taken off that of the lands"},
    {FG_TEXT_BY("bumps", find_bump_range), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "bumps"}},
    {FG_NUMBER_BY("bump_radius_median_mm", find_trace_median),
     .words = "median radius of the trace's bumps",
     .page = {.rank = 2, .heading = "median R,\nmm", .decimals = 4}},
    {FG_COUNT("points", fg_die_trace, points), .words = "of the file",
     .page = {.rank = 2, .heading = "points"}},
    {FG_NUMBER("length_mm", fg_die_trace, length_mm), .words = "along x",
     .page = {.rank = 2, .heading = "length,\nmm", .decimals = 2}},
    {FG_NUMBER("step_um", fg_die_trace, step_um),
     .words = "between stations, each a mean of neighbouring points"},
    {FG_TEXT_BY("units", find_units), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .heading = "unit\nx, z"}},
    {FG_NUMBER("steep_share", fg_die_trace, steep_share),
     .words = "of the stations: steeper than max_slope_deg, in no fit",
     .page = {.rank = 5, .heading = "too\nsteep", .decimals = 1, .scale = 100, .unit = " %"}},
    {FG_COUNT("lands", fg_die_trace, lands), .words = "between its bumps"},
    {FG_COUNT("bumps_cut_off", fg_die_trace, cut_bumps),
     .words = "their crowns are seen, but not enough of their arcs"},
    {FG_LIST("bumps_lost", fg_die_trace, lost, lost_count, &lost_members),
     .words = "of these, the numbers of those that were traced from foot to foot"},
    {FG_NUMBER("noise_um", fg_die_trace, noise_um), .words = "sd of the bumps' residuals",
     .page = {.rank = 4, .heading = "noise,\nµm", .decimals = 3}},
    {FG_OBJECT("form", fg_die_trace, form_error, &form_error_members), .options = FG_MEMBER_ON_LINE,
     .words =
         "noise along the bumps' arcs: white beside correlated, exp(-d/length) or, smooth, (1 + "
         "d/length + (d/length)^2/3) exp(-d/length)"},
    {FG_OBJECT("overall", fg_die_trace, overall, &lands_members),
     .words = "the circle through the lands"},
    {FG_LIST("bumps", fg_die_trace, bumps, bump_count, &trace_bump_members),
     .options = FG_MEMBER_ON_LINE, .words = "in the order of numbers"},
    {FG_TEXT_BY("sha256", find_short_sum), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 6, .heading = "SHA-256", .words = true}},
};
const fg_members fg_die_trace_members = FG_MEMBERS(trace_rows);

bool fg_die_trace_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_die *die = list->object;
  element->object = &die->traces[i];
  return i < die->trace_count;
}

/* The report. */
static fg_verdict judge_die(const fg_subject *subject) {
  fg_report_outcome outcome;
  fg_die_judge(subject->object, &outcome, NULL, 0);
  return outcome.verdict;
}

static double find_die_in_tolerance(const fg_subject *subject) {
  return fg_is_in_tolerance(judge_die(subject));
}

static int find_die_verdict(const fg_subject *subject) {
  return (int)judge_die(subject);
}

static const char *find_die_summary(const fg_subject *subject, char *buffer) {
  fg_report_outcome outcome;
  fg_die_judge(subject->object, &outcome, buffer, 200);
  return buffer;
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/die/1")},
    {FG_FLAG_BY("in_tolerance", find_die_in_tolerance), .options = FG_MEMBER_NULLABLE,
     .words = FG_IN_TOLERANCE_WORDS},
    {FG_WORD_BY("verdict", find_die_verdict, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_VERDICT_WORDS},
    {FG_TEXT_BY("summary", find_die_summary), .options = FG_MEMBER_NEVER_NULL,
     .words = "outcome in a sentence"},
    {FG_OBJECT("design", fg_die, design, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_OBJECT("nominal", fg_die, nominal, &fg_nominal_members),
     .schema = "{\"type\": \"object\"}"},
    {FG_NUMBER("u_tip_um", fg_die, options.u_tip_um), .options = FG_MEMBER_NOT_NEGATIVE,
     .words = "of the tip's radius"},
    {FG_NUMBER("u_scale_ppm", fg_die, options.u_scale_ppm), .options = FG_MEMBER_NOT_NEGATIVE,
     .words = "of the profilometer's scale"},
    {FG_NUMBER("max_slope_deg", fg_die, options.max_slope_deg),
     .words = "steeper flanks are in no fit"},
    {FG_OBJECT("die", fg_die, whole, &die_members), .words = "mean of the halves"},
    {FG_LIST_BY("halves", find_half, &half_members), .lowest = 1, .highest = 2,
     .words = "those that were traced"},
    {FG_LIST("traces", fg_die, traces, trace_count, &fg_die_trace_members), .lowest = 1,
     .words = "in the order given"},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_die_document = {
    .file = "die",
    .title = "foilgauge die report",
    .description =
        "Units are in the names. u_ is a standard uncertainty, sd_ a standard deviation: "
        "of one repeat, of a mean that of the bumps. null is a value that is not known.",
    .made_by = "`foilgauge die`",
    .members = &report_members,
};

fg_status fg_die_write_json(fg_context *ctx, const fg_die *die, FILE *out) {
  fg_document_json(out, &report_members, die);
  return fg_stream_finish(ctx, out, "the JSON report");
}
