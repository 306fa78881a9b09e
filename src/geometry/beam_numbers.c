#include "geometry/beam_numbers.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"

/* Beams point the same way when none is further than this from their mean direction. */
#define SAME_WAY 0.7071 /* cos 45 degrees */

/* Where a beam stands in the order. */
typedef struct place {
  fg_beam beam;
  double row, column;
} place;

static int by_row(const void *a, const void *b) {
  const place *p = a, *q = b;
  return (p->row > q->row) - (p->row < q->row);
}

static int by_column(const void *a, const void *b) {
  const place *p = a, *q = b;
  return (p->column > q->column) - (p->column < q->column);
}

static fg_point middle_of(const fg_beam *beam) {
  return (fg_point){0.5 * (beam->root_mm.x + beam->tip_mm.x),
                    0.5 * (beam->root_mm.y + beam->tip_mm.y)};
}

static double length_of(const fg_beam *beam) {
  return hypot(beam->tip_mm.x - beam->root_mm.x, beam->tip_mm.y - beam->root_mm.y);
}

/* The mean direction, when all point that way. */
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
    if (cos(angle) * mean->x + sin(angle) * mean->y < SAME_WAY) return false;
  }
  return true;
}

/* Rows from the tips down, by the roots, which a beam that is torn off keeps; a row ends where the
 * next root lies half a length lower. */
static void sort_rows(place *places, size_t count, fg_point up) {
  double longest = 0;
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
    first = next;
  }
}

/* Clockwise as seen (y runs down: rising angles), from after the widest gap. */
static void sort_around(place *places, size_t count) {
  fg_point centre = {0, 0};
  for (size_t i = 0; i < count; i++) {
    fg_point m = middle_of(&places[i].beam);
    centre.x += m.x / (double)count;
    centre.y += m.y / (double)count;
  }
  for (size_t i = 0; i < count; i++) {
    fg_point m = middle_of(&places[i].beam);
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

fg_status fg_beams_number(fg_context *ctx, fg_foil *foil) {
  place *places;
  fg_point up;
  size_t count = foil->beam_count;
  bool same_way = find_direction(foil, &up);
  foil->rotation_deg = same_way ? atan2(up.y, up.x) * 180 / M_PI : NAN;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *places, (void **)&places));
  for (size_t i = 0; i < count; i++)
    places[i].beam = foil->beams[i];
  if (same_way)
    sort_rows(places, count, up);
  else
    sort_around(places, count);
  for (size_t i = 0; i < count; i++) {
    foil->beams[i] = places[i].beam;
    foil->beams[i].number = (int)i + 1;
  }
  free(places);
  return FG_OK;
}
