/* What somebody says of a foil, over what its file's name said: every change leaves a trail. */
#include <stdlib.h>
#include <string.h>

#include "station/actions.h"
#include "station/naming.h"

static const struct {
  const char *field;
  const char *update;
} fields[] = {
    {"serial", "UPDATE foils SET serial = ? WHERE id = ?"},
    {"lot", "UPDATE foils SET lot = ? WHERE id = ?"},
    {"die", "UPDATE foils SET die = ? WHERE id = ?"},
    {"operator", "UPDATE foils SET operator = ? WHERE id = ?"},
};

/* TEXT_BYTES: a file's name, and the number of a foil of its bed. */
enum { FIELDS = sizeof fields / sizeof *fields, TEXT_BYTES = FG_NAMED_TEXT + 16 };

typedef struct correction {
  int64_t foil;
  char before[FIELDS][TEXT_BYTES], after[FIELDS][TEXT_BYTES];
  bool asked[FIELDS];
  char by[TEXT_BYTES];
} correction;

/* Without the spaces around it, which readers and fingers add. */
static fg_status take_text(fg_context *ctx, const char *field, const char *given,
                           char text[TEXT_BYTES]) {
  given += strspn(given, " ");
  size_t length = strlen(given);
  while (length && given[length - 1] == ' ')
    length--;
  if (length >= TEXT_BYTES)
    return fg_fail(ctx, FG_ERR_DATA, "The %s is too long: at most %d bytes.", field,
                   TEXT_BYTES - 1);
  memcpy(text, given, length);
  text[length] = '\0';
  return FG_OK;
}

static bool is_given(const fg_request *request, const char *name) {
  for (size_t i = 0; i < request->fields; i++)
    if (!strcmp(request->field[i].name, name)) return true;
  return false;
}

/* A field that the form does not have stays as it is. */
static fg_status take_form(fg_context *ctx, const fg_request *request, correction *asked) {
  char *end;
  const char *id = fg_request_get(request, "foil");
  *asked = (correction){.foil = strtoll(id, &end, 10)};
  if (*end || asked->foil <= 0) return fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
  for (size_t i = 0; i < FIELDS; i++) {
    asked->asked[i] = is_given(request, fields[i].field);
    FG_TRY(
        take_text(ctx, fields[i].field, fg_request_get(request, fields[i].field), asked->after[i]));
  }
  if (asked->asked[0] && !asked->after[0][0])
    return fg_fail(ctx, FG_ERR_DATA,
                   "The serial number is empty: a foil needs one to be found again.");
  return take_text(ctx, "name", fg_request_get(request, "by"), asked->by);
}

static fg_status read_before(fg_context *ctx, sqlite3 *writer, correction *asked) {
  fg_query query;
  fg_query_begin(writer, "SELECT serial, lot, die, operator FROM foils WHERE id = ?", &query);
  fg_query_integer(&query, asked->foil);
  bool found = fg_query_row(&query);
  for (int i = 0; found && i < FIELDS; i++)
    snprintf(asked->before[i], sizeof asked->before[i], "%s", fg_query_get_text(&query, i));
  FG_TRY(fg_query_end(ctx, &query, "reading a foil"));
  return found ? FG_OK : fg_fail(ctx, FG_ERR_USAGE, "There is no such foil.");
}

static fg_status set_field(fg_context *ctx, sqlite3 *writer, const correction *asked, size_t i) {
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

/* Whoever does not say who corrects is taken for the operator that the foil has then. */
static fg_status change(fg_context *ctx, sqlite3 *writer, correction *asked) {
  enum { OPERATOR = FIELDS - 1 };
  FG_TRY(read_before(ctx, writer, asked));
  if (!asked->by[0])
    snprintf(asked->by, sizeof asked->by, "%s",
             asked->asked[OPERATOR] ? asked->after[OPERATOR] : asked->before[OPERATOR]);
  for (size_t i = 0; i < FIELDS; i++)
    if (asked->asked[i] && strcmp(asked->before[i], asked->after[i]) != 0)
      FG_TRY(set_field(ctx, writer, asked, i));
  return FG_OK;
}

fg_status fg_action_correct(fg_context *ctx, fg_inspection *station, const fg_request *request,
                            fg_answer *answer) {
  correction asked;
  FG_TRY(take_form(ctx, request, &asked));
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 change(ctx, station->database.writer, &asked)));
  /* Back to one of two pages of our own, whatever the form says. */
  if (!strcmp(fg_request_get(request, "back"), "/"))
    strcpy(answer->location, "/");
  else
    snprintf(answer->location, sizeof answer->location, "/foil?id=%lld", (long long)asked.foil);
  return FG_OK;
}
