/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of sentences, each allocated: what a result has to say beside its numbers. */
#ifndef FG_CORE_NOTES_H
#define FG_CORE_NOTES_H

#include <stdarg.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* Appends one to *notes (NULL at first), which holds *count and has room for *capacity. On
 * FG_ERR_MEMORY the list is as before. */
fg_status fg_notes_add(fg_context *ctx, char ***notes, size_t *count, size_t *capacity,
                       const char *format, va_list values);
void fg_notes_free(char **notes, size_t count);

#endif
