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
#include "foilgauge/calibration.h"

/* Of an fg_design; of an fg_gauge; of an fg_nominal, that of a foil with bumps. */
extern const fg_members fg_design_members, fg_gauge_members, fg_nominal_members;

/* Of an fg_calibration: as stated, and in a report with its derived values. They are definitions of
 * design.schema.json. */
extern const fg_members fg_calibration_members, fg_calibration_used_members;

/* Reads the row's fg_calibration; null: none is stated. */
fg_member_reader fg_calibration_read;
/* Writes a calibration, or the words "not needed" with their reason. */
void fg_calibration_write(fg_json *json, const char *name, const fg_calibration *calibration);
#define FG_CALIBRATION_WORDS                                                                       \
  "{\"type\": \"string\", \"pattern\": \"^(flatbed|not needed: ?[^ :].*)$\"}"

/* Of a design: state of traceability, and artefact. A definition of measure.schema.json. */
extern const fg_members fg_traceability_members;
#define FG_TRACEABILITY(function)                                                                  \
  FG_PART("traceability", function, &fg_traceability_members), .options = FG_MEMBER_NEVER_NULL,    \
                                                               .words = "what lengths rest on"

extern const fg_document fg_design_document, fg_nominal_document;

#endif
