/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of how each kind of foil is shown: one row per kind of words, and of functions that write
 * what the kind alone has. Writers ask the row; no other line of a report tells kinds apart. How a
 * kind is measured is a row of geometry/foil_kind.h. Kinds that are shown alike share a row.
 */
#ifndef FG_REPORT_MEASURE_FOIL_VIEW_H
#define FG_REPORT_MEASURE_FOIL_VIEW_H

#include <stdio.h>

#include "core/member.h"
#include "foilgauge/design_report.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"

typedef struct fg_overlay_legend fg_overlay_legend;

typedef struct fg_foil_view {
  const char *parts;          /* "bumps", which may be missing or too many */
  const char *u_from;         /* what the uncertainty comes from, beside the residuals */
  const char *spread_over;    /* what a standard deviation s on a tile is over; NULL: no s */
  const char *legend;         /* colours of a page's picture */
  const char *overlay_note;   /* colours of the overlay */
  const char *table_note;     /* last lines of the terminal's table; NULL */
  const char *summary_heads;  /* HTML: columns of a page's summary */
  const char *points_heading; /* CSV of edge points */
  fg_quantity_owner lines;    /* CSV of values: a line is of this */
  const fg_members *members;  /* JSON: of a foil with its decision (measure/foil_members.h) */
  /* Terminal: a design, what a foil is, its parts (NULL: none). */
  void (*design_table)(const fg_design_report *report, FILE *out);
  void (*foil_heading)(const fg_foil *foil, FILE *out);
  void (*part_table)(FILE *out, const fg_design *design, const fg_foil *foil);
  /* Page: what a foil is, tiles, everything below the picture, cells of the summary (foil NULL: not
   * measured). */
  void (*page_heading)(const fg_foil *foil, FILE *out);
  void (*tiles)(FILE *out, const fg_design *design, const fg_foil *foil);
  void (*details)(FILE *out, const fg_design *design, const fg_foil *foil);
  void (*summary)(FILE *out, const fg_design *design, const fg_foil *foil);
  /* Legend under the overlay; `all` with every part. */
  fg_status (*overlay)(fg_context *ctx, fg_overlay_legend *legend, const fg_design *design,
                       const fg_foil *foil, bool all);
} fg_foil_view;

const fg_foil_view *fg_foil_view_of(fg_foil_kind kind);

extern const fg_foil_view fg_foil_view_arc;

/* Words of every strip that is seen from its edge. */
#define FG_EDGES_SAY "the two edges say against each other"
#define FG_ARCS_NOTE                                                                               \
  "± is U = 2 u (k = 2, about 95 %). Solid arc: used by the fit; dashed: beyond. Whiskers: "      \
  "residuals."
#define FG_STATIONS_HEADING                                                                        \
  "scan,foil,station,s_mm,side,x_mm,y_mm,u_um,arc,number,fitted,residual_um\n"

/* ---- functions of rows ---- */

void fg_design_table_of_bumps(const fg_design_report *report, FILE *out);
void fg_design_table_of_beams(const fg_design_report *report, FILE *out);
void fg_design_table_of_grid(const fg_design_report *report, FILE *out);
void fg_design_table_of_discs(const fg_design_report *report, FILE *out);
void fg_part_table_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_part_table_of_beams(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_tiles_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_tiles_of_beams(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_details_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_details_of_beams(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_summary_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_summary_of_beams(FILE *out, const fg_design *design, const fg_foil *foil);
fg_status fg_overlay_of_bumps(fg_context *ctx, fg_overlay_legend *legend, const fg_design *design,
                              const fg_foil *foil, bool all);
fg_status fg_overlay_of_beams(fg_context *ctx, fg_overlay_legend *legend, const fg_design *design,
                              const fg_foil *foil, bool all);

#endif
