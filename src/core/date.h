/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dates as people write them in tables. */
#ifndef FG_CORE_DATE_H
#define FG_CORE_DATE_H

#include <stdint.h>

/* "2026-11-20T13:45" and its end. */
enum { FG_DATE_TEXT = 24 };

/* Days from 1970-01-01, a time of day as their fraction: 2024-05-31, 31.05.2024, behind them
 * nothing or " 13:45", "T13:45:10", each with or without a Z. NaN: no date. What is written with
 * strokes may begin with day or month: no date. */
double fg_date_days(const char *text);

/* As ISO 8601 has it: the day, and hours and minutes where the days are not whole; "" for NaN. */
void fg_date_format(double days, char text[FG_DATE_TEXT]);

/* A day, "2026-11-20", and its end. */
enum { FG_DATE_DAY = 11 };

/* Of a time in seconds since 1970, UTC; and of a file, when it was written last by its own time, ""
 * where that is not known. */
void fg_date_of_time(int64_t seconds, char day[FG_DATE_DAY]);
void fg_date_of_file(const char *path, char day[FG_DATE_DAY]);

#endif
