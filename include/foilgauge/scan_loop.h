/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closing the loop on scans: what the scanner or the foil does that the declared geometry lacks.
 *
 * The scans are measured, the edge points of all arcs and lands are held against one geometry, and
 * every small set of effects of scanner and part is tried on what is left. What is found is fitted
 * together with the geometry, non-linearly, and the edges are corrected and measured again.
 */
#ifndef FOILGAUGE_SCAN_LOOP_H
#define FOILGAUGE_SCAN_LOOP_H

#include <stdio.h>

#include "foilgauge/loop.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan_result.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_SCANNER_NAME = 128 };

struct fg_forming_prediction; /* foilgauge/forming.h */

typedef struct fg_scan_loop_options {
  double dpi;       /* 0: as the files say */
  bool allow_lossy; /* as in fg_measure_options */
  unsigned threads; /* 0: all cores */
  bool same_foil;   /* foil k of every scan is one foil, turned or shifted in between */
  bool coarse;      /* a quick look: few starts, sets of one smooth effect, two rounds at most */
  /* Rows of the scan by which the sensor's red and blue line lie ahead of the green one (they see
   * at row y what the carriage does at y + gap); both 0: not known. */
  double colour_gap_px[2];
  uint64_t seed;
  const char *scanner; /* its name, for the model file; NULL: not said */
  int64_t date; /* likewise, when its scans were made: seconds since 1970, UTC; 0: not said */
  /* Declared of the bumps in place of the design's springback, each by its number; NULL: the
   * design's. It must outlive the loop. */
  const struct fg_forming_prediction *forming;
} fg_scan_loop_options;

typedef struct fg_scan_loop fg_scan_loop; /* src/scan_loop/state.h */

/* `hold_out[i]`: scan i only confirms. At least one scan must not be kept aside. FG_ERR_DATA when
 * the scans do not fit together (resolution; under same_foil scans that are not of one foil), or
 * `forming` does not know a bump that they show,
 * FG_ERR_NOT_MEASURED when no foil of the design could be measured. */
fg_status fg_scan_loop_run(fg_context *ctx, const char *const *paths, const bool *hold_out,
                           size_t count, const fg_design *design,
                           const fg_scan_loop_options *options, fg_scan_loop **loop);
void fg_scan_loop_free(fg_scan_loop *loop);
/* What it came to; belongs to the loop. */
const fg_scan_result *fg_scan_loop_result(const fg_scan_loop *loop);

/* "foilgauge/loop/1", domain "scan". */
fg_status fg_scan_loop_write_json(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
fg_status fg_scan_loop_write_text(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
/* The same as one page with drawings inside, without scripts. */
fg_status fg_scan_loop_write_html(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
/* "foilgauge/scan-model/1". */
fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

/* A model that was found, to correct other scans. FG_ERR_DATA for a file that is not one, with what
 * is wrong in it. `path` of the second is for messages. */
typedef struct fg_scanner_model fg_scanner_model;
fg_status fg_scanner_model_load(fg_context *ctx, const char *path, fg_scanner_model **model);
fg_status fg_scanner_model_parse(fg_context *ctx, const char *path, const char *text,
                                 fg_scanner_model **model);
void fg_scanner_model_free(fg_scanner_model *model);

/* What a model is and corrects; its words belong to it. */
enum { FG_SCANNER_MODEL_EFFECTS = 8 };
typedef struct fg_scanner_model_effect {
  const char *id, *words;
  fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS];
  size_t parameters;
  double half_range_um; /* in its region */
} fg_scanner_model_effect;
typedef struct fg_scanner_model_facts {
  const char *path, *sha256;
  const char *scanner, *date;   /* NULL: not said */
  size_t scans;                 /* that it was found on; 0: not said */
  size_t known_diameters;       /* gauges of them; 0: its absolute scale is not known */
  bool tied;                    /* other explanations did as well when it was found */
  double low_mm[2], high_mm[2]; /* its region of the glass */
  fg_scanner_model_effect effect[FG_SCANNER_MODEL_EFFECTS];
  size_t effects;
} fg_scanner_model_facts;
void fg_scanner_model_describe(const fg_scanner_model *model, fg_scanner_model_facts *facts);
const char *fg_scanner_model_sha256(const fg_scanner_model *model);
/* Other explanations did as well when it was found. */
bool fg_scanner_model_is_tied(const fg_scanner_model *model);
/* Nothing was found of the scanner: the model corrects nothing. */
bool fg_scanner_model_is_empty(const fg_scanner_model *model);
/* FG_ERR_DATA unless the model is of the scanner of that name; NULL: any. */
fg_status fg_scanner_model_check_scanner(fg_context *ctx, const fg_scanner_model *model,
                                         const char *path, const char *scanner);
/* Corrects the edges of every foil and measures it again; of R0, R and h what that does not make
 * better stays as it was (`choice` of fg_foil). The model's uncertainty is in every u_, and in a
 * tie how far from it each explanation would have put the value. FG_ERR_DATA when the
 * model is of another resolution, or a foil lies more than twice as far on the glass as what the
 * model was found on; `warning` (200 bytes, or NULL) gets words when it lies outside at all. Part
 * effects are of the foil they were found on and are not applied. What it did is in `correction` of
 * every foil; the model must outlive the measurement, whose reports speak of it. */
fg_status fg_scanner_model_apply(fg_context *ctx, const fg_scanner_model *model, fg_measurement *m,
                                 unsigned threads, char *warning);

#ifdef __cplusplus
}
#endif
#endif
