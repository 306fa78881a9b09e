/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lot as a table for the loop: one measured quantity beside the manifest's columns, and no other
 * results.
 *
 * A row per bump (a response of bumps) or per foil, in the manifest's order. Columns: `foil` (its
 * name, where rows share one), those of the manifest, `foil_number` where a scan holds several,
 * `bump`, and the response. Crushed bumps and foils not of the design are left out, as in the
 * lot's statistics. */
#ifndef FOILGAUGE_LOT_TABLE_H
#define FOILGAUGE_LOT_TABLE_H

#include "foilgauge/lot.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_lot_table_options {
  const char *quantity;       /* quantity of bumps or of foils: "radius_mm", "overall.radius_mm" */
  bool with_radius;           /* adds the bumps' radius_mm, for constant arc length */
  const char *const *without; /* columns of the manifest to leave out */
  size_t withouts;
} fg_lot_table_options;

typedef struct fg_lot_table {
  fg_table table;
  const char *group; /* "foil": rows of a foil share it; NULL: every row is a foil of its own */
  char **name;       /* table.rows: "foil 17, bump 3" */
  size_t names;
  fg_design design; /* design of the lot */
  /* Files of the lot that the table was made from, results.jsonl first. */
  char *path[3], sha256[3][65];
  char *said; /* rows left out and columns made numbers, in words; NULL: none */
} fg_lot_table;

/* FG_ERR_DATA: the folder holds no whole lot; no reported quantity of that name; a column of the
 * manifest that fg_table_check refuses; no value at all. Free with fg_lot_table_free. */
fg_status fg_lot_table_read(fg_context *ctx, const char *folder,
                            const fg_lot_table_options *options, fg_lot_table *out);
void fg_lot_table_free(fg_lot_table *table);

#ifdef __cplusplus
}
#endif
#endif
