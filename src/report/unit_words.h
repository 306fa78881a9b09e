/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns are named with their unit at the end: temperature_C, duration_h, height_um. */
#ifndef FG_REPORT_DOE_DOE_UNITS_H
#define FG_REPORT_DOE_DOE_UNITS_H

#include <stddef.h>

/* "°C" of temperature_C; "" where the name ends with no unit that is known. */
const char *fg_unit_of_name(const char *name);
/* "temperature, °C" for an axis, "temperature" for a sentence: the name without its unit, with
 * blanks; a name without a unit stays as it is. */
void fg_axis_words(const char *name, char *text, size_t size);
void fg_name_words(const char *name, char *text, size_t size);
/* "600 °C", "2.44 %". */
void fg_value_with_unit(const char *name, double value, int digits, char *text, size_t size);

#endif
