/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/cause_data.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "core/text.h"

/* WITHIN_DAYS: a column varies within days when a day has more than so many levels of it on
 * average. KNOWN_SHARE: a context's column counts when it knows so large a share of the foils. */
#define WITHIN_DAYS 1.5
#define KNOWN_SHARE 0.9
enum { MS_OF_DAY = 86400000, LEVELS_MAX = FG_LOOP_COLUMNS };

static const char *const word_columns[] = {"die",     "coil",   "oven",  "operator",  "scanner",
                                           "program", "recipe", "model", FG_CAUSE_LOT};
enum { WORD_COLUMNS = sizeof word_columns / sizeof *word_columns };

/* Each foil's mean of the quantity, without crushed bumps, as in charts. */
#define COLUMNS                                                                                    \
  " scans.at, foils.serial, foils.die, foils.coil, foils.oven, foils.operator, foils.scanner,"     \
  " setups.program, (SELECT min(s.id) FROM setups AS s WHERE s.recipe = setups.recipe),"           \
  " substr(coalesce(setups.model_sha256, ''), 1, 8), foils.lot FROM"
static const char of_choice[] =
    "SELECT foils.id, each.value," COLUMNS
    " (SELECT measured.foil AS foil, avg(value) AS value FROM measured WHERE quantity = ?1 AND"
    " value IS NOT NULL AND (?2 = 0 OR bump = ?2) AND (measured.foil, bump) NOT IN (SELECT foil,"
    " number FROM bumps WHERE flags <> '' AND instr(flags, 'crushed')) GROUP BY measured.foil) AS"
    " each JOIN foils ON foils.id = each.foil JOIN scans ON scans.id = foils.scan JOIN setups ON"
    " setups.id = scans.setup WHERE (?3 = '' OR foils.lot = ?3) AND (?4 = '' OR foils.die = ?4)"
    " AND" FG_NEWEST_SCAN_OF_FOIL " ORDER BY foils.id";
static const char of_range[] =
    "SELECT foils.id, 0," COLUMNS
    " foils JOIN scans ON scans.id = foils.scan JOIN setups ON setups.id = scans.setup WHERE"
    " foils.id BETWEEN ?1 AND ?2 ORDER BY foils.id";

double fg_cause_days(int64_t at) {
  time_t seconds = (time_t)(at / 1000);
  struct tm local;
  double offset = localtime_r(&seconds, &local) ? (double)local.tm_gmtoff * 1000 : 0;
  return ((double)at + offset) / MS_OF_DAY;
}

static fg_status find_level(fg_context *ctx, fg_cause_column *column, const char *word,
                            size_t *capacity, size_t *level) {
  for (*level = 0; *level < column->levels; ++*level)
    if (!strcmp(column->level_name[*level], word)) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, column->levels + 1, sizeof *column->level_name, capacity,
                           (void **)&column->level_name));
  FG_TRY(fg_text_print(ctx, &column->level_name[column->levels], "%s", word));
  column->levels++;
  return FG_OK;
}

typedef struct cause_reading {
  fg_cause_data *data;
  const int64_t *only; /* foils that are wanted, sorted; NULL: all */
  size_t only_count, next;
  size_t room, level_room[WORD_COLUMNS];
} cause_reading;

/* Grows all arrays of foils together. */
static fg_status reserve_foil(fg_context *ctx, cause_reading *reading) {
  fg_cause_data *data = reading->data;
  size_t needed = data->foils + 1, room;
  if (needed <= reading->room) return FG_OK;
  size_t wanted = 2 * reading->room + 256;
  struct {
    void **block;
    size_t size;
  } blocks[] = {{(void **)&data->foil, sizeof *data->foil},
                {(void **)&data->at, sizeof *data->at},
                {(void **)&data->value, sizeof *data->value},
                {(void **)&data->serial, sizeof *data->serial}};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
    room = reading->room;
    FG_TRY(fg_memory_reserve(ctx, wanted, blocks[i].size, &room, blocks[i].block));
  }
  for (size_t i = 0; i < WORD_COLUMNS; i++) {
    room = reading->room;
    FG_TRY(fg_memory_reserve(ctx, wanted, sizeof(size_t), &room, (void **)&data->column[i].level));
  }
  reading->room = wanted;
  return FG_OK;
}

/* Only foils that are wanted; both lists are in order. */
static bool is_wanted(cause_reading *reading, int64_t foil) {
  if (!reading->only) return true;
  while (reading->next < reading->only_count && reading->only[reading->next] < foil)
    reading->next++;
  return reading->next < reading->only_count && reading->only[reading->next] == foil;
}

static fg_status read_foil(fg_context *ctx, const fg_query *query, cause_reading *reading) {
  fg_cause_data *data = reading->data;
  if (!is_wanted(reading, fg_query_get_integer(query, 0))) return FG_OK;
  FG_TRY(reserve_foil(ctx, reading));
  size_t i = data->foils;
  data->foil[i] = fg_query_get_integer(query, 0);
  data->value[i] = fg_query_get_number(query, 1);
  data->at[i] = fg_query_get_integer(query, 2);
  FG_TRY(fg_text_print(ctx, &data->serial[i], "%s", fg_query_get_text(query, 3)));
  data->foils++;
  for (size_t c = 0; c < WORD_COLUMNS; c++)
    FG_TRY(find_level(ctx, &data->column[c], fg_query_get_text(query, (int)c + 4),
                      &reading->level_room[c], &data->column[c].level[i]));
  return FG_OK;
}

static fg_status read_foils(fg_context *ctx, fg_query *query, cause_reading *reading) {
  fg_status status = FG_OK;
  for (size_t c = 0; c < WORD_COLUMNS; c++) {
    reading->data->column[c].words = true;
    strcpy(reading->data->column[c].name, word_columns[c]);
  }
  reading->data->columns = WORD_COLUMNS;
  while (status == FG_OK && fg_query_row(query))
    status = read_foil(ctx, query, reading);
  fg_status ended = fg_query_end(ctx, query, "reading the foils");
  return status == FG_OK ? ended : status;
}

static fg_status add_number_column(fg_context *ctx, fg_cause_data *data, const char *name,
                                   fg_cause_column **column) {
  *column = &data->column[data->columns];
  **column = (fg_cause_column){0};
  fg_text_clip((*column)->name, FG_CAUSE_NAME, "%s", name);
  FG_TRY(fg_memory_allocate(ctx, data->foils, sizeof(double), (void **)&(*column)->number));
  data->columns++;
  return FG_OK;
}

/* Days, times and hours of the foils. A day of the list begins at local midnight. */
static fg_status add_times(fg_context *ctx, fg_cause_data *data) {
  fg_cause_column *when, *hour;
  FG_TRY(add_number_column(ctx, data, FG_CAUSE_TIME, &when));
  FG_TRY(add_number_column(ctx, data, FG_CAUSE_HOUR, &hour));
  FG_TRY(fg_memory_allocate(ctx, data->foils, sizeof *data->day, (void **)&data->day));
  for (size_t i = 0; i < data->foils; i++) {
    when->number[i] = fg_cause_days(data->at[i]);
    hour->number[i] = 24 * (when->number[i] - floor(when->number[i]));
    bool same = i && floor(when->number[i]) == floor(when->number[i - 1]);
    data->day[i] = i ? data->day[i - 1] + !same : 0;
  }
  data->days = data->foils ? data->day[data->foils - 1] + 1 : 0;
  hour->within_days = true;
  return FG_OK;
}

/* A context's column becomes words when any of its cells is one. */
static fg_status add_context_column(fg_context *ctx, const fg_station_context *context, size_t k,
                                    fg_cause_data *data) {
  const fg_column *cells = &context->table.column[k];
  fg_cause_column *column;
  size_t known = 0, room = 0;
  char number[32];
  FG_TRY(add_number_column(ctx, data, cells->name, &column));
  column->words = cells->word_count > 0;
  if (column->words)
    FG_TRY(fg_memory_allocate(ctx, data->foils, sizeof(size_t), (void **)&column->level));
  for (size_t i = 0; i < data->foils; i++) {
    fg_context_value value =
        fg_station_context_value(context, k, data->serial[i], fg_cause_days(data->at[i]));
    known += value.word || isfinite(value.number);
    column->number[i] = value.number;
    if (!column->words) continue;
    snprintf(number, sizeof number, "%.10g", value.number);
    const char *word = value.word ? value.word : isfinite(value.number) ? number : "";
    FG_TRY(find_level(ctx, column, word, &room, &column->level[i]));
  }
  if ((double)known >= KNOWN_SHARE * (double)data->foils) return FG_OK;
  size_t length = strlen(data->left_out);
  fg_text_clip(data->left_out + length, sizeof data->left_out - length,
               "%s%s: known of %zu of %zu foils", length ? "; " : "", column->name, known,
               data->foils);
  column->levels = 0; /* dropped below */
  column->words = true;
  return FG_OK;
}

static fg_status add_contexts(fg_context *ctx, const fg_station_contexts *contexts,
                              fg_cause_data *data) {
  for (size_t f = 0; f < contexts->count; f++)
    for (size_t k = 0; k < contexts->one[f].table.columns; k++) {
      const char *name = contexts->one[f].table.column[k].name;
      if (k == contexts->one[f].key || data->columns == FG_CAUSE_COLUMNS) continue;
      if (fg_cause_column_find(data, name)) continue;
      FG_TRY(add_context_column(ctx, &contexts->one[f], k, data));
    }
  return FG_OK;
}

static void free_cause_column(fg_cause_column *column) {
  for (size_t i = 0; column->level_name && i < column->levels; i++)
    free(column->level_name[i]);
  free(column->level_name);
  free(column->level);
  free(column->number);
}

static bool varies(const fg_cause_data *data, const fg_cause_column *column) {
  if (column->words) return column->levels > 1 && column->levels <= LEVELS_MAX;
  for (size_t i = 1; i < data->foils; i++)
    if (column->number[i] != column->number[0]) return true;
  return false;
}

/* The lot becomes a level of its own, and no candidate; columns that do not vary are dropped. */
static void sort_columns(fg_cause_data *data) {
  size_t kept = 0;
  for (size_t c = 0; c < data->columns; c++) {
    fg_cause_column column = data->column[c];
    bool is_lot = c < WORD_COLUMNS && !strcmp(column.name, FG_CAUSE_LOT);
    if (is_lot) {
      data->lot = column.level;
      data->lots = column.levels;
      column.level = NULL;
    }
    if (!is_lot && varies(data, &column))
      data->column[kept++] = column;
    else
      free_cause_column(&column);
  }
  data->columns = kept;
}

/* Finds whether days have more than one value of a column. */
static fg_status note_within_days(fg_context *ctx, const fg_cause_data *data,
                                  fg_cause_column *column) {
  size_t *seen, pairs = 0;
  if (!column->words) {
    for (size_t i = 1; i < data->foils && strcmp(column->name, FG_CAUSE_TIME) != 0; i++)
      pairs += data->day[i] == data->day[i - 1] && column->number[i] != column->number[i - 1];
    column->within_days = 2 * pairs > data->foils;
    return FG_OK;
  }
  FG_TRY(fg_memory_allocate(ctx, column->levels, sizeof *seen, (void **)&seen));
  for (size_t i = 0; i < data->foils; i++) {
    size_t mark = data->day[i] + 1;
    pairs += seen[column->level[i]] != mark;
    seen[column->level[i]] = mark;
  }
  free(seen);
  column->within_days = (double)pairs > WITHIN_DAYS * (double)data->days;
  return FG_OK;
}

/* Foils of which a number is not known take the mean of the others: they tell nothing of it. */
static void fill_numbers(const fg_cause_data *data, fg_cause_column *column) {
  double sum = 0;
  size_t known = 0;
  if (column->words) return;
  for (size_t i = 0; i < data->foils; i++)
    if (isfinite(column->number[i])) sum += column->number[i], known++;
  for (size_t i = 0; i < data->foils; i++)
    if (!isfinite(column->number[i])) column->number[i] = known ? sum / (double)known : 0;
}

static fg_status complete_data(fg_context *ctx, const fg_station_contexts *contexts,
                               fg_cause_data *data) {
  FG_TRY(add_times(ctx, data));
  FG_TRY(add_contexts(ctx, contexts, data));
  for (size_t c = 0; c < data->columns; c++)
    fill_numbers(data, &data->column[c]);
  sort_columns(data);
  for (size_t c = 0; c < data->columns; c++)
    FG_TRY(note_within_days(ctx, data, &data->column[c]));
  return FG_OK;
}

fg_status fg_cause_data_read(fg_context *ctx, sqlite3 *reader, const fg_station_contexts *contexts,
                             const fg_trend_choice *choice, fg_cause_data *data) {
  fg_query query;
  int64_t quantity;
  *data = (fg_cause_data){0};
  cause_reading reading = {.data = data};
  FG_TRY(fg_trend_find_quantity(ctx, reader, choice, &quantity));
  fg_query_begin(reader, of_choice, &query);
  fg_query_integer(&query, quantity);
  fg_query_integer(&query, choice->bump);
  fg_query_text(&query, choice->lot);
  fg_query_text(&query, choice->die);
  fg_status status = read_foils(ctx, &query, &reading);
  if (status == FG_OK) status = complete_data(ctx, contexts, data);
  if (status != FG_OK) fg_cause_data_free(data);
  return status;
}

fg_status fg_cause_data_of_foils(fg_context *ctx, sqlite3 *reader,
                                 const fg_station_contexts *contexts, const int64_t *foil,
                                 size_t count, fg_cause_data *data) {
  fg_query query;
  *data = (fg_cause_data){0};
  cause_reading reading = {.data = data, .only = foil, .only_count = count};
  fg_query_begin(reader, of_range, &query);
  fg_query_integer(&query, count ? foil[0] : 0);
  fg_query_integer(&query, count ? foil[count - 1] : 0);
  fg_status status = read_foils(ctx, &query, &reading);
  if (status == FG_OK) status = add_times(ctx, data);
  if (status == FG_OK) status = add_contexts(ctx, contexts, data);
  if (status != FG_OK) fg_cause_data_free(data);
  return status;
}

void fg_cause_data_free(fg_cause_data *data) {
  for (size_t i = 0; i < data->columns; i++)
    free_cause_column(&data->column[i]);
  for (size_t i = 0; data->serial && i < data->foils; i++)
    free(data->serial[i]);
  free(data->serial);
  free(data->foil);
  free(data->at);
  free(data->value);
  free(data->day);
  free(data->lot);
  *data = (fg_cause_data){0};
}

const fg_cause_column *fg_cause_column_find(const fg_cause_data *data, const char *name) {
  for (size_t c = 0; c < data->columns; c++)
    if (!strcmp(data->column[c].name, name)) return &data->column[c];
  return NULL;
}
