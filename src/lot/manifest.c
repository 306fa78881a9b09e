#include "lot/manifest.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include <csv.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "scan/format.h"

enum { TEXT_BYTES_MAX = 1 << 30, DEPTH_MAX = 32, COLUMNS_MAX = 1000 };

static fg_status copy_text(fg_context *ctx, const char *text, size_t length, char **copy) {
  *copy = strndup(text, length);
  return *copy ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
}

static fg_status add_column(fg_context *ctx, fg_manifest *manifest, const char *name, size_t length,
                            size_t *column) {
  for (*column = 0; *column < manifest->columns; (*column)++)
    if (strlen(manifest->name[*column]) == length && !memcmp(manifest->name[*column], name, length))
      return FG_OK;
  if (manifest->items)
    return fg_fail(ctx, FG_ERR_USAGE, "a manifest with columns must be the only input");
  FG_TRY(fg_memory_reserve(ctx, manifest->columns + 1, sizeof *manifest->name,
                           &manifest->name_capacity, (void **)&manifest->name));
  FG_TRY(copy_text(ctx, name, length, &manifest->name[manifest->columns]));
  manifest->columns++;
  return FG_OK;
}

static fg_status start(fg_context *ctx, fg_manifest *manifest) {
  size_t column;
  return manifest->columns ? FG_OK : add_column(ctx, manifest, "scan", 4, &column);
}

/* A row of empty cells. */
static fg_status add_item(fg_context *ctx, fg_manifest *manifest, char ***row) {
  size_t used = manifest->items * manifest->columns;
  FG_TRY(fg_memory_reserve(ctx, used + manifest->columns, sizeof *manifest->cell,
                           &manifest->cell_capacity, (void **)&manifest->cell));
  *row = manifest->cell + used;
  memset(*row, 0, manifest->columns * sizeof **row);
  manifest->items++;
  return FG_OK;
}

static fg_status add_scan(fg_context *ctx, fg_manifest *manifest, const char *folder,
                          const char *scan) {
  char **row;
  FG_TRY(start(ctx, manifest));
  FG_TRY(add_item(ctx, manifest, &row));
  bool relative = *folder && scan[0] != '/';
  return fg_text_print(ctx, &row[0], "%s%s%s", relative ? folder : "", relative ? "/" : "", scan);
}

/* Folders: every picture below, in the order of the names' bytes, so that a lot reads alike in
 * every locale. */

static int keep_visible(const struct dirent *entry) {
  return entry->d_name[0] != '.';
}

static int by_bytes(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

static bool same_place(const char *a, const char *b) {
  struct stat one, other;
  return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
         one.st_ino == other.st_ino;
}

typedef struct search {
  fg_context *ctx;
  fg_manifest *manifest;
  const char *leave_out, *own;
} search;

static fg_status add_folder(const search *s, const char *folder, int depth);

static fg_status add_entry(const search *s, const char *folder, const char *name, int depth) {
  char *path = NULL;
  struct stat info;
  FG_TRY(fg_text_print(s->ctx, &path, "%s/%s", folder, name));
  fg_status status = FG_OK;
  bool there = stat(path, &info) == 0;
  if (there && S_ISDIR(info.st_mode) && !(s->leave_out && same_place(path, s->leave_out)))
    status = add_folder(s, path, depth + 1);
  else if (fg_format_has_name(name) && !(there && S_ISDIR(info.st_mode)))
    status = add_scan(s->ctx, s->manifest, "", path);
  free(path);
  return status;
}

static fg_status add_folder(const search *s, const char *folder, int depth) {
  struct dirent **entries;
  if (depth > DEPTH_MAX)
    return fg_fail(s->ctx, FG_ERR_DATA, "%s: folders lie %d deep; is a link going round?", folder,
                   DEPTH_MAX);
  int count = scandir(folder, &entries, keep_visible, by_bytes);
  if (count < 0)
    return fg_fail(s->ctx, FG_ERR_IO, "%s: the folder cannot be read: %s", folder, strerror(errno));
  fg_status status = FG_OK;
  for (int i = 0; i < count; i++) {
    if (status == FG_OK) status = add_entry(s, folder, entries[i]->d_name, depth);
    free(entries[i]);
  }
  free(entries);
  return status;
}

/* CSV: RFC 4180; the first row names the columns. */

typedef struct csv_reader {
  fg_context *ctx;
  fg_manifest *manifest;
  const char *source, *folder;
  size_t *column; /* of the file to those of the manifest */
  size_t columns, capacity, cell, row, scan;
  char **cells; /* of the row that is read; NULL before its first cell */
  bool named, filled;
  fg_status status;
} csv_reader;

static fg_status take_name(csv_reader *r, const char *text, size_t length) {
  size_t column;
  FG_TRY(add_column(r->ctx, r->manifest, text, length, &column));
  FG_TRY(fg_memory_reserve(r->ctx, r->columns + 1, sizeof *r->column, &r->capacity,
                           (void **)&r->column));
  for (size_t i = 0; i < r->columns; i++)
    if (r->column[i] == column)
      return fg_fail(r->ctx, FG_ERR_DATA, "%s: the column '%.*s' is there twice", r->source,
                     (int)length, text);
  r->column[r->columns++] = column;
  return FG_OK;
}

static fg_status take_cell(csv_reader *r, const char *text, size_t length) {
  fg_csv_take_apostrophe(&text, &length);
  if (!r->named && r->columns == COLUMNS_MAX)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: more than %d columns, which every line of the reports would repeat; keep "
                   "those that say which foil it is",
                   r->source, COLUMNS_MAX);
  if (!r->named) return take_name(r, text, length);
  if (r->cell >= r->columns && length)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu has more cells than the heading (%zu)",
                   r->source, r->row + 1, r->columns);
  if (r->cell >= r->columns) return FG_OK;
  if (!r->cells) FG_TRY(add_item(r->ctx, r->manifest, &r->cells));
  size_t column = r->column[r->cell++];
  r->filled = r->filled || length;
  if (column == 0 && length && text[0] != '/' && *r->folder)
    return fg_text_print(r->ctx, &r->cells[0], "%s/%.*s", r->folder, (int)length, text);
  return copy_text(r->ctx, text, length, &r->cells[column]);
}

static fg_status end_names(csv_reader *r) {
  r->named = true;
  for (size_t i = 0; i < r->columns; i++)
    if (r->column[i] == 0) return FG_OK;
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: no column `scan`; the first row must name the columns",
                 r->source);
}

static fg_status end_row(csv_reader *r) {
  if (!r->named) return r->columns ? end_names(r) : FG_OK;
  char **cells = r->cells;
  bool filled = r->filled;
  r->row++;
  r->cells = NULL;
  r->cell = 0;
  r->filled = false;
  if (!cells) return FG_OK;
  if (!filled) { /* a line of commas */
    for (size_t i = 0; i < r->manifest->columns; i++)
      free(cells[i]);
    r->manifest->items--;
    return FG_OK;
  }
  if (cells[0] && cells[0][0]) return FG_OK;
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu names no scan", r->source, r->row);
}

static void on_cell(void *text, size_t length, void *user) {
  csv_reader *r = user;
  if (r->status == FG_OK) r->status = take_cell(r, text, length);
}

static void on_row(int end, void *user) {
  csv_reader *r = user;
  (void)end;
  if (r->status == FG_OK) r->status = end_row(r);
}

static unsigned char delimiter_of(const char *text) {
  size_t line = strcspn(text, "\r\n"), best = 0;
  unsigned char delimiter = ',';
  static const unsigned char known[] = {',', ';', '\t'};
  for (size_t i = 0; i < sizeof known; i++) {
    size_t found = 0;
    for (size_t k = 0; k < line; k++)
      found += (unsigned char)text[k] == known[i];
    if (found > best) {
      best = found;
      delimiter = known[i];
    }
  }
  return delimiter;
}

static fg_status parse_rows(csv_reader *r, const char *text) {
  struct csv_parser parser;
  size_t size = strlen(text);
  if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0)
    return fg_fail(r->ctx, FG_ERR_MEMORY, "out of memory: a CSV reader");
  csv_set_delim(&parser, delimiter_of(text));
  bool broken = csv_parse(&parser, text, size, on_cell, on_row, r) != size;
  broken = csv_fini(&parser, on_cell, on_row, r) != 0 || broken;
  csv_free(&parser);
  if (r->status == FG_OK && broken)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: a quote is not closed, near row %zu", r->source,
                   r->row + 1);
  if (r->status == FG_OK && !r->named)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: empty; the first row must name the columns",
                   r->source);
  return r->status;
}

fg_status fg_manifest_parse(fg_context *ctx, const char *source, const char *text,
                            const char *folder, fg_manifest *manifest) {
  csv_reader reader = {.ctx = ctx, .manifest = manifest, .source = source, .folder = folder};
  if (!strncmp(text, "\xEF\xBB\xBF", 3)) text += 3;
  fg_status status = start(ctx, manifest);
  if (status == FG_OK) status = parse_rows(&reader, text);
  free(reader.column);
  return status;
}

static fg_status parse_list(fg_context *ctx, const char *text, const char *folder,
                            fg_manifest *manifest) {
  while (*text) {
    size_t length = strcspn(text, "\r\n");
    if (length && text[0] != '#') {
      char *line;
      FG_TRY(copy_text(ctx, text, length, &line));
      fg_status status = add_scan(ctx, manifest, folder, line);
      free(line);
      FG_TRY(status);
    }
    text += length + strspn(text + length, "\r\n");
  }
  return FG_OK;
}

static fg_status add_text_file(fg_context *ctx, const char *path, bool list, bool own,
                               fg_manifest *manifest) {
  char *text, *folder = NULL;
  const char *slash = strrchr(path, '/');
  FG_TRY(fg_file_read_text(ctx, path, TEXT_BYTES_MAX, &text));
  fg_status status = copy_text(ctx, path, slash && !own ? (size_t)(slash - path) : 0, &folder);
  if (status == FG_OK)
    status = list ? parse_list(ctx, text, folder, manifest)
                  : fg_manifest_parse(ctx, path, text, folder, manifest);
  free(folder);
  free(text);
  return status;
}

static bool ends_with(const char *path, const char *end) {
  size_t length = strlen(path), tail = strlen(end);
  return length > tail && !strcasecmp(path + length - tail, end);
}

static fg_status add_path(const search *s, const char *path) {
  struct stat info;
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) {
    size_t length = strlen(path);
    char *folder;
    while (length > 1 && path[length - 1] == '/')
      length--;
    FG_TRY(copy_text(s->ctx, path, length, &folder));
    fg_status status = add_folder(s, folder, 0);
    free(folder);
    return status;
  }
  if (ends_with(path, ".csv"))
    return add_text_file(s->ctx, path, false, s->own == path, s->manifest);
  if (ends_with(path, ".txt")) return add_text_file(s->ctx, path, true, false, s->manifest);
  return add_scan(s->ctx, s->manifest, "", path);
}

/* The scans under one spelling each: without links, "." and "..". One that is not there keeps its
 * own. */
static fg_status resolve_scans(fg_context *ctx, const fg_manifest *manifest, fg_manifest *real) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, manifest->items, sizeof *real->cell, &block));
  *real = (fg_manifest){.cell = block, .columns = 1};
  while (real->items < manifest->items) {
    const char *scan = fg_manifest_scan(manifest, real->items);
    char *path = realpath(scan, NULL);
    if (!path) FG_TRY(copy_text(ctx, scan, strlen(scan), &path));
    real->cell[real->items++] = path;
  }
  return FG_OK;
}

/* The columns of both must say the same; else which of them holds? */
static fg_status check_double(fg_context *ctx, const fg_manifest *manifest, size_t first,
                              size_t second) {
  for (size_t i = 1; i < manifest->columns; i++)
    if (strcmp(fg_manifest_cell(manifest, first, i), fg_manifest_cell(manifest, second, i)) != 0)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: the scan is there twice, with another %s (items %zu and %zu, the first "
                     "as %s)",
                     fg_manifest_scan(manifest, second), manifest->name[i], first + 1, second + 1,
                     fg_manifest_scan(manifest, first));
  return FG_OK;
}

static void leave_out(fg_manifest *manifest, size_t first, size_t second) {
  if (manifest->doubles++ == 0)
    fg_text_clip(manifest->first_double, sizeof manifest->first_double, "%s (%s)",
                 fg_manifest_scan(manifest, second), fg_manifest_scan(manifest, first));
  for (size_t i = 0; i < manifest->columns; i++) {
    free(manifest->cell[second * manifest->columns + i]);
    manifest->cell[second * manifest->columns + i] = NULL;
  }
}

static fg_status leave_out_doubles(fg_context *ctx, fg_manifest *manifest, const fg_manifest *real,
                                   const fg_manifest_index *index) {
  size_t kept = 0, columns = manifest->columns;
  for (size_t i = 0; i < real->items; i++) {
    size_t first = fg_manifest_index_find(index, real, real->cell[i]);
    if (first != i) FG_TRY(check_double(ctx, manifest, first, i));
  }
  for (size_t i = 0; i < real->items; i++) {
    size_t first = fg_manifest_index_find(index, real, real->cell[i]);
    if (first != i) leave_out(manifest, first, i);
  }
  for (size_t i = 0; i < real->items; i++) {
    if (!manifest->cell[i * columns]) continue;
    memmove(manifest->cell + kept++ * columns, manifest->cell + i * columns,
            columns * sizeof *manifest->cell);
  }
  manifest->items = kept;
  return FG_OK;
}

static fg_status check_scans(fg_context *ctx, fg_manifest *manifest) {
  fg_manifest real = {0};
  fg_manifest_index index = {0};
  char endings[100];
  fg_format_list_endings(endings, sizeof endings);
  if (manifest->items == 0)
    return fg_fail(ctx, FG_ERR_DATA, "no scan: the folders hold no file (%s), the lists no line",
                   endings);
  fg_status status = resolve_scans(ctx, manifest, &real);
  if (status == FG_OK) status = fg_manifest_index_build(ctx, &real, &index);
  if (status == FG_OK) status = leave_out_doubles(ctx, manifest, &real, &index);
  for (size_t i = 0; i < real.items; i++)
    free(real.cell[i]);
  free(real.cell);
  fg_manifest_index_free(&index);
  return status;
}

fg_status fg_manifest_collect(fg_context *ctx, const char *const *paths, size_t count,
                              const char *leave_out, const char *own, fg_manifest *manifest) {
  const search s = {ctx, manifest, leave_out, own};
  *manifest = (fg_manifest){0};
  fg_status status = start(ctx, manifest);
  for (size_t i = 0; i < count && status == FG_OK; i++)
    status = add_path(&s, paths[i]);
  if (status == FG_OK) status = check_scans(ctx, manifest);
  if (status != FG_OK) fg_manifest_free(manifest);
  return status;
}

fg_status fg_manifest_format(fg_context *ctx, const fg_manifest *manifest, char **text) {
  size_t size;
  *text = NULL;
  FILE *out = open_memstream(text, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
  for (size_t row = 0; row <= manifest->items; row++)
    for (size_t i = 0; i < manifest->columns; i++) {
      fg_csv_put_text(out, row ? fg_manifest_cell(manifest, row - 1, i) : manifest->name[i], NULL);
      fputc(i + 1 < manifest->columns ? ',' : '\n', out);
    }
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return FG_OK;
  free(*text);
  *text = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
}

const char *fg_manifest_cell(const fg_manifest *manifest, size_t item, size_t column) {
  if (column >= manifest->columns) return "";
  const char *cell = manifest->cell[item * manifest->columns + column];
  return cell ? cell : "";
}

const char *fg_manifest_scan(const fg_manifest *manifest, size_t item) {
  return fg_manifest_cell(manifest, item, 0);
}

const char *fg_manifest_label(const fg_manifest *manifest, size_t item) {
  const char *label = fg_manifest_cell(manifest, item, fg_manifest_column(manifest, "foil"));
  if (*label) return label;
  const char *scan = fg_manifest_scan(manifest, item), *slash = strrchr(scan, '/');
  return slash && slash[1] ? slash + 1 : scan;
}

size_t fg_manifest_column(const fg_manifest *manifest, const char *name) {
  for (size_t i = 0; *name && i < manifest->columns; i++)
    if (!strcmp(manifest->name[i], name)) return i;
  return FG_NO_COLUMN;
}

/* FNV-1a. */
static size_t hash_text(const char *text) {
  uint64_t hash = 14695981039346656037u;
  for (; *text; text++)
    hash = (hash ^ (unsigned char)*text) * 1099511628211u;
  return (size_t)(hash ^ (hash >> 29));
}

static size_t *find_slot(const fg_manifest_index *index, const fg_manifest *manifest,
                         const char *scan) {
  size_t at = hash_text(scan) % index->slots;
  while (index->slot[at] && strcmp(fg_manifest_scan(manifest, index->slot[at] - 1), scan) != 0)
    at = (at + 1) % index->slots;
  return &index->slot[at];
}

fg_status fg_manifest_index_build(fg_context *ctx, const fg_manifest *manifest,
                                  fg_manifest_index *index) {
  void *block;
  *index = (fg_manifest_index){.slots = 2 * manifest->items + 3};
  FG_TRY(fg_memory_allocate(ctx, index->slots, sizeof *index->slot, &block));
  index->slot = block;
  for (size_t i = 0; i < manifest->items; i++) {
    size_t *slot = find_slot(index, manifest, fg_manifest_scan(manifest, i));
    if (!*slot) *slot = i + 1;
  }
  return FG_OK;
}

size_t fg_manifest_index_find(const fg_manifest_index *index, const fg_manifest *manifest,
                              const char *scan) {
  size_t slot = *find_slot(index, manifest, scan);
  return slot ? slot - 1 : manifest->items;
}

void fg_manifest_index_free(fg_manifest_index *index) {
  free(index->slot);
  *index = (fg_manifest_index){0};
}

void fg_manifest_free(fg_manifest *manifest) {
  for (size_t i = 0; i < manifest->columns; i++)
    free(manifest->name[i]);
  for (size_t i = 0; i < manifest->items * manifest->columns; i++)
    free(manifest->cell[i]);
  free(manifest->name);
  free(manifest->cell);
  *manifest = (fg_manifest){0};
}
