/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of a measurement's page, its tiles, reasons and limits. */
#ifndef FG_REPORT_MEASURE_PAGE_TABLES_H
#define FG_REPORT_MEASURE_PAGE_TABLES_H

#include "page/page.h"
#include "page/plot_marks.h"
#include "report/measure/page_parts.h"

void fg_html_disc_table(FILE *out, const fg_design *design, const fg_measurement *measurement);

/* Key numbers (page_tiles.c). */

void fg_html_quantity_tile(FILE *out, fg_quantity_owner owner, const char *name, const char *title,
                           const void *object);
void fg_html_disc_tiles(FILE *out, const fg_measurement *measurement);

/* Reasons of a verdict (page_reasons.c). */

/* Writes a paragraph with every value of that verdict, its bump and its limit; nothing without
 * one. */
void fg_html_reasons(FILE *out, const fg_decision *decision, fg_verdict verdict);
void fg_html_defect(FILE *out, const fg_design *design, const fg_foil *foil);
fg_status fg_html_disc_reasons(fg_context *ctx, FILE *out, const fg_design *design,
                               const fg_measurement *measurement);
/* Writes all reasons in one line, without a paragraph. */
void fg_html_reason_line(FILE *out, const fg_design *design, const fg_foil *foil,
                         const fg_decision *decision);

/* Limits (page_limits.c). */

/* Plots every toleranced quantity of the bumps. */
void fg_html_limits(FILE *out, const fg_design *design, const fg_foil *foil);
/* Makes labels of the limits that are set, with `words` behind their values; returns their
 * number. */
size_t fg_html_limit_labels(const fg_tolerance *limit, const char *words, fg_plot_label labels[2]);
/* Returns the room that labels need right of a plot; 0 without one. */
double fg_html_limit_room(const fg_plot_label *labels, size_t count);
/* Draws a line for each limit, and the labels beside the plot. */
void fg_html_limit_lines(const fg_plot *at, fg_plot_label *labels, size_t count);

/* Several foils (page_summary.c). */

const char *fg_html_base_name(const char *path);
/* Returns the number of sections: one for each foil and each unmeasured scan, "part1" ... */
size_t fg_html_sections(const fg_report *report);
/* A cell with a number, or a dash. */
void fg_html_summary_number(FILE *out, double value, int decimals);
/* Residuals along a foil; `against` names their reference in the heading. */
void fg_html_residual_figure(FILE *out, const fg_foil *foil, const char *against);
fg_status fg_html_summary(fg_context *ctx, FILE *out, const fg_report *report);

#endif
