/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of a lot's JSON. */
#ifndef FG_REPORT_LOT_JSON_H
#define FG_REPORT_LOT_JSON_H

#include "core/json_writer.h"
#include "lot/statistics/analysis.h"

/* Writes the state of the process; and the causes of one quantity's signals. */
void fg_lot_json_process(fg_json *json, const fg_lot_analysis *analysis);
void fg_lot_json_cause(fg_json *json, const fg_lot_analysis *analysis,
                       const fg_lot_quantity *quantity);
void fg_lot_json_stiffness(fg_json *json, const fg_lot_analysis *analysis);

/* Writes the layout, every bearing, and the clearances of all bumps. */
void fg_lot_json_bearings(fg_json *json, const fg_lot_analysis *analysis);

/* Writes the bearings drawn from the lot's foils; nothing where the recipe asks for none. */
void fg_lot_json_assembly(fg_json *json, const fg_lot_analysis *analysis);

#endif
