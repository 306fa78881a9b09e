/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A hub: shows the parts of several stations, which post them (station/outbox/). */
#ifndef FG_STATION_HUB_HUB_H
#define FG_STATION_HUB_HUB_H

#include "core/member.h"
#include "station/hub/store.h"
#include "station/request.h"

enum { FG_HUB_TEXT = 160, FG_HUB_REASON = 1100, FG_HUB_NUMBER = 24 };

/* A part as it was posted, and as it is shown. */
typedef struct fg_hub_part {
  char source[FG_HUB_TEXT], station[FG_HUB_TEXT], at[FG_HUB_TEXT], measured_at[FG_HUB_TEXT];
  char serial[FG_HUB_TEXT], lot[FG_HUB_TEXT], die[FG_HUB_TEXT], operator_name[FG_HUB_TEXT];
  char verdict[FG_HUB_TEXT], disposition[FG_HUB_TEXT], withheld[FG_HUB_REASON];
  char received_at[FG_HUB_TEXT]; /* first, by the hub's clock */
  size_t event, foil;
} fg_hub_part;

/* A station over the last day. */
typedef struct fg_hub_station {
  char station[FG_HUB_TEXT], source[FG_HUB_TEXT], received_at[FG_HUB_TEXT];
  size_t parts, failed, open;
} fg_hub_station;

typedef struct fg_hub {
  fg_inspection server; /* host of the pages: its request, its address, its tokens */
  fg_hub_store store;
  pthread_mutex_t mutex; /* of the store */
} fg_hub;

/* Keeps a posted part, once: *known where it was there. FG_ERR_DATA: it is none. */
fg_status fg_hub_keep(fg_context *ctx, fg_hub *hub, const char *body, bool *known);

/* Search of parts: "" is any. */
typedef struct fg_hub_search {
  const char *station, *serial, *lot, *verdict;
  size_t page; /* from 0 */
  size_t per_page;
} fg_hub_search;

typedef struct fg_hub_state {
  fg_hub_station *stations;
  fg_hub_part *parts;
  size_t station_count, part_count;
  bool more; /* parts on the next page */
} fg_hub_state;

fg_status fg_hub_read(fg_context *ctx, fg_hub *hub, const fg_hub_search *search,
                      fg_hub_state *state);
void fg_hub_state_free(fg_hub_state *state);
/* Reads the whole newest event of a foil as it was posted; *body NULL: there is none. */
fg_status fg_hub_read_part(fg_context *ctx, fg_hub *hub, const char *source, const char *foil,
                           char **body);

extern const fg_members fg_hub_state_members, fg_hub_part_members, fg_hub_station_members;

/* Write the state as a page, its parts as CSV. */
void fg_hub_write_page(const fg_hub_search *search, const fg_hub_state *state, FILE *out);
void fg_hub_write_csv(const fg_hub_state *state, FILE *out);

/* Answers a request (station/answer.h). */
void fg_hub_answer(fg_inspection *server, const fg_request *request, fg_answer *answer);

#endif
