/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/record.h"
#include "core/file.h"
#include "core/json_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/date.h"
#include "core/member.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/words.h"
#include "lot/run/seal.h"
#include "quantity/parts.h"
#include "quantity/quantity_rows.h"
#include "report/flag_names.h"

/* Highest number of a foil or of a part. More than any scan holds, and arrays by number stay small.
 */
enum { NUMBER_MAX = 10000 };

static void write_value_list(fg_json *json, fg_quantity_owner owner, const void *object) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  fg_json_array(json, "values");
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    size_t width = fg_quantity_numbers(&rows[i], object, numbers);
    for (size_t k = 0; k < width; k++)
      fg_json_number(json, NULL, numbers[k]);
  }
  fg_json_array_end(json);
}

static bool is_moved(const fg_calibrated *calibrated, size_t source) {
  for (size_t k = 0; k < FG_CALIBRATED_MAX; k++)
    if (calibrated->move[source][k] != 0) return true;
  return false;
}

/* Writes nothing where no calibration is stated. */
static void write_calibrated(fg_json *json, fg_quantity_owner owner,
                             const fg_calibrated *calibrated) {
  size_t sources = FG_CALIBRATION_SOURCES;
  while (sources > 0 && !is_moved(calibrated, sources - 1))
    sources--;
  if (!sources) return;
  fg_json_array(json, "calibrated");
  for (size_t s = 0; s < sources; s++)
    fg_json_numbers(json, NULL, calibrated->move[s], fg_quantity_moves(owner));
  fg_json_array_end(json);
}

static void write_flag_list(fg_json *json, const fg_flag_words *words, unsigned flags,
                            unsigned findings) {
  fg_json_array(json, "flags");
  fg_json_flag_names(json, words, flags, findings);
  fg_json_array_end(json);
}

static const fg_flag_words *part_flag_words(fg_quantity_owner owner) {
  return owner == FG_QUANTITY_OF_BEAM ? fg_beam_flag_words() : fg_bump_flag_words();
}

/* Parts are kept of foils of the design only; of other objects the whole is enough. */
static void write_parts(fg_json *json, const char *name, const fg_foil *foil,
                        fg_quantity_owner owner) {
  size_t count = fg_foil_is_measured(foil) ? fg_part_count(foil, owner) : 0;
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++) {
    const fg_foil_part part = fg_part_at(foil, owner, i);
    fg_json_object(json, NULL);
    fg_json_integer(json, "number", part.number);
    write_flag_list(json, part_flag_words(owner), part.flags, 0);
    write_value_list(json, owner, part.object);
    write_calibrated(json, owner, part.calibrated);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_measured_foil(fg_json *json, const fg_foil *foil) {
  fg_json_object(json, NULL);
  fg_json_integer(json, "number", foil->number);
  write_flag_list(json, fg_foil_flag_words(), foil->flags, foil->strip.picture.findings);
  fg_json_string(json, "error", foil->error[0] ? foil->error : NULL);
  write_value_list(json, FG_QUANTITY_OF_FOIL, foil);
  write_calibrated(json, FG_QUANTITY_OF_FOIL, &foil->calibrated);
  write_parts(json, "bumps", foil, FG_QUANTITY_OF_BUMP);
  if (foil->beam_count) write_parts(json, "beams", foil, FG_QUANTITY_OF_BEAM);
  fg_json_object_end(json);
}

/* JSON holds UTF-8, a file name any bytes. A name that is not UTF-8 is also written as hex digits,
 * so that it can be restored. *hex is NULL where that is not needed. */
static fg_status format_bytes(fg_context *ctx, const char *text, char **hex) {
  static const char digits[] = "0123456789abcdef";
  size_t length = strlen(text);
  void *block;
  *hex = NULL;
  if (fg_utf8_is_valid(text)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, length + 1, 2, &block));
  *hex = block;
  for (size_t i = 0; i < length; i++) {
    (*hex)[2 * i] = digits[(unsigned char)text[i] >> 4];
    (*hex)[2 * i + 1] = digits[(unsigned char)text[i] & 15];
  }
  return FG_OK;
}

/* A line of the journal, and the bytes of a scan's name as hex digits. */
typedef struct record_line {
  fg_record record;
  char *scan_bytes; /* NULL: the name is UTF-8 */
} record_line;

/* Members before the foils, as they are written and read. Those of early versions had no date. */
static const fg_member line_rows[] = {
    {FG_STRING("scan", record_line, record.scan)},
    {FG_STRING("scan_bytes", record_line, scan_bytes), .options = FG_MEMBER_LEFT_OUT},
    {FG_TEXT("sha256", record_line, record.sha256), .options = FG_MEMBER_EMPTY_IS_NULL},
    {FG_TEXT("date", record_line, record.date),
     .options = FG_MEMBER_EMPTY_IS_NULL | FG_MEMBER_LEFT_OUT},
    {FG_TEXT("measured_with", record_line, record.measured_with)},
    {FG_STRING("error", record_line, record.error)},
};
static const fg_members line_members = FG_MEMBERS(line_rows);

static void print_record(FILE *out, const record_line *line, const fg_measurement *measurement) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_line(&json);
  fg_json_object(&json, NULL);
  fg_members_json(&json, &line_members, &(fg_subject){.object = line});
  fg_json_array(&json, "foils");
  for (size_t i = 0; measurement && i < measurement->foil_count; i++)
    write_measured_foil(&json, &measurement->foils[i]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
}

fg_status fg_record_format(fg_context *ctx, const fg_record *record,
                           const fg_measurement *measurement, char **line, size_t *length) {
  record_line written = {.record = *record};
  *line = NULL;
  if (measurement) written.record.error = NULL;
  FG_TRY(format_bytes(ctx, record->scan, &written.scan_bytes));
  FILE *out = fg_stream_open(line, length);
  if (out) print_record(out, &written, measurement);
  free(written.scan_bytes);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
  if (fg_stream_keep(out, line)) return fg_seal_line(ctx, line, length);
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
}

static fg_status fail_record(fg_context *ctx, const char *what) {
  return fg_fail(ctx, FG_ERR_DATA, "not a record of a lot: %s", what);
}

static const cJSON *find_member(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name);
}

static unsigned find_flag(const fg_flag_words *words, const char *name) {
  while (words->name && strcmp(name, words->name))
    words++;
  return words->flag;
}

static unsigned find_finding(const char *name) {
  const fg_picture_words *words = fg_picture_finding_words();
  while (words->name && strcmp(name, words->name))
    words++;
  return words->finding;
}

/* `findings` is NULL for a part, which has none of its own. */
static fg_status restore_flags(fg_context *ctx, const cJSON *object, const fg_flag_words *words,
                               unsigned *flags, unsigned *findings) {
  const cJSON *list = find_member(object, "flags"), *item;
  *flags = 0;
  if (!cJSON_IsArray(list)) return fail_record(ctx, "no flags");
  cJSON_ArrayForEach(item, list) {
    const char *name = cJSON_IsString(item) ? item->valuestring : "";
    unsigned flag = find_flag(words, name), finding = findings ? find_finding(name) : 0;
    if (!flag && !finding) return fail_record(ctx, "an unknown flag");
    *flags |= flag;
    if (findings) *findings |= finding;
  }
  return FG_OK;
}

static fg_status restore_values(fg_context *ctx, const cJSON *object, fg_quantity_owner owner,
                                void *target) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  const cJSON *values = find_member(object, "values");
  const cJSON *value = cJSON_IsArray(values) ? values->child : NULL;
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    for (size_t k = 0; k < fg_quantity_width(&rows[i]); k++, value = value->next) {
      if (!value) return fail_record(ctx, "values are missing");
      if (cJSON_IsNumber(value) && !isfinite(value->valuedouble))
        return fail_record(ctx, "a value that is no number");
      numbers[k] = cJSON_IsNumber(value) ? value->valuedouble : NAN;
    }
    fg_quantity_restore(&rows[i], target, numbers);
  }
  return value ? fail_record(ctx, "too many values") : FG_OK;
}

static fg_status read_calibrated(fg_context *ctx, const cJSON *object, fg_quantity_owner owner,
                                 fg_calibrated *calibrated) {
  const cJSON *sources = find_member(object, "calibrated"), *source, *move;
  size_t s = 0;
  *calibrated = (fg_calibrated){.move = {{0}}};
  cJSON_ArrayForEach(source, sources) {
    size_t k = 0;
    if (s == FG_CALIBRATION_SOURCES || cJSON_GetArraySize(source) != (int)fg_quantity_moves(owner))
      return fail_record(ctx, "a calibration of another size");
    cJSON_ArrayForEach(move, source) {
      if (!cJSON_IsNumber(move) || !isfinite(move->valuedouble))
        return fail_record(ctx, "a calibration that is no number");
      calibrated->move[s][k++] = move->valuedouble;
    }
    s++;
  }
  return FG_OK;
}

static fg_status read_part_number(fg_context *ctx, const cJSON *object, int *number) {
  const cJSON *value = find_member(object, "number");
  double read = cJSON_IsNumber(value) ? value->valuedouble : NAN;
  if (!(read >= 0 && read <= NUMBER_MAX && read == floor(read)))
    return fail_record(ctx, "no number that a foil, bump or beam can have");
  *number = (int)read;
  return FG_OK;
}

/* Reads the members that every kind of part has. */
static fg_status restore_part(fg_context *ctx, const cJSON *object, fg_quantity_owner owner,
                              fg_foil_part *part, void *target, fg_calibrated *calibrated) {
  FG_TRY(read_part_number(ctx, object, &part->number));
  FG_TRY(restore_flags(ctx, object, part_flag_words(owner), &part->flags, NULL));
  FG_TRY(restore_values(ctx, object, owner, target));
  return read_calibrated(ctx, object, owner, calibrated);
}

static fg_status read_bumps(fg_context *ctx, const cJSON *bumps, fg_foil *foil) {
  const cJSON *bump;
  void *block;
  if (!cJSON_IsArray(bumps)) return fail_record(ctx, "no bumps");
  FG_TRY(fg_memory_allocate(ctx, (size_t)cJSON_GetArraySize(bumps), sizeof *foil->bumps, &block));
  foil->bumps = block;
  cJSON_ArrayForEach(bump, bumps) {
    fg_bump *target = &foil->bumps[foil->bump_count++];
    fg_foil_part part;
    FG_TRY(restore_part(ctx, bump, FG_QUANTITY_OF_BUMP, &part, target, &target->calibrated));
    target->number = part.number;
    target->flags = part.flags;
  }
  return FG_OK;
}

/* Reads the beams of a cantilever; other records have none. */
static fg_status read_beams(fg_context *ctx, const cJSON *beams, fg_foil *foil) {
  const cJSON *beam;
  void *block;
  if (!beams) return FG_OK;
  if (!cJSON_IsArray(beams)) return fail_record(ctx, "beams that are no list");
  FG_TRY(fg_memory_allocate(ctx, (size_t)cJSON_GetArraySize(beams), sizeof *foil->beams, &block));
  foil->beams = block;
  cJSON_ArrayForEach(beam, beams) {
    fg_beam *target = &foil->beams[foil->beam_count++];
    fg_foil_part part;
    FG_TRY(restore_part(ctx, beam, FG_QUANTITY_OF_BEAM, &part, target, &target->calibrated));
    target->number = part.number;
    target->flags = part.flags;
  }
  return FG_OK;
}

static fg_status restore_foil(fg_context *ctx, const cJSON *object, fg_foil *foil) {
  const cJSON *error = find_member(object, "error");
  FG_TRY(read_part_number(ctx, object, &foil->number));
  FG_TRY(restore_flags(ctx, object, fg_foil_flag_words(), &foil->flags,
                       &foil->strip.picture.findings));
  FG_TRY(restore_values(ctx, object, FG_QUANTITY_OF_FOIL, foil));
  FG_TRY(read_calibrated(ctx, object, FG_QUANTITY_OF_FOIL, &foil->calibrated));
  if (cJSON_IsString(error))
    fg_text_clip(foil->error, sizeof foil->error, "%s", error->valuestring);
  FG_TRY(read_bumps(ctx, find_member(object, "bumps"), foil));
  return read_beams(ctx, find_member(object, "beams"), foil);
}

/* Reads a member where it is a text; checksums and dates have one length. */
static fg_status read_line_member(fg_context *ctx, const fg_member *row, const cJSON *value,
                                  record_line *line) {
  char *place = (char *)line + row->offset;
  if (!cJSON_IsString(value)) return FG_OK;
  if (row->kind == FG_MEMBER_STRING) {
    char *copy = strdup(value->valuestring);
    *(char **)(void *)place = copy;
    return copy ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
  }
  if (strlen(value->valuestring) != row->stride - 1)
    return fail_record(ctx, "a checksum or a date of another length");
  strcpy(place, value->valuestring);
  return FG_OK;
}

static int hex_digit(char hex) {
  const char *digits = "0123456789abcdef", *at = hex ? strchr(digits, hex) : NULL;
  return at ? (int)(at - digits) : -1;
}

/* Restores a name that was written as bytes: in place, for it is half as long. */
static fg_status restore_name(fg_context *ctx, char *text) {
  size_t length = strlen(text);
  if (length == 0 || length % 2) return fail_record(ctx, "scan_bytes that are none");
  for (size_t i = 0; i < length / 2; i++) {
    int high = hex_digit(text[2 * i]), low = hex_digit(text[2 * i + 1]);
    if (high < 0 || low < 0 || high + low == 0) return fail_record(ctx, "scan_bytes that are none");
    text[i] = (char)(high << 4 | low);
  }
  text[length / 2] = '\0';
  return FG_OK;
}

static fg_status read_head(fg_context *ctx, const cJSON *root, fg_record *record) {
  record_line line = {.record = *record};
  fg_status status = FG_OK;
  for (size_t i = 0; i < line_members.count && status == FG_OK; i++)
    status = read_line_member(ctx, &line_rows[i], find_member(root, line_rows[i].name), &line);
  if (line.scan_bytes) {
    if (status == FG_OK) status = restore_name(ctx, line.scan_bytes);
    free(line.record.scan);
    line.record.scan = line.scan_bytes;
  }
  *record = line.record;
  FG_TRY(status);
  if (!record->scan || !record->measured_with[0] || !cJSON_IsArray(find_member(root, "foils")))
    return fail_record(ctx, "members are missing");
  return FG_OK;
}

static fg_status read_foils(fg_context *ctx, const cJSON *root, fg_record *record) {
  const cJSON *foils = find_member(root, "foils"), *foil;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, (size_t)cJSON_GetArraySize(foils), sizeof *record->foils, &block));
  record->foils = block;
  cJSON_ArrayForEach(foil, foils)
      FG_TRY(restore_foil(ctx, foil, &record->foils[record->foil_count++]));
  return FG_OK;
}

fg_status fg_record_parse(fg_context *ctx, const char *line, fg_record *record) {
  *record = (fg_record){0};
  if (!fg_seal_holds(line, strlen(line))) return fail_record(ctx, "its checksum does not hold");
  cJSON *root;
  fg_status status = fg_json_read(ctx, "a record of a lot", line, &root);
  if (status == FG_OK) status = read_head(ctx, root, record);
  if (status == FG_OK) status = read_foils(ctx, root, record);
  cJSON_Delete(root);
  if (status != FG_OK) fg_record_free(record);
  return status;
}

void fg_record_free(fg_record *record) {
  for (size_t i = 0; i < record->foil_count; i++) {
    free(record->foils[i].bumps);
    free(record->foils[i].beams); /* records hold no edges of beams */
  }
  free(record->foils);
  free(record->scan);
  free(record->error);
  *record = (fg_record){0};
}

static void write_value_names(fg_json *json, const char *name, fg_quantity_owner owner) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++) {
    bool pair = rows[i].kind == FG_QUANTITY_PAIR;
    size_t values = pair ? 2 : 1;
    for (size_t k = 0; k < fg_quantity_width(&rows[i]); k++) {
      char text[96];
      snprintf(text, sizeof text, "%s%s%s", k < values ? "" : "u_", rows[i].name,
               !pair             ? ""
               : k % values == 1 ? "[1]"
                                 : "[0]");
      fg_json_string(json, NULL, text);
    }
  }
  fg_json_array_end(json);
}

void fg_record_write_names(fg_json *json) {
  write_value_names(json, "foil_values", FG_QUANTITY_OF_FOIL);
  write_value_names(json, "bump_values", FG_QUANTITY_OF_BUMP);
  write_value_names(json, "beam_values", FG_QUANTITY_OF_BEAM);
}

fg_status fg_record_format_names(fg_context *ctx, char **text) {
  size_t size;
  fg_json json;
  *text = NULL;
  FILE *out = fg_stream_open(text, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the names of a record");
  fg_json_begin(&json, out);
  fg_json_line(&json);
  fg_json_object(&json, NULL);
  fg_record_write_names(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  if (fg_stream_keep(out, text)) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the names of a record");
}
