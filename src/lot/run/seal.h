/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A line of JSON that carries its own checksum: its last member, "checksum", is the beginning of
 * the SHA-256 of all that stands before it. Whatever byte of the line changes, it is noticed. */
#ifndef FG_LOT_RUN_SEAL_H
#define FG_LOT_RUN_SEAL_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* *line is an object with at least one member, from malloc; it gets the checksum and a newline.
 * FG_ERR_MEMORY: *line is freed and NULL. */
fg_status fg_seal_line(fg_context *ctx, char **line, size_t *length);

/* Whether the line, with its newline, is one that was sealed, to the byte. */
bool fg_seal_holds(const char *line, size_t length);

#endif
