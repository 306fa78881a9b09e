/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge level (tone) of a scanner in its model: found on discs of known diameter, applied to scans
 * made with the same settings. */
#ifndef FG_SCAN_LOOP_SCANNER_MODEL_TONE_H
#define FG_SCAN_LOOP_SCANNER_MODEL_TONE_H

#include <cjson/cJSON.h>

#include "core/member.h"
#include "foilgauge/scan_loop.h"
#include "measure/level.h"

/* Edge level, and the scanner's state that it is valid for; NaN: unknown. */
typedef struct fg_model_tone {
  size_t gauges; /* number of known discs behind it; 0: level unknown */
  fg_level level;
  double blur_px, asymmetry; /* of edges, see vision/edge_spread.h */
  double shown;              /* T(1/2) less a half, as estimated by the edge model */
  double gamma, sharpen_amount, sharpen_radius_px;
  unsigned findings; /* fg_picture_finding of the scans */
  double u_scale;    /* relative u of a scale found with the level; 0: no known diameters */
  bool contradicted; /* by discs whose sizes scatter: an effect moves them, too */
} fg_model_tone;

/* T(1/2) less a half, as the edge model explains the edge of a disc. */
double fg_model_tone_shown_by(const fg_disc *disc);

/* Returns true when the level differs significantly from where the edges are. */
bool fg_model_tone_is_away(const fg_model_tone *tone, double half);

/* Reads member `tone` of a model; absent: unknown. */
fg_status fg_model_tone_read(fg_context *ctx, const cJSON *root, fg_model_tone *tone);
/* Members that it reads, and a model has. */
extern const fg_members fg_model_tone_members;

/* Moves the edges of a scan to the level. It does not when a gauge on the glass determined the
 * scan's own level, or when the scan was made with other settings: m->tone_note then has the
 * reason. */
fg_status fg_model_tone_apply(fg_context *ctx, const fg_model_tone *tone, unsigned threads,
                              fg_measurement *m);

#endif
