/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/file.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/text.h"

typedef enum place_kind { NOWHERE, A_FILE, A_NEW_FILE, A_STREAM } place_kind;

/* Final place of a path. */
typedef struct fg_output_place {
  const char *path;
  place_kind kind; /* A_STREAM: standard input or output that is no file */
  dev_t device;
  ino_t inode;
  char *canonical; /* of a new file */
} fg_output_place;

/* "folder/name" with every link in the folder followed; NULL: no such folder, or out of memory. */
static char *canonical_path(const char *path) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
  char *real = folder ? realpath(folder, NULL) : NULL, *canonical = NULL;
  if (real && fg_text_print(NULL, &canonical, "%s/%s", real, name) != FG_OK) canonical = NULL;
  free(folder);
  free(real);
  return canonical;
}

static fg_status find_place(fg_context *ctx, const char *path, int standard,
                            fg_output_place *place) {
  struct stat info;
  *place = (fg_output_place){.path = path};
  if (!path) return FG_OK;
  bool is_standard = !strcmp(path, "-");
  if ((is_standard ? fstat(standard, &info) : stat(path, &info)) == 0) {
    if (is_standard)
      place->kind = S_ISREG(info.st_mode) ? A_FILE : A_STREAM;
    else if (!S_ISCHR(info.st_mode))
      place->kind = A_FILE;
    place->device = info.st_dev;
    place->inode = info.st_ino;
  } else if (!is_standard) {
    place->canonical = canonical_path(path);
    if (place->canonical)
      place->kind = A_NEW_FILE;
    else if (errno == ENOMEM)
      return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the path %s", path);
  }
  return FG_OK;
}

static bool is_same(const fg_output_place *a, const fg_output_place *b) {
  if (a->kind != b->kind) return false;
  if (a->kind == A_FILE) return a->device == b->device && a->inode == b->inode;
  return a->kind == A_NEW_FILE && !strcmp(a->canonical, b->canonical);
}

static const char *place_name(const fg_output_place *output) {
  return strcmp(output->path, "-") ? output->path : "standard output";
}

static fg_status check_pair(fg_context *ctx, const fg_output_place *a, const fg_output_place *b) {
  bool both_standard = a->kind == A_STREAM && b->kind == A_STREAM;
  if (!both_standard && !is_same(a, b)) return FG_OK;
  if (!strcmp(a->path, b->path))
    return fg_fail(ctx, FG_ERR_USAGE, "%s: two outputs cannot go to one file", place_name(a));
  return fg_fail(ctx, FG_ERR_USAGE, "%s and %s: two outputs cannot go to one file", place_name(a),
                 place_name(b));
}

fg_status fg_overwrite_begin(fg_context *ctx, const char *const *outputs, size_t count,
                             fg_overwrite *overwrite) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *overwrite->places, &block));
  overwrite->places = block;
  for (size_t i = 0; i < count; i++) {
    fg_output_place *place = &overwrite->places[i];
    FG_TRY(find_place(ctx, outputs[i], STDOUT_FILENO, place));
    overwrite->count = i + 1;
    for (size_t other = 0; other < i; other++)
      FG_TRY(check_pair(ctx, &overwrite->places[other], place));
  }
  return FG_OK;
}

fg_status fg_overwrite_check(fg_context *ctx, const fg_overwrite *overwrite, const char *input,
                             const char *words) {
  fg_output_place place;
  FG_TRY(find_place(ctx, input, STDIN_FILENO, &place));
  const fg_output_place *found = NULL;
  for (size_t i = 0; i < overwrite->count && !found; i++)
    if (is_same(&overwrite->places[i], &place)) found = &overwrite->places[i];
  free(place.canonical);
  if (!found) return FG_OK;
  if (!strcmp(found->path, input) && strcmp(input, "-") != 0)
    return fg_fail(ctx, FG_ERR_USAGE, "%s: the output would overwrite %s; give it another name",
                   found->path, words);
  return fg_fail(ctx, FG_ERR_USAGE, "%s: the output would overwrite %s, %s; give it another name",
                 place_name(found), words, strcmp(input, "-") ? input : "standard input");
}

bool fg_overwrite_is_same(const char *a, const char *b) {
  fg_output_place one = {0}, other = {0};
  bool same = find_place(NULL, a, STDIN_FILENO, &one) == FG_OK &&
              find_place(NULL, b, STDIN_FILENO, &other) == FG_OK && is_same(&one, &other);
  free(one.canonical);
  free(other.canonical);
  return same;
}

void fg_overwrite_free(fg_overwrite *overwrite) {
  for (size_t i = 0; i < overwrite->count; i++)
    free(overwrite->places[i].canonical);
  free(overwrite->places);
  *overwrite = (fg_overwrite){0};
}
