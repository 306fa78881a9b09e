/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/outbox/lane.h"

#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/file.h"

/* The row of a receiver: the event it got last, and one that is prepared for it. */
typedef struct cursor {
  int64_t passed, prepared, next; /* next 0: none */
  char serial[FG_PART_NAME], kind[16], source[FG_PART_KEY];
} cursor;

/* Makes the receiver's row, unless it has one. */
static fg_status insert_row(fg_context *ctx, fg_lane *lane) {
  fg_query query;
  fg_station_database *database = &lane->station->database;
  FG_TRY(fg_station_database_begin(ctx, database));
  fg_query_begin(database->writer,
                 "INSERT OR IGNORE INTO destinations (name, passed)"
                 " SELECT ?, CASE WHEN ? THEN 0 ELSE coalesce(max(id), 0) END FROM events",
                 &query);
  fg_query_text(&query, lane->name);
  fg_query_integer(&query, lane->from_start);
  fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, "keeping a receiver");
  return fg_station_database_end(ctx, database, status);
}

fg_status fg_lane_begin(fg_context *ctx, fg_lane *lane) {
  static const char *const words[] = {"json", "csv", "bumps_csv", "dfq", "qif"};
  const fg_station_destination *destination = lane->destination;
  FG_TRY(fg_transport_find(ctx, destination->to, &lane->transport));
  if (destination->token_file[0])
    FG_TRY(fg_file_read_token(ctx, destination->token_file, lane->token, FG_LANE_TOKEN));
  fg_text_clip(lane->name, sizeof lane->name, "%s %s", words[destination->format], destination->to);
  return insert_row(ctx, lane);
}

static fg_status read_cursor(fg_context *ctx, fg_lane *lane, sqlite3 *reader, cursor *at) {
  fg_query query;
  *at = (cursor){.passed = -1};
  fg_query_begin(reader,
                 "SELECT passed, prepared, e.id, e.serial, e.kind, (SELECT id FROM identity)"
                 " FROM destinations LEFT JOIN events AS e"
                 " ON e.id = (SELECT min(id) FROM events WHERE id > passed) WHERE name = ?",
                 &query);
  fg_query_text(&query, lane->name);
  if (fg_query_row(&query)) {
    at->passed = fg_query_get_integer(&query, 0);
    at->prepared = fg_query_get_integer(&query, 1);
    at->next = fg_query_get_integer(&query, 2);
    fg_text_clip(at->serial, sizeof at->serial, "%s", fg_query_get_text(&query, 3));
    fg_text_clip(at->kind, sizeof at->kind, "%s", fg_query_get_text(&query, 4));
    fg_text_clip(at->source, sizeof at->source, "%s", fg_query_get_text(&query, 5));
  }
  return fg_query_end(ctx, &query, "reading the outbox");
}

static fg_status write_cursor(fg_context *ctx, fg_lane *lane, const char *sql, int64_t event) {
  fg_query query;
  fg_station_database *database = &lane->station->database;
  FG_TRY(fg_station_database_begin(ctx, database));
  fg_query_begin(database->writer, sql, &query);
  fg_query_text(&query, lane->name);
  fg_query_integer(&query, event);
  fg_query_integer(&query, fg_station_now());
  fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, "keeping what was passed on");
  return fg_station_database_end(ctx, database, status);
}

static fg_status note_prepared(fg_context *ctx, fg_lane *lane, int64_t event) {
  return write_cursor(ctx, lane, "UPDATE destinations SET prepared = ?2 WHERE name = ?1 AND ?3 > 0",
                      event);
}

static fg_status note_passed(fg_context *ctx, fg_lane *lane, int64_t event) {
  return write_cursor(ctx, lane,
                      "UPDATE destinations SET passed = ?2, passed_at = ?3, count = count + 1"
                      " WHERE name = ?1 AND passed < ?2",
                      event);
}

/* Name of a file: the event's number first, so that names sort by time. Any byte of a serial number
 * that a file system or a shell might not like is a `_`. */
static void name_message(const fg_lane *lane, const cursor *at, char *name, size_t size) {
  char serial[64];
  fg_text_clip(serial, sizeof serial, "%s", at->serial);
  for (char *c = serial; *c; c++)
    if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-.", *c)) *c = '_';
  fg_text_clip(name, size, "%08lld-%s-%s-%.8s%s", (long long)at->next, serial, at->kind, at->source,
               fg_part_format_ending(lane->destination->format));
}

static fg_status format_body(fg_context *ctx, fg_lane *lane, const cursor *at, fg_message *message,
                             char **body) {
  fg_part *part;
  fg_station_database *database = &lane->station->database;
  pthread_mutex_lock(&database->reading);
  fg_status status = fg_part_load(ctx, database->reader, lane->station_name, at->next, &part);
  pthread_mutex_unlock(&database->reading);
  FG_TRY(status);
  status = fg_parts_format(ctx, &part, 1, lane->destination->format,
                           lane->station->request->decimal_comma, body, &message->size);
  message->body = *body;
  fg_part_free(part);
  return status;
}

static fg_status send_event(fg_context *ctx, fg_lane *lane, const cursor *at, fg_message *message,
                            char **body) {
  const fg_transport *transport = lane->transport;
  bool is_prepared = transport->prepare && at->prepared == at->next;
  if (!lane->way)
    FG_TRY(transport->open(ctx, lane->destination->to, lane->token, lane->closing, &lane->way));
  if (!is_prepared) FG_TRY(format_body(ctx, lane, at, message, body));
  if (transport->prepare && !is_prepared) {
    FG_TRY(transport->prepare(ctx, lane->way, message));
    FG_TRY(note_prepared(ctx, lane, at->next));
  }
  return transport->send(ctx, lane->way, message);
}

fg_status fg_lane_deliver(fg_context *ctx, fg_lane *lane, bool *idle) {
  cursor at;
  char name[FG_PART_NAME], key[FG_PART_KEY + 32], *body = NULL;
  fg_station_database *database = &lane->station->database;
  *idle = false;
  pthread_mutex_lock(&database->reading);
  fg_status status = read_cursor(ctx, lane, database->reader, &at);
  pthread_mutex_unlock(&database->reading);
  FG_TRY(status);
  if (at.passed < 0) return insert_row(ctx, lane); /* another database has come */
  *idle = !at.next;
  if (*idle) return FG_OK;
  name_message(lane, &at, name, sizeof name);
  snprintf(key, sizeof key, "%.40s-%lld", at.source, (long long)at.next);
  fg_message message = {
      .key = key, .name = name, .type = fg_part_format_type(lane->destination->format)};
  status = send_event(ctx, lane, &at, &message, &body);
  free(body);
  return status == FG_OK ? note_passed(ctx, lane, at.next) : status;
}

void fg_lane_end(fg_lane *lane) {
  if (lane->way) lane->transport->close(lane->way);
  lane->way = NULL;
}
