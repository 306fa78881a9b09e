/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a TIFF.
 *
 * Uncompressed strips are read directly, by their offsets: a row at a time, whatever the strip's
 * length and byte count (in files beyond 4 GiB the 32-bit count has wrapped round). Compressed
 * strips and tiles are decoded in batches (tiff_batch.c); long strips, and those of odd codecs, go
 * through TIFFReadScanline. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/tiff_reader.h"

/* Max bytes of a tile; scanners write smaller ones. */
#define TILE_BYTES_MAX ((uint64_t)64 << 20)

static size_t plane_row_bytes(const fg_tiff *r) {
  size_t samples = (size_t)r->width * (r->separate ? 1 : (size_t)r->channels);
  return (samples * (size_t)r->bits + 7) / 8;
}

static fg_status read_at(fg_context *ctx, const fg_tiff *r, uint64_t offset, uint8_t *out,
                         size_t wanted) {
  ssize_t got = fg_source_read_at(r->source, out, wanted, offset);
  if (got < 0)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s; check the disk or copy it again",
                   r->source->name, strerror(r->source->error));
  return (size_t)got == wanted ? FG_OK : fg_tiff_fail(ctx, r, "it is cut off");
}

static uint64_t row_offset(const fg_tiff *r, uint64_t plane, uint64_t row) {
  uint64_t strips_per_plane = (r->height + r->rows_per_strip - 1) / r->rows_per_strip;
  return r->offsets[plane * strips_per_plane + row / r->rows_per_strip] +
         row % r->rows_per_strip * plane_row_bytes(r);
}

static fg_status read_plane_row(fg_context *ctx, fg_tiff *r, uint64_t plane, uint8_t *out) {
  size_t bytes = plane_row_bytes(r);
  uint16_t fill_order = FILLORDER_MSB2LSB;
  FG_TRY(read_at(ctx, r, row_offset(r, plane, r->row), out, bytes));
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_FILLORDER, &fill_order);
  if (fill_order == FILLORDER_LSB2MSB) fg_libtiff.ReverseBits(out, (tmsize_t)bytes);
  if (r->bits == 16 && fg_libtiff.IsByteSwapped(r->main.tiff))
    fg_libtiff.SwabArrayOfShort((uint16_t *)(void *)out, (tmsize_t)(bytes / 2));
  return FG_OK;
}

static fg_status fetch_direct(fg_context *ctx, fg_tiff *r, uint8_t *row) {
  if (!r->separate) return read_plane_row(ctx, r, 0, row);
  size_t size = (size_t)r->bits / 8, channels = (size_t)r->channels;
  for (size_t c = 0; c < channels; c++) {
    FG_TRY(read_plane_row(ctx, r, c, r->packed));
    for (size_t x = 0; x < r->width; x++)
      memcpy(row + (x * channels + c) * size, r->packed + x * size, size);
  }
  return FG_OK;
}

static fg_status fetch_scanline(fg_context *ctx, fg_tiff *r, uint8_t *row) {
  if (fg_libtiff.ReadScanline(r->main.tiff, row, (uint32_t)r->row, 0) == 1 && !r->main.complained)
    return FG_OK;
  return fg_tiff_fail(ctx, r, r->main.words);
}

static fg_status plan_tiles(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  fg_libtiff.GetField(r->main.tiff, TIFFTAG_TILEWIDTH, &r->tile_width);
  fg_libtiff.GetField(r->main.tiff, TIFFTAG_TILELENGTH, &r->tile_height);
  uint64_t size = fg_libtiff.TileSize64(r->main.tiff),
           pixel_bits = (uint64_t)(r->bits * r->channels);
  if (r->separate) return fg_tiff_fail(ctx, r, "its colours lie in separate tiles");
  if (r->tile_width == 0 || r->tile_height == 0 || r->tile_width % 8 || size == 0 ||
      size > TILE_BYTES_MAX || r->tile_width > TILE_BYTES_MAX || r->tile_height > TILE_BYTES_MAX ||
      size != r->tile_width * pixel_bits / 8 * r->tile_height)
    return fg_tiff_fail(ctx, r, "its tiles have no sensible size");
  r->tile_bytes = (size_t)size;
  fg_tiff_plan_tiles(r);
  header->memory_bytes = fg_tiff_batch_memory(r);
  r->fetch = fg_tiff_fetch_batch;
  return FG_OK;
}

/* Reports rows outside of the file before they are read. */
static fg_status check_offsets(fg_context *ctx, const fg_tiff *r, uint64_t planes) {
  size_t bytes = plane_row_bytes(r);
  for (uint64_t plane = 0; plane < planes; plane++)
    for (uint64_t row = 0; row < r->height;) {
      uint64_t next = row + r->rows_per_strip, last = (next < r->height ? next : r->height) - 1;
      uint64_t from = row_offset(r, plane, row), to = row_offset(r, plane, last) + bytes;
      if (from == 0 || to < from || to > r->source->size)
        return fg_tiff_fail(ctx, r, "it is cut off, or a strip lies outside the file");
      row = last + 1;
    }
  return FG_OK;
}

/* Notes wrong byte counts; only the offsets are used. */
static void note_counts(const fg_tiff *r, const uint64_t *counts, fg_scan_header *header) {
  bool wrong = r->main.counts_replaced;
  for (uint64_t strip = 0; strip < r->strip_count && !wrong; strip++) {
    uint64_t first = strip * r->rows_per_strip % r->height, rows = r->height - first;
    if (rows > r->rows_per_strip) rows = r->rows_per_strip;
    wrong = counts[strip] != rows * plane_row_bytes(r);
  }
  if (wrong)
    fg_scan_warn(
        header->warning, sizeof header->warning,
        "the byte counts of its strips are wrong (beyond 4 GiB they wrap round); the rows are "
        "taken as they follow");
}

static fg_status plan_direct(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint64_t planes = r->separate ? (uint64_t)r->channels : 1, *counts = NULL;
  uint64_t strips = (r->height + r->rows_per_strip - 1) / r->rows_per_strip * planes;
  r->strip_count = fg_libtiff.NumberOfStrips(r->main.tiff);
  if (strips != r->strip_count ||
      !fg_libtiff.GetField(r->main.tiff, TIFFTAG_STRIPOFFSETS, &r->offsets) || !r->offsets)
    return fg_tiff_fail(ctx, r, "its strips have no usable offsets");
  FG_TRY(check_offsets(ctx, r, planes));
  if (!r->separate && fg_libtiff.GetField(r->main.tiff, TIFFTAG_STRIPBYTECOUNTS, &counts) && counts)
    note_counts(r, counts, header);
  r->fetch = fetch_direct;
  return FG_OK;
}

static fg_status plan_scanlines(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint64_t *counts = NULL, largest = 0;
  if (r->separate) return fg_tiff_fail(ctx, r, "its colours lie in separate compressed planes");
  if (fg_libtiff.ScanlineSize64(r->main.tiff) != r->row_bytes)
    return fg_tiff_fail(ctx, r, "its rows have no sensible size");
  if (!fg_libtiff.GetField(r->main.tiff, TIFFTAG_STRIPBYTECOUNTS, &counts) || !counts)
    return fg_tiff_fail(ctx, r, "its strips have no usable byte counts");
  for (uint32_t strip = 0; strip < fg_libtiff.NumberOfStrips(r->main.tiff); strip++)
    if (counts[strip] > largest) largest = counts[strip];
  if (largest > r->source->size) largest = r->source->size;
  bool together = fg_tiff_plan_strips(r);
  header->memory_bytes = together ? largest * r->threads + fg_tiff_batch_memory(r) : largest;
  r->fetch = together ? fg_tiff_fetch_batch : fetch_scanline;
  return FG_OK;
}

fg_status fg_tiff_plan_rows(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint32_t rows_per_strip = 0;
  r->row_bytes = ((size_t)r->width * (size_t)(r->bits * r->channels) + 7) / 8;
  if (fg_libtiff.IsTiled(r->main.tiff)) return plan_tiles(ctx, r, header);
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_ROWSPERSTRIP, &rows_per_strip);
  r->rows_per_strip = rows_per_strip < r->height ? rows_per_strip : r->height;
  if (rows_per_strip == 0) return fg_tiff_fail(ctx, r, "its strips have no rows");
  return r->compression == COMPRESSION_NONE ? plan_direct(ctx, r, header)
                                            : plan_scanlines(ctx, r, header);
}

fg_status fg_tiff_start_rows(fg_context *ctx, fg_tiff *r) {
  r->main.in_image = true;
  r->main.complained = false;
  FG_TRY(fg_memory_allocate(ctx, r->row_bytes, 1, (void **)&r->packed));
  return r->batch_rows ? fg_tiff_start_batch(ctx, r) : FG_OK;
}

fg_status fg_tiff_read_row(fg_context *ctx, fg_tiff *r, void *samples) {
  bool packed = r->bits < 8;
  FG_TRY(r->fetch(ctx, r, packed ? r->packed : samples));
  r->row++;
  if (!packed) return FG_OK;
  unsigned bits = (unsigned)r->bits, mask = (1u << bits) - 1, per_byte = 8 / bits;
  uint8_t *out = samples;
  for (size_t x = 0; x < r->width; x++)
    out[x] = (uint8_t)((unsigned)r->packed[x / per_byte] >> (8 - bits * (x % per_byte + 1)) & mask);
  return FG_OK;
}

void fg_tiff_free_rows(fg_tiff *r) {
  free(r->packed);
  fg_tiff_free_batch(r);
}
