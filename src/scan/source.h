/* The bytes of a scan: a file or a pipe, read once from front to back through one buffer. */
#ifndef FG_SCAN_SOURCE_H
#define FG_SCAN_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include <nettle/sha2.h>

#include "foilgauge/status.h"

typedef struct fg_source {
  char *name;      /* for error texts */
  int descriptor;  /* -1: none */
  bool owned;      /* close it */
  bool regular;    /* a regular file: has a size, can be hashed by pread */
  off_t start;     /* of a regular file: where the scan begins */
  uint64_t size;   /* of a regular file, from `start` */
  uint64_t offset; /* bytes handed out so far */
  bool ended;      /* the end of the file was seen */
  int error;       /* errno of a failed read */
  uint8_t *buffer;
  size_t begin, end;     /* what of the buffer is filled and not yet handed out */
  struct sha256_ctx sum; /* of a pipe, over all bytes received */
} fg_source;

/* "-" is standard input. FG_ERR_IO: missing, a folder, no permission. */
fg_status fg_source_open(fg_context *ctx, const char *path, fg_source *source);
void fg_source_close(fg_source *source);

/* At most `wanted` (≤ 4096) bytes from where it stands, without consuming them; fewer at the end
 * of the file or after a failure (source->error). */
size_t fg_source_peek(fg_source *source, size_t wanted, const uint8_t **bytes);

/* Hands out exactly `wanted` bytes, or fewer at the end of the file or after a failure. */
size_t fg_source_read(fg_source *source, void *out, size_t wanted);

/* Stores a pipe in a temporary file without a name (in TMPDIR) and goes on from there as with a
 * regular file; nothing may have been handed out. A regular file stays. */
fg_status fg_source_store(fg_context *ctx, fg_source *source);

/* Back to the first byte of a regular file. */
fg_status fg_source_rewind(fg_context *ctx, fg_source *source);

/* Receives and hashes what is left of a pipe; a regular file is left alone. */
void fg_source_drain(fg_source *source);

#endif
