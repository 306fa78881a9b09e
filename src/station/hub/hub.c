/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A hub from its start to its end, and its answers. */
#include "station/hub/hub.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "core/memory.h"
#include "foilgauge/file.h"
#include "station/access.h"
#include "station/answer.h"
#include "station/pages.h"
#include "station/server.h"

enum { PER_PAGE = 40, CSV_MAX = 100000, PAGE_MAX = 1000000 };

static fg_hub *hub_of(fg_inspection *server) {
  return server->hub;
}

static void give_body(fg_answer *answer, int code, const char *type, char *body, size_t size) {
  *answer = (fg_answer){.code = code, .type = type, .body = body, .size = size};
}

static void give_words(fg_answer *answer, int code, const char *words) {
  char *body = strdup(words);
  give_body(answer, code, "text/plain; charset=utf-8", body, body ? strlen(body) : 0);
}

/* A station hears 422 of a part that is none, 503 where the database is gone: it tries again. */
static void take_part(fg_hub *hub, const fg_request *request, fg_answer *answer) {
  fg_context ctx = {.message = ""};
  bool known = false;
  fg_status status = fg_hub_keep(&ctx, hub, request->body, &known);
  if (status == FG_OK)
    give_words(answer, 200, known ? "known\n" : "kept\n");
  else
    give_words(answer, status == FG_ERR_DATA ? 422 : 503, ctx.message);
}

static void read_hub_search(const fg_request *request, size_t per_page, fg_hub_search *search) {
  long page = strtol(fg_request_get(request, "page"), NULL, 10);
  *search = (fg_hub_search){.station = fg_request_get(request, "station"),
                            .serial = fg_request_get(request, "serial"),
                            .lot = fg_request_get(request, "lot"),
                            .verdict = fg_request_get(request, "verdict"),
                            .page = page > 1 && page < PAGE_MAX ? (size_t)page - 1 : 0,
                            .per_page = per_page};
}

/* Views of the state. */
static void write_json(const fg_hub_search *search, const fg_hub_state *state, FILE *out) {
  (void)search;
  fg_document_json(out, &fg_hub_state_members, state);
}

static void write_csv(const fg_hub_search *search, const fg_hub_state *state, FILE *out) {
  (void)search;
  fg_hub_write_csv(state, out);
}

static const struct {
  const char *path, *type;
  void (*write)(const fg_hub_search *search, const fg_hub_state *state, FILE *out);
  size_t per_page;
} views[] = {
    {"/", "text/html; charset=utf-8", fg_hub_write_page, PER_PAGE},
    {"/api/parts", "application/json", write_json, PER_PAGE},
    {"/api/parts.csv", "text/csv; charset=utf-8", write_csv, CSV_MAX},
};

static void give_state(fg_hub *hub, const fg_request *request, size_t view, fg_answer *answer) {
  fg_context ctx = {.message = ""};
  fg_hub_search search;
  fg_hub_state state;
  char *body = NULL;
  size_t size = 0;
  read_hub_search(request, views[view].per_page, &search);
  if (fg_hub_read(&ctx, hub, &search, &state) != FG_OK) {
    give_words(answer, 503, ctx.message);
    return;
  }
  FILE *out = fg_stream_open(&body, &size);
  if (out) {
    views[view].write(&search, &state, out);
    fg_stream_keep(out, &body);
  }
  fg_hub_state_free(&state);
  give_body(answer, body ? 200 : 500, views[view].type, body, size);
}

static void give_part(fg_hub *hub, const fg_request *request, fg_answer *answer) {
  fg_context ctx = {.message = ""};
  char *body;
  fg_status status = fg_hub_read_part(&ctx, hub, fg_request_get(request, "source"),
                                      fg_request_get(request, "foil"), &body);
  if (status != FG_OK)
    give_words(answer, 503, ctx.message);
  else if (!body)
    give_words(answer, 404, "There is no such part.\n");
  else
    give_body(answer, 200, "application/json", body, strlen(body));
}

static void answer_in_english(fg_inspection *server, const fg_request *request, fg_answer *answer) {
  fg_hub *hub = hub_of(server);
  if (!fg_access_allows(server, request, answer)) return;
  if (request->post && !strcmp(request->path, "/api/parts")) {
    take_part(hub, request, answer);
    return;
  }
  if (fg_station_give_fixed(request, answer)) return;
  if (!strcmp(request->path, "/api/part")) {
    give_part(hub, request, answer);
    return;
  }
  for (size_t i = 0; i < sizeof views / sizeof *views; i++)
    if (!request->post && !strcmp(request->path, views[i].path)) {
      give_state(hub, request, i, answer);
      return;
    }
  give_words(answer, 404, "There is no such page.\n");
}

void fg_hub_answer(fg_inspection *server, const fg_request *request, fg_answer *answer) {
  const fg_language *language = fg_languages_choose(server->languages, NULL, request->languages);
  *answer = (fg_answer){0};
  answer_in_english(server, request, answer);
  if (language) fg_station_give_language(language, answer);
}

/* Writes the newest parts as a file. */
static fg_status export_parts(fg_context *ctx, fg_hub *hub, const char *path) {
  const fg_hub_search all = {"", "", "", "", .per_page = CSV_MAX};
  fg_hub_state state;
  fg_output output;
  FG_TRY(fg_hub_read(ctx, hub, &all, &state));
  fg_status status = fg_output_open(ctx, path, &output);
  if (status == FG_OK) {
    fg_hub_write_csv(&state, output.stream);
    status = fg_output_end(ctx, &output, FG_OK);
  }
  fg_hub_state_free(&state);
  return status;
}

/* Waits for the end. */
static fg_status wait_for_end(fg_context *ctx, int descriptor) {
  struct pollfd end = {.fd = descriptor, .events = POLLIN};
  while (poll(&end, 1, -1) <= 0 || !end.revents) {
  }
  return fg_fail(ctx, FG_ERR_INTERRUPTED, "interrupted");
}

static fg_status serve_hub(fg_context *ctx, fg_hub *hub, const char *database) {
  FG_TRY(fg_users_load(ctx, hub->server.request->users, &hub->server.users));
  FG_TRY(fg_hub_store_open(ctx, database, &hub->store));
  const char *path = hub->server.request->export_path;
  if (path) return export_parts(ctx, hub, path);
  FG_TRY(fg_languages_open(ctx, &hub->server.languages));
  FG_TRY(fg_station_server_start(ctx, &hub->server));
  fg_status status = wait_for_end(ctx, hub->server.request->end_descriptor);
  fg_station_server_stop(&hub->server);
  return status;
}

fg_status fg_hub_run(fg_context *ctx, const char *database, const fg_station_request *pages) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_hub), &block));
  fg_hub *hub = block;
  *hub = (fg_hub){.server = {.request = pages, .answer = fg_hub_answer}};
  hub->server.hub = hub;
  pthread_mutex_init(&hub->mutex, NULL);
  atomic_init(&hub->server.news, 0);
  fg_status status = serve_hub(ctx, hub, database);
  fg_hub_store_close(&hub->store);
  fg_languages_close(hub->server.languages);
  free(hub->server.users.list);
  free(hub);
  return status;
}
