/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/temporary.h"
#include "core/text.h"
#include "core/utf8.h"

static const struct {
  int error;
  const char *advice;
} advices[] = {
    {ENOSPC, "free some space or choose another place"},
    {EDQUOT, "free some space of your quota or choose another place"},
    {EFBIG, "raise the file size limit (ulimit -f) or choose another place"},
    {EACCES, "choose a place where you may write"},
    {EPERM, "choose a place where you may write"},
    {EROFS, "choose a place where you may write"},
    {ENOENT, "create its folder first"},
    {ENOTDIR, "a part of the path is a file, not a folder; choose another place"},
    {EISDIR, "it is a folder; give the name of a file"},
    {EPIPE, "the program that should read it has ended"},
    {ENAMETOOLONG, "choose a shorter name"},
    {ENOMEM, "close other programs"},
};

fg_status fg_output_fail(fg_context *ctx, const char *path, int error) {
  const char *advice = "check the disk or choose another place";
  for (size_t i = 0; i < sizeof advices / sizeof advices[0]; i++)
    if (advices[i].error == error) advice = advices[i].advice;
  return fg_fail(ctx, fg_status_of_errno(error), "%s: cannot be written: %s; %s", path,
                 strerror(error), advice);
}

/* Sink of the stream. A stream alone remembers only that a write has failed, not the errno. */
typedef struct fg_sink {
  int descriptor;
  bool owned;              /* closed at the end */
  fg_temporary *temporary; /* owns the descriptor; NULL: written directly */
  int error;               /* of the first write that failed */
  bool dropped;            /* buffered bytes are dropped */
  bool terminal;           /* control characters are made visible */
  char held[4];            /* for a terminal: the begin of a character */
  size_t held_count;
} fg_sink;

static bool put_bytes(fg_sink *sink, const char *bytes, size_t size) {
  size_t done = 0;
  while (done < size && !sink->error) {
    ssize_t put = write(sink->descriptor, bytes + done, size - done);
    if (put > 0)
      done += (size_t)put;
    else if (put == 0 || errno != EINTR)
      sink->error = put < 0 && errno ? errno : EIO;
  }
  return !sink->error;
}

/* Writes bytes with control characters made visible; `last`: no bytes follow. */
static bool put_visible(fg_sink *sink, const char *bytes, size_t size, bool last) {
  enum { PIECE = 1024 };
  char piece[PIECE], visible[4 * PIECE];
  do {
    size_t length, held = sink->held_count, more = size < PIECE - held ? size : PIECE - held;
    memcpy(piece, sink->held, held);
    if (more) memcpy(piece + held, bytes, more);
    size_t taken = fg_utf8_make_visible(piece, held + more, last && more == size, visible, &length);
    sink->held_count = held + more - taken;
    memcpy(sink->held, piece + taken, sink->held_count);
    if (!put_bytes(sink, visible, length)) return false;
    bytes += more;
    size -= more;
  } while (size);
  return true;
}

static ssize_t write_to_sink(void *cookie, const char *bytes, size_t size) {
  fg_sink *sink = cookie;
  if (sink->dropped) return (ssize_t)size;
  bool put = sink->terminal ? put_visible(sink, bytes, size, false) : put_bytes(sink, bytes, size);
  return put ? (ssize_t)size : 0;
}

/* Follows links to the final path: a rename onto a symbolic link would replace the link, not its
 * file. */
static fg_status resolve_links(fg_context *ctx, const char *path, char **resolved) {
  *resolved = realpath(path, NULL);
  if (!*resolved) *resolved = strdup(path);
  if (!*resolved) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
  return FG_OK;
}

/* Passes on the old file's mode and owner. If the group cannot be kept, the new group gets the
 * permissions of others. */
static void pass_on_mode(int descriptor, const struct stat *old) {
  struct stat fresh;
  mode_t mode = old->st_mode & 0777;
  bool other =
      fstat(descriptor, &fresh) != 0 || fresh.st_uid != old->st_uid || fresh.st_gid != old->st_gid;
  if (other && fchown(descriptor, old->st_uid, old->st_gid) != 0 &&
      fchown(descriptor, (uid_t)-1, old->st_gid) != 0)
    mode &= ~(mode_t)070 | ((mode & 07) << 3);
  fchmod(descriptor, mode);
}

/* `old`: the file that is replaced, or NULL. Until the new one has its mode, nobody else can read
 * it. */
static fg_status open_temporary(fg_context *ctx, fg_output *output, const struct stat *old) {
  fg_sink *sink = output->sink;
  int error = fg_temporary_create(output->path, old ? 0600 : 0666, &sink->temporary);
  if (error) return fg_output_fail(ctx, output->path, error);
  sink->descriptor = sink->temporary->descriptor;
  if (old) pass_on_mode(sink->descriptor, old);
  return FG_OK;
}

/* Returns the descriptor that a path stands for; -1: none. A new file under that path would
 * disconnect other writers to the descriptor. */
static int descriptor_of(const char *path) {
  static const char *const folders[] = {"/dev/fd/", "/proc/self/fd/"};
  if (!strcmp(path, "/dev/stdout")) return STDOUT_FILENO;
  if (!strcmp(path, "/dev/stderr")) return STDERR_FILENO;
  for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
    size_t length = strlen(folders[i]);
    if (strncmp(path, folders[i], length) != 0) continue;
    size_t digits = strspn(path + length, "0123456789");
    if (digits > 0 && digits < 8 && !path[length + digits]) return atoi(path + length);
  }
  return -1;
}

static fg_status open_directly(fg_context *ctx, fg_output *output, const char *path) {
  int named = descriptor_of(path);
  fg_sink *sink = output->sink;
  sink->descriptor = named < 0 ? open(path, O_WRONLY | O_NOCTTY | O_CLOEXEC)
                               : fcntl(named, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  sink->owned = sink->descriptor >= 0;
  if (!sink->owned) return fg_output_fail(ctx, path, errno);
  output->path = strdup(path);
  return output->path ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
}

static fg_status open_path(fg_context *ctx, const char *path, fg_output *output) {
  struct stat entry;
  bool exists = stat(path, &entry) == 0;
  if (exists && S_ISDIR(entry.st_mode)) return fg_output_fail(ctx, path, EISDIR);
  if (descriptor_of(path) >= 0 || (exists && !S_ISREG(entry.st_mode)))
    return open_directly(ctx, output, path);
  /* A rename would replace even a file that its owner made read-only. */
  if (exists && access(path, W_OK) != 0) return fg_output_fail(ctx, path, errno);
  FG_TRY(resolve_links(ctx, path, &output->path));
  return open_temporary(ctx, output, exists ? &entry : NULL);
}

static fg_status open_stream(fg_context *ctx, fg_output *output) {
  static const cookie_io_functions_t functions = {.write = write_to_sink};
  output->sink->terminal = !output->sink->temporary && isatty(output->sink->descriptor);
  output->stream = fopencookie(output->sink, "wb", functions);
  if (!output->stream) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: an output");
  __fsetlocking(output->stream, FSETLOCKING_BYCALLER); /* one thread writes to an output */
  return FG_OK;
}

fg_status fg_output_open(fg_context *ctx, const char *path, fg_output *output) {
  void *block;
  *output = (fg_output){0};
  if (path && !*path)
    return fg_fail(ctx, FG_ERR_USAGE, "the output has an empty name; give the name of a file");
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *output->sink, &block));
  output->sink = block;
  output->sink->descriptor = STDOUT_FILENO;
  fg_status status = path && strcmp(path, "-") != 0 ? open_path(ctx, path, output) : FG_OK;
  if (status == FG_OK) status = open_stream(ctx, output);
  if (status != FG_OK) fg_output_discard(output);
  return status;
}

static const char *output_name(const fg_output *output) {
  return output->path ? output->path : "standard output";
}

fg_status fg_output_flush(fg_context *ctx, fg_output *output, fg_status status) {
  if (status != FG_OK && status != FG_ERR_IO) return status;
  bool broken = fflush(output->stream) != 0 || ferror(output->stream);
  if (output->sink->held_count) put_visible(output->sink, "", 0, true);
  if (output->sink->error) return fg_output_fail(ctx, output_name(output), output->sink->error);
  return broken && status == FG_OK ? fg_output_fail(ctx, output_name(output), EIO) : status;
}

/* Syncs the folder: the rename itself is durable only then. Not every file system can sync a
 * folder, and the file is complete either way, so a failure here is none. */
static void sync_folder(const char *path) {
  const char *slash = strrchr(path, '/');
  char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
  if (!folder) return;
  int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor >= 0) {
    fsync(descriptor);
    close(descriptor);
  }
  free(folder);
}

static fg_status publish_output(fg_context *ctx, fg_output *output) {
  fg_sink *sink = output->sink;
  FG_TRY(fg_output_flush(ctx, output, FG_OK));
  if (sink->owned) {
    sink->owned = false;
    return close(sink->descriptor) == 0 ? FG_OK : fg_output_fail(ctx, output_name(output), errno);
  }
  if (!sink->temporary) return FG_OK;
  int error = fsync(sink->descriptor) == 0 ? 0 : errno;
  if (!error) error = fg_temporary_rename(sink->temporary, output->path);
  if (error) return fg_output_fail(ctx, output_name(output), error);
  sync_folder(output->path);
  return FG_OK;
}

fg_status fg_output_commit(fg_context *ctx, fg_output *output) {
  fg_status status = publish_output(ctx, output);
  fg_output_discard(output);
  return status;
}

void fg_output_discard(fg_output *output) {
  fg_sink *sink = output->sink;
  if (sink) sink->dropped = true;
  if (output->stream) fclose(output->stream);
  if (sink) {
    if (sink->owned) close(sink->descriptor);
    fg_temporary_close(sink->temporary);
  }
  free(sink);
  free(output->path);
  *output = (fg_output){0};
}

fg_status fg_output_end(fg_context *ctx, fg_output *output, fg_status status) {
  status = fg_output_flush(ctx, output, status);
  if (status == FG_OK) return fg_output_commit(ctx, output);
  fg_output_discard(output);
  return status;
}

static fg_status read_stream(fg_context *ctx, FILE *stream, const char *path, size_t cap,
                             char **text) {
  size_t length = 0, capacity = 0;
  size_t got = 0;
  do {
    FG_TRY(fg_memory_reserve(ctx, length + 4096 + 1, 1, &capacity, (void **)text));
    got = fread(*text + length, 1, capacity - length - 1, stream);
    length += got;
    if (length > cap)
      return fg_fail(ctx, FG_ERR_DATA, "%s: longer than %zu bytes; is it the right file?", path,
                     cap);
  } while (got > 0);
  if (ferror(stream) && errno == EISDIR)
    return fg_fail(ctx, FG_ERR_IO, "%s: is a folder; give the name of a file", path);
  if (ferror(stream))
    return fg_fail(ctx, fg_status_of_errno(errno),
                   "%s: cannot be read: %s; check the disk or copy it again", path,
                   strerror(errno));
  (*text)[length] = '\0';
  const char *nul = memchr(*text, '\0', length);
  if (nul && length > 1 && (!memcmp(*text, "\xff\xfe", 2) || !memcmp(*text, "\xfe\xff", 2)))
    return fg_fail(ctx, FG_ERR_DATA, "%s: this is UTF-16; save it as UTF-8 or as CSV", path);
  if (nul)
    return fg_fail(ctx, FG_ERR_DATA, "%s: not a text: byte %zu is zero; is it the right file?",
                   path, (size_t)(nul - *text));
  return FG_OK;
}

fg_status fg_file_open(fg_context *ctx, const char *path, FILE **stream) {
  *stream = fopen(path, "rbe");
  if (*stream) return FG_OK;
  const char *advice = errno == ENOMEM   ? "close other programs"
                       : errno == EACCES ? "ask for permission to read it"
                                         : "check the name";
  return fg_fail(ctx, fg_status_of_errno(errno), "%.600s: cannot be opened: %s; %s", path,
                 strerror(errno), advice);
}

fg_status fg_file_open_to_append(fg_context *ctx, const char *path, FILE **stream) {
  *stream = fopen(path, "a+e");
  if (!*stream) return fg_output_fail(ctx, path, errno);
  rewind(*stream); /* where reading begins is not defined */
  return FG_OK;
}

fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text) {
  FILE *stream;
  *text = NULL;
  FG_TRY(fg_file_open(ctx, path, &stream));
  fg_status status = read_stream(ctx, stream, path, cap, text);
  fclose(stream);
  if (status != FG_OK) {
    free(*text);
    *text = NULL;
  }
  return status;
}

fg_status fg_file_read_token(fg_context *ctx, const char *path, char *token, int size) {
  FILE *file;
  FG_TRY(fg_file_open(ctx, path, &file));
  char *line = fgets(token, size, file);
  fclose(file);
  if (!line)
    return fg_fail(ctx, FG_ERR_DATA, "%.600s: it is empty; its first line must be the token", path);
  token[strcspn(token, " \t\r\n")] = '\0';
  return FG_OK;
}

/* An earlier write may have failed, whose errno is lost. */
fg_status fg_stream_finish(fg_context *ctx, FILE *out, const char *what) {
  bool failed = ferror(out) != 0;
  errno = 0;
  if (fflush(out) == 0 && !failed) return FG_OK;
  return fg_fail(ctx, fg_status_of_errno(errno),
                 "%s cannot be written: %s; is there space on the disk?", what,
                 errno ? strerror(errno) : "a write failed");
}

void fg_file_find_beside(const char *path, const char *name, char *file, size_t size) {
  const char *slash = strrchr(path, '/');
  bool beside = slash && name[0] != '/';
  fg_text_clip(file, size, "%.*s%s", beside ? (int)(slash - path) + 1 : 0, path, name);
}
