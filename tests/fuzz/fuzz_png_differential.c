/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reading of common PNGs held against libpng's. Half of the inputs are a file, bent, whose
 * checksums are put right, that of the compressed stream too where zlib finds its end; the other
 * half are a recipe and the rows to make one of, so that sound files of every kind are compared. */
#include <stdio.h>

#include "fuzz.h"
#include "support/png_pair.h"

enum { STREAM_MAX = 1 << 20, RECIPE_BYTES = 16, IHDR_END = 33 };

static uint32_t read_32(const uint8_t *p) {
  return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void write_32(uint8_t *p, uint32_t value) {
  for (int i = 0; i < 4; i++)
    p[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Size of the chunk at a place, with head and checksum; 0: there is no whole one. */
static size_t chunk_at(const growing *file, size_t at) {
  if (at + 12 > file->size) return 0;
  size_t length = read_32(file->data + at);
  return length > file->size - at - 12 ? 0 : length + 12;
}

static void seal(const growing *file) {
  for (size_t at = 8, size; (size = chunk_at(file, at)) > 0; at += size)
    write_32(file->data + at + size - 4, (uint32_t)crc32(0, file->data + at + 4, (uInt)(size - 8)));
}

/* Gathers the compressed stream, and the place of each of its bytes in the file. */
static size_t gather(const growing *file, uint8_t *stream, size_t *places) {
  size_t count = 0;
  bool inside = false;
  for (size_t at = 8, size; (size = chunk_at(file, at)) > 0; at += size) {
    bool idat = !memcmp(file->data + at + 4, "IDAT", 4);
    if (inside && !idat) break;
    inside |= idat;
    for (size_t i = 8; idat && i + 4 < size; i++, count++) {
      stream[count] = file->data[at + i];
      places[count] = at + i;
    }
  }
  return count;
}

/* The sum of what the stream becomes, and where it says it; 0: it does not come to its end. */
static size_t find_sum(const uint8_t *stream, size_t size, uint8_t *out, uint32_t *sum) {
  z_stream z = {.next_in = (uint8_t *)(uintptr_t)stream + 2, .avail_in = (uInt)size - 2};
  z.next_out = out;
  z.avail_out = STREAM_MAX;
  if (inflateInit2(&z, -15) != Z_OK) abort();
  int code = inflate(&z, Z_FINISH);
  *sum = (uint32_t)adler32(1, out, (uInt)z.total_out);
  size_t end = 2 + z.total_in;
  inflateEnd(&z);
  return code == Z_STREAM_END && end + 4 <= size ? end : 0;
}

static void repair_stream(growing *file) {
  static uint8_t out[STREAM_MAX];
  uint8_t *stream = malloc(file->size);
  size_t *places = malloc(file->size * sizeof *places);
  if (!stream || !places) abort();
  size_t size = gather(file, stream, places);
  uint32_t sum = 0;
  size_t end = size > 6 ? find_sum(stream, size, out, &sum) : 0;
  for (size_t i = 0; end && i < 4; i++)
    file->data[places[end + i]] = (uint8_t)(sum >> (24 - 8 * i));
  free(stream);
  free(places);
}

static growing bend(const uint8_t *data, size_t size) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  growing file = {0};
  grow(&file, signature, sizeof signature);
  grow(&file, data, size);
  repair_stream(&file);
  seal(&file);
  return file;
}

static growing make(const uint8_t *data, size_t size) {
  static const struct {
    int type, depth;
  } kinds[] = {{0, 8}, {0, 16}, {2, 8}, {2, 16}, {4, 8}, {4, 16}, {6, 8}, {6, 16}};
  recipe r = {.width = 1u + data[0] % 97,
              .height = 1u + data[1] % 31,
              .colour_type = kinds[data[2] % 8].type,
              .bit_depth = kinds[data[2] % 8].depth,
              .filter = data[3] % 6,
              .level = data[4] % 10,
              .strategy = data[5] % 5,
              .window_bits = 9 + data[6] % 7,
              .memory_level = 1 + data[7] % 9,
              .idat_bytes = data[8] | (data[9] % 4u) << 8,
              .empty_every = data[10] % 8,
              .flush_every = data[11] % 8};
  size_t wanted = recipe_row_bytes(&r) * r.height, left = size - RECIPE_BYTES;
  uint8_t *raw = malloc(wanted);
  if (!raw) abort();
  for (size_t i = 0; i < wanted; i++)
    raw[i] = (uint8_t)(left ? data[RECIPE_BYTES + i % left] + i / left * data[12] : data[13]);
  growing file = make_pair_png(&r, raw);
  free(raw);
  return file;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size <= RECIPE_BYTES || size > STREAM_MAX) return 0;
  bool made = data[0] & 1;
  growing file = made ? make(data + 1, size - 1) : bend(data + 1, size - 1);
  pair p = read_both_ways(fuzz_file(file.data, file.size));
  bool alone;
  const char *differs = compare_pair(&p, &alone);
  if (made && p.ours.status != FG_OK) differs = "a sound file is refused";
  if (differs) {
    fprintf(stderr, "%s\nours: %s\nlibpng: %s\n", differs, p.ours.context.message,
            p.libpng.context.message);
    abort();
  }
  free_pair(&p);
  free(file.data);
  return 0;
}
