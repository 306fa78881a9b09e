/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` in the report of the loop on scans. */
#ifndef FG_REPORT_SCAN_LOOP_BUMPS_H
#define FG_REPORT_SCAN_LOOP_BUMPS_H

#include "core/json_writer.h"
#include "foilgauge/scan_result.h"

/* Writes into the open arrays `claims` and `rejected`. */
void fg_json_bump_claims(fg_json *json, const fg_scan_result_bumps *bumps);
void fg_json_bump_rejected(fg_json *json, const fg_scan_result_bumps *bumps);
/* Writes the member `unattributed`; returns false, and writes nothing, when the bumps have no such
 * curve. */
bool fg_json_bump_curve(fg_json *json, const fg_scan_result_bumps *bumps);
/* Writes the member `bumps`. */
void fg_json_bumps(fg_json *json, const fg_scan_result_bumps *bumps);

void fg_text_bumps(const fg_scan_result_bumps *bumps, FILE *out);
/* Writes the effects that are not claimed. */
void fg_text_bumps_rejected(const fg_scan_result_bumps *bumps, FILE *out);

#endif
