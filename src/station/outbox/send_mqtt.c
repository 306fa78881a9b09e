/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A message of a topic for each part: MQTT with quality of service 1, noted when the broker has
 * acknowledged it. The part's key tells a subscriber a message that comes again. */
#include "station/outbox/transport.h"

#ifdef FOILGAUGE_MQTT
#include <mosquitto.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/library.h"
#include "core/text.h"

enum { PORT = 1883, KEEP_ALIVE_S = 60, TURN_MS = 100, QOS = 1, HOST_BYTES = 256 };
static const double acknowledge_s = 20;

/* Functions of libmosquitto. */
/* clang-format off */
#define MOSQUITTO_FUNCTIONS(F) \
  F(mosquitto_, connack_string) \
  F(mosquitto_, connect) \
  F(mosquitto_, connect_callback_set) \
  F(mosquitto_, destroy) \
  F(mosquitto_, disconnect) \
  F(mosquitto_, disconnect_callback_set) \
  F(mosquitto_, lib_init) \
  F(mosquitto_, loop) \
  F(mosquitto_, new) \
  F(mosquitto_, publish) \
  F(mosquitto_, publish_callback_set) \
  F(mosquitto_, reinitialise) \
  F(mosquitto_, strerror) \
  F(mosquitto_, username_pw_set)
/* clang-format on */
static struct mosquitto_library { MOSQUITTO_FUNCTIONS(FG_LIBRARY_POINTER) } broker;
static const char *const names[] = {MOSQUITTO_FUNCTIONS(FG_LIBRARY_NAME)};

static void start_mosquitto(void) {
  broker.lib_init();
}

static fg_library libmosquitto =
    FG_LIBRARY("libmosquitto.so.1", "libmosquitto1", names, &broker, start_mosquitto);

typedef struct mqtt {
  struct mosquitto *client;
  char host[HOST_BYTES], user[HOST_BYTES], *topic, *token;
  int port;
  bool connected;
  int refused;      /* by the broker: its reason; 0: none */
  int acknowledged; /* message that the broker has */
  const atomic_bool *closing;
} mqtt;

static void note_connect(struct mosquitto *client, void *user, int code) {
  mqtt *at = user;
  (void)client;
  at->connected = code == 0;
  at->refused = code;
}

static void note_disconnect(struct mosquitto *client, void *user, int code) {
  (void)client;
  (void)code;
  ((mqtt *)user)->connected = false;
}

static void note_publish(struct mosquitto *client, void *user, int message) {
  (void)client;
  ((mqtt *)user)->acknowledged = message;
}

static void close_mqtt(void *way) {
  mqtt *at = way;
  if (at->client) broker.disconnect(at->client);
  if (at->client) broker.destroy(at->client);
  free(at->topic);
  free(at->token);
  free(at);
}

/* Reads USER@HOST:PORT/TOPIC behind the scheme. */
static fg_status read_address(fg_context *ctx, const char *to, mqtt *at) {
  const char *host = to + strlen("mqtt://"), *slash = strchr(host, '/');
  const char *user = slash ? memchr(host, '@', (size_t)(slash - host)) : NULL;
  if (!slash)
    return fg_fail(ctx, FG_ERR_DATA, "%.300s: has no topic; write it as mqtt://HOST:1883/TOPIC",
                   to);
  if (user) fg_text_clip(at->user, sizeof at->user, "%.*s", (int)(user - host), host);
  if (user) host = user + 1;
  const char *colon = memchr(host, ':', (size_t)(slash - host));
  at->port = colon ? atoi(colon + 1) : PORT;
  const char *end = colon ? colon : slash;
  fg_text_clip(at->host, sizeof at->host, "%.*s", (int)(end - host), host);
  return fg_text_print(ctx, &at->topic, "%s", slash + 1);
}

static void set_callbacks(mqtt *at) {
  broker.connect_callback_set(at->client, note_connect);
  broker.disconnect_callback_set(at->client, note_disconnect);
  broker.publish_callback_set(at->client, note_publish);
  if (at->user[0] || at->token[0])
    broker.username_pw_set(at->client, at->user[0] ? at->user : "foilgauge", at->token);
}

static fg_status make_client(fg_context *ctx, const char *to, const char *token, mqtt *at) {
  FG_TRY(read_address(ctx, to, at));
  FG_TRY(fg_text_print(ctx, &at->token, "%s", token));
  at->client = broker.new(NULL, true, at);
  if (!at->client) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: an MQTT client");
  set_callbacks(at);
  return FG_OK;
}

static fg_status open_mqtt(fg_context *ctx, const char *to, const char *token,
                           const atomic_bool *closing, void **way) {
  FG_TRY(fg_library_load(ctx, &libmosquitto));
  mqtt *at = calloc(1, sizeof *at);
  if (!at) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a topic");
  at->closing = closing;
  *way = at;
  fg_status status = make_client(ctx, to, token, at);
  if (status != FG_OK) close_mqtt(at);
  return status;
}

static fg_status fail_mqtt(fg_context *ctx, const mqtt *at, const char *words) {
  return fg_fail(ctx, FG_ERR_IO, "%s:%d: %s", at->host, at->port, words);
}

/* Runs the client until it is connected, or the broker has message `wanted`. */
static fg_status run_client(fg_context *ctx, mqtt *at, int wanted) {
  double end = fg_clock_seconds() + acknowledge_s;
  while (wanted ? at->acknowledged != wanted : !at->connected) {
    int code = broker.loop(at->client, TURN_MS, 1);
    if (code != MOSQ_ERR_SUCCESS) {
      at->connected = false;
      return fail_mqtt(ctx, at,
                       at->refused ? broker.connack_string(at->refused) : broker.strerror(code));
    }
    if (atomic_load(at->closing)) return fail_mqtt(ctx, at, "the station ends");
    if (fg_clock_seconds() > end) return fail_mqtt(ctx, at, "the broker does not answer");
  }
  return FG_OK;
}

static fg_status connect_client(fg_context *ctx, mqtt *at) {
  if (at->connected && broker.loop(at->client, 0, 1) == MOSQ_ERR_SUCCESS && at->connected)
    return FG_OK;
  at->connected = false;
  at->refused = 0;
  int code = broker.connect(at->client, at->host, at->port, KEEP_ALIVE_S);
  if (code != MOSQ_ERR_SUCCESS) return fail_mqtt(ctx, at, broker.strerror(code));
  return run_client(ctx, at, 0);
}

/* An earlier message that was not acknowledged is sent by the client itself once more: a client
 * made anew has none. */
static fg_status send_mqtt(fg_context *ctx, void *way, const fg_message *message) {
  mqtt *at = way;
  int number = 0;
  FG_TRY(connect_client(ctx, at));
  at->acknowledged = 0;
  int code =
      broker.publish(at->client, &number, at->topic, (int)message->size, message->body, QOS, false);
  if (code != MOSQ_ERR_SUCCESS) return fail_mqtt(ctx, at, broker.strerror(code));
  fg_status status = run_client(ctx, at, number);
  if (status == FG_OK) return FG_OK;
  broker.reinitialise(at->client, NULL, true, at);
  set_callbacks(at);
  at->connected = false;
  return status;
}

const fg_transport fg_transport_mqtt = {"mqtt://", open_mqtt, NULL, send_mqtt, close_mqtt};
#else
const fg_transport fg_transport_mqtt = {.scheme = "mqtt://"};
#endif
