/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a lot's report; the whole of each subject is the fg_lot_analysis. */
#ifndef FG_REPORT_LOT_MEMBERS_H
#define FG_REPORT_LOT_MEMBERS_H

#include "core/member.h"
#include "lot/statistics/analysis.h"

/* Tables of the page that show quantities; the index of their list. */
typedef enum fg_lot_quantity_table { FG_LOT_VALUES, FG_LOT_MEAN_U } fg_lot_quantity_table;

/* Of an fg_lot_foil; of an fg_lot_quantity, and its capability; of an fg_lot_difference; of an
 * fg_lot_gauge; of an fg_lot_die_sum; of an fg_lot_dies. */
extern const fg_members fg_lot_foil_members, fg_lot_quantity_members, fg_lot_capability_members,
    fg_lot_difference_members, fg_lot_gauge_members, fg_lot_die_sum_members, fg_lot_dies_members;

extern const fg_document fg_lot_document;

/* True of subjects whose lot has such parts: beams of a cantilever, bumps of every other kind. */
bool fg_lot_has_beams(const fg_subject *subject);
bool fg_lot_has_no_beams(const fg_subject *subject);
/* An fg_traceability, by the subject's whole. */
int fg_lot_traceability(const fg_subject *subject);

#endif
