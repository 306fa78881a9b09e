/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A manifest from what a user names: folders, scans, lists, manifests. */
#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "core/file.h"
#include "core/folder.h"
#include "core/memory.h"
#include "core/text.h"
#include "lot/input/manifest.h"
#include "scan/format.h"

enum { TEXT_BYTES_MAX = 1 << 30, DEPTH_MAX = 32 };

/* Pictures of folders are sorted by the bytes of their names, so that a lot reads alike in every
 * locale. */

static int is_visible_entry(const struct dirent *entry) {
  return entry->d_name[0] != '.';
}

static int compare_names_bytewise(const struct dirent **a, const struct dirent **b) {
  return strcmp((*a)->d_name, (*b)->d_name);
}

static bool is_same_file(const char *a, const char *b) {
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

static void note_empty_folder(fg_manifest *manifest, const char *path) {
  fg_lot_finding *folders = &manifest->empty_folders;
  if (folders->count++ == 0) fg_text_clip(folders->first, sizeof folders->first, "%s", path);
}

static fg_status add_entry(const search *s, const char *folder, const char *name, int depth) {
  char *path = NULL;
  struct stat info;
  FG_TRY(fg_text_print(s->ctx, &path, "%s/%s", folder, name));
  fg_status status = FG_OK;
  bool there = stat(path, &info) == 0;
  size_t before = s->manifest->items;
  if (there && S_ISDIR(info.st_mode) && !(s->leave_out && is_same_file(path, s->leave_out))) {
    status = add_folder(s, path, depth + 1);
    if (s->manifest->items == before && fg_format_has_name(name))
      note_empty_folder(s->manifest, path);
  } else if (fg_format_has_name(name) && !(there && S_ISDIR(info.st_mode)))
    status = fg_manifest_add_scan(s->ctx, s->manifest, "", path);
  free(path);
  return status;
}

static fg_status add_folder(const search *s, const char *folder, int depth) {
  struct dirent **entries;
  if (depth > DEPTH_MAX)
    return fg_fail(s->ctx, FG_ERR_DATA, "%s: folders lie %d deep; is a link going round?", folder,
                   DEPTH_MAX);
  int count = scandir(folder, &entries, is_visible_entry, compare_names_bytewise);
  if (count < 0)
    return fg_fail(s->ctx, fg_status_of_errno(errno), "%s: the folder cannot be read: %s", folder,
                   strerror(errno));
  fg_status status = FG_OK;
  for (int i = 0; i < count; i++) {
    if (status == FG_OK) status = add_entry(s, folder, entries[i]->d_name, depth);
    free(entries[i]);
  }
  free(entries);
  return status;
}

static fg_status parse_list(fg_context *ctx, const char *text, const char *folder,
                            fg_manifest *manifest) {
  while (*text) {
    size_t length = strcspn(text, "\r\n");
    if (length && text[0] != '#') {
      char *line;
      FG_TRY(fg_manifest_copy_text(ctx, text, length, &line));
      fg_status status = fg_manifest_add_scan(ctx, manifest, folder, line);
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
  fg_status status =
      fg_manifest_copy_text(ctx, path, slash && !own ? (size_t)(slash - path) : 0, &folder);
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
    FG_TRY(fg_manifest_copy_text(s->ctx, path, length, &folder));
    fg_status status = add_folder(s, folder, 0);
    free(folder);
    return status;
  }
  if (ends_with(path, ".csv"))
    return add_text_file(s->ctx, path, false, s->own == path, s->manifest);
  if (ends_with(path, ".txt")) return add_text_file(s->ctx, path, true, false, s->manifest);
  /* A missing scan becomes a record with its error. A path without the name of a scan must be a
   * folder. */
  if (!fg_format_has_name(path) && stat(path, &info) != 0) return fg_folder_require(s->ctx, path);
  return fg_manifest_add_scan(s->ctx, s->manifest, "", path);
}

/* Resolves links, "." and ".." of every scan. A scan that is missing keeps its spelling. */
static fg_status resolve_scans(fg_context *ctx, const fg_manifest *manifest, fg_manifest *real) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, manifest->items, sizeof *real->cell, &block));
  *real = (fg_manifest){.cell = block, .columns = 1};
  while (real->items < manifest->items) {
    const char *scan = fg_manifest_scan(manifest, real->items);
    char *path = realpath(scan, NULL);
    if (!path) FG_TRY(fg_manifest_copy_text(ctx, scan, strlen(scan), &path));
    real->cell[real->items++] = path;
  }
  return FG_OK;
}

/* Both rows must agree: nobody knows which of two cells holds. */
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

static void drop_named_again(fg_manifest *manifest, size_t first, size_t second) {
  fg_lot_finding *again = &manifest->named_again;
  if (again->count++ == 0)
    fg_text_clip(again->first, sizeof again->first, "%s (%s)", fg_manifest_scan(manifest, second),
                 fg_manifest_scan(manifest, first));
  for (size_t i = 0; i < manifest->columns; i++) {
    free(manifest->cell[second * manifest->columns + i]);
    manifest->cell[second * manifest->columns + i] = NULL;
  }
}

static fg_status drop_doubles(fg_context *ctx, fg_manifest *manifest, const fg_manifest *real,
                              const fg_manifest_index *index) {
  size_t kept = 0, columns = manifest->columns;
  for (size_t i = 0; i < real->items; i++) {
    size_t first = fg_manifest_index_find(index, real, real->cell[i]);
    if (first != i) FG_TRY(check_double(ctx, manifest, first, i));
  }
  for (size_t i = 0; i < real->items; i++) {
    size_t first = fg_manifest_index_find(index, real, real->cell[i]);
    if (first != i) drop_named_again(manifest, first, i);
  }
  for (size_t i = 0; i < real->items; i++) {
    if (!manifest->cell[i * columns]) continue;
    memmove(manifest->cell + kept++ * columns, manifest->cell + i * columns,
            columns * sizeof *manifest->cell);
  }
  manifest->items = kept;
  return FG_OK;
}

static fg_status check_listed_scans(fg_context *ctx, fg_manifest *manifest) {
  fg_manifest real = {0};
  fg_manifest_index index = {0};
  char endings[100];
  fg_format_list_endings(endings, sizeof endings);
  if (manifest->items == 0)
    return fg_fail(ctx, FG_ERR_DATA, "no scan: the folders hold no file (%s), the lists no line",
                   endings);
  fg_status status = resolve_scans(ctx, manifest, &real);
  if (status == FG_OK) status = fg_manifest_index_build(ctx, &real, &index);
  if (status == FG_OK) status = drop_doubles(ctx, manifest, &real, &index);
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
  fg_status status = fg_manifest_start(ctx, manifest);
  for (size_t i = 0; i < count && status == FG_OK; i++)
    status = add_path(&s, paths[i]);
  if (status == FG_OK) status = check_listed_scans(ctx, manifest);
  if (status != FG_OK) fg_manifest_free(manifest);
  return status;
}
