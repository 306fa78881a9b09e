/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/folder_lock.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/folder.h"
#include "core/text.h"

/* Removes temporary outputs (core/file.h) of a killed run; other files stay. */
static void remove_leftovers(const char *folder) {
  static const char first[] = ".foilgauge-", last[] = ".tmp";
  DIR *entries = opendir(folder);
  const struct dirent *entry;
  while (entries && (entry = readdir(entries))) {
    size_t length = strlen(entry->d_name), end = sizeof last - 1;
    if (strncmp(entry->d_name, first, sizeof first - 1) != 0 || length < end) continue;
    if (!strcmp(entry->d_name + length - end, last)) unlinkat(dirfd(entries), entry->d_name, 0);
  }
  if (entries) closedir(entries);
}

fg_status fg_folder_lock(fg_context *ctx, const char *folder, int *lock) {
  char *path = NULL;
  FG_TRY(fg_folder_require(ctx, folder));
  FG_TRY(fg_text_print(ctx, &path, "%s/.lock", folder));
  fg_status status = FG_OK;
  *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (*lock < 0) {
    status = fg_fail(ctx, fg_status_of_errno(errno),
                     "%s: nothing can be written in this folder: %s; results are kept in it: ask "
                     "for permission, or choose another",
                     folder, strerror(errno));
  } else if (flock(*lock, LOCK_EX | LOCK_NB) != 0) {
    status = fg_fail(ctx, FG_ERR_IO,
                     "%s: another run is at work in this folder; wait for it, or choose another",
                     folder);
    close(*lock);
    *lock = -1;
  }
  if (status == FG_OK) remove_leftovers(folder);
  free(path);
  return status;
}
