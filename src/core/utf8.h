/* UTF-8, and text that a terminal shows as it is. */
#ifndef FG_CORE_UTF8_H
#define FG_CORE_UTF8_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The length of the UTF-8 sequence at `text` (up to its NUL); 0 when it is not one: overlong, a
 * surrogate, above U+10FFFF, a stray byte. */
size_t fg_utf8_length(const char *text);

bool fg_utf8_is_valid(const char *text);

/* Writes the one character at `text`, a stray byte as \xE4; returns how many bytes it took. */
size_t fg_utf8_put(FILE *out, const char *text);

/* What a terminal would obey (control characters but newline and tab) and stray bytes become
 * \x1B; the rest stays. At most 4 × size bytes go to `visible`, `*length` of them. A sequence that
 * the end of `bytes` cuts is left to the next call unless this is the last one; returns how many
 * bytes were taken. */
size_t fg_utf8_make_visible(const char *bytes, size_t size, bool last, char *visible,
                            size_t *length);

#endif
