/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Journal of a lot, results.jsonl: the records, line by line.
 *
 * A record is one write of one line with its own checksum. A crash leaves at worst an incomplete
 * last line. Such a line, and any line that fails its checksum, is dropped when the file is read,
 * and its scan is measured again. A write that fails (disk full) is cut off again, so that every
 * earlier line stays whole. */
#ifndef FG_LOT_RUN_JOURNAL_H
#define FG_LOT_RUN_JOURNAL_H

#include <pthread.h>
#include <stdbool.h>
#include <sys/types.h>
#include <time.h>

#include "lot/run/journal_head.h"
#include "lot/run/record.h"

/* Position of a record in the file. */
typedef struct fg_journal_entry {
  off_t offset;
  size_t length; /* with its newline; 0: no record */
} fg_journal_entry;

/* Lines of a journal that could not be used. */
typedef struct fg_journal_damage {
  size_t lines; /* incomplete, or with a wrong checksum */
  size_t first; /* the first of them, from 1 */
  bool earlier; /* of an earlier version; nothing was read */
} fg_journal_damage;

/* Called for every whole record. The callee sets to zero the parts that it takes over. */
typedef fg_status fg_journal_visit(fg_context *ctx, void *user, fg_record *record,
                                   fg_journal_entry entry);

typedef struct fg_journal_visitor {
  fg_journal_visit *visit;
  void *user;
  unsigned threads; /* that parse; 0: as many as cores. Records are visited in the file's order */
} fg_journal_visitor;

/* Reads the file; damaged lines are counted and left out. FG_ERR_DATA when the first line is not
 * that of a journal of this version. */
fg_status fg_journal_read(fg_context *ctx, const char *path, fg_journal_head *head,
                          fg_journal_damage *damage, const fg_journal_visitor *by);

/* Reads every usable record, for a caller who measures the others again. A damaged first line
 * counts as any other; a journal of an earlier version is only noted. FG_ERR_DATA when there is
 * neither a first line nor a record: the file is then no journal, and must not be overwritten. */
fg_status fg_journal_salvage(fg_context *ctx, const char *path, fg_journal_damage *damage,
                             const fg_journal_visitor *by);

/* Reads the first line only. */
fg_status fg_journal_read_head(fg_context *ctx, const char *path, fg_journal_head *head);

/* Writes a file `to` from the head and the entries of the files `from`, in their order. Entry i is
 * of file from_of[i], or of the first where from_of is NULL. `to` is replaced once it is whole.
 * Entries are set to their places in it. */
fg_status fg_journal_rewrite(fg_context *ctx, const char *to, const fg_journal_head *head,
                             const char *const *from, const size_t *from_of,
                             fg_journal_entry *entries, size_t count);

/* Gives the record of an item as a line (fg_record_format), allocated with malloc. */
typedef fg_status fg_journal_source(fg_context *ctx, void *user, size_t item, char **line,
                                    size_t *length);

/* Writes a file `to` from the head and a record for each of its items. It appears once it is whole.
 */
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
/* Appends a line; may be called from any thread. The line is on the disk within a second.
 * FG_ERR_IO: nothing was added. */
fg_status fg_journal_append(fg_context *ctx, fg_journal *journal, const char *line, size_t length,
                            fg_journal_entry *entry);
fg_status fg_journal_close(fg_context *ctx, fg_journal *journal);

#endif
