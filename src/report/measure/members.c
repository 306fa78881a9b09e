/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The document: inputs, and what each scan shows. */
#include "report/measure/members.h"

#include <stdlib.h>

#include "core/file.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/memory.h"
#include "foilgauge/words.h"
#include "report/design/members.h"
#include "report/measure/colour_lines_report.h"
#include "report/measure/foil_view.h"
#include "report/measure/gauge_report.h"
#include "report/measure/grid_members.h"
#include "report/measure/picture_report.h"
#include "report/measure/scan_model_words.h"
#include "report/measure/uncertainty_budget.h"
#include "report/verdict_members.h"

/* A scan with the decisions on it and on its foils and discs. */
typedef struct judged_scan {
  const char *path, *error;
  const fg_measurement *measurement; /* NULL: not measured */
  fg_verdict verdict;
  fg_foil_kind kind;        /* of the report's design */
  fg_judged *foils, *discs; /* owned */
  size_t foil_count, disc_count;
} judged_scan;

/* A report with all decisions. */
typedef struct judged_report {
  const fg_report *report;
  fg_report_outcome outcome;
  judged_scan *scans; /* owned */
  size_t scan_count;
} judged_report;

/* An input. */
static bool has_measurement(const fg_subject *subject) {
  return ((const judged_scan *)subject->object)->measurement != NULL;
}

static const char *find_sha256(const fg_subject *subject, char *buffer) {
  const judged_scan *scan = subject->object;
  (void)buffer;
  return scan->measurement ? scan->measurement->sha256 : NULL;
}

static double find_width(const fg_subject *subject) {
  return (double)((const fg_measurement *)subject->object)->file.width_px;
}

static double find_height(const fg_subject *subject) {
  return (double)((const fg_measurement *)subject->object)->file.height_px;
}

static const char *find_measured_channel(const fg_subject *subject, char *buffer) {
  const fg_measurement *m = subject->object;
  (void)buffer;
  return m->file.colour ? fg_channel_word(m->file.channel) : "gray";
}

static const char *const formats[] = {"PNG", "TIFF", "PNM", "JPEG", NULL};
static const char *const channels[] = {"gray", "red", "green", "blue", "luminance", NULL};

static const fg_member file_rows[] = {
    {FG_COUNT_BY("width_px", find_width)},
    {FG_COUNT_BY("height_px", find_height)},
    {FG_INTEGER("bit_depth", fg_measurement, file.bit_depth),
     .schema = "{\"enum\": [1, 2, 4, 8, 16]}"},
    {FG_STRING("format", fg_measurement, file.format), .choices = formats,
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL},
    {FG_TEXT_BY("channel", find_measured_channel), .choices = channels,
     .options = FG_MEMBER_NEVER_NULL, .words = "what of a colour scan was measured"},
    {FG_INTEGER("jpeg_quality", fg_measurement, file.jpeg_quality), .lowest = 1, .highest = 100,
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "the scan has lost by JPEG: quality of the Independent JPEG Group with the nearest "
              "quantization table; every uncertainty is wider for it"},
    {FG_TEXT("note", fg_measurement, warning),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "what is odd about the file"},
    {FG_SHA256("model_sha256", fg_measurement, model_sha256),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "of the scanner's model that the edges were corrected by"},
    {FG_PAIR("dpi", fg_measurement, dpi), .words = "used: x, y"},
    {FG_PAIR("dpi_file", fg_measurement, file.dpi_file),
     .words = "as the file says, before it was snapped: x, y"},
};
static const fg_members file_members = FG_MEMBERS(file_rows);

#define OF_MEASUREMENT(members_)                                                                   \
  .kind = FG_MEMBER_SAME, .pointed = true, .offset = offsetof(judged_scan, measurement),           \
  .members = (members_)

static const fg_member input_rows[] = {
    {FG_STRING("path", judged_scan, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("sha256", find_sha256), .pattern = FG_SHA256_PATTERN,
     .words = "null: the file could not be measured, and nothing follows"},
    {OF_MEASUREMENT(&file_members), .present = has_measurement},
};
static const fg_members input_members = FG_MEMBERS_OF_FILE(input_rows, "input", "measure");

/* Results of one scan. */
static bool has_colour_lines(const fg_subject *subject) {
  return ((const fg_measurement *)subject->object)->colour_lines.seen;
}

static fg_subject find_colour_lines(const fg_subject *subject) {
  const fg_measurement *m = subject->object;
  return (fg_subject){.object = &m->colour_lines, .whole = m};
}

static const fg_member shown_rows[] = {
    {FG_FLAG("light_on_dark", fg_measurement, light_on_dark)},
    {FG_COUNT("specks", fg_measurement, specks),
     .words = "objects left alone: dust, scratches, other shapes"},
    {FG_PART("colour_lines", find_colour_lines, &fg_colour_lines_members),
     .present = has_colour_lines, .options = FG_MEMBER_NEVER_NULL,
     .words = "of a colour scan: where its channels show the same edges"},
    {FG_OBJECT("picture", fg_measurement, picture, &fg_picture_state_members),
     .words =
         "what a scanner's driver or the light has made of the picture, from its pixels beside "
         "edges; null: not known"},
    {FG_LIST_BY("gauges", fg_gauge_reading_at, &fg_gauge_reading_members),
     .words = "gauges that the design states, as found in the scan; null: not found"},
    {FG_FLAG("gauges_contradict", fg_measurement, gauges_contradict),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "the gauges differ by more than their uncertainties"},
    {FG_TEXT("tone_note", fg_measurement, tone_note),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "why the level of edges that the scanner's model holds was not applied"},
};
static const fg_members shown_members = FG_MEMBERS(shown_rows);

static bool has_members(const fg_subject *subject, const fg_members *members) {
  return fg_foil_view_of(((const judged_scan *)subject->object)->kind)->members == members;
}

static bool shows_strips(const fg_subject *subject) {
  return has_members(subject, &fg_foil_members);
}

static bool shows_flat_foils(const fg_subject *subject) {
  return has_members(subject, &fg_flat_foil_members);
}

static bool shows_grid(const fg_subject *subject) {
  return fg_foil_traits_of(((const judged_scan *)subject->object)->kind)->is_grid;
}

static bool shows_discs(const fg_subject *subject) {
  return !fg_foil_traits_of(((const judged_scan *)subject->object)->kind)->is_foil &&
         !shows_grid(subject);
}

static fg_subject find_grid(const fg_subject *subject) {
  const fg_measurement *m = ((const judged_scan *)subject->object)->measurement;
  return (fg_subject){.object = m->grid, .whole = m};
}

static bool find_judged_foil(const fg_subject *list, size_t i, fg_subject *element) {
  const judged_scan *scan = list->object;
  element->object = element->whole = &scan->foils[i];
  return i < scan->foil_count;
}

static bool find_judged_disc(const fg_subject *list, size_t i, fg_subject *element) {
  const judged_scan *scan = list->object;
  element->object = element->whole = &scan->discs[i];
  return i < scan->disc_count;
}

static const fg_member scan_value_rows[] = {
    {OF_MEASUREMENT(&shown_members)},
    {FG_LIST_BY("foils", find_judged_foil, &fg_foil_members), .present = shows_strips},
    {FG_LIST_BY("foils", find_judged_foil, &fg_flat_foil_members), .present = shows_flat_foils,
     .options = FG_MEMBER_EITHER},
    {FG_LIST_BY("discs", find_judged_disc, &fg_disc_members), .present = shows_discs,
     .words = "form discs only"},
    {FG_PART("grid", find_grid, &fg_grid_members), .present = shows_grid,
     .options = FG_MEMBER_NEVER_NULL, .words = "form grid only"},
};
static const fg_members scan_value_members = FG_MEMBERS(scan_value_rows);

static const fg_member scan_rows[] = {
    {FG_STRING("path", judged_scan, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("error", judged_scan, error),
     .words = "why it could not be measured; then nothing but the verdict is here"},
    {FG_VERDICT(judged_scan, verdict)},
    {FG_SAME(&scan_value_members), .present = has_measurement},
};
static const fg_members scan_members = FG_MEMBERS_OF_FILE(scan_rows, "scan", "measure");

/* The report. */
static const fg_report *report_of(const fg_subject *subject) {
  return ((const judged_report *)subject->object)->report;
}

static const fg_member count_rows[] = {
    {FG_COUNT("exceeded", fg_report_outcome, exceeded),
     .words = "values beyond a limit by more than U = 2 u"},
    {FG_COUNT("cannot_tell", fg_report_outcome, undecided),
     .words = "values with a limit within U"},
    {FG_COUNT("not_measured", fg_report_outcome, not_measured),
     .words = "scans, foils, bumps and values"},
    {FG_COUNT("rejected", fg_report_outcome, rejected),
     .words = "foils with bumps or beams missing or too many"},
};
static const fg_members count_members = FG_MEMBERS(count_rows);

static bool has_not_judged(const fg_subject *subject) {
  return fg_report_of_bearing(report_of(subject)->design, NULL, 0) > 0;
}

static const char *find_not_judged(const fg_subject *subject, size_t i) {
  const fg_design *design = report_of(subject)->design;
  if (i >= design->tolerance_count) return NULL;
  const char *quantity = design->tolerances[i].quantity;
  return fg_quantity_of_bearing_for(quantity) ? quantity : "";
}

static void write_model(fg_json *json, const char *name, const fg_subject *subject) {
  fg_json_scan_model(json, name, fg_report_model(report_of(subject)));
}

static void write_report_calibration(fg_json *json, const char *name, const fg_subject *subject) {
  (void)name;
  fg_json_report_calibration(json, report_of(subject));
}

static fg_subject find_design(const fg_subject *subject) {
  return (fg_subject){.object = report_of(subject)->design};
}

static bool has_nominal(const fg_subject *subject) {
  return fg_foil_kind_has_bumps(report_of(subject)->design->kind);
}

static fg_subject find_nominal(const fg_subject *subject) {
  return (fg_subject){.object = report_of(subject)->nominal};
}

/* One measured scan stands in the report itself. */
static bool is_of_one_scan(const fg_subject *subject) {
  const judged_report *r = subject->object;
  return r->scan_count == 1 && r->scans[0].measurement;
}

static bool is_of_several_scans(const fg_subject *subject) {
  return !is_of_one_scan(subject);
}

static fg_subject find_one_scan(const fg_subject *subject) {
  return (fg_subject){.object = ((const judged_report *)subject->object)->scans};
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/measure/1")},
    {FG_VERDICT(judged_report, outcome.verdict)},
    {FG_OBJECT("counts", judged_report, outcome, &count_members), .options = FG_MEMBER_ON_LINE,
     .words = "what the verdict rests on"},
    {FG_TEXTS_BY("not_judged", find_not_judged), .present = has_not_judged, .lowest = 1,
     .options = FG_MEMBER_ON_LINE,
     .words = "tolerances of a bearing, where the design states any: a scan has none, foilgauge "
              "lot judges them"},
    {FG_LIST("inputs", judged_report, scans, scan_count, &input_members), .lowest = 1,
     .words = "the files, in the order given"},
    {FG_SCAN_MODEL("model", write_model)},
    {FG_WRITTEN("calibration", write_report_calibration,
                FG_REF("design.schema.json#/$defs/calibration_used"))},
    {FG_TRACEABILITY(find_design)},
    {FG_PART("design", find_design, &fg_design_members), .schema = FG_REF("design.schema.json"),
     .options = FG_MEMBER_NEVER_NULL},
    {FG_PART("nominal", find_nominal, &fg_nominal_members), .present = has_nominal,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "what follows from the design (thesis eq 5.1, 5.2, 5.5, 5.8)"},
    {FG_SAME(&scan_value_members), .part = find_one_scan, .present = is_of_one_scan},
    {FG_LIST("scans", judged_report, scans, scan_count, &scan_members),
     .present = is_of_several_scans},
};
static const fg_members report_members = {
    .rows = report_rows,
    .count = sizeof report_rows / sizeof *report_rows,
    .limits = "{\"oneOf\": ["
              "{\"required\": [\"light_on_dark\", \"specks\", \"foils\"], "
              "\"not\": {\"required\": [\"scans\"]}}, "
              "{\"required\": [\"scans\"], \"not\": {\"required\": [\"foils\"]}}]}",
};

const fg_document fg_measure_document = {
    .file = "measure",
    .title = "foilgauge measure report",
    .description =
        "One scan: `foils` (and `discs`) stand in the report itself. Several scans: `scans` "
        "holds them, one each in the order given, and `inputs` runs parallel. Units are in "
        "the names; u_<name> is the standard uncertainty of <name>; null is a value that is "
        "not known.",
    .made_by = "`foilgauge measure --json`",
    .members = &report_members,
};

fg_status fg_judge_foil(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                        fg_judged *judged) {
  *judged = (fg_judged){.design = design, .foil = foil};
  FG_TRY(fg_foil_decide(ctx, design, foil, &judged->decision));
  if (!fg_foil_defect(design, foil, judged->defect, sizeof judged->defect)) judged->defect[0] = 0;
  return FG_OK;
}

fg_status fg_judge_disc(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                        fg_judged *judged) {
  *judged = (fg_judged){.design = design, .disc = disc};
  return fg_disc_decide(ctx, design, disc, &judged->decision);
}

static void write_judged(fg_json *json, const fg_members *members, fg_judged *judged) {
  const fg_member row = {.kind = FG_MEMBER_OBJECT, .members = members};
  fg_member_json(json, &row, &(fg_subject){.object = judged, .whole = judged});
  fg_decision_free(&judged->decision);
}

fg_status fg_json_foil(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_foil *foil) {
  fg_judged judged;
  FG_TRY(fg_judge_foil(ctx, design, foil, &judged));
  write_judged(json, fg_foil_view_of(design->kind)->members, &judged);
  return FG_OK;
}

fg_status fg_json_disc(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_disc *disc) {
  fg_judged judged;
  FG_TRY(fg_judge_disc(ctx, design, disc, &judged));
  write_judged(json, &fg_disc_members, &judged);
  return FG_OK;
}

/* Decisions on all scans. */
static fg_status judge_scan(fg_context *ctx, const fg_report *report, size_t i, judged_scan *to) {
  const fg_report_scan *scan = &report->scans[i];
  const fg_measurement *m = scan->measurement;
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
  *to = (judged_scan){.path = scan->path,
                      .error = m ? NULL : scan->error,
                      .measurement = m,
                      .verdict = outcome.verdict,
                      .kind = report->design->kind};
  if (!m) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, m->foil_count + 1, sizeof *to->foils, (void **)&to->foils));
  FG_TRY(fg_memory_allocate(ctx, m->disc_count + 1, sizeof *to->discs, (void **)&to->discs));
  for (; to->foil_count < m->foil_count; to->foil_count++)
    FG_TRY(
        fg_judge_foil(ctx, report->design, &m->foils[to->foil_count], &to->foils[to->foil_count]));
  for (; to->disc_count < m->disc_count; to->disc_count++)
    FG_TRY(
        fg_judge_disc(ctx, report->design, &m->discs[to->disc_count], &to->discs[to->disc_count]));
  return FG_OK;
}

static fg_status judge_report(fg_context *ctx, const fg_report *report, judged_report *to) {
  FG_TRY(fg_report_judge(ctx, report, &to->outcome));
  FG_TRY(fg_memory_allocate(ctx, report->scan_count + 1, sizeof *to->scans, (void **)&to->scans));
  to->scan_count = report->scan_count;
  for (size_t i = 0; i < report->scan_count; i++)
    FG_TRY(judge_scan(ctx, report, i, &to->scans[i]));
  return FG_OK;
}

static void free_judged_report(judged_report *judged) {
  for (size_t i = 0; i < judged->scan_count; i++) {
    judged_scan *scan = &judged->scans[i];
    for (size_t k = 0; k < scan->foil_count; k++)
      fg_decision_free(&scan->foils[k].decision);
    for (size_t k = 0; k < scan->disc_count; k++)
      fg_decision_free(&scan->discs[k].decision);
    free(scan->foils);
    free(scan->discs);
  }
  free(judged->scans);
}

fg_status fg_report_write_json(fg_context *ctx, const fg_report *report, FILE *out) {
  judged_report judged = {.report = report};
  fg_status status = judge_report(ctx, report, &judged);
  if (status == FG_OK) fg_document_json(out, &report_members, &judged);
  free_judged_report(&judged);
  FG_TRY(status);
  return fg_stream_finish(ctx, out, "the JSON report");
}
