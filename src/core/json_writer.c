/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/json_writer.h"

#include <math.h>
#include <string.h>

#include "core/digits.h"

void fg_json_begin(fg_json *json, FILE *out) {
  *json = (fg_json){.out = out};
}

void fg_json_end(fg_json *json) {
  fputc('\n', json->out);
}

static void put_character(FILE *out, const char *text, size_t length) {
  unsigned char first = (unsigned char)*text;
  if (length == 0)
    fprintf(out, "\\\\x%02X", first);
  else if (length > 1)
    fwrite(text, 1, length, out);
  else if (first == '"' || first == '\\')
    fprintf(out, "\\%c", first);
  else if (first < 0x20 || first == 0x7F)
    fprintf(out, "\\u%04x", first);
  else
    fputc(first, out);
}

static void put_string(FILE *out, const char *text) {
  fputc('"', out);
  while (*text) {
    size_t length = fg_utf8_length(text);
    put_character(out, text, length);
    text += length ? length : 1;
  }
  fputc('"', out);
}

/* Writes the comma, the line and the name before a value. */
static void put_place(fg_json *json, const char *name) {
  if (json->has_members) fputs(json->line_depth ? ", " : ",", json->out);
  if (json->depth > 0 && json->line_depth == 0) fprintf(json->out, "\n%*s", json->depth, "");
  if (name) {
    put_string(json->out, name);
    fputs(": ", json->out);
  }
  json->has_members = true;
}

static void open_with(fg_json *json, const char *name, char bracket) {
  put_place(json, name);
  fputc(bracket, json->out);
  json->depth++;
  json->has_members = false;
}

static void close_with(fg_json *json, char bracket) {
  json->depth--;
  if (json->has_members && json->line_depth == 0) fprintf(json->out, "\n%*s", json->depth, "");
  fputc(bracket, json->out);
  json->has_members = true;
}

void fg_json_object(fg_json *json, const char *name) {
  open_with(json, name, '{');
}

void fg_json_object_end(fg_json *json) {
  close_with(json, '}');
}

void fg_json_array(fg_json *json, const char *name) {
  open_with(json, name, '[');
}

void fg_json_array_end(fg_json *json) {
  close_with(json, ']');
}

void fg_json_line(fg_json *json) {
  json->line_depth++;
}

void fg_json_line_end(fg_json *json) {
  json->line_depth--;
}

void fg_json_format(char text[32], double value) {
  if (isfinite(value))
    fg_digits_format(text, 10, value);
  else
    strcpy(text, "null");
}

void fg_json_number(fg_json *json, const char *name, double value) {
  char text[32];
  if (json->exact && isfinite(value))
    fg_digits_format_exactly(text, value);
  else
    fg_json_format(text, value);
  put_place(json, name);
  fputs(text, json->out);
}

void fg_json_integer(fg_json *json, const char *name, int64_t value) {
  put_place(json, name);
  fprintf(json->out, "%lld", (long long)value);
}

void fg_json_bool(fg_json *json, const char *name, bool value) {
  put_place(json, name);
  fputs(value ? "true" : "false", json->out);
}

void fg_json_string(fg_json *json, const char *name, const char *text) {
  put_place(json, name);
  if (text)
    put_string(json->out, text);
  else
    fputs("null", json->out);
}

void fg_json_numbers(fg_json *json, const char *name, const double *values, size_t count) {
  fg_json_array(json, name);
  fg_json_line(json);
  for (size_t i = 0; i < count; i++)
    fg_json_number(json, NULL, values[i]);
  fg_json_array_end(json);
  fg_json_line_end(json);
}

void fg_json_of(fg_json *json, const char *before, const char *name, double value) {
  char whole[96];
  snprintf(whole, sizeof whole, "%s%s", before, name);
  fg_json_number(json, whole, value);
}

void fg_json_head(fg_json *json, const char *schema) {
  fg_json_string(json, "schema", schema);
  fg_json_string(json, "version", FOILGAUGE_VERSION);
}
