/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses out of scans: a run sheet that names the scans of every run.
 *
 * A cell of the scan column holds one path or several with ';' between them (the foil scanned
 * again); relative paths are relative to the run sheet's folder. The response of a run is the mean
 * over its scans, of the mean over the foils in each, of the mean over the bumps of each foil where
 * the quantity is one of bumps.
 *
 * Standard uncertainty of these means: scans and foils are independent. Bumps of one foil are
 * independent in the radius, which their own circle alone gives. Height, angle and clearance
 * need the overall circle too and share its error: the mean over bumps gets the mean of their
 * uncertainties, which is an upper bound. The calibration's error is the same in every scan: it
 * is in no run's uncertainty, moves the level of all runs, and has its own number. */
#ifndef FOILGAUGE_RUN_SHEET_H
#define FOILGAUGE_RUN_SHEET_H

#include "foilgauge/experiment.h"
#include "foilgauge/measure.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Called with the path of every scan before the first is measured; an error ends the call. */
typedef fg_status fg_run_sheet_visit(fg_context *ctx, void *user, const char *scan);

typedef struct fg_run_sheet_options {
  const char *column;   /* that names the scans */
  const char *quantity; /* any reported quantity: "overall.springback_error_pct", "height_mm" */
  const char *folder;   /* of relative paths; NULL: the current one */
  const fg_design *design;
  fg_measure_options measure;
  fg_run_sheet_visit *visit; /* may be NULL */
  void *user;                /* of visit */
} fg_run_sheet_options;

typedef struct fg_run_sheet {
  fg_table table; /* the measured runs, with columns <quantity> and u_<quantity> */
  size_t *row;    /* table.rows: row of the sheet, from 1 */
  fg_experiment_scan *scan;
  size_t scans;
  double u_calibration; /* of the mean of all runs by the design's calibration; 0: none is stated */
  size_t empty;         /* runs without a scan: left out */
  size_t failed;        /* scans that could not be measured; a run without any other is left out */
} fg_run_sheet;

/* FG_ERR_DATA: no such column; no reported quantity of that name (the message lists them); a
 * column of the quantity's name is there already; no scan could be measured (the first one's
 * message). The error of one scan is in scan[].error. Free with fg_run_sheet_free. */
fg_status fg_run_sheet_measure(fg_context *ctx, const fg_table *sheet,
                               const fg_run_sheet_options *options, fg_run_sheet *measured);
void fg_run_sheet_free(fg_run_sheet *measured);

#ifdef __cplusplus
}
#endif
#endif
