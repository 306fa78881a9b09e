/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unsampled stretches of a stroke: a dropout, or a rotor under load control that jumps through the
 * gap. */
#include <math.h>

#include "load_test/strokes.h"

/* Number of distances between places that a stretch is compared with on either side; places within
 * this many resolutions are one, as those of a rotor at rest under a weight. */
enum { AROUND = 24, AROUND_MIN = 4 };
static const double place_resolutions = 3;

/* Ratio to the upper quartile of the distances around it from which a stretch is unsampled. Of
 * places at random that is one in a thousand; a gap with a few samples in it stays one. */
static const double hole_factor = 7, smaller_share = 0.75;

double fg_load_stroke_place(const fg_load_stroke *s) {
  return place_resolutions * s->resolution_mm;
}

typedef enum around { FEW, WIDE, DENSE } around;

/* Finds the class of most distances between samples from `i` on, outward. */
static around look_around(const fg_load_stroke *s, size_t i, int step, double small) {
  size_t count = 0, smaller = 0;
  double place = fg_load_stroke_place(s), last = s->x[i];
  while (count < AROUND && (step > 0 ? i + 1 < s->count : i > 0)) {
    i = step > 0 ? i + 1 : i - 1;
    double distance = fabs(s->x[i] - last);
    if (distance < place) continue;
    last = s->x[i];
    smaller += distance < small;
    count++;
  }
  if (count < AROUND_MIN) return FEW;
  return (double)smaller >= smaller_share * (double)count ? DENSE : WIDE;
}

static bool is_hole(const fg_load_stroke *s, size_t i) {
  double small = (s->x[i] - s->x[i - 1]) / hole_factor;
  if (small <= fg_load_stroke_place(s)) return false;
  return look_around(s, i, 1, small) == DENSE || look_around(s, i - 1, -1, small) == DENSE;
}

void fg_load_stroke_find_holes(fg_load_stroke *s) {
  double mean = s->count > 1 ? (s->x[s->count - 1] - s->x[0]) / (double)(s->count - 1) : 0;
  for (size_t i = 0; i < s->count; i++)
    s->after_hole[i] = i && s->x[i] - s->x[i - 1] > mean && is_hole(s, i);
}

bool fg_load_stroke_part(const fg_load_stroke *s, double x, size_t *first, size_t *last) {
  size_t at = fg_load_stroke_from(s, x);
  if (!s->count) return false;
  if (at < s->count && s->after_hole[at] && x < s->x[at]) return false;
  *first = *last = at < s->count ? at : s->count - 1;
  while (*first > 0 && !s->after_hole[*first])
    --*first;
  while (*last + 1 < s->count && !s->after_hole[*last + 1])
    ++*last;
  return true;
}
