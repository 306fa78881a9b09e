/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of the newest check on the tab Scanner. */
#ifndef FG_STATION_CHECK_PAGE_H
#define FG_STATION_CHECK_PAGE_H

#include <stdio.h>

#include "station/sql.h"
#include "station/state.h"

/* Tone, sharpening and blur of the newest check beside its baseline, and where they have changed
 * the button that makes it the baseline. Nothing for checks without a state. */
fg_status fg_page_scanner_state(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                FILE *out);

#endif
