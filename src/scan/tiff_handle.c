/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libtiff's access to the source, and its messages. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "scan/tiff_reader.h"

/* Max bytes of one allocation by libtiff. */
#define ALLOCATION_MAX ((tmsize_t)1 << 30)

static tmsize_t on_read(thandle_t handle, void *out, tmsize_t wanted) {
  fg_tiff_handle *h = handle;
  ssize_t got = h->window
                    ? fg_source_read_window(h->source, h->window, out, (size_t)wanted, h->position)
                    : fg_source_read_at(h->source, out, (size_t)wanted, h->position);
  if (got > 0) h->position += (uint64_t)got;
  return got;
}

static tmsize_t on_write(thandle_t handle, void *bytes, tmsize_t size) {
  (void)handle;
  (void)bytes;
  (void)size;
  return -1;
}

static toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  fg_tiff_handle *h = handle;
  uint64_t base = whence == SEEK_CUR ? h->position : whence == SEEK_END ? h->source->size : 0;
  if (base + offset > INT64_MAX) return (toff_t)-1;
  h->position = base + offset;
  return h->position;
}

static int on_close(thandle_t handle) {
  (void)handle;
  return 0;
}

static toff_t on_size(thandle_t handle) {
  return ((fg_tiff_handle *)handle)->source->size;
}

static int on_error(TIFF *tiff, void *user, const char *module, const char *format,
                    va_list values) {
  (void)tiff;
  (void)module;
  fg_tiff_handle *h = user;
  if (h->complained) return 1; /* the first message is the cause */
  vsnprintf(h->words, sizeof h->words, format, values);
  for (char *c = h->words; *c; c++)
    if (!isprint((unsigned char)*c)) *c = '?';
  h->complained = true;
  return 1;
}

static int on_warning(TIFF *tiff, void *user, const char *module, const char *format,
                      va_list values) {
  fg_tiff_handle *h = user;
  if (strstr(format, "StripByteCounts")) h->counts_replaced = true;
  return h->strict && h->in_image ? on_error(tiff, user, module, format, values) : 1;
}

bool fg_tiff_handle_open(fg_tiff_handle *h) {
  TIFFOpenOptions *options = fg_libtiff.OpenOptionsAlloc();
  if (!options) return false;
  fg_libtiff.OpenOptionsSetMaxSingleMemAlloc(options, ALLOCATION_MAX);
  fg_libtiff.OpenOptionsSetErrorHandlerExtR(options, on_error, h);
  fg_libtiff.OpenOptionsSetWarningHandlerExtR(options, on_warning, h);
  /* m: no mapping; c: strips as they are. */
  h->tiff = fg_libtiff.ClientOpenExt(h->source->name, "rmc", h, on_read, on_write, on_seek,
                                     on_close, on_size, NULL, NULL, options);
  fg_libtiff.OpenOptionsFree(options);
  if (!h->tiff && !h->words[0]) snprintf(h->words, sizeof h->words, "it cannot be decoded");
  return h->tiff;
}

void fg_tiff_handle_close(fg_tiff_handle *h) {
  if (h->tiff) fg_libtiff.Close(h->tiff);
  h->tiff = NULL;
}

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
