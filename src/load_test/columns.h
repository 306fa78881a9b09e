/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of a test's table or a break-away test's, by their names and units. */
#ifndef FG_LOAD_TEST_COLUMNS_H
#define FG_LOAD_TEST_COLUMNS_H

#include "foilgauge/load_test.h"
#include "foilgauge/table.h"

typedef enum fg_load_measured {
  FG_LOAD_AZIMUTH,
  FG_LOAD_FORCE,
  FG_LOAD_DISPLACEMENT,
  FG_LOAD_TIME,
  FG_LOAD_WEIGHT, /* of a break-away test, as are its force and torque */
  FG_LOAD_TORQUE,
  FG_LOAD_MEASURED,
} fg_load_measured;

typedef struct fg_load_columns {
  const fg_extended *number[FG_LOAD_MEASURED]; /* NULL: no such column */
  double scale[FG_LOAD_MEASURED];              /* to degrees, N, mm, s, N mm */
  const fg_column *cycle, *bearing, *pad;      /* NULL: no such column */
  char *not_read;                              /* names of unused columns; NULL: none; owned */
} fg_load_columns;

/* FG_ERR_DATA: a missing or duplicate column, a missing or unknown unit, a cell that is no number.
 * Time may be missing, azimuth too when `azimuth_said`. */
fg_status fg_load_columns_find(fg_context *ctx, const fg_table *table, bool azimuth_said,
                               fg_load_columns *columns);

/* As fg_load_columns_find, for a break-away test: the dead weight, and either the torque or the
 * force. */
fg_status fg_load_columns_find_break_away(fg_context *ctx, const fg_table *table,
                                          fg_load_columns *columns);

/* The cell as text; FG_ERR_DATA where it is empty. */
fg_status fg_load_columns_text(fg_context *ctx, const fg_table *table, const fg_column *column,
                               size_t row, char *text, size_t size);

#endif
