/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

fg_status fg_text_print(fg_context *ctx, char **text, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  int length = vasprintf(text, format, arguments);
  va_end(arguments);
  if (length >= 0) return FG_OK;
  *text = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
}

static fg_status append_behind(fg_context *ctx, char **text, const char *separator,
                               const char *format, va_list arguments) {
  char *addition = NULL, *joined = NULL;
  if (vasprintf(&addition, format, arguments) < 0)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  fg_status status =
      fg_text_print(ctx, &joined, "%s%s%s", *text ? *text : "", *text ? separator : "", addition);
  free(addition);
  if (status != FG_OK) return status;
  free(*text);
  *text = joined;
  return FG_OK;
}

fg_status fg_text_append(fg_context *ctx, char **text, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fg_status status = append_behind(ctx, text, "", format, arguments);
  va_end(arguments);
  return status;
}

fg_status fg_text_append_remark(fg_context *ctx, char **text, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fg_status status = append_behind(ctx, text, "; ", format, arguments);
  va_end(arguments);
  return status;
}

void fg_text_clip(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, size, format, arguments);
  va_end(arguments);
}

fg_status fg_text_append_word(fg_context *ctx, char **text, const char *word) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./+-";
  if (*word && strspn(word, plain) == strlen(word)) return fg_text_append(ctx, text, " %s", word);
  FG_TRY(fg_text_append(ctx, text, " '"));
  for (; *word; word++)
    FG_TRY(*word == '\'' ? fg_text_append(ctx, text, "'\\''")
                         : fg_text_append(ctx, text, "%c", *word));
  return fg_text_append(ctx, text, "'");
}

const char *fg_plural(size_t count) {
  return count == 1 ? "" : "s";
}

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
