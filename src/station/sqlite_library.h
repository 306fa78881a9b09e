/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SQLite, which is loaded for the first database (core/library.h). */
#ifndef FG_STATION_SQLITE_LIBRARY_H
#define FG_STATION_SQLITE_LIBRARY_H

#include <sqlite3.h>

#include "core/library.h"

/* clang-format off */
#define FG_SQLITE_FUNCTIONS(F) \
  F(sqlite3_, bind_double) \
  F(sqlite3_, bind_int64) \
  F(sqlite3_, bind_null) \
  F(sqlite3_, bind_text) \
  F(sqlite3_, bind_text64) \
  F(sqlite3_, busy_timeout) \
  F(sqlite3_, changes) \
  F(sqlite3_, close_v2) \
  F(sqlite3_, column_count) \
  F(sqlite3_, column_double) \
  F(sqlite3_, column_int64) \
  F(sqlite3_, column_text) \
  F(sqlite3_, column_type) \
  F(sqlite3_, create_function) \
  F(sqlite3_, db_config) \
  F(sqlite3_, errcode) \
  F(sqlite3_, errmsg) \
  F(sqlite3_, errstr) \
  F(sqlite3_, exec) \
  F(sqlite3_, extended_errcode) \
  F(sqlite3_, file_control) \
  F(sqlite3_, finalize) \
  F(sqlite3_, get_autocommit) \
  F(sqlite3_, last_insert_rowid) \
  F(sqlite3_, open_v2) \
  F(sqlite3_, prepare_v2) \
  F(sqlite3_, reset) \
  F(sqlite3_, result_error_nomem) \
  F(sqlite3_, result_text) \
  F(sqlite3_, step) \
  F(sqlite3_, total_changes64) \
  F(sqlite3_, value_text) \
  F(sqlite3_, wal_checkpoint_v2)
/* clang-format on */

/* Functions of SQLite, less sqlite3_ in front. */
typedef struct fg_sqlite_library {
  FG_SQLITE_FUNCTIONS(FG_LIBRARY_POINTER)
} fg_sqlite_library;

extern fg_sqlite_library fg_sqlite; /* NULL before fg_sqlite_library_load */

fg_status fg_sqlite_library_load(fg_context *ctx);

#endif
