/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV with a decimal comma: separators and numbers. */
#include <string.h>
#include <strings.h>

#include "core/csv.h"
#include "core/extended.h"

static const unsigned char separators[] = {'\t', ';', ','};
enum { SEPARATORS = sizeof separators };

/* Number of rows inspected: enough to tell a separator from characters of names and numbers. */
enum { ROWS_INSPECTED = 20 };

size_t fg_csv_hint(const char *text, size_t size, unsigned char *separator) {
  if (size < 5 || strncasecmp(text, "sep=", 4) != 0) return 0;
  if (!memchr(separators, text[4], SEPARATORS)) return 0;
  size_t length = 5;
  if (length < size && text[length] == '\r') length++;
  if (length < size && text[length] == '\n') length++;
  if (length == 5 && length < size) return 0; /* a column of that name */
  *separator = (unsigned char)text[4];
  return length;
}

/* Counts the separators outside quotes in the row at `text`, and returns the begin of the next. */
static size_t count_row(const char *text, size_t size, size_t counts[SEPARATORS]) {
  bool quoted = false;
  size_t i = 0;
  memset(counts, 0, SEPARATORS * sizeof *counts);
  for (; i < size && (quoted || (text[i] != '\n' && text[i] != '\r')); i++) {
    if (text[i] == '"') quoted = !quoted;
    for (size_t k = 0; k < SEPARATORS && !quoted; k++)
      counts[k] += (unsigned char)text[i] == separators[k];
  }
  while (i < size && (text[i] == '\n' || text[i] == '\r'))
    i++;
  return i;
}

unsigned char fg_csv_separator(const char *text, size_t size) {
  size_t header[SEPARATORS], counts[SEPARATORS], max = SEPARATORS - 1;
  bool alike[SEPARATORS];
  size_t at = 0;
  while (at < size && (text[at] == '\n' || text[at] == '\r'))
    at++;
  at += count_row(text + at, size - at, header);
  for (size_t k = 0; k < SEPARATORS; k++)
    alike[k] = header[k] > 0;
  for (int row = 0; row < ROWS_INSPECTED && at < size; row++) {
    at += count_row(text + at, size - at, counts);
    for (size_t k = 0; k < SEPARATORS; k++)
      alike[k] = alike[k] && counts[k] == header[k];
  }
  for (size_t k = 0; k < SEPARATORS; k++)
    if (alike[k]) return separators[k];
  for (size_t k = SEPARATORS; k-- > 0;)
    if (header[k] > header[max]) max = k;
  return separators[max];
}

static bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

static size_t digits_at(const char *text, size_t length) {
  size_t count = 0;
  while (count < length && is_digit(text[count]))
    count++;
  return count;
}

/* The bytes of a mark that separates thousands: . , ' or a space, the narrow and the fixed too. */
static size_t mark_at(const char *text, size_t length) {
  static const char *const marks[] = {".",           ",", "'", " ", "\xc2\xa0", "\xe2\x80\xaf",
                                      "\xe2\x80\x99"};
  for (size_t i = 0; i < sizeof marks / sizeof *marks; i++) {
    size_t bytes = strlen(marks[i]);
    if (length >= bytes && !memcmp(text, marks[i], bytes)) return bytes;
  }
  return 0;
}

/* One to three digits, then groups of three, each after the same mark, then perhaps another mark
 * and decimals. */
static bool has_thousands(const char *text, size_t length) {
  size_t sign = length && (*text == '-' || *text == '+');
  text += sign, length -= sign;
  size_t at = digits_at(text, length), groups = 0;
  if (at < 1 || at > 3) return false;
  size_t mark = mark_at(text + at, length - at);
  const char *first = text + at;
  while (mark && at + mark <= length && !memcmp(text + at, first, mark) &&
         digits_at(text + at + mark, length - at - mark) == 3) {
    at += mark + 3;
    groups++;
  }
  if (!groups) return false;
  if (at == length) return true;
  size_t decimals = digits_at(text + at + 1, length - at - 1);
  return (text[at] == '.' || text[at] == ',') && text[at] != *first && decimals &&
         at + 1 + decimals == length;
}

bool fg_csv_may_be_thousands(const char *text, size_t length) {
  size_t sign = length && (*text == '-' || *text == '+');
  return length > sign && text[sign] != '0' && has_thousands(text, length);
}

bool fg_csv_point(const char *cell, size_t length, char *text, size_t size) {
  const char *comma = memchr(cell, ',', length);
  if (!comma || length >= size) return false;
  memcpy(text, cell, length);
  text[comma - cell] = '.';
  text[length] = 0;
  return true;
}

fg_csv_number fg_csv_number_kind(const char *text, size_t length) {
  fg_extended number;
  char pointed[128]; /* four times the digits that 106 bits hold */
  if (fg_extended_parse(text, length, &number))
    return memchr(text, '.', length) ? FG_CSV_POINT : FG_CSV_WHOLE;
  if (!memchr(text, '.', length) && fg_csv_point(text, length, pointed, sizeof pointed) &&
      fg_extended_parse(pointed, length, &number))
    return FG_CSV_COMMA;
  return has_thousands(text, length) ? FG_CSV_THOUSANDS : FG_CSV_WORD;
}
