/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/seal.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/sha256.h"

#define SEAL_FORMAT ", \"checksum\": \"%.16s\"}\n"
enum { SEAL_BYTES = 34 };

static void format_seal(const char *body, size_t length, char seal[SEAL_BYTES + 1]) {
  struct sha256_ctx state;
  char sum[65];
  sha256_init(&state);
  sha256_update(&state, length, (const uint8_t *)body);
  fg_sha256_finish(&state, sum);
  snprintf(seal, SEAL_BYTES + 1, SEAL_FORMAT, sum);
}

fg_status fg_seal_line(fg_context *ctx, char **line, size_t *length) {
  size_t body = *length;
  while (body > 0 && (*line)[body - 1] != '}')
    body--;
  if (body > 0) body--; /* the seal ends with the brace */
  char *longer = realloc(*line, body + SEAL_BYTES + 1);
  if (!longer) {
    free(*line);
    *line = NULL;
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a record");
  }
  format_seal(longer, body, longer + body);
  *line = longer;
  *length = body + SEAL_BYTES;
  return FG_OK;
}

bool fg_seal_holds(const char *line, size_t length) {
  char seal[SEAL_BYTES + 1];
  if (length <= SEAL_BYTES) return false;
  format_seal(line, length - SEAL_BYTES, seal);
  return memcmp(line + length - SEAL_BYTES, seal, SEAL_BYTES) == 0;
}
