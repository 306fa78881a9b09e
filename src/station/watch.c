/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Watches the folder. A file is inspected when its writer has closed or renamed it (inotify). Where
 * the system does not notify (network folders, earlier files) it is inspected once it has not
 * changed for a while. An incomplete file is waited for: its writer may only pause. The folder is
 * also listed now and then, to find events that inotify missed.
 *
 * Tasks that the station cannot do now (a full disk, a folder that is gone) are shown on its
 * pages, and are tried again. */
#include "station/watch.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "station/file_stability.h"
#include "station/intake.h"
#include "station/keep.h"
#include "station/news.h"
#include "station/recovery.h"
#include "station/stored_name.h"

/* TURN_MS: longest sleep without an event. A folder that is removed while one of its files is
 * open (as the database is) sends none. */
enum { LIST_EVERY_MS = 30000, LIST_SOON_MS = 500, TURN_MS = 500, EVENT_BYTES = 1 << 16 };

typedef struct found {
  char *name;
  int64_t bytes, modified_ns;
} found;

typedef struct watch {
  fg_inspection *station;
  int inotify;  /* -1: none */
  dev_t device; /* of the folder that is listened to: another one may come under its name */
  ino_t inode;
  found *files; /* that are not done */
  size_t count, capacity;
  fg_file_stability stability;
  int64_t listed_ns; /* when the folder was, by the steady clock; 0: not yet */
  int64_t took_ns;   /* for the list alone, without measuring */
  bool pending;      /* a file was not whole yet */
  bool once;
} watch;

static int64_t now_ns(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* True for the station's own files, hidden ones, and files in transfer under a temporary name. */
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

static int64_t modified_ns(const struct stat *file) {
  return (int64_t)file->st_mtim.tv_sec * 1000000000 + file->st_mtim.tv_nsec;
}

static fg_status add_found(fg_context *ctx, watch *at, const char *name, const struct stat *file) {
  void *block = at->files;
  FG_TRY(fg_memory_reserve(ctx, at->count + 1, sizeof *at->files, &at->capacity, &block));
  at->files = block;
  FG_TRY(fg_text_print(ctx, &at->files[at->count].name, "%s", name));
  at->files[at->count].bytes = file->st_size;
  at->files[at->count++].modified_ns = modified_ns(file);
  return FG_OK;
}

static void clear(watch *at) {
  for (size_t i = 0; i < at->count; i++)
    free(at->files[i].name);
  at->count = 0;
}

/* Compares files by arrival. A copied file keeps its own time; two of one time are ordered by
 * name. */
static int by_arrival(const void *a, const void *b) {
  const found *one = a, *other = b;
  if (one->modified_ns != other->modified_ns) return one->modified_ns < other->modified_ns ? -1 : 1;
  return strcmp(one->name, other->name);
}

static void sort(watch *at) {
  fg_sort_items(at->files, at->count, sizeof *at->files, by_arrival);
}

/* A list of new files is limited, to bound its memory: it keeps those that came first. The others
 * are found by the next list, which follows at once. */
static void keep_first(watch *at) {
  sort(at);
  while (at->count > FG_STATION_FILES)
    free(at->files[--at->count].name);
  at->pending = true;
}

static fg_status is_done(fg_context *ctx, fg_done_files *done, const char *name,
                         const struct stat *info, bool *is) {
  char *stored;
  FG_TRY(fg_stored_name(ctx, name, &stored));
  const fg_station_file file = {
      .name = stored, .bytes = info->st_size, .modified_ns = modified_ns(info)};
  *is = fg_done_files_have(done, &file);
  free(stored);
  return FG_OK;
}

/* Lists the folder's files that are not done; `*files` is the number of all. */
static fg_status list_entries(fg_context *ctx, watch *at, DIR *open, fg_done_files *done,
                              size_t *files) {
  for (struct dirent *entry; (entry = readdir(open));) {
    struct stat file;
    bool known;
    if (is_ignored(entry->d_name) || fstatat(dirfd(open), entry->d_name, &file, 0) != 0 ||
        !S_ISREG(file.st_mode))
      continue;
    ++*files;
    FG_TRY(is_done(ctx, done, entry->d_name, &file, &known));
    if (!known) FG_TRY(add_found(ctx, at, entry->d_name, &file));
    if (at->count == 2 * FG_STATION_FILES && !at->once) keep_first(at);
  }
  return FG_OK;
}

static fg_status list_folder(fg_context *ctx, watch *at) {
  const char *folder = at->station->request->folder;
  fg_done_files done;
  size_t files = 0;
  int64_t began_ns = now_ns(CLOCK_MONOTONIC);
  clear(at);
  DIR *open = opendir(folder);
  if (!open)
    return fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be read: %s", folder, strerror(errno));
  fg_done_files_begin(&at->station->database, &done);
  fg_status status = list_entries(ctx, at, open, &done, &files);
  fg_status ended = fg_done_files_end(status == FG_OK ? ctx : NULL, &done);
  closedir(open);
  sort(at);
  if (at->count > FG_STATION_FILES && !at->once) keep_first(at);
  at->took_ns = now_ns(CLOCK_MONOTONIC) - began_ns;
  fg_station_note_files(at->station, files, (double)at->took_ns / 1e9);
  return status == FG_OK ? ended : status;
}

static fg_status inspect_closed(fg_context *ctx, watch *at, const char *name) {
  bool later;
  FG_TRY(fg_station_inspect_file(ctx, at->station, name, FG_WRITER_PAUSES, &later));
  at->pending = at->pending || later;
  return FG_OK;
}

static int64_t receive_ns(const watch *at) {
  int64_t given = (int64_t)(at->station->settings->receive_s * 1e9);
  return given > FG_STABLE_NS ? given : FG_STABLE_NS;
}

static fg_writer writer_after(const watch *at, int64_t still_ns) {
  if (still_ns < FG_STABLE_NS) return FG_WRITER_WRITES;
  return still_ns < receive_ns(at) ? FG_WRITER_PAUSES : FG_WRITER_GONE;
}

/* Age, by this machine's clock, of a file that was there before the station began. The clocks of
 * other machines are unknown. */
static fg_writer first_writer(const watch *at, const found *file, bool once) {
  if (once) return FG_WRITER_GONE;
  if (at->listed_ns || at->station->request->poll_s > 0) return FG_WRITER_WRITES;
  return writer_after(at, now_ns(CLOCK_REALTIME) - file->modified_ns);
}

/* A file that is read to its end and found to be cut off is not read again until it changes, or
 * until nothing more is waited for. */
static fg_status inspect_listed(fg_context *ctx, watch *at, const found *file, bool once) {
  bool later;
  fg_stable_file *resting;
  int64_t now = now_ns(CLOCK_MONOTONIC);
  FG_TRY(
      fg_station_inspect_file(ctx, at->station, file->name, first_writer(at, file, once), &later));
  if (!later) return FG_OK;
  FG_TRY(fg_file_stability_note(ctx, &at->stability, file->name, file->bytes, file->modified_ns,
                                now, &resting));
  fg_writer writer = writer_after(at, now - resting->since_ns);
  if (writer == FG_WRITER_GONE || (writer == FG_WRITER_PAUSES && !resting->tried)) {
    FG_TRY(fg_station_inspect_file(ctx, at->station, file->name, writer, &later));
    resting->tried = true;
  }
  at->pending = at->pending || later;
  return FG_OK;
}

/* Waits until the time is over or the folder sends an event. FG_ERR_INTERRUPTED: the station is
 * to end. */
static fg_status wait_for_event(fg_context *ctx, const watch *at, bool of_folder, int wait_ms) {
  int end = at->station->request->end_descriptor;
  struct pollfd descriptors[] = {{.fd = end > 0 ? end : -1, .events = POLLIN},
                                 {.fd = of_folder ? at->inotify : -1, .events = POLLIN}};
  poll(descriptors, 2, wait_ms);
  return descriptors[0].revents ? fg_fail(ctx, FG_ERR_INTERRUPTED, "interrupted") : FG_OK;
}

static void stop_listening(watch *at) {
  if (at->inotify >= 0) close(at->inotify);
  at->inotify = -1;
}

/* True where another folder has replaced the one that is watched. */
static bool is_another_folder(const watch *at) {
  struct stat folder;
  return at->inotify >= 0 && (stat(at->station->request->folder, &folder) != 0 ||
                              folder.st_dev != at->device || folder.st_ino != at->inode);
}

/* Starts listening for events; where the system has none, the folder is listed. IN_ATTRIB: a
 * file may have become readable. */
static void listen_to(watch *at) {
  static const uint32_t events = IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_MODIFY | IN_ATTRIB |
                                 IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
  const char *folder = at->station->request->folder;
  struct stat info;
  stop_listening(at);
  if (at->station->request->poll_s > 0 || stat(folder, &info) != 0) return;
  at->device = info.st_dev;
  at->inode = info.st_ino;
  at->inotify = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
  if (at->inotify >= 0 && inotify_add_watch(at->inotify, folder, events) < 0) stop_listening(at);
}

static fg_status handle_event(fg_context *ctx, watch *at, const struct inotify_event *event) {
  if (event->mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_IGNORED | IN_UNMOUNT | IN_Q_OVERFLOW)) {
    at->pending = true;
    /* Listening ends with the folder; a later folder of its name is another one. */
    if (!(event->mask & IN_Q_OVERFLOW)) stop_listening(at);
    return FG_OK;
  }
  if (!event->len || is_ignored(event->name)) return FG_OK;
  if (event->mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) return inspect_closed(ctx, at, event->name);
  at->pending = true; /* it is being written */
  return FG_OK;
}

/* Handles events; after one that failed, the list finds the files of the others. */
static fg_status handle_events(fg_context *ctx, watch *at) {
  _Alignas(struct inotify_event) char bytes[EVENT_BYTES];
  ssize_t got = at->inotify >= 0 ? read(at->inotify, bytes, sizeof bytes) : -1;
  for (ssize_t i = 0; i < got;) {
    const struct inotify_event *event = (const void *)(bytes + i);
    FG_TRY(handle_event(ctx, at, event));
    i += (ssize_t)sizeof *event + event->len;
  }
  return FG_OK;
}

/* Between two files of a list, which may be long: a scan that comes now does not wait for them. */
static fg_status attend(fg_context *ctx, watch *at) {
  FG_TRY(wait_for_event(ctx, at, false, 0));
  fg_station_database_keep_up(&at->station->database);
  return handle_events(ctx, at);
}

/* Inspects all files; `once` does not wait for writers. A scan that needs more memory than there
 * is does not hold up the others. */
static fg_status inspect_all(fg_context *ctx, watch *at, bool once) {
  fg_status short_of_memory = FG_OK;
  fg_context inner = {.message = ""};
  at->pending = false;
  FG_TRY(list_folder(ctx, at));
  fg_station_begin_round(at->station);
  for (size_t i = 0; i < at->count; i++) {
    FG_TRY(attend(ctx, at));
    fg_status status = inspect_listed(&inner, at, &at->files[i], once);
    if (status == FG_ERR_MEMORY)
      short_of_memory = fg_fail(ctx, status, "%s: %.900s", at->files[i].name, inner.message);
    else if (status != FG_OK)
      return fg_fail(ctx, status, "%s", inner.message);
  }
  fg_file_stability_end_round(&at->stability);
  fg_station_end_round(at->station);
  at->listed_ns = now_ns(CLOCK_MONOTONIC);
  return short_of_memory;
}

/* Returns the pause before the next list. Listing very many files is slow: it may use a
 * twentieth of all time, a half while a file is being written. */
static int list_after_ms(const watch *at) {
  double poll_s = at->station->request->poll_s;
  int64_t took_ms = at->took_ns / 1000000;
  int64_t wait = poll_s > 0 ? (int64_t)(1000 * poll_s) : LIST_EVERY_MS, soon = LIST_SOON_MS;
  if (wait < 20 * took_ms) wait = 20 * took_ms;
  if (soon < 2 * took_ms) soon = 2 * took_ms;
  if ((at->pending || (poll_s <= 0 && at->inotify < 0)) && wait > soon) wait = soon;
  return wait < INT_MAX ? (int)wait : INT_MAX;
}

/* Waits for the next thing to do: events that came, or the time to list. In trouble, events do not
 * bring the next attempt forward. */
static fg_status wait_and_handle(fg_context *ctx, watch *at, bool in_recovery) {
  int wait_ms = in_recovery ? TURN_MS : list_after_ms(at);
  FG_TRY(wait_for_event(ctx, at, !in_recovery, wait_ms < TURN_MS ? wait_ms : TURN_MS));
  fg_station_database_keep_up(&at->station->database);
  FG_TRY(fg_station_ensure_folder(ctx, at->station));
  FG_TRY(handle_events(ctx, at));
  if (is_another_folder(at)) {
    stop_listening(at);
    at->pending = true;
  }
  if (at->inotify < 0) listen_to(at);
  int64_t since_ns = now_ns(CLOCK_MONOTONIC) - at->listed_ns;
  if (since_ns < (int64_t)list_after_ms(at) * 1000000) return FG_OK;
  return inspect_all(ctx, at, false);
}

/* A station goes on in any trouble: a full disk, a missing folder or a damaged database is put
 * right while it runs. */
static fg_status run_watch(fg_context *ctx, watch *at) {
  fg_context inner = {.message = ""};
  fg_status status;
  listen_to(at);
  status = inspect_all(&inner, at, false);
  while (status != FG_ERR_INTERRUPTED) {
    fg_station_set_recovery(at->station, status == FG_OK ? "" : inner.message);
    at->pending = at->pending || status != FG_OK;
    status = wait_and_handle(&inner, at, status != FG_OK);
  }
  return fg_fail(ctx, status, "%s", inner.message);
}

fg_status fg_station_watch(fg_context *ctx, fg_inspection *station, bool once) {
  watch at = {.station = station, .inotify = -1, .once = once};
  fg_status status = once ? inspect_all(ctx, &at, true) : run_watch(ctx, &at);
  stop_listening(&at);
  clear(&at);
  free(at.files);
  fg_file_stability_free(&at.stability);
  return status;
}
