#include "station/rest.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"

static fg_resting *find(const fg_rest *rest, const char *name) {
  for (size_t i = 0; i < rest->count; i++)
    if (!strcmp(rest->files[i].name, name)) return &rest->files[i];
  return NULL;
}

static fg_status add(fg_context *ctx, fg_rest *rest, const char *name, fg_resting **file) {
  void *block = rest->files;
  FG_TRY(fg_memory_reserve(ctx, rest->count + 1, sizeof *rest->files, &rest->capacity, &block));
  rest->files = block;
  *file = &rest->files[rest->count];
  **file = (fg_resting){.bytes = -1};
  FG_TRY(fg_text_print(ctx, &(*file)->name, "%s", name));
  rest->count++;
  return FG_OK;
}

fg_status fg_rest_look(fg_context *ctx, fg_rest *rest, const char *name, int64_t bytes,
                       int64_t modified_ns, int64_t now_ns, fg_resting **found) {
  fg_resting *file = find(rest, name);
  if (!file) FG_TRY(add(ctx, rest, name, &file));
  if (file->bytes != bytes || file->modified_ns != modified_ns) {
    file->bytes = bytes;
    file->modified_ns = modified_ns;
    file->since_ns = now_ns;
    file->tried = false;
  }
  file->seen = true;
  *found = file;
  return FG_OK;
}

void fg_rest_end_round(fg_rest *rest) {
  size_t kept = 0;
  for (size_t i = 0; i < rest->count; i++) {
    if (rest->files[i].seen)
      rest->files[kept++] = rest->files[i];
    else
      free(rest->files[i].name);
  }
  for (size_t i = 0; i < kept; i++)
    rest->files[i].seen = false;
  rest->count = kept;
}

void fg_rest_free(fg_rest *rest) {
  for (size_t i = 0; i < rest->count; i++)
    free(rest->files[i].name);
  free(rest->files);
  *rest = (fg_rest){0};
}
