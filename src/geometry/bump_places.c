/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/bump_places.h"

#include <math.h>

#include "core/select.h"

enum { GAPS_MAX = 512 };
/* Max deviation of a gap from whole pitches, in pitches. */
#define WHOLE_SHARE 0.25
#define DEG         (180 / M_PI)

double fg_places_turn(double from_deg, double to_deg) {
  double d = to_deg - from_deg;
  return d - 360 * round(d / 360);
}

static double gap_before(const fg_foil *foil, size_t i) {
  return fabs(fg_places_turn(foil->bumps[i - 1].position_deg, foil->bumps[i].position_deg));
}

/* Finds the pitch: the design's, changed by springback, which keeps lengths along the strip. Where
 * most gaps are no multiple of it (another foil's design), their median is the pitch. */
static double find_pitch(const fg_design *design, const fg_foil *foil) {
  double pitch = design->bumps.pitch_deg * design->overall_radius_mm / foil->overall.radius_mm;
  double gaps[GAPS_MAX], units[GAPS_MAX];
  size_t count = 0, whole = 0;
  for (size_t i = 1; i < foil->bump_count && count < GAPS_MAX; i++) {
    double gap = gap_before(foil, i), places = round(gap / pitch);
    gaps[count++] = gap;
    if (places >= 1 && fabs(gap / pitch - places) < WHOLE_SHARE) units[whole++] = gap / places;
  }
  if (2 * whole > count) return fg_select(units, whole, whole / 2);
  return count >= 3 ? fg_select(gaps, count, count / 2) : pitch;
}

static int places_before(const fg_foil *foil, size_t i, double pitch_deg) {
  int places = (int)lround(gap_before(foil, i) / pitch_deg);
  return places > 1 ? places : 1;
}

/* Direction from O of the lip's bend at one end of the strip, or else of the strip's end. */
static double end_direction(const fg_layout *layout, const fg_foil *foil, bool last) {
  const fg_strip *strip = layout->line.strip;
  size_t at = last ? strip->count - 1 : 0;
  if (last ? layout->turning.lip_last : layout->turning.lip_first)
    at = layout->turning.lip_end[last];
  fg_point p = fg_strip_middle(strip, at);
  return DEG * atan2(p.y - foil->overall.centre_mm.y, p.x - foil->overall.centre_mm.x);
}

/* Returns true when the bumps' order is against the stations'. */
static bool is_reversed(const fg_layout *layout, const fg_foil *foil) {
  if (foil->bump_count > 1)
    return foil->bumps[0].arc_start_mm > foil->bumps[foil->bump_count - 1].arc_start_mm;
  if (foil->flags & FG_FOIL_NO_LIP) return layout->turning.sense > 0;
  return layout->turning.lip_last;
}

/* Number of additional bumps that fit on the land between the first or last bump in order and the
 * strip's end next to it: the first needs its chord, every other one a pitch. */
static double room_at(const fg_layout *layout, const fg_nominal *nominal, const fg_foil *foil,
                      bool last, double pitch_deg) {
  const fg_bump *bump = &foil->bumps[last ? foil->bump_count - 1 : 0];
  double foot = DEG * asin(fmin(nominal->half_chord_mm / foil->overall.radius_mm, 1));
  double end = end_direction(layout, foil, last != is_reversed(layout, foil));
  double land = fabs(fg_places_turn(bump->position_deg, end));
  return 1 + (land - 3 * foot) / pitch_deg;
}

/* Number of `missing` bumps before the first: each goes to the end that has more room left. */
static int share_missing(const fg_layout *layout, const fg_nominal *nominal, fg_foil *foil,
                         double pitch_deg, int missing) {
  double first = room_at(layout, nominal, foil, false, pitch_deg);
  double last = room_at(layout, nominal, foil, true, pitch_deg);
  int before = 0;
  for (; missing > 0 && fmax(first, last) >= 1; missing--) {
    foil->flags |= FG_FOIL_MISSING_BUMP;
    before += first >= last;
    *(first >= last ? &first : &last) -= 1;
  }
  return before;
}

void fg_places_number(const fg_layout *layout, const fg_design *design, const fg_nominal *nominal,
                      fg_foil *foil) {
  size_t n = foil->bump_count;
  double pitch = find_pitch(design, foil);
  int places = 1;
  for (size_t i = 1; i < n; i++)
    places += places_before(foil, i, pitch);
  if (places > (int)n) foil->flags |= FG_FOIL_MISSING_BUMP;
  int missing = (int)design->bumps.count - places;
  int number = 1 + share_missing(layout, nominal, foil, pitch, missing);
  for (size_t i = 0; i < n; i++) {
    if (i > 0) number += places_before(foil, i, pitch);
    foil->bumps[i].number = number;
  }
  if (design->bumps.count && n != design->bumps.count) foil->flags |= FG_FOIL_BUMP_COUNT;
}
