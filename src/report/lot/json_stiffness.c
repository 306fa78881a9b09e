/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about the stiffness of bumps. */
#include "report/lot/json.h"

static void write_arch(fg_json *json, const char *name, const fg_arch_stiffness *stiffness) {
  fg_json_object(json, name);
  fg_json_line(json);
  fg_json_number(json, "stiffness_n_mm2", stiffness->stiffness_n_mm2);
  fg_json_number(json, "unloading_n_mm2", stiffness->unloading_n_mm2);
  fg_json_number(json, "foot_n_mm2", stiffness->foot_n_mm2);
  fg_json_number(json, "foot_share", stiffness->foot_share);
  fg_json_bool(json, "stuck", stiffness->stuck);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_models(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_stiffness *stiffness = &analysis->stiffness;
  double pitch_mm = fg_design_pitch_mm(&analysis->lot->settings.design);
  fg_json_array(json, "models");
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    fg_json_object(json, NULL);
    fg_json_stiffness_model(json, i);
    for (int k = 0; k < (analysis->has_stiffness ? FG_LOT_CASES : 1); k++)
      fg_json_stiffness_case(json, &stiffness->cases[k], i, pitch_mm);
    if (stiffness->by_model[i].count)
      fg_lot_json_spread(json, "normalised", &stiffness->by_model[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_term(fg_json *json, const char *name, const fg_lot_budget_term *term) {
  fg_json_object(json, name);
  fg_json_line(json);
  fg_json_number(json, "relative_sd_pct", term->spread_pct);
  fg_json_number(json, "sensitivity", term->sensitivity);
  fg_json_number(json, "variance_pct2", term->variance_pct2);
  fg_json_number(json, "share_pct", term->share_pct);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_stiffness_budget(fg_json *json, const fg_lot_budget *budget) {
  fg_json_object(json, "budget");
  write_term(json, "radius_at_arc_length", &budget->radius);
  write_term(json, "arc_length", &budget->arc_length);
  fg_json_object(json, "radius_with_arc_length");
  fg_json_line(json);
  fg_json_number(json, "correlation", budget->correlation);
  fg_json_number(json, "variance_pct2", budget->together_pct2);
  fg_json_object_end(json);
  fg_json_line_end(json);
  write_term(json, "thickness", &budget->thickness);
  fg_json_number(json, "sum_pct2", budget->sum_pct2);
  fg_json_number(json, "observed_relative_sd_pct", budget->observed_pct);
  fg_json_number(json, "unexplained_pct2", budget->unexplained_pct2);
  fg_json_number(json, "rest_share_pct", budget->rest_share_pct);
  fg_json_number(json, "measurement_relative_sd_pct", budget->measurement_pct);
  fg_json_number(json, "parts_relative_sd_pct", budget->parts_pct);
  fg_json_object_end(json);
}

void fg_lot_json_stiffness(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_stiffness *stiffness = &analysis->stiffness;
  fg_json_object(json, "stiffness");
  fg_json_string(json, "model", "classical");
  fg_json_string(json, "note", fg_lot_stiffness_note(analysis));
  write_arch(json, "design_free", &stiffness->design_free);
  write_arch(json, "design_welded", &stiffness->design_welded);
  fg_json_sensitivity(json, "sensitivity", &stiffness->sensitivity);
  write_models(json, analysis);
  if (analysis->has_stiffness) {
    fg_lot_json_spread(json, "normalised", &stiffness->measured);
    fg_json_number(json, "u_normalised_by_thickness", stiffness->u_by_thickness);
    fg_json_number(json, "u_normalised_by_calibration", stiffness->u_by_calibration);
    fg_lot_json_spread(json, "normalised_at_design_thickness", &stiffness->at_design_thickness);
    fg_lot_json_spread(json, "normalised_resampled", &stiffness->resampled);
    fg_lot_json_spread(json, "normalised_foot", &stiffness->foot);
    write_stiffness_budget(json, &stiffness->budget);
  }
  fg_json_object_end(json);
}
