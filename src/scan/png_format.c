/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNG as one of the formats: the common header; interlaced images decoded whole. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/format.h"
#include "scan/interlace.h"
#include "scan/png_reader.h"

#define METRES_PER_INCH 0.0254
/* Limit of an interlaced image, which lies in memory whole; a scanner does not write such files. */
#define INTERLACED_BYTES_CAP ((uint64_t)1 << 30)
/* Max expansion by deflate: 258 bytes from 2 bits. */
#define DEFLATE_RATIO_MAX 1032.0

typedef struct png_reader {
  fg_png *png;
  const char *name;
  bool beside;      /* a thread may help */
  size_t row_bytes; /* of samples */
  uint8_t *image;   /* of an interlaced one, once it is decoded */
  size_t rows_read;
} png_reader;

static bool matches_png(const uint8_t *head, size_t length) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  return !memcmp(head, signature, length < sizeof signature ? length : sizeof signature);
}

/* Colour type, byte 25: the second bit says colour (or palette). */
static bool has_png_colour(const uint8_t *head, size_t length) {
  return length > 25 && head[25] & 2;
}

static void fill_resolution(const fg_png_header *png, fg_scan_header *header) {
  bool known = png->has_phys && png->phys_in_metres;
  for (int axis = 0; axis < 2; axis++)
    header->dpi[axis] = known ? png->per_metre[axis] * METRES_PER_INCH : NAN;
  if (!png->has_phys)
    header->no_dpi = "no usable pHYs chunk";
  else if (!known)
    header->no_dpi = "chunk pHYs holds the shape of its pixels only";
  snprintf(header->dpi_source, sizeof header->dpi_source, "chunk pHYs: %u × %u pixels per metre",
           png->per_metre[0], png->per_metre[1]);
}

static void fill_header(const fg_png_header *png, fg_scan_header *header) {
  *header = (fg_scan_header){.width_px = png->width_px,
                             .height_px = png->height_px,
                             .bit_depth = png->bit_depth,
                             .channels = png->channels,
                             .colour = png->channels >= 3,
                             .has_palette = png->has_palette,
                             .palette_size = png->palette_size};
  memcpy(header->palette, png->palette, sizeof header->palette);
  fill_resolution(png, header);
  double row_bits = (double)png->width_px * png->channels * png->bit_depth;
  header->bytes_min = png->height_px * (row_bits / 8 + 1) / DEFLATE_RATIO_MAX;
}

static fg_status open_png(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                          void **out, fg_scan_header *header) {
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(png_reader), out));
  png_reader *reader = *out;
  reader->beside = options->threads != 1;
  reader->name = source->name;
  FG_TRY(fg_png_open(ctx, source, &reader->png));
  const fg_png_header *png = fg_png_get_header(reader->png);
  fill_header(png, header);
  reader->row_bytes =
      (size_t)png->width_px * (size_t)png->channels * (png->bit_depth == 16 ? 2 : 1);
  if (!png->interlaced) return FG_OK;
  header->memory_bytes = (uint64_t)reader->row_bytes * png->height_px;
  if (header->memory_bytes > INTERLACED_BYTES_CAP)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is interlaced and needs %llu MiB of memory; save it without interlacing",
                   source->name, (unsigned long long)header->memory_bytes >> 20);
  return FG_OK;
}

static fg_status start_png(fg_context *ctx, void *r) {
  png_reader *reader = r;
  return fg_png_start(ctx, reader->png, reader->beside);
}

static fg_status decode_whole(fg_context *ctx, png_reader *reader) {
  const fg_png_header *png = fg_png_get_header(reader->png);
  void *row = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, reader->row_bytes, 1, &row));
  FG_TRY_EXIT(fg_memory_allocate(ctx, reader->row_bytes, png->height_px, (void **)&reader->image));
  FG_TRY_EXIT(fg_interlace_read(ctx, reader->png, row, reader->image));
exit:
  free(row);
  return status;
}

static fg_status read_png_row(fg_context *ctx, void *r, void *samples) {
  png_reader *reader = r;
  if (!fg_png_get_header(reader->png)->interlaced)
    return fg_png_read_row(ctx, reader->png, samples);
  if (!reader->image) FG_TRY(decode_whole(ctx, reader));
  memcpy(samples, reader->image + reader->rows_read++ * reader->row_bytes, reader->row_bytes);
  return FG_OK;
}

static fg_status finish_png(fg_context *ctx, void *r) {
  return fg_png_finish(ctx, ((png_reader *)r)->png);
}

static void stop_png(void *r) {
  fg_png_stop(((png_reader *)r)->png);
}

static void close_png(void *r) {
  png_reader *reader = r;
  if (!reader) return;
  fg_png_close(reader->png);
  free(reader->image);
  free(reader);
}

static const char *const endings[] = {".png", NULL};

const fg_format fg_format_png = {.name = "PNG",
                                 .endings = endings,
                                 .matches = matches_png,
                                 .has_colour = has_png_colour,
                                 .open = open_png,
                                 .start = start_png,
                                 .read_row = read_png_row,
                                 .finish = finish_png,
                                 .stop = stop_png,
                                 .close = close_png};
