/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a lot's JSON share. */
#ifndef FG_REPORT_LOT_JSON_H
#define FG_REPORT_LOT_JSON_H

#include "core/json_writer.h"
#include "lot/statistics/analysis.h"

void fg_lot_json_spread(fg_json *json, const char *name, const fg_lot_spread *spread);
/* Whether the process runs as it did; and what one quantity's signals come from. */
void fg_lot_json_process(fg_json *json, const fg_lot_analysis *analysis);
void fg_lot_json_cause(fg_json *json, const fg_lot_analysis *analysis,
                       const fg_lot_quantity *quantity);
void fg_lot_json_stiffness(fg_json *json, const fg_lot_analysis *analysis);

/* Where bumps lie around a bearing, every bearing, the clearances of all bumps. */
void fg_lot_json_bearings(fg_json *json, const fg_lot_analysis *analysis);

/* Bearings drawn from the lot's foils; nothing where the recipe asks for none. */
void fg_lot_json_assembly(fg_json *json, const fg_lot_analysis *analysis);

#endif
