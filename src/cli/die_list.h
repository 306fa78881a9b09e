/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The profiles of a die: one after the other on the command line, or rows of a table. */
#ifndef FG_CLI_DIE_LIST_H
#define FG_CLI_DIE_LIST_H

#include "foilgauge/die.h"

typedef struct fg_die_sources {
  fg_die_source *source; /* owned, `count` of them */
  char **path;           /* paths that were joined to a folder; owned */
  size_t count, capacity, path_count, path_capacity;
} fg_die_sources;

fg_status fg_die_sources_add(fg_context *ctx, fg_die_sources *sources, const fg_die_source *source);
void fg_die_sources_free(fg_die_sources *sources);

/* Read a half, two units, two columns; false: the text is none of that kind. */
bool fg_die_read_half(const char *text, const char **half);
bool fg_die_read_units(const char *text, fg_die_unit unit[2]);
bool fg_die_read_columns(const char *text, size_t column[2]);

/* Adds the rows of a table; cells that it lacks are as `said`. */
fg_status fg_die_list_load(fg_context *ctx, const char *path, const fg_die_source *said,
                           fg_die_sources *sources);

#endif
