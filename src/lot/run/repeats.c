/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repeated scans: files with the same bytes under several names. A scan shows one foil. Under a
 * second name it tells nothing of the foil of that name, and would count twice in statistics. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "lot/run/lot.h"

static int compare_sums(const void *a, const void *b) {
  const fg_record *const *one = a, *const *other = b;
  int order = strcmp((*one)->sha256, (*other)->sha256);
  return order ? order : (*one > *other) - (*one < *other); /* records lie in manifest's order */
}

/* Replaces the foils of the repeat by the reason. */
static fg_status mark_repeat(fg_context *ctx, fg_lot *lot, fg_record *repeat,
                             const fg_record *first) {
  size_t item = (size_t)(first - lot->records);
  fg_record marked = {.scan = repeat->scan, .repeat_of = item + 1};
  FG_TRY(fg_text_print(ctx, &marked.error,
                       "%s: the same scan, byte by byte, as that of %s (%s), which counts: %s was "
                       "not measured",
                       repeat->scan, fg_manifest_label(&lot->manifest, item), first->scan,
                       fg_manifest_label(&lot->manifest, (size_t)(repeat - lot->records))));
  memcpy(marked.sha256, repeat->sha256, sizeof marked.sha256);
  memcpy(marked.measured_with, repeat->measured_with, sizeof marked.measured_with);
  memcpy(marked.date, repeat->date, sizeof marked.date);
  repeat->scan = NULL;
  fg_record_free(repeat);
  *repeat = marked;
  return FG_OK;
}

fg_status fg_lot_mark_repeats(fg_context *ctx, fg_lot *lot) {
  size_t items = lot->manifest.items;
  fg_record **record = NULL;
  FG_TRY(fg_memory_allocate(ctx, items, sizeof(fg_record *), (void **)&record));
  for (size_t i = 0; i < items; i++)
    record[i] = &lot->records[i];
  fg_sort_items(record, items, sizeof *record, compare_sums);
  fg_status status = FG_OK;
  for (size_t i = 1, first = 0; i < items && status == FG_OK; i++) {
    bool same = record[i]->sha256[0] && !strcmp(record[i]->sha256, record[first]->sha256);
    if (!same) first = i;
    if (same && !record[i]->error) status = mark_repeat(ctx, lot, record[i], record[first]);
  }
  free(record);
  return status;
}

fg_lot_finding fg_lot_find_repeats(const fg_lot *lot) {
  fg_lot_finding repeats = {.count = 0};
  for (size_t i = 0; i < lot->manifest.items; i++) {
    const fg_record *record = &lot->records[i];
    if (!record->repeat_of) continue;
    if (repeats.count++ == 0)
      fg_text_clip(repeats.first, sizeof repeats.first, "%s", record->error);
  }
  return repeats;
}
