/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/hub/store.h"

#include <stdlib.h>
#include <string.h>

#include "core/text.h"

/* An event is there once: its source and number are its key. A part is the newest event of its
 * foil. It has the hub's own time of the foil's first event: a station's clock may be wrong. */
static const char *const tables[] = {
    "CREATE TABLE IF NOT EXISTS hub_events (source TEXT NOT NULL, event BIGINT NOT NULL,"
    " received_at TEXT NOT NULL, body TEXT NOT NULL, PRIMARY KEY (source, event))",
    "CREATE TABLE IF NOT EXISTS hub_parts (source TEXT NOT NULL, foil BIGINT NOT NULL,"
    " event BIGINT NOT NULL, station TEXT NOT NULL, at TEXT NOT NULL, measured_at TEXT NOT NULL,"
    " serial TEXT NOT NULL, lot TEXT NOT NULL, die TEXT NOT NULL, operator TEXT NOT NULL,"
    " verdict TEXT NOT NULL, withheld TEXT NOT NULL, disposition TEXT NOT NULL,"
    " received_at TEXT NOT NULL DEFAULT '', PRIMARY KEY (source, foil))",
    "CREATE TABLE IF NOT EXISTS hub_stations (source TEXT PRIMARY KEY, station TEXT NOT NULL,"
    " received_at TEXT NOT NULL)",
    "CREATE INDEX IF NOT EXISTS hub_parts_by_serial ON hub_parts (serial)",
    "CREATE INDEX IF NOT EXISTS hub_parts_by_lot ON hub_parts (lot)",
};

/* Databases of before have no times of receipt: those of the events are taken. */
static fg_status add_receipts(fg_context *ctx, fg_hub_store *store) {
  char *sql;
  FG_TRY(fg_text_print(
      ctx, &sql,
      "UPDATE hub_parts SET received_at = first.received_at FROM (SELECT source AS of_source,"
      " %s AS of_foil, min(received_at) AS received_at FROM hub_events GROUP BY 1, 2) AS first"
      " WHERE source = of_source AND foil = of_foil",
      store->kind->foil_of_body));
  fg_status status = fg_hub_store_run(
      ctx, store, "ALTER TABLE hub_parts ADD COLUMN received_at TEXT NOT NULL DEFAULT ''", NULL, 0,
      NULL);
  if (status == FG_OK) status = fg_hub_store_run(ctx, store, sql, NULL, 0, NULL);
  free(sql);
  return status;
}

static fg_status update_tables(fg_context *ctx, fg_hub_store *store) {
  fg_context inner;
  if (fg_hub_store_run(&inner, store, "SELECT received_at FROM hub_parts LIMIT 0", NULL, 0, NULL) ==
      FG_OK)
    return FG_OK;
  FG_TRY(fg_hub_store_run(ctx, store, "BEGIN", NULL, 0, NULL));
  fg_status status = add_receipts(ctx, store);
  if (status == FG_OK) return fg_hub_store_run(ctx, store, "COMMIT", NULL, 0, NULL);
  fg_hub_store_run(&inner, store, "ROLLBACK", NULL, 0, NULL);
  return status;
}

fg_status fg_hub_store_open(fg_context *ctx, const char *database, fg_hub_store *store) {
  bool is_url = !strncmp(database, "postgresql://", 13) || !strncmp(database, "postgres://", 11);
  *store = (fg_hub_store){.kind = is_url ? &fg_hub_postgresql : &fg_hub_sqlite};
  if (!store->kind->open)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "this build has no PostgreSQL: build it where libpq-dev is installed");
  FG_TRY(store->kind->open(ctx, database, &store->connection));
  for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
    FG_TRY(fg_hub_store_run(ctx, store, tables[i], NULL, 0, NULL));
  FG_TRY(update_tables(ctx, store));
  return fg_hub_store_run(ctx, store,
                          "CREATE INDEX IF NOT EXISTS hub_parts_by_receipt ON hub_parts"
                          " (received_at)",
                          NULL, 0, NULL);
}

void fg_hub_store_close(fg_hub_store *store) {
  if (store->connection) store->kind->close(store->connection);
  store->connection = NULL;
}

fg_status fg_hub_store_run(fg_context *ctx, fg_hub_store *store, const char *sql,
                           const char *const *values, size_t count, fg_hub_rows *rows) {
  if (rows) *rows = (fg_hub_rows){0};
  fg_status status = store->kind->run(ctx, store->connection, sql, values, count, rows);
  if (status != FG_OK && rows) fg_hub_rows_free(rows);
  return status;
}

const char *fg_hub_cell(const fg_hub_rows *rows, size_t row, size_t column) {
  const char *text = rows->cell[row * rows->columns + column];
  return text ? text : "";
}

fg_status fg_hub_rows_add(fg_context *ctx, fg_hub_rows *rows, char ***cells) {
  size_t used = rows->rows * rows->columns;
  char **grown = realloc(rows->cell, (used + rows->columns + 1) * sizeof *grown);
  if (!grown) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: rows of the hub");
  rows->cell = grown;
  *cells = grown + used;
  for (size_t i = 0; i < rows->columns; i++)
    (*cells)[i] = NULL;
  rows->rows++;
  return FG_OK;
}

void fg_hub_rows_free(fg_hub_rows *rows) {
  for (size_t i = 0; i < rows->rows * rows->columns; i++)
    free(rows->cell[i]);
  free(rows->cell);
  *rows = (fg_hub_rows){0};
}
