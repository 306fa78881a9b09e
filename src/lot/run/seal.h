/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seal of a line of JSON: its last member, "checksum", begins the SHA-256 of everything before it.
 * A change of any byte is noticed. */
#ifndef FG_LOT_RUN_SEAL_H
#define FG_LOT_RUN_SEAL_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* Adds checksum and newline to *line, an object with at least one member, from malloc.
 * FG_ERR_MEMORY: *line is freed and NULL. */
fg_status fg_seal_line(fg_context *ctx, char **line, size_t *length);

/* Returns true when the line, with its newline, has the checksum that it was sealed with. */
bool fg_seal_holds(const char *line, size_t length);

#endif
