/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Member of lot.json about bearings drawn from the lot's foils. */
#include "report/lot/json.h"

static void write_assembly_share(fg_json *json, const char *name, const fg_assembly_share *share,
                                 bool resampled) {
  fg_json_object(json, name);
  fg_json_line(json);
  fg_json_integer(json, "count", (int64_t)share->count);
  fg_json_number(json, "share", share->share);
  fg_json_number(json, "draws_low", share->draws_low);
  fg_json_number(json, "draws_high", share->draws_high);
  fg_json_number(json, "foils_low", share->foils_low);
  fg_json_number(json, "foils_high", share->foils_high);
  fg_json_string(json, "foils_by",
                 !resampled            ? NULL
                 : share->by_bootstrap ? "bootstrap"
                                       : "independent bearings");
  fg_json_number(json, "surely", share->surely);
  fg_json_number(json, "possibly", share->possibly);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_assembly_result(fg_json *json, const fg_assembly_plan *plan,
                                  const fg_assembly_result *result, bool resampled) {
  fg_json_object(json, "drawn");
  write_assembly_share(json, "assembled", &result->assembled, resampled);
  fg_json_array(json, "limits");
  for (size_t i = 0; i < plan->limits; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "quantity", plan->limit[i].row->tolerance);
    fg_json_number(json, "min", plan->limit[i].lower);
    fg_json_number(json, "max", plan->limit[i].upper);
    fg_json_bool(json, "asked", plan->limit[i].asked);
    write_assembly_share(json, "within", &result->within[i], resampled);
    fg_json_integer(json, "rejected", (int64_t)result->rejected[i]);
    fg_json_integer(json, "rejected_alone", (int64_t)result->alone[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_object(json, "quantiles");
  fg_json_numbers(json, "probability", fg_assembly_probability, FG_ASSEMBLY_QUANTILES);
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++)
    fg_json_numbers(json, fg_assembly_row(i)->tolerance, result->quantile[i],
                    FG_ASSEMBLY_QUANTILES);
  fg_json_object_end(json);
  fg_json_object_end(json);
}

static void write_left_out(fg_json *json, const fg_lot_analysis *analysis) {
  fg_json_array(json, "left_out");
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    if (analysis->assembly.reason[i] == FG_LOT_IN_STOCK) continue;
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_integer(json, "input", (int64_t)foil->item);
    fg_json_string(json, "label", fg_manifest_label(&analysis->lot->manifest, foil->item));
    fg_json_integer(json, "number", foil->foil->number);
    fg_json_string(json, "why", fg_lot_left_out_words(analysis->assembly.reason[i]));
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void write_assembly_changes(fg_json *json, const fg_lot_assembly *assembly) {
  fg_json_array(json, "changes");
  for (size_t i = 0; i < assembly->changes; i++) {
    const fg_lot_change *change = &assembly->change[i];
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "change", change->name);
    fg_json_string(json, "words", change->words);
    fg_json_number(json, "share", change->share);
    fg_json_number(json, "gain", change->gain);
    fg_json_bool(json, "clear", change->clear);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
  fg_json_integer(json, "classes", (int64_t)assembly->classes);
}

static void write_drawn(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  write_assembly_result(json, &assembly->plan, &assembly->drawn, true);
  fg_json_object(json, "design");
  fg_json_number(json, "clearance_mm", analysis->lot->nominal.clearance_mm);
  fg_json_number(json, "deviation_pct", analysis->lot->settings.assembly.design_deviation_pct);
  write_assembly_result(json, &assembly->plan, &assembly->design, false);
  fg_json_object_end(json);
  write_assembly_changes(json, assembly);
}

void fg_lot_json_assembly(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_assembly *assembly = &analysis->assembly;
  if (!assembly->asked) return;
  fg_json_object(json, "assembly");
  fg_json_integer(json, "bearings", (int64_t)assembly->plan.bearings);
  fg_json_integer(json, "seed", (int64_t)assembly->plan.seed);
  fg_json_integer(json, "foils", (int64_t)assembly->stock.foils);
  fg_json_integer(json, "pads", (int64_t)assembly->plan.layout.pads);
  fg_json_string(json, "replacement", "a bearing takes different foils, which go back after it");
  write_left_out(json, analysis);
  fg_json_string(json, "why_none", assembly->why[0] ? assembly->why : NULL);
  fg_json_array(json, "statements");
  for (size_t i = 0; i < sizeof assembly->statement / sizeof *assembly->statement; i++)
    if (assembly->statement[i][0]) fg_json_string(json, NULL, assembly->statement[i]);
  fg_json_array_end(json);
  fg_json_string(json, "scope", fg_assembly_scope);
  if (!assembly->why[0]) write_drawn(json, analysis);
  fg_json_object_end(json);
}
