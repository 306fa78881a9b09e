/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas film against closed forms at its limits, and against itself: derivatives, mesh,
 * symmetries. */
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

#include "film/orbit.h"
#include "support/film_bearing.h"

/* Ocvirk 1952, the whole film: f = L pi e (l/R)³ / (12 (1 - e²)^(3/2)) across the eccentricity. */
static void short_bearing_is_ocvirks(void **unused) {
  (void)unused;
  bearing b;
  const double lambda = 1e-3, e = 0.6, half = 0.02;
  const fg_film_mesh mesh = ring_of(240, 16, half);
  double force[2];
  open_bearing(&b, &mesh, lambda, 0);
  hold_at(&b, e, 0);
  fg_film_force(&b.film, &b.state, force);
  double expected = lambda * pi * e * pow(2 * half, 3) / (12 * pow(1 - e * e, 1.5));
  assert_ratio(-force[1], expected, 5e-3);
  assert_true(fabs(force[0]) < 2e-3 * expected);
  close_bearing(&b);
}

/* Sommerfeld 1904, in the middle of a long bearing: P - 1 = L e sin(phi) (2 + e cos(phi)) / ((2 +
 * e²) (1 + e cos(phi))²), phi from the widest film. */
static void long_bearing_is_sommerfelds(void **unused) {
  (void)unused;
  bearing b;
  const double lambda = 1e-4, e = 0.5;
  const fg_film_mesh mesh = ring_of(240, 16, 12);
  open_bearing(&b, &mesh, lambda, 0);
  hold_at(&b, -e, 0); /* widest at angle 0 */
  for (size_t i = 0; i < b.film.columns; i += 20) {
    double phi = fg_film_angle_rad(&mesh, i), h = 1 + e * cos(phi);
    double expected = lambda * e * sin(phi) * (2 + e * cos(phi)) / ((2 + e * e) * h * h);
    double found = b.state.pressure[i * b.film.nodes] - 1;
    assert_true(fabs(found - expected) < 2e-3 * lambda);
  }
  close_bearing(&b);
}

/* At infinite compressibility number P H = sqrt(mean H³ / mean H) = sqrt(1 + 3/2 e²) away from the
 * ends (Elrod and Burgdorfer 1959). */
static void fast_bearing_keeps_pressure_times_thickness(void **unused) {
  (void)unused;
  bearing b;
  const double e = 0.5;
  const fg_film_mesh mesh = ring_of(120, 40, 1);
  open_bearing(&b, &mesh, 10, 0);
  for (double lambda = 10; lambda < 2e5; lambda *= 10) {
    b.at.lambda = lambda;
    hold_at(&b, e, 0);
  }
  for (size_t i = 0; i < b.film.columns; i += 7)
    assert_ratio(b.state.pressure[i * b.film.nodes] *
                     fg_film_thickness(&b.film, &b.at, &b.state, i),
                 sqrt(1 + 1.5 * e * e), 5e-3);
  close_bearing(&b);
}

static void light_rotors_whirl_at_half_the_speed(void **unused) {
  (void)unused;
  bearing b;
  fg_film_threshold found;
  const fg_film_mesh mesh = ring_of(96, 8, 1);
  open_bearing(&b, &mesh, 1, 0);
  balance(&b, 0.05, 0.3);
  assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
  assert_ratio(found.ratio, 0.5, 2e-3);
  close_bearing(&b);
}

static double threshold_on(const fg_film_mesh *mesh, double *eccentricity) {
  bearing b;
  fg_film_threshold found;
  open_bearing(&b, mesh, 1, 0.67);
  b.at.loss = 0.14;
  balance(&b, 0.5, 0.3);
  assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
  *eccentricity = hypot(b.state.place[0], b.state.place[1]);
  close_bearing(&b);
  return found.mass;
}

static void mesh_has_second_order(void **unused) {
  (void)unused;
  double mass[3], place[3];
  for (size_t k = 0; k < 3; k++) {
    size_t fine = (size_t)1 << k;
    const fg_film_mesh mesh = pads_of(3, 14 * fine, 4 * fine);
    mass[k] = threshold_on(&mesh, &place[k]);
  }
  assert_true(fabs(log2((mass[0] - mass[1]) / (mass[1] - mass[2])) - 2) < 0.3);
  assert_true(fabs(log2((place[0] - place[1]) / (place[1] - place[2])) - 2) < 0.3);
}

/* Without whirl the impedance is the derivative of the force by the place. */
static void stiffness_is_the_forces_derivative(void **unused) {
  (void)unused;
  bearing b;
  const double step = 1e-4;
  const fg_film_mesh mesh = pads_of(3, 28, 6);
  double complex z[2][2];
  open_bearing(&b, &mesh, 2, 0.67);
  balance(&b, 0.8, 1.1);
  const double x = b.state.place[0], y = b.state.place[1];
  fg_film_assemble(&b.ctx, &b.film, &b.at, &b.state);
  assert_int_equal(fg_film_impedance(&b.ctx, &b.film, &b.at, 0, z), FG_OK);
  for (int l = 0; l < 2; l++) {
    double force[2][2];
    for (int side = 0; side < 2; side++) {
      double by = side ? step : -step;
      hold_at(&b, x + (l ? 0 : by), y + (l ? by : 0));
      fg_film_force(&b.film, &b.state, force[side]);
    }
    for (int k = 0; k < 2; k++)
      assert_true(fabs((force[1][k] - force[0][k]) / (2 * step) - creal(z[k][l])) <
                  1e-6 * cabs(z[0][0]));
  }
  close_bearing(&b);
}

static void turning_pattern_and_load_turns_the_rotor(void **unused) {
  (void)unused;
  const size_t by = 5;
  double place[2], mass[2];
  for (int k = 0; k < 2; k++) {
    bearing b;
    fg_film_threshold found;
    const fg_film_mesh mesh = ring_of(60, 4, 1);
    open_bearing(&b, &mesh, 1, 0.5);
    for (size_t i = 0; i < 60; i++)
      b.at.clearance[(i + (k ? by : 0)) % 60] = 1 + 0.2 * sin(2.1 * (double)i) * (i % 3 == 0);
    double turn = k ? 2 * pi * (double)by / 60 : 0;
    balance(&b, 0.5, 0.3 + turn);
    assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
    place[k] = remainder(atan2(b.state.place[1], b.state.place[0]) - turn, 2 * pi);
    mass[k] = found.mass;
    close_bearing(&b);
  }
  assert_ratio(place[1], place[0], 1e-8);
  assert_ratio(mass[1], mass[0], 1e-6);
}

/* ---- the threshold by the eigenvalues of film and rotor together ---- */

static double at_matrix(const bearing *b, const double *values, int row, int column) {
  const fg_sparse *s = &b->film.sparse;
  for (int k = s->column[column]; k < s->column[column + 1]; k++)
    if (s->row[k] == row) return values[k];
  return 0;
}

/* Force by an unknown: of a pressure its weight; of a deflection 0. */
static void force_by(const bearing *b, size_t unknown, double force[2]) {
  const fg_film *f = &b->film;
  force[0] = force[1] = 0;
  for (size_t i = 0; i < f->columns; i++)
    for (size_t j = 0; j < f->mesh.axial && !f->edge[i]; j++)
      if ((size_t)f->base[i] + j == unknown) {
        force[0] = 2 * f->step * f->weight[j] * f->cosine[i];
        force[1] = 2 * f->step * f->weight[j] * f->sine[i];
      }
}

/* Largest growth of T x' + S v = -J x - D X, X' = v, M v' = -f(x): B y' = A y; of all motions, or
 * of those that turn. */
static double largest_growth(bearing *b, double mass, bool turning) {
  size_t n = (size_t)b->film.sparse.size, all = n + 4;
  gsl_matrix *a = gsl_matrix_calloc(all, all), *t = gsl_matrix_calloc(all, all);
  gsl_vector_complex *above = gsl_vector_complex_alloc(all);
  gsl_vector *below = gsl_vector_alloc(all);
  gsl_eigen_gen_workspace *work = gsl_eigen_gen_alloc(all);
  fg_film_assemble(&b->ctx, &b->film, &b->at, &b->state);
  for (size_t r = 0; r < n; r++) {
    double force[2];
    force_by(b, r, force);
    for (size_t c = 0; c < n; c++) {
      gsl_matrix_set(a, r, c, -at_matrix(b, b->film.matrix, (int)r, (int)c));
      gsl_matrix_set(t, r, c, at_matrix(b, b->film.time, (int)r, (int)c));
    }
    for (size_t k = 0; k < 2; k++) {
      gsl_matrix_set(a, r, n + k, -b->film.shift[k][r]);
      gsl_matrix_set(a, r, n + 2 + k, -b->film.shift_time[k][r]);
      gsl_matrix_set(a, n + 2 + k, r, -force[k]);
    }
  }
  for (size_t k = 0; k < 2; k++) {
    gsl_matrix_set(a, n + k, n + 2 + k, 1);
    gsl_matrix_set(t, n + k, n + k, 1);
    gsl_matrix_set(t, n + 2 + k, n + 2 + k, mass);
  }
  assert_int_equal(gsl_eigen_gen(a, t, above, below, work), 0);
  double growth = -INFINITY;
  for (size_t i = 0; i < all; i++)
    if (fabs(gsl_vector_get(below, i)) > 1e-9 &&
        (!turning ||
         fabs(GSL_IMAG(gsl_vector_complex_get(above, i))) > 1e-6 * fabs(gsl_vector_get(below, i))))
      growth = fmax(growth, GSL_REAL(gsl_vector_complex_get(above, i)) / gsl_vector_get(below, i));
  gsl_eigen_gen_free(work);
  gsl_vector_free(below);
  gsl_vector_complex_free(above);
  gsl_matrix_free(t);
  gsl_matrix_free(a);
  return growth;
}

static void eigenvalues_have_the_same_threshold(void **unused) {
  (void)unused;
  bearing b;
  fg_film_threshold found;
  const fg_film_mesh mesh = pads_of(3, 8, 3);
  open_bearing(&b, &mesh, 1.5, 0.67);
  balance(&b, 0.8, 0.4);
  assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
  assert_true(isfinite(found.mass));
  assert_true(largest_growth(&b, found.mass * 0.999, false) < 0);
  assert_true(largest_growth(&b, found.mass * 1.001, false) > 0);
  close_bearing(&b);
}

/* Three films under one load: from the one between the others every rotor falls, though none of its
 * whirls grows. */
static void no_rotor_rests_between_two_films(void **unused) {
  (void)unused;
  static const double places[3][2] = {{0.81, 0.276}, {0.786, -0.193}, {0.557, -0.625}};
  bearing b;
  fg_film_threshold found;
  fg_film_mesh mesh = pads_of(3, 18, 4);
  mesh.start_rad = -20 * pi / 540;
  open_bearing(&b, &mesh, 0.05352, 0.3492);
  b.at.load[1] = -0.12337;
  for (int i = 0; i < 3; i++) {
    bool falls;
    assert_int_equal(fg_film_solve_from_place(&b.ctx, &b.film, &b.at, places[i], &b.state), FG_OK);
    assert_true(hypot(b.state.place[0] - places[i][0], b.state.place[1] - places[i][1]) < 0.02);
    assert_int_equal(fg_film_find_fall(&b.ctx, &b.film, &b.at, &b.state, &falls), FG_OK);
    assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
    assert_int_equal(falls, i == 1);
    assert_int_equal(found.mass == 0 && found.ratio == 0, i == 1);
  }
  close_bearing(&b);
}

/* A whirl that hardly grows, one that decays, and one that grows within a turn are all found. */
static void least_stable_whirl_is_the_largest_eigenvalue(void **unused) {
  (void)unused;
  static const double over_critical[] = {0.03, 0.3, 0.9, 1, 1.2, 5, 100, 3000};
  bearing b;
  fg_film_threshold critical;
  const fg_film_mesh mesh = pads_of(3, 8, 3);
  open_bearing(&b, &mesh, 1.5, 0.67);
  balance(&b, 0.8, 0.4);
  assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &critical), FG_OK);
  for (size_t i = 0; i < sizeof over_critical / sizeof *over_critical; i++) {
    double mass = critical.mass * over_critical[i], expected = largest_growth(&b, mass, true);
    fg_film_motions found;
    assert_int_equal(fg_film_find_motions(&b.ctx, &b.film, &b.at, &b.state, mass, &found), FG_OK);
    assert_true(found.count > 0);
    double growth = -INFINITY;
    for (size_t k = 0; k < found.count; k++)
      growth = fmax(growth, creal(found.motion[k].s));
    if (fabs(growth - expected) > 1e-6 * cabs(found.motion[0].s) + 1e-9)
      fail_msg("%g critical masses grow by %.9g, not %.9g", over_critical[i], growth, expected);
    if (over_critical[i] == 1) assert_near(cimag(found.motion[0].s), critical.ratio, 1e-6);
    for (size_t k = 1; k < found.count; k++) /* by damping */
      assert_true(carg(found.motion[k].s) >= carg(found.motion[k - 1].s));
    if (over_critical[i] >= 0.9) assert_true(found.motion[0].forward);
  }
  close_bearing(&b);
}

/* In time the amplitude decays below the critical mass and grows above, at the same whirl. */
static void orbits_in_time_have_the_same_threshold(void **unused) {
  (void)unused;
  enum { TURNS = 40, POINTS = 32 };
  static fg_film_orbit_point points[TURNS * POINTS + 1];
  for (int lossy = 0; lossy < 2; lossy++) {
    bearing b;
    fg_film_threshold found;
    const fg_film_mesh mesh = pads_of(3, 14, 4);
    open_bearing(&b, &mesh, 1, 0.67);
    b.at.loss = lossy ? 0.14 : 0;
    balance(&b, 0.5, 0);
    assert_int_equal(fg_film_find_threshold(&b.ctx, &b.film, &b.at, &b.state, &found), FG_OK);
    for (int above = 0; above < 2; above++) {
      const fg_film_orbit_plan plan = {.mass = found.mass * (above ? 1.03 : 0.97),
                                       .loss_ratio = found.ratio,
                                       .pulse = 0.01,
                                       .turns = TURNS,
                                       .points_per_turn = POINTS};
      size_t count;
      assert_int_equal(
          fg_film_integrate_orbit(&b.ctx, &b.film, &b.at, &b.state, &plan, points, &count), FG_OK);
      assert_int_equal(count, TURNS * POINTS + 1);
      fg_film_orbit_growth growth = fg_film_measure_orbit(points, count);
      assert_true(above ? growth.per_turn > 5e-3 : growth.per_turn < -5e-3);
      assert_ratio(growth.ratio, found.ratio, 0.03);
    }
    close_bearing(&b);
  }
}

/* A top foil that is far stiffer than its bumps deflects as a whole; a soft one more between the
 * bumps than on them. */
static void top_foil_sags_between_bumps(void **unused) {
  (void)unused;
  double between[2], on[2];
  for (int soft = 0; soft < 2; soft++) {
    bearing b;
    const fg_film_mesh mesh = {.pads = 1, .cells = 40, .axial = 4, .arc_rad = 6, .half_length = 1};
    memset(&b, 0, sizeof b);
    assert_int_equal(fg_film_open(&b.ctx, &mesh, true, &b.film), FG_OK);
    assert_int_equal(fg_film_case_open(&b.ctx, b.film.columns, &b.at), FG_OK);
    assert_int_equal(fg_film_state_open(&b.ctx, &b.film, &b.state), FG_OK);
    b.at.lambda = 2;
    b.at.bending = soft ? 1e-3 : 1e3;
    for (size_t i = 0; i < b.film.columns; i++) {
      b.at.clearance[i] = b.at.yield[i] = 1;
      b.at.spring[i] = i % 8 == 4 ? 12 : i ? 0 : 1;
    }
    balance(&b, 0.5, 3);
    on[soft] = b.state.deflection[20];
    between[soft] = b.state.deflection[24];
    assert_true(fabs(b.state.deflection[0]) < 1e-12);
    close_bearing(&b);
  }
  assert_true(between[1] > 1.2 * on[1]);
  assert_true(fabs(between[0]) < fabs(between[1]));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(short_bearing_is_ocvirks),
      cmocka_unit_test(long_bearing_is_sommerfelds),
      cmocka_unit_test(fast_bearing_keeps_pressure_times_thickness),
      cmocka_unit_test(light_rotors_whirl_at_half_the_speed),
      cmocka_unit_test(mesh_has_second_order),
      cmocka_unit_test(stiffness_is_the_forces_derivative),
      cmocka_unit_test(turning_pattern_and_load_turns_the_rotor),
      cmocka_unit_test(eigenvalues_have_the_same_threshold),
      cmocka_unit_test(no_rotor_rests_between_two_films),
      cmocka_unit_test(least_stable_whirl_is_the_largest_eigenvalue),
      cmocka_unit_test(orbits_in_time_have_the_same_threshold),
      cmocka_unit_test(top_foil_sags_between_bumps),
  };
  return cmocka_run_group_tests_name("film", tests, NULL, NULL);
}
