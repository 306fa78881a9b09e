/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/input/reference_curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/table.h"

enum { CURVE_BYTES_MAX = 1 << 20, CONTEXT_WORDS = 700 };

/* Columns of the file in the order of a point, with the names of a lot's bumps.csv. */
static const char *const columns[] = {"bump", "radius_error_pct", "intersection_angle_error_pct"};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

/* Inserts a point in the order of bumps; `row`, from 1, is for messages. */
static fg_status insert_point(fg_context *ctx, const double numbers[COLUMNS], size_t row,
                              fg_lot_curve *curve) {
  double bump = numbers[0];
  for (int i = 0; i < COLUMNS; i++)
    if (!isfinite(numbers[i]))
      return fg_fail(ctx, FG_ERR_DATA, "row %zu: %s is no number", row, columns[i]);
  if (bump != floor(bump) || bump < 1 || bump > FG_LOT_CURVE_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "row %zu: bump is %g; it must be a whole number from 1 to %d",
                   row, bump, FG_LOT_CURVE_MAX);
  for (size_t i = 0; i < curve->count; i++)
    if (curve->point[i].bump == (int)bump)
      return fg_fail(ctx, FG_ERR_DATA, "row %zu: bump %g is there twice", row, bump);
  size_t at = curve->count++;
  for (; at > 0 && curve->point[at - 1].bump > (int)bump; at--)
    curve->point[at] = curve->point[at - 1];
  curve->point[at] = (fg_lot_curve_point){(int)bump, numbers[1], numbers[2]};
  return FG_OK;
}

static fg_status read_curve_table(fg_context *ctx, const fg_table *table, fg_lot_curve *curve) {
  const fg_extended *numbers[COLUMNS];
  for (int i = 0; i < COLUMNS; i++)
    FG_TRY(fg_table_numbers(ctx, table, columns[i], &numbers[i]));
  for (size_t row = 0; row < table->rows; row++) {
    double point[COLUMNS];
    for (int i = 0; i < COLUMNS; i++)
      point[i] = numbers[i][row].value;
    FG_TRY(insert_point(ctx, point, row + 1, curve));
  }
  return FG_OK;
}

/* A message of the table names its file already; one of a point does not. */
static fg_status name_curve_file(fg_context *ctx, const char *path, const fg_context *inner,
                                 fg_status status) {
  if (status == FG_OK) return FG_OK;
  bool named = !strncmp(inner->message, path, strlen(path));
  return fg_fail(ctx, status, "reference_curve: %.200s%s%.*s%s", named ? "" : path,
                 named ? "" : ": ", CONTEXT_WORDS, inner->message,
                 strstr(inner->message, "bump")
                     ? ""
                     : "; a reference curve has the columns bump, radius_error_pct, "
                       "intersection_angle_error_pct");
}

fg_status fg_lot_settings_load_curve(fg_context *ctx, const char *path, fg_lot_settings *settings) {
  char *text;
  fg_table table = {0};
  fg_context inner = {.message = ""};
  fg_lot_curve curve = {.count = 0};
  const char *slash = strrchr(path, '/');
  FG_TRY(fg_file_read_text(ctx, path, CURVE_BYTES_MAX, &text));
  fg_status status = fg_table_parse(&inner, path, text, strlen(text), &table);
  if (status == FG_OK) status = read_curve_table(&inner, &table, &curve);
  fg_table_free(&table);
  free(text);
  FG_TRY(name_curve_file(ctx, path, &inner, status));
  fg_text_clip(curve.name, sizeof curve.name, "%s", slash ? slash + 1 : path);
  settings->curve = curve;
  return FG_OK;
}

/* A point is kept as three numbers. */
static const double *list_kept_point(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_curve_point *point = subject->object;
  const double numbers[] = {point->bump, point->radius_error_pct, point->angle_error_pct};
  *count = COLUMNS;
  return memcpy(values, numbers, sizeof numbers);
}

static fg_status read_kept_points(const fg_reading *reading, const fg_member *member,
                                  const cJSON *value, void *object) {
  fg_lot_curve *curve = object;
  const cJSON *point;
  size_t row = 0;
  (void)member;
  cJSON_ArrayForEach(point, value) {
    double numbers[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
      const cJSON *item = cJSON_GetArrayItem(point, i);
      numbers[i] = cJSON_IsNumber(item) ? item->valuedouble : NAN;
    }
    FG_TRY(insert_point(reading->ctx, numbers, ++row, curve));
  }
  return row ? FG_OK : fg_fail(reading->ctx, FG_ERR_DATA, "points are missing");
}

static const fg_member point_rows[] = {{FG_NUMBERS_BY(NULL, list_kept_point), .lowest = COLUMNS,
                                        .highest = COLUMNS, .options = FG_MEMBER_NEVER_NULL}};
static const fg_members point_members = FG_MEMBERS(point_rows);

static const fg_member curve_rows[] = {
    {FG_TEXT("name", fg_lot_curve, name), .options = FG_MEMBER_REQUIRED | FG_MEMBER_ANY_TEXT,
     .words = "of its file"},
    {FG_ARRAY("points", fg_lot_curve, point, count, &point_members), .read = read_kept_points,
     .lowest = 1, .words = "bump, radius_error_pct, intersection_angle_error_pct",
     .options = FG_MEMBER_REQUIRED},
};
const fg_members fg_reference_curve_members = FG_MEMBERS(curve_rows);

fg_status fg_reference_curve_read(const fg_reading *reading, const fg_member *member,
                                  const cJSON *value, void *object) {
  fg_lot_settings *settings = object;
  fg_lot_curve curve = {.count = 0};
  fg_context inner = {.message = ""};
  const fg_reading kept = {.ctx = &inner, .between = " "};
  if (cJSON_IsString(value)) {
    char file[4096];
    fg_file_find_beside(reading->user, value->valuestring, file, sizeof file);
    return fg_lot_settings_load_curve(reading->ctx, file, settings);
  }
  if (!cJSON_IsObject(value))
    return fg_reading_fail(reading, member->name, "must be the path of a CSV file");
  if (fg_object_read(&kept, &fg_reference_curve_members, value, &curve) != FG_OK)
    return fg_fail(reading->ctx, FG_ERR_DATA, "reference_curve: %.*s", CONTEXT_WORDS,
                   inner.message);
  settings->curve = curve;
  return FG_OK;
}

fg_status fg_reference_curve_check(fg_context *ctx, const fg_lot_settings *settings) {
  const fg_lot_curve *curve = &settings->curve;
  size_t bumps = settings->design.bumps.count;
  if (!curve->count) return FG_OK;
  if (!fg_foil_kind_has_bumps(settings->design.kind))
    return fg_fail(ctx, FG_ERR_DATA,
                   "reference_curve: the lot's design is of form arc and has no bumps");
  int last = curve->point[curve->count - 1].bump;
  if (!bumps || last <= (int)bumps) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "reference_curve: %s has a bump %d; the design has %zu, 1 is next to the lip",
                 curve->name, last, bumps);
}
