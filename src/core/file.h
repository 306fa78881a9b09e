/* Files that appear under their final name only when they are whole. */
#ifndef FG_CORE_FILE_H
#define FG_CORE_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An output on its way: written to a temporary file in the same folder (core/temporary.h);
 * fg_output_commit makes it durable (fsync) and renames it; fg_output_discard removes it. A file
 * that is replaced hands down its mode, and its owner where the system allows that.
 *
 * A path of "-" or NULL is standard output. What is no file (a device, a pipe), and what names an
 * open descriptor (/dev/stdout, /dev/fd/3), is written directly; to a terminal, control characters
 * as \x1B, so that no name in a report makes it do anything. */
typedef struct fg_output {
  FILE *stream;
  char *path; /* where the bytes end up; NULL: standard output */
  struct fg_sink *sink;
} fg_output;

fg_status fg_output_open(fg_context *ctx, const char *path, fg_output *output);

/* Flushes what was written so far. `status` is what the writer came to: where it is FG_OK or
 * FG_ERR_IO and a write has failed, the words say which file and why (FG_ERR_IO); else it is
 * returned as it is. */
fg_status fg_output_flush(fg_context *ctx, fg_output *output, fg_status status);

/* Flushes, fsync, rename; FG_ERR_IO names the path and the first thing that went wrong. */
fg_status fg_output_commit(fg_context *ctx, fg_output *output);
void fg_output_discard(fg_output *output); /* harmless after a commit */

/* The end of a writer that came to `status`: commits where that is FG_OK, else discards. */
fg_status fg_output_end(fg_context *ctx, fg_output *output, fg_status status);

/* The end of a writer into an open stream: FG_ERR_IO when a write has failed. `what` is what was
 * written, in words. */
fg_status fg_stream_finish(fg_context *ctx, FILE *out, const char *what);

/* FG_ERR_IO: why `path` cannot be written, by its errno, and what to do. */
fg_status fg_output_fail(fg_context *ctx, const char *path, int error);

/* The whole text file, NUL-terminated; at most `cap` bytes, else FG_ERR_DATA. Caller frees. */
fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text);

#ifdef __cplusplus
}
#endif
#endif
