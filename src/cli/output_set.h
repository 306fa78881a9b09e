/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outputs of one command: none overwrites an input, and all or none get their names. */
#ifndef FG_CLI_OUTPUT_SET_H
#define FG_CLI_OUTPUT_SET_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/file.h"

enum { FG_OUTPUT_SET_MAX = 8 };

typedef struct fg_output_set {
  const char *path[FG_OUTPUT_SET_MAX]; /* NULL: not asked for; "-": standard output */
  size_t count;
  fg_output output[FG_OUTPUT_SET_MAX];
  bool open[FG_OUTPUT_SET_MAX];
  fg_overwrite overwrite;
  unsigned csv; /* bits of the kinds that are CSV */
  bool decimal_comma;
} fg_output_set;

/* An input of the command; a path of NULL is none. */
typedef struct fg_input {
  const char *path;
  const char *words; /* for messages: "the scan" */
} fg_input;

bool fg_is_standard(const char *path);
bool fg_output_set_has_standard(
    const fg_output_set *set); /* true when one of them is standard output */

/* Chooses standard output for results that no option sends elsewhere. A terminal shows the text,
 * even where files are written. A pipe or a file gets the JSON when no output is asked for, and
 * with `json_beside` when no JSON is. */
void fg_output_set_choose_standard(fg_output_set *set, size_t json, size_t text, bool json_beside);

/* FG_ERR_USAGE when two outputs are one file, or one is an input (foilgauge/file.h). Call it
 * once all outputs are known and before any work; again when more inputs become known. */
fg_status fg_output_set_check(fg_context *ctx, fg_output_set *set, const fg_input *inputs,
                              size_t count);

fg_status fg_output_set_open(fg_context *ctx, fg_output_set *set);

/* Writes the output `kind` to its stream. */
typedef fg_status fg_output_writer(fg_context *ctx, void *user, size_t kind, FILE *out);

/* Writes and flushes everything before anything gets its final name, so that a full disk shows
 * first; standard output comes last, when all files are written. */
fg_status fg_output_set_write(fg_context *ctx, fg_output_set *set, fg_output_writer *writer,
                              void *user);
void fg_output_set_close(fg_output_set *set); /* removes outputs that were not committed */

/* Outputs of `loop`, on tables and on scans. */
typedef enum fg_loop_output {
  FG_LOOP_HTML,
  FG_LOOP_MODEL,
  FG_LOOP_JSON,
  FG_LOOP_TEXT,
  FG_LOOP_OUTPUTS
} fg_loop_output;

/* Sends results without -o to standard output: as text on a terminal, else as JSON where no file
 * was asked for. */
void fg_loop_outputs_choose(fg_output_set *set);

#endif
