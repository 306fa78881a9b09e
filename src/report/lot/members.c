/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lot.json: "schema": "foilgauge/lot/1", of its parts. */
#include "report/lot/members.h"

#include <math.h>

#include "core/file.h"
#include "foilgauge/foil_kind.h"
#include "lot/input/reference_curve.h"
#include "report/design/members.h"
#include "report/film/members.h"
#include "report/lot/files.h"
#include "report/lot/parts_members.h"
#include "report/measure/scan_model_words.h"
#include "report/verdict_members.h"

static const fg_lot_analysis *analysis_of(const fg_subject *subject) {
  return subject->whole;
}

/* Members of the analysis' lot, among those of the analysis. */
#define OF_LOT(members)                                                                            \
  { FG_SAME(members), .offset = offsetof(fg_lot_analysis, lot), .pointed = true }

static bool has_bumps(const fg_subject *subject) {
  return fg_foil_kind_has_bumps(analysis_of(subject)->lot->settings.design.kind);
}

/* Head. */
#define DATE_PATTERN "^[0-9]{4}-[0-9]{2}-[0-9]{2}(T[0-9]{2}:[0-9]{2})?$"

static const char *const date_sources[] = {FG_LOT_DATE_MANIFEST, FG_LOT_DATE_SCANS, NULL};

static const fg_member date_rows[] = {
    {FG_TEXT("first", fg_lot_analysis, date.first), .options = FG_MEMBER_EMPTY_IS_NULL,
     .pattern = DATE_PATTERN},
    {FG_TEXT("last", fg_lot_analysis, date.last), .options = FG_MEMBER_EMPTY_IS_NULL,
     .pattern = DATE_PATTERN},
    {FG_STRING("from", fg_lot_analysis, date.from), .choices = date_sources,
     .words = "`manifest`: its column `date`; `scans`: the times of the scans' files (UTC)"},
    {FG_COUNT("cells_not_dates", fg_lot_analysis, invalid_dates.count), .lowest = 1,
     .options = FG_MEMBER_EMPTY_IS_NULL | FG_MEMBER_LEFT_OUT,
     .words = "cells of the manifest's column `date` that are no date: the column is not taken"},
};
static const fg_members date_members = FG_MEMBERS(date_rows);

static double count_scans(const fg_subject *subject) {
  return (double)analysis_of(subject)->lot->manifest.items;
}

#define VERDICT_COUNT(name, verdict)                                                               \
  { FG_COUNT(name, fg_lot_analysis, by_verdict[verdict]), .words = "foils of this verdict" }

static const fg_member count_rows[] = {
    {FG_COUNT_BY("scans", count_scans)},
    {FG_COUNT("scans_not_measured", fg_lot_analysis, failed_scans)},
    {FG_COUNT("scans_repeated", fg_lot_analysis, repeated.count),
     .words = "scans with the bytes of an earlier one under another name; among "
              "scans_not_measured"},
    {FG_COUNT("foils", fg_lot_analysis, foil_count)},
    {FG_COUNT("foils_scanned_again", fg_lot_analysis, scanned_again),
     .words = "of them, scans of a foil that an earlier scan shows (the recipe's part_column): "
              "statistics count each foil once, by the mean of its scans"},
    {FG_COUNT("bumps", fg_lot_analysis, part_count), .present = fg_lot_has_no_beams},
    {FG_COUNT("beams", fg_lot_analysis, part_count), .present = fg_lot_has_beams,
     .words = "of a cantilever, instead of bumps"},
    {FG_COUNT("bumps_crushed", fg_lot_analysis, left_out), .present = fg_lot_has_no_beams,
     .words = "of them: judged, and left out of statistics, stiffness and clearances"},
    {FG_COUNT("beams_damaged", fg_lot_analysis, left_out), .present = fg_lot_has_beams,
     .words = "of them, torn, bent or hidden: judged, and left out of the statistics"},
    VERDICT_COUNT("pass", FG_VERDICT_PASS),
    VERDICT_COUNT("fail", FG_VERDICT_FAIL),
    VERDICT_COUNT("cannot_tell", FG_VERDICT_UNDECIDED),
    VERDICT_COUNT("not_measured", FG_VERDICT_NOT_MEASURED),
    VERDICT_COUNT("no_tolerance", FG_VERDICT_NONE),
    {FG_COUNT("exceeded", fg_lot_analysis, exceeded),
     .words = "foils with a value beyond a limit by more than U"},
    {FG_COUNT("rejected", fg_lot_analysis, outcome.rejected),
     .words = "foils with bumps missing or too many"},
};
static const fg_members count_members = FG_MEMBERS(count_rows);

static const fg_member name_rows[] = {
    {FG_TEXT("name", fg_lot, settings.name), .words = "of the lot"},
};
static const fg_members name_members = FG_MEMBERS(name_rows);

static void write_model(fg_json *json, const char *name, const fg_subject *subject) {
  fg_json_scan_model(json, name, analysis_of(subject)->lot->model);
}

static void write_correction(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_correction max = fg_lot_correction_largest(analysis_of(subject));
  (void)name;
  fg_json_correction(json, &max);
}

static fg_subject find_calibration(const fg_subject *subject) {
  const fg_calibration *calibration = &analysis_of(subject)->lot->settings.design.calibration;
  return (fg_subject){.object = calibration->stated ? calibration : NULL};
}

static fg_subject find_lot_design(const fg_subject *subject) {
  return (fg_subject){.object = &analysis_of(subject)->lot->settings.design};
}

static const fg_member provenance_rows[] = {
    {FG_SHA256("recipe_sha256", fg_lot, head.recipe_sha256)},
    {FG_SHA256("manifest_sha256", fg_lot, head.manifest_sha256)},
    {FG_SHA256("model_sha256", fg_lot, settings.model_sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "of the scanner's model that corrected every scan; null: none"},
    {FG_WRITTEN("model", write_model, FG_REF("measure.schema.json#/$defs/model")),
     .options = FG_MEMBER_LEFT_OUT},
    {FG_WRITTEN("correction", write_correction, FG_REF("measure.schema.json#/$defs/correction")),
     .options = FG_MEMBER_LEFT_OUT, .words = "the largest over the foils"},
    {FG_PART("calibration", find_calibration, &fg_calibration_used_members),
     .schema = FG_REF("design.schema.json#/$defs/calibration_used")},
    {FG_TRACEABILITY(find_lot_design)},
    {FG_OBJECT("design", fg_lot, settings.design, &fg_design_members),
     .schema = FG_REF("design.schema.json")},
    {FG_OBJECT("nominal", fg_lot, nominal, &fg_nominal_members), .present = has_bumps,
     .schema = FG_REF("measure.schema.json#/$defs/nominal")},
};
static const fg_members provenance_members = FG_MEMBERS(provenance_rows);

/* Inputs. */
static bool find_input(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot *lot = analysis_of(list)->lot;
  element->object = &lot->records[i];
  return i < lot->manifest.items;
}

static double find_repeated(const fg_subject *subject) {
  const fg_record *record = subject->object;
  return record->repeat_of ? (double)record->repeat_of - 1 : NAN;
}

static const fg_member input_rows[] = {
    {FG_STRING("path", fg_record, scan), .options = FG_MEMBER_NEVER_NULL},
    {FG_SHA256("sha256", fg_record, sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "null: the scan could not be read"},
    {FG_STRING("error", fg_record, error), .words = "reason why it could not be measured"},
    {FG_COUNT_BY("repeat_of", find_repeated), .options = FG_MEMBER_LEFT_OUT,
     .words = "index of the earlier input with the same bytes, which counts; this one was not "
              "measured"},
};
static const fg_members input_members = FG_MEMBERS_DEFINED(input_rows, "input");

/* Quantities, groups and dies. */
static bool find_lot_quantity(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = analysis_of(list);
  element->object = &analysis->quantities[i];
  return i < analysis->quantity_count;
}

static const char *find_quantity_key(const fg_subject *subject) {
  return ((const fg_lot_quantity *)subject->object)->row->name;
}

static bool find_worst(const fg_subject *list, size_t i, fg_subject *element) {
  if (i >= FG_LOT_WORST) return false;
  element->object = analysis_of(list)->worst[i];
  return true;
}

static bool has_correlation(const fg_subject *subject) {
  return analysis_of(subject)->has_correlation;
}

#define CORRELATION(name, field, words_)                                                           \
  { FG_NUMBER(name, fg_lot_correlation, field), .words = (words_) }

static const fg_member correlation_rows[] = {
    {FG_COUNT("count", fg_lot_correlation, count), .words = "bumps"},
    {FG_COUNT("trimmed", fg_lot_correlation, trimmed), .words = "of them, by their radius"},
    {FG_COUNT("foils", fg_lot_correlation, foils),
     .words = "that the bumps of the lines come from"},
    CORRELATION("r", r, "of the errors of radius and angle"),
    CORRELATION("slope", slope, "of the angle's error over the radius'"),
    CORRELATION("intercept_pct", intercept, NULL),
    CORRELATION("log_slope", log_slope, "of the logarithms: -1 exactly at a constant arc length"),
    CORRELATION("log_slope_low", log_low, "end of its interval"),
    CORRELATION("log_slope_high", log_high, "end of its interval"),
    CORRELATION("log_slope_freedom", log_dof,
                "degrees of freedom of the interval of log_slope: bumps come in foils; null where "
                "foils are too few for one"),
    CORRELATION("arc_length_mean_pct", arc_length_mean_pct, "error of all bumps' arc length"),
    CORRELATION("arc_length_sd_pct", arc_length_sd_pct, "its standard deviation"),
};
static const fg_members correlation_members = FG_MEMBERS(correlation_rows);

static double find_design_thickness(const fg_subject *subject) {
  return analysis_of(subject)->lot->settings.design.thickness_mm;
}

static const fg_member thickness_rows[] = {
    {FG_COUNT("foils", fg_lot_analysis, thickness.foils), .words = "with a thickness"},
    {FG_NUMBER_U("mean_mm", fg_lot_analysis, thickness.mean.mm, thickness.mean.u_mm),
     .words = "its u is that of one foil, for all share the scanner's tone curve"},
    {FG_NUMBER_BY("design_mm", find_design_thickness), .options = FG_MEMBER_NEVER_NULL},
    {FG_FLAG("differs", fg_lot_analysis, thickness.differs),
     .words = "from the design's by more than 2 u"},
};
static const fg_members thickness_members = FG_MEMBERS(thickness_rows);

static bool has_dies(const fg_subject *subject) {
  return analysis_of(subject)->dies.count > 0;
}

static bool has_curve(const fg_subject *subject) {
  return analysis_of(subject)->lot->settings.curve.count > 0;
}

static const fg_member curve_rows[] = {
    {FG_OBJECT("reference_curve", fg_lot, settings.curve, &fg_reference_curve_members),
     .present = has_curve, .words = "what a simulation or a die says of the errors of every bump"},
};
static const fg_members curve_members = FG_MEMBERS(curve_rows);

static bool has_assembly(const fg_subject *subject) {
  return has_bumps(subject) && analysis_of(subject)->assembly.asked;
}

static bool has_film(const fg_subject *subject) {
  return analysis_of(subject)->lot->settings.film.load_n > 0;
}

/* The film's rows take the film for the whole. */
static void write_film(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_film_report *film = analysis_of(subject)->film;
  const fg_member row = {
      .name = name, .kind = FG_MEMBER_OBJECT, .pointed = true, .members = &fg_film_of_lot_members};
  fg_member_json(json, &row, &(fg_subject){.object = &film, .whole = film});
}

static const fg_member analysis_rows[] = {
    {FG_HEAD("foilgauge/lot/1")},
    OF_LOT(&name_members),
    {FG_GROUP("date", &date_members), .options = FG_MEMBER_ON_LINE,
     .words = "of the lot: earliest and latest; null: not known"},
    {FG_VERDICT(fg_lot_analysis, outcome.verdict)},
    {FG_GROUP("counts", &count_members)},
    {FG_GROUP("process", &fg_lot_process_members),
     .words = "state of the process in the quantities that the release of the lot rests on: those "
              "with a tolerance, else those that the page charts"},
    OF_LOT(&provenance_members),
    {FG_LIST_BY("inputs", find_input, &input_members), .options = FG_MEMBER_ON_LINE,
     .words = "scans in the order of the manifest"},
    {FG_LIST("foils", fg_lot_analysis, foils, foil_count, &fg_lot_foil_members),
     .options = FG_MEMBER_ON_LINE, .words = "in the order of the manifest"},
    {FG_LIST_BY("worst", find_worst, &fg_lot_foil_members), .options = FG_MEMBER_ON_LINE,
     .highest = FG_LOT_WORST, .words = "foils of the worst verdict, then the highest severity"},
    {FG_MAP_BY("quantities", find_lot_quantity, find_quantity_key, &fg_lot_quantity_members),
     .words = "under the names of a measure report"},
    {FG_OBJECT("correlation", fg_lot_analysis, correlation, &correlation_members),
     .present = has_correlation, .words = "errors of radius and angle, trimmed by the radius"},
    {FG_GROUP("thickness", &thickness_members),
     .words = "of the strips: what clearances and stiffness rest on"},
    {FG_OBJECT("stiffness", fg_lot_analysis, stiffness, &fg_lot_stiffness_members),
     .present = has_bumps, .words = "of the bumps; missing where the design's form has none"},
    {FG_SAME(&fg_lot_bearing_members), .present = has_bumps},
    {FG_OBJECT("dies", fg_lot_analysis, dies, &fg_lot_dies_members), .present = has_dies,
     .words = "where the recipe names dies (reports of foilgauge die): springback against the die "
              "beside that against the design"},
    OF_LOT(&curve_members),
    {FG_OBJECT("assembly", fg_lot_analysis, assembly, &fg_lot_assembly_members),
     .present = has_assembly,
     .words = "bearings drawn from the foils that can be built in: recipe's assembly"},
    {FG_GROUP("film", &fg_film_of_lot_members), .write = write_film, .options = FG_MEMBER_NULLABLE,
     .present = has_film,
     .words = "gas film of such bearings, and the rotor's threshold: recipe's film; null: none was "
              "found"},
    {FG_LIST("comparisons", fg_lot_analysis, differences, difference_count,
             &fg_lot_difference_members),
     .words = "groups against each other"},
    {FG_LIST("gauge_studies", fg_lot_analysis, gauges, gauge_count, &fg_lot_gauge_members),
     .options = FG_MEMBER_ON_LINE, .words = "repeatability and reproducibility"},
};
static const fg_members analysis_members = {
    .rows = analysis_rows,
    .count = sizeof analysis_rows / sizeof *analysis_rows,
    .limits =
        "{\"if\": {\"properties\": {\"design\": {\"properties\": {\"form\": {\"enum\": [\"arc\", "
        "\"cantilever\"]}}}}}, \"else\": {\"required\": [\"nominal\", \"stiffness\", "
        "\"bearing_layout\", \"bearings_assumed\", \"bearings\"]}}",
};

const fg_document fg_lot_document = {
    .file = "lot",
    .title = "foilgauge lot report",
    .description = "Units are in the names; a quantity's are those of a measure report. null is a "
                   "value that is not known.",
    .made_by = "`foilgauge lot`, as lot.json,",
    .members = &analysis_members,
};

fg_status fg_lot_write_json(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  fg_document_json(out, &analysis_members, analysis);
  return fg_stream_finish(ctx, out, "lot.json");
}
