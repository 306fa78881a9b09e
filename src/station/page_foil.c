/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One foil: its verdict and the reasons, its picture, its values with their limits, its html
 * form, and its corrections. */
#include <string.h>

#include "page/page.h"
#include "page/table.h"
#include "station/disposition.h"
#include "station/pages.h"
#include "station/stored_foil.h"
#include "station/values.h"

static void write_fact(FILE *out, const char *title, const char *text) {
  if (!text || !text[0]) return;
  fprintf(out, "<dt>%s</dt><dd>", title);
  fg_html_name(out, text);
  fputs("</dd>\n", out);
}

static void write_foil_call(const fg_stored_foil *stored, FILE *out) {
  bool withheld = stored->withheld != NULL;
  fprintf(out, "<div class=\"call small %s\"><b>%s</b><span>",
          fg_page_verdict_class(stored->verdict, withheld),
          fg_page_verdict_words(stored->verdict, withheld));
  fg_html_name(out, stored->serial);
  fputs("<br>", out);
  fg_page_time(out, stored->at);
  fputs("</span></div>\n", out);
  const char *words = withheld ? stored->withheld : stored->reasons;
  if (!words[0] && !strcmp(stored->verdict, "cannot_tell"))
    words = "A limit lies within the uncertainty of a value: neither PASS nor FAIL is proven.";
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
    fprintf(out,
            "<p class=\"note\"><a href=\"/picture?foil=%lld\">Draw its picture from the "
            "scan</a></p>\n",
            (long long)stored->id);
  return fg_query_end(ctx, &query, "reading a picture");
}

static fg_status write_facts(fg_context *ctx, const fg_stored_foil *stored, FILE *out) {
  fputs("<h2>Where it comes from</h2>\n<dl class=\"facts\">\n", out);
  write_fact(out, "Scan file", stored->path);
  fprintf(out, "<dt>From</dt><dd>%s</dd>\n",
          !strcmp(stored->source, "scanner") ? "the Scan button" : "the folder");
  write_fact(out, "Lot", stored->lot);
  write_fact(out, "Die", stored->die);
  write_fact(out, "Operator", stored->operator_name);
  write_fact(out, "SHA-256", stored->sha256);
  FG_TRY(fg_stored_foil_write_provenance(ctx, stored, out));
  fputs("</dl>\n", out);
  return FG_OK;
}

/* A change: the row of a query. Of a disposition the last column has its kind. */
enum { CHANGE_AT, CHANGE_BY, CHANGE_FIELD, CHANGE_BEFORE, CHANGE_AFTER, CHANGE_KIND };

static void write_change_time(FILE *out, const fg_subject *change) {
  fg_page_time(out, fg_query_get_integer(change->object, CHANGE_AT));
}

static void write_author(FILE *out, const fg_subject *change) {
  const char *by = fg_query_get_text(change->object, CHANGE_BY);
  if (by[0])
    fg_html_name(out, by);
  else
    fputs("no name given", out);
}

static void write_field(FILE *out, const fg_subject *change) {
  fg_html_text(out, fg_query_get_text(change->object, CHANGE_FIELD));
}

static void write_before(FILE *out, const fg_subject *change) {
  const char *text = fg_query_get_text(change->object, CHANGE_BEFORE);
  fg_html_name(out, text[0] ? text : "–");
}

static void write_after(FILE *out, const fg_subject *change) {
  const char *text = fg_query_get_text(change->object, CHANGE_AFTER);
  const char *kind = fg_query_get_text(change->object, CHANGE_KIND);
  fg_html_text(out, kind);
  if (kind[0] && text[0]) fputs(", ", out);
  fg_html_name(out, text[0] || kind[0] ? text : "–");
}

#define CHANGE(name_, write_, ...)                                                                 \
  {                                                                                                \
    FG_TEXT_BY(name_, NULL), .markup = (write_), .page = {.rank = 1, __VA_ARGS__ }                 \
  }
static const fg_member change_rows[] = {
    CHANGE("at", write_change_time, .heading = "When"),
    CHANGE("by", write_author, .heading = "Who", .words = true),
    CHANGE("field", write_field, .heading = "What", .words = true),
    CHANGE("before", write_before, .heading = "Before", .words = true),
    CHANGE("after", write_after, .heading = "After", .words = true),
};
static const fg_members change_members = {change_rows, 5, .frame = "left"};

static fg_status write_trail(fg_context *ctx, sqlite3 *reader, const fg_stored_foil *stored,
                             FILE *out) {
  fg_query query;
  fg_member_columns columns;
  bool any = false;
  fg_member_columns_of(&change_members, FG_ON_PAGE, &(fg_subject){0}, &columns);
  fg_query_begin(
      reader,
      "SELECT at, by, field, before, after, '' FROM corrections WHERE foil = ?1 UNION ALL"
      " SELECT at, by, 'disposition', '', reason || iif(reason = '' OR note = '', '', ': ') ||"
      " note, kind FROM dispositions WHERE foil = ?1 ORDER BY at",
      &query);
  fg_query_integer(&query, stored->id);
  fputs("<h2>Corrections and dispositions</h2>\n", out);
  while (fg_query_row(&query)) {
    if (!any) fg_html_table_begin(out, &columns), fg_html_table_rows(out);
    any = true;
    fg_html_table_row(out, &columns, &(fg_subject){.object = &query});
    fputs("</tr>\n", out);
  }
  if (any)
    fg_html_table_end(out);
  else
    fputs("<p class=\"note\">None.</p>\n", out);
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
  fg_page_heading(out, "Foil");
  fputs("<section>\n", out);
  write_foil_call(stored, out);
  FG_TRY(fg_page_crushed(ctx, reader, stored->id, out));
  FG_TRY(fg_page_deciding(ctx, reader, stored->id, out));
  FG_TRY(fg_page_same_serial(ctx, reader, stored->id, out));
  FG_TRY(fg_disposition_write_html_form(ctx, station, reader, stored->id, out));
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
