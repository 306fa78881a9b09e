/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lots that are open and lots that are closed. */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "page/page.h"
#include "page/table.h"
#include "station/disposition.h"
#include "station/lot_content.h"
#include "station/pages.h"

enum { LOTS_SHOWN = 25, LOTS_MAX = 1000000 };

static void write_lot_name(FILE *out, const char *lot) {
  if (*lot)
    fg_html_name(out, lot);
  else
    fputs("without lot", out);
}

/* Writes text encoded as a value in a link. */
static void write_encoded(FILE *out, const char *text) {
  for (; *text; text++) {
    bool plain = (*text >= '0' && *text <= '9') || (*text >= 'A' && *text <= 'Z') ||
                 (*text >= 'a' && *text <= 'z') || *text == '-' || *text == '_' || *text == '.';
    fprintf(out, plain ? "%c" : "%%%02X", (unsigned char)*text);
  }
}

static void write_link(FILE *out, const char *page, const char *lot, const char *words) {
  fprintf(out, "<a href=\"%s", page);
  write_encoded(out, lot);
  fprintf(out, "\">%s</a>", words);
}

/* Counts of a row: foils, pass, fail, again, withheld. */
#define COUNTS                                                                                     \
  "count(*), total(f.verdict = 'pass' AND s.withheld IS NULL),"                                    \
  " total(f.verdict = 'fail' AND s.withheld IS NULL),"                                             \
  " total(f.verdict IN ('cannot_tell', 'not_measured') AND s.withheld IS NULL),"                   \
  " total(s.withheld IS NOT NULL)"

/* Columns of the queries, of open lots and of the one that is asked about. */
enum { LOT_NAME, LOT_NEWEST, LOT_COUNTS };

static double find_foils(const fg_subject *row) {
  return (double)fg_query_get_integer(row->object, LOT_COUNTS);
}

static void write_verdicts(FILE *out, const fg_subject *row) {
  static const char *const words[] = {"PASS", "FAIL", "SCAN AGAIN", "NO VERDICT"};
  static const char *const styles[] = {"pass", "fail", "again", "again"};
  for (int i = 0; i < 4; i++) {
    long long count = fg_query_get_integer(row->object, LOT_COUNTS + 1 + i);
    if (count) fprintf(out, "<span class=\"tag %s\">%lld %s</span> ", styles[i], count, words[i]);
  }
}

static const fg_member count_rows[] = {
    {FG_COUNT_BY("foils", find_foils), .label = "foils", .page = {.rank = 2, .heading = "Foils"}},
    {FG_TEXT_BY("verdicts", NULL), .markup = write_verdicts,
     .page = {.rank = 2, .heading = "Verdicts"}},
};
static const fg_members count_members = {count_rows, 2, .frame = "left rows"};

static void write_lot_link(FILE *out, const fg_subject *row) {
  const char *lot = fg_query_get_text(row->object, LOT_NAME);
  fputs("<a href=\"/history?lot=", out);
  write_encoded(out, lot);
  fputs("\">", out);
  write_lot_name(out, lot);
  fputs("</a>", out);
}

static void write_newest(FILE *out, const fg_subject *row) {
  fg_page_time(out, fg_query_get_integer(row->object, LOT_NEWEST));
}

static void write_close(FILE *out, const fg_subject *row) {
  write_link(out, "/lots?close=1&amp;lot=", fg_query_get_text(row->object, LOT_NAME), "Close …");
}

static const char *find_screen_class(const fg_subject *row) {
  (void)row;
  return "noprint";
}

static const fg_member open_rows[] = {
    {FG_TEXT_BY("lot", NULL), .markup = write_lot_link, .page = {.rank = 1, .heading = "Lot"}},
    {FG_SAME(&count_members)},
    {FG_TEXT_BY("newest", NULL), .markup = write_newest, .label = "newest",
     .page = {.rank = 3, .heading = "Newest"}},
    {FG_TEXT_BY("close", NULL), .markup = write_close, .look = find_screen_class,
     .page = {.rank = 3, .heading = ""}},
};
static const fg_members open_members = {open_rows, 4, .frame = "left rows"};

static void write_lot_row(FILE *out, const fg_member_columns *columns, const fg_query *query) {
  fg_html_table_row(out, columns, &(fg_subject){.object = query});
  fputs("</tr>\n", out);
}

/* Open lots, the newest first, LOTS_SHOWN on a page; the index of the lots alone finds them. */
static const char open_lots[] =
    "WITH newest AS (SELECT lot, max(id) AS last FROM foils WHERE lot NOT IN (SELECT name FROM "
    "lots)"
    " GROUP BY lot ORDER BY last DESC LIMIT ? OFFSET ?) SELECT f.lot, max(s.at), " COUNTS
    " FROM newest CROSS JOIN foils AS f ON f.lot = newest.lot JOIN scans AS s ON s.id = f.scan"
    " WHERE NOT " FG_LOT_REPLACED " GROUP BY f.lot ORDER BY newest.last DESC";

static fg_status write_open(fg_context *ctx, sqlite3 *reader, int64_t from, FILE *out) {
  fg_query query;
  fg_member_columns columns;
  int64_t count = 0;
  fg_member_columns_of(&open_members, FG_ON_PAGE, &(fg_subject){0}, &columns);
  fg_query_begin(reader, open_lots, &query);
  fg_query_integer(&query, LOTS_SHOWN + 1);
  fg_query_integer(&query, from);
  fputs("<section><h2 class=\"first\">Open lots</h2>\n", out);
  for (; fg_query_row(&query) && count <= LOTS_SHOWN; count++) {
    if (!count) fg_html_table_begin(out, &columns), fg_html_table_rows(out);
    if (count < LOTS_SHOWN) write_lot_row(out, &columns, &query);
  }
  if (count)
    fg_html_table_end(out);
  else
    fputs("<p>No lot is open.</p>\n", out);
  if (count > LOTS_SHOWN)
    fprintf(out, "<p class=\"noprint\"><a href=\"/lots?from=%lld\">Older</a></p>\n",
            (long long)from + LOTS_SHOWN);
  fputs("</section>\n", out);
  return fg_query_end(ctx, &query, "reading the open lots");
}

static void write_downloads(const fg_inspection *station, FILE *out, const char *lot) {
  static const char *const files[][2] = {{"foils.csv", "Foils (CSV)"},
                                         {"bumps.csv", "Bumps (CSV)"},
                                         {"results.qif", "QIF"},
                                         {"results.dfq", "DFQ"}};
  fputs("<form class=\"fields noprint\" method=\"post\" action=\"/download\">", out);
  fg_page_csrf_token(station, out);
  fputs("<input type=\"hidden\" name=\"lot\" value=\"", out);
  fg_html_text(out, lot);
  fputs("\">", out);
  for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    fprintf(out, "<button name=\"file\" value=\"%s\">%s</button>", files[i][0], files[i][1]);
  fputs("</form>", out);
}

enum { CLOSED_NAME, CLOSED_AT, CLOSED_BY, CLOSED_VERDICT, CLOSED_WITHHELD, CLOSED_SUMMARY };
enum { CLOSED_BEFORE = CLOSED_SUMMARY + 1, CLOSED_CHANGED };

static void write_closed_lot(const fg_inspection *station, FILE *out, const fg_query *row) {
  const char *lot = fg_query_get_text(row, CLOSED_NAME);
  const char *verdict = fg_query_get_text(row, CLOSED_VERDICT);
  long long before = fg_query_get_integer(row, CLOSED_BEFORE);
  bool withheld = fg_query_get_integer(row, CLOSED_WITHHELD) && strcmp(verdict, "fail") != 0;
  fprintf(out, "<li><span class=\"tag %s\">%s</span> <a href=\"/history?lot=",
          fg_page_verdict_class(verdict, withheld), fg_page_verdict_words(verdict, withheld));
  write_encoded(out, lot);
  fputs("\">", out);
  write_lot_name(out, lot);
  fputs("</a> ", out);
  write_link(out, "/lot?name=", lot, "Report");
  fputs("<span>", out);
  fg_html_text(out, fg_query_get_text(row, CLOSED_SUMMARY));
  fputs("</span><span class=\"note\">closed ", out);
  fg_page_time(out, fg_query_get_integer(row, CLOSED_AT));
  fputs(" by ", out);
  fg_html_name(out, fg_query_get_text(row, CLOSED_BY));
  if (before) fprintf(out, ", %lld time%s before", before, fg_plural((size_t)before));
  fputs("</span>", out);
  if (fg_query_get_integer(row, CLOSED_CHANGED)) {
    fputs("<b>Foils have come, gone or been corrected since.</b> ", out);
    write_link(out, "/lots?close=1&amp;lot=", lot, "Close again …");
  }
  write_downloads(station, out, lot);
  fputs("</li>\n", out);
}

static fg_status write_closed(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                              FILE *out) {
  fg_query query;
  size_t count = 0;
  fg_query_begin(
      reader,
      "SELECT l.name, l.closed_at, l.by, l.verdict, l.withheld, l.summary,"
      " (SELECT count(*) FROM lots AS e WHERE e.name = l.name) - 1,"
      " l.state <> " FG_LOT_STATE(
          "l.name") " FROM lots AS l"
                    " WHERE l.id = (SELECT max(e.id) FROM lots AS e WHERE e.name = l.name)"
                    " ORDER BY l.id DESC LIMIT ?",
      &query);
  fg_query_integer(&query, LOTS_SHOWN);
  while (fg_query_row(&query)) {
    if (!count++)
      fputs("<section><h2 class=\"first\">Closed lots</h2>\n<ul class=\"cards\">\n", out);
    write_closed_lot(station, out, &query);
  }
  if (count) fputs("</ul></section>\n", out);
  return fg_query_end(ctx, &query, "reading the closed lots");
}

/* Lists faults of files that gave no scan; their lot is unknown. */
static fg_status write_refused(fg_context *ctx, sqlite3 *reader, FILE *out) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT count(*) FROM arrivals WHERE superseded = 0"
                 " AND kind IN ('unfinished', 'unreadable')",
                 &query);
  long long count = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  if (count)
    fprintf(out,
            "<p>%lld file%s of the folder could not be read or measured and %s in no lot: see "
            "<a href=\"/\">Now</a>.</p>\n",
            count, count == 1 ? "" : "s", count == 1 ? "is" : "are");
  return fg_query_end(ctx, &query, "reading the cards");
}

static fg_status write_question(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                const char *lot, FILE *out) {
  fg_query query;
  int64_t open;
  fg_member_columns columns;
  fg_member_columns_of(&count_members, FG_ON_PAGE, &(fg_subject){0}, &columns);
  fg_query_begin(reader,
                 "SELECT f.lot, max(s.at), " COUNTS
                 " FROM foils AS f JOIN scans AS s ON s.id = f.scan"
                 " WHERE f.lot = ? AND NOT " FG_LOT_REPLACED,
                 &query);
  fg_query_text(&query, lot);
  fputs("<section><h2 class=\"first\">Close this lot? ", out);
  write_lot_name(out, lot);
  fputs("</h2>\n", out);
  fg_html_table_begin(out, &columns);
  fg_html_table_rows(out);
  if (fg_query_row(&query)) write_lot_row(out, &columns, &query);
  fg_html_table_end(out);
  fputs("<p>Its report is written into the folder lots of the station. "
        "Foils can be corrected, and the lot closed again, later.</p>\n",
        out);
  FG_TRY(fg_query_end(ctx, &query, "reading the lot"));
  FG_TRY(write_refused(ctx, reader, out));
  FG_TRY(fg_disposition_count_open(ctx, reader, lot, &open));
  fputs("<form class=\"fields\" method=\"post\" action=\"/close\">", out);
  fg_page_csrf_token(station, out);
  fputs("<input type=\"hidden\" name=\"lot\" value=\"", out);
  fg_html_text(out, lot);
  fputs("\">", out);
  if (open)
    fprintf(out,
            "<label class=\"tick\"><input type=\"checkbox\" name=\"open\" value=\"%lld\" required> "
            "with %lld foil%s without disposition</label>",
            (long long)open, (long long)open, fg_plural((size_t)open));
  fputs("<label>Closed by<input name=\"by\" maxlength=\"127\" autocomplete=\"off\" required "
        "data-focus></label><button>Close the lot</button> <a href=\"/lots\">Not yet</a></form>\n"
        "</section>\n",
        out);
  return FG_OK;
}

/* Writes the lot that is being closed, or the failure of the last. */
static void write_closing(fg_inspection *station, FILE *out) {
  fg_closing *closing = &station->closing;
  pthread_mutex_lock(&closing->mutex);
  if (closing->running)
    fputs("<p class=\"banner\" role=\"status\" data-live>The lot ", out);
  else if (closing->error[0])
    fputs("<p class=\"banner\" role=\"alert\">The lot ", out);
  if (closing->running || closing->error[0]) {
    write_lot_name(out, closing->lot);
    fputs(closing->running ? " is being closed." : " could not be closed: ", out);
    if (!closing->running) fg_html_text(out, closing->error);
    fputs("</p>\n", out);
  }
  pthread_mutex_unlock(&closing->mutex);
}

fg_status fg_page_lots(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                       const fg_request *request, FILE *out) {
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_LOTS, "Lots"));
  fg_page_heading(out, "Lots");
  write_closing(station, out);
  if (fg_request_get(request, "close")[0])
    FG_TRY(write_question(ctx, station, reader, fg_request_get(request, "lot"), out));
  long from = strtol(fg_request_get(request, "from"), NULL, 10);
  FG_TRY(write_open(ctx, reader, from > 0 && from < LOTS_MAX ? from : 0, out));
  FG_TRY(write_closed(ctx, station, reader, out));
  fg_page_end(out);
  return FG_OK;
}
