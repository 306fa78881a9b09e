/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/ledger.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

fg_status fg_ledger_open(fg_context *ctx, uint64_t size, fg_ledger *ledger) {
  void *block;
  ledger->blocks = (size_t)(size / FG_LEDGER_BLOCK_BYTES) + 1;
  FG_TRY(fg_memory_allocate(ctx, ledger->blocks, sizeof *ledger->mark, &block));
  ledger->mark = block;
  atomic_init(&ledger->changed, false);
  return FG_OK;
}

void fg_ledger_close(fg_ledger *ledger) {
  free((void *)ledger->mark);
  ledger->mark = NULL;
}

static uint64_t stir_lane(uint64_t lane, uint64_t word) {
  lane = (lane ^ word) * 0x9E3779B97F4A7C15u;
  return lane ^ lane >> 29;
}

/* Mark of a block. Every step is one to one in its input, so that a change of one word always
 * changes the mark, and of several with a chance of 1 - 2^-64; four lanes, as fast as memory. Never
 * 0. */
static uint64_t mark_of(const uint8_t *bytes, size_t length) {
  uint64_t lane[4] = {length, 1, 2, 3}, word[4];
  for (size_t at = 0; at < length; at += sizeof word) {
    size_t left = length - at;
    if (left < sizeof word) memset(word, 0, sizeof word);
    memcpy(word, bytes + at, left < sizeof word ? left : sizeof word);
    for (int i = 0; i < 4; i++)
      lane[i] = stir_lane(lane[i], word[i]);
  }
  uint64_t mark = lane[0];
  for (int i = 1; i < 4; i++)
    mark = stir_lane(mark, lane[i]);
  return mark ? mark : 1;
}

void fg_ledger_note(fg_ledger *ledger, uint64_t block, const uint8_t *bytes, size_t length) {
  if (!ledger->mark || block >= ledger->blocks) return;
  uint64_t mark = mark_of(bytes, length), seen = 0;
  if (!atomic_compare_exchange_strong(&ledger->mark[block], &seen, mark) && seen != mark)
    atomic_store(&ledger->changed, true);
}
