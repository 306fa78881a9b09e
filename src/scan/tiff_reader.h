/* One TIFF or BigTIFF, first image, row by row through libtiff. */
#ifndef FG_SCAN_TIFF_READER_H
#define FG_SCAN_TIFF_READER_H

#include <tiffio.h>

#include "scan/header.h"
#include "scan/source.h"

typedef struct fg_tiff fg_tiff;

/* The next row as it stands in the file, all channels of a pixel together, samples of fewer than 8
 * bits packed. */
typedef fg_status fg_tiff_fetch(fg_context *ctx, fg_tiff *reader, uint8_t *row);

struct fg_tiff {
  TIFF *tiff;
  fg_source *source;
  uint64_t position; /* of libtiff in the file */
  uint64_t width, height, row;
  int bits, channels; /* of a sample; of a pixel */
  uint16_t compression;
  bool separate; /* each channel in a plane of its own */
  bool strict;   /* warnings about the image are errors */
  bool in_image, complained;
  bool counts_replaced; /* libtiff found the byte counts wrong and made its own */
  char words[160];      /* libtiff's last error */
  fg_tiff_fetch *fetch;
  size_t row_bytes;  /* of a packed row, all channels */
  uint8_t *packed;   /* room for it where samples must be unpacked or interleaved */
  uint64_t *offsets; /* of strips, where they are read directly */
  uint64_t strip_count, rows_per_strip;
  uint32_t tile_width, tile_height;
  size_t tile_bytes;
  uint8_t *tile, *tile_rows; /* one tile; the rows of a row of tiles */
};

/* Words for what libtiff said or what the file lacks. tiff_words.c */
fg_status fg_tiff_fail(fg_context *ctx, const fg_tiff *reader, const char *what);

/* Chooses how rows are fetched, checks that the file holds them, and says how much memory that
 * takes. tiff_rows.c */
fg_status fg_tiff_plan_rows(fg_context *ctx, fg_tiff *reader, fg_scan_header *header);
fg_status fg_tiff_start_rows(fg_context *ctx, fg_tiff *reader);
fg_status fg_tiff_read_row(fg_context *ctx, fg_tiff *reader, void *samples);
void fg_tiff_free_rows(fg_tiff *reader);

#endif
