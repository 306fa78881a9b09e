/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/scan.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/sha256.h"
#include "scan/average.h"
#include "scan/contrast.h"
#include "scan/format.h"
#include "scan/gray.h"
#include "scan/header.h"
#include "scan/source.h"

enum { HEAD_BYTES = 512 }; /* bytes that tell the format */

struct fg_scan {
  fg_source source;
  const fg_format *format;
  void *reader; /* of the format */
  fg_scan_header header;
  fg_gray gray;
  fg_gray colours[3];     /* after fg_scan_begin_colours */
  void *samples;          /* buffer for a row of samples; NULL where they need no conversion */
  fg_average average;     /* of the gray rows */
  fg_average averages[3]; /* of the colours */
  void *fine;             /* a gray row before it is averaged; NULL: none is */
  fg_scan_info info;
  unsigned threads;
  int64_t rows_read; /* of the file */
  bool broken;       /* an error ended the reading */
  bool ended;        /* all was read and checked, to the end of the file */
};

static fg_status find_format(fg_context *ctx, const fg_scan_options *options, fg_scan *scan) {
  fg_source *source = &scan->source;
  const uint8_t *head = NULL;
  size_t length = fg_source_peek(source, HEAD_BYTES, &head);
  if (source->error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s; check the disk or copy it again",
                   source->name, strerror(source->error));
  scan->format = fg_format_find(head, length);
  if (!scan->format) {
    char problem[300];
    fg_format_problem(head, length, problem, sizeof problem);
    return fg_fail(ctx, FG_ERR_DATA, "%s: %s", source->name, problem);
  }
  bool twice = options->channel == FG_CHANNEL_AUTO && scan->format->has_colour(head, length);
  return twice || scan->format->needs_file ? fg_source_store(ctx, source) : FG_OK;
}

/* Refuses sizes over the cap before anything is decoded: a few bytes can declare a size that fills
 * the memory or takes days. */
static fg_status check_size(fg_context *ctx, const fg_scan *scan, uint64_t cap) {
  const fg_scan_header *header = &scan->header;
  const char *name = scan->source.name;
  uint64_t pixels = 0;
  if (cap == 0) cap = (uint64_t)FG_SCAN_PIXEL_CAP;
  if (__builtin_mul_overflow(header->width_px, header->height_px, &pixels) || pixels > cap)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: has %" PRIu64 " x %" PRIu64 " pixels, more than the %" PRIu64
                   " that are read; scan a smaller area",
                   name, header->width_px, header->height_px, cap);
  if (header->width_px > FG_SCAN_WIDTH_MAX_PX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is %" PRIu64 " pixels wide, more than the %d that are read; scan a "
                   "narrower area",
                   name, header->width_px, FG_SCAN_WIDTH_MAX_PX);
  if (scan->source.regular && header->bytes_min > (double)scan->source.size)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: declares %" PRIu64 " x %" PRIu64 " pixels, which its %" PRIu64
                   " bytes cannot hold; copy or scan it again",
                   name, header->width_px, header->height_px, scan->source.size);
  return FG_OK;
}

static fg_status check_memory(fg_context *ctx, const fg_scan *scan, uint64_t cap) {
  const fg_scan_header *header = &scan->header;
  if (cap == 0 || header->memory_bytes <= cap) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: needs %" PRIu64 " MiB to be decoded, more than the %" PRIu64
                 " MiB that it may take (--max-memory); save it in strips of a few rows, not "
                 "interlaced",
                 scan->source.name, header->memory_bytes >> 20, cap >> 20);
}

static void fill_info(fg_scan *scan) {
  const fg_scan_header *header = &scan->header;
  fg_scan_info *info = &scan->info;
  info->width_px = (int64_t)header->width_px;
  info->height_px = (int64_t)header->height_px;
  info->bit_depth = header->bit_depth;
  info->bytes_per_pixel = header->bit_depth == 16 ? 2 : 1;
  info->format = scan->format->name;
  info->colour = header->colour || header->has_palette || header->luminance_only;
  info->jpeg_quality = header->jpeg_quality;
  info->memory_bytes = header->memory_bytes;
  memcpy(info->warning, header->warning, sizeof info->warning);
}

static fg_status open_format(fg_context *ctx, const fg_scan_options *options, fg_scan *scan) {
  FG_TRY(scan->format->open(ctx, &scan->source, options, &scan->reader, &scan->header));
  FG_TRY(check_size(ctx, scan, options->pixel_cap));
  return check_memory(ctx, scan, options->memory_cap);
}

static size_t count_sample_bytes(const fg_scan *scan) {
  return (size_t)(scan->header.channels * scan->info.bytes_per_pixel);
}

/* Back to the first row. */
static fg_status begin_again(fg_context *ctx, const fg_scan_options *options, fg_scan *scan) {
  scan->format->close(scan->reader);
  scan->reader = NULL;
  FG_TRY(fg_source_rewind(ctx, &scan->source));
  FG_TRY(open_format(ctx, options, scan));
  return scan->format->start(ctx, scan->reader);
}

/* Reads the scan once to find the channel, and begins again. */
static fg_status find_channel(fg_context *ctx, const fg_scan_options *options, fg_scan *scan) {
  fg_contrast contrast = {.header = &scan->header};
  for (int64_t y = 0; y < (int64_t)scan->header.height_px; y++) {
    FG_TRY(scan->format->read_row(ctx, scan->reader, scan->samples));
    fg_contrast_add_row(&contrast, y, scan->samples);
  }
  scan->info.channel = fg_contrast_best(&contrast);
  return begin_again(ctx, options, scan);
}

static fg_status prepare_rows(fg_context *ctx, const fg_scan_options *options, fg_scan *scan) {
  FG_TRY(scan->format->start(ctx, scan->reader));
  scan->info.channel = options->channel;
  bool find =
      options->channel == FG_CHANNEL_AUTO && scan->info.colour && !scan->header.luminance_only;
  if (options->channel == FG_CHANNEL_AUTO) scan->info.channel = FG_CHANNEL_LUMINANCE;
  fg_gray_init(&scan->header, scan->info.channel, &scan->gray);
  if (!scan->gray.convert) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, (size_t)scan->header.width_px, count_sample_bytes(scan),
                            &scan->samples));
  if (!find) return FG_OK;
  FG_TRY(find_channel(ctx, options, scan));
  fg_gray_init(&scan->header, scan->info.channel, &scan->gray);
  return FG_OK;
}

static bool is_averaged(const fg_scan *scan) {
  return scan->info.averaged[0] > 1 || scan->info.averaged[1] > 1;
}

static fg_status open_average(fg_context *ctx, const fg_scan *scan, fg_average *average) {
  const fg_scan_info *info = &scan->info;
  *average = (fg_average){.columns = info->averaged[0],
                          .rows = info->averaged[1],
                          .width = (size_t)info->width_px,
                          .bytes_per_pixel = info->bytes_per_pixel};
  return fg_average_open(ctx, average);
}

static fg_status prepare_averages(fg_context *ctx, fg_scan *scan) {
  if (!is_averaged(scan)) return FG_OK;
  if (scan->info.width_px == 0 || scan->info.height_px == 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s: has too few pixels for its resolutions; scan it again",
                   scan->source.name);
  FG_TRY(fg_memory_allocate(ctx, (size_t)scan->header.width_px, (size_t)scan->info.bytes_per_pixel,
                            &scan->fine));
  return open_average(ctx, scan, &scan->average);
}

static fg_status open_scan(fg_context *ctx, const char *path, const fg_scan_options *options,
                           fg_scan *scan) {
  if (options->dpi != 0) FG_TRY(fg_scan_check_dpi(ctx, options->dpi));
  FG_TRY(fg_source_open(ctx, path, options->only_file, &scan->source));
  scan->source.unsummed = options->unsummed;
  scan->source.sum.alone = options->threads == 1;
  scan->threads = options->threads;
  FG_TRY(find_format(ctx, options, scan));
  FG_TRY(open_format(ctx, options, scan));
  fill_info(scan);
  FG_TRY(fg_resolution_find(ctx, scan->source.name, &scan->header, options, &scan->info));
  FG_TRY(prepare_averages(ctx, scan));
  return prepare_rows(ctx, options, scan);
}

/* Sums a file that was opened but is no scan. */
static void sum_failed(const fg_scan_options *options, fg_scan *scan) {
  char *hex = options->failed_sha256;
  if (!hex) return;
  hex[0] = '\0';
  if (scan->source.regular && fg_source_sha256(NULL, &scan->source, hex) != FG_OK) hex[0] = '\0';
}

fg_status fg_scan_open(fg_context *ctx, const char *path, const fg_scan_options *options,
                       fg_scan **scan) {
  static const fg_scan_options defaults = {0};
  fg_scan *opened = NULL;
  *scan = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *opened, (void **)&opened));
  opened->source.descriptor = -1;
  if (!options) options = &defaults;
  fg_status status = open_scan(ctx, path, options, opened);
  if (status == FG_OK)
    *scan = opened;
  else
    sum_failed(options, opened);
  if (status != FG_OK) fg_scan_close(opened);
  return status;
}

const fg_scan_info *fg_scan_get_info(const fg_scan *scan) {
  return &scan->info;
}

static fg_status finish_scan(fg_context *ctx, fg_scan *scan) {
  FG_TRY(scan->format->finish(ctx, scan->reader));
  FG_TRY(fg_source_drain(ctx, &scan->source));
  scan->ended = true;
  return FG_OK;
}

static size_t count_row_bytes(const fg_scan *scan) {
  return (size_t)scan->info.width_px * (size_t)scan->info.bytes_per_pixel;
}

static fg_status convert_row(fg_context *ctx, fg_scan *scan, void *out) {
  size_t width = (size_t)scan->header.width_px;
  FG_TRY(scan->format->read_row(ctx, scan->reader, scan->samples));
  size_t invalid = fg_gray_find_invalid(&scan->gray, scan->samples, width);
  if (invalid < width)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is a damaged %s: the pixel at row %" PRId64 ", column %zu has colour %d of "
                   "a palette of %zu; copy or scan it again",
                   scan->source.name, scan->format->name, scan->rows_read + 1, invalid + 1,
                   ((const uint8_t *)scan->samples)[invalid], scan->gray.table_size);
  scan->gray.convert(&scan->gray, scan->samples, width, out);
  return FG_OK;
}

static fg_status read_one_row(fg_context *ctx, fg_scan *scan, void *out) {
  FG_TRY(scan->gray.convert ? convert_row(ctx, scan, out)
                            : scan->format->read_row(ctx, scan->reader, out));
  scan->rows_read++;
  return FG_OK;
}

static fg_status read_averaged_row(fg_context *ctx, fg_scan *scan, void *out) {
  for (int r = 0; r < scan->average.rows; r++) {
    FG_TRY(read_one_row(ctx, scan, scan->fine));
    fg_average_add(&scan->average, scan->fine);
  }
  fg_average_put(&scan->average, out);
  return FG_OK;
}

static int64_t rows_left(const fg_scan *scan) {
  return scan->info.height_px - scan->rows_read / scan->info.averaged[1];
}

/* Reads and checks the last rows, too few for a row of averages. */
static fg_status read_remainder(fg_context *ctx, fg_scan *scan) {
  while (scan->rows_read < (int64_t)scan->header.height_px)
    FG_TRY(read_one_row(ctx, scan, scan->fine));
  return FG_OK;
}

static fg_status read_gray_rows(fg_context *ctx, fg_scan *scan, int64_t rows, void *out,
                                int64_t stride_bytes) {
  for (int64_t i = 0; i < rows; i++) {
    char *row = (char *)out + i * stride_bytes;
    FG_TRY(scan->fine ? read_averaged_row(ctx, scan, row) : read_one_row(ctx, scan, row));
  }
  if (rows_left(scan) || scan->ended) return FG_OK;
  FG_TRY(read_remainder(ctx, scan));
  return finish_scan(ctx, scan);
}

fg_status fg_scan_read_rows(fg_context *ctx, fg_scan *scan, int64_t rows, void *out,
                            int64_t stride_bytes) {
  const char *name = scan->source.name;
  if (scan->broken) return fg_fail(ctx, FG_ERR_USAGE, "%s: was read on after an error", name);
  if (rows < 0 || rows > rows_left(scan))
    return fg_fail(ctx, FG_ERR_USAGE, "%s: %" PRId64 " rows wanted where %" PRId64 " are left",
                   name, rows, rows_left(scan));
  if (rows > 1 && stride_bytes < (int64_t)count_row_bytes(scan))
    return fg_fail(ctx, FG_ERR_USAGE, "%s: rows of %zu bytes do not fit a stride of %" PRId64, name,
                   count_row_bytes(scan), stride_bytes);
  fg_status status = read_gray_rows(ctx, scan, rows, out, stride_bytes);
  scan->broken = status != FG_OK;
  return status;
}

bool fg_scan_has_colours(const fg_scan *scan) {
  const fg_scan_header *header = &scan->header;
  return (header->colour || header->has_palette) && !header->luminance_only &&
         !header->jpeg_quality && scan->source.regular;
}

fg_status fg_scan_begin_colours(fg_context *ctx, fg_scan *scan) {
  if (!fg_scan_has_colours(scan) || scan->broken)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: its colours cannot be read apart", scan->source.name);
  const fg_scan_options options = {
      .allow_lossy = true, .pixel_cap = UINT64_MAX, .unsummed = true, .threads = scan->threads};
  for (int i = 0; i < 3; i++) {
    fg_gray_init(&scan->header, (fg_channel)(FG_CHANNEL_RED + i), &scan->colours[i]);
    FG_TRY(open_average(ctx, scan, &scan->averages[i]));
  }
  scan->source.unsummed = true; /* it is known, or not requested */
  scan->broken = true;          /* its gray rows are over */
  return begin_again(ctx, &options, scan);
}

fg_status fg_scan_read_colours(fg_context *ctx, fg_scan *scan, void *const planes[3]) {
  size_t width = (size_t)scan->header.width_px;
  for (int r = 0; r < scan->info.averaged[1]; r++) {
    FG_TRY(scan->format->read_row(ctx, scan->reader, scan->samples));
    for (int i = 0; i < 3; i++) {
      void *row = scan->fine ? scan->fine : planes[i];
      scan->colours[i].convert(&scan->colours[i], scan->samples, width, row);
      if (scan->fine) fg_average_add(&scan->averages[i], row);
    }
  }
  for (int i = 0; scan->fine && i < 3; i++)
    fg_average_put(&scan->averages[i], planes[i]);
  return FG_OK;
}

unsigned fg_scan_get_threads(const fg_scan *scan) {
  return scan->threads;
}

bool fg_scan_is_file(const fg_scan *scan) {
  return scan->source.regular;
}

bool fg_scan_sums_apart(const fg_scan *scan) {
  return scan->format->needs_file;
}

fg_status fg_scan_check_unchanged(fg_context *ctx, fg_scan *scan) {
  return fg_source_check_unchanged(ctx, &scan->source);
}

fg_status fg_scan_sha256(fg_context *ctx, fg_scan *scan, char hex[65]) {
  fg_source *source = &scan->source;
  if (source->unsummed)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: was opened without its SHA-256", source->name);
  if (!source->regular && !scan->ended)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: its SHA-256 is known after the last row only",
                   source->name);
  if (!source->jumps && !scan->ended) {
    scan->broken = true;
    if (scan->format->stop) scan->format->stop(scan->reader);
  }
  return fg_source_sha256(ctx, source, hex);
}

void fg_scan_close(fg_scan *scan) {
  if (!scan) return;
  if (scan->format) scan->format->close(scan->reader);
  fg_source_close(&scan->source);
  fg_average_close(&scan->average);
  for (int i = 0; i < 3; i++)
    fg_average_close(&scan->averages[i]);
  free(scan->fine);
  free(scan->samples);
  free(scan);
}
