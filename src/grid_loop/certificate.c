/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/certificate.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "foilgauge/table.h"

enum { INDEX_MAX = 2000 };

/* Columns of the table; NULL: lines have none. */
typedef struct certificate_columns {
  const fg_extended *column, *row, *x, *y, *u;
  size_t count;
} certificate_columns;

static fg_status find_certificate_columns(fg_context *ctx, const fg_table *table, bool lines,
                                          certificate_columns *found) {
  *found = (certificate_columns){.count = table->rows};
  FG_TRY(fg_table_numbers(ctx, table, "column", &found->column));
  FG_TRY(fg_table_numbers(ctx, table, "x_mm", &found->x));
  FG_TRY(fg_table_numbers(ctx, table, "u_um", &found->u));
  if (lines) return FG_OK;
  FG_TRY(fg_table_numbers(ctx, table, "row", &found->row));
  return fg_table_numbers(ctx, table, "y_mm", &found->y);
}

static double number_at(const fg_extended *numbers, size_t i) {
  return numbers ? numbers[i].value : 0;
}

/* First index and number of them along one axis. */
static fg_status find_index_span(fg_context *ctx, const char *path, const fg_extended *numbers,
                                 size_t count, int *first, int *span) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    double index = number_at(numbers, i);
    if (index != round(index) || fabs(index) > INDEX_MAX)
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: an index is %g; it must be a whole number",
                     path, i + 1, index);
    low = fmin(low, index);
    high = fmax(high, index);
  }
  *first = (int)low;
  *span = (int)(high - low) + 1;
  return FG_OK;
}

static fg_status fill_places(fg_context *ctx, const char *path, const certificate_columns *table,
                             fg_grid_certificate *certificate) {
  int first[2];
  double square = 0, low = INFINITY, high = -INFINITY;
  FG_TRY(find_index_span(ctx, path, table->column, table->count, &first[0], &certificate->columns));
  FG_TRY(find_index_span(ctx, path, table->row, table->count, &first[1], &certificate->rows));
  size_t places = (size_t)certificate->columns * (size_t)certificate->rows;
  FG_TRY(fg_memory_allocate(ctx, places, sizeof *certificate->place_mm,
                            (void **)&certificate->place_mm));
  for (size_t k = 0; k < places; k++)
    certificate->place_mm[k] = (fg_point){NAN, NAN};
  for (size_t i = 0; i < table->count; i++) {
    size_t c = (size_t)(number_at(table->column, i) - first[0]);
    size_t r = (size_t)(number_at(table->row, i) - first[1]);
    double x = number_at(table->x, i), u_mm = number_at(table->u, i) / 1000;
    if (!(u_mm > 0))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: u_um is %g; it must be positive", path, i + 1,
                     1000 * u_mm);
    certificate->place_mm[r * (size_t)certificate->columns + c] =
        (fg_point){x, number_at(table->y, i)};
    square += u_mm * u_mm;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  certificate->u_scale = sqrt(square / (double)table->count) / (0.5 * (high - low));
  if (certificate->columns >= 3 && high > low) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: a certificate needs three columns of marks at least", path);
}

fg_status fg_grid_certificate_load(fg_context *ctx, const char *path, bool lines,
                                   fg_grid_certificate *certificate) {
  fg_table table = {0};
  char sha256[65];
  certificate_columns columns;
  *certificate = (fg_grid_certificate){0};
  FG_TRY(fg_table_load(ctx, path, &table, sha256));
  fg_status status = find_certificate_columns(ctx, &table, lines, &columns);
  if (status == FG_OK) status = fill_places(ctx, path, &columns, certificate);
  fg_table_free(&table);
  if (status != FG_OK) fg_grid_certificate_free(certificate);
  return status;
}

void fg_grid_certificate_free(fg_grid_certificate *certificate) {
  free(certificate->place_mm);
  *certificate = (fg_grid_certificate){0};
}

bool fg_grid_certificate_at(const fg_grid_certificate *certificate, const int index[2],
                            fg_point *place) {
  if (index[0] < 0 || index[1] < 0 || index[0] >= certificate->columns ||
      index[1] >= certificate->rows)
    return false;
  *place =
      certificate->place_mm[(size_t)index[1] * (size_t)certificate->columns + (size_t)index[0]];
  return isfinite(place->x);
}
