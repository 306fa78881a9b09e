/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members as JSON. */
#include <math.h>

#include "core/member.h"

static void write_null(fg_json *json, const char *name) {
  fg_json_string(json, name, NULL);
}

static bool is_left_out(const fg_member *member, bool known) {
  return !known && member->options & FG_MEMBER_LEFT_OUT;
}

static double number_at(const fg_subject *subject, size_t offset) {
  return *(const double *)(const void *)((const char *)subject->object + offset);
}

static void write_number(fg_json *json, const fg_member *member, const fg_subject *subject) {
  const char *name = member->name;
  double value = fg_member_value(member, subject);
  if (value == 0 && member->options & FG_MEMBER_EMPTY_IS_NULL) value = NAN;
  if (is_left_out(member, isfinite(value))) return;
  fg_json_number(json, name, value);
  if (member->sd_offset) fg_json_of(json, "sd_", name, number_at(subject, member->sd_offset));
  if (fg_member_has_u(member)) fg_json_of(json, "u_", name, fg_member_u(member, subject));
  if (member->repeat_offset)
    fg_json_of(json, "u_repeat_", name, number_at(subject, member->repeat_offset));
}

/* A double would lose digits. */
static int64_t seed_at(const fg_member *member, const fg_subject *subject) {
  return (int64_t) *
         (const uint64_t *)(const void *)((const char *)subject->object + member->offset);
}

static void write_whole_number(fg_json *json, const fg_member *member, const fg_subject *subject) {
  double value = fg_member_value(member, subject);
  bool known = isfinite(value) && !(value == 0 && member->options & FG_MEMBER_EMPTY_IS_NULL);
  if (is_left_out(member, known)) return;
  if (!known)
    write_null(json, member->name);
  else if (member->kind == FG_MEMBER_SEED)
    fg_json_integer(json, member->name, seed_at(member, subject));
  else if (member->kind == FG_MEMBER_FLAG)
    fg_json_bool(json, member->name, value != 0);
  else
    fg_json_integer(json, member->name, (int64_t)value);
}

static void write_text(fg_json *json, const fg_member *member, const fg_subject *subject) {
  char buffer[FG_MEMBER_TEXT_MAX];
  const char *text = fg_member_text(member, subject, buffer);
  if (!is_left_out(member, text != NULL)) fg_json_string(json, member->name, text);
}

static void write_range(fg_json *json, const fg_member *member, const fg_subject *subject) {
  const double range[] = {number_at(subject, member->offset), number_at(subject, member->u_offset)};
  if (is_left_out(member, isfinite(range[0]) || isfinite(range[1]))) return;
  fg_json_numbers(json, member->name, range, 2);
}

static void write_pair(fg_json *json, const fg_member *member, const fg_subject *subject) {
  char u_name[96];
  const char *object = subject->object;
  fg_json_numbers(json, member->name, (const double *)(const void *)(object + member->offset), 2);
  if (!member->u_offset) return;
  snprintf(u_name, sizeof u_name, "u_%s", member->name);
  fg_json_numbers(json, u_name, (const double *)(const void *)(object + member->u_offset), 2);
}

static void write_numbers(fg_json *json, const fg_member *member, const fg_subject *subject) {
  double buffer[FG_MEMBER_NUMBERS_MAX];
  const char *object = subject->object;
  const double *values = (const double *)(const void *)(object + member->offset);
  size_t count = (size_t)member->highest;
  if (member->numbers)
    values = member->numbers(subject, buffer, &count);
  else if (member->count_offset)
    count = *(const size_t *)(const void *)(object + member->count_offset);
  if (!count && member->options & FG_MEMBER_NULLABLE)
    write_null(json, member->name);
  else if (!is_left_out(member, count > 0))
    fg_json_numbers(json, member->name, values, count);
}

static void write_texts(fg_json *json, const fg_member *member, const fg_subject *subject) {
  const char *text;
  bool line = member->options & FG_MEMBER_ON_LINE;
  fg_json_array(json, member->name);
  if (line) fg_json_line(json);
  for (size_t i = 0; (text = member->text_at(subject, i)) != NULL; i++)
    if (*text) fg_json_string(json, NULL, text);
  fg_json_array_end(json);
  if (line) fg_json_line_end(json);
}

typedef enum line_style { LINES, ONE_LINE, ONE_LINE_ENDS_BELOW } line_style;

static line_style style_of(const fg_member *member, bool line) {
  return !line ? LINES : member->options & FG_MEMBER_ENDS_BELOW ? ONE_LINE_ENDS_BELOW : ONE_LINE;
}

static line_style line_of_list(const fg_member *member) {
  return style_of(member, member->options & FG_MEMBER_LIST_ON_LINE);
}

/* Returns the style of an object, or of an element of a list. */
static line_style line_of(const fg_member *member, const fg_subject *subject) {
  return style_of(member,
                  member->line ? member->line(subject) : member->options & FG_MEMBER_ON_LINE);
}

/* Closes an object or array; `close` NULL: none is open. */
static void close_line(fg_json *json, line_style line, void (*close)(fg_json *)) {
  if (line == ONE_LINE_ENDS_BELOW) fg_json_line_end(json);
  if (close) close(json);
  if (line == ONE_LINE) fg_json_line_end(json);
}

/* Writes an object under a name; one nameless member is written bare in its place, as the name's
 * value. */
static void write_members(fg_json *json, const char *name, const fg_members *members,
                          const fg_subject *subject, line_style line) {
  if (members->count == 1 && !members->rows[0].name && members->rows[0].kind != FG_MEMBER_SAME) {
    fg_member row = members->rows[0];
    row.name = name;
    fg_member_json(json, &row, subject);
    return;
  }
  fg_json_object(json, name);
  if (line) fg_json_line(json);
  fg_members_json(json, members, subject);
  close_line(json, line, fg_json_object_end);
}

static void write_object(fg_json *json, const fg_member *member, const fg_subject *subject) {
  const fg_subject part = fg_member_part(member, subject);
  if (part.object)
    write_members(json, member->name, member->members, &part, line_of(member, &part));
  else if (!is_left_out(member, false))
    write_null(json, member->name);
}

static const char *find_key(const fg_member *member, const fg_subject *element) {
  if (member->kind != FG_MEMBER_MAP) return NULL;
  if (member->key) return member->key(element);
  return (const char *)element->object + member->key_offset;
}

static void write_list(fg_json *json, const fg_member *member, const fg_subject *subject) {
  bool map = member->kind == FG_MEMBER_MAP, open = !map || member->name;
  fg_subject element;
  if (is_left_out(member, fg_member_element_at(member, subject, 0, &element))) return;
  if (open) (map ? fg_json_object : fg_json_array)(json, member->name);
  if (line_of_list(member)) fg_json_line(json);
  for (size_t i = 0; fg_member_element_at(member, subject, i, &element); i++)
    if (element.object)
      write_members(json, find_key(member, &element), member->members, &element,
                    line_of(member, &element));
  close_line(json, line_of_list(member),
             open ? map ? fg_json_object_end : fg_json_array_end : NULL);
}

static void write_same(fg_json *json, const fg_member *member, const fg_subject *subject) {
  const fg_subject part = fg_member_part(member, subject);
  fg_member row;
  if (!part.object) return;
  for (size_t i = 0; member->row_at && member->row_at(i, &row); i++)
    fg_member_json(json, &row, &part);
  if (member->members) fg_members_json(json, member->members, &part);
}

static void write_head(fg_json *json, const fg_member *member, const fg_subject *subject) {
  (void)subject;
  if (member->options & FG_MEMBER_NO_VERSION)
    fg_json_string(json, "schema", member->name);
  else
    fg_json_head(json, member->name);
}

static void write_by_function(fg_json *json, const fg_member *member, const fg_subject *subject) {
  member->write(json, member->name, subject);
}

typedef void writer(fg_json *json, const fg_member *member, const fg_subject *subject);

static writer *const writers[] = {
    [FG_MEMBER_NUMBER] = write_number,
    [FG_MEMBER_COUNT] = write_whole_number,
    [FG_MEMBER_INTEGER] = write_whole_number,
    [FG_MEMBER_UNSIGNED] = write_whole_number,
    [FG_MEMBER_SEED] = write_whole_number,
    [FG_MEMBER_FLAG] = write_whole_number,
    [FG_MEMBER_TEXT] = write_text,
    [FG_MEMBER_STRING] = write_text,
    [FG_MEMBER_WORD] = write_text,
    [FG_MEMBER_RANGE] = write_range,
    [FG_MEMBER_PAIR] = write_pair,
    [FG_MEMBER_NUMBERS] = write_numbers,
    [FG_MEMBER_TEXTS] = write_texts,
    [FG_MEMBER_OBJECT] = write_object,
    [FG_MEMBER_LIST] = write_list,
    [FG_MEMBER_MAP] = write_list,
    [FG_MEMBER_SAME] = write_same,
    [FG_MEMBER_HEAD] = write_head,
    [FG_MEMBER_WRITTEN] = write_by_function,
};

void fg_member_json(fg_json *json, const fg_member *member, const fg_subject *subject) {
  bool exact = json->exact;
  if (member->options & FG_MEMBER_NOT_IN_JSON || !fg_member_is_present(member, subject)) return;
  json->exact = exact || member->options & FG_MEMBER_EXACT;
  (member->write ? write_by_function : writers[member->kind])(json, member, subject);
  json->exact = exact;
}

void fg_members_json(fg_json *json, const fg_members *members, const fg_subject *subject) {
  for (size_t i = 0; i < members->count; i++)
    fg_member_json(json, &members->rows[i], subject);
}

void fg_document_json(FILE *out, const fg_members *members, const void *whole) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_members_json(&json, members, &(fg_subject){.object = whole, .whole = whole});
  fg_json_object_end(&json);
  fg_json_end(&json);
}
