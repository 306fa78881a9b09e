/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formats that a scan can have: a row of a table each. */
#ifndef FG_SCAN_FORMAT_H
#define FG_SCAN_FORMAT_H

#include "foilgauge/scan.h"
#include "scan/header.h"
#include "scan/source.h"

/* How one format is read. Order of calls: open, start, read_row for each row, finish. After an
 * error only close is left. `reader` is the format's own. */
typedef struct fg_format {
  const char *name;
  const char *const *endings; /* of its files' names, ".png"; NULL ends them */
  /* Whether a file begins as this format does; one that is shorter than that counts as cut off. */
  bool (*matches)(const uint8_t *head, size_t length);
  bool needs_file; /* it jumps about in the file: a pipe must be stored first */
  /* Whether it holds colours, as far as its first bytes tell. */
  bool (*has_colour)(const uint8_t *head, size_t length);
  /* Reads what stands before the image; the source must outlive the reader. *reader is set also on
   * failure, when there is something to close. */
  fg_status (*open)(fg_context *ctx, fg_source *source, const fg_scan_options *options,
                    void **reader, fg_scan_header *header);
  /* Takes the memory for rows; the caller has agreed to the size. */
  fg_status (*start)(fg_context *ctx, void *reader);
  fg_status (*read_row)(fg_context *ctx, void *reader, void *samples);
  /* Reads and checks what is left of the file. */
  fg_status (*finish)(fg_context *ctx, void *reader);
  /* Ends what reads the source beside the caller; after that only close is left. NULL: nothing
   * does. */
  void (*stop)(void *reader);
  void (*close)(void *reader); /* NULL is fine */
} fg_format;

extern const fg_format fg_format_png, fg_format_tiff, fg_format_pnm, fg_format_jpeg;

/* FG_ERR_DATA: the scan has lost by `compression`, and nobody has allowed that. */
fg_status fg_format_refuse_lossy(fg_context *ctx, const char *name, const char *compression);

/* Every format that is read. */
const fg_format *const *fg_formats(size_t *count);

/* The format whose files begin like `head`, the first `length` bytes; NULL when it is none. */
const fg_format *fg_format_find(const uint8_t *head, size_t length);

/* Whether a file's name ends as those of a format do. */
bool fg_format_has_name(const char *name);

/* All endings, for people: ".png, .tif, ...". */
void fg_format_list_endings(char *text, size_t size);

/* Why fg_format_find found none: what the file is and what to do, in words that follow its name. */
void fg_format_problem(const uint8_t *head, size_t length, char *text, size_t size);

#endif
