/* Reports: a measurement as JSON, CSV, a table for the terminal, a picture and a page.
 *
 * Every reported quantity is one row of a table (fg_report_fields): its JSON name, where it lies,
 * where its standard uncertainty lies, its unit and its words. JSON, CSV, terminal, page,
 * tolerances and the schema's test all read that table, so a new quantity is a new row.
 *
 * Uncertainties: u_<name> is a standard uncertainty (one standard deviation). Where a report for
 * people says ±, it is U = 2 u, the expanded uncertainty with coverage factor k = 2 (about 95 %).
 */
#ifndef FOILGAUGE_REPORT_H
#define FOILGAUGE_REPORT_H

#include <stdio.h>

#include "foilgauge/foil.h"

#ifdef __cplusplus
extern "C" {
#endif

/* k of the expanded uncertainty U = k u. */
#define FG_COVERAGE_FACTOR 2.0

/* What a row of the table belongs to. */
typedef enum fg_report_owner {
  FG_REPORT_FOIL, /* offsets into fg_foil; "overall." in the name is a JSON object */
  FG_REPORT_BUMP, /* offsets into fg_bump */
  FG_REPORT_DISC, /* offsets into fg_disc */
} fg_report_owner;

typedef enum fg_field_kind {
  FG_FIELD_NUMBER, /* double */
  FG_FIELD_PAIR,   /* two doubles, x and y */
  FG_FIELD_COUNT,  /* size_t */
} fg_field_kind;

#define FG_NO_UNCERTAINTY ((size_t)-1)

typedef struct fg_report_field {
  const char *name;   /* JSON name, unit included */
  const char *unit;   /* for people: "mm", "°", "%", "µm", "" */
  const char *symbol; /* heading of a column, UTF-8 */
  const char *words;  /* what it is, for people */
  fg_field_kind kind;
  size_t offset;   /* in its owner */
  size_t u_offset; /* of its standard uncertainty; FG_NO_UNCERTAINTY without */
  int decimals;    /* at least, where people read it */
} fg_report_field;

/* The rows of one owner, in the order of the report. */
const fg_report_field *fg_report_fields(fg_report_owner owner, size_t *count);

/* The row of that name, or NULL. */
const fg_report_field *fg_report_find(fg_report_owner owner, const char *name);

/* A number or a count of the object (fg_foil, fg_bump, fg_disc) as double; NaN for a pair. */
double fg_report_value(const fg_report_field *field, const void *object);

/* Its standard uncertainty; NaN when there is none. */
double fg_report_uncertainty(const fg_report_field *field, const void *object);

/* What a value says about its tolerance, its uncertainty considered (after ISO 14253-1): the
 * interval value ± 2 u lies inside both limits, or outside one, or a limit runs through it. A value
 * whose uncertainty is not known is judged as if it were 0. */
typedef enum fg_verdict {
  FG_VERDICT_PASS,         /* "pass" */
  FG_VERDICT_FAIL,         /* "fail" */
  FG_VERDICT_UNDECIDED,    /* "cannot_tell": at 95 % it could be either */
  FG_VERDICT_NOT_MEASURED, /* "not_measured": no value */
  FG_VERDICT_NONE,         /* "no_tolerance" */
} fg_verdict;

typedef struct fg_judgement {
  const fg_tolerance *tolerance; /* of the design; not owned */
  const fg_report_field *field;
  int number; /* of the bump or disc; 0: the whole foil */
  double value, u;
  bool exceeded; /* the value itself lies outside a limit */
  fg_verdict verdict;
} fg_judgement;

fg_verdict fg_judge_value(const fg_tolerance *tolerance, double value, double u);

/* The word of a verdict as JSON has it. */
const char *fg_verdict_word(fg_verdict verdict);

/* Every tolerance of the design applied to a foil: one judgement per tolerance of the foil and one
 * per tolerance and bump; a bump that the design states and the foil lacks is "not_measured". The
 * caller frees *list with free(). */
fg_status fg_foil_judgements(fg_context *ctx, const fg_design *design, const fg_foil *foil,
                             fg_judgement **list, size_t *count);

/* The same for one disc. */
fg_status fg_disc_judgements(fg_context *ctx, const fg_design *design, const fg_disc *disc,
                             fg_judgement **list, size_t *count);

/* The worse of two: fail, then not measured, cannot tell, pass, no tolerance. */
fg_verdict fg_verdict_worse(fg_verdict a, fg_verdict b);

/* The worst of a list. */
fg_verdict fg_judgements_verdict(const fg_judgement *list, size_t count);

/* Sets foil->in_tolerance and FG_BUMP_OUT_OF_TOLERANCE from the values alone. */
void fg_foil_judge(const fg_design *design, fg_foil *foil);

/* FG_ERR_DATA when a tolerance names a quantity that is not reported for this form of part; the
 * message lists the names that there are. */
fg_status fg_report_check_tolerances(fg_context *ctx, const fg_design *design);

/* One scan of a report: measured, or not and why. */
typedef struct fg_report_scan {
  const char *path;
  const fg_measurement *measurement; /* NULL when it could not be measured */
  const char *error;                 /* then: the words */
} fg_report_scan;

typedef struct fg_report {
  const fg_design *design;
  const fg_nominal *nominal;
  const fg_report_scan *scans;
  size_t scan_count;
} fg_report;

/* What all of it comes to. */
typedef struct fg_report_outcome {
  fg_verdict verdict;  /* the worst of all */
  size_t exceeded;     /* values outside their tolerance */
  size_t not_measured; /* scans, foils and toleranced quantities without a value */
} fg_report_outcome;

fg_status fg_report_judge(fg_context *ctx, const fg_report *report, fg_report_outcome *outcome);

/* The writers check the stream's error indicator at their end: FG_ERR_IO. */

/* JSON, "schema": "foilgauge/measure/1" (reports/schema/measure.schema.json). One scan: its
 * `foils` and `discs` are members of the report; several: `scans[]` holds them, one each in the
 * order given, and `inputs[]` runs parallel. Numbers have ten significant digits; NaN is null. */
fg_status fg_report_write_json(fg_context *ctx, const fg_report *report, FILE *out);

/* One line per bump (or disc), a heading line, quoted as in RFC 4180; an unknown number is an empty
 * field. */
fg_status fg_report_write_csv(fg_context *ctx, const fg_report *report, FILE *out);

/* Every edge point: left and right edge and midline of every station (or every point of every
 * disc), the arc it belongs to and its residual from the fitted circle. */
fg_status fg_report_write_points(fg_context *ctx, const fg_report *report, FILE *out);

/* For people, at most 100 columns. */
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
