/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/folder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static fg_status make_one(fg_context *ctx, const char *path) {
  struct stat about;
  if (mkdir(path, 0777) == 0) return FG_OK;
  int error = errno;
  if (error == EEXIST && stat(path, &about) == 0 && !S_ISDIR(about.st_mode)) error = ENOTDIR;
  if (error == EEXIST) return FG_OK;
  return fg_fail(ctx, fg_status_of_errno(error), "%s: the folder cannot be made: %s",
                 *path ? path : "''", strerror(error));
}

/* Parents are made only when the whole path cannot be made at once: an existing folder may lie in
 * one that is not writable. */
fg_status fg_folder_make(fg_context *ctx, const char *path) {
  if (mkdir(path, 0777) == 0) return FG_OK;
  if (errno != ENOENT || !*path) return make_one(ctx, path);
  fg_status status = FG_OK;
  char *part = strdup(path);
  if (!part) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the folder %s", path);
  for (char *slash = strchr(part + 1, '/'); slash && status == FG_OK;
       slash = strchr(slash + 1, '/')) {
    *slash = '\0';
    struct stat about;
    if (stat(part, &about) != 0) status = make_one(ctx, part);
    *slash = '/';
  }
  free(part);
  return status == FG_OK ? make_one(ctx, path) : status;
}

fg_status fg_folder_require(fg_context *ctx, const char *path) {
  struct stat info;
  if (stat(path, &info) == 0) {
    if (S_ISDIR(info.st_mode)) return FG_OK;
    errno = ENOTDIR;
  }
  return fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be opened: %s", *path ? path : "''",
                 strerror(errno));
}
