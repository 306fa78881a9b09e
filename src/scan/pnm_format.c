/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNM: P4 (1 bit), P5 (gray), P6 (colour), binary, 8 or 16 bit, as `scanimage` writes it to a pipe.
 *
 * Netpbm's header: the magic, then width, height and (not in P4) the largest value, separated by
 * white space and comments from # to the end of the line; one white space; then the rows, 16-bit
 * samples with the high byte first. It has no resolution.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/format.h"

typedef struct pnm_reader {
  fg_source *source;
  size_t row_samples, row_bytes; /* of a row in the file */
  size_t rows_read, height;
  unsigned white;
  bool bits; /* P4 */
  uint8_t *packed;
} pnm_reader;

static bool matches_pnm(const uint8_t *head, size_t length) {
  if (head[0] != 'P') return false;
  if (length >= 2 && (head[1] < '4' || head[1] > '6')) return false;
  return length < 3 || head[2] == '#' || strchr(" \t\r\n\v\f", head[2]) != NULL;
}

static bool has_pnm_colour(const uint8_t *head, size_t length) {
  return length > 1 && head[1] == '6';
}

static fg_status fail_header(fg_context *ctx, const fg_source *source, const char *what) {
  if (source->error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s; check the disk or copy it again",
                   source->name, strerror(source->error));
  return fg_fail(ctx, FG_ERR_DATA, "%s: is a damaged PNM: %s (byte %llu); copy or scan it again",
                 source->name, what, (unsigned long long)source->offset);
}

static int next_byte(fg_source *source) {
  uint8_t byte;
  return fg_source_read(source, &byte, 1) == 1 ? byte : -1;
}

static bool is_space(int c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/* Reads the next number of the header with the one white space after it. */
static fg_status read_header_number(fg_context *ctx, fg_source *source, const char *what,
                                    uint64_t *out) {
  int c = next_byte(source);
  while (is_space(c) || c == '#') {
    while (c == '#' || (c >= 0 && c != '\n' && !is_space(c))) {
      do
        c = next_byte(source);
      while (c >= 0 && c != '\n');
    }
    c = next_byte(source);
  }
  *out = 0;
  if (c < '0' || c > '9') return fail_header(ctx, source, what);
  for (; c >= '0' && c <= '9'; c = next_byte(source)) {
    if (*out > UINT32_MAX) return fail_header(ctx, source, what);
    *out = *out * 10 + (uint64_t)(c - '0');
  }
  return is_space(c) ? FG_OK : fail_header(ctx, source, what);
}

static int bits_of(uint64_t white) {
  return white < 256 ? 8 : 16;
}

static fg_status read_header(fg_context *ctx, pnm_reader *reader, fg_scan_header *header) {
  fg_source *source = reader->source;
  uint64_t white = 1;
  char magic[2] = "";
  if (fg_source_read(source, magic, 2) != 2)
    return fail_header(ctx, source, "it is cut off in its header");
  FG_TRY(read_header_number(ctx, source, "no width", &header->width_px));
  FG_TRY(read_header_number(ctx, source, "no height", &header->height_px));
  reader->bits = magic[1] == '4';
  if (!reader->bits) FG_TRY(read_header_number(ctx, source, "no largest value", &white));
  if (header->width_px == 0 || header->height_px == 0)
    return fail_header(ctx, source, "its width or height is zero");
  if (white == 0 || white > 65535)
    return fail_header(ctx, source, "its largest value is not from 1 to 65535");
  reader->white = (unsigned)white;
  header->bit_depth = reader->bits ? 1 : bits_of(white);
  header->white = reader->bits || white == 255 || white == 65535 ? 0 : (unsigned)white;
  header->inverted = reader->bits;
  header->colour = magic[1] == '6';
  header->channels = header->colour ? 3 : 1;
  return FG_OK;
}

static fg_status open_pnm(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                          void **out, fg_scan_header *header) {
  (void)options;
  *header = (fg_scan_header){.dpi = {NAN, NAN}};
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(pnm_reader), out));
  pnm_reader *reader = *out;
  reader->source = source;
  FG_TRY(read_header(ctx, reader, header));
  double bits = reader->bits ? 1 : header->bit_depth;
  header->bytes_min =
      (double)source->offset +
      ceil((double)header->width_px * header->channels * bits / 8) * (double)header->height_px;
  reader->row_samples = (size_t)header->width_px * (size_t)header->channels;
  reader->row_bytes =
      reader->bits ? (reader->row_samples + 7) / 8 : reader->row_samples * (size_t)(bits / 8);
  reader->height = (size_t)header->height_px;
  return FG_OK;
}

static fg_status start_pnm(fg_context *ctx, void *r) {
  pnm_reader *reader = r;
  return reader->bits ? fg_memory_allocate(ctx, reader->row_bytes, 1, (void **)&reader->packed)
                      : FG_OK;
}

/* High byte first to host order, in place. */
static void swap_bytes(uint8_t *bytes, size_t count) {
  for (size_t i = 0; i < count; i++) {
    uint16_t value = (uint16_t)(bytes[2 * i] << 8 | bytes[2 * i + 1]);
    memcpy(bytes + 2 * i, &value, 2);
  }
}

static size_t find_too_large(const pnm_reader *reader, const void *samples) {
  size_t i = 0;
  if (reader->white > 255)
    for (const uint16_t *v = samples; i < reader->row_samples && v[i] <= reader->white;)
      i++;
  else
    for (const uint8_t *v = samples; i < reader->row_samples && v[i] <= reader->white;)
      i++;
  return i;
}

static fg_status read_pnm_row(fg_context *ctx, void *r, void *samples) {
  pnm_reader *reader = r;
  fg_source *source = reader->source;
  uint8_t *to = reader->bits ? reader->packed : samples;
  if (fg_source_read(source, to, reader->row_bytes) != reader->row_bytes) {
    if (source->error) return fail_header(ctx, source, "");
    return fg_fail(ctx, FG_ERR_DATA, "%s: is cut off (row %zu of %zu); copy or scan it again",
                   source->name, reader->rows_read + 1, reader->height);
  }
  reader->rows_read++;
  if (reader->bits)
    for (size_t i = 0; i < reader->row_samples; i++)
      ((uint8_t *)samples)[i] = reader->packed[i / 8] >> (7 - i % 8) & 1;
  if (reader->white > 255) swap_bytes(samples, reader->row_samples);
  if (reader->bits || reader->white == 255 || reader->white == 65535) return FG_OK;
  size_t bad = find_too_large(reader, samples);
  if (bad == reader->row_samples) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: is a damaged PNM: sample %zu of row %zu is above its largest value %u; copy "
                 "or scan it again",
                 source->name, bad + 1, reader->rows_read, reader->white);
}

/* Any further bytes would be another image, or a header that does not fit. */
static fg_status finish_pnm(fg_context *ctx, void *r) {
  pnm_reader *reader = r;
  if (next_byte(reader->source) < 0) return FG_OK;
  return fg_fail(
      ctx, FG_ERR_DATA,
      "%s: goes on after its last row (%zu): more than one image, or a wrong header; give "
      "one image",
      reader->source->name, reader->height);
}

static void close_pnm(void *r) {
  pnm_reader *reader = r;
  if (!reader) return;
  free(reader->packed);
  free(reader);
}

static const char *const endings[] = {".pnm", ".pgm", ".ppm", ".pbm", NULL};

const fg_format fg_format_pnm = {.name = "PNM",
                                 .endings = endings,
                                 .matches = matches_pnm,
                                 .has_colour = has_pnm_colour,
                                 .open = open_pnm,
                                 .start = start_pnm,
                                 .read_row = read_pnm_row,
                                 .finish = finish_pnm,
                                 .close = close_pnm};
