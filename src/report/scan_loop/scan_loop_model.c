/* The model of a scanner as a file: "foilgauge/scan-model/1". */
#include <string.h>
#include <time.h>

#include "core/file.h"
#include "report/measure/measure_json.h"
#include "report/words.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

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

static void write_inputs(fg_json *json, const fg_scan_loop *loop) {
  fg_json_array(json, "inputs");
  for (size_t i = 0; i < loop->scan_count; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "path", loop->before[i].scan);
    fg_json_string(json, "sha256", loop->before[i].sha256);
    fg_json_bool(json, "hold_out", loop->hold_out[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* The explanation in force, and those that were tied with it. */
typedef struct explanations {
  fg_field_list fields, other[FG_EXPLANATIONS_MAX];
  size_t others;
} explanations;

/* What the reader would refuse is no model. */
static fg_status check(fg_context *ctx, const fg_scan_loop *loop, const explanations *all) {
  fg_context inner = {.message = ""};
  fg_status status = fg_scanner_model_check_place(&inner, loop->before[0].dpi, &all->fields.frame);
  if (status == FG_OK) status = fg_scanner_model_check_fields(&inner, "fields", &all->fields);
  for (size_t k = 0; k < all->others && status == FG_OK; k++)
    status = fg_scanner_model_check_fields(&inner, "alternatives", &all->other[k]);
  if (status == FG_OK) return FG_OK;
  return fg_fail(ctx, status, "what was found is no model of a scanner, and is not written: %.600s",
                 inner.message);
}

/* How many held the absolute scale; 0 where they could not have shown that it is wrong. */
static size_t known_diameters(const fg_scan_loop *loop) {
  for (size_t e = 0; e < loop->set.count; e++)
    if (loop->set.effects[e].kind->scales) return loop->points.known_count;
  for (size_t i = 0; i < loop->decided.candidates; i++)
    if (loop->decided.candidate[i].kind->scales &&
        loop->decided.candidate[i].verdict == FG_LOOP_ABSENT)
      return loop->points.known_count;
  return 0;
}

static void format_date(int64_t seconds, char text[FG_MODEL_DATE]) {
  time_t at = (time_t)seconds;
  struct tm utc;
  text[0] = 0;
  if (seconds && gmtime_r(&at, &utc)) strftime(text, FG_MODEL_DATE, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  explanations all = {.others = loop->tie_count};
  fg_json json;
  const fg_measurement *m = &loop->before[0];
  fg_effect_set_fields(&loop->points, &loop->set, &all.fields);
  for (size_t k = 0; k < all.others; k++)
    fg_effect_set_fields(&loop->points, &loop->tie[k], &all.other[k]);
  FG_TRY(check(ctx, loop, &all));
  char date[FG_MODEL_DATE];
  format_date(loop->options.date, date);
  const fg_field_frame *frame = &all.fields.frame;
  fg_json_begin(&json, out);
  json.exact = true; /* a model that is read corrects as the loop did */
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/scan-model/1");
  fg_json_string(&json, "scanner", loop->options.scanner);
  fg_json_string(&json, "date", date[0] ? date : NULL);
  fg_json_string(&json, "level", "points");
  fg_json_numbers(&json, "dpi", m->dpi, 2);
  fg_json_numbers(
      &json, "region_mm",
      (double[]){frame->low_mm[0], frame->low_mm[1], frame->high_mm[0], frame->high_mm[1]}, 4);
  fg_json_numbers(
      &json, "curve_mm",
      (double[]){frame->first_mm[0], frame->first_mm[1], frame->last_mm[0], frame->last_mm[1]}, 4);
  fg_json_integer(&json, "curve_knots", (int64_t)frame->knots);
  write_inputs(&json, loop);
  fg_json_integer(&json, "known_diameters", (int64_t)known_diameters(loop));
  fg_json_bool(&json, "tied", loop->tied);
  write_fields(&json, "fields", &all.fields);
  fg_json_array(&json, "alternatives");
  for (size_t k = 0; k < all.others; k++)
    write_fields(&json, NULL, &all.other[k]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_stream_finish(ctx, out, "the model");
}
