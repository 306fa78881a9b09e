/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text that the callee allocates, and text that a terminal shows as it is. */
#ifndef FOILGAUGE_TEXT_H
#define FOILGAUGE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* *text = the formatted text; the caller frees it. FG_ERR_MEMORY. */
fg_status fg_text_print(fg_context *ctx, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Appends to *text, which may be NULL. */
fg_status fg_text_append(fg_context *ctx, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Into a buffer of `size` bytes; what does not fit is cut off. */
void fg_text_clip(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* What a noun ends in behind its count: "" of one, else "s". */
const char *fg_plural(size_t count);

/* The length of the UTF-8 sequence at `text` (up to its NUL); 0 when it is not one: overlong, a
 * surrogate, above U+10FFFF, a stray byte. */
size_t fg_utf8_length(const char *text);

/* What a terminal would obey (control characters but newline and tab) and stray bytes become
 * \x1B; the rest stays. At most 4 × size bytes go to `visible`, `*length` of them. A sequence that
 * the end of `bytes` cuts is left to the next call unless this is the last one; returns how many
 * bytes were taken. */
size_t fg_utf8_make_visible(const char *bytes, size_t size, bool last, char *visible,
                            size_t *length);

#ifdef __cplusplus
}
#endif
#endif
