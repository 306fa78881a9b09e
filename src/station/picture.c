/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/picture.h"

#include <stdio.h>
#include <stdlib.h>

#include "core/file.h"
#include "report/foil_html.h"

/* Pictures that are kept, of some 150 KB each; that of an older foil is drawn from its scan. */
enum { PICTURES_KEPT = 40 };

static fg_status draw_picture(fg_context *ctx, const fg_measurement *measurement,
                              const fg_foil *foil, char **html) {
  size_t size;
  FILE *out = fg_stream_open(html, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a picture");
  fg_status status = fg_html_picture(ctx, out, measurement, foil, 0);
  if (!fg_stream_keep(out, html) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a picture");
  return status;
}

static fg_status keep_picture(fg_context *ctx, sqlite3 *writer, int64_t scan, int number,
                              const char *html) {
  fg_query query;
  fg_query_begin(writer,
                 "INSERT OR REPLACE INTO pictures (foil, html)"
                 " SELECT id, ? FROM foils WHERE scan = ? AND number = ?",
                 &query);
  fg_query_text(&query, html);
  fg_query_integer(&query, scan);
  fg_query_integer(&query, number);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a picture");
}

static fg_status forget_old(fg_context *ctx, sqlite3 *writer) {
  fg_query query;
  fg_query_begin(writer, "DELETE FROM pictures WHERE foil <= (SELECT max(id) FROM foils) - ?",
                 &query);
  fg_query_integer(&query, PICTURES_KEPT);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a picture");
}

/* A picture that cannot be drawn is left out; the result is kept without it. */
fg_status fg_station_keep_pictures(fg_context *ctx, fg_station_database *database, int64_t scan,
                                   const fg_measurement *measurement) {
  for (size_t i = 0; i < measurement->foil_count; i++) {
    fg_context inner;
    char *html = NULL;
    fg_status status = draw_picture(&inner, measurement, &measurement->foils[i], &html);
    if (status == FG_OK) {
      status = fg_station_database_begin(ctx, database);
      if (status == FG_OK) {
        status = keep_picture(ctx, database->writer, scan, measurement->foils[i].number, html);
        if (status == FG_OK) status = forget_old(ctx, database->writer);
        status = fg_station_database_end(ctx, database, status);
      }
    } else {
      status = FG_OK;
    }
    free(html);
    if (status != FG_OK) return status;
  }
  return FG_OK;
}
