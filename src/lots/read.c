/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a lot from its lot.json. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "lots/index.h"
#include "quantity/parts.h"
#include "report/design/json.h"

enum { LOT_BYTES_MAX = 1 << 30 };

static const cJSON *find_member(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *read_member_text(const cJSON *object, const char *name) {
  const cJSON *value = find_member(object, name);
  return cJSON_IsString(value) ? value->valuestring : "";
}

static double read_member_number(const cJSON *object, const char *name) {
  const cJSON *value = find_member(object, name);
  return cJSON_IsNumber(value) ? value->valuedouble : NAN;
}

static size_t read_member_count(const cJSON *object, const char *name) {
  double value = read_member_number(object, name);
  return value >= 0 && value < 1e15 ? (size_t)value : 0;
}

/* Describes why lot.json is missing, with advice. */
static fg_status describe_missing(fg_context *ctx, fg_index_lot *lot, const char *path,
                                  const char *error) {
  fg_journal_head head;
  fg_context unused;
  struct stat about;
  char *journal;
  if (stat(lot->folder, &about) == 0 && !S_ISDIR(about.st_mode))
    return fg_text_print(ctx, &lot->problem, "%s: not a folder; name the folder of a lot",
                         lot->folder);
  if (access(path, F_OK) == 0 || access(lot->folder, F_OK) != 0)
    return fg_text_print(ctx, &lot->problem, "%s", error);
  FG_TRY(fg_lot_path(ctx, lot->folder, "results.jsonl", &journal));
  bool begun = access(journal, F_OK) == 0;
  bool shard = fg_journal_read_head(&unused, journal, &head) == FG_OK && head.shard.count > 1;
  free(journal);
  if (shard)
    return fg_text_print(ctx, &lot->problem,
                         "%s: one of %zu shards, no lot yet; join them with `foilgauge merge`",
                         lot->folder, head.shard.count);
  if (begun)
    return fg_text_print(ctx, &lot->problem,
                         "%s: not finished, there is results.jsonl but no lot.json; finish it with "
                         "`foilgauge lot %s/manifest.csv -o %s --recipe %s/recipe.json --resume`",
                         lot->folder, lot->folder, lot->folder, lot->folder);
  return fg_text_print(ctx, &lot->problem,
                       "%s: not the folder of a lot, there is no lot.json; make one with "
                       "`foilgauge lot SCANS -o %s`",
                       lot->folder, lot->folder);
}

/* Describes the damage of a lot.json; NULL: it can be read. */
static fg_status describe_damage(fg_context *ctx, fg_index_lot *lot, const char *path,
                                 const cJSON *root) {
  static const char kind[] = "foilgauge/lot/";
  const char *schema = read_member_text(root, "schema");
  if (root && !strcmp(schema, "foilgauge/lot/1")) return FG_OK;
  if (root && !strncmp(schema, kind, sizeof kind - 1))
    return fg_text_print(ctx, &lot->problem,
                         "%s: of another version, %s, and this program reads foilgauge/lot/1; take "
                         "the program that it is of (%s), or a newer one",
                         path, schema, read_member_text(root, "version"));
  if (root)
    return fg_text_print(ctx, &lot->problem, "%s: not the report of a lot (its schema is '%s')",
                         path, schema);
  return fg_text_print(ctx, &lot->problem,
                       "%s: not JSON: damaged or cut off; write it again with `foilgauge lot "
                       "%s/manifest.csv -o %s --recipe %s/recipe.json --resume`",
                       path, lot->folder, lot->folder, lot->folder);
}

static fg_verdict read_verdict_word(const char *word) {
  for (int verdict = FG_VERDICT_PASS; verdict < FG_VERDICT_NONE; verdict++)
    if (!strcmp(word, fg_verdict_word((fg_verdict)verdict))) return (fg_verdict)verdict;
  return FG_VERDICT_NONE;
}

static void read_counts(fg_index_lot *lot, const cJSON *root) {
  const cJSON *counts = find_member(root, "counts");
  lot->verdict = read_verdict_word(read_member_text(root, "verdict"));
  lot->scans = read_member_count(counts, "scans");
  lot->failed_scans = read_member_count(counts, "scans_not_measured");
  lot->foils = read_member_count(counts, "foils");
  lot->exceeded = read_member_count(counts, "exceeded");
  for (int verdict = FG_VERDICT_PASS; verdict <= FG_VERDICT_NONE; verdict++)
    lot->by_verdict[verdict] = read_member_count(counts, fg_verdict_word((fg_verdict)verdict));
}

static void read_lot_date(fg_index_lot *lot, const cJSON *root) {
  const cJSON *date = find_member(root, "date");
  const char *from = read_member_text(date, "from");
  lot->day = fg_date_days(read_member_text(date, "first"));
  if (!isfinite(lot->day)) return;
  lot->date.from = !strcmp(from, FG_LOT_DATE_MANIFEST) ? FG_LOT_DATE_MANIFEST : FG_LOT_DATE_SCANS;
  fg_date_format(lot->day, lot->date.first);
  double last = fg_date_days(read_member_text(date, "last"));
  fg_date_format(isfinite(last) ? last : lot->day, lot->date.last);
}

/* Sums the nominal values of the design: its text without name, tolerances and calibration. */
static fg_status sum_asked_design(fg_context *ctx, fg_index_lot *lot) {
  char *text = NULL;
  size_t size;
  fg_json json;
  fg_design bare = lot->design;
  strcpy(bare.name, "-");
  bare.tolerance_count = 0;
  bare.calibration = (fg_calibration){.stated = false};
  FILE *out = fg_stream_open(&text, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a design");
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_design(&json, "design", &bare);
  fg_json_object_end(&json);
  if (!fg_stream_keep(out, &text)) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a design");
  fg_sha256_text(text, lot->design_sum);
  free(text);
  return FG_OK;
}

static fg_status read_lot_design(fg_context *ctx, fg_index_lot *lot, const char *path,
                                 const cJSON *root) {
  fg_context inner = {.message = ""};
  char *text = cJSON_PrintUnformatted(find_member(root, "design"));
  fg_design_default(&lot->design);
  fg_status status = text ? fg_design_parse(&inner, path, text, &lot->design)
                          : fg_fail(&inner, FG_ERR_DATA, "%s: design: it is missing", path);
  if (status == FG_OK) status = fg_design_derive(&inner, &lot->design, &lot->nominal);
  cJSON_free(text);
  if (status == FG_OK) return sum_asked_design(ctx, lot);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  return fg_text_print(ctx, &lot->problem,
                       "%s (foilgauge %s wrote it, this is %s; what it cannot read may be newer)",
                       inner.message, lot->version, FOILGAUGE_VERSION);
}

static void read_lot_stat(fg_index_lot *lot, fg_quantity_owner owner, const fg_quantity *row,
                          const cJSON *from) {
  fg_index_stat *stat = &lot->stats[lot->stat_count++];
  *stat = (fg_index_stat){
      .row = row,
      .owner = owner,
      .count = read_member_count(from, "count"),
      .mean = read_member_number(from, "mean"),
      .sd = read_member_number(from, "sd"),
      .median = read_member_number(from, "median"),
      .mode = read_member_number(from, "mode"),
      .min = read_member_number(from, "min"),
      .max = read_member_number(from, "max"),
      .lower = -INFINITY,
      .upper = INFINITY,
      .foil_mean = NAN,
      .foil_sd = NAN,
      .expected_low = NAN,
      .expected_high = NAN,
  };
  for (size_t i = 0; i < lot->design.tolerance_count; i++)
    if (!strcmp(lot->design.tolerances[i].quantity, row->name)) {
      stat->lower = lot->design.tolerances[i].lower;
      stat->upper = lot->design.tolerances[i].upper;
    }
}

/* Reads the quantities in the order of lot.json; unknown ones, of another version, are skipped. */
static fg_status read_lot_stats(fg_context *ctx, fg_index_lot *lot, const cJSON *root) {
  const fg_quantity_owner owners[] = {fg_foil_kind_parts(lot->design.kind), FG_QUANTITY_OF_FOIL};
  const cJSON *list = find_member(root, "quantities"), *item;
  void *block;
  int size = cJSON_GetArraySize(list);
  FG_TRY(fg_memory_allocate(ctx, (size_t)(size > 0 ? size : 0), sizeof *lot->stats, &block));
  lot->stats = block;
  cJSON_ArrayForEach(item, list) for (size_t o = 0; o < 2; o++) {
    const fg_quantity *row = fg_quantity_find(owners[o], item->string);
    if (!row || row->kind == FG_QUANTITY_PAIR) continue;
    read_lot_stat(lot, owners[o], row, item);
    break;
  }
  return FG_OK;
}

static fg_status read_scan_sums(fg_context *ctx, fg_index_lot *lot, const cJSON *root) {
  const cJSON *list = find_member(root, "inputs"), *item;
  void *block;
  int size = cJSON_GetArraySize(list);
  FG_TRY(fg_memory_allocate(ctx, (size_t)(size > 0 ? size : 0), sizeof *lot->scan_sum, &block));
  lot->scan_sum = block;
  cJSON_ArrayForEach(item, list) {
    const char *sum = read_member_text(item, "sha256");
    if (strlen(sum) == 64) strcpy(lot->scan_sum[lot->scan_sums++], sum);
  }
  return FG_OK;
}

static fg_status read_lot_members(fg_context *ctx, fg_index_lot *lot, const char *path,
                                  const cJSON *root) {
  FG_TRY(describe_damage(ctx, lot, path, root));
  if (lot->problem) return FG_OK;
  const char *name = read_member_text(root, "name");
  FG_TRY(fg_text_print(ctx, &lot->name, "%s", *name ? name : lot->folder));
  fg_text_clip(lot->version, sizeof lot->version, "%s", read_member_text(root, "version"));
  read_counts(lot, root);
  read_lot_date(lot, root);
  FG_TRY(read_lot_design(ctx, lot, path, root));
  if (lot->problem) return FG_OK;
  FG_TRY(read_lot_stats(ctx, lot, root));
  return read_scan_sums(ctx, lot, root);
}

fg_status fg_index_read_lot(fg_context *ctx, fg_index_lot *lot) {
  char *path, *text = NULL;
  fg_context inner = {.message = ""};
  lot->day = NAN;
  FG_TRY(fg_lot_path(ctx, lot->folder, "lot.json", &path));
  fg_status status = fg_file_read_text(&inner, path, LOT_BYTES_MAX, &text);
  if (status == FG_ERR_MEMORY) {
    fg_fail(ctx, status, "%s", inner.message);
  } else if (status != FG_OK) {
    status = describe_missing(ctx, lot, path, inner.message);
  } else {
    cJSON *root;
    status = fg_json_read(ctx, path, text, &root);
    fg_sha256_text(text, lot->sha256);
    if (status != FG_ERR_MEMORY)
      status = read_lot_members(ctx, lot, path, root); /* damage becomes lot->problem */
    cJSON_Delete(root);
  }
  free(text);
  free(path);
  return status;
}
