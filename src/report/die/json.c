/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "foilgauge/die_report.h"
#include "report/design/json.h"
#include "report/measure/json.h"

/* name, sd_name (as its own unit), u_name. */
static void write_die_value(fg_json *json, const char *name, const fg_die_value *value) {
  fg_json_number(json, name, value->value);
  fg_json_of(json, "sd_", name, value->sd);
  fg_json_of(json, "u_", name, value->u);
}

static void write_values(fg_json *json, const fg_die_value values[FG_DIE_QUANTITIES]) {
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    write_die_value(json, fg_die_row_of((fg_die_quantity)q)->name, &values[q]);
}

static void write_side(fg_json *json, const fg_die *die, const fg_die_side *side,
                       const char *counted) {
  fg_json_object(json, "overall");
  write_die_value(json, "radius_mm", &side->overall_radius_mm);
  write_die_value(json, "radius_error_pct", &side->overall_error_pct);
  fg_json_object_end(json);
  fg_json_object(json, "mean");
  write_values(json, side->mean);
  fg_json_object_end(json);
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < side->bump_count; i++) {
    fg_json_object(json, NULL);
    fg_json_integer(json, "number", side->bumps[i].number);
    fg_json_integer(json, counted, (int64_t)side->bumps[i].count);
    fg_json_string(json, "verdict", fg_verdict_word(fg_die_judge_bump(die, &side->bumps[i])));
    write_values(json, side->bumps[i].value);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_half(fg_json *json, const fg_die *die, fg_die_half half) {
  char unseen[200], lost[200];
  fg_json_object(json, NULL);
  fg_json_string(json, "half", fg_die_half_word(half));
  fg_json_integer(json, "traces", (int64_t)die->half[half].traces);
  fg_die_unseen(die, half, FG_DIE_UNSEEN, unseen, sizeof unseen);
  fg_die_unseen(die, half, FG_DIE_LOST, lost, sizeof lost);
  fg_json_string(json, "bumps_not_seen", unseen);
  fg_json_string(json, "bumps_lost", lost);
  write_side(json, die, &die->half[half], "repeats");
  fg_json_object_end(json);
}

static void write_trace_bump(fg_json *json, const fg_bump *bump) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_integer(json, "number", bump->number);
  fg_json_number(json, "radius_mm", bump->radius_mm);
  fg_json_number(json, "u_radius_mm", bump->u_radius_mm);
  fg_json_numbers(json, "centre_mm", &bump->centre_mm.x, 2);
  fg_json_number(json, "bump_angle_deg", bump->bump_angle_deg);
  fg_json_number(json, "u_bump_angle_deg", bump->u_bump_angle_deg);
  fg_json_number(json, "height_mm", bump->height_mm);
  fg_json_number(json, "u_height_mm", bump->u_height_mm);
  fg_json_number(json, "rms_um", bump->rms_um);
  fg_json_integer(json, "points", (int64_t)bump->points);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_trace(fg_json *json, const fg_die_trace *trace) {
  fg_json_object(json, NULL);
  fg_json_string(json, "path", trace->path);
  fg_json_string(json, "sha256", trace->sha256);
  fg_json_string(json, "half", fg_die_half_word(trace->half));
  fg_json_integer(json, "repeat", trace->repeat);
  fg_json_string(json, "x_unit", fg_die_unit_word(trace->unit[0]));
  fg_json_string(json, "z_unit", fg_die_unit_word(trace->unit[1]));
  fg_json_number(json, "tip_um", trace->tip_um);
  fg_json_number(json, "shift_mm", trace->shift_mm);
  fg_json_integer(json, "points", (int64_t)trace->points);
  fg_json_number(json, "length_mm", trace->length_mm);
  fg_json_number(json, "step_um", trace->step_um);
  fg_json_number(json, "steep_share", trace->steep_share);
  fg_json_integer(json, "lands", (int64_t)trace->lands);
  fg_json_integer(json, "bumps_cut_off", (int64_t)trace->cut_bumps);
  fg_json_array(json, "bumps_lost");
  for (size_t i = 0; i < trace->lost_count; i++)
    fg_json_integer(json, NULL, trace->lost[i]);
  fg_json_array_end(json);
  fg_json_number(json, "noise_um", trace->noise_um);
  fg_json_object(json, "form");
  fg_json_line(json);
  fg_json_number(json, "sd_um", 1000 * trace->form_error.sd_mm);
  fg_json_number(json, "white_share", trace->form_error.white_share);
  fg_json_number(json, "length_mm", trace->form_error.length_mm);
  fg_json_string(json, "correlation", trace->form_error.smooth ? "smooth" : "exponential");
  fg_json_object_end(json);
  fg_json_line_end(json);
  fg_json_object(json, "overall");
  fg_json_number(json, "radius_mm", trace->overall.radius_mm);
  fg_json_number(json, "u_radius_mm", trace->overall.u_radius_mm);
  fg_json_numbers(json, "centre_mm", &trace->overall.centre_mm.x, 2);
  fg_json_number(json, "rms_um", trace->overall.rms_um);
  fg_json_object_end(json);
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < trace->bump_count; i++)
    write_trace_bump(json, &trace->bumps[i]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

fg_status fg_die_write_json(fg_context *ctx, const fg_die *die, FILE *out) {
  fg_json json;
  char words[200];
  fg_report_outcome outcome;
  fg_die_judge(die, &outcome, words, sizeof words);
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/die/1");
  fg_json_verdict(&json, outcome.verdict);
  fg_json_string(&json, "summary", words);
  fg_json_design(&json, "design", &die->design);
  fg_json_nominal(&json, "nominal", &die->nominal);
  fg_json_number(&json, "u_tip_um", die->options.u_tip_um);
  fg_json_number(&json, "u_scale_ppm", die->options.u_scale_ppm);
  fg_json_number(&json, "max_slope_deg", die->options.max_slope_deg);
  fg_json_object(&json, "die");
  write_side(&json, die, &die->whole, "halves");
  fg_json_object_end(&json);
  fg_json_array(&json, "halves");
  for (int half = 0; half < FG_DIE_HALVES; half++)
    if (die->half[half].traces) write_half(&json, die, (fg_die_half)half);
  fg_json_array_end(&json);
  fg_json_array(&json, "traces");
  for (size_t i = 0; i < die->trace_count; i++)
    write_trace(&json, &die->traces[i]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the JSON report");
}
