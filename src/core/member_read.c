/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/member_read.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "core/text.h"

enum { READ_WORDS = 900, NAME_SHOWN = 60 };

/* Whole numbers without limits of their own: those that a double holds exactly, and those of int.
 */
static const double whole_max = 9007199254740992.0, int_max = 2147483647;

static void join_place(char place[FG_READING_PLACE], const fg_reading *reading, const char *name) {
  bool dot = reading->place[0] && name && name[0] != '[';
  fg_text_clip(place, FG_READING_PLACE, "%s%s%.*s", reading->place, dot ? "." : "", NAME_SHOWN,
               name ? name : "");
}

fg_reading fg_reading_inside(const fg_reading *reading, const char *name) {
  fg_reading inside = *reading;
  join_place(inside.place, reading, name);
  return inside;
}

fg_status fg_reading_fail(const fg_reading *reading, const char *name, const char *format, ...) {
  char words[READ_WORDS], place[FG_READING_PLACE];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(words, sizeof words, format, arguments);
  va_end(arguments);
  join_place(place, reading, name);
  return fg_fail(reading->ctx, FG_ERR_DATA, "%s%s%s%s%s", reading->path ? reading->path : "",
                 reading->path ? ": " : "", place, place[0] ? reading->between : "", words);
}

static void add_name(char *list, size_t size, const char *name) {
  size_t used = strlen(list);
  fg_text_clip(list + used, size - used, "%s%s", used ? ", " : "", name);
}

/* A short object's members are told where it is none. */
enum { NAMES_TOLD_MAX = 4 };

static void list_names(const fg_members *members, char *list, size_t size) {
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i];
    if (row->kind == FG_MEMBER_SAME)
      list_names(row->members, list, size);
    else if (!(row->options & FG_MEMBER_NOT_IN_JSON))
      add_name(list, size, row->kind == FG_MEMBER_HEAD ? "schema" : row->name);
  }
}

/* Words are quoted: "mid", "inner" or "outer". */
static void list_choices(const fg_member *member, char *list, size_t size) {
  list[0] = '\0';
  for (size_t i = 0; fg_member_choice_at(member, i); i++) {
    bool last = i && !fg_member_choice_at(member, i + 1);
    size_t used = strlen(list);
    fg_text_clip(list + used, size - used, "%s\"%s\"",
                 last ? " or "
                 : i  ? ", "
                      : "",
                 fg_member_choice_at(member, i));
  }
}

static bool is_whole(fg_member_kind kind) {
  return kind != FG_MEMBER_NUMBER;
}

static void store_number(fg_member_kind kind, void *place, double value) {
  if (kind == FG_MEMBER_NUMBER) *(double *)place = value;
  if (kind == FG_MEMBER_COUNT) *(size_t *)place = (size_t)value;
  if (kind == FG_MEMBER_INTEGER) *(int *)place = (int)value;
  if (kind == FG_MEMBER_UNSIGNED) *(unsigned *)place = (unsigned)value;
  if (kind == FG_MEMBER_SEED) *(uint64_t *)place = (uint64_t)value;
}

static fg_status check_limits(const fg_reading *reading, const fg_member *member, double value) {
  bool limited = member->highest > member->lowest, whole = is_whole(member->kind);
  bool is_int = member->kind == FG_MEMBER_INTEGER;
  double highest = limited ? member->highest : is_int ? int_max : whole ? whole_max : INFINITY;
  double lowest = limited ? member->lowest : is_int ? -int_max : whole ? 0 : -INFINITY;
  if (member->options & FG_MEMBER_ABOVE_0 && !(value > 0))
    return fg_reading_fail(reading, member->name, "is %g; it must be above 0", value);
  if (value >= lowest && value <= highest && (!whole || value == floor(value))) return FG_OK;
  return fg_reading_fail(reading, member->name, "is %g; it must be a %snumber from %g to %g", value,
                         whole ? "whole " : "", lowest, highest);
}

/* null gives 0 where the row writes 0 as null. */
static bool may_be_null(const fg_member *member) {
  unsigned null = FG_MEMBER_NULLABLE | FG_MEMBER_EMPTY_IS_NULL;
  return member->options & null && !(member->options & FG_MEMBER_LEFT_OUT);
}

static fg_status read_number(const fg_reading *reading, const fg_member *member, const cJSON *item,
                             void *place) {
  double value = item->valuedouble;
  if (may_be_null(member) && cJSON_IsNull(item)) {
    store_number(member->kind, place, 0);
    return FG_OK;
  }
  if (!cJSON_IsNumber(item)) return fg_reading_fail(reading, member->name, "must be a number");
  if (!isfinite(value)) return fg_reading_fail(reading, member->name, "the number is too large");
  FG_TRY(check_limits(reading, member, value));
  store_number(member->kind, place, value);
  return FG_OK;
}

static fg_status read_flag(const fg_reading *reading, const fg_member *member, const cJSON *item,
                           void *place) {
  if (!cJSON_IsBool(item)) return fg_reading_fail(reading, member->name, "must be true or false");
  *(bool *)place = cJSON_IsTrue(item);
  return FG_OK;
}

static fg_status read_text(const fg_reading *reading, const fg_member *member, const cJSON *item,
                           void *place) {
  if (may_be_null(member) && cJSON_IsNull(item)) {
    *(char *)place = '\0';
    return FG_OK;
  }
  if (!cJSON_IsString(item))
    return fg_reading_fail(reading, member->name, "must be a text in quotes");
  const char *text = item->valuestring;
  if (strlen(text) >= member->stride)
    return fg_reading_fail(reading, member->name, "is too long; at most %zu bytes",
                           member->stride - 1);
  for (const char *c = text; *c && !(member->options & FG_MEMBER_ANY_TEXT); c++)
    if (iscntrl((unsigned char)*c))
      return fg_reading_fail(reading, member->name, "holds a control character");
  strcpy(place, text);
  return FG_OK;
}

static fg_status read_word(const fg_reading *reading, const fg_member *member, const cJSON *item,
                           void *place) {
  char choices[READ_WORDS];
  for (int i = 0; cJSON_IsString(item) && fg_member_choice_at(member, (size_t)i); i++)
    if (!strcmp(item->valuestring, fg_member_choice_at(member, (size_t)i))) {
      *(int *)place = i;
      return FG_OK;
    }
  list_choices(member, choices, sizeof choices);
  return fg_reading_fail(reading, member->name, "must be %s", choices);
}

static fg_status read_numbers(const fg_reading *reading, const fg_member *member, const cJSON *item,
                              void *object) {
  double *values = (double *)(void *)((char *)object + member->offset);
  size_t *count = (size_t *)(void *)((char *)object + member->count_offset);
  const fg_reading inside = fg_reading_inside(reading, member->name);
  if (!cJSON_IsArray(item))
    return fg_reading_fail(reading, member->name, "must be an array of numbers");
  *count = 0;
  for (const cJSON *each = item->child; each; each = each->next) {
    char name[24];
    snprintf(name, sizeof name, "[%zu]", *count);
    const fg_member element = {.name = name, .kind = FG_MEMBER_NUMBER};
    if ((double)*count >= member->highest)
      return fg_reading_fail(reading, member->name, "more than %g numbers", member->highest);
    FG_TRY(read_number(&inside, &element, each, &values[*count]));
    (*count)++;
  }
  return FG_OK;
}

static fg_status check_doubled(const fg_reading *reading, const cJSON *object, const cJSON *item) {
  if (cJSON_GetObjectItemCaseSensitive(object, item->string) == item) return FG_OK;
  return fg_reading_fail(reading, item->string, "is given twice");
}

static fg_status fail_empty(const fg_reading *reading, const fg_member *member) {
  char known[READ_WORDS] = "";
  list_names(member->members, known, sizeof known);
  return fg_reading_fail(reading, NULL, "must be an object with at least one of %s", known);
}

static fg_status read_key(const fg_reading *reading, const fg_member *member, const cJSON *item,
                          char *element) {
  if (!item->string[0] || strlen(item->string) >= member->key_size)
    return fg_reading_fail(reading, item->string, "a name has 1 to %zu bytes",
                           member->key_size - 1);
  strcpy(element + member->key_offset, item->string);
  return FG_OK;
}

/* Elements of a file replace those that the struct had. */
static fg_status read_list(const fg_reading *reading, const fg_member *member, const cJSON *item,
                           void *object) {
  bool map = member->kind == FG_MEMBER_MAP;
  char *first = (char *)object + member->offset;
  size_t *count = (size_t *)(void *)((char *)object + member->count_offset);
  const fg_reading inside = fg_reading_inside(reading, member->name);
  if (map ? !cJSON_IsObject(item) : !cJSON_IsArray(item))
    return fg_reading_fail(reading, member->name, "must be an %s", map ? "object" : "array");
  *count = 0;
  for (const cJSON *each = item->child; each; each = each->next) {
    char *element = first + *count * member->stride, name[24];
    snprintf(name, sizeof name, "[%zu]", *count);
    if ((double)*count >= member->highest)
      return fg_reading_fail(reading, member->name, "more than %g entries", member->highest);
    memset(element, 0, member->stride);
    if (member->fresh) memcpy(element, member->fresh, member->stride);
    if (map) FG_TRY(check_doubled(&inside, item, each));
    if (map) FG_TRY(read_key(&inside, member, each, element));
    const fg_reading part = fg_reading_inside(&inside, map ? each->string : name);
    if (member->options & FG_MEMBER_NOT_EMPTY && !each->child) return fail_empty(&part, member);
    FG_TRY(fg_object_read(&part, member->members, each, element));
    (*count)++;
  }
  return FG_OK;
}

fg_status fg_member_read(const fg_reading *reading, const fg_member *member, const cJSON *item,
                         void *object) {
  char *place = (char *)object + member->offset;
  fg_reading inside;
  if (member->read) return member->read(reading, member, item, object);
  switch (member->kind) {
  case FG_MEMBER_FLAG:
    return read_flag(reading, member, item, place);
  case FG_MEMBER_TEXT:
    return read_text(reading, member, item, place);
  case FG_MEMBER_WORD:
    return read_word(reading, member, item, place);
  case FG_MEMBER_NUMBERS:
    return read_numbers(reading, member, item, object);
  case FG_MEMBER_LIST:
  case FG_MEMBER_MAP:
    return read_list(reading, member, item, object);
  case FG_MEMBER_OBJECT:
    inside = fg_reading_inside(reading, member->name);
    return fg_object_read(&inside, member->members, item, place);
  case FG_MEMBER_HEAD:
    if (cJSON_IsString(item) && !strcmp(item->valuestring, member->name)) return FG_OK;
    return fg_reading_fail(reading, "schema", "must be \"%s\"", member->name);
  default:
    return member->kind <= FG_MEMBER_SEED ? read_number(reading, member, item, place) : FG_OK;
  }
}

static const fg_member *find_row_of(const fg_members *members, const char *name) {
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i], *found = NULL;
    if (row->kind == FG_MEMBER_SAME)
      found = find_row_of(row->members, name);
    else if (!strcmp(row->kind == FG_MEMBER_HEAD ? "schema" : row->name, name))
      found = row->options & FG_MEMBER_NOT_IN_JSON ? NULL : row;
    if (found) return found;
  }
  return NULL;
}

static fg_status check_required(const fg_reading *reading, const fg_members *members,
                                const cJSON *item) {
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i];
    const char *name = row->kind == FG_MEMBER_HEAD ? "schema" : row->name;
    if (row->kind == FG_MEMBER_SAME) FG_TRY(check_required(reading, row->members, item));
    if (!(row->kind == FG_MEMBER_HEAD || row->options & FG_MEMBER_REQUIRED)) continue;
    if (cJSON_GetObjectItemCaseSensitive(item, name)) continue;
    if (reading->place[0]) return fg_reading_fail(reading, NULL, "%s is missing", name);
    if (row->kind != FG_MEMBER_HEAD) return fg_reading_fail(reading, name, "is missing");
    return fg_reading_fail(reading, name, "is missing; it must be \"%s\"", row->name);
  }
  return FG_OK;
}

/* A document tells the program that wrote it beside its schema. */
static bool is_version(const fg_members *members, const char *name) {
  const fg_member *head = find_row_of(members, "schema");
  return !strcmp(name, "version") && head && head->kind == FG_MEMBER_HEAD &&
         !(head->options & FG_MEMBER_NO_VERSION);
}

fg_status fg_object_read(const fg_reading *reading, const fg_members *members, const cJSON *item,
                         void *object) {
  char known[READ_WORDS] = "";
  if (!cJSON_IsObject(item)) {
    if (members->count <= NAMES_TOLD_MAX) list_names(members, known, sizeof known);
    return fg_reading_fail(reading, NULL, "must be an object%s%s", *known ? " with " : "", known);
  }
  for (const cJSON *each = item->child; each; each = each->next) {
    const fg_member *row = find_row_of(members, each->string);
    FG_TRY(check_doubled(reading, item, each));
    if (!row && (reading->has_others || is_version(members, each->string))) continue;
    if (!row) {
      list_names(members, known, sizeof known);
      return fg_reading_fail(reading, each->string, "is not known; there are %s", known);
    }
    void *to = reading->object_of ? reading->object_of(row, object) : object;
    FG_TRY(fg_member_read(reading, row, each, to));
  }
  return check_required(reading, members, item);
}

static bool is_limited_number(const fg_member *row) {
  return row->kind <= FG_MEMBER_SEED && row->kind != FG_MEMBER_FLAG && !row->number &&
         row->highest > row->lowest;
}

fg_status fg_object_check(const fg_reading *reading, const fg_members *members,
                          const void *object) {
  for (size_t i = 0; i < members->count; i++) {
    const fg_member *row = &members->rows[i];
    const fg_subject subject = {.object = object};
    double value = fg_member_value(row, &subject);
    bool unknown = value == 0 && row->options & FG_MEMBER_EMPTY_IS_NULL;
    if (row->kind == FG_MEMBER_SAME) FG_TRY(fg_object_check(reading, row->members, object));
    if (row->kind == FG_MEMBER_OBJECT && !row->read) {
      const fg_reading inside = fg_reading_inside(reading, row->name);
      FG_TRY(fg_object_check(&inside, row->members, (const char *)object + row->offset));
    }
    if (is_limited_number(row) && !unknown) FG_TRY(check_limits(reading, row, value));
  }
  return FG_OK;
}
