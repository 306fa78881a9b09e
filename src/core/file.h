/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: the room's own part beside the public foilgauge/file.h. */
#ifndef FG_CORE_FILE_H
#define FG_CORE_FILE_H

#include "foilgauge/file.h"

/* Opens a file to read. */
fg_status fg_file_open(fg_context *ctx, const char *path, FILE **stream);

/* Opens a file to read its content and to append to it; a missing one is made. */
fg_status fg_file_open_to_append(fg_context *ctx, const char *path, FILE **stream);

/* Ends the writing to an open stream: FG_ERR_IO when a write has failed. `what` names the content
 * in words. */
fg_status fg_stream_finish(fg_context *ctx, FILE *out, const char *what);

/* Opens a stream into memory; NULL: memory ran out. A write that finds no memory is an error of the
 * stream; glibc's own stream in memory drops such bytes and tells nobody. `*text` and `*size` are
 * set at its end. */
FILE *fg_stream_open(char **text, size_t *size);

/* Ends such a stream, or NULL. Returns true when `*text` is whole, with a '\0' after it; else
 * memory ran out, and it is NULL. The caller frees it. */
bool fg_stream_keep(FILE *out, char **text);

/* Resolves `name` against the folder of the file `path`. */
void fg_file_find_beside(const char *path, const char *name, char *file, size_t size);

#endif
