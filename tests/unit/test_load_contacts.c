/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unsampled stretches of a stroke, and contacts that contradict each other. */
#include <math.h>
#include <stdlib.h>

#include "load_test/analysis.h"
#include "load_test/local_fit.h"
#include "load_test/noise.h"
#include "support/random.h"
#include "support/test.h"

enum { SAMPLES = 600 };

typedef struct made {
  double x[SAMPLES], f[SAMPLES], variance[SAMPLES], scatter[SAMPLES];
  bool after_hole[SAMPLES];
  fg_load_stroke stroke;
} made;

static made *make(double resolution_mm) {
  made *m = calloc(1, sizeof *m);
  assert_non_null(m);
  m->stroke = (fg_load_stroke){.x = m->x,
                               .f = m->f,
                               .variance = m->variance,
                               .scatter = m->scatter,
                               .after_hole = m->after_hole,
                               .resolution_mm = resolution_mm,
                               .sense = 1};
  return m;
}

static void add(made *m, double x, double f) {
  size_t i = m->stroke.count++;
  m->x[i] = x, m->f[i] = f, m->variance[i] = 1e-4;
}

static size_t holes(made *m) {
  size_t count = 0;
  fg_load_stroke_find_holes(&m->stroke);
  for (size_t i = 0; i < m->stroke.count; i++)
    count += m->after_hole[i];
  return count;
}

static void even_and_random_samples_have_no_holes(void **state) {
  (void)state;
  made *even = make(0.0002), *sine = make(0.0002), *random = make(0), *weights = make(0.0002);
  uint64_t seed = 3;
  double x = 0;
  for (size_t i = 0; i < 500; i++) {
    add(even, 0.001 * (double)i, 0);
    add(sine, -0.19 * cos(M_PI * ((double)i + 0.5) / 500), 0);
    add(random, x -= 0.001 * log(random_uniform(&seed)), 0);
    /* A rotor that rests under 25 weights: every rest is one place. */
    add(weights, 0.01 * (double)(i / 20) + 0.00002 * (double)(i % 20), 0);
  }
  assert_int_equal(holes(even), 0);
  assert_int_equal(holes(sine), 0);
  assert_in_range(holes(random), 0, 2);
  assert_int_equal(holes(weights), 0);
  free(even), free(sine), free(random), free(weights);
}

/* Dense on both sides of a gap, with a few samples in it. */
static made *jump(size_t within) {
  made *m = make(0.0002);
  for (size_t i = 0; i < 200; i++)
    add(m, -0.18 + 0.0005 * (double)i, -50 + 0.25 * (double)i);
  for (size_t i = 0; i < within; i++)
    add(m, -0.08 + 0.16 * (double)(i + 1) / (double)(within + 1), 0);
  for (size_t i = 0; i < 200; i++)
    add(m, 0.08 + 0.0005 * (double)i, 0.25 * (double)i);
  return m;
}

static void jumps_are_found_and_not_reached_over(void **state) {
  (void)state;
  for (size_t within = 0; within <= 4; within++) {
    made *m = jump(within);
    fg_local_fit fit;
    double x, u;
    assert_int_equal(holes(m), within + 1);
    assert_false(fg_local_fit_at(&m->stroke, 0.05, 0.2, &fit));
    assert_true(fg_local_fit_at(&m->stroke, 0.08, 0.2, &fit));
    assert_near(fit.slope, 500, 1e-6); /* of its own branch alone */
    assert_true(fg_local_crossing(&m->stroke, 5, &x, &u, &fit));
    assert_near(x, 0.09, 1e-6);
    assert_true(u < 0.0001);
    assert_near(fit.u_unsampled_mm, 0, 0);
    free(m);
  }
}

/* 5 N are passed within a stretch of 30 um: where, is bounded by the stiffness beside it. */
static void crossing_in_a_hole(void **state) {
  (void)state;
  made *m = make(0.0002);
  for (size_t i = 0; i < 500; i++) {
    double x = 0.0005 * (double)i;
    if (x <= 0.07 || x >= 0.1) add(m, x, 500 * fmax(0, x - 0.08));
  }
  fg_local_fit fit;
  double x, u;
  assert_int_equal(holes(m), 1);
  assert_true(fg_local_crossing(&m->stroke, 5, &x, &u, &fit));
  assert_near(x, 0.09, 2 * u);
  assert_true(u < 0.03 / sqrt(12) && fit.u_unsampled_mm > 0.9 * u);
  free(m);
}

/* A whole record of a bearing, so that branches can be compared. */
static void contradictions(void **state) {
  (void)state;
  enum { CYCLES = 3, EACH = 600, ALL = CYCLES * EACH };
  const struct {
    double pull_mm, push_mm, unloading_mm;
    unsigned flags;
  } rows[] = {{-0.09, 0.09, 0.184, 0},
              {0.094, 0.097, 0.006, FG_LOAD_SAME_SIDE},
              {-0.09, 0.09, 0.170, FG_LOAD_BRANCHES_APART},
              {-0.09, 0.09, 0.260, FG_LOAD_BRANCHES_APART}};
  fg_load_sample *samples = calloc(ALL, sizeof *samples);
  for (size_t i = 0; i < ALL; i++) {
    double phase = 2 * M_PI * (double)i / EACH, x = 0.19 * sin(phase);
    double f = copysign(500 * fmax(0, fabs(x) - 0.08), x) + (cos(phase) >= 0 ? 1 : -1);
    samples[i] =
        (fg_load_sample){.x_mm = x, .force_n = f + 0.05 * ((double)(i * 7919 % 13) / 6 - 1)};
  }
  size_t begin[] = {0};
  fg_context ctx = {0};
  fg_load_strokes strokes;
  fg_load_records records = {.begin = begin, .count = 1};
  fg_load_test test = {.samples = samples, .sample_count = ALL};
  fg_load_direction d = {.count = ALL, .travel_mm = 0.38};
  assert_ok(&ctx, fg_load_strokes_cut(&ctx, &test, &d, &records, &strokes));
  assert_ok(&ctx, fg_load_find_noise(&ctx, samples, d.step_mm, &strokes));
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    const double u = 0.0005;
    d.flags = 0;
    d.pull_mm = rows[i].pull_mm, d.push_mm = rows[i].push_mm, d.drift_um_cycle = NAN;
    d.clearance = (fg_load_value){d.push_mm - d.pull_mm, u, u};
    d.unloading = (fg_load_value){rows[i].unloading_mm, u, u};
    assert_ok(&ctx, fg_load_check_contacts(&ctx, &strokes, 0, &d));
    assert_int_equal(d.flags & FG_LOAD_CONTRADICTION, rows[i].flags);
  }
  fg_load_strokes_free(&strokes);
  free(samples);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(even_and_random_samples_have_no_holes),
                                     cmocka_unit_test(jumps_are_found_and_not_reached_over),
                                     cmocka_unit_test(crossing_in_a_hole),
                                     cmocka_unit_test(contradictions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
