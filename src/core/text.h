/* Text that the callee allocates. */
#ifndef FG_CORE_TEXT_H
#define FG_CORE_TEXT_H

#include <stddef.h>

#include "foilgauge/status.h"

/* *text = the formatted text; the caller frees it. FG_ERR_MEMORY. */
fg_status fg_text_print(fg_context *ctx, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Appends to *text, which may be NULL. */
fg_status fg_text_append(fg_context *ctx, char **text, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Into a buffer of `size` bytes; what does not fit is cut off. */
void fg_text_clip(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
