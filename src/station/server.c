/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/server.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "core/memory.h"
#include "station/access.h"
#include "station/connections.h"
#include "station/reach.h"
#include "station/scan_command.h"

/* WAITING_MAX: a browser opens six connections, one of which waits for news. A closed page is
 * noticed only at the next news, so waiting pages must leave room for others. THREADS: a report
 * that is measured again keeps one of them for a second. Each of them takes as many connections as
 * there are: the library gives them to whichever is free. */
enum { THREADS = 4, WAITING_MAX = 64, SECONDS = 15, HEADER_BYTES = 16384 };

typedef struct waiter {
  struct MHD_Connection *connection;
  fg_client client;
} waiter;

typedef struct server {
  fg_inspection *station;
  struct MHD_Daemon *daemon;
  pthread_mutex_t mutex;
  waiter waiting[WAITING_MAX]; /* the oldest first */
  size_t waiters;
  unsigned long news; /* how often there were any */
  bool closing;
  fg_connections connections;
} server;

/* One request on its way. */
typedef struct call {
  fg_request request;
  char *body;
  size_t size;
  bool broken, waited;
} call;

/* Keeps the library from decoding: one decoder reads every field. */
static size_t leave_encoded(void *user, struct MHD_Connection *connection, char *text) {
  (void)user;
  (void)connection;
  return strlen(text);
}

static enum MHD_Result read_query_field(void *user, enum MHD_ValueKind kind, const char *name,
                                        const char *value) {
  call *at = user;
  (void)kind;
  if (!at->broken && !fg_request_add_field(&at->request, name, value)) at->broken = true;
  return at->broken ? MHD_NO : MHD_YES;
}

static long long read_header_number(const char *text) {
  char *end;
  long long number = text ? strtoll(text, &end, 10) : -1;
  return text && end != text && !*end && number >= 0 ? number : -1;
}

static call *begin_call(struct MHD_Connection *connection, const char *method,
                        const char *user_header) {
  call *at = calloc(1, sizeof *at);
  if (!at) return NULL;
  fg_request *request = &at->request;
  request->post = !strcmp(method, "POST");
  request->host = fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Host");
  request->origin = fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Origin");
  request->site =
      fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Sec-Fetch-Site");
  request->cookie = fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Cookie");
  request->languages =
      fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Accept-Language");
  request->authorization =
      fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Authorization");
  if (user_header)
    request->user = fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, user_header);
  request->last_event = read_header_number(
      fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND, "Last-Event-ID"));
  fg_microhttpd.get_connection_values(connection, MHD_GET_ARGUMENT_KIND, read_query_field, at);
  return at;
}

/* False: too much. */
static bool receive_body(call *at, const char *bytes, size_t size, size_t max) {
  if (at->size + size > max) return false;
  char *grown = realloc(at->body, at->size + size + 1);
  if (!grown) return false;
  memcpy(grown + at->size, bytes, size);
  at->body = grown;
  at->size += size;
  at->body[at->size] = '\0';
  return true;
}

static void add_headers(struct MHD_Response *response, const fg_answer *answer) {
  /* A report has inline styles of its own. On other pages only the station's scripts run, and no
   * page fetches from elsewhere. */
  const char *policy =
      answer->own_style
          ? "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; "
            "form-action 'none'; frame-ancestors 'none'"
          : "default-src 'none'; style-src 'self'; script-src 'self'; connect-src 'self'; "
            "img-src 'self' data:; form-action 'self'; base-uri 'none'; frame-ancestors 'none'";
  char saved[200];
  fg_microhttpd.add_response_header(response, "Content-Security-Policy", policy);
  fg_microhttpd.add_response_header(response, "X-Content-Type-Options", "nosniff");
  fg_microhttpd.add_response_header(response, "Referrer-Policy", "same-origin");
  fg_microhttpd.add_response_header(response, "Cache-Control", "no-store");
  if (answer->type) fg_microhttpd.add_response_header(response, "Content-Type", answer->type);
  if (answer->language)
    fg_microhttpd.add_response_header(response, "Content-Language", answer->language);
  if (answer->location[0])
    fg_microhttpd.add_response_header(response, "Location", answer->location);
  if (answer->cookie[0]) fg_microhttpd.add_response_header(response, "Set-Cookie", answer->cookie);
  if (!answer->download[0]) return;
  snprintf(saved, sizeof saved, "attachment; filename=\"%s\"", answer->download);
  fg_microhttpd.add_response_header(response, "Content-Disposition", saved);
}

static enum MHD_Result send_answer(server *at, struct MHD_Connection *connection,
                                   fg_answer *answer) {
  struct MHD_Response *response = fg_microhttpd.create_response_from_buffer(
      answer->body ? answer->size : 0, answer->body ? answer->body : "",
      answer->body ? MHD_RESPMEM_MUST_FREE : MHD_RESPMEM_PERSISTENT);
  if (!response) {
    free(answer->body);
    return MHD_NO;
  }
  add_headers(response, answer);
  fg_connections_sending(&at->connections, connection, answer->body ? answer->size : 0);
  enum MHD_Result result = fg_microhttpd.queue_response(
      connection, (unsigned)(answer->code ? answer->code : 500), response);
  fg_microhttpd.destroy_response(response);
  return result;
}

static enum MHD_Result refuse_request(server *at, struct MHD_Connection *connection, int code,
                                      const char *words) {
  fg_answer answer = {.code = code, .type = "text/plain; charset=utf-8", .body = strdup(words)};
  answer.size = answer.body ? strlen(words) : 0;
  return send_answer(at, connection, &answer);
}

typedef enum waiting { WAITS, NEWS_CAME, CLOSING } waiting;

/* Place of the connection that makes room: the longest waiting one of the client with the most. */
static size_t find_longest_waiting(const server *at) {
  size_t place = 0, max = 0;
  for (size_t i = 0; i < at->waiters; i++) {
    size_t count = 0;
    for (size_t k = 0; k < at->waiters; k++)
      count += fg_client_is(&at->waiting[i].client, &at->waiting[k].client);
    if (count > max) place = i;
    if (count > max) max = count;
  }
  return place;
}

/* It is answered, and asks again. */
static void make_room(server *at) {
  size_t place = find_longest_waiting(at), behind = --at->waiters - place;
  fg_microhttpd.resume_connection(at->waiting[place].connection);
  memmove(&at->waiting[place], &at->waiting[place + 1], behind * sizeof *at->waiting);
}

/* Until there is news. Those that `seen` does not count came after the answer was made: then there
 * is another answer already. */
static waiting wait_for_news(server *at, struct MHD_Connection *connection, unsigned long seen) {
  waiting result = WAITS;
  pthread_mutex_lock(&at->mutex);
  if (at->closing) {
    result = CLOSING;
  } else if (at->news != seen) {
    result = NEWS_CAME;
  } else {
    if (at->waiters == WAITING_MAX) make_room(at);
    fg_microhttpd.suspend_connection(connection);
    at->waiting[at->waiters++] = (waiter){connection, fg_connection_client(connection)};
  }
  pthread_mutex_unlock(&at->mutex);
  return result;
}

static void resume_all(void *user) {
  server *at = user;
  pthread_mutex_lock(&at->mutex);
  at->news++;
  for (size_t i = 0; i < at->waiters; i++)
    fg_microhttpd.resume_connection(at->waiting[i].connection);
  at->waiters = 0;
  pthread_mutex_unlock(&at->mutex);
}

static unsigned long count_news(server *at) {
  pthread_mutex_lock(&at->mutex);
  unsigned long news = at->news;
  pthread_mutex_unlock(&at->mutex);
  return news;
}

static enum MHD_Result answer_call(server *at, struct MHD_Connection *connection, call *asked) {
  fg_answer answer;
  fg_connections_asked(&at->connections, connection);
  if (fg_access_is_api(asked->request.path))
    asked->request.body = asked->body ? asked->body : "";
  else if (asked->request.post &&
           !fg_request_read_fields(&asked->request, asked->body, asked->size))
    asked->broken = true;
  if (asked->broken) return refuse_request(at, connection, 400, "The fields cannot be read.\n");
  unsigned long seen = count_news(at);
  at->station->answer(at->station, &asked->request, &answer);
  if (answer.wait && !asked->waited) {
    waiting result = wait_for_news(at, connection, seen);
    asked->waited = true;
    if (result != CLOSING) free(answer.body);
    if (result == WAITS) return MHD_YES;
    if (result == NEWS_CAME) at->station->answer(at->station, &asked->request, &answer);
  }
  return send_answer(at, connection, &answer);
}

/* A hub alone takes large bodies: the parts of its stations. */
static size_t body_max(const server *at, const char *path) {
  return at->station->hub && fg_access_is_api(path) ? FG_API_BODY_MAX : FG_BODY_MAX;
}

/* Begins a request; refuses unknown methods and bodies that are too long before they come. */
static enum MHD_Result begin(server *at, struct MHD_Connection *connection, const char *method,
                             const char *path, void **place) {
  const char *length = fg_microhttpd.lookup_connection_value(connection, MHD_HEADER_KIND,
                                                             MHD_HTTP_HEADER_CONTENT_LENGTH);
  if (strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0 && strcmp(method, "POST") != 0)
    return refuse_request(at, connection, 405, "GET and POST are answered.\n");
  if (length && (strlen(length) > 9 || read_header_number(length) > (long long)body_max(at, path)))
    return refuse_request(at, connection, 413, "The form is too long.\n");
  *place = begin_call(connection, method, at->station->request->user_header);
  return *place ? MHD_YES : MHD_NO;
}

static enum MHD_Result handle_request(void *user, struct MHD_Connection *connection,
                                      const char *path, const char *method, const char *version,
                                      const char *bytes, size_t *size, void **place) {
  server *at = user;
  call *asked = *place;
  (void)version;
  if (!asked) return begin(at, connection, method, path, place);
  if (*size) {
    bool taken = receive_body(asked, bytes, *size, body_max(at, path));
    *size = 0;
    return taken ? MHD_YES : MHD_NO;
  }
  asked->request.path = path;
  return answer_call(at, connection, asked);
}

static void end_call(void *user, struct MHD_Connection *connection, void **place,
                     enum MHD_RequestTerminationCode code) {
  server *at = user;
  call *asked = *place;
  (void)code;
  fg_connections_answered(&at->connections, connection);
  if (asked) free(asked->body);
  free(asked);
  *place = NULL;
}

/* At `::` the station answers to IPv4 too. */
static unsigned flags_of(const struct sockaddr_storage *address, fg_reach reach) {
  unsigned flags = MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME;
  if (address->ss_family == AF_INET6)
    flags |= reach == FG_REACH_ANY ? MHD_USE_DUAL_STACK : MHD_USE_IPv6;
  return flags;
}

static fg_status start_daemon(fg_context *ctx, server *at, const struct sockaddr_storage *address) {
  const fg_station_request *request = at->station->request;
  errno = 0;
  at->daemon = fg_microhttpd.start_daemon(
      flags_of(address, at->station->reach), 0, NULL, NULL, handle_request, at,
      MHD_OPTION_SOCK_ADDR, address, MHD_OPTION_NOTIFY_COMPLETED, end_call, at,
      MHD_OPTION_NOTIFY_CONNECTION, fg_connections_notify, &at->connections,
      MHD_OPTION_UNESCAPE_CALLBACK, leave_encoded, NULL, MHD_OPTION_THREAD_POOL_SIZE,
      (unsigned)THREADS, MHD_OPTION_CONNECTION_LIMIT, (unsigned)(THREADS * 2 * FG_CONNECTIONS),
      MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)SECONDS, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
      (size_t)HEADER_BYTES, MHD_OPTION_END);
  if (at->daemon) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "%s:%u: pages cannot be served there: %s; choose another --port",
                 request->listen ? request->listen : "127.0.0.1", request->port,
                 errno ? strerror(errno) : "the address is taken or not this machine's");
}

fg_status fg_station_server_start(fg_context *ctx, fg_inspection *station) {
  struct sockaddr_storage address;
  void *block;
  const fg_station_request *request = station->request;
  FG_TRY(fg_reach_find(ctx, request, &address, &station->reach));
  FG_TRY(fg_http_library_load(ctx));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(server), &block));
  server *at = block;
  at->station = station;
  pthread_mutex_init(&at->mutex, NULL);
  fg_status status = fg_connections_begin(&at->connections)
                         ? start_daemon(ctx, at, &address)
                         : fg_fail(ctx, FG_ERR_MEMORY, "there is no thread for the pages");
  if (status != FG_OK) {
    fg_connections_end(&at->connections);
    free(at);
    return status;
  }
  const union MHD_DaemonInfo *info =
      fg_microhttpd.get_daemon_info(at->daemon, MHD_DAEMON_INFO_BIND_PORT);
  fg_reach_write(&address, info ? info->port : request->port, station->host, sizeof station->host);
  station->server = at;
  station->wake = resume_all;
  fg_reach_announce(station);
  return FG_OK;
}

void fg_station_server_stop(fg_inspection *station) {
  server *at = station->server;
  pthread_mutex_lock(&at->mutex);
  at->closing = true;
  pthread_mutex_unlock(&at->mutex);
  resume_all(at);
  fg_microhttpd.stop_daemon(at->daemon);
  fg_station_scan_stop(station);
  station->wake = NULL;
  station->server = NULL;
  fg_connections_end(&at->connections);
  free(at);
}
