/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checksums of a file's blocks, by all its readers: they show that it changed while it was read.
 *
 * A format that reads its file at random cannot be summed as it is decoded: its SHA-256 needs a
 * reading of its own. Each reading adds the checksum of every block. Where two of one block
 * differ, the file has changed in between. */
#ifndef FG_SCAN_BLOCK_CHECKSUMS_H
#define FG_SCAN_BLOCK_CHECKSUMS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

enum { FG_CHECKSUM_BLOCK_BYTES = 1 << 16 };

typedef struct fg_block_checksums {
  _Atomic uint64_t *checksum; /* by block; 0: not read yet; NULL: none are kept */
  size_t blocks;
  atomic_bool changed;
} fg_block_checksums;

/* Opens the checksums of a file of `size` bytes. FG_ERR_MEMORY. */
fg_status fg_block_checksums_open(fg_context *ctx, uint64_t size, fg_block_checksums *sums);
void fg_block_checksums_close(fg_block_checksums *sums);

/* Adds the checksum of a whole block, or of the file's last part; from any thread. */
void fg_block_checksums_add(fg_block_checksums *sums, uint64_t block, const uint8_t *bytes,
                            size_t length);

#endif
