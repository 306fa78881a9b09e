#include "core/file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"

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
};

static fg_status fail_to_write(fg_context *ctx, const char *path, int error) {
  const char *advice = "check the disk or choose another place";
  for (size_t i = 0; i < sizeof advices / sizeof advices[0]; i++)
    if (advices[i].error == error) advice = advices[i].advice;
  return fg_fail(ctx, FG_ERR_IO, "%s: cannot be written: %s; %s", path,
                 error ? strerror(error) : "a write failed", advice);
}

/* Where the bytes end up: a rename onto a symbolic link would replace the link, not its file. */
static fg_status resolve_links(fg_context *ctx, const char *path, char **resolved) {
  *resolved = realpath(path, NULL);
  if (!*resolved) *resolved = strdup(path);
  if (!*resolved) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
  return FG_OK;
}

/* A name in the folder of `path` that nobody else has, with the stream that writes to it. The name
 * does not grow with the final one, which may be as long as a name can be. */
static fg_status open_temporary(fg_context *ctx, fg_output *output) {
  const char *slash = strrchr(output->path, '/');
  int folder_length = slash ? (int)(slash - output->path) + 1 : 0;
  int descriptor = -1;
  do {
    uint64_t random = 0;
    if (getrandom(&random, sizeof random, 0) < 0) random = (uint64_t)getpid();
    free(output->temporary);
    output->temporary = NULL;
    if (asprintf(&output->temporary, "%.*s.foilgauge-%016" PRIx64 ".tmp", folder_length,
                 output->path, random) < 0) {
      output->temporary = NULL;
      return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", output->path);
    }
    descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EEXIST);
  if (descriptor >= 0) output->stream = fdopen(descriptor, "wb");
  if (output->stream) return FG_OK;

  int error = errno;
  if (descriptor >= 0) {
    close(descriptor);
    unlink(output->temporary);
  }
  free(output->temporary);
  output->temporary = NULL;
  return fail_to_write(ctx, output->path, error);
}

static fg_status open_directly(fg_context *ctx, fg_output *output) {
  output->stream = fopen(output->path, "wbe");
  return output->stream ? FG_OK : fail_to_write(ctx, output->path, errno);
}

static fg_status open_path(fg_context *ctx, const char *path, fg_output *output) {
  struct stat entry;
  bool exists = stat(path, &entry) == 0;
  if (exists && S_ISDIR(entry.st_mode)) return fail_to_write(ctx, path, EISDIR);
  bool special = !strncmp(path, "/dev/", 5) || (exists && !S_ISREG(entry.st_mode));
  if (special) {
    output->path = strdup(path);
    if (!output->path) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
    return open_directly(ctx, output);
  }
  /* A rename would replace even a file that its owner made read-only. */
  if (exists && access(path, W_OK) != 0) return fail_to_write(ctx, path, errno);
  FG_TRY(resolve_links(ctx, path, &output->path));
  return open_temporary(ctx, output);
}

fg_status fg_output_open(fg_context *ctx, const char *path, fg_output *output) {
  *output = (fg_output){0};
  if (!path || !strcmp(path, "-")) {
    output->stream = stdout;
    return FG_OK;
  }
  if (!*path)
    return fg_fail(ctx, FG_ERR_USAGE, "the output has an empty name; give the name of a file");
  fg_status status = open_path(ctx, path, output);
  if (status != FG_OK) fg_output_discard(output);
  return status;
}

/* The first thing that went wrong, as an errno; 0 when all is on the disk. */
static int flush_durably(fg_output *output) {
  errno = 0;
  bool broken = ferror(output->stream) != 0;
  if (fflush(output->stream) != 0 || broken) return errno ? errno : EIO;
  if (output->temporary && fsync(fileno(output->stream)) != 0) return errno;
  if (output->stream == stdout) return 0;
  int closed = fclose(output->stream);
  output->stream = NULL;
  return closed == 0 ? 0 : errno;
}

/* The rename itself is durable only when the folder is. Not every file system can sync a folder,
 * and the file is whole either way, so a failure here is none. */
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

fg_status fg_output_commit(fg_context *ctx, fg_output *output) {
  const char *name = output->path ? output->path : "standard output";
  fg_status status = FG_OK;
  int error = flush_durably(output);
  if (!error && output->temporary && rename(output->temporary, output->path) != 0) error = errno;
  if (error) {
    status = fail_to_write(ctx, name, error);
  } else if (output->temporary) {
    sync_folder(output->path);
    free(output->temporary);
    output->temporary = NULL;
  }
  fg_output_discard(output);
  return status;
}

void fg_output_discard(fg_output *output) {
  if (output->stream && output->stream != stdout) fclose(output->stream);
  if (output->temporary) unlink(output->temporary);
  free(output->temporary);
  free(output->path);
  *output = (fg_output){0};
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
  if (ferror(stream))
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
  (*text)[length] = '\0';
  const char *nul = memchr(*text, '\0', length);
  if (nul)
    return fg_fail(ctx, FG_ERR_DATA, "%s: not a text: byte %zu is zero; is it the right file?",
                   path, (size_t)(nul - *text));
  return FG_OK;
}

fg_status fg_file_read_text(fg_context *ctx, const char *path, size_t cap, char **text) {
  *text = NULL;
  FILE *stream = fopen(path, "rbe");
  if (!stream)
    return fg_fail(ctx, FG_ERR_IO, "%s: cannot be opened: %s; check the name", path,
                   strerror(errno));
  fg_status status = read_stream(ctx, stream, path, cap, text);
  fclose(stream);
  if (status != FG_OK) {
    free(*text);
    *text = NULL;
  }
  return status;
}
