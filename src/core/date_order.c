/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/date_order.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/date.h"

/* Years of two digits are those from 1970 to 2069, as POSIX has them (1969 is its own). */
enum { FIRST_SHORT_YEAR = 70, SHORTEST_NAME = 3 };

static bool is_letter(char c) {
  return isalpha((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* Returns the month that `text` begins with, and the length of its name with a dot behind it; 0:
 * none. */
static int read_month(const char *text, size_t *length) {
  static const struct {
    const char *name;
    int month;
  } names[] = {{"january", 1},   {"januar", 1},      {"february", 2}, {"februar", 2},
               {"march", 3},     {"m\xc3\xa4rz", 3}, {"maerz", 3},    {"mrz", 3},
               {"april", 4},     {"may", 5},         {"mai", 5},      {"june", 6},
               {"juni", 6},      {"july", 7},        {"juli", 7},     {"august", 8},
               {"september", 9}, {"october", 10},    {"oktober", 10}, {"november", 11},
               {"december", 12}, {"dezember", 12}};
  size_t letters = 0;
  while (is_letter(text[letters]))
    letters++;
  *length = letters + (text[letters] == '.');
  for (size_t i = 0; letters >= SHORTEST_NAME && i < sizeof names / sizeof *names; i++)
    if (letters <= strlen(names[i].name) && !strncasecmp(text, names[i].name, letters))
      return names[i].month;
  return 0;
}

/* Returns the number that *text begins with, of at most `digits` digits, and moves behind it; -1:
 * none. */
static int read_digits(const char **text, size_t digits, size_t *count) {
  int number = 0;
  *count = strspn(*text, "0123456789");
  if (!*count || *count > digits) return -1;
  for (size_t i = 0; i < *count; i++)
    number = 10 * number + (*text)[i] - '0';
  *text += *count;
  return number;
}

/* A year of two or four digits; -1: none. */
static int read_year(const char **text) {
  size_t count;
  int year = read_digits(text, 4, &count);
  if (count == 2) return year + (year < FIRST_SHORT_YEAR ? 2000 : 1900);
  return count == 4 ? year : -1;
}

static double days_with_time(int year, int month, int day, const char *time) {
  return fg_date_of_day(year, month, day) + fg_date_time_of_day(time);
}

static void skip(const char **text, const char *separators) {
  *text += strspn(*text, separators);
}

/* May 31, 2024 */
static double read_name_first(const char *text) {
  size_t length, digits;
  int month = read_month(text, &length);
  text += length;
  skip(&text, " -");
  int day = read_digits(&text, 2, &digits);
  skip(&text, ", -");
  int year = read_year(&text);
  return month ? days_with_time(year, month, day, text) : NAN;
}

/* Numbers first: 31-May-2024, 31.5.24, 5/31/24, 2024/05/31. */
static double read_number_first(const char *text, fg_date_order order) {
  size_t digits, ignored;
  int first = read_digits(&text, 4, &digits);
  char separator = *text;
  if (first < 0 || !separator || !strchr("./- ", separator)) return NAN;
  skip(&text, separator == '.' ? ". " : " -/");
  if (is_letter(*text)) {
    int month = read_month(text, &ignored);
    text += ignored;
    skip(&text, " -/");
    int year = read_year(&text);
    return month && digits <= 2 ? days_with_time(year, month, first, text) : NAN;
  }
  int second = read_digits(&text, 2, &ignored);
  if (second < 0 || separator == ' ' || *text++ != separator) return NAN;
  if (digits == 4) {
    int day = read_digits(&text, 2, &ignored);
    return days_with_time(first, second, day, text);
  }
  int year = read_year(&text);
  bool day_first = separator == '.' || order == FG_DATE_DAY_FIRST;
  return digits <= 2
             ? days_with_time(year, day_first ? second : first, day_first ? first : second, text)
             : NAN;
}

double fg_date_days_in(const char *text, fg_date_order order) {
  double days = fg_date_days(text);
  if (!isnan(days)) return days;
  return is_letter(*text) ? read_name_first(text) : read_number_first(text, order);
}
