/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One quantity over the foils of a station, or over its lots: the user's choice, and the chart. */
#ifndef FG_STATION_TREND_H
#define FG_STATION_TREND_H

#include "lot/statistics/analysis.h"
#include "station/naming.h"
#include "station/pages.h"

/* The choice in the page's html form. Points are counted from the first of the selection, from
 * 1: their numbers stay when new foils come. */
typedef struct fg_trend_choice {
  fg_quantity_owner owner;
  const fg_quantity *row;
  int bump; /* 0: the mean over a foil's bumps, or the whole foil */
  char lot[FG_NAMED_TEXT], die[FG_NAMED_TEXT]; /* "": any */
  bool by_lots;
  size_t newest;     /* points of the chart; 0: all */
  size_t from, to;   /* points that are drawn; 0: not given */
  bool of_the_drawn; /* the chart's limits come from the drawn points alone */
} fg_trend_choice;

/* FG_ERR_USAGE: there is no such quantity. */
fg_status fg_trend_choose(fg_context *ctx, const fg_inspection *station, const fg_request *request,
                          fg_trend_choice *choice);

/* Writes the choice as a query, "?q=...", HTML-safe; with other points drawn, unless both are 0. */
void fg_trend_write_link(FILE *out, const fg_trend_choice *choice, size_t from, size_t to);

/* Writes "bump:height_mm", as the query has it. */
void fg_trend_write_name(FILE *out, fg_quantity_owner owner, const fg_quantity *row);

/* The chart is of `count` points, behind `before` others, of `total`; [first, last] of them are
 * drawn. */
typedef struct fg_trend {
  const fg_trend_choice *choice;
  fg_lot_quantity quantity; /* values and chart; `size` is that of each point */
  int64_t *foil;            /* of each point: the foil, or the lot's first; owned */
  size_t before, count, total, first, last;
} fg_trend;

/* Reads the points. FG_OK also with none, or too few for a chart: then quantity.has_chart is
 * false. */
fg_status fg_trend_read(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                        const fg_trend_choice *choice, fg_trend *trend);
void fg_trend_free(fg_trend *trend);

/* Writes the html form of the choice. */
fg_status fg_trend_write_html_form(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                                   const fg_trend *trend, FILE *out);

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

/* A point before which the setup changed: another program, recipe or model of the scanner. */
typedef struct fg_trend_change {
  size_t point;
  bool program, recipe, model;
} fg_trend_change;
enum { FG_TREND_CHANGES = 4 };
/* Finds the newest FG_TREND_CHANGES of the drawn range; none over lots. */
size_t fg_trend_changes(sqlite3 *reader, const fg_trend *trend,
                        fg_trend_change change[FG_TREND_CHANGES]);

/* Draws the chart as SVG: for wide pages and paper, or for narrow ones. */
void fg_trend_plot(FILE *out, sqlite3 *reader, const fg_trend *trend, const fg_trend_run *runs,
                   size_t run_count, bool narrow);

extern const char fg_trend_style[], fg_trend_script[];

#endif
