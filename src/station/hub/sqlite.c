/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/text.h"
#include "station/hub/store.h"
#include "station/sql.h"

enum { BUSY_MS = 5000 };

static void close_sqlite(void *connection) {
  fg_sql_close(connection);
}

static fg_status open_sqlite(fg_context *ctx, const char *database, void **connection) {
  sqlite3 *opened;
  int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  fg_status status = fg_sql_open(ctx, database, flags, &opened);
  if (status == FG_OK) fg_sqlite.busy_timeout(opened, BUSY_MS);
  if (status == FG_OK)
    status = fg_sql_run(ctx, opened, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
  *connection = opened;
  if (status == FG_OK) return FG_OK;
  close_sqlite(opened);
  *connection = NULL;
  return status;
}

static fg_status copy_row(fg_context *ctx, const fg_query *query, fg_hub_rows *rows) {
  char **cells;
  rows->columns = (size_t)fg_sqlite.column_count(query->statement);
  FG_TRY(fg_hub_rows_add(ctx, rows, &cells));
  for (size_t i = 0; i < rows->columns; i++)
    FG_TRY(fg_text_print(ctx, &cells[i], "%s", fg_query_get_text(query, (int)i)));
  return FG_OK;
}

static fg_status run_sqlite(fg_context *ctx, void *connection, const char *sql,
                            const char *const *values, size_t count, fg_hub_rows *rows) {
  fg_query query;
  fg_status status = FG_OK;
  fg_query_begin(connection, sql, &query);
  for (size_t i = 0; i < count; i++)
    fg_query_text(&query, values[i]);
  while (fg_query_row(&query) && status == FG_OK)
    if (rows) status = copy_row(ctx, &query, rows);
  fg_status ended = fg_query_end(status == FG_OK ? ctx : NULL, &query, "the hub's database");
  return status == FG_OK ? ended : status;
}

const fg_hub_kind fg_hub_sqlite = {open_sqlite, run_sqlite, close_sqlite,
                                   "json_extract(body, '$.foil')"};
