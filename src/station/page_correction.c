/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Page of a held correction: fields that somebody else changed meanwhile, or the foil that has the
 * serial number already. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "page/page.h"
#include "station/correct.h"
#include "station/pages.h"
#include "station/values.h"

static void write_conflict_cell(FILE *out, const char *name, const char *text) {
  fprintf(out, "<td class=\"text\" data-name=\"%s\">", name);
  fg_html_name(out, text[0] ? text : "–");
  fputs("</td>", out);
}

/* Author and time of the last change of a field. */
static fg_status write_last_change(fg_context *ctx, sqlite3 *reader, int64_t foil,
                                   const char *field, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT by, at FROM corrections WHERE foil = ? AND field = ? ORDER BY id DESC"
                 " LIMIT 1",
                 &query);
  fg_query_integer(&query, foil);
  fg_query_text(&query, field);
  fputs("<td data-name=\"by\">", out);
  if (fg_query_row(&query)) {
    const char *by = fg_query_get_text(&query, 0);
    if (by[0])
      fg_html_name(out, by);
    else
      fputs("no name given", out);
    fputs(", ", out);
    fg_page_time(out, fg_query_get_integer(&query, 1));
  }
  fputs("</td>", out);
  return fg_query_end(ctx, &query, "reading the corrections");
}

static fg_status write_overtaken(fg_context *ctx, sqlite3 *reader, const fg_identity_change *asked,
                                 FILE *out) {
  fputs(
      "<p>Nothing was changed. Somebody else has changed the foil since your page was loaded:</p>\n"
      "<table class=\"left rows\"><thead><tr><th>Field</th><th>Now</th><th>By</th>"
      "<th>Your page showed</th><th>You want</th></tr></thead>\n<tbody>\n",
      out);
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++) {
    if (!asked->overtaken[i]) continue;
    fprintf(out, "<tr><td><b>%s</b></td>", fg_identity_field(i));
    write_conflict_cell(out, "now", asked->before[i]);
    FG_TRY(write_last_change(ctx, reader, asked->foil, fg_identity_field(i), out));
    write_conflict_cell(out, "your page showed", asked->was[i]);
    write_conflict_cell(out, "you want", asked->after[i]);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table>\n<p>Keep what you want over it, or go back.</p>\n", out);
  return FG_OK;
}

static fg_status write_owners(fg_context *ctx, sqlite3 *reader, const fg_identity_change *asked,
                              FILE *out) {
  enum { SHOWN = 5 };
  fg_query query;
  fg_query_begin(reader,
                 "SELECT foils.id, lot, foils.verdict, withheld, at, path FROM foils"
                 " JOIN scans ON scans.id = scan"
                 " WHERE serial = ? AND foils.id <> ? ORDER BY foils.id DESC LIMIT ?",
                 &query);
  fg_query_text(&query, asked->after[0]);
  fg_query_integer(&query, asked->foil);
  fg_query_integer(&query, SHOWN);
  fputs("<p>Nothing was changed. The serial number is that of:</p>\n<ul class=\"cards\">\n", out);
  while (fg_query_row(&query)) {
    const char *verdict = fg_query_get_text(&query, 2), *lot = fg_query_get_text(&query, 1);
    bool withheld = !fg_query_is_null(&query, 3);
    fprintf(out, "<li><span class=\"tag %s\">%s</span> <a href=\"/foil?id=%lld\">",
            fg_page_verdict_class(verdict, withheld), fg_page_verdict_words(verdict, withheld),
            (long long)fg_query_get_integer(&query, 0));
    fg_html_name(out, asked->after[0]);
    fputs("</a><span>", out);
    fg_html_name(out, fg_query_get_text(&query, 5));
    if (*lot) fputs(", lot ", out);
    fg_html_name(out, lot);
    fputs("</span><span class=\"note\">", out);
    fg_page_time(out, fg_query_get_integer(&query, 4));
    fputs("</span></li>\n", out);
  }
  fputs("</ul>\n<p>Is it the same foil, measured again? Else type the right number.</p>\n", out);
  return fg_query_end(ctx, &query, "reading the serial numbers");
}

static fg_status write_conflict_html_form(fg_context *ctx, const fg_inspection *station,
                                          sqlite3 *reader, const fg_identity_change *asked,
                                          FILE *out) {
  fg_query query;
  fg_foil_html_form html_form = {.back = asked->to_now ? "/" : "/foil",
                                 .focus = true,
                                 .who = !asked->to_now,
                                 .by = asked->by,
                                 .also = asked->owned ? asked->after[0] : ""};
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++)
    html_form.asked[i] = asked->asked[i] ? asked->after[i] : NULL;
  fg_query_begin(reader, "SELECT id, serial, lot, die, operator FROM foils WHERE id = ?", &query);
  fg_query_integer(&query, asked->foil);
  if (fg_query_row(&query)) fg_page_foil_html_form(station, &query, &html_form, out);
  return fg_query_end(ctx, &query, "reading a foil");
}

static fg_status write_conflict_page(fg_context *ctx, fg_inspection *station,
                                     const fg_identity_change *asked, FILE *out) {
  sqlite3 *reader = station->database.reader;
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, "Correct a foil"));
  bool overtaken = false;
  for (size_t i = 0; i < FG_IDENTITY_FIELDS; i++)
    overtaken = overtaken || asked->overtaken[i];
  fprintf(out, "<section>\n<h1>Foil <a href=\"/foil?id=%lld\">", (long long)asked->foil);
  fg_html_name(out, asked->before[0]);
  fputs("</a>", out);
  fputs(asked->owned ? ": another foil has the serial number " : " was changed meanwhile", out);
  if (asked->owned) fg_html_name(out, asked->after[0]);
  fputs("</h1>\n", out);
  if (overtaken) FG_TRY(write_overtaken(ctx, reader, asked, out));
  if (asked->owned) FG_TRY(write_owners(ctx, reader, asked, out));
  FG_TRY(write_conflict_html_form(ctx, station, reader, asked, out));
  if (asked->to_now)
    fputs("<p><a href=\"/\">Back to Now</a></p>\n</section>\n", out);
  else
    fprintf(out, "<p><a href=\"/foil?id=%lld\">Back to the foil</a></p>\n</section>\n",
            (long long)asked->foil);
  fg_page_end(out);
  return FG_OK;
}

fg_status fg_page_identity(fg_context *ctx, fg_inspection *station, const fg_identity_change *asked,
                           fg_answer *answer) {
  enum { CONFLICT = 409 };
  FILE *out = fg_stream_open(&answer->body, &answer->size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  pthread_mutex_lock(&station->database.reading);
  fg_status status = write_conflict_page(ctx, station, asked, out);
  pthread_mutex_unlock(&station->database.reading);
  if (!fg_stream_keep(out, &answer->body) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  answer->code = CONFLICT;
  return status;
}
