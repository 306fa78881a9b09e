/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The way of parts to one receiver. */
#ifndef FG_STATION_OUTBOX_LANE_H
#define FG_STATION_OUTBOX_LANE_H

#include <pthread.h>

#include "station/outbox/part.h"
#include "station/outbox/transport.h"

enum { FG_LANE_TOKEN = 256, FG_LANE_NAME = 1100, FG_LANE_ERROR = 600 };

typedef struct fg_lane {
  fg_inspection *station;
  const fg_station_destination *destination;
  const char *station_name;
  bool from_start;         /* a new receiver gets earlier parts, too */
  char name[FG_LANE_NAME]; /* in the database */
  const fg_transport *transport;
  char token[FG_LANE_TOKEN];
  void *way; /* NULL: not open */
  const atomic_bool *closing;
  pthread_t thread;
  bool started;
  /* Under the outbox's mutex: */
  char error[FG_LANE_ERROR];
  size_t attempts;
  double retry_at; /* fg_clock_seconds */
} fg_lane;

/* Finds the way of a destination and its token, and its row in the database. */
fg_status fg_lane_begin(fg_context *ctx, fg_lane *lane);
/* Passes the next part on; *idle: there is none. */
fg_status fg_lane_deliver(fg_context *ctx, fg_lane *lane, bool *idle);
void fg_lane_end(fg_lane *lane);

#endif
