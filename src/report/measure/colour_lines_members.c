/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members "colour_lines" of a scan. The whole of their subjects is the measurement. */
#include "foilgauge/words.h"
#include "report/measure/colour_lines_report.h"

#define WINDOW_VALUE(function, field)                                                              \
  static double function(const fg_subject *subject) {                                              \
    return (double)((const fg_colour_window *)subject->object)->field;                             \
  }
WINDOW_VALUE(find_y_mm, y_mm)
WINDOW_VALUE(find_dy_um, dy_um)
WINDOW_VALUE(find_u_dy_um, u_dy_um)
WINDOW_VALUE(find_smooth_um, smooth_um)
WINDOW_VALUE(find_u_smooth_um, u_smooth_um)

static const fg_member window_rows[] = {
    {FG_NUMBER_BY("y_mm", find_y_mm), .options = FG_MEMBER_NEVER_NULL, .words = "middle of it"},
    {FG_NUMBER_BY("dy_um", find_dy_um), .u = find_u_dy_um, .options = FG_MEMBER_NEVER_NULL,
     .words = "over the window"},
    {FG_NUMBER_BY("smooth_um", find_smooth_um), .u = find_u_smooth_um,
     .options = FG_MEMBER_NEVER_NULL, .words = "the smooth curve there"},
};
static const fg_members window_members = FG_MEMBERS(window_rows);

/* Micrometres of a distance in pixels along x (0) or y (1). */
#define DISTANCE_UM(function, field, axis)                                                         \
  static double function(const fg_subject *subject) {                                              \
    const fg_measurement *m = subject->whole;                                                      \
    return ((const fg_colour_shift *)subject->object)->field * (25400 / m->dpi[axis]);             \
  }
DISTANCE_UM(find_dx_um, dx_px, 0)
DISTANCE_UM(find_u_dx_um, u_dx_px, 0)
DISTANCE_UM(find_dy_mean_um, dy_px, 1)
DISTANCE_UM(find_u_dy_mean_um, u_dy_px, 1)

static const char *find_state(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_colour_state_word(((const fg_colour_shift *)subject->object)->state);
}

static const char *state_choice(size_t i) {
  return i <= FG_COLOUR_FEW_EDGES ? fg_colour_state_word((fg_colour_state)i) : NULL;
}

static const char *find_shifted_channel(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_channel_word(((const fg_colour_shift *)subject->object)->channel);
}

static const fg_member shift_rows[] = {
    {FG_TEXT_BY("channel", find_shifted_channel), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "channel", .words = true}},
    {FG_TEXT_BY("state", find_state), .choice_at = state_choice, .options = FG_MEMBER_NEVER_NULL,
     .words = "identical: the same picture, a gray one saved as RGB, all 0 without u; no_contrast: "
              "it shows no edges"},
    {FG_NUMBER_U("dx_px", fg_colour_shift, dx_px, u_dx_px), .words = "along x",
     .page = {.rank = 2, .heading = "dx, px", .decimals = 3, .plus = true}},
    {FG_NUMBER_BY("dx_um", find_dx_um), .u = find_u_dx_um, .words = "along x",
     .page = {.rank = 3, .heading = "dx, µm", .decimals = 2, .plus = true}},
    {FG_NUMBER_U("dy_px", fg_colour_shift, dy_px, u_dy_px), .words = "along y, mean over y",
     .page = {.rank = 2, .heading = "dy, px", .decimals = 3, .plus = true}},
    {FG_NUMBER_BY("dy_um", find_dy_mean_um), .u = find_u_dy_mean_um,
     .words = "along y, mean over y",
     .page = {.rank = 3, .heading = "dy, µm", .decimals = 2, .plus = true}},
    {FG_NUMBER_U("magnification_ppm", fg_colour_shift, magnification_ppm, u_magnification_ppm),
     .words = "lateral colour: larger along x",
     .page = {.rank = 4, .heading = "magnified, ppm", .decimals = 1, .plus = true}},
    {FG_NUMBER_U("skew_ppm", fg_colour_shift, skew_ppm, u_skew_ppm),
     .words = "dy over x: one line is turned against the other",
     .page = {.rank = 4, .heading = "skew, ppm", .decimals = 1, .plus = true}},
    {FG_NUMBER("largest_px", fg_colour_shift, largest_px),
     .words = "distance where it is largest within the parts"},
    {FG_COUNT("stations", fg_colour_shift, stations), .words = "cross-sections used"},
    {FG_NUMBER("rms_um", fg_colour_shift, rms_um), .words = "of their differences that are left"},
    {FG_NUMBER("correlation", fg_colour_shift, correlation),
     .words = "integral of its correlation along the edges, in cross-sections"},
    {FG_NUMBER("course_rms_um", fg_colour_shift, drift_rms_um),
     .words = "of the smooth dy(y) about its mean",
     .page = {.rank = 5, .heading = "uneven, µm rms", .digits = 2}},
    {FG_NUMBER("p_constant", fg_colour_shift, p_constant),
     .words = "probability that a constant dy shows as much unevenness along y",
     .page = {.rank = 5, .heading = "p", .digits = 2}},
    {FG_ARRAY("course", fg_colour_shift, windows, window_count, &window_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "dy over windows along y, and a smooth curve through them"},
};
const fg_members fg_colour_shift_members =
    FG_MEMBERS_OF_FILE(shift_rows, "colour_shift", "measure");

static bool find_shift(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_colour_lines *lines = list->object;
  element->object = &lines->shifts[i];
  return i < 2;
}

static const char *name_shift(const fg_subject *element) {
  return find_shifted_channel(element, NULL);
}

static bool is_one_of_two(const fg_subject *subject) {
  (void)subject;
  return true;
}

static const char *find_against(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return fg_channel_word(((const fg_colour_lines *)subject->object)->against);
}

static const char *const colours[] = {"red", "green", "blue", NULL};

static const fg_member lines_rows[] = {
    {FG_TEXT_BY("against", find_against), .choices = colours, .options = FG_MEMBER_NEVER_NULL,
     .words = "the channel that the two others stand against"},
    {FG_FLAG("apart", fg_colour_lines, apart),
     .words = "two channels lie more than 0.1 px apart: measure one, do not average them"},
    {FG_NUMBER("x0_mm", fg_colour_lines, x0_mm), .options = FG_MEMBER_NEVER_NULL,
     .words = "where along x dx and dy hold"},
    {FG_MAP_BY(NULL, find_shift, name_shift, &fg_colour_shift_members), .choices = colours,
     .present = is_one_of_two,
     .words = "where one channel shows edges, minus where the other does: dx + magnification "
              "(x - x0) along x, dy(y) + skew (x - x0) along y"},
};
const fg_members fg_colour_lines_members = {
    .rows = lines_rows,
    .count = sizeof lines_rows / sizeof *lines_rows,
    .definition = "colour_lines",
    .file = "measure",
    .limits = "{\"minProperties\": 5, \"maxProperties\": 5}",
};
