/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers and dates of a text in the form of a language. */
#include <ctype.h>
#include <string.h>
#include <time.h>

#include "language/catalogue.h"

static size_t count_digits(const char *text) {
  return strspn(text, "0123456789");
}

static size_t exponent_length(const char *text) {
  if (*text != 'e' && *text != 'E') return 0;
  size_t sign = text[1] == '-' || text[1] == '+', digits = count_digits(text + 1 + sign);
  return digits ? 1 + sign + digits : 0;
}

size_t fg_number_length(const char *text) {
  static const char minus[] = "−", none[] = "–";
  if (!strncmp(text, none, sizeof none - 1)) return sizeof none - 1;
  size_t at = *text == '-' || *text == '+' ? 1 : strncmp(text, minus, 3) ? 0 : sizeof minus - 1;
  size_t digits = count_digits(text + at);
  if (!digits) return 0;
  at += digits;
  if (text[at] == '.' && count_digits(text + at + 1)) at += 1 + count_digits(text + at + 1);
  return at + exponent_length(text + at);
}

/* Returns the length of what has this layout, in which 0 is any digit. */
static size_t layout_length(const char *text, const char *layout) {
  size_t i = 0;
  for (; layout[i]; i++)
    if (layout[i] == '0' ? !isdigit((unsigned char)text[i]) : text[i] != layout[i]) return 0;
  return i;
}

size_t fg_time_length(const char *text) {
  size_t date = layout_length(text, "0000-00-00");
  if (!date) return 0;
  size_t minutes = layout_length(text + date, " 00:00") + layout_length(text + date, "T00:00");
  if (!minutes && isalnum((unsigned char)text[date])) return 0;
  size_t length = date + minutes;
  if (minutes) length += layout_length(text + length, ":00");
  if (minutes)
    length += layout_length(text + length, " +00:00") + layout_length(text + length, " -00:00");
  return length;
}

static void write_time(const fg_language *language, const char *text, size_t length, FILE *out) {
  struct tm day = {0};
  char date[40];
  if (sscanf(text, "%4d-%2d-%2d", &day.tm_year, &day.tm_mon, &day.tm_mday) != 3) return;
  day.tm_year -= 1900;
  day.tm_mon--;
  size_t size = strftime(date, sizeof date, language->date, &day);
  fwrite(date, 1, size, out);
  if (length > 10) fputc(' ', out);
  if (length > 10) fwrite(text + 11, 1, length - 11, out);
}

static void write_decimal(const fg_language *language, const char *text, size_t length, FILE *out) {
  for (size_t i = 0; i < length; i++)
    fputc(text[i] == '.' ? language->decimal : text[i], out);
}

/* Letters, digits and marks that a name is made of: a number beside one is a part of the name. */
static bool is_of_name(char c) {
  return isalnum((unsigned char)c) || c == '_' || c == '/' || c == '@';
}

/* "1.12.0", "127.0.0.1" and "3.png" are no numbers. */
static bool ends_number(const char *next) {
  if (is_of_name(*next)) return false;
  return !(*next == '.' && isalnum((unsigned char)next[1]));
}

/* Returns the length of a stretch of letters and digits with their points: it is copied whole. */
static size_t name_length(const char *text, size_t length) {
  size_t i = 0;
  while (i < length && (is_of_name(text[i]) || text[i] == '.'))
    i++;
  return i ? i : 1;
}

void fg_numbers_write(const fg_language *language, const char *text, size_t length, FILE *out) {
  for (size_t i = 0, step; i < length; i += step) {
    size_t time = fg_time_length(text + i), number = fg_number_length(text + i);
    if (time && time <= length - i) {
      write_time(language, text + i, step = time, out);
    } else if (number && number <= length - i && ends_number(text + i + number)) {
      write_decimal(language, text + i, step = number, out);
    } else {
      step = name_length(text + i, length - i);
      fwrite(text + i, 1, step, out);
    }
  }
}
