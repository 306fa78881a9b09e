/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a lot's page share, and its sections. */
#ifndef FG_REPORT_LOT_PAGE_PARTS_H
#define FG_REPORT_LOT_PAGE_PARTS_H

#include <stdio.h>

#include "lot/statistics/analysis.h"

/* A dash where it is not known. */
void fg_lot_put_number(FILE *out, double value, int digits);

/* A value with as many decimals as people read of its quantity. */
void fg_lot_put_value(FILE *out, const fg_quantity *row, double value);
void fg_lot_put_decimals(FILE *out, double value, int decimals);

/* A cell with a verdict: its word, and its colour. */
void fg_lot_put_verdict(FILE *out, fg_verdict verdict);

/* Of one foil: what stands against it most; three cells: the value ± U, the limit, the margin. */
void fg_lot_put_reason(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);
void fg_lot_put_margin(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* What the signals of a quantity's chart come from: the rest of a sentence; nothing where it is not
 * known. */
void fg_lot_put_cause(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);

/* Parts of the first screen, in its order. */
void fg_lot_put_heading(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_counts(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_worst(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_leading(FILE *out, const fg_lot_analysis *analysis);

/* A path as a link has it. */
void fg_lot_put_href(FILE *out, const char *path);

/* A scan's name, which leads to the scan where it is still there. */
void fg_lot_put_scan(FILE *out, const fg_lot_analysis *analysis, size_t item);

/* The start of a link to a foil's own page, or where it has none to its line of the page's list;
 * false: neither is there, and nothing is written. */
bool fg_lot_begin_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* What people call a foil, with that link. */
void fg_lot_put_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* What people call a foil. */
void fg_lot_put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* What the strips measure, and what the design says where that is another thickness. */
void fg_lot_put_thickness(FILE *out, const fg_lot_analysis *analysis);

/* How well the means are known: a part of the quantities' section. */
void fg_lot_put_known(FILE *out, const fg_lot_analysis *analysis);

/* Where the spread of the stiffness comes from: a part of that section. */
void fg_lot_put_stiffness_budget(FILE *out, const fg_lot_analysis *analysis);

/* The sections, in the page's order. */
void fg_lot_put_quantities(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_springback(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_arcs(FILE *out, const fg_lot_analysis *analysis);  /* of plain strips instead */
void fg_lot_put_beams(FILE *out, const fg_lot_analysis *analysis); /* of cantilevers instead */
void fg_lot_put_stiffness(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_bearings(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_assembly(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_comparisons(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_gauge(FILE *out, const fg_lot_analysis *analysis);

#endif
