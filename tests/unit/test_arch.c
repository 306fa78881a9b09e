/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The arch model against a frame of straight beam elements, against strain energy integrated from
 * the equilibrium of a cut arch, and at its limits. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/bearing.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;
static const fg_arch gen2 = {3.32, 63.15, 0.1};

static fg_arch_material steel(double friction) {
  return (fg_arch_material){200, 0.3, friction};
}

static double free_stiffness(fg_arch arch, double friction, fg_arch_stiffness *all) {
  fg_context ctx;
  fg_arch_material material = steel(friction);
  assert_ok(&ctx, fg_arch_free(&ctx, &arch, &material, all));
  return all->stiffness_n_mm2;
}

/* A plane frame of straight Euler-Bernoulli elements along the arc from psi0 to psi1: it knows
 * nothing of Castigliano. */
enum { ELEMENTS = 160, NODES = ELEMENTS + 1, UNKNOWNS = 3 * NODES };

typedef struct frame {
  double *stiffness, *force;
  double x[NODES], y[NODES];
} frame;

static void add_element(frame *f, int at, double axial, double bending) {
  double dx = f->x[at + 1] - f->x[at], dy = f->y[at + 1] - f->y[at], length = hypot(dx, dy);
  double c = dx / length, s = dy / length, a = axial / length, b = bending / pow(length, 3);
  const double local[6][6] = {
      {a, 0, 0, -a, 0, 0},
      {0, 12 * b, 6 * b * length, 0, -12 * b, 6 * b * length},
      {0, 6 * b * length, 4 * b * length * length, 0, -6 * b * length, 2 * b * length * length},
      {-a, 0, 0, a, 0, 0},
      {0, -12 * b, -6 * b * length, 0, 12 * b, -6 * b * length},
      {0, 6 * b * length, 2 * b * length * length, 0, -6 * b * length, 4 * b * length * length}};
  double turn[6][6] = {{0}};
  for (int i = 0; i < 6; i += 3) {
    turn[i][i] = turn[i + 1][i + 1] = c;
    turn[i][i + 1] = s;
    turn[i + 1][i] = -s;
    turn[i + 2][i + 2] = 1;
  }
  for (int i = 0; i < 6; i++)
    for (int k = 0; k < 6; k++) {
      double sum = 0;
      for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++)
          sum += turn[p][i] * local[p][q] * turn[q][k];
      f->stiffness[(size_t)(3 * at + i) * UNKNOWNS + (size_t)(3 * at + k)] += sum;
    }
}

static void build(frame *f, fg_arch arch, double from, double to) {
  double t = arch.thickness_mm, e = 200e3 / (1 - 0.3 * 0.3);
  f->stiffness = calloc((size_t)UNKNOWNS * UNKNOWNS, sizeof(double));
  f->force = calloc(UNKNOWNS, sizeof(double));
  assert_non_null(f->stiffness);
  for (int i = 0; i < NODES; i++) {
    double psi = from + (to - from) * i / ELEMENTS;
    f->x[i] = arch.radius_mm * sin(psi);
    f->y[i] = arch.radius_mm * cos(psi);
  }
  for (int i = 0; i < ELEMENTS; i++)
    add_element(f, i, e * t, e * t * t * t / 12);
}

static void hold(frame *f, int unknown) {
  f->stiffness[(size_t)unknown * UNKNOWNS + (size_t)unknown] += 1e12;
}

/* Gaussian elimination; the displacements replace the forces. Elements join neighbours only, so
 * nothing lies farther than five from the diagonal. */
static void solve(frame *f) {
  for (int i = 0; i < UNKNOWNS; i++)
    for (int k = i + 1; k < UNKNOWNS && k <= i + 5; k++) {
      double share = f->stiffness[(size_t)k * UNKNOWNS + (size_t)i] /
                     f->stiffness[(size_t)i * UNKNOWNS + (size_t)i];
      for (int j = i; j < UNKNOWNS && j <= i + 5; j++)
        f->stiffness[(size_t)k * UNKNOWNS + (size_t)j] -=
            share * f->stiffness[(size_t)i * UNKNOWNS + (size_t)j];
      f->force[k] -= share * f->force[i];
    }
  for (int i = UNKNOWNS - 1; i >= 0; i--) {
    for (int j = i + 1; j < UNKNOWNS && j <= i + 5; j++)
      f->force[i] -= f->stiffness[(size_t)i * UNKNOWNS + (size_t)j] * f->force[j];
    f->force[i] /= f->stiffness[(size_t)i * UNKNOWNS + (size_t)i];
  }
}

static void release(frame *f) {
  free(f->stiffness);
  free(f->force);
}

/* Half a free bump: its crown is guided, its foot stands on rollers. */
static double frame_free(fg_arch arch, double friction, bool stuck) {
  frame f;
  build(&f, arch, 0, arch.bump_angle_deg * pi / 360);
  hold(&f, 0);
  hold(&f, 2);
  hold(&f, 3 * ELEMENTS + 1);
  if (stuck) hold(&f, 3 * ELEMENTS);
  f.force[1] = -0.5;
  if (!stuck) f.force[3 * ELEMENTS] = -0.5 * friction;
  solve(&f);
  double stiffness = -1 / f.force[1];
  release(&f);
  return stiffness;
}

/* A whole bump, its left end clamped: deflection of the crown and the right foot's reaction. */
static void frame_welded(fg_arch arch, double load, double inward, bool stuck, double *deflection,
                         double *reaction) {
  frame f;
  double phi = arch.bump_angle_deg * pi / 360;
  build(&f, arch, -phi, phi);
  for (int i = 0; i < 3; i++)
    hold(&f, i);
  hold(&f, 3 * ELEMENTS + 1);
  if (stuck) hold(&f, 3 * ELEMENTS);
  f.force[3 * (ELEMENTS / 2) + 1] = -load;
  f.force[3 * ELEMENTS] -= inward;
  solve(&f);
  *deflection = -f.force[3 * (ELEMENTS / 2) + 1];
  *reaction = -1e12 * f.force[3 * ELEMENTS + 1];
  release(&f);
}

static void free_bump_is_the_frames(void **state) {
  (void)state;
  const fg_arch arches[] = {gen2, {4.1, 50, 0.1}, {2.5, 120, 0.15}, {6, 30, 0.076}};
  for (size_t i = 0; i < sizeof arches / sizeof *arches; i++)
    for (double friction = 0; friction < 0.25; friction += 0.1) {
      fg_arch_stiffness result;
      double ours = free_stiffness(arches[i], friction, &result);
      assert_false(result.stuck);
      assert_near(ours / frame_free(arches[i], friction, false), 1, 5e-4);
    }
}

static void stuck_bump_is_the_frames(void **state) {
  (void)state;
  fg_arch_stiffness result;
  double ours = free_stiffness(gen2, 50, &result);
  assert_true(result.stuck);
  assert_near(ours / frame_free(gen2, 0, true), 1, 2e-3);
  assert_near(free_stiffness(gen2, 5, &result), ours, 1e-9 * ours);
  assert_true(isnan(result.unloading_n_mm2));
}

static void welded_bump_is_the_frames(void **state) {
  (void)state;
  fg_context ctx;
  for (double friction = 0; friction < 0.25; friction += 0.1) {
    fg_arch_material material = steel(friction);
    fg_arch_stiffness result;
    double sink_w, sink_h, v_w, v_h;
    assert_ok(&ctx, fg_arch_welded(&ctx, &gen2, &material, &result));
    frame_welded(gen2, 1, 0, false, &sink_w, &v_w);
    frame_welded(gen2, 0, 1, false, &sink_h, &v_h);
    double h = friction * v_w / (1 - friction * v_h);
    assert_near(result.foot_share, v_w + h * v_h, 1e-3);
    assert_near(result.stiffness_n_mm2 * (sink_w + h * sink_h), 1, 1e-3);
  }
  fg_arch_material rough = steel(50);
  fg_arch_stiffness result;
  double sink, v;
  assert_ok(&ctx, fg_arch_welded(&ctx, &gen2, &rough, &result));
  frame_welded(gen2, 1, 0, true, &sink, &v);
  assert_true(result.stuck);
  assert_near(result.stiffness_n_mm2 * sink, 1, 3e-3);
}

/* Strain energy of half a free bump under V and H by Simpson's rule, moments from the forces about
 * each cut; the deflection is its derivative. */
static double energy(fg_arch arch, double v, double h) {
  enum { STEPS = 4000 };
  double phi = arch.bump_angle_deg * pi / 360, r = arch.radius_mm, t = arch.thickness_mm;
  double e = 200e3 / (1 - 0.3 * 0.3), sum = 0, foot_x = r * sin(phi), foot_y = r * cos(phi);
  for (int i = 0; i <= STEPS; i++) {
    double psi = phi * i / STEPS, dx = foot_x - r * sin(psi), dy = foot_y - r * cos(psi);
    double moment = dx * v + dy * h; /* of (-h, v) about the cut */
    double compression = h * cos(psi) + v * sin(psi);
    double value =
        moment * moment / (2 * e * t * t * t / 12) + compression * compression / (2 * e * t);
    sum += value * (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2);
  }
  return sum * r * phi / STEPS / 3;
}

static void free_bump_is_the_energy_s_derivative(void **state) {
  (void)state;
  const double step = 1e-3, mu = 0.1;
  double sink =
      (energy(gen2, 0.5 + step, 0.5 * mu) - energy(gen2, 0.5 - step, 0.5 * mu)) / (2 * step);
  fg_arch_stiffness result;
  assert_near(free_stiffness(gen2, mu, &result) * sink, 1, 1e-9);
  sink = (energy(gen2, 0.5 + step, -0.5 * mu) - energy(gen2, 0.5 - step, -0.5 * mu)) / (2 * step);
  assert_near(result.unloading_n_mm2 * sink, 1, 1e-9);
  double give = (energy(gen2, 0, 1 + step) - energy(gen2, 0, 1 - step)) / (2 * step);
  assert_near(result.foot_n_mm2 * give, 1, 1e-9);
}

/* A very flat arch without friction is a beam on two supports: K = 48 D / L³. */
static void flat_arch_is_a_beam(void **state) {
  (void)state;
  const fg_arch flat = {100, 2, 0.05};
  double length = 2 * 100 * sin(pi / 180), d = 200e3 * pow(0.05, 3) / (12 * 0.91);
  fg_arch_stiffness result;
  double k = free_stiffness(flat, 0, &result);
  assert_near(k * pow(length, 3) / (48 * d), 1, 1e-3);
}

static void sensitivities_are_slopes(void **state) {
  (void)state;
  fg_context ctx;
  fg_arch_sensitivity s;
  fg_arch_material material = steel(0.1);
  fg_arch_stiffness at, moved;
  assert_ok(&ctx, fg_arch_sensitivities(&ctx, &gen2, &material, &s));
  fg_arch wider = gen2;
  wider.radius_mm *= 1.001;
  double slope =
      log(free_stiffness(wider, 0.1, &moved) / free_stiffness(gen2, 0.1, &at)) / log(1.001);
  assert_near(s.radius, slope, 1e-3);
  assert_near(s.radius_at_arc_length, s.radius - s.angle, 1e-6);
  assert_true(at.foot_n_mm2 > at.stiffness_n_mm2);
}

static void nonsense_is_refused(void **state) {
  (void)state;
  fg_context ctx;
  fg_arch_stiffness result;
  fg_arch_material material = steel(0.1);
  const fg_arch bad[] = {{0, 60, 0.1}, {3, 0, 0.1}, {3, 180, 0.1}, {3, 60, 4}, {NAN, 60, 0.1}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_status(&ctx, fg_arch_free(&ctx, &bad[i], &material, &result), FG_ERR_DATA);
  material.friction = -1;
  assert_status(&ctx, fg_arch_welded(&ctx, &gen2, &material, &result), FG_ERR_DATA);
}

/* Clearances of a rotor that stands off centre: the offset comes back, the circle is round, and the
 * centred rotor has the same room everywhere. */
static void offset_bearing_is_round(void **state) {
  (void)state;
  fg_context ctx;
  fg_bearing_layout layout = {3, 7, 1, 0};
  double angle[21], clearance[21];
  for (size_t i = 0; i < 21; i++) {
    angle[i] = fg_bearing_angle_deg(&layout, i / 7, i % 7);
    clearance[i] = 0.08 + 0.01 * cos(angle[i] * pi / 180) - 0.02 * sin(angle[i] * pi / 180);
  }
  assert_near(angle[1], 17.142857142857142, 1e-12);
  fg_bearing_clearance result;
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, 21, &result));
  assert_near(result.offset_mm[0], 0.01, 1e-12);
  assert_near(result.offset_mm[1], -0.02, 1e-12);
  assert_near(result.circularity_mm, 0, 1e-12);
  assert_near(result.centred_min_mm, 0.08, 1e-12);
  assert_near(result.mean_mm, 0.08, 1e-12);
  assert_near(result.min_mm, 0.08 - hypot(0.01, 0.02), 2e-4);
}

/* Three lobes at the bumps' own places: no offset, peak to valley twice the amplitude; shifting the
 * rotor gains nothing. A missing bump is left out. */
static void lobes_are_circularity(void **state) {
  (void)state;
  fg_context ctx;
  fg_bearing_layout layout = {3, 6, 1, 0};
  double angle[18], clearance[18];
  for (size_t i = 0; i < 18; i++) {
    angle[i] = fg_bearing_angle_deg(&layout, i / 6, i % 6);
    clearance[i] = 0.07 + 0.015 * cos(3 * angle[i] * pi / 180);
  }
  fg_bearing_clearance result;
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, 18, &result));
  assert_near(result.circularity_mm, 0.03, 1e-12);
  assert_near(result.centred_min_mm, 0.055, 1e-12);
  clearance[4] = NAN;
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, 18, &result));
  assert_int_equal(result.count, 17);
}

static void open_bearing_centres_nothing(void **state) {
  (void)state;
  fg_context ctx;
  const double angle[] = {0, 40, 80}, clearance[] = {0.1, 0.1, 0.1};
  fg_bearing_clearance result;
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, 3, &result));
  assert_true(isnan(result.centred_min_mm));
  assert_status(&ctx, fg_bearing_assess(&ctx, angle, clearance, 2, &result), FG_ERR_DATA);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_bump_is_the_frames),
      cmocka_unit_test(stuck_bump_is_the_frames),
      cmocka_unit_test(welded_bump_is_the_frames),
      cmocka_unit_test(free_bump_is_the_energy_s_derivative),
      cmocka_unit_test(flat_arch_is_a_beam),
      cmocka_unit_test(sensitivities_are_slopes),
      cmocka_unit_test(nonsense_is_refused),
      cmocka_unit_test(offset_bearing_is_round),
      cmocka_unit_test(lobes_are_circularity),
      cmocka_unit_test(open_bearing_centres_nothing),
  };
  return cmocka_run_group_tests_name("arch and bearing", tests, NULL, NULL);
}
