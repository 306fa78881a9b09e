/* The model file of a scanner: "foilgauge/scan-model/1". */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "loop/scan_loop.h"

struct fg_scan_model {
  double dpi[2];
  fg_field_list fields;
};

fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out) {
  fg_field_list fields;
  (void)ctx;
  fg_scan_fields(&loop->points, &loop->set, &fields);
  const fg_measurement *m = &loop->before[0];
  fprintf(out,
          "{\n \"schema\": \"foilgauge/scan-model/1\",\n \"dpi\": [%.10g, %.10g],\n"
          " \"region_mm\": [%.10g, %.10g, %.10g, %.10g],\n \"tied\": %s,\n \"fields\": [",
          m->dpi[0], m->dpi[1], fields.frame.low_mm[0], fields.frame.low_mm[1],
          fields.frame.high_mm[0], fields.frame.high_mm[1], loop->tied ? "true" : "false");
  for (size_t i = 0; i < fields.count; i++) {
    const fg_field *f = &fields.fields[i];
    fprintf(out, "%s\n  {\"id\": \"%s\", \"amplitude_mm\": [", i ? "," : "", f->row->id);
    for (size_t c = 0; c < f->row->columns; c++)
      fprintf(out, "%s%.10g", c ? ", " : "", f->amplitude_mm[c]);
    fputs("], \"u_amplitude_mm\": [", out);
    for (size_t c = 0; c < f->row->columns; c++)
      fprintf(out, "%s%.10g", c ? ", " : "", f->u_amplitude_mm[c]);
    fputs("], \"shape\": [", out);
    for (size_t s = 0; s < f->row->shapes; s++)
      fprintf(out, "%s%.10g", s ? ", " : "", f->shape[s]);
    fputs("]}", out);
  }
  fputs("\n ]\n}\n", out);
  return FG_OK;
}

/* Up to `most` numbers of an array member; false when it is not one or holds something else. */
static bool read_numbers(const cJSON *object, const char *name, double *out, size_t wanted) {
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!cJSON_IsArray(array) || (size_t)cJSON_GetArraySize(array) != wanted) return false;
  for (size_t i = 0; i < wanted; i++) {
    const cJSON *item = cJSON_GetArrayItem(array, (int)i);
    if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble)) return false;
    out[i] = item->valuedouble;
  }
  return true;
}

static fg_status read_field(fg_context *ctx, const char *path, const cJSON *item,
                            fg_scan_model *model) {
  const cJSON *id = cJSON_GetObjectItemCaseSensitive(item, "id");
  const fg_field_row *row = cJSON_IsString(id) ? fg_field_find(id->valuestring) : NULL;
  if (!row || model->fields.count == FG_FIELDS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "%s: `fields` holds an effect that is not known: %s", path,
                   cJSON_IsString(id) ? id->valuestring : "without id");
  fg_field *f = &model->fields.fields[model->fields.count++];
  f->row = row;
  if (!read_numbers(item, "amplitude_mm", f->amplitude_mm, row->columns) ||
      !read_numbers(item, "u_amplitude_mm", f->u_amplitude_mm, row->columns) ||
      !read_numbers(item, "shape", f->shape, row->shapes))
    return fg_fail(ctx, FG_ERR_DATA, "%s: the numbers of `%s` are not complete", path, row->id);
  return FG_OK;
}

static fg_status read_model(fg_context *ctx, const char *path, const cJSON *root,
                            fg_scan_model *model) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  double region[4];
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/scan-model/1"))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: not a model of a scanner (\"schema\": \"foilgauge/scan-model/1\"); "
                   "`foilgauge loop SCAN --model-out F` writes one",
                   path);
  if (!read_numbers(root, "dpi", model->dpi, 2) || !read_numbers(root, "region_mm", region, 4))
    return fg_fail(ctx, FG_ERR_DATA, "%s: `dpi` or `region_mm` is missing", path);
  for (int axis = 0; axis < 2; axis++) {
    model->fields.frame.low_mm[axis] = region[axis];
    model->fields.frame.high_mm[axis] = region[2 + axis];
    model->fields.frame.centre_mm[axis] = 0.5 * (region[axis] + region[2 + axis]);
  }
  const cJSON *fields = cJSON_GetObjectItemCaseSensitive(root, "fields"), *item;
  if (!cJSON_IsArray(fields)) return fg_fail(ctx, FG_ERR_DATA, "%s: `fields` is missing", path);
  cJSON_ArrayForEach(item, fields) FG_TRY(read_field(ctx, path, item, model));
  return FG_OK;
}

fg_status fg_scan_model_load(fg_context *ctx, const char *path, fg_scan_model **model) {
  char *text = NULL;
  cJSON *root = NULL;
  fg_scan_model *made = NULL;
  fg_status status = FG_OK;
  *model = NULL;
  FG_TRY_EXIT(fg_file_read_text(ctx, path, 1u << 20, &text));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  root = cJSON_Parse(text);
  if (!root) status = fg_fail(ctx, FG_ERR_DATA, "%s: not JSON", path);
  if (status == FG_OK) status = read_model(ctx, path, root, made);
  if (status == FG_OK) {
    *model = made;
    made = NULL;
  }
exit:
  cJSON_Delete(root);
  free(text);
  free(made);
  return status;
}

void fg_scan_model_free(fg_scan_model *model) {
  free(model);
}

/* Adds in squares what one parameter of the model moves every quantity by. */
static void add_doubt(fg_foil *foil, const fg_foil *moved) {
  if (moved->bump_count != foil->bump_count) return;
#define WIDEN(u, value, other) (u) = hypot((u), (value) - (other))
  fg_overall *o = &foil->overall;
  WIDEN(o->u_radius_mm, o->radius_mm, moved->overall.radius_mm);
  WIDEN(o->u_springback_error_pct, o->springback_error_pct, moved->overall.springback_error_pct);
  for (size_t b = 0; b < foil->bump_count; b++) {
    fg_bump *p = &foil->bumps[b];
    const fg_bump *q = &moved->bumps[b];
    WIDEN(p->u_radius_mm, p->radius_mm, q->radius_mm);
    WIDEN(p->u_centre_to_centre_mm, p->centre_to_centre_mm, q->centre_to_centre_mm);
    WIDEN(p->u_bump_angle_deg, p->bump_angle_deg, q->bump_angle_deg);
    WIDEN(p->u_intersection_angle_deg, p->intersection_angle_deg, q->intersection_angle_deg);
    WIDEN(p->u_height_mm, p->height_mm, q->height_mm);
    WIDEN(p->u_clearance_mm, p->clearance_mm, q->clearance_mm);
    WIDEN(p->u_clearance_error, p->clearance_error, q->clearance_error);
    WIDEN(p->u_radius_error_pct, p->radius_error_pct, q->radius_error_pct);
    WIDEN(p->u_bump_angle_error_pct, p->bump_angle_error_pct, q->bump_angle_error_pct);
    WIDEN(p->u_height_model_mm, p->height_model_mm, q->height_model_mm);
    WIDEN(p->u_bump_angle_model_deg, p->bump_angle_model_deg, q->bump_angle_model_deg);
  }
#undef WIDEN
}

static void add_disc_doubt(fg_disc *disc, const fg_disc *moved) {
  double off = moved->radius_mm - disc->radius_mm;
  disc->u_radius_mm = hypot(disc->u_radius_mm, off);
  disc->u_diameter_mm = 2 * disc->u_radius_mm;
  disc->covariance[2][2] += off * off;
}

static fg_status widen_by_model(fg_context *ctx, const fg_scan_model *model,
                                const fg_measurement *m, unsigned threads,
                                fg_measurement *corrected) {
  for (size_t f = 0; f < model->fields.count; f++)
    for (size_t c = 0; c < model->fields.fields[f].row->columns; c++) {
      fg_field_list moved = model->fields;
      fg_measurement other;
      moved.fields[f].amplitude_mm[c] += moved.fields[f].u_amplitude_mm[c];
      FG_TRY(fg_scan_correct(ctx, m, &moved, NULL, 0, NULL, threads, &other));
      for (size_t k = 0; k < corrected->foil_count; k++)
        add_doubt(&corrected->foils[k], &other.foils[k]);
      for (size_t k = 0; k < corrected->disc_count; k++)
        add_disc_doubt(&corrected->discs[k], &other.discs[k]);
      fg_measurement_free(&other);
    }
  return FG_OK;
}

fg_status fg_scan_model_apply(fg_context *ctx, const fg_scan_model *model, fg_measurement *m,
                              unsigned threads, char *warning) {
  if (warning) warning[0] = 0;
  for (int axis = 0; axis < 2; axis++)
    if (fabs(m->dpi[axis] / model->dpi[axis] - 1) > 1e-4)
      return fg_fail(
          ctx, FG_ERR_DATA,
          "%s: the scan has %g dpi and the model is of a scanner at %g dpi; find a model "
          "at this resolution",
          m->scan, m->dpi[axis], model->dpi[axis]);
  const fg_field_frame *frame = &model->fields.frame;
  if (warning && ((double)m->width_px * 25.4 / m->dpi[0] > frame->high_mm[0] * 1.1 ||
                  (double)m->height_px * 25.4 / m->dpi[1] > frame->high_mm[1] * 1.1))
    snprintf(warning, 200,
             "%.80s: the scan reaches beyond the %.0f x %.0f mm the model was found in", m->scan,
             frame->high_mm[0], frame->high_mm[1]);
  fg_measurement corrected;
  FG_TRY(fg_scan_correct(ctx, m, &model->fields, NULL, 0, NULL, threads, &corrected));
  fg_status status = widen_by_model(ctx, model, m, threads, &corrected);
  if (status != FG_OK) {
    fg_measurement_free(&corrected);
    return status;
  }
  for (size_t f = 0; f < m->foil_count; f++)
    fg_foil_free(&m->foils[f]);
  for (size_t d = 0; d < m->disc_count; d++)
    fg_disc_free(&m->discs[d]);
  free(m->foils);
  free(m->discs);
  *m = corrected;
  return FG_OK;
}
