/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ways to receivers, one row each: a folder, HTTP, MQTT. */
#ifndef FG_STATION_OUTBOX_TRANSPORT_H
#define FG_STATION_OUTBOX_TRANSPORT_H

#include <stdatomic.h>
#include <stddef.h>

#include "foilgauge/station.h"

typedef struct fg_message {
  const char *key;  /* the same in every attempt */
  const char *name; /* file name, the same in every attempt */
  const char *type; /* media type */
  const char *body; /* NULL: it was prepared by an earlier attempt */
  size_t size;
} fg_message;

typedef struct fg_transport {
  const char *scheme; /* "http://"; "": a folder */
  /* Opens a way to `to`; the token is "" or the first line of a file. `closing` becomes true when
   * the station ends: a call that waits returns then. */
  fg_status (*open)(fg_context *ctx, const char *to, const char *token, const atomic_bool *closing,
                    void **way);
  /* Puts the message where `send` finds it, so that nothing arrives twice; NULL: `send` takes it
   * alone. */
  fg_status (*prepare)(fg_context *ctx, void *way, const fg_message *message);
  fg_status (*send)(fg_context *ctx, void *way, const fg_message *message);
  void (*close)(void *way);
} fg_transport;

/* The row of `to`. FG_ERR_DATA: there is none, or this build has none. */
fg_status fg_transport_find(fg_context *ctx, const char *to, const fg_transport **transport);
fg_status fg_transport_check(fg_context *ctx, const char *to);

extern const fg_transport fg_transport_folder, fg_transport_http, fg_transport_https,
    fg_transport_mqtt;

#endif
