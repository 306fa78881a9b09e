/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SHA-256 as in reports: 64 lower-case hex digits. foilgauge/file.h has that of a file. */
#ifndef FG_CORE_SHA256_H
#define FG_CORE_SHA256_H

#include <sys/types.h>

#include <nettle/sha2.h>

#include "foilgauge/file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Ends the sum and writes it; `sum` begins anew. */
void fg_sha256_finish(struct sha256_ctx *sum, char hex[65]);

void fg_sha256_text(const char *text, char hex[65]);

#ifdef __cplusplus
}
#endif
#endif
