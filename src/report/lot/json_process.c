/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about the state of the process and the causes of its charts' signals. */
#include "report/lot/json.h"

static void write_lot_trend(fg_json *json, const fg_lot_trend *trend) {
  if (!trend->known) {
    fg_json_string(json, "trend", NULL);
    return;
  }
  fg_json_object(json, "trend");
  fg_json_number(json, "per_foil", trend->per_foil);
  fg_json_number(json, "u_per_foil", trend->u_per_foil);
  fg_json_number(json, "freedom", trend->dof);
  fg_json_number(json, "first_to_last", (double)(trend->foils - 1) * trend->per_foil);
  fg_json_number(json, "neighbours", trend->correlation);
  fg_json_number(json, "p_value", trend->p_value);
  fg_json_integer(json, "signals_left", (int64_t)trend->signals_left);
  fg_json_object_end(json);
}

void fg_lot_json_cause(fg_json *json, const fg_lot_analysis *analysis,
                       const fg_lot_quantity *quantity) {
  const fg_lot_cause *cause = &quantity->cause;
  write_lot_trend(json, &quantity->trend);
  if (cause->column == FG_NO_COLUMN) {
    fg_json_string(json, "signals_by", NULL);
    return;
  }
  fg_json_object(json, "signals_by");
  fg_json_string(json, "column", analysis->lot->manifest.name[cause->column]);
  fg_json_number(json, "p_value", cause->p_value);
  fg_json_integer(json, "signals_left", (int64_t)cause->signals_left);
  fg_json_bool(json, "in_turn", cause->in_turn);
  fg_json_array(json, "groups");
  for (size_t g = 0; g < cause->groups; g++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "name", cause->name[g]);
    fg_json_integer(json, "foils", (int64_t)cause->foils[g]);
    fg_json_number(json, "mean", cause->mean[g]);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_foil_names(fg_json *json, const char *name, const fg_lot_analysis *analysis,
                             bool unstable, bool explained) {
  fg_json_array(json, name);
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_quantity *quantity = &analysis->quantities[i];
    if (!fg_lot_is_watched(analysis, quantity) || (unstable && quantity->stable) ||
        (explained && !fg_lot_is_explained(quantity)))
      continue;
    fg_json_string(json, NULL, quantity->row->name);
  }
  fg_json_array_end(json);
}

void fg_lot_json_process(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_lot_process *process = &analysis->process;
  fg_json_object(json, "process");
  if (process->watched)
    fg_json_bool(json, "stable", process->unstable == 0);
  else
    fg_json_string(json, "stable", NULL);
  write_foil_names(json, "watched", analysis, false, false);
  write_foil_names(json, "not_stable", analysis, true, false);
  write_foil_names(json, "explained", analysis, true, true);
  fg_json_object_end(json);
}
