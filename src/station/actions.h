/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a form asks for: the answer sends the browser on, or carries a file. */
#ifndef FG_STATION_ACTIONS_H
#define FG_STATION_ACTIONS_H

#include "station/request.h"

typedef fg_status fg_action(fg_context *ctx, fg_inspection *station, const fg_request *request,
                            fg_answer *answer);

fg_action fg_action_correct;  /* serial, lot, die, operator of a foil; leaves a trail */
fg_action fg_action_scan;     /* runs the recipe's scan_command */
fg_action fg_action_baseline; /* the newest check: what later ones are compared with */
fg_action fg_action_close;    /* a lot: writes its folder and report */
fg_action fg_action_download; /* a lot's CSV, QIF, DFQ, report */

#endif
