/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "film/stock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/text.h"
#include "foilgauge/memory.h"
#include "foilgauge/table.h"

bool fg_film_draws_from_lot(const fg_film_options *options) {
  struct stat found;
  if (options->stock) return true;
  return options->foils && stat(options->foils, &found) == 0 && S_ISDIR(found.st_mode);
}

/* Both tables of a lot, and the columns that are read; `part` and `stiffness` may be missing. */
typedef struct lot_tables {
  fg_table bumps, foils;
  const fg_column *scan, *number, *bump, *flags, *clearance, *stiffness, *part;
  const fg_column *foil_scan, *foil_number, *verdict;
} lot_tables;

static const char *cell_word(const fg_column *column, size_t row) {
  size_t word = column->word ? column->word[row] : FG_TABLE_NOT_A_WORD;
  return word < column->word_count ? column->words[word] : "";
}

static double cell_number(const fg_column *column, size_t row) {
  if (!column || (column->word && column->word[row] != FG_TABLE_NOT_A_WORD)) return NAN;
  return column->number[row].value;
}

static bool cells_agree(const fg_column *a, size_t row_a, const fg_column *b, size_t row_b) {
  const char *word = cell_word(a, row_a), *other = cell_word(b, row_b);
  if (*word || *other) return !strcmp(word, other);
  return cell_number(a, row_a) == cell_number(b, row_b);
}

static fg_status load_table(fg_context *ctx, const fg_film_report *r, const char *name,
                            fg_table *table, char sha256[65]) {
  char *path;
  FG_TRY(fg_text_print(ctx, &path, "%s/%s", r->options.foils, name));
  fg_status status = fg_table_load(ctx, path, table, sha256);
  free(path);
  return status;
}

static fg_status load_tables(fg_context *ctx, fg_film_report *r, lot_tables *t) {
  char unused[65];
  fg_context why_not;
  FG_TRY(load_table(ctx, r, "bumps.csv", &t->bumps, r->foils_sha256));
  FG_TRY(load_table(ctx, r, "foils.csv", &t->foils, unused));
  const struct {
    const fg_table *table;
    const char *name;
    const fg_column **column;
  } needed[] = {
      {&t->bumps, "scan", &t->scan},
      {&t->bumps, "foil_number", &t->number},
      {&t->bumps, "bump", &t->bump},
      {&t->bumps, "flags", &t->flags},
      {&t->bumps, "clearance_fitted_mm", &t->clearance},
      {&t->foils, "scan", &t->foil_scan},
      {&t->foils, "foil_number", &t->foil_number},
      {&t->foils, "verdict", &t->verdict},
  };
  for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
    FG_TRY(fg_table_find(ctx, needed[i].table, needed[i].name, needed[i].column));
  if (fg_table_find(&why_not, &t->bumps, "normalised_stiffness", &t->stiffness) != FG_OK)
    t->stiffness = NULL;
  if (fg_table_find(&why_not, &t->bumps, "foil", &t->part) != FG_OK) t->part = NULL;
  return FG_OK;
}

/* Reads the bumps of rows `from` up to `to` into the place behind the stock's last foil; false
 * where one is missing or crushed. */
static bool take_places(const fg_film_report *r, const lot_tables *t, size_t from, size_t to,
                        fg_film_stock *stock) {
  double *clearance = stock->clearance_mm + stock->foils * stock->places;
  double *stiffness = stock->stiffness + stock->foils * stock->places;
  size_t found = 0;
  for (size_t row = from; row < to; row++) {
    double place = cell_number(t->bump, row) - (double)r->options.first_bump;
    if (strstr(cell_word(t->flags, row), "crushed")) return false;
    if (!(place >= 0 && place < (double)stock->places)) continue;
    double stiff = cell_number(t->stiffness, row);
    clearance[(size_t)place] = cell_number(t->clearance, row);
    stiffness[(size_t)place] = isfinite(stiff) && stiff > 0 ? stiff : 1;
    if (isfinite(clearance[(size_t)place])) found++;
  }
  return found == stock->places;
}

/* The foil's verdict; both tables have the foils in the same order, so that `at` only advances. */
static bool fails(const lot_tables *t, size_t row, size_t *at) {
  while (*at < t->foils.rows && !(cells_agree(t->scan, row, t->foil_scan, *at) &&
                                  cells_agree(t->number, row, t->foil_number, *at)))
    ++*at;
  if (*at == t->foils.rows) return true;
  const char *verdict = cell_word(t->verdict, *at);
  return !strcmp(verdict, "fail") || !strcmp(verdict, "not_measured");
}

/* True where an earlier row has the same part and number: the part is scanned again. */
static bool is_scanned_again(const lot_tables *t, size_t row) {
  if (!t->part) return false;
  for (size_t i = 0; i < row; i++)
    if (cells_agree(t->part, i, t->part, row) && cells_agree(t->number, i, t->number, row) &&
        !cells_agree(t->scan, i, t->scan, row))
      return true;
  return false;
}

static void fill_stock(const fg_film_report *r, const lot_tables *t, fg_film_stock *stock) {
  size_t at = 0;
  for (size_t from = 0, to; from < t->bumps.rows; from = to) {
    for (to = from + 1; to < t->bumps.rows && cells_agree(t->scan, to, t->scan, from) &&
                        cells_agree(t->number, to, t->number, from);)
      to++;
    bool taken =
        !fails(t, from, &at) && !is_scanned_again(t, from) && take_places(r, t, from, to, stock);
    stock->foils += taken;
    stock->left_out += !taken;
  }
}

static fg_status read_stock(fg_context *ctx, fg_film_report *r, lot_tables *t,
                            fg_film_stock *stock) {
  void *block;
  size_t pads = r->options.pads ? r->options.pads : 1;
  FG_TRY(load_tables(ctx, r, t));
  /* A foil has a row at least. */
  FG_TRY(fg_memory_allocate(ctx, t->bumps.rows * stock->places, sizeof(double), &block));
  stock->clearance_mm = block;
  FG_TRY(fg_memory_allocate(ctx, t->bumps.rows * stock->places, sizeof(double), &block));
  stock->stiffness = block;
  fill_stock(r, t, stock);
  if (stock->foils >= pads) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: %zu foils can be built in, a bearing takes %zu different ones",
                 r->options.foils, stock->foils, pads);
}

fg_status fg_film_stock_read(fg_context *ctx, fg_film_report *report, fg_film_stock *stock) {
  lot_tables tables = {.scan = NULL};
  *stock = (fg_film_stock){.places = report->options.bumps_per_pad};
  fg_text_clip(report->foils_path, sizeof report->foils_path, "%s", report->options.foils);
  fg_status status = read_stock(ctx, report, &tables, stock);
  fg_table_free(&tables.bumps);
  fg_table_free(&tables.foils);
  if (status != FG_OK) fg_film_stock_free(stock);
  return status;
}

void fg_film_stock_free(fg_film_stock *stock) {
  free(stock->clearance_mm);
  free(stock->stiffness);
  *stock = (fg_film_stock){0};
}
