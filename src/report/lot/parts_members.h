/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of parts of a lot's report; the whole of each subject is the fg_lot_analysis. */
#ifndef FG_REPORT_LOT_PARTS_MEMBERS_H
#define FG_REPORT_LOT_PARTS_MEMBERS_H

#include "core/member.h"
#include "lot/statistics/analysis.h"

/* Of an fg_lot_spread; of an fg_lot_budget_term; of an fg_lot_stiffness. */
extern const fg_members fg_lot_spread_members, fg_lot_budget_term_members, fg_lot_stiffness_members;

#endif
