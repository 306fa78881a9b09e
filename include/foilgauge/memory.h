/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checked memory: products of sizes are checked, and a failure has a message. */
#ifndef FOILGAUGE_MEMORY_H
#define FOILGAUGE_MEMORY_H

#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* *out = zeroed memory for count × size bytes (at least one byte); the caller frees it with
 * free(). FG_ERR_MEMORY when the product overflows or there is no memory; *out is then NULL. */
fg_status fg_memory_allocate(fg_context *ctx, size_t count, size_t size, void **out);

/* Grows *block to hold `needed` items of `size` bytes; *capacity is in items and at least
 * doubles. New items are not zeroed. On failure the old block stays valid. */
fg_status fg_memory_reserve(fg_context *ctx, size_t needed, size_t size, size_t *capacity,
                            void **block);

#ifdef __cplusplus
}
#endif
#endif
