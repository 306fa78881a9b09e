/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimal digits of a double, byte for byte as printf's %.*g writes them with a point. */
#ifndef FG_CORE_DIGITS_H
#define FG_CORE_DIGITS_H

enum { FG_DIGITS_TEXT = 32 };

/* `digits`: 1 to 17, trailing zeros are left out. `value` is finite. Zero has no sign. */
void fg_digits_format(char text[FG_DIGITS_TEXT], int digits, double value);

/* Uses the fewest digits, ten at least, that read as the same number. */
void fg_digits_format_exactly(char text[FG_DIGITS_TEXT], double value);

#endif
