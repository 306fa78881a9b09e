/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text that the callee allocates, and text that is safe on a terminal. */
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

/* Appends a remark: behind "; " where *text holds others. */
fg_status fg_text_append_remark(fg_context *ctx, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints into a buffer of `size` bytes; a longer text is cut off. */
void fg_text_clip(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Returns the ending of a noun after its count: "" for one, else "s". */
const char *fg_plural(size_t count);

/* The length of the UTF-8 sequence at `text` (up to its NUL); 0 when it is not one: overlong, a
 * surrogate, above U+10FFFF, a stray byte. */
size_t fg_utf8_length(const char *text);

/* Replaces control characters (but newline and tab), which a terminal would obey, and stray bytes
 * by \x1B and the like; other text stays. At most 4 × size bytes go to `visible`, `*length` of
 * them. A sequence cut by the end of `bytes` is left to the next call unless this is the last one;
 * returns the number of bytes consumed. */
size_t fg_utf8_make_visible(const char *bytes, size_t size, bool last, char *visible,
                            size_t *length);

#ifdef __cplusplus
}
#endif
#endif
