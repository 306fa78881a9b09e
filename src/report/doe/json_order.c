/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects taken out before the analysis, and the residuals over the order of the runs, as JSON. */
#include <stdlib.h>

#include "report/doe/json_parts.h"
#include "report/doe/words.h"

void fg_doe_json_taken(fg_json *json, const fg_experiment *e) {
  if (!fg_doe_json_begin_part(json, "taken_out", e->takens > 0)) return;
  fg_json_integer(json, "freedom", (int64_t)e->dof_taken);
  fg_json_array(json, "effects");
  for (size_t i = 0; i < e->takens; i++) {
    const fg_experiment_taken *t = &e->taken[i];
    fg_json_object(json, NULL);
    fg_json_string(json, "id", t->id);
    fg_json_string(json, "words", t->words);
    fg_json_bool(json, "taken_out", t->applied);
    fg_json_number(json, "amplitude", t->amplitude);
    fg_json_number(json, "u_amplitude", t->u_amplitude);
    fg_json_integer(json, "parameters", (int64_t)t->parameters);
    fg_json_numbers(json, "range", (const double[]){t->low, t->high}, 2);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

fg_status fg_doe_json_order(fg_context *ctx, fg_json *json, const fg_experiment_report *report) {
  const fg_order_check *o = &report->experiment->order;
  char *command = NULL;
  if (!fg_doe_json_begin_part(json, "order", report->experiment->has_order)) return FG_OK;
  if (fg_order_seen(o)) FG_TRY(fg_experiment_loop_command(ctx, report, &command));
  fg_json_string(json, "column", o->column);
  fg_json_number(json, "level", FG_ORDER_LEVEL);
  fg_json_object(json, "drift");
  fg_json_bool(json, "shows", fg_order_shows(o->drift_p));
  fg_json_number(json, "change", o->drift);
  fg_json_number(json, "u_change", o->u_drift);
  fg_json_number(json, "p_value", o->drift_p);
  fg_json_object_end(json);
  fg_json_object(json, "neighbours");
  fg_json_bool(json, "shows", fg_order_shows(o->neighbours_p));
  fg_json_number(json, "correlation", o->neighbours);
  fg_json_number(json, "durbin_watson", o->durbin_watson);
  fg_json_number(json, "p_value", o->neighbours_p);
  fg_json_object_end(json);
  fg_json_object(json, "farthest");
  fg_json_bool(json, "shows", fg_order_shows(o->farthest_p));
  fg_json_integer(json, "row", (int64_t)(report->row ? report->row[o->farthest] : o->farthest + 1));
  fg_json_number(json, "externally_studentised", o->farthest_t);
  fg_json_number(json, "p_value", o->farthest_p);
  fg_json_object_end(json);
  fg_json_string(json, "command", command);
  fg_json_object_end(json);
  free(command);
  return FG_OK;
}
