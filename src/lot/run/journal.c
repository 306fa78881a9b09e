/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"

enum { SYNC_RECORDS = 64, COPY_BYTES = 1 << 16 };

static fg_status copy_entry(fg_context *ctx, const char *path, int from, fg_journal_entry entry,
                            FILE *out) {
  char piece[COPY_BYTES];
  while (entry.length) {
    size_t want = entry.length < sizeof piece ? entry.length : sizeof piece;
    ssize_t got = pread(from, piece, want, entry.offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return fg_journal_fail(ctx, path, "read");
    fwrite(piece, 1, (size_t)got, out);
    entry.offset += got;
    entry.length -= (size_t)got;
  }
  return FG_OK;
}

static fg_status copy_entries(fg_context *ctx, const char *const *from, const size_t *from_of,
                              const fg_journal_entry *entries, size_t count, FILE *out) {
  int descriptor = -1;
  size_t opened = 0;
  fg_status status = FG_OK;
  for (size_t i = 0; i < count && status == FG_OK; i++) {
    size_t file = from_of ? from_of[i] : 0;
    if (!entries[i].length) continue;
    if (descriptor >= 0 && file != opened) {
      close(descriptor);
      descriptor = -1;
    }
    if (descriptor < 0) descriptor = open(from[file], O_RDONLY | O_CLOEXEC);
    opened = file;
    status = descriptor < 0 ? fg_journal_fail(ctx, from[file], "opened")
                            : copy_entry(ctx, from[file], descriptor, entries[i], out);
  }
  if (descriptor >= 0) close(descriptor);
  return status;
}

static void place_entries(fg_journal_entry *entries, size_t count, size_t at) {
  for (size_t i = 0; i < count; i++) {
    entries[i].offset = (off_t)at;
    at += entries[i].length;
  }
}

fg_status fg_journal_rewrite(fg_context *ctx, const char *to, const fg_journal_head *head,
                             const char *const *from, const size_t *from_of,
                             fg_journal_entry *entries, size_t count) {
  fg_output output;
  size_t length;
  FG_TRY(fg_output_open(ctx, to, &output));
  fg_status status = fg_journal_write_head(ctx, output.stream, head, &length);
  if (status == FG_OK) status = copy_entries(ctx, from, from_of, entries, count, output.stream);
  place_entries(entries, count, length);
  return fg_output_end(ctx, &output, status);
}

fg_status fg_journal_write(fg_context *ctx, const char *to, const fg_journal_head *head,
                           fg_journal_source *source, void *user) {
  fg_output output;
  size_t head_length;
  FG_TRY(fg_output_open(ctx, to, &output));
  fg_status status = fg_journal_write_head(ctx, output.stream, head, &head_length);
  for (size_t i = 0; i < head->items && status == FG_OK; i++) {
    char *line = NULL;
    size_t length = 0;
    status = source(ctx, user, i, &line, &length);
    if (status == FG_OK) fwrite(line, 1, length, output.stream);
    free(line);
  }
  return fg_output_end(ctx, &output, status);
}

fg_status fg_journal_open(fg_context *ctx, const char *path, fg_journal *journal) {
  *journal = (fg_journal){.descriptor = open(path, O_WRONLY | O_CLOEXEC)};
  if (journal->descriptor < 0) return fg_journal_fail(ctx, path, "opened");
  journal->end = lseek(journal->descriptor, 0, SEEK_END);
  journal->path = strdup(path);
  clock_gettime(CLOCK_MONOTONIC, &journal->synced);
  pthread_mutex_init(&journal->mutex, NULL);
  return journal->path ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a path");
}

static bool write_whole(const fg_journal *journal, const char *line, size_t length) {
  size_t done = 0;
  while (done < length) {
    ssize_t put =
        pwrite(journal->descriptor, line + done, length - done, journal->end + (off_t)done);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    done += (size_t)put;
  }
  return true;
}

/* Limits syncs to one a second or SYNC_RECORDS records: a power cut may lose so much. */
static bool is_sync_due(fg_journal *journal) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (++journal->unsynced < SYNC_RECORDS && now.tv_sec <= journal->synced.tv_sec) return false;
  journal->unsynced = 0;
  journal->synced = now;
  return true;
}

fg_status fg_journal_append(fg_context *ctx, fg_journal *journal, const char *line, size_t length,
                            fg_journal_entry *entry) {
  fg_status status = FG_OK;
  bool due = false;
  pthread_mutex_lock(&journal->mutex);
  if (write_whole(journal, line, length)) {
    *entry = (fg_journal_entry){journal->end, length};
    journal->end += (off_t)length;
    due = is_sync_due(journal);
  } else {
    status = fg_journal_fail(ctx, journal->path, "written");
    if (ftruncate(journal->descriptor, journal->end) != 0) entry->length = 0;
  }
  pthread_mutex_unlock(&journal->mutex);
  /* Other threads do not wait for the disk. */
  if (due && fdatasync(journal->descriptor) != 0)
    status = fg_journal_fail(ctx, journal->path, "written");
  return status;
}

fg_status fg_journal_close(fg_context *ctx, fg_journal *journal) {
  fg_status status = FG_OK;
  if (!journal->path) return FG_OK;
  if (fsync(journal->descriptor) != 0) status = fg_journal_fail(ctx, journal->path, "written");
  if (close(journal->descriptor) != 0 && status == FG_OK)
    status = fg_journal_fail(ctx, journal->path, "written");
  pthread_mutex_destroy(&journal->mutex);
  free(journal->path);
  *journal = (fg_journal){.descriptor = -1};
  return status;
}
