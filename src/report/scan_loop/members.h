/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of the report of the loop on scans, "foilgauge/loop/1" of the domain "scan". */
#ifndef FG_REPORT_SCAN_LOOP_MEMBERS_H
#define FG_REPORT_SCAN_LOOP_MEMBERS_H

#include "core/member.h"
#include "foilgauge/scan_result.h"

/* Whole of every subject. */
typedef struct fg_scan_report {
  const fg_scan_result *result;
  const char *sentence; /* summary; of JSON alone, as are those below */
  fg_context *ctx;
  fg_status *status; /* first failure */
} fg_scan_report;

static inline const fg_scan_result *fg_scan_result_of(const fg_subject *subject) {
  return ((const fg_scan_report *)subject->whole)->result;
}

/* Of fg_scan_result_scan. */
extern const fg_members fg_scan_input_members;
fg_member_element fg_scan_find_input;

/* Of a side, before or after the correction. */
extern const fg_members fg_scan_side_members;
fg_subject fg_scan_find_before(const fg_subject *subject);
fg_subject fg_scan_find_after(const fg_subject *subject);
/* Errors of both sides beside each other, of page and terminal. */
extern const fg_members fg_scan_error_members;
fg_member_element fg_scan_find_error;

/* Claims and rejected effects: those of the rows have the index 0, those of response r of the
 * bumps r + 1. A list has both kinds, and a table of the page or of the terminal one. */
extern const fg_members fg_scan_claim_members, fg_scan_rejected_members;
fg_member_element fg_scan_find_claim, fg_scan_find_rejected;

/* The unexplained curve; object NULL: none. */
extern const fg_members fg_scan_curve_members;
fg_subject fg_scan_find_curve(const fg_subject *result);

/* Of fg_scan_result_bumps; of its responses and the height, where page and terminal show them. */
extern const fg_members fg_scan_bumps_members, fg_scan_response_members;
fg_member_element fg_scan_find_judged;

extern const fg_document fg_scan_loop_document;

#endif
