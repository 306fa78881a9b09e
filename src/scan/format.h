/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats of scans: one row of a table each. */
#ifndef FG_SCAN_FORMAT_H
#define FG_SCAN_FORMAT_H

#include "foilgauge/scan.h"
#include "scan/header.h"
#include "scan/source.h"

/* Reader of one format. Order of calls: open, start, read_row for each row, finish. After an error
 * only close is allowed. `reader` is the format's own. */
typedef struct fg_format {
  const char *name;
  const char *const *endings; /* of its files' names, ".png"; NULL ends them */
  /* True when a file begins as this format does; a file shorter than the format's mark counts as
   * cut off. */
  bool (*matches)(const uint8_t *head, size_t length);
  bool needs_file; /* it reads the file at random: a pipe must be stored first */
  /* True when it holds colours, as far as its first bytes tell. */
  bool (*has_colour)(const uint8_t *head, size_t length);
  /* Reads the file up to the image; the source must outlive the reader. *reader is set also on
   * failure, when there is something to close. */
  fg_status (*open)(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                    void **reader, fg_scan_header *header);
  /* Allocates memory for rows; the caller has agreed to the size. */
  fg_status (*start)(fg_context *ctx, void *reader);
  fg_status (*read_row)(fg_context *ctx, void *reader, void *samples);
  /* Reads and checks the remainder of the file. */
  fg_status (*finish)(fg_context *ctx, void *reader);
  /* Stops a thread that reads the source beside the caller; after that only close is allowed. NULL:
   * there is none. */
  void (*stop)(void *reader);
  void (*close)(void *reader); /* NULL is fine */
} fg_format;

extern const fg_format fg_format_png, fg_format_tiff, fg_format_pnm, fg_format_jpeg;

/* FG_ERR_DATA: `compression` of the scan is lossy, and the options do not allow that. */
fg_status fg_format_refuse_lossy(fg_context *ctx, const char *name, const char *compression);

/* Returns all formats. */
const fg_format *const *fg_formats(size_t *count);

/* Finds the format whose files begin like `head`, the first `length` bytes; NULL: none. */
const fg_format *fg_format_find(const uint8_t *head, size_t length);

/* Returns true when a file's name has the ending of a format. */
bool fg_format_has_name(const char *name);

/* Lists all endings, for people: ".png, .tif, ...". */
void fg_format_list_endings(char *text, size_t size);

/* Explains why fg_format_find found none: the kind of the file and the remedy, in words that follow
 * its name. */
void fg_format_problem(const uint8_t *head, size_t length, char *text, size_t size);

#endif
