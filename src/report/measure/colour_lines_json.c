/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "foilgauge/words.h"
#include "report/measure/colour_lines_report.h"

/* A distance along one axis, in pixels and in um. */
static void write_distance(fg_json *json, char axis, double px, double u_px, double pixel_um) {
  const char names[4][8] = {{'d', axis, '_', 'p', 'x'},
                            {'u', '_', 'd', axis, '_', 'p', 'x'},
                            {'d', axis, '_', 'u', 'm'},
                            {'u', '_', 'd', axis, '_', 'u', 'm'}};
  const double values[4] = {px, u_px, px * pixel_um, u_px * pixel_um};
  for (int i = 0; i < 4; i++)
    fg_json_number(json, names[i], values[i]);
}

static void write_window(fg_json *json, const fg_colour_window *window) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_number(json, "y_mm", (double)window->y_mm);
  fg_json_number(json, "dy_um", (double)window->dy_um);
  fg_json_number(json, "u_dy_um", (double)window->u_dy_um);
  fg_json_number(json, "smooth_um", (double)window->smooth_um);
  fg_json_number(json, "u_smooth_um", (double)window->u_smooth_um);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_shift(fg_json *json, const fg_measurement *m, const fg_colour_shift *shift) {
  fg_json_object(json, fg_channel_word(shift->channel));
  fg_json_string(json, "state", fg_colour_state_word(shift->state));
  write_distance(json, 'x', shift->dx_px, shift->u_dx_px, 25400 / m->dpi[0]);
  write_distance(json, 'y', shift->dy_px, shift->u_dy_px, 25400 / m->dpi[1]);
  fg_json_number(json, "magnification_ppm", shift->magnification_ppm);
  fg_json_number(json, "u_magnification_ppm", shift->u_magnification_ppm);
  fg_json_number(json, "skew_ppm", shift->skew_ppm);
  fg_json_number(json, "u_skew_ppm", shift->u_skew_ppm);
  fg_json_number(json, "largest_px", shift->largest_px);
  fg_json_integer(json, "stations", (int64_t)shift->stations);
  fg_json_number(json, "rms_um", shift->rms_um);
  fg_json_number(json, "correlation", shift->correlation);
  fg_json_number(json, "course_rms_um", shift->drift_rms_um);
  fg_json_number(json, "p_constant", shift->p_constant);
  fg_json_array(json, "course");
  for (size_t i = 0; i < shift->window_count; i++)
    write_window(json, &shift->windows[i]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

void fg_json_colour_lines(fg_json *json, const fg_measurement *measurement) {
  const fg_colour_lines *lines = &measurement->colour_lines;
  if (!lines->seen) return;
  fg_json_object(json, "colour_lines");
  fg_json_string(json, "against", fg_channel_word(lines->against));
  fg_json_bool(json, "apart", lines->apart);
  fg_json_number(json, "x0_mm", lines->x0_mm);
  for (int k = 0; k < 2; k++)
    write_shift(json, measurement, &lines->shifts[k]);
  fg_json_object_end(json);
}
