/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/notes.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"

fg_status fg_notes_add(fg_context *ctx, char ***notes, size_t *count, size_t *capacity,
                       const char *format, va_list values) {
  char *text = NULL;
  FG_TRY(fg_memory_reserve(ctx, *count + 1, sizeof **notes, capacity, (void **)notes));
  if (vasprintf(&text, format, values) < 0) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  (*notes)[(*count)++] = text;
  return FG_OK;
}

void fg_notes_free(char **notes, size_t count) {
  for (size_t i = 0; i < count; i++)
    free(notes[i]);
  free(notes);
}
