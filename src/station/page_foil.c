/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One foil: its verdict and the reasons, its picture, its values with their limits, its html
 * form, and its corrections. */
#include <string.h>

#include "page/page.h"
#include "station/pages.h"
#include "station/stored_foil.h"
#include "station/values.h"

static void write_fact(FILE *out, const char *title, const char *text) {
  if (!text || !text[0]) return;
  fprintf(out, "<dt>%s</dt><dd>", title);
  fg_html_text(out, text);
  fputs("</dd>\n", out);
}

static void write_foil_call(const fg_stored_foil *stored, FILE *out) {
  bool withheld = stored->withheld != NULL;
  fprintf(out, "<div class=\"call small %s\"><b>%s</b><span>",
          fg_page_verdict_class(stored->verdict, withheld),
          fg_page_verdict_words(stored->verdict, withheld));
  fg_html_text(out, stored->serial);
  fputs("<br>", out);
  fg_page_time(out, stored->at);
  fputs("</span></div>\n", out);
  const char *words = withheld ? stored->withheld : stored->reasons;
  if (!words[0]) return;
  fputs("<p class=\"next\">", out);
  fg_html_text(out, words);
  fputs("</p>\n", out);
}

static fg_status write_picture(fg_context *ctx, sqlite3 *reader, const fg_stored_foil *stored,
                               FILE *out) {
  fg_query query;
  fg_query_begin(reader, "SELECT html FROM pictures WHERE foil = ?", &query);
  fg_query_integer(&query, stored->id);
  if (fg_query_row(&query))
    fprintf(out, "<figure class=\"scroll\">%s</figure>\n", fg_query_get_text(&query, 0));
  else
    fputs("<p class=\"note\">Its picture is in the whole report.</p>\n", out);
  return fg_query_end(ctx, &query, "reading a picture");
}

static fg_status write_facts(fg_context *ctx, const fg_stored_foil *stored, FILE *out) {
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\">\n", out);
  write_fact(out, "Scan", stored->path);
  write_fact(out, "From", !strcmp(stored->source, "scanner") ? "the Scan button" : "the folder");
  write_fact(out, "Lot", stored->lot);
  write_fact(out, "Die", stored->die);
  write_fact(out, "Operator", stored->operator_name);
  write_fact(out, "SHA-256", stored->sha256);
  FG_TRY(fg_stored_foil_write_provenance(ctx, stored, out));
  fputs("</dl>\n", out);
  return FG_OK;
}

static void write_change(FILE *out, const fg_query *at) {
  fputs("<tr><td>", out);
  fg_page_time(out, fg_query_get_integer(at, 0));
  for (int i = 1; i < 5; i++) {
    const char *text = fg_query_get_text(at, i);
    fputs("</td><td class=\"words\">", out);
    fg_html_text(out, text[0] ? text : i == 1 ? "no name given" : "–");
  }
  fputs("</td></tr>\n", out);
}

static fg_status write_trail(fg_context *ctx, sqlite3 *reader, const fg_stored_foil *stored,
                             FILE *out) {
  fg_query query;
  bool any = false;
  fg_query_begin(reader,
                 "SELECT at, by, field, before, after FROM corrections WHERE foil = ? ORDER BY id",
                 &query);
  fg_query_integer(&query, stored->id);
  fputs("<h2>Corrections</h2>\n", out);
  while (fg_query_row(&query)) {
    if (!any)
      fputs("<div class=\"scroll\"><table class=\"left\"><thead><tr><th>When</th><th>Who</th>"
            "<th>What</th><th>Before</th><th>After</th></tr></thead>\n<tbody>\n",
            out);
    any = true;
    write_change(out, &query);
  }
  fputs(any ? "</tbody></table></div>\n" : "<p class=\"note\">None.</p>\n", out);
  return fg_query_end(ctx, &query, "reading the corrections");
}

static fg_status write_foil_html_form(fg_context *ctx, const fg_inspection *station,
                                      sqlite3 *reader, const fg_stored_foil *stored, FILE *out) {
  fg_query query;
  fg_query_begin(reader, "SELECT id, serial, lot, die, operator FROM foils WHERE id = ?", &query);
  fg_query_integer(&query, stored->id);
  const fg_foil_html_form html_form = {.back = "/foil", .who = true};
  if (fg_query_row(&query)) fg_page_foil_html_form(station, &query, &html_form, out);
  return fg_query_end(ctx, &query, "reading a foil");
}

static fg_status write_foil(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                            const fg_stored_foil *stored, FILE *out) {
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, stored->serial));
  fputs("<section>\n", out);
  write_foil_call(stored, out);
  FG_TRY(fg_page_crushed(ctx, reader, stored->id, out));
  FG_TRY(fg_page_deciding(ctx, reader, stored->id, out));
  FG_TRY(fg_page_same_serial(ctx, reader, stored->id, out));
  FG_TRY(write_picture(ctx, reader, stored, out));
  fprintf(out,
          "<p class=\"noprint\"><a class=\"button\" href=\"/report?foil=%lld\">The whole "
          "report</a></p>\n",
          (long long)stored->id);
  fg_stored_foil_write_tables(stored, out);
  fputs("<h2 class=\"noprint\">Correct what is said of it</h2>\n", out);
  FG_TRY(write_foil_html_form(ctx, station, reader, stored, out));
  FG_TRY(write_trail(ctx, reader, stored, out));
  FG_TRY(write_facts(ctx, stored, out));
  fputs("</section>\n", out);
  fg_page_end(out);
  return FG_OK;
}

fg_status fg_page_foil(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                       const fg_request *request, FILE *out) {
  fg_stored_foil *stored;
  FG_TRY(fg_stored_foil_load(ctx, reader, fg_request_get(request, "id"), &stored));
  fg_status status = write_foil(ctx, station, reader, stored, out);
  fg_stored_foil_free(stored);
  return status;
}
