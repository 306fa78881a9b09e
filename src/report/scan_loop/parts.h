/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of the page of the loop on scans. All write into an open <main>. */
#ifndef FG_REPORT_SCAN_LOOP_PARTS_H
#define FG_REPORT_SCAN_LOOP_PARTS_H

#include "foilgauge/scan_loop.h"
#include "page/page.h"
#include "report/value_words.h"

/* ---- words (words.c) ---- */

/* "µm" for "um", "°" for "deg". */
const char *fg_scan_loop_unit_words(const char *unit);
/* Writes the kind of the held-out error: "scans kept aside", "bumps that took no part in the
 * search"; "": it adds nothing to the rms. */
enum { FG_HELD_OUT_WORDS = 80 };
void fg_scan_loop_held_out_words(const fg_scan_result *result, char words[FG_HELD_OUT_WORDS]);

/* Returns the largest of 1, 2, 5 times a power of ten that is not above `max`. */
double fg_scan_loop_nice_below(double max);

/* Writes the page's summary sentence; the caller frees it (sentence.c). */
fg_status fg_scan_loop_sentence(fg_context *ctx, const fg_scan_result *result, char **text);

/* Writes the recommended next step, in one sentence, and its commands, a line each; NULL: none. The
 * caller frees both (next.c). */
fg_status fg_scan_loop_next(fg_context *ctx, const fg_scan_result *result, char **words,
                            char **commands);

/* ---- effects (curves.c) ---- */

/* The deformation of the picture, curves over the coordinates, parameters. */
void fg_scan_loop_page_effects(FILE *out, const fg_scan_result *result);
void fg_scan_loop_page_grid(FILE *out, const fg_scan_result *result);

/* ---- residuals (vectors.c, plots.c) ---- */

fg_status fg_scan_loop_page_vectors(fg_context *ctx, FILE *out, const fg_scan_result *result);
fg_status fg_scan_loop_page_residuals(fg_context *ctx, FILE *out, const fg_scan_result *result);

/* Finds the size that all but `share` of the residuals stay below, over rows with weight; 0 without
 * any. */
fg_status fg_scan_loop_residual_limit(fg_context *ctx, const fg_scan_result *result, bool after,
                                      double share, double *limit);

/* ---- dimensions (dimensions.c) ---- */

void fg_scan_loop_page_dimensions(FILE *out, const fg_scan_result *result);

/* ---- form errors (form_errors.c) ---- */

/* Returns false where none was looked for. */
bool fg_has_form_error(const fg_form_error *error);
/* Writes a form error in um: "10.35 ± 0.18", "below 0.05", or a range; "": none. */
enum { FG_FORM_ERROR_WORDS = 48 };
void fg_form_error_words(const fg_form_error *error, const char *plus_minus, char *words,
                         size_t size);
void fg_scan_loop_page_form_errors(FILE *out, const fg_foil *foil);

/* ---- the bumps (bump_page.c) ---- */

void fg_scan_loop_page_bumps(FILE *out, const fg_scan_result *result);

#endif
