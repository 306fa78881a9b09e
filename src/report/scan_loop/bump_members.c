/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bumps against the declared springback, or against a forming's prediction. */
#include <math.h>

#include "core/text.h"
#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"

static const char *const quantity_words[] = {"bump_radius_mm", "bump_angle_deg", "height_mm", NULL};
static const char *const unit_words_of_bumps[] = {"um", "deg", NULL};

static const fg_member declared_rows[] = {
    {FG_STRING("path", fg_scan_result_bumps, declared_path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sha256", fg_scan_result_bumps, declared_sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = "^[0-9a-f]{64}$"},
};
static const fg_members declared_members = FG_MEMBERS(declared_rows);

static fg_subject find_declared_forming(const fg_subject *s) {
  const fg_scan_result_bumps *bumps = s->object;
  return (fg_subject){bumps->declared_path ? bumps : NULL, s->whole, 0};
}

/* Responses, and the height, which follows from both: their errors. */
static bool find_bump_response(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scan_result_bumps *bumps = &fg_scan_result_of(list)->bumps;
  element->object = i < FG_SCAN_RESULT_RESPONSES ? &bumps->response[i].error : &bumps->height_um;
  return i <= FG_SCAN_RESULT_RESPONSES;
}

static fg_subject find_response_facts(const fg_subject *s) {
  static const fg_scan_result_response height = {
      .name = "height_mm",
      .words = "height",
      .unit = "um",
      .model = "follows from radius and angle",
      .level = NAN,
      .u_level = NAN,
  };
  const fg_scan_result_bumps *bumps = &fg_scan_result_of(s)->bumps;
  bool is_height = s->index >= FG_SCAN_RESULT_RESPONSES;
  return (fg_subject){is_height ? &height : &bumps->response[s->index], s->whole, s->index};
}

static const fg_member fact_rows[] = {
    {FG_STRING("response", fg_scan_result_response, name), .choices = quantity_words,
     .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("unit", fg_scan_result_response, unit), .choices = unit_words_of_bumps,
     .options = FG_MEMBER_NEVER_NULL, .words = "of the numbers beside it"},
    {FG_STRING("model", fg_scan_result_response, model), .options = FG_MEMBER_NEVER_NULL,
     .words = "declared of it"},
    {FG_NUMBER_U("level", fg_scan_result_response, level, u_level),
     .words = "mean of measured minus declared, which the errors are without; null where no "
              "forming is declared, or the model has no level"},
};
static const fg_members fact_members = FG_MEMBERS(fact_rows);

static const char *find_response_title(const fg_subject *s, char *buffer) {
  const fg_scan_result_response *response = find_response_facts(s).object;
  fg_text_clip(buffer, 80, "%s, %s", response->words, fg_scan_loop_unit_words(response->unit));
  return buffer;
}

static const char *find_response_model(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_scan_result_response *)find_response_facts(s).object)->model;
}

static const fg_member response_rows[] = {
    {FG_SAME(&fact_members), .part = find_response_facts, .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("response", find_response_title), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "rms about the declared model"}},
    {FG_TEXT_BY("model", find_response_model), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "model", .words = true}},
    {FG_NUMBER("rms_before", fg_scan_result_bump_error, rms[0]),
     .words = "about the declared model; null where too few bumps were measured",
     .page = {.rank = 1, .heading = "before", .digits = 3}},
    {FG_NUMBER("rms_after", fg_scan_result_bump_error, rms[1]), .words = "with what was found",
     .page = {.rank = 1, .heading = "after", .digits = 3}},
    {FG_NUMBER("held_out_rms_before", fg_scan_result_bump_error, held_out_rms[0]),
     .words =
         "of scans kept aside; without, cross-fitted as tables are, where what was found first is "
         "what stands; without a finding rms_before. Heights follow from both others: null without "
         "scans kept aside",
     .page = {.rank = 1, .heading = "took no part:\nbefore", .digits = 3}},
    {FG_NUMBER("held_out_rms_after", fg_scan_result_bump_error, held_out_rms[1]),
     .words = "the same with what was found", .page = {.rank = 1, .heading = "after", .digits = 3}},
};
const fg_members fg_scan_response_members = FG_MEMBERS(response_rows);

bool fg_scan_find_judged(const fg_subject *list, size_t i, fg_subject *element) {
  if (!find_bump_response(list, i, element)) return false;
  const fg_scan_result_bump_error *error = element->object;
  if (!isfinite(error->rms[0])) element->object = NULL;
  return true;
}

static const fg_member bumps_rows[] = {
    {FG_COUNT("count", fg_scan_result_bumps, count), .words = "bumps that were tested"},
    {FG_COUNT("kept_aside", fg_scan_result_bumps, held_out), .words = "further ones"},
    {FG_COUNT("foils", fg_scan_result_bumps, parts), .words = "foils that they are of"},
    {FG_PART("declared", find_declared_forming, &declared_members),
     .words = "the report of `foilgauge form` that predicts every bump; null: the design's "
              "springback, one radius on all bumps and constant arc length"},
    {FG_LIST_BY("responses", find_bump_response, &fg_scan_response_members), .lowest = 3,
     .highest = 3, .words = "radius, angle and height"},
};
const fg_members fg_scan_bumps_members = FG_MEMBERS(bumps_rows);
