/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: outputs that appear under their final name only when they are whole, a guard against
 * overwriting inputs, and inputs that are read whole.
 *
 * Pattern of a writer of reports:
 *
 *     fg_output output;
 *     FG_TRY(fg_output_open(ctx, "report.json", &output));
 *     return fg_output_end(ctx, &output, fg_report_write_json(ctx, &report, output.stream));
 */
#ifndef FOILGAUGE_FILE_H
#define FOILGAUGE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An output in progress. It is written to a temporary file in the same folder; fg_output_commit
 * makes it durable (fsync) and renames it; fg_output_discard removes it. A replaced file passes on
 * its mode, and its owner where the system allows that.
 *
 * A path of "-" or NULL is standard output. A device, a pipe, and a name of an open descriptor
 * (/dev/stdout, /dev/fd/3) are written directly. To a terminal, control characters go as \x1B, so
 * that no name in a report can control it. */
typedef struct fg_output {
  FILE *stream;
  char *path; /* final path; NULL: standard output */
  struct fg_sink *sink;
} fg_output;

fg_status fg_output_open(fg_context *ctx, const char *path, fg_output *output);

/* Flushes the output. `status` is the writer's result. Where it is FG_OK or FG_ERR_IO and a write
 * has failed, the message names file and reason (FG_ERR_IO); else `status` is returned unchanged.
 */
fg_status fg_output_flush(fg_context *ctx, fg_output *output, fg_status status);

/* Flushes, fsync, rename; FG_ERR_IO names the path and the first error. */
fg_status fg_output_commit(fg_context *ctx, fg_output *output);
void fg_output_discard(fg_output *output); /* harmless after a commit */

/* Ends a writer with the result `status`: commits on FG_OK, else discards. */
fg_status fg_output_end(fg_context *ctx, fg_output *output, fg_status status);

/* FG_ERR_IO with the reason why `path` cannot be written, by its errno, and the remedy. */
fg_status fg_output_fail(fg_context *ctx, const char *path, int error);

/* Removes the temporary files of all uncommitted outputs: their names are the only state that the
 * library keeps beyond a call. Afterwards none is made, renamed or closed: every other thread that
 * tries waits for the end of the process, which must follow. Do not call it in a signal handler,
 * but in a thread that waits for signals. */
void fg_temporaries_remove(void);

/* Guard against outputs that would replace an input or another output. Files are told apart by
 * device and inode, so that no spelling, link or redirection hides that two names are one; a file
 * that does not exist yet, by its folder and name. A device may be named more than once. */
typedef struct fg_overwrite {
  struct fg_output_place *places; /* of the outputs */
  size_t count;
} fg_overwrite;

/* Looks up the outputs: NULL is none, "-" standard output. FG_ERR_USAGE when two are one file.
 * `overwrite` is all zero before; call fg_overwrite_free in any case. */
fg_status fg_overwrite_begin(fg_context *ctx, const char *const *outputs, size_t count,
                             fg_overwrite *overwrite);

/* FG_ERR_USAGE when an output would overwrite `input`, which `words` names ("the scan"). NULL is no
 * input, "-" standard input. */
fg_status fg_overwrite_check(fg_context *ctx, const fg_overwrite *overwrite, const char *input,
                             const char *words);

/* Returns true when both names are one file, or one that does not exist yet. */
bool fg_overwrite_is_same(const char *a, const char *b);

void fg_overwrite_free(fg_overwrite *overwrite);

/* Reads a whole text file, NUL-terminated; at most `cap` bytes, else FG_ERR_DATA. The caller frees
 * it. */
fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text);

/* Reads a secret: the first word of the first line. FG_ERR_IO, FG_ERR_DATA: there is none. */
fg_status fg_file_read_token(fg_context *ctx, const char *path, char *token, int size);

/* Writes CSV by `write`, with commas and decimal points. With `decimal_comma` it writes the same
 * cells between semicolons, numbers with decimal commas, after a byte order mark, as spreadsheets
 * of many countries read it. */
typedef fg_status fg_csv_writer(fg_context *ctx, void *user, FILE *out);
fg_status fg_csv_write(fg_context *ctx, bool decimal_comma, fg_csv_writer *write, void *user,
                       FILE *out);

/* SHA-256 of a regular file as in reports: 64 lower-case hex digits. FG_ERR_IO, FG_ERR_MEMORY. */
fg_status fg_sha256_file(fg_context *ctx, const char *path, char hex[65]);

#ifdef __cplusplus
}
#endif
#endif
