/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cards of files, and setups of scans, in the database. */
#include "station/keep.h"

#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/sha256.h"
#include "lot/run/lot.h"

const char *fg_card_word(fg_card card) {
  static const char *const words[] = {"measured",   "known", "unfinished", "foreign",
                                      "unreadable", "check", "duplicate"};
  return words[card];
}

static fg_status find_setup(fg_context *ctx, fg_station_database *database, const char *sum,
                            int64_t *setup) {
  fg_query query;
  fg_query_begin(database->writer, "SELECT id FROM setups WHERE sha256 = ?", &query);
  fg_query_text(&query, sum);
  *setup = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "reading the setups");
}

static fg_status insert_setup(fg_context *ctx, fg_station_database *database,
                              const fg_lot_settings *settings, const char *sum, const char *recipe,
                              const char *model, int64_t *setup) {
  fg_query query;
  fg_query_begin(database->writer,
                 "INSERT INTO setups (sha256, program, recipe, model, model_sha256, first_at)"
                 " VALUES (?, ?, ?, ?, ?, ?)",
                 &query);
  fg_query_text(&query, sum);
  fg_query_text(&query, FOILGAUGE_VERSION);
  fg_query_text(&query, recipe);
  fg_query_text(&query, model);
  fg_query_text(&query, model ? settings->model_sha256 : NULL);
  fg_query_integer(&query, fg_station_now());
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping the setup"));
  *setup = fg_sqlite.last_insert_rowid(database->writer);
  return FG_OK;
}

fg_status fg_station_keep_setup(fg_context *ctx, fg_station_database *database,
                                const fg_lot_settings *settings, int64_t *setup) {
  char sum[65], *recipe = NULL, *model = NULL, *whole = NULL;
  size_t size;
  fg_status status = fg_lot_settings_format(ctx, settings, false, &recipe);
  if (status == FG_OK && settings->model[0])
    status = fg_file_read_text(ctx, settings->model, FG_LOT_MODEL_BYTES_MAX, &model);
  FILE *out = status == FG_OK ? fg_stream_open(&whole, &size) : NULL;
  if (out) {
    fprintf(out, "%s\n%s\n%s", FOILGAUGE_VERSION, recipe, model ? model : "");
    if (!fg_stream_keep(out, &whole))
      status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a setup");
  } else if (status == FG_OK) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a setup");
  }
  if (status == FG_OK) {
    fg_sha256_text(whole, sum);
    status = fg_station_database_begin(ctx, database);
    if (status == FG_OK) {
      status = find_setup(ctx, database, sum, setup);
      if (status == FG_OK && !*setup)
        status = insert_setup(ctx, database, settings, sum, recipe, model, setup);
      status = fg_station_database_end(ctx, database, status);
    }
  }
  free(whole);
  free(model);
  free(recipe);
  return status;
}

void fg_done_files_begin(fg_station_database *database, fg_done_files *files) {
  files->database = database;
  pthread_mutex_lock(&database->writing);
  fg_query_begin(database->writer,
                 "SELECT 1 FROM files WHERE path = ? AND bytes = ? AND modified_ns = ?",
                 &files->query);
  pthread_mutex_unlock(&database->writing);
}

bool fg_done_files_have(fg_done_files *files, const fg_station_file *file) {
  fg_query *query = &files->query;
  pthread_mutex_lock(&files->database->writing);
  fg_query_text(query, file->name);
  fg_query_integer(query, file->bytes);
  fg_query_integer(query, file->modified_ns);
  bool done = fg_query_row(query);
  fg_query_again(query);
  pthread_mutex_unlock(&files->database->writing);
  return done;
}

fg_status fg_done_files_end(fg_context *ctx, fg_done_files *files) {
  pthread_mutex_lock(&files->database->writing);
  fg_status status = fg_query_end(ctx, &files->query, "reading what is known of files");
  pthread_mutex_unlock(&files->database->writing);
  return status;
}

fg_status fg_station_file_is_done(fg_context *ctx, fg_station_database *database,
                                  const fg_station_file *file, bool *done) {
  fg_done_files files;
  fg_done_files_begin(database, &files);
  *done = fg_done_files_have(&files, file);
  return fg_done_files_end(ctx, &files);
}

fg_status fg_station_card_stands(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 bool *stands) {
  fg_query query;
  pthread_mutex_lock(&database->writing);
  fg_query_begin(database->writer,
                 "SELECT 1 FROM files JOIN arrivals ON arrivals.id = files.arrival"
                 " WHERE files.path = ? AND bytes = ? AND modified_ns = ? AND kind = ?"
                 " AND message = ?",
                 &query);
  fg_query_text(&query, file->name);
  fg_query_integer(&query, file->bytes);
  fg_query_integer(&query, file->modified_ns);
  fg_query_text(&query, fg_card_word(card));
  fg_query_text(&query, message);
  *stands = fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, "reading the cards");
  pthread_mutex_unlock(&database->writing);
  return status;
}

fg_status fg_station_find_scan(fg_context *ctx, fg_station_database *database, const char *sha256,
                               int64_t *scan) {
  fg_query query;
  pthread_mutex_lock(&database->writing);
  fg_query_begin(database->writer, "SELECT id FROM scans WHERE sha256 = ?", &query);
  fg_query_text(&query, sha256);
  *scan = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  fg_status status = fg_query_end(ctx, &query, "reading the scans");
  pthread_mutex_unlock(&database->writing);
  return status;
}

/* Marks earlier cards of the same file as outdated, unless a scan was measured. */
static fg_status supersede(fg_context *ctx, fg_station_database *database, const char *path) {
  fg_query query;
  fg_query_begin(database->writer,
                 "UPDATE arrivals SET superseded = 1 WHERE path = ? AND superseded = 0"
                 " AND kind IN ('unfinished', 'unreadable', 'foreign')",
                 &query);
  fg_query_text(&query, path);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a card");
}

static fg_status insert_card(fg_context *ctx, fg_station_database *database, const char *path,
                             fg_card card, const char *message, int64_t scan) {
  fg_query query;
  fg_query_begin(database->writer,
                 "INSERT INTO arrivals (at, path, kind, message, scan) VALUES (?, ?, ?, ?, ?)",
                 &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, path);
  fg_query_text(&query, fg_card_word(card));
  fg_query_text(&query, message);
  if (scan)
    fg_query_integer(&query, scan);
  else
    fg_query_text(&query, NULL);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a card");
}

fg_status fg_station_insert_card(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 int64_t scan) {
  fg_query query;
  FG_TRY(supersede(ctx, database, file->name));
  FG_TRY(insert_card(ctx, database, file->name, card, message, scan));
  fg_query_begin(database->writer,
                 "INSERT INTO files (path, bytes, modified_ns, arrival) VALUES (?, ?, ?, ?)"
                 " ON CONFLICT (path) DO UPDATE SET bytes = excluded.bytes,"
                 " modified_ns = excluded.modified_ns, arrival = excluded.arrival",
                 &query);
  fg_query_text(&query, file->name);
  fg_query_integer(&query, file->bytes);
  fg_query_integer(&query, file->modified_ns);
  fg_query_integer(&query, fg_sqlite.last_insert_rowid(database->writer));
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping what is known of a file");
}

fg_status fg_station_keep_card(fg_context *ctx, fg_station_database *database,
                               const fg_station_file *file, fg_card card, const char *message,
                               int64_t scan) {
  FG_TRY(fg_station_database_begin(ctx, database));
  return fg_station_database_end(ctx, database,
                                 fg_station_insert_card(ctx, database, file, card, message, scan));
}

fg_status fg_event_keep(fg_context *ctx, sqlite3 *writer, int64_t foil, const char *kind) {
  fg_query query;
  fg_query_begin(writer,
                 "INSERT INTO events (at, kind, foil, serial, lot, die, operator, disposition)"
                 " SELECT ?, ?, id, serial, lot, die, operator,"
                 " coalesce((SELECT max(id) FROM dispositions WHERE foil = foils.id), 0)"
                 " FROM foils WHERE id = ?",
                 &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, kind);
  fg_query_integer(&query, foil);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping an event");
}
