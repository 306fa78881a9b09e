/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/defects.h"

/* Min hidden share of a disturbed arc, in one piece or in total. */
#define HIDDEN_RUN   0.15
#define HIDDEN_SHARE 0.35

static unsigned facts_between(const fg_strip *strip, size_t first, size_t last) {
  unsigned facts = 0;
  for (size_t k = first; k <= last; k++)
    facts |= strip->stations[k].facts;
  return facts;
}

static bool is_hidden(const fg_layout *layout, const fg_arc *arc) {
  size_t hidden = 0, run = 0, longest = 0, first = arc->ranges[0].first, last = arc->ranges[0].last;
  for (size_t k = first; k <= last; k++) {
    run = fg_arc_used(&layout->line, arc, k) ? 0 : run + 1;
    hidden += run > 0;
    if (run > longest) longest = run;
  }
  double count = (double)(last - first + 1);
  return (double)longest > HIDDEN_RUN * count || (double)hidden > HIDDEN_SHARE * count;
}

unsigned fg_defect_flags(const fg_layout *layout, size_t i) {
  const fg_strip *strip = layout->line.strip;
  const fg_turning *turning = &layout->turning;
  const fg_arc *arc = &layout->bumps[i];
  size_t before = i > 0 ? turning->bumps[i - 1].last : 0;
  size_t after = i + 1 < turning->bump_count ? turning->bumps[i + 1].first : strip->count - 1;
  unsigned flags = 0;
  if (facts_between(strip, before, after) & FG_STATION_TOUCHED) flags |= FG_BUMP_TOUCHES_OTHER;
  if (facts_between(strip, turning->bumps[i].first, turning->bumps[i].last) & FG_STATION_CUT)
    flags |= FG_BUMP_GAP;
  if (layout->fitted[i] && is_hidden(layout, arc)) flags |= FG_BUMP_DISTURBED_EDGE;
  return flags;
}
