/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A station with foils in its database and no scans, and the pages that it answers. */
#ifndef FG_TEST_TREND_STATION_H
#define FG_TEST_TREND_STATION_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "station/answer.h"
#include "support/page_names.h"
#include "support/test.h"

enum { BUMPS = 3 };

typedef struct fixture {
  char folder[64];
  fg_station_settings settings;
  fg_station_request request;
  fg_inspection station;
  double drawn;
} fixture;

static void run_sql(fixture *f, const char *format, ...) {
  char *sql;
  fg_context ctx;
  va_list arguments;
  va_start(arguments, format);
  assert_true(vasprintf(&sql, format, arguments) > 0);
  va_end(arguments);
  if (fg_sql_run(&ctx, f->station.database.writer, sql) != FG_OK) fail_msg("%s", ctx.message);
  free(sql);
}

static int start(void **state) {
  fg_context ctx = {0};
  fixture *f = calloc(1, sizeof *f);
  strcpy(f->folder, "/tmp/foilgauge_trend_XXXXXX");
  assert_non_null(mkdtemp(f->folder));
  assert_ok(&ctx, fg_station_settings_load(&ctx, NULL, NULL, &f->settings));
  f->settings.lot.design.tolerance_count = 1;
  strcpy(f->settings.lot.design.calibration.not_needed, "made up");
  f->settings.lot.design.tolerances[0] = (fg_tolerance){"radius_mm", 3.3, 3.5};
  f->request = (fg_station_request){.folder = f->folder, .settings = &f->settings};
  f->station.request = &f->request;
  f->station.settings = &f->settings;
  strcpy(f->station.host, "127.0.0.1:1");
  if (fg_station_database_open(&ctx, f->folder, &f->station.database) != FG_OK)
    fail_msg("%s", ctx.message);
  char *recipe;
  assert_ok(&ctx, fg_lot_settings_format(&ctx, &f->settings.lot, false, &recipe));
  run_sql(f, "INSERT INTO setups VALUES (1, 'x', 'v', '%s', NULL, NULL, 1)", recipe);
  free(recipe);
  run_sql(f, "INSERT INTO quantities VALUES (1, 'bump', 'radius_mm', 'mm'), (2, 'foil', "
             "'thickness_mm', 'mm')");
  *state = f;
  return 0;
}

static int stop(void **state) {
  static const char *const files[] = {"foilgauge.sqlite", "foilgauge.sqlite-wal",
                                      "foilgauge.sqlite-shm"};
  fixture *f = *state;
  char path[128];
  fg_station_database_close(&f->station.database);
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    in_row("files[%zu]", i);
    snprintf(path, sizeof path, "%s/%s", f->folder, files[i]);
    unlink(path);
  }
  rmdir(f->folder);
  free(f);
  return 0;
}

/* Scatter without the signals that chance has, too: mean 0, sd 1, never beyond 1.5, no runs. */
static double draw(fixture *f) {
  return M_SQRT2 * sin(f->drawn++);
}

static void add_foil(fixture *f, int id, const char *lot, const char *die, double radius,
                     double scatter) {
  run_sql(
      f,
      "INSERT INTO scans (id, sha256, setup, path, source, at, verdict) VALUES (%d, '%d', 1, "
      "'%d.png', 'folder', %d, 'pass');"
      "INSERT INTO foils VALUES (%d, %d, 1, 'S%04d', '%s', '%s', '', 'pass', '', '', '', '', 0)",
      id, id, id, id, id, id, id, lot, die);
  for (int bump = 1; bump <= BUMPS; bump++)
    run_sql(f,
            "INSERT INTO bumps VALUES (%d, %d, 'pass', '');"
            "INSERT INTO measured VALUES (1, %d, %d, %.9g, 0.0001)",
            id, bump, id, bump, radius + scatter * draw(f));
}

static void add_foils(fixture *f, int from, int to, const char *lot, double radius) {
  run_sql(f, "BEGIN");
  for (int id = from; id <= to; id++)
    add_foil(f, id, lot, id % 2 ? "A" : "B", radius + 0.004 * draw(f), 0.004);
  run_sql(f, "COMMIT");
}

/* The page, in a buffer that the next call writes over. */
static const char *get(fixture *f, const char *path, const char *query, int code) {
  static char text[1 << 20];
  fg_answer answer;
  fg_request request = {.path = path, .host = "127.0.0.1:1", .last_event = -1};
  assert_true(fg_request_read_fields(&request, query, strlen(query)));
  fg_station_answer(&f->station, &request, &answer);
  assert_int_equal(answer.code, code);
  assert_true(answer.size < sizeof text);
  memcpy(text, answer.body, answer.size);
  text[answer.size] = '\0';
  free(answer.body);
  return page_without_name_marks(text);
}

#endif
