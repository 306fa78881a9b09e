/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/grid_loop/members.h"

#include <math.h>

#include "core/file.h"
#include "report/design/members.h"
#include "report/measure/grid_members.h"

static const fg_grid_loop_result *result_of(const fg_subject *subject) {
  return subject->whole;
}

/* Scans. */
static const char *find_grid_scan_path(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_grid_scan *)s->object)->measurement->scan;
}

static const char *find_grid_scan_sha256(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_grid_scan *)s->object)->measurement->sha256;
}

static double count_grid_marks(const fg_subject *s) {
  return (double)((const fg_grid_scan *)s->object)->measurement->grid->count;
}

static fg_subject find_grid_of_scan(const fg_subject *s) {
  return (fg_subject){.object = ((const fg_grid_scan *)s->object)->measurement->grid};
}

static const fg_member input_rows[] = {
    {FG_TEXT_BY("path", find_grid_scan_path), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "scan"}},
    {FG_TEXT_BY("sha256", find_grid_scan_sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = FG_SHA256_PATTERN},
    {FG_INTEGER("turn_deg", fg_grid_scan, turn_deg),
     .words = "of the board against the first scan, from x towards y",
     .page = {.rank = 1, .heading = "turned, °"}},
    {FG_COUNT_BY("marks", count_grid_marks), .page = {.rank = 1, .heading = "marks"}},
};
const fg_members fg_grid_scan_members = FG_MEMBERS(input_rows);

/* Scans held out. */
static const char *find_held_out_path(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_grid_held_out *)s->object)->measurement->scan;
}

static const char *find_held_out_sha256(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_grid_held_out *)s->object)->measurement->sha256;
}

static double count_held_out_marks(const fg_subject *s) {
  return (double)((const fg_grid_held_out *)s->object)->measurement->grid->count;
}

bool fg_grid_loop_find_held_out(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_grid_loop_result *r = result_of(list);
  element->object = &r->held_out[i];
  return i < r->held_out_scans;
}

static const fg_member held_out_rows[] = {
    {FG_TEXT_BY("path", find_held_out_path), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "scan held out"}},
    {FG_TEXT_BY("sha256", find_held_out_sha256), .options = FG_MEMBER_NEVER_NULL,
     .pattern = FG_SHA256_PATTERN},
    {FG_INTEGER("turn_deg", fg_grid_held_out, turn_deg),
     .page = {.rank = 1, .heading = "turned, °"}},
    {FG_COUNT_BY("marks", count_held_out_marks), .page = {.rank = 1, .heading = "marks"}},
    {FG_NUMBER("before_um", fg_grid_held_out, before_um),
     .words = "rms of its marks in the region, with a pose of its own alone",
     .page = {.rank = 2, .heading = "before,\nµm", .decimals = 2}},
    {FG_NUMBER("after_um", fg_grid_held_out, after_um),
     .words = "the same with everything that was found on the other scans",
     .page = {.rank = 2, .heading = "after,\nµm", .decimals = 2}},
};
const fg_members fg_grid_held_out_members = FG_MEMBERS(held_out_rows);

/* Claims. */
static const char *const verdict_words[] = {
    [FG_GRID_FOUND] = "found", [FG_GRID_TIED] = "tied", [FG_GRID_ABSENT] = "absent", NULL};

static double claim_in_unit(const fg_subject *s) {
  const fg_grid_claim *claim = s->object;
  return claim->ratio ? 100 * claim->value : claim->value;
}

static double claim_u_in_unit(const fg_subject *s) {
  const fg_grid_claim *claim = s->object;
  return claim->ratio ? 100 * claim->u : claim->u;
}

static bool is_ratio_claim(const fg_subject *s) {
  return ((const fg_grid_claim *)s->object)->ratio;
}

static bool is_length_claim(const fg_subject *s) {
  return !is_ratio_claim(s);
}

static const char *find_unit(const fg_subject *s, char *buffer) {
  (void)buffer;
  return is_ratio_claim(s) ? "%" : "µm";
}

static const fg_member claim_rows[] = {
    {FG_STRING("id", fg_grid_claim, id), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 1, .heading = "effect"}, .terminal = {.rank = 1, .heading = "effect"}},
    {FG_STRING("words", fg_grid_claim, words), .options = FG_MEMBER_NEVER_NULL,
     .page = {.rank = 2, .heading = "meaning", .words = true}},
    {FG_WORD("verdict", fg_grid_claim, verdict, verdict_words),
     .words = "tied: scanner or board, which these scans cannot tell; the value is that of both "
              "together",
     .page = {.rank = 2, .heading = "verdict"}, .terminal = {.rank = 2, .heading = "verdict"}},
    {FG_NUMBER_U("ratio", fg_grid_claim, value, u), .present = is_ratio_claim,
     .words = "a share of a length"},
    {FG_NUMBER_U("amplitude_um", fg_grid_claim, value, u), .present = is_length_claim,
     .words = "of polynomials 18 mm from the middle"},
    {.name = "value",
     .kind = FG_MEMBER_NUMBER,
     .number = claim_in_unit,
     .u = claim_u_in_unit,
     .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .heading = "value", .decimals = 3, .by_u = true},
     .terminal = {.rank = 3, .heading = "value", .decimals = 3, .by_u = true}},
    {FG_TEXT_BY("unit", find_unit), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .heading = "unit"}, .terminal = {.rank = 3, .heading = "unit"}},
    {FG_NUMBER("shape_mm", fg_grid_claim, shape), .words = "period or place; null: none",
     .page = {.rank = 4, .heading = "period or place,\nmm", .decimals = 2},
     .terminal = {.rank = 4, .heading = "mm", .decimals = 2}},
    {FG_NUMBER("z", fg_grid_claim, z),
     .words = "value over its standard uncertainty, beside all other effects and the map"},
};
const fg_members fg_grid_claim_members = FG_MEMBERS(claim_rows);

/* The map. */
static double map_x(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->at_mm.x;
}

static double map_y(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->at_mm.y;
}

static double map_dx(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->d_um.x;
}

static double map_dy(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->d_um.y;
}

static double map_ux(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->u_um.x;
}

static double map_uy(const fg_subject *s) {
  return ((const fg_grid_map_point *)s->object)->u_um.y;
}

static bool find_map_point(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_grid_loop_result *r = result_of(list);
  element->object = &r->map[i];
  return i < r->map_columns * r->map_rows;
}

static const fg_member map_rows[] = {
    {FG_NUMBER_BY("x_mm", map_x)},
    {FG_NUMBER_BY("y_mm", map_y)},
    {.name = "dx_um",
     .kind = FG_MEMBER_NUMBER,
     .number = map_dx,
     .u = map_ux,
     .words = "true less measured place, along x"},
    {.name = "dy_um", .kind = FG_MEMBER_NUMBER, .number = map_dy, .u = map_uy},
};
static const fg_members map_members = FG_MEMBERS(map_rows);

/* Errors: rms of the marks, each component. Names are those of the loop on edges. */
static double find_rms_ratio_of_marks(const fg_subject *s) {
  return result_of(s)->after_um / result_of(s)->before_um;
}

static double find_held_out_ratio_of_marks(const fg_subject *s) {
  return result_of(s)->held_out_after_um / result_of(s)->held_out_before_um;
}

static const fg_member before_rows[] = {
    {FG_NUMBER("rms", fg_grid_loop_result, before_um),
     .words = "of the marks against their boards' lattices"},
    {FG_NUMBER("held_out_rms", fg_grid_loop_result, held_out_before_um),
     .words =
         "the same on marks that the fit did not see: of the scans of `held_out`, or every fifth "
         "mark in turn; null: too few"},
};
static const fg_members before_members = FG_MEMBERS(before_rows);

static const fg_member after_rows[] = {
    {FG_NUMBER("rms", fg_grid_loop_result, after_um), .words = "with everything found"},
    {FG_NUMBER("held_out_rms", fg_grid_loop_result, held_out_after_um)},
};
static const fg_members after_members = FG_MEMBERS(after_rows);

static const fg_member ratio_rows[] = {
    {FG_NUMBER_BY("rms", find_rms_ratio_of_marks)},
    {FG_NUMBER_BY("held_out", find_held_out_ratio_of_marks)},
};
static const fg_members ratio_members = FG_MEMBERS(ratio_rows);

/* Verdict. Indices of the words. */
enum { CLEAN, EXPLAINED, PARTLY, UNATTRIBUTED };
static const char *const outcome_words[] = {
    [CLEAN] = "clean",
    [EXPLAINED] = "explained",
    [PARTLY] = "partly explained",
    [UNATTRIBUTED] = "unattributed",
    NULL,
};
static const char *const domain_words[] = {"scan", NULL};

static int find_grid_domain(const fg_subject *s) {
  (void)s;
  return 0;
}

/* A map holds the part that no effect of the list explains. */
static int find_grid_outcome(const fg_subject *s) {
  const fg_grid_loop_result *r = result_of(s);
  bool map = r->map_um > 0 || r->board_map_um > 0, named = false;
  for (size_t i = 0; i < r->claims; i++)
    named = named || r->claim[i].verdict != FG_GRID_ABSENT;
  if (named) return map ? PARTLY : EXPLAINED;
  return map ? UNATTRIBUTED : CLEAN;
}

static const fg_member noise_rows[] = {
    {FG_NUMBER("mark", fg_grid_loop_result, mark_um), .words = "of a mark in one scan, sd"},
    {FG_NUMBER("board_mark", fg_grid_loop_result, board_mark_um),
     .words = "of the board's own marks, sd; null: no mark was seen twice"},
    {FG_NUMBER("carriage", fg_grid_loop_result, carriage_um),
     .words = "of the carriage from scan to scan, sd, which no model removes: it is in the map's "
              "u; null: no scans of one pose"},
    {FG_NUMBER("map", fg_grid_loop_result, map_um),
     .words = "rms of the smooth map beside the effects; 0: none is needed"},
    {FG_NUMBER("u_map", fg_grid_loop_result, u_map_um),
     .words = "rms standard uncertainty of the displacement, effects included"},
    {FG_NUMBER("board_map", fg_grid_loop_result, board_map_um),
     .words = "rms of the first board's own smooth deviation; 0: none"},
};
static const fg_members noise_members = FG_MEMBERS(noise_rows);

static const double *list_grid_region(const fg_subject *s, double *numbers, size_t *count) {
  const fg_grid_loop_result *r = result_of(s);
  for (int axis = 0; axis < 2; axis++) {
    numbers[axis] = r->low_mm[axis];
    numbers[2 + axis] = r->high_mm[axis];
  }
  *count = 4;
  return numbers;
}

static fg_subject find_grid_design(const fg_subject *s) {
  return (fg_subject){.object = &result_of(s)->scan[0].measurement->design};
}

bool fg_grid_loop_find_scan(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_grid_loop_result *r = result_of(list);
  element->object = &r->scan[i];
  return i < r->scans;
}

static bool find_scan_grid(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_grid_loop_result *r = result_of(list);
  fg_subject scan = {.object = &r->scan[i]};
  if (i >= r->scans) return false;
  *element = find_grid_of_scan(&scan);
  return true;
}

bool fg_grid_loop_find_claim(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_grid_loop_result *r = result_of(list);
  element->object = &r->claim[i];
  return i < r->claims;
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/grid-loop/1")},
    {FG_WORD_BY("domain", find_grid_domain, domain_words), .options = FG_MEMBER_NEVER_NULL},
    {FG_WORD_BY("verdict", find_grid_outcome, outcome_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "unattributed, and partly explained: a smooth map holds what no effect of the list "
              "explains; a claim tells whether it is found or tied"},
    {FG_TEXT("summary", fg_grid_loop_result, sentence), .words = "one sentence"},
    {FG_TEXT("advice", fg_grid_loop_result, advice), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "the measurement that would tell more; null: none is needed"},
    {FG_LIST_BY("inputs", fg_grid_loop_find_scan, &fg_grid_scan_members), .lowest = 1},
    {FG_LIST_BY("held_out", fg_grid_loop_find_held_out, &fg_grid_held_out_members),
     .words = "scans that only confirm (--hold-out); without any, marks are held out in turn"},
    {FG_PART("design", find_grid_design, &fg_design_members),
     .schema = FG_REF("design.schema.json"), .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT("boards", fg_grid_loop_result, boards)},
    {FG_FLAG("turned", fg_grid_loop_result, turned),
     .words = "scans of one board, turned by a quarter: scanner and board are told apart"},
    {FG_FLAG("scale_known", fg_grid_loop_result, scale_known),
     .words = "by a stated pitch with its uncertainty"},
    {FG_FLAG("axes_known", fg_grid_loop_result, axes_known),
     .words = "the scanner's ratio of axes and shear are told from the board's"},
    {FG_FLAG("tied", fg_grid_loop_result, tied)},
    {FG_NUMBER_U("axis_ratio", fg_grid_loop_result, axis_ratio, u_axis_ratio),
     .words = "of the scanner: a length along x, as measured, over the same along y"},
    {FG_NUMBER_U("board_axis_ratio", fg_grid_loop_result, board_ratio, u_board_ratio),
     .words = "of the first board, as it lies in the first scan"},
    {FG_LIST_BY("claims", fg_grid_loop_find_claim, &fg_grid_claim_members),
     .options = FG_MEMBER_ON_LINE},
    {FG_GROUP("before", &before_members), .words = "errors along one axis, um"},
    {FG_GROUP("after", &after_members)},
    {FG_GROUP("error_ratio", &ratio_members), .words = "after / before"},
    {FG_GROUP("noise_um", &noise_members)},
    {FG_NUMBERS_BY("region_mm", list_grid_region), .lowest = 4, .highest = 4,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "of all marks: x, y of one corner, and the opposite"},
    {FG_LIST_BY("map", find_map_point, &map_members), .options = FG_MEMBER_ON_LINE,
     .words = "displacement of the scanner over the region, effects and map together; its shift "
              "and turn have no meaning"},
    {FG_LIST_BY("grids", find_scan_grid, &fg_grid_members), .words = "of the scans, as measured"},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_grid_loop_document = {
    .file = "grid_loop",
    .title = "foilgauge loop on grids",
    .description = "What a scanner does to its bed, from scans of plates and boards. Units are in "
                   "the names; u_<name> is the standard uncertainty of <name>; null is a value "
                   "that is not known.",
    .made_by = "`foilgauge loop SCAN` with a design of form grid",
    .members = &report_members,
};

fg_status fg_grid_loop_write_json(fg_context *ctx, const fg_grid_loop *loop, FILE *out) {
  const fg_grid_loop_result *result = fg_grid_loop_result_of(loop);
  fg_document_json(out, &report_members, result);
  return fg_stream_finish(ctx, out, "the JSON report");
}
