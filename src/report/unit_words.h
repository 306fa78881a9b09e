/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units of columns, which their names end with: temperature_C, duration_h, height_um. */
#ifndef FG_REPORT_DOE_DOE_UNITS_H
#define FG_REPORT_DOE_DOE_UNITS_H

#include <stddef.h>

/* Returns "°C" for temperature_C; "" where the name ends with no known unit. */
const char *fg_unit_of_name(const char *name);
/* Write the name for an axis, "temperature, °C", and for a sentence, "temperature": blanks in
 * place of underscores; a name without a unit stays as it is. */
void fg_axis_words(const char *name, char *text, size_t size);
void fg_name_words(const char *name, char *text, size_t size);
/* Writes a value with the unit of its name: "600 °C", "2.44 %". */
void fg_value_with_unit(const char *name, double value, int digits, char *text, size_t size);

#endif
