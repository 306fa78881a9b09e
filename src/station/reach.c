/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/reach.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "core/text.h"
#include "station/request.h"

enum { NAME_BYTES = 256, DEFAULT_PORT = 80 };

/* A host without its port, in lower or upper case as it came; IPv6 addresses without brackets. */
typedef struct place {
  char name[NAME_BYTES];
  unsigned port; /* 0: none was given */
} place;

static bool read_port(const char *text, unsigned *port) {
  char *end;
  unsigned long number = strtoul(text, &end, 10);
  if (text[0] < '0' || text[0] > '9' || *end || number == 0 || number > 65535) return false;
  *port = (unsigned)number;
  return true;
}

static bool read_place(const char *host, place *at) {
  const char *end = host + strcspn(host, ":"), *name = host;
  *at = (place){.port = 0};
  if (*host == '[') {
    name = host + 1;
    end = name + strcspn(name, "]");
    if (*end != ']') return false;
  }
  size_t length = (size_t)(end - name);
  if (!length || length >= NAME_BYTES) return false;
  memcpy(at->name, name, length);
  end += *end == ']';
  return !*end || (*end == ':' && read_port(end + 1, &at->port));
}

static const char *host_of_origin(const char *origin) {
  const char *host = strstr(origin, "://");
  return host ? host + 3 : "";
}

/* True for an origin as a browser writes it: a scheme and a host alone. */
static bool is_origin(const char *origin) {
  place at;
  bool web = !strncmp(origin, "https://", 8) || !strncmp(origin, "http://", 7);
  return web && !strpbrk(host_of_origin(origin), "/?#@ \r\n\"<>") &&
         read_place(host_of_origin(origin), &at);
}

static bool read_address(const char *text, unsigned port, struct sockaddr_storage *address) {
  struct sockaddr_in *four = (void *)address;
  struct sockaddr_in6 *six = (void *)address;
  memset(address, 0, sizeof *address);
  if (inet_pton(AF_INET, text, &four->sin_addr) == 1) {
    four->sin_family = AF_INET;
    four->sin_port = htons((uint16_t)port);
    return true;
  }
  six->sin6_family = AF_INET6;
  six->sin6_port = htons((uint16_t)port);
  return inet_pton(AF_INET6, text, &six->sin6_addr) == 1;
}

static fg_reach find_reach(const struct sockaddr_storage *address) {
  if (address->ss_family == AF_INET) {
    uint32_t number = ntohl(((const struct sockaddr_in *)(const void *)address)->sin_addr.s_addr);
    return number >> 24 == 127 ? FG_REACH_LOCAL : number ? FG_REACH_ADDRESS : FG_REACH_ANY;
  }
  const struct in6_addr *six = &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(six)      ? FG_REACH_LOCAL
         : IN6_IS_ADDR_UNSPECIFIED(six) ? FG_REACH_ANY
                                        : FG_REACH_ADDRESS;
}

/* Checks a token: it must fit into an address and a cookie. */
static fg_status check_token(fg_context *ctx, const char *token) {
  static const char allowed[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.~";
  size_t length = strlen(token);
  if (length >= FG_TOKEN_MIN && length <= FG_TOKEN_MAX && strspn(token, allowed) == length)
    return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE, "a token needs %d to %d of the characters A-Z a-z 0-9 - _ . ~",
                 FG_TOKEN_MIN, FG_TOKEN_MAX);
}

static fg_status check_names(fg_context *ctx, const fg_station_request *request) {
  place at;
  for (size_t i = 0; i < request->host_count; i++)
    if (!read_place(request->hosts[i], &at) || strpbrk(request->hosts[i], "/?#@ "))
      return fg_fail(ctx, FG_ERR_USAGE, "--host: '%.100s' is no name, as scanner.example.com",
                     request->hosts[i]);
  if (!request->origin) return FG_OK;
  if (!is_origin(request->origin))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--origin: '%.100s' is none, as https://scanner.example.com, without a path",
                   request->origin);
  if (!request->token && !request->users)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--origin: others can reach the station by a proxy: give --token-file with at "
                   "least %d characters",
                   FG_TOKEN_MIN);
  return FG_OK;
}

fg_status fg_reach_find(fg_context *ctx, const fg_station_request *request,
                        struct sockaddr_storage *address, fg_reach *reach) {
  const char *text = request->listen ? request->listen : "127.0.0.1";
  if (!read_address(text, request->port, address))
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--listen: '%.60s' is no address, as 192.168.1.20 or ::", text);
  *reach = find_reach(address);
  if (*reach != FG_REACH_LOCAL && !request->token && !request->users)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--listen %s: others can reach this address: give --token-file with at least "
                   "%d characters",
                   text, FG_TOKEN_MIN);
  FG_TRY(check_names(ctx, request));
  return request->token ? check_token(ctx, request->token) : FG_OK;
}

static void write_address_name(const struct sockaddr *address, char name[INET6_ADDRSTRLEN]) {
  const void *bytes =
      address->sa_family == AF_INET
          ? (const void *)&((const struct sockaddr_in *)(const void *)address)->sin_addr
          : &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;
  name[0] = '\0';
  inet_ntop(address->sa_family, bytes, name, INET6_ADDRSTRLEN);
}

void fg_reach_write(const struct sockaddr_storage *address, unsigned port, char *text,
                    size_t size) {
  char name[INET6_ADDRSTRLEN];
  bool six = address->ss_family == AF_INET6;
  write_address_name((const void *)address, name);
  snprintf(text, size, "%s%s%s:%u", six ? "[" : "", name, six ? "]" : "", port);
}

static bool is_internet(const struct ifaddrs *at) {
  return at->ifa_addr && at->ifa_flags & IFF_UP &&
         (at->ifa_addr->sa_family == AF_INET || at->ifa_addr->sa_family == AF_INET6);
}

/* Addresses come and go with networks: they are asked for each time. */
static bool is_address_of_machine(const char *name) {
  struct sockaddr_storage given;
  struct ifaddrs *all;
  bool found = false;
  if (!read_address(name, 0, &given) || getifaddrs(&all) != 0) return false;
  char wanted[INET6_ADDRSTRLEN], own[INET6_ADDRSTRLEN];
  write_address_name((const void *)&given, wanted);
  for (const struct ifaddrs *at = all; at && !found; at = at->ifa_next) {
    if (!is_internet(at) || at->ifa_addr->sa_family != given.ss_family) continue;
    write_address_name(at->ifa_addr, own);
    found = !strcmp(own, wanted);
  }
  freeifaddrs(all);
  return found;
}

/* Its name, without its domain too, and as the network without a server of names has it. */
static bool is_name_of_machine(const char *name) {
  char own[NAME_BYTES], local[NAME_BYTES + 8];
  if (gethostname(own, sizeof own) != 0 || !memchr(own, '\0', sizeof own) || !own[0]) return false;
  if (!strcasecmp(name, own)) return true;
  own[strcspn(own, ".")] = '\0';
  snprintf(local, sizeof local, "%s.local", own);
  return !strcasecmp(name, own) || !strcasecmp(name, local);
}

/* True when a host is the given name: as it was given, or, given without a port, with the
 * station's port. */
static bool is_given(const char *given, const char *host, const place *at, unsigned port) {
  place own;
  if (!strcasecmp(given, host)) return true;
  return read_place(given, &own) && !own.port && !strcasecmp(own.name, at->name) &&
         at->port == port;
}

bool fg_reach_is_host(const fg_inspection *station, const char *host) {
  const fg_station_request *request = station->request;
  place at, own;
  if (!host || !read_place(host, &at) || !read_place(station->host, &own)) return false;
  if (request->origin && !strcasecmp(host, host_of_origin(request->origin))) return true;
  for (size_t i = 0; i < request->host_count; i++)
    if (is_given(request->hosts[i], host, &at, own.port)) return true;
  if ((at.port ? at.port : DEFAULT_PORT) != own.port) return false;
  if (!strcasecmp(at.name, own.name)) return true;
  if (!strcasecmp(at.name, "localhost"))
    return station->reach == FG_REACH_ANY || (station->reach == FG_REACH_LOCAL && !request->token);
  if (station->reach != FG_REACH_LOCAL && is_name_of_machine(at.name)) return true;
  return station->reach == FG_REACH_ANY && is_address_of_machine(at.name);
}

bool fg_reach_is_origin(const fg_inspection *station, const char *host, const char *origin) {
  const char *given = station->request->origin;
  if (given && !strcasecmp(origin, given)) return true;
  return !strncmp(origin, "http://", 7) && !strcmp(origin + 7, host);
}

static void announce_address(const fg_inspection *station, const char *scheme, const char *host) {
  const fg_station_request *request = station->request;
  char url[600];
  snprintf(url, sizeof url, "%s%s/%s%s", scheme, host, request->token ? "?token=" : "",
           request->token ? request->token : "");
  request->ready(request->user, url);
}

/* Link-local addresses of IPv6 are left out: they need the name of a network card, which no
 * browser accepts. */
static bool is_for_others(const struct ifaddrs *at, int family) {
  if (!is_internet(at) || at->ifa_flags & IFF_LOOPBACK) return false;
  if (at->ifa_addr->sa_family == AF_INET) return true;
  const struct sockaddr_in6 *six = (const void *)at->ifa_addr;
  return family == AF_INET6 && !IN6_IS_ADDR_LINKLOCAL(&six->sin6_addr);
}

static void announce_all(const fg_inspection *station, const place *own) {
  struct ifaddrs *all = NULL;
  char host[INET6_ADDRSTRLEN + 16];
  int family = strchr(own->name, ':') ? AF_INET6 : AF_INET;
  size_t told = 0;
  if (getifaddrs(&all) != 0) all = NULL;
  for (const struct ifaddrs *at = all; at; at = at->ifa_next) {
    struct sockaddr_storage address = {0};
    if (!is_for_others(at, family)) continue;
    memcpy(&address, at->ifa_addr,
           at->ifa_addr->sa_family == AF_INET ? sizeof(struct sockaddr_in)
                                              : sizeof(struct sockaddr_in6));
    fg_reach_write(&address, own->port, host, sizeof host);
    announce_address(station, "http://", host);
    told++;
  }
  freeifaddrs(all);
  snprintf(host, sizeof host, "127.0.0.1:%u", own->port);
  if (!told) announce_address(station, "http://", host);
}

void fg_reach_announce(const fg_inspection *station) {
  const fg_station_request *request = station->request;
  place own;
  if (!request->ready || !read_place(station->host, &own)) return;
  if (request->origin) announce_address(station, "", request->origin);
  if (station->reach == FG_REACH_ANY)
    announce_all(station, &own);
  else
    announce_address(station, "http://", station->host);
}
