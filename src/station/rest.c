#include "station/rest.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"

enum { SLOTS_MIN = 64 };

/* FNV-1a, 64 bit. */
static size_t hash(const char *name) {
  uint64_t sum = 0xcbf29ce484222325u;
  for (; *name; name++)
    sum = (sum ^ (unsigned char)*name) * 0x100000001b3u;
  return (size_t)(sum ^ sum >> 32);
}

/* The slot of the file, or the free one that it would have. */
static size_t *find_slot(const fg_rest *rest, const char *name) {
  size_t at = hash(name) & (rest->slot_count - 1);
  while (rest->slots[at] && strcmp(rest->files[rest->slots[at] - 1].name, name) != 0)
    at = (at + 1) & (rest->slot_count - 1);
  return &rest->slots[at];
}

static void fill_slots(fg_rest *rest) {
  if (rest->slots) memset(rest->slots, 0, rest->slot_count * sizeof *rest->slots);
  for (size_t i = 0; i < rest->count; i++)
    *find_slot(rest, rest->files[i].name) = i + 1;
}

/* At least half of the slots are free: a search ends soon. */
static fg_status reserve_slots(fg_context *ctx, fg_rest *rest) {
  void *block;
  if (2 * (rest->count + 1) <= rest->slot_count) return FG_OK;
  size_t count = rest->slot_count ? 2 * rest->slot_count : SLOTS_MIN;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *rest->slots, &block));
  free(rest->slots);
  rest->slots = block;
  rest->slot_count = count;
  fill_slots(rest);
  return FG_OK;
}

static fg_resting *find(const fg_rest *rest, const char *name) {
  size_t index = rest->slot_count ? *find_slot(rest, name) : 0;
  return index ? &rest->files[index - 1] : NULL;
}

static fg_status add(fg_context *ctx, fg_rest *rest, const char *name, fg_resting **file) {
  void *block = rest->files;
  FG_TRY(reserve_slots(ctx, rest));
  FG_TRY(fg_memory_reserve(ctx, rest->count + 1, sizeof *rest->files, &rest->capacity, &block));
  rest->files = block;
  *file = &rest->files[rest->count];
  **file = (fg_resting){.bytes = -1};
  FG_TRY(fg_text_print(ctx, &(*file)->name, "%s", name));
  *find_slot(rest, name) = ++rest->count;
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
  fill_slots(rest);
}

void fg_rest_free(fg_rest *rest) {
  for (size_t i = 0; i < rest->count; i++)
    free(rest->files[i].name);
  free(rest->files);
  free(rest->slots);
  *rest = (fg_rest){0};
}
