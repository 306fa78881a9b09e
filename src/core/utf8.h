/* SPDX-License-Identifier: GPL-3.0-or-later */
/* UTF-8: the room's own part beside the public foilgauge/text.h. */
#ifndef FG_CORE_UTF8_H
#define FG_CORE_UTF8_H

#include <stdio.h>

#include "foilgauge/text.h"

bool fg_utf8_is_valid(const char *text);

/* Returns the number of characters. */
size_t fg_utf8_count(const char *text);

/* Writes the one character at `text`, a stray byte as \xE4; returns the number of its bytes. */
size_t fg_utf8_put(FILE *out, const char *text);

#endif
