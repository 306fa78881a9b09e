/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level of a scanner's edges, from discs of known diameter. */
#include <math.h>

#include "scan_loop/state.h"

/* Limits of u. Discs of several sizes separate the level from any scale of the scanner: the level
 * counts as known when its u is at most half of the uncertainty by an unknown tone curve. */
#define SCALE_FREE  0.05
#define LEVEL_KNOWN 0.04
enum { DISCS_MIN = 3 };

/* Adds the diameter of the corrected scan; the edge level is as found. */
static void add_disc(const fg_disc *disc, const fg_disc *corrected, double known_mm, double u_mm,
                     fg_level_sum *sum) {
  double level = disc->level_u_mm;
  double u = sqrt(fmax(disc->u_radius_mm * disc->u_radius_mm - level * level, 0));
  const fg_gauge gauge = {disc->hole ? FG_GAUGE_HOLE : FG_GAUGE_PIN, known_mm, u_mm};
  const fg_gauge_reading reading = {.measured_mm =
                                        disc->plain_mm + corrected->diameter_mm - disc->diameter_mm,
                                    .u_measured_mm = 2 * u,
                                    .blur_mm = disc->plain_blur_um / 1000,
                                    .contrast = disc->contrast,
                                    .bright = disc->bright};
  fg_level_add(sum, &gauge, &reading);
}

static double mean_of(double sum, double count) {
  return count > 0 ? sum / count : NAN;
}

static fg_model_tone find_on(const fg_scan_loop *loop, const fg_measurement *scans) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  fg_model_tone tone = {.gauges = 0};
  fg_level_sum sum = {.count = 0};
  double shown = 0;
  double blur = 0, asymmetry = 0, gamma = 0, gammas = 0, sharpen = 0, radius = 0, sharpened = 0;
  for (size_t v = 0; edge_fit->discs && v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    const fg_edge_fit_part *part = &edge_fit->parts[view->part];
    const fg_disc *disc = view->disc;
    if (view->held_out || !(part->known_radius_mm > 0) || disc->flags & FG_BUMP_POOR_FIT) continue;
    const fg_disc *corrected = &scans[view->scan].discs[disc - view->measurement->discs];
    add_disc(disc, corrected, 2 * part->known_radius_mm,
             fg_scan_loop_u_diameter_mm(view->measurement), &sum);
    blur += disc->spread_px;
    asymmetry += disc->asymmetry;
    shown += fg_model_tone_shown_by(disc);
    tone.findings |= disc->picture.findings;
    if (disc->flags & FG_BUMP_LOSSY) tone.findings |= FG_PICTURE_BLOCK_NOISE;
    if (isfinite(disc->picture.gamma)) {
      gamma += disc->picture.gamma;
      gammas++;
    }
    if (isfinite(disc->picture.sharpen_amount)) {
      sharpen += disc->picture.sharpen_amount;
      radius += disc->picture.sharpen_radius_px;
      sharpened++;
    }
  }
  if (sum.count) tone.u_scale = fg_level_u_scale(&sum);
  if (sum.count < DISCS_MIN) return tone;
  tone.contradicted = fg_level_is_contradicted(&sum, fg_level_solve(&sum, SCALE_FREE, &tone.level));
  if (!(tone.level.u < LEVEL_KNOWN)) return tone;
  tone.gauges = sum.count;
  tone.blur_px = blur / (double)sum.count;
  tone.asymmetry = asymmetry / (double)sum.count;
  tone.shown = tone.findings & FG_PICTURE_UNKNOWN_PROFILE ? NAN : shown / (double)sum.count;
  tone.gamma = mean_of(gamma, gammas);
  tone.sharpen_amount = mean_of(sharpen, sharpened);
  tone.sharpen_radius_px = mean_of(radius, sharpened);
  return tone;
}

fg_model_tone fg_scan_loop_find_tone(const fg_scan_loop *loop, bool searched) {
  fg_model_tone plain = find_on(loop, loop->before);
  if (!searched) return plain;
  fg_model_tone corrected = find_on(loop, loop->after);
  if (!plain.gauges || (corrected.gauges && corrected.level.u < plain.level.u)) return corrected;
  return plain;
}
