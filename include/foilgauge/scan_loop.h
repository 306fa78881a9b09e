/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for effects of scanner and foil that the declared geometry lacks, on scans.
 *
 * The scans are measured, the edge points of all arcs and lands are compared with one geometry, and
 * every small set of effects of scanner and part is fitted to the residual. The effects found are
 * fitted together with the geometry, non-linearly; then the edges are corrected and measured again.
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
  double dpi;       /* 0: the files' own */
  bool allow_lossy; /* as in fg_measure_options */
  unsigned threads; /* 0: all cores */
  bool same_foil;   /* foil k of every scan is the same foil, turned or shifted in between */
  bool coarse;      /* fast search: few starts, sets of one smooth effect, two rounds at most */
  /* Rows of the scan by which the sensor's red and blue line lie ahead of the green one: at row y
   * they see the carriage's position of row y + gap. Both 0: unknown. */
  double colour_gap_px[2];
  uint64_t seed;
  const char *scanner; /* scanner's name, for the model file; NULL: not stated */
  int64_t date; /* date of its scans, for the model file: seconds since 1970, UTC; 0: not stated */
  /* Prediction of every bump, by number, that replaces the design's springback; NULL: the design's.
   * It must outlive the loop. */
  const struct fg_forming_prediction *forming;
  /* Effects that are not looked for, by id, separated by commas; NULL: none. It must outlive the
   * loop. */
  const char *without;
  /* Factors on the expectations before a scan is seen, for studies of how much hangs on them: on
   * the sizes of causes and on their probabilities. 0: 1. */
  double prior_size, prior_weight;
} fg_scan_loop_options;

typedef struct fg_scan_loop fg_scan_loop; /* src/scan_loop/state.h */

/* Scans of a loop: scan i only confirms where hold_out[i] is true; at least one must not be held
 * out. */
typedef struct fg_scan_loop_scans {
  const char *const *paths;
  const bool *hold_out;
  size_t count;
} fg_scan_loop_scans;

/* FG_ERR_DATA when the scans do not fit together (resolution; under same_foil scans of different
 * foils), or when `forming` does not predict a bump that they show. FG_ERR_NOT_MEASURED when no
 * foil of the design could be measured. FG_ERR_USAGE when `without` names no listed effect. */
fg_status fg_scan_loop_run(fg_context *ctx, const fg_scan_loop_scans *scans,
                           const fg_design *design, const fg_scan_loop_options *options,
                           fg_scan_loop **loop);
void fg_scan_loop_free(fg_scan_loop *loop);
/* Returns the result, owned by the loop. */
const fg_scan_result *fg_scan_loop_result(const fg_scan_loop *loop);

/* "foilgauge/loop/1", domain "scan". */
fg_status fg_scan_loop_write_json(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
fg_status fg_scan_loop_write_text(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
/* Writes the same content as one page with drawings inside, without scripts. */
fg_status fg_scan_loop_write_html(fg_context *ctx, const fg_scan_loop *loop, FILE *out);
/* "foilgauge/scan-model/1". */
fg_status fg_scan_loop_write_model(fg_context *ctx, const fg_scan_loop *loop, FILE *out);

/* Model of a scanner, to correct other scans. FG_ERR_DATA for an invalid file, with its fault.
 * `path` of the second function is for messages. */
typedef struct fg_scanner_model fg_scanner_model;
fg_status fg_scanner_model_load(fg_context *ctx, const char *path, fg_scanner_model **model);
fg_status fg_scanner_model_parse(fg_context *ctx, const char *path, const char *text,
                                 fg_scanner_model **model);
void fg_scanner_model_free(fg_scanner_model *model);

/* Facts of a model; its strings belong to it. */
enum { FG_SCANNER_MODEL_EFFECTS = 8 };
typedef struct fg_scanner_model_effect {
  const char *id, *words;
  fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS];
  size_t parameters;
  double half_range_um; /* in its region */
} fg_scanner_model_effect;
typedef struct fg_scanner_model_facts {
  const char *path, *sha256;
  const char *scanner, *date; /* NULL: not said */
  size_t scans;               /* number of scans behind it; 0: not stated */
  size_t known_diameters;     /* gauges among its scans */
  size_t known_grids;   /* scans of grids of known pitch; without either its scale is unknown */
  bool tied;            /* other explanations fitted its scans as well */
  double temperature_c; /* of the scanner then; NaN: not stated */
  double low_mm[2], high_mm[2]; /* its region of the glass */
  fg_scanner_model_effect effect[FG_SCANNER_MODEL_EFFECTS];
  size_t effects;
  double map_half_range_um; /* of its map, in its region; NaN: none */
} fg_scanner_model_facts;
void fg_scanner_model_describe(const fg_scanner_model *model, fg_scanner_model_facts *facts);
const char *fg_scanner_model_sha256(const fg_scanner_model *model);
/* Returns true when other explanations fitted the model's scans as well. */
bool fg_scanner_model_is_tied(const fg_scanner_model *model);
/* True where it holds the level of edges, by gauges; NULL: false. */
bool fg_scanner_model_has_level(const fg_scanner_model *model);
/* Returns true when the model has neither effects nor an edge level and corrects nothing. */
bool fg_scanner_model_is_empty(const fg_scanner_model *model);
/* Notes in a design whose scale the model in use has: of gauges of known size, or none; and what
 * the scanner's own expansion since then leaves uncertain, where both temperatures are stated. */
void fg_scanner_model_trace(const fg_scanner_model *model, fg_design *design);
/* FG_ERR_DATA when the model is not of the named scanner; NULL: any scanner. */
fg_status fg_scanner_model_check_scanner(fg_context *ctx, const fg_scanner_model *model,
                                         const char *path, const char *scanner);
/* Corrects the edges of every foil and measures it again. Of R0, R and h, a value that the
 * correction does not improve keeps its measured value (`choice` of fg_foil). Every u_ includes the
 * model's uncertainty and, in a tie, the differences between the explanations. FG_ERR_DATA when the
 * model has another resolution, when a scan is younger than its artefact's due date, or a foil lies
 * more than twice as far on the glass as the model's region; `warning` (200 bytes, or NULL) gets a
 * message when it lies outside the region at all. Part effects belong to the model's own foil and
 * are not applied. `correction` of every foil records the changes; the model must outlive the
 * measurement, whose reports refer to it. */
fg_status fg_scanner_model_apply(fg_context *ctx, const fg_scanner_model *model, fg_measurement *m,
                                 unsigned threads, char *warning);

#ifdef __cplusplus
}
#endif
#endif
