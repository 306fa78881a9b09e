/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/csv.h"

#include <math.h>
#include <string.h>

#include "core/json_writer.h"

static bool begins_formula(const char *text, size_t length) {
  size_t at = 0;
  while (at < length && text[at] == '\'')
    at++;
  return at < length && memchr("=+-@\t\r", text[at], 6) != NULL;
}

bool fg_csv_needs_apostrophe(const char *text) {
  size_t length = strlen(text);
  if (!begins_formula(text, length)) return false;
  fg_csv_number kind = fg_csv_number_kind(text, length);
  return kind == FG_CSV_WORD || kind == FG_CSV_THOUSANDS;
}

/* Blanks at the ends need quotes, as a reader would drop them. */
bool fg_csv_needs_quotes(const char *text) {
  size_t length = strlen(text);
  return strpbrk(text, ",;\t\"\r\n") || (length && (text[0] == ' ' || text[length - 1] == ' '));
}

static size_t put_byte(FILE *out, const char *text) {
  fputc(*text, out);
  return 1;
}

void fg_csv_put_text(FILE *out, const char *text, fg_csv_character *put) {
  bool quoted = fg_csv_needs_quotes(text);
  if (quoted) fputc('"', out);
  if (fg_csv_needs_apostrophe(text)) fputc('\'', out);
  while (*text) {
    if (*text == '"') fputc('"', out);
    text += put ? put(out, text) : put_byte(out, text);
  }
  if (quoted) fputc('"', out);
}

void fg_csv_put_number(FILE *out, double value) {
  char text[32];
  fputc(',', out);
  if (!isfinite(value)) return;
  fg_json_format(text, value);
  fputs(text, out);
}

void fg_csv_drop_apostrophe(const char **text, size_t *length) {
  if (!*length || **text != '\'' || !begins_formula(*text, *length)) return;
  ++*text;
  --*length;
}
