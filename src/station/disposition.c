/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/disposition.h"

#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "page/page.h"
#include "station/access.h"
#include "station/keep.h"
#include "station/news.h"

static const struct {
  const char *kind, *words;
} kinds[] = {{"scrap", "Scrap"},
             {"rework", "Rework"},
             {"concession", "Concession"},
             {"again", "Measure again"}};
enum { KINDS = sizeof kinds / sizeof *kinds, REASON_BYTES = 120 };

fg_status fg_disposition_count_open(fg_context *ctx, sqlite3 *connection, const char *lot,
                                    int64_t *count) {
  fg_query query;
  fg_query_begin(connection,
                 "SELECT count(*) FROM (SELECT 1 FROM foils WHERE (?1 IS NULL OR lot = ?1) "
                 "AND " FG_FOIL_IS_OPEN " LIMIT CASE WHEN ?1 IS NULL THEN ?2 ELSE -1 END)",
                 &query);
  fg_query_text(&query, lot);
  fg_query_integer(&query, FG_OPEN_COUNTED);
  *count = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "counting open foils");
}

fg_status fg_disposition_write_open(fg_context *ctx, sqlite3 *reader, FILE *out) {
  int64_t count;
  FG_TRY(fg_disposition_count_open(ctx, reader, NULL, &count));
  if (count)
    fprintf(out,
            "<p class=\"order\"><a href=\"/history?verdict=open\"><b>%lld%s</b> without "
            "disposition</a></p>\n",
            (long long)count, count == FG_OPEN_COUNTED ? "+" : "");
  return FG_OK;
}

fg_status fg_disposition_write_link(fg_context *ctx, sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  fg_query_begin(reader, "SELECT 1 FROM foils WHERE id = ? AND " FG_FOIL_IS_OPEN, &query);
  fg_query_integer(&query, foil);
  if (fg_query_row(&query))
    fprintf(out,
            "<p class=\"noprint\"><a class=\"button\" href=\"/foil?id=%lld#fate\">Scrap, rework, "
            "concession …</a></p>\n",
            (long long)foil);
  return fg_query_end(ctx, &query, "reading a foil");
}

/* Reason codes of the recipe: between commas. */
static void write_reasons(const char *reasons, FILE *out) {
  char reason[REASON_BYTES];
  fputs("<label>Reason<input name=\"reason\" maxlength=\"100\" autocomplete=\"off\" "
        "list=\"reasons\"></label><datalist id=\"reasons\">",
        out);
  for (const char *at = reasons; *at;) {
    at += strspn(at, ", ");
    size_t length = strcspn(at, ",");
    fg_text_clip(reason, sizeof reason, "%.*s", (int)length, at);
    if (length) {
      fputs("<option value=\"", out);
      fg_html_text(out, reason);
      fputs("\">", out);
    }
    at += length;
  }
  fputs("</datalist>", out);
}

static void write_kinds(const fg_inspection *station, int64_t foil, FILE *out) {
  fputs("<form id=\"fate\" class=\"fields noprint\" method=\"post\" action=\"/dispose\">", out);
  fg_page_csrf_token(station, out);
  fprintf(out, "<input type=\"hidden\" name=\"foil\" value=\"%lld\">", (long long)foil);
  write_reasons(station->settings->reasons, out);
  fputs("<label>Note<input name=\"note\" maxlength=\"300\" autocomplete=\"off\"></label><label>"
        "Decided by<input name=\"by\" maxlength=\"127\" autocomplete=\"off\" required></label>",
        out);
  for (size_t i = 0; i < KINDS; i++)
    fprintf(out, "<button class=\"plain\" name=\"kind\" value=\"%s\">%s</button>", kinds[i].kind,
            kinds[i].words);
  fputs("</form>\n", out);
}

static const char *kind_words(const char *kind) {
  for (size_t i = 0; i < KINDS; i++)
    if (!strcmp(kinds[i].kind, kind)) return kinds[i].words;
  return kind;
}

static void write_in_force(const fg_query *query, FILE *out) {
  fputs("<p class=\"next\">Disposition: <b>", out);
  fg_html_text(out, kind_words(fg_query_get_text(query, 1)));
  fputs("</b>", out);
  if (fg_query_get_text(query, 2)[0])
    fg_html_name((fputs(", ", out), out), fg_query_get_text(query, 2));
  if (fg_query_get_text(query, 3)[0])
    fg_html_name((fputs(": ", out), out), fg_query_get_text(query, 3));
  fg_html_name((fputs(" (", out), out), fg_query_get_text(query, 4));
  fputs(", ", out);
  fg_page_time(out, fg_query_get_integer(query, 5));
  fputs(")</p>\n", out);
}

fg_status fg_disposition_write_html_form(fg_context *ctx, const fg_inspection *station,
                                         sqlite3 *reader, int64_t foil, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT foils.verdict IN ('fail', 'cannot_tell', 'not_measured'), kind, reason,"
                 " note, by, at FROM foils LEFT JOIN dispositions ON dispositions.foil = foils.id"
                 " WHERE foils.id = ? ORDER BY dispositions.id DESC LIMIT 1",
                 &query);
  fg_query_integer(&query, foil);
  bool asked = fg_query_row(&query) && fg_query_get_integer(&query, 0);
  bool known = asked && !fg_query_is_null(&query, 1);
  if (known) write_in_force(&query, out);
  if (asked && !known) fputs("<p class=\"next\">No disposition yet.</p>\n", out);
  if (asked) write_kinds(station, foil, out);
  return fg_query_end(ctx, &query, "reading a disposition");
}

static fg_status insert_disposition(fg_context *ctx, sqlite3 *writer, const fg_request *request,
                                    int64_t foil) {
  fg_query query;
  fg_query_begin(
      writer,
      "INSERT INTO dispositions (foil, kind, reason, note, by, at) SELECT id, ?, ?, ?, ?,"
      " ? FROM foils WHERE id = ? AND verdict IN ('fail', 'cannot_tell',"
      " 'not_measured')",
      &query);
  fg_query_text(&query, fg_request_get(request, "kind"));
  fg_query_text(&query, fg_request_get(request, "reason"));
  fg_query_text(&query, fg_request_get(request, "note"));
  fg_query_text(&query, fg_request_get(request, "by"));
  fg_query_integer(&query, fg_station_now());
  fg_query_integer(&query, foil);
  fg_query_row(&query);
  FG_TRY(fg_query_end(ctx, &query, "keeping a disposition"));
  if (fg_sqlite.changes(writer) == 1) return fg_event_keep(ctx, writer, foil, FG_EVENT_DISPOSED);
  return fg_fail(ctx, FG_ERR_USAGE, "There is no such foil that did not pass.");
}

fg_status fg_action_dispose(fg_context *ctx, fg_inspection *station, const fg_request *request,
                            fg_answer *answer) {
  const char *kind = fg_request_get(request, "kind"), *by = fg_request_get(request, "by");
  int64_t foil = strtoll(fg_request_get(request, "foil"), NULL, 10);
  if (!by[strspn(by, " ")])
    return fg_fail(ctx, FG_ERR_DATA, "Who decides? Go back and fill in the name.");
  if (kind_words(kind) == kind)
    return fg_fail(ctx, FG_ERR_DATA, "Scrap, rework, concession or measure again? Go back.");
  const fg_user *user = fg_access_user(station, request);
  if (user && user->role < FG_ROLE_QUALITY && !strcmp(kind, "concession"))
    return fg_fail(ctx, FG_ERR_DATA, "A concession takes the role quality.");
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 insert_disposition(ctx, station->database.writer, request, foil)));
  fg_station_notify(station);
  snprintf(answer->location, sizeof answer->location, "/foil?id=%lld", (long long)foil);
  return FG_OK;
}
