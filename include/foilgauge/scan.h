/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scan, read row by row as gray values.
 *
 * PNG of any kind (gray, RGB, palette, with or without alpha, 1 to 16 bit), TIFF and BigTIFF (gray,
 * RGB, palette; strips or tiles; both byte orders; any compression without loss), PNM (P4, P5, P6),
 * and JPEG (8-bit gray, YCbCr or RGB) where loss is allowed, come out as rows of 8- or 16-bit gray:
 * 16 when the file has 16, else 8. Fewer bits are spread over 0 to 255; TIFF's min-is-white is
 * turned round. Of colours one channel is taken, or the luminance (Rec. 709 weights; of a JPEG the
 * one that it holds, Rec. 601); alpha and infrared are dropped. Interlaced PNG are decoded whole in
 * memory and served row by row. Where a file says that one resolution is a whole multiple of the
 * other, as 4800 × 2400 dpi, so many columns or rows are averaged to one: pixels are square. CRC
 * errors and truncation are fatal. A TIFF on a pipe is stored in an unnamed temporary file first
 * (TMPDIR), and so is anything whose channel must be found.
 */
#ifndef FOILGAUGE_SCAN_H
#define FOILGAUGE_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Range of resolutions that a scanner can have; others count as mistakes. */
#define FG_SCAN_DPI_MIN 1.0
#define FG_SCAN_DPI_MAX 1e6
/* Max width: a row is held in memory whole. */
#define FG_SCAN_WIDTH_MAX_PX 1000000

typedef struct fg_scan fg_scan;

/* Channel of a colour scan that becomes gray. */
typedef enum fg_channel {
  FG_CHANNEL_AUTO, /* the one of the three with the most contrast; costs a reading of its own */
  FG_CHANNEL_RED,
  FG_CHANNEL_GREEN,
  FG_CHANNEL_BLUE,
  FG_CHANNEL_LUMINANCE,
} fg_channel;

#define FG_SCAN_PIXEL_CAP 4e9

typedef struct fg_scan_options {
  double dpi;          /* 0: the file's; else used for both axes, file or not */
  int averaged[2];     /* columns and rows that become one pixel; 0: as the file's resolutions ask
                          for, where `dpi` is 0 */
  uint64_t pixel_cap;  /* refuse larger ones; 0: FG_SCAN_PIXEL_CAP */
  uint64_t memory_cap; /* bytes that the reader may hold at most; 0: no limit */
  fg_channel channel;
  bool allow_lossy;    /* accept lossy compression by JPEG, which moves edges */
  bool only_file;      /* refuse pipes and devices, which may never end */
  bool unsummed;       /* the SHA-256 will not be asked for */
  unsigned threads;    /* 1: nothing runs beside the caller; 0: as many as are useful */
  char *failed_sha256; /* 65 bytes or NULL: gets the SHA-256 of a regular file that can be read, but
                          is no scan; else "" */
} fg_scan_options;

/* The quality of a JPEG is that of the Independent JPEG Group whose quantization table is nearest
 * to the file's at the frequencies of edges. It is the last compression's: an image that was saved
 * twice has lost more. */
typedef struct fg_scan_info {
  int64_t width_px, height_px; /* of the rows that are read: after averaging */
  int averaged[2];             /* columns and rows of the file that became one pixel: 1, 1 mostly */
  int bit_depth;               /* of the file: 1, 2, 4, 8, 16 */
  int bytes_per_pixel;         /* of the rows: 1 or 2 (host byte order, uint16_t) */
  double dpi[2]; /* x, y, of the rows that are read; snapped to the nearest whole dpi when within
                    0.02 dpi */
  double dpi_file[2];    /* of the file, before snapping; NaN when it states none */
  const char *format;    /* its name, one of fg_scan_format_names */
  int jpeg_quality;      /* of a lossy scan: 1 to 100, see above; 0: lossless */
  bool colour;           /* the file holds colours */
  fg_channel channel;    /* the channel in use; never FG_CHANNEL_AUTO */
  uint64_t memory_bytes; /* that the reader holds beyond a row */
  char warning[256];     /* oddities of the file; empty: none */
} fg_scan_info;

/* Lists the formats, for people: "PNG, TIFF or PNM" with `before_last` " or ". */
void fg_scan_format_names(const char *before_last, char *text, size_t size);

/* Checks a resolution from the user: FG_ERR_USAGE, with a message, unless `dpi` is finite, positive
 * and from FG_SCAN_DPI_MIN to FG_SCAN_DPI_MAX. Zero is wrong here. */
fg_status fg_scan_check_dpi(fg_context *ctx, double dpi);

/* Opens a scan and reads its header. `path` "-" is standard input. Errors: FG_ERR_IO (cannot open
 * or read), FG_ERR_DATA (empty, no known format, broken, over the cap, no resolution and no dpi
 * given: the message says `--dpi`), FG_ERR_USAGE (options->dpi neither 0 nor valid by
 * fg_scan_check_dpi). Rows and columns in error texts count from 1. NULL options are all zero. */
fg_status fg_scan_open(fg_context *ctx, const char *path, const fg_scan_options *options,
                       fg_scan **scan);

const fg_scan_info *fg_scan_get_info(const fg_scan *scan);

/* Reads the next `rows` rows, each `stride_bytes` after the one before. Rows beyond the end are an
 * FG_ERR_USAGE. After the last row everything up to the end of the file is read and checked. */
fg_status fg_scan_read_rows(fg_context *ctx, fg_scan *scan, int64_t rows, void *out,
                            int64_t stride_bytes);

/* Returns true when red, green and blue can be read apart, after everything else: a lossless colour
 * scan that is a regular file, or a pipe that was stored to find its channel. */
bool fg_scan_has_colours(const fg_scan *scan);

/* Goes back to the first row, after the last one (and the SHA-256) was read, for
 * fg_scan_read_colours. FG_ERR_USAGE unless fg_scan_has_colours. */
fg_status fg_scan_begin_colours(fg_context *ctx, fg_scan *scan);

/* Reads the next row of each of red, green and blue, as gray rows of bytes_per_pixel. */
fg_status fg_scan_read_colours(fg_context *ctx, fg_scan *scan, void *const planes[3]);

/* Returns the threads of its options. */
unsigned fg_scan_get_threads(const fg_scan *scan);

/* Returns true when it is read from a regular file (a stored pipe counts; a pipe or device does
 * not). */
bool fg_scan_is_file(const fg_scan *scan);

/* SHA-256 of the rows' bytes, to the end of the file, as 64 hex digits. It is found during reading,
 * and known after the last row. Called earlier on a regular file it reads the remainder, and no
 * more rows come (of a pipe: FG_ERR_USAGE). */
fg_status fg_scan_sha256(fg_context *ctx, fg_scan *scan, char hex[65]);

/* Returns true when the scan's format reads its file at random (TIFF) and is summed in a reading of
 * its own, through the same open file: then fg_scan_sha256 may be called from another thread while
 * rows are read. After both, fg_scan_check_unchanged is FG_ERR_IO when the two have seen different
 * bytes (and so is the sum itself when it comes last). */
bool fg_scan_sums_apart(const fg_scan *scan);
fg_status fg_scan_check_unchanged(fg_context *ctx, fg_scan *scan);

void fg_scan_close(fg_scan *scan); /* NULL is fine */

#ifdef __cplusplus
}
#endif
#endif
