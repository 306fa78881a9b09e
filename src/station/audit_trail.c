/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdlib.h>
#include <string.h>

#include "core/member.h"
#include "core/memory.h"
#include "core/text.h"
#include "page/table.h"
#include "station/access.h"
#include "station/audit_trail.h"
#include "station/pages.h"

enum { ACTIONS_SHOWN = 200, ACTION_TEXT = 300 };

typedef struct trail_action {
  char at[32], user[FG_USER_NAME], action[ACTION_TEXT], subject[ACTION_TEXT], refused[ACTION_TEXT];
} trail_action;

typedef struct trail_list {
  trail_action *actions;
  size_t count;
} trail_list;

static const fg_member action_rows[] = {
    {FG_TEXT("at", trail_action, at), .heading = "When", .page = {.rank = 1}},
    {FG_TEXT("user", trail_action, user), .heading = "User", .page = {.rank = 2}},
    {FG_TEXT("action", trail_action, action), .heading = "Action", .page = {.rank = 3}},
    {FG_TEXT("subject", trail_action, subject), .heading = "Of",
     .page = {.rank = 4, .words = true}},
    {FG_TEXT("refused", trail_action, refused), .heading = "Refused",
     .page = {.rank = 5, .words = true}},
};
static const fg_members action_members = FG_MEMBERS(action_rows);

/* Names the foil, lot or order that an action is of, and its kind: "foil 17 concession". */
static void find_subject(const fg_request *request, char subject[ACTION_TEXT]) {
  static const char *const fields[] = {"foil", "lot", "order", "number", "kind", "serial", "id"};
  size_t length = 0;
  subject[0] = '\0';
  for (size_t i = 0; i < sizeof fields / sizeof *fields && length < ACTION_TEXT - 1; i++) {
    const char *value = fg_request_get(request, fields[i]);
    if (!*value) continue;
    fg_text_clip(subject + length, ACTION_TEXT - length, "%s%s %.100s", length ? ", " : "",
                 fields[i], value);
    length = strlen(subject);
  }
}

static fg_status insert_action(fg_context *ctx, sqlite3 *writer, const fg_user *user,
                               const fg_request *request, const char *refused) {
  fg_query query;
  char subject[ACTION_TEXT];
  find_subject(request, subject);
  fg_query_begin(writer,
                 "INSERT INTO trail (at, user, action, subject, refused) VALUES (?, ?, ?, ?, ?)",
                 &query);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, user->name);
  fg_query_text(&query, request->path + 1);
  fg_query_text(&query, subject);
  fg_query_text(&query, refused);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping an action");
}

void fg_audit_trail_add(fg_inspection *station, const fg_request *request, const char *refused) {
  fg_context inner;
  const fg_user *user = fg_access_user(station, request);
  fg_station_database *database = &station->database;
  if (!user || fg_station_database_begin(&inner, database) != FG_OK) return;
  fg_station_database_end(&inner, database,
                          insert_action(&inner, database->writer, user, request, refused));
}

static void copy_action(const fg_query *query, trail_action *action) {
  char *const texts[] = {action->at, action->user, action->action, action->subject,
                         action->refused};
  const size_t sizes[] = {sizeof action->at, sizeof action->user, sizeof action->action,
                          sizeof action->subject, sizeof action->refused};
  for (int i = 0; i < 5; i++)
    fg_text_clip(texts[i], sizes[i], "%s", fg_query_get_text(query, i));
}

static fg_status read_actions(fg_context *ctx, sqlite3 *reader, trail_list *list) {
  fg_query query;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, ACTIONS_SHOWN, sizeof *list->actions, &block));
  *list = (trail_list){.actions = block};
  fg_query_begin(reader,
                 "SELECT strftime('%Y-%m-%d %H:%M:%S', at / 1000, 'unixepoch', 'localtime'), user,"
                 " action, subject, refused FROM trail ORDER BY id DESC LIMIT ?",
                 &query);
  fg_query_integer(&query, ACTIONS_SHOWN);
  while (fg_query_row(&query))
    copy_action(&query, &list->actions[list->count++]);
  fg_status status = fg_query_end(ctx, &query, "reading the trail");
  if (status != FG_OK) free(list->actions);
  return status;
}

static bool action_at(const fg_subject *list, size_t i, fg_subject *element) {
  const trail_list *trail = list->object;
  element->object = &trail->actions[i];
  return i < trail->count;
}

fg_status fg_page_audit_trail(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                              const fg_request *request, FILE *out) {
  trail_list list;
  (void)request;
  FG_TRY(read_actions(ctx, reader, &list));
  const fg_subject all = {.object = &list, .whole = &list};
  fg_status status = fg_page_begin(ctx, station, reader, out, FG_TAB_HISTORY, "Trail");
  if (status == FG_OK) {
    fputs("<section><h1>Trail</h1>\n", out);
    if (list.count)
      fg_html_table(out, &action_members, &all, action_at);
    else
      fputs("<p class=\"note\">No known user has done anything yet.</p>\n", out);
    fputs("</section>\n", out);
    fg_page_end(out);
  }
  free(list.actions);
  return status;
}
