/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of lot.json about bearings. */
#include "report/lot/json.h"
#include "report/measure/json.h"
#include "report/quantity_json.h"

static void write_pads(fg_json *json, const fg_lot_analysis *analysis,
                       const fg_lot_bearing *bearing) {
  fg_json_array(json, "pads");
  fg_json_line(json);
  for (size_t pad = 0; pad < analysis->layout.pads; pad++)
    fg_json_string(json, NULL,
                   bearing->pad[pad]
                       ? fg_manifest_label(&analysis->lot->manifest, bearing->pad[pad]->item)
                       : NULL);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

static void write_lot_bearing(fg_json *json, const fg_lot_analysis *analysis,
                              const fg_lot_bearing *bearing) {
  fg_json_object(json, NULL);
  fg_json_string(json, "name", bearing->name);
  fg_json_integer(json, "number", (int64_t)bearing->number);
  write_pads(json, analysis, bearing);
  fg_json_numbers(json, "angle_deg", bearing->angle_deg, bearing->places);
  fg_json_numbers(json, "clearance_mm", bearing->clearance_mm, bearing->places);
  fg_json_numbers(json, "u_clearance_mm", bearing->u_clearance_mm, bearing->places);
  fg_json_verdict(json, bearing->decision.outcome.verdict);
  fg_json_judgements(json, &bearing->decision, "bearing");
  if (bearing->known)
    fg_json_quantities(json, FG_QUANTITY_OF_BEARING, "", &bearing->clearance, true);
  fg_json_object_end(json);
}

static void write_layout(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_bearing_layout *layout = &analysis->layout;
  fg_json_object(json, "bearing_layout");
  fg_json_integer(json, "pads", (int64_t)layout->pads);
  fg_json_integer(json, "bumps_per_pad", (int64_t)layout->bumps_per_pad);
  fg_json_integer(json, "first_bump", (int64_t)layout->first_bump);
  fg_json_number(json, "bump_pitch_deg", fg_bearing_pitch_deg(layout));
  fg_json_string(json, "note", analysis->layout_note[0] ? analysis->layout_note : NULL);
  fg_json_object_end(json);
}

void fg_lot_json_bearings(fg_json *json, const fg_lot_analysis *analysis) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  bool assumed =
      fg_manifest_column(manifest, analysis->lot->settings.bearing_column) == FG_NO_COLUMN;
  write_layout(json, analysis);
  fg_json_bool(json, "bearings_assumed", assumed);
  fg_json_object(json, "foils_in_no_bearing");
  fg_json_line(json);
  fg_json_integer(json, "without", (int64_t)analysis->unplaced.without);
  fg_json_integer(json, "displaced", (int64_t)analysis->unplaced.displaced);
  fg_json_integer(json, "bad_pads", (int64_t)analysis->unplaced.bad_pads);
  fg_json_object_end(json);
  fg_json_line_end(json);
  fg_json_array(json, "bearings");
  for (size_t i = 0; i < analysis->bearing_count; i++)
    write_lot_bearing(json, analysis, &analysis->bearings[i]);
  fg_json_array_end(json);
  if (analysis->clearance_pct.count)
    fg_lot_json_spread(json, "clearance_relative_to_design_pct", &analysis->clearance_pct);
  if (analysis->clearance_fitted_pct.count)
    fg_lot_json_spread(json, "clearance_fitted_relative_to_design_pct",
                       &analysis->clearance_fitted_pct);
}
