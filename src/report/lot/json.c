/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lot.json: "schema": "foilgauge/lot/1" (reports/schema/lot.schema.json). */
#include <math.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "lot/input/reference_curve.h"
#include "lot/run/date.h"
#include "lot/statistics/dies.h"
#include "report/design/calibration_json.h"
#include "report/design/json.h"
#include "report/flag_names.h"
#include "report/lot/files.h"
#include "report/lot/json.h"
#include "report/measure/json.h"
#include "report/measure/scan_model_words.h"
#include "report/quantity_json.h"

static void write_lot_inputs(fg_json *json, const fg_lot *lot) {
  fg_json_array(json, "inputs");
  for (size_t i = 0; i < lot->manifest.items; i++) {
    const fg_record *record = &lot->records[i];
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "path", record->scan);
    fg_json_string(json, "sha256", record->sha256[0] ? record->sha256 : NULL);
    fg_json_string(json, "error", record->error);
    if (record->repeat_of) fg_json_integer(json, "repeat_of", (int64_t)record->repeat_of - 1);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_foil_counts(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_words *words = fg_lot_words_of(analysis);
  fg_json_object(json, "counts");
  fg_json_integer(json, "scans", (int64_t)analysis->lot->manifest.items);
  fg_json_integer(json, "scans_not_measured", (int64_t)analysis->failed_scans);
  const fg_record *repeat;
  size_t repeats = fg_lot_count_repeats(analysis->lot, &repeat);
  fg_json_integer(json, "scans_repeated", (int64_t)repeats);
  fg_json_integer(json, "foils", (int64_t)analysis->foil_count);
  fg_json_integer(json, words->many, (int64_t)analysis->part_count);
  fg_json_integer(json, words->json_damaged, (int64_t)analysis->left_out);
  for (int verdict = FG_VERDICT_PASS; verdict <= FG_VERDICT_NONE; verdict++)
    fg_json_integer(json, fg_verdict_word((fg_verdict)verdict),
                    (int64_t)analysis->by_verdict[verdict]);
  fg_json_integer(json, "exceeded", (int64_t)analysis->exceeded);
  fg_json_integer(json, "rejected", (int64_t)analysis->outcome.rejected);
  fg_json_object_end(json);
}

static void write_foil_flags(fg_json *json, const fg_foil *foil) {
  fg_json_array(json, "flags");
  fg_json_flag_names(json, fg_foil_flag_words(), foil->flags, foil->strip.picture.findings);
  fg_json_array_end(json);
}

static void write_lot_foil(fg_json *json, const fg_lot_analysis *analysis,
                           const fg_lot_foil *foil) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  char defect[200];
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_integer(json, "input", (int64_t)foil->item);
  fg_json_string(json, "label", fg_manifest_label(manifest, foil->item));
  fg_json_integer(json, "number", foil->foil->number);
  write_foil_flags(json, foil->foil);
  fg_json_verdict(json, foil->verdict);
  bool rejected =
      fg_foil_defect(&analysis->lot->settings.design, foil->foil, defect, sizeof defect);
  fg_json_string(json, "defect", rejected ? defect : NULL);
  fg_json_bool(json, "exceeded", foil->exceeded);
  fg_json_number(json, "severity", foil->severity);
  fg_json_string(json, "worst_quantity", foil->worst_row ? foil->worst_row->name : NULL);
  fg_json_integer(json, fg_lot_words_of(analysis)->json_worst, foil->worst_number);
  fg_json_number(json, "worst_value", foil->worst_row ? foil->worst_value : NAN);
  fg_json_number(json, "worst_u", foil->worst_u);
  fg_json_number(json, "worst_limit", foil->worst_limit);
  fg_json_number(json, "worst_margin", foil->worst_margin);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_lot_foils(fg_json *json, const fg_lot_analysis *analysis) {
  fg_json_array(json, "foils");
  for (size_t i = 0; i < analysis->foil_count; i++)
    write_lot_foil(json, analysis, &analysis->foils[i]);
  fg_json_array_end(json);
  fg_json_array(json, "worst");
  for (int i = 0; i < 3; i++)
    if (analysis->worst[i]) write_lot_foil(json, analysis, analysis->worst[i]);
  fg_json_array_end(json);
}

static void write_capability_ratio(fg_json *json, const char *name, const fg_ratio *ratio) {
  fg_json_object(json, name);
  fg_json_line(json);
  fg_json_number(json, "value", ratio->value);
  fg_json_number(json, "low", ratio->low);
  fg_json_number(json, "high", ratio->high);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_lot_capability(fg_json *json, const fg_lot_quantity *quantity) {
  const fg_capability *capability = &quantity->capability;
  fg_json_object(json, "capability");
  fg_json_number(json, "min", quantity->tolerance->lower);
  fg_json_number(json, "max", quantity->tolerance->upper);
  fg_json_bool(json, "stable", capability->stable);
  fg_json_bool(json, "normal", capability->normal);
  fg_json_number(json, "anderson_darling", capability->normality.a2);
  fg_json_number(json, "normality_p_value", capability->normality.p_value);
  write_capability_ratio(json, "pp", &capability->p);
  write_capability_ratio(json, "ppk", &capability->pk);
  write_capability_ratio(json, "cp", &capability->c);
  write_capability_ratio(json, "cpk", &capability->ck);
  fg_json_number(json, "pp_quantile", capability->quantile_p);
  fg_json_number(json, "ppk_quantile", capability->quantile_pk);
  fg_json_numbers(json, "quantiles", capability->quantile, 3);
  fg_json_object_end(json);
}

static void write_control_chart(fg_json *json, const char *name, const fg_chart *chart,
                                double sigma) {
  fg_json_object(json, name);
  fg_json_number(json, "centre", chart->centre);
  fg_json_number(json, "sigma", sigma);
  fg_json_integer(json, "points", (int64_t)chart->count);
  fg_json_array(json, "signals");
  for (size_t i = 0; i < chart->count; i++) {
    if (!chart->point[i].rules) continue;
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_integer(json, "point", (int64_t)i + 1);
    fg_json_number(json, "value", chart->point[i].value);
    fg_json_array(json, "rules");
    for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
      if (chart->point[i].rules & (1u << (rule - 1))) fg_json_integer(json, NULL, rule);
    fg_json_array_end(json);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_places(fg_json *json, const fg_lot_words *words,
                         const fg_lot_quantity *quantity) {
  fg_json_array(json, words->many);
  for (size_t i = 0; i < quantity->places; i++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_integer(json, "number", (int64_t)i + 1);
    fg_json_integer(json, "count", (int64_t)quantity->place[i].count);
    fg_json_number(json, "mean", quantity->place[i].mean);
    fg_json_number(json, "sd", quantity->place[i].sd);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_lot_quantity(fg_json *json, const fg_lot_analysis *analysis,
                               const fg_lot_quantity *quantity) {
  fg_json_object(json, quantity->row->name);
  fg_json_integer(json, "count", (int64_t)quantity->count);
  fg_json_number(json, "mean", quantity->mean);
  fg_json_number(json, "sd", quantity->sd);
  const fg_lot_mean_u known = fg_lot_find_mean_u(analysis, quantity);
  fg_json_number(json, "u_mean", known.u);
  fg_json_number(json, "u_mean_statistical", known.u_statistical);
  fg_json_number(json, "u_mean_calibration", known.u_calibration);
  fg_json_number(json, "median", quantity->median);
  fg_json_number(json, "mode", quantity->mode);
  fg_json_number(json, "min", quantity->min);
  fg_json_number(json, "max", quantity->max);
  fg_json_number(json, "bandwidth", quantity->has_density ? quantity->density.bandwidth : NAN);
  if (fg_owner_is_part(quantity->owner)) write_places(json, fg_lot_words_of(analysis), quantity);
  if (quantity->has_chart) {
    write_control_chart(json, "individuals", &quantity->chart, quantity->chart_sigma);
    fg_json_bool(json, "stable", quantity->stable);
    fg_lot_json_cause(json, analysis, quantity);
  }
  if (quantity->has_subgroups) {
    write_control_chart(json, "means", &quantity->means, quantity->within_sigma);
    write_control_chart(json, "deviations", &quantity->deviations, quantity->within_sigma);
  }
  if (quantity->has_capability) write_lot_capability(json, quantity);
  fg_json_object_end(json);
}

static void write_correlation(fg_json *json, const fg_lot_correlation *correlation) {
  fg_json_object(json, "correlation");
  fg_json_integer(json, "count", (int64_t)correlation->count);
  fg_json_integer(json, "trimmed", (int64_t)correlation->trimmed);
  fg_json_integer(json, "foils", (int64_t)correlation->foils);
  fg_json_number(json, "r", correlation->r);
  fg_json_number(json, "slope", correlation->slope);
  fg_json_number(json, "intercept_pct", correlation->intercept);
  fg_json_number(json, "log_slope", correlation->log_slope);
  fg_json_number(json, "log_slope_low", correlation->log_low);
  fg_json_number(json, "log_slope_high", correlation->log_high);
  fg_json_number(json, "log_slope_freedom", correlation->log_dof);
  fg_json_number(json, "arc_length_mean_pct", correlation->arc_length_mean_pct);
  fg_json_number(json, "arc_length_sd_pct", correlation->arc_length_sd_pct);
  fg_json_object_end(json);
}

static void write_thickness(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_thickness *thickness = &analysis->thickness;
  fg_json_object(json, "thickness");
  fg_json_integer(json, "foils", (int64_t)thickness->foils);
  fg_json_number(json, "mean_mm", thickness->mean.mm);
  fg_json_number(json, "u_mean_mm", thickness->mean.u_mm);
  fg_json_number(json, "design_mm", analysis->lot->settings.design.thickness_mm);
  fg_json_bool(json, "differs", thickness->differs);
  fg_json_object_end(json);
}

/* Members of the tests in the order of fg_lot_group_test. */
static const char *const test_members[FG_LOT_GROUP_TESTS][2] = {{"p_means", "p_means_holm"},
                                                                {"p_variances", "p_variances_holm"},
                                                                {"p_levene", "p_levene_holm"},
                                                                {"p_within", "p_within_holm"}};

static void write_difference(fg_json *json, const fg_lot_difference *difference) {
  const fg_comparison *comparison = &difference->comparison;
  fg_json_object(json, NULL);
  fg_json_string(json, "quantity", difference->quantity->row->name);
  fg_json_string(json, "a", difference->a);
  fg_json_string(json, "b", difference->b);
  fg_json_integer(json, "count_a", (int64_t)difference->count_a);
  fg_json_integer(json, "count_b", (int64_t)difference->count_b);
  fg_json_integer(json, "foils_a", (int64_t)difference->foils_a);
  fg_json_integer(json, "foils_b", (int64_t)difference->foils_b);
  fg_json_number(json, "mean_a", difference->mean_a);
  fg_json_number(json, "mean_b", difference->mean_b);
  fg_json_number(json, "sd_a", difference->sd_a);
  fg_json_number(json, "sd_b", difference->sd_b);
  fg_json_number(json, "within_sd_a", difference->within_sd_a);
  fg_json_number(json, "within_sd_b", difference->within_sd_b);
  fg_json_number(json, "difference", comparison->difference);
  fg_json_number(json, "difference_low", comparison->low);
  fg_json_number(json, "difference_high", comparison->high);
  fg_json_number(json, "variance_ratio", comparison->variance_ratio);
  for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++) {
    fg_json_number(json, test_members[t][0], difference->p[t]);
    fg_json_number(json, test_members[t][1], difference->p_holm[t]);
  }
  fg_json_object_end(json);
}

static void write_gauge(fg_json *json, const fg_lot_words *words, const fg_lot_gauge *gauge) {
  const fg_gauge_study *study = &gauge->study;
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "quantity", gauge->quantity->row->name);
  fg_json_integer(json, words->one, gauge->number);
  fg_json_integer(json, "parts", (int64_t)study->parts);
  fg_json_integer(json, "operators", (int64_t)study->operators);
  fg_json_integer(json, "trials", (int64_t)study->trials);
  fg_json_number(json, "repeatability", study->repeatability);
  fg_json_number(json, "reproducibility", study->reproducibility);
  fg_json_number(json, "grr", study->grr);
  fg_json_number(json, "part", study->part);
  fg_json_number(json, "grr_pct", study->grr_pct);
  fg_json_number(json, "distinct_categories", study->distinct_categories);
  fg_json_number(json, "p_interaction", study->p_interaction);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_lot_date(fg_json *json, const fg_lot *lot) {
  fg_lot_date date;
  const char *wrong;
  size_t count = fg_lot_date_count_invalid(&lot->manifest, &wrong);
  fg_lot_date_find(lot, &date);
  fg_json_object(json, "date");
  fg_json_line(json);
  fg_json_string(json, "first", date.from ? date.first : NULL);
  fg_json_string(json, "last", date.from ? date.last : NULL);
  fg_json_string(json, "from", date.from);
  if (count) fg_json_integer(json, "cells_not_dates", (int64_t)count);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_die_sum(fg_json *json, const fg_lot_die_sum *sum) {
  fg_json_object(json, NULL);
  fg_json_string(json, "name", sum->die->name);
  fg_json_string(json, "sha256", sum->die->sha256);
  fg_json_integer(json, "foils", (int64_t)sum->foils);
  fg_json_integer(json, "bumps", (int64_t)sum->bumps);
  fg_json_integer(json, "bumps_by_mean", (int64_t)sum->by_mean);
  fg_json_number(json, "die_radius_error_pct", sum->die_error_pct);
  fg_json_number(json, "u_die_radius_error_pct", sum->u_die_error_pct);
  fg_json_number(json, "radius_error_mean_pct", sum->design_mean_pct);
  fg_json_number(json, "radius_error_sd_pct", sum->design_sd_pct);
  fg_json_number(json, "radius_error_to_die_mean_pct", sum->die_mean_pct);
  fg_json_number(json, "radius_error_to_die_sd_pct", sum->die_sd_pct);
  fg_json_number(json, "explained_by_die_pct", sum->explained_pct);
  fg_json_object_end(json);
}

static void write_lot_dies(fg_json *json, const fg_lot_analysis *analysis) {
  fg_lot_dies dies;
  fg_lot_analyse_dies(analysis, &dies);
  if (!dies.count) return;
  fg_json_object(json, "dies");
  fg_json_array(json, "each");
  for (size_t i = 0; i < dies.count; i++)
    write_die_sum(json, &dies.sum[i]);
  fg_json_array_end(json);
  fg_json_integer(json, "bumps", (int64_t)dies.bumps);
  fg_json_number(json, "radius_error_sd_pct", dies.design_sd_pct);
  fg_json_number(json, "radius_error_to_die_sd_pct", dies.die_sd_pct);
  fg_json_number(json, "explained_variance_pct", dies.explained_variance_pct);
  fg_json_number(json, "foils_differ_pct", dies.foils_differ_pct);
  fg_json_number(json, "dies_differ_pct", dies.dies_differ_pct);
  fg_json_number(json, "explained_difference_pct", dies.explained_difference_pct);
  fg_json_object_end(json);
}

static void write_lot_head(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  const char *model_sha256 = lot->settings.model_sha256;
  fg_json_head(json, "foilgauge/lot/1");
  fg_json_string(json, "name", lot->settings.name);
  write_lot_date(json, lot);
  fg_json_verdict(json, analysis->outcome.verdict);
  write_foil_counts(json, analysis);
  fg_lot_json_process(json, analysis);
  fg_json_string(json, "recipe_sha256", lot->head.recipe_sha256);
  fg_json_string(json, "manifest_sha256", lot->head.manifest_sha256);
  fg_json_string(json, "model_sha256", model_sha256[0] ? model_sha256 : NULL);
  fg_json_scan_model(json, "model", lot->model);
  fg_correction max = fg_lot_correction_largest(analysis);
  fg_json_correction(json, &max);
  fg_json_calibration_used(json, "calibration", &lot->settings.design.calibration);
  fg_json_design(json, "design", &lot->settings.design);
}

static void write_lot_quantities(fg_json *json, const fg_lot_analysis *analysis) {
  fg_json_object(json, "quantities");
  for (size_t i = 0; i < analysis->quantity_count; i++)
    write_lot_quantity(json, analysis, &analysis->quantities[i]);
  fg_json_object_end(json);
  if (analysis->has_correlation) write_correlation(json, &analysis->correlation);
  write_thickness(json, analysis);
}

static void write_lot_comparisons(fg_json *json, const fg_lot_analysis *analysis) {
  fg_json_array(json, "comparisons");
  for (size_t i = 0; i < analysis->difference_count; i++)
    write_difference(json, &analysis->differences[i]);
  fg_json_array_end(json);
  fg_json_array(json, "gauge_studies");
  for (size_t i = 0; i < analysis->gauge_count; i++)
    write_gauge(json, fg_lot_words_of(analysis), &analysis->gauges[i]);
  fg_json_array_end(json);
}

fg_status fg_lot_write_json(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  const fg_lot *lot = analysis->lot;
  bool bumps = fg_foil_kind_has_bumps(lot->settings.design.kind);
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  write_lot_head(&json, analysis);
  if (bumps) fg_json_nominal(&json, "nominal", &lot->nominal);
  write_lot_inputs(&json, lot);
  write_lot_foils(&json, analysis);
  write_lot_quantities(&json, analysis);
  if (bumps) fg_lot_json_stiffness(&json, analysis);
  if (bumps) fg_lot_json_bearings(&json, analysis);
  if (bumps) write_lot_dies(&json, analysis);
  fg_reference_curve_write(&json, "reference_curve", &lot->settings);
  if (bumps) fg_lot_json_assembly(&json, analysis);
  write_lot_comparisons(&json, analysis);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "lot.json");
}
