/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corrections of a foil's identity, which its file's name gave: every change leaves a trail.
 *
 * A form carries the values that it showed (`was_serial` beside `serial`), so that only fields
 * changed in it are applied. A change that somebody else made meanwhile is not overwritten, and
 * a serial number of another foil is not used: the page asks first. */
#include "station/correct.h"

#include <stdlib.h>
#include <string.h>

#include "station/keep.h"
#include "station/news.h"
#include "station/pages.h"

static const struct {
  const char *field, *was;
  const char *update;
} fields[FG_IDENTITY_FIELDS] = {
    {"serial", "was_serial", "UPDATE foils SET serial = ? WHERE id = ?"},
    {"lot", "was_lot", "UPDATE foils SET lot = ? WHERE id = ?"},
    {"die", "was_die", "UPDATE foils SET die = ? WHERE id = ?"},
    {"operator", "was_operator", "UPDATE foils SET operator = ? WHERE id = ?"},
};

enum { SERIAL = 0, OPERATOR = FG_IDENTITY_FIELDS - 1 };

const char *fg_identity_field(size_t field) {
  return fields[field].field;
}

static fg_status read_identity_text(fg_context *ctx, const char *field, const char *given,
                                    char text[FG_IDENTITY_BYTES]) {
  return fg_request_read_text(ctx, field, given, text, FG_IDENTITY_BYTES);
}

static bool is_given(const fg_request *request, const char *name) {
  for (size_t i = 0; i < request->fields; i++)
    if (!strcmp(request->field[i].name, name)) return true;
  return false;
}

/* Reads a field. One that the html form lacks, or shows unchanged, is not corrected. */
static fg_status read_identity_field(fg_context *ctx, const fg_request *request, size_t i,
                                     fg_identity_change *asked) {
  const char *name = fields[i].field;
  FG_TRY(read_identity_text(ctx, name, fg_request_get(request, name), asked->after[i]));
  FG_TRY(read_identity_text(ctx, name, fg_request_get(request, fields[i].was), asked->was[i]));
  asked->was_given[i] = is_given(request, fields[i].was);
  asked->asked[i] =
      is_given(request, name) && !(asked->was_given[i] && !strcmp(asked->was[i], asked->after[i]));
  return FG_OK;
}

static fg_status read_html_form(fg_context *ctx, const fg_request *request,
                                fg_identity_change *asked) {
  char *end;
  const char *id = fg_request_get(request, "foil");
  *asked = (fg_identity_change){.foil = strtoll(id, &end, 10)};
  if (*end || asked->foil <= 0) return fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++)
    FG_TRY(read_identity_field(ctx, request, i, asked));
  if (asked->asked[SERIAL] && !asked->after[SERIAL][0])
    return fg_fail(ctx, FG_ERR_DATA,
                   "The serial number is empty: a foil needs one to be found again.");
  /* An html form returns to one of two pages of the station, whatever address it holds. */
  asked->to_now = !strcmp(fg_request_get(request, "back"), "/");
  FG_TRY(read_identity_text(ctx, "serial", fg_request_get(request, "also"), asked->also));
  return read_identity_text(ctx, "name", fg_request_get(request, "by"), asked->by);
}

static fg_status read_before(fg_context *ctx, sqlite3 *writer, fg_identity_change *asked) {
  fg_query query;
  fg_query_begin(writer, "SELECT serial, lot, die, operator FROM foils WHERE id = ?", &query);
  fg_query_integer(&query, asked->foil);
  bool found = fg_query_row(&query);
  for (int i = 0; found && i < FG_IDENTITY_FIELDS; i++)
    snprintf(asked->before[i], sizeof asked->before[i], "%s", fg_query_get_text(&query, i));
  FG_TRY(fg_query_end(ctx, &query, "reading a foil"));
  return found ? FG_OK : fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
}

/* True where somebody else changed the field since the form was shown, and to another value. */
static bool is_overtaken(const fg_identity_change *asked, size_t i) {
  char before[FG_IDENTITY_BYTES];
  if (!asked->asked[i] || !asked->was_given[i]) return false;
  if (read_identity_text(NULL, "", asked->before[i], before) != FG_OK) return true;
  return strcmp(before, asked->was[i]) != 0 && strcmp(before, asked->after[i]) != 0;
}

/* Finds another foil with the serial number, unless a shared number has been confirmed. */
static fg_status find_serial_owner(fg_context *ctx, sqlite3 *writer, fg_identity_change *asked) {
  fg_query query;
  const char *serial = asked->after[SERIAL];
  if (!asked->asked[SERIAL] || !strcmp(serial, asked->before[SERIAL]) ||
      !strcmp(serial, asked->also))
    return FG_OK;
  fg_query_begin(writer, "SELECT 1 FROM foils WHERE serial = ? AND id <> ? LIMIT 1", &query);
  fg_query_text(&query, serial);
  fg_query_integer(&query, asked->foil);
  asked->owned = fg_query_row(&query);
  return fg_query_end(ctx, &query, "reading the serial numbers");
}

static fg_status set_field(fg_context *ctx, sqlite3 *writer, const fg_identity_change *asked,
                           size_t i) {
  fg_query query;
  fg_query_begin(writer, fields[i].update, &query);
  fg_query_text(&query, asked->after[i]);
  fg_query_integer(&query, asked->foil);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a correction"));
  fg_query_begin(writer,
                 "INSERT INTO corrections (foil, field, before, after, by, at)"
                 " VALUES (?, ?, ?, ?, ?, ?)",
                 &query);
  fg_query_integer(&query, asked->foil);
  fg_query_text(&query, fields[i].field);
  fg_query_text(&query, asked->before[i]);
  fg_query_text(&query, asked->after[i]);
  fg_query_text(&query, asked->by);
  fg_query_integer(&query, fg_station_now());
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a correction");
}

/* Applies a change. Its author, if not given, is the operator whom the foil then has. */
static fg_status change(fg_context *ctx, sqlite3 *writer, fg_identity_change *asked) {
  FG_TRY(read_before(ctx, writer, asked));
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++) {
    asked->overtaken[i] = is_overtaken(asked, i);
    asked->held = asked->held || asked->overtaken[i];
  }
  FG_TRY(find_serial_owner(ctx, writer, asked));
  asked->held = asked->held || asked->owned;
  if (asked->held) return FG_OK;
  if (!asked->by[0])
    snprintf(asked->by, sizeof asked->by, "%s",
             asked->asked[OPERATOR] ? asked->after[OPERATOR] : asked->before[OPERATOR]);
  bool changed = false;
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++) {
    if (!asked->asked[i] || !strcmp(asked->before[i], asked->after[i])) continue;
    FG_TRY(set_field(ctx, writer, asked, i));
    changed = true;
  }
  return changed ? fg_event_keep(ctx, writer, asked->foil, FG_EVENT_CORRECTED) : FG_OK;
}

fg_status fg_action_correct(fg_context *ctx, fg_inspection *station, const fg_request *request,
                            fg_answer *answer) {
  fg_identity_change asked;
  FG_TRY(read_html_form(ctx, request, &asked));
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 change(ctx, station->database.writer, &asked)));
  if (asked.held) return fg_page_identity(ctx, station, &asked, answer);
  fg_station_notify(station);
  if (asked.to_now)
    strcpy(answer->location, "/");
  else
    snprintf(answer->location, sizeof answer->location, "/foil?id=%lld", (long long)asked.foil);
  return FG_OK;
}
