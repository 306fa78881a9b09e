/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text: the room's own part beside the public foilgauge/text.h. */
#ifndef FG_CORE_TEXT_H
#define FG_CORE_TEXT_H

#include <stdarg.h>

#include "foilgauge/text.h"

/* Appends a blank and a word of a command, quoted where a shell would split it. */
fg_status fg_text_append_word(fg_context *ctx, char **text, const char *word);

/* Appends a sentence to *notes, a list of allocated remarks of a result (NULL at first), which
 * holds *count and has room for *capacity. On FG_ERR_MEMORY the list is unchanged. */
fg_status fg_notes_add(fg_context *ctx, char ***notes, size_t *count, size_t *capacity,
                       const char *format, va_list values);
void fg_notes_free(char **notes, size_t count);

#endif
