/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/scanner_change/members.h"

#include <math.h>

#include "core/file.h"
#include "report/measure/scan_model_words.h"

static const fg_scanner_change *change_of(const fg_subject *subject) {
  return subject->whole;
}

/* Numbers. Tables show parts per million, as the station's check does. */
static const fg_member number_rows[] = {
    {FG_STRING("id", fg_scanner_number, id), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "number"}, .terminal = {.rank = 1, .heading = "number"}},
    {FG_STRING("words", fg_scanner_number, words), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "meaning", .words = true}},
    {FG_NUMBER_U("older", fg_scanner_number, older, u_older),
     .words = "by the older model; null: not known to both",
     .page = {.rank = 2, .heading = "older,\nppm", .decimals = 1, .scale = 1e6},
     .terminal = {.rank = 2, .heading = "older,\nppm", .decimals = 1, .scale = 1e6}},
    {FG_NUMBER_U("newer", fg_scanner_number, newer, u_newer),
     .page = {.rank = 2, .heading = "newer,\nppm", .decimals = 1, .scale = 1e6},
     .terminal = {.rank = 2, .heading = "newer,\nppm", .decimals = 1, .scale = 1e6}},
    {FG_NUMBER_U("difference", fg_scanner_number, difference, u), .words = "newer less older",
     .page = {.rank = 3, .heading = "difference,\nppm", .decimals = 1, .scale = 1e6},
     .terminal = {.rank = 3, .heading = "difference,\nppm", .decimals = 1, .scale = 1e6}},
};
const fg_members fg_scanner_number_members = FG_MEMBERS(number_rows);

bool fg_scanner_change_find_number(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_scanner_change *change = change_of(list);
  element->object = &change->number[i];
  return i < change->numbers;
}

/* Places. */
static double place_x(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->at_mm.x;
}

static double place_y(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->at_mm.y;
}

static double place_dx(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->d_um.x;
}

static double place_dy(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->d_um.y;
}

static double place_ux(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->u_um.x;
}

static double place_uy(const fg_subject *s) {
  return ((const fg_scanner_place *)s->object)->u_um.y;
}

static const fg_member place_rows[] = {
    {FG_NUMBER_BY("x_mm", place_x)},
    {FG_NUMBER_BY("y_mm", place_y)},
    {.name = "dx_um",
     .kind = FG_MEMBER_NUMBER,
     .number = place_dx,
     .u = place_ux,
     .words = "displacement by the newer model less that by the older, along x"},
    {.name = "dy_um", .kind = FG_MEMBER_NUMBER, .number = place_dy, .u = place_uy},
    {FG_FLAG("compared", fg_scanner_place, compared),
     .words = "false: between the places that the models have of one jump"},
};
static const fg_members place_members = FG_MEMBERS(place_rows);

static const double *list_common_region(const fg_subject *s, double *numbers, size_t *count) {
  const fg_scanner_change *change = change_of(s);
  for (int axis = 0; axis < 2; axis++) {
    numbers[axis] = change->low_mm[axis];
    numbers[2 + axis] = change->high_mm[axis];
  }
  *count = 4;
  return numbers;
}

static const char *const change_words[] = {[FG_SCANNER_SAME] = "same",
                                           [FG_SCANNER_SUSPECTED] = "suspected",
                                           [FG_SCANNER_CHANGED] = "changed",
                                           NULL};
static const char *const limit_words[] = {[FG_SCANNER_WITHIN] = "within",
                                          [FG_SCANNER_BEYOND] = "beyond",
                                          [FG_SCANNER_CANNOT_TELL] = "cannot_tell",
                                          [FG_SCANNER_NO_LIMIT] = "none",
                                          NULL};

static const fg_member change_rows[] = {
    {FG_HEAD("foilgauge/scanner-change/1")},
    {FG_WORD("verdict", fg_scanner_change, verdict, change_words),
     .words = "suspected: p_value from 0.01 to 0.1; changed: below"},
    {FG_NUMBER("p_value", fg_scanner_change, p_value),
     .words = "probability that two models of an unchanged scanner differ as much, over all places "
              "or in a number"},
    {FG_TEXT("summary", fg_scanner_change, sentence), .words = "one sentence"},
    {FG_NUMBER("limit_um", fg_scanner_change, limit_um),
     .words = "the largest allowed difference; null: none was given"},
    {FG_WORD("limit", fg_scanner_change, limit, limit_words),
     .words = "of the largest difference with its U"},
    {FG_OBJECT("older", fg_scanner_change, older, &fg_scan_model_members)},
    {FG_OBJECT("newer", fg_scanner_change, newer, &fg_scan_model_members)},
    {FG_NUMBERS_BY("region_mm", list_common_region), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "of the glass, that both models know: x, y of one corner and of the opposite"},
    {FG_FLAG("scale_known", fg_scanner_change, scale_known),
     .words = "to both models; else a scale equal in x and y is taken off all differences"},
    {FG_LIST_BY("numbers", fg_scanner_change_find_number, &fg_scanner_number_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_NUMBER_U("largest_um", fg_scanner_change, largest_um, u_largest_um),
     .words = "difference of a place, less shift and turn, which have no meaning"},
    {FG_OBJECT("largest", fg_scanner_change, largest, &place_members), .options = FG_MEMBER_ON_LINE,
     .words = "its place"},
    {FG_NUMBER("rms_um", fg_scanner_change, rms_um), .words = "along one axis, of all places"},
    {FG_NUMBER("would_show_um", fg_scanner_change, would_show_um),
     .words =
         "difference over the bed, rms along one axis, beside scale, ratio and shear, that would "
         "have been called a change"},
    {FG_ARRAY("places", fg_scanner_change, place, places, &place_members),
     .options = FG_MEMBER_ON_LINE},
};
static const fg_members change_members = FG_MEMBERS(change_rows);

const fg_document fg_scanner_change_document = {
    .file = "scanner_change",
    .title = "foilgauge scanner",
    .description = "Two models of one scanner compared. Units are in the names; u_<name> is the "
                   "standard uncertainty of <name>; null is a value that is not known.",
    .made_by = "`foilgauge scanner OLDER NEWER`",
    .members = &change_members,
};

fg_status fg_scanner_change_write_json(fg_context *ctx, const fg_scanner_change *change,
                                       FILE *out) {
  fg_document_json(out, &change_members, change);
  return fg_stream_finish(ctx, out, "the JSON report");
}
