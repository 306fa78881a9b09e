/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PostgreSQL by libpq. A connection that was lost is made again by the next statement outside of a
 * transaction. */
#include "station/hub/store.h"

#ifdef FOILGAUGE_POSTGRESQL
#include <libpq-fe.h>
#include <string.h>

#include "core/library.h"
#include "core/text.h"

/* Functions of libpq. */
/* clang-format off */
#define PQ_FUNCTIONS(F) \
  F(PQ, connectdb) \
  F(PQ, status) \
  F(PQ, reset) \
  F(PQ, finish) \
  F(PQ, errorMessage) \
  F(PQ, execParams) \
  F(PQ, resultStatus) \
  F(PQ, ntuples) \
  F(PQ, nfields) \
  F(PQ, getvalue) \
  F(PQ, clear) \
  F(PQ, transactionStatus) \
  F(PQ, setNoticeProcessor)
/* clang-format on */
static struct pq { PQ_FUNCTIONS(FG_LIBRARY_POINTER) } pq;
static const char *const names[] = {PQ_FUNCTIONS(FG_LIBRARY_NAME)};

static fg_library libpq = FG_LIBRARY("libpq.so.5", "libpq5", names, &pq, NULL);

static fg_status fail_pq(fg_context *ctx, PGconn *connection) {
  const char *words = pq.errorMessage(connection);
  return fg_fail(ctx, FG_ERR_IO, "PostgreSQL: %.*s", (int)strcspn(words, "\n"), words);
}

static void ignore_notice(void *user, const char *words) {
  (void)user;
  (void)words;
}

static fg_status open_postgresql(fg_context *ctx, const char *database, void **connection) {
  FG_TRY(fg_library_load(ctx, &libpq));
  PGconn *opened = *connection = pq.connectdb(database);
  if (!opened) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: PostgreSQL");
  pq.setNoticeProcessor(opened, ignore_notice, NULL);
  if (pq.status(opened) == CONNECTION_OK) return FG_OK;
  fg_status status = fail_pq(ctx, opened);
  pq.finish(opened);
  *connection = NULL;
  return status;
}

static fg_status copy_result(fg_context *ctx, PGresult *result, fg_hub_rows *rows) {
  char **cells;
  rows->columns = (size_t)pq.nfields(result);
  for (int row = 0; row < pq.ntuples(result); row++) {
    FG_TRY(fg_hub_rows_add(ctx, rows, &cells));
    for (size_t i = 0; i < rows->columns; i++)
      FG_TRY(fg_text_print(ctx, &cells[i], "%s", pq.getvalue(result, row, (int)i)));
  }
  return FG_OK;
}

static fg_status run_postgresql(fg_context *ctx, void *connection, const char *sql,
                                const char *const *values, size_t count, fg_hub_rows *rows) {
  if (pq.status(connection) != CONNECTION_OK) pq.reset(connection);
  if (pq.status(connection) != CONNECTION_OK) return fail_pq(ctx, connection);
  PGresult *result = pq.execParams(connection, sql, (int)count, NULL, values, NULL, NULL, 0);
  ExecStatusType how = pq.resultStatus(result);
  fg_status status = FG_OK;
  if (how != PGRES_COMMAND_OK && how != PGRES_TUPLES_OK)
    status = fail_pq(ctx, connection);
  else if (rows)
    status = copy_result(ctx, result, rows);
  pq.clear(result);
  return status;
}

static void close_postgresql(void *connection) {
  pq.finish(connection);
}

const fg_hub_kind fg_hub_postgresql = {open_postgresql, run_postgresql, close_postgresql,
                                       "CAST(CAST(body AS json) ->> 'foil' AS BIGINT)"};
#else
const fg_hub_kind fg_hub_postgresql = {.open = NULL};
#endif
