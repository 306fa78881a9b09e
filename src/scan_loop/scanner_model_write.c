/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writer of a scanner's model file, "foilgauge/scan-model/1" (reports/schema); the reader is
 * scanner_model_file.c. */
#include <string.h>
#include <time.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "core/memory.h"
#include "core/text.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

/* ---- the model of a loop ---- */

static void format_date(int64_t seconds, char text[FG_MODEL_DATE]) {
  time_t at = (time_t)seconds;
  struct tm utc;
  text[0] = 0;
  if (seconds && gmtime_r(&at, &utc)) strftime(text, FG_MODEL_DATE, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

/* Returns the number of known diameters that determined the absolute scale; 0 where they could not
 * have detected an error of it. */
static size_t known_diameters(const fg_scan_loop *loop) {
  for (size_t e = 0; e < loop->set.count; e++)
    if (loop->set.effects[e].kind->scales) return loop->edge_fit.known_count;
  for (size_t i = 0; i < loop->result.unclaimeds; i++)
    if (fg_effect_find(loop->result.unclaimed[i].id)->scales &&
        loop->result.unclaimed[i].verdict == FG_LOOP_ABSENT)
      return loop->edge_fit.known_count;
  return 0;
}

fg_status fg_scanner_model_of(fg_context *ctx, const fg_scan_loop *loop, fg_scanner_model **model) {
  fg_scanner_model *made = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  if (loop->options.scanner)
    fg_text_clip(made->scanner, sizeof made->scanner, "%s", loop->options.scanner);
  format_date(loop->options.date, made->date);
  const fg_measurement *first = &loop->before[0];
  for (int axis = 0; axis < 2; axis++) /* resolution stated by the scan */
    made->dpi[axis] = first->dpi[axis] * fg_calibration_factor(&first->design.calibration);
  made->scans = loop->scan_count;
  made->known_diameters = known_diameters(loop);
  made->tone = loop->tone;
  fg_effect_set_fields(&loop->edge_fit, &loop->set, &made->fields);
  for (size_t k = 0; k < loop->tie_count; k++)
    if (!loop->unlikely[k])
      fg_effect_set_fields(&loop->edge_fit, &loop->tie[k], &made->other[made->others++]);
  made->tied = made->others > 0;
  *model = made;
  return FG_OK;
}

/* ---- the file ---- */

static void write_fields(fg_json *json, const char *name, const fg_field_list *list) {
  fg_json_array(json, name);
  for (size_t i = 0; i < list->count; i++) {
    const fg_field *f = &list->fields[i];
    fg_json_object(json, NULL);
    fg_json_string(json, "id", f->id);
    fg_json_numbers(json, "amplitude_mm", f->amplitude_mm, f->columns);
    fg_json_numbers(json, "u_amplitude_mm", f->u_amplitude_mm, f->columns);
    fg_json_numbers(json, "shape", f->shape, f->shapes);
    fg_json_numbers(json, "u_shape", f->u_shape, f->shapes);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_model_inputs(fg_json *json, const fg_scan_result *result) {
  fg_json_array(json, "inputs");
  for (size_t i = 0; i < result->scans; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "path", result->scan[i].before->scan);
    fg_json_string(json, "sha256", result->scan[i].before->sha256);
    fg_json_bool(json, "hold_out", result->scan[i].hold_out);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* Refuses a model that the reader would refuse. */
static fg_status check_readable(fg_context *ctx, const fg_scanner_model *model) {
  fg_context inner = {.message = ""};
  fg_status status = fg_scanner_model_check_place(&inner, model->dpi, &model->fields.frame);
  if (status == FG_OK) status = fg_scanner_model_check_fields(&inner, "fields", &model->fields);
  for (size_t k = 0; k < model->others && status == FG_OK; k++)
    status = fg_scanner_model_check_fields(&inner, "alternatives", &model->other[k]);
  if (status == FG_OK) return FG_OK;
  return fg_fail(ctx, status, "what was found is no model of a scanner, and is not written: %.600s",
                 inner.message);
}

/* Refuses pictures with findings that distort edges in a way that no model describes: the
 * distortion would be applied to every scan. Rows that jump are allowed: a step of the carriage is
 * an effect that the loop finds. So is a profile that no tone curve explains: it is the same for
 * all edges, and known diameters determine its level. */
static fg_status check_pictures(fg_context *ctx, const fg_scan_loop *loop) {
  const unsigned spoiling =
      FG_PICTURE_CLIPPED | FG_PICTURE_FEW_LEVELS | FG_PICTURE_SHADOW | FG_PICTURE_BLOCK_NOISE;
  for (size_t i = 0; i < loop->scan_count; i++)
    for (const fg_picture_words *words = fg_picture_finding_words(); words->name; words++)
      if (loop->before[i].picture.findings & words->finding & spoiling)
        return fg_fail(
            ctx, FG_ERR_DATA,
            "no model is written: %.120s: %s: %s A model of it would carry that to every "
            "scan. %s",
            loop->before[i].scan, words->name, words->meaning, words->cure);
  return FG_OK;
}

static void write_place(fg_json *json, const fg_scanner_model *model) {
  const fg_field_frame *frame = &model->fields.frame;
  fg_json_numbers(json, "dpi", model->dpi, 2);
  fg_json_numbers(
      json, "region_mm",
      (double[]){frame->low_mm[0], frame->low_mm[1], frame->high_mm[0], frame->high_mm[1]}, 4);
  fg_json_numbers(
      json, "curve_mm",
      (double[]){frame->first_mm[0], frame->first_mm[1], frame->last_mm[0], frame->last_mm[1]}, 4);
  fg_json_integer(json, "curve_knots", (int64_t)frame->knots);
}

fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  const fg_scanner_model *model = loop->result.model;
  fg_json json;
  FG_TRY(check_pictures(ctx, loop));
  FG_TRY(check_readable(ctx, model));
  fg_json_begin(&json, out);
  json.exact = true; /* a model that is read corrects as the loop did */
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/scan-model/1");
  fg_json_string(&json, "scanner", model->scanner[0] ? model->scanner : NULL);
  fg_json_string(&json, "date", model->date[0] ? model->date : NULL);
  fg_json_string(&json, "level", "points");
  write_place(&json, model);
  write_model_inputs(&json, &loop->result);
  fg_json_integer(&json, "known_diameters", (int64_t)model->known_diameters);
  fg_model_tone_write(&json, &model->tone);
  fg_json_bool(&json, "tied", model->tied);
  write_fields(&json, "fields", &model->fields);
  fg_json_array(&json, "alternatives");
  for (size_t k = 0; k < model->others; k++)
    write_fields(&json, NULL, &model->other[k]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the model");
}
