/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/lot_content.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"

enum { FOIL_SCAN, FOIL_PATH, FOIL_SUM, FOIL_SETUP, FOIL_OF, FOIL_NUMBER, FOIL_SERIAL, FOIL_DIE };
enum { FOIL_OPERATOR = FOIL_DIE + 1, FOIL_WITHHELD, FOIL_REPLACED, FOIL_HELD, FOIL_MORE };

/* FOIL_HELD is false where the file of the scan's path holds something else now. */
static const char foils_of_lot[] =
    "SELECT s.id, s.path, s.sha256, s.setup, (SELECT count(*) FROM foils AS o WHERE o.scan = s.id),"
    " f.number, f.serial, f.die, f.operator, s.withheld IS NOT NULL, " FG_LOT_REPLACED
    ", (SELECT a.scan FROM files JOIN arrivals AS a ON a.id = files.arrival WHERE files.path = "
    "s.path)"
    " IS s.id, f.coil, f.oven, f.scanner,"
    " coalesce((SELECT number FROM orders WHERE id = f.order_id), ''),"
    " coalesce((SELECT kind FROM dispositions AS d WHERE d.foil = f.id ORDER BY d.id DESC LIMIT "
    "1),"
    " ''), coalesce(s.withheld, '') FROM foils AS f JOIN scans AS s ON s.id = f.scan WHERE f.lot = "
    "?"
    " ORDER BY s.id, f.number";

static fg_status add_content_scan(fg_context *ctx, fg_lot_content *content, const fg_query *row) {
  void *block = content->scans;
  FG_TRY(fg_memory_reserve(ctx, content->count + 1, sizeof *content->scans, &content->capacity,
                           &block));
  content->scans = block;
  fg_lot_scan *scan = &content->scans[content->count++];
  *scan = (fg_lot_scan){.id = fg_query_get_integer(row, FOIL_SCAN),
                        .of = (size_t)fg_query_get_integer(row, FOIL_OF)};
  fg_text_clip(scan->sha256, sizeof scan->sha256, "%s", fg_query_get_text(row, FOIL_SUM));
  content->setup = fg_query_get_integer(row, FOIL_SETUP);
  FG_TRY(fg_text_print(ctx, &scan->path, "%s", fg_query_get_text(row, FOIL_PATH)));
  if (fg_query_get_integer(row, FOIL_HELD)) return FG_OK;
  /* A manifest names each scan once, and never the file of another. */
  return fg_text_append(ctx, &scan->path, ".overwritten-%.12s", scan->sha256);
}

/* True when `word` is one of the words of `text`. */
static bool has_word(const char *text, const char *word) {
  size_t length = strlen(word);
  for (const char *at = text; (at = strstr(at, word)); at++)
    if ((at == text || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return true;
  return false;
}

/* Joins values that a scan's foils do not share: a manifest has one row per scan. */
static fg_status join_word(fg_context *ctx, char **text, const char *word) {
  if (!*text) return fg_text_print(ctx, text, "%s", word);
  if (!*word || has_word(*text, word)) return FG_OK;
  return fg_text_append(ctx, text, "%s%s", **text ? " " : "", word);
}

static fg_status add_content_foil(fg_context *ctx, fg_lot_scan *scan, const fg_query *row) {
  void *block = scan->numbers;
  FG_TRY(fg_memory_reserve(ctx, scan->count + 1, sizeof *scan->numbers, &scan->capacity, &block));
  scan->numbers = block;
  scan->numbers[scan->count++] = (int)fg_query_get_integer(row, FOIL_NUMBER);
  FG_TRY(join_word(ctx, &scan->serial, fg_query_get_text(row, FOIL_SERIAL)));
  FG_TRY(join_word(ctx, &scan->die, fg_query_get_text(row, FOIL_DIE)));
  for (int i = 0; i < FG_LOT_MORE; i++)
    FG_TRY(join_word(ctx, &scan->more[i], fg_query_get_text(row, FOIL_MORE + i)));
  return join_word(ctx, &scan->operator_name, fg_query_get_text(row, FOIL_OPERATOR));
}

static fg_status count_foil(fg_context *ctx, fg_lot_content *content, const fg_query *row) {
  int64_t scan = fg_query_get_integer(row, FOIL_SCAN);
  if (fg_query_get_integer(row, FOIL_REPLACED)) {
    content->replaced++;
    return FG_OK;
  }
  content->withheld += fg_query_get_integer(row, FOIL_WITHHELD) != 0;
  if (!content->count || content->scans[content->count - 1].id != scan)
    FG_TRY(add_content_scan(ctx, content, row));
  return add_content_foil(ctx, &content->scans[content->count - 1], row);
}

static fg_status read_state(fg_context *ctx, sqlite3 *reader, const char *lot,
                            fg_lot_content *content) {
  fg_query query;
  fg_query_begin(reader, "SELECT " FG_LOT_STATE("?1"), &query);
  fg_query_text(&query, lot);
  if (fg_query_row(&query))
    fg_text_clip(content->state, sizeof content->state, "%s", fg_query_get_text(&query, 0));
  return fg_query_end(ctx, &query, "reading the lot's state");
}

fg_status fg_lot_content_read(fg_context *ctx, sqlite3 *reader, const char *lot,
                              fg_lot_content *content) {
  fg_query query;
  fg_status status = FG_OK;
  *content = (fg_lot_content){0};
  fg_query_begin(reader, foils_of_lot, &query);
  fg_query_text(&query, lot);
  while (status == FG_OK && fg_query_row(&query))
    status = count_foil(ctx, content, &query);
  fg_status ended = fg_query_end(ctx, &query, "reading the lot's foils");
  if (status == FG_OK) status = ended;
  if (status == FG_OK) status = read_state(ctx, reader, lot, content);
  if (status == FG_OK && !content->count)
    status = fg_fail(ctx, FG_ERR_USAGE, "There is no foil of the lot '%.127s'.", lot);
  if (status != FG_OK) fg_lot_content_free(content);
  return status;
}

void fg_lot_content_free(fg_lot_content *content) {
  for (size_t i = 0; i < content->count; i++) {
    fg_lot_scan *scan = &content->scans[i];
    free(scan->path);
    free(scan->numbers);
    free(scan->serial);
    free(scan->die);
    free(scan->operator_name);
    for (int k = 0; k < FG_LOT_MORE; k++)
      free(scan->more[k]);
  }
  free(content->scans);
  *content = (fg_lot_content){0};
}

fg_status fg_station_lot_note(fg_context *ctx, fg_station_database *database, const char *lot,
                              char *words, size_t size) {
  fg_query query;
  words[0] = '\0';
  pthread_mutex_lock(&database->writing);
  fg_query_begin(database->writer, "SELECT by FROM lots WHERE name = ? ORDER BY id DESC LIMIT 1",
                 &query);
  fg_query_text(&query, lot);
  if (fg_query_row(&query))
    fg_text_clip(words, size,
                 "comes after its lot '%.127s' was closed by %.127s; close the lot again on the "
                 "page Lots",
                 lot, fg_query_get_text(&query, 0));
  fg_status status = fg_query_end(ctx, &query, "reading the lots");
  pthread_mutex_unlock(&database->writing);
  return status;
}
