/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The film of a round bearing of finite length about its middle against the exact solution of its
 * linear equation: load and attitude at small eccentricity (Ausman 1957, 1961: his first-order
 * perturbation and his linearised P H agree there), and the impedance against a rotor that whirls,
 * on a rigid bearing and on a compliant one.
 *
 * With P = 1 + p, H = 1 + h and h, p as exp(i n theta + s tau), n = 1 and -1, the equation of
 * film/film.h is, to first order, with p = 0 at both ends,
 *   p'' = (1 + q) p + q h,  q = L (i n + 2 s)
 *   mean of p over the length = -a h,  a = q / (1 + q) (1 - tanh(k l) / (k l)),  k² = 1 + q,
 * l the half length over R. A top foil that yields by w = G mean(p), G = g / (1 + i gamma), makes
 * it -a / (1 + G a) times the clearance's change by the rotor. */
#include <complex.h>

#include "support/film_bearing.h"

static const double lambdas[] = {0.1, 0.3, 1, 3, 10, 30, 100}, halves[] = {0.5, 1, 2};
enum { LAMBDAS = sizeof lambdas / sizeof *lambdas, HALVES = sizeof halves / sizeof *halves };

typedef struct case_of_bearing {
  double lambda, half, compliance, loss;
  double complex s;
} case_of_bearing;

static double complex find_share(const case_of_bearing *c, double n) {
  double complex q = c->lambda * (I * n + 2 * c->s), k = csqrt(1 + q) * c->half;
  double complex a = q / (1 + q) * (1 - ctanh(k) / k);
  return a / (1 + c->compliance / (1 + I * c->loss) * a);
}

/* Force by the rotor's place: K + i ratio C. */
static void find_exact(const case_of_bearing *c, double complex z[2][2]) {
  double complex forward = find_share(c, 1), backward = find_share(c, -1);
  z[0][0] = z[1][1] = pi * c->half * (forward + backward);
  z[1][0] = pi * c->half * I * (forward - backward);
  z[0][1] = -z[1][0];
}

/* Fine enough for the scheme's order to show: cells' Peclet numbers near 2 or below, and several
 * cells across the layers at the ends, which are of 1 / sqrt(L). */
static fg_film_mesh choose_mesh(const case_of_bearing *c, size_t finer) {
  double cells = 24 + 3 * c->lambda, axial = fmax(8, 1.5 * c->half * sqrt(c->lambda));
  return ring_of(finer * (size_t)cells, finer * (size_t)axial, c->half);
}

static void find_on_mesh(const case_of_bearing *c, size_t finer, double complex z[2][2]) {
  bearing b;
  const fg_film_mesh mesh = choose_mesh(c, finer);
  open_bearing(&b, &mesh, c->lambda, c->compliance);
  b.at.loss = c->loss;
  fg_film_assemble(&b.ctx, &b.film, &b.at, &b.state);
  assert_int_equal(fg_film_impedance(&b.ctx, &b.film, &b.at, c->s, z), FG_OK);
  close_bearing(&b);
}

/* From two meshes by the order of the scheme, which is 2. */
static void extrapolate(const case_of_bearing *c, double complex z[2][2]) {
  double complex coarse[2][2];
  find_on_mesh(c, 1, coarse);
  find_on_mesh(c, 2, z);
  for (int k = 0; k < 4; k++)
    z[k / 2][k % 2] += (z[k / 2][k % 2] - coarse[k / 2][k % 2]) / 3;
}

/* A load is a force on the rotor: the rotor lies at the attitude from it. */
static void load_and_attitude_are_ausmans(void **unused) {
  (void)unused;
  for (size_t i = 0; i < LAMBDAS * HALVES; i++) {
    const case_of_bearing c = {.lambda = lambdas[i % LAMBDAS], .half = halves[i / LAMBDAS]};
    double complex found[2][2], exact[2][2];
    extrapolate(&c, found);
    find_exact(&c, exact);
    assert_ratio(hypot(creal(found[0][0]), creal(found[1][0])),
                 hypot(creal(exact[0][0]), creal(exact[1][0])), 1e-3);
    assert_ratio(creal(found[0][0]), creal(exact[0][0]), 2e-3);
    assert_ratio(creal(found[1][0]), creal(exact[1][0]), 2e-3);
  }
}

/* A rotor held off the middle carries that load. */
static void light_load_is_ausmans(void **unused) {
  (void)unused;
  const double e = 1e-3;
  for (size_t i = 0; i < HALVES; i++) {
    bearing b;
    const case_of_bearing c = {.lambda = 2, .half = halves[i]};
    const fg_film_mesh mesh = ring_of(96, 48, c.half);
    double complex exact[2][2];
    double force[2];
    find_exact(&c, exact);
    open_bearing(&b, &mesh, c.lambda, 0);
    hold_at(&b, e, 0);
    fg_film_force(&b.film, &b.state, force);
    for (int k = 0; k < 2; k++)
      assert_near(force[k], e * creal(exact[k][0]),
                  2e-3 * e * (cabs(exact[0][0]) + cabs(exact[1][0])));
    close_bearing(&b);
  }
}

/* Ratios of whirl from far below the speed to above it, and a whirl that grows. Near one half of
 * the speed the impedance of fast bearings nearly vanishes: light rotors whirl there. */
static void stiffness_and_damping_are_the_linear_equations(void **unused) {
  (void)unused;
  static const double complex motions[] = {0.05 * I, 0.4 * I, 2 * I, 0.1 + 0.5 * I};
  static const double foils[][2] = {{0, 0}, {0.67, 0.14}, {5, 0.3}};
  enum { MOTIONS = sizeof motions / sizeof *motions, FOILS = sizeof foils / sizeof *foils };
  for (size_t i = 0; i < LAMBDAS - 1; i += 2)
    for (size_t k = 0; k < MOTIONS * FOILS; k++) {
      const case_of_bearing c = {.lambda = lambdas[i],
                                 .half = halves[k % HALVES],
                                 .compliance = foils[k / MOTIONS][0],
                                 .loss = foils[k / MOTIONS][1],
                                 .s = motions[k % MOTIONS]};
      double complex found[2][2], exact[2][2];
      extrapolate(&c, found);
      find_exact(&c, exact);
      for (int j = 0; j < 4; j++)
        assert_near(cabs(found[j / 2][j % 2] - exact[j / 2][j % 2]), 0,
                    2e-3 * (cabs(exact[0][0]) + cabs(exact[1][0])));
    }
}

static void error_falls_with_the_square_of_the_mesh(void **unused) {
  (void)unused;
  const case_of_bearing c = {.lambda = 3, .half = 1, .compliance = 0.67, .loss = 0.14, .s = I / 3};
  double error[3];
  double complex exact[2][2];
  find_exact(&c, exact);
  for (int k = 0; k < 3; k++) {
    double complex found[2][2];
    find_on_mesh(&c, (size_t)1 << k, found);
    error[k] = cabs(found[0][0] - exact[0][0]);
  }
  for (int k = 0; k < 2; k++)
    assert_near(log2(error[k] / error[k + 1]), 2, 0.3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(load_and_attitude_are_ausmans),
      cmocka_unit_test(light_load_is_ausmans),
      cmocka_unit_test(stiffness_and_damping_are_the_linear_equations),
      cmocka_unit_test(error_falls_with_the_square_of_the_mesh),
  };
  return cmocka_run_group_tests_name("film_linear", tests, NULL, NULL);
}
