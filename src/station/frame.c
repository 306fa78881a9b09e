/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frame of every page of a station, its style and its icon. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/file.h"
#include "page/page.h"
#include "station/check.h"
#include "station/check_fit.h"
#include "station/news.h"
#include "station/pages.h"
#include "station/trend.h"

static const struct {
  fg_tab tab;
  const char *path, *name;
} tabs[] = {
    {FG_TAB_NOW, "/", "Now"},
    {FG_TAB_HISTORY, "/history", "History"},
    {FG_TAB_TRENDS, "/trends", "Trends"},
    {FG_TAB_SCANNER, "/scanner", "Scanner"},
    {FG_TAB_LOTS, "/lots", "Lots"},
    {FG_TAB_ORDERS, "/orders", "Orders"},
};

void fg_page_time(FILE *out, int64_t at) {
  time_t seconds = (time_t)(at / 1000);
  struct tm local;
  char text[32];
  if (!localtime_r(&seconds, &local) || !strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local))
    strcpy(text, "?");
  fputs(text, out);
}

void fg_page_time_zoned(FILE *out, int64_t at) {
  time_t seconds = (time_t)(at / 1000);
  struct tm local;
  char zone[8];
  fg_page_time(out, at);
  if (localtime_r(&seconds, &local) && strftime(zone, sizeof zone, "%z", &local) == 5)
    fprintf(out, " %.3s:%s", zone, zone + 3);
}

void fg_page_parameter(FILE *out, const char *name, const char *value) {
  fprintf(out, "%s=", name);
  for (; *value; value++) {
    unsigned char c = (unsigned char)*value;
    bool plain = (c >= '0' && c <= '9') || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z') || c == '-';
    fprintf(out, plain ? "%c" : "%%%02X", c);
  }
  fputs("&amp;", out);
}

void fg_page_csrf_token(const fg_inspection *station, FILE *out) {
  fprintf(out, "<input type=\"hidden\" name=\"form\" value=\"%s\">", station->csrf_token);
}

const char *fg_page_verdict_words(const char *verdict, bool withheld) {
  if (withheld) return "NO VERDICT";
  if (!strcmp(verdict, "pass")) return "PASS";
  if (!strcmp(verdict, "fail")) return "FAIL";
  if (!strcmp(verdict, "no_tolerance")) return "MEASURED";
  return "SCAN AGAIN";
}

const char *fg_page_verdict_class(const char *verdict, bool withheld) {
  if (withheld) return "again";
  if (!strcmp(verdict, "pass")) return "pass";
  if (!strcmp(verdict, "fail")) return "fail";
  if (!strcmp(verdict, "no_tolerance")) return "none";
  return "again";
}

bool fg_page_check_passed(const char *words) {
  return !strncmp(words, FG_CHECK_IN_ORDER, strlen(FG_CHECK_IN_ORDER));
}

fg_card_style fg_page_card_style(const char *kind, const char *words, const char *verdict,
                                 bool withheld) {
  static const struct {
    const char *kind;
    fg_card_style look;
  } rows[] = {
      {"known", {"MEASURED BEFORE", "none"}},  {"duplicate", {"SAME SCAN", "again"}},
      {"check", {"CHECKED", "none"}},          {"foreign", {"NO SCAN", "again"}},
      {"unfinished", {"SCAN AGAIN", "again"}}, {"unreadable", {"SCAN AGAIN", "again"}},
  };
  if (!strcmp(kind, "check") && !fg_page_check_passed(words))
    return (fg_card_style){"CHECK FAILED", "fail"};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    if (!strcmp(kind, rows[i].kind)) return rows[i].look;
  return (fg_card_style){fg_page_verdict_words(verdict, withheld),
                         fg_page_verdict_class(verdict, withheld)};
}

static void write_tabs(FILE *out, fg_tab here) {
  fputs("<nav aria-label=\"Pages of the station\">", out);
  for (size_t i = 0; i < sizeof tabs / sizeof *tabs; i++)
    fprintf(out, "<a href=\"%s\"%s accesskey=\"%zu\">%s</a>", tabs[i].path,
            tabs[i].tab == here ? " aria-current=\"page\"" : "", i + 1, tabs[i].name);
  fputs("</nav>\n", out);
}

static void write_recovery(fg_inspection *station, FILE *out) {
  fg_recovery *recovery = &station->recovery;
  pthread_mutex_lock(&recovery->mutex);
  if (recovery->words[0]) {
    fputs("<p class=\"banner\" role=\"alert\"><b>Nothing is kept now; it is tried again.</b> ",
          out);
    fg_html_text(out, recovery->words);
    fputs("</p>\n", out);
  }
  if (recovery->backup[0]) {
    fputs("<p class=\"banner\" role=\"alert\"><b>No backup.</b> ", out);
    fg_html_text(out, recovery->backup);
    fputs("</p>\n", out);
  }
  if (recovery->crowd[0]) {
    fputs("<p class=\"banner\"><b>Very many files.</b> ", out);
    fg_html_text(out, recovery->crowd);
    fputs("</p>\n", out);
  }
  pthread_mutex_unlock(&recovery->mutex);
}

static fg_status write_banner(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                              FILE *out) {
  fg_station_health health;
  const fg_station_check *check = &station->settings->check;
  FG_TRY(fg_station_check_health(ctx, reader, check, &health));
  if (!health.asked || (!health.due && !health.failed && !health.changed)) return FG_OK;
  fprintf(out,
          "<p class=\"banner\" role=\"alert\"><b>%s</b> %s <a href=\"/scanner\">Scanner</a></p>\n",
          health.changed      ? "The scanner's tone, sharpening or blur has changed."
          : health.failed     ? "The scanner failed its last check."
          : health.clock_back ? "The clock was set back: the scanner's check may be too old."
          : health.last_at    ? "The scanner's check is due."
                              : "The scanner was never checked.",
          check->withhold ? "No foil gets a verdict until a check has passed." : "");
  return FG_OK;
}

/* Words of the page's script, and the line in which it tells a screen reader of news: a region that
 * lives as long as the page. In the words % is a time or a number. */
static void write_script_words(FILE *out) {
  static const char *const words[][2] = {
      {"lost", "No connection to the station. This page shows what was known at %; what came later "
               "is not here."},
      {"stale", "The station cannot show its newest result now. This page shows what was known at "
                "%; what came later is not here."},
      {"newer", "% newer:"},
      {"drop", "Drop"},
  };
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    fprintf(out, "<p hidden data-word=\"%s\">%s</p>\n", words[i][0], words[i][1]);
  fputs("<p id=\"heard\" role=\"status\"></p>\n", out);
}

/* Seen until the page's script has heard of the station: without a script, always. */
static void write_silent(FILE *out) {
  fputs("<p id=\"silent\" role=\"alert\">This page shows what was known at ", out);
  fg_page_time(out, fg_station_now());
  fputs(", and does not renew itself: <a href=\"\">load it again</a>.</p>\n", out);
}

fg_status fg_page_begin(fg_context *ctx, fg_inspection *station, sqlite3 *reader, FILE *out,
                        fg_tab tab, const char *title) {
  long long news =
      fg_station_news(station); /* before anything is read: the page is as new, or newer */
  fputs("<!doctype html>\n<html lang=\"en\" class=\"unconfirmed\">\n<head>\n<meta "
        "charset=\"utf-8\">\n<meta "
        "name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
        out);
  fg_html_text(out, title);
  fputs(" – foilgauge station</title>\n<link rel=\"icon\" href=\"/icon.svg\">\n<link "
        "rel=\"stylesheet\" href=\"/style.css\">\n<script "
        "src=\"/script.js\" defer></script>\n</head>\n<body>\n",
        out);
  write_tabs(out, tab);
  write_silent(out);
  write_script_words(out);
  fprintf(out, "<main data-news=\"%lld\" data-form=\"%s\" data-at=\"", news, station->csrf_token);
  fg_page_time(out, fg_station_now());
  fputs("\">\n", out);
  write_recovery(station, out);
  return write_banner(ctx, station, reader, out);
}

void fg_page_heading(FILE *out, const char *words) {
  fprintf(out, "<h1 class=\"unseen\">%s</h1>\n", words);
}

void fg_page_end(FILE *out) {
  fputs("</main>\n</body>\n</html>\n", out);
}

/* A bump of a foil. */
const char fg_station_icon[] =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 32 32\"><rect width=\"32\" "
    "height=\"32\" rx=\"6\" fill=\"#16202a\"/><path d=\"M2 23H7Q16 -3 25 23H30\" fill=\"none\" "
    "stroke=\"#fff\" stroke-width=\"3.5\"/></svg>\n";

static char *whole; /* the style that pages link to */

static void join_styles(void) {
  size_t size;
  FILE *out = fg_stream_open(&whole, &size);
  if (!out) return;
  fputs(fg_page_style, out);
  fputs(fg_station_style, out);
  fputs(fg_trend_style, out);
  fputs(fg_station_dark_style, out);
  fg_stream_keep(out, &whole);
}

const char *fg_station_style_text(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, join_styles);
  return whole ? whole : fg_station_style;
}
