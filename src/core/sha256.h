/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SHA-256 as reports state it: 64 lower-case hex digits. That of a file: foilgauge/file.h. */
#ifndef FG_CORE_SHA256_H
#define FG_CORE_SHA256_H

#include <sys/types.h>

#include <nettle/sha2.h>

#include "foilgauge/file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Ends the sum; `sum` starts afresh. */
void fg_sha256_finish(struct sha256_ctx *sum, char hex[65]);

void fg_sha256_text(const char *text, char hex[65]);

#ifdef __cplusplus
}
#endif
#endif
