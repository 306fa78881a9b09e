/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layout of a lot's bumps around a bearing. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lot/statistics/analysis.h"

static size_t find_highest_bump(const fg_lot_analysis *analysis) {
  int highest = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < analysis->foils[i].foil->bump_count; k++)
      if (analysis->foils[i].foil->bumps[k].number > highest)
        highest = analysis->foils[i].foil->bumps[k].number;
  return (size_t)highest;
}

static size_t clamp_count(size_t value, size_t low, size_t high) {
  return value < low ? low : value > high ? high : value;
}

/* Completes the recipe's layout by the design: a place for every bump from the first on, at the
 * design's pitch, and as many pads as fit around. Bumps are equally spaced where the recipe states
 * pads and bumps but no pitch, or where the pads do not fit at the design's pitch. */
static void resolve_layout(const fg_lot_analysis *analysis, size_t bumps,
                           fg_bearing_layout *layout) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  *layout = settings->layout;
  bool equal = layout->pads && layout->bumps_per_pad && !(layout->pitch_deg > 0);
  double pitch = layout->pitch_deg > 0 ? layout->pitch_deg : settings->design.bumps.pitch_deg;
  if (!layout->bumps_per_pad)
    layout->bumps_per_pad = bumps >= layout->first_bump ? bumps + 1 - layout->first_bump : 1;
  layout->bumps_per_pad = clamp_count(layout->bumps_per_pad, 1, FG_BEARING_BUMPS_MAX);
  size_t max = FG_BEARING_BUMPS_MAX / layout->bumps_per_pad;
  if (!layout->pads)
    layout->pads = (size_t)floor(360 * (1 + 1e-6) / ((double)layout->bumps_per_pad * pitch));
  layout->pads = clamp_count(layout->pads, 1, max);
  bool fits = (double)(layout->pads * layout->bumps_per_pad) * pitch <= 360 * (1 + 1e-6);
  layout->pitch_deg = equal || !fits ? 0 : pitch;
}

static void describe_contradiction(const fg_design *design, const fg_bearing_layout *layout,
                                   size_t bumps, char *note, size_t size) {
  size_t last = layout->first_bump + layout->bumps_per_pad - 1;
  double pitch = fg_bearing_pitch_deg(layout);
  size_t used = 0;
  note[0] = 0;
  if (layout->first_bump > 1 || last < bumps)
    used = (size_t)snprintf(note, size,
                            "The bearing has places for bumps %zu to %zu of each foil, the design "
                            "has %zu bumps: the others are in no bearing. ",
                            layout->first_bump, last, bumps);
  if (fabs(pitch / design->bumps.pitch_deg - 1) > 0.005)
    snprintf(note + used, size - used,
             "Its places are %.4g° apart, the design's bumps %.4g°: clearances stand at other "
             "angles than the bumps. ",
             pitch, design->bumps.pitch_deg);
  if (note[0])
    snprintf(note + strlen(note), size - strlen(note),
             "pads, bumps_per_pad and bump_pitch_deg of the recipe say so; null takes the "
             "design's.");
}

void fg_lot_find_layout(fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  size_t bumps = design->bumps.count ? design->bumps.count : find_highest_bump(analysis);
  resolve_layout(analysis, bumps, &analysis->layout);
  describe_contradiction(design, &analysis->layout, bumps, analysis->layout_note,
                         sizeof analysis->layout_note);
}
