/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/guard.h"

#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/sha256.h"
#include "foilgauge/file.h"
#include "lot/run/journal.h"
#include "lot/run/lot.h"

enum { LOT_FILES = 12 };

/* Paths of the files that a run writes into a lot's folder. Starts zeroed; free it in any case. */
typedef struct lot_guard {
  char *path[LOT_FILES];
  fg_overwrite overwrite; /* for fg_overwrite_check */
} lot_guard;

static const char *const lot_files[LOT_FILES] = {"manifest.csv",  "recipe.json", FG_LOT_MODEL_FILE,
                                                 "results.jsonl", "lot.json",    "index.html",
                                                 "foils.csv",     "bumps.csv",   "beams.csv",
                                                 "results.qif",   "results.dfq", "bearings.csv"};

static fg_status begin_guard(fg_context *ctx, const char *folder, lot_guard *guard) {
  for (size_t i = 0; i < LOT_FILES; i++)
    FG_TRY(fg_lot_path(ctx, folder, lot_files[i], &guard->path[i]));
  return fg_overwrite_begin(ctx, (const char *const *)guard->path, LOT_FILES, &guard->overwrite);
}

static void free_guard(lot_guard *guard) {
  for (size_t i = 0; i < LOT_FILES; i++)
    free(guard->path[i]);
  fg_overwrite_free(&guard->overwrite);
}

/* Checks the sum that the results were made with. The model's stands in the recipe, and its copy is
 * written back as it was read. */
static bool is_as_written(const char *path, const char *name, const fg_journal_head *head) {
  enum { TEXT_BYTES_MAX = 1 << 30 };
  char *text, sum[65];
  if (!strcmp(name, FG_LOT_MODEL_FILE)) return true;
  if (fg_file_read_text(NULL, path, TEXT_BYTES_MAX, &text) != FG_OK) return false;
  fg_sha256_text(text, sum);
  free(text);
  return !strcmp(sum, strcmp(name, "recipe.json") ? head->manifest_sha256 : head->recipe_sha256);
}

bool fg_lot_is_own_copy(const fg_lot_request *request, const char *path, const char *name) {
  char *own = NULL, *results = NULL;
  fg_journal_head head;
  if (!path || !request->resume) return false;
  bool same = fg_lot_path(NULL, request->folder, name, &own) == FG_OK &&
              fg_lot_path(NULL, request->folder, "results.jsonl", &results) == FG_OK &&
              fg_overwrite_is_same(own, path) &&
              fg_journal_read_head(NULL, results, &head) == FG_OK &&
              is_as_written(own, name, &head);
  free(own);
  free(results);
  return same;
}

static fg_status check_input(fg_context *ctx, const fg_lot_request *request, const lot_guard *guard,
                             const char *path, const char *name, const char *words) {
  if (fg_lot_is_own_copy(request, path, name)) return FG_OK;
  return fg_overwrite_check(ctx, &guard->overwrite, path, words);
}

static fg_status check_all_inputs(fg_context *ctx, const fg_lot_request *request,
                                  const fg_manifest *manifest, const lot_guard *guard) {
  const char *model = request->settings->model;
  FG_TRY(check_input(ctx, request, guard, request->recipe, "recipe.json", "the recipe"));
  FG_TRY(check_input(ctx, request, guard, request->design, "recipe.json", "the design"));
  FG_TRY(check_input(ctx, request, guard, model[0] ? model : NULL, FG_LOT_MODEL_FILE,
                     "the scanner's model"));
  for (size_t i = 0; i < manifest->items; i++)
    FG_TRY(fg_overwrite_check(ctx, &guard->overwrite, fg_manifest_scan(manifest, i), "the scan"));
  for (size_t i = 0; i < request->path_count; i++)
    FG_TRY(
        check_input(ctx, request, guard, request->paths[i], "manifest.csv", "the list of scans"));
  return FG_OK;
}

fg_status fg_lot_check_inputs(fg_context *ctx, const fg_lot_request *request,
                              const fg_manifest *manifest) {
  lot_guard guard = {0};
  fg_status status = begin_guard(ctx, request->folder, &guard);
  if (status == FG_OK) status = check_all_inputs(ctx, request, manifest, &guard);
  free_guard(&guard);
  return status;
}

static fg_status check_shard_files(fg_context *ctx, const char *shard, const lot_guard *guard) {
  enum { READ = 4 }; /* number of lot_files that merging reads */
  fg_status status = FG_OK;
  for (size_t i = 0; i < READ && status == FG_OK; i++) {
    char *path;
    FG_TRY(fg_lot_path(ctx, shard, lot_files[i], &path));
    status = fg_overwrite_check(ctx, &guard->overwrite, path, "a file of a shard");
    free(path);
  }
  return status;
}

fg_status fg_lot_check_shards(fg_context *ctx, const char *folder, const char *const *shards,
                              size_t count) {
  lot_guard guard = {0};
  fg_status status = begin_guard(ctx, folder, &guard);
  for (size_t i = 0; i < count && status == FG_OK; i++)
    status = check_shard_files(ctx, shards[i], &guard);
  free_guard(&guard);
  return status;
}
