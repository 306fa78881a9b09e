/* The model of a scanner as a file: "foilgauge/scan-model/1". */
#include "loop/scan_loop.h"
#include "report/measure_json.h"
#include "report/words.h"

static void write_fields(fg_json *json, const char *name, const fg_field_list *list) {
  fg_json_array(json, name);
  for (size_t i = 0; i < list->count; i++) {
    const fg_field *f = &list->fields[i];
    fg_json_object(json, NULL);
    fg_json_string(json, "id", f->row->id);
    fg_json_numbers(json, "amplitude_mm", f->amplitude_mm, f->row->columns);
    fg_json_numbers(json, "u_amplitude_mm", f->u_amplitude_mm, f->row->columns);
    fg_json_numbers(json, "shape", f->shape, f->row->shapes);
    fg_json_numbers(json, "u_shape", f->u_shape, f->row->shapes);
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

fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  fg_field_list fields, other;
  fg_json json;
  const fg_measurement *m = &loop->before[0];
  fg_scan_fields(&loop->points, &loop->set, &fields);
  const fg_field_frame *frame = &fields.frame;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_head(&json, "foilgauge/scan-model/1");
  fg_json_string(&json, "scanner", loop->options.scanner);
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
  fg_json_bool(&json, "tied", loop->tied);
  write_fields(&json, "fields", &fields);
  fg_json_array(&json, "alternatives");
  for (size_t k = 0; k < loop->tie_count; k++) {
    fg_scan_fields(&loop->points, &loop->tie[k], &other);
    write_fields(&json, NULL, &other);
  }
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  return fg_report_finish(ctx, out, "the model");
}
