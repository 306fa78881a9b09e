/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part as an event left it: what receivers get. */
#ifndef FG_STATION_OUTBOX_PART_H
#define FG_STATION_OUTBOX_PART_H

#include "core/member.h"
#include "station/keep.h"
#include "station/settings.h"
#include "station/stored_foil.h"

enum { FG_PART_NAME = 160, FG_PART_NOTE = 1024, FG_PART_TIME = 32, FG_PART_KEY = 64 };

typedef struct fg_part_value {
  const char *of; /* "foil", "bump", "beam" */
  int number;     /* of the bump or beam; 0: the foil */
  const char *name, *unit;
  double value, u;
} fg_part_value;

typedef struct fg_part_disposition {
  char kind[32], reason[FG_PART_NOTE], note[FG_PART_NOTE], by[FG_PART_NAME], at[FG_PART_TIME];
} fg_part_disposition;

typedef struct fg_part {
  char key[FG_PART_KEY], source[FG_PART_KEY]; /* key of the event; identity of the database */
  char station[FG_PART_NAME], kind[16], at[FG_PART_TIME], measured_at[FG_PART_TIME];
  char serial[FG_PART_NAME], lot[FG_PART_NAME], die[FG_PART_NAME], operator_name[FG_PART_NAME];
  char coil[FG_PART_NAME], oven[FG_PART_NAME], scanner[FG_PART_NAME], order[FG_PART_NAME];
  size_t event, foil; /* numbers of the database; event 0: none */
  fg_part_disposition disposition;
  bool disposed;
  fg_stored_foil *stored;
  fg_part_value *values;
  size_t value_count;
  fg_decision decision;
} fg_part;

/* Name of a station for receivers: as stated, or the machine's. */
void fg_part_station_name(const fg_station_request *request, char name[FG_PART_NAME]);

/* Loads the part of an event. FG_ERR_USAGE: there is none. The call alone may use `reader`
 * meanwhile. */
fg_status fg_part_load(fg_context *ctx, sqlite3 *reader, const char *station, int64_t event,
                       fg_part **part);
/* As fg_part_load, of a foil as it is now. */
fg_status fg_part_load_foil(fg_context *ctx, sqlite3 *reader, const char *station, int64_t foil,
                            fg_part **part);
void fg_part_free(fg_part *part);

/* Formats parts as one document, JSON of one; the caller frees the body. A lot's CSV of bumps is
 * one of beams where the foils lie flat. */
fg_status fg_parts_format(fg_context *ctx, fg_part *const *parts, size_t count,
                          fg_part_format format, bool decimal_comma, char **body, size_t *size);

/* Ending of a file of the format, ".json", and its media type. */
const char *fg_part_format_ending(fg_part_format format);
const char *fg_part_format_type(fg_part_format format);

#endif
