/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of the level at which edges are placed. */
#include "geometry/level_uncertainty.h"

#include <math.h>

/* Half-ranges of an unknown tone curve T, after the one fitted exponent. Edges alone do not
 * determine the middle of T: whatever its place, a monotone curve explains the profile. So the rows
 * state the curves that scanners and their drivers have. Each row is a kind, uniform over its
 * range; as the kinds are independent, their variances add (GUM, Type B).
 *
 *   gamma      the fitted exponent is right only as far as the blur is symmetric; it may be wrong
 *              by 30 %. T(1/2) = 0.5^(1/gamma) then lies from 0.37 to 0.59: half-range 0.107
 *   S curve    automatic contrast: slope at its middle from 1 to 2, the middle up to 10 % of the
 *              scale off that of a contrast of 80 % of it: T(1/2) is off by (slope - 1) 0.1 / 0.8,
 *              of which (slope - 1) has a mean square of 1/3: half-range 0.072
 *   toe        and shoulder, a tenth of the scale long at one end: T(1/2) is off by up to 0.05
 *
 * Together 0.080: a quarter of a pixel for each edge at a blur of 1.25 px. */
static const double unknown_tone_half_ranges[] = {0.107, 0.072, 0.05};

/* A sensor that is called linear deviates by some 1 % of its scale. T(1/2) of such a curve is off
 * by at most half of that: uniform. */
#define LINEAR_TONE_SD 0.003

/* Standard deviation of T(1/2) by a finding. A gauge in the same scan goes through the same driver:
 * its level includes all but local effects. */
typedef struct level_row {
  unsigned bit;
  double sd;
  bool local; /* it differs from edge to edge of a scan */
} level_row;

static const level_row findings[] = {
    /* Two levels: their threshold may lie anywhere, uniform over 0 to 1. */
    {FG_PICTURE_FEW_LEVELS, 0.29, false},
    /* A curve was applied after rounding: another unknown tone curve. */
    {FG_PICTURE_LEVEL_GAPS, 0.08, false},
    /* Light beyond the end of the scale differs by edge: its contrast and the light around it.
       u_cut covers the part that all edges may lose, which a gauge's level includes. */
    {FG_PICTURE_CLIPPED, 0.1, true},
    /* Both lobes of an unsharp mask are symmetric until one of them is cut or meets the strip's
       other edge; then one side lacks up to a third of the contrast, and half of that counts. */
    {FG_PICTURE_SHARPENED, 0.1, false},
    /* Slopes up to 4: the S curve above, three times as steep. */
    {FG_PICTURE_TONE_CURVE, 0.15, false},
    /* Quantised blocks have the level of most of their pixels. */
    {FG_PICTURE_BLOCK_NOISE, 0.08, true},
    {FG_PICTURE_UNEVEN_BLUR, 0.05, true},
    /* A band of unknown depth beside one of two edges may count as part of the strip. */
    {FG_PICTURE_SHADOW, 0.25, true},
    {FG_PICTURE_SHADING, 0.05, true},
    {FG_PICTURE_UNKNOWN_PROFILE, 0.2, false},
};

/* Of a foil: halo, wall or a clipped level shape its edges, and all profiles give the same wrong
 * exponent gamma. 23 % of error in gamma near 1 move T(1/2) = 0.5^(1/gamma) by 0.5 ln 2 0.23 =
 * 0.08. */
static const level_row foil_flags[] = {
    {FG_FOIL_ROUGH_EDGE, 0.08, true},
    {FG_FOIL_SIDE_BAND, 0.08, true},
    {FG_FOIL_CLIPPED, 0.08, true},
};

static double add_rows(const level_row *rows, size_t count, unsigned bits, bool known) {
  double variance = 0;
  for (size_t i = 0; i < count; i++)
    if (bits & rows[i].bit && (rows[i].local || !known)) variance += rows[i].sd * rows[i].sd;
  return variance;
}

static double unknown_tone_variance(void) {
  double variance = 0;
  for (size_t i = 0; i < sizeof unknown_tone_half_ranges / sizeof *unknown_tone_half_ranges; i++)
    variance += unknown_tone_half_ranges[i] * unknown_tone_half_ranges[i] / 3;
  return variance;
}

/* An unsharp mask alone, which the edge model includes: its lobes leave at most 0.006, over 36
 * scans of two renderers. */
#define HELD_MASK_SD 0.01

/* Findings whose rows count; those in the edge model are replaced by *held. */
static unsigned open_findings(const fg_picture_state *picture, double *held) {
  const unsigned spoiling = FG_PICTURE_UNKNOWN_PROFILE | FG_PICTURE_TONE_CURVE |
                            FG_PICTURE_CLIPPED | FG_PICTURE_FEW_LEVELS | FG_PICTURE_BLOCK_NOISE;
  bool holds = picture->sharpen_amount > 0 && !(picture->findings & spoiling);
  *held = holds ? HELD_MASK_SD : 0;
  return holds ? picture->findings & ~(unsigned)FG_PICTURE_SHARPENED : picture->findings;
}

/* Variance of a hidden level. When only few levels or a part of the profile are visible, an edge is
 * wider than it looks, and a share of the level moves it by as much more. */
static double hidden_variance(const fg_picture_state *picture, bool known) {
  const unsigned hiding = FG_PICTURE_FEW_LEVELS | FG_PICTURE_CLIPPED;
  double variance = 0;
  if (known || !(picture->findings & hiding)) return 0;
  if (isfinite(picture->u_cut)) variance += picture->u_cut * picture->u_cut;
  if (picture->findings & FG_PICTURE_FEW_LEVELS && picture->seen_blur < 1) {
    double seen = add_rows(findings, 1, FG_PICTURE_FEW_LEVELS, known);
    variance += seen * (1 / (picture->seen_blur * picture->seen_blur) - 1);
  }
  return variance;
}

double fg_level_uncertainty(const fg_design *design, const fg_picture_state *picture,
                            unsigned flags) {
  double held;
  unsigned open = open_findings(picture, &held);
  bool known = picture->level_known;
  double variance = isfinite(picture->u_level) ? picture->u_level * picture->u_level : 0;
  if (!known)
    variance +=
        design->tone == FG_TONE_LINEAR ? LINEAR_TONE_SD * LINEAR_TONE_SD : unknown_tone_variance();
  variance += held * held;
  variance += add_rows(findings, sizeof findings / sizeof *findings, open, known);
  variance += hidden_variance(picture, known);
  /* Halo, wall and clipping mislead the same fit: one of them is as bad as all. */
  double hidden = 0;
  for (size_t i = 0; i < sizeof foil_flags / sizeof *foil_flags; i++)
    hidden = fmax(hidden, add_rows(&foil_flags[i], 1, flags, known));
  return sqrt(variance + hidden);
}

double fg_level_shift(double blur) {
  return blur * sqrt(2 * M_PI);
}

void fg_disc_find_level_uncertainty(const fg_design *design, fg_disc *disc) {
  double level = fg_level_uncertainty(design, &disc->picture, 0);
  disc->level_u_mm = hypot(disc->edge_u_mm, level * fg_level_shift(disc->blur_um) / 1000);
}
