/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A search for causes, in a thread of its own that leaves the processors to the measurements. */
#ifndef FG_STATION_CAUSE_THREAD_H
#define FG_STATION_CAUSE_THREAD_H

#include "station/cause.h"

typedef struct fg_cause_thread {
  pthread_mutex_t mutex;
  pthread_t thread;
  bool started, running; /* started: there is a thread to join */
  fg_trend_choice choice;
  int64_t at;             /* time of its end */
  char error[1024];       /* "": none */
  fg_cause_report report; /* of the choice, when it has ended without an error */
} fg_cause_thread;

fg_status fg_cause_thread_start(fg_context *ctx, fg_inspection *station);
void fg_cause_thread_stop(fg_inspection *station);

/* Searches in the calling thread, by a connection of its own to the file `database`. */
fg_status fg_cause_search_database(fg_context *ctx, const fg_station_request *request,
                                   const char *database, const fg_trend_choice *choice,
                                   fg_cause_report *report);

#endif
