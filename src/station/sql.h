/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SQLite, with statuses: a statement from its text to its rows. */
#ifndef FG_STATION_SQL_H
#define FG_STATION_SQL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <sqlite3.h>

#include "foilgauge/status.h"

/* FG_ERR_IO with SQLite's words: disk full and what to do, damaged (FG_ERR_DATA), busy. */
fg_status fg_sql_fail(fg_context *ctx, sqlite3 *connection, const char *what);

/* Several statements without values or rows. */
fg_status fg_sql_run(fg_context *ctx, sqlite3 *connection, const char *sql);

/* One statement. Errors stay in it until fg_query_end: values can be bound and rows read without a
 * look at each. After a value that could not be bound there are no rows. */
typedef struct fg_query {
  sqlite3 *connection;
  sqlite3_stmt *statement;
  int bound, error;
} fg_query;

void fg_query_begin(sqlite3 *connection, const char *sql, fg_query *query);
/* Values in the order of the statement's question marks. NULL and NaN are null; texts are copied.
 */
void fg_query_text(fg_query *query, const char *text);
void fg_query_integer(fg_query *query, int64_t value);
void fg_query_number(fg_query *query, double value);
/* The next row, or false. */
bool fg_query_row(fg_query *query);
/* Of the row, by the column's place from 0: "" and NaN for null. Valid until the next row. */
const char *fg_query_get_text(const fg_query *query, int column);
int64_t fg_query_get_integer(const fg_query *query, int column);
double fg_query_get_number(const fg_query *query, int column);
bool fg_query_is_null(const fg_query *query, int column);
/* Makes it ready for other values; the rows of the last are gone. */
void fg_query_again(fg_query *query);
/* Frees it. The status is FG_OK when everything went well since the beginning. */
fg_status fg_query_end(fg_context *ctx, fg_query *query, const char *what);

#endif
