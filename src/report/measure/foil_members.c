/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/foil_members.h"

#include <math.h>
#include <string.h>

#include "foilgauge/foil_kind.h"
#include "foilgauge/words.h"
#include "quantity/parts.h"
#include "report/correction_words.h"
#include "report/flag_names.h"
#include "report/quantity_members.h"
#include "report/verdict_members.h"

#define FORM_ERROR_WORDS                                                                           \
  "only in a loop's report: peak-to-valley deviation of the foil from this least-squares circle "  \
  "(ISO 12181), by its own shape"
#define RANGE_WORDS "lowest and highest over explanations that a loop could not tell apart"

static const fg_judged *judged_of(const fg_subject *subject) {
  return subject->whole;
}

/* A 3 x 3 covariance: the rows' subject is its matrix. */
static bool find_covariance_row(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = (const double *)list->object + 3 * i;
  return i < 3;
}

static const double *list_covariance_row(const fg_subject *subject, double *values, size_t *count) {
  (void)values;
  *count = 3;
  return subject->object;
}

static const fg_member covariance_row[] = {
    {FG_NUMBERS_BY(NULL, list_covariance_row), .lowest = 3, .highest = 3}};
static const fg_members covariance_members = FG_MEMBERS(covariance_row);
static const fg_member covariance_rows[] = {
    {FG_LIST_BY("covariance_mm2", find_covariance_row, &covariance_members), .lowest = 3,
     .highest = 3, .options = FG_MEMBER_LIST_ON_LINE, .words = "of centre x, centre y, radius"}};
static const fg_members covariance_list = FG_MEMBERS(covariance_rows);
#define COVARIANCE(object_, field) FG_SAME(&covariance_list), .offset = offsetof(object_, field)

/* Ranges over explanations: only where a loop left a tie. */
#define RANGE_OF(function, object_, field)                                                         \
  static const double *function(const fg_subject *subject, double *values, size_t *count) {        \
    const double *range = ((const object_ *)subject->object)->field;                               \
    (void)values;                                                                                  \
    *count = range[0] != 0 || range[1] != 0 ? 2 : 0;                                               \
    return range;                                                                                  \
  }
RANGE_OF(find_overall_range, fg_foil, overall.radius_range_mm)
RANGE_OF(find_radius_range, fg_bump, radius_range_mm)
RANGE_OF(find_height_range, fg_bump, height_range_mm)
RANGE_OF(find_disc_range, fg_disc, radius_range_mm)
#define RANGE(name_, function)                                                                     \
  FG_NUMBERS_BY(name_, function), .lowest = 2, .highest = 2,                                       \
                                  .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_NEVER_NULL,            \
                                  .words = RANGE_WORDS

/* Form errors: only in what a loop reports. */
static bool has_form_error(const fg_form_error *error) {
  return isnan(error->um) || error->u_um > 0;
}
#define FORM_ERROR_OF(function, range_function, object_, field)                                    \
  static bool function(const fg_subject *subject) {                                                \
    return has_form_error(&((const object_ *)subject->object)->field);                             \
  }                                                                                                \
  RANGE_OF(range_function, object_, field.range_um)
FORM_ERROR_OF(has_bump_form_error, find_bump_deviation_range, fg_bump, form_error)
FORM_ERROR_OF(has_overall_form_error, find_overall_deviation_range, fg_foil, overall.form_error)
#define FORM_ERROR(object_, field, present_, range_function)                                       \
  {FG_NUMBER("form_error_um", object_, field.um), .present = present_, .words = FORM_ERROR_WORDS}, \
      {FG_NUMBER("u_form_error_um", object_, field.u_um), .present = present_}, {                  \
    FG_NUMBERS_BY("form_error_range_um", range_function),                                          \
        .lowest = 2, .highest = 2, .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_NEVER_NULL,           \
        .words = "where the edges do not tell the foil's deviation from the scanner's: lowest "    \
                 "and highest, U included; form_error_um is null"                                  \
  }

/* A bump and a beam. */
static const char *bump_flag_at(const fg_subject *subject, size_t i) {
  const fg_judged *judged = judged_of(subject);
  return fg_flag_name_at(fg_bump_flag_words(),
                         fg_bump_flags(judged->design, judged->foil, subject->object), 0, i);
}

static const char *beam_flag_at(const fg_subject *subject, size_t i) {
  const fg_judged *judged = judged_of(subject);
  return fg_flag_name_at(fg_beam_flag_words(),
                         fg_beam_flags(judged->design, judged->foil, subject->object), 0, i);
}

static int judge_bump(const fg_subject *subject) {
  const fg_judged *judged = judged_of(subject);
  return (int)fg_bump_verdict(judged->design, judged->foil, subject->object);
}

static int judge_beam(const fg_subject *subject) {
  const fg_judged *judged = judged_of(subject);
  return (int)fg_beam_verdict(judged->design, judged->foil, subject->object);
}

#define FLAGS(function, choice)                                                                    \
  FG_TEXTS_BY("flags", function), .choice_at = (choice), .options = FG_MEMBER_ON_LINE
#define PART_VERDICT(function)                                                                     \
  FG_WORD_BY("verdict", function, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL

static const fg_member bump_rows[] = {
    {FG_INTEGER("number", fg_bump, number), .lowest = 1, .words = "1 is next to the lip"},
    {FLAGS(bump_flag_at, fg_bump_flag_choice), .words = "what is wrong with it"},
    {PART_VERDICT(judge_bump), .words = "the worst of the bump's values; not_measured when it was "
                                        "not fitted, or its foil not measured"},
    {FG_SAME_BY(fg_bump_quantity_at)},
    {COVARIANCE(fg_bump, covariance)},
    {RANGE("radius_range_mm", find_radius_range)},
    {RANGE("height_range_mm", find_height_range)},
    FORM_ERROR(fg_bump, form_error, has_bump_form_error, find_bump_deviation_range),
};
static const fg_members bump_members = FG_MEMBERS_OF_FILE(bump_rows, "bump", "measure");

static const fg_member beam_rows[] = {
    {FG_INTEGER("number", fg_beam, number), .lowest = 1,
     .words = "from left to right with the tips up; else clockwise"},
    {FLAGS(beam_flag_at, fg_beam_flag_choice), .words = "what is wrong with it"},
    {PART_VERDICT(judge_beam),
     .words = "the worst of the beam's values; not_measured without a length or a width"},
    {FG_SAME_BY(fg_beam_quantity_at)},
    {FG_PAIR("root_mm", fg_beam, root_mm),
     .words = "end of its axis at the root, in the scan: x, y"},
    {FG_PAIR("tip_mm", fg_beam, tip_mm), .words = "end of its axis at the tip"},
};
static const fg_members beam_members = FG_MEMBERS_OF_FILE(beam_rows, "beam", "measure");

static bool find_bump(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_foil *foil = list->object;
  if (i >= foil->bump_count) return false;
  element->object = &foil->bumps[i];
  return true;
}

static bool find_beam(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_foil *foil = list->object;
  if (i >= foil->beam_count) return false;
  element->object = &foil->beams[i];
  return true;
}

/* The strip: without stations it has no numbers. */
static fg_subject find_strip_values(const fg_subject *subject) {
  static const fg_strip not_seen = {.step_mm = NAN,
                                    .blur_left_um = NAN,
                                    .blur_right_um = NAN,
                                    .contrast = NAN,
                                    .noise = NAN,
                                    .gamma = NAN};
  const fg_strip *strip = subject->object;
  return (fg_subject){.object = strip->count > 0 ? strip : &not_seen};
}

static const double *list_box_px(const fg_subject *subject, double *values, size_t *count) {
  const fg_strip *strip = subject->object;
  for (*count = 0; *count < 4; ++*count)
    values[*count] = (double)strip->box_px[*count];
  return values;
}

static const fg_member strip_rows[] = {
    {FG_SAME_BY(fg_strip_quantity_at), .part = find_strip_values},
    {FG_NUMBERS_BY("box_px", list_box_px), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL, .words = "x, y, width, height"},
};
static const fg_members strip_members = FG_MEMBERS_OF_FILE(strip_rows, "strip", "measure");

static const fg_member overall_rows[] = {
    {FG_SAME_BY(fg_overall_quantity_at)},
    {COVARIANCE(fg_foil, overall.covariance)},
    {RANGE("radius_range_mm", find_overall_range)},
    FORM_ERROR(fg_foil, overall.form_error, has_overall_form_error, find_overall_deviation_range),
};
static const fg_members overall_members = FG_MEMBERS_OF_FILE(overall_rows, "overall", "measure");

static const fg_member arc_rows[] = {{FG_SAME_BY(fg_arc_quantity_at)}};
static const fg_members arc_members = FG_MEMBERS_OF_FILE(arc_rows, "arc", "measure");

/* Every foil, before and after the decision. */
static const char *foil_flag_at(const fg_subject *subject, size_t i) {
  const fg_foil *foil = subject->object;
  return fg_flag_name_at(fg_foil_flag_words(), foil->flags, foil->strip.picture.findings, i);
}

static const double *list_place_of_foil(const fg_subject *subject, double *values, size_t *count) {
  (void)values;
  *count = 4;
  return ((const fg_foil *)subject->object)->place_mm;
}

static const fg_member foil_head_rows[] = {
    {FG_INTEGER("number", fg_foil, number), .lowest = 1, .words = "reading order in the scan"},
    {FLAGS(foil_flag_at, fg_foil_flag_choice), .words = "what is wrong with it"},
    {FG_NUMBERS_BY("place_mm", list_place_of_foil), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "the box that holds it in the scan: x, y, width, height"},
    {FG_TEXT("error", fg_foil, error), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why it was not measured, or not as a foil of the design"},
};
static const fg_members foil_head_members = FG_MEMBERS(foil_head_rows);

static bool is_measured(const fg_subject *subject) {
  return fg_foil_is_measured(judged_of(subject)->foil);
}

/* Rows whose subject is the judged foil itself. */
#define OF_FOIL(members_)                                                                          \
  .kind = FG_MEMBER_SAME, .pointed = true, .offset = offsetof(fg_judged, foil),                    \
  .members = (members_)
#define FOIL_HEAD                                                                                  \
  {OF_FOIL(&foil_head_members)}, {FG_VERDICT(fg_judged, decision.outcome.verdict)},                \
      {FG_TEXT("defect", fg_judged, defect), .options = FG_MEMBER_EMPTY_IS_NULL,                   \
       .words = "what rejects the foil whatever its values are: parts missing or too many"},       \
  {                                                                                                \
    FG_JUDGEMENTS(fg_judged, decision), .words = FG_JUDGEMENTS_WORDS, .present = is_measured       \
  }

/* A foil that is seen from its edge. */
static const char *find_orientation(const fg_subject *subject, char *buffer) {
  const fg_foil *foil = subject->object;
  const fg_foil_traits *traits = fg_foil_traits_of(judged_of(subject)->design->kind);
  (void)buffer;
  bool turns = !(foil->flags & FG_FOIL_NOT_MEASURED) && !traits->is_plain_strip;
  return turns ? fg_orientation_word(foil->orientation) : NULL;
}

static const char *orientation_choice(size_t i) {
  return i <= FG_COUNTERCLOCKWISE ? fg_orientation_word((fg_orientation)i) : NULL;
}

static int find_thickness_source(const fg_subject *subject) {
  return judged_of(subject)->design->thickness_measured_mm > 0 ? 0 : 1;
}

static double find_design_thickness(const fg_subject *subject) {
  return judged_of(subject)->design->thickness_mm;
}

static double differs_in_thickness(const fg_subject *subject) {
  const fg_design *design = judged_of(subject)->design;
  const fg_thickness strip = fg_foil_thickness(design, subject->object);
  return fg_thickness_differs(design, &strip);
}

static bool has_arc(const fg_subject *subject) {
  const fg_quantity *length = fg_quantity_find(FG_QUANTITY_OF_FOIL, "arc.length_mm");
  return fg_quantity_applies(FG_QUANTITY_OF_FOIL, length, judged_of(subject)->design->kind);
}

static const char *const thickness_sources[] = {"statement", "scan", NULL};

static double find_bump_median(const fg_subject *subject) {
  const fg_foil *foil = subject->object;
  return fg_bump_radius_median(foil->bumps, foil->bump_count);
}

static const fg_member strip_value_rows[] = {
    {FG_TEXT_BY("orientation", find_orientation), .choice_at = orientation_choice,
     .words = "which way the bump numbers rise as the scan is seen"},
    {FG_SAME_BY(fg_foil_quantity_at)},
    {FG_WORD_BY("thickness_by", find_thickness_source, thickness_sources),
     .options = FG_MEMBER_NEVER_NULL,
     .words = "where thickness_mm comes from: stated as measured, or the scan"},
    {FG_NUMBER_BY("thickness_design_mm", find_design_thickness), .options = FG_MEMBER_NEVER_NULL},
    {FG_FLAG_BY("thickness_differs", differs_in_thickness),
     .words = "from the design's by more than 2 u; clearances are over the strip as measured: with "
              "the design's thickness they would be thickness_mm - thickness_design_mm larger"},
    {FG_GROUP("overall", &overall_members), .words = "the circle through the lands"},
    {FG_GROUP("arc", &arc_members), .present = has_arc,
     .words = "form arc: from end to end of a plain strip; null where an end is not seen"},
    {FG_OBJECT("correction", fg_foil, correction, &fg_correction_members),
     .present = fg_foil_is_corrected, .words = FG_CORRECTION_WORDS_OF_MODEL},
    {FG_CHOICES(fg_foil_choice_at, fg_foil_has_choices)},
    {FG_OBJECT("strip", fg_foil, strip, &strip_members), .words = "the edges as they were traced"},
    {FG_NUMBER_BY("bump_radius_median_mm", find_bump_median), .options = FG_MEMBER_LEFT_OUT,
     .words = "median radius of the fitted bumps"},
    {FG_LIST_BY("bumps", find_bump, &bump_members), .words = "in the order of their numbers"},
};
static const fg_members strip_value_members = FG_MEMBERS(strip_value_rows);

static const fg_member foil_rows[] = {FOIL_HEAD, {OF_FOIL(&strip_value_members)}};
const fg_members fg_foil_members = FG_MEMBERS_OF_FILE(foil_rows, "foil", "measure");

/* A flat foil. */
static const fg_member flat_value_rows[] = {
    {FG_SAME_BY(fg_flat_foil_quantity_at)},
    {FG_NUMBER_BY("thickness_design_mm", find_design_thickness),
     .words = "the design's: a scan of a flat foil does not show it"},
    {FG_LIST_BY("beams", find_beam, &beam_members), .words = "in the order of their numbers"},
};
static const fg_members flat_value_members = FG_MEMBERS(flat_value_rows);

static const fg_member flat_foil_rows[] = {FOIL_HEAD, {OF_FOIL(&flat_value_members)}};
const fg_members fg_flat_foil_members = FG_MEMBERS_OF_FILE(flat_foil_rows, "flat_foil", "measure");

/* A disc. */
static const char *disc_flag_at(const fg_subject *subject, size_t i) {
  const fg_disc *disc = subject->object;
  return fg_flag_name_at(fg_bump_flag_words(), fg_disc_flags(judged_of(subject)->design, disc),
                         disc->picture.findings, i);
}

static const fg_member disc_head_rows[] = {
    {FG_INTEGER("number", fg_disc, number), .lowest = 1, .words = "reading order in the scan"},
    {FLAGS(disc_flag_at, fg_disc_flag_choice), .words = "what is wrong with it"},
    {FG_FLAG("hole", fg_disc, hole)},
    {FG_FLAG("bright", fg_disc, bright), .words = "brighter than what surrounds it"},
};
static const fg_members disc_head_members = FG_MEMBERS(disc_head_rows);

static const fg_member disc_value_rows[] = {
    {FG_SAME_BY(fg_disc_quantity_at)},
    {COVARIANCE(fg_disc, covariance)},
    {RANGE("radius_range_mm", find_disc_range)},
    {FG_CHOICES(fg_disc_choice_at, fg_disc_has_choice)},
};
static const fg_members disc_value_members = FG_MEMBERS(disc_value_rows);

#define OF_DISC(members_)                                                                          \
  .kind = FG_MEMBER_SAME, .pointed = true, .offset = offsetof(fg_judged, disc),                    \
  .members = (members_)
static const fg_member disc_rows[] = {
    {OF_DISC(&disc_head_members)},
    {FG_VERDICT(fg_judged, decision.outcome.verdict)},
    {FG_JUDGEMENTS(fg_judged, decision), .words = FG_JUDGEMENTS_WORDS},
    {OF_DISC(&disc_value_members)},
};
const fg_members fg_disc_members = FG_MEMBERS_OF_FILE(disc_rows, "disc", "measure");
