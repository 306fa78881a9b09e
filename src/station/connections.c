/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/connections.h"

#include <netinet/in.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>

#include "core/date.h"

/* SECONDS: time limit of a request, and of an answer. BYTES_PER_S: a radio link at the far end of a
 * hall has more. TICK_MS: largest delay of the clock. FILES: other open descriptors. */
enum { SECONDS = 15, BYTES_PER_S = 16384, TICK_MS = 500, FILES = 64 };

fg_client fg_connection_client(struct MHD_Connection *connection) {
  fg_client client = {{0}};
  const union MHD_ConnectionInfo *info =
      fg_microhttpd.get_connection_info(connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  if (!info || !info->client_addr) return client;
  if (info->client_addr->sa_family == AF_INET) {
    const struct sockaddr_in *address = (const void *)info->client_addr;
    memcpy(client.bytes, &address->sin_addr, 4);
  } else if (info->client_addr->sa_family == AF_INET6) {
    const struct in6_addr *address =
        &((const struct sockaddr_in6 *)(const void *)info->client_addr)->sin6_addr;
    if (IN6_IS_ADDR_V4MAPPED(address))
      memcpy(client.bytes, address->s6_addr + 12, 4);
    else
      memcpy(client.bytes + 8, address->s6_addr, 8);
  }
  return client;
}

bool fg_client_is(const fg_client *one, const fg_client *other) {
  return !memcmp(one->bytes, other->bytes, sizeof one->bytes);
}

/* True where the connection occupies a place without work of the station: it has sent no whole
 * request, or is receiving its answer. */
static bool is_slow(const fg_connection *at) {
  return at->connection && at->until > 0 && !at->cut;
}

/* Shuts the socket down; the library, which owns it until it has notified the end, closes it. */
static void cut_off(fg_connection *at) {
  shutdown(at->socket, SHUT_RDWR);
  at->cut = true;
}

static size_t count_slow(const fg_connections *all, const fg_client *of) {
  size_t count = 0;
  for (size_t i = 0; i < 2 * FG_CONNECTIONS; i++)
    count += is_slow(&all->one[i]) && (!of || fg_client_is(&all->one[i].client, of));
  return count;
}

static const fg_client *find_busiest(const fg_connections *all) {
  const fg_client *busiest = NULL;
  size_t max = 0;
  for (size_t i = 0; i < 2 * FG_CONNECTIONS; i++) {
    if (!is_slow(&all->one[i])) continue;
    size_t count = count_slow(all, &all->one[i].client);
    if (count <= max) continue;
    max = count;
    busiest = &all->one[i].client;
  }
  return busiest;
}

static void cut_off_first(fg_connections *all, fg_client of) {
  fg_connection *first = NULL;
  for (size_t i = 0; i < 2 * FG_CONNECTIONS; i++) {
    fg_connection *at = &all->one[i];
    if (is_slow(at) && fg_client_is(&at->client, &of) && (!first || at->until < first->until))
      first = at;
  }
  if (first) cut_off(first);
}

static void make_room(fg_connections *all, const fg_client *client) {
  if (count_slow(all, client) >= FG_CONNECTIONS_OF_ONE) {
    cut_off_first(all, *client);
  } else if (count_slow(all, NULL) >= all->max) {
    const fg_client *busiest = find_busiest(all);
    if (busiest) cut_off_first(all, *busiest);
  }
}

static fg_connection *find_connection(fg_connections *all,
                                      const struct MHD_Connection *connection) {
  for (size_t i = 0; i < 2 * FG_CONNECTIONS; i++)
    if (all->one[i].connection == connection) return &all->one[i];
  return NULL;
}

static void add_connection(fg_connections *all, struct MHD_Connection *connection) {
  const union MHD_ConnectionInfo *info =
      fg_microhttpd.get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
  if (!info) return;
  const fg_connection new = {.connection = connection,
                             .socket = info->connect_fd,
                             .client = fg_connection_client(connection),
                             .until = fg_clock_seconds() + SECONDS};
  make_room(all, &new.client);
  fg_connection *place = find_connection(all, NULL);
  if (place)
    *place = new;
  else
    shutdown(new.socket, SHUT_RDWR);
}

void fg_connections_notify(void *user, struct MHD_Connection *connection, void **unused,
                           enum MHD_ConnectionNotificationCode code) {
  fg_connections *all = user;
  (void)unused;
  pthread_mutex_lock(&all->mutex);
  fg_connection *known = find_connection(all, connection);
  if (code == MHD_CONNECTION_NOTIFY_STARTED)
    add_connection(all, connection);
  else if (known)
    *known = (fg_connection){0};
  pthread_mutex_unlock(&all->mutex);
}

static void set_deadline(fg_connections *all, const struct MHD_Connection *connection,
                         double until) {
  pthread_mutex_lock(&all->mutex);
  fg_connection *known = find_connection(all, connection);
  if (known) known->until = until;
  pthread_mutex_unlock(&all->mutex);
}

void fg_connections_asked(fg_connections *all, struct MHD_Connection *connection) {
  set_deadline(all, connection, 0);
}

void fg_connections_sending(fg_connections *all, struct MHD_Connection *connection, size_t bytes) {
  set_deadline(all, connection, fg_clock_seconds() + SECONDS + (double)bytes / BYTES_PER_S);
}

void fg_connections_answered(fg_connections *all, struct MHD_Connection *connection) {
  set_deadline(all, connection, fg_clock_seconds() + SECONDS);
}

static void *run_clock(void *user) {
  fg_connections *all = user;
  pthread_mutex_lock(&all->mutex);
  while (all->running) {
    double now = fg_clock_seconds();
    struct timespec next;
    for (size_t i = 0; i < 2 * FG_CONNECTIONS; i++)
      if (is_slow(&all->one[i]) && now > all->one[i].until) cut_off(&all->one[i]);
    clock_gettime(CLOCK_MONOTONIC, &next);
    next.tv_nsec += TICK_MS * 1000000L;
    next.tv_sec += next.tv_nsec / 1000000000;
    next.tv_nsec %= 1000000000;
    pthread_cond_timedwait(&all->ends, &all->mutex, &next);
  }
  pthread_mutex_unlock(&all->mutex);
  return NULL;
}

static size_t find_max(void) {
  struct rlimit files;
  rlim_t max = FG_CONNECTIONS;
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && files.rlim_cur < 2 * FG_CONNECTIONS + FILES)
    max = files.rlim_cur > FILES + 16 ? (files.rlim_cur - FILES) / 2 : 8;
  return (size_t)max;
}

bool fg_connections_begin(fg_connections *all) {
  pthread_condattr_t steady;
  *all = (fg_connections){.running = true, .max = find_max()};
  pthread_mutex_init(&all->mutex, NULL);
  pthread_condattr_init(&steady);
  pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
  pthread_cond_init(&all->ends, &steady);
  pthread_condattr_destroy(&steady);
  if (pthread_create(&all->clock, NULL, run_clock, all) == 0) return true;
  all->running = false;
  return false;
}

void fg_connections_end(fg_connections *all) {
  pthread_mutex_lock(&all->mutex);
  bool running = all->running;
  all->running = false;
  pthread_cond_signal(&all->ends);
  pthread_mutex_unlock(&all->mutex);
  if (running) pthread_join(all->clock, NULL);
  pthread_cond_destroy(&all->ends);
  pthread_mutex_destroy(&all->mutex);
}
