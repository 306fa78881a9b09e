/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Temperature over time in the die. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/forming.h"

enum { BYTES_MAX = 1 << 20, POINTS_MAX = 10000 };

static fg_status allocate_schedule(fg_context *ctx, size_t count, fg_forming_schedule *schedule) {
  *schedule = (fg_forming_schedule){.count = count};
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *schedule->time_h, (void **)&schedule->time_h));
  schedule->temperature_C = schedule->time_h + count;
  return FG_OK;
}

fg_status fg_forming_schedule_hold(fg_context *ctx, double temperature_C, double hours,
                                   fg_forming_schedule *schedule) {
  FG_TRY(allocate_schedule(ctx, 2, schedule));
  schedule->temperature_C[0] = schedule->temperature_C[1] = temperature_C;
  schedule->time_h[1] = hours;
  return FG_OK;
}

static fg_status copy_schedule(fg_context *ctx, const fg_table *table,
                               fg_forming_schedule *schedule) {
  const fg_extended *time, *temperature;
  FG_TRY(fg_table_numbers(ctx, table, "time_h", &time));
  FG_TRY(fg_table_numbers(ctx, table, "temperature_C", &temperature));
  if (table->rows < 2 || table->rows > POINTS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "%s: %zu rows; a schedule has 2 to %d", table->source,
                   table->rows, POINTS_MAX);
  FG_TRY(allocate_schedule(ctx, table->rows, schedule));
  for (size_t i = 0; i < table->rows; i++) {
    schedule->time_h[i] = time[i].value;
    schedule->temperature_C[i] = temperature[i].value;
    if (i && !(time[i].value > time[i - 1].value))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: time_h is %g after %g; it must rise",
                     table->source, i + 1, time[i].value, time[i - 1].value);
    if (!(temperature[i].value > -273.15))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: row %zu: temperature_C is %g, below absolute zero: degrees Celsius",
                     table->source, i + 1, temperature[i].value);
  }
  return FG_OK;
}

fg_status fg_forming_schedule_load(fg_context *ctx, const char *path,
                                   fg_forming_schedule *schedule) {
  char *text = NULL;
  fg_table table = {0};
  FG_TRY(fg_file_read_text(ctx, path, BYTES_MAX, &text));
  fg_status status = fg_table_parse(ctx, path, text, strlen(text), &table);
  *schedule = (fg_forming_schedule){0};
  if (status == FG_OK) status = copy_schedule(ctx, &table, schedule);
  if (status == FG_OK) {
    fg_text_clip(schedule->file.path, sizeof schedule->file.path, "%s", path);
    fg_sha256_text(text, schedule->file.sha256);
  }
  if (status != FG_OK) fg_forming_schedule_free(schedule);
  fg_table_free(&table);
  free(text);
  return status;
}

void fg_forming_schedule_free(fg_forming_schedule *schedule) {
  free(schedule->time_h);
  *schedule = (fg_forming_schedule){0};
}
