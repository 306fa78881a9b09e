/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/colour_lines.h"

#include <math.h>
#include <stddef.h>

const char *const fg_colour_line_words[FG_COLOUR_LINES] = {"red", "green", "blue"};

/* Members with a number for each line. */
static const struct line_member {
  const char *name;
  size_t offset;
  double low, high;
} line_members[] = {
    {"gap_px", offsetof(fg_colour_line, gap_px), -200, 200},
    {"dx_px", offsetof(fg_colour_line, shift_px), -20, 20},
    {"dy_px", offsetof(fg_colour_line, shift_px) + sizeof(double), -20, 20},
    {"magnification_ppm", offsetof(fg_colour_line, magnification_ppm), -10000, 10000},
    {"background", offsetof(fg_colour_line, background), 0, 255},
    {"contrast", offsetof(fg_colour_line, contrast), -255, 255},
};
enum { LINE_MEMBERS = sizeof line_members / sizeof *line_members };

static fg_status check_names(const fg_place *place, const cJSON *object) {
  fg_spec_row known[LINE_MEMBERS + 1] = {{0}};
  for (int i = 0; i < LINE_MEMBERS; i++)
    known[i] = (fg_spec_row){line_members[i].name, FG_SPEC_OTHER, 0, 0, 0};
  return fg_members_read(place, object, known, NULL);
}

static fg_status read_line_member(const fg_place *place, const cJSON *object,
                                  const struct line_member *member, fg_colour_lines *lines) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, member->name);
  double values[FG_COLOUR_LINES];
  int count;
  if (!item) return FG_OK;
  FG_TRY(fg_member_numbers(
      place, member->name, item,
      (fg_array_limits){member->low, member->high, FG_COLOUR_LINES, FG_COLOUR_LINES}, values,
      &count));
  for (int i = 0; i < FG_COLOUR_LINES; i++)
    *(double *)((char *)&lines->line[i] + member->offset) = values[i];
  return FG_OK;
}

/* A line may have no contrast at all: a foil of the very colour of its background. */
static fg_status check_tones(const fg_place *place, const cJSON *object,
                             const fg_colour_lines *lines) {
  for (int i = 0; i < FG_COLOUR_LINES; i++) {
    double strip = lines->line[i].background + lines->line[i].contrast;
    if (!(strip >= 0 && strip <= 255))
      return fg_member_fail(place, "contrast", cJSON_GetObjectItemCaseSensitive(object, "contrast"),
                            "background + contrast must lie within 0 and 255 for every line");
  }
  return FG_OK;
}

fg_status fg_colour_lines_read(const fg_place *place, const cJSON *scanner, double background,
                               double contrast, fg_colour_lines *lines) {
  const cJSON *object = cJSON_GetObjectItemCaseSensitive(scanner, "colour_lines");
  *lines = (fg_colour_lines){0};
  for (int i = 0; i < FG_COLOUR_LINES; i++)
    lines->line[i] = (fg_colour_line){.background = background, .contrast = contrast};
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, "colour_lines");
  FG_TRY(check_names(&inner, object));
  for (int i = 0; i < LINE_MEMBERS; i++)
    FG_TRY(read_line_member(&inner, object, &line_members[i], lines));
  lines->stated = true;
  return check_tones(&inner, object, lines);
}

double fg_colour_lines_reach_px(const fg_colour_lines *lines, double width_px) {
  double reach = 0;
  for (int i = 0; i < FG_COLOUR_LINES && lines->stated; i++) {
    const fg_colour_line *line = &lines->line[i];
    reach =
        fmax(reach, fabs(line->shift_px[0]) + 0.5e-6 * fabs(line->magnification_ppm) * width_px);
    reach = fmax(reach, fabs(line->shift_px[1]));
  }
  return reach;
}
