/* A file is whole when its writer has closed or renamed it (inotify), or, where the system does
 * not tell (network folders, files that were there before), when it has been at rest for a while.
 * Whatever inotify says, the folder is listed now and then: what was missed is found. */
#include "station/watch.h"

#include <dirent.h>
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/text.h"
#include "station/intake.h"

enum { NAMES_MAX = 100000, LIST_EVERY_MS = 10000, LIST_SOON_MS = 500, EVENT_BYTES = 1 << 16 };
#define AT_REST_NS 2000000000LL /* as long as a slow scanner pauses between rows */

typedef struct found {
  char *name;
  int64_t modified_ns;
} found;

typedef struct watch {
  fg_inspection *station;
  int inotify, descriptor; /* -1: none */
  found *files;
  size_t count, capacity;
  bool pending; /* a file was not whole yet */
  bool gone;    /* the folder */
} watch;

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* What is the station's own, hidden, or on its way under a name of its own. */
static bool is_ignored(const char *name) {
  static const char *const endings[] = {".tmp", ".part", ".crdownload", ".swp", "~"};
  size_t length = strlen(name);
  if (name[0] == '.' || !strncmp(name, FG_STATION_DATABASE, strlen(FG_STATION_DATABASE)))
    return true;
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    size_t end = strlen(endings[i]);
    if (length > end && !strcasecmp(name + length - end, endings[i])) return true;
  }
  return false;
}

static fg_status add(fg_context *ctx, watch *at, const char *name, int64_t modified_ns) {
  void *block = at->files;
  FG_TRY(fg_memory_reserve(ctx, at->count + 1, sizeof *at->files, &at->capacity, &block));
  at->files = block;
  FG_TRY(fg_text_print(ctx, &at->files[at->count].name, "%s", name));
  at->files[at->count++].modified_ns = modified_ns;
  return FG_OK;
}

static void clear(watch *at) {
  for (size_t i = 0; i < at->count; i++)
    free(at->files[i].name);
  at->count = 0;
}

/* In order of arrival: a file that is copied keeps its own time, so that two of one time go by
 * name. */
static int by_arrival(const void *a, const void *b) {
  const found *one = a, *other = b;
  if (one->modified_ns != other->modified_ns) return one->modified_ns < other->modified_ns ? -1 : 1;
  return strcmp(one->name, other->name);
}

static fg_status list(fg_context *ctx, watch *at) {
  const char *folder = at->station->request->folder;
  fg_status status = FG_OK;
  DIR *open = opendir(folder);
  clear(at);
  at->gone = !open;
  if (!open) return FG_OK;
  for (struct dirent *entry; status == FG_OK && (entry = readdir(open));) {
    struct stat file;
    if (is_ignored(entry->d_name) || fstatat(dirfd(open), entry->d_name, &file, 0) != 0 ||
        !S_ISREG(file.st_mode))
      continue;
    if (at->count == NAMES_MAX)
      status = fg_fail(ctx, FG_ERR_DATA, "%s: more than %d files; move old ones elsewhere", folder,
                       NAMES_MAX);
    else
      status = add(ctx, at, entry->d_name,
                   (int64_t)file.st_mtim.tv_sec * 1000000000 + file.st_mtim.tv_nsec);
  }
  closedir(open);
  if (at->count) qsort(at->files, at->count, sizeof *at->files, by_arrival);
  return status;
}

static fg_status take(fg_context *ctx, watch *at, const char *name, bool closed) {
  bool later;
  FG_TRY(fg_station_take_file(ctx, at->station, name, closed, &later));
  at->pending = at->pending || later;
  return FG_OK;
}

/* Everything that is there; `once` does not wait for anybody. A time in the future is no reason to
 * wait: clocks differ. */
static fg_status take_all(fg_context *ctx, watch *at, bool once) {
  at->pending = false;
  FG_TRY(list(ctx, at));
  for (size_t i = 0; i < at->count; i++) {
    int64_t age = now_ns() - at->files[i].modified_ns;
    bool at_rest = once || age > AT_REST_NS || age < 0;
    FG_TRY(take(ctx, at, at->files[i].name, at_rest));
    at->pending = at->pending || !at_rest;
  }
  return FG_OK;
}

static void stop_listening(watch *at) {
  if (at->inotify >= 0) close(at->inotify);
  at->inotify = at->descriptor = -1;
}

/* Where the system cannot tell, the folder is listed. */
static void listen_to(watch *at) {
  stop_listening(at);
  if (at->station->request->poll_s > 0) return;
  at->inotify = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
  if (at->inotify < 0) return;
  at->descriptor = inotify_add_watch(at->inotify, at->station->request->folder,
                                     IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_MODIFY |
                                         IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR);
  if (at->descriptor < 0) stop_listening(at);
}

static fg_status take_event(fg_context *ctx, watch *at, const struct inotify_event *event) {
  if (event->mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_IGNORED | IN_UNMOUNT | IN_Q_OVERFLOW)) {
    at->gone = !(event->mask & IN_Q_OVERFLOW);
    at->pending = true;
    return FG_OK;
  }
  if (!event->len || is_ignored(event->name)) return FG_OK;
  if (event->mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) return take(ctx, at, event->name, true);
  at->pending = true; /* it is being written */
  return FG_OK;
}

/* Waits for the next thing to do: events that came, or the time to list. */
static fg_status wait_and_take(fg_context *ctx, watch *at, int64_t *listed) {
  _Alignas(struct inotify_event) char bytes[EVENT_BYTES];
  double poll_s = at->station->request->poll_s;
  int wait = at->pending || at->gone ? LIST_SOON_MS
             : poll_s > 0            ? (int)(1000 * poll_s)
                                     : LIST_EVERY_MS;
  struct pollfd descriptor = {.fd = at->inotify, .events = POLLIN};
  poll(&descriptor, 1, wait);
  ssize_t got = at->inotify >= 0 ? read(at->inotify, bytes, sizeof bytes) : -1;
  for (ssize_t i = 0; i < got;) {
    const struct inotify_event *event = (const void *)(bytes + i);
    FG_TRY(take_event(ctx, at, event));
    i += (ssize_t)sizeof *event + event->len;
  }
  if (now_ns() - *listed < (int64_t)wait * 1000000 && got > 0) return FG_OK;
  bool was_gone = at->gone;
  FG_TRY(take_all(ctx, at, false));
  if (was_gone || at->inotify < 0) listen_to(at);
  *listed = now_ns();
  return FG_OK;
}

fg_status fg_station_watch(fg_context *ctx, fg_inspection *station, bool once) {
  watch at = {.station = station, .inotify = -1, .descriptor = -1};
  int64_t listed = now_ns();
  if (!once) listen_to(&at);
  fg_status status = take_all(ctx, &at, once);
  if (status == FG_OK && once && at.gone)
    status = fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be read: %s", station->request->folder,
                     strerror(errno));
  while (status == FG_OK && !once)
    status = wait_and_take(ctx, &at, &listed);
  stop_listening(&at);
  clear(&at);
  free(at.files);
  return status;
}
