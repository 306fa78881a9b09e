/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libmicrohttpd, which is loaded when pages are served (core/library.h). */
#ifndef FG_STATION_HTTP_LIBRARY_H
#define FG_STATION_HTTP_LIBRARY_H

#include <microhttpd.h>

#include "foilgauge/status.h"

/* clang-format off */
#define FG_HTTP_FUNCTIONS(F) \
  F(add_response_header) \
  F(create_response_from_buffer) \
  F(destroy_response) \
  F(get_connection_info) \
  F(get_connection_values) \
  F(get_daemon_info) \
  F(lookup_connection_value) \
  F(queue_response) \
  F(resume_connection) \
  F(start_daemon) \
  F(stop_daemon) \
  F(suspend_connection)
/* clang-format on */

/* Functions of libmicrohttpd, less MHD_ in front. */
typedef struct fg_http_library {
#define FG_HTTP_POINTER(name) __typeof__(MHD_##name) *name;
  FG_HTTP_FUNCTIONS(FG_HTTP_POINTER)
#undef FG_HTTP_POINTER
} fg_http_library;

extern fg_http_library fg_microhttpd; /* NULL before fg_http_library_load */

fg_status fg_http_library_load(fg_context *ctx);

#endif
