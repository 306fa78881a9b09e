/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libmicrohttpd, which is loaded when pages are served (core/library.h). */
#ifndef FG_STATION_HTTP_LIBRARY_H
#define FG_STATION_HTTP_LIBRARY_H

#include <microhttpd.h>

#include "core/library.h"

/* clang-format off */
#define FG_HTTP_FUNCTIONS(F) \
  F(MHD_, add_response_header) \
  F(MHD_, create_response_from_buffer) \
  F(MHD_, destroy_response) \
  F(MHD_, get_connection_info) \
  F(MHD_, get_connection_values) \
  F(MHD_, get_daemon_info) \
  F(MHD_, lookup_connection_value) \
  F(MHD_, queue_response) \
  F(MHD_, resume_connection) \
  F(MHD_, start_daemon) \
  F(MHD_, stop_daemon) \
  F(MHD_, suspend_connection)
/* clang-format on */

/* Functions of libmicrohttpd, less MHD_ in front. */
typedef struct fg_http_library {
  FG_HTTP_FUNCTIONS(FG_LIBRARY_POINTER)
} fg_http_library;

extern fg_http_library fg_microhttpd; /* NULL before fg_http_library_load */

fg_status fg_http_library_load(fg_context *ctx);

#endif
