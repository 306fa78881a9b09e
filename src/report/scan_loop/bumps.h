/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` in the report of the loop on scans. */
#ifndef FG_REPORT_SCAN_LOOP_BUMPS_H
#define FG_REPORT_SCAN_LOOP_BUMPS_H

#include <stdio.h>

#include "foilgauge/scan_result.h"

void fg_text_bumps(const fg_scan_result_bumps *bumps, FILE *out);
/* Writes the effects that are not claimed. */
void fg_text_bumps_rejected(const fg_scan_result_bumps *bumps, FILE *out);

#endif
