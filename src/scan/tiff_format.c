/* TIFF and BigTIFF as one of the formats: what the tags say. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan/format.h"
#include "scan/tiff_reader.h"

/* The most that libtiff may allocate at once. */
#define ALLOCATION_MOST ((tmsize_t)1 << 30)

/* ratio: the most that a byte can become; 0: not known. */
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

static bool matches(const uint8_t *head, size_t length) {
  static const char *const magics[] = {"II*", "MM\0*", "II+", "MM\0+"};
  size_t compared = length < 4 ? length : 4;
  for (size_t i = 0; i < sizeof magics / sizeof magics[0] && length >= 2; i++)
    if (!memcmp(head, magics[i], compared)) return true;
  return false;
}

/* Everything of a TIFF is stored before it is read. */
static bool has_colour(const uint8_t *head, size_t length) {
  (void)head;
  (void)length;
  return false;
}

static tmsize_t on_read(thandle_t handle, void *out, tmsize_t wanted) {
  fg_tiff *r = handle;
  ssize_t got = fg_source_read_at(r->source, out, (size_t)wanted, r->position);
  if (got > 0) r->position += (uint64_t)got;
  return got;
}

static tmsize_t on_write(thandle_t handle, void *bytes, tmsize_t size) {
  (void)handle;
  (void)bytes;
  (void)size;
  return -1;
}

static toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  fg_tiff *r = handle;
  uint64_t base = whence == SEEK_CUR ? r->position : whence == SEEK_END ? r->source->size : 0;
  if (base + offset > INT64_MAX) return (toff_t)-1;
  r->position = base + offset;
  return r->position;
}

static int on_close(thandle_t handle) {
  (void)handle;
  return 0;
}

static toff_t on_size(thandle_t handle) {
  return ((fg_tiff *)handle)->source->size;
}

static int on_error(TIFF *tiff, void *user, const char *module, const char *format,
                    va_list values) {
  (void)tiff;
  (void)module;
  fg_tiff *r = user;
  if (r->complained) return 1; /* the first one tells */
  vsnprintf(r->words, sizeof r->words, format, values);
  for (char *c = r->words; *c; c++)
    if (!isprint((unsigned char)*c)) *c = '?';
  r->complained = true;
  return 1;
}

static int on_warning(TIFF *tiff, void *user, const char *module, const char *format,
                      va_list values) {
  fg_tiff *r = user;
  if (strstr(format, "StripByteCounts")) r->counts_replaced = true;
  return r->strict && r->in_image ? on_error(tiff, user, module, format, values) : 1;
}

static fg_status refuse(fg_context *ctx, const fg_tiff *r, const char *what, unsigned value) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: has %s (%u), which is not read; "
                 "save it as 8- or 16-bit "
                 "gray or RGB without loss",
                 r->source->name, what, value);
}

static fg_status open_tiff(fg_context *ctx, fg_tiff *r) {
  TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
  if (!options) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: libtiff's reader");
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, ALLOCATION_MOST);
  TIFFOpenOptionsSetErrorHandlerExtR(options, on_error, r);
  TIFFOpenOptionsSetWarningHandlerExtR(options, on_warning, r);
  /* m: no mapping; c: strips as they are. */
  r->tiff = TIFFClientOpenExt(r->source->name, "rmc", r, on_read, on_write, on_seek, on_close,
                              on_size, NULL, NULL, options);
  TIFFOpenOptionsFree(options);
  return r->tiff ? FG_OK : fg_tiff_fail(ctx, r, r->words);
}

static fg_status check_compression(fg_context *ctx, fg_tiff *r, const fg_scan_options *options,
                                   double *ratio) {
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_COMPRESSION, &r->compression);
  for (size_t i = 0; i < sizeof compressions / sizeof compressions[0]; i++) {
    if (compressions[i].code != r->compression) continue;
    if (compressions[i].lossy && !options->allow_lossy)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: is compressed with loss (%s), which moves edges; scan again without, or "
                     "take it as it is with --allow-lossy",
                     r->source->name, compressions[i].name);
    *ratio = compressions[i].ratio;
    r->strict = compressions[i].strict;
    if (TIFFIsCODECConfigured(r->compression)) return FG_OK;
  }
  return refuse(ctx, r, "an unknown compression", r->compression);
}

static fg_status check_samples(fg_context *ctx, fg_tiff *r) {
  uint16_t bits = 1, channels = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG;
  uint32_t width = 0, height = 0;
  TIFFGetField(r->tiff, TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(r->tiff, TIFFTAG_IMAGELENGTH, &height);
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_SAMPLESPERPIXEL, &channels);
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_PLANARCONFIG, &planar);
  if (width == 0 || height == 0) return fg_tiff_fail(ctx, r, "its width or height is zero");
  if (bits != 1 && bits != 2 && bits != 4 && bits != 8 && bits != 16)
    return refuse(ctx, r, "samples of odd size", bits);
  if (channels == 0 || channels > 8 || (channels > 1 && bits < 8))
    return refuse(ctx, r, "an odd number of channels", channels);
  if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID)
    return refuse(ctx, r, "signed or floating-point samples", format);
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
      !TIFFGetField(r->tiff, TIFFTAG_COLORMAP, &red, &green, &blue))
    return fg_tiff_fail(ctx, r, "its palette is missing");
  header->has_palette = true;
  header->palette_size = (size_t)1 << r->bits;
  for (size_t i = 0; i < header->palette_size; i++)
    header->palette[i] = (fg_scan_loop_colour){(uint8_t)(red[i] >> 8), (uint8_t)(green[i] >> 8),
                                               (uint8_t)(blue[i] >> 8)};
  return FG_OK;
}

static fg_status check_colours(fg_context *ctx, fg_tiff *r, fg_scan_header *header) {
  uint16_t photometric = PHOTOMETRIC_MINISBLACK;
  if (!TIFFGetField(r->tiff, TIFFTAG_PHOTOMETRIC, &photometric))
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
    TIFFSetField(r->tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    header->colour = true;
    return FG_OK;
  case PHOTOMETRIC_RGB:
    if (r->channels < 3) return fg_tiff_fail(ctx, r, "it has colours but not three channels");
    header->colour = true;
    return FG_OK;
  default:
    break;
  }
  return refuse(ctx, r, "an odd kind of colours", photometric);
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
  if (!TIFFGetField(r->tiff, TIFFTAG_XRESOLUTION, &x) ||
      !TIFFGetField(r->tiff, TIFFTAG_YRESOLUTION, &y))
    return;
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
  header->no_dpi = "its ResolutionUnit is none";
  if (unit != RESUNIT_INCH && unit != RESUNIT_CENTIMETER) return;
  header->no_dpi = NULL;
  header->dpi[0] = (double)x * units[unit].per_inch;
  header->dpi[1] = (double)y * units[unit].per_inch;
  snprintf(header->dpi_source, sizeof header->dpi_source, "XResolution %g, YResolution %g per %s",
           (double)x, (double)y, units[unit].name);
}

static void note_oddities(const fg_tiff *r, fg_scan_header *header) {
  uint16_t orientation = ORIENTATION_TOPLEFT;
  TIFFGetFieldDefaulted(r->tiff, TIFFTAG_ORIENTATION, &orientation);
  if (orientation != ORIENTATION_TOPLEFT)
    snprintf(header->warning, sizeof header->warning,
             "its orientation tag (%u) is left alone: positions are those of the rows as stored",
             orientation);
  else if (!TIFFLastDirectory(r->tiff))
    snprintf(header->warning, sizeof header->warning,
             "it holds more than one image: only the first is read");
}

static fg_status read_tags(fg_context *ctx, fg_tiff *r, const fg_scan_options *options,
                           fg_scan_header *header) {
  double ratio = 0;
  FG_TRY(fg_source_jump(ctx, r->source));
  FG_TRY(open_tiff(ctx, r));
  FG_TRY(check_compression(ctx, r, options, &ratio));
  FG_TRY(check_samples(ctx, r));
  FG_TRY(check_colours(ctx, r, header));
  header->width_px = r->width;
  header->height_px = r->height;
  header->bit_depth = r->bits;
  header->channels = r->channels;
  fill_resolution(r, header);
  if (ratio > 0)
    header->bytes_least = (double)r->height * (double)r->width * r->bits * r->channels / 8 / ratio;
  return FG_OK;
}

static fg_status open_format(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                             void **out, fg_scan_header *header) {
  *header = (fg_scan_header){.channels = 1};
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_tiff), out));
  fg_tiff *r = *out;
  r->source = source;
  FG_TRY(read_tags(ctx, r, options, header));
  note_oddities(r, header);
  /* Rows are planned when the size has been agreed to, and for that no row may be too wide. */
  if (r->width > FG_SCAN_WIDTH_MAX_PX) return FG_OK;
  return header->bytes_least > (double)source->size ? FG_OK : fg_tiff_plan_rows(ctx, r, header);
}

static fg_status start(fg_context *ctx, void *reader) {
  return fg_tiff_start_rows(ctx, reader);
}

static fg_status read_row(fg_context *ctx, void *reader, void *samples) {
  return fg_tiff_read_row(ctx, reader, samples);
}

static fg_status finish(fg_context *ctx, void *reader) {
  (void)ctx;
  (void)reader;
  return FG_OK;
}

static void close_format(void *reader) {
  fg_tiff *r = reader;
  if (!r) return;
  if (r->tiff) TIFFClose(r->tiff);
  fg_tiff_free_rows(r);
  free(r);
}

static const char *const endings[] = {".tif", ".tiff", NULL};

const fg_format fg_format_tiff = {.name = "TIFF",
                                  .endings = endings,
                                  .matches = matches,
                                  .needs_file = true,
                                  .has_colour = has_colour,
                                  .open = open_format,
                                  .start = start,
                                  .read_row = read_row,
                                  .finish = finish,
                                  .close = close_format};
