#include "lot/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/memory.h"
#include "core/text.h"
#include "report/words.h"

enum { PLACES_MAX = 4 };

/* Where the values of a field lie in its object, in the order of a record. */
static size_t places_of(const fg_report_field *field, size_t offset[PLACES_MAX]) {
  size_t width = field->kind == FG_FIELD_PAIR ? 2 : 1, count = 0;
  for (size_t i = 0; i < width; i++)
    offset[count++] = field->offset + i * sizeof(double);
  if (field->u_offset == FG_NO_UNCERTAINTY) return count;
  for (size_t i = 0; i < width; i++)
    offset[count++] = field->u_offset + i * sizeof(double);
  return count;
}

static double load_place(const fg_report_field *field, const void *object, size_t offset) {
  const char *place = (const char *)object + offset;
  size_t whole;
  double value;
  if (field->kind == FG_FIELD_COUNT) {
    memcpy(&whole, place, sizeof whole);
    return (double)whole;
  }
  memcpy(&value, place, sizeof value);
  return value;
}

static void store_place(const fg_report_field *field, void *object, size_t offset, double value) {
  char *place = (char *)object + offset;
  size_t whole = value >= 0 ? (size_t)value : 0;
  if (field->kind == FG_FIELD_COUNT)
    memcpy(place, &whole, sizeof whole);
  else
    memcpy(place, &value, sizeof value);
}

static void write_values(fg_json *json, fg_report_owner owner, const void *object) {
  size_t count, offset[PLACES_MAX];
  const fg_report_field *fields = fg_report_fields(owner, &count);
  fg_json_array(json, "values");
  for (size_t i = 0; i < count; i++) {
    size_t places = places_of(&fields[i], offset);
    for (size_t k = 0; k < places; k++)
      fg_json_number(json, NULL, load_place(&fields[i], object, offset[k]));
  }
  fg_json_array_end(json);
}

static void write_flags(fg_json *json, const fg_flag_words *words, unsigned flags) {
  fg_json_array(json, "flags");
  for (; words->name; words++)
    if (flags & words->flag) fg_json_string(json, NULL, words->name);
  fg_json_array_end(json);
}

static void write_foil(fg_json *json, const fg_foil *foil) {
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", foil->number);
  write_flags(json, fg_foil_flag_words(), foil->flags);
  fg_json_string(json, "error", foil->error[0] ? foil->error : NULL);
  write_values(json, FG_REPORT_FOIL, foil);
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < foil->bump_count; i++) {
    fg_json_object(json, NULL);
    fg_json_integer(json, "number", foil->bumps[i].number);
    write_flags(json, fg_bump_flag_words(), foil->bumps[i].flags);
    write_values(json, FG_REPORT_BUMP, &foil->bumps[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

fg_status fg_record_format(fg_context *ctx, const fg_record *record,
                           const fg_measurement *measurement, char **line, size_t *length) {
  fg_json json;
  *line = NULL;
  FILE *out = open_memstream(line, length);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
  fg_json_begin(&json, out);
  fg_json_line(&json);
  fg_json_object(&json, NULL);
  fg_json_string(&json, "scan", record->scan);
  fg_json_string(&json, "sha256", record->sha256[0] ? record->sha256 : NULL);
  fg_json_string(&json, "measured_with", record->measured_with);
  fg_json_string(&json, "error", measurement ? NULL : record->error);
  fg_json_array(&json, "foils");
  for (size_t i = 0; measurement && i < measurement->foil_count; i++)
    write_foil(&json, &measurement->foils[i]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return FG_OK;
  free(*line);
  *line = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
}

static fg_status fail_record(fg_context *ctx, const char *what) {
  return fg_fail(ctx, FG_ERR_DATA, "not a record of a lot: %s", what);
}

static const cJSON *member(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name);
}

static fg_status read_flags(fg_context *ctx, const cJSON *object, const fg_flag_words *words,
                            unsigned *flags) {
  const cJSON *list = member(object, "flags"), *name;
  *flags = 0;
  if (!cJSON_IsArray(list)) return fail_record(ctx, "no flags");
  cJSON_ArrayForEach(name, list) {
    const fg_flag_words *row = words;
    while (row->name && !(cJSON_IsString(name) && !strcmp(name->valuestring, row->name)))
      row++;
    if (!row->name) return fail_record(ctx, "an unknown flag");
    *flags |= row->flag;
  }
  return FG_OK;
}

static fg_status read_values(fg_context *ctx, const cJSON *object, fg_report_owner owner,
                             void *target) {
  size_t count, offset[PLACES_MAX];
  const fg_report_field *fields = fg_report_fields(owner, &count);
  const cJSON *values = member(object, "values");
  const cJSON *value = cJSON_IsArray(values) ? values->child : NULL;
  for (size_t i = 0; i < count; i++) {
    size_t places = places_of(&fields[i], offset);
    for (size_t k = 0; k < places; k++) {
      if (!value) return fail_record(ctx, "values are missing");
      store_place(&fields[i], target, offset[k], cJSON_IsNumber(value) ? value->valuedouble : NAN);
      value = value->next;
    }
  }
  return value ? fail_record(ctx, "too many values") : FG_OK;
}

static fg_status read_number(fg_context *ctx, const cJSON *object, int *number) {
  const cJSON *value = member(object, "number");
  if (!cJSON_IsNumber(value)) return fail_record(ctx, "no number");
  *number = value->valueint;
  return FG_OK;
}

static fg_status read_foil(fg_context *ctx, const cJSON *object, fg_foil *foil) {
  const cJSON *error = member(object, "error"), *bumps = member(object, "bumps"), *bump;
  void *block;
  FG_TRY(read_number(ctx, object, &foil->number));
  FG_TRY(read_flags(ctx, object, fg_foil_flag_words(), &foil->flags));
  FG_TRY(read_values(ctx, object, FG_REPORT_FOIL, foil));
  if (cJSON_IsString(error))
    fg_text_clip(foil->error, sizeof foil->error, "%s", error->valuestring);
  if (!cJSON_IsArray(bumps)) return fail_record(ctx, "no bumps");
  FG_TRY(fg_memory_allocate(ctx, (size_t)cJSON_GetArraySize(bumps), sizeof *foil->bumps, &block));
  foil->bumps = block;
  cJSON_ArrayForEach(bump, bumps) {
    fg_bump *target = &foil->bumps[foil->bump_count++];
    FG_TRY(read_number(ctx, bump, &target->number));
    FG_TRY(read_flags(ctx, bump, fg_bump_flag_words(), &target->flags));
    FG_TRY(read_values(ctx, bump, FG_REPORT_BUMP, target));
  }
  return FG_OK;
}

static fg_status read_sum(fg_context *ctx, const cJSON *value, char sum[65]) {
  if (!cJSON_IsString(value)) return FG_OK;
  if (strlen(value->valuestring) != 64) return fail_record(ctx, "a checksum of another length");
  strcpy(sum, value->valuestring);
  return FG_OK;
}

static fg_status copy_words(fg_context *ctx, const cJSON *value, char **copy) {
  if (!cJSON_IsString(value)) return FG_OK;
  *copy = strdup(value->valuestring);
  return *copy ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
}

static fg_status read_head(fg_context *ctx, const cJSON *root, fg_record *record) {
  FG_TRY(copy_words(ctx, member(root, "scan"), &record->scan));
  FG_TRY(read_sum(ctx, member(root, "sha256"), record->sha256));
  FG_TRY(read_sum(ctx, member(root, "measured_with"), record->measured_with));
  FG_TRY(copy_words(ctx, member(root, "error"), &record->error));
  if (!record->scan || !record->measured_with[0] || !cJSON_IsArray(member(root, "foils")))
    return fail_record(ctx, "members are missing");
  return FG_OK;
}

static fg_status read_foils(fg_context *ctx, const cJSON *root, fg_record *record) {
  const cJSON *foils = member(root, "foils"), *foil;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, (size_t)cJSON_GetArraySize(foils), sizeof *record->foils, &block));
  record->foils = block;
  cJSON_ArrayForEach(foil, foils)
      FG_TRY(read_foil(ctx, foil, &record->foils[record->foil_count++]));
  return FG_OK;
}

static fg_status parse(fg_context *ctx, const char *line, bool all, fg_record *record) {
  *record = (fg_record){0};
  cJSON *root = cJSON_Parse(line);
  if (!root) return fail_record(ctx, "not JSON");
  fg_status status = read_head(ctx, root, record);
  if (status == FG_OK && all) status = read_foils(ctx, root, record);
  cJSON_Delete(root);
  if (status != FG_OK) fg_record_free(record);
  return status;
}

fg_status fg_record_parse_head(fg_context *ctx, const char *line, fg_record *record) {
  return parse(ctx, line, false, record);
}

fg_status fg_record_parse(fg_context *ctx, const char *line, fg_record *record) {
  return parse(ctx, line, true, record);
}

void fg_record_free(fg_record *record) {
  for (size_t i = 0; i < record->foil_count; i++)
    free(record->foils[i].bumps);
  free(record->foils);
  free(record->scan);
  free(record->error);
  *record = (fg_record){0};
}

static void write_names(fg_json *json, const char *name, fg_report_owner owner) {
  size_t count;
  const fg_report_field *fields = fg_report_fields(owner, &count);
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++) {
    bool pair = fields[i].kind == FG_FIELD_PAIR;
    for (int side = 0; side < (fields[i].u_offset == FG_NO_UNCERTAINTY ? 1 : 2); side++)
      for (int axis = 0; axis < (pair ? 2 : 1); axis++) {
        char text[96];
        snprintf(text, sizeof text, "%s%s%s", side ? "u_" : "", fields[i].name,
                 pair ? (axis ? "[1]" : "[0]") : "");
        fg_json_string(json, NULL, text);
      }
  }
  fg_json_array_end(json);
}

void fg_record_write_names(fg_json *json) {
  write_names(json, "foil_values", FG_REPORT_FOIL);
  write_names(json, "bump_values", FG_REPORT_BUMP);
}
