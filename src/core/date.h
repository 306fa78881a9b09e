/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dates as people write them in tables, and a monotonic clock. */
#ifndef FG_CORE_DATE_H
#define FG_CORE_DATE_H

#include <stdbool.h>
#include <stdint.h>

/* Size of "2026-11-20T13:45" with its NUL, and room to spare. */
enum { FG_DATE_TEXT = 24 };

/* Returns days from 1970-01-01, a time of day as their fraction. Formats: 2024-05-31, 31.05.2024,
 * then nothing or " 13:45", "T13:45:10", each with or without a Z, or " 1:45 PM". NaN: no date. A
 * date with strokes is no date: it may begin with day or month. */
double fg_date_days(const char *text);

/* Returns days from 1970-01-01 of a day of the calendar; NaN: no day of 1900 to 2199. */
double fg_date_of_day(int year, int month, int day);

/* Returns the time of day, in days, that follows a date: "" (0), " 13:45", "T13:45:10Z", " 1:45
 * PM"; NaN: other text. */
double fg_date_time_of_day(const char *text);

/* True with a Z: the date is UTC. Others are local, wherever that is. */
bool fg_date_is_utc(const char *text);

/* Writes days as ISO 8601: the day, and hours and minutes where the days are not whole; "" for NaN.
 */
void fg_date_format(double days, char text[FG_DATE_TEXT]);

/* Size of "2026-11-20" with its NUL. */
enum { FG_DATE_DAY = 11 };

/* Write the local day of a time in seconds since 1970, and of a file's last change; "" where the
 * file's time is not known. */
void fg_date_of_time(int64_t seconds, char day[FG_DATE_DAY]);
void fg_date_of_file(const char *path, char day[FG_DATE_DAY]);

/* Sizes of "2026-11-20T13:45:10Z" and "20261120-134510" with their NUL, and room to spare. */
enum { FG_DATE_UTC = 32, FG_DATE_STAMP = 32 };

/* Writes a time in seconds since 1970 as ISO 8601, UTC; "" for 0. */
void fg_date_format_utc(int64_t seconds, char text[FG_DATE_UTC]);

/* Writes local time for names of files, which sort by it; "" where there is none. */
void fg_date_format_stamp(int64_t seconds, char stamp[FG_DATE_STAMP]);

/* Returns the seconds of a clock that nobody sets, since a fixed moment before the machine's start.
 */
double fg_clock_seconds(void);

#endif
