/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/outbox/transport.h"

#include <string.h>

fg_status fg_transport_find(fg_context *ctx, const char *to, const fg_transport **transport) {
  static const fg_transport *const rows[] = {&fg_transport_http, &fg_transport_https,
                                             &fg_transport_mqtt};
  *transport = &fg_transport_folder;
  if (!to[0])
    return fg_fail(ctx, FG_ERR_DATA,
                   "pass_on: `to` is empty; it must be a folder, or an address with http://, "
                   "https:// or mqtt://");
  if (!strstr(to, "://")) return FG_OK;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (strncmp(to, rows[i]->scheme, strlen(rows[i]->scheme)) != 0) continue;
    *transport = rows[i];
    if (rows[i]->open) return FG_OK;
    return fg_fail(ctx, FG_ERR_DATA,
                   "%.300s: this build has no MQTT: build it where libmosquitto-dev is installed",
                   to);
  }
  return fg_fail(ctx, FG_ERR_DATA,
                 "%.300s: a folder, or an address with http://, https:// or mqtt://", to);
}

/* A topic stands behind the broker's name, and is one. */
static fg_status check_topic(fg_context *ctx, const char *to) {
  const char *topic = strchr(to + strlen("mqtt://"), '/');
  if (topic && topic[1] && !strpbrk(topic, "#+")) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%.300s: is no topic, as mqtt://HOST:1883/TOPIC", to);
}

fg_status fg_transport_check(fg_context *ctx, const char *to) {
  const fg_transport *transport;
  FG_TRY(fg_transport_find(ctx, to, &transport));
  return transport == &fg_transport_mqtt ? check_topic(ctx, to) : FG_OK;
}
