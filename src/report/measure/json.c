/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/json.h"
#include "report/flag_names.h"
#include "report/measure/foil_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "quantity/parts.h"
#include "report/correction_words.h"
#include "report/design/calibration_json.h"
#include "report/design/json.h"
#include "report/measure/colour_lines_report.h"
#include "report/measure/gauge_report.h"
#include "report/measure/picture_report.h"
#include "report/measure/scan_model_words.h"
#include "report/measure/uncertainty_budget.h"
#include "report/quantity_json.h"

/* One member of `inputs`. */
static void write_input(fg_json *json, const fg_report_scan *scan) {
  const fg_measurement *measurement = scan->measurement;
  fg_json_object(json, NULL);
  fg_json_string(json, "path", scan->path);
  fg_json_string(json, "sha256", measurement ? measurement->sha256 : NULL);
  if (measurement) {
    fg_json_integer(json, "width_px", measurement->width_px);
    fg_json_integer(json, "height_px", measurement->height_px);
    fg_json_integer(json, "bit_depth", measurement->bit_depth);
    if (measurement->format[0]) fg_json_string(json, "format", measurement->format);
    fg_json_string(json, "channel",
                   measurement->colour ? fg_channel_word(measurement->channel) : "gray");
    if (measurement->jpeg_quality) fg_json_integer(json, "jpeg_quality", measurement->jpeg_quality);
    if (measurement->warning[0]) fg_json_string(json, "note", measurement->warning);
    if (measurement->model_sha256[0])
      fg_json_string(json, "model_sha256", measurement->model_sha256);
    fg_json_numbers(json, "dpi", measurement->dpi, 2);
    fg_json_numbers(json, "dpi_file", measurement->dpi_file, 2);
  }
  fg_json_object_end(json);
}

/* Writes the flags of a foil or its part, and the findings of its picture. */
static void write_flags(fg_json *json, const fg_flag_words *words, unsigned flags,
                        unsigned findings) {
  fg_json_array(json, "flags");
  fg_json_line(json);
  fg_json_flag_names(json, words, flags, findings);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

static void write_covariance(fg_json *json, const double covariance[3][3]) {
  fg_json_array(json, "covariance_mm2");
  fg_json_line(json);
  for (int i = 0; i < 3; i++)
    fg_json_numbers(json, NULL, covariance[i], 3);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

/* Only where a loop left a tie. */
static void write_range(fg_json *json, const char *name, const double range[2]) {
  if (range[0] != 0 || range[1] != 0) fg_json_numbers(json, name, range, 2);
}

static void write_bump(fg_json *json, const fg_design *design, const fg_foil *foil,
                       const fg_bump *bump) {
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", bump->number);
  write_flags(json, fg_bump_flag_words(), fg_bump_flags(design, foil, bump), 0);
  fg_json_string(json, "verdict", fg_verdict_word(fg_bump_verdict(design, foil, bump)));
  fg_json_quantities(json, FG_QUANTITY_OF_BUMP, "", bump, true);
  write_covariance(json, bump->covariance);
  write_range(json, "radius_range_mm", bump->radius_range_mm);
  write_range(json, "height_range_mm", bump->height_range_mm);
  fg_json_object_end(json);
}

static void write_judgement(fg_json *json, const fg_judgement *judgement, const char *owner) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "quantity", judgement->tolerance->quantity);
  if (judgement->number) fg_json_integer(json, owner, judgement->number);
  fg_json_number(json, "value", judgement->value);
  fg_json_number(json, "u", judgement->u);
  fg_json_number(json, "min", judgement->tolerance->lower);
  fg_json_number(json, "max", judgement->tolerance->upper);
  fg_json_bool(json, "exceeded", judgement->exceeded);
  if (judgement->missing) fg_json_bool(json, "missing", true);
  fg_json_string(json, "verdict", fg_verdict_word(judgement->verdict));
  if (judgement->cure) fg_json_string(json, "cure", judgement->cure);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

/* `in_tolerance` is true for a pass alone: a reader who takes it for a boolean accepts nothing
 * that was not seen to pass. */
void fg_json_verdict(fg_json *json, fg_verdict verdict) {
  if (verdict == FG_VERDICT_NONE)
    fg_json_string(json, "in_tolerance", NULL);
  else
    fg_json_bool(json, "in_tolerance", verdict == FG_VERDICT_PASS);
  fg_json_string(json, "verdict", fg_verdict_word(verdict));
}

static void write_counts(fg_json *json, const fg_report_outcome *outcome) {
  fg_json_object(json, "counts");
  fg_json_line(json);
  fg_json_integer(json, "exceeded", (int64_t)outcome->exceeded);
  fg_json_integer(json, "cannot_tell", (int64_t)outcome->undecided);
  fg_json_integer(json, "not_measured", (int64_t)outcome->not_measured);
  fg_json_integer(json, "rejected", (int64_t)outcome->rejected);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

void fg_json_judgements(fg_json *json, const fg_decision *decision, const char *owner) {
  fg_json_array(json, "judgements");
  for (size_t i = 0; i < decision->count; i++)
    write_judgement(json, &decision->judgements[i], owner);
  fg_json_array_end(json);
}

static void write_strip(fg_json *json, const fg_strip *strip) {
  fg_json_object(json, "strip");
  fg_json_quantities(json, FG_QUANTITY_OF_STRIP, "", strip, strip->count > 0);
  double box[4];
  for (int i = 0; i < 4; i++)
    box[i] = (double)strip->box_px[i];
  fg_json_numbers(json, "box_px", box, 4);
  fg_json_object_end(json);
}

static void write_beam(fg_json *json, const fg_design *design, const fg_foil *foil,
                       const fg_beam *beam) {
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", beam->number);
  write_flags(json, fg_beam_flag_words(), fg_beam_flags(design, foil, beam), 0);
  fg_json_string(json, "verdict", fg_verdict_word(fg_beam_verdict(design, foil, beam)));
  fg_json_quantities(json, FG_QUANTITY_OF_BEAM, "", beam, true);
  fg_json_numbers(json, "root_mm", (const double[]){beam->root_mm.x, beam->root_mm.y}, 2);
  fg_json_numbers(json, "tip_mm", (const double[]){beam->tip_mm.x, beam->tip_mm.y}, 2);
  fg_json_object_end(json);
}

/* Writes the values that a flat foil shares with others, and its beams. */
void fg_values_json_of_beams(fg_json *json, const fg_design *design, const fg_foil *foil) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_FOIL, &count);
  for (size_t i = 0; i < count; i++)
    if (fg_quantity_applies(FG_QUANTITY_OF_FOIL, &rows[i], design->kind))
      fg_json_number(json, rows[i].name, fg_quantity_value(&rows[i], foil));
  fg_json_number(json, "thickness_design_mm", design->thickness_mm);
  fg_json_array(json, "beams");
  for (size_t i = 0; i < foil->beam_count; i++)
    write_beam(json, design, foil, &foil->beams[i]);
  fg_json_array_end(json);
}

void fg_values_json_of_strip(fg_json *json, const fg_design *design, const fg_foil *foil) {
  const char *own = fg_foil_view_of(design->kind)->own;
  bool turns =
      !(foil->flags & FG_FOIL_NOT_MEASURED) && !fg_foil_traits_of(design->kind)->is_plain_strip;
  fg_json_string(json, "orientation", turns ? fg_orientation_word(foil->orientation) : NULL);
  fg_json_quantities(json, FG_QUANTITY_OF_FOIL, "", foil, true);
  const fg_thickness strip = fg_foil_thickness(design, foil);
  fg_json_string(json, "thickness_by", design->thickness_measured_mm > 0 ? "statement" : "scan");
  fg_json_number(json, "thickness_design_mm", design->thickness_mm);
  fg_json_bool(json, "thickness_differs", fg_thickness_differs(design, &strip));
  fg_json_object(json, "overall");
  fg_json_quantities(json, FG_QUANTITY_OF_FOIL, "overall.", foil, true);
  write_covariance(json, foil->overall.covariance);
  write_range(json, "radius_range_mm", foil->overall.radius_range_mm);
  fg_json_object_end(json);
  if (own) {
    char prefix[32];
    snprintf(prefix, sizeof prefix, "%s.", own);
    fg_json_object(json, own);
    fg_json_quantities(json, FG_QUANTITY_OF_FOIL, prefix, foil, true);
    fg_json_object_end(json);
  }
  fg_json_correction(json, &foil->correction);
  fg_json_choices(json, foil);
  write_strip(json, &foil->strip);
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < foil->bump_count; i++)
    write_bump(json, design, foil, &foil->bumps[i]);
  fg_json_array_end(json);
}

fg_status fg_json_foil(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_foil *foil) {
  fg_decision decision;
  char defect[200];
  FG_TRY(fg_foil_decide(ctx, design, foil, &decision));
  bool rejected = fg_foil_defect(design, foil, defect, sizeof defect);
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", foil->number);
  write_flags(json, fg_foil_flag_words(), foil->flags, foil->strip.picture.findings);
  fg_json_numbers(json, "place_mm", foil->place_mm, 4);
  fg_json_string(json, "error", foil->error[0] ? foil->error : NULL);
  fg_json_verdict(json, decision.outcome.verdict);
  fg_json_string(json, "defect", rejected ? defect : NULL);
  const char *part = fg_part_word(fg_foil_kind_parts(design->kind));
  if (fg_foil_is_measured(foil)) fg_json_judgements(json, &decision, part);
  fg_foil_view_of(design->kind)->values_json(json, design, foil);
  fg_json_object_end(json);
  fg_decision_free(&decision);
  return FG_OK;
}

fg_status fg_json_disc(fg_context *ctx, fg_json *json, const fg_design *design,
                       const fg_disc *disc) {
  fg_decision decision;
  FG_TRY(fg_disc_decide(ctx, design, disc, &decision));
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", disc->number);
  write_flags(json, fg_bump_flag_words(), fg_disc_flags(design, disc), disc->picture.findings);
  fg_json_bool(json, "hole", disc->hole);
  fg_json_bool(json, "bright", disc->bright);
  fg_json_verdict(json, decision.outcome.verdict);
  fg_json_judgements(json, &decision, "disc");
  fg_json_quantities(json, FG_QUANTITY_OF_DISC, "", disc, true);
  write_covariance(json, disc->covariance);
  write_range(json, "radius_range_mm", disc->radius_range_mm);
  fg_json_disc_choice(json, disc);
  fg_json_object_end(json);
  fg_decision_free(&decision);
  return FG_OK;
}

/* The members that one scan gives: of the report itself, or of one of `scans`. */
static fg_status write_scan(fg_context *ctx, fg_json *json, const fg_report *report,
                            const fg_measurement *measurement) {
  fg_json_bool(json, "light_on_dark", measurement->light_on_dark);
  fg_json_integer(json, "specks", (int64_t)measurement->specks);
  fg_json_colour_lines(json, measurement);
  fg_json_picture_state(json, measurement);
  fg_json_gauges(json, measurement);
  if (measurement->tone_note[0]) fg_json_string(json, "tone_note", measurement->tone_note);
  fg_json_array(json, "foils");
  for (size_t i = 0; i < measurement->foil_count; i++)
    FG_TRY(fg_json_foil(ctx, json, report->design, &measurement->foils[i]));
  fg_json_array_end(json);
  if (fg_foil_traits_of(report->design->kind)->is_foil) return FG_OK;
  fg_json_array(json, "discs");
  for (size_t i = 0; i < measurement->disc_count; i++)
    FG_TRY(fg_json_disc(ctx, json, report->design, &measurement->discs[i]));
  fg_json_array_end(json);
  return FG_OK;
}

static fg_status write_scans(fg_context *ctx, fg_json *json, const fg_report *report) {
  fg_json_array(json, "scans");
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_report_scan *scan = &report->scans[i];
    fg_report_outcome outcome;
    FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
    fg_json_object(json, NULL);
    fg_json_string(json, "path", scan->path);
    fg_json_string(json, "error", scan->measurement ? NULL : scan->error);
    fg_json_verdict(json, outcome.verdict);
    if (scan->measurement) FG_TRY(write_scan(ctx, json, report, scan->measurement));
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  return FG_OK;
}

/* Tolerances of a bearing, where the design states any: a scan has none. */
static void write_not_judged(fg_json *json, const fg_design *design) {
  if (!fg_report_of_bearing(design, NULL, 0)) return;
  fg_json_array(json, "not_judged");
  fg_json_line(json);
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (fg_quantity_of_bearing_for(design->tolerances[i].quantity))
      fg_json_string(json, NULL, design->tolerances[i].quantity);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

fg_status fg_report_write_json(fg_context *ctx, const fg_report *report, FILE *out) {
  fg_report_outcome outcome;
  fg_json json;
  FG_TRY(fg_report_judge(ctx, report, &outcome));
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/measure/1");
  fg_json_verdict(&json, outcome.verdict);
  write_counts(&json, &outcome);
  write_not_judged(&json, report->design);
  fg_json_array(&json, "inputs");
  for (size_t i = 0; i < report->scan_count; i++)
    write_input(&json, &report->scans[i]);
  fg_json_array_end(&json);
  fg_json_scan_model(&json, "model", fg_report_model(report));
  fg_json_report_calibration(&json, report);
  fg_json_design(&json, "design", report->design);
  if (fg_foil_kind_has_bumps(report->design->kind))
    fg_json_nominal(&json, "nominal", report->nominal);
  if (report->scan_count == 1 && report->scans[0].measurement)
    FG_TRY(write_scan(ctx, &json, report, report->scans[0].measurement));
  else
    FG_TRY(write_scans(ctx, &json, report));
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the JSON report");
}
