/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests to a station: "POST" or not, path, query, then headers, then the body, a line each. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "support/station_fixture.h"

static station_fixture fixture;

static void close_fixture(void) {
  station_fixture_close(&fixture);
}

static void open_fixture(void) {
  fg_context ctx = {0};
  if (station_fixture_open(&ctx, &fixture, "<script>S-1", "S-1.png") != FG_OK) {
    fprintf(stderr, "%s\n", ctx.message);
    abort();
  }
  fixture.request.token = "a-token-of-a-station";
  /* One disk, many executions. */
  fg_sql_run(&ctx, fixture.station.database.writer, "PRAGMA synchronous = OFF");
  atexit(close_fixture);
}

/* The next line, or NULL where it is empty. */
static const char *take_line(char **at) {
  char *line = *at, *end = strchr(line, '\n');
  *at = end ? end + 1 : line + strlen(line);
  if (end) *end = '\0';
  return line[0] ? line : NULL;
}

static void ask(char *text, fg_request *request) {
  fg_answer answer;
  const char *method = take_line(&text), *path = take_line(&text), *query = take_line(&text);
  *request = (fg_request){.post = method && !strcmp(method, "POST"), .path = path ? path : ""};
  request->host = take_line(&text);
  request->origin = take_line(&text);
  request->site = take_line(&text);
  request->cookie = take_line(&text);
  const char *event = take_line(&text);
  request->last_event = event ? strtoll(event, NULL, 10) : -1;
  if (query && !fg_request_read_fields(request, query, strlen(query))) return;
  if (request->post && !fg_request_read_fields(request, text, strlen(text))) return;
  fg_station_answer(&fixture.station, request, &answer);
  if (answer.code < 200 || answer.code > 599 || strpbrk(answer.location, "\r\n") ||
      !strncmp(answer.location, "//", 2) || (answer.location[0] && answer.location[0] != '/'))
    abort();
  /* Nothing that was given is on a page as it came. */
  if (answer.body && answer.type && strstr(answer.type, "html") &&
      memmem(answer.body, answer.size, "<script>", 8))
    abort();
  free(answer.body);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static fg_request request;
  static int opened;
  char *text = malloc(size + 1);
  if (!opened++) open_fixture();
  if (!text) return 0;
  memcpy(text, data, size);
  text[size] = '\0';
  ask(text, &request);
  free(text);
  return 0;
}
