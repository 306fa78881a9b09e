/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The item of a scan, by its path. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lot/input/manifest.h"

/* FNV-1a. */
static size_t hash_text(const char *text) {
  uint64_t hash = 14695981039346656037u;
  for (; *text; text++)
    hash = (hash ^ (unsigned char)*text) * 1099511628211u;
  return (size_t)(hash ^ (hash >> 29));
}

static size_t *find_slot(const fg_manifest_index *index, const fg_manifest *manifest,
                         const char *scan) {
  size_t at = hash_text(scan) % index->slots;
  while (index->slot[at] && strcmp(fg_manifest_scan(manifest, index->slot[at] - 1), scan) != 0)
    at = (at + 1) % index->slots;
  return &index->slot[at];
}

fg_status fg_manifest_index_build(fg_context *ctx, const fg_manifest *manifest,
                                  fg_manifest_index *index) {
  void *block;
  *index = (fg_manifest_index){.slots = 2 * manifest->items + 3};
  FG_TRY(fg_memory_allocate(ctx, index->slots, sizeof *index->slot, &block));
  index->slot = block;
  for (size_t i = 0; i < manifest->items; i++) {
    size_t *slot = find_slot(index, manifest, fg_manifest_scan(manifest, i));
    if (!*slot) *slot = i + 1;
  }
  return FG_OK;
}

size_t fg_manifest_index_find(const fg_manifest_index *index, const fg_manifest *manifest,
                              const char *scan) {
  size_t slot = *find_slot(index, manifest, scan);
  return slot ? slot - 1 : manifest->items;
}

void fg_manifest_index_free(fg_manifest_index *index) {
  free(index->slot);
  *index = (fg_manifest_index){0};
}
