/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Why a quantity has moved: what the search for causes found, and the chart without it. */
#include <math.h>
#include <string.h>

#include "page/page.h"
#include "page/tile.h"
#include "station/cause_keep.h"
#include "station/cause_thread.h"
#include "station/trend.h"

#define P_SHOWN 1e-12

typedef struct why_page {
  fg_inspection *station;
  sqlite3 *reader;
  const fg_trend_choice *choice;
  const fg_cause_thread *search;
  FILE *out;
} why_page;

static bool is_of_choice(const fg_cause_thread *search, const fg_trend_choice *choice) {
  return search->choice.row == choice->row && search->choice.owner == choice->owner &&
         search->choice.bump == choice->bump && !strcmp(search->choice.lot, choice->lot) &&
         !strcmp(search->choice.die, choice->die);
}

static void write_acceptance(const why_page *p, size_t k) {
  const fg_cause *cause = &p->search->report.cause[k];
  fputs("<form class=\"fields\" method=\"post\" action=\"/accept\">", p->out);
  fg_page_csrf_token(p->station, p->out);
  fg_trend_write_hidden(p->out, p->choice);
  fprintf(p->out,
          "<input type=\"hidden\" name=\"cause\" value=\"%zu\"><input type=\"hidden\" "
          "name=\"words\" value=\"",
          k);
  fg_html_text(p->out, cause->words_of);
  fputs("\"><label>Why<input name=\"note\" maxlength=\"200\" autocomplete=\"off\"></label>"
        "<label>Accepted by<input name=\"by\" maxlength=\"127\" autocomplete=\"off\" required>"
        "</label><button>Accept as cause</button></form>",
        p->out);
}

static void write_found(const why_page *p) {
  const fg_cause_report *report = &p->search->report;
  if (!report->causes) {
    fputs("<p class=\"next\">No column explains the values beyond chance.</p>\n", p->out);
    return;
  }
  fputs("<ol class=\"runs found\">", p->out);
  for (size_t k = 0; k < report->causes; k++) {
    fputs("<li>", p->out);
    fg_cause_write(p->out, &report->cause[k], p->choice->row, report->mean);
    if (report->cause[k].p_value < P_SHOWN)
      fputs(" <small>(p &lt; 10⁻¹²)</small>", p->out);
    else
      fprintf(p->out, " <small>(p = %.1e)</small>", report->cause[k].p_value);
    write_acceptance(p, k);
    fputs("</li>\n", p->out);
  }
  fputs("</ol>\n", p->out);
}

static void write_error_tile(FILE *out, const char *title, double value, const fg_quantity *row,
                             const char *small) {
  fg_html_tile(out, &(fg_tile){.title = title,
                               .value = value,
                               .unit = row->unit[0] ? row->unit : NULL,
                               .digits = 3,
                               .small = small});
}

static void write_errors(const why_page *p) {
  const fg_cause_report *report = &p->search->report;
  const fg_quantity *row = p->choice->row;
  fputs("<dl class=\"tiles\">", p->out);
  write_error_tile(p->out, "Scatter of foils before", report->before, row, "standard deviation");
  write_error_tile(p->out, "after", report->after, row, "with these causes taken out");
  if (isfinite(report->cv_before) && report->causes) {
    write_error_tile(p->out, "Prediction error before", report->cv_before, row,
                     report->days < 20 ? "of foils left out in turn" : "of days left out in turn");
    write_error_tile(p->out, "after", report->cv_after, row, "with these causes");
  }
  fputs("</dl>\n", p->out);
}

static void write_line(FILE *out, const char *label, const char *words) {
  if (!words[0]) return;
  fprintf(out, "<p class=\"next\"><b>%s</b> ", label);
  fg_html_text(out, words);
  fputs("</p>\n", out);
}

static fg_status write_chart_of(fg_context *ctx, const why_page *p, bool taken_out) {
  fg_trend trend;
  fg_trend_choice choice = *p->choice;
  const fg_cause_report *report = &p->search->report;
  choice.newest = 0;
  choice.taken_out = taken_out;
  choice.found = taken_out ? report->cause : NULL;
  choice.found_count = taken_out ? report->causes : 0;
  FG_TRY(fg_trend_read(ctx, p->station, p->reader, &choice, &trend));
  if (trend.quantity.has_chart) {
    fprintf(p->out, "<h2>%s</h2>\n", taken_out ? "With the causes taken out" : "As measured");
    for (int narrow = 0; narrow < 2; narrow++)
      fg_trend_plot(p->out, p->reader, &trend, NULL, 0, narrow);
    fprintf(p->out, "<p class=\"note\">%zu signal%s in %zu foils.</p>\n",
            trend.quantity.chart.signals, trend.quantity.chart.signals == 1 ? "" : "s",
            trend.count);
  }
  fg_trend_free(&trend);
  return FG_OK;
}

static fg_status write_result(fg_context *ctx, const why_page *p) {
  const fg_cause_report *report = &p->search->report;
  fprintf(p->out,
          "<p class=\"note\">%zu foils of %zu day%s and %zu lot%s; searched in %.1f s, until ",
          report->foils, report->days, report->days == 1 ? "" : "s", report->lots,
          report->lots == 1 ? "" : "s", report->seconds);
  fg_page_time_zoned(p->out, p->search->at);
  fputs(".</p>\n", p->out);
  write_found(p);
  write_errors(p);
  write_line(p->out, "Suspected, not proven:", report->suspected);
  write_line(p->out, "Not explained:", report->unexplained);
  write_line(p->out, "Left out:", report->note);
  FG_TRY(write_chart_of(ctx, p, false));
  if (report->causes) FG_TRY(write_chart_of(ctx, p, true));
  return FG_OK;
}

static void write_ask(const why_page *p, const char *words) {
  fputs("<form class=\"fields\" method=\"post\" action=\"/why\">", p->out);
  fg_page_csrf_token(p->station, p->out);
  fg_trend_write_hidden(p->out, p->choice);
  fprintf(p->out, "<button>%s</button></form>\n", words);
}

static fg_status write_why(fg_context *ctx, const why_page *p) {
  fputs("<h1>Why? ", p->out);
  fg_html_text(p->out, p->choice->row->words);
  fputs("</h1>\n<p><a href=\"", p->out);
  fg_trend_write_query(p->out, "/trends", p->choice);
  fputs("\">« Trends</a></p>\n", p->out);
  bool ours = is_of_choice(p->search, p->choice);
  if (p->search->running && ours) {
    fputs("<p class=\"next\" data-live role=\"status\">Searching for causes. The answer comes by "
          "itself.</p>\n",
          p->out);
    return FG_OK;
  }
  if (ours && p->search->error[0])
    write_line(p->out, "No answer:", p->search->error);
  else if (ours && p->search->at)
    FG_TRY(write_result(ctx, p));
  if (!ours || !p->search->at)
    fputs(
        "<p class=\"note\">Searches die, coil, oven, operator, scanner, program and time for what "
        "moved this quantity.</p>\n",
        p->out);
  write_ask(p, ours && p->search->at ? "Search again" : "Why?");
  return FG_OK;
}

fg_status fg_page_why(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                      const fg_request *request, FILE *out) {
  fg_trend_choice choice;
  FG_TRY(fg_trend_choose(ctx, station, request, &choice));
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_TRENDS, "Why?"));
  fputs("<section>\n", out);
  pthread_mutex_lock(&station->cause_thread->mutex);
  fg_status status =
      write_why(ctx, &(why_page){station, reader, &choice, station->cause_thread, out});
  pthread_mutex_unlock(&station->cause_thread->mutex);
  fputs("</section>\n", out);
  fg_page_end(out);
  return status;
}
