/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Date of a lot: the manifest's column `date`, else the times of the scans' files. */
#ifndef FG_LOT_RUN_DATE_H
#define FG_LOT_RUN_DATE_H

#include "core/date.h"
#include "core/json_writer.h"
#include "lot/run/lot.h"

/* Column of the manifest that holds dates. */
#define FG_LOT_DATE_COLUMN "date"

typedef struct fg_lot_date {
  char first[FG_DATE_TEXT], last[FG_DATE_TEXT]; /* earliest and latest; "": unknown */
  const char *from; /* FG_LOT_DATE_MANIFEST or FG_LOT_DATE_SCANS; NULL: unknown */
} fg_lot_date;

#define FG_LOT_DATE_MANIFEST "manifest"
#define FG_LOT_DATE_SCANS    "scans"

/* Finds the dates. A column `date` with a cell that is no date is ignored. */
void fg_lot_date_find(const fg_lot *lot, fg_lot_date *date);

/* Returns a scan's date: the cell of that column, else the day of the scan's file. */
const char *fg_lot_date_of(const fg_lot *lot, size_t item);

/* Finds cells of that column that are no date. */
fg_lot_finding fg_lot_date_find_invalid(const fg_manifest *manifest);

#endif
