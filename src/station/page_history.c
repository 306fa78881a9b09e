/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every foil that was measured, the newest first: found by serial number, lot, die, date, verdict.
 */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "page/page.h"
#include "station/disposition.h"
#include "station/outbox/part.h"
#include "station/pages.h"
#include "station/values.h"

/* PAGE_FOILS: foils on one sheet of paper. SUGGESTED: lots and dies that a field proposes, of the
 * newest 5000 foils. */
enum { PAGE_FOILS = 40, PAGES_MAX = 1000000, SUGGESTED = 200, WHERE_BYTES = 2048 };

static const struct {
  const char *word, *name;
} verdicts[] = {
    {"pass", "PASS"},
    {"fail", "FAIL"},
    {"cannot_tell", "SCAN AGAIN: cannot tell"},
    {"not_measured", "SCAN AGAIN: not measured"},
    {"no_tolerance", "MEASURED"},
    {"open", "without disposition"},
};

enum { VERDICTS = sizeof verdicts / sizeof *verdicts };

/* A search. Texts belong to the request. */
typedef struct search {
  const char *serial, *lot, *die, *from, *to, *verdict;
  int64_t from_ms, to_ms; /* -1: open */
  bool open;              /* foils without disposition alone */
  long page;              /* from 1 */
  char where[WHERE_BYTES];
} search;

/* The beginning of a day of the local calendar, `days` later; -1: no date. */
static int64_t read_day(const char *text, int days) {
  int year, month, day, length = 0;
  if (strspn(text, "0123456789-") != 10 ||
      sscanf(text, "%4d-%2d-%2d%n", &year, &month, &day, &length) != 3 || text[length])
    return -1;
  if (year < 1970 || month < 1 || month > 12 || day < 1 || day > 31) return -1;
  struct tm local = {
      .tm_year = year - 1900, .tm_mon = month - 1, .tm_mday = day + days, .tm_isdst = -1};
  time_t at = mktime(&local);
  return at < 0 ? -1 : (int64_t)at * 1000;
}

static void add_condition(search *at, const char *condition) {
  size_t length = strlen(at->where);
  snprintf(at->where + length, sizeof at->where - length, "%s%s", length ? " AND " : " WHERE ",
           condition);
}

static bool is_verdict(const char *word) {
  for (size_t i = 0; i < VERDICTS; i++)
    if (!strcmp(verdicts[i].word, word)) return true;
  return false;
}

/* Reads the search. Invalid parameters are ignored. */
static void read_search(const fg_request *request, search *at) {
  char *end;
  *at = (search){.serial = fg_request_get(request, "serial"),
                 .lot = fg_request_get(request, "lot"),
                 .die = fg_request_get(request, "die"),
                 .from = fg_request_get(request, "from"),
                 .to = fg_request_get(request, "to"),
                 .verdict = fg_request_get(request, "verdict"),
                 .page = strtol(fg_request_get(request, "page"), &end, 10)};
  at->from_ms = read_day(at->from, 0);
  at->to_ms = read_day(at->to, 1);
  if (*end || at->page < 1 || at->page > PAGES_MAX) at->page = 1;
  if (!is_verdict(at->verdict)) at->verdict = "";
  if (at->serial[0]) add_condition(at, "instr(lower(serial), lower(?))");
  if (at->lot[0]) add_condition(at, "lot = ? COLLATE NOCASE");
  if (at->die[0]) add_condition(at, "die = ? COLLATE NOCASE");
  if (at->from_ms >= 0) add_condition(at, "at >= ?");
  if (at->to_ms >= 0) add_condition(at, "at < ?");
  at->open = !strcmp(at->verdict, "open");
  if (at->verdict[0]) add_condition(at, at->open ? FG_FOIL_IS_OPEN : "foils.verdict = ?");
}

/* The values of the conditions, in their order. */
static void bind(const search *at, fg_query *query) {
  if (at->serial[0]) fg_query_text(query, at->serial);
  if (at->lot[0]) fg_query_text(query, at->lot);
  if (at->die[0]) fg_query_text(query, at->die);
  if (at->from_ms >= 0) fg_query_integer(query, at->from_ms);
  if (at->to_ms >= 0) fg_query_integer(query, at->to_ms);
  if (at->verdict[0] && !at->open) fg_query_text(query, at->verdict);
}

static fg_status count_found(fg_context *ctx, sqlite3 *reader, const search *at, int64_t *count) {
  fg_query query;
  char sql[WHERE_BYTES + 200];
  bool timed = at->from_ms >= 0 || at->to_ms >= 0; /* times are those of scans */
  snprintf(sql, sizeof sql, "SELECT count(*) FROM foils%s%s",
           timed ? " JOIN scans ON scans.id = scan" : "", at->where);
  fg_query_begin(reader, sql, &query);
  bind(at, &query);
  *count = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "searching foils");
}

static void write_input(FILE *out, const char *label, const char *name, const char *more,
                        const char *value) {
  fprintf(out, "<label>%s<input name=\"%s\"%s value=\"", label, name, more);
  fg_html_text(out, value);
  fputs("\"></label>", out);
}

/* Writes the existing values, newest first, as proposals of a field. */
static fg_status write_suggestions(fg_context *ctx, sqlite3 *reader, const char *id,
                                   const char *sql, FILE *out) {
  fg_query query;
  fg_query_begin(reader, sql, &query);
  fg_query_integer(&query, SUGGESTED);
  fprintf(out, "<datalist id=\"%s\">", id);
  while (fg_query_row(&query)) {
    fputs("<option value=\"", out);
    fg_html_text(out, fg_query_get_text(&query, 0));
    fputs("\">", out);
  }
  fputs("</datalist>\n", out);
  return fg_query_end(ctx, &query, "reading the lots");
}

static fg_status write_search_html_form(fg_context *ctx, sqlite3 *reader, const search *at,
                                        FILE *out) {
  fputs("<form class=\"fields\" method=\"get\" action=\"/history\">", out);
  write_input(out, "Serial", "serial",
              " type=\"search\" maxlength=\"127\" autocomplete=\"off\" autofocus data-focus",
              at->serial);
  write_input(out, "Lot", "lot", " maxlength=\"127\" autocomplete=\"off\" list=\"lots\"", at->lot);
  write_input(out, "Die", "die", " maxlength=\"127\" autocomplete=\"off\" list=\"dies\"", at->die);
  write_input(out, "From", "from", " type=\"date\"", at->from_ms >= 0 ? at->from : "");
  write_input(out, "To", "to", " type=\"date\"", at->to_ms >= 0 ? at->to : "");
  fputs("<label>Verdict<select name=\"verdict\"><option value=\"\">any</option>", out);
  for (size_t i = 0; i < VERDICTS; i++)
    fprintf(out, "<option value=\"%s\"%s>%s</option>", verdicts[i].word,
            strcmp(verdicts[i].word, at->verdict) ? "" : " selected", verdicts[i].name);
  fputs("</select></label><button>Search</button><a href=\"/history\">All</a></form>\n", out);
  FG_TRY(write_suggestions(ctx, reader, "lots",
                           "SELECT lot FROM (SELECT id, lot FROM foils ORDER BY id DESC LIMIT 5000)"
                           " WHERE lot <> '' GROUP BY lot ORDER BY max(id) DESC LIMIT ?",
                           out));
  return write_suggestions(ctx, reader, "dies",
                           "SELECT die FROM (SELECT id, die FROM foils ORDER BY id DESC LIMIT 5000)"
                           " WHERE die <> '' GROUP BY die ORDER BY max(id) DESC LIMIT ?",
                           out);
}

static void write_found_cell(FILE *out, const char *style, const char *name, const char *text) {
  fprintf(out, "<td class=\"text%s\"", style);
  if (text[0]) fprintf(out, " data-name=\"%s\"", name);
  fputc('>', out);
  fg_html_name(out, text);
  fputs("</td>", out);
}

static void write_found_row(const fg_query *at, FILE *out) {
  long long id = (long long)fg_query_get_integer(at, 0);
  const char *verdict = fg_query_get_text(at, 6);
  bool withheld = !fg_query_is_null(at, 7);
  fprintf(out, "<tr><td><a href=\"/foil?id=%lld\">", id);
  fg_html_name(out, fg_query_get_text(at, 1));
  fprintf(out, "</a></td><td><span class=\"tag %s\">%s</span></td><td>",
          fg_page_verdict_class(verdict, withheld), fg_page_verdict_words(verdict, withheld));
  fg_page_time(out, fg_query_get_integer(at, 5));
  fputs("</td>", out);
  write_found_cell(out, "", "lot", fg_query_get_text(at, 2));
  write_found_cell(out, "", "die", fg_query_get_text(at, 3));
  write_found_cell(out, " wide", "operator", fg_query_get_text(at, 4));
  fputs("<td class=\"wide\">", out);
  if (!fg_query_is_null(at, 9)) fg_page_decided_line(at, 9, out);
  fputs("</td></tr>\n", out);
}

static fg_status write_rows(fg_context *ctx, sqlite3 *reader, const search *at, FILE *out) {
  fg_query query;
  char sql[WHERE_BYTES + 800];
  snprintf(sql, sizeof sql,
           "SELECT foils.id, serial, lot, die, operator, at, foils.verdict, withheld, reasons,"
           " quantities.name, owner, unit, bump, value, u, lower, upper, deciding.verdict"
           " FROM foils JOIN scans ON scans.id = scan"
           " LEFT JOIN deciding ON deciding.foil = foils.id AND rank = 0"
           " LEFT JOIN quantities ON quantities.id = quantity%s"
           " ORDER BY foils.id DESC LIMIT ? OFFSET ?",
           at->where);
  fg_query_begin(reader, sql, &query);
  bind(at, &query);
  fg_query_integer(&query, PAGE_FOILS);
  fg_query_integer(&query, (at->page - 1) * PAGE_FOILS);
  fputs(
      "<div class=\"scroll\"><table class=\"left rows found\"><thead><tr><th>Serial</th><th>Verdict"
      "</th><th>When</th><th>Lot</th><th>Die</th><th class=\"wide\">Operator</th>"
      "<th class=\"wide\">Nearest its limit</th></tr></thead>\n<tbody>\n",
      out);
  while (fg_query_row(&query))
    write_found_row(&query, out);
  fputs("</tbody></table></div>\n", out);
  return fg_query_end(ctx, &query, "searching foils");
}

static void write_search_fields(const search *at, FILE *out) {
  fg_page_parameter(out, "serial", at->serial);
  fg_page_parameter(out, "lot", at->lot);
  fg_page_parameter(out, "die", at->die);
  fg_page_parameter(out, "from", at->from_ms >= 0 ? at->from : "");
  fg_page_parameter(out, "to", at->to_ms >= 0 ? at->to : "");
  fg_page_parameter(out, "verdict", at->verdict);
}

static void write_link(const search *at, long page, const char *relation, const char *words,
                       FILE *out) {
  fprintf(out, "<a class=\"button\" rel=\"%s\" href=\"/history?", relation);
  write_search_fields(at, out);
  fprintf(out, "page=%ld\">%s</a>", page, words);
}

static void write_paging(const search *at, int64_t found, FILE *out) {
  long pages = (long)((found + PAGE_FOILS - 1) / PAGE_FOILS);
  fprintf(out, "<p class=\"paging\">");
  if (at->page > 1 && at->page <= pages) write_link(at, at->page - 1, "prev", "← Newer", out);
  if (pages > 1)
    fprintf(out, "<span>page %ld of %ld</span>", at->page < pages ? at->page : pages, pages);
  if (at->page < pages) write_link(at, at->page + 1, "next", "Older →", out);
  fputs("</p>\n", out);
}

/* Files of all foils of a search. */
static const struct {
  const char *path, *words;
  fg_part_format format;
} files[] = {
    {"/found/foils.csv", "CSV of foils", FG_PART_CSV},
    {"/found/bumps.csv", "CSV of bumps", FG_PART_BUMPS_CSV},
    {"/found/results.dfq", "DFQ", FG_PART_DFQ},
    {"/found/results.qif", "QIF", FG_PART_QIF},
};
enum { FILES = sizeof files / sizeof *files, FOUND_MAX = 2000 };

static void write_file_links(const search *at, FILE *out) {
  fputs("<p class=\"paging noprint\">", out);
  for (size_t i = 0; i < FILES; i++) {
    fprintf(out, "<a class=\"button plain\" download href=\"%s?", files[i].path);
    write_search_fields(at, out);
    fprintf(out, "page=1\">%s</a>", files[i].words);
  }
  fputs("</p>\n", out);
}

static fg_status load_found(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                            const search *at, fg_part **parts, size_t *count) {
  fg_query query;
  char sql[WHERE_BYTES + 200], name[FG_PART_NAME];
  fg_status status = FG_OK;
  fg_part_station_name(station->request, name);
  snprintf(sql, sizeof sql,
           "SELECT foils.id FROM foils JOIN scans ON scans.id = scan%s ORDER BY foils.id LIMIT ?",
           at->where);
  fg_query_begin(reader, sql, &query);
  bind(at, &query);
  fg_query_integer(&query, FOUND_MAX);
  while (status == FG_OK && fg_query_row(&query)) {
    status = fg_part_load_foil(ctx, reader, name, fg_query_get_integer(&query, 0), &parts[*count]);
    *count += status == FG_OK;
  }
  fg_status ended = fg_query_end(status == FG_OK ? ctx : NULL, &query, "searching foils");
  return status == FG_OK ? ended : status;
}

static fg_status write_found_file(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                  const search *at, fg_part_format format, FILE *out) {
  void *block;
  size_t count = 0, size;
  char *body;
  FG_TRY(fg_memory_allocate(ctx, FOUND_MAX, sizeof(fg_part *), &block));
  fg_part **parts = block;
  fg_status status = load_found(ctx, station, reader, at, parts, &count);
  if (status == FG_OK)
    status =
        fg_parts_format(ctx, parts, count, format, station->request->decimal_comma, &body, &size);
  if (status == FG_OK) {
    fwrite(body, 1, size, out);
    free(body);
  }
  while (count)
    fg_part_free(parts[--count]);
  free(parts);
  return status;
}

static fg_status write_found(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                             const fg_request *request, FILE *out) {
  search at;
  int64_t found;
  size_t i = 0;
  while (i + 1 < FILES && strcmp(request->path, files[i].path) != 0)
    i++;
  read_search(request, &at);
  FG_TRY(count_found(ctx, reader, &at, &found));
  if (!found) return fg_fail(ctx, FG_ERR_DATA, "No foil is found: there is nothing to write.");
  if (found > FOUND_MAX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%lld foils are found, and a file takes at most %d: search for fewer, or close "
                   "their lots.",
                   (long long)found, FOUND_MAX);
  return write_found_file(ctx, station, reader, &at, files[i].format, out);
}

/* Reads by a connection of its own: many foils take seconds. */
fg_status fg_page_found(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                        const fg_request *request, FILE *out) {
  sqlite3 *own;
  (void)reader;
  FG_TRY(fg_station_database_open_reader(ctx, station->database.path, &own));
  fg_status status = write_found(ctx, station, own, request, out);
  fg_sql_close(own);
  return status;
}

fg_status fg_page_history(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                          const fg_request *request, FILE *out) {
  search at;
  int64_t found;
  read_search(request, &at);
  FG_TRY(count_found(ctx, reader, &at, &found));
  long pages = (long)((found + PAGE_FOILS - 1) / PAGE_FOILS);
  if (at.page > pages) at.page = pages > 0 ? pages : 1;
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, "History"));
  fg_page_heading(out, "History");
  fputs("<section>\n", out);
  FG_TRY(write_search_html_form(ctx, reader, &at, out));
  fprintf(out, "<p class=\"note\">%lld %s%s</p>\n", (long long)found, found == 1 ? "foil" : "foils",
          at.where[0] ? " found" : "");
  if (found) FG_TRY(write_rows(ctx, reader, &at, out));
  write_paging(&at, found, out);
  if (found) write_file_links(&at, out);
  fputs("</section>\n", out);
  fg_page_end(out);
  return FG_OK;
}
