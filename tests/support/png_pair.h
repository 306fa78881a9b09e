/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNGs made by the test's own filters and zlib's deflate, and one file read in both ways: as the
 * program reads it, and all by libpng. What takes the one and what the other must agree. */
#ifndef FG_TEST_PNG_PAIR_H
#define FG_TEST_PNG_PAIR_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "scan/png_reader.h"

enum { PAIR_PIXELS_MAX = 1 << 21, PAIR_FILTER_MIXED = 5 };

typedef struct recipe {
  uint32_t width, height;
  int bit_depth, colour_type;
  int filter; /* 0 to 4, PAIR_FILTER_MIXED: each row its own */
  int level, strategy, window_bits, memory_level;
  uint32_t idat_bytes;  /* of each chunk's data; 0: all in one chunk */
  uint32_t empty_every; /* an empty IDAT after so many; 0: none */
  uint32_t flush_every; /* rows to a block of deflate; 0: as zlib likes */
} recipe;

typedef struct growing {
  uint8_t *data;
  size_t size, room;
} growing;

static inline void grow(growing *g, const void *data, size_t size) {
  if (g->size + size > g->room) {
    g->room = 2 * (g->size + size);
    g->data = realloc(g->data, g->room);
    if (!g->data) abort();
  }
  if (size) memcpy(g->data + g->size, data, size);
  g->size += size;
}

static inline void grow_32(growing *g, uint32_t value) {
  uint8_t four[4] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                     (uint8_t)value};
  grow(g, four, 4);
}

static inline void grow_chunk(growing *g, const char *type, const void *data, uint32_t size) {
  grow_32(g, size);
  size_t from = g->size;
  grow(g, type, 4);
  grow(g, data, size);
  grow_32(g, (uint32_t)crc32(0, g->data + from, size + 4));
}

static inline size_t recipe_pixel_bits(const recipe *r) {
  static const int channels[7] = {1, 0, 3, 1, 2, 0, 4};
  return (size_t)(channels[r->colour_type] * r->bit_depth);
}

static inline size_t recipe_row_bytes(const recipe *r) {
  return (r->width * recipe_pixel_bits(r) + 7) / 8;
}

/* PNG specification, section 9, from its words; `at` -1 is left of the row. */
static inline uint8_t filtered(int filter, const uint8_t *above, const uint8_t *row, size_t at,
                               size_t pixel) {
  int a = at >= pixel ? row[at - pixel] : 0, b = above ? above[at] : 0;
  int c = above && at >= pixel ? above[at - pixel] : 0;
  int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
  int paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
  const int predicted[] = {0, a, b, (a + b) / 2, paeth};
  return (uint8_t)(row[at] - predicted[filter]);
}

/* `raw` holds height rows of recipe_row_bytes; the rows with their filters' bytes come out. */
static inline uint8_t *filter_rows(const recipe *r, const uint8_t *raw) {
  size_t size = recipe_row_bytes(r), pixel = (recipe_pixel_bits(r) + 7) / 8;
  uint8_t *out = malloc((size + 1) * r->height), *to = out;
  if (!out) abort();
  for (uint32_t y = 0; y < r->height; y++) {
    const uint8_t *row = raw + y * size;
    int filter = r->filter == PAIR_FILTER_MIXED ? (int)((y * 7 + y / 5) % 5) : r->filter;
    *to++ = (uint8_t)filter;
    for (size_t x = 0; x < size; x++)
      *to++ = filtered(filter, y ? row - size : NULL, row, x, pixel);
  }
  return out;
}

static inline growing deflate_rows(const recipe *r, uint8_t *lines) {
  growing out = {0};
  z_stream z = {0};
  size_t line = recipe_row_bytes(r) + 1;
  if (deflateInit2(&z, r->level, Z_DEFLATED, r->window_bits, r->memory_level, r->strategy) != Z_OK)
    abort();
  for (uint32_t y = 0; y < r->height; y++) {
    bool last = y + 1 == r->height, flush = r->flush_every && y % r->flush_every == 0;
    z.next_in = lines + y * line;
    z.avail_in = (uInt)line;
    int code;
    do {
      uint8_t piece[4096];
      z.next_out = piece;
      z.avail_out = sizeof piece;
      code = deflate(&z, last ? Z_FINISH : flush ? Z_FULL_FLUSH : Z_NO_FLUSH);
      grow(&out, piece, sizeof piece - z.avail_out);
    } while (z.avail_out == 0 || (last && code != Z_STREAM_END));
  }
  deflateEnd(&z);
  return out;
}

static inline void grow_idats(growing *png, const recipe *r, const growing *stream) {
  uint32_t part = r->idat_bytes ? r->idat_bytes : (uint32_t)stream->size, count = 0;
  for (size_t at = 0; at < stream->size; at += part) {
    size_t left = stream->size - at;
    grow_chunk(png, "IDAT", stream->data + at, (uint32_t)(left < part ? left : part));
    if (r->empty_every && ++count % r->empty_every == 0) grow_chunk(png, "IDAT", NULL, 0);
  }
}

static inline growing make_pair_png(const recipe *r, const uint8_t *raw) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const uint8_t shape[13] = {(uint8_t)(r->width >> 24),  (uint8_t)(r->width >> 16),
                             (uint8_t)(r->width >> 8),   (uint8_t)r->width,
                             (uint8_t)(r->height >> 24), (uint8_t)(r->height >> 16),
                             (uint8_t)(r->height >> 8),  (uint8_t)r->height,
                             (uint8_t)r->bit_depth,      (uint8_t)r->colour_type};
  uint8_t palette[768] = {1, 2, 3, 4, 5, 6}, *lines = filter_rows(r, raw);
  growing png = {0}, stream = deflate_rows(r, lines);
  grow(&png, signature, sizeof signature);
  grow_chunk(&png, "IHDR", shape, sizeof shape);
  if (r->colour_type == 3) grow_chunk(&png, "PLTE", palette, 3u << r->bit_depth);
  grow_idats(&png, r, &stream);
  grow_chunk(&png, "IEND", NULL, 0);
  free(stream.data);
  free(lines);
  return png;
}

/* Result of one of the two readers for a file. */
typedef struct reading {
  fg_status status;
  fg_context context;
  uint8_t *rows; /* NULL: the image was not begun, or is larger than is compared */
  size_t size;
} reading;

static inline fg_status read_image(fg_png *png, reading *out) {
  const fg_png_header *h = fg_png_get_header(png);
  uint64_t pixels = (uint64_t)h->width_px * h->height_px;
  size_t row = (size_t)h->width_px * (size_t)h->channels * (h->bit_depth == 16 ? 2 : 1);
  if (h->interlaced || pixels > PAIR_PIXELS_MAX)
    return fg_fail(&out->context, FG_ERR_USAGE, "not compared");
  out->size = row * h->height_px;
  out->rows = calloc(1, out->size);
  if (!out->rows) abort();
  FG_TRY(fg_png_start(&out->context, png, true));
  for (uint32_t y = 0; y < h->height_px; y++)
    FG_TRY(fg_png_read_row(&out->context, png, out->rows + y * row));
  return fg_png_finish(&out->context, png);
}

static inline reading read_one_way(const char *path, bool reference) {
  reading out = {0};
  fg_source source;
  fg_png *png = NULL;
  out.status = fg_source_open(&out.context, path, true, &source);
  source.unsummed = true;
  if (out.status == FG_OK)
    out.status = (reference ? fg_png_open_reference : fg_png_open)(&out.context, &source, &png);
  if (out.status == FG_OK) out.status = read_image(png, &out);
  fg_png_close(png);
  fg_source_close(&source);
  return out;
}

typedef struct pair {
  reading ours, libpng;
} pair;

static inline pair read_both_ways(const char *path) {
  return (pair){read_one_way(path, false), read_one_way(path, true)};
}

/* NULL where the two agree: both refuse it, or both take it and every sample is the same. What ours
 * alone refuses is told apart. */
static inline const char *compare_pair(const pair *p, bool *ours_alone) {
  *ours_alone = p->ours.status != FG_OK && p->libpng.status == FG_OK;
  if (p->ours.status != FG_OK) return NULL;
  if (p->libpng.status != FG_OK) return "libpng refuses what is taken";
  if (p->ours.size != p->libpng.size) return "sizes differ";
  if (memcmp(p->ours.rows, p->libpng.rows, p->ours.size)) return "samples differ";
  return NULL;
}

static inline void free_pair(pair *p) {
  free(p->ours.rows);
  free(p->libpng.rows);
}

#endif
