/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>

#include "core/file.h"
#include "foilgauge/load_report.h"
#include "report/measure/json.h"

/* Writes name, u_name, and the standard deviation of repeats alone. */
static void write_load_value(fg_json *json, const char *name, const fg_load_value *value) {
  fg_json_number(json, name, value->value);
  fg_json_of(json, "u_", name, value->u);
  fg_json_of(json, "u_repeat_", name, value->u_repeat);
}

static void write_flag_names(fg_json *json, const fg_load_flag *flag, unsigned flags) {
  fg_json_array(json, "flags");
  fg_json_line(json);
  for (; flag->name; flag++)
    if (flags & flag->flag) fg_json_string(json, NULL, flag->name);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

static void write_stiffness_profile(fg_json *json, const char *name,
                                    const fg_load_profile *profile) {
  fg_json_array(json, name);
  for (size_t i = 0; i < profile->count; i++) {
    const fg_load_point *p = &profile->point[i];
    fg_json_numbers(json, NULL,
                    (const double[]){p->x_mm, p->force_n, p->stiffness_n_mm, p->u_stiffness_n_mm},
                    4);
  }
  fg_json_array_end(json);
}

static void write_friction(fg_json *json, const fg_load_friction *f) {
  fg_json_object(json, "friction");
  fg_json_line(json);
  fg_json_number(json, "intercept_n", f->a_n);
  fg_json_number(json, "u_intercept_n", f->u_a_n);
  fg_json_number(json, "slope", f->b);
  fg_json_number(json, "u_slope", f->u_b);
  fg_json_number(json, "way_mm", f->way_mm);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_direction(fg_json *json, const fg_load_test *test, const fg_load_direction *d) {
  fg_json_object(json, NULL);
  fg_json_string(json, "bearing", test->bearings[d->bearing].name);
  fg_json_number(json, "azimuth_deg", d->azimuth_deg);
  fg_json_string(json, "pad", d->pad[0] ? d->pad : NULL);
  write_flag_names(json, fg_load_flags(), d->flags);
  fg_json_string(json, "verdict", fg_verdict_word(fg_load_judge_direction(test, d)));
  fg_json_integer(json, "samples", (int64_t)d->count);
  fg_json_integer(json, "strokes", (int64_t)d->strokes);
  fg_json_integer(json, "cycles", (int64_t)d->cycles);
  fg_json_number(json, "travel_mm", d->travel_mm);
  fg_json_numbers(json, "force_range_n", (const double[]){d->force_low_n, d->force_high_n}, 2);
  fg_json_number(json, "force_zero_n", d->zero_n);
  fg_json_number(json, "force_noise_n", d->noise_n);
  fg_json_number(json, "displacement_noise_mm", d->noise_mm);
  fg_json_number(json, "displacement_step_mm", d->step_mm > 0 ? d->step_mm : NAN);
  write_load_value(json, "clearance_mm", &d->clearance);
  write_load_value(json, "gap_mm", &d->gap);
  fg_json_number(json, "push_mm", d->push_mm);
  fg_json_number(json, "pull_mm", d->pull_mm);
  write_load_value(json, "clearance_unloading_mm", &d->unloading);
  fg_json_number(json, "drift_um_per_cycle", d->drift_um_cycle);
  write_load_value(json, "stiffness_n_mm", &d->stiffness);
  fg_json_number(json, "stiffness_at_mm", d->stiffness_at_mm);
  write_load_value(json, "stiffness_secant_n_mm", &d->secant);
  write_load_value(json, "loop_area_n_mm", &d->area);
  write_load_value(json, "loss_factor", &d->loss);
  write_load_value(json, "loss_factor_secant", &d->loss_secant);
  write_load_value(json, "loss_factor_foil", &d->loss_foil);
  write_friction(json, &d->friction);
  write_load_value(json, "predicted_clearance_mm", &d->predicted);
  write_load_value(json, "clearance_difference_mm", &d->difference);
  fg_json_integer(json, "predicted_pad", d->predicted_pad);
  write_stiffness_profile(json, "course_push", &d->profile[FG_LOAD_PUSH]);
  write_stiffness_profile(json, "course_pull", &d->profile[FG_LOAD_PULL]);
  fg_json_object_end(json);
}

static void write_harmonics(fg_json *json, const fg_load_bearing *b) {
  fg_json_array(json, "harmonics");
  for (int order = 2; order <= FG_LOAD_ORDER_MAX; order += 2) {
    if (!b->harmonic[order]) continue;
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_integer(json, "order", order);
    fg_json_number(json, "amplitude_mm", b->amplitude_mm[order]);
    fg_json_number(json, "u_amplitude_mm", b->u_amplitude_mm[order]);
    fg_json_number(json, "cosine_mm", b->cosine_mm[order]);
    fg_json_number(json, "sine_mm", b->sine_mm[order]);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_break_away(fg_json *json, const fg_break_away *b) {
  if (!b->pulls) {
    fg_json_string(json, "break_away", NULL);
    return;
  }
  fg_json_object(json, "break_away");
  fg_json_integer(json, "pulls", (int64_t)b->pulls);
  fg_json_integer(json, "dead_weights", (int64_t)b->weights);
  fg_json_numbers(json, "dead_weight_range_n", (const double[]){b->weight_low_n, b->weight_high_n},
                  2);
  write_flag_names(json, fg_break_away_flags(), b->flags);
  write_load_value(json, "friction_coefficient", &b->friction);
  write_load_value(json, "friction_no_weight_n", &b->intercept_n);
  fg_json_number(json, "rig_friction_n", b->rig_n);
  fg_json_number(json, "residual_sd_n", b->residual_n);
  fg_json_number(json, "p_curved", b->p_curved);
  fg_json_object_end(json);
}

static void write_bearing(fg_json *json, const fg_load_test *test, size_t bearing) {
  const fg_load_bearing *b = &test->bearings[bearing];
  fg_json_object(json, NULL);
  fg_json_string(json, "name", b->name);
  fg_json_string(json, "verdict", fg_verdict_word(fg_load_judge_bearing(test, bearing)));
  fg_json_integer(json, "azimuths", (int64_t)b->directions);
  fg_json_integer(json, "azimuths_measured", (int64_t)b->measured);
  write_load_value(json, "clearance_min_mm", &b->min);
  fg_json_number(json, "clearance_min_at_deg", b->min_measured_at_deg);
  write_load_value(json, "clearance_max_mm", &b->max);
  fg_json_number(json, "clearance_max_at_deg", b->max_measured_at_deg);
  fg_json_number(json, "clearance_mean_mm", b->mean_mm);
  fg_json_number(json, "u_clearance_mean_mm", b->u_mean_mm);
  fg_json_number(json, "p_alike", b->p_value);
  write_harmonics(json, b);
  fg_json_number(json, "smallest_at_deg", b->min_at_deg);
  fg_json_number(json, "u_smallest_at_deg", b->u_min_at_deg);
  fg_json_string(json, "smallest_not_known", fg_load_axis_words(b->axis));
  fg_json_number(json, "birge_ratio", b->birge);
  write_load_value(json, "stiffness_n_mm", &b->stiffness);
  write_load_value(json, "radial_hysteresis_n", &b->hysteresis_n);
  fg_json_number(json, "friction_intercept_n", b->hysteresis_n.value);
  fg_json_number(json, "u_friction_intercept_n", b->hysteresis_n.u_repeat);
  fg_json_number(json, "friction_slope", b->slope);
  fg_json_number(json, "u_friction_slope", b->u_slope);
  write_break_away(json, &b->break_away);
  write_load_value(json, "preload_n", &b->preload_n);
  write_load_value(json, "preload_kpa", &b->preload_kpa);
  fg_json_bool(json, "in_lot", b->in_lot);
  fg_json_integer(json, "places_unknown", (int64_t)b->unknown_places);
  fg_json_object_end(json);
}

static void write_options(fg_json *json, const fg_load_test *test) {
  const fg_load_options *o = &test->options;
  fg_json_object(json, "options");
  fg_json_number(json, "threshold_n", o->threshold_n);
  fg_json_number(json, "u_force_pct", o->u_force_pct);
  fg_json_number(json, "u_displacement_pct", o->u_displacement_pct);
  fg_json_number(json, "u_stiffness_pct", hypot(o->u_force_pct, o->u_displacement_pct));
  fg_json_number(json, "diameter_mm", o->diameter_mm);
  fg_json_number(json, "length_mm", o->length_mm);
  fg_json_number(json, "azimuth_zero_deg", o->azimuth_zero_deg);
  fg_json_number(json, "u_weight_pct", o->u_weight_pct);
  fg_json_number(json, "lever_mm", isfinite(o->lever_mm) ? o->lever_mm : o->diameter_mm / 2);
  fg_json_number(json, "rig_torque_n_mm", o->rig_n_mm);
  fg_json_number(json, "u_rig_torque_n_mm", isfinite(o->rig_n_mm) ? o->u_rig_n_mm : NAN);
  fg_json_array(json, "limits");
  for (size_t i = 0; i < o->limit_count; i++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "quantity", o->limits[i].quantity);
    fg_json_number(json, "min", o->limits[i].lower);
    fg_json_number(json, "max", o->limits[i].upper);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_load_inputs(fg_json *json, const fg_load_test *test) {
  fg_json_array(json, "inputs");
  for (size_t i = 0; i < test->file_count; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "path", test->files[i].path);
    fg_json_string(json, "sha256", test->files[i].sha256);
    fg_json_string(json, "columns_not_read", test->files[i].not_read);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  if (test->options.lot) fg_json_file(json, "lot", test->options.lot, test->lot_sha256);
}

fg_status fg_load_write_json(fg_context *ctx, const fg_load_test *test, FILE *out) {
  fg_json json;
  char words[300];
  fg_report_outcome outcome;
  fg_load_judge(test, &outcome, words, sizeof words);
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/load_test/1");
  fg_json_verdict(&json, outcome.verdict);
  fg_json_string(&json, "summary", words);
  write_load_inputs(&json, test);
  write_options(&json, test);
  fg_json_array(&json, "bearings");
  for (size_t i = 0; i < test->bearing_count; i++)
    write_bearing(&json, test, i);
  fg_json_array_end(&json);
  fg_json_array(&json, "azimuths");
  for (size_t i = 0; i < test->direction_count; i++)
    write_direction(&json, test, &test->directions[i]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the JSON report");
}
