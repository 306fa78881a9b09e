/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One quantity over the foils of a station, or over its lots: the user's choice, and the chart. */
#ifndef FG_STATION_TREND_H
#define FG_STATION_TREND_H

#include "lot/statistics/analysis.h"
#include "station/trend_choice.h"

/* A point before which the setup changed: another program, recipe or model of the scanner. */
typedef struct fg_trend_change {
  size_t point;
  bool program, recipe, model;
} fg_trend_change;
enum { FG_TREND_CHANGES = 4 };

/* The chart is of `count` points, behind `before` others, of `total`; [first, last] of them are
 * drawn. */
typedef struct fg_trend {
  const fg_trend_choice *choice;
  fg_lot_quantity quantity; /* values and chart; `size` is that of each point */
  double u_shared;          /* bound of the error that all values share: their smallest u */
  int64_t *foil;            /* of each point: the foil, or the lot's first; owned */
  size_t before, count, total, first, last;
  bool mixed;             /* foils of more than one recipe: no tolerance is that of all */
  fg_tolerance tolerance; /* by the recipe of the newest foil: quantity.tolerance */
  double *shift; /* of each point by causes, about which limits are taken; NULL: there is none */
  struct fg_cause *cause; /* accepted ones; owned */
  size_t causes;
  fg_trend_change change[FG_TREND_CHANGES]; /* of the drawn range, the newest first */
  size_t changes;
} fg_trend;

/* Reads the points. FG_OK also with none, or too few for a chart: then quantity.has_chart is
 * false. */
fg_status fg_trend_read(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                        const fg_trend_choice *choice, fg_trend *trend);
void fg_trend_free(fg_trend *trend);

/* Returns the chart: of individuals, or of the lots' means. */
const fg_chart *fg_trend_chart(const fg_trend *trend);
/* Returns a point's number, counted from 1. */
size_t fg_trend_number(const fg_trend *trend, size_t point);
/* Writes its serial number or lot. */
void fg_trend_name(sqlite3 *reader, const fg_trend *trend, size_t point, char *name, size_t size);

/* Points in a row at whose ends the same rule held. */
typedef struct fg_trend_run {
  unsigned rule;
  size_t first, last; /* from the first point of the rule */
  size_t mark;        /* from 1, the newest first */
} fg_trend_run;
enum { FG_TREND_RUNS = 8 }; /* so that a page is one sheet of paper */
/* Finds the newest FG_TREND_RUNS runs; *all is the number of all. */
size_t fg_trend_runs(const fg_trend *trend, fg_trend_run runs[FG_TREND_RUNS], size_t *all);

/* Finds the newest FG_TREND_CHANGES of the drawn range; none over lots. */
void fg_trend_find_changes(sqlite3 *reader, fg_trend *trend);

/* Returns true when the foils of the chart were measured by more than one recipe. */
bool fg_trend_mixes_recipes(sqlite3 *reader, const fg_trend *trend);

/* Finds the tolerance by which the newest foil was judged: that of its own recipe, which may be a
 * part's or an earlier one. quantity.tolerance stays NULL where it has none. */
fg_status fg_trend_find_tolerance(fg_context *ctx, sqlite3 *reader, fg_trend *trend);

/* Draws the chart as SVG: for wide pages and paper, or for narrow ones. */
void fg_trend_plot(FILE *out, sqlite3 *reader, const fg_trend *trend, const fg_trend_run *runs,
                   size_t run_count, bool narrow);

extern const char fg_trend_style[], fg_trend_script[];

#endif
