/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bore's measured profile: radius over angle, which shifts the clearance of every place. */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "core/text.h"
#include "film/bearing.h"
#include "foilgauge/memory.h"
#include "foilgauge/table.h"

typedef struct bore_point {
  double angle_deg, radius_mm;
} bore_point;

static int compare_bore_points(const void *left, const void *right) {
  const bore_point *a = left, *b = right;
  return (a->angle_deg > b->angle_deg) - (a->angle_deg < b->angle_deg);
}

static double whole_turn(double angle_deg) {
  double rest = fmod(angle_deg, 360);
  return rest < 0 ? rest + 360 : rest;
}

/* Linear between the points, which go round. */
static double radius_at(const bore_point *points, size_t count, double angle_deg) {
  size_t next = 0;
  double at = whole_turn(angle_deg);
  while (next < count && points[next].angle_deg <= at)
    next++;
  const bore_point *a = &points[(next + count - 1) % count], *b = &points[next % count];
  double span = whole_turn(b->angle_deg - a->angle_deg);
  double share = span > 0 ? whole_turn(at - a->angle_deg) / span : 0;
  return a->radius_mm + share * (b->radius_mm - a->radius_mm);
}

static fg_status take_profile(fg_context *ctx, fg_film_report *r, const fg_table *table,
                              bore_point *points) {
  const fg_extended *angle, *radius;
  double sleeve_mm = r->design.bumps.sleeve_radius_mm;
  FG_TRY(fg_table_numbers(ctx, table, "angle_deg", &angle));
  FG_TRY(fg_table_numbers(ctx, table, "radius_mm", &radius));
  for (size_t i = 0; i < table->rows; i++) {
    points[i] = (bore_point){whole_turn(angle[i].value), radius[i].value};
    if (fabs(radius[i].value - sleeve_mm) > sleeve_mm / 10)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: row %zu: a radius of %g mm is not that of a bore of %g mm",
                     r->options.bore, i + 1, radius[i].value, sleeve_mm);
  }
  fg_sort_items(points, table->rows, sizeof *points, compare_bore_points);
  for (size_t i = 0; i < r->bearing.count; i++)
    r->bore_shift_mm[i] = radius_at(points, table->rows, r->bearing.angle_deg[i]) - sleeve_mm;
  return FG_OK;
}

fg_status fg_film_read_bore(fg_context *ctx, fg_film_report *r) {
  fg_table table = {0};
  void *points = NULL;
  if (!r->options.bore) return FG_OK;
  fg_text_clip(r->bore_path, sizeof r->bore_path, "%s", r->options.bore);
  fg_status status = fg_table_load(ctx, r->options.bore, &table, r->bore_sha256);
  if (status == FG_OK && !table.rows)
    status = fg_fail(ctx, FG_ERR_DATA, "%s: no rows", r->options.bore);
  if (status == FG_OK) status = fg_memory_allocate(ctx, table.rows, sizeof(bore_point), &points);
  if (status == FG_OK) status = take_profile(ctx, r, &table, points);
  free(points);
  fg_table_free(&table);
  return status;
}

void fg_film_add_bore(const fg_film_report *r, fg_film_bearing *bearing) {
  for (size_t i = 0; i < bearing->count && r->options.bore; i++)
    bearing->clearance_mm[i] += r->bore_shift_mm[i];
}
