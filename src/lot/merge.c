/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Merges shards into one lot: refuses shards that do not belong together, then reports as one run
 * would. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"
#include "core/folder.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "lot/run/folder_lock.h"
#include "lot/run/guard.h"
#include "lot/run/lot.h"
#include "report/lot/files.h"
#include "report/lot/foil_pages.h"

enum { TEXT_BYTES_MAX = 1 << 30 };

typedef struct merger {
  const char *const *folders;
  size_t count;
  const char *folder; /* of the merged lot */
  char *recipe_text, *manifest_text;
  char *model_text; /* NULL: none */
  fg_lot_settings settings;
  fg_manifest manifest;
  fg_manifest_index index;
  fg_journal_head head; /* of the first shard */
  char **paths;         /* results.jsonl of each folder */
  size_t *shard_of;     /* folder + 1 by shard index - 1; 0: missing */
  fg_journal_entry *entries;
  size_t *from;
  size_t at; /* folder that is read now */
  int lock;
  bool decimal_comma;
} merger;

static fg_status read_folder_text(fg_context *ctx, const char *folder, const char *name,
                                  char **text) {
  char *path;
  FG_TRY(fg_lot_path(ctx, folder, name, &path));
  fg_status status = fg_file_read_text(ctx, path, TEXT_BYTES_MAX, text);
  free(path);
  return status;
}

static fg_status check_text_sum(fg_context *ctx, const char *folder, const char *name,
                                const char *text, const char *expected) {
  char sum[65];
  fg_sha256_text(text, sum);
  if (!strcmp(sum, expected)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: %s is not the one that its results.jsonl was made with; measure the shard "
                 "again",
                 folder, name);
}

/* The first folder defines the lot: recipe, manifest, model. */
static fg_status read_first_folder(fg_context *ctx, merger *m) {
  const char *folder = m->folders[0];
  FG_TRY(read_folder_text(ctx, folder, "recipe.json", &m->recipe_text));
  FG_TRY(read_folder_text(ctx, folder, "manifest.csv", &m->manifest_text));
  FG_TRY(check_text_sum(ctx, folder, "recipe.json", m->recipe_text, m->head.recipe_sha256));
  FG_TRY(check_text_sum(ctx, folder, "manifest.csv", m->manifest_text, m->head.manifest_sha256));
  fg_lot_settings_default(&m->settings);
  FG_TRY(fg_lot_settings_parse(ctx, folder, m->recipe_text, &m->settings));
  if (m->settings.model[0]) {
    FG_TRY(read_folder_text(ctx, folder, FG_LOT_MODEL_FILE, &m->model_text));
    FG_TRY(check_text_sum(ctx, folder, FG_LOT_MODEL_FILE, m->model_text, m->settings.model_sha256));
  }
  FG_TRY(fg_manifest_parse(ctx, folder, m->manifest_text, "", &m->manifest));
  return fg_manifest_index_build(ctx, &m->manifest, &m->index);
}

static fg_status allocate_merger(fg_context *ctx, merger *m) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, m->manifest.items, sizeof *m->entries, &block));
  m->entries = block;
  FG_TRY(fg_memory_allocate(ctx, m->manifest.items, sizeof *m->from, &block));
  m->from = block;
  FG_TRY(fg_memory_allocate(ctx, m->head.shard.count, sizeof *m->shard_of, &block));
  m->shard_of = block;
  return FG_OK;
}

static fg_status refuse_shard(fg_context *ctx, const merger *m, const char *what) {
  return fg_fail(ctx, FG_ERR_DATA, "%s and %s: %s differ; shards of one lot must share it",
                 m->folders[0], m->folders[m->at], what);
}

/* Serves the message only: an unreadable recipe counts as another recipe. */
static bool has_other_model(const merger *m) {
  fg_context ignored = {.message = ""};
  fg_lot_settings other;
  char *text = NULL;
  fg_lot_settings_default(&other);
  if (read_folder_text(&ignored, m->folders[m->at], "recipe.json", &text) != FG_OK) return false;
  fg_status status = fg_lot_settings_parse(&ignored, m->folders[m->at], text, &other);
  free(text);
  return status == FG_OK && strcmp(other.model_sha256, m->settings.model_sha256) != 0;
}

static fg_status check_head(fg_context *ctx, const merger *m, const fg_journal_head *head) {
  if (strcmp(head->version, m->head.version) != 0)
    return refuse_shard(ctx, m, "the program's versions");
  if (strcmp(head->recipe_sha256, m->head.recipe_sha256) != 0)
    return refuse_shard(ctx, m, has_other_model(m) ? "the scanner's models" : "the recipes");
  if (strcmp(head->manifest_sha256, m->head.manifest_sha256) != 0)
    return refuse_shard(ctx, m, "the manifests");
  if (strcmp(head->measured_with, m->head.measured_with) != 0)
    return refuse_shard(ctx, m, "the settings of the measurement");
  if (head->shard.count != m->head.shard.count)
    return refuse_shard(ctx, m, "the numbers of shards");
  return FG_OK;
}

static fg_status assign_record(fg_context *ctx, void *user, fg_record *record,
                               fg_journal_entry entry) {
  merger *m = user;
  size_t item = fg_manifest_index_find(&m->index, &m->manifest, record->scan);
  if (item == m->manifest.items)
    return fg_fail(ctx, FG_ERR_DATA, "%s: %s is not in the manifest", m->paths[m->at],
                   record->scan);
  if (m->entries[item].length)
    return fg_fail(ctx, FG_ERR_DATA, "%s: a second record of %s; the first is in %s",
                   m->paths[m->at], record->scan, m->paths[m->from[item]]);
  if (strcmp(record->measured_with, m->head.measured_with) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s: %s was measured with other settings or another version",
                   m->paths[m->at], record->scan);
  m->entries[item] = entry;
  m->from[item] = m->at;
  return FG_OK;
}

static fg_status add_shard(fg_context *ctx, merger *m) {
  fg_journal_head head;
  fg_journal_damage damage;
  FG_TRY(fg_journal_read_head(ctx, m->paths[m->at], &head));
  FG_TRY(check_head(ctx, m, &head));
  size_t *folder = &m->shard_of[head.shard.index - 1];
  if (*folder)
    return fg_fail(ctx, FG_ERR_DATA, "shard %zu/%zu is there twice: %s and %s", head.shard.index,
                   head.shard.count, m->folders[*folder - 1], m->folders[m->at]);
  *folder = m->at + 1;
  FG_TRY(fg_journal_read(ctx, m->paths[m->at], &head, &damage,
                         &(fg_journal_visitor){.visit = assign_record, .user = m}));
  if (!damage.lines) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: line %zu is damaged or not whole (one of %zu); measure the shard with "
                 "--resume, which keeps the others",
                 m->paths[m->at], damage.first, damage.lines);
}

static fg_status check_all_there(fg_context *ctx, const merger *m) {
  size_t missing = 0, first = 0;
  for (size_t i = m->head.shard.count; i-- > 0;)
    if (!m->shard_of[i]) {
      missing++;
      first = i + 1;
    }
  if (missing)
    return fg_fail(ctx, FG_ERR_DATA, "missing: %zu of %zu shards, the first is %zu/%zu", missing,
                   m->head.shard.count, first, m->head.shard.count);
  for (size_t i = m->manifest.items; i-- > 0;)
    if (!m->entries[i].length) {
      missing++;
      first = i;
    }
  if (!missing) return FG_OK;
  size_t shard = m->shard_of[first % m->head.shard.count] - 1;
  return fg_fail(ctx, FG_ERR_DATA,
                 "without a record: %zu of %zu scans, the first is %s; measure %s with --resume",
                 missing, m->manifest.items, fg_manifest_scan(&m->manifest, first),
                 m->folders[shard]);
}

static fg_status gather_shards(fg_context *ctx, merger *m) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, m->count, sizeof *m->paths, &block));
  m->paths = block;
  for (size_t i = 0; i < m->count; i++) {
    FG_TRY(fg_folder_require(ctx, m->folders[i]));
    FG_TRY(fg_lot_path(ctx, m->folders[i], "results.jsonl", &m->paths[i]));
  }
  FG_TRY(fg_journal_read_head(ctx, m->paths[0], &m->head));
  FG_TRY(read_first_folder(ctx, m));
  FG_TRY(allocate_merger(ctx, m));
  for (m->at = 0; m->at < m->count; m->at++)
    FG_TRY(add_shard(ctx, m));
  return check_all_there(ctx, m);
}

static fg_status check_target_folder(fg_context *ctx, const merger *m) {
  struct stat target, source;
  FG_TRY(fg_lot_check_shards(ctx, m->folder, m->folders, m->count));
  FG_TRY(fg_folder_make(ctx, m->folder));
  for (size_t i = 0; i < m->count; i++)
    if (stat(m->folder, &target) == 0 && stat(m->folders[i], &source) == 0 &&
        target.st_dev == source.st_dev && target.st_ino == source.st_ino)
      return fg_fail(ctx, FG_ERR_USAGE, "%s: the result would overwrite a shard", m->folder);
  return FG_OK;
}

static fg_status write_merged_lot(fg_context *ctx, merger *m, fg_lot_outcome *outcome) {
  char *path;
  fg_journal_head head = m->head;
  head.shard = (fg_lot_shard){1, 1};
  FG_TRY(fg_lot_remove_report(ctx, m->folder));
  FG_TRY(fg_lot_write_text(ctx, m->folder, "recipe.json", m->recipe_text));
  FG_TRY(fg_lot_write_text(ctx, m->folder, "manifest.csv", m->manifest_text));
  FG_TRY(fg_lot_write_model(ctx, m->folder, m->model_text));
  FG_TRY(fg_lot_path(ctx, m->folder, "results.jsonl", &path));
  fg_status status = fg_journal_rewrite(ctx, path, &head, (const char *const *)m->paths, m->from,
                                        m->entries, m->manifest.items);
  free(path);
  FG_TRY(status);
  fg_lot lot = {
      .settings = m->settings, .manifest = m->manifest, .decimal_comma = m->decimal_comma};
  m->manifest = (fg_manifest){0};
  status = fg_lot_load(ctx, m->folder, &lot);
  if (status == FG_OK) status = fg_lot_pages_link(ctx, m->folders, m->from, m->folder, &lot);
  if (status == FG_OK) status = fg_lot_write_report(ctx, m->folder, &lot, outcome);
  fg_lot_free(&lot);
  return status;
}

static fg_status merge_shards(fg_context *ctx, merger *m, fg_lot_outcome *outcome) {
  if (m->count == 0) return fg_fail(ctx, FG_ERR_USAGE, "no folder to merge");
  FG_TRY(gather_shards(ctx, m));
  FG_TRY(check_target_folder(ctx, m));
  FG_TRY(fg_folder_lock(ctx, m->folder, &m->lock));
  return write_merged_lot(ctx, m, outcome);
}

fg_status fg_lot_merge(fg_context *ctx, const char *const *folders, size_t count,
                       const char *folder, bool decimal_comma, fg_lot_outcome *outcome) {
  merger m = {.folders = folders,
              .count = count,
              .folder = folder,
              .decimal_comma = decimal_comma,
              .lock = -1};
  *outcome = (fg_lot_outcome){.judged = {.verdict = FG_VERDICT_NONE}};
  fg_status status = merge_shards(ctx, &m, outcome);
  if (m.lock >= 0) close(m.lock);
  for (size_t i = 0; m.paths && i < count; i++)
    free(m.paths[i]);
  free(m.paths);
  free(m.recipe_text);
  free(m.model_text);
  free(m.manifest_text);
  free(m.shard_of);
  free(m.entries);
  free(m.from);
  fg_manifest_index_free(&m.index);
  fg_manifest_free(&m.manifest);
  return status;
}
