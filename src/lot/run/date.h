/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a lot was made: the manifest's column `date`, else the times of its scans' files. */
#ifndef FG_LOT_RUN_DATE_H
#define FG_LOT_RUN_DATE_H

#include "core/date.h"
#include "core/json_writer.h"
#include "lot/run/lot.h"

/* The column of a manifest. */
#define FG_LOT_DATE_COLUMN "date"

typedef struct fg_lot_date {
  char first[FG_DATE_TEXT], last[FG_DATE_TEXT]; /* "": not known; of both ends */
  const char *from; /* FG_LOT_DATE_MANIFEST, FG_LOT_DATE_SCANS; NULL: not known */
} fg_lot_date;

#define FG_LOT_DATE_MANIFEST "manifest"
#define FG_LOT_DATE_SCANS    "scans"

/* A column `date` in which a cell is no date is not taken. */
void fg_lot_date_find(const fg_lot *lot, fg_lot_date *date);

/* How many cells of that column are no date, and the first of them; 0, NULL: none. */
size_t fg_lot_date_wrong(const fg_manifest *manifest, const char **first);

#endif
