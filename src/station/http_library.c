/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/http_library.h"

fg_http_library fg_microhttpd;

static const char *const names[] = {FG_HTTP_FUNCTIONS(FG_LIBRARY_NAME)};

static fg_library library =
    FG_LIBRARY(FOILGAUGE_MICROHTTPD_FILE, "libmicrohttpd12", names, &fg_microhttpd, NULL);

fg_status fg_http_library_load(fg_context *ctx) {
  return fg_library_load(ctx, &library);
}
