/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bore's measured profile: radius over angle, which shifts the clearance of every place. */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "core/text.h"
#include "film/bearing.h"
#include "foilgauge/memory.h"
#include "foilgauge/table.h"

/* Share that a radius may differ from the sleeve's. */
static const double off_share = 0.1;
/* The same place, the same radius: a profile may close with its first row. */
static const double same_deg = 1e-6, same_mm = 1e-5;
/* Stretch without rows: wider than between bumps and than some steps is a hole, and a bore whose
 * ovality is not seen (fewer than four rows) is not measured. */
static const double gap_widest_deg = 90, gap_steps = 3;

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

/* A radius that is far off is likely one of another unit. */
static fg_status check_radius(fg_context *ctx, const fg_film_report *r, size_t row,
                              double radius_mm) {
  static const struct {
    double factor;
    const char *words;
  } units[] = {{2, "; it looks like a diameter"},
               {1000, "; it looks like micrometres"},
               {1 / 25.4, "; it looks like inches"}};
  double sleeve_mm = r->design.bumps.sleeve_radius_mm;
  const char *words = "";
  if (fabs(radius_mm - sleeve_mm) <= off_share * sleeve_mm) return FG_OK;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (fabs(radius_mm / units[i].factor - sleeve_mm) <= off_share * sleeve_mm)
      words = units[i].words;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: row %zu: a radius of %g mm is not that of a bore of %g mm%s", r->options.bore,
                 row, radius_mm, sleeve_mm, words);
}

static double gap_behind(const bore_point *points, size_t count, size_t i) {
  double gap = whole_turn(points[(i + 1) % count].angle_deg - points[i].angle_deg);
  return i + 1 == count && gap == 0 ? 360 : gap;
}

/* The step from row to row that half of them keep. */
static fg_status find_usual_step(fg_context *ctx, const bore_point *points, size_t count,
                                 double *step) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
  double *gaps = block;
  for (size_t i = 0; i < count; i++)
    gaps[i] = gap_behind(points, count, i);
  fg_sort(gaps, count);
  *step = gaps[count / 2];
  free(gaps);
  return FG_OK;
}

/* The same angle twice, with two radii; a stretch without rows. */
static fg_status check_angles(fg_context *ctx, const fg_film_report *r, const bore_point *points,
                              size_t count) {
  double step;
  FG_TRY(find_usual_step(ctx, points, count, &step));
  double widest = fmin(gap_widest_deg, fmax(r->options.pitch_deg, gap_steps * step));
  for (size_t i = 0; i < count; i++) {
    const bore_point *next = &points[(i + 1) % count];
    double gap = gap_behind(points, count, i);
    if (gap < same_deg && fabs(next->radius_mm - points[i].radius_mm) > same_mm)
      return fg_fail(ctx, FG_ERR_DATA, "%s: %g degrees are there twice, with %g and %g mm",
                     r->options.bore, points[i].angle_deg, points[i].radius_mm, next->radius_mm);
    if (gap > widest * (1 + same_deg))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: no radius from %g to %g degrees: a profile goes round the whole bore%s",
                     r->options.bore, points[i].angle_deg, next->angle_deg,
                     points[count - 1].angle_deg < 6.3 ? " (are its angles radians?)" : "");
  }
  return FG_OK;
}

static fg_status set_bore_profile(fg_context *ctx, fg_film_report *r, const fg_table *table,
                                  bore_point *points) {
  const fg_extended *angle, *radius;
  double sleeve_mm = r->design.bumps.sleeve_radius_mm;
  FG_TRY(fg_table_numbers(ctx, table, "angle_deg", &angle));
  FG_TRY(fg_table_numbers(ctx, table, "radius_mm", &radius));
  for (size_t i = 0; i < table->rows; i++) {
    points[i] = (bore_point){whole_turn(angle[i].value), radius[i].value};
    FG_TRY(check_radius(ctx, r, i + 1, radius[i].value));
  }
  fg_sort_items(points, table->rows, sizeof *points, compare_bore_points);
  FG_TRY(check_angles(ctx, r, points, table->rows));
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
    status = fg_fail(
        ctx, FG_ERR_DATA,
        "%s: no rows; a profile of the bore has one per direction, with angle_deg and radius_mm",
        r->options.bore);
  if (status == FG_OK) status = fg_memory_allocate(ctx, table.rows, sizeof(bore_point), &points);
  if (status == FG_OK) status = set_bore_profile(ctx, r, &table, points);
  free(points);
  fg_table_free(&table);
  return status;
}

void fg_film_add_bore(const fg_film_report *r, fg_film_bearing *bearing) {
  for (size_t i = 0; i < bearing->count && r->options.bore; i++)
    bearing->clearance_mm[i] += r->bore_shift_mm[i];
}
