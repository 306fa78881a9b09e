/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The decompressed content of the IDAT chunks of a PNG, by ISA-L's inflate, which takes a third of
 * zlib's time.
 *
 * Every chunk's CRC, the stream's head and its Adler-32 are checked. Errors have libpng's words. */
#ifndef FG_SCAN_PNG_STREAM_H
#define FG_SCAN_PNG_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"
#include "scan/source.h"

enum { FG_PNG_CHUNK_HEAD_BYTES = 8 };

typedef struct fg_png_stream fg_png_stream;

/* The source stands after the head of the first IDAT chunk, which is `head`. FG_ERR_MEMORY. */
fg_status fg_png_stream_open(fg_context *ctx, fg_source *source,
                             const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES], fg_png_stream **stream);
void fg_png_stream_close(fg_png_stream *stream); /* NULL is fine */

/* Reads the next bytes; fewer at the stream's end, or before an error. */
size_t fg_png_stream_read(fg_png_stream *stream, uint8_t *out, size_t wanted);

/* Checks that the stream ends here (bytes of IDAT after it do no harm), and goes to the first chunk
 * that is no IDAT, whose head goes to `head`. False: an error. */
bool fg_png_stream_finish(fg_png_stream *stream, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]);

/* Describes the error after a short read or a failed finish; NULL: the file ends too early, or
 * cannot be read on. */
const char *fg_png_stream_problem(const fg_png_stream *stream);

#endif
