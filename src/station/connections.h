/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The connections that are open, and who has to make room for others.
 *
 * A connection has a time for a whole request, header and body, and for taking the answer; a clock
 * cuts off who is over it. (The library's own limit starts again with every byte.) Where there are
 * too many connections that have not asked yet, or that take their answer slowly, the address with
 * the most of them loses the one that is nearest to its end: whoever opens how many connections,
 * somebody else's always finds a place. */
#ifndef FG_STATION_CONNECTIONS_H
#define FG_STATION_CONNECTIONS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include <microhttpd.h>

/* FG_CONNECTIONS_OF_ONE: a browser opens six, a proxy has those of all its browsers. */
enum { FG_CONNECTIONS = 256, FG_CONNECTIONS_OF_ONE = 48 };

/* Client by its IPv4 address, or by its IPv6 network (/64): one machine can choose any address of
 * its network. */
typedef struct fg_client {
  uint8_t bytes[16];
} fg_client;

typedef struct fg_connection {
  struct MHD_Connection *connection; /* NULL: none here */
  int socket;
  fg_client client;
  double until; /* when it is cut off (fg_clock_seconds); 0: not, it is being answered */
  bool cut;     /* it is closed as soon as the library sees that */
} fg_connection;

typedef struct fg_connections {
  pthread_mutex_t mutex;
  pthread_cond_t ends;
  pthread_t clock;
  bool running;
  size_t max;                            /* FG_CONNECTIONS, less where fewer files may be open */
  fg_connection one[2 * FG_CONNECTIONS]; /* with those that are cut off */
} fg_connections;

/* False: there is no thread for the clock. */
bool fg_connections_begin(fg_connections *connections);
void fg_connections_end(fg_connections *connections);

/* MHD_NotifyConnectionCallback with the fg_connections as its first argument. */
void fg_connections_notify(void *connections, struct MHD_Connection *connection, void **unused,
                           enum MHD_ConnectionNotificationCode code);

/* All of its request has come; `bytes` of an answer are sent; it is answered, and may ask again. */
void fg_connections_asked(fg_connections *connections, struct MHD_Connection *connection);
void fg_connections_sending(fg_connections *connections, struct MHD_Connection *connection,
                            size_t bytes);
void fg_connections_answered(fg_connections *connections, struct MHD_Connection *connection);

fg_client fg_connection_client(struct MHD_Connection *connection);
bool fg_client_is(const fg_client *one, const fg_client *other);

#endif
