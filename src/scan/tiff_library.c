/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/tiff_library.h"

fg_tiff_library fg_libtiff;

static const char *const names[] = {FG_TIFF_FUNCTIONS(FG_LIBRARY_NAME)};

static fg_library library = FG_LIBRARY(FOILGAUGE_TIFF_FILE, "libtiff6", names, &fg_libtiff, NULL);

fg_status fg_tiff_library_load(fg_context *ctx) {
  return fg_library_load(ctx, &library);
}
