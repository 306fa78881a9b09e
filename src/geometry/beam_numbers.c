/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/beam_numbers.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"

/* Cosine of the max angle to their mean direction at which beams are parallel. */
#define PARALLEL_COSINE 0.7071 /* cos 45 degrees */

/* A gap is a whole number of pitches when it is within this share of a pitch of it. */
#define WHOLE_SHARE 0.25
/* Tolerance, in pitches, of the foil's middle against the middle that a number of missing end beams
 * predicts. The box of a foil askew by more than some 45 degrees may end at the tips. It then moves
 * with the missing beam, and cannot tell which end lacks one. */
#define MIDDLE_SHARE 0.3

/* Place of a beam in the order. */
typedef struct place {
  fg_beam beam;
  double row, column;
  size_t line; /* its row, from 0 */
  int index;   /* its place in the row, from 0 */
} place;

static int by_row(const void *a, const void *b) {
  const place *p = a, *q = b;
  return (p->row > q->row) - (p->row < q->row);
}

static int by_column(const void *a, const void *b) {
  const place *p = a, *q = b;
  return (p->column > q->column) - (p->column < q->column);
}

static fg_point beam_middle(const fg_beam *beam) {
  return (fg_point){0.5 * (beam->root_mm.x + beam->tip_mm.x),
                    0.5 * (beam->root_mm.y + beam->tip_mm.y)};
}

static double length_of(const fg_beam *beam) {
  return hypot(beam->tip_mm.x - beam->root_mm.x, beam->tip_mm.y - beam->root_mm.y);
}

/* Finds the mean direction, when all beams are parallel. */
static bool find_direction(const fg_foil *foil, fg_point *mean) {
  *mean = (fg_point){0, 0};
  for (size_t i = 0; i < foil->beam_count; i++) {
    double angle = foil->beams[i].direction_deg * M_PI / 180;
    mean->x += cos(angle);
    mean->y += sin(angle);
  }
  double size = hypot(mean->x, mean->y);
  if (!(size > 0)) return false;
  mean->x /= size;
  mean->y /= size;
  for (size_t i = 0; i < foil->beam_count; i++) {
    double angle = foil->beams[i].direction_deg * M_PI / 180;
    if (cos(angle) * mean->x + sin(angle) * mean->y < PARALLEL_COSINE) return false;
  }
  return true;
}

/* Sorts into rows from the tips down, by the roots, which a torn beam keeps; a row ends where the
 * next root lies half a length lower. */
static size_t sort_rows(place *places, size_t count, fg_point up) {
  double longest = 0;
  size_t rows = 0;
  for (size_t i = 0; i < count; i++) {
    fg_point root = places[i].beam.root_mm;
    places[i].row = -(root.x * up.x + root.y * up.y);
    places[i].column = root.y * up.x - root.x * up.y;
    longest = fmax(longest, length_of(&places[i].beam));
  }
  fg_sort_items(places, count, sizeof *places, by_row);
  for (size_t first = 0; first < count;) {
    size_t next = first + 1;
    while (next < count && places[next].row - places[next - 1].row < 0.5 * longest)
      next++;
    fg_sort_items(places + first, next - first, sizeof *places, by_column);
    for (size_t i = first; i < next; i++)
      places[i].line = rows;
    rows++;
    first = next;
  }
  return rows;
}

/* Finds the pitch: the smallest gap, evened out over the others by their multiples. */
static double find_pitch(const double *gaps, size_t count) {
  double min = INFINITY, sum = 0, steps = 0;
  for (size_t i = 0; i < count; i++)
    min = fmin(min, gaps[i]);
  for (size_t i = 0; i < count; i++) {
    sum += gaps[i];
    steps += round(gaps[i] / min);
  }
  return count && min > 0 ? sum / steps : NAN;
}

static size_t gaps_in_rows(const place *places, size_t count, double *gaps) {
  size_t n = 0;
  for (size_t i = 1; i < count; i++)
    if (places[i].line == places[i - 1].line) gaps[n++] = places[i].column - places[i - 1].column;
  return n;
}

/* Number of `missing` places before the first one, of those at the ends of the rows: the foil's
 * middle is that of its box. -1: unknown. */
static int count_before(const fg_foil *foil, fg_point up, double first, double pitch, int span,
                        int missing) {
  const double *box = foil->place_mm;
  if (!missing) return 0;
  if (foil->flags & FG_FOIL_TOUCHES_BORDER || !(box[2] > 0 && box[3] > 0)) return -1;
  fg_point centre = {box[0] + box[2] / 2, box[1] + box[3] / 2};
  double middle = centre.y * up.x - centre.x * up.y;
  double off = (first + (span - 1) * pitch / 2 - middle) / pitch;
  double before = off + missing / 2.0, whole = round(before);
  if (fabs(before - whole) > MIDDLE_SHARE || whole < 0 || whole > missing) return -1;
  return (int)whole;
}

/* Places beams in rows, which have the same places, at one pitch. False: the empty ones are
 * unknown. */
static bool place_in_rows(const fg_foil *foil, size_t stated, place *places, size_t rows,
                          fg_point up, double *gaps) {
  size_t count = foil->beam_count;
  int span = 1, each = (int)(stated / rows);
  double first = INFINITY, pitch = find_pitch(gaps, gaps_in_rows(places, count, gaps));
  if (stated % rows || !(pitch > 0)) return false;
  for (size_t i = 0; i < count; i++)
    first = fmin(first, places[i].column);
  for (size_t i = 0; i < count; i++) {
    double steps = (places[i].column - first) / pitch;
    places[i].index = (int)lround(steps);
    if (fabs(steps - places[i].index) > WHOLE_SHARE) return false;
    if (places[i].index >= span) span = places[i].index + 1;
  }
  /* So few beams that the pitch may be half of it: every other one may be missing. */
  if (span > each || 2 * span - 1 <= each) return false;
  int before = count_before(foil, up, first, pitch, span, each - span);
  for (size_t i = 0; i < count; i++) {
    places[i].index += before + (int)places[i].line * each;
    if (i && places[i].index <= places[i - 1].index) return false;
  }
  return before >= 0;
}

/* Clockwise as seen (y runs down: rising angles), from after the widest gap. */
static void sort_around(place *places, size_t count) {
  fg_point centre = {0, 0};
  for (size_t i = 0; i < count; i++) {
    fg_point m = beam_middle(&places[i].beam);
    centre.x += m.x / (double)count;
    centre.y += m.y / (double)count;
  }
  for (size_t i = 0; i < count; i++) {
    fg_point m = beam_middle(&places[i].beam);
    places[i].column = atan2(m.y - centre.y, m.x - centre.x);
  }
  fg_sort_items(places, count, sizeof *places, by_column);
  double widest = -1, start = 0;
  for (size_t i = 0; i < count; i++) {
    const place *before = &places[(i + count - 1) % count];
    double gap = places[i].column - before->column + (i ? 0 : 2 * M_PI);
    if (gap <= widest + 1e-6) continue;
    widest = gap;
    start = places[i].column;
  }
  for (size_t i = 0; i < count; i++)
    if (places[i].column < start) places[i].column += 2 * M_PI;
  fg_sort_items(places, count, sizeof *places, by_column);
}

/* From 0 to 2 pi. */
static double turn_to(const place *from, const place *to) {
  double turn = (to->beam.direction_deg - from->beam.direction_deg) * M_PI / 180;
  return turn - 2 * M_PI * floor(turn / (2 * M_PI));
}

/* Counts places of the beams after the gap before `start`; 0: a gap is no whole number of pitches.
 */
static int count_around(const place *places, size_t count, size_t start, double pitch) {
  int index = 0;
  for (size_t k = 1; k < count; k++) {
    double gap = turn_to(&places[(start + k - 1) % count], &places[(start + k) % count]) / pitch;
    if (fabs(gap - round(gap)) > WHOLE_SHARE || gap < WHOLE_SHARE) return 0;
    index += (int)lround(gap);
  }
  return index + 1;
}

/* Places beams around a ring: they point away from its middle, or turn with it. The order starts
 * after the one gap that leaves as many places as the design has beams. */
static bool place_around(const fg_foil *foil, size_t stated, place *places, double *gaps) {
  size_t count = foil->beam_count, starts = 0, start = 0;
  for (size_t i = 0; i < count; i++)
    gaps[i] = turn_to(&places[i], &places[(i + 1) % count]);
  double pitch = INFINITY;
  for (size_t i = 0; i < count; i++)
    pitch = fmin(pitch, gaps[i]);
  for (size_t i = 0; i < count && pitch > 0; i++) {
    if (count_around(places, count, i, pitch) != (int)stated) continue;
    starts++;
    start = i;
  }
  if (starts != 1) return false;
  const place first = places[start];
  for (size_t i = 0; i < count; i++) {
    places[i].column = i == start ? 0 : turn_to(&first, &places[i]);
    places[i].index = (int)lround(places[i].column / pitch);
  }
  fg_sort_items(places, count, sizeof *places, by_column);
  return true;
}

/* Numbers by places where beams are missing; else, and where the places are unknown, by order. */
static void number_beams(const fg_design *design, place *places, size_t rows, fg_point up,
                         double *gaps, fg_foil *foil) {
  size_t count = foil->beam_count, stated = design->beams.count;
  bool lacks = count && count < stated, placed = false;
  if (lacks && rows) placed = place_in_rows(foil, stated, places, rows, up, gaps);
  if (lacks && !rows) placed = place_around(foil, stated, places, gaps);
  if (placed) foil->flags |= FG_FOIL_MISSING_BEAM;
  if (lacks && !placed) foil->flags |= FG_FOIL_BEAM_PLACES_UNKNOWN;
  for (size_t i = 0; i < count; i++) {
    foil->beams[i] = places[i].beam;
    foil->beams[i].number = (placed ? places[i].index : (int)i) + 1;
  }
}

fg_status fg_beams_number(fg_context *ctx, const fg_design *design, fg_foil *foil) {
  place *places = NULL;
  double *gaps = NULL;
  fg_point up;
  size_t count = foil->beam_count, rows = 0;
  fg_status status = FG_OK;
  bool parallel = find_direction(foil, &up);
  foil->rotation_deg = parallel ? atan2(up.y, up.x) * 180 / M_PI : NAN;
  foil->flags &= ~(unsigned)(FG_FOIL_MISSING_BEAM | FG_FOIL_BEAM_PLACES_UNKNOWN);
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *places, (void **)&places));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *gaps, (void **)&gaps));
  for (size_t i = 0; i < count; i++)
    places[i].beam = foil->beams[i];
  if (parallel)
    rows = sort_rows(places, count, up);
  else
    sort_around(places, count);
  number_beams(design, places, rows, up, gaps, foil);
exit:
  free(places);
  free(gaps);
  return status;
}
