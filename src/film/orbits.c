/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The orbit of the report's rotor, in its units. */
#include <math.h>
#include <stdlib.h>

#include "film/bearing.h"
#include "film/orbit.h"
#include "foilgauge/memory.h"

enum { POINTS_PER_TURN = 32 };
static const double pulse = 0.02; /* of the load */
static const double usual_ratio = 0.5;

/* An orbit whose amplitude changes by less than this share in a turn neither grows nor decays. */
static const double growth_small = 1e-3;

const char *const fg_film_fate_words[] = {
    [FG_FILM_DECAYS] = "decays",        [FG_FILM_GROWS] = "grows",
    [FG_FILM_CYCLES] = "limit cycle",   [FG_FILM_TOUCHES] = "touches",
    [FG_FILM_FATE_UNKNOWN] = "unknown", NULL};

static fg_film_fate find_fate(const fg_film_orbit *orbit, size_t asked) {
  if (orbit->count < asked) return FG_FILM_TOUCHES;
  if (isnan(orbit->growth_per_turn)) return FG_FILM_FATE_UNKNOWN;
  if (orbit->growth_per_turn > growth_small) return FG_FILM_GROWS;
  return orbit->growth_per_turn < -growth_small ? FG_FILM_DECAYS : FG_FILM_CYCLES;
}

static void keep_orbit(const fg_film_report *r, const fg_film_orbit_point *points,
                       fg_film_orbit *orbit) {
  for (size_t i = 0; i < orbit->count; i++) {
    const fg_film_orbit_point *p = &points[i];
    orbit->point[i] =
        (fg_film_orbit_place){p->turn,
                              {p->place[0] * r->clearance_um, p->place[1] * r->clearance_um},
                              p->thinnest * r->clearance_um};
  }
}

/* The whirl at which viscous bumps lose as much as the loss factor says: the rotor's least damped
 * one. */
static double find_loss_ratio(const fg_film_report *r) {
  return r->modes ? r->mode[0].whirl_ratio : usual_ratio;
}

static fg_status integrate_report(fg_context *ctx, fg_film_report *r, fg_film_workspace *w,
                                  fg_film_orbit_point *points) {
  fg_film_orbit *orbit = &r->orbit;
  const fg_film_orbit_plan plan = {.mass = r->options.rotor_mass_kg /
                                           fg_film_mass_unit_kg(r, r->options.speed_rpm),
                                   .loss_ratio = find_loss_ratio(r),
                                   .pulse = pulse,
                                   .turns = r->options.orbit_turns,
                                   .points_per_turn = POINTS_PER_TURN};
  FG_TRY(fg_film_integrate_orbit(ctx, &w->film, &w->at, &w->state, &plan, points, &orbit->count));
  fg_film_orbit_growth growth = fg_film_measure_orbit(points, orbit->count);
  orbit->growth_per_turn = growth.per_turn;
  orbit->whirl_ratio = growth.ratio;
  orbit->fate = find_fate(orbit, plan.turns * POINTS_PER_TURN + 1);
  keep_orbit(r, points, orbit);
  return FG_OK;
}

fg_status fg_film_follow_orbit(fg_context *ctx, fg_film_report *r, fg_film_workspace *w) {
  size_t count = r->options.orbit_turns * POINTS_PER_TURN + 1;
  void *block;
  if (!r->options.orbit_turns) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *r->orbit.point, &block));
  r->orbit.point = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(fg_film_orbit_point), &block));
  fg_status status = integrate_report(ctx, r, w, block);
  free(block);
  return status;
}
