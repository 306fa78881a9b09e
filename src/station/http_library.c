/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/http_library.h"

fg_http_library fg_microhttpd;

static const char *const names[] = {FG_HTTP_FUNCTIONS(FG_LIBRARY_NAME)};

static fg_library library = {.file = FOILGAUGE_MICROHTTPD_FILE,
                             .package = "libmicrohttpd12",
                             .names = names,
                             .count = sizeof names / sizeof *names,
                             .functions = &fg_microhttpd,
                             .mutex = PTHREAD_MUTEX_INITIALIZER};

fg_status fg_http_library_load(fg_context *ctx) {
  return fg_library_load(ctx, &library);
}
