#include "foilgauge/scan.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/sha256.h"
#include "scan/format.h"
#include "scan/interlace.h"
#include "scan/resolution.h"
#include "scan/row.h"
#include "scan/source.h"

#define DEFAULT_PIXEL_CAP 4000000000u
/* An interlaced image lies in memory whole; a scanner does not write such files. */
#define INTERLACED_BYTES_CAP ((uint64_t)1 << 30)
/* The most that deflate can make of a byte: 258 bytes from 2 bits. */
#define DEFLATE_RATIO_MAX 1032.0

struct fg_scan {
  fg_source source;
  fg_row_reader rows;
  fg_scan_info info;
  bool interlaced;
  uint8_t *image; /* of an interlaced scan, once it is decoded */
  int64_t rows_read;
  bool broken; /* an error ended it */
  bool ended;  /* all was read and checked, to the end of the file */
};

static fg_status check_format(fg_context *ctx, fg_source *source) {
  const uint8_t *head = NULL;
  size_t length = fg_source_peek(source, 512, &head);
  if (source->error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s; check the disk or copy it again",
                   source->name, strerror(source->error));
  const char *problem = fg_format_problem(head, length);
  return problem ? fg_fail(ctx, FG_ERR_DATA, "%s: %s", source->name, problem) : FG_OK;
}

static double count_decoded_bytes(const fg_png_header *header) {
  double row_bits = (double)header->width_px * header->channels * header->bit_depth;
  return header->height_px * (row_bits / 8 + 1);
}

/* A few bytes can declare a size that fills the memory or takes days: refuse it before any of it
 * is decoded. */
static fg_status check_size(fg_context *ctx, const fg_scan *scan, uint64_t cap) {
  const fg_png_header *header = fg_png_get_header(scan->rows.png);
  const char *name = scan->source.name;
  uint64_t pixels = (uint64_t)header->width_px * header->height_px;
  if (cap == 0) cap = DEFAULT_PIXEL_CAP;
  if (pixels > cap)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: has %" PRIu32 " x %" PRIu32 " pixels, more than the %" PRIu64
                   " that are read; scan a smaller area",
                   name, header->width_px, header->height_px, cap);
  if (header->width_px > FG_SCAN_WIDTH_MAX_PX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is %" PRIu32 " pixels wide, more than the %d that are read; scan a "
                   "narrower area",
                   name, header->width_px, FG_SCAN_WIDTH_MAX_PX);
  if (scan->source.regular &&
      count_decoded_bytes(header) > DEFLATE_RATIO_MAX * (double)scan->source.size)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: declares %" PRIu32 " x %" PRIu32 " pixels, which its %" PRIu64
                   " bytes cannot hold; copy or scan it again",
                   name, header->width_px, header->height_px, scan->source.size);
  uint64_t image_bytes = pixels * (header->bit_depth == 16 ? 2 : 1);
  if (header->interlaced && image_bytes > INTERLACED_BYTES_CAP)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is interlaced and needs %" PRIu64
                   " MiB of memory; save it without interlacing",
                   name, image_bytes >> 20);
  return FG_OK;
}

static void fill_info(fg_scan *scan) {
  const fg_png_header *header = fg_png_get_header(scan->rows.png);
  fg_gray_init(&scan->rows.gray, header->channels, header->bit_depth,
               header->has_palette ? header->palette : NULL, header->palette_size);
  scan->interlaced = header->interlaced;
  scan->info.width_px = header->width_px;
  scan->info.height_px = header->height_px;
  scan->info.bit_depth = header->bit_depth;
  scan->info.bytes_per_pixel = scan->rows.gray.bytes_per_pixel;
}

static fg_status prepare_rows(fg_context *ctx, fg_scan *scan) {
  fg_row_reader *rows = &scan->rows;
  FG_TRY(fg_png_start(ctx, rows->png));
  if (!rows->gray.convert) return FG_OK;
  size_t sample_bytes = (size_t)(rows->gray.channels * rows->gray.bytes_per_pixel);
  return fg_memory_allocate(ctx, (size_t)scan->info.width_px, sample_bytes, &rows->samples);
}

static fg_status open_scan(fg_context *ctx, const char *path, const fg_scan_options *options,
                           fg_scan *scan) {
  if (options->dpi != 0) FG_TRY(fg_scan_check_dpi(ctx, options->dpi));
  FG_TRY(fg_source_open(ctx, path, &scan->source));
  FG_TRY(check_format(ctx, &scan->source));
  scan->rows.name = scan->source.name;
  FG_TRY(fg_png_open(ctx, &scan->source, &scan->rows.png));
  FG_TRY(check_size(ctx, scan, options->pixel_cap));
  fill_info(scan);
  FG_TRY(fg_resolution_find(ctx, scan->source.name, fg_png_get_header(scan->rows.png), options->dpi,
                            &scan->info));
  return prepare_rows(ctx, scan);
}

fg_status fg_scan_open(fg_context *ctx, const char *path, const fg_scan_options *options,
                       fg_scan **scan) {
  static const fg_scan_options defaults = {0};
  fg_scan *opened = NULL;
  *scan = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *opened, (void **)&opened));
  opened->source.descriptor = -1;
  fg_status status = open_scan(ctx, path, options ? options : &defaults, opened);
  if (status != FG_OK) {
    fg_scan_close(opened);
    return status;
  }
  *scan = opened;
  return FG_OK;
}

const fg_scan_info *fg_scan_get_info(const fg_scan *scan) {
  return &scan->info;
}

static fg_status finish(fg_context *ctx, fg_scan *scan) {
  FG_TRY(fg_png_finish(ctx, scan->rows.png));
  fg_source_drain(&scan->source);
  if (scan->source.error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read behind the image: %s", scan->source.name,
                   strerror(scan->source.error));
  scan->ended = true;
  return FG_OK;
}

static size_t count_row_bytes(const fg_scan *scan) {
  return (size_t)scan->info.width_px * (size_t)scan->info.bytes_per_pixel;
}

static fg_status decode_whole(fg_context *ctx, fg_scan *scan) {
  void *grays = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count_row_bytes(scan), 1, &grays));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count_row_bytes(scan), (size_t)scan->info.height_px,
                                 (void **)&scan->image));
  FG_TRY_EXIT(fg_interlace_read(ctx, &scan->rows, grays, scan->image));
exit:
  free(grays);
  return status;
}

static fg_status read_one_row(fg_context *ctx, fg_scan *scan, void *out) {
  size_t row = (size_t)scan->rows_read;
  if (scan->interlaced)
    memcpy(out, scan->image + row * count_row_bytes(scan), count_row_bytes(scan));
  else
    FG_TRY(fg_row_read(ctx, &scan->rows, &(fg_row_place){(size_t)scan->info.width_px, row, 0, 1},
                       out));
  scan->rows_read++;
  return FG_OK;
}

static fg_status read_rows(fg_context *ctx, fg_scan *scan, int64_t rows, void *out,
                           int64_t stride_bytes) {
  if (scan->interlaced && !scan->image) FG_TRY(decode_whole(ctx, scan));
  for (int64_t i = 0; i < rows; i++)
    FG_TRY(read_one_row(ctx, scan, (char *)out + i * stride_bytes));
  bool complete = scan->rows_read == scan->info.height_px;
  return complete && !scan->ended ? finish(ctx, scan) : FG_OK;
}

fg_status fg_scan_read_rows(fg_context *ctx, fg_scan *scan, int64_t rows, void *out,
                            int64_t stride_bytes) {
  const char *name = scan->source.name;
  if (scan->broken) return fg_fail(ctx, FG_ERR_USAGE, "%s: was read on after an error", name);
  if (rows < 0 || rows > scan->info.height_px - scan->rows_read)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: %" PRId64 " rows wanted where %" PRId64 " are left",
                   name, rows, scan->info.height_px - scan->rows_read);
  if (rows > 1 && stride_bytes < (int64_t)count_row_bytes(scan))
    return fg_fail(ctx, FG_ERR_USAGE, "%s: rows of %zu bytes do not fit a stride of %" PRId64, name,
                   count_row_bytes(scan), stride_bytes);
  fg_status status = read_rows(ctx, scan, rows, out, stride_bytes);
  scan->broken = status != FG_OK;
  return status;
}

bool fg_scan_is_file(const fg_scan *scan) {
  return scan->source.regular;
}

fg_status fg_scan_sha256(fg_context *ctx, fg_scan *scan, char hex[65]) {
  const fg_source *source = &scan->source;
  if (source->regular)
    return fg_sha256_descriptor(ctx, source->descriptor, source->start, source->name, hex);
  if (!scan->ended)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: its SHA-256 is known after the last row only",
                   source->name);
  struct sha256_ctx sum = source->sum;
  fg_sha256_finish(&sum, hex);
  return FG_OK;
}

void fg_scan_close(fg_scan *scan) {
  if (!scan) return;
  fg_png_close(scan->rows.png);
  fg_source_close(&scan->source);
  free(scan->rows.samples);
  free(scan->image);
  free(scan);
}
