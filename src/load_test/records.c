/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/records.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/sha256.h"
#include "core/text.h"
#include "load_test/columns.h"

/* More directions are a column of something else that is called azimuth. */
enum { DIRECTIONS_MAX = 1000 };

/* A kilometre and 100 MN are units mistaken; sums of squares stay far from the largest double. */
static const double displacement_max_mm = 1e6, force_max_n = 1e8;

/* Difference below which azimuths are one direction: a fraction of a dividing head's step. */
static const double same_azimuth_deg = 0.05;

/* A row of a file, before the rows are sorted by direction. */
typedef struct row {
  fg_load_sample sample;
  size_t direction, file;
} row;

typedef struct reading {
  fg_context *ctx;
  fg_load_test *test;
  row *rows;
  size_t count, capacity;
  /* Of every direction, in this file: */
  double *last_time, *last_cycle;
  size_t last_time_capacity, last_cycle_capacity;
} reading;

const char *fg_load_file_stem(const char *path, char *text, size_t size) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  const char *dot = strrchr(name, '.');
  fg_text_clip(text, size, "%.*s", (int)(dot && dot > name ? (size_t)(dot - name) : strlen(name)),
               name);
  return text;
}

fg_status fg_load_find_bearing(fg_context *ctx, fg_load_test *test, const char *name,
                               size_t *index) {
  for (*index = 0; *index < test->bearing_count; (*index)++)
    if (!strcmp(test->bearings[*index].name, name)) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, test->bearing_count + 1, sizeof *test->bearings,
                           &test->bearing_capacity, (void **)&test->bearings));
  fg_load_bearing *bearing = &test->bearings[test->bearing_count++];
  *bearing = (fg_load_bearing){0};
  fg_text_clip(bearing->name, sizeof bearing->name, "%s", name);
  return FG_OK;
}

static fg_status find_direction(reading *r, const fg_load_direction *key, size_t guess,
                                size_t *index) {
  fg_load_test *test = r->test;
  for (size_t i = 0; i <= test->direction_count; i++) {
    *index = i ? i - 1 : guess; /* mostly that of the row before */
    if (*index >= test->direction_count) continue;
    const fg_load_direction *d = &test->directions[*index];
    if (d->bearing == key->bearing && fabs(d->azimuth_deg - key->azimuth_deg) < same_azimuth_deg &&
        !strcmp(d->pad, key->pad))
      return FG_OK;
  }
  if (test->direction_count == DIRECTIONS_MAX)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: more than %d different azimuths: is that the azimuth?",
                   test->files[test->file_count - 1].path, DIRECTIONS_MAX);
  FG_TRY(fg_memory_reserve(r->ctx, test->direction_count + 1, sizeof *test->directions,
                           &test->direction_capacity, (void **)&test->directions));
  *index = test->direction_count++;
  test->directions[*index] = *key;
  return FG_OK;
}

/* Times must rise and cycles must not go back: the order of the rows is that of time. */
static fg_status check_order(reading *r, const fg_table *table, const fg_load_columns *columns,
                             size_t i, size_t direction) {
  size_t old[2] = {r->last_time_capacity, r->last_cycle_capacity};
  FG_TRY(fg_memory_reserve(r->ctx, direction + 1, sizeof(double), &r->last_time_capacity,
                           (void **)&r->last_time));
  FG_TRY(fg_memory_reserve(r->ctx, direction + 1, sizeof(double), &r->last_cycle_capacity,
                           (void **)&r->last_cycle));
  for (size_t k = old[0]; k < r->last_time_capacity; k++)
    r->last_time[k] = -INFINITY;
  for (size_t k = old[1]; k < r->last_cycle_capacity; k++)
    r->last_cycle[k] = -INFINITY;
  double time = columns->number[FG_LOAD_TIME] ? columns->number[FG_LOAD_TIME][i].value : NAN;
  double cycle = columns->cycle ? columns->cycle->number[i].value : NAN;
  if (time <= r->last_time[direction])
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: row %zu (line %zu): the time %.10g %s one of the same azimuth; rows must "
                   "stand in the order of time, each time once",
                   table->source, i + 1, table->line[i], time,
                   time == r->last_time[direction] ? "is there twice; it follows"
                                                   : "follows a later");
  if (cycle < r->last_cycle[direction])
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: row %zu (line %zu): cycle %.10g follows cycle %.10g of the same azimuth; "
                   "rows must stand in the order of time",
                   table->source, i + 1, table->line[i], cycle, r->last_cycle[direction]);
  if (isfinite(time)) r->last_time[direction] = time;
  if (isfinite(cycle)) r->last_cycle[direction] = cycle;
  return FG_OK;
}

static double cell_value_at(const fg_load_columns *columns, fg_load_measured which, size_t i) {
  return columns->number[which][i].value * columns->scale[which];
}

static fg_status check_size(reading *r, const fg_table *table, const fg_load_columns *columns,
                            size_t i) {
  static const char *const words[] = {"displacement", "force"};
  const double value[] = {cell_value_at(columns, FG_LOAD_DISPLACEMENT, i),
                          cell_value_at(columns, FG_LOAD_FORCE, i)};
  const double max[] = {displacement_max_mm, force_max_n};
  for (int k = 0; k < 2; k++)
    if (!(fabs(value[k]) <= max[k]))
      return fg_fail(
          r->ctx, FG_ERR_DATA, "%s: row %zu (line %zu): a %s of %.3g %s; no bearing's is beyond %g",
          table->source, i + 1, table->line[i], words[k], value[k], k ? "N" : "mm", max[k]);
  return FG_OK;
}

/* A file given twice as a repeat would halve the uncertainty without new information. */
fg_status fg_load_check_new(fg_context *ctx, const fg_load_test *test) {
  const fg_load_file *last = &test->files[test->file_count - 1];
  for (size_t i = 0; i + 1 < test->file_count; i++)
    if (!strcmp(test->files[i].sha256, last->sha256))
      return fg_fail(ctx, FG_ERR_DATA, "%s: the same bytes as %s; a test counts once", last->path,
                     test->files[i].path);
  return FG_OK;
}

static fg_status take_row(reading *r, const fg_table *table, const fg_load_columns *columns,
                          const fg_load_source *source, size_t i) {
  char name[128];
  fg_load_direction key = {.azimuth_deg = source->azimuth_deg};
  size_t direction;
  if (columns->number[FG_LOAD_AZIMUTH])
    key.azimuth_deg = cell_value_at(columns, FG_LOAD_AZIMUTH, i);
  if (columns->bearing)
    FG_TRY(fg_load_columns_text(r->ctx, table, columns->bearing, i, name, sizeof name));
  else if (source->bearing)
    fg_text_clip(name, sizeof name, "%s", source->bearing);
  else
    fg_load_file_stem(source->path, name, sizeof name);
  if (columns->pad)
    FG_TRY(fg_load_columns_text(r->ctx, table, columns->pad, i, key.pad, sizeof key.pad));
  FG_TRY(check_size(r, table, columns, i));
  FG_TRY(fg_load_find_bearing(r->ctx, r->test, name, &key.bearing));
  FG_TRY(find_direction(r, &key, r->count ? r->rows[r->count - 1].direction : 0, &direction));
  FG_TRY(check_order(r, table, columns, i, direction));
  FG_TRY(fg_memory_reserve(r->ctx, r->count + 1, sizeof *r->rows, &r->capacity, (void **)&r->rows));
  r->rows[r->count++] = (row){
      {cell_value_at(columns, FG_LOAD_DISPLACEMENT, i), cell_value_at(columns, FG_LOAD_FORCE, i)},
      direction,
      r->test->file_count - 1};
  return FG_OK;
}

static fg_status read_file(reading *r, const fg_load_source *source) {
  char *text = NULL;
  fg_table table = {0};
  fg_load_columns columns = {0};
  fg_status status = FG_OK;
  fg_load_file *file = &r->test->files[r->test->file_count++];
  FG_TRY_EXIT(fg_text_print(r->ctx, &file->path, "%s", source->path));
  FG_TRY_EXIT(fg_file_read_text(r->ctx, source->path, FG_LOAD_BYTES_MAX, &text));
  fg_sha256_text(text, file->sha256);
  FG_TRY_EXIT(fg_load_check_new(r->ctx, r->test));
  FG_TRY_EXIT(fg_table_parse(r->ctx, source->path, text, strlen(text), &table));
  FG_TRY_EXIT(fg_load_columns_find(r->ctx, &table, isfinite(source->azimuth_deg), &columns));
  for (size_t k = 0; k < r->last_time_capacity; k++)
    r->last_time[k] = -INFINITY;
  for (size_t k = 0; k < r->last_cycle_capacity; k++)
    r->last_cycle[k] = -INFINITY;
  for (size_t i = 0; i < table.rows; i++)
    FG_TRY_EXIT(take_row(r, &table, &columns, source, i));
exit:
  file->not_read = columns.not_read;
  fg_table_free(&table);
  free(text);
  return status;
}

typedef struct place {
  size_t bearing, old;
  double azimuth_deg;
} place;

static int by_place(const void *left, const void *right) {
  const place *a = left, *b = right;
  if (a->bearing != b->bearing) return a->bearing < b->bearing ? -1 : 1;
  if (a->azimuth_deg < b->azimuth_deg) return -1;
  if (a->azimuth_deg > b->azimuth_deg) return 1;
  return (a->old > b->old) - (a->old < b->old);
}

/* Sorts directions by bearing and azimuth, and renumbers each row's direction. */
static fg_status sort_directions(reading *r) {
  fg_load_test *test = r->test;
  size_t count = test->direction_count;
  fg_load_direction *sorted = NULL;
  place *places = NULL;
  size_t *now = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, count, sizeof *sorted, (void **)&sorted));
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, count, sizeof *places, (void **)&places));
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, count, sizeof *now, (void **)&now));
  for (size_t i = 0; i < count; i++)
    places[i] = (place){test->directions[i].bearing, i, test->directions[i].azimuth_deg};
  fg_sort_items(places, count, sizeof *places, by_place);
  for (size_t i = 0; i < count; i++) {
    sorted[i] = test->directions[places[i].old];
    now[places[i].old] = i;
  }
  for (size_t i = 0; i < r->count; i++) {
    r->rows[i].direction = now[r->rows[i].direction];
    sorted[r->rows[i].direction].count++;
  }
  free(test->directions);
  test->directions = sorted;
  test->direction_capacity = count;
  sorted = NULL;
exit:
  free(sorted);
  free(places);
  free(now);
  return status;
}

static fg_status begin_record(reading *r, fg_load_records *records, size_t at) {
  FG_TRY(fg_memory_reserve(r->ctx, records->count + 1, sizeof *records->begin, &records->capacity,
                           (void **)&records->begin));
  records->begin[records->count++] = at;
  return FG_OK;
}

static int by_number(const void *left, const void *right) {
  size_t a = *(const size_t *)left, b = *(const size_t *)right;
  return (a > b) - (a < b);
}

/* The rows of each direction together, in their order. */
static fg_status gather_rows(reading *r, fg_load_records *records) {
  fg_load_test *test = r->test;
  size_t first = 0, *next = NULL, *file = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, r->count, sizeof *test->samples, (void **)&test->samples));
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, test->direction_count, sizeof *next, (void **)&next));
  FG_TRY_EXIT(fg_memory_allocate(r->ctx, test->direction_count, sizeof *file, (void **)&file));
  test->sample_count = test->sample_capacity = r->count;
  for (size_t i = 0; i < test->direction_count; i++) {
    test->directions[i].first = next[i] = first;
    first += test->directions[i].count;
    file[i] = SIZE_MAX;
  }
  for (size_t i = 0; i < r->count; i++) {
    size_t d = r->rows[i].direction;
    if (file[d] != r->rows[i].file) FG_TRY_EXIT(begin_record(r, records, next[d]));
    file[d] = r->rows[i].file;
    test->samples[next[d]++] = r->rows[i].sample;
  }
  fg_sort_items(records->begin, records->count, sizeof *records->begin, by_number);
exit:
  free(next);
  free(file);
  return status;
}

fg_status fg_load_records_read(fg_context *ctx, const fg_load_source *sources, size_t count,
                               fg_load_test *test, fg_load_records *records) {
  reading r = {.ctx = ctx, .test = test};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + test->options.break_away_count, sizeof *test->files,
                                 (void **)&test->files));
  for (size_t i = 0; i < count; i++)
    FG_TRY_EXIT(read_file(&r, &sources[i]));
  FG_TRY_EXIT(sort_directions(&r));
  FG_TRY_EXIT(gather_rows(&r, records));
exit:
  free(r.rows);
  free(r.last_time);
  free(r.last_cycle);
  return status;
}

void fg_load_records_free(fg_load_records *records) {
  free(records->begin);
  *records = (fg_load_records){0};
}
