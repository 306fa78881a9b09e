/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A station without a socket: a folder of its own with a database of one scan and one foil. */
#ifndef FG_TESTS_STATION_FIXTURE_H
#define FG_TESTS_STATION_FIXTURE_H

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "station/answer.h"

typedef struct station_fixture {
  char folder[64];
  fg_station_settings settings;
  fg_station_request request;
  fg_station_outcome outcome;
  fg_inspection station;
} station_fixture;

/* `serial` and `path` of the one scan, as they are. */
static fg_status station_fixture_open(fg_context *ctx, station_fixture *at, const char *serial,
                                      const char *path) {
  memset(at, 0, sizeof *at);
  strcpy(at->folder, "/tmp/foilgauge-station-XXXXXX");
  if (!mkdtemp(at->folder)) return fg_fail(ctx, FG_ERR_IO, "no folder");
  FG_TRY(fg_station_settings_load(ctx, NULL, NULL, &at->settings));
  at->request = (fg_station_request){.folder = at->folder, .settings = &at->settings};
  at->station.request = &at->request;
  at->station.settings = &at->settings;
  at->station.outcome = &at->outcome;
  strcpy(at->station.csrf_token, "0123456789abcdef0123456789abcdef");
  strcpy(at->station.host, "127.0.0.1:8317");
  FG_TRY(fg_station_database_open(ctx, at->folder, &at->station.database));
  sqlite3 *writer = at->station.database.writer;
  FG_TRY(fg_sql_run(ctx, writer,
                    "INSERT INTO setups (id, sha256, program, recipe, first_at)"
                    " VALUES (1, 's', '0', '{}', 0);"));
  fg_query query;
  fg_query_begin(writer,
                 "INSERT INTO scans (id, sha256, setup, path, source, at, verdict, record)"
                 " VALUES (1, 'x', 1, ?, 'folder', 1000000000000, 'fail', '')",
                 &query);
  fg_query_text(&query, path);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "a scan"));
  fg_query_begin(
      writer,
      "INSERT INTO foils (id, scan, number, serial, lot, die, operator, verdict, reasons)"
      " VALUES (1, 1, 1, ?, 'L1', 'D1', '', 'fail', '')",
      &query);
  fg_query_text(&query, serial);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "a foil"));
  fg_query_begin(writer,
                 "INSERT INTO arrivals (at, path, kind, message, scan)"
                 " VALUES (1000000000000, ?, 'measured', '', 1)",
                 &query);
  fg_query_text(&query, path);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "a card");
}

static void station_fixture_remove(const char *folder) {
  char path[512];
  DIR *open = opendir(folder);
  for (struct dirent *entry; open && (entry = readdir(open));) {
    if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    if (unlink(path) != 0) station_fixture_remove(path);
  }
  if (open) closedir(open);
  rmdir(folder);
}

static void station_fixture_close(station_fixture *at) {
  fg_station_database_close(&at->station.database);
  station_fixture_remove(at->folder);
}

#endif
