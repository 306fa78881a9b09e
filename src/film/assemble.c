/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residual of the film's equations on a mesh, and its exact derivatives. */
#include <math.h>
#include <string.h>

#include "film/film.h"

/* A node of a face: its unknowns (-1: none) and values. */
typedef struct film_node {
  int pressure_at, deflection_at;
  double pressure, thickness;
  size_t column;
} film_node;

/* Mass flux from a to b, and its derivatives by pressure and thickness of both. */
typedef struct film_flux {
  double value, by_pressure[2], by_thickness[2];
} film_flux;

/* kappa(x) = coth(x/2) - 2/x and its derivative: the share of upwind diffusion at x = cell's
 * Peclet number. Its series below 0.01, where the closed form cancels. */
static double upwind_share(double x, double *slope) {
  if (x < 0.01) {
    *slope = 1. / 6 - x * x / 120;
    return x / 6 - x * x * x / 360;
  }
  if (x > 100) {
    *slope = 2 / (x * x);
    return 1 - 2 / x;
  }
  double grown = expm1(x); /* coth(x/2) = 1 + 2 / (e^x - 1) */
  *slope = 2 / (x * x) - 2 * (1 + grown) / (grown * grown);
  return 1 + 2 / grown - 2 / x;
}

/* F = L (q_a + q_b)/2 - L kappa(Pe) (q_b - q_a)/2 - P H³ (P_b - P_a)/d, q = P H, with means of P
 * and H, Pe = L d / (P H²). */
static film_flux find_flux(const film_node *a, const film_node *b, double lambda, double distance) {
  double p = (a->pressure + b->pressure) / 2, h = (a->thickness + b->thickness) / 2;
  double drop = (b->pressure - a->pressure) / distance, h3 = h * h * h;
  double q[2] = {a->pressure * a->thickness, b->pressure * b->thickness};
  film_flux f = {.value = -p * h3 * drop};
  for (int k = 0; k < 2; k++) {
    f.by_pressure[k] = -h3 * drop / 2 + (k ? -1 : 1) * p * h3 / distance;
    f.by_thickness[k] = -1.5 * p * h * h * drop;
  }
  if (lambda <= 0) return f;
  double peclet = lambda * distance / (p * h * h), slope;
  double kappa = upwind_share(peclet, &slope), across = lambda * (q[1] - q[0]) / 2;
  f.value += lambda * (q[0] + q[1]) / 2 - kappa * across;
  for (int k = 0; k < 2; k++) {
    const film_node *n = k ? b : a;
    double carried = lambda * (k ? 1 - kappa : 1 + kappa) / 2;
    f.by_pressure[k] += carried * n->thickness + slope * peclet / (2 * p) * across;
    f.by_thickness[k] += carried * n->pressure + slope * peclet / h * across;
  }
  return f;
}

static film_node find_node(const fg_film *film, const fg_film_state *state, size_t column,
                           double thickness, size_t j) {
  bool fixed = film->edge[column] || j == film->mesh.axial;
  return (film_node){.pressure_at = fixed ? -1 : film->base[column] + (int)j,
                     .deflection_at =
                         film->base[column] + (film->edge[column] ? 0 : (int)film->mesh.axial),
                     .pressure = state->pressure[column * film->nodes + j],
                     .thickness = thickness,
                     .column = column};
}

double fg_film_thickness(const fg_film *film, const fg_film_case *at, const fg_film_state *state,
                         size_t column) {
  return at->clearance[column] - state->place[0] * film->cosine[column] -
         state->place[1] * film->sine[column] + state->deflection[column];
}

static void add_entry(fg_context *ctx, fg_film *film, int row, int column, double value) {
  size_t place = fg_sparse_place(ctx, &film->sparse, row, column);
  if (film->matrix) film->matrix[place] += value;
}

static void add_by_time(fg_context *ctx, fg_film *film, int row, int column, double value) {
  size_t place = fg_sparse_place(ctx, &film->sparse, row, column);
  if (film->matrix) film->time[place] += value;
}

/* Adds `sign` times the flux to the balance of a node. */
static void add_flux(fg_context *ctx, fg_film *film, const film_node *of, const film_node *ends[2],
                     const film_flux *f, double sign) {
  int row = of->pressure_at;
  if (row < 0) return;
  film->residual[row] += sign * f->value;
  for (int k = 0; k < 2; k++) {
    const film_node *n = ends[k];
    if (n->pressure_at >= 0) add_entry(ctx, film, row, n->pressure_at, sign * f->by_pressure[k]);
    add_entry(ctx, film, row, n->deflection_at, sign * f->by_thickness[k]);
    film->shift[0][row] -= sign * f->by_thickness[k] * film->cosine[n->column];
    film->shift[1][row] -= sign * f->by_thickness[k] * film->sine[n->column];
  }
}

static void add_face(fg_context *ctx, fg_film *film, const film_node *a, const film_node *b,
                     double lambda, double distance, double area) {
  const film_node *ends[2] = {a, b};
  film_flux f = find_flux(a, b, lambda, distance);
  add_flux(ctx, film, a, ends, &f, area);
  add_flux(ctx, film, b, ends, &f, -area);
}

/* 2 L d(P H)/d tau of a node's volume. */
static void add_volume(fg_context *ctx, fg_film *film, const film_node *n, double lambda,
                       double volume) {
  double by_time = 2 * lambda * volume;
  if (n->pressure_at < 0) return;
  add_by_time(ctx, film, n->pressure_at, n->pressure_at, by_time * n->thickness);
  add_by_time(ctx, film, n->pressure_at, n->deflection_at, by_time * n->pressure);
  film->shift_time[0][n->pressure_at] = -by_time * n->pressure * film->cosine[n->column];
  film->shift_time[1][n->pressure_at] = -by_time * n->pressure * film->sine[n->column];
}

/* Column behind `i` in the sense of rotation; false at the end of a pad. */
static bool find_next_column(const fg_film *film, size_t i, size_t *next) {
  *next = i + 1;
  if (!film->mesh.ring) return (i + 1) % (film->mesh.cells + 1) != 0;
  if (*next == film->columns) *next = 0;
  return true;
}

static void add_column_film(fg_context *ctx, fg_film *film, const fg_film_case *at,
                            const fg_film_state *state, size_t i) {
  size_t next;
  bool joined = find_next_column(film, i, &next);
  double thickness = fg_film_thickness(film, at, state, i);
  double thickness_next = joined ? fg_film_thickness(film, at, state, next) : NAN;
  for (size_t j = 0; j < film->mesh.axial; j++) {
    film_node here = find_node(film, state, i, thickness, j);
    if (joined) {
      film_node there = find_node(film, state, next, thickness_next, j);
      add_face(ctx, film, &here, &there, at->lambda, film->step, film->weight[j]);
    }
    if (film->edge[i]) continue;
    film_node outward = find_node(film, state, i, thickness, j + 1);
    add_face(ctx, film, &here, &outward, 0, film->step_z, film->step);
    add_volume(ctx, film, &here, at->lambda, film->step * film->weight[j]);
  }
}

/* B d⁴w/dtheta⁴ at a node of a pad: w = w' = 0 at its leading edge, where the node before it
 * mirrors the one behind; w'' = w''' = 0 at its trailing edge, which gives two nodes behind it. */
static void find_bending(size_t node, size_t last, double weight[5]) {
  static const double inside[5] = {1, -4, 6, -4, 1};
  static const double before_end[5] = {1, -4, 5, -2, 0}, at_end[5] = {2, -4, 2, 0, 0};
  memcpy(weight, node == last ? at_end : node + 1 == last ? before_end : inside, sizeof inside);
  if (node == 1) {
    weight[2] += weight[0];
    weight[0] = 0;
  }
}

static void add_bending(fg_context *ctx, fg_film *film, const fg_film_case *at,
                        const fg_film_state *state, size_t i, int row) {
  double weight[5], scale = at->bending / pow(film->step, 4);
  size_t last = film->mesh.cells, node = film->mesh.ring ? 2 : i % (last + 1);
  if (node == 0) return;
  find_bending(node, film->mesh.ring ? film->columns : last, weight);
  for (size_t k = 0; k < 5; k++) {
    if (weight[k] == 0) continue;
    size_t other = (i + film->columns + k - 2) % film->columns;
    int column = film->base[other] + (film->edge[other] ? 0 : (int)film->mesh.axial);
    add_entry(ctx, film, row, column, scale * weight[k]);
    film->residual[row] += scale * weight[k] * state->deflection[other];
  }
}

static void add_foil(fg_context *ctx, fg_film *film, const fg_film_case *at,
                     const fg_film_state *state, size_t i) {
  int row = film->base[i] + (film->edge[i] ? 0 : (int)film->mesh.axial);
  size_t place = fg_sparse_place(ctx, &film->sparse, row, row);
  if (film->matrix) {
    film->matrix[place] += at->spring[i];
    film->lossy[place] += at->spring[i];
  }
  film->residual[row] += at->spring[i] * state->deflection[i];
  for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++) {
    double share = at->yield[i] * film->weight[j] / film->mesh.half_length;
    add_entry(ctx, film, row, film->base[i] + (int)j, -share);
    film->residual[row] -= share * (state->pressure[i * film->nodes + j] - 1);
  }
  if (at->bending > 0) add_bending(ctx, film, at, state, i, row);
}

static void clear_system(fg_film *film) {
  size_t size = (size_t)film->sparse.size, entries = film->sparse.entries;
  memset(film->residual, 0, size * sizeof(double));
  for (int k = 0; k < 2; k++) {
    memset(film->shift[k], 0, size * sizeof(double));
    memset(film->shift_time[k], 0, size * sizeof(double));
  }
  if (!film->matrix) return;
  memset(film->matrix, 0, entries * sizeof(double));
  memset(film->time, 0, entries * sizeof(double));
  memset(film->lossy, 0, entries * sizeof(double));
}

void fg_film_assemble(fg_context *ctx, fg_film *film, const fg_film_case *at,
                      const fg_film_state *state) {
  clear_system(film);
  film->sparse.next = 0;
  for (size_t i = 0; i < film->columns; i++) {
    add_column_film(ctx, film, at, state, i);
    add_foil(ctx, film, at, state, i);
  }
}

void fg_film_force(const fg_film *film, const fg_film_state *state, double force[2]) {
  force[0] = force[1] = 0;
  for (size_t i = 0; i < film->columns; i++)
    for (size_t j = 0; j < film->mesh.axial; j++) {
      double part = 2 * film->step * film->weight[j] * (state->pressure[i * film->nodes + j] - 1);
      force[0] += part * film->cosine[i];
      force[1] += part * film->sine[i];
    }
}

/* Shear at the rotor: mu omega R / h + (h / 2 R) dp/dtheta; over mu omega R³ (R / C). The second
 * part is in units of p_a C R² / 2 = mu omega R⁴/C × 3 / L. */
double fg_film_torque(const fg_film *film, const fg_film_case *at, const fg_film_state *state) {
  double sum = 0;
  for (size_t i = 0; i < film->columns; i++) {
    size_t next;
    if (!find_next_column(film, i, &next)) continue;
    double a = fg_film_thickness(film, at, state, i);
    double b = fg_film_thickness(film, at, state, next);
    for (size_t j = 0; j < film->nodes; j++) {
      double drop = state->pressure[next * film->nodes + j] - state->pressure[i * film->nodes + j];
      double pushed = at->lambda > 0 ? 3 / at->lambda * (a + b) / 2 * drop : 0;
      sum += 2 * film->weight[j] * (film->step * 2 / (a + b) + pushed);
    }
  }
  return sum;
}
