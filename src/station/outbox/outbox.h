/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outbox: passes every part on to its receivers, in order, each by a thread of its own.
 *
 * An event is kept with what befell its foil, in one transaction; a receiver has a row that says
 * which event it got last. It gets the next one until it has it, after growing waits, and the row
 * says so afterwards. A station that ends in between sends the event again, with the same key. */
#ifndef FG_STATION_OUTBOX_OUTBOX_H
#define FG_STATION_OUTBOX_OUTBOX_H

#include "core/member.h"
#include "station/request.h"

/* Finds the receivers: a new one gets parts of later events alone, so it comes before them. Without
 * receivers there is nothing to do. */
fg_status fg_outbox_open(fg_context *ctx, fg_inspection *station);
/* Begins passing on. */
fg_status fg_outbox_begin(fg_context *ctx, fg_inspection *station);
/* Passes on what waits, until a receiver has all or fails: of a station that ends at once. */
void fg_outbox_flush(fg_inspection *station);
void fg_outbox_end(fg_inspection *station);

/* State of a receiver. */
typedef struct fg_outbox_receiver {
  char to[1100];
  const char *format;
  size_t passed, waiting;
  char passed_at[32]; /* of the last part; "": none yet */
  char error[600];    /* of the last attempt; "": none */
  size_t attempts;    /* that failed, for the part that is next */
  double retry_s;     /* until the next attempt; NaN: none is due */
} fg_outbox_receiver;

/* Reads the state of receiver `i`; false behind the last. */
bool fg_outbox_read(fg_inspection *station, sqlite3 *reader, size_t i, fg_outbox_receiver *state);

fg_page_writer fg_page_outbox;     /* /outbox */
fg_page_writer fg_page_outbox_api; /* /api/outbox */

/* Writes a line with a link where parts wait; nothing without receivers. */
fg_status fg_outbox_write_line(fg_context *ctx, fg_inspection *station, sqlite3 *reader, FILE *out);

#endif
