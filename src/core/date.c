/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/date.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>

enum { DAYS_TO_1970 = 719468, DAYS_OF_ERA = 146097 };

/* Days from 1970-01-01 in the Gregorian calendar (Hinnant 2013, "chrono-compatible low-level date
 * algorithms"). */
static double days_of(int year, int month, int day) {
  int y = month <= 2 ? year - 1 : year, era = y / 400, of_era = y - 400 * era;
  int of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  return era * (double)DAYS_OF_ERA + of_era * 365 + of_era / 4 - of_era / 100 + of_year -
         DAYS_TO_1970;
}

static bool is_day(int year, int month, int day) {
  static const int days[] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
  return year >= 1900 && year < 2200 && month >= 1 && month <= 12 && day >= 1 &&
         day <= days[month - 1] - (month == 2 && !leap);
}

double fg_date_of_day(int year, int month, int day) {
  return is_day(year, month, day) ? days_of(year, month, day) : NAN;
}

/* Returns the hour of 24 for one of twelve with AM or PM, which *text moves behind; -1: no such
 * hour. */
static int read_half_day(const char **text, int hour) {
  const char *half = *text + strspn(*text, " ");
  bool am = !strncasecmp(half, "am", 2), pm = !strncasecmp(half, "pm", 2);
  if (!am && !pm) return hour;
  *text = half + 2;
  return hour < 1 || hour > 12 ? -1 : hour % 12 + (pm ? 12 : 0);
}

double fg_date_time_of_day(const char *text) {
  int hour, minute, end = 0;
  double second = 0;
  if (!*text) return 0;
  if (*text != ' ' && *text != 'T') return NAN;
  if (sscanf(text + 1, "%2d:%2d%n", &hour, &minute, &end) < 2 || hour > 24 || minute > 59)
    return NAN;
  text += 1 + end;
  end = 0;
  if (*text == ':' && sscanf(text, ":%9lf%n", &second, &end) == 1) text += end;
  if ((hour = read_half_day(&text, hour)) < 0) return NAN;
  if (*text == 'Z') text++;
  return *text ? NAN : (hour + (minute + second / 60) / 60) / 24;
}

double fg_date_days(const char *text) {
  int year = 0, month = 0, day = 0, end = 0;
  if (strspn(text, "0123456789") == 4)
    (void)sscanf(text, "%4d-%2d-%2d%n", &year, &month, &day, &end);
  else
    (void)sscanf(text, "%2d.%2d.%4d%n", &day, &month, &year, &end);
  return end && is_day(year, month, day)
             ? days_of(year, month, day) + fg_date_time_of_day(text + end)
             : NAN;
}

bool fg_date_is_utc(const char *text) {
  size_t length = strlen(text);
  return length && text[length - 1] == 'Z';
}

/* The algorithm of days_of, inverted. */
void fg_date_format(double days, char text[FG_DATE_TEXT]) {
  text[0] = '\0';
  if (!isfinite(days)) return;
  long minutes = lround((days - floor(days)) * 1440), whole = lround(floor(days)) + minutes / 1440;
  long z = whole + DAYS_TO_1970, era = z / DAYS_OF_ERA, of_era = z - era * DAYS_OF_ERA;
  long year = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
  long of_year = of_era - (365 * year + year / 4 - year / 100), m = (5 * of_year + 2) / 153;
  long day = of_year - (153 * m + 2) / 5 + 1, month = m < 10 ? m + 3 : m - 9;
  minutes %= 1440;
  int end = snprintf(text, FG_DATE_TEXT, "%04ld-%02ld-%02ld", year + era * 400 + (month <= 2),
                     month, day);
  if (minutes && end > 0 && end < FG_DATE_TEXT)
    snprintf(text + end, (size_t)(FG_DATE_TEXT - end), "T%02ld:%02ld", minutes / 60, minutes % 60);
}

void fg_date_of_time(int64_t seconds, char day[FG_DATE_DAY]) {
  time_t time = (time_t)seconds;
  struct tm when;
  if (!localtime_r(&time, &when) ||
      strftime(day, FG_DATE_DAY, "%Y-%m-%d", &when) != FG_DATE_DAY - 1)
    day[0] = '\0';
}

void fg_date_of_file(const char *path, char day[FG_DATE_DAY]) {
  struct stat about;
  day[0] = '\0';
  if (stat(path, &about) == 0) fg_date_of_time(about.st_mtime, day);
}

void fg_date_format_utc(int64_t seconds, char text[FG_DATE_UTC]) {
  time_t at = (time_t)seconds;
  struct tm utc;
  text[0] = '\0';
  if (seconds && gmtime_r(&at, &utc)) strftime(text, FG_DATE_UTC, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

void fg_date_format_stamp(int64_t seconds, char stamp[FG_DATE_STAMP]) {
  time_t at = (time_t)seconds;
  struct tm local;
  stamp[0] = '\0';
  if (localtime_r(&at, &local)) strftime(stamp, FG_DATE_STAMP, "%Y%m%d-%H%M%S", &local);
}

double fg_clock_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
