/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` in the report of the loop on scans. */
#ifndef FG_REPORT_SCAN_LOOP_BUMPS_H
#define FG_REPORT_SCAN_LOOP_BUMPS_H

#include "core/json_writer.h"
#include "foilgauge/scan_result.h"

/* Into the open arrays `claims` and `rejected`. */
void fg_json_bump_claims(fg_json *json, const fg_scan_result_bumps *bumps);
void fg_json_bump_rejected(fg_json *json, const fg_scan_result_bumps *bumps);
/* The member `unattributed`; false, and nothing written, where the bumps leave no curve. */
bool fg_json_bump_curve(fg_json *json, const fg_scan_result_bumps *bumps);
/* The member `bumps`. */
void fg_json_bumps(fg_json *json, const fg_scan_result_bumps *bumps);

void fg_text_bumps(const fg_scan_result_bumps *bumps, FILE *out);
/* What is not claimed. */
void fg_text_bumps_rejected(const fg_scan_result_bumps *bumps, FILE *out);

#endif
