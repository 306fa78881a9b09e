/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dates whose reading depends on the country: the numbers' order, years of two digits, names of
 * months. One such date may mean two days; a column of them seldom does (stats/table_dates.h). */
#ifndef FG_CORE_DATE_ORDER_H
#define FG_CORE_DATE_ORDER_H

typedef enum fg_date_order { FG_DATE_DAY_FIRST, FG_DATE_MONTH_FIRST, FG_DATE_ORDERS } fg_date_order;

/* Returns days from 1970-01-01, a time of day as their fraction. Formats: all of fg_date_days;
 * 2024/05/31; in the order stated 31/05/2024, 31-5-24 and 05/31/2024, 5-31-24; 31.5.24 (day first
 * always); 31-May-2024, 31 Mai 24, May 31, 2024 (English and German names, three letters at least).
 * A time of day may have AM or PM. NaN: no date. */
double fg_date_days_in(const char *text, fg_date_order order);

#endif
