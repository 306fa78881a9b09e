/* Reading the model file of a scanner: "foilgauge/scan-model/1" (reports/schema). */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "loop/scan_model.h"

enum { MODEL_BYTES_MAX = 1 << 20 };

/* Exactly `wanted` finite numbers of an array member. */
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

static bool has_field(const fg_field_list *list, const fg_field_row *row) {
  for (size_t i = 0; i < list->count; i++)
    if (list->fields[i].row == row) return true;
  return false;
}

static fg_status read_field(fg_context *ctx, const cJSON *item, fg_field_list *list) {
  const cJSON *id = cJSON_GetObjectItemCaseSensitive(item, "id");
  const fg_field_row *row = cJSON_IsString(id) ? fg_field_find(id->valuestring) : NULL;
  if (!row)
    return fg_fail(ctx, FG_ERR_DATA, "`fields` holds an effect that is not known: %.80s",
                   cJSON_IsString(id) ? id->valuestring : "one without id");
  if (has_field(list, row) || list->count == FG_FIELDS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "`fields` holds `%s` twice, or too many effects", row->id);
  fg_field *f = &list->fields[list->count++];
  f->row = row;
  if (!read_numbers(item, "amplitude_mm", f->amplitude_mm, row->columns) ||
      !read_numbers(item, "u_amplitude_mm", f->u_amplitude_mm, row->columns) ||
      !read_numbers(item, "shape", f->shape, row->shapes))
    return fg_fail(ctx, FG_ERR_DATA, "the numbers of `%s` are not complete", row->id);
  /* Not in every file; a shape that was not refined has none. */
  if (!read_numbers(item, "u_shape", f->u_shape, row->shapes))
    memset(f->u_shape, 0, sizeof f->u_shape);
  return FG_OK;
}

static fg_status read_fields(fg_context *ctx, const cJSON *fields, fg_field_list *list) {
  const cJSON *item;
  if (!cJSON_IsArray(fields)) return fg_fail(ctx, FG_ERR_DATA, "`fields` is missing");
  cJSON_ArrayForEach(item, fields) FG_TRY(read_field(ctx, item, list));
  return FG_OK;
}

static fg_status read_place(fg_context *ctx, const cJSON *root, fg_scan_model *model) {
  fg_field_frame *frame = &model->fields.frame;
  double region[4], curve[4], knots = FG_FIELD_COLUMNS;
  if (!read_numbers(root, "dpi", model->dpi, 2) || !(model->dpi[0] > 0 && model->dpi[1] > 0))
    return fg_fail(ctx, FG_ERR_DATA, "`dpi` must be two numbers above 0");
  if (!read_numbers(root, "region_mm", region, 4) || !(region[2] > region[0]) ||
      !(region[3] > region[1]))
    return fg_fail(ctx, FG_ERR_DATA, "`region_mm` must be x, y of one corner and of the opposite");
  memcpy(curve, region, sizeof curve); /* a file without free curves need not say */
  if (cJSON_GetObjectItemCaseSensitive(root, "curve_mm") &&
      (!read_numbers(root, "curve_mm", curve, 4) || !(curve[2] > curve[0]) ||
       !(curve[3] > curve[1])))
    return fg_fail(ctx, FG_ERR_DATA, "`curve_mm` must be x, y of one corner and of the opposite");
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "curve_knots");
  if (item) knots = cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (!(knots >= 4 && knots <= FG_FIELD_COLUMNS))
    return fg_fail(ctx, FG_ERR_DATA, "`curve_knots` must be 4 to %d", FG_FIELD_COLUMNS);
  frame->knots = (size_t)knots;
  for (int axis = 0; axis < 2; axis++) {
    frame->first_mm[axis] = curve[axis];
    frame->last_mm[axis] = curve[2 + axis];
    frame->low_mm[axis] = region[axis];
    frame->high_mm[axis] = region[2 + axis];
    frame->centre_mm[axis] = 0.5 * (region[axis] + region[2 + axis]);
  }
  return FG_OK;
}

static fg_status read_scanner(fg_context *ctx, const cJSON *root, fg_scan_model *model) {
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(root, "scanner");
  if (!name || cJSON_IsNull(name)) return FG_OK;
  if (!cJSON_IsString(name) || strlen(name->valuestring) >= sizeof model->scanner)
    return fg_fail(ctx, FG_ERR_DATA, "`scanner` must be a name of at most %d bytes",
                   FG_SCANNER_NAME - 1);
  strcpy(model->scanner, name->valuestring);
  return FG_OK;
}

static fg_status read_others(fg_context *ctx, const cJSON *root, fg_scan_model *model) {
  const cJSON *others = cJSON_GetObjectItemCaseSensitive(root, "alternatives"), *item;
  model->tied = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(root, "tied"));
  cJSON_ArrayForEach(item, others) {
    if (model->others == FG_SUBSET_CLASS)
      return fg_fail(ctx, FG_ERR_DATA, "`alternatives` holds too many explanations");
    fg_field_list *other = &model->other[model->others++];
    other->frame = model->fields.frame;
    FG_TRY(read_fields(ctx, item, other));
  }
  return FG_OK;
}

static fg_status read_model(fg_context *ctx, const cJSON *root, fg_scan_model *model) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/scan-model/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "not a model of a scanner (\"schema\": \"foilgauge/scan-model/1\"); "
                   "`foilgauge loop SCAN --model-out F` writes one");
  FG_TRY(read_scanner(ctx, root, model));
  FG_TRY(read_place(ctx, root, model));
  FG_TRY(read_fields(ctx, cJSON_GetObjectItemCaseSensitive(root, "fields"), &model->fields));
  return read_others(ctx, root, model);
}

static void sum_text(const char *text, char sum[65]) {
  struct sha256_ctx state;
  sha256_init(&state);
  sha256_update(&state, strlen(text), (const uint8_t *)text);
  fg_sha256_finish(&state, sum);
}

fg_status fg_scan_model_parse(fg_context *ctx, const char *path, const char *text,
                              fg_scan_model **model) {
  fg_context inner = {.message = ""};
  fg_scan_model *made = NULL;
  const char *end = NULL;
  *model = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  sum_text(text, made->sha256);
  cJSON *root = cJSON_ParseWithOpts(text, &end, true);
  fg_status status = root ? read_model(&inner, root, made)
                          : fg_fail(&inner, FG_ERR_DATA,
                                    "not a model of a scanner, or not all of one: no JSON at "
                                    "byte %td",
                                    end ? end - text : 0);
  cJSON_Delete(root);
  if (status == FG_OK) {
    *model = made;
    return FG_OK;
  }
  free(made);
  return fg_fail(ctx, status, "%.200s: %.700s", path, inner.message);
}

fg_status fg_scan_model_load(fg_context *ctx, const char *path, fg_scan_model **model) {
  char *text = NULL;
  *model = NULL;
  FG_TRY(fg_file_read_text(ctx, path, MODEL_BYTES_MAX, &text));
  fg_status status = fg_scan_model_parse(ctx, path, text, model);
  free(text);
  return status;
}

void fg_scan_model_free(fg_scan_model *model) {
  free(model);
}

const char *fg_scan_model_sha256(const fg_scan_model *model) {
  return model->sha256;
}

bool fg_scan_model_is_tied(const fg_scan_model *model) {
  return model->tied;
}

fg_status fg_scan_model_check_scanner(fg_context *ctx, const fg_scan_model *model, const char *path,
                                      const char *scanner) {
  if (!scanner || !strcmp(model->scanner, scanner)) return FG_OK;
  if (!model->scanner[0])
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the model does not say which scanner it is of; make it with `foilgauge "
                   "loop --scanner '%s' --model-out`",
                   path, scanner);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: a model of the scanner '%s', not of '%s'; every scanner needs its own", path,
                 model->scanner, scanner);
}
