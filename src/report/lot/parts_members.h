/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of parts of a lot's report; the whole of each subject is the fg_lot_analysis. */
#ifndef FG_REPORT_LOT_PARTS_MEMBERS_H
#define FG_REPORT_LOT_PARTS_MEMBERS_H

#include "core/member.h"
#include "lot/statistics/analysis.h"

/* Of an fg_lot_spread; of an fg_lot_budget_term; of an fg_lot_stiffness. */
extern const fg_members fg_lot_spread_members, fg_lot_budget_term_members, fg_lot_stiffness_members;

/* Of the fg_lot_assembly of drawn bearings; of an fg_assembly_share; of an fg_lot_change. */
extern const fg_members fg_lot_assembly_members, fg_lot_assembly_share_members,
    fg_lot_change_members;

/* Of the analysis: layout, bearings, clearances of all bumps. */
extern const fg_members fg_lot_bearing_members;

/* Of the analysis: "process"; of an fg_lot_quantity with a chart: the causes of its signals. */
extern const fg_members fg_lot_process_members, fg_lot_cause_members;

#endif
