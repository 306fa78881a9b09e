/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/access.h"

#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "page/page.h"
#include "station/reach.h"

static const char *const role_words[] = {"operator", "quality", "admin"};
enum { ROLES = sizeof role_words / sizeof *role_words, LINE_BYTES = 512 };

void fg_access_refuse(fg_answer *answer, int code, const char *words) {
  free(answer->body);
  *answer = (fg_answer){.code = code, .type = "text/html; charset=utf-8"};
  FILE *out = fg_stream_open(&answer->body, &answer->size);
  if (!out) return;
  fputs("<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><title>foilgauge</title>"
        "<link rel=\"stylesheet\" href=\"/style.css\"><main><section><h1>",
        out);
  fg_html_text(out, words);
  fputs("</h1><p><a href=\"/\">Back to the newest result</a></p></section></main></html>\n", out);
  fg_stream_keep(out, &answer->body);
}

/* ---- users ---- */

static bool read_role(const char *word, fg_role *role) {
  for (size_t i = 0; i < ROLES; i++)
    if (!strcmp(word, role_words[i])) {
      *role = (fg_role)i;
      return true;
    }
  return false;
}

static bool read_user(char *line, fg_user *user) {
  line[strcspn(line, "\r\n")] = '\0';
  char *role = strchr(line, ','), *token = role ? strchr(role + 1, ',') : NULL;
  if (!token) return false;
  *role++ = *token++ = '\0';
  size_t length = strlen(token);
  fg_text_clip(user->name, sizeof user->name, "%s", line);
  if (!line[0] || !read_role(role, &user->role)) return false;
  if (length && (length < FG_TOKEN_MIN || length > FG_TOKEN_MAX || strpbrk(token, "; ,")))
    return false;
  fg_text_clip(user->token, sizeof user->token, "%s", token);
  return true;
}

static fg_status read_users(fg_context *ctx, FILE *file, const char *path, fg_users *users) {
  char line[LINE_BYTES];
  size_t capacity = 0;
  for (size_t number = 1; fgets(line, sizeof line, file); number++) {
    if (line[0] == '#' || line[strspn(line, " \r\n")] == '\0') continue;
    void *block = users->list;
    FG_TRY(fg_memory_reserve(ctx, users->count + 1, sizeof *users->list, &capacity, &block));
    users->list = block;
    if (!read_user(line, &users->list[users->count++]))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%.600s: line %zu is none of a user: name,role,token with the role operator, "
                     "quality or admin, and a token of %d to %d characters or none (proxy)",
                     path, number, FG_TOKEN_MIN, FG_TOKEN_MAX);
  }
  if (users->count) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%.600s: names no user; it needs a line for each: name,role,token", path);
}

fg_status fg_users_load(fg_context *ctx, const char *path, fg_users *users) {
  *users = (fg_users){.list = NULL};
  if (!path) return FG_OK;
  FILE *file;
  FG_TRY(fg_file_open(ctx, path, &file));
  fg_status status = read_users(ctx, file, path, users);
  fclose(file);
  return status;
}

/* ---- requests ---- */

/* Takes as long for a wrong one as for the right one. */
static bool same_secret(const char *given, const char *secret) {
  size_t length = strlen(secret), other = strlen(given);
  unsigned differs = length != other;
  for (size_t i = 0; i < length; i++)
    differs |= (unsigned char)secret[i] ^ (unsigned char)given[other ? i % other : 0];
  return !differs;
}

static bool has_cookie(const fg_request *request, const char *token) {
  static const char name[] = "foilgauge=";
  const char *at = request->cookie ? request->cookie : "";
  while (*at) {
    at += strspn(at, "; ");
    size_t length = strcspn(at, ";");
    char value[FG_TOKEN_MAX + 1] = "";
    if (!strncmp(at, name, sizeof name - 1) && length - (sizeof name - 1) <= FG_TOKEN_MAX)
      memcpy(value, at + sizeof name - 1, length - (sizeof name - 1));
    if (value[0] && same_secret(value, token)) return true;
    at += length;
  }
  return false;
}

static bool has_bearer(const fg_request *request, const char *token) {
  static const char before[] = "Bearer ";
  const char *given = request->authorization;
  return given && !strncmp(given, before, sizeof before - 1) &&
         same_secret(given + sizeof before - 1, token);
}

static bool has_our_csrf_token(const fg_inspection *station, const fg_request *request) {
  if (request->origin && !fg_reach_is_origin(station, request->host, request->origin)) return false;
  if (request->site && strcmp(request->site, "same-origin") != 0 &&
      strcmp(request->site, "none") != 0)
    return false;
  return same_secret(fg_request_get(request, "form"), station->csrf_token);
}

bool fg_access_is_api(const char *path) {
  return !strncmp(path, "/api/", 5);
}

const fg_user *fg_access_user(const fg_inspection *station, const fg_request *request) {
  const fg_users *users = &station->users;
  for (size_t i = 0; i < users->count; i++) {
    const fg_user *user = &users->list[i];
    bool by_proxy = request->user && !strcmp(request->user, user->name);
    bool by_token = user->token[0] && !request->user &&
                    (has_cookie(request, user->token) || has_bearer(request, user->token));
    if (by_proxy || by_token) return user;
  }
  return NULL;
}

/* A token of the address, of the station or of a user, that becomes a cookie; NULL: none. */
static const char *find_given_token(const fg_inspection *station, const fg_request *request) {
  const char *given = fg_request_get(request, "token"), *token = station->request->token;
  if (request->post || !given[0]) return NULL;
  if (token && same_secret(given, token)) return token;
  for (size_t i = 0; i < station->users.count; i++)
    if (station->users.list[i].token[0] && same_secret(given, station->users.list[i].token))
      return station->users.list[i].token;
  return NULL;
}

/* Redirects to a page of this station alone: any other path may lead elsewhere ("//elsewhere"). */
static void set_cookie(const fg_inspection *station, const fg_request *request, const char *token,
                       fg_answer *answer) {
  const char *origin = station->request->origin, *path = request->path;
  bool plain = path[0] == '/' && !path[1 + strspn(path + 1, "abcdefghijklmnopqrstuvwxyz-")];
  fg_access_refuse(answer, 303, "");
  fg_text_clip(answer->location, sizeof answer->location, "%s", plain ? path : "/");
  snprintf(answer->cookie, sizeof answer->cookie,
           "foilgauge=%s; HttpOnly; SameSite=Strict; Path=/%s", token,
           origin && !strncmp(origin, "https:", 6) ? "; Secure" : "");
}

static bool is_known(const fg_inspection *station, const fg_request *request) {
  const char *token = station->request->token;
  if (station->users.count) return fg_access_user(station, request) != NULL;
  return !token || has_cookie(request, token) ||
         (fg_access_is_api(request->path) && has_bearer(request, token));
}

/* A page elsewhere cannot post to an API: a browser says where it comes from. */
static bool is_from_here(const fg_inspection *station, const fg_request *request) {
  if (!request->post) return true;
  if (fg_access_is_api(request->path)) return !request->origin && !request->site;
  return has_our_csrf_token(station, request);
}

bool fg_access_allows(const fg_inspection *station, const fg_request *request, fg_answer *answer) {
  if (!fg_reach_is_host(station, request->host)) {
    fg_access_refuse(
        answer, 421,
        "This address is not the station's: use one that it printed, or start it with --host for "
        "another name.");
    return false;
  }
  if (!is_known(station, request)) {
    const char *token = find_given_token(station, request);
    if (token)
      set_cookie(station, request, token, answer);
    else
      fg_access_refuse(answer, 401,
                       station->users.count
                           ? "Open this address with ?token= and your token."
                           : "Open the address that the station printed: it carries the token.");
    return false;
  }
  if (is_from_here(station, request)) return true;
  fg_access_refuse(
      answer, 403,
      "This form is not from this station as it runs now: go back and load the page again.");
  return false;
}

bool fg_access_has_role(const fg_inspection *station, const fg_request *request, fg_role role,
                        fg_answer *answer) {
  char words[200];
  const fg_user *user = fg_access_user(station, request);
  if (!user || user->role >= role) return true;
  snprintf(words, sizeof words, "%.80s may not do this: it takes the role %s.", user->name,
           role_words[role]);
  fg_access_refuse(answer, 403, words);
  return false;
}

void fg_access_sign(const fg_inspection *station, fg_request *request) {
  const fg_user *user = fg_access_user(station, request);
  if (!user) return;
  for (size_t i = 0; i < request->fields; i++)
    if (!strcmp(request->field[i].name, "by")) strcpy(request->field[i].name, "by_before");
  if (request->fields == FG_FIELDS_MAX) request->fields--;
  fg_field *field = &request->field[request->fields++];
  strcpy(field->name, "by");
  fg_text_clip(field->value, sizeof field->value, "%s", user->name);
}
