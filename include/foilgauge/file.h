/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files: outputs that appear under their final name only when they are whole, what an output must
 * not take the place of, and inputs that are read whole.
 *
 * A writer of reports goes so:
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

/* An output on its way: written to a temporary file in the same folder; fg_output_commit makes it
 * durable (fsync) and renames it; fg_output_discard removes it. A file that is replaced hands down
 * its mode, and its owner where the system allows that.
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

/* FG_ERR_IO: why `path` cannot be written, by its errno, and what to do. */
fg_status fg_output_fail(fg_context *ctx, const char *path, int error);

/* Removes the temporary files of all outputs that are not committed: their names are the only state
 * that the library keeps beyond a call. From here on none is made, renamed or closed: every other
 * thread that tries waits for the end of the process, which must follow. Not to be called in a
 * signal handler, but by a thread that waits for signals. */
void fg_temporaries_remove(void);

/* What an output must not take the place of: an input, or another output. Files are told apart by
 * device and inode, so that no spelling, link or redirection hides that two names are one; a file
 * that is not there yet, by the folder that it will be in and its name. Devices can be named as
 * often as one likes. */
typedef struct fg_overwrite {
  struct fg_output_place *places; /* of the outputs */
  size_t count;
} fg_overwrite;

/* Looks up the outputs: NULL is none, "-" standard output. FG_ERR_USAGE when two are one file. All
 * zero before; fg_overwrite_free in any case. */
fg_status fg_overwrite_begin(fg_context *ctx, const char *const *outputs, size_t count,
                             fg_overwrite *overwrite);

/* FG_ERR_USAGE when an output would overwrite `input`, called so in `words` ("the scan"). NULL is
 * no input, "-" standard input. */
fg_status fg_overwrite_check(fg_context *ctx, const fg_overwrite *overwrite, const char *input,
                             const char *words);

/* One file, or one that is not there yet. */
bool fg_overwrite_is_same(const char *a, const char *b);

void fg_overwrite_free(fg_overwrite *overwrite);

/* The whole text file, NUL-terminated; at most `cap` bytes, else FG_ERR_DATA. Caller frees. */
fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text);

/* Writes CSV: as `write` writes it, with commas and decimal points; or with `decimal_comma` the
 * same cells between semicolons, numbers with decimal commas, behind a byte order mark, as
 * spreadsheets of many countries read it. */
typedef fg_status fg_csv_writer(fg_context *ctx, void *user, FILE *out);
fg_status fg_csv_write(fg_context *ctx, bool decimal_comma, fg_csv_writer *write, void *user,
                       FILE *out);

/* The SHA-256 of a regular file as reports state it: 64 lower-case hex digits. FG_ERR_IO,
 * FG_ERR_MEMORY. */
fg_status fg_sha256_file(fg_context *ctx, const char *path, char hex[65]);

#ifdef __cplusplus
}
#endif
#endif
