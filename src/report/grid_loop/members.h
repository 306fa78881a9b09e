/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FG_REPORT_GRID_LOOP_MEMBERS_H
#define FG_REPORT_GRID_LOOP_MEMBERS_H

#include "core/member.h"
#include "foilgauge/grid_loop.h"

extern const fg_members fg_grid_claim_members;
extern const fg_members fg_grid_scan_members;
extern const fg_members fg_grid_held_out_members;
/* whole: the result */
fg_member_element fg_grid_loop_find_claim, fg_grid_loop_find_scan, fg_grid_loop_find_held_out;

extern const fg_document fg_grid_loop_document;

#endif
