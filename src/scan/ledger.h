/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ledger of a file's content at reading: a mark for every block, by all its readers.
 *
 * A format that reads its file at random cannot be summed as it is decoded: its SHA-256 needs a
 * reading of its own. Each reading notes the mark of every block. Where two marks of one block
 * differ, the file has changed in between. */
#ifndef FG_SCAN_LEDGER_H
#define FG_SCAN_LEDGER_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

enum { FG_LEDGER_BLOCK_BYTES = 1 << 16 };

typedef struct fg_ledger {
  _Atomic uint64_t *mark; /* 0: not seen; NULL: no ledger is kept */
  size_t blocks;
  atomic_bool changed;
} fg_ledger;

/* Opens a ledger of a file of `size` bytes. FG_ERR_MEMORY. */
fg_status fg_ledger_open(fg_context *ctx, uint64_t size, fg_ledger *ledger);
void fg_ledger_close(fg_ledger *ledger);

/* Notes a whole block, or the file's part of it; from any thread. */
void fg_ledger_note(fg_ledger *ledger, uint64_t block, const uint8_t *bytes, size_t length);

#endif
