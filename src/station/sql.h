/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SQLite, with statuses: a statement from its text to its rows. */
#ifndef FG_STATION_SQL_H
#define FG_STATION_SQL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "station/sqlite_library.h"

/* Opens a database, by flags of sqlite3_open_v2. *connection is NULL after a failure. */
fg_status fg_sql_open(fg_context *ctx, const char *path, int flags, sqlite3 **connection);
void fg_sql_close(sqlite3 *connection);

/* Fails with SQLite's words and advice: FG_ERR_IO (disk full, busy), FG_ERR_DATA (damaged). */
fg_status fg_sql_fail(fg_context *ctx, sqlite3 *connection, const char *what);

/* Runs several statements without values or rows. */
fg_status fg_sql_run(fg_context *ctx, sqlite3 *connection, const char *sql);

/* One statement. Errors stay in it until fg_query_end: no call in between has to be checked.
 * After a value that could not be bound there are no rows. */
typedef struct fg_query {
  sqlite3 *connection;
  sqlite3_stmt *statement;
  int bound, error;
} fg_query;

void fg_query_begin(sqlite3 *connection, const char *sql, fg_query *query);
/* Bind values in the order of the statement's question marks. NULL and NaN are null; texts are
 * copied. */
void fg_query_text(fg_query *query, const char *text);
void fg_query_integer(fg_query *query, int64_t value);
void fg_query_number(fg_query *query, double value);
/* Reads the next row; false: there is none. */
bool fg_query_row(fg_query *query);
/* Return a column of the row, counted from 0: "" and NaN for null. Valid until the next row. */
const char *fg_query_get_text(const fg_query *query, int column);
int64_t fg_query_get_integer(const fg_query *query, int column);
double fg_query_get_number(const fg_query *query, int column);
bool fg_query_is_null(const fg_query *query, int column);
/* Resets the statement for other values; its rows are gone. */
void fg_query_again(fg_query *query);
/* Frees it and returns the status of all calls since the beginning. */
fg_status fg_query_end(fg_context *ctx, fg_query *query, const char *what);

#endif
