/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Addresses and names of the pages. A request for any other name comes from a page of another site,
 * which could read ours (DNS rebinding). */
#ifndef FG_STATION_REACH_H
#define FG_STATION_REACH_H

#include <sys/socket.h>

#include "station/state.h"

/* Finds the address to listen at. FG_ERR_USAGE: it is no address; or other machines can reach
 * the station (directly, or by a proxy: --origin) and there is no token; or a token, host or
 * origin is not valid. */
fg_status fg_reach_find(fg_context *ctx, const fg_station_request *request,
                        struct sockaddr_storage *address, fg_reach *reach);

/* Writes "192.168.1.20:8317" or "[::1]:8317"; `port` is that of the socket. */
void fg_reach_write(const struct sockaddr_storage *address, unsigned port, char *text, size_t size);

/* Calls the request's `ready` with every address that a browser can open. */
void fg_reach_announce(const fg_inspection *station);

/* True where a request's Host is this station's: its address, localhost where only this machine can
 * reach it, --host, the host of --origin; names of the machine where others can reach it, and every
 * address of the machine where it listens at all of them. */
bool fg_reach_is_host(const fg_inspection *station, const char *host);

/* True where a form's Origin is that host, or --origin. */
bool fg_reach_is_origin(const fg_inspection *station, const char *host, const char *origin);

#endif
