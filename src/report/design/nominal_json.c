/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design and its derived values as JSON. */
#include "core/file.h"
#include "foilgauge/cantilever.h"
#include "foilgauge/design_report.h"
#include "report/design/beam_deviations.h"
#include "report/design/json.h"
#include "report/measure/foil_view.h"
#include "report/stiffness/table.h"

static void write_stiffness(fg_json *json, const fg_design_report *report) {
  const fg_stiffness_of_design stiffness =
      fg_stiffness_find_of_design(report->design, report->material);
  fg_json_object(json, "stiffness");
  fg_members_json(json, &fg_stiffness_design_members, &(fg_subject){.object = &stiffness});
  fg_json_object_end(json);
}

static void write_deviating(fg_json *json, const fg_design *design, double length_pct,
                            double width_pct) {
  const fg_cantilever beam = fg_cantilever_deviating(design, length_pct, width_pct);
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_number(json, "length_error_pct", length_pct);
  fg_json_number(json, "width_error_pct", width_pct);
  fg_json_number(json, "compliance_error_pct", beam.compliance_error_pct);
  fg_json_number(json, "sagitta_error_pct", beam.sagitta_error_pct);
  fg_json_number(json, "clearance_change_mm", beam.clearance_change_mm);
  fg_json_number(json, "clearance_change_pct", beam.clearance_change_pct);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

void fg_nominal_json_of_beams(fg_json *json, const fg_design_report *report) {
  const fg_design *design = report->design;
  const fg_cantilever beam = fg_cantilever_nominal(design);
  fg_json_object(json, "nominal");
  fg_json_number(json, "second_moment_mm4", fg_cantilever_second_moment_mm4(design));
  fg_json_number(json, "compliance_mm_per_n", beam.compliance_mm_per_n);
  fg_json_number(json, "u_compliance_mm_per_n", beam.u_compliance_mm_per_n);
  fg_json_array(json, "deviations");
  for (size_t i = 0; i < FG_BEAM_DEVIATIONS; i++)
    write_deviating(json, design, fg_beam_deviations_pct[i][0], fg_beam_deviations_pct[i][1]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

void fg_nominal_json_of_bumps(fg_json *json, const fg_design_report *report) {
  fg_json_nominal(json, "nominal", report->nominal);
  write_stiffness(json, report);
}

fg_status fg_design_write_json(fg_context *ctx, const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  const fg_foil_view *view = fg_foil_view_of(design->kind);
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/nominal/1");
  fg_json_design(&json, "design", design);
  if (view->nominal_json) view->nominal_json(&json, report);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the design");
}
