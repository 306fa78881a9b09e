/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a lot's report. Each writer checks the stream at its end: FG_ERR_IO. */
#ifndef FG_REPORT_LOT_FILES_H
#define FG_REPORT_LOT_FILES_H

#include <stdio.h>

#include "lot/statistics/analysis.h"

typedef fg_status fg_lot_writer(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out);

fg_lot_writer fg_lot_write_json;
fg_lot_writer fg_lot_write_foils_csv; /* a line per foil, and per scan without foils */
fg_lot_writer fg_lot_write_bumps_csv; /* a line per bump */
fg_lot_writer fg_lot_write_beams_csv; /* a line per beam */
fg_lot_writer fg_lot_write_bearings_csv;
fg_lot_writer fg_lot_write_page;
fg_lot_writer fg_lot_write_qif; /* QIF 3.0 results */
fg_lot_writer fg_lot_write_dfq; /* Q-DAS ASCII transfer format */

/* Writes every file of the report, lot.json last, so that it says that all are there. */
fg_status fg_lot_write_report(fg_context *ctx, const char *folder, const fg_lot *lot,
                              fg_lot_outcome *outcome);

#endif
