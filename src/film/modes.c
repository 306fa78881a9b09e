/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Motions of a rotor on its film by itself: the roots of det(M s² + Z(s)) = 0, which are
 * eigenvalues of film and rotor together, since Z(s) holds the whole film.
 *
 * Starts: along the imaginary axis an eigenvalue of Z is taken as linear between two points, so
 * that M s² + lambda(s) has two roots; one that turns about as fast as the point does is followed
 * by Newton's method, with the slope of a chord. A whirl that grows or decays within a fraction of
 * a turn is found from there as well. */
#include <math.h>

#include "film/bearing.h"

/* Ratios of whirl from which roots are sought: heavy rotors whirl far below the speed. */
static const double ratios[] = {1e-3, 1e2};
enum { STEPS = 40, ITERATIONS_MAX = 30 };
/* A start may turn this much faster or slower than its point. */
static const double near_factor = 1.6;
static const double root_close = 1e-10; /* last step over the root */
static const double root_same = 1e-6;

const char *const fg_film_direction_words[] = {
    [FG_FILM_FORWARD] = "forward", [FG_FILM_BACKWARD] = "backward", NULL};

typedef struct root_search {
  fg_film *film;
  const fg_film_case *at;
  double mass;
  fg_film_motions *found;
} root_search;

/* The eigenvalue of Z(s) that is nearest to `lambda`, which it replaces. */
static fg_status find_nearest(fg_context *ctx, const root_search *search, double complex s,
                              double complex *lambda) {
  double complex value[FG_FILM_ROOTS];
  FG_TRY(fg_film_eigenvalues(ctx, search->film, search->at, s, NULL, value));
  *lambda = cabs(value[0] - *lambda) <= cabs(value[1] - *lambda) ? value[0] : value[1];
  return FG_OK;
}

/* Follows M s² + lambda(s) to its root by chords. */
static fg_status refine_root(fg_context *ctx, const root_search *search, double complex lambda,
                             double complex *s, bool *known) {
  double complex before = *s * (1 + 1e-4 * I), now = *s;
  FG_TRY(find_nearest(ctx, search, before, &lambda));
  double complex f_before = search->mass * before * before + lambda;
  *known = false;
  for (int i = 0; i < ITERATIONS_MAX && !*known; i++) {
    FG_TRY(find_nearest(ctx, search, now, &lambda));
    double complex f = search->mass * now * now + lambda;
    double complex step = f == f_before ? 0 : -f * (now - before) / (f - f_before);
    before = now;
    f_before = f;
    now += step;
    if (!isfinite(creal(now)) || !isfinite(cimag(now)) || cabs(now) > 2 * ratios[1]) return FG_OK;
    *known = cabs(step) < root_close * cabs(now);
  }
  *s = now;
  *known = *known && cimag(now) > root_same * cabs(now);
  return FG_OK;
}

static bool is_kept(const fg_film_motions *found, double complex s) {
  for (size_t i = 0; i < found->count; i++)
    if (cabs(found->motion[i].s - s) < root_same * cabs(s)) return true;
  return false;
}

/* The orbit of (Z + M s²) x = 0: forward where y is behind x. */
static fg_status is_forward(fg_context *ctx, const root_search *search, double complex s,
                            bool *forward) {
  double complex z[2][2];
  FG_TRY(fg_film_impedance(ctx, search->film, search->at, s, z));
  double complex own[2] = {z[0][0] + search->mass * s * s, z[1][1] + search->mass * s * s};
  bool first = cabs(own[0]) + cabs(z[0][1]) > cabs(own[1]) + cabs(z[1][0]);
  double complex x = first ? -z[0][1] : -own[1], y = first ? own[0] : z[1][0];
  *forward = cimag(conj(x) * y) < 0;
  return FG_OK;
}

/* From whirl to whirl. */
static double growth_of(double complex s) {
  return creal(s) / cimag(s);
}

static fg_status keep_root(fg_context *ctx, const root_search *search, double complex s) {
  fg_film_motions *found = search->found;
  fg_film_motion motion = {.s = s};
  if (is_kept(found, s)) return FG_OK;
  FG_TRY(is_forward(ctx, search, s, &motion.forward));
  size_t place = found->count;
  while (place && growth_of(found->motion[place - 1].s) < growth_of(s))
    place--;
  if (place == FG_FILM_MODES) return FG_OK;
  if (found->count < FG_FILM_MODES) found->count++;
  for (size_t i = found->count - 1; i > place; i--)
    found->motion[i] = found->motion[i - 1];
  found->motion[place] = motion;
  return FG_OK;
}

/* Roots of M s² + lambda + slope (s - i ratio) that turn about as fast as the point. */
static fg_status search_from(fg_context *ctx, const root_search *search, double ratio,
                             double complex lambda, double complex slope) {
  double complex root = csqrt(slope * slope - 4 * search->mass * (lambda - slope * I * ratio));
  for (int sign = -1; sign <= 1; sign += 2) {
    double complex s = (-slope + sign * root) / (2 * search->mass);
    bool known;
    if (!(cimag(s) > ratio / near_factor && cimag(s) < ratio * near_factor)) continue;
    FG_TRY(refine_root(ctx, search, lambda, &s, &known));
    if (known) FG_TRY(keep_root(ctx, search, s));
  }
  return FG_OK;
}

fg_status fg_film_find_motions(fg_context *ctx, fg_film *film, const fg_film_case *at,
                               const fg_film_state *state, double mass, fg_film_motions *motions) {
  const root_search search = {film, at, mass, motions};
  fg_film_trace trace;
  motions->count = 0;
  fg_film_assemble(ctx, film, at, state);
  FG_TRY(fg_film_trace_eigenvalues(ctx, film, at, ratios, STEPS, &trace));
  for (size_t i = 1; i < trace.count; i++) {
    const fg_film_trace_point *low = &trace.point[i - 1], *high = &trace.point[i];
    for (int k = 0; k < FG_FILM_ROOTS; k++)
      FG_TRY(search_from(ctx, &search, high->ratio, high->value[k],
                         (high->value[k] - low->value[k]) / (I * (high->ratio - low->ratio))));
  }
  return FG_OK;
}

static fg_film_mode mode_of(const fg_film_motion *motion, double speed_rpm) {
  static const double full_turn = 2 * 3.14159265358979323846;
  double growth = creal(motion->s), turning = cimag(motion->s);
  return (fg_film_mode){.whirl_ratio = turning,
                        .frequency_hz = turning * speed_rpm / 60,
                        .log_decrement = -full_turn * growth / turning,
                        .damping_ratio = -growth / cabs(motion->s),
                        .direction = motion->forward ? FG_FILM_FORWARD : FG_FILM_BACKWARD};
}

fg_status fg_film_find_modes(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                             fg_film_result *result, fg_film_modes *modes) {
  fg_film_motions motions;
  double mass = r->options.rotor_mass_kg / fg_film_mass_unit_kg(r, result->speed_rpm);
  modes->count = 0;
  if (result->outcome == FG_FILM_UNSOLVED) return FG_OK;
  FG_TRY(fg_film_find_motions(ctx, &workspace->film, &workspace->at, &workspace->state, mass,
                              &motions));
  modes->count = motions.count;
  for (size_t i = 0; i < motions.count; i++)
    modes->mode[i] = mode_of(&motions.motion[i], result->speed_rpm);
  if (modes->count) result->log_decrement = modes->mode[0].log_decrement;
  if (fg_film_falls_off(result)) result->log_decrement = -INFINITY;
  return FG_OK;
}
