#include "lot/journal.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"

enum { SYNC_RECORDS = 64, COPY_BYTES = 1 << 16 };

static fg_status fail_errno(fg_context *ctx, const char *path, const char *what) {
  const char *advice = errno == ENOSPC || errno == EDQUOT || errno == EFBIG
                           ? "; what is kept stays valid: free some space and --resume"
                           : "";
  return fg_fail(ctx, FG_ERR_IO, "%s: cannot be %s: %s%s", path, what, strerror(errno), advice);
}

static void write_head(FILE *out, const fg_journal_head *head) {
  fg_json json;
  fg_json_begin(&json, out);
  fg_json_line(&json);
  fg_json_object(&json, NULL);
  fg_json_string(&json, "schema", "foilgauge/results/1");
  fg_json_string(&json, "version", head->version);
  fg_json_array(&json, "shard");
  fg_json_integer(&json, NULL, (int64_t)head->shard.index);
  fg_json_integer(&json, NULL, (int64_t)head->shard.count);
  fg_json_array_end(&json);
  fg_json_integer(&json, "items", (int64_t)head->items);
  fg_json_string(&json, "manifest_sha256", head->manifest_sha256);
  fg_json_string(&json, "recipe_sha256", head->recipe_sha256);
  fg_json_string(&json, "measured_with", head->measured_with);
  fg_record_write_names(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
}

static bool read_text(const cJSON *root, const char *name, char *text, size_t size) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(root, name);
  if (!cJSON_IsString(value) || strlen(value->valuestring) >= size) return false;
  strcpy(text, value->valuestring);
  return true;
}

static bool read_head_members(const cJSON *root, fg_journal_head *head) {
  const cJSON *shard = cJSON_GetObjectItemCaseSensitive(root, "shard");
  const cJSON *items = cJSON_GetObjectItemCaseSensitive(root, "items");
  const cJSON *index = cJSON_GetArrayItem(shard, 0), *count = cJSON_GetArrayItem(shard, 1);
  char schema[32];
  if (!read_text(root, "schema", schema, sizeof schema) || strcmp(schema, "foilgauge/results/1"))
    return false;
  if (!cJSON_IsNumber(index) || !cJSON_IsNumber(count) || !cJSON_IsNumber(items)) return false;
  if (!(index->valuedouble >= 1 && index->valuedouble <= count->valuedouble &&
        count->valuedouble <= 1e9 && items->valuedouble >= 0 && items->valuedouble < 1e12))
    return false;
  head->shard = (fg_lot_shard){(size_t)index->valuedouble, (size_t)count->valuedouble};
  head->items = (size_t)items->valuedouble;
  return read_text(root, "version", head->version, sizeof head->version) &&
         read_text(root, "manifest_sha256", head->manifest_sha256, 65) &&
         read_text(root, "recipe_sha256", head->recipe_sha256, 65) &&
         read_text(root, "measured_with", head->measured_with, 65);
}

static fg_status parse_head(fg_context *ctx, const char *path, const char *line,
                            fg_journal_head *head) {
  *head = (fg_journal_head){0};
  cJSON *root = cJSON_Parse(line);
  bool good = root && read_head_members(root, head);
  cJSON_Delete(root);
  if (good) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: not the results of a lot (its first line is not whole); remove it, or choose "
                 "another folder",
                 path);
}

typedef struct reader {
  const char *path;
  FILE *in;
  char *line;
  size_t capacity;
  off_t offset;
  bool head_only;
} reader;

/* The next line, NULL at the end; *whole says whether it has its newline and holds no NUL. */
static char *next_line(reader *r, fg_journal_entry *entry, bool *whole) {
  ssize_t length = getline(&r->line, &r->capacity, r->in);
  if (length <= 0) return NULL;
  *entry = (fg_journal_entry){r->offset, (size_t)length};
  *whole = r->line[length - 1] == '\n' && !memchr(r->line, 0, (size_t)length);
  r->offset += length;
  return r->line;
}

static fg_status read_records(fg_context *ctx, reader *r, size_t *torn, fg_journal_visit *visit,
                              void *user) {
  fg_journal_entry entry;
  bool whole;
  while (next_line(r, &entry, &whole)) {
    fg_record record;
    fg_context inner;
    fg_status status = FG_ERR_DATA;
    if (whole)
      status = r->head_only ? fg_record_parse_head(&inner, r->line, &record)
                            : fg_record_parse(&inner, r->line, &record);
    if (status == FG_ERR_DATA) {
      ++*torn;
      continue;
    }
    if (status != FG_OK) return fg_fail(ctx, status, "%s", inner.message);
    status = visit(ctx, user, &record, entry);
    fg_record_free(&record);
    FG_TRY(status);
  }
  if (ferror(r->in)) return fail_errno(ctx, r->path, "read");
  return FG_OK;
}

static fg_status read_file(fg_context *ctx, reader *r, fg_journal_head *head, size_t *torn,
                           fg_journal_visit *visit, void *user) {
  fg_journal_entry entry;
  bool whole = false;
  r->in = fopen(r->path, "rbe");
  if (!r->in) return fail_errno(ctx, r->path, "opened");
  const char *line = next_line(r, &entry, &whole);
  fg_status status = parse_head(ctx, r->path, line && whole ? line : "", head);
  if (status == FG_OK && visit) status = read_records(ctx, r, torn, visit, user);
  fclose(r->in);
  free(r->line);
  return status;
}

fg_status fg_journal_read(fg_context *ctx, const char *path, bool head_only, fg_journal_head *head,
                          size_t *torn, fg_journal_visit *visit, void *user) {
  reader r = {.path = path, .head_only = head_only};
  *torn = 0;
  return read_file(ctx, &r, head, torn, visit, user);
}

fg_status fg_journal_read_head(fg_context *ctx, const char *path, fg_journal_head *head) {
  reader r = {.path = path};
  return read_file(ctx, &r, head, NULL, NULL, NULL);
}

static fg_status copy_entry(fg_context *ctx, const char *path, int from, fg_journal_entry entry,
                            FILE *out) {
  char piece[COPY_BYTES];
  while (entry.length) {
    size_t want = entry.length < sizeof piece ? entry.length : sizeof piece;
    ssize_t got = pread(from, piece, want, entry.offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return fail_errno(ctx, path, "read");
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
    status = descriptor < 0 ? fail_errno(ctx, from[file], "opened")
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
  write_head(output.stream, head);
  fg_status status = copy_entries(ctx, from, from_of, entries, count, output.stream);
  if (status == FG_OK) return fg_output_commit(ctx, &output);
  fg_output_discard(&output);
  return status;
}

fg_status fg_journal_open(fg_context *ctx, const char *path, fg_journal *journal) {
  *journal = (fg_journal){.descriptor = open(path, O_WRONLY | O_CLOEXEC)};
  if (journal->descriptor < 0) return fail_errno(ctx, path, "opened");
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

/* Every record would cost a disk's turn; a second's worth is what a power cut may take. */
static bool sync_now_and_then(fg_journal *journal) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (++journal->unsynced < SYNC_RECORDS && now.tv_sec <= journal->synced.tv_sec) return true;
  journal->unsynced = 0;
  journal->synced = now;
  return fdatasync(journal->descriptor) == 0;
}

fg_status fg_journal_append(fg_context *ctx, fg_journal *journal, const char *line, size_t length,
                            fg_journal_entry *entry) {
  fg_status status = FG_OK;
  pthread_mutex_lock(&journal->mutex);
  if (write_whole(journal, line, length)) {
    *entry = (fg_journal_entry){journal->end, length};
    journal->end += (off_t)length;
    if (!sync_now_and_then(journal)) status = fail_errno(ctx, journal->path, "written");
  } else {
    status = fail_errno(ctx, journal->path, "written");
    if (ftruncate(journal->descriptor, journal->end) != 0) entry->length = 0;
  }
  pthread_mutex_unlock(&journal->mutex);
  return status;
}

fg_status fg_journal_close(fg_context *ctx, fg_journal *journal) {
  fg_status status = FG_OK;
  if (!journal->path) return FG_OK;
  if (fsync(journal->descriptor) != 0) status = fail_errno(ctx, journal->path, "written");
  if (close(journal->descriptor) != 0 && status == FG_OK)
    status = fail_errno(ctx, journal->path, "written");
  pthread_mutex_destroy(&journal->mutex);
  free(journal->path);
  *journal = (fg_journal){.descriptor = -1};
  return status;
}

/* Ours alone: the names that outputs have before they are whole (core/file.h). */
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
  FG_TRY(fg_text_print(ctx, &path, "%s/.lock", folder));
  fg_status status = FG_OK;
  *lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (*lock < 0) {
    status = fail_errno(ctx, path, "opened");
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
