/* SPDX-License-Identifier: GPL-3.0-or-later */
/* UTF-8; what of it is public stands in foilgauge/text.h. */
#ifndef FG_CORE_UTF8_H
#define FG_CORE_UTF8_H

#include <stdio.h>

#include "foilgauge/text.h"

bool fg_utf8_is_valid(const char *text);

/* Returns the number of characters. */
size_t fg_utf8_count(const char *text);

/* Writes the one character at `text`, a stray byte as \xE4; returns how many bytes it took. */
size_t fg_utf8_put(FILE *out, const char *text);

#endif
