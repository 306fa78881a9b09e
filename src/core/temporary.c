/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "foilgauge/file.h"

/* Held while a name is added or removed, so that the list is right at every moment. */
static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER;
static fg_temporary *first;

/* Max number of names for one output; creation fails when running processes hold all of them. */
enum { NAMES = 64 };

/* FNV-1a, of the last part of the path. */
static uint64_t hash_name(const char *path) {
  const char *slash = strrchr(path, '/');
  uint64_t hash = 14695981039346656037u;
  for (const char *at = slash ? slash + 1 : path; *at; at++)
    hash = (hash ^ (unsigned char)*at) * 1099511628211u;
  return hash;
}

/* The name does not grow with the final one, which may be as long as a name can be. */
static char *name_beside(const char *path, unsigned number) {
  const char *slash = strrchr(path, '/');
  char *name = NULL;
  if (asprintf(&name, "%.*s.foilgauge-%016" PRIx64 ".tmp", slash ? (int)(slash - path) + 1 : 0,
               path, hash_name(path) + number) < 0)
    return NULL;
  return name;
}

/* Removes a file that nobody holds: it belongs to a killed run. It is removed while it is locked: a
 * run that has just made it cannot lock it then, and uses another. */
static bool remove_stale(const char *name) {
  struct stat info;
  int descriptor = open(name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return errno == ENOENT;
  bool stale = fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) &&
               flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  bool removed = stale && (unlink(name) == 0 || errno == ENOENT);
  close(descriptor);
  return removed;
}

/* Locks a file. Where files cannot be locked, nobody removes a stale one either. */
static bool lock_file(int descriptor) {
  struct stat info;
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  return fstat(descriptor, &info) == 0 && info.st_nlink > 0;
}

/* Returns an errno, or 0 with an open file of that name. EEXIST: another process uses it. */
static int create_named(const char *name, mode_t mode, int *descriptor) {
  for (int attempt = 0; attempt < 2; attempt++) {
    *descriptor = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (*descriptor >= 0) {
      if (lock_file(*descriptor)) return 0;
      close(*descriptor);
      return EEXIST;
    }
    if (errno != EEXIST) return errno;
    if (!remove_stale(name)) return EEXIST;
  }
  return EEXIST;
}

int fg_temporary_create(const char *path, mode_t mode, fg_temporary **made) {
  int error = EEXIST;
  fg_temporary *temporary = calloc(1, sizeof *temporary);
  if (!temporary) return ENOMEM;
  pthread_mutex_lock(&guard);
  for (unsigned number = 0; number < NAMES && error == EEXIST; number++) {
    free(temporary->path);
    temporary->path = name_beside(path, number);
    error = temporary->path ? create_named(temporary->path, mode, &temporary->descriptor) : ENOMEM;
  }
  if (!error) {
    temporary->next = first;
    first = temporary;
  }
  pthread_mutex_unlock(&guard);
  if (error) {
    free(temporary->path);
    free(temporary);
    temporary = NULL;
  }
  *made = temporary;
  return error;
}

static void remove_from_list(const fg_temporary *temporary) {
  fg_temporary **at = &first;
  while (*at && *at != temporary)
    at = &(*at)->next;
  if (*at) *at = temporary->next;
}

int fg_temporary_rename(fg_temporary *temporary, const char *path) {
  pthread_mutex_lock(&guard);
  int error = rename(temporary->path, path) == 0 ? 0 : errno;
  if (!error) {
    remove_from_list(temporary);
    free(temporary->path);
    temporary->path = NULL;
  }
  pthread_mutex_unlock(&guard);
  return error;
}

void fg_temporary_close(fg_temporary *temporary) {
  if (!temporary) return;
  if (temporary->path) {
    pthread_mutex_lock(&guard);
    unlink(temporary->path);
    remove_from_list(temporary);
    pthread_mutex_unlock(&guard);
  }
  close(temporary->descriptor);
  free(temporary->path);
  free(temporary);
}

void fg_temporaries_remove(void) {
  pthread_mutex_lock(&guard);
  for (const fg_temporary *at = first; at; at = at->next)
    unlink(at->path);
}
