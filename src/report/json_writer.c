#include "report/json_writer.h"

#include <math.h>
#include <string.h>

void fg_json_begin(fg_json *json, FILE *out) {
  *json = (fg_json){.out = out};
}

void fg_json_end(fg_json *json) {
  fputc('\n', json->out);
}

/* The Unicode standard's table 3-7: the first byte decides the range of the second. */
size_t fg_utf8_length(const char *text) {
  static const struct {
    unsigned char first_low, first_high, second_low, second_high;
    size_t length;
  } forms[] = {
      {0xC2, 0xDF, 0x80, 0xBF, 2}, {0xE0, 0xE0, 0xA0, 0xBF, 3}, {0xE1, 0xEC, 0x80, 0xBF, 3},
      {0xED, 0xED, 0x80, 0x9F, 3}, {0xEE, 0xEF, 0x80, 0xBF, 3}, {0xF0, 0xF0, 0x90, 0xBF, 4},
      {0xF1, 0xF3, 0x80, 0xBF, 4}, {0xF4, 0xF4, 0x80, 0x8F, 4},
  };
  const unsigned char *at = (const unsigned char *)text;
  if (at[0] < 0x80) return 1;
  for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
    if (at[0] < forms[i].first_low || at[0] > forms[i].first_high) continue;
    if (at[1] < forms[i].second_low || at[1] > forms[i].second_high) return 0;
    for (size_t k = 2; k < forms[i].length; k++)
      if (at[k] < 0x80 || at[k] > 0xBF) return 0;
    return forms[i].length;
  }
  return 0;
}

static void put_character(FILE *out, const char *text, size_t length) {
  unsigned char first = (unsigned char)*text;
  if (length == 0)
    fputs("\xEF\xBF\xBD", out);
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

/* The comma and the line before a value, and its name. */
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
  if (!isfinite(value)) {
    strcpy(text, "null");
    return;
  }
  snprintf(text, 32, "%.10g", value + 0.0); /* + 0.0: never "-0" */
  char *comma = strchr(text, ',');          /* a host program's locale */
  if (comma) *comma = '.';
}

void fg_json_number(fg_json *json, const char *name, double value) {
  char text[32];
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
