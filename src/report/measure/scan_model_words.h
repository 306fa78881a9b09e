/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scanner's model in words, and its effect on the reported values that it corrected. */
#ifndef FG_REPORT_MEASURE_SCAN_MODEL_WORDS_H
#define FG_REPORT_MEASURE_SCAN_MODEL_WORDS_H

#include <stdio.h>

#include "core/member.h"
#include "foilgauge/report.h"

struct fg_scanner_model;

/* Returns the model that corrected the scans of a report; NULL: none. */
const struct fg_scanner_model *fg_report_model(const fg_report *report);

/* Rows of an fg_scanner_model_facts, definition "model" of measure. FG_SCAN_MODEL is a row whose
 * function calls fg_json_scan_model, which writes the model as an object; NULL: null. */
extern const fg_members fg_scan_model_members;
#define FG_SCAN_MODEL(name_, function)                                                             \
  FG_GROUP(name_, &fg_scan_model_members), .write = (function), .options = FG_MEMBER_NULLABLE,     \
                                           .words = FG_SCAN_MODEL_WORDS
#define FG_SCAN_MODEL_WORDS "scanner's model that every scan was corrected by; null: none"
void fg_json_scan_model(fg_json *json, const char *name, const struct fg_scanner_model *model);

enum { FG_SCALE_WORDS = 480, FG_CORRECTION_WORDS = 256 };

/* Writes in a sentence or two if the uncertainties include the scanner's error of scale. NULL:
 * no model. */
void fg_scale_words(const struct fg_scanner_model *model, const fg_calibration *calibration,
                    char *words, size_t size);

/* Describe the correction of one foil: "R0 by -41.9 µm, R by up to +8.2 µm, ..."; and its
 * contribution to u: "0.01 µm to u of R0, ...". Empty where nothing was corrected. */
void fg_correction_moved(const fg_correction *correction, char *words, size_t size);
void fg_correction_added(const fg_correction *correction, char *words, size_t size);

/* Replaces each number of `max` by the larger of both; start from NaN. */
void fg_correction_largest(fg_correction *max, const fg_correction *one);

/* Writes the member `correction`; nothing where nothing was corrected. */
void fg_json_correction(fg_json *json, const fg_correction *correction);

/* Write the box above a page's values, and rows of its list of facts. `moved` and `added` are
 * words as above, or empty. Nothing without a model. */
fg_status fg_html_corrected(fg_context *ctx, FILE *out, const struct fg_scanner_model *model,
                            const char *moved, const char *added);
fg_status fg_html_model_facts(fg_context *ctx, FILE *out, const struct fg_scanner_model *model);

/* Writes the same facts for a terminal, in lines. */
fg_status fg_text_scan_model(fg_context *ctx, FILE *out, const struct fg_scanner_model *model);

#endif
