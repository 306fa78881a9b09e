/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/table_remarks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"

enum { NAMED = 5 }; /* rows and names that are told; of more the number */

typedef struct remarks {
  fg_context *ctx;
  const fg_table *table;
  const char *response;
  char **said;
} remarks;

static bool is_numbers(const fg_table *table, const fg_column *column) {
  return column->number_count == table->rows && !column->uncertainty;
}

/* The numbers of a column in rising order. */
static void sort_numbers(const fg_table *table, const fg_column *column, double *value) {
  for (size_t i = 0; i < table->rows; i++)
    value[i] = column->number[i].value;
  fg_sort(value, table->rows);
}

static size_t count_distinct(const double *sorted, size_t count) {
  size_t distinct = count > 0;
  for (size_t i = 1; i < count; i++)
    distinct += sorted[i] != sorted[i - 1];
  return distinct;
}

/* ---- rows that are alike in every cell ---- */

typedef struct row_at {
  const fg_table *table;
  size_t row;
} row_at;

static int compare_cells(const row_at *a, const row_at *b) {
  for (size_t c = 0; c < a->table->columns; c++) {
    const fg_column *column = &a->table->column[c];
    size_t x = column->word ? column->word[a->row] : FG_TABLE_NOT_A_WORD;
    size_t y = column->word ? column->word[b->row] : FG_TABLE_NOT_A_WORD;
    if (x != y) return x < y ? -1 : 1;
    double u = column->number[a->row].value, v = column->number[b->row].value;
    if (x == FG_TABLE_NOT_A_WORD && u != v) return u < v ? -1 : 1;
  }
  return 0;
}

static int by_cells(const void *a, const void *b) {
  const row_at *x = a, *y = b;
  int order = compare_cells(x, y);
  return order ? order : (x->row > y->row) - (x->row < y->row);
}

/* True when hardly a value of some column recurs in rows that are no copies: rows alike in it, too,
 * are no repeats of a setting that came out the same. */
static bool rows_are_told_apart(const fg_table *table, size_t different, double *value) {
  for (size_t c = 0; c < table->columns; c++) {
    const fg_column *column = &table->column[c];
    size_t distinct = column->word_count;
    if (is_numbers(table, column)) {
      sort_numbers(table, column, value);
      distinct = count_distinct(value, table->rows);
    }
    if (20 * distinct >= 19 * different) return true;
  }
  return false;
}

static fg_status say_copies(const remarks *about, const row_at *rows, size_t copies) {
  size_t told = 0;
  FG_TRY(fg_text_append_remark(about->ctx, about->said, "rows "));
  for (size_t i = 1; i < about->table->rows && told < NAMED; i++) {
    if (compare_cells(&rows[i - 1], &rows[i])) continue;
    FG_TRY(fg_text_append(about->ctx, about->said, "%s%zu and %zu", told++ ? ", " : "",
                          rows[i - 1].row + 1, rows[i].row + 1));
  }
  if (copies > told)
    FG_TRY(fg_text_append(about->ctx, about->said, " and %zu more pairs", copies - told));
  return fg_text_append(about->ctx, about->said,
                        " are alike in every cell: take copies out, as every ± and p-value is too "
                        "small with them");
}

static fg_status remark_copies(const remarks *about, double *value) {
  const fg_table *table = about->table;
  row_at *rows = NULL;
  size_t copies = 0;
  FG_TRY(fg_memory_allocate(about->ctx, table->rows, sizeof *rows, (void **)&rows));
  for (size_t i = 0; i < table->rows; i++)
    rows[i] = (row_at){table, i};
  qsort(rows, table->rows, sizeof *rows, by_cells);
  for (size_t i = 1; i < table->rows; i++)
    copies += !compare_cells(&rows[i - 1], &rows[i]);
  fg_status status = FG_OK;
  if (copies && rows_are_told_apart(table, table->rows - copies, value))
    status = say_copies(about, rows, copies);
  free(rows);
  return status;
}

/* ---- values far from all others ---- */

/* Distance from all other values, in their range, from which on a value hardly belongs to them:
 * inches among millimetres, a point that slipped, -999 for a missing value. Settings by decades
 * stay below with four values beside the far one. */
#define FAR 10.0
enum { OTHERS_MIN = 4, FAR_SHARE = 10 };

static bool only_rises(const fg_table *table, const fg_column *column) {
  for (size_t i = 1; i < table->rows; i++)
    if (column->number[i].value < column->number[i - 1].value) return false;
  return true;
}

/* Returns the number of values that lie far above (sign 1) or below (-1) all others; 0: none. */
static size_t count_far(const double *sorted, size_t count, int sign) {
  for (size_t far = 1; far * FAR_SHARE <= count; far++) {
    const double *others = sign > 0 ? sorted : sorted + far;
    size_t others_count = count - far;
    double gap =
        sign > 0 ? sorted[others_count] - sorted[others_count - 1] : sorted[far] - sorted[far - 1];
    double range = others[others_count - 1] - others[0];
    if (range > 0 && gap > FAR * range && count_distinct(others, others_count) >= OTHERS_MIN)
      return far;
  }
  return 0;
}

static fg_status say_far(const remarks *about, const fg_column *column, const double *sorted,
                         size_t far, int sign) {
  size_t count = about->table->rows, told = 0;
  double low = sign > 0 ? sorted[0] : sorted[far];
  double high = sign > 0 ? sorted[count - far - 1] : sorted[count - 1];
  FG_TRY(fg_text_append_remark(about->ctx, about->said, "%s is ", column->name));
  for (size_t i = 0; i < count && told < NAMED; i++) {
    double value = column->number[i].value;
    if (value >= low && value <= high) continue;
    FG_TRY(fg_text_append(about->ctx, about->said, "%s%.6g in row %zu", told++ ? ", " : "", value,
                          i + 1));
  }
  if (far > told) FG_TRY(fg_text_append(about->ctx, about->said, " (and in %zu more)", far - told));
  return fg_text_append(
      about->ctx, about->said,
      ", and %.6g to %.6g in all others: if that is another unit, a slip or a code for a "
      "missing value, correct it, as it decides every trend over %s",
      low, high, column->name);
}

static fg_status remark_far(const remarks *about, const fg_column *column, double *value) {
  if (!is_numbers(about->table, column) || only_rises(about->table, column)) return FG_OK;
  sort_numbers(about->table, column, value);
  for (int sign = -1; sign <= 1; sign += 2) {
    size_t far = count_far(value, about->table->rows, sign);
    if (far) return say_far(about, column, value, far, sign);
  }
  return FG_OK;
}

/* ---- a response at the end of the gauge's range ---- */

enum { AT_END_MIN = 5, AT_END_SHARE = 10, AT_END_TIMES = 3 };

/* Rows with the lowest or the highest value; *repeats: rows of the value between that recurs most
 * often. */
static size_t count_at_end(const double *sorted, size_t count, bool highest, size_t *repeats) {
  double end = highest ? sorted[count - 1] : sorted[0];
  size_t at_end = 0, run = 0;
  *repeats = 1;
  for (size_t i = 0; i < count; i++) {
    if (sorted[i] == end) {
      at_end++;
      continue;
    }
    run = i && sorted[i] == sorted[i - 1] ? run + 1 : 1;
    if (run > *repeats) *repeats = run;
  }
  return at_end;
}

static fg_status remark_ends(const remarks *about, const fg_column *column, double *value) {
  size_t rows = about->table->rows, repeats;
  if (!is_numbers(about->table, column)) return FG_OK;
  sort_numbers(about->table, column, value);
  if (count_distinct(value, rows) < AT_END_MIN) return FG_OK;
  for (int highest = 0; highest <= 1; highest++) {
    size_t at_end = count_at_end(value, rows, highest, &repeats);
    if (at_end < AT_END_MIN || at_end * AT_END_SHARE < rows || at_end < AT_END_TIMES * repeats)
      continue;
    FG_TRY(fg_text_append_remark(
        about->ctx, about->said,
        "%s is %.6g, its %s value, in %zu of %zu rows: if the gauge ends there, they "
        "are limits and no values, which look like bends, interactions and "
        "a scatter that changes, and make every slope too small",
        column->name, highest ? value[rows - 1] : value[0], highest ? "highest" : "lowest", at_end,
        rows));
  }
  return FG_OK;
}

/* ---- words ---- */

enum { WORDS_COMPARED = 200 };

/* The same letters, whatever their case and the spaces, points, strokes and dashes among them. */
static bool is_same_name(const char *a, const char *b) {
  static const char ignored[] = " ._-/";
  for (;;) {
    a += strspn(a, ignored);
    b += strspn(b, ignored);
    if (!*a || !*b) return !*a && !*b;
    if (strncasecmp(a++, b++, 1)) return false;
  }
}

static bool has_letter(const char *word) {
  return strpbrk(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ") != NULL;
}

static fg_status remark_names(const remarks *about, const fg_column *column) {
  size_t told = 0;
  if (column->word_count > WORDS_COMPARED) return FG_OK;
  for (size_t i = 0; i < column->word_count; i++)
    for (size_t k = i + 1; k < column->word_count && told < NAMED; k++) {
      if (!has_letter(column->words[i]) || !is_same_name(column->words[i], column->words[k]))
        continue;
      const char *first = column->words[i], *second = column->words[k];
      FG_TRY(told++
                 ? fg_text_append(about->ctx, about->said, ", '%s' and '%s'", first, second)
                 : fg_text_append_remark(about->ctx, about->said, "'%s' and '%s'", first, second));
    }
  if (!told) return FG_OK;
  return fg_text_append(about->ctx, about->said,
                        " of %s count as different levels: write one name in one way",
                        column->name);
}

/* Returns the text behind the number that all words begin with, "" where there is none or it
 * differs. */
static const char *common_unit(const fg_column *column) {
  const char *unit = "";
  for (size_t i = 0; i < column->word_count; i++) {
    char *end;
    strtod(column->words[i], &end);
    if (end == column->words[i] || (i && strcmp(end, unit))) return "";
    unit = end;
  }
  return strpbrk(unit, "0123456789") ? "" : unit;
}

static fg_status remark_units(const remarks *about, const fg_column *column) {
  if (column->word_count < 2 || column->number_count || !*common_unit(column)) return FG_OK;
  return fg_text_append_remark(
      about->ctx, about->said,
      "%s holds words such as '%s', which count as levels: for a trend write the "
      "numbers alone, and the unit into the column's name",
      column->name, column->words[0]);
}

static fg_status remark_column(const remarks *about, const fg_column *column, double *value) {
  if (about->response && !strcmp(column->name, about->response))
    return remark_ends(about, column, value);
  FG_TRY(remark_far(about, column, value));
  FG_TRY(remark_names(about, column));
  return remark_units(about, column);
}

fg_status fg_table_remark(fg_context *ctx, const fg_table *table, const char *response,
                          char **said) {
  const remarks about = {ctx, table, response, said};
  double *value = NULL;
  if (table->rows < 2) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, table->rows, sizeof *value, (void **)&value));
  fg_status status = remark_copies(&about, value);
  for (size_t c = 0; status == FG_OK && c < table->columns; c++)
    status = remark_column(&about, &table->column[c], value);
  free(value);
  return status;
}
