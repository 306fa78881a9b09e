/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes of a scan: a file or a pipe, read once from front to back through one buffer, and
 * summed on the way.
 *
 * A format that reads at random (fg_source_read_at) is summed in a reading of its own, and
 * checksums detects when the two saw different bytes. */
#ifndef FG_SCAN_SOURCE_H
#define FG_SCAN_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "core/sha256_stream.h"
#include "foilgauge/status.h"
#include "scan/block_checksums.h"

/* A block of a file that is read at random, for one reader of it. */
typedef struct fg_source_window {
  uint8_t *buffer; /* FG_CHECKSUM_BLOCK_BYTES */
  uint64_t block;
  size_t length; /* number of bytes that the file has of it; 0: none is held */
  int error;     /* errno of a failed read */
} fg_source_window;

typedef struct fg_source {
  char *name;      /* for error texts */
  int descriptor;  /* -1: none */
  bool owned;      /* close it */
  bool regular;    /* a regular file: has a size, can be read anywhere */
  bool stored;     /* a pipe stored in an unnamed file */
  bool unsummed;   /* nobody will ask for the sum */
  bool jumps;      /* read by fg_source_read_at */
  off_t start;     /* of a regular file: begin of the scan */
  uint64_t size;   /* of a regular file, from `start` */
  uint64_t offset; /* bytes handed out so far */
  bool ended;      /* the end of the file was seen */
  int error;       /* errno of a failed read */
  uint8_t *buffer;
  size_t begin, end;    /* filled part of the buffer that is not yet handed out */
  fg_sha256_stream sum; /* over all bytes received */
  char sha256[65];      /* "": not known yet */
  fg_block_checksums checksums;
  fg_source_window window; /* for reading at random */
} fg_source;

/* "-" is standard input. FG_ERR_IO: missing, a folder, no permission; with `only_file`: a pipe or a
 * device, which could block the caller for ever. The source keeps its address. */
fg_status fg_source_open(fg_context *ctx, const char *path, bool only_file, fg_source *source);
void fg_source_close(fg_source *source);

/* Shows at most `wanted` (≤ 4096) bytes from the present place, without consuming them; fewer at
 * the end of the file or after a failure (source->error). */
size_t fg_source_peek(fg_source *source, size_t wanted, const uint8_t **bytes);

/* Hands out exactly `wanted` bytes, or fewer at the end of the file or after a failure. */
size_t fg_source_read(fg_source *source, void *out, size_t wanted);

/* Reports why a decoder got fewer bytes than requested: FG_ERR_IO when reading failed, FG_ERR_DATA
 * when the file ended (`cut_off`); else FG_OK. `place` is the message's part that the format knows
 * (chunk, byte, row). */
fg_status fg_source_check(fg_context *ctx, const fg_source *source, bool cut_off,
                          const char *place);

/* Stores a pipe in a temporary file without a name (in TMPDIR) and goes on from there as with a
 * regular file; nothing may have been handed out. A regular file stays. */
fg_status fg_source_store(fg_context *ctx, fg_source *source);

/* Switches to random reading by fg_source_read_at only. FG_ERR_MEMORY. */
fg_status fg_source_jump(fg_context *ctx, fg_source *source);

/* Reads at most `wanted` bytes from `offset` of a regular file; 0 at its end; -1: source->error. */
ssize_t fg_source_read_at(fg_source *source, void *out, size_t wanted, uint64_t offset);

/* Reading through the caller's own window, which holds its errors: from any thread. */
fg_status fg_source_window_open(fg_context *ctx, fg_source_window *window);
void fg_source_window_close(fg_source_window *window);
ssize_t fg_source_read_window(fg_source *source, fg_source_window *window, void *out, size_t wanted,
                              uint64_t offset);

/* Goes back to the first byte of a regular file. */
fg_status fg_source_rewind(fg_context *ctx, fg_source *source);

/* Receives the remainder; nothing remains of a file that is read at random. FG_ERR_IO, FG_ERR_DATA:
 * an endless pipe. */
fg_status fg_source_drain(fg_context *ctx, fg_source *source);

/* Writes the SHA-256 of the whole scan. Where the file is read at random a reading of its own finds
 * it, which another thread may do meanwhile; FG_ERR_IO when the two have seen different bytes so
 * far. */
fg_status fg_source_sha256(fg_context *ctx, fg_source *source, char hex[65]);

/* FG_ERR_IO when two readings of one block have seen different bytes. */
fg_status fg_source_check_unchanged(fg_context *ctx, fg_source *source);

#endif
