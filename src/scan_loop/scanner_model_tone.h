/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level of a scanner's edges in its model: found on discs of known diameter, applied to scans
 * that were made with the same settings. */
#ifndef FG_SCAN_LOOP_SCANNER_MODEL_TONE_H
#define FG_SCAN_LOOP_SCANNER_MODEL_TONE_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/scan_loop.h"
#include "measure/level.h"

/* The level, and the scanner's state that it belongs to; NaN: not known. */
typedef struct fg_model_tone {
  size_t gauges; /* discs of known diameter that told it; 0: it is not known */
  fg_level level;
  double blur_px, asymmetry; /* of edges, as vision/edge_spread.h says */
  double shown;              /* T(1/2) less a half, as the edge model explained the edges */
  double gamma, sharpen_amount, sharpen_radius_px;
  unsigned findings; /* fg_picture_finding of the scans */
  double u_scale;    /* relative: of a scale that is found with the level; 0: no known diameters */
} fg_model_tone;

/* From the discs of known diameter of a loop's scans, with any scale beside it; once effects were
 * searched for, as scanned or as corrected, whichever agree better. gauges 0 where that does not
 * tell it. */
fg_model_tone fg_model_tone_find(const fg_scan_loop *loop, bool searched);

/* It is not half of the counts. */
bool fg_model_tone_is_significant(const fg_model_tone *tone);

/* Member `tone` of a model; absent: not known. */
fg_status fg_model_tone_read(fg_context *ctx, const cJSON *root, fg_model_tone *tone);
void fg_model_tone_write(fg_json *json, const fg_model_tone *tone);

/* Moves the edges of a scan to the level, unless a gauge on the glass has told its own, or the scan
 * was made with other settings: then m->tone_note says why not. */
fg_status fg_model_tone_apply(fg_context *ctx, const fg_model_tone *tone, unsigned threads,
                              fg_measurement *m);

#endif
