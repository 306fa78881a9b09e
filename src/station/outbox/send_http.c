/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A POST for each part, over one connection that stays open. 2xx means that the receiver has it. */
#include <curl/curl.h>
#include <stdlib.h>
#include <string.h>

#include "core/library.h"
#include "core/text.h"
#include "station/outbox/transport.h"

enum { CONNECT_S = 10, TOTAL_S = 60, HEADER_BYTES = 600, ANSWER_BYTES = 200 };

/* Functions of libcurl. */
/* clang-format off */
#define CURL_FUNCTIONS(F) \
  F(curl_, easy_init) \
  F(curl_, easy_setopt) \
  F(curl_, easy_perform) \
  F(curl_, easy_getinfo) \
  F(curl_, easy_cleanup) \
  F(curl_, easy_strerror) \
  F(curl_, slist_append) \
  F(curl_, slist_free_all) \
  F(curl_, global_init)
/* clang-format on */
static struct curl { CURL_FUNCTIONS(FG_LIBRARY_POINTER) } curl;
static const char *const names[] = {CURL_FUNCTIONS(FG_LIBRARY_NAME)};

static void start_curl(void) {
  curl.global_init(CURL_GLOBAL_DEFAULT);
}

static fg_library libcurl = FG_LIBRARY("libcurl.so.4", "libcurl4", names, &curl, start_curl);

typedef struct http {
  CURL *handle;
  char *to, *token;
  const atomic_bool *closing;
  char answer[ANSWER_BYTES]; /* the beginning of it */
  size_t answered;
} http;

static void close_http(void *way) {
  http *at = way;
  if (at->handle) curl.easy_cleanup(at->handle);
  free(at->to);
  free(at->token);
  free(at);
}

static int is_closing(void *user, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d) {
  const http *at = user;
  (void)a, (void)b, (void)c, (void)d;
  return atomic_load(at->closing);
}

static size_t keep_answer(char *bytes, size_t size, size_t count, void *user) {
  http *at = user;
  size_t room = sizeof at->answer - 1 - at->answered, length = size * count;
  size_t kept = length < room ? length : room;
  memcpy(at->answer + at->answered, bytes, kept);
  at->answered += kept;
  at->answer[at->answered] = '\0';
  return length;
}

static void set_options(http *at) {
  CURL *handle = at->handle;
  curl.easy_setopt(handle, CURLOPT_URL, at->to);
  curl.easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
  curl.easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
  curl.easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
  curl.easy_setopt(handle, CURLOPT_TIMEOUT, (long)TOTAL_S);
  curl.easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
  curl.easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, is_closing);
  curl.easy_setopt(handle, CURLOPT_XFERINFODATA, at);
  curl.easy_setopt(handle, CURLOPT_WRITEFUNCTION, keep_answer);
  curl.easy_setopt(handle, CURLOPT_WRITEDATA, at);
  curl.easy_setopt(handle, CURLOPT_USERAGENT, "foilgauge/" FOILGAUGE_VERSION);
}

static fg_status open_http(fg_context *ctx, const char *to, const char *token,
                           const atomic_bool *closing, void **way) {
  FG_TRY(fg_library_load(ctx, &libcurl));
  http *at = calloc(1, sizeof *at);
  if (!at) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: an address");
  at->closing = closing;
  at->handle = curl.easy_init();
  fg_status status =
      at->handle ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: an HTTP client");
  if (status == FG_OK) status = fg_text_print(ctx, &at->to, "%s", to);
  if (status == FG_OK) status = fg_text_print(ctx, &at->token, "%s", token);
  if (status != FG_OK)
    close_http(at);
  else
    set_options(at);
  *way = at;
  return status;
}

static struct curl_slist *add_header(struct curl_slist *list, const char *name, const char *value) {
  char header[HEADER_BYTES];
  fg_text_clip(header, sizeof header, "%s: %s", name, value);
  struct curl_slist *longer = curl.slist_append(list, header);
  return longer ? longer : list;
}

static struct curl_slist *make_headers(const http *at, const fg_message *message) {
  char bearer[HEADER_BYTES];
  struct curl_slist *list = add_header(NULL, "Content-Type", message->type);
  list = add_header(list, "Idempotency-Key", message->key);
  list = add_header(list, "Expect", "");
  fg_text_clip(bearer, sizeof bearer, "Bearer %s", at->token);
  return at->token[0] ? add_header(list, "Authorization", bearer) : list;
}

static fg_status judge_code(fg_context *ctx, const http *at, long code) {
  if (code >= 200 && code < 300) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "the receiver answers %ld%s%.150s", code,
                 at->answer[0] ? ": " : "", at->answer);
}

static fg_status send_http(fg_context *ctx, void *way, const fg_message *message) {
  http *at = way;
  long code = 0;
  struct curl_slist *headers = make_headers(at, message);
  at->answered = 0;
  at->answer[0] = '\0';
  curl.easy_setopt(at->handle, CURLOPT_HTTPHEADER, headers);
  curl.easy_setopt(at->handle, CURLOPT_POSTFIELDS, message->body);
  curl.easy_setopt(at->handle, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)message->size);
  CURLcode result = curl.easy_perform(at->handle);
  curl.easy_getinfo(at->handle, CURLINFO_RESPONSE_CODE, &code);
  curl.easy_setopt(at->handle, CURLOPT_HTTPHEADER, NULL);
  curl.slist_free_all(headers);
  if (result == CURLE_OK) return judge_code(ctx, at, code);
  return fg_fail(ctx, FG_ERR_IO, "%s", curl.easy_strerror(result));
}

const fg_transport fg_transport_http = {"http://", open_http, NULL, send_http, close_http};
const fg_transport fg_transport_https = {"https://", open_http, NULL, send_http, close_http};
