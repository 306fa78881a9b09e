/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is wrong with a TIFF, in words. */
#include <string.h>

#include "scan/tiff_reader.h"

fg_status fg_tiff_fail(fg_context *ctx, const fg_tiff *r, const char *what) {
  char place[64] = "";
  if (r->main.in_image)
    snprintf(place, sizeof place, " (row %llu of %llu)", (unsigned long long)r->row + 1,
             (unsigned long long)r->height);
  if (r->source->error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read%s: %s; check the disk or copy it again",
                   r->source->name, place, strerror(r->source->error));
  return fg_fail(ctx, FG_ERR_DATA, "%s: is a damaged TIFF: %s%s; copy or scan it again",
                 r->source->name, *what ? what : "it cannot be decoded", place);
}
