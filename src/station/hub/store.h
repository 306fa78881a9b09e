/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The database of a hub: SQLite or PostgreSQL, by the same statements.
 *
 * Values are texts, $1, $2 ... in the statement, each first used in this order; NULL is null. */
#ifndef FG_STATION_HUB_STORE_H
#define FG_STATION_HUB_STORE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* Rows of an answer; null is "". */
typedef struct fg_hub_rows {
  char **cell; /* rows × columns */
  size_t rows, columns;
} fg_hub_rows;

typedef struct fg_hub_store {
  void *connection;
  const struct fg_hub_kind *kind;
} fg_hub_store;

/* A kind of database. */
typedef struct fg_hub_kind {
  fg_status (*open)(fg_context *ctx, const char *database, void **connection);
  fg_status (*run)(fg_context *ctx, void *connection, const char *sql, const char *const *values,
                   size_t count, fg_hub_rows *rows);
  void (*close)(void *connection);
  const char *foil_of_body; /* SQL: the number of the foil in hub_events.body */
} fg_hub_kind;

extern const fg_hub_kind fg_hub_sqlite, fg_hub_postgresql;

/* Opens a path, or postgresql://…, and makes its tables. FG_ERR_USAGE: this build has no
 * PostgreSQL. */
fg_status fg_hub_store_open(fg_context *ctx, const char *database, fg_hub_store *store);
void fg_hub_store_close(fg_hub_store *store);

/* Runs a statement; the caller frees the rows. `rows` NULL: it has none. One call at a time. */
fg_status fg_hub_store_run(fg_context *ctx, fg_hub_store *store, const char *sql,
                           const char *const *values, size_t count, fg_hub_rows *rows);
const char *fg_hub_cell(const fg_hub_rows *rows, size_t row, size_t column);
/* Makes room for a row more; its cells are NULL. */
fg_status fg_hub_rows_add(fg_context *ctx, fg_hub_rows *rows, char ***cells);
void fg_hub_rows_free(fg_hub_rows *rows);

#endif
