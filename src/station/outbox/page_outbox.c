/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of the outbox: as a page, as JSON, and as a line of the page Now. */
#include <stdlib.h>

#include "core/memory.h"
#include "page/table.h"
#include "station/outbox/outbox.h"
#include "station/pages.h"
#include "station/settings.h"

enum { RECEIVERS_MAX = FG_STATION_DESTINATIONS + 1 };

typedef struct outbox_state {
  fg_outbox_receiver *receivers;
  size_t count;
} outbox_state;

static const fg_member receiver_rows[] = {
    {FG_TEXT("to", fg_outbox_receiver, to), .named = true, .heading = "Receiver",
     .page = {.rank = 1, .words = true}},
    {FG_STRING("format", fg_outbox_receiver, format), .options = FG_MEMBER_NEVER_NULL,
     .named = true, .heading = "As", .page = {.rank = 2}},
    {FG_COUNT("passed", fg_outbox_receiver, passed), .words = "parts that it got", .heading = "Got",
     .page = {.rank = 3}},
    {FG_COUNT("waiting", fg_outbox_receiver, waiting), .words = "parts that it will get",
     .heading = "Waiting", .page = {.rank = 4}},
    {FG_TEXT("passed_at", fg_outbox_receiver, passed_at), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "when it got the last, UTC", .heading = "Last, UTC", .page = {.rank = 5}},
    {FG_TEXT("error", fg_outbox_receiver, error), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "why the last attempt failed", .heading = "Trouble",
     .page = {.rank = 8, .words = true}},
    {FG_COUNT("attempts", fg_outbox_receiver, attempts),
     .words = "that failed for the part that is next", .heading = "Attempts", .page = {.rank = 6}},
    {FG_NUMBER("retry_s", fg_outbox_receiver, retry_s), .words = "seconds to the next attempt",
     .heading = "Next,\ns", .page = {.rank = 7}},
};
static const fg_members receiver_members = FG_MEMBERS(receiver_rows);

static const fg_member outbox_rows[] = {
    {FG_HEAD("foilgauge/outbox/1")},
    {FG_LIST("receivers", outbox_state, receivers, count, &receiver_members)},
};
static const fg_members outbox_members = FG_MEMBERS(outbox_rows);

const fg_document fg_outbox_document = {
    .file = "outbox",
    .title = "foilgauge outbox",
    .description = "What a station has passed on, and what waits.",
    .made_by = "a station's page `/api/outbox`",
    .members = &outbox_members,
};

static fg_status read_state(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                            outbox_state *state) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, RECEIVERS_MAX + 1, sizeof *state->receivers, &block));
  *state = (outbox_state){.receivers = block};
  while (fg_outbox_read(station, reader, state->count, &state->receivers[state->count]))
    state->count++;
  return FG_OK;
}

fg_status fg_page_outbox_api(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                             const fg_request *request, FILE *out) {
  outbox_state state;
  (void)request;
  FG_TRY(read_state(ctx, station, reader, &state));
  fg_document_json(out, &outbox_members, &state);
  free(state.receivers);
  return FG_OK;
}

static bool receiver_at(const fg_subject *list, size_t i, fg_subject *element) {
  const outbox_state *state = list->object;
  element->object = &state->receivers[i];
  return i < state->count;
}

fg_status fg_page_outbox(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                         const fg_request *request, FILE *out) {
  outbox_state state;
  (void)request;
  FG_TRY(fg_page_begin(ctx, station, reader, out, FG_TAB_LOTS, "Passed on"));
  FG_TRY(read_state(ctx, station, reader, &state));
  fputs("<section><h1>Passed on</h1>\n", out);
  if (!state.count) fputs("<p class=\"note\">The recipe names no receiver.</p>\n", out);
  const fg_subject list = {.object = &state, .whole = &state};
  if (state.count) fg_html_table(out, &receiver_members, &list, receiver_at);
  fputs("</section>\n", out);
  fg_page_end(out);
  free(state.receivers);
  return FG_OK;
}

fg_status fg_outbox_write_line(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                               FILE *out) {
  outbox_state state;
  size_t waiting = 0;
  FG_TRY(read_state(ctx, station, reader, &state));
  for (size_t i = 0; i < state.count; i++) {
    if (state.receivers[i].error[0]) waiting += state.receivers[i].waiting;
  }
  if (waiting)
    fprintf(out, "<p class=\"order\"><a href=\"/outbox\"><b>%zu</b> not passed on yet</a></p>\n",
            waiting);
  else if (state.count)
    fputs("<p class=\"note\"><a href=\"/outbox\">Parts are passed on</a></p>\n", out);
  free(state.receivers);
  return FG_OK;
}
