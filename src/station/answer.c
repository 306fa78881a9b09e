/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access and routes: every request passes here. */
#include "station/answer.h"

#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "foilgauge/file.h"
#include "language/language.h"
#include "station/access.h"
#include "station/audit_trail.h"
#include "station/news.h"
#include "station/outbox/outbox.h"
#include "station/pages.h"
#include "station/trend.h"

typedef struct route {
  const char *path;
  fg_page_writer *write;
  const char *type;
  bool own_style;
  bool slow; /* takes the reader itself, for as long as it reads: others go on meanwhile */
} route;

#define HTML "text/html; charset=utf-8"
#define CSV  "text/csv; charset=utf-8"

static const route pages[] = {
    {"/", fg_page_now, HTML, false, false},
    {"/history", fg_page_history, HTML, false, false},
    {"/foil", fg_page_foil, HTML, false, false},
    {"/report", fg_page_report, HTML, true, true},
    {"/picture", fg_page_picture, HTML, true, true},
    {"/trends", fg_page_trends, HTML, false, false},
    {"/why", fg_page_why, HTML, false, false},
    {"/scanner", fg_page_scanner, HTML, false, false},
    {"/lots", fg_page_lots, HTML, false, false},
    {"/orders", fg_page_orders, HTML, false, false},
    {"/lot", fg_page_lot, HTML, true, false},
    {"/found/foils.csv", fg_page_found, CSV, false, true},
    {"/found/bumps.csv", fg_page_found, CSV, false, true},
    {"/found/results.dfq", fg_page_found, "text/plain; charset=utf-8", false, true},
    {"/found/results.qif", fg_page_found, "application/xml", false, true},
    {"/trail", fg_page_audit_trail, HTML, false, false},
    {"/outbox", fg_page_outbox, HTML, false, false},
    {"/api/outbox", fg_page_outbox_api, "application/json", false, false},
};

static const struct {
  const char *path;
  fg_action *act;
  fg_role role; /* that it takes where the station knows users */
} actions[] = {
    {"/correct", fg_action_correct, FG_ROLE_OPERATOR},
    {"/scan", fg_action_scan, FG_ROLE_OPERATOR},
    {"/baseline", fg_action_baseline, FG_ROLE_QUALITY},
    {"/close", fg_action_close, FG_ROLE_QUALITY},
    {"/download", fg_action_download, FG_ROLE_OPERATOR},
    {"/dispose", fg_action_dispose, FG_ROLE_OPERATOR},
    {"/order", fg_action_order, FG_ROLE_OPERATOR},
    {"/order-close", fg_action_order_close, FG_ROLE_OPERATOR},
    {"/why", fg_action_why, FG_ROLE_OPERATOR},
    {"/accept", fg_action_accept, FG_ROLE_QUALITY},
    {"/withdraw", fg_action_withdraw, FG_ROLE_QUALITY},
};

enum { PAGES = sizeof pages / sizeof *pages, ACTIONS = sizeof actions / sizeof *actions };

static int code_of(fg_status status) {
  switch (status) {
  case FG_ERR_USAGE:
    return 404;
  case FG_ERR_DATA:
    return 422;
  case FG_ERR_INTERRUPTED:
    return 503;
  default:
    return 500;
  }
}

static void write_route_page(fg_inspection *station, const fg_request *request, const route *page,
                             fg_answer *answer) {
  fg_context ctx = {.message = ""};
  FILE *out = fg_stream_open(&answer->body, &answer->size);
  if (!out) {
    fg_access_refuse(answer, 500, "out of memory");
    return;
  }
  if (!page->slow) pthread_mutex_lock(&station->database.reading);
  fg_status status = page->write(&ctx, station, station->database.reader, request, out);
  if (!page->slow) pthread_mutex_unlock(&station->database.reading);
  if (!fg_stream_keep(out, &answer->body) && status == FG_OK)
    status = fg_fail(&ctx, FG_ERR_MEMORY, "out of memory");
  *answer = (fg_answer){.code = 200,
                        .type = page->type,
                        .own_style = page->own_style,
                        .body = answer->body,
                        .size = answer->size};
  if (status != FG_OK) fg_access_refuse(answer, code_of(status), ctx.message);
}

static void give_text(fg_answer *answer, const char *type, const char *text) {
  answer->code = 200;
  answer->type = type;
  answer->body = strdup(text);
  answer->size = answer->body ? strlen(text) : 0;
}

static void act(fg_inspection *station, const fg_request *request, fg_action *action,
                fg_answer *answer) {
  fg_context ctx = {.message = ""};
  fg_request signed_request = *request;
  *answer = (fg_answer){.code = 303, .type = HTML};
  fg_access_sign(station, &signed_request);
  fg_status status = action(&ctx, station, &signed_request, answer);
  fg_audit_trail_add(station, request, status == FG_OK ? "" : ctx.message);
  if (status != FG_OK) fg_access_refuse(answer, code_of(status), ctx.message);
}

/* The count of news, for pages that wait for more. The reply ends the connection: the browser asks
 * again by itself. Nothing here waits for the database. */
static void answer_events(fg_inspection *station, const fg_request *request, fg_answer *answer) {
  long long news = fg_station_news(station);
  *answer = (fg_answer){.code = 200, .type = "text/event-stream"};
  answer->wait = news == request->last_event;
  FILE *out = fg_stream_open(&answer->body, &answer->size);
  if (!out) return;
  fprintf(out, "retry: 250\nid: %lld\ndata: %s\n\n", news,
          answer->wait || request->last_event < 0 ? "same" : "new");
  fg_stream_keep(out, &answer->body);
}

/* Answers a page's heartbeat: the count of news, and the time. The answer confirms a page with
 * that count. */
static void answer_heartbeat(fg_inspection *station, fg_answer *answer) {
  *answer = (fg_answer){.code = 200, .type = "text/plain; charset=utf-8"};
  FILE *out = fg_stream_open(&answer->body, &answer->size);
  if (!out) return;
  fprintf(out, "%lld ", fg_station_news(station));
  fg_page_time(out, fg_station_now());
  fputc('\n', out);
  fg_stream_keep(out, &answer->body);
  answer->in_language = true;
}

bool fg_station_give_fixed(const fg_request *request, fg_answer *answer) {
  if (request->post) return false;
  if (!strcmp(request->path, "/style.css"))
    give_text(answer, "text/css; charset=utf-8", fg_station_style_text());
  else if (!strcmp(request->path, "/icon.svg") || !strcmp(request->path, "/favicon.ico"))
    give_text(answer, "image/svg+xml", fg_station_icon);
  else if (!strcmp(request->path, "/script.js"))
    give_text(answer, "text/javascript; charset=utf-8", fg_station_script);
  else if (!strcmp(request->path, "/trends.js"))
    give_text(answer, "text/javascript; charset=utf-8", fg_trend_script);
  else
    return false;
  return true;
}

/* Answers a page's questions in the background. */
static bool give_news(fg_inspection *station, const fg_request *request, fg_answer *answer) {
  if (request->post) return false;
  if (!strcmp(request->path, "/events"))
    answer_events(station, request, answer);
  else if (!strcmp(request->path, "/alive"))
    answer_heartbeat(station, answer);
  else
    return false;
  return true;
}

static fg_status write_page_in(const fg_language *language, const fg_answer *answer, FILE *out) {
  fg_language_write_html(language, answer->body, answer->size, out, NULL);
  return FG_OK;
}

static fg_status copy_body(fg_context *ctx, void *answer, FILE *out) {
  const fg_answer *written = answer;
  (void)ctx;
  fwrite(written->body, 1, written->size, out);
  return FG_OK;
}

static bool begins_with(const fg_answer *answer, const char *text) {
  return answer->size >= strlen(text) && !memcmp(answer->body, text, strlen(text));
}

void fg_station_give_language(const fg_language *language, fg_answer *answer) {
  char *text = NULL;
  size_t size = 0;
  fg_context ctx = {.message = ""};
  bool page =
      answer->in_language || (answer->type && !strcmp(answer->type, HTML) && !answer->download[0]);
  bool table = answer->type && !strncmp(answer->type, "text/csv", 8) &&
               fg_language_decimal(language) == ',' && !begins_with(answer, "\xef\xbb\xbf");
  FILE *out = (page || table) && answer->body ? fg_stream_open(&text, &size) : NULL;
  if (!out) return;
  fg_status status = page ? write_page_in(language, answer, out)
                          : fg_csv_write(&ctx, true, copy_body, answer, out);
  if (!fg_stream_keep(out, &text) || status != FG_OK) {
    free(text);
    return;
  }
  free(answer->body);
  answer->body = text;
  answer->size = size;
  answer->language = fg_language_tag(language);
}

static void write_answer(fg_inspection *station, const fg_request *request, fg_answer *answer) {
  if (!fg_access_allows(station, request, answer)) return;
  if (fg_station_give_fixed(request, answer) || give_news(station, request, answer)) return;
  for (size_t i = 0; i < PAGES && !request->post; i++)
    if (!strcmp(request->path, pages[i].path)) {
      write_route_page(station, request, &pages[i], answer);
      return;
    }
  for (size_t i = 0; i < ACTIONS && request->post; i++)
    if (!strcmp(request->path, actions[i].path)) {
      if (fg_access_has_role(station, request, actions[i].role, answer))
        act(station, request, actions[i].act, answer);
      else
        fg_audit_trail_add(station, request, "the role does not reach");
      return;
    }
  fg_access_refuse(answer, 404, "There is no such page.");
}

void fg_station_answer(fg_inspection *station, const fg_request *request, fg_answer *answer) {
  const char *named = station->settings->language;
  const fg_language *language = fg_languages_choose(station->languages, named, request->languages);
  *answer = (fg_answer){0};
  write_answer(station, request, answer);
  if (language) fg_station_give_language(language, answer);
}
