/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/block_checksums.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

fg_status fg_block_checksums_open(fg_context *ctx, uint64_t size, fg_block_checksums *sums) {
  void *block;
  sums->blocks = (size_t)(size / FG_CHECKSUM_BLOCK_BYTES) + 1;
  FG_TRY(fg_memory_allocate(ctx, sums->blocks, sizeof *sums->checksum, &block));
  sums->checksum = block;
  atomic_init(&sums->changed, false);
  return FG_OK;
}

void fg_block_checksums_close(fg_block_checksums *sums) {
  free((void *)sums->checksum);
  sums->checksum = NULL;
}

static uint64_t stir_lane(uint64_t lane, uint64_t word) {
  lane = (lane ^ word) * 0x9E3779B97F4A7C15u;
  return lane ^ lane >> 29;
}

/* Checksum of a block. Every step is one to one in its input, so that a change of one word always
 * changes it, and of several with a chance of 1 - 2^-64; four lanes, as fast as memory. Never
 * 0. */
static uint64_t checksum_of(const uint8_t *bytes, size_t length) {
  uint64_t lane[4] = {length, 1, 2, 3}, word[4];
  for (size_t at = 0; at < length; at += sizeof word) {
    size_t left = length - at;
    if (left < sizeof word) memset(word, 0, sizeof word);
    memcpy(word, bytes + at, left < sizeof word ? left : sizeof word);
    for (int i = 0; i < 4; i++)
      lane[i] = stir_lane(lane[i], word[i]);
  }
  uint64_t checksum = lane[0];
  for (int i = 1; i < 4; i++)
    checksum = stir_lane(checksum, lane[i]);
  return checksum ? checksum : 1;
}

void fg_block_checksums_add(fg_block_checksums *sums, uint64_t block, const uint8_t *bytes,
                            size_t length) {
  if (!sums->checksum || block >= sums->blocks) return;
  uint64_t checksum = checksum_of(bytes, length), seen = 0;
  if (!atomic_compare_exchange_strong(&sums->checksum[block], &seen, checksum) && seen != checksum)
    atomic_store(&sums->changed, true);
}
