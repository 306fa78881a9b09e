#include "scan/source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

enum { BUFFER_BYTES = 1 << 16 };

static fg_status examine(fg_context *ctx, fg_source *source) {
  struct stat entry;
  if (fstat(source->descriptor, &entry) != 0)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s", source->name, strerror(errno));
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

fg_status fg_source_open(fg_context *ctx, const char *path, fg_source *source) {
  *source = (fg_source){.descriptor = -1};
  sha256_init(&source->sum);
  bool standard = !strcmp(path, "-");
  source->name = strdup(standard ? "standard input" : path);
  if (!source->name) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
  source->descriptor = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
  source->owned = !standard;
  if (source->descriptor < 0)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be opened: %s; %s", path, strerror(errno),
                   errno == EACCES ? "ask for permission to read it" : "check the name");
  FG_TRY(examine(ctx, source));
  return fg_memory_allocate(ctx, BUFFER_BYTES, 1, (void **)&source->buffer);
}

void fg_source_close(fg_source *source) {
  if (source->owned && source->descriptor >= 0) close(source->descriptor);
  free(source->buffer);
  free(source->name);
  *source = (fg_source){.descriptor = -1};
}

static size_t receive(fg_source *source, void *out, size_t wanted) {
  if (source->ended || source->error) return 0;
  ssize_t got;
  do
    got = read(source->descriptor, out, wanted);
  while (got < 0 && errno == EINTR);
  if (got < 0) source->error = errno;
  if (got == 0) source->ended = true;
  if (got <= 0) return 0;
  if (!source->regular) sha256_update(&source->sum, (size_t)got, out);
  return (size_t)got;
}

size_t fg_source_peek(fg_source *source, size_t wanted, const uint8_t **bytes) {
  if (source->begin > 0) {
    memmove(source->buffer, source->buffer + source->begin, source->end - source->begin);
    source->end -= source->begin;
    source->begin = 0;
  }
  while (source->end < wanted) {
    size_t got = receive(source, source->buffer + source->end, BUFFER_BYTES - source->end);
    if (got == 0) break;
    source->end += got;
  }
  *bytes = source->buffer;
  return source->end < wanted ? source->end : wanted;
}

static size_t take(fg_source *source, uint8_t *out, size_t wanted) {
  size_t held = source->end - source->begin;
  size_t taken = held < wanted ? held : wanted;
  memcpy(out, source->buffer + source->begin, taken);
  source->begin += taken;
  return taken;
}

/* Large requests go past the buffer, straight to where they are wanted: one copy less. */
size_t fg_source_read(fg_source *source, void *out, size_t wanted) {
  uint8_t *bytes = out;
  size_t done = take(source, bytes, wanted);
  while (done < wanted) {
    size_t missing = wanted - done;
    size_t got;
    if (missing >= BUFFER_BYTES / 2) {
      got = receive(source, bytes + done, missing);
      done += got;
    } else {
      source->begin = 0;
      source->end = got = receive(source, source->buffer, BUFFER_BYTES);
      done += take(source, bytes + done, missing);
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
  do {
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
    held = receive(source, source->buffer, BUFFER_BYTES);
  } while (held > 0);
  if (!source->error) return FG_OK;
  return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s", source->name, strerror(source->error));
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
  source->descriptor = store;
  source->owned = source->regular = true;
  source->start = 0;
  source->size = size > 0 ? (uint64_t)size : 0;
  return fg_source_rewind(ctx, source);
}

fg_status fg_source_rewind(fg_context *ctx, fg_source *source) {
  if (lseek(source->descriptor, source->start, SEEK_SET) < 0)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read again: %s", source->name, strerror(errno));
  source->begin = source->end = 0;
  source->offset = 0;
  source->ended = false;
  source->error = 0;
  return FG_OK;
}

void fg_source_drain(fg_source *source) {
  if (source->regular) return;
  source->begin = source->end = 0;
  while (receive(source, source->buffer, BUFFER_BYTES) > 0)
    continue;
}
