/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rotor that whirls: impedance of the film, and the mass from which on it is unstable.
 *
 * A rigid rotor of mass M on this bearing moves as X exp(s tau): (M s² + Z(s)) X = 0 in units of
 * the speed. On a border of stability s = i nu, so that M nu² is an eigenvalue of Z(nu), real and
 * above 0 (Pan 1964: the film's equivalent stiffness, where its damping vanishes). Heavier rotors
 * have one growing whirl more where the damping gets positive with the frequency there, one less
 * where it gets negative. Where the equivalent stiffness is below 0 no rotor is light enough: it is
 * a border at mass 0. */
#include <math.h>

#include "film/film.h"

/* Ratios of whirl that are searched: gas films whirl near one half of the speed, foils with
 * stiffness of their own below. */
static const double ratios[] = {0.02, 1.5};
enum { STEPS = 13, REFINEMENTS = 20 };
static const double ratio_close = 1e-7;

static void force_of_response(const fg_film *film, const double complex *vector,
                              double complex force[2]) {
  force[0] = force[1] = 0;
  for (size_t i = 0; i < film->columns; i++) {
    if (film->edge[i]) continue;
    double complex sum = 0;
    for (size_t j = 0; j < film->mesh.axial; j++)
      sum += film->weight[j] * vector[film->base[i] + (int)j];
    force[0] += 2 * film->step * sum * film->cosine[i];
    force[1] += 2 * film->step * sum * film->sine[i];
  }
}

/* Matrix of the response at exp(s tau): J + s T + i gamma S, S the springs of the bumps. */
fg_status fg_film_impedance(fg_context *ctx, fg_film *film, const fg_film_case *at,
                            double complex s, double complex impedance[2][2]) {
  size_t size = (size_t)film->sparse.size;
  for (size_t k = 0; k < film->sparse.entries; k++)
    film->whirl[k] = film->matrix[k] + s * film->time[k] + I * at->loss * film->lossy[k];
  for (size_t l = 0; l < 2; l++)
    for (size_t k = 0; k < size; k++)
      film->response[l * size + k] = -film->shift[l][k] - s * film->shift_time[l][k];
  FG_TRY(fg_sparse_factor_complex(ctx, &film->sparse, film->whirl));
  FG_TRY(fg_sparse_solve_complex(ctx, &film->sparse, film->response, 2));
  for (size_t l = 0; l < 2; l++) {
    double complex force[2];
    force_of_response(film, film->response + l * size, force);
    impedance[0][l] = force[0];
    impedance[1][l] = force[1];
  }
  return FG_OK;
}

static void find_eigenvalues(double complex z[2][2], double complex value[FG_FILM_ROOTS]) {
  double complex mean = (z[0][0] + z[1][1]) / 2;
  double complex root = csqrt((z[0][0] - z[1][1]) * (z[0][0] - z[1][1]) / 4 + z[0][1] * z[1][0]);
  value[0] = mean + root;
  value[1] = mean - root;
}

fg_status fg_film_eigenvalues(fg_context *ctx, fg_film *film, const fg_film_case *at,
                              double complex s, const double complex *near,
                              double complex value[FG_FILM_ROOTS]) {
  double complex z[2][2];
  FG_TRY(fg_film_impedance(ctx, film, at, s, z));
  find_eigenvalues(z, value);
  if (!near) return FG_OK;
  double kept = cabs(value[0] - near[0]) + cabs(value[1] - near[1]);
  double turned = cabs(value[1] - near[0]) + cabs(value[0] - near[1]);
  if (turned < kept) {
    double complex other = value[0];
    value[0] = value[1];
    value[1] = other;
  }
  return FG_OK;
}

/* A mass from which on the rotor has one growing whirl more, or one less (`more` -1). */
typedef struct border {
  double mass, ratio;
  int more;
} border;
enum { BORDERS_MAX = 8 };

/* A stretch of ratios in which the imaginary part of eigenvalue `root` changes its sign. */
typedef struct crossing {
  double low, high;
  double complex at_low[FG_FILM_ROOTS], at_high[FG_FILM_ROOTS];
  int root;
} crossing;

/* Narrows it by false position (Illinois). */
static fg_status refine_crossing(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                 crossing *c, border *found) {
  double complex middle[FG_FILM_ROOTS] = {0};
  double f_low = cimag(c->at_low[c->root]), f_high = cimag(c->at_high[c->root]), ratio = c->low;
  int side = 0;
  for (int i = 0; i < REFINEMENTS; i++) {
    ratio = (c->low * f_high - c->high * f_low) / (f_high - f_low);
    FG_TRY(
        fg_film_eigenvalues(ctx, film, at, I * ratio, side > 0 ? c->at_high : c->at_low, middle));
    double f = cimag(middle[c->root]);
    bool above = (f > 0) == (f_high > 0);
    double moved = above ? c->high - ratio : ratio - c->low;
    if (above) {
      c->high = ratio, f_high = f;
      if (side == 1) f_low /= 2;
    } else {
      c->low = ratio, f_low = f;
      if (side == -1) f_high /= 2;
    }
    side = above ? 1 : -1;
    for (int k = 0; k < FG_FILM_ROOTS; k++)
      (above ? c->at_high : c->at_low)[k] = middle[k];
    if (fabs(moved) < ratio_close * ratio || f == 0) break;
  }
  double stiffness = creal(middle[c->root]);
  *found = (border){fmax(0, stiffness / (ratio * ratio)), ratio, f_high > 0 ? 1 : -1};
  return FG_OK;
}

/* Puts a border among the others, lighter ones first. */
static void add_border(const border *found, border *borders, size_t *count) {
  size_t place = *count;
  if (*count == BORDERS_MAX) return;
  while (place && borders[place - 1].mass > found->mass) {
    borders[place] = borders[place - 1];
    place--;
  }
  borders[place] = *found;
  ++*count;
}

/* The lightest unstable rotor, and the heaviest one. */
static fg_film_threshold read_borders(const border *borders, size_t count) {
  fg_film_threshold threshold = {INFINITY, INFINITY, NAN};
  int growing = 0;
  for (size_t i = 0; i < count; i++) {
    growing += borders[i].more;
    if (i + 1 < count && borders[i + 1].mass == borders[i].mass) continue;
    if (growing > 0 && isinf(threshold.mass)) {
      threshold.mass = borders[i].mass;
      threshold.ratio = borders[i].ratio;
    }
    if (isfinite(threshold.mass)) threshold.stable_again = growing > 0 ? INFINITY : borders[i].mass;
  }
  return threshold;
}

/* No rotor rests where the stiffness without a whirl has a determinant below 0: M s² + Z(s) = 0 has
 * a root s above 0 at every mass. Such a film lies between two others, on either side. */
fg_status fg_film_find_fall(fg_context *ctx, fg_film *film, const fg_film_case *at,
                            const fg_film_state *state, bool *falls) {
  double complex z[2][2];
  fg_film_case lossless = *at;
  lossless.loss = 0; /* of bumps that whirl */
  fg_film_assemble(ctx, film, at, state);
  FG_TRY(fg_film_impedance(ctx, film, &lossless, 0, z));
  *falls = creal(z[0][0] * z[1][1] - z[0][1] * z[1][0]) < 0;
  return FG_OK;
}

/* Borders where an eigenvalue of the trace passes the real axis. */
static fg_status find_borders(fg_context *ctx, fg_film *film, const fg_film_case *at,
                              const fg_film_trace *trace, border *borders, size_t *count) {
  for (size_t i = 1; i < trace->count; i++) {
    const fg_film_trace_point *low = &trace->point[i - 1], *high = &trace->point[i];
    for (int k = 0; k < FG_FILM_ROOTS; k++) {
      if ((cimag(low->value[k]) < 0) == (cimag(high->value[k]) < 0)) continue;
      crossing c = {low->ratio,
                    high->ratio,
                    {low->value[0], low->value[1]},
                    {high->value[0], high->value[1]},
                    k};
      border found;
      FG_TRY(refine_crossing(ctx, film, at, &c, &found));
      add_border(&found, borders, count);
    }
  }
  return FG_OK;
}

fg_status fg_film_find_threshold(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                 const fg_film_state *state, fg_film_threshold *threshold) {
  border borders[BORDERS_MAX];
  size_t count = 0;
  fg_film_trace trace;
  bool falls;
  FG_TRY(fg_film_find_fall(ctx, film, at, state, &falls));
  *threshold = (fg_film_threshold){.mass = 0, .stable_again = INFINITY, .ratio = 0};
  if (falls) return FG_OK;
  FG_TRY(fg_film_trace_eigenvalues(ctx, film, at, ratios, STEPS, &trace));
  FG_TRY(find_borders(ctx, film, at, &trace, borders, &count));
  *threshold = read_borders(borders, count);
  return FG_OK;
}
