/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.jsonl: records as they are made, and the lock of the folder they lie in.
 *
 * A record is one write of one line, with its own checksum. What a crash leaves is at worst a last
 * line that is not whole; it is dropped when the file is read, as is any line that is not what was
 * written, and what it was about is measured again. A write that fails (disk full) is cut off
 * again, so that every line before it stays whole. */
#ifndef FG_LOT_RUN_JOURNAL_H
#define FG_LOT_RUN_JOURNAL_H

#include <pthread.h>
#include <stdbool.h>
#include <sys/types.h>
#include <time.h>

#include "foilgauge/lot.h"
#include "lot/run/record.h"

/* The first line: what the records belong to. */
typedef struct fg_journal_head {
  char version[32];
  fg_lot_shard shard;
  size_t items; /* of the manifest */
  char manifest_sha256[65], recipe_sha256[65], measured_with[65];
} fg_journal_head;

/* Where a record lies in the file. */
typedef struct fg_journal_entry {
  off_t offset;
  size_t length; /* with its newline; 0: no record */
} fg_journal_entry;

/* What of a journal could not be taken. */
typedef struct fg_journal_damage {
  size_t lines; /* not whole, or not what was written */
  size_t first; /* the first of them, from 1 */
  bool earlier; /* by an earlier version, with other values or without checksums: nothing was taken
                 */
} fg_journal_damage;

/* Called for every whole record; what it takes over it sets to zero. */
typedef fg_status fg_journal_visit(fg_context *ctx, void *user, fg_record *record,
                                   fg_journal_entry entry);

/* Reads the file; what is damaged is noted and left out. FG_ERR_DATA when the first line is not
 * that of a journal of this version. */
fg_status fg_journal_read(fg_context *ctx, const char *path, fg_journal_head *head,
                          fg_journal_damage *damage, fg_journal_visit *visit, void *user);

/* Takes what can be taken, for a caller who measures the rest again: a damaged first line counts as
 * any other, and a journal of an earlier version is only noted. FG_ERR_DATA when there is neither a
 * first line nor a record: then it is no journal, and nobody's to overwrite. */
fg_status fg_journal_salvage(fg_context *ctx, const char *path, fg_journal_damage *damage,
                             fg_journal_visit *visit, void *user);

/* Only the first line. */
fg_status fg_journal_read_head(fg_context *ctx, const char *path, fg_journal_head *head);

/* A new file `to` of the head and the entries of the files `from` (the one number from_of[i], or
 * the first when from_of is NULL), in their order; it replaces `to` when it is whole. */
fg_status fg_journal_rewrite(fg_context *ctx, const char *to, const fg_journal_head *head,
                             const char *const *from, const size_t *from_of,
                             const fg_journal_entry *entries, size_t count);

/* The record of an item as a line (fg_record_format), from malloc. */
typedef fg_status fg_journal_source(fg_context *ctx, void *user, size_t item, char **line,
                                    size_t *length);

/* A new file `to` of the head and a record for each of its items; there only when it is whole. */
fg_status fg_journal_write(fg_context *ctx, const char *to, const fg_journal_head *head,
                           fg_journal_source *source, void *user);

typedef struct fg_journal {
  char *path;
  int descriptor;
  off_t end;
  size_t unsynced;
  struct timespec synced;
  pthread_mutex_t mutex;
} fg_journal;

fg_status fg_journal_open(fg_context *ctx, const char *path, fg_journal *journal);
/* One line; from any thread. On the disk within a second. FG_ERR_IO: nothing was added. */
fg_status fg_journal_append(fg_context *ctx, fg_journal *journal, const char *line, size_t length,
                            fg_journal_entry *entry);
fg_status fg_journal_close(fg_context *ctx, fg_journal *journal);

#endif
