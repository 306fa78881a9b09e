/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Break-away tests from CSV. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "load_test/break_away.h"
#include "load_test/columns.h"
#include "load_test/records.h"

/* 100 MN, and that on a lever of a kilometre: units mistaken. */
static const double weight_max_n = 1e8, torque_max_n_mm = 1e14;

/* Weights and repeats of a test by hand; more rows are a record of something else. */
enum { PULLS_MAX = 20000 };

typedef struct reading {
  fg_context *ctx;
  fg_load_test *test;
  const fg_load_source *source;
  const fg_table *table;
  fg_load_columns columns;
  const char *only; /* name of the tests' only bearing; NULL: there is none or several */
} reading;

static fg_status find_bearing(reading *r, size_t row, size_t *index) {
  char name[128];
  if (r->columns.bearing)
    FG_TRY(fg_load_columns_text(r->ctx, r->table, r->columns.bearing, row, name, sizeof name));
  else if (r->source->bearing || r->only)
    fg_text_clip(name, sizeof name, "%s", r->source->bearing ? r->source->bearing : r->only);
  else
    fg_load_file_stem(r->source->path, name, sizeof name);
  return fg_load_find_bearing(r->ctx, r->test, name, index);
}

/* A weight or torque; its sign would be a direction, which neither has. */
static fg_status read_value(const reading *r, fg_load_measured which, const char *words, double max,
                            size_t row, double *value) {
  *value = r->columns.number[which][row].value * r->columns.scale[which];
  if (*value < 0)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: row %zu (line %zu): a %s of %.6g; give its size, without a sign",
                   r->table->source, row + 1, r->table->line[row], words, *value);
  if (!(*value <= max))
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu (line %zu): a %s of %.3g; none is beyond %g",
                   r->table->source, row + 1, r->table->line[row], words, *value, max);
  return FG_OK;
}

/* Friction at the rotor's surface, which a torque and a force on a lever are. */
static fg_status read_friction(const reading *r, size_t row, double *friction_n) {
  const fg_load_options *o = &r->test->options;
  double radius_mm = o->diameter_mm / 2;
  if (r->columns.number[FG_LOAD_TORQUE]) {
    FG_TRY(read_value(r, FG_LOAD_TORQUE, "torque", torque_max_n_mm, row, friction_n));
    *friction_n /= radius_mm;
    return FG_OK;
  }
  FG_TRY(read_value(r, FG_LOAD_FORCE, "force", weight_max_n, row, friction_n));
  if (isfinite(o->lever_mm)) *friction_n *= o->lever_mm / radius_mm;
  return FG_OK;
}

static fg_status read_pull(reading *r, size_t row) {
  fg_load_test *test = r->test;
  fg_break_away_pull pull;
  if (test->pull_count == PULLS_MAX)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: more than %d pulls; a break-away test has a row per pull, not per sample",
                   r->table->source, PULLS_MAX);
  FG_TRY(find_bearing(r, row, &pull.bearing));
  FG_TRY(read_value(r, FG_LOAD_WEIGHT, "dead weight", weight_max_n, row, &pull.weight_n));
  FG_TRY(read_friction(r, row, &pull.friction_n));
  FG_TRY(fg_memory_reserve(r->ctx, test->pull_count + 1, sizeof *test->pulls, &test->pull_capacity,
                           (void **)&test->pulls));
  test->pulls[test->pull_count++] = pull;
  return FG_OK;
}

static fg_status read_file(fg_context *ctx, fg_load_test *test, const fg_load_source *source,
                           const char *only) {
  char *text = NULL;
  fg_table table = {0};
  reading r = {.ctx = ctx, .test = test, .source = source, .table = &table, .only = only};
  fg_status status = FG_OK;
  fg_load_file *file = &test->files[test->file_count++];
  FG_TRY_EXIT(fg_text_print(ctx, &file->path, "%s", source->path));
  FG_TRY_EXIT(fg_file_read_text(ctx, source->path, FG_LOAD_BYTES_MAX, &text));
  fg_sha256_text(text, file->sha256);
  FG_TRY_EXIT(fg_load_check_new(ctx, test));
  FG_TRY_EXIT(fg_table_parse(ctx, source->path, text, strlen(text), &table));
  FG_TRY_EXIT(fg_load_columns_find_break_away(ctx, &table, &r.columns));
  for (size_t i = 0; i < table.rows; i++)
    FG_TRY_EXIT(read_pull(&r, i));
exit:
  file->not_read = r.columns.not_read;
  fg_table_free(&table);
  free(text);
  return status;
}

fg_status fg_break_away_read(fg_context *ctx, fg_load_test *test) {
  const fg_load_options *o = &test->options;
  char only[128] = "";
  if (test->bearing_count == 1) fg_text_clip(only, sizeof only, "%s", test->bearings[0].name);
  for (size_t i = 0; i < o->break_away_count; i++)
    FG_TRY(read_file(ctx, test, &o->break_away[i], *only ? only : NULL));
  return FG_OK;
}
