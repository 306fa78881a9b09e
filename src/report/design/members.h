/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a design, of its nominal values and of its calibration: the rows that read them, write
 * them, and make their schemas and the manual's lists.
 *
 * Another report refers to the file's schema:
 *   {FG_OBJECT("design", fg_die, design, &fg_design_members),
 *    .schema = FG_REF("design.schema.json")} */
#ifndef FG_REPORT_DESIGN_MEMBERS_H
#define FG_REPORT_DESIGN_MEMBERS_H

#include "core/member.h"
#include "core/member_read.h"

/* Of an fg_design; of an fg_gauge; of an fg_nominal, that of a foil with bumps. */
extern const fg_members fg_design_members, fg_gauge_members, fg_nominal_members;

/* Of an fg_calibration: as stated, and in a report with its derived values. They are definitions of
 * design.schema.json. */
extern const fg_members fg_calibration_members, fg_calibration_used_members;

/* Reads the row's fg_calibration; null: none is stated. */
fg_member_reader fg_calibration_read;

extern const fg_document fg_design_document, fg_nominal_document;

#endif
