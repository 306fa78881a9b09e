/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts and sections of a lot's page. */
#ifndef FG_REPORT_LOT_PAGE_PARTS_H
#define FG_REPORT_LOT_PAGE_PARTS_H

#include <stdio.h>

#include "lot/statistics/analysis.h"

/* Puts a number; a dash where it is unknown. */
void fg_lot_put_number(FILE *out, double value, int digits);

/* Puts a value with the decimals of its quantity. */
void fg_lot_put_value(FILE *out, const fg_quantity *row, double value);
void fg_lot_put_decimals(FILE *out, double value, int decimals);

/* Puts the table of the worst foils; that of all foils that the page lists. */
void fg_lot_put_worst_table(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_foil_table(FILE *out, const fg_lot_analysis *analysis);

/* Puts the causes of the signals of a quantity's chart, as the rest of a sentence; nothing where
 * they are unknown. */
void fg_lot_put_cause(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);

/* Parts of the first screen, in its order. */
void fg_lot_put_heading(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_counts(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_worst(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_leading(FILE *out, const fg_lot_analysis *analysis);

/* Puts a path as a link needs it. */
void fg_lot_put_href(FILE *out, const char *path);

/* Puts a scan's name, linked to the scan where it still exists. */
void fg_lot_put_scan(FILE *out, const fg_lot_analysis *analysis, size_t item);

/* Begins a link to a foil's own page, or to its line in the page's list. Returns false, and writes
 * nothing, when there is neither. */
bool fg_lot_begin_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* Puts the label of a foil with that link. */
void fg_lot_put_foil_link(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* Puts the label of a foil. */
void fg_lot_put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil);

/* Puts the thickness of the strips, and the design's where it differs. */
void fg_lot_put_thickness(FILE *out, const fg_lot_analysis *analysis);

/* Puts the causes of the spread of the stiffness: a part of its section. */
void fg_lot_put_stiffness_budget(FILE *out, const fg_lot_analysis *analysis);

/* Sections in the page's order. */
void fg_lot_put_quantities(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_springback(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_arcs(FILE *out, const fg_lot_analysis *analysis);  /* for plain strips instead */
void fg_lot_put_beams(FILE *out, const fg_lot_analysis *analysis); /* for cantilevers instead */
void fg_lot_put_stiffness(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_bearings(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_assembly(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_film(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_comparisons(FILE *out, const fg_lot_analysis *analysis);
void fg_lot_put_gauge(FILE *out, const fg_lot_analysis *analysis);

#endif
