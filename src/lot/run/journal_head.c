/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/journal_head.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/member.h"
#include "lot/run/record.h"
#include "lot/run/seal.h"

#define SCHEMA          "foilgauge/results/2"
#define SCHEMA_UNSEALED "foilgauge/results/1" /* without checksums */

fg_status fg_journal_fail(fg_context *ctx, const char *path, const char *what) {
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

fg_status fg_journal_write_head(fg_context *ctx, FILE *out, const fg_journal_head *head,
                                size_t *length) {
  char *line = NULL;
  FILE *memory = fg_stream_open(&line, length);
  if (memory) write_head_members(memory, head);
  if (!fg_stream_keep(memory, &line))
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the head of a journal");
  FG_TRY(fg_seal_line(ctx, &line, length));
  fwrite(line, 1, *length, out);
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

/* Records hold values by position. A build with other quantities would misread them wherever their
 * number agrees, so the names of the first line must match. */
static fg_status check_value_names(fg_context *ctx, const char *line, fg_head_state *state) {
  char *names;
  FG_TRY(fg_record_format_names(ctx, &names));
  names[strcspn(names, "}")] = '\0';
  if (!strstr(line, names + 1)) *state = FG_HEAD_EARLIER;
  free(names);
  return FG_OK;
}

fg_status fg_journal_parse_head(fg_context *ctx, const char *line, fg_journal_head *head,
                                fg_head_state *out) {
  *head = (fg_journal_head){0};
  fg_head_state state = FG_HEAD_DAMAGED;
  cJSON *root;
  if (fg_json_read(ctx, "the head of a journal", line, &root) == FG_ERR_MEMORY)
    return FG_ERR_MEMORY;
  if (is_of_schema(root, SCHEMA_UNSEALED) && !cJSON_HasObjectItem(root, "checksum"))
    state = FG_HEAD_EARLIER;
  else if (fg_seal_holds(line, strlen(line)) && is_of_schema(root, SCHEMA) &&
           read_head_members(root, head))
    state = FG_HEAD_GOOD;
  cJSON_Delete(root);
  *out = state;
  return state == FG_HEAD_GOOD ? check_value_names(ctx, line, out) : FG_OK;
}

fg_status fg_journal_fail_head(fg_context *ctx, const char *path, fg_head_state state) {
  if (state == FG_HEAD_EARLIER)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is of an earlier version, whose records hold other values or carry no "
                   "checksum; measure its scans again with --resume",
                   path);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: line 1 is damaged, or it is not the results of a lot; `foilgauge lot "
                 "--resume` keeps what is whole, if anything is; else choose another folder",
                 path);
}
