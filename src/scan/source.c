/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

/* CONSUMED_BYTES: max bytes of a pipe after its image. */
#define CONSUMED_BYTES ((uint64_t)1 << 30)
/* Limit of a stored pipe: the largest accepted scan, of four channels. */
#define STORE_BYTES ((uint64_t)32 << 30)
enum { BUFFER_BYTES = FG_CHECKSUM_BLOCK_BYTES };

static fg_status examine_file(fg_context *ctx, fg_source *source) {
  struct stat entry;
  if (fstat(source->descriptor, &entry) != 0)
    return fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be read: %s", source->name,
                   strerror(errno));
  if (S_ISDIR(entry.st_mode))
    return fg_fail(ctx, FG_ERR_IO, "%s: is a folder; give the name of a scan in it", source->name);
  source->regular = S_ISREG(entry.st_mode);
  if (!source->regular) return FG_OK;
  off_t start = lseek(source->descriptor, 0, SEEK_CUR);
  source->start = start > 0 ? start : 0;
  source->size = entry.st_size > source->start ? (uint64_t)(entry.st_size - source->start) : 0;
  /* Only a hint, so its failure is none. */
  (void)posix_fadvise(source->descriptor, 0, 0, POSIX_FADV_SEQUENTIAL);
  return FG_OK;
}

fg_status fg_source_open(fg_context *ctx, const char *path, bool only_file, fg_source *source) {
  *source = (fg_source){.descriptor = -1};
  fg_sha256_stream_begin(&source->sum);
  bool standard = !strcmp(path, "-");
  source->name = strdup(standard ? "standard input" : path);
  if (!source->name) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
  source->descriptor =
      standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC | (only_file ? O_NONBLOCK : 0));
  source->owned = !standard;
  if (source->descriptor < 0)
    return fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be opened: %s; %s", path,
                   strerror(errno),
                   errno == EACCES   ? "ask for permission to read it"
                   : errno == ENOMEM ? "close other programs"
                                     : "check the name");
  FG_TRY(examine_file(ctx, source));
  if (only_file && !source->regular)
    return fg_fail(ctx, FG_ERR_IO, "%s: is a pipe or a device, not a file; give a scan's file",
                   source->name);
  return fg_memory_allocate(ctx, BUFFER_BYTES, 1, (void **)&source->buffer);
}

void fg_source_close(fg_source *source) {
  char unused[65];
  if (source->name) fg_sha256_stream_finish(&source->sum, unused);
  if (source->owned && source->descriptor >= 0) close(source->descriptor);
  fg_block_checksums_close(&source->checksums);
  free(source->buffer);
  free(source->name);
  *source = (fg_source){.descriptor = -1};
}

static size_t receive_bytes(fg_source *source, void *out, size_t wanted) {
  if (source->ended || source->error) return 0;
  ssize_t got;
  do
    got = read(source->descriptor, out, wanted);
  while (got < 0 && errno == EINTR);
  if (got < 0) source->error = errno;
  if (got == 0) source->ended = true;
  if (got <= 0) return 0;
  if (!source->unsummed && !source->stored) fg_sha256_stream_feed(&source->sum, out, (size_t)got);
  return (size_t)got;
}

size_t fg_source_peek(fg_source *source, size_t wanted, const uint8_t **bytes) {
  if (source->begin > 0) {
    memmove(source->buffer, source->buffer + source->begin, source->end - source->begin);
    source->end -= source->begin;
    source->begin = 0;
  }
  while (source->end < wanted) {
    size_t got = receive_bytes(source, source->buffer + source->end, BUFFER_BYTES - source->end);
    if (got == 0) break;
    source->end += got;
  }
  *bytes = source->buffer;
  return source->end < wanted ? source->end : wanted;
}

static size_t hand_out(fg_source *source, uint8_t *out, size_t wanted) {
  size_t held = source->end - source->begin;
  size_t taken = held < wanted ? held : wanted;
  memcpy(out, source->buffer + source->begin, taken);
  source->begin += taken;
  return taken;
}

/* Large requests bypass the buffer: one copy less. */
size_t fg_source_read(fg_source *source, void *out, size_t wanted) {
  uint8_t *bytes = out;
  size_t done = hand_out(source, bytes, wanted);
  while (done < wanted) {
    size_t missing = wanted - done;
    size_t got;
    if (missing >= BUFFER_BYTES / 2) {
      got = receive_bytes(source, bytes + done, missing);
      done += got;
    } else {
      source->begin = 0;
      source->end = got = receive_bytes(source, source->buffer, BUFFER_BYTES);
      done += hand_out(source, bytes + done, missing);
    }
    if (got == 0) break;
  }
  source->offset += done;
  return done;
}

static fg_status open_store(fg_context *ctx, const fg_source *source, int *store) {
  const char *folder = getenv("TMPDIR");
  if (!folder || !*folder) folder = "/tmp";
  *store = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (*store >= 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO,
                 "%s: must be stored before it is read, and %s takes no file: %s; set TMPDIR to a "
                 "folder with room, or give a file",
                 source->name, folder, strerror(errno));
}

static fg_status copy_to_store(fg_context *ctx, fg_source *source, int store) {
  size_t held = source->end;
  uint64_t stored = 0;
  do {
    stored += held;
    if (stored > STORE_BYTES)
      return fg_fail(ctx, FG_ERR_DATA, "%s: goes on for more than %d GiB; is it a scan?",
                     source->name, (int)(STORE_BYTES >> 30));
    for (size_t done = 0; done < held;) {
      ssize_t wrote = write(store, source->buffer + done, held - done);
      if (wrote < 0 && errno == EINTR) continue;
      if (wrote <= 0)
        return fg_fail(ctx, FG_ERR_IO,
                       "%s: cannot be stored before it is read: %s; set TMPDIR to a folder with "
                       "room, or give a file",
                       source->name, strerror(errno));
      done += (size_t)wrote;
    }
    held = receive_bytes(source, source->buffer, BUFFER_BYTES);
  } while (held > 0);
  if (!source->error) return FG_OK;
  return fg_fail(ctx, fg_status_of_errno(source->error), "%s: cannot be read: %s", source->name,
                 strerror(source->error));
}

fg_status fg_source_store(fg_context *ctx, fg_source *source) {
  int store = -1;
  if (source->regular) return FG_OK;
  FG_TRY(open_store(ctx, source, &store));
  fg_status status = copy_to_store(ctx, source, store);
  if (status != FG_OK) {
    close(store);
    return status;
  }
  if (source->owned) close(source->descriptor);
  off_t size = lseek(store, 0, SEEK_CUR);
  fg_sha256_stream_finish(&source->sum, source->sha256);
  source->descriptor = store;
  source->owned = source->regular = source->stored = true;
  source->start = 0;
  source->size = size > 0 ? (uint64_t)size : 0;
  return fg_source_rewind(ctx, source);
}

fg_status fg_source_jump(fg_context *ctx, fg_source *source) {
  source->jumps = true;
  source->window = (fg_source_window){.buffer = source->buffer};
  if (source->stored || source->unsummed || source->checksums.checksum) return FG_OK;
  return fg_block_checksums_open(ctx, source->size, &source->checksums);
}

/* Reads one block of the file, or the file's part of it. */
static ssize_t read_block(const fg_source *source, uint64_t block, uint8_t *out) {
  size_t done = 0;
  while (done < FG_CHECKSUM_BLOCK_BYTES) {
    uint64_t offset = block * FG_CHECKSUM_BLOCK_BYTES + done;
    uint64_t left = offset < source->size ? source->size - offset : 0;
    size_t wanted = FG_CHECKSUM_BLOCK_BYTES - done;
    if (left < wanted) wanted = (size_t)left;
    if (wanted == 0) break;
    ssize_t got = pread(source->descriptor, out + done, wanted, source->start + (off_t)offset);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) break;
    done += (size_t)got;
  }
  return (ssize_t)done;
}

static bool hold_block(fg_source *source, fg_source_window *window, uint64_t block) {
  if (window->length > 0 && window->block == block) return true;
  ssize_t got = read_block(source, block, window->buffer);
  window->block = block;
  window->length = got < 0 ? 0 : (size_t)got;
  if (got < 0) window->error = errno;
  if (got >= 0) fg_block_checksums_add(&source->checksums, block, window->buffer, window->length);
  return got >= 0;
}

fg_status fg_source_window_open(fg_context *ctx, fg_source_window *window) {
  *window = (fg_source_window){.buffer = NULL};
  return fg_memory_allocate(ctx, FG_CHECKSUM_BLOCK_BYTES, 1, (void **)&window->buffer);
}

void fg_source_window_close(fg_source_window *window) {
  free(window->buffer);
  window->buffer = NULL;
}

ssize_t fg_source_read_window(fg_source *source, fg_source_window *window, void *out, size_t wanted,
                              uint64_t offset) {
  size_t done = 0;
  while (done < wanted) {
    if (!hold_block(source, window, (offset + done) / FG_CHECKSUM_BLOCK_BYTES)) return -1;
    size_t from = (size_t)((offset + done) % FG_CHECKSUM_BLOCK_BYTES);
    size_t taken = from < window->length ? window->length - from : 0;
    if (taken == 0) break;
    if (taken > wanted - done) taken = wanted - done;
    memcpy((uint8_t *)out + done, window->buffer + from, taken);
    done += taken;
  }
  return (ssize_t)done;
}

ssize_t fg_source_read_at(fg_source *source, void *out, size_t wanted, uint64_t offset) {
  ssize_t got = fg_source_read_window(source, &source->window, out, wanted, offset);
  if (got < 0) source->error = source->window.error;
  return got;
}

fg_status fg_source_rewind(fg_context *ctx, fg_source *source) {
  char unused[65];
  if (!source->stored) fg_sha256_stream_finish(&source->sum, unused);
  if (lseek(source->descriptor, source->start, SEEK_SET) < 0)
    return fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be read again: %s", source->name,
                   strerror(errno));
  source->begin = source->end = 0;
  source->offset = 0;
  source->ended = false;
  source->error = 0;
  return FG_OK;
}

fg_status fg_source_drain(fg_context *ctx, fg_source *source) {
  uint64_t past = 0;
  size_t got;
  if (source->jumps || (source->regular && (source->stored || source->unsummed))) return FG_OK;
  source->begin = source->end = 0;
  while ((got = receive_bytes(source, source->buffer, BUFFER_BYTES)) > 0)
    if ((past += got) > CONSUMED_BYTES && !source->regular)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: goes on for more than %d MiB behind its image; give one image",
                     source->name, (int)(CONSUMED_BYTES >> 20));
  if (!source->error) return FG_OK;
  return fg_fail(ctx, fg_status_of_errno(source->error), "%s: cannot be read behind the image: %s",
                 source->name, strerror(source->error));
}

/* Sums the file in a reading of its own: block by block beside the other's. */
static fg_status sum_blocks(fg_context *ctx, fg_source *source, char hex[65]) {
  struct sha256_ctx sum;
  void *block;
  ssize_t got = 0;
  FG_TRY(fg_memory_allocate(ctx, FG_CHECKSUM_BLOCK_BYTES, 1, &block));
  sha256_init(&sum);
  for (uint64_t i = 0; (got = read_block(source, i, block)) > 0; i++) {
    fg_block_checksums_add(&source->checksums, i, block, (size_t)got);
    sha256_update(&sum, (size_t)got, block);
  }
  int error = errno;
  free(block);
  if (got < 0)
    return fg_fail(ctx, fg_status_of_errno(error), "%s: cannot be read: %s", source->name,
                   strerror(error));
  fg_sha256_finish(&sum, hex);
  return FG_OK;
}

fg_status fg_source_check_unchanged(fg_context *ctx, fg_source *source) {
  if (!source->checksums.checksum || !atomic_load(&source->checksums.changed)) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "%s: changed while it was read; measure it again", source->name);
}

fg_status fg_source_sha256(fg_context *ctx, fg_source *source, char hex[65]) {
  if (source->jumps && !source->stored) FG_TRY(sum_blocks(ctx, source, source->sha256));
  FG_TRY(fg_source_check_unchanged(ctx, source));
  if (!source->sha256[0]) {
    FG_TRY(fg_source_drain(ctx, source));
    fg_sha256_stream_finish(&source->sum, source->sha256);
  }
  memcpy(hex, source->sha256, 65);
  return FG_OK;
}

fg_status fg_source_check(fg_context *ctx, const fg_source *source, bool cut_off,
                          const char *place) {
  if (source->error)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read at %s: %s; check the disk or copy it again",
                   source->name, place, strerror(source->error));
  if (!cut_off) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: is cut off (%s); copy or scan it again", source->name,
                 place);
}
