/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream into memory whose failed writes are errors. */
#include <stdio.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"

typedef struct text_stream {
  char **text;
  size_t *size;
  void *block; /* owned until the end */
  size_t used, room;
  bool failed;
} text_stream;

static ssize_t append_text(void *cookie, const char *bytes, size_t count) {
  text_stream *stream = cookie;
  fg_context unused;
  if (stream->failed || fg_memory_reserve(&unused, stream->used + count + 1, 1, &stream->room,
                                          &stream->block) != FG_OK) {
    stream->failed = true;
    return 0;
  }
  memcpy((char *)stream->block + stream->used, bytes, count);
  stream->used += count;
  return (ssize_t)count;
}

/* An empty text is a block, too. */
static int end_stream_text(void *cookie) {
  text_stream *stream = cookie;
  append_text(stream, "", 0);
  bool failed = stream->failed;
  *stream->text = failed ? NULL : stream->block;
  *stream->size = failed ? 0 : stream->used;
  if (failed)
    free(stream->block);
  else
    ((char *)stream->block)[stream->used] = '\0';
  free(stream);
  return failed ? -1 : 0;
}

FILE *fg_stream_open(char **text, size_t *size) {
  text_stream *stream = calloc(1, sizeof *stream);
  *text = NULL;
  if (!stream) return NULL;
  *stream = (text_stream){.text = text, .size = size};
  FILE *out = fopencookie(stream, "w",
                          (cookie_io_functions_t){.write = append_text, .close = end_stream_text});
  if (out)
    __fsetlocking(out, FSETLOCKING_BYCALLER); /* one thread writes to it */
  else
    free(stream);
  return out;
}

bool fg_stream_keep(FILE *out, char **text) {
  if (!out) return false;
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return true;
  free(*text);
  *text = NULL;
  return false;
}
