/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a file held when it was read: a mark for every block, by all who read it.
 *
 * A format that jumps about in its file cannot be summed as it is decoded: its SHA-256 is found in
 * a reading of its own. Each reading notes the mark of every block that it sees; where two marks of
 * one block differ, the file has changed in between. */
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

/* For a file of `size` bytes. FG_ERR_MEMORY. */
fg_status fg_ledger_open(fg_context *ctx, uint64_t size, fg_ledger *ledger);
void fg_ledger_close(fg_ledger *ledger);

/* A whole block, or what the file has of it; from any thread. */
void fg_ledger_note(fg_ledger *ledger, uint64_t block, const uint8_t *bytes, size_t length);

#endif
