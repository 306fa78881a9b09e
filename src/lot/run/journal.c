/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/member.h"
#include "core/memory.h"
#include "core/text.h"
#include "lot/run/seal.h"

#define SCHEMA          "foilgauge/results/2"
#define SCHEMA_UNSEALED "foilgauge/results/1" /* without checksums */

enum { SYNC_RECORDS = 64, COPY_BYTES = 1 << 16, LINE_BYTES_MAX = 1 << 26 };

static fg_status fail_file(fg_context *ctx, const char *path, const char *what) {
  const char *advice = errno == ENOSPC || errno == EDQUOT || errno == EFBIG
                           ? "; what is kept stays valid: free some space and --resume"
                           : "";
  return fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be %s: %s%s", path, what,
                 strerror(errno), advice);
}

static const char *find_schema(const fg_subject *subject, char *buffer) {
  (void)subject, (void)buffer;
  return SCHEMA;
}

static const double *list_shard(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_shard *shard = &((const fg_journal_head *)subject->object)->shard;
  values[0] = (double)shard->index;
  values[1] = (double)shard->count;
  *count = 2;
  return values;
}

/* Members of the first line, before the names of the values. */
static const fg_member head_rows[] = {
    {FG_TEXT_BY("schema", find_schema)},
    {FG_TEXT("version", fg_journal_head, version)},
    {FG_NUMBERS_BY("shard", list_shard)},
    {FG_COUNT("items", fg_journal_head, items)},
    {FG_TEXT("manifest_sha256", fg_journal_head, manifest_sha256)},
    {FG_TEXT("recipe_sha256", fg_journal_head, recipe_sha256)},
    {FG_TEXT("measured_with", fg_journal_head, measured_with)},
};
static const fg_members head_members = FG_MEMBERS(head_rows);

static void write_head_members(FILE *out, const fg_journal_head *head) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_line(&json);
  fg_json_object(&json, NULL);
  fg_members_json(&json, &head_members, &(fg_subject){.object = head});
  fg_record_write_names(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
}

static fg_status write_journal_head(fg_context *ctx, FILE *out, const fg_journal_head *head) {
  char *line = NULL;
  size_t length;
  FILE *memory = fg_stream_open(&line, &length);
  if (memory) write_head_members(memory, head);
  if (!fg_stream_keep(memory, &line))
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the head of a journal");
  FG_TRY(fg_seal_line(ctx, &line, &length));
  fwrite(line, 1, length, out);
  free(line);
  return FG_OK;
}

static bool read_head_texts(const cJSON *root, fg_journal_head *head) {
  for (size_t i = 0; i < head_members.count; i++) {
    const fg_member *row = &head_rows[i];
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(root, row->name);
    if (row->kind != FG_MEMBER_TEXT) continue;
    if (!cJSON_IsString(value) || strlen(value->valuestring) >= row->stride) return false;
    strcpy((char *)head + row->offset, value->valuestring);
  }
  return true;
}

static bool read_head_members(const cJSON *root, fg_journal_head *head) {
  const cJSON *shard = cJSON_GetObjectItemCaseSensitive(root, "shard");
  const cJSON *items = cJSON_GetObjectItemCaseSensitive(root, "items");
  const cJSON *index = cJSON_GetArrayItem(shard, 0), *count = cJSON_GetArrayItem(shard, 1);
  if (!cJSON_IsNumber(index) || !cJSON_IsNumber(count) || !cJSON_IsNumber(items)) return false;
  if (!(index->valuedouble >= 1 && index->valuedouble <= count->valuedouble &&
        count->valuedouble <= 1e9 && items->valuedouble >= 0 && items->valuedouble < 1e12))
    return false;
  head->shard = (fg_lot_shard){(size_t)index->valuedouble, (size_t)count->valuedouble};
  head->items = (size_t)items->valuedouble;
  return read_head_texts(root, head);
}

static bool is_of_schema(const cJSON *root, const char *expected) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  return cJSON_IsString(schema) && !strcmp(schema->valuestring, expected);
}

typedef enum head_state { HEAD_GOOD, HEAD_EARLIER, HEAD_DAMAGED } head_state;

/* Records hold values by position. A build with other quantities would misread them wherever their
 * number agrees, so the names of the first line must match. */
static fg_status check_value_names(fg_context *ctx, const char *line, head_state *state) {
  char *names;
  FG_TRY(fg_record_format_names(ctx, &names));
  names[strcspn(names, "}")] = '\0';
  if (!strstr(line, names + 1)) *state = HEAD_EARLIER;
  free(names);
  return FG_OK;
}

static fg_status parse_head(fg_context *ctx, const char *line, fg_journal_head *head,
                            head_state *out) {
  *head = (fg_journal_head){0};
  head_state state = HEAD_DAMAGED;
  cJSON *root;
  if (fg_json_read(ctx, "the head of a journal", line, &root) == FG_ERR_MEMORY)
    return FG_ERR_MEMORY;
  if (is_of_schema(root, SCHEMA_UNSEALED) && !cJSON_HasObjectItem(root, "checksum"))
    state = HEAD_EARLIER;
  else if (fg_seal_holds(line, strlen(line)) && is_of_schema(root, SCHEMA) &&
           read_head_members(root, head))
    state = HEAD_GOOD;
  cJSON_Delete(root);
  *out = state;
  return state == HEAD_GOOD ? check_value_names(ctx, line, out) : FG_OK;
}

static fg_status fail_head(fg_context *ctx, const char *path, head_state state) {
  if (state == HEAD_EARLIER)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is of an earlier version, whose records hold other values or carry no "
                   "checksum; measure its scans again with --resume",
                   path);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: line 1 is damaged, or it is not the results of a lot; `foilgauge lot "
                 "--resume` keeps what is whole, if anything is; else choose another folder",
                 path);
}

typedef struct reader {
  const char *path;
  FILE *in;
  char *line;
  size_t capacity;
  off_t offset;
  size_t number;  /* of the current line, from 1 */
  size_t records; /* whole ones so far */
  fg_journal_damage *damage;
} reader;

/* Reads a line with its newline into r->line; *there is false at the end. The tail of a line too
 * long for a record is skipped, so that a damaged file needs no more memory than a whole one. */
static fg_status read_journal_line(fg_context *ctx, reader *r, size_t *length, bool *there) {
  int byte;
  *length = 0;
  while ((byte = getc_unlocked(r->in)) != EOF) {
    r->offset++;
    if (*length < LINE_BYTES_MAX) {
      FG_TRY(fg_memory_reserve(ctx, *length + 2, 1, &r->capacity, (void **)&r->line));
      r->line[(*length)++] = (char)byte;
    }
    if (byte == '\n') break;
  }
  *there = *length > 0;
  if (*there) r->line[*length] = '\0';
  return FG_OK;
}

/* Sets *line to the next line, to NULL at the end, or to "" when it has no newline or holds a NUL.
 */
static fg_status next_journal_line(fg_context *ctx, reader *r, fg_journal_entry *entry,
                                   const char **line) {
  bool there;
  off_t start = r->offset;
  size_t length;
  FG_TRY(read_journal_line(ctx, r, &length, &there));
  *line = NULL;
  if (!there) return FG_OK;
  *entry = (fg_journal_entry){start, length};
  r->number++;
  bool whole = r->line[length - 1] == '\n' && !memchr(r->line, 0, length);
  *line = whole ? r->line : "";
  return FG_OK;
}

static void note_damage(reader *r) {
  if (r->damage->lines++ == 0) r->damage->first = r->number;
}

static fg_status read_records(fg_context *ctx, reader *r, fg_journal_visit *visit, void *user) {
  fg_journal_entry entry;
  const char *line;
  for (;;) {
    FG_TRY(next_journal_line(ctx, r, &entry, &line));
    if (!line) break;
    fg_record record;
    fg_context inner;
    fg_status status = fg_record_parse(&inner, line, &record);
    if (status == FG_ERR_DATA) {
      note_damage(r);
      continue;
    }
    if (status != FG_OK) return fg_fail(ctx, status, "%s", inner.message);
    r->records++;
    status = visit(ctx, user, &record, entry);
    fg_record_free(&record);
    FG_TRY(status);
  }
  if (ferror(r->in)) return fail_file(ctx, r->path, "read");
  return FG_OK;
}

static fg_status open_reader(fg_context *ctx, reader *r, fg_journal_head *head, head_state *state) {
  fg_journal_entry entry;
  r->in = fopen(r->path, "rbe");
  if (!r->in) return fail_file(ctx, r->path, "opened");
  const char *line;
  FG_TRY(next_journal_line(ctx, r, &entry, &line));
  return parse_head(ctx, line ? line : "", head, state);
}

static fg_status close_reader(reader *r, fg_status status) {
  if (r->in) fclose(r->in);
  free(r->line);
  return status;
}

static fg_status read_strictly(fg_context *ctx, reader *r, fg_journal_head *head,
                               fg_journal_visit *visit, void *user) {
  head_state state;
  FG_TRY(open_reader(ctx, r, head, &state));
  if (state != HEAD_GOOD) return fail_head(ctx, r->path, state);
  return visit ? read_records(ctx, r, visit, user) : FG_OK;
}

fg_status fg_journal_read(fg_context *ctx, const char *path, fg_journal_head *head,
                          fg_journal_damage *damage, fg_journal_visit *visit, void *user) {
  reader r = {.path = path, .damage = damage};
  *damage = (fg_journal_damage){0};
  return close_reader(&r, read_strictly(ctx, &r, head, visit, user));
}

fg_status fg_journal_read_head(fg_context *ctx, const char *path, fg_journal_head *head) {
  reader r = {.path = path};
  return close_reader(&r, read_strictly(ctx, &r, head, NULL, NULL));
}

static fg_status salvage_records(fg_context *ctx, reader *r, fg_journal_visit *visit, void *user) {
  fg_journal_head head;
  head_state state;
  FG_TRY(open_reader(ctx, r, &head, &state));
  r->damage->earlier = state == HEAD_EARLIER;
  if (state == HEAD_EARLIER) return FG_OK;
  if (state == HEAD_DAMAGED) note_damage(r);
  FG_TRY(read_records(ctx, r, visit, user));
  return state == HEAD_DAMAGED && !r->records ? fail_head(ctx, r->path, state) : FG_OK;
}

fg_status fg_journal_salvage(fg_context *ctx, const char *path, fg_journal_damage *damage,
                             fg_journal_visit *visit, void *user) {
  reader r = {.path = path, .damage = damage};
  *damage = (fg_journal_damage){0};
  return close_reader(&r, salvage_records(ctx, &r, visit, user));
}

static fg_status copy_entry(fg_context *ctx, const char *path, int from, fg_journal_entry entry,
                            FILE *out) {
  char piece[COPY_BYTES];
  while (entry.length) {
    size_t want = entry.length < sizeof piece ? entry.length : sizeof piece;
    ssize_t got = pread(from, piece, want, entry.offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return fail_file(ctx, path, "read");
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
    status = descriptor < 0 ? fail_file(ctx, from[file], "opened")
                            : copy_entry(ctx, from[file], descriptor, entries[i], out);
  }
  if (descriptor >= 0) close(descriptor);
  return status;
}

fg_status fg_journal_rewrite(fg_context *ctx, const char *to, const fg_journal_head *head,
                             const char *const *from, const size_t *from_of,
                             const fg_journal_entry *entries, size_t count) {
  fg_output output;
  FG_TRY(fg_output_open(ctx, to, &output));
  fg_status status = write_journal_head(ctx, output.stream, head);
  if (status == FG_OK) status = copy_entries(ctx, from, from_of, entries, count, output.stream);
  return fg_output_end(ctx, &output, status);
}

fg_status fg_journal_write(fg_context *ctx, const char *to, const fg_journal_head *head,
                           fg_journal_source *source, void *user) {
  fg_output output;
  FG_TRY(fg_output_open(ctx, to, &output));
  fg_status status = write_journal_head(ctx, output.stream, head);
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
  if (journal->descriptor < 0) return fail_file(ctx, path, "opened");
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
    status = fail_file(ctx, journal->path, "written");
    if (ftruncate(journal->descriptor, journal->end) != 0) entry->length = 0;
  }
  pthread_mutex_unlock(&journal->mutex);
  /* Other threads do not wait for the disk. */
  if (due && fdatasync(journal->descriptor) != 0) status = fail_file(ctx, journal->path, "written");
  return status;
}

fg_status fg_journal_close(fg_context *ctx, fg_journal *journal) {
  fg_status status = FG_OK;
  if (!journal->path) return FG_OK;
  if (fsync(journal->descriptor) != 0) status = fail_file(ctx, journal->path, "written");
  if (close(journal->descriptor) != 0 && status == FG_OK)
    status = fail_file(ctx, journal->path, "written");
  pthread_mutex_destroy(&journal->mutex);
  free(journal->path);
  *journal = (fg_journal){.descriptor = -1};
  return status;
}
