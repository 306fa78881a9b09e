/* Several outputs of one command: all or none get their final names. */
#ifndef FG_CLI_OUTPUT_SET_H
#define FG_CLI_OUTPUT_SET_H

#include <stdbool.h>
#include <stddef.h>

#include "cli/interrupt.h"
#include "core/file.h"

enum { FG_OUTPUT_SET_MAX = 8 };

typedef struct fg_output_set {
  const char *path[FG_OUTPUT_SET_MAX]; /* NULL: not asked for; "-": standard output */
  size_t count;
  fg_output output[FG_OUTPUT_SET_MAX];
  bool open[FG_OUTPUT_SET_MAX];
  fg_interrupt interrupt;
} fg_output_set;

/* Whether two paths are one regular file; a name that is not there yet is compared as text. */
bool fg_same_file(const char *a, const char *b);
bool fg_is_standard(const char *path);

/* FG_ERR_USAGE when two outputs are one file, or one is the file `input` (named so in words). */
fg_status fg_output_set_check(fg_context *ctx, const fg_output_set *set, const char *input,
                              const char *words);

/* Opens all; from here to fg_output_set_close a signal leaves nothing behind. */
fg_status fg_output_set_open(fg_context *ctx, fg_output_set *set);

/* Writes the output `kind` to its stream. */
typedef fg_status fg_output_writer(fg_context *ctx, void *user, size_t kind, FILE *out);

/* Writes and flushes everything before anything gets its final name, so that a full disk shows
 * first; standard output comes last, when all files are written. */
fg_status fg_output_set_write(fg_context *ctx, fg_output_set *set, fg_output_writer *writer,
                              void *user);
void fg_output_set_close(fg_output_set *set); /* what was not committed is removed */

#endif
