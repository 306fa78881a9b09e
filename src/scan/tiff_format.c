/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIFF and BigTIFF as one of the formats: meaning of the tags. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/format.h"
#include "scan/jpeg_tables.h"
#include "scan/tiff_reader.h"

/* Max bytes of an image's markers before its quantization table. */
enum { TABLES_BYTES_MAX = 4096 };

/* ratio: max bytes that a byte can become; 0: not known. */
static const struct {
  uint16_t code;
  const char *name;
  bool lossy, strict;
  double ratio;
} compressions[] = {
    {COMPRESSION_NONE, "none", false, false, 1},
    {COMPRESSION_CCITTRLE, "CCITT RLE", false, true, 0},
    {COMPRESSION_CCITTFAX3, "CCITT group 3", false, true, 0},
    {COMPRESSION_CCITTFAX4, "CCITT group 4", false, true, 0},
    {COMPRESSION_LZW, "LZW", false, false, 3700},               /* 4096 bytes from 9 bits */
    {COMPRESSION_ADOBE_DEFLATE, "Deflate", false, false, 1032}, /* 258 bytes from 2 bits */
    {COMPRESSION_DEFLATE, "Deflate", false, false, 1032},
    {COMPRESSION_PACKBITS, "PackBits", false, false, 64}, /* 128 bytes from 2 */
    {COMPRESSION_LZMA, "LZMA", false, false, 0},
    {COMPRESSION_ZSTD, "Zstandard", false, false, 0},
    {COMPRESSION_JPEG, "JPEG", true, false, 0},
};

static bool matches_tiff(const uint8_t *head, size_t length) {
  static const char *const magics[] = {"II*", "MM\0*", "II+", "MM\0+"};
  size_t compared = length < 4 ? length : 4;
  for (size_t i = 0; i < sizeof magics / sizeof magics[0] && length >= 2; i++)
    if (!memcmp(head, magics[i], compared)) return true;
  return false;
}

/* A pipe with a TIFF is always stored before it is read. */
static bool has_tiff_colour(const uint8_t *head, size_t length) {
  (void)head;
  (void)length;
  return false;
}

static fg_status refuse_tag(fg_context *ctx, const fg_tiff *r, const char *what, unsigned value) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: has %s (%u), which is not read; "
                 "save it as 8- or 16-bit "
                 "gray or RGB without loss",
                 r->source->name, what, value);
}

static fg_status open_tiff(fg_context *ctx, fg_tiff *r) {
  r->main.source = r->source;
  FG_TRY(fg_tiff_library_load(ctx));
  if (fg_tiff_handle_open(&r->main)) return FG_OK;
  if (!r->main.words[0]) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: libtiff's reader");
  return fg_tiff_fail(ctx, r, r->main.words);
}

static fg_status check_compression(fg_context *ctx, fg_tiff *r, const fg_scan_options *options,
                                   double *ratio) {
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_COMPRESSION, &r->compression);
  for (size_t i = 0; i < sizeof compressions / sizeof compressions[0]; i++) {
    if (compressions[i].code != r->compression) continue;
    if (compressions[i].lossy && !options->allow_lossy)
      return fg_format_refuse_lossy(ctx, r->source->name, compressions[i].name);
    *ratio = compressions[i].ratio;
    r->main.strict = compressions[i].strict;
    if (fg_libtiff.IsCODECConfigured(r->compression)) return FG_OK;
  }
  return refuse_tag(ctx, r, "an unknown compression", r->compression);
}

/* Finds JPEG's quantization table: in a tag of its own, or before the first strip's or tile's
 * image. */
static fg_status find_quality(fg_context *ctx, const fg_tiff *r, fg_scan_header *header) {
  uint8_t head[TABLES_BYTES_MAX];
  uint16_t zigzag[64];
  uint32_t length = 0;
  const uint8_t *tables = NULL;
  if (r->compression != COMPRESSION_JPEG) return FG_OK;
  bool found = fg_libtiff.GetField(r->main.tiff, TIFFTAG_JPEGTABLES, &length, &tables) && tables &&
               fg_jpeg_find_table(tables, length, zigzag);
  if (!found) {
    tmsize_t got = fg_libtiff.IsTiled(r->main.tiff)
                       ? fg_libtiff.ReadRawTile(r->main.tiff, 0, head, sizeof head)
                       : fg_libtiff.ReadRawStrip(r->main.tiff, 0, head, sizeof head);
    found = got > 0 && fg_jpeg_find_table(head, (size_t)got, zigzag);
  }
  if (!found) return fg_tiff_fail(ctx, r, "its JPEG has no quantization table");
  header->jpeg_quality = fg_jpeg_quality_of(zigzag);
  return FG_OK;
}

static fg_status check_samples(fg_context *ctx, fg_tiff *r) {
  uint16_t bits = 1, channels = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG;
  uint32_t width = 0, height = 0;
  fg_libtiff.GetField(r->main.tiff, TIFFTAG_IMAGEWIDTH, &width);
  fg_libtiff.GetField(r->main.tiff, TIFFTAG_IMAGELENGTH, &height);
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_SAMPLESPERPIXEL, &channels);
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_SAMPLEFORMAT, &format);
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_PLANARCONFIG, &planar);
  if (width == 0 || height == 0) return fg_tiff_fail(ctx, r, "its width or height is zero");
  if (bits != 1 && bits != 2 && bits != 4 && bits != 8 && bits != 16)
    return refuse_tag(ctx, r, "samples of odd size", bits);
  if (channels == 0 || channels > 8 || (channels > 1 && bits < 8))
    return refuse_tag(ctx, r, "an odd number of channels", channels);
  if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID)
    return refuse_tag(ctx, r, "signed or floating-point samples", format);
  r->width = width;
  r->height = height;
  r->bits = bits;
  r->channels = channels;
  r->separate = planar == PLANARCONFIG_SEPARATE && channels > 1;
  return FG_OK;
}

static fg_status copy_palette(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint16_t *red, *green, *blue;
  if (r->bits > 8 || r->channels > 1 ||
      !fg_libtiff.GetField(r->main.tiff, TIFFTAG_COLORMAP, &red, &green, &blue))
    return fg_tiff_fail(ctx, r, "its palette is missing");
  header->has_palette = true;
  header->palette_size = (size_t)1 << r->bits;
  for (size_t i = 0; i < header->palette_size; i++)
    header->palette[i] =
        (fg_scan_colour){(uint8_t)(red[i] >> 8), (uint8_t)(green[i] >> 8), (uint8_t)(blue[i] >> 8)};
  return FG_OK;
}

static fg_status check_colours(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint16_t photometric = PHOTOMETRIC_MINISBLACK;
  if (!fg_libtiff.GetField(r->main.tiff, TIFFTAG_PHOTOMETRIC, &photometric))
    photometric = r->channels >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
  switch (photometric) {
  case PHOTOMETRIC_MINISWHITE:
    header->inverted = true;
    return FG_OK;
  case PHOTOMETRIC_MINISBLACK:
    return FG_OK;
  case PHOTOMETRIC_PALETTE:
    return copy_palette(ctx, r, header);
  case PHOTOMETRIC_YCBCR:
    if (r->compression != COMPRESSION_JPEG) break;
    fg_libtiff.SetField(r->main.tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    header->colour = true;
    return FG_OK;
  case PHOTOMETRIC_RGB:
    if (r->channels < 3) return fg_tiff_fail(ctx, r, "it has colours but not three channels");
    header->colour = true;
    return FG_OK;
  default:
    break;
  }
  return refuse_tag(ctx, r, "an odd kind of colours", photometric);
}

static void fill_resolution(const fg_tiff *r, fg_scan_header *header) {
  static const struct {
    const char *name;
    double per_inch;
  } units[] = {[RESUNIT_INCH] = {"inch", 1}, [RESUNIT_CENTIMETER] = {"cm", 2.54}};
  float x = 0, y = 0;
  uint16_t unit = RESUNIT_INCH;
  header->dpi[0] = header->dpi[1] = NAN;
  header->no_dpi = "no XResolution and YResolution";
  if (!fg_libtiff.GetField(r->main.tiff, TIFFTAG_XRESOLUTION, &x) ||
      !fg_libtiff.GetField(r->main.tiff, TIFFTAG_YRESOLUTION, &y))
    return;
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
  header->no_dpi = "its ResolutionUnit is none";
  if (unit != RESUNIT_INCH && unit != RESUNIT_CENTIMETER) return;
  header->no_dpi = NULL;
  header->dpi[0] = (double)x * units[unit].per_inch;
  header->dpi[1] = (double)y * units[unit].per_inch;
  if (unit == RESUNIT_CENTIMETER && x == floorf(x) && y == floorf(y)) header->dpi_step = 2.54;
  snprintf(header->dpi_source, sizeof header->dpi_source, "XResolution %g, YResolution %g per %s",
           (double)x, (double)y, units[unit].name);
}

static void note_oddities(const fg_tiff *r, fg_scan_header *header) {
  uint16_t orientation = ORIENTATION_TOPLEFT;
  fg_libtiff.GetFieldDefaulted(r->main.tiff, TIFFTAG_ORIENTATION, &orientation);
  if (!fg_libtiff.LastDirectory(r->main.tiff))
    fg_scan_warn(header->warning, sizeof header->warning, FG_SCAN_MORE_IMAGES);
  if (orientation != ORIENTATION_TOPLEFT)
    fg_scan_warn(
        header->warning, sizeof header->warning,
        "its orientation tag (%u) is left alone: positions are those of the rows as stored",
        orientation);
}

static fg_status read_tags(fg_context *ctx, fg_tiff *r, const fg_scan_options *options,
                           fg_scan_header *header) {
  double ratio = 0;
  FG_TRY(fg_source_jump(ctx, r->source));
  FG_TRY(open_tiff(ctx, r));
  FG_TRY(check_compression(ctx, r, options, &ratio));
  FG_TRY(check_samples(ctx, r));
  FG_TRY(find_quality(ctx, r, header));
  FG_TRY(check_colours(ctx, r, header));
  header->width_px = r->width;
  header->height_px = r->height;
  header->bit_depth = r->bits;
  header->channels = r->channels;
  fill_resolution(r, header);
  if (ratio > 0)
    header->bytes_min = (double)r->height * (double)r->width * r->bits * r->channels / 8 / ratio;
  return FG_OK;
}

static fg_status open_format(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                             void **out, fg_scan_header *header) {
  *header = (fg_scan_header){.channels = 1};
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_tiff), out));
  fg_tiff *r = *out;
  r->source = source;
  r->threads = options->threads;
  FG_TRY(read_tags(ctx, r, options, header));
  note_oddities(r, header);
  /* Rows are planned after the size is accepted, so no row may be too wide. */
  if (r->width > FG_SCAN_WIDTH_MAX_PX) return FG_OK;
  return header->bytes_min > (double)source->size ? FG_OK : fg_tiff_plan_rows(ctx, r, header);
}

static fg_status start_tiff(fg_context *ctx, void *reader) {
  return fg_tiff_start_rows(ctx, reader);
}

static fg_status read_tiff_row(fg_context *ctx, void *reader, void *samples) {
  return fg_tiff_read_row(ctx, reader, samples);
}

static fg_status finish_tiff(fg_context *ctx, void *reader) {
  (void)ctx;
  (void)reader;
  return FG_OK;
}

static void close_format(void *reader) {
  fg_tiff *r = reader;
  if (!r) return;
  fg_tiff_handle_close(&r->main);
  fg_tiff_free_rows(r);
  free(r);
}

static const char *const endings[] = {".tif", ".tiff", NULL};

const fg_format fg_format_tiff = {.name = "TIFF",
                                  .endings = endings,
                                  .matches = matches_tiff,
                                  .needs_file = true,
                                  .has_colour = has_tiff_colour,
                                  .open = open_format,
                                  .start = start_tiff,
                                  .read_row = read_tiff_row,
                                  .finish = finish_tiff,
                                  .close = close_format};
