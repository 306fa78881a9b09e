#include "station/patience.h"

#include <sys/socket.h>

#include "core/clock.h"

/* A connection that is kept open is idle for at most half of this (server.c). */
enum { SECONDS = 30 };

void fg_patience_begin(fg_patience *patience) {
  *patience = (fg_patience){0};
  pthread_mutex_init(&patience->mutex, NULL);
}

void fg_patience_end(fg_patience *patience) {
  pthread_mutex_destroy(&patience->mutex);
}

static void set(fg_patience *patience, const struct MHD_Connection *connection, double until) {
  pthread_mutex_lock(&patience->mutex);
  for (size_t i = 0; i < FG_CONNECTIONS; i++)
    if (patience->one[i].connection == connection) patience->one[i].until = until;
  pthread_mutex_unlock(&patience->mutex);
}

/* The library closes what was shut down; its socket is its own until it has told of that. */
static void cut_off(fg_patience *patience) {
  double now = fg_clock_seconds();
  for (size_t i = 0; i < FG_CONNECTIONS; i++)
    if (patience->one[i].connection && patience->one[i].until > 0 && now > patience->one[i].until)
      shutdown(patience->one[i].socket, SHUT_RDWR);
}

static void replace(fg_patience *patience, const struct MHD_Connection *which,
                    struct MHD_Connection *by, int socket) {
  for (size_t i = 0; i < FG_CONNECTIONS; i++)
    if (patience->one[i].connection == which) {
      patience->one[i].connection = by;
      patience->one[i].socket = socket;
      patience->one[i].until = fg_clock_seconds() + SECONDS;
      return;
    }
}

void fg_patience_notify(void *user, struct MHD_Connection *connection, void **unused,
                        enum MHD_ConnectionNotificationCode code) {
  fg_patience *patience = user;
  (void)unused;
  pthread_mutex_lock(&patience->mutex);
  if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
    replace(patience, connection, NULL, -1);
  } else {
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    cut_off(patience);
    if (info) replace(patience, NULL, connection, info->connect_fd);
  }
  pthread_mutex_unlock(&patience->mutex);
}

void fg_patience_asked(fg_patience *patience, struct MHD_Connection *connection) {
  set(patience, connection, 0);
}

void fg_patience_answered(fg_patience *patience, struct MHD_Connection *connection) {
  set(patience, connection, fg_clock_seconds() + SECONDS);
}
