/* Files that appear under their final name only when they are whole. */
#ifndef FG_CORE_FILE_H
#define FG_CORE_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An output on its way: written to a temporary file in the same folder; fg_output_commit makes it
 * durable (fsync) and renames it; fg_output_discard removes it. A path of "-" or NULL is standard
 * output. /dev/ paths are written directly. */
typedef struct fg_output {
  FILE *stream;
  char *path;
  char *temporary; /* NULL when written directly */
} fg_output;

fg_status fg_output_open(fg_context *ctx, const char *path, fg_output *output);
/* Flushes, checks for write errors (disk full: FG_ERR_IO naming the path), fsync, rename. */
fg_status fg_output_commit(fg_context *ctx, fg_output *output);
void fg_output_discard(fg_output *output); /* harmless after a commit */

/* The whole text file, NUL-terminated; at most `cap` bytes, else FG_ERR_DATA. Caller frees. */
fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text);

#ifdef __cplusplus
}
#endif
#endif
