/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A request and its answer, as pages and actions see them: no sockets, no HTTP. */
#ifndef FG_STATION_REQUEST_H
#define FG_STATION_REQUEST_H

#include <stddef.h>
#include <stdio.h>

#include "station/state.h"

/* FG_TOKEN_MAX: of --token; it fits into a cookie. */
enum { FG_TOKEN_MIN = 16, FG_TOKEN_MAX = 64 };
enum { FG_FIELDS_MAX = 32, FG_FIELD_BYTES = 1024, FG_BODY_MAX = 1 << 16 };
enum { FG_API_BODY_MAX = 1 << 22 }; /* of a part that a station posts to a hub */

/* A name and its value, from a query or a form; decoded, valid UTF-8, without control characters.
 */
typedef struct fg_field {
  char name[64];
  char value[FG_FIELD_BYTES];
} fg_field;

typedef struct fg_request {
  bool post;        /* else GET */
  const char *path; /* as it was sent: routes are plain ASCII, without encoded characters */
  fg_field field[FG_FIELDS_MAX];
  size_t fields;
  const char *host, *origin, *site, *cookie; /* headers; NULL: absent. site: Sec-Fetch-Site */
  const char *languages;                     /* Accept-Language; NULL: absent */
  const char *authorization, *user;          /* headers; user: of --user-header; NULL: absent */
  const char *body;                          /* of a POST to /api/; else NULL */
  long long last_event;                      /* Last-Event-ID; -1: none */
} fg_request;

typedef struct fg_answer {
  int code;             /* of HTTP */
  const char *type;     /* "text/html; charset=utf-8" */
  char location[1200];  /* of a redirection, with two encoded names; "": none */
  char cookie[128];     /* to set; "": none */
  char download[160];   /* name of a file to save; "": to be shown */
  bool own_style;       /* a report of its own: its styles are inline */
  bool in_language;     /* a text that is translated as pages are */
  const char *language; /* "de": of a page that is not English; NULL */
  bool wait;            /* there is no event yet: call again when there is one */
  char *body;
  size_t size;
} fg_answer;

/* Adds a field; name and value (NULL: "") are encoded as in an address. False as below. */
bool fg_request_add_field(fg_request *request, const char *name, const char *value);

/* Reads the fields of a query or of an html form's body. False: too many, too long, or wrongly
 * encoded. */
bool fg_request_read_fields(fg_request *request, const char *text, size_t length);

/* The value, or "". */
const char *fg_request_get(const fg_request *request, const char *name);

/* Reads the value of `given` without the spaces around it, which readers and fingers add.
 * FG_ERR_DATA, "The <what> is too long": `text` does not hold it. */
fg_status fg_request_read_text(fg_context *ctx, const char *what, const char *given, char *text,
                               size_t size);

/* Writes a page into `out`; the writer alone uses `reader`, the database, meanwhile.
 * FG_ERR_USAGE: the requested item does not exist (404). */
typedef fg_status fg_page_writer(fg_context *ctx, fg_inspection *station, sqlite3 *reader,
                                 const fg_request *request, FILE *out);

#endif
