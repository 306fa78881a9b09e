/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scanner's model is and what it did, where values are reported that it corrected. */
#ifndef FG_REPORT_MEASURE_SCAN_MODEL_WORDS_H
#define FG_REPORT_MEASURE_SCAN_MODEL_WORDS_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/report.h"

struct fg_scanner_model;

/* What the scans of a report were corrected by; NULL: nothing. */
const struct fg_scanner_model *fg_report_model(const fg_report *report);

/* An object; NULL: null. */
void fg_json_scan_model(fg_json *json, const char *name, const struct fg_scanner_model *model);

enum { FG_SCALE_WORDS = 480, FG_CORRECTION_WORDS = 256 };

/* Whether the scanner's error of scale is in the uncertainties: a sentence or two. NULL: no model.
 */
void fg_scale_words(const struct fg_scanner_model *model, const fg_calibration *calibration,
                    char *words, size_t size);

/* "R0 by -41.9 µm, R by up to +8.2 µm, ...": what it did to one foil; "0.01 µm to u of R0, ...":
 * what it added. Empty where nothing was corrected. */
void fg_correction_moved(const fg_correction *correction, char *words, size_t size);
void fg_correction_added(const fg_correction *correction, char *words, size_t size);

/* `most` becomes the larger of both, number by number; start from NaN. */
void fg_correction_largest(fg_correction *max, const fg_correction *one);

/* The member `correction`; nothing where nothing was corrected. */
void fg_json_correction(fg_json *json, const fg_correction *correction);

/* A page: what stands above the values, and rows of the list of facts. `moved` and `added` are
 * words as above, or empty. Nothing without a model. */
fg_status fg_html_corrected(fg_context *ctx, FILE *out, const struct fg_scanner_model *model,
                            const char *moved, const char *added);
fg_status fg_html_model_facts(fg_context *ctx, FILE *out, const struct fg_scanner_model *model);

/* The same for a terminal, in lines. */
fg_status fg_text_scan_model(fg_context *ctx, FILE *out, const struct fg_scanner_model *model);

#endif
