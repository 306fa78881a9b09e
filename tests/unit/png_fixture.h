/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNGs made for a test: written by libpng into memory, then bent byte by byte. */
#ifndef FG_TEST_PNG_FIXTURE_H
#define FG_TEST_PNG_FIXTURE_H

#include <fcntl.h>
#include <png.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PHYS_4800_DPI = 188976 };

typedef struct picture {
  uint32_t width, height;
  int bit_depth, colour_type, interlace;
  uint32_t phys[2]; /* 0, 0: no pHYs */
  int phys_unit;
  int palette_size;
  png_color palette[256];
  int with_trns;
  uint32_t idat_bytes; /* 0: libpng's own choice */
} picture;

typedef struct bytes {
  uint8_t *data;
  size_t size;
} bytes;

static inline uint32_t next_random(uint32_t *seed) {
  *seed ^= *seed << 13;
  *seed ^= *seed >> 17;
  *seed ^= *seed << 5;
  return *seed;
}

static inline int picture_channels(const picture *p) {
  static const int channels[7] = {1, 0, 3, 1, 2, 0, 4};
  return channels[p->colour_type];
}

/* Random samples, width x height x channels, each within the bit depth (and the palette). */
static inline uint16_t *make_samples(const picture *p, uint32_t seed) {
  size_t count = (size_t)p->width * p->height * (size_t)picture_channels(p);
  uint32_t limit = p->palette_size ? (uint32_t)p->palette_size : 1u << p->bit_depth;
  uint16_t *samples = malloc(count * sizeof *samples);
  for (size_t i = 0; samples && i < count; i++)
    samples[i] = (uint16_t)(next_random(&seed) % limit);
  return samples;
}

static inline void append_bytes(png_structp png, png_bytep data, size_t size) {
  bytes *file = png_get_io_ptr(png);
  uint8_t *grown = realloc(file->data, file->size + size);
  if (!grown) png_error(png, "out of memory");
  memcpy(grown + file->size, data, size);
  *file = (bytes){grown, file->size + size};
}

static inline void no_flush(png_structp png) {
  (void)png;
}

static inline void set_header(png_structp png, png_infop info, const picture *p) {
  png_set_IHDR(png, info, p->width, p->height, p->bit_depth, p->colour_type, p->interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (p->phys[0] || p->phys[1] || p->phys_unit)
    png_set_pHYs(png, info, p->phys[0], p->phys[1], p->phys_unit);
  if (p->palette_size) png_set_PLTE(png, info, p->palette, p->palette_size);
  static const png_byte alphas[2] = {0, 128};
  static const png_color_16 transparent = {0, 1, 1, 1, 1};
  if (p->with_trns && p->palette_size) png_set_tRNS(png, info, alphas, 2, NULL);
  if (p->with_trns && !p->palette_size) png_set_tRNS(png, info, NULL, 0, &transparent);
  if (p->idat_bytes) png_set_compression_buffer_size(png, p->idat_bytes);
}

/* libpng wants whole rows of big-endian samples, packed; png_set_packing takes bytes. */
static inline void pack_row(const picture *p, const uint16_t *samples, uint8_t *row) {
  size_t count = (size_t)p->width * (size_t)picture_channels(p);
  for (size_t i = 0; i < count; i++) {
    if (p->bit_depth == 16) {
      row[2 * i] = (uint8_t)(samples[i] >> 8);
      row[2 * i + 1] = (uint8_t)samples[i];
    } else {
      row[i] = (uint8_t)samples[i];
    }
  }
}

static inline bytes write_png(const picture *p, const uint16_t *samples) {
  bytes file = {0};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  size_t count = (size_t)p->width * (size_t)picture_channels(p);
  uint8_t *row = malloc(count * 2);
  png_set_write_fn(png, &file, append_bytes, no_flush);
  set_header(png, info, p);
  png_write_info(png, info);
  if (p->bit_depth < 8) png_set_packing(png);
  int passes = png_set_interlace_handling(png);
  for (int pass = 0; pass < passes; pass++)
    for (uint32_t y = 0; y < p->height; y++) {
      pack_row(p, samples + y * count, row);
      png_write_row(png, row);
    }
  png_write_end(png, NULL);
  png_destroy_write_struct(&png, &info);
  free(row);
  return file;
}

/* A file in the folder for temporary files; the caller removes and frees the name. */
static inline char *save_bytes(const void *data, size_t size) {
  const char *folder = getenv("TMPDIR");
  char *path = NULL;
  if (asprintf(&path, "%s/foilgauge-test-XXXXXX", folder && *folder ? folder : "/tmp") < 0)
    return NULL;
  int descriptor = mkstemp(path);
  if (descriptor < 0 || write(descriptor, data, size) != (ssize_t)size) abort();
  close(descriptor);
  return path;
}

static inline uint32_t get_32(const uint8_t *at) {
  return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static inline void put_32(uint8_t *at, uint32_t value) {
  for (int i = 0; i < 4; i++)
    at[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Place of a chunk (of its length); aborts when there is none: the test is wrong then. */
static inline size_t find_chunk(const bytes *file, const char *type) {
  for (size_t at = 8; at + 12 <= file->size; at += 12 + get_32(file->data + at))
    if (!memcmp(file->data + at + 4, type, 4)) return at;
  abort();
}

/* CRC-32 as the PNG specification defines it (annex D), bit by bit. */
static inline uint32_t crc_of(const uint8_t *data, size_t size) {
  uint32_t crc = 0xffffffffu;
  for (size_t i = 0; i < size; i++) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; bit++)
      crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

/* After a chunk's data were changed: makes its CRC right again. */
static inline void seal_chunk(const bytes *file, size_t at) {
  uint32_t length = get_32(file->data + at);
  put_32(file->data + at + 8 + length, crc_of(file->data + at + 4, (size_t)length + 4));
}

static inline void insert_chunk(bytes *file, size_t at, const char *type, const void *data,
                                uint32_t length) {
  uint8_t *grown = realloc(file->data, file->size + 12 + length);
  if (!grown) abort();
  memmove(grown + at + 12 + length, grown + at, file->size - at);
  *file = (bytes){grown, file->size + 12 + length};
  put_32(grown + at, length);
  memcpy(grown + at + 4, type, 4);
  if (length) memcpy(grown + at + 8, data, length);
  seal_chunk(file, at);
}

static inline void remove_chunk(bytes *file, const char *type) {
  size_t at = find_chunk(file, type);
  size_t size = 12 + get_32(file->data + at);
  memmove(file->data + at, file->data + at + size, file->size - at - size);
  file->size -= size;
}

#endif
