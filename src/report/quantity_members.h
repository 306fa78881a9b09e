/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of quantities (foilgauge/quantity.h) as members of reports.
 *
 * A table of members takes all rows of an owner by one row of its own:
 *
 *   {FG_SAME_BY(fg_bump_quantity_at)},
 *
 * whose subject is the owner's struct. Groups of a foil ("overall.") are objects of their own, with
 * the same subject: {FG_GROUP("overall", &rows)}, rows: {FG_SAME_BY(fg_overall_quantity_at)}.
 */
#ifndef FG_REPORT_QUANTITY_MEMBERS_H
#define FG_REPORT_QUANTITY_MEMBERS_H

#include "core/member.h"
#include "foilgauge/quantity.h"

/* Makes the member of a quantity, without the name of its group. */
fg_member fg_quantity_member(const fg_quantity *quantity);

/* Functions of FG_SAME_BY. A foil's are those without a group; a flat foil's those that its kind
 * has. */
bool fg_foil_quantity_at(size_t i, fg_member *row);
bool fg_flat_foil_quantity_at(size_t i, fg_member *row);
bool fg_overall_quantity_at(size_t i, fg_member *row);
bool fg_arc_quantity_at(size_t i, fg_member *row);
bool fg_correction_quantity_at(size_t i, fg_member *row); /* its subject is an fg_correction */
bool fg_bump_quantity_at(size_t i, fg_member *row);
bool fg_beam_quantity_at(size_t i, fg_member *row);
bool fg_disc_quantity_at(size_t i, fg_member *row);
bool fg_strip_quantity_at(size_t i, fg_member *row);
bool fg_bearing_quantity_at(size_t i, fg_member *row);

#endif
