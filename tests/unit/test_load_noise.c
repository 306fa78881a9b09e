/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of load-displacement records: the step of a column, noise of force and of displacement told
 * apart, and where strokes turn. */
#include <math.h>
#include <stdlib.h>

#include "load_test/noise.h"
#include "support/random.h"
#include "support/test.h"

enum { CYCLES = 5, EACH = 600, SAMPLES = CYCLES * EACH };
static const double amplitude_mm = 0.19;

typedef struct record {
  fg_load_sample sample[SAMPLES];
  fg_load_test test;
  fg_load_direction direction;
  fg_load_records records;
  fg_load_strokes strokes;
} record;

/* A gap of 0.16 mm and a spring that hardens behind it; friction of 1 N. */
static double force_at(double x, double sense) {
  double d = fmax(0, fabs(x) - 0.08);
  return copysign(500 * d + 5e4 * d * d * d, x) + sense;
}

static void fill(record *r, double noise_n, double noise_mm, double step_mm) {
  uint64_t state = 7;
  for (size_t i = 0; i < SAMPLES; i++) {
    double phase = 2 * M_PI * (double)i / EACH, x = amplitude_mm * sin(phase);
    double f = force_at(x, cos(phase) >= 0 ? 1 : -1) + noise_n * random_gaussian(&state);
    x += noise_mm * random_gaussian(&state);
    if (step_mm > 0) x = step_mm * round(x / step_mm);
    r->sample[i] = (fg_load_sample){.x_mm = x, .force_n = f};
  }
}

static void cut(record *r) {
  static size_t begin[] = {0};
  fg_context ctx = {0};
  r->test = (fg_load_test){.samples = r->sample, .sample_count = SAMPLES};
  r->direction = (fg_load_direction){.count = SAMPLES, .travel_mm = 2 * amplitude_mm};
  r->direction.step_mm = fg_load_find_step(r->sample, SAMPLES);
  r->records = (fg_load_records){.begin = begin, .count = 1};
  assert_ok(&ctx, fg_load_strokes_cut(&ctx, &r->test, &r->direction, &r->records, &r->strokes));
  assert_ok(&ctx, fg_load_find_noise(&ctx, r->sample, r->direction.step_mm, &r->strokes));
}

static void steps_of_columns(void **state) {
  (void)state;
  record *r = calloc(1, sizeof *r);
  fill(r, 0.2, 0.0002, 0.001);
  assert_near(fg_load_find_step(r->sample, SAMPLES), 0.001, 1e-12);
  fill(r, 0.2, 0.0002, 0.0025);
  assert_near(fg_load_find_step(r->sample, SAMPLES), 0.0025, 1e-12);
  assert_near(fg_load_find_step(r->sample, 40), 0, 0); /* too few to say */
  fill(r, 0.2, 0.0002, 0);
  assert_near(fg_load_find_step(r->sample, SAMPLES), 0, 0);
  for (size_t i = 0; i < SAMPLES; i++)
    r->sample[i].x_mm = 0.1;
  assert_near(fg_load_find_step(r->sample, SAMPLES), 0, 0);
  free(r);
}

static void noise_of_both_columns(void **state) {
  (void)state;
  const struct {
    double n, mm, step_mm;
  } rows[] = {{0.2, 0.0002, 0}, {1, 0.0002, 0}, {0.1, 0.001, 0}, {0.2, 0.0002, 0.002}};
  record *r = calloc(1, sizeof *r);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fill(r, rows[i].n, rows[i].mm, rows[i].step_mm);
    cut(r);
    double mm = hypot(rows[i].mm, rows[i].step_mm / sqrt(12));
    assert_near(r->strokes.noise_n, rows[i].n, 0.2 * rows[i].n);
    /* Told by how it grows with the slope: beside a large noise of force less is known of it. */
    double known = rows[i].n > 0.5 ? 0.6 : 0.3;
    assert_near(r->strokes.noise_mm, mm, known * mm);
    fg_load_strokes_free(&r->strokes);
  }
  free(r);
}

/* The extreme of noisy samples lies beyond the turn by some three times the noise. */
static void turns(void **state) {
  (void)state;
  record *r = calloc(1, sizeof *r);
  fill(r, 0.2, 0.002, 0);
  cut(r);
  assert_int_equal(r->strokes.count, 2 * CYCLES + 1);
  for (size_t i = 1; i + 1 < r->strokes.count; i++) {
    const fg_load_stroke *s = &r->strokes.stroke[i];
    assert_near(s->low_mm, -amplitude_mm, 0.001);
    assert_near(s->high_mm, amplitude_mm, 0.001);
    assert_true(s->x[0] > s->low_mm + 0.004 && s->x[s->count - 1] < s->high_mm - 0.004);
  }
  fg_load_strokes_free(&r->strokes);
  free(r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(steps_of_columns),
                                     cmocka_unit_test(noise_of_both_columns),
                                     cmocka_unit_test(turns)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
