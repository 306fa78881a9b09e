/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/sha256.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

enum { PIECE_BYTES = 1 << 18 };

void fg_sha256_finish(struct sha256_ctx *sum, char hex[65]) {
  static const char digits[] = "0123456789abcdef";
  uint8_t digest[SHA256_DIGEST_SIZE];
  sha256_digest(sum, sizeof digest, digest);
  for (size_t i = 0; i < sizeof digest; i++) {
    hex[2 * i] = digits[digest[i] >> 4];
    hex[2 * i + 1] = digits[digest[i] & 15];
  }
  hex[64] = '\0';
}

static ssize_t read_at(int descriptor, void *piece, off_t offset) {
  ssize_t got;
  do
    got = pread(descriptor, piece, PIECE_BYTES, offset);
  while (got < 0 && errno == EINTR);
  return got;
}

static fg_status sum_descriptor(fg_context *ctx, int descriptor, const char *name, char hex[65]) {
  void *piece = NULL;
  FG_TRY(fg_memory_allocate(ctx, PIECE_BYTES, 1, &piece));
  struct sha256_ctx sum;
  sha256_init(&sum);
  fg_status status = FG_OK;
  ssize_t got;
  for (off_t offset = 0; (got = read_at(descriptor, piece, offset)) > 0; offset += got)
    sha256_update(&sum, (size_t)got, piece);
  if (got < 0)
    status =
        fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be read: %s", name, strerror(errno));
  else
    fg_sha256_finish(&sum, hex);
  free(piece);
  return status;
}

fg_status fg_sha256_file(fg_context *ctx, const char *path, char hex[65]) {
  struct stat entry;
  int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0)
    return fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be opened: %s", path,
                   strerror(errno));
  fg_status status = FG_OK;
  if (fstat(descriptor, &entry) != 0 || !S_ISREG(entry.st_mode))
    status = fg_fail(ctx, FG_ERR_IO, "%s: is no file", path);
  else
    status = sum_descriptor(ctx, descriptor, path, hex);
  close(descriptor);
  return status;
}

void fg_sha256_text(const char *text, char hex[65]) {
  struct sha256_ctx sum;
  sha256_init(&sum);
  sha256_update(&sum, strlen(text), (const uint8_t *)text);
  fg_sha256_finish(&sum, hex);
}
