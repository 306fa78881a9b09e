/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts that the code fills into texts of help and manual: defaults, lists of formats and of
 * words, exit codes. A text names them as @name@. */
#ifndef FG_CLI_FACTS_H
#define FG_CLI_FACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Defaults that are the command line's own; those of the library stand in its headers. */
enum {
  FG_CLI_STATION_PORT = 8317,
  FG_CLI_HUB_PORT = 8318,
  FG_CLI_LOOP_MINUTES = 10, /* longest estimated search that is not refused */
  FG_CLI_LOOP_MEBIBYTES = 512,
  FG_CLI_SEED = 1,
};
#define FG_CLI_LOT_RESPONSE "radius_mm"
#define FG_CLI_LOT_MODEL    "1"

typedef struct fg_fact {
  const char *name;
  void (*write)(FILE *out);
} fg_fact;

/* Returns the fact of that name, or NULL. */
const fg_fact *fg_fact_find(const char *name, size_t length);

/* The exit codes of a kind of commands, by the name of its fact ("exit_judged"). */
typedef struct fg_exit_code {
  int code;
  const char *words;
} fg_exit_code;
bool fg_exit_codes_use(const char *kind, size_t length, const fg_exit_code *code);
extern const fg_exit_code fg_exit_codes[]; /* ends with words of NULL */

/* Writes a text with its facts filled in; `more` (may be NULL) finds further facts. Returns true
 * when every fact that it names is known. */
bool fg_facts_write(const char *text, const fg_fact *(*more)(const char *, size_t), FILE *out);

/* Fills the texts of --help; the help_filter of a parser (argp). */
char *fg_cli_fill(int key, const char *text, void *input);

#endif
