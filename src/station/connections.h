/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The open connections, and which of them is closed to make room. A connection has a time limit
 * for a whole request, header and body, and for receiving the answer; a clock cuts off those
 * beyond it. (The library's own limit starts again with every byte.) Where too many connections
 * have sent no request yet, or receive their answer slowly, the address with the most of them
 * loses the one nearest to its limit: no client can keep the others out. */
#ifndef FG_STATION_CONNECTIONS_H
#define FG_STATION_CONNECTIONS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "station/http_library.h"

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
  double until; /* time of its cut-off (fg_clock_seconds); 0: none, it is being answered */
  bool cut;     /* it is closed as soon as the library sees that */
} fg_connection;

typedef struct fg_connections {
  pthread_mutex_t mutex;
  pthread_cond_t ends;
  pthread_t clock;
  bool running;
  size_t max;                            /* FG_CONNECTIONS, less where fewer files may be open */
  fg_connection one[2 * FG_CONNECTIONS]; /* including those being cut off */
} fg_connections;

/* Starts the clock's thread; false: there is none. */
bool fg_connections_begin(fg_connections *connections);
void fg_connections_end(fg_connections *connections);

/* MHD_NotifyConnectionCallback with the fg_connections as its first argument. */
void fg_connections_notify(void *connections, struct MHD_Connection *connection, void **unused,
                           enum MHD_ConnectionNotificationCode code);

/* Note that a connection's whole request has come; that `bytes` of an answer are sent; that it
 * is answered, and may ask again. */
void fg_connections_asked(fg_connections *connections, struct MHD_Connection *connection);
void fg_connections_sending(fg_connections *connections, struct MHD_Connection *connection,
                            size_t bytes);
void fg_connections_answered(fg_connections *connections, struct MHD_Connection *connection);

fg_client fg_connection_client(struct MHD_Connection *connection);
bool fg_client_is(const fg_client *one, const fg_client *other);

#endif
