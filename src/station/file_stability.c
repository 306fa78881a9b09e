/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/file_stability.h"

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
static size_t *find_slot(const fg_file_stability *stability, const char *name) {
  size_t at = hash(name) & (stability->slot_count - 1);
  while (stability->slots[at] && strcmp(stability->files[stability->slots[at] - 1].name, name) != 0)
    at = (at + 1) & (stability->slot_count - 1);
  return &stability->slots[at];
}

static void fill_slots(fg_file_stability *stability) {
  if (stability->slots)
    memset(stability->slots, 0, stability->slot_count * sizeof *stability->slots);
  for (size_t i = 0; i < stability->count; i++)
    *find_slot(stability, stability->files[i].name) = i + 1;
}

/* Keeps at least half of the slots free, so that a search is short. */
static fg_status reserve_slots(fg_context *ctx, fg_file_stability *stability) {
  void *block;
  if (2 * (stability->count + 1) <= stability->slot_count) return FG_OK;
  size_t count = stability->slot_count ? 2 * stability->slot_count : SLOTS_MIN;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *stability->slots, &block));
  free(stability->slots);
  stability->slots = block;
  stability->slot_count = count;
  fill_slots(stability);
  return FG_OK;
}

static fg_stable_file *find_stable_file(const fg_file_stability *stability, const char *name) {
  size_t index = stability->slot_count ? *find_slot(stability, name) : 0;
  return index ? &stability->files[index - 1] : NULL;
}

static fg_status add_stable_file(fg_context *ctx, fg_file_stability *stability, const char *name,
                                 fg_stable_file **file) {
  void *block = stability->files;
  FG_TRY(reserve_slots(ctx, stability));
  FG_TRY(fg_memory_reserve(ctx, stability->count + 1, sizeof *stability->files,
                           &stability->capacity, &block));
  stability->files = block;
  *file = &stability->files[stability->count];
  **file = (fg_stable_file){.bytes = -1};
  FG_TRY(fg_text_print(ctx, &(*file)->name, "%s", name));
  *find_slot(stability, name) = ++stability->count;
  return FG_OK;
}

fg_status fg_file_stability_note(fg_context *ctx, fg_file_stability *stability, const char *name,
                                 int64_t bytes, int64_t modified_ns, int64_t now_ns,
                                 fg_stable_file **found) {
  fg_stable_file *file = find_stable_file(stability, name);
  if (!file) FG_TRY(add_stable_file(ctx, stability, name, &file));
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

void fg_file_stability_end_round(fg_file_stability *stability) {
  size_t kept = 0;
  for (size_t i = 0; i < stability->count; i++) {
    if (stability->files[i].seen)
      stability->files[kept++] = stability->files[i];
    else
      free(stability->files[i].name);
  }
  for (size_t i = 0; i < kept; i++)
    stability->files[i].seen = false;
  stability->count = kept;
  fill_slots(stability);
}

void fg_file_stability_free(fg_file_stability *stability) {
  for (size_t i = 0; i < stability->count; i++)
    free(stability->files[i].name);
  free(stability->files);
  free(stability->slots);
  *stability = (fg_file_stability){0};
}
