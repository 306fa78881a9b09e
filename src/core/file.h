/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: the room's own part beside the public foilgauge/file.h. */
#ifndef FG_CORE_FILE_H
#define FG_CORE_FILE_H

#include "foilgauge/file.h"

/* Ends the writing to an open stream: FG_ERR_IO when a write has failed. `what` names the content
 * in words. */
fg_status fg_stream_finish(fg_context *ctx, FILE *out, const char *what);

/* Ends a stream of open_memstream, or NULL where that failed. Returns true when `*text` is whole;
 * else memory ran out, and it is freed and NULL. glibc says so by ferror alone, or where the last
 * step fails by no text beside a success. */
bool fg_stream_keep(FILE *out, char **text);

/* Resolves `name` against the folder of the file `path`. */
void fg_file_find_beside(const char *path, const char *name, char *file, size_t size);

#endif
