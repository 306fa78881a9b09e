/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/sqlite_library.h"

fg_sqlite_library fg_sqlite;

static const char *const names[] = {FG_SQLITE_FUNCTIONS(FG_LIBRARY_NAME)};

static fg_library library =
    FG_LIBRARY(FOILGAUGE_SQLITE_FILE, "libsqlite3-0", names, &fg_sqlite, NULL);

fg_status fg_sqlite_library_load(fg_context *ctx) {
  return fg_library_load(ctx, &library);
}
