/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports: a measurement as JSON, CSV, a table for the terminal, a picture and a page.
 *
 * Every reported quantity is one row of a table (quantity.h): JSON, CSV, terminal, page and
 * tolerances loop over the rows.
 *
 * Uncertainties: u_<name> is a standard uncertainty (one standard deviation). Where a report for
 * people says ±, it is U = 2 u, the expanded uncertainty with coverage factor k = 2 (about 95 %).
 */
#ifndef FOILGAUGE_REPORT_H
#define FOILGAUGE_REPORT_H

#include <stdio.h>

#include "foilgauge/bearing.h"
#include "foilgauge/foil.h"
#include "foilgauge/quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* k of the expanded uncertainty U = k u. */
#define FG_COVERAGE_FACTOR 2.0

/* Verdict on a value against its tolerance, its uncertainty considered (after ISO 14253-1): the
 * interval value ± 2 u lies inside both limits, or outside one, or a limit runs through it. A
 * value whose uncertainty is not known is judged as if it were 0. */
typedef enum fg_verdict {
  FG_VERDICT_PASS,         /* "pass" */
  FG_VERDICT_FAIL,         /* "fail" */
  FG_VERDICT_UNDECIDED,    /* "cannot_tell": at 95 % it could be either */
  FG_VERDICT_NOT_MEASURED, /* "not_measured": no value */
  FG_VERDICT_NONE,         /* "no_tolerance" */
} fg_verdict;

/* Returns the verdict on one value. */
fg_verdict fg_judge_value(const fg_tolerance *tolerance, double value, double u);

/* Returns the verdict on a value of a scan: "cannot_tell" also where nothing is known of the
 * scanner's scale (traceability.h), but for a thickness that is stated as measured. */
fg_verdict fg_judge_measured(const fg_design *design, const fg_tolerance *tolerance,
                             const fg_quantity *row, double value, double u);

/* Returns the verdict's word as JSON has it. */
const char *fg_verdict_word(fg_verdict verdict);

/* Returns the worse of two, from the worst: fail, then not measured, cannot tell, pass, no
 * tolerance. */
fg_verdict fg_verdict_worse(fg_verdict a, fg_verdict b);

typedef struct fg_judgement {
  const fg_tolerance *tolerance; /* of the design; not owned */
  const fg_quantity *row;
  int number; /* of the bump or disc; 0: the whole foil */
  double value, u;
  fg_margin margin; /* to the nearest limit */
  /* Share of the deviation that the tolerance allows: 0 in its middle, 1 at its limit, more beyond.
   * A single limit allows as far as it is from the design's nominal, and from 0 where the design
   * has none (of an error, 0 is the nominal). Infinite without a value. */
  double severity;
  bool missing;  /* of a bump that is not there: no value, and a fail */
  bool exceeded; /* the value fails */
  fg_verdict verdict;
  const char *cure; /* "cannot tell": cheapest way to decide it; static; NULL: none is cheap */
} fg_judgement;

/* Outcome of a foil, a disc, a scan or a run. */
typedef struct fg_report_outcome {
  fg_verdict verdict;  /* the worst of all */
  size_t exceeded;     /* values that lie beyond a limit by more than U */
  size_t undecided;    /* values with a limit within U */
  size_t not_measured; /* scans, foils, bumps and toleranced quantities without a value */
  size_t rejected;     /* foils with a defect that rejects them whatever their values are */
} fg_report_outcome;

/* `sum` starts with the verdict FG_VERDICT_NONE and zeros. */
void fg_outcome_add(fg_report_outcome *sum, const fg_report_outcome *part);

/* The program's exit code: 2 something was not measured, else 1 a fail, else 3 cannot tell, else
 * 0. */
int fg_outcome_exit_code(const fg_report_outcome *outcome);

/* The decision on a foil or a disc. Every report, a lot and the exit code read it; none counts
 * again.
 *
 * A foil passes when all of it was measured and every value passes. It fails when a value fails
 * or a defect rejects it (fg_foil_defect). It is not measured when it could not be, when it is
 * no foil of the design (fg_foil_is_measured), when a bump could not be fitted, or when the
 * border of the scan may hide bumps that tolerances ask for. */
typedef struct fg_decision {
  fg_report_outcome outcome;
  fg_judgement *judgements; /* per tolerance of the foil, and per tolerance and bump; owned */
  size_t count;             /* 0 for a foil that was not measured */
} fg_decision;

fg_status fg_foil_decide(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                         fg_decision *decision);
fg_status fg_disc_decide(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                         fg_decision *decision);

/* Decides on a bearing of a lot, by the tolerances that name quantities of a bearing
 * (quantity.h). NULL: nothing is known of it. A bearing that is not `whole` has places without a
 * clearance: it fails where a known clearance lies below a limit already, and is not measured
 * otherwise. */
fg_status fg_bearing_decide(fg_context *ctx, const fg_design *design,
                            const fg_bearing_clearance *clearance, bool whole,
                            fg_decision *decision);
void fg_decision_free(fg_decision *decision);

/* Ranks judgements, the worst first: by verdict (fail, not measured, cannot tell, pass), then by
 * severity, then by number. Below 0: `a` comes before `b`. Every search for the worst uses it. */
int fg_judgement_compare(const fg_judgement *a, const fg_judgement *b);

/* Returns the number of the design's tolerances of a bearing, and writes their names (`names`
 * may be NULL). They are judged in lots: a scan shows no bearing. */
size_t fg_report_of_bearing(const fg_design *design, char *names, size_t size);

/* True with `words` (may be NULL) for people: "bump 3 is missing (8 found, the design has 9)". A
 * place at the pitch that the scan shows empty rejects a foil under every design. Another number
 * of bumps than the design's does so under a design with tolerances, unless the border of the
 * scan cuts the foil; under one without, which judges nothing, it is a flag alone. */
bool fg_foil_defect(const fg_design *design, const fg_foil *foil, char *words, size_t size);

/* Returns the worst verdict of a bump's values; "not_measured" when it was not fitted or its
 * foil not measured. */
fg_verdict fg_bump_verdict(const fg_design *design, const fg_foil *foil, const fg_bump *bump);

/* Returns the flags of a bump as reports write them, with FG_BUMP_OUT_OF_TOLERANCE when its
 * verdict is fail. */
unsigned fg_bump_flags(const fg_design *design, const fg_foil *foil, const fg_bump *bump);
unsigned fg_disc_flags(const fg_design *design, const fg_disc *disc);

/* Returns the worst verdict of a beam's values; "not_measured" without a length or a width. */
fg_verdict fg_beam_verdict(const fg_design *design, const fg_foil *foil, const fg_beam *beam);
unsigned fg_beam_flags(const fg_design *design, const fg_foil *foil, const fg_beam *beam);

/* FG_ERR_DATA when a tolerance names a quantity that is not reported for this kind of foil; the
 * message lists those that are. Quantities of a bearing are accepted for foils. */
fg_status fg_report_check_tolerances(fg_context *ctx, const fg_design *design);

/* One scan of a report: measured, or not and why. */
typedef struct fg_report_scan {
  const char *path;
  const fg_measurement *measurement; /* NULL when it could not be measured */
  const char *error;                 /* why not */
  const char *name; /* of its one foil: a serial number; NULL: the foil's number on the scan */
} fg_report_scan;

typedef struct fg_report {
  const fg_design *design;
  const fg_nominal *nominal;
  const fg_report_scan *scans;
  size_t scan_count;
  const char *back; /* address of the page's link back; NULL: none */
} fg_report;

/* Judge one scan, and all of them. */
fg_status fg_report_judge_scan(fg_context *ctx, const fg_design *design, const fg_report_scan *scan,
                               fg_report_outcome *outcome);
fg_status fg_report_judge(fg_context *ctx, const fg_report *report, fg_report_outcome *outcome);

/* The writers check the stream's error indicator at their end: FG_ERR_IO. */

/* JSON, "schema": "foilgauge/measure/1" (reports/schema/measure.schema.json). One scan: its
 * `foils` and `discs` are members of the report; several: `scans[]` holds them, one each in the
 * order given, and `inputs[]` runs parallel. Numbers have ten significant digits; NaN is null. */
fg_status fg_report_write_json(fg_context *ctx, const fg_report *report, FILE *out);

/* CSV: a heading line, then one line per bump (or disc), quoted as in RFC 4180; an unknown
 * number is an empty field. */
fg_status fg_report_write_csv(fg_context *ctx, const fg_report *report, FILE *out);

/* CSV of every edge point: left and right edge and midline of every station (or every point of
 * every disc), the arc it belongs to and its residual from the fitted circle. */
fg_status fg_report_write_points(fg_context *ctx, const fg_report *report, FILE *out);

/* Table for a terminal, at most 100 columns wide. */
fg_status fg_report_write_table(fg_context *ctx, const fg_report *report, FILE *out);

/* PNG, at most 8000 px wide: the one scan of the report in gray (read again from its file), edges,
 * numbered bumps, fitted circles, residuals magnified with their scale, dimensions in a legend. */
fg_status fg_report_write_overlay(fg_context *ctx, const fg_report *report, FILE *out);

/* One self-contained page (no scripts, prints well), a section per foil: verdict, key numbers, the
 * picture (read again from the scan for up to six foils), tables with tolerances, plots. */
fg_status fg_report_write_html(fg_context *ctx, const fg_report *report, FILE *out);

#ifdef __cplusplus
}
#endif
#endif
