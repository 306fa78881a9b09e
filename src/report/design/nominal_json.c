/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design and its derived values: the document `foilgauge design -o` writes. */
#include "core/file.h"
#include "foilgauge/cantilever.h"
#include "foilgauge/design_report.h"
#include "foilgauge/foil_kind.h"
#include "report/design/beam_deviations.h"
#include "report/design/kind_members.h"
#include "report/design/members.h"
#include "report/stiffness/table.h"

/* Values that follow from a design, in the report that is written. */
typedef struct nominal_report {
  const fg_design *design;
  const fg_nominal *nominal;
  fg_cantilever beam, deviating[FG_BEAM_DEVIATIONS];
  double second_moment_mm4;
  fg_stiffness_of_design stiffness;
} nominal_report;

#define KNOWN .options = FG_MEMBER_NEVER_NULL
static const fg_member nominal_rows[] = {
    {FG_NUMBER("centre_to_centre_mm", fg_nominal, centre_to_centre_mm), KNOWN,
     .words = "X, from the bump's centre to the overall centre"},
    {FG_NUMBER("half_chord_mm", fg_nominal, half_chord_mm), KNOWN,
     .words = "l0 = R sin(alpha / 2)"},
    {FG_NUMBER("arc_length_mm", fg_nominal, arc_length_mm), KNOWN, .words = "of a bump, alpha R"},
    {FG_NUMBER("intersection_angle_deg", fg_nominal, intersection_angle_deg), KNOWN,
     .words = "theta"},
    {FG_NUMBER("height_mm", fg_nominal, height_mm), KNOWN, .words = "h of a bump"},
    {FG_NUMBER("die_height_mm", fg_nominal, die_height_mm), KNOWN,
     .words = "of the die, t + R - R cos(alpha / 2)"},
    {FG_NUMBER("clearance_mm", fg_nominal, clearance_mm), KNOWN, .words = "of the bearing"},
};
const fg_members fg_nominal_members = FG_MEMBERS_OF_FILE(nominal_rows, "nominal", "measure");

static const fg_member arc_rows[] = {
    {FG_NUMBER("arc_length_mm", fg_nominal, arc_length_mm), KNOWN, .words = "from end to end"},
};
static const fg_members arc_members = FG_MEMBERS(arc_rows);

static double find_length_error(const fg_subject *subject) {
  return fg_beam_deviations_pct[subject->index][0];
}

static double find_width_error(const fg_subject *subject) {
  return fg_beam_deviations_pct[subject->index][1];
}

static const fg_member deviation_rows[] = {
    {FG_NUMBER_BY("length_error_pct", find_length_error), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER_BY("width_error_pct", find_width_error), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("compliance_error_pct", fg_cantilever, compliance_error_pct),
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("sagitta_error_pct", fg_cantilever, sagitta_error_pct),
     .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("clearance_change_mm", fg_cantilever, clearance_change_mm),
     .words = "null without sagitta_mm"},
    {FG_NUMBER("clearance_change_pct", fg_cantilever, clearance_change_pct),
     .words = "null without clearance_mm"},
};
static const fg_members deviation_members = FG_MEMBERS(deviation_rows);

static bool find_deviation(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &((const nominal_report *)list->object)->deviating[i];
  return i < FG_BEAM_DEVIATIONS;
}

static const fg_member beam_rows[] = {
    {FG_NUMBER("second_moment_mm4", nominal_report, second_moment_mm4), KNOWN,
     .words = "I = w t^3 / 12"},
    {FG_NUMBER_U("compliance_mm_per_n", nominal_report, beam.compliance_mm_per_n,
                 beam.u_compliance_mm_per_n),
     .words = "L^3 / (3 E I); null without elastic_modulus_gpa"},
    {FG_LIST_BY("deviations", find_deviation, &deviation_members), .options = FG_MEMBER_ON_LINE,
     .words = "consequences of deviations of length and width"},
};
static const fg_members beam_members = FG_MEMBERS(beam_rows);

static fg_subject design_of(const fg_subject *subject) {
  return (fg_subject){.object = ((const nominal_report *)subject->object)->design};
}

static bool is_report_of_bumps(const fg_subject *subject) {
  const fg_subject design = design_of(subject);
  return fg_design_is_of_bumps(&design);
}

static bool is_report_of_arc(const fg_subject *subject) {
  const fg_subject design = design_of(subject);
  return fg_design_is_of_arc(&design);
}

static bool is_report_of_beams(const fg_subject *subject) {
  const fg_subject design = design_of(subject);
  return fg_design_is_of_beams(&design);
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/nominal/1")},
    {FG_POINTED("design", nominal_report, design, &fg_design_members),
     .schema = FG_REF("design.schema.json"), .words = "as stated"},
    {FG_POINTED("nominal", nominal_report, nominal, &fg_nominal_members), KNOWN,
     .present = is_report_of_bumps, .words = "of a foil with bumps (thesis eq 5.1, 5.2, 5.5, 5.8)"},
    {FG_POINTED("nominal", nominal_report, nominal, &arc_members),
     .options = FG_MEMBER_NEVER_NULL | FG_MEMBER_EITHER, .present = is_report_of_arc,
     .words = "of an arc"},
    {FG_GROUP("nominal", &beam_members), .options = FG_MEMBER_EITHER, .present = is_report_of_beams,
     .words = "of a cantilever"},
    {FG_OBJECT("stiffness", nominal_report, stiffness, &fg_stiffness_design_members),
     .present = is_report_of_bumps,
     .words = "of a bump, by three models (include/foilgauge/stiffness.h)"},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_nominal_document = {
    .file = "nominal",
    .title = "foilgauge design, with its derived values",
    .made_by = "`foilgauge design -o`",
    .members = &report_members,
};

fg_status fg_design_write_json(fg_context *ctx, const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  const fg_design_group group = fg_foil_traits_of(design->kind)->group;
  nominal_report made = {.design = design, .nominal = report->nominal};
  if (group == FG_DESIGN_BEAMS) {
    made.beam = fg_cantilever_nominal(design);
    made.second_moment_mm4 = fg_cantilever_second_moment_mm4(design);
    for (size_t i = 0; i < FG_BEAM_DEVIATIONS; i++)
      made.deviating[i] = fg_cantilever_deviating(design, fg_beam_deviations_pct[i][0],
                                                  fg_beam_deviations_pct[i][1]);
  }
  if (group == FG_DESIGN_BUMPS)
    made.stiffness = fg_stiffness_find_of_design(design, report->material);
  fg_document_json(out, &report_members, &made);
  return fg_stream_finish(ctx, out, "the design");
}
