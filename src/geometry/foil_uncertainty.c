/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainties of a foil's values: scatter of the edges, the edge model, the tone curve. */
#include "geometry/foil_uncertainty.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/arc_step.h"
#include "geometry/bump_misfit.h"
#include "geometry/land_step.h"
#include "geometry/level_uncertainty.h"
#include "geometry/shadow_uncertainty.h"

/* Max probability of chance at which the edge model's systematic error counts. */
#define EDGE_MODEL_P 0.005
/* Min half-width shift of the overall circle, in standard deviations: it has a single one, no mean
 * of many. */
#define OVERALL_SHIFT_SIGMAS 3.0
/* Thickness, in blurs, below which both edges blur into each other and their places depend on the
 * shape of the blur. */
#define PLATEAU_BLURS 3.0
/* Correlation length, in stations, above which an edge is rough. */
#define ROUGH_STATIONS 3.0

/* Chance of lands as if the scan jumped, below which u holds the jump: of foils without one 1 in
 * 100 may seem to have it, and it costs them uncertainty. */
#define JUMP_CHANCE 0.01

/* Unit vectors of a bump: u from O to C, v across. */
static void bump_axes(const fg_layout *layout, const fg_arc *arc, double axes[2][2]) {
  double dx = arc->circle.x - layout->overall.circle.x;
  double dy = arc->circle.y - layout->overall.circle.y, d = hypot(dx, dy);
  axes[0][0] = dx / d;
  axes[0][1] = dy / d;
  axes[1][0] = -dy / d;
  axes[1][1] = dx / d;
}

/* A shift of (x, y, R) in the bump's axes: (u, v, R). */
static void to_axes(double axes[2][2], const double in[3], double out[3]) {
  for (int i = 0; i < 2; i++)
    out[i] = axes[i][0] * in[0] + axes[i][1] * in[1];
  out[2] = in[2];
}

/* The systematic part of the edge model over all bumps, in the bump's axes: mean square of the
 * half-width shifts beyond what the half width's own noise gives. False when there is none. */
static bool find_edge_model(const fg_layout *layout, const fg_noise_model *noise,
                            double systematic[3][3]) {
  double ratio = 0, bumps = 0;
  memset(systematic, 0, 9 * sizeof(double));
  for (size_t i = 0; i < layout->turning.bump_count; i++) {
    fg_arc arc = layout->bumps[i];
    double shift[3], local[3], axes[2][2];
    if (!layout->fitted[i] || !fg_arc_half_width_shift(&layout->line, &arc, shift)) continue;
    fg_arc_covariance(&layout->line, noise, &arc);
    bump_axes(layout, &arc, axes);
    to_axes(axes, shift, local);
    ratio += shift[2] * shift[2] / arc.covariance[2][2];
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        systematic[p][q] += local[p] * local[q];
    bumps++;
  }
  if (bumps < 1 || !(ratio > gsl_cdf_chisq_Qinv(EDGE_MODEL_P, bumps))) return false;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      systematic[p][q] *= (1 - bumps / ratio) / bumps;
  return true;
}

/* Adds a systematic covariance, given in the bump's axes, to a bump's. */
static void add_systematic(const fg_layout *layout, double systematic[3][3], fg_arc *arc) {
  double axes[2][2], turn[3][3] = {{0}};
  bump_axes(layout, arc, axes);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      turn[j][i] = axes[i][j];
  turn[2][2] = 1;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          arc->covariance[p][q] += turn[p][a] * systematic[a][b] * turn[q][b];
}

/* Adds the overall circle's own half-width shift, where it is more than chance. */
static void add_overall_systematic(fg_layout *layout, const fg_noise_model *half_width) {
  fg_arc arc = layout->overall;
  double shift[3];
  if (!fg_arc_half_width_shift(&layout->line, &arc, shift)) return;
  fg_arc_covariance(&layout->line, half_width, &arc);
  double ratio = shift[2] * shift[2] / arc.covariance[2][2];
  if (!(ratio > OVERALL_SHIFT_SIGMAS * OVERALL_SHIFT_SIGMAS)) return;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      layout->overall.covariance[p][q] += (1 - 1 / ratio) * shift[p] * shift[q];
}

double fg_strip_blur_um(const fg_strip *strip) {
  return fmax(strip->blur_left_um, strip->blur_right_um);
}

double fg_strip_widths_in_blurs(const fg_strip *strip) {
  return 1000 * strip->thickness_mm / fg_strip_blur_um(strip);
}

double fg_strip_coarseness(const fg_strip *strip) {
  return pow(fmax(1, PLATEAU_BLURS / fg_strip_widths_in_blurs(strip)), 3);
}

/* Adds the edge model's own error: a shift of the whole line along its normal. It moves the radius
 * of every circle and the crowns, and nothing else. JPEG's loss and the level of the edges move an
 * edge that is the datum, but not the middle of two edges. */
static void add_line_shift(const fg_layout *layout, const fg_design *design, const fg_foil *foil,
                           fg_arc *arc) {
  const fg_strip *strip = &foil->strip;
  double shift_mm =
      FG_LINE_SHIFT_BLURS * fg_strip_coarseness(strip) * fg_strip_blur_um(strip) / 1000;
  double loss_mm = layout->line.is_edge ? strip->loss_um / 1000 : 0;
  double edge_mm = layout->line.is_edge ? fg_foil_edge_u_mm(design, foil) : 0;
  arc->covariance[2][2] += shift_mm * shift_mm + loss_mm * loss_mm + edge_mm * edge_mm;
}

/* Adds the common error of JPEG's blocks along an edge, which the residuals do not show. */
static void widen_by_loss(const fg_foil *foil, fg_arc *arc) {
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      arc->covariance[p][q] *= 1 + foil->strip.loss_variance;
}

static void find_overall_covariance(fg_layout *layout, const fg_design *design,
                                    const fg_foil *foil) {
  fg_noise_model noise, half_width;
  fg_noise_estimate(&layout->line, &layout->overall, 1, FG_NOISE_OF_LINE, &noise);
  fg_noise_estimate(&layout->line, &layout->overall, 1, FG_NOISE_OF_HALF_WIDTH, &half_width);
  fg_arc_covariance(&layout->line, &noise, &layout->overall);
  fg_arc_cluster_covariance(&layout->line, EDGE_MODEL_P, &layout->overall);
  widen_by_loss(foil, &layout->overall);
  add_overall_systematic(layout, &half_width);
  add_line_shift(layout, design, foil, &layout->overall);
}

/* Mean square of the edges' own standard deviation, which the pixels' noise gives, mm². */
static double pixel_variance(const fg_strip *strip) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < strip->count; i++) {
    const fg_station *s = &strip->stations[i];
    if (!(s->weight > 0)) continue;
    sum += 1e-6 * ((double)s->u_left_um * s->u_left_um + (double)s->u_right_um * s->u_right_um) / 2;
    count++;
  }
  return count > 0 ? sum / count : 0;
}

void fg_foil_find_arc_uncertainty(fg_layout *layout, const fg_design *design, fg_foil *foil) {
  fg_noise_model noise, half_width;
  fg_noise_estimate(&layout->line, &layout->overall, 1, FG_NOISE_OF_LINE, &noise);
  fg_noise_estimate(&layout->line, &layout->overall, 1, FG_NOISE_OF_HALF_WIDTH, &half_width);
  double edge = noise.covariance[0] + half_width.covariance[0];
  foil->noise.sd_um = 1000 * sqrt(noise.covariance[0]);
  foil->noise.correlation_mm = noise.integral_stations * foil->strip.step_mm;
  foil->noise.edge_rough_um = 1000 * sqrt(fmax(edge - pixel_variance(&foil->strip), 0));
  foil->noise.edge_model_um = 0;
  if (noise.integral_stations > ROUGH_STATIONS) foil->flags |= FG_FOIL_ROUGH_EDGE;
  find_overall_covariance(layout, design, foil);
  fg_arc_add_shadow(&layout->line, &layout->overall);
}

static size_t gather_bumps(const fg_layout *layout, fg_arc *arcs) {
  size_t n = 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    if (layout->fitted[i]) arcs[n++] = layout->bumps[i];
  return n;
}

/* Adds what the overall circle changes by if the scan jumps between two lands. */
static void add_land_step(fg_layout *layout) {
  fg_land_step_find(layout);
  const fg_land_step step = layout->land_step;
  for (int p = 0; step.chance < JUMP_CHANCE && p < 3; p++)
    for (int q = 0; q < 3; q++)
      layout->overall.covariance[p][q] += step.change[p] * step.change[q];
}

fg_status fg_foil_find_uncertainties(fg_context *ctx, fg_layout *layout, const fg_design *design,
                                     fg_foil *foil) {
  fg_arc *arcs = NULL;
  fg_noise_model noise, half_width;
  double systematic[3][3];
  FG_TRY(fg_memory_allocate(ctx, layout->turning.bump_count, sizeof *arcs, (void **)&arcs));
  size_t count = gather_bumps(layout, arcs);
  fg_noise_estimate(&layout->line, arcs, count, FG_NOISE_OF_LINE, &noise);
  fg_noise_estimate(&layout->line, arcs, count, FG_NOISE_OF_HALF_WIDTH, &half_width);
  free(arcs);
  foil->noise.sd_um = 1000 * sqrt(noise.covariance[0]);
  foil->noise.correlation_mm = noise.integral_stations * foil->strip.step_mm;
  if (noise.integral_stations > ROUGH_STATIONS) foil->flags |= FG_FOIL_ROUGH_EDGE;
  double rms_limit_mm = fg_misfit_rms_limit(ctx, layout);
  FG_TRY(fg_arc_steps_find(ctx, layout));
  bool found = find_edge_model(layout, &half_width, systematic);
  foil->noise.edge_model_um = found ? 1000 * sqrt(fmax(systematic[2][2], 0)) : 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++) {
    if (!layout->fitted[i]) continue;
    fg_arc_covariance(&layout->line, &noise, &layout->bumps[i]);
    fg_misfit_widen(&layout->line, rms_limit_mm, &layout->bumps[i]);
    widen_by_loss(foil, &layout->bumps[i]);
    if (found) add_systematic(layout, systematic, &layout->bumps[i]);
    add_line_shift(layout, design, foil, &layout->bumps[i]);
    fg_arc_step_add(layout, i);
  }
  find_overall_covariance(layout, design, foil);
  add_land_step(layout);
  return FG_OK;
}

double fg_foil_tone_u_um(const fg_design *design, const fg_foil *foil) {
  const fg_strip *strip = &foil->strip;
  bool fitted = !strip->picture.level_known && !isfinite(strip->picture.u_level);
  double by_gamma = fitted && strip->gamma > 0 ? strip->tone_um * strip->u_gamma / strip->gamma : 0;
  double level = fg_level_uncertainty(design, &strip->picture, foil->flags);
  double blurs_um = fg_level_shift(strip->blur_left_um) + fg_level_shift(strip->blur_right_um);
  return hypot(by_gamma, level * blurs_um);
}

double fg_foil_edge_u_mm(const fg_design *design, const fg_foil *foil) {
  return fg_foil_tone_u_um(design, foil) / 2000;
}

double fg_foil_width_u_um(const fg_design *design, const fg_foil *foil) {
  return hypot(fg_foil_tone_u_um(design, foil), 2 * foil->strip.loss_um);
}

/* Max deviation of a thickness from the design's, as a share, if it is more than U, too: beyond it
 * is another material, another setup or a wrong edge. */
#define OTHER_THICKNESS_SHARE 0.2
#define COVERAGE              2.0

static void check_thickness(const fg_design *design, fg_foil *foil) {
  bool stated = design->thickness_measured_mm > 0;
  double expected = stated ? design->thickness_measured_mm : design->thickness_mm;
  double u = stated ? hypot(foil->thickness.u_scan_mm, design->u_thickness_measured_mm)
                    : foil->thickness.u_scan_mm;
  double off = fabs(foil->thickness.scan_mm - expected);
  if (!(off > COVERAGE * u)) return;
  if (stated) {
    foil->flags |= FG_FOIL_THICKNESS_CONTRADICTS;
    /* Either may be wrong: the value may be off by as much as they differ. */
    foil->thickness.u_mm = hypot(foil->thickness.u_mm, off);
  } else if (off > OTHER_THICKNESS_SHARE * expected)
    foil->flags |= FG_FOIL_OTHER_THICKNESS;
}

void fg_foil_find_thickness(const fg_design *design, fg_foil *foil) {
  double u_mm_of_level = fg_foil_width_u_um(design, foil) / 1000;
  foil->thickness.scan_mm = foil->strip.thickness_mm;
  foil->thickness.u_scan_mm = hypot(foil->strip.u_thickness_mm, u_mm_of_level);
  foil->thickness.u_tone_mm = fg_foil_tone_u_um(design, foil) / 1000;
  bool stated = design->thickness_measured_mm > 0;
  foil->thickness.mm = stated ? design->thickness_measured_mm : foil->thickness.scan_mm;
  foil->thickness.u_mm = stated ? design->u_thickness_measured_mm : foil->thickness.u_scan_mm;
  check_thickness(design, foil);
}
