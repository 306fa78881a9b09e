/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "report/measure/members.h"
#include "report/scan_loop/members.h"
#include "report/scan_loop/parts.h"

/* A side, before or after the correction: its errors, whose index is 1 after. */
fg_subject fg_scan_find_before(const fg_subject *s) {
  return (fg_subject){&fg_scan_result_of(s)->before, s->whole, 0};
}

fg_subject fg_scan_find_after(const fg_subject *s) {
  return (fg_subject){&fg_scan_result_of(s)->after, s->whole, 1};
}

static bool is_of_width(const fg_subject *s) {
  return fg_scan_result_of(s)->of_width;
}

static bool is_held_out_apart(const fg_subject *s) {
  return fg_scan_result_of(s)->held_out != FG_SCAN_HELD_OUT_NOTHING;
}

static bool is_of_discs(const fg_subject *s) {
  return fg_scan_result_of(s)->discs;
}

static double find_side_width(const fg_subject *s) {
  const fg_scan_result *result = fg_scan_result_of(s);
  return s->index ? result->width_after_um : result->width_before_um;
}

static const fg_member side_width_rows[] = {{FG_NUMBER_BY("rms", find_side_width)}};
static const fg_members side_width_members = FG_MEMBERS(side_width_rows);

/* Parts of all scans of a side: their index is twice the scan's, and 1 more after. */
#define PARTS_OF_SIDE(function, count_, parts_)                                                    \
  static bool function(const fg_subject *side, size_t i, fg_subject *element) {                    \
    const fg_scan_result *result = fg_scan_result_of(side);                                        \
    for (size_t k = 0; k < result->scans; k++) {                                                   \
      const fg_scan_result_scan *scan = &result->scan[k];                                          \
      const fg_measurement *m = side->index ? scan->after : scan->before;                          \
      if (i < m->count_) {                                                                         \
        element->object = &m->parts_[i];                                                           \
        element->index = 2 * k + side->index;                                                      \
        return true;                                                                               \
      }                                                                                            \
      i -= m->count_;                                                                              \
    }                                                                                              \
    return false;                                                                                  \
  }
PARTS_OF_SIDE(find_side_foil, foil_count, foils)
PARTS_OF_SIDE(find_side_disc, disc_count, discs)

/* Writes a part as the measurement does; keeps the first failure. */
#define WRITE_PART(function, writer)                                                               \
  static void function(fg_json *json, const char *name, const fg_subject *s) {                     \
    (void)name;                                                                                    \
    const fg_scan_report *report = s->whole;                                                       \
    const fg_scan_result_scan *scan = &report->result->scan[s->index / 2];                         \
    const fg_measurement *m = s->index % 2 ? scan->after : scan->before;                           \
    fg_status status = writer(report->ctx, json, &m->design, s->object);                           \
    if (*report->status == FG_OK) *report->status = status;                                        \
  }
WRITE_PART(write_side_foil, fg_json_foil)
WRITE_PART(write_side_disc, fg_json_disc)

static const fg_member foil_rows[] = {
    {FG_WRITTEN(NULL, write_side_foil,
                "{\"type\": \"object\", \"required\": [\"overall\", \"bumps\", \"flags\"]}")}};
static const fg_members foil_members = FG_MEMBERS(foil_rows);
static const fg_member disc_rows[] = {
    {FG_WRITTEN(NULL, write_side_disc,
                "{\"type\": \"object\", \"required\": [\"number\", \"radius_mm\", \"u_radius_mm\", "
                "\"flags\"]}")}};
static const fg_members disc_members = FG_MEMBERS(disc_rows);

static const fg_member side_rows[] = {
    {FG_NUMBER("rms", fg_scan_loop_error, rms), .words = "of the edge rows", .heading = "rms",
     .page = {.rank = 1}},
    {FG_NUMBER("held_out_rms", fg_scan_loop_error, held_out_rms),
     .words =
         "of scans kept aside; without, cross-fitted: bumps (discs; where a curve over a place was "
         "found, short stretches of the edge) go round folds, the effects are fitted without each "
         "(of a plate the search is repeated), and are taken out of that fold, with the geometry "
         "fitted to all rows. "
         "Before nothing but the geometry is fitted. Where nothing was found it is rms; null where "
         "bumps are too few",
     .column = is_held_out_apart, .page = {.rank = 2}},
    {FG_NUMBER("robust_sd", fg_scan_loop_error, robust_sd), .heading = "robust sd",
     .page = {.rank = 1}},
    {FG_NUMBER("p95", fg_scan_loop_error, p95), .words = "of the size of the residuals",
     .heading = "95th percentile", .page = {.rank = 1}},
    {FG_NUMBER("maximum", fg_scan_loop_error, maximum), .heading = "maximum", .page = {.rank = 1}},
    {FG_NUMBER_BY("half_width", find_side_width), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "half the width, rms", .column = is_of_width, .page = {.rank = 3}},
    {FG_GROUP("half_width", &side_width_members), .present = is_of_width,
     .words = "only where an effect of the strip's width is claimed: half the width about its mean "
              "over every view, without and with the scanner's stretch and what is claimed"},
    {FG_LIST_BY("foils", find_side_foil, &foil_members),
     .words = "every foil of every scan as `measure` reports it"},
    {FG_LIST_BY("discs", find_side_disc, &disc_members), .present = is_of_discs,
     .words = "form discs only: every hole and disc of every scan; `foils` is empty then"},
};
const fg_members fg_scan_side_members = FG_MEMBERS_DEFINED(side_rows, "side");

/* Errors of page and terminal, before beside after: a line for each member of a side that the page
 * shows. */
static const fg_member *find_error_row(const fg_subject *error) {
  fg_member_columns lines;
  fg_member_columns_of(&fg_scan_side_members, FG_ON_PAGE, error, &lines);
  return error->index < lines.count ? lines.rows[error->index] : NULL;
}

static double find_error_before(const fg_subject *error) {
  const fg_subject side = fg_scan_find_before(error);
  return fg_member_value(find_error_row(error), &side);
}

static double find_error_after(const fg_subject *error) {
  const fg_subject side = fg_scan_find_after(error);
  return fg_member_value(find_error_row(error), &side);
}

static double find_error_ratio(const fg_subject *error) {
  return find_error_after(error) / find_error_before(error);
}

bool fg_scan_find_error(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_subject error = {list->whole, list->whole, i};
  if (!find_error_row(&error)) return false;
  *element = error;
  if (!isfinite(find_error_before(&error))) element->object = NULL;
  return true;
}

static const char *find_error_name(const fg_subject *error, char *buffer) {
  const fg_member *row = find_error_row(error);
  if (row->heading) return row->heading;
  fg_scan_loop_held_out_words(fg_scan_result_of(error), buffer);
  return buffer;
}

static const char *find_words_before(const fg_subject *error, char *buffer) {
  fg_scan_loop_length_words(find_error_before(error), buffer, 32);
  return buffer;
}

static const char *find_words_after(const fg_subject *error, char *buffer) {
  fg_scan_loop_length_words(find_error_after(error), buffer, 32);
  return buffer;
}

static const fg_member error_rows[] = {
    {FG_TEXT_BY("error", find_error_name), .page = {.rank = 1, .heading = "error"},
     .terminal = {.rank = 1, .heading = "errors of the edge rows, um", .words = true}},
    {FG_TEXT_BY("before", find_words_before), .page = {.rank = 1, .heading = "before"}},
    {FG_TEXT_BY("after", find_words_after), .page = {.rank = 1, .heading = "after"}},
    {FG_NUMBER_BY("before", find_error_before),
     .terminal = {.rank = 1, .heading = "before", .digits = 4}},
    {FG_NUMBER_BY("after", find_error_after),
     .terminal = {.rank = 1, .heading = "after", .digits = 4}},
    {FG_NUMBER_BY("ratio", find_error_ratio), .page = {.rank = 1, .heading = "ratio", .digits = 3}},
};
const fg_members fg_scan_error_members = FG_MEMBERS(error_rows);
