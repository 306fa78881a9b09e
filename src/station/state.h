/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a running station. */
#ifndef FG_STATION_STATE_H
#define FG_STATION_STATE_H

#include <stdatomic.h>

#include "foilgauge/scan_loop.h"
#include "foilgauge/station.h"
#include "language/language.h"
#include "station/database.h"

enum { FG_CSRF_TOKEN = 33 };

/* A lot that is being closed, in a thread of its own: scans may have to be measured again. */
typedef struct fg_closing {
  pthread_mutex_t mutex;
  pthread_t thread;
  bool started, running; /* started: there is a thread to join */
  char lot[1024], by[1024];
  char error[1024]; /* failure of the last that could not be closed; "": none */
} fg_closing;

/* A failure from which the station tries to recover; pages show it. */
typedef struct fg_recovery {
  pthread_mutex_t mutex;
  char words[1000]; /* "": all is well */
  char backup[500]; /* failure of the last backup; "": there is none */
  char crowd[200];  /* warning of a folder with very many files; "": there is none */
} fg_recovery;

typedef struct fg_outbox fg_outbox;
struct fg_request; /* station/request.h */
struct fg_answer;

/* Users that the station knows; 0: it knows none. */
typedef struct fg_users {
  struct fg_user *list;
  size_t count;
} fg_users;

/* Stage of the newest file before it has a card. */
typedef enum fg_stage {
  FG_STAGE_NONE,
  FG_STAGE_RECEIVING, /* it is not whole, and its writer may go on */
  FG_STAGE_MEASURING
} fg_stage;

typedef struct fg_arriving {
  pthread_mutex_t mutex;
  fg_stage stage;
  int64_t since;
  char file[256]; /* below the folder; clipped */
  bool seen;      /* in this pass over the folder */
} fg_arriving;

/* Machines that can reach the address listened at. */
typedef enum fg_reach {
  FG_REACH_LOCAL,   /* this machine */
  FG_REACH_ADDRESS, /* others, at one address of this machine */
  FG_REACH_ANY      /* others, at every address */
} fg_reach;

typedef struct fg_inspection fg_inspection;
struct fg_inspection {
  const fg_station_request *request;
  const fg_station_settings *settings;
  fg_station_outcome *outcome;
  fg_station_database database;
  fg_scanner_model *model; /* that corrects every scan; NULL: none */
  fg_design check_design;  /* of the plate or ring, if check_design_known */
  bool check_design_known;
  int64_t setup;
  int lock;
  char csrf_token[FG_CSRF_TOKEN]; /* carried by the html forms of this station's pages */
  char host[128];                 /* address that it listens at: "127.0.0.1:8317" */
  fg_reach reach;
  atomic_bool scanning;               /* the scan command runs */
  char scan_warning[1000];            /* options of it that spoil scans; "": none is known */
  struct fg_station_scanner *scanner; /* of the last scan by command; NULL: none yet */
  fg_closing closing;
  struct fg_backup *backup; /* station/backup.h; NULL: the recipe asks for none */
  fg_users users;           /* station/access.h */
  struct fg_outbox *outbox; /* station/outbox/outbox.h; NULL: nothing is passed on */
  struct fg_cause_thread
      *cause_thread; /* search for causes (station/cause_thread.h); NULL: none was asked for */
  fg_languages *languages;       /* of the pages; NULL: English alone */
  struct fg_part_recipes *parts; /* station/part_recipes.h; NULL: one recipe for all */
  fg_recovery recovery;
  fg_arriving arriving;
  atomic_llong news;          /* station/news.h */
  void (*wake)(void *server); /* called on news; NULL: no page waits */
  void *server;
  void (*answer)(struct fg_inspection *station, const struct fg_request *request,
                 struct fg_answer *answer);
  void *hub;                                      /* whose pages these are; NULL: a station's */
  void (*pass_on)(struct fg_inspection *station); /* called on news; NULL: there is no receiver */
};

#endif
