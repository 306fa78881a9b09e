/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/place.h"

#include <math.h>

#include "core/select.h"

void fg_place_from_trace(const fg_trace *trace, fg_foil *foil) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  int64_t *box = foil->strip.box_px;
  for (size_t i = 0; i < trace->count; i++) {
    low[0] = fmin(low[0], trace->points[i].x);
    low[1] = fmin(low[1], trace->points[i].y);
    high[0] = fmax(high[0], trace->points[i].x);
    high[1] = fmax(high[1], trace->points[i].y);
  }
  for (int k = 0; k < 2; k++) {
    box[k] = (int64_t)floor(low[k]);
    box[2 + k] = (int64_t)ceil(high[k] - low[k]) + 1;
  }
}

static void move_point(fg_point *p, const double by_mm[2]) {
  p->x += by_mm[0];
  p->y += by_mm[1];
}

void fg_place_move(const int64_t origin_px[2], const double dpi[2], fg_foil *foil) {
  double by_mm[2];
  for (int k = 0; k < 2; k++) {
    by_mm[k] = (double)origin_px[k] * 25.4 / dpi[k];
    foil->strip.box_px[k] += origin_px[k];
    foil->place_mm[k] = (double)foil->strip.box_px[k] * 25.4 / dpi[k];
    foil->place_mm[2 + k] = (double)foil->strip.box_px[2 + k] * 25.4 / dpi[k];
  }
  move_point(&foil->overall.centre_mm, by_mm);
  for (size_t i = 0; i < foil->bump_count; i++)
    move_point(&foil->bumps[i].centre_mm, by_mm);
  for (size_t i = 0; i < foil->strip.count; i++) {
    move_point(&foil->strip.stations[i].left, by_mm);
    move_point(&foil->strip.stations[i].right, by_mm);
  }
  for (int i = 0; i < 2; i++) {
    move_point(&foil->strip.ends[i].left, by_mm);
    move_point(&foil->strip.ends[i].right, by_mm);
  }
}

static int compare_boxes(const void *a, const void *b) {
  const int64_t *p = ((const fg_foil *)a)->strip.box_px, *q = ((const fg_foil *)b)->strip.box_px;
  if (p[1] != q[1]) return (p[1] > q[1]) - (p[1] < q[1]);
  return (p[0] > q[0]) - (p[0] < q[0]);
}

static int compare_columns(const void *a, const void *b) {
  const int64_t *p = ((const fg_foil *)a)->strip.box_px, *q = ((const fg_foil *)b)->strip.box_px;
  if (p[0] != q[0]) return (p[0] > q[0]) - (p[0] < q[0]);
  return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Returns true where two foils lie side by side: their heights overlap by half of the lower one's.
 */
static bool is_beside(const fg_foil *a, const fg_foil *b) {
  const int64_t *p = a->strip.box_px, *q = b->strip.box_px;
  int64_t top = p[1] > q[1] ? p[1] : q[1];
  int64_t low = p[1] + p[3] < q[1] + q[3] ? p[1] + p[3] : q[1] + q[3];
  return 2 * (low - top) > (p[3] < q[3] ? p[3] : q[3]);
}

/* Foils that lie beside the tallest one of a row, from its top on, are that row of the bed. */
void fg_place_sort_foils(fg_measurement *m) {
  if (!m->foil_count) return;
  fg_sort_items(m->foils, m->foil_count, sizeof *m->foils, compare_boxes);
  for (size_t first = 0; first < m->foil_count;) {
    size_t next = first + 1, tallest = first;
    while (next < m->foil_count && is_beside(&m->foils[next], &m->foils[tallest])) {
      if (m->foils[next].strip.box_px[3] > m->foils[tallest].strip.box_px[3]) tallest = next;
      next++;
    }
    fg_sort_items(m->foils + first, next - first, sizeof *m->foils, compare_columns);
    first = next;
  }
  for (size_t i = 0; i < m->foil_count; i++)
    m->foils[i].number = (int)i + 1;
}
