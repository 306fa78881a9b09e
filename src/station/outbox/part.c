/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/outbox/part.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/text.h"
#include "quantity/quantity_rows.h"
#include "report/measure/foil_parts.h"

void fg_part_station_name(const fg_station_request *request, char name[FG_PART_NAME]) {
  char host[FG_PART_NAME] = "";
  if (!request->name && gethostname(host, sizeof host - 1) != 0) strcpy(host, "station");
  fg_text_clip(name, FG_PART_NAME, "%s", request->name ? request->name : host);
}

/* Writes 2026-03-01T14:02:33.123Z. */
static void format_time(int64_t at, char text[FG_PART_TIME]) {
  time_t seconds = (time_t)(at / 1000);
  struct tm utc;
  text[0] = '\0';
  if (!at || !gmtime_r(&seconds, &utc)) return;
  size_t length = strftime(text, FG_PART_TIME, "%Y-%m-%dT%H:%M:%S", &utc);
  snprintf(text + length, FG_PART_TIME - length, ".%03dZ", (int)(at % 1000));
}

/* Columns of an event. Where it is of no event, the foil is as it is now. */
#define PART_FROM                                                                                  \
  " scans.at, foils.coil, foils.oven, foils.scanner, coalesce(orders.number, ''), "                \
  "coalesce(d.kind, ''),"                                                                          \
  " coalesce(d.reason, ''), coalesce(d.note, ''), coalesce(d.by, ''), coalesce(d.at, 0),"          \
  " (SELECT id FROM identity) FROM foils JOIN scans ON scans.id = foils.scan"                      \
  " LEFT JOIN orders ON orders.id = foils.order_id"

static const char of_event[] =
    "SELECT e.id, e.foil, e.kind, e.at, e.serial, e.lot, e.die, e.operator," PART_FROM
    " JOIN events AS e ON e.foil = foils.id LEFT JOIN dispositions AS d ON d.id = e.disposition"
    " WHERE e.id = ?";
static const char of_foil[] =
    "SELECT 0, foils.id, 'measured', scans.at, serial, foils.lot, foils.die, "
    "foils.operator," PART_FROM
    " LEFT JOIN dispositions AS d ON d.id = (SELECT max(id) FROM dispositions WHERE foil ="
    " foils.id) WHERE foils.id = ?";

static void copy_column(const fg_query *query, int column, char *text, size_t size) {
  fg_text_clip(text, size, "%s", fg_query_get_text(query, column));
}

static void copy_disposition(const fg_query *query, fg_part *part) {
  fg_part_disposition *disposition = &part->disposition;
  copy_column(query, 13, disposition->kind, sizeof disposition->kind);
  copy_column(query, 14, disposition->reason, sizeof disposition->reason);
  copy_column(query, 15, disposition->note, sizeof disposition->note);
  copy_column(query, 16, disposition->by, sizeof disposition->by);
  format_time(fg_query_get_integer(query, 17), disposition->at);
  part->disposed = disposition->kind[0] != '\0';
}

static void copy_row(const fg_query *query, fg_part *part) {
  char *const names[] = {part->serial, part->lot, part->die, part->operator_name};
  char *const others[] = {part->coil, part->oven, part->scanner, part->order};
  part->event = (size_t)fg_query_get_integer(query, 0);
  part->foil = (size_t)fg_query_get_integer(query, 1);
  copy_column(query, 2, part->kind, sizeof part->kind);
  format_time(fg_query_get_integer(query, 3), part->at);
  for (int i = 0; i < 4; i++)
    copy_column(query, 4 + i, names[i], FG_PART_NAME);
  format_time(fg_query_get_integer(query, 8), part->measured_at);
  for (int i = 0; i < 4; i++)
    copy_column(query, 9 + i, others[i], FG_PART_NAME);
  copy_disposition(query, part);
  copy_column(query, 18, part->source, sizeof part->source);
  fg_text_clip(part->key, sizeof part->key, "%.40s-%zu", part->source, part->event);
}

static fg_status read_part(fg_context *ctx, sqlite3 *reader, const char *sql, int64_t id,
                           fg_part *part) {
  fg_query query;
  fg_query_begin(reader, sql, &query);
  fg_query_integer(&query, id);
  bool found = fg_query_row(&query);
  if (found) copy_row(&query, part);
  FG_TRY(fg_query_end(ctx, &query, "reading an event"));
  return found ? FG_OK : fg_fail(ctx, FG_ERR_USAGE, "There is no such event.");
}

static void add_values(fg_part *part, fg_quantity_owner owner, const char *of, int number,
                       const void *object) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    if (rows[i].kind == FG_QUANTITY_PAIR ||
        !fg_quantity_applies(owner, &rows[i], part->stored->settings.design.kind))
      continue;
    part->values[part->value_count++] = (fg_part_value){of,
                                                        number,
                                                        rows[i].name,
                                                        rows[i].unit,
                                                        fg_quantity_value(&rows[i], object),
                                                        fg_quantity_uncertainty(&rows[i], object)};
  }
}

/* Lists the values of the foil and of its bumps or beams. */
static fg_status list_values(fg_context *ctx, fg_part *part) {
  size_t of_each, of_whole;
  const fg_foil *foil = part->stored->foil;
  const fg_foil_parts parts = fg_foil_parts_of(&part->stored->settings.design, foil);
  void *block;
  fg_quantities(FG_QUANTITY_OF_FOIL, &of_whole);
  fg_quantities(parts.owner, &of_each);
  FG_TRY(
      fg_memory_allocate(ctx, of_whole + of_each * parts.count + 1, sizeof *part->values, &block));
  part->values = block;
  add_values(part, FG_QUANTITY_OF_FOIL, "foil", 0, foil);
  for (size_t i = 0; i < parts.count; i++)
    add_values(part, parts.owner, parts.name, fg_foil_part_number(&parts, i),
               fg_foil_part_at(&parts, i));
  return FG_OK;
}

/* A record of an earlier program that this one cannot read is passed on without values. */
static fg_status load_values(fg_context *ctx, sqlite3 *reader, fg_part *part) {
  char id[32];
  snprintf(id, sizeof id, "%zu", part->foil);
  FG_TRY(fg_stored_foil_load(ctx, reader, id, &part->stored));
  if (!part->stored->readable) return FG_OK;
  FG_TRY(fg_foil_decide(ctx, &part->stored->settings.design, part->stored->foil, &part->decision));
  return fg_foil_is_measured(part->stored->foil) ? list_values(ctx, part) : FG_OK;
}

static fg_status load_part(fg_context *ctx, sqlite3 *reader, const char *station, const char *sql,
                           int64_t id, fg_part **part) {
  void *block;
  *part = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **part, &block));
  fg_part *loaded = block;
  *loaded = (fg_part){.value_count = 0};
  fg_text_clip(loaded->station, sizeof loaded->station, "%s", station);
  fg_status status = read_part(ctx, reader, sql, id, loaded);
  if (status == FG_OK) status = load_values(ctx, reader, loaded);
  if (status == FG_OK)
    *part = loaded;
  else
    fg_part_free(loaded);
  return status;
}

fg_status fg_part_load(fg_context *ctx, sqlite3 *reader, const char *station, int64_t event,
                       fg_part **part) {
  return load_part(ctx, reader, station, of_event, event, part);
}

fg_status fg_part_load_foil(fg_context *ctx, sqlite3 *reader, const char *station, int64_t foil,
                            fg_part **part) {
  return load_part(ctx, reader, station, of_foil, foil, part);
}

void fg_part_free(fg_part *part) {
  if (!part) return;
  fg_decision_free(&part->decision);
  fg_stored_foil_free(part->stored);
  free(part->values);
  free(part);
}
