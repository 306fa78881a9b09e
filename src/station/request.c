/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of a query or an html form. */
#include <string.h>

#include "core/utf8.h"
#include "station/request.h"

static int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  c |= 0x20;
  return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* One byte of text from its encoding; -1: it is none. */
static int decode(const char **at, const char *end) {
  char c = *(*at)++;
  if (c == '+') return ' ';
  if (c != '%') return (unsigned char)c;
  if (end - *at < 2) return -1;
  int high = hex_digit((*at)[0]), low = hex_digit((*at)[1]);
  *at += 2;
  return high < 0 || low < 0 ? -1 : high << 4 | low;
}

static bool is_clean(const char *text) {
  while (*text) {
    size_t length = fg_utf8_length(text);
    if (!length || (unsigned char)*text < ' ' || *text == 0x7f) return false;
    text += length;
  }
  return true;
}

/* All of it decoded; false: too long, or not as it should be. */
static bool read_all(const char *at, const char *end, char *text, size_t size) {
  size_t length = 0;
  while (at < end) {
    int byte = decode(&at, end);
    if (byte <= 0 || length + 1 >= size) return false;
    text[length++] = (char)byte;
  }
  text[length] = '\0';
  return is_clean(text);
}

static bool read_field_text(const char *encoded, char *text, size_t size) {
  return read_all(encoded, encoded + strlen(encoded), text, size);
}

/* Reads up to `stop` or the next field. */
static bool read_part(const char **at, const char *end, char stop, char *text, size_t size) {
  const char *from = *at;
  while (*at < end && **at != stop && **at != '&')
    (*at)++;
  return read_all(from, *at, text, size);
}

bool fg_request_add_field(fg_request *request, const char *name, const char *value) {
  if (request->fields == FG_FIELDS_MAX) return false;
  fg_field *field = &request->field[request->fields];
  /* The separators are split off already; a character that looks like one is text. */
  if (!read_field_text(name, field->name, sizeof field->name) ||
      !read_field_text(value ? value : "", field->value, sizeof field->value))
    return false;
  request->fields += field->name[0] != '\0';
  return true;
}

bool fg_request_read_fields(fg_request *request, const char *text, size_t length) {
  const char *end = text + length;
  while (text < end) {
    if (request->fields == FG_FIELDS_MAX) return false;
    fg_field *field = &request->field[request->fields];
    field->value[0] = '\0';
    if (!read_part(&text, end, '=', field->name, sizeof field->name)) return false;
    if (text < end && *text == '=') {
      text++;
      if (!read_part(&text, end, '&', field->value, sizeof field->value)) return false;
    }
    request->fields += field->name[0] != '\0';
    if (text < end) text++;
  }
  return true;
}

fg_status fg_request_read_text(fg_context *ctx, const char *what, const char *given, char *text,
                               size_t size) {
  given += strspn(given, " ");
  size_t length = strlen(given);
  while (length && given[length - 1] == ' ')
    length--;
  if (length >= size)
    return fg_fail(ctx, FG_ERR_DATA, "The %s is too long: at most %zu bytes.", what, size - 1);
  memcpy(text, given, length);
  text[length] = '\0';
  return FG_OK;
}

const char *fg_request_get(const fg_request *request, const char *name) {
  for (size_t i = 0; i < request->fields; i++)
    if (!strcmp(request->field[i].name, name)) return request->field[i].value;
  return "";
}
