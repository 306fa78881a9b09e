/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pages on a socket: libmicrohttpd carries, answer.h answers. */
#ifndef FG_STATION_SERVER_H
#define FG_STATION_SERVER_H

#include "station/state.h"

/* Listens, and calls the request's `ready` with the addresses. FG_ERR_IO: the address is taken
 * or not ours; FG_ERR_USAGE: an address beyond this machine without a token. */
fg_status fg_station_server_start(fg_context *ctx, fg_inspection *station);
void fg_station_server_stop(fg_inspection *station);

#endif
