/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading the model file of a scanner: "foilgauge/scan-model/1" (reports/schema). */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/traceability.h"
#include "scan_loop/scanner_model.h"

enum { MODEL_BYTES_MAX = 1 << 20 };
_Static_assert((int)FG_EFFECT_SET_MAX <= (int)FG_FIELDS_MAX, "what is written can be read");

/* Reads exactly `wanted` numbers of an array member; NaN for null. Their ranges are checked later.
 */
static fg_status read_model_numbers(fg_context *ctx, const cJSON *object, const char *before,
                                    const char *name, double *out, size_t wanted) {
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, name);
  size_t count = cJSON_IsArray(array) ? (size_t)cJSON_GetArraySize(array) : 0;
  if (!cJSON_IsArray(array) || count != wanted)
    return fg_fail(ctx, FG_ERR_DATA, "`%s%s` holds %zu number%s; an array of %zu is allowed",
                   before, name, count, count == 1 ? "" : "s", wanted);
  for (size_t i = 0; i < wanted; i++) {
    const cJSON *item = cJSON_GetArrayItem(array, (int)i);
    out[i] = cJSON_IsNumber(item) ? item->valuedouble : NAN;
    if (cJSON_IsNumber(item) || cJSON_IsNull(item)) continue;
    return fg_fail(ctx, FG_ERR_DATA, "`%s%s[%zu]` is %s; only a number is allowed", before, name, i,
                   cJSON_IsString(item) ? "text" : "no number");
  }
  return FG_OK;
}

static fg_status read_field(fg_context *ctx, const char *member, const cJSON *item,
                            fg_field_list *list) {
  char before[64];
  const cJSON *id = cJSON_GetObjectItemCaseSensitive(item, "id");
  const fg_effect *kind = cJSON_IsString(id) ? fg_effect_find(id->valuestring) : NULL;
  if (!kind || !kind->glass)
    return fg_fail(ctx, FG_ERR_DATA, "`%s` holds an effect that is not known: %.80s", member,
                   cJSON_IsString(id) ? id->valuestring : "one without id");
  fg_text_clip(before, sizeof before, "%s[%zu].", member, list->count);
  fg_field *f = &list->fields[list->count++];
  *f = fg_effect_field(kind);
  FG_TRY(read_model_numbers(ctx, item, before, "amplitude_mm", f->amplitude_mm, f->columns));
  FG_TRY(read_model_numbers(ctx, item, before, "u_amplitude_mm", f->u_amplitude_mm, f->columns));
  FG_TRY(read_model_numbers(ctx, item, before, "shape", f->shape, f->shapes));
  /* Not in every file; a shape that was not refined has none. */
  if (cJSON_GetObjectItemCaseSensitive(item, "u_shape"))
    FG_TRY(read_model_numbers(ctx, item, before, "u_shape", f->u_shape, f->shapes));
  for (size_t s = 0; s < f->shapes; s++)
    if (isnan(f->u_shape[s])) f->u_shape[s] = 0;
  return FG_OK;
}

/* An effect may occur more than once: two ripples, two steps. */
static fg_status read_fields(fg_context *ctx, const char *member, const cJSON *fields,
                             fg_field_list *list) {
  const cJSON *item;
  if (!fields) return fg_fail(ctx, FG_ERR_DATA, "`%s` is missing", member);
  if (!cJSON_IsArray(fields))
    return fg_fail(ctx, FG_ERR_DATA, "`%s` is no array of effects; an array is allowed", member);
  if (cJSON_GetArraySize(fields) > FG_FIELDS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "`%s` holds %d effects; at most %d are allowed", member,
                   cJSON_GetArraySize(fields), FG_FIELDS_MAX);
  cJSON_ArrayForEach(item, fields) FG_TRY(read_field(ctx, member, item, list));
  return fg_scanner_model_check_fields(ctx, member, list);
}

static fg_status read_knots(fg_context *ctx, const cJSON *root, size_t *knots) {
  enum { MIN = 4 };
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "curve_knots");
  double value = !item ? FG_FIELD_COLUMNS : cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (!(value >= MIN && value <= FG_FIELD_COLUMNS && value == floor(value)))
    return fg_fail(ctx, FG_ERR_DATA, "`curve_knots` is %g; a whole number, %d to %d, is allowed",
                   value, MIN, FG_FIELD_COLUMNS);
  *knots = (size_t)value;
  return FG_OK;
}

static fg_status read_place(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  fg_field_frame *frame = &model->fields.frame;
  double region[4], curve[4];
  FG_TRY(read_model_numbers(ctx, root, "", "dpi", model->dpi, 2));
  FG_TRY(read_model_numbers(ctx, root, "", "region_mm", region, 4));
  memcpy(curve, region, sizeof curve); /* a file without free curves may lack the member */
  if (cJSON_GetObjectItemCaseSensitive(root, "curve_mm"))
    FG_TRY(read_model_numbers(ctx, root, "", "curve_mm", curve, 4));
  FG_TRY(read_knots(ctx, root, &frame->knots));
  for (int axis = 0; axis < 2; axis++) {
    frame->first_mm[axis] = curve[axis];
    frame->last_mm[axis] = curve[2 + axis];
    frame->low_mm[axis] = region[axis];
    frame->high_mm[axis] = region[2 + axis];
    frame->centre_mm[axis] = 0.5 * (region[axis] + region[2 + axis]);
  }
  return fg_scanner_model_check_place(ctx, model->dpi, frame);
}

static fg_status read_scanner(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(root, "scanner");
  if (!name || cJSON_IsNull(name)) return FG_OK;
  if (!cJSON_IsString(name) || strlen(name->valuestring) >= sizeof model->scanner)
    return fg_fail(ctx, FG_ERR_DATA, "`scanner` must be a name of at most %d bytes",
                   FG_SCANNER_NAME - 1);
  strcpy(model->scanner, name->valuestring);
  return FG_OK;
}

/* "2026-03-14", or with the time behind it. */
static fg_status read_date(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *date = cJSON_GetObjectItemCaseSensitive(root, "date");
  int year, month, day, used = 0;
  if (!date || cJSON_IsNull(date)) return FG_OK;
  if (!cJSON_IsString(date) || strlen(date->valuestring) >= sizeof model->date ||
      sscanf(date->valuestring, "%4d-%2d-%2d%n", &year, &month, &day, &used) != 3 || used != 10 ||
      strspn(date->valuestring, "0123456789-:TZ") != strlen(date->valuestring))
    return fg_fail(ctx, FG_ERR_DATA,
                   "`date` is no date; one as 2026-03-14T09:26:53Z, or null, is allowed");
  strcpy(model->date, date->valuestring);
  return FG_OK;
}

static fg_status read_artefact_text(fg_context *ctx, const cJSON *artefact, const char *name,
                                    char *text, size_t size) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(artefact, name);
  if (!item || cJSON_IsNull(item)) return FG_OK;
  if (!cJSON_IsString(item) || strlen(item->valuestring) >= size)
    return fg_fail(ctx, FG_ERR_DATA, "`artefact.%s` must be a text of at most %zu bytes", name,
                   size - 1);
  strcpy(text, item->valuestring);
  return FG_OK;
}

static fg_status read_artefact(fg_context *ctx, const cJSON *root, fg_artefact *a) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "artefact");
  if (!item || cJSON_IsNull(item)) return FG_OK;
  FG_TRY(read_artefact_text(ctx, item, "name", a->name, sizeof a->name));
  FG_TRY(read_artefact_text(ctx, item, "certificate", a->certificate, sizeof a->certificate));
  FG_TRY(read_artefact_text(ctx, item, "date", a->date, sizeof a->date));
  FG_TRY(read_artefact_text(ctx, item, "due", a->due, sizeof a->due));
  return fg_artefact_check(ctx, "artefact", a);
}

/* Reads a number of gauges; an absent one is 0. */
static fg_status read_known(fg_context *ctx, const cJSON *root, const char *name, size_t *known) {
  enum { KNOWN_MAX = 1000000 };
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, name);
  double count = !item ? 0 : cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (!(count >= 0 && count <= KNOWN_MAX && count == floor(count)))
    return fg_fail(ctx, FG_ERR_DATA, "`%s` is %g; how many gauges had one, 0 to %d, is allowed",
                   name, count, KNOWN_MAX);
  *known = (size_t)count;
  return FG_OK;
}

/* Reads a temperature in its range; an absent one is NaN. */
static fg_status read_temperature_of(fg_context *ctx, const cJSON *root, const char *name,
                                     double lowest, double highest, double *value) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, name);
  *value = NAN;
  if (!item || cJSON_IsNull(item)) return FG_OK;
  *value = cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (*value >= lowest && *value <= highest) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "`%s` is %g; a number, %g to %g, is allowed", name, *value,
                 lowest, highest);
}

static fg_status read_heat(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  FG_TRY(read_temperature_of(ctx, root, "temperature_C", 0, 60, &model->temperature_c));
  FG_TRY(read_temperature_of(ctx, root, "u_temperature_K", 0, 20, &model->u_temperature_k));
  if (isnan(model->u_temperature_k)) model->u_temperature_k = 0;
  return FG_OK;
}

static fg_status read_origin(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *inputs = cJSON_GetObjectItemCaseSensitive(root, "inputs");
  FG_TRY(read_known(ctx, root, "known_diameters", &model->known_diameters));
  FG_TRY(read_known(ctx, root, "known_grids", &model->known_grids));
  FG_TRY(read_artefact(ctx, root, &model->artefact));
  FG_TRY(read_heat(ctx, root, model));
  model->scans = cJSON_IsArray(inputs) ? (size_t)cJSON_GetArraySize(inputs) : 0;
  return read_date(ctx, root, model);
}

/* Reads what evidence gives the model and its alternatives; absent: nothing is known of it. */
static fg_status read_weights(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *weights = cJSON_GetObjectItemCaseSensitive(root, "weights"), *item;
  double sum = 0;
  if (!weights) return FG_OK;
  if (!cJSON_IsArray(weights) || (size_t)cJSON_GetArraySize(weights) != model->others + 1)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "`weights` must be an array of a number for `fields` and one for each of the %zu "
        "alternatives",
        model->others);
  cJSON_ArrayForEach(item, weights) {
    double weight = cJSON_IsNumber(item) ? item->valuedouble : NAN;
    if (!(weight >= 0 && weight <= 1))
      return fg_fail(ctx, FG_ERR_DATA, "`weights[%zu]` is %g; 0 to 1 is allowed", model->weights,
                     weight);
    model->weight[model->weights++] = weight;
    sum += weight;
  }
  if (fabs(sum - 1) > 1e-6)
    return fg_fail(ctx, FG_ERR_DATA, "the sum of `weights` is %g; it must be 1", sum);
  return FG_OK;
}

static fg_status read_others(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *others = cJSON_GetObjectItemCaseSensitive(root, "alternatives"), *item;
  const cJSON *tied = cJSON_GetObjectItemCaseSensitive(root, "tied");
  if (tied && !cJSON_IsBool(tied))
    return fg_fail(ctx, FG_ERR_DATA, "`tied` is neither; true or false is allowed");
  model->tied = cJSON_IsTrue(tied);
  if (others && !cJSON_IsArray(others))
    return fg_fail(ctx, FG_ERR_DATA, "`alternatives` is no array; an array is allowed");
  if (cJSON_GetArraySize(others) > FG_EXPLANATIONS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "`alternatives` holds %d explanations; at most %d are allowed",
                   cJSON_GetArraySize(others), FG_EXPLANATIONS_MAX);
  cJSON_ArrayForEach(item, others) {
    char member[32];
    fg_text_clip(member, sizeof member, "alternatives[%zu]", model->others);
    fg_field_list *other = &model->other[model->others++];
    other->frame = model->fields.frame;
    FG_TRY(read_fields(ctx, member, item, other));
  }
  return FG_OK;
}

static fg_status read_map_side(fg_context *ctx, const cJSON *map, const char *name, size_t *side) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(map, name);
  double value = cJSON_IsNumber(item) ? item->valuedouble : NAN;
  if (!(value >= FG_MAP_SIDE_MIN && value <= FG_MAP_SIDE_MAX && value == floor(value)))
    return fg_fail(ctx, FG_ERR_DATA, "`map.%s` is %g; a whole number, %d to %d, is allowed", name,
                   value, FG_MAP_SIDE_MIN, FG_MAP_SIDE_MAX);
  *side = (size_t)value;
  return FG_OK;
}

/* Displacements by a map are a scanner's as those by its effects are. */
#define MAP_MAX_MM 20.0

static fg_status read_map_numbers(fg_context *ctx, const cJSON *object, const char *before,
                                  size_t numbers, double **mm) {
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof **mm, (void **)mm));
  FG_TRY(read_model_numbers(ctx, object, before, "d_mm", *mm, numbers));
  for (size_t i = 0; i < numbers; i++)
    if (!(fabs((*mm)[i]) <= MAP_MAX_MM))
      return fg_fail(ctx, FG_ERR_DATA, "`%sd_mm[%zu]` is %g; -%g to %g mm is allowed", before, i,
                     (*mm)[i], MAP_MAX_MM, MAP_MAX_MM);
  return FG_OK;
}

static fg_status read_map(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *map = cJSON_GetObjectItemCaseSensitive(root, "map"), *mode;
  if (!map || cJSON_IsNull(map)) return FG_OK;
  fg_map_frame *frame = &model->map.frame;
  for (int axis = 0; axis < 2; axis++) {
    frame->low_mm[axis] = model->fields.frame.low_mm[axis];
    frame->high_mm[axis] = model->fields.frame.high_mm[axis];
  }
  FG_TRY(read_map_side(ctx, map, "columns", &frame->side[0]));
  FG_TRY(read_map_side(ctx, map, "rows", &frame->side[1]));
  size_t numbers = 2 * fg_map_splines(frame);
  FG_TRY(read_map_numbers(ctx, map, "map.", numbers, &model->map.mm));
  const cJSON *modes = cJSON_GetObjectItemCaseSensitive(map, "modes");
  if (!cJSON_IsArray(modes) || cJSON_GetArraySize(modes) > FG_MAP_MODES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "`map.modes` must be an array of at most %d objects",
                   FG_MAP_MODES_MAX);
  cJSON_ArrayForEach(mode, modes) {
    char before[48];
    fg_text_clip(before, sizeof before, "map.modes[%zu].", model->map.mode_count);
    FG_TRY(
        read_map_numbers(ctx, mode, before, numbers, &model->map.modes[model->map.mode_count++]));
  }
  model->fields.map = frame;
  model->fields.map_mm = model->map.mm;
  return FG_OK;
}

static fg_status read_model(fg_context *ctx, const cJSON *root, fg_scanner_model *model) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/scan-model/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "not a model of a scanner (\"schema\": \"foilgauge/scan-model/1\"); "
                   "`foilgauge loop SCAN --model-out F` writes one");
  FG_TRY(read_scanner(ctx, root, model));
  FG_TRY(read_origin(ctx, root, model));
  FG_TRY(read_place(ctx, root, model));
  FG_TRY(fg_model_tone_read(ctx, root, &model->tone));
  FG_TRY(read_map(ctx, root, model));
  FG_TRY(
      read_fields(ctx, "fields", cJSON_GetObjectItemCaseSensitive(root, "fields"), &model->fields));
  FG_TRY(read_others(ctx, root, model));
  return read_weights(ctx, root, model);
}

static void sum_text(const char *text, char sum[65]) {
  struct sha256_ctx state;
  sha256_init(&state);
  sha256_update(&state, strlen(text), (const uint8_t *)text);
  fg_sha256_finish(&state, sum);
}

fg_status fg_scanner_model_parse(fg_context *ctx, const char *path, const char *text,
                                 fg_scanner_model **model) {
  fg_context inner = {.message = ""};
  fg_scanner_model *made = NULL;
  *model = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  sum_text(text, made->sha256);
  fg_text_clip(made->path, sizeof made->path, "%s", path);
  cJSON *root;
  fg_status read = fg_json_read(ctx, path, text, &root);
  fg_status status = read == FG_OK ? read_model(&inner, root, made) : read;
  cJSON_Delete(root);
  if (status == FG_OK) {
    *model = made;
    return FG_OK;
  }
  fg_scanner_model_free(made);
  return read != FG_OK ? read : fg_fail(ctx, status, "%.200s: %.700s", path, inner.message);
}

fg_status fg_scanner_model_load(fg_context *ctx, const char *path, fg_scanner_model **model) {
  char *text = NULL;
  *model = NULL;
  FG_TRY(fg_file_read_text(ctx, path, MODEL_BYTES_MAX, &text));
  fg_status status = fg_scanner_model_parse(ctx, path, text, model);
  free(text);
  return status;
}

void fg_scanner_model_free(fg_scanner_model *model) {
  if (model) fg_field_map_free(&model->map);
  free(model);
}

const char *fg_scanner_model_sha256(const fg_scanner_model *model) {
  return model->sha256;
}

bool fg_scanner_model_has_level(const fg_scanner_model *model) {
  return model && model->tone.gauges;
}

bool fg_scanner_model_is_tied(const fg_scanner_model *model) {
  return model->tied;
}

double fg_scanner_model_weight(const fg_scanner_model *model, size_t explanation) {
  return model->weights ? model->weight[explanation] : 1 / (double)(model->others + 1);
}

bool fg_scanner_model_is_empty(const fg_scanner_model *model) {
  return fg_field_list_is_empty(&model->fields) && model->others == 0 && !model->tone.gauges;
}

fg_status fg_scanner_model_check_scanner(fg_context *ctx, const fg_scanner_model *model,
                                         const char *path, const char *scanner) {
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
