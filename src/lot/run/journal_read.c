/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a journal: lines are read in order, and those of a batch parsed on several threads. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "lot/run/journal.h"

/* A batch is as long as takes threads much longer to parse than to start. Its bytes are limited,
 * for one line may be as long as a damaged file. */
enum {
  LINE_BYTES_MAX = 1 << 26,
  BATCH_LINES = 256,
  FEW_LINES = 8,
  BATCH_BYTES = 1 << 21,
  BLOCK_BYTES = 1 << 16
};

typedef struct batch_line {
  size_t at; /* of its text in the batch's */
  fg_journal_entry entry;
  bool whole; /* ends with a newline, and holds no NUL */
  fg_status status;
  fg_record record;
  fg_context context;
} batch_line;

typedef struct reader {
  const char *path;
  unsigned threads;
  FILE *in;
  char *block; /* read of the file; BLOCK_BYTES */
  size_t block_at, block_end;
  char *text; /* lines of the batch, each ends with NUL */
  size_t length, capacity;
  batch_line *lines;
  size_t count;   /* lines of the batch */
  off_t offset;   /* of the next line */
  size_t number;  /* lines before the batch */
  size_t records; /* whole ones so far */
  fg_journal_damage *damage;
} reader;

static bool fill_journal_block(reader *r) {
  if (r->block_at < r->block_end) return true;
  r->block_at = 0;
  r->block_end = fread(r->block, 1, BLOCK_BYTES, r->in);
  return r->block_end > 0;
}

/* Appends a line with its newline to the text; entry->length is 0 at the end. The tail of a line
 * too long for a record is skipped, so that a damaged file needs no more memory than a whole one.
 */
static fg_status read_journal_line(fg_context *ctx, reader *r, fg_journal_entry *entry) {
  const char *newline = NULL;
  *entry = (fg_journal_entry){.offset = r->offset};
  while (!newline && fill_journal_block(r)) {
    const char *from = r->block + r->block_at;
    size_t rest = r->block_end - r->block_at;
    newline = memchr(from, '\n', rest);
    size_t piece = newline ? (size_t)(newline - from) + 1 : rest;
    size_t room = LINE_BYTES_MAX - entry->length, kept = piece < room ? piece : room;
    FG_TRY(fg_memory_reserve(ctx, r->length + kept + 1, 1, &r->capacity, (void **)&r->text));
    memcpy(r->text + r->length, from, kept);
    r->length += kept;
    entry->length += kept;
    r->block_at += piece;
    r->offset += (off_t)piece;
  }
  return FG_OK;
}

/* Reads the next lines, none at the end. */
static fg_status read_batch(fg_context *ctx, reader *r, size_t lines) {
  r->number += r->count;
  r->count = r->length = 0;
  while (r->count < lines && r->length < BATCH_BYTES) {
    batch_line *line = &r->lines[r->count];
    line->at = r->length;
    FG_TRY(read_journal_line(ctx, r, &line->entry));
    size_t length = line->entry.length;
    if (!length) break;
    const char *text = r->text + line->at;
    line->whole = text[length - 1] == '\n' && !memchr(text, 0, length);
    r->text[r->length++] = '\0';
    r->count++;
  }
  return ferror(r->in) ? fg_journal_fail(ctx, r->path, "read") : FG_OK;
}

static fg_status parse_line(fg_context *ctx, void *shared, size_t i) {
  reader *r = shared;
  batch_line *line = &r->lines[i];
  (void)ctx;
  line->status =
      fg_record_parse(&line->context, line->whole ? r->text + line->at : "", &line->record);
  return FG_OK;
}

static fg_status visit_line(fg_context *ctx, reader *r, size_t i, const fg_journal_visitor *by) {
  batch_line *line = &r->lines[i];
  if (line->status == FG_ERR_DATA) {
    if (r->damage->lines++ == 0) r->damage->first = r->number + i + 1;
    return FG_OK;
  }
  if (line->status != FG_OK) return fg_fail(ctx, line->status, "%s", line->context.message);
  r->records++;
  return by->visit(ctx, by->user, &line->record, line->entry);
}

/* Records are visited in the file's order, whatever thread has parsed them. */
static fg_status visit_batch(fg_context *ctx, reader *r, const fg_journal_visitor *by) {
  fg_status status = FG_OK;
  unsigned threads = r->count > FEW_LINES ? r->threads : 1; /* a thread takes longer to start */
  FG_TRY(fg_parallel_run(ctx, threads, r->count, parse_line, r));
  for (size_t i = 0; i < r->count; i++) {
    if (status == FG_OK) status = visit_line(ctx, r, i, by);
    fg_record_free(&r->lines[i].record);
  }
  return status;
}

static fg_status read_records(fg_context *ctx, reader *r, const fg_journal_visitor *by) {
  do {
    FG_TRY(read_batch(ctx, r, BATCH_LINES));
    FG_TRY(visit_batch(ctx, r, by));
  } while (r->count);
  return FG_OK;
}

static fg_status open_reader(fg_context *ctx, reader *r, fg_journal_head *head,
                             fg_head_state *state) {
  FG_TRY(fg_file_open(ctx, r->path, &r->in));
  FG_TRY(fg_memory_allocate(ctx, BLOCK_BYTES, 1, (void **)&r->block));
  FG_TRY(fg_memory_allocate(ctx, BATCH_LINES, sizeof *r->lines, (void **)&r->lines));
  FG_TRY(read_batch(ctx, r, 1));
  return fg_journal_parse_head(ctx, r->count && r->lines->whole ? r->text : "", head, state);
}

static fg_status close_reader(reader *r, fg_status status) {
  if (r->in) fclose(r->in);
  free(r->block);
  free(r->text);
  free(r->lines);
  return status;
}

static fg_status read_strictly(fg_context *ctx, reader *r, fg_journal_head *head,
                               const fg_journal_visitor *by) {
  fg_head_state state;
  FG_TRY(open_reader(ctx, r, head, &state));
  if (state != FG_HEAD_GOOD) return fg_journal_fail_head(ctx, r->path, state);
  return by ? read_records(ctx, r, by) : FG_OK;
}

fg_status fg_journal_read(fg_context *ctx, const char *path, fg_journal_head *head,
                          fg_journal_damage *damage, const fg_journal_visitor *by) {
  reader r = {.path = path, .threads = by->threads, .damage = damage};
  *damage = (fg_journal_damage){0};
  return close_reader(&r, read_strictly(ctx, &r, head, by));
}

fg_status fg_journal_read_head(fg_context *ctx, const char *path, fg_journal_head *head) {
  reader r = {.path = path};
  return close_reader(&r, read_strictly(ctx, &r, head, NULL));
}

static fg_status salvage_records(fg_context *ctx, reader *r, const fg_journal_visitor *by) {
  fg_journal_head head;
  fg_head_state state;
  FG_TRY(open_reader(ctx, r, &head, &state));
  r->damage->earlier = state == FG_HEAD_EARLIER;
  if (state == FG_HEAD_EARLIER) return FG_OK;
  if (state == FG_HEAD_DAMAGED) *r->damage = (fg_journal_damage){.lines = 1, .first = 1};
  FG_TRY(read_records(ctx, r, by));
  return state == FG_HEAD_DAMAGED && !r->records ? fg_journal_fail_head(ctx, r->path, state)
                                                 : FG_OK;
}

fg_status fg_journal_salvage(fg_context *ctx, const char *path, fg_journal_damage *damage,
                             const fg_journal_visitor *by) {
  reader r = {.path = path, .threads = by->threads, .damage = damage};
  *damage = (fg_journal_damage){0};
  return close_reader(&r, salvage_records(ctx, &r, by));
}
