/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/place.h"

#include <math.h>

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
