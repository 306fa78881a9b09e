/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas film of one bearing without dimensions, on a mesh: steady pressure under a load, and its
 * first-order response to a rotor that whirls.
 *
 * Units: angles from the bearing's 0 degrees, in the sense of rotation; z over the radius R; film
 * thickness H, deflection w and the rotor's place X, Y over the reference clearance C; pressure P
 * over ambient p_a; loads over p_a R², stiffness over p_a R² / C, time as tau = omega t.
 *   d/dtheta (P H³ dP/dtheta) + d/dz (P H³ dP/dz) = L d(P H)/dtheta + 2 L d(P H)/dtau
 *   L = 6 mu omega (R / C)² / p_a  (compressibility number)
 *   H = c(theta) - X cos(theta) - Y sin(theta) + w(theta)
 * A rotor at (X, Y) has its eccentricity there: the film is thin where it points. A load is the
 * force on the rotor.
 *
 * Foil. The top foil does not bend along the axis: the mean pressure over the length deflects it,
 *   g (P_mean - 1) = a (1 + i gamma) w + B d⁴w/dtheta⁴,
 * stiff between bumps: a = 1, g = compliance, B = 0; sagging: a = the bumps' springs at their
 * places, g = 1, B = the bending stiffness of the top foil, held at its leading edge and free at
 * its trailing edge. gamma is the loss factor of the bumps (hysteretic: it acts on whirling alone).
 * A foil follows pressures below ambient as well: its lifting off the bumps is not modelled.
 *
 * Finite volumes around nodes, conservative. The flux between two nodes has the diffusion that
 * makes it exact for one dimension at constant H (exponential fitting; Scharfetter and Gummel
 * 1969) put on P H: second order where the film is resolved, upwind where L is large, and P H =
 * constant is a solution at infinite L. */
#ifndef FG_FILM_FILM_H
#define FG_FILM_FILM_H

#include "film/sparse.h"
#include "foilgauge/film.h"

typedef struct fg_film_mesh {
  size_t pads, cells, axial; /* cells of a pad along the rotation; of half the length */
  bool ring;                 /* one pad without edges */
  double start_rad, arc_rad; /* leading edge of pad 0; extent of a pad */
  double half_length;        /* over R */
} fg_film_mesh;

/* Foil and film at every column of nodes (fg_film_columns of them). */
typedef struct fg_film_case {
  double lambda, load[2], loss;
  double bending;    /* B; 0: stiff between the bumps */
  double *clearance; /* c */
  double *spring;    /* a */
  double *yield;     /* g */
} fg_film_case;

typedef struct fg_film_state {
  double *pressure;   /* columns × (axial + 1), from the middle to the end of the length */
  double *deflection; /* of a column */
  double place[2];    /* X, Y */
} fg_film_state;

typedef struct fg_film {
  fg_film_mesh mesh;
  size_t columns, nodes; /* nodes of a column */
  double step, step_z;
  double *cosine, *sine;
  int *base;      /* first unknown of a column */
  bool *edge;     /* column at ambient pressure */
  double *weight; /* of a column's nodes in an integral over half the length */
  fg_sparse sparse;
  double *matrix, *time, *lossy; /* d residual / d unknown, d(unknown)/d tau, gamma w */
  double *residual, *shift[2], *shift_time[2]; /* d residual / dX, dY; by their speed */
  double *step_of;                             /* three right-hand sides */
  double complex *whirl, *response;
  fg_film_state trial, kept;
} fg_film;

fg_status fg_film_open(fg_context *ctx, const fg_film_mesh *mesh, bool bends, fg_film *film);
void fg_film_close(fg_film *film);

size_t fg_film_columns(const fg_film_mesh *mesh);
double fg_film_angle_rad(const fg_film_mesh *mesh, size_t column);

fg_status fg_film_case_open(fg_context *ctx, size_t columns, fg_film_case *at);
void fg_film_case_copy(const fg_film_case *from, size_t columns, fg_film_case *to);
void fg_film_case_close(fg_film_case *at);
fg_status fg_film_state_open(fg_context *ctx, const fg_film *film, fg_film_state *state);
void fg_film_state_copy(const fg_film *film, const fg_film_state *from, fg_film_state *to);
void fg_film_state_close(fg_film_state *state);

/* H at a column. */
double fg_film_thickness(const fg_film *film, const fg_film_case *at, const fg_film_state *state,
                         size_t column);

/* Fills the residual and its derivatives. */
void fg_film_assemble(fg_context *ctx, fg_film *film, const fg_film_case *at,
                      const fg_film_state *state);

/* Force of the film on the rotor, less its sign: the integral of (P - 1) (cos, sin). */
void fg_film_force(const fg_film *film, const fg_film_state *state, double force[2]);

/* That of pressures which stand as unknowns. */
void fg_film_force_of(const fg_film *film, const double *vector, double force[2]);

/* Torque on the rotor over mu omega R³ / C × R, and the mean over the nodes: */
double fg_film_torque(const fg_film *film, const fg_film_case *at, const fg_film_state *state);

/* Newton's method from `state` for the pressure alone at the place that it has, or with the place
 * that balances the load. FG_ERR_NUMERIC where it does not converge. */
typedef enum fg_film_unknowns { FG_FILM_PRESSURE, FG_FILM_BALANCE } fg_film_unknowns;
fg_status fg_film_newton(fg_context *ctx, fg_film *film, const fg_film_case *at,
                         fg_film_unknowns unknowns, fg_film_state *state);

/* Follows a solved state from one case to another of the same loss and bending, in as many steps as
 * it takes. FG_ERR_NUMERIC where the path ends; `state` is then that of `from`. */
fg_status fg_film_follow(fg_context *ctx, fg_film *film, const fg_film_case *from,
                         const fg_film_case *to, fg_film_state *state);

/* Solves a case from nothing: ambient pressure and a centred rotor at no load first. */
fg_status fg_film_solve(fg_context *ctx, fg_film *film, const fg_film_case *at,
                        fg_film_state *state);

/* Solves a case from a rotor that is held at a place until its film is known. */
fg_status fg_film_solve_from_place(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                   const double place[2], fg_film_state *state);

/* Impedance of the film against a rotor that moves as exp(s tau): force over displacement; s = i
 * ratio of a whirl at `ratio` times the speed, Z = K + i ratio C. The system must be assembled at
 * the steady state. */
fg_status fg_film_impedance(fg_context *ctx, fg_film *film, const fg_film_case *at,
                            double complex s, double complex impedance[2][2]);

enum { FG_FILM_ROOTS = 2 };
/* Both eigenvalues of the impedance; `near` (may be NULL) keeps their order. */
fg_status fg_film_eigenvalues(fg_context *ctx, fg_film *film, const fg_film_case *at,
                              double complex s, const double complex *near,
                              double complex value[FG_FILM_ROOTS]);

enum { FG_FILM_TRACE_MAX = 256 };
typedef struct fg_film_trace_point {
  double ratio;
  double complex value[FG_FILM_ROOTS];
} fg_film_trace_point;
typedef struct fg_film_trace {
  fg_film_trace_point point[FG_FILM_TRACE_MAX];
  size_t count;
} fg_film_trace;
/* Follows both eigenvalues over the ratio of whirl, in at least so many steps of one factor. */
fg_status fg_film_trace_eigenvalues(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                    const double ratios[2], int steps, fg_film_trace *trace);

/* The mass (of `M omega² C / (p_a R²)`) at which the rotor on this film begins to whirl, 0 where
 * every rotor does, and the ratio of whirl; infinite, and NaN, where none does between the ratios.
 * Rotors heavier than `stable_again` do not whirl (infinite: all do). A film that no rotor rests
 * on, as each falls off its place without a whirl, has mass 0 and ratio 0. */
typedef struct fg_film_threshold {
  double mass, stable_again, ratio;
} fg_film_threshold;
fg_status fg_film_find_threshold(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                 const fg_film_state *state, fg_film_threshold *threshold);

/* Finds out whether a rotor of every mass falls off its place, without a whirl; assembles the
 * system. */
fg_status fg_film_find_fall(fg_context *ctx, fg_film *film, const fg_film_case *at,
                            const fg_film_state *state, bool *falls);

/* Oscillating motions exp(s tau) of a rotor of this mass on its film, the least stable one first:
 * eigenvalues of film and rotor together. */
typedef struct fg_film_motion {
  double complex s; /* its imaginary part above 0 */
  bool forward;     /* its orbit turns with the rotor */
} fg_film_motion;
typedef struct fg_film_motions {
  fg_film_motion motion[FG_FILM_MODES];
  size_t count;
} fg_film_motions;
fg_status fg_film_find_motions(fg_context *ctx, fg_film *film, const fg_film_case *at,
                               const fg_film_state *state, double mass, fg_film_motions *motions);

#endif
