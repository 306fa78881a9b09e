/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/run/date.h"

#include <math.h>
#include <string.h>

#include "core/text.h"

typedef struct span {
  double first, last; /* days; NaN: none yet */
} span;

static void widen_span(span *days, double day) {
  days->first = fmin(days->first, day); /* fmin and fmax pass over a NaN */
  days->last = fmax(days->last, day);
}

/* Returns false when the column is missing, is empty, or has a cell that is no date. */
static bool date_by_manifest(const fg_manifest *manifest, span *days) {
  size_t column = fg_manifest_column(manifest, FG_LOT_DATE_COLUMN);
  if (column == FG_NO_COLUMN) return false;
  for (size_t i = 0; i < manifest->items; i++) {
    const char *cell = fg_manifest_cell(manifest, i, column);
    double day = fg_date_days(cell);
    if (*cell && !isfinite(day)) return false;
    widen_span(days, day);
  }
  return isfinite(days->first);
}

fg_lot_finding fg_lot_date_find_invalid(const fg_manifest *manifest) {
  size_t column = fg_manifest_column(manifest, FG_LOT_DATE_COLUMN);
  fg_lot_finding invalid = {.count = 0};
  for (size_t i = 0; column != FG_NO_COLUMN && i < manifest->items; i++) {
    const char *cell = fg_manifest_cell(manifest, i, column);
    if (!*cell || isfinite(fg_date_days(cell))) continue;
    if (invalid.count++ == 0) fg_text_clip(invalid.first, sizeof invalid.first, "%s", cell);
  }
  return invalid;
}

static bool date_by_scans(const fg_lot *lot, span *days) {
  for (size_t i = 0; i < lot->manifest.items; i++)
    widen_span(days, fg_date_days(lot->records[i].date));
  return isfinite(days->first);
}

const char *fg_lot_date_of(const fg_lot *lot, size_t item) {
  size_t column = fg_manifest_column(&lot->manifest, FG_LOT_DATE_COLUMN);
  return column == FG_NO_COLUMN ? lot->records[item].date
                                : fg_manifest_cell(&lot->manifest, item, column);
}

void fg_lot_date_find(const fg_lot *lot, fg_lot_date *date) {
  span manifest = {NAN, NAN}, scans = {NAN, NAN};
  *date = (fg_lot_date){.from = NULL};
  if (date_by_manifest(&lot->manifest, &manifest))
    date->from = FG_LOT_DATE_MANIFEST;
  else if (date_by_scans(lot, &scans))
    date->from = FG_LOT_DATE_SCANS;
  else
    return;
  const span *days = !strcmp(date->from, FG_LOT_DATE_MANIFEST) ? &manifest : &scans;
  fg_date_format(days->first, date->first);
  fg_date_format(days->last, date->last);
}
