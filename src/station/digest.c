/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/digest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/date.h"
#include "core/file.h"
#include "core/text.h"
#include "foilgauge/version.h"
#include "page/page.h"
#include "station/cause_keep.h"
#include "station/cause_thread.h"
#include "station/trend.h"

enum {
  NEWEST_POINTS = 200,
  RUNS_SHOWN = 3,
  MS_OF_DAY = 86400000,
  MS_OF_HOUR = 3600000,
  LINE = 2400
};

typedef struct digest {
  const fg_station_request *request;
  fg_inspection station; /* for trends: settings and request alone */
  sqlite3 *reader;
  char *path;
  FILE *text, *page;
  bool in_list;
  int64_t until; /* time of the newest scan: the last day ends with it */
} digest;

/* Binds the last day. Scans of a later time came before the clock was set back; by up to an hour
 * they count. */
static void bind_day(const digest *d, fg_query *query) {
  fg_query_integer(query, d->until - MS_OF_DAY);
  fg_query_integer(query, d->until + MS_OF_HOUR);
}

static void end_list(digest *d) {
  if (d->page && d->in_list) fputs("</ul>\n", d->page);
  d->in_list = false;
}

static void write_heading(digest *d, const char *words) {
  end_list(d);
  fprintf(d->text, "\n%s\n", words);
  if (!d->page) return;
  fputs("<h2>", d->page);
  fg_html_text(d->page, words);
  fputs("</h2>\n", d->page);
}

/* A line, whose words are text without markup. */
static void write_item(digest *d, const char *words) {
  fprintf(d->text, "  %s\n", words);
  if (!d->page) return;
  fputs(d->in_list ? "<li>" : "<ul>\n<li>", d->page);
  fg_html_text(d->page, words);
  fputs("</li>\n", d->page);
  d->in_list = true;
}

static fg_status write_counts(fg_context *ctx, digest *d) {
  fg_query query;
  char line[LINE] = "", day[FG_DATE_TEXT];
  size_t total = 0;
  fg_query_begin(d->reader,
                 "SELECT foils.verdict, count(*) FROM foils JOIN scans ON scans.id = scan WHERE at"
                 " > ? AND at <= ? GROUP BY 1 ORDER BY 2 DESC",
                 &query);
  bind_day(d, &query);
  while (fg_query_row(&query)) {
    size_t length = strlen(line);
    fg_text_clip(line + length, sizeof line - length, "%s%lld %s", length ? ", " : "",
                 (long long)fg_query_get_integer(&query, 1), fg_query_get_text(&query, 0));
    total += (size_t)fg_query_get_integer(&query, 1);
  }
  for (char *at = line; *at; at++)
    if (*at == '_') *at = ' ';
  FG_TRY(fg_query_end(ctx, &query, "counting the foils"));
  fg_date_format(fg_cause_days(d->until), day);
  char words[LINE + 100];
  fg_text_clip(words, sizeof words, "The 24 hours until %s: %zu foil%s%s%s", day, total,
               fg_plural(total), total ? ": " : "", line);
  write_item(d, words);
  return FG_OK;
}

/* Levels that foils had for the first time in the last day. */
static fg_status write_new_levels(fg_context *ctx, digest *d) {
  static const char *const columns[] = {"die", "coil", "oven", "operator", "scanner", "lot"};
  for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
    fg_query query;
    char *sql = NULL, line[LINE];
    FG_TRY(fg_text_print(ctx, &sql,
                         "SELECT %s, min(at), serial FROM foils JOIN scans ON scans.id = scan WHERE"
                         " %s <> '' GROUP BY 1 HAVING min(at) > ? AND min(at) <= ? ORDER BY 2",
                         columns[c], columns[c]));
    fg_query_begin(d->reader, sql, &query);
    free(sql);
    bind_day(d, &query);
    while (fg_query_row(&query)) {
      char day[FG_DATE_TEXT];
      fg_date_format(fg_cause_days(fg_query_get_integer(&query, 1)), day);
      fg_text_clip(line, sizeof line, "New %s: %.120s, since foil %.120s (%s)", columns[c],
                   fg_query_get_text(&query, 0), fg_query_get_text(&query, 2), day);
      write_item(d, line);
    }
    FG_TRY(fg_query_end(ctx, &query, "reading the columns"));
  }
  return FG_OK;
}

static fg_status write_signals(fg_context *ctx, digest *d, const fg_trend_choice *choice) {
  fg_trend trend;
  fg_trend_run runs[FG_TREND_RUNS];
  FG_TRY(fg_trend_read(ctx, &d->station, d->reader, choice, &trend));
  size_t all = 0, count = trend.quantity.has_chart ? fg_trend_runs(&trend, runs, &all) : 0;
  char line[LINE], name[200];
  if (!count) write_item(d, "No signal in the newest 200 foils.");
  for (size_t i = 0; i < count && i < RUNS_SHOWN; i++) {
    fg_trend_name(d->reader, &trend, runs[i].first, name, sizeof name);
    fg_text_clip(line, sizeof line, "Signal: %s, from foil %s on", fg_run_rule_words(runs[i].rule),
                 name);
    write_item(d, line);
  }
  if (all > RUNS_SHOWN) {
    fg_text_clip(line, sizeof line, "and %zu earlier signals", all - RUNS_SHOWN);
    write_item(d, line);
  }
  fg_trend_free(&trend);
  return FG_OK;
}

static void write_labelled(digest *d, const char *label, const char *words) {
  char line[LINE];
  if (!words[0]) return;
  fg_text_clip(line, sizeof line, "%s %s", label, words);
  write_item(d, line);
}

/* A sentence as plain text. */
static char *format_cause(const fg_cause *cause, const fg_quantity *row, double mean) {
  char *text = NULL;
  size_t size;
  FILE *out = fg_stream_open(&text, &size);
  if (!out) return NULL;
  fg_cause_write_text(out, cause, row, mean);
  fg_stream_keep(out, &text);
  return text;
}

static void write_cause_report(digest *d, const fg_trend_choice *choice,
                               const fg_cause_report *report) {
  char line[LINE];
  for (size_t k = 0; k < report->causes; k++) {
    char *text = format_cause(&report->cause[k], choice->row, report->mean);
    write_labelled(d, "Found:", text ? text : "");
    free(text);
  }
  if (!report->causes) write_item(d, "Found: no column explains the values beyond chance.");
  write_labelled(d, "Suspected:", report->suspected);
  write_labelled(d, "Not explained:", report->unexplained);
  if (report->causes)
    fg_text_clip(line, sizeof line,
                 "Scatter of %zu foils: %.4g %s, without these causes %.4g; searched in %.1f s",
                 report->foils, report->before, choice->row->unit, report->after, report->seconds);
  else
    fg_text_clip(line, sizeof line, "Scatter of %zu foils: %.4g %s; searched in %.1f s",
                 report->foils, report->before, choice->row->unit, report->seconds);
  write_item(d, line);
}

static fg_status write_accepted_causes(fg_context *ctx, digest *d, const fg_trend_choice *choice) {
  fg_cause *causes;
  size_t count;
  FG_TRY(fg_causes_read(ctx, d->reader, choice, &causes, &count));
  for (size_t k = 0; k < count; k++)
    write_labelled(d, "Accepted before:", causes[k].words_of);
  fg_causes_free(causes, count);
  return FG_OK;
}

static fg_status write_quantity(fg_context *ctx, digest *d, const fg_trend_choice *choice) {
  fg_cause_report report;
  fg_context inner = {.message = ""};
  char title[200];
  fg_text_clip(title, sizeof title, "%s%s%s", choice->row->words, choice->row->unit[0] ? ", " : "",
               choice->row->unit);
  write_heading(d, title);
  FG_TRY(write_signals(ctx, d, choice));
  FG_TRY(write_accepted_causes(ctx, d, choice));
  fg_status status = fg_cause_search_database(&inner, d->request, d->path, choice, &report);
  if (status == FG_ERR_DATA) {
    write_labelled(d, "Not searched:", inner.message);
    return FG_OK;
  }
  if (status != FG_OK) return fg_fail(ctx, status, "%s", inner.message);
  write_cause_report(d, choice, &report);
  fg_cause_report_free(&report);
  return FG_OK;
}

static fg_status write_quantities_of_design(fg_context *ctx, digest *d) {
  const fg_design *design = &d->request->settings->lot.design;
  size_t written = 0;
  for (size_t i = 0; i < design->tolerance_count; i++) {
    fg_trend_choice choice;
    if (!fg_trend_choose_named(design->tolerances[i].quantity, NEWEST_POINTS, &choice)) continue;
    FG_TRY(write_quantity(ctx, d, &choice));
    written++;
  }
  if (written) return FG_OK;
  fg_trend_choice choice;
  fg_trend_choose_named("radius_mm", NEWEST_POINTS, &choice);
  return write_quantity(ctx, d, &choice);
}

/* The newest scan is the last that came, whatever the clock said before. */
static fg_status find_newest(fg_context *ctx, digest *d) {
  fg_query query;
  fg_query_begin(d->reader, "SELECT at FROM scans ORDER BY id DESC LIMIT 1", &query);
  d->until = fg_query_row(&query) ? fg_query_get_integer(&query, 0) : 0;
  return fg_query_end(ctx, &query, "reading the scans");
}

static fg_status write_digest(fg_context *ctx, digest *d) {
  FG_TRY(find_newest(ctx, d));
  fprintf(d->text, "foilgauge station: what changed, what is suspected, what was found\n");
  write_heading(d, "What changed");
  FG_TRY(write_counts(ctx, d));
  FG_TRY(write_new_levels(ctx, d));
  FG_TRY(write_quantities_of_design(ctx, d));
  end_list(d);
  return FG_OK;
}

fg_status fg_station_digest(fg_context *ctx, const fg_station_request *request, FILE *text,
                            FILE *page) {
  digest *d = calloc(1, sizeof *d);
  if (!d) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a digest");
  d->request = d->station.request = request;
  d->station.settings = request->settings;
  d->text = text;
  d->page = page;
  fg_status status = fg_text_print(ctx, &d->path, "%s/%s", request->folder, FG_STATION_DATABASE);
  if (status == FG_OK) status = fg_station_database_check(ctx, d->path);
  if (status == FG_OK) status = fg_station_database_open_reader(ctx, d->path, &d->reader);
  if (page) {
    fg_html_begin(page, "What changed at the station");
    fputs("<h1>What changed, what is suspected, what was found</h1>\n", page);
  }
  if (status == FG_OK) status = write_digest(ctx, d);
  if (page) fg_html_end(page);
  fg_sql_close(d->reader);
  free(d->path);
  free(d);
  return status;
}
