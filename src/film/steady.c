/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steady film: Newton's method on all pressures, deflections and the rotor's place, and the
 * path from one case to another. */
#include <math.h>
#include <string.h>

#include "film/film.h"

enum { ITERATIONS_MAX = 25 };

/* Newton has converged when its last step is this small, of pressures, thicknesses and places over
 * their units: the error is then far below. */
static const double step_small = 1e-8;

/* A step takes no more than this share of a pressure or a thickness: both stay above 0. */
static const double share_max = 0.8;

/* Shortest step of a path from case (0) to case (1). */
static const double path_step_min = 1. / 32;

/* Thickness that the first guess lifts the foil to. */
static const double guess_thickness = 0.05;

void fg_film_force_of(const fg_film *film, const double *vector, double force[2]) {
  force[0] = force[1] = 0;
  for (size_t i = 0; i < film->columns; i++) {
    if (film->edge[i]) continue;
    double sum = 0;
    for (size_t j = 0; j < film->mesh.axial; j++)
      sum += film->weight[j] * vector[film->base[i] + (int)j];
    force[0] += 2 * film->step * sum * film->cosine[i];
    force[1] += 2 * film->step * sum * film->sine[i];
  }
}

/* Finds the step of the rotor that balances the load; adds its part of the pressures' step. */
static bool add_place_step(const fg_film *film, const fg_film_case *at, const fg_film_state *state,
                           double *steps, double place_step[2]) {
  size_t size = (size_t)film->sparse.size;
  double now[2], by_residual[2], by[2][2], lack[2];
  fg_film_force(film, state, now);
  fg_film_force_of(film, steps, by_residual);
  for (int k = 0; k < 2; k++) {
    fg_film_force_of(film, steps + (size_t)(k + 1) * size, by[k]);
    lack[k] = by_residual[k] - (at->load[k] - now[k]);
  }
  double determinant = by[0][0] * by[1][1] - by[0][1] * by[1][0];
  if (!(fabs(determinant) > 0)) return false;
  place_step[0] = (lack[0] * by[1][1] - by[1][0] * lack[1]) / determinant;
  place_step[1] = (by[0][0] * lack[1] - lack[0] * by[0][1]) / determinant;
  for (size_t i = 0; i < size; i++)
    steps[i] -= place_step[0] * steps[size + i] + place_step[1] * steps[2 * size + i];
  return true;
}

static size_t deflection_at(const fg_film *film, size_t column) {
  return (size_t)film->base[column] + (film->edge[column] ? 0 : film->mesh.axial);
}

static double shorten(double share, double value, double step) {
  return step < 0 ? fmin(share, share_max * value / -step) : share;
}

/* Share of the step that keeps pressures and thicknesses above 0; `size` gets its largest part. */
static double find_share(const fg_film *film, const fg_film_case *at, const fg_film_state *state,
                         const double *step, const double place_step[2], double *size) {
  double share = 1;
  *size = fmax(fabs(place_step[0]), fabs(place_step[1]));
  for (size_t i = 0; i < film->columns; i++) {
    double thicker = step[deflection_at(film, i)] - place_step[0] * film->cosine[i] -
                     place_step[1] * film->sine[i];
    share = shorten(share, fg_film_thickness(film, at, state, i), thicker);
    *size = fmax(*size, fabs(thicker));
    for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++) {
      double more = step[film->base[i] + (int)j], now = state->pressure[i * film->nodes + j];
      share = shorten(share, now, more);
      *size = fmax(*size, fabs(more) / fmax(1, now));
    }
  }
  return share;
}

static void apply_step(const fg_film *film, fg_film_state *state, const double *step,
                       const double place_step[2], double share) {
  for (size_t i = 0; i < film->columns; i++) {
    state->deflection[i] += share * step[deflection_at(film, i)];
    for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++)
      state->pressure[i * film->nodes + j] += share * step[film->base[i] + (int)j];
  }
  for (int k = 0; k < 2; k++)
    state->place[k] += share * place_step[k];
}

static fg_status fail_to_converge(fg_context *ctx) {
  return fg_fail(ctx, FG_ERR_NUMERIC,
                 "the film's pressure does not converge: lower the load, or raise the speed");
}

fg_status fg_film_newton(fg_context *ctx, fg_film *film, const fg_film_case *at,
                         fg_film_unknowns unknowns, fg_film_state *state) {
  size_t size = (size_t)film->sparse.size;
  int columns = unknowns == FG_FILM_BALANCE ? 3 : 1;
  for (int i = 0; i < ITERATIONS_MAX; i++) {
    double place_step[2] = {0, 0}, largest;
    fg_film_assemble(ctx, film, at, state);
    for (size_t k = 0; k < size; k++)
      film->step_of[k] = -film->residual[k];
    memcpy(film->step_of + size, film->shift[0], size * sizeof(double));
    memcpy(film->step_of + 2 * size, film->shift[1], size * sizeof(double));
    FG_TRY(fg_sparse_factor(ctx, &film->sparse, film->matrix));
    FG_TRY(fg_sparse_solve(ctx, &film->sparse, film->step_of, columns));
    if (columns == 3 && !add_place_step(film, at, state, film->step_of, place_step))
      return fail_to_converge(ctx);
    double share = find_share(film, at, state, film->step_of, place_step, &largest);
    if (!isfinite(largest) || !(share > 0)) return fail_to_converge(ctx);
    apply_step(film, state, film->step_of, place_step, share);
    if (largest < step_small) return FG_OK;
  }
  return fail_to_converge(ctx);
}

static void mix_columns(const double *from, const double *to, size_t count, double share,
                        double *mixed) {
  for (size_t i = 0; i < count; i++)
    mixed[i] = from[i] + share * (to[i] - from[i]);
}

static void mix_cases(const fg_film_case *from, const fg_film_case *to, size_t columns,
                      double share, fg_film_case *mixed) {
  mix_columns(from->clearance, to->clearance, columns, share, mixed->clearance);
  mix_columns(from->spring, to->spring, columns, share, mixed->spring);
  mix_columns(from->yield, to->yield, columns, share, mixed->yield);
  mix_columns(from->load, to->load, 2, share, mixed->load);
  mixed->lambda = from->lambda * pow(to->lambda / from->lambda, share);
  mixed->bending = to->bending;
  mixed->loss = to->loss;
}

/* The foil yields to a new clearance that would touch the rotor, and pressure holds it there. */
static void lift_foil(const fg_film *film, const fg_film_case *at, fg_film_state *state) {
  for (size_t i = 0; i < film->columns; i++) {
    double lack = guess_thickness - fg_film_thickness(film, at, state, i);
    if (lack <= 0 || film->edge[i]) continue;
    state->deflection[i] += lack;
    if (at->yield[i] <= 0) continue;
    for (size_t j = 0; j < film->mesh.axial; j++)
      state->pressure[i * film->nodes + j] += lack * at->spring[i] / at->yield[i];
  }
}

static bool has_film(const fg_film *film, const fg_film_case *at, const fg_film_state *state) {
  for (size_t i = 0; i < film->columns; i++)
    if (fg_film_thickness(film, at, state, i) <= 0) return false;
  return true;
}

static fg_status follow_path(fg_context *ctx, fg_film *film, const fg_film_case *from,
                             const fg_film_case *to, fg_film_case *mixed, fg_film_state *state) {
  double done = 0, step = 1;
  while (done < 1) {
    double next = fmin(1, done + step);
    mix_cases(from, to, film->columns, next, mixed);
    fg_film_state_copy(film, state, &film->trial);
    lift_foil(film, mixed, &film->trial);
    fg_status status = has_film(film, mixed, &film->trial)
                           ? fg_film_newton(ctx, film, mixed, FG_FILM_BALANCE, &film->trial)
                           : fail_to_converge(ctx);
    if (status == FG_OK) {
      fg_film_state_copy(film, &film->trial, state);
      done = next;
      step *= 2;
    } else if (status == FG_ERR_NUMERIC && step > path_step_min) {
      step /= 2;
    } else {
      return status;
    }
  }
  return FG_OK;
}

fg_status fg_film_follow(fg_context *ctx, fg_film *film, const fg_film_case *from,
                         const fg_film_case *to, fg_film_state *state) {
  fg_film_case mixed;
  FG_TRY(fg_film_case_open(ctx, film->columns, &mixed));
  fg_film_state_copy(film, state, &film->kept);
  fg_status status = follow_path(ctx, film, from, to, &mixed, state);
  if (status != FG_OK) fg_film_state_copy(film, &film->kept, state);
  fg_film_case_close(&mixed);
  return status;
}

static void set_ambient(const fg_film *film, fg_film_state *state) {
  for (size_t i = 0; i < film->columns; i++) {
    state->deflection[i] = 0;
    for (size_t j = 0; j < film->nodes; j++)
      state->pressure[i * film->nodes + j] = 1;
  }
  state->place[0] = state->place[1] = 0;
}

fg_status fg_film_solve(fg_context *ctx, fg_film *film, const fg_film_case *at,
                        fg_film_state *state) {
  fg_film_case centred;
  FG_TRY(fg_film_case_open(ctx, film->columns, &centred));
  fg_film_case_copy(at, film->columns, &centred);
  centred.load[0] = centred.load[1] = 0;
  for (size_t i = 0; i < film->columns; i++)
    centred.clearance[i] = 1;
  set_ambient(film, state);
  fg_status status = fg_film_newton(ctx, film, &centred, FG_FILM_BALANCE, state);
  if (status == FG_OK) status = fg_film_follow(ctx, film, &centred, at, state);
  fg_film_case_close(&centred);
  return status;
}

fg_status fg_film_solve_from_place(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                   const double place[2], fg_film_state *state) {
  set_ambient(film, state);
  for (int k = 0; k < 2; k++)
    state->place[k] = place[k];
  lift_foil(film, at, state);
  if (!has_film(film, at, state)) return fail_to_converge(ctx);
  FG_TRY(fg_film_newton(ctx, film, at, FG_FILM_PRESSURE, state));
  return fg_film_newton(ctx, film, at, FG_FILM_BALANCE, state);
}
