/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Companion file of a run sheet: limits and steps of its factors, and every planned setting. */
#include "process/plan_file.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/plan.h"

#define PLAN_SCHEMA "foilgauge/plan/1"

enum { PLAN_BYTES_MAX = 1 << 26 };

/* Relative rounding that a spreadsheet may apply to a number. */
static const double same = 1e-6;

/* A factor: the subject's index is its place in the plan. */
#define OF_FACTOR(function, value)                                                                 \
  static double function(const fg_subject *s) {                                                    \
    const fg_plan *plan = s->object;                                                               \
    return value;                                                                                  \
  }
OF_FACTOR(find_factor_low, plan->low[s->index])
OF_FACTOR(find_factor_high, plan->high[s->index])
OF_FACTOR(find_factor_step, plan->step[s->index] > 0 ? plan->step[s->index] : NAN)

static const char *find_factor_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  return ((const fg_plan *)s->object)->name[s->index];
}

static const fg_member factor_rows[] = {
    {FG_TEXT_BY("name", find_factor_name), .options = FG_MEMBER_NEVER_NULL, .words = "its column"},
    {FG_NUMBER_BY("low", find_factor_low), .options = FG_MEMBER_NEVER_NULL,
     .words = "real value of -1"},
    {FG_NUMBER_BY("high", find_factor_high), .options = FG_MEMBER_NEVER_NULL,
     .words = "real value of +1"},
    {FG_NUMBER_BY("step", find_factor_step),
     .words = "settings are its multiples; null: not rounded"},
};
static const fg_members factor_members = FG_MEMBERS(factor_rows);

static bool find_factor(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_plan *plan = list->object;
  element->object = plan;
  return i < plan->factors;
}

/* Settings of a run, by the standard order. */
static const double *list_settings(const fg_subject *s, double *settings, size_t *count) {
  const fg_plan *plan = s->object;
  size_t run = 0;
  while (run < plan->runs && plan->run[run].standard != s->index + 1)
    run++;
  *count = plan->factors;
  for (size_t k = 0; k < plan->factors; k++)
    settings[k] = run < plan->runs ? fg_plan_setting(plan, run, k) : 0;
  return settings;
}

static const fg_member setting_rows[] = {
    {FG_NUMBERS_BY(NULL, list_settings), .options = FG_MEMBER_NEVER_NULL}};
static const fg_members setting_members = FG_MEMBERS(setting_rows);

static bool find_run(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_plan *plan = list->object;
  element->object = plan;
  return i < plan->runs;
}

static double find_axial(const fg_subject *s) {
  const fg_plan *plan = s->object;
  return plan->axial > 0 ? plan->axial : NAN;
}

static const fg_member plan_rows[] = {
    {FG_HEAD(PLAN_SCHEMA)},
    {FG_NUMBER_BY("axial", find_axial),
     .words = "coded distance of the axial runs; null: there are none"},
    {FG_LIST_BY("factors", find_factor, &factor_members), .options = FG_MEMBER_ON_LINE, .lowest = 1,
     .highest = FG_PLAN_FACTORS},
    {FG_LIST_BY("settings", find_run, &setting_members),
     .words = "by standard_order: what each factor is to be set to"},
};
static const fg_members plan_members = FG_MEMBERS(plan_rows);

const fg_document fg_plan_document = {
    .file = "plan",
    .title = "foilgauge doe plan: what lies beside a run sheet",
    .made_by = "`foilgauge doe plan -o`",
    .members = &plan_members,
};

fg_status fg_plan_write_json(fg_context *ctx, const fg_plan *plan, FILE *out) {
  fg_document_json(out, &plan_members, plan);
  return fg_stream_finish(ctx, out, "the plan");
}

fg_status fg_plan_beside(fg_context *ctx, const char *sheet, char **path) {
  size_t length = strlen(sheet);
  bool csv = length > 4 && !strcmp(sheet + length - 4, ".csv");
  return fg_text_print(ctx, path, "%.*s.plan.json", (int)(csv ? length - 4 : length), sheet);
}

static fg_status read_factor(fg_context *ctx, const char *path, const cJSON *one,
                             fg_plan_limits *limits) {
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(one, "name"),
              *low = cJSON_GetObjectItemCaseSensitive(one, "low"),
              *high = cJSON_GetObjectItemCaseSensitive(one, "high"),
              *step = cJSON_GetObjectItemCaseSensitive(one, "step");
  char text[400];
  size_t k = limits->factors;
  if (!cJSON_IsString(name) || !cJSON_IsNumber(low) || !cJSON_IsNumber(high))
    return fg_fail(ctx, FG_ERR_DATA, "%s: factors[%zu] has no name, low and high", path, k);
  fg_text_clip(text, sizeof text, "%.250s=%.15g:%.15g", name->valuestring, low->valuedouble,
               high->valuedouble);
  fg_context words = {0};
  if (fg_coding_parse(&words, text, &limits->coding[k]) != FG_OK)
    return fg_fail(ctx, FG_ERR_DATA, "%s: factors[%zu]: %s", path, k, words.message);
  limits->step[k] = cJSON_IsNumber(step) && step->valuedouble > 0 ? step->valuedouble : 0;
  limits->factors++;
  return FG_OK;
}

static fg_status read_settings(fg_context *ctx, const char *path, const cJSON *settings,
                               fg_plan_limits *limits) {
  const cJSON *one, *number;
  size_t runs = (size_t)cJSON_GetArraySize(settings);
  void *block;
  FG_TRY(fg_memory_allocate(ctx, runs * limits->factors + 1, sizeof(double), &block));
  limits->setting = block;
  cJSON_ArrayForEach(one, settings) {
    size_t k = 0;
    cJSON_ArrayForEach(number, one) {
      if (k < limits->factors && cJSON_IsNumber(number))
        limits->setting[limits->runs * limits->factors + k] = number->valuedouble;
      k++;
    }
    if (k != limits->factors)
      return fg_fail(ctx, FG_ERR_DATA, "%s: settings[%zu] has %zu numbers for %zu factors", path,
                     limits->runs, k, limits->factors);
    limits->runs++;
  }
  return FG_OK;
}

static fg_status read_plan(fg_context *ctx, const char *path, const cJSON *root,
                           fg_plan_limits *limits) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"),
              *factors = cJSON_GetObjectItemCaseSensitive(root, "factors"), *one;
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, PLAN_SCHEMA) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "%s: is no plan: schema is not \"" PLAN_SCHEMA "\"", path);
  if (!cJSON_IsArray(factors) || !cJSON_GetArraySize(factors) ||
      cJSON_GetArraySize(factors) > FG_PLAN_FACTORS)
    return fg_fail(ctx, FG_ERR_DATA, "%s: factors must be 1 to %d", path, FG_PLAN_FACTORS);
  cJSON_ArrayForEach(one, factors) FG_TRY(read_factor(ctx, path, one, limits));
  return read_settings(ctx, path, cJSON_GetObjectItemCaseSensitive(root, "settings"), limits);
}

fg_status fg_plan_limits_load(fg_context *ctx, const char *path, fg_plan_limits *limits) {
  char *text = NULL;
  *limits = (fg_plan_limits){0};
  FG_TRY(fg_file_read_text(ctx, path, PLAN_BYTES_MAX, &text));
  cJSON *root;
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  if (status == FG_OK) status = read_plan(ctx, path, root, limits);
  cJSON_Delete(root);
  if (status != FG_OK) fg_plan_limits_free(limits);
  return status;
}

void fg_plan_limits_free(fg_plan_limits *limits) {
  free(limits->setting);
  *limits = (fg_plan_limits){0};
}

static bool differs(const fg_plan_limits *limits, const fg_extended *const *column, size_t row,
                    double standard) {
  if (!(standard >= 1 && standard <= (double)limits->runs)) return true;
  const double *setting = limits->setting + ((size_t)standard - 1) * limits->factors;
  for (size_t k = 0; k < limits->factors; k++) {
    double size = limits->coding[k].high.value - limits->coding[k].low.value;
    if (column[k] && fabs(column[k][row].value - setting[k]) > same * size) return true;
  }
  return false;
}

size_t fg_plan_limits_differ(const fg_plan_limits *limits, const fg_table *table, size_t *first) {
  const fg_extended *column[FG_PLAN_FACTORS] = {NULL}, *standard;
  fg_context unused;
  size_t count = 0;
  if (fg_table_numbers(&unused, table, "standard_order", &standard) != FG_OK) return 0;
  for (size_t k = 0; k < limits->factors; k++)
    if (fg_table_numbers(&unused, table, limits->coding[k].name, &column[k]) != FG_OK)
      column[k] = NULL;
  for (size_t i = 0; i < table->rows; i++) {
    if (!differs(limits, column, i, standard[i].value)) continue;
    if (!count) *first = i + 1;
    count++;
  }
  return count;
}
