/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/png_reader.h"

#include <inttypes.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/png_image.h"

/* Larger pieces of IDAT save calls, smaller ones stay in the processor's cache. */
enum { IDAT_PIECE_BYTES = 1 << 16 };

struct fg_png {
  png_structp png;
  png_infop info;
  fg_source *source;
  fg_png_header header;
  bool by_libpng;      /* libpng reads the whole image */
  fg_png_image *image; /* reads the rows instead of libpng; NULL: libpng reads them */
  uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]; /* of the last chunk */
  bool head_waits;                       /* for libpng to read it */
  bool in_image;
  uint64_t rows_read;
  bool cut_off;
  char words[128];   /* libpng's, of the error */
  char warning[128]; /* of the last warning: it holds the detail of some errors */
};

static void on_error(png_structp png, png_const_charp words) {
  fg_png *reader = png_get_error_ptr(png);
  snprintf(reader->words, sizeof reader->words, "%s", words);
  png_longjmp(png, 1);
}

/* libpng only warns when the compressed data are wrong after the last row (their checksum, rows
 * beyond the header's). Then the rows cannot be trusted. Bytes after a sound stream do no harm. */
static void on_warning(png_structp png, png_const_charp words) {
  fg_png *reader = png_get_error_ptr(png);
  snprintf(reader->warning, sizeof reader->warning, "%s", words);
  bool in_image = !strncmp(words, "IDAT:", 5);
  if (in_image && !strstr(words, "Extra compressed data")) png_error(png, words);
}

/* libpng reads a chunk's head in one piece of its size. The head is kept for the reader of the
 * image, which returns the head after it. */
static void on_read(png_structp png, png_bytep out, size_t wanted) {
  fg_png *reader = png_get_io_ptr(png);
  bool waited = reader->head_waits && wanted == sizeof reader->head;
  if (waited) {
    memcpy(out, reader->head, wanted);
    reader->head_waits = false;
    return;
  }
  if (fg_source_read(reader->source, out, wanted) == wanted) {
    if (wanted == sizeof reader->head) memcpy(reader->head, out, wanted);
    return;
  }
  reader->cut_off = true;
  png_error(png, "cut off");
}

/* The one setjmp: runs `step`; false when libpng failed. */
static bool run_libpng(fg_png *reader, void (*step)(fg_png *, void *), void *row) {
  if (setjmp(png_jmpbuf(reader->png))) return false;
  step(reader, row);
  return true;
}

static const char *explain_libpng(const char *words) {
  static const char *const table[][2] = {
      {"CRC error", "its checksum (CRC) is wrong"},
      {"incorrect data check", "the checksum of the compressed image is wrong"},
      {"Not enough image data", "the image ends before its last row"},
      {"Not enough compressed data", "the image ends before its last row"},
      {"Too much image data", "it holds more rows than the header says"},
      {"Missing PLTE before IDAT", "the palette is missing"},
      {"Missing IHDR before IDAT", "the header is missing"},
      {"out of place", "it stands in the wrong place"},
  };
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
    if (!strcmp(words, table[i][0])) return table[i][1];
  return words;
}

/* libpng puts the chunk's name before its message when it is known. */
static const char *split_chunk(const fg_png *reader, char chunk[24]) {
  const char *colon = strstr(reader->words, ": ");
  if (colon && colon - reader->words >= 4 && colon - reader->words < 24) {
    snprintf(chunk, 24, "%.*s", (int)(colon - reader->words), reader->words);
    return colon + 2;
  }
  uint32_t type = png_get_io_chunk_type(reader->png);
  for (int i = 0; i < 4; i++)
    chunk[i] = (char)(type >> (24 - 8 * i));
  chunk[4] = '\0';
  return reader->words;
}

/* Writes the part of a message that tells the chunk, the byte, and the first row that could not be
 * read; of an interlaced image, whose rows come in passes, the count over all passes. */
static void describe_place(const fg_png *reader, char *place, size_t size) {
  char chunk[24];
  split_chunk(reader, chunk);
  const fg_png_header *header = &reader->header;
  bool named = chunk[0] >= 'A' && chunk[0] <= 'z';
  int length = snprintf(place, size, "%s%s%sbyte %" PRIu64, named ? "chunk " : "",
                        named ? chunk : "", named ? ", " : "", reader->source->offset);
  if (length < 0 || (size_t)length >= size || !reader->in_image) return;
  if (header->interlaced)
    snprintf(place + length, size - (size_t)length, ", interlaced row %" PRIu64,
             reader->rows_read + 1);
  else if (reader->rows_read < header->height_px)
    snprintf(place + length, size - (size_t)length, ", row %" PRIu64 " of %" PRIu32,
             reader->rows_read + 1, header->height_px);
  else
    snprintf(place + length, size - (size_t)length, ", after the last row");
}

static fg_status fail_png(fg_context *ctx, const fg_png *reader) {
  const char *name = reader->source->name;
  char place[128], chunk[24];
  describe_place(reader, place, sizeof place);
  FG_TRY(fg_source_check(ctx, reader->source, reader->cut_off, place));
  const char *words = split_chunk(reader, chunk);
  if (strstr(words, "ut of memory") || strstr(words, "nsufficient memory"))
    return fg_fail(ctx, FG_ERR_MEMORY, "%s: out of memory (%s)", name, place);
  if (!strcmp(words, "Invalid IHDR data")) words = reader->warning;
  return fg_fail(ctx, FG_ERR_DATA, "%s: is a damaged PNG: %s (%s); copy or scan it again", name,
                 explain_libpng(words), place);
}

/* Of all chunks but the image only the resolution matters: the others are checked by their CRC and
 * not parsed. */
static void configure_libpng(png_structp png) {
  static const png_byte phys[] = "pHYs", trns[] = "tRNS";
  png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, trns, 1);
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_AS_DEFAULT, phys, 1);
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* the caller has its own */
  png_set_compression_buffer_size(png, IDAT_PIECE_BYTES);
}

static void read_header(fg_png *reader, void *unused) {
  (void)unused;
  png_structp png = reader->png;
  fg_png_header *header = &reader->header;
  configure_libpng(png);
  png_read_info(png, reader->info);
  header->width_px = png_get_image_width(png, reader->info);
  header->height_px = png_get_image_height(png, reader->info);
  header->bit_depth = png_get_bit_depth(png, reader->info);
  header->channels = png_get_channels(png, reader->info);
  header->interlaced = png_get_interlace_type(png, reader->info) != PNG_INTERLACE_NONE;
  int unit = PNG_RESOLUTION_UNKNOWN;
  header->has_phys =
      png_get_pHYs(png, reader->info, &header->per_metre[0], &header->per_metre[1], &unit) != 0;
  header->phys_in_metres = unit == PNG_RESOLUTION_METER;
}

static void copy_palette(fg_png *reader) {
  fg_png_header *header = &reader->header;
  png_colorp colours = NULL;
  int count = 0;
  header->has_palette = png_get_color_type(reader->png, reader->info) == PNG_COLOR_TYPE_PALETTE;
  if (!header->has_palette || !png_get_PLTE(reader->png, reader->info, &colours, &count)) return;
  header->palette_size = (size_t)count;
  for (int i = 0; i < count && i < 256; i++)
    header->palette[i] = (fg_scan_colour){colours[i].red, colours[i].green, colours[i].blue};
}

static fg_status create_libpng(fg_context *ctx, fg_png *reader) {
  reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
  if (reader->png) reader->info = png_create_info_struct(reader->png);
  if (!reader->info) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: libpng's reader");
  png_set_read_fn(reader->png, reader, on_read);
  return FG_OK;
}

static fg_status open_png(fg_context *ctx, fg_source *source, bool by_libpng, fg_png **png) {
  fg_png *reader = NULL;
  *png = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *reader, (void **)&reader));
  reader->source = source;
  reader->by_libpng = by_libpng;
  fg_status status = create_libpng(ctx, reader);
  if (status == FG_OK && !run_libpng(reader, read_header, NULL)) status = fail_png(ctx, reader);
  if (status != FG_OK) {
    fg_png_close(reader);
    return status;
  }
  copy_palette(reader);
  *png = reader;
  return FG_OK;
}

fg_status fg_png_open(fg_context *ctx, fg_source *source, fg_png **png) {
  return open_png(ctx, source, false, png);
}

fg_status fg_png_open_reference(fg_context *ctx, fg_source *source, fg_png **png) {
  return open_png(ctx, source, true, png);
}

const fg_png_header *fg_png_get_header(const fg_png *png) {
  return &png->header;
}

static bool is_little_endian(void) {
  const uint16_t one = 1;
  return *(const uint8_t *)&one == 1;
}

static void start_libpng(fg_png *reader, void *unused) {
  (void)unused;
  if (reader->header.bit_depth < 8) png_set_packing(reader->png);
  if (reader->header.bit_depth == 16 && is_little_endian()) png_set_swap(reader->png);
  png_start_read_image(reader->png);
}

/* Returns true for the kinds that scanners write. */
static bool is_common(const fg_png_header *header) {
  return !header->interlaced && !header->has_palette && header->bit_depth >= 8;
}

/* True where no distance in the compressed stream can exceed the window that its first byte
 * declares (RFC 1950): 32 KiB, or at least the bytes of the image. ISA-L only rejects distances
 * beyond the start of the stream; libpng also rejects those beyond the window. So libpng reads the
 * images for which the two may disagree. */
static bool window_covers_image(const fg_png *png) {
  enum { WINDOW_BITS_MIN = 8, WINDOW_BITS_MAX = 15 };
  const uint8_t *first;
  const fg_png_header *header = &png->header;
  bool empty_chunk = !(png->head[0] | png->head[1] | png->head[2] | png->head[3]);
  if (empty_chunk || fg_source_peek(png->source, 1, &first) < 1) return false;
  int bits = (*first >> 4) + WINDOW_BITS_MIN;
  uint64_t row_bytes =
      (uint64_t)header->width_px * (uint64_t)(header->channels * header->bit_depth / 8);
  return bits >= WINDOW_BITS_MAX || ((uint64_t)1 << bits) >= (row_bytes + 1) * header->height_px;
}

static fg_status start_image(fg_context *ctx, fg_png *png, bool beside) {
  const fg_png_header *header = &png->header;
  size_t pixel_bytes = (size_t)(header->channels * header->bit_depth / 8);
  fg_png_image_layout layout = {.height_px = header->height_px,
                                .pixel_bytes = pixel_bytes,
                                .row_bytes = header->width_px * pixel_bytes};
  return fg_png_image_create(ctx, png->source, png->head, &layout, beside, &png->image);
}

fg_status fg_png_start(fg_context *ctx, fg_png *png, bool beside) {
  png->in_image = true;
  if (is_common(&png->header) && !png->by_libpng && window_covers_image(png))
    return start_image(ctx, png, beside);
  return run_libpng(png, start_libpng, NULL) ? FG_OK : fail_png(ctx, png);
}

/* An error of the image in libpng's words, as libpng's own. */
static fg_status fail_image(fg_context *ctx, fg_png *png) {
  const char *words = fg_png_image_problem(png->image);
  png->cut_off = !words;
  snprintf(png->words, sizeof png->words, "%s", words ? words : "cut off");
  return fail_png(ctx, png);
}

static void copy_samples(const fg_png_header *header, const uint8_t *row, void *samples) {
  size_t count = (size_t)header->width_px * (size_t)header->channels;
  if (header->bit_depth == 8) {
    memcpy(samples, row, count);
    return;
  }
  uint8_t *out = samples;
  for (size_t i = 0; i < count; i++) {
    uint16_t value = (uint16_t)(row[2 * i] << 8 | row[2 * i + 1]);
    memcpy(out + 2 * i, &value, 2);
  }
}

static fg_status read_image_row(fg_context *ctx, fg_png *png, void *samples) {
  const uint8_t *row = fg_png_image_next(png->image);
  if (!row) return fail_image(ctx, png);
  copy_samples(&png->header, row, samples);
  png->rows_read++;
  return FG_OK;
}

static void read_libpng_row(fg_png *reader, void *row) {
  png_read_row(reader->png, row, NULL);
  reader->rows_read++;
}

fg_status fg_png_read_row(fg_context *ctx, fg_png *png, void *samples) {
  if (png->image) return read_image_row(ctx, png, samples);
  return run_libpng(png, read_libpng_row, samples) ? FG_OK : fail_png(ctx, png);
}

/* libpng goes on after the image as if it had skipped it. The image's memory is freed for the
 * processing of its rows. */
static fg_status finish_image(fg_context *ctx, fg_png *png) {
  if (!fg_png_image_finish(png->image, png->head)) return fail_image(ctx, png);
  fg_png_image_free(png->image);
  png->image = NULL;
  png->head_waits = true;
  return FG_OK;
}

static void finish_libpng(fg_png *reader, void *unused) {
  static const png_byte idat[] = "IDAT";
  (void)unused;
  if (reader->head_waits) png_set_keep_unknown_chunks(reader->png, PNG_HANDLE_CHUNK_NEVER, idat, 1);
  png_read_end(reader->png, NULL);
}

fg_status fg_png_finish(fg_context *ctx, fg_png *png) {
  if (png->image) FG_TRY(finish_image(ctx, png));
  return run_libpng(png, finish_libpng, NULL) ? FG_OK : fail_png(ctx, png);
}

void fg_png_stop(fg_png *png) {
  if (png->image) fg_png_image_stop(png->image);
}

void fg_png_close(fg_png *png) {
  if (!png) return;
  fg_png_image_free(png->image);
  png_destroy_read_struct(&png->png, &png->info, NULL);
  free(png);
}
