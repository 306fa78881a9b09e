#include <math.h>
#include <stddef.h>

#include "loop/scan_loop.h"
#include "loop/scan_model.h"

/* A value and its uncertainty inside a struct. */
typedef struct value_place {
  size_t value, u;
} value_place;

#define BUMP(name)                                                                                 \
  { offsetof(fg_bump, name), offsetof(fg_bump, u_##name) }
#define OVERALL(name)                                                                              \
  { offsetof(fg_overall, name), offsetof(fg_overall, u_##name) }
#define DISC(name)                                                                                 \
  { offsetof(fg_disc, name), offsetof(fg_disc, u_##name) }

static const value_place bump_places[] = {BUMP(radius_mm),
                                          BUMP(centre_to_centre_mm),
                                          BUMP(bump_angle_deg),
                                          BUMP(intersection_angle_deg),
                                          BUMP(height_mm),
                                          BUMP(clearance_mm),
                                          BUMP(clearance_error),
                                          BUMP(radius_error_pct),
                                          BUMP(bump_angle_error_pct),
                                          BUMP(height_model_mm),
                                          BUMP(bump_angle_model_deg)};
static const value_place overall_places[] = {OVERALL(radius_mm), OVERALL(springback_error_pct)};
static const value_place disc_places[] = {DISC(radius_mm), DISC(diameter_mm)};

#define COUNT(places) (sizeof(places) / sizeof *(places))

static double at(const void *object, size_t place) {
  return *(const double *)((const char *)object + place);
}

/* `farthest` keeps the largest move of each value. */
static void take_moves(const value_place *places, size_t count, const void *chosen,
                       const void *other, double *farthest) {
  for (size_t k = 0; k < count; k++) {
    double move = fabs(at(other, places[k].value) - at(chosen, places[k].value));
    if (move > farthest[k]) farthest[k] = move;
  }
}

static void widen(const value_place *places, size_t count, void *chosen, const double *farthest) {
  for (size_t k = 0; k < count; k++) {
    double *u = (double *)(void *)((char *)chosen + places[k].u);
    *u = hypot(*u, farthest[k] / sqrt(3.0));
  }
}

/* One object of every other explanation. */
typedef const void *object_of(const fg_measurement *m, size_t i, size_t k);

static const void *bump_of(const fg_measurement *m, size_t i, size_t k) {
  return i < m->foil_count && k < m->foils[i].bump_count ? &m->foils[i].bumps[k] : NULL;
}

static const void *overall_of(const fg_measurement *m, size_t i, size_t k) {
  (void)k;
  return i < m->foil_count ? &m->foils[i].overall : NULL;
}

static const void *disc_of(const fg_measurement *m, size_t i, size_t k) {
  (void)k;
  return i < m->disc_count ? &m->discs[i] : NULL;
}

static void widen_object(const value_place *places, size_t count, object_of *object,
                         const fg_measurement *others, size_t other_count, size_t i, size_t k,
                         void *chosen) {
  double farthest[COUNT(bump_places)] = {0};
  for (size_t o = 0; o < other_count; o++) {
    const void *other = object(&others[o], i, k);
    if (other) take_moves(places, count, chosen, other, farthest);
  }
  widen(places, count, chosen, farthest);
}

static void widen_all(const fg_measurement *others, size_t count, fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++) {
    widen_object(overall_places, COUNT(overall_places), overall_of, others, count, f, 0,
                 &m->foils[f].overall);
    for (size_t b = 0; b < m->foils[f].bump_count; b++)
      widen_object(bump_places, COUNT(bump_places), bump_of, others, count, f, b,
                   &m->foils[f].bumps[b]);
  }
  for (size_t d = 0; d < m->disc_count; d++)
    widen_object(disc_places, COUNT(disc_places), disc_of, others, count, d, 0, &m->discs[d]);
}

fg_status fg_scan_model_widen_tie(fg_context *ctx, const fg_scan_model *model,
                                  const fg_measurement *m, unsigned threads,
                                  fg_measurement *corrected) {
  fg_measurement others[FG_SUBSET_CLASS];
  fg_status status = FG_OK;
  size_t count = 0;
  while (count < model->others && status == FG_OK) {
    status = fg_scan_correct(ctx, m, &model->other[count], NULL, 0, NULL, threads, &others[count]);
    if (status == FG_OK) count++;
  }
  if (status == FG_OK) widen_all(others, count, corrected);
  for (size_t o = 0; o < count; o++)
    fg_measurement_free(&others[o]);
  return status;
}
