/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/sql.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/utf8.h"

static fg_status fail_code(fg_context *ctx, int code, const char *what, const char *words) {
  switch (code & 0xFF) {
  case SQLITE_NOMEM:
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %s", what);
  case SQLITE_FULL:
    return fg_fail(ctx, FG_ERR_IO,
                   "%s: the disk is full: what was kept stays valid; free some space", what);
  case SQLITE_CORRUPT:
  case SQLITE_NOTADB:
    return fg_fail(
        ctx, FG_ERR_DATA,
        "%s: the database is damaged or none (%s): put it aside, and take it from a backup, "
        "or measure the folder's scans again",
        what, words);
  case SQLITE_READONLY:
  case SQLITE_CANTOPEN:
    return fg_fail(ctx, FG_ERR_IO,
                   "%s: %s: the station writes into its folder; check whose it is and what may be "
                   "written there",
                   what, words);
  default:
    return fg_fail(ctx, FG_ERR_IO, "%s: %s", what, words);
  }
}

fg_status fg_sql_fail(fg_context *ctx, sqlite3 *connection, const char *what) {
  int code = connection ? fg_sqlite.extended_errcode(connection) : SQLITE_NOMEM;
  return fail_code(ctx, code, what, connection ? fg_sqlite.errmsg(connection) : "out of memory");
}

void fg_sql_close(sqlite3 *connection) {
  if (connection) fg_sqlite.close_v2(connection);
}

fg_status fg_sql_open(fg_context *ctx, const char *path, int flags, sqlite3 **connection) {
  *connection = NULL;
  FG_TRY(fg_sqlite_library_load(ctx));
  if (fg_sqlite.open_v2(path, connection, flags, NULL) == SQLITE_OK) return FG_OK;
  fg_status failed = fg_sql_fail(ctx, *connection, path);
  fg_sql_close(*connection);
  *connection = NULL;
  return failed;
}

fg_status fg_sql_run(fg_context *ctx, sqlite3 *connection, const char *sql) {
  if (fg_sqlite.exec(connection, sql, NULL, NULL, NULL) == SQLITE_OK) return FG_OK;
  return fg_sql_fail(ctx, connection, "the database");
}

void fg_query_begin(sqlite3 *connection, const char *sql, fg_query *query) {
  *query = (fg_query){.connection = connection};
  query->error = fg_sqlite.prepare_v2(connection, sql, -1, &query->statement, NULL);
}

static void note_error(fg_query *query, int code) {
  if (query->error == SQLITE_OK && code != SQLITE_OK) query->error = code;
}

/* Other programs cannot read a row that holds anything else than UTF-8: stray bytes, of a message
 * that was cut, of a text that quotes a file, become \xE4. */
static void bind_visible(fg_query *query, const char *text) {
  size_t size = strlen(text), length;
  char *visible = malloc(4 * size);
  if (visible) {
    fg_utf8_make_visible(text, size, true, visible, &length);
    note_error(query, fg_sqlite.bind_text64(query->statement, query->bound, visible, length,
                                            SQLITE_TRANSIENT, SQLITE_UTF8));
  } else {
    note_error(query, SQLITE_NOMEM);
  }
  free(visible);
}

void fg_query_text(fg_query *query, const char *text) {
  query->bound++;
  if (text && !fg_utf8_is_valid(text)) {
    if (query->error == SQLITE_OK) bind_visible(query, text);
    return;
  }
  if (query->error == SQLITE_OK)
    note_error(query, text ? fg_sqlite.bind_text(query->statement, query->bound, text, -1,
                                                 SQLITE_TRANSIENT)
                           : fg_sqlite.bind_null(query->statement, query->bound));
}

void fg_query_integer(fg_query *query, int64_t value) {
  query->bound++;
  if (query->error == SQLITE_OK)
    note_error(query, fg_sqlite.bind_int64(query->statement, query->bound, value));
}

void fg_query_number(fg_query *query, double value) {
  query->bound++;
  if (query->error == SQLITE_OK)
    note_error(query, isfinite(value) ? fg_sqlite.bind_double(query->statement, query->bound, value)
                                      : fg_sqlite.bind_null(query->statement, query->bound));
}

bool fg_query_row(fg_query *query) {
  if (query->error != SQLITE_OK) return false;
  int code = fg_sqlite.step(query->statement);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) note_error(query, code);
  return false;
}

const char *fg_query_get_text(const fg_query *query, int column) {
  const unsigned char *text = fg_sqlite.column_text(query->statement, column);
  return text ? (const char *)text : "";
}

int64_t fg_query_get_integer(const fg_query *query, int column) {
  return fg_sqlite.column_int64(query->statement, column);
}

double fg_query_get_number(const fg_query *query, int column) {
  return fg_query_is_null(query, column) ? NAN : fg_sqlite.column_double(query->statement, column);
}

bool fg_query_is_null(const fg_query *query, int column) {
  return fg_sqlite.column_type(query->statement, column) == SQLITE_NULL;
}

void fg_query_again(fg_query *query) {
  query->bound = 0;
  if (query->statement) fg_sqlite.reset(query->statement);
}

/* The connection's message is of the last call: an earlier error is reported by its code. */
fg_status fg_query_end(fg_context *ctx, fg_query *query, const char *what) {
  fg_status status = FG_OK;
  if (query->error != SQLITE_OK) {
    bool last = (fg_sqlite.errcode(query->connection) & 0xFF) == (query->error & 0xFF);
    status = fail_code(ctx, query->error, what,
                       last ? fg_sqlite.errmsg(query->connection) : fg_sqlite.errstr(query->error));
  }
  fg_sqlite.finalize(query->statement);
  query->statement = NULL;
  return status;
}
