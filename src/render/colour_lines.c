/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/colour_lines.h"

#include <math.h>
#include <stddef.h>

#include "render/spec.h"

enum { COURSE_POINTS = 201 };

static const char *const line_words[FG_COLOUR_LINES] = {"red", "green", "blue"};

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
  fg_member known[LINE_MEMBERS + 1] = {{0}};
  for (int i = 0; i < LINE_MEMBERS; i++)
    known[i] = (fg_member){line_members[i].name, FG_MEMBER_OTHER, 0, 0, 0};
  return fg_members_read(place, object, known, NULL);
}

static fg_status read_member(const fg_place *place, const cJSON *object,
                             const struct line_member *member, fg_colour_lines *lines) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, member->name);
  double values[FG_COLOUR_LINES];
  int count;
  if (!item) return FG_OK;
  FG_TRY(fg_member_numbers(place, member->name, item, member->low, member->high, FG_COLOUR_LINES,
                           FG_COLOUR_LINES, values, &count));
  for (int i = 0; i < FG_COLOUR_LINES; i++)
    *(double *)((char *)&lines->line[i] + member->offset) = values[i];
  return FG_OK;
}

/* A line may see no contrast at all: a foil of the very colour of what lies behind it. */
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
    FG_TRY(read_member(&inner, object, &line_members[i], lines));
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

/* The carriage's error along y when a line reads row y, in the middle of the picture, mm. */
static double carriage_mm(const fg_render_spec *spec, const fg_colour_line *line, double y_mm) {
  double at[2] = {0.5 * (double)spec->sensor.width_px * spec->sensor.pixel_mm[0],
                  y_mm + line->gap_px * spec->sensor.pixel_mm[1]};
  double d[2];
  fg_render_effects_field(&spec->effects, at[0], at[1], at, d);
  return d[1];
}

/* true = nominal + d: the picture moves up by d. */
static void put_course(fg_json *json, const fg_render_spec *spec, int i) {
  const fg_colour_line *line = &spec->scanner.colour.line[i],
                       *green = &spec->scanner.colour.line[1];
  double height_mm = (double)spec->sensor.height_px * spec->sensor.pixel_mm[1];
  double shift_mm = (line->shift_px[1] - green->shift_px[1]) * spec->sensor.pixel_mm[1];
  fg_json_array(json, "course");
  for (int k = 0; k < COURSE_POINTS; k++) {
    double y = height_mm * k / (COURSE_POINTS - 1);
    double um = 1e3 * (shift_mm - carriage_mm(spec, line, y) + carriage_mm(spec, green, y));
    fg_json_numbers(json, NULL, (const double[]){y, um}, 2);
  }
  fg_json_array_end(json);
}

static void put_line(fg_json *json, const fg_render_spec *spec, int i) {
  const fg_colour_line *line = &spec->scanner.colour.line[i],
                       *green = &spec->scanner.colour.line[1];
  double dx = line->shift_px[0] - green->shift_px[0], dy = line->shift_px[1] - green->shift_px[1];
  fg_json_object(json, line_words[i]);
  fg_json_number(json, "gap_px", line->gap_px - green->gap_px);
  fg_json_number(json, "dx_px", dx * spec->sensor.pixel_mm[0] / spec->pixel_mm[0]);
  fg_json_number(json, "dy_px", dy * spec->sensor.pixel_mm[1] / spec->pixel_mm[1]);
  fg_json_number(json, "dx_um", 1e3 * dx * spec->sensor.pixel_mm[0]);
  fg_json_number(json, "dy_um", 1e3 * dy * spec->sensor.pixel_mm[1]);
  fg_json_number(json, "magnification_ppm", line->magnification_ppm - green->magnification_ppm);
  put_course(json, spec, i);
  fg_json_object_end(json);
}

void fg_colour_lines_put_truth(fg_json *json, const fg_render_spec *spec) {
  if (!spec->scanner.colour.stated) return;
  fg_json_object(json, "colour_lines");
  fg_json_string(json, "against", line_words[1]);
  fg_json_number(json, "middle_x_mm",
                 0.5 * (double)(spec->sensor.width_px - 1) * spec->sensor.pixel_mm[0]);
  put_line(json, spec, 0);
  put_line(json, spec, 2);
  fg_json_object_end(json);
}
