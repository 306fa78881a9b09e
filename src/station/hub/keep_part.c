/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part from a station into the hub's database, and back. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/date.h"
#include "core/json_read.h"
#include "core/member_read.h"
#include "core/memory.h"
#include "core/text.h"
#include "report/verdict_members.h"
#include "station/hub/hub.h"

static fg_status read_disposition(const fg_reading *reading, const fg_member *member,
                                  const cJSON *item, void *object) {
  const cJSON *kind = cJSON_GetObjectItemCaseSensitive(item, "kind");
  fg_hub_part *part = object;
  (void)reading, (void)member;
  fg_text_clip(part->disposition, sizeof part->disposition, "%s",
               cJSON_IsString(kind) ? kind->valuestring : "");
  return FG_OK;
}

#define POSTED(name_, field_) FG_TEXT(name_, fg_hub_part, field_), .options = FG_MEMBER_REQUIRED
static const fg_member posted_rows[] = {
    {FG_HEAD("foilgauge/part/1")},
    {POSTED("source", source)},
    {FG_COUNT("event", fg_hub_part, event), .options = FG_MEMBER_REQUIRED, .lowest = 1},
    {FG_COUNT("foil", fg_hub_part, foil), .options = FG_MEMBER_REQUIRED, .lowest = 1},
    {POSTED("station", station)},
    {POSTED("at", at)},
    {POSTED("measured_at", measured_at)},
    {POSTED("serial", serial)},
    {POSTED("lot", lot)},
    {POSTED("die", die)},
    {POSTED("operator", operator_name)},
    {POSTED("verdict", verdict), .choices = fg_verdict_words},
    {FG_TEXT("withheld", fg_hub_part, withheld), .options = FG_MEMBER_EMPTY_IS_NULL},
    {FG_WRITTEN("disposition", NULL, "{}"), .read = read_disposition},
};
static const fg_members posted_members = FG_MEMBERS(posted_rows);

static fg_status parse_part(fg_context *ctx, const char *body, fg_hub_part *part) {
  cJSON *root;
  *part = (fg_hub_part){.event = 0};
  FG_TRY(fg_json_read(ctx, "the part", body, &root));
  const fg_reading reading = {.ctx = ctx, .between = " ", .has_others = true};
  fg_status status = fg_object_read(&reading, &posted_members, root, part);
  cJSON_Delete(root);
  return status;
}

static fg_status keep_event(fg_context *ctx, fg_hub_store *store, const fg_hub_part *part,
                            const char *event, const char *now, const char *body, bool *known) {
  fg_hub_rows rows;
  const char *const values[] = {part->source, event, now, body};
  FG_TRY(fg_hub_store_run(ctx, store,
                          "INSERT INTO hub_events (source, event, received_at, body)"
                          " VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING RETURNING event",
                          values, 4, &rows));
  *known = !rows.rows;
  fg_hub_rows_free(&rows);
  return FG_OK;
}

/* The newest event of a foil is in force, in whatever order they come; its first receipt stays. */
static fg_status keep_newest(fg_context *ctx, fg_hub_store *store, const fg_hub_part *part,
                             const char *event, const char *foil, const char *now) {
  const char *const values[] = {part->source,
                                foil,
                                event,
                                part->station,
                                part->at,
                                part->measured_at,
                                part->serial,
                                part->lot,
                                part->die,
                                part->operator_name,
                                part->verdict,
                                part->withheld,
                                part->disposition,
                                now};
  return fg_hub_store_run(
      ctx, store,
      "INSERT INTO hub_parts (source, foil, event, station, at, measured_at, serial, lot, die,"
      " operator, verdict, withheld, disposition, received_at)"
      " VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14)"
      " ON CONFLICT (source, foil) DO UPDATE SET event = excluded.event,"
      " station = excluded.station, at = excluded.at, serial = excluded.serial,"
      " lot = excluded.lot, die = excluded.die, operator = excluded.operator,"
      " verdict = excluded.verdict, withheld = excluded.withheld,"
      " disposition = excluded.disposition WHERE excluded.event > hub_parts.event",
      values, sizeof values / sizeof *values, NULL);
}

static fg_status keep_station(fg_context *ctx, fg_hub_store *store, const fg_hub_part *part,
                              const char *now) {
  const char *const values[] = {part->source, part->station, now};
  return fg_hub_store_run(ctx, store,
                          "INSERT INTO hub_stations (source, station, received_at)"
                          " VALUES ($1, $2, $3) ON CONFLICT (source) DO UPDATE SET"
                          " station = excluded.station, received_at = excluded.received_at",
                          values, 3, NULL);
}

static fg_status keep_rows(fg_context *ctx, fg_hub_store *store, const fg_hub_part *part,
                           const char *body, bool *known) {
  char event[FG_HUB_NUMBER], foil[FG_HUB_NUMBER], now[FG_DATE_UTC];
  snprintf(event, sizeof event, "%zu", part->event);
  snprintf(foil, sizeof foil, "%zu", part->foil);
  fg_date_format_utc(time(NULL), now);
  FG_TRY(keep_event(ctx, store, part, event, now, body, known));
  if (*known) return FG_OK;
  FG_TRY(keep_newest(ctx, store, part, event, foil, now));
  return keep_station(ctx, store, part, now);
}

fg_status fg_hub_keep(fg_context *ctx, fg_hub *hub, const char *body, bool *known) {
  fg_hub_part part;
  fg_context inner;
  FG_TRY(parse_part(ctx, body, &part));
  pthread_mutex_lock(&hub->mutex);
  fg_status status = fg_hub_store_run(ctx, &hub->store, "BEGIN", NULL, 0, NULL);
  if (status == FG_OK) {
    status = keep_rows(ctx, &hub->store, &part, body, known);
    if (status == FG_OK) status = fg_hub_store_run(ctx, &hub->store, "COMMIT", NULL, 0, NULL);
    if (status != FG_OK) fg_hub_store_run(&inner, &hub->store, "ROLLBACK", NULL, 0, NULL);
  }
  pthread_mutex_unlock(&hub->mutex);
  return status;
}

static size_t read_count(const fg_hub_rows *rows, size_t row, size_t column) {
  return (size_t)strtoull(fg_hub_cell(rows, row, column), NULL, 10);
}

static fg_status read_stations(fg_context *ctx, fg_hub *hub, fg_hub_state *state) {
  fg_hub_rows rows;
  void *block;
  char since[FG_DATE_UTC];
  fg_date_format_utc(time(NULL) - 24 * 3600, since);
  const char *const values[] = {since};
  FG_TRY(fg_hub_store_run(
      ctx, &hub->store,
      "SELECT s.station, s.source, s.received_at, count(p.foil),"
      " coalesce(sum(CASE WHEN p.verdict = 'fail' AND p.withheld = '' THEN 1 ELSE 0 END), 0),"
      " coalesce(sum(CASE WHEN p.verdict IN ('fail', 'cannot_tell', 'not_measured')"
      " AND p.disposition = '' THEN 1 ELSE 0 END), 0)"
      " FROM hub_stations AS s LEFT JOIN hub_parts AS p"
      " ON p.source = s.source AND p.received_at >= $1"
      " GROUP BY s.station, s.source, s.received_at ORDER BY s.station, s.source",
      values, 1, &rows));
  fg_status status = fg_memory_allocate(ctx, rows.rows + 1, sizeof *state->stations, &block);
  if (status == FG_OK) state->stations = block;
  for (size_t i = 0; status == FG_OK && i < rows.rows; i++) {
    fg_hub_station *station = &state->stations[state->station_count++];
    *station = (fg_hub_station){.parts = read_count(&rows, i, 3),
                                .failed = read_count(&rows, i, 4),
                                .open = read_count(&rows, i, 5)};
    fg_text_clip(station->station, FG_HUB_TEXT, "%s", fg_hub_cell(&rows, i, 0));
    fg_text_clip(station->source, FG_HUB_TEXT, "%s", fg_hub_cell(&rows, i, 1));
    fg_text_clip(station->received_at, FG_HUB_TEXT, "%s", fg_hub_cell(&rows, i, 2));
  }
  fg_hub_rows_free(&rows);
  return status;
}

static void copy_part(const fg_hub_rows *rows, size_t row, fg_hub_part *part) {
  char *const texts[] = {part->source,  part->station,     part->at,         part->measured_at,
                         part->serial,  part->lot,         part->die,        part->operator_name,
                         part->verdict, part->disposition, part->received_at};
  *part = (fg_hub_part){.event = read_count(rows, row, 12), .foil = read_count(rows, row, 13)};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    fg_text_clip(texts[i], FG_HUB_TEXT, "%s", fg_hub_cell(rows, row, i));
  fg_text_clip(part->withheld, sizeof part->withheld, "%s", fg_hub_cell(rows, row, 11));
}

/* One part more than a page shows: then there is another page. */
static fg_status find_parts(fg_context *ctx, fg_hub *hub, const fg_hub_search *search,
                            fg_hub_rows *rows) {
  char limit[FG_HUB_NUMBER], offset[FG_HUB_NUMBER];
  snprintf(limit, sizeof limit, "%zu", search->per_page + 1);
  snprintf(offset, sizeof offset, "%zu", search->page * search->per_page);
  const char *const values[] = {search->station, search->serial, search->lot,
                                search->verdict, limit,          offset};
  return fg_hub_store_run(
      ctx, &hub->store,
      "SELECT source, station, at, measured_at, serial, lot, die, operator, verdict, disposition,"
      " received_at, withheld, event, foil FROM hub_parts WHERE ($1 = '' OR station = $1)"
      " AND ($2 = '' OR serial = $2) AND ($3 = '' OR lot = $3)"
      " AND ($4 = '' OR (verdict = $4 AND withheld = '') OR ($4 = 'withheld' AND withheld <> '')"
      " OR ($4 = 'open' AND disposition = ''"
      " AND verdict IN ('fail', 'cannot_tell', 'not_measured')))"
      " ORDER BY received_at DESC, source, foil DESC LIMIT CAST($5 AS INTEGER)"
      " OFFSET CAST($6 AS INTEGER)",
      values, sizeof values / sizeof *values, rows);
}

static fg_status read_parts(fg_context *ctx, fg_hub *hub, const fg_hub_search *search,
                            fg_hub_state *state) {
  fg_hub_rows rows;
  void *block;
  FG_TRY(find_parts(ctx, hub, search, &rows));
  fg_status status = fg_memory_allocate(ctx, rows.rows + 1, sizeof *state->parts, &block);
  if (status == FG_OK) state->parts = block;
  state->more = rows.rows > search->per_page;
  for (size_t i = 0; status == FG_OK && i < rows.rows && i < search->per_page; i++)
    copy_part(&rows, i, &state->parts[state->part_count++]);
  fg_hub_rows_free(&rows);
  return status;
}

fg_status fg_hub_read(fg_context *ctx, fg_hub *hub, const fg_hub_search *search,
                      fg_hub_state *state) {
  *state = (fg_hub_state){.stations = NULL};
  pthread_mutex_lock(&hub->mutex);
  fg_status status = read_stations(ctx, hub, state);
  if (status == FG_OK) status = read_parts(ctx, hub, search, state);
  pthread_mutex_unlock(&hub->mutex);
  if (status != FG_OK) fg_hub_state_free(state);
  return status;
}

void fg_hub_state_free(fg_hub_state *state) {
  free(state->stations);
  free(state->parts);
  *state = (fg_hub_state){.stations = NULL};
}

fg_status fg_hub_read_part(fg_context *ctx, fg_hub *hub, const char *source, const char *foil,
                           char **body) {
  fg_hub_rows rows;
  const char *const values[] = {source, foil};
  *body = NULL;
  pthread_mutex_lock(&hub->mutex);
  fg_status status =
      fg_hub_store_run(ctx, &hub->store,
                       "SELECT body FROM hub_parts AS p JOIN hub_events AS e"
                       " ON e.source = p.source AND e.event = p.event WHERE p.source = $1"
                       " AND CAST(p.foil AS TEXT) = $2",
                       values, 2, &rows);
  pthread_mutex_unlock(&hub->mutex);
  FG_TRY(status);
  if (rows.rows) status = fg_text_print(ctx, body, "%s", fg_hub_cell(&rows, 0, 0));
  fg_hub_rows_free(&rows);
  return status;
}
