/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a search for causes: means of foils that are alike. */
#ifndef FG_STATION_CAUSE_ROWS_H
#define FG_STATION_CAUSE_ROWS_H

#include "foilgauge/loop_table.h"
#include "station/cause.h"

enum { FG_CAUSE_EFFECTS = 24 };

/* Names of the table's columns of the response and of the groups. */
#define FG_CAUSE_VALUE "#value"
#define FG_CAUSE_GROUP "#group"

/* One of the two searches. */
typedef struct fg_cause_pass {
  const fg_cause_data *data;
  double *value;         /* foils: measured, without the causes found before */
  size_t *cell, cells;   /* of each foil its row */
  size_t *group, groups; /* of each foil; NULL: rows are independent */
  bool within, between;  /* columns that are sought */
  fg_loop_effect effects[FG_CAUSE_EFFECTS];
  size_t first; /* row from which on cells are used: the newest ROWS_MAX */
} fg_cause_pass;

/* Makes days the rows, split where a lot or a column that stays for days changes; pass->cell is
 * then the caller's to free. */
fg_status fg_cause_split_days(fg_context *ctx, fg_cause_pass *pass);
/* Split rows further by two hours, and by columns of words. */
fg_status fg_cause_split_hours(fg_context *ctx, fg_cause_pass *pass);
fg_status fg_cause_split_columns(fg_context *ctx, fg_cause_pass *pass, bool within);

/* Fills a table with the newest rows and the columns that are sought. */
fg_status fg_cause_table(fg_context *ctx, fg_cause_pass *pass, fg_table *table);

#endif
