/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JPEG as one of the formats, where the options allow loss. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "scan/format.h"
#include "scan/jpeg_reader.h"

/* Min bits of a block: two codes of one bit. */
#define BITS_PER_BLOCK 2.0
/* Min bits of a progressive image's block: a band of all blocks may share one bit. */
#define BITS_PER_BLOCK_PROGRESSIVE 1.0
/* Max ratio, less 1, of JFIF's and EXIF's resolution when they state the same: EXIF has fractions.
 */
#define SAME_RESOLUTION 0.01

typedef struct jpeg_reader {
  fg_jpeg_in *jpeg;
  bool luminance;
} jpeg_reader;

static bool matches_jpeg(const uint8_t *head, size_t length) {
  static const uint8_t magic[3] = {0xff, 0xd8, 0xff};
  for (size_t i = 0; i < length && i < sizeof magic; i++)
    if (head[i] != magic[i]) return false;
  return true;
}

/* The colours are stated after EXIF data, which may be long. */
static bool has_jpeg_colour(const uint8_t *head, size_t length) {
  (void)head;
  (void)length;
  return true;
}

/* Resolution by JFIF; NaN without. */
static double jfif_dpi(const fg_jpeg_header *jpeg, int axis) {
  static const double per_inch[] = {NAN, 1, 2.54};
  if (!jpeg->has_density || jpeg->density_unit < 1 || jpeg->density_unit > 2) return NAN;
  return jpeg->density[axis] * per_inch[jpeg->density_unit];
}

static bool is_contradiction(double a, double b) {
  return a > 0 && b > 0 && fabs(log(a / b)) > SAME_RESOLUTION;
}

static void fill_resolution(const fg_jpeg_header *jpeg, fg_scan_header *header) {
  bool jfif = jfif_dpi(jpeg, 0) > 0 && jfif_dpi(jpeg, 1) > 0;
  const double *exif = jpeg->exif.dpi;
  for (int axis = 0; axis < 2; axis++) {
    header->dpi[axis] = jfif ? jfif_dpi(jpeg, axis) : exif[axis];
    if (jfif && is_contradiction(header->dpi[axis], exif[axis]))
      header->no_dpi = "its JFIF header and its EXIF data contradict each other";
  }
  if (jfif && jpeg->density_unit == 2) header->dpi_step = 2.54;
  if (!(header->dpi[0] > 0 && header->dpi[1] > 0))
    header->no_dpi = "no density in its JFIF header, no XResolution and YResolution in EXIF data";
  if (header->no_dpi) header->dpi[0] = header->dpi[1] = NAN;
  snprintf(header->dpi_source, sizeof header->dpi_source, "%s: %g × %g dpi",
           jfif ? "JFIF header" : "EXIF data", header->dpi[0], header->dpi[1]);
}

static void fill_header(const fg_jpeg_header *jpeg, bool luminance, fg_scan_header *header) {
  *header = (fg_scan_header){.width_px = jpeg->width_px,
                             .height_px = jpeg->height_px,
                             .bit_depth = 8,
                             .channels = luminance ? 1 : 3,
                             .colour = !luminance,
                             .luminance_only = luminance && jpeg->colour,
                             .jpeg_quality = jpeg->quality,
                             .memory_bytes = jpeg->memory_bytes};
  fill_resolution(jpeg, header);
  double bits = jpeg->whole ? BITS_PER_BLOCK_PROGRESSIVE : BITS_PER_BLOCK;
  if (!jpeg->arithmetic) header->bytes_min = (double)jpeg->blocks * bits / 8;
  if (jpeg->exif.orientation > 1)
    fg_scan_warn(
        header->warning, sizeof header->warning,
        "its orientation tag (%d) is left alone: positions are those of the rows as stored",
        jpeg->exif.orientation);
}

static fg_status open_jpeg(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                           void **out, fg_scan_header *header) {
  if (!options->allow_lossy) return fg_format_refuse_lossy(ctx, source->name, "JPEG");
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(jpeg_reader), out));
  jpeg_reader *reader = *out;
  FG_TRY(fg_jpeg_open(ctx, source, &reader->jpeg));
  const fg_jpeg_header *jpeg = fg_jpeg_get_header(reader->jpeg);
  /* JPEG keeps the Y of YCbCr best: it is the default. */
  bool any = options->channel == FG_CHANNEL_AUTO || options->channel == FG_CHANNEL_LUMINANCE;
  reader->luminance = jpeg->has_luminance && (any || !jpeg->colour);
  fill_header(jpeg, reader->luminance, header);
  return FG_OK;
}

static fg_status start_jpeg(fg_context *ctx, void *r) {
  jpeg_reader *reader = r;
  return fg_jpeg_start(ctx, reader->jpeg, reader->luminance);
}

static fg_status read_jpeg_row(fg_context *ctx, void *r, void *samples) {
  return fg_jpeg_read_row(ctx, ((jpeg_reader *)r)->jpeg, samples);
}

static fg_status finish_jpeg(fg_context *ctx, void *r) {
  return fg_jpeg_finish(ctx, ((jpeg_reader *)r)->jpeg);
}

static void close_jpeg(void *r) {
  jpeg_reader *reader = r;
  if (!reader) return;
  fg_jpeg_close(reader->jpeg);
  free(reader);
}

static const char *const endings[] = {".jpg", ".jpeg", NULL};

const fg_format fg_format_jpeg = {.name = "JPEG",
                                  .endings = endings,
                                  .matches = matches_jpeg,
                                  .has_colour = has_jpeg_colour,
                                  .open = open_jpeg,
                                  .start = start_jpeg,
                                  .read_row = read_jpeg_row,
                                  .finish = finish_jpeg,
                                  .close = close_jpeg};
