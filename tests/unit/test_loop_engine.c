/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on tables whose truth is known: effects that it finds, leaves alone or ties. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/brief.h"
#include "support/random.h"
#include "support/test.h"

enum { RUNS = 24, FOILS = 14, BUMPS = 9 };

typedef struct fixture {
  fg_context ctx;
  fg_table table;
  fg_loop_table_spec spec;
  fg_loop_table_problem problem;
  fg_loop_result result;
} fixture;

static void check(const fixture *f, fg_status status) {
  if (status != FG_OK) fail_msg("%s", f->ctx.message);
}

static void add(fixture *f, const char *name, const double *values, size_t rows) {
  check(f, fg_table_add_numbers(&f->ctx, &f->table, name, values, rows));
}

/* Accepted at a level; 0: the engine's own. */
static void run_at(fixture *f, double accept_p) {
  fg_design design;
  fg_design_default(&design);
  f->spec.design = &design;
  f->spec.seed = 1;
  fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1, .accept_p = accept_p};
  check(f, fg_loop_table_problem_build(&f->ctx, &f->table, &f->spec, &f->problem));
  check(f, fg_loop_run(&f->ctx, &f->problem.problem, &options, &f->result));
}

static void run(fixture *f) {
  run_at(f, 0);
}

static void clear(fixture *f) {
  fg_loop_result_free(&f->result);
  fg_loop_table_problem_free(&f->problem);
  fg_table_free(&f->table);
}

typedef struct runs_data {
  double run[RUNS], t[RUNS], d[RUNS], humidity[RUNS], y[RUNS];
} runs_data;

/* y = 20 - 0.03 T - D + noise of sd 0.5, runs in a seeded order. */
static void make_runs(uint64_t seed, runs_data *data) {
  for (size_t i = 0; i < RUNS; i++) {
    data->run[i] = (double)i + 1;
    data->t[i] = 450 + 50 * floor(5 * random_uniform(&seed));
    data->d[i] = 3 + floor(3 * random_uniform(&seed));
    data->humidity[i] = 15 + 45 * random_uniform(&seed);
    data->y[i] = 20 - 0.03 * data->t[i] - data->d[i] + 0.5 * random_gaussian(&seed);
  }
}

static void load_runs(fixture *f, const runs_data *data) {
  memset(f, 0, sizeof *f);
  add(f, "run", data->run, RUNS);
  add(f, "temperature_C", data->t, RUNS);
  add(f, "duration_h", data->d, RUNS);
  add(f, "humidity_pct", data->humidity, RUNS);
  add(f, "y", data->y, RUNS);
  f->spec.response = "y";
  f->spec.model = "1 + temperature_C + duration_h";
}

/* One clean table in ten is suspected, by the meaning of its p-value. */
static void count_suspected(const fg_loop_result *result, size_t *suspected) {
  assert_int_equal(result->claims, 0);
  *suspected += result->verdict == FG_LOOP_SUSPECTED;
  assert_true(result->verdict == FG_LOOP_CLEAN || result->verdict == FG_LOOP_SUSPECTED);
  assert_int_equal(result->verdict == FG_LOOP_SUSPECTED, result->family_p <= FG_LOOP_SUSPECTED_P);
}

static void clean_runs_are_clean(void **state) {
  size_t suspected = 0;
  (void)state;
  for (uint64_t seed = 1; seed <= 12; seed += test_step(4)) {
    fixture f;
    runs_data data;
    make_runs(seed, &data);
    load_runs(&f, &data);
    run(&f);
    count_suspected(&f.result, &suspected);
    assert_near(f.result.before.rms, f.result.after.rms, 0);
    clear(&f);
  }
  assert_true(suspected <= 3);
}

static void a_trend_is_found_with_its_size(void **state) {
  (void)state;
  size_t covered = 0, tried = 0;
  for (uint64_t seed = 21; seed <= 30; seed += test_step(4), tried++) {
    fixture f;
    runs_data data;
    make_runs(seed, &data);
    double low = 100, high = 0;
    for (size_t i = 0; i < RUNS; i++) {
      data.y[i] += 0.1 * data.humidity[i];
      low = fmin(low, data.humidity[i]);
      high = fmax(high, data.humidity[i]);
    }
    load_runs(&f, &data);
    run(&f);
    assert_int_equal(f.result.claims, 1);
    const fg_loop_claim *claim = &f.result.claim[0];
    assert_string_equal(claim->name, "table.linear(humidity_pct)");
    double truth = 0.1 * (high - low) / 2;
    assert_near(claim->amplitude, truth, 0.6);
    covered += claim->interval[0] <= truth && truth <= claim->interval[1];
    assert_true(f.result.after.rms < 0.7 * f.result.before.rms);
    assert_true(claim->p_value < 0.01);
    clear(&f);
  }
  assert_true(5 * covered >= 4 * tried - 1);
}

static void a_drift_is_no_correlation(void **state) {
  fixture f;
  runs_data data;
  (void)state;
  make_runs(42, &data);
  for (size_t i = 0; i < RUNS; i++)
    data.y[i] += 0.25 * data.run[i];
  load_runs(&f, &data);
  run(&f);
  assert_int_equal(f.result.claims, 1);
  assert_string_equal(f.result.claim[0].name, "table.order_drift(run)");
  clear(&f);
}

static void exchanged_runs_are_named(void **state) {
  fixture f;
  runs_data data;
  (void)state;
  make_runs(52, &data);
  size_t low = 0, high = 0;
  f = (fixture){0};
  load_runs(&f, &data);
  f.spec.hold_out = "0";
  for (size_t i = 0; i < RUNS; i++) {
    if (data.t[i] < data.t[low]) low = i;
    if (data.t[i] > data.t[high]) high = i;
  }
  fg_table_free(&f.table);
  double kept = data.y[low];
  data.y[low] = data.y[high];
  data.y[high] = kept;
  load_runs(&f, &data);
  f.spec.hold_out = "0";
  run(&f);
  assert_int_equal(f.result.claims, 1);
  assert_string_equal(f.result.claim[0].candidate.effect->id, "table.exchanged_runs");
  size_t a = f.result.claim[0].candidate.row[0], b = f.result.claim[0].candidate.row[1];
  assert_true((a == low && b == high) || (a == high && b == low));
  clear(&f);
}

static void a_copy_is_no_second_candidate(void **state) {
  fixture f;
  runs_data data;
  (void)state;
  make_runs(61, &data);
  for (size_t i = 0; i < RUNS; i++)
    data.y[i] += 0.1 * data.humidity[i];
  load_runs(&f, &data);
  add(&f, "moisture", data.humidity, RUNS);
  run(&f);
  assert_int_equal(f.result.claims, 1);
  assert_string_equal(f.result.claim[0].candidate.effect->id, "table.linear");
  assert_has(f.problem.excluded, "moisture: says the same as humidity_pct");
  clear(&f);
}

static void an_unlisted_effect_is_unattributed(void **state) {
  enum { MANY = 72 };
  double x[MANY], y[MANY], run_number[MANY];
  uint64_t seed = 71;
  fixture f = {0};
  (void)state;
  for (size_t i = 0; i < MANY; i++) {
    x[i] = random_uniform(&seed);
    run_number[i] = (double)i + 1;
    y[i] = 4 * exp(-50 * (x[i] - 0.4) * (x[i] - 0.4)) + 0.4 * random_gaussian(&seed);
  }
  add(&f, "run", run_number, MANY);
  add(&f, "x", x, MANY);
  add(&f, "y", y, MANY);
  f.spec.response = "y";
  f.spec.model = "1";
  run(&f);
  assert_int_equal(f.result.verdict, FG_LOOP_UNATTRIBUTED);
  assert_string_equal(f.result.curve.name, "x");
  assert_true(fg_loop_curve_at(&f.result.curve, 0.4) - fg_loop_curve_at(&f.result.curve, 0.9) > 3);
  assert_true(f.result.after.held_out_rms < 0.6);
  clear(&f);
}

static void make_lot(fixture *f, uint64_t seed, double decay, double between, double coil) {
  double foil[FOILS * BUMPS], bump[FOILS * BUMPS], batch[FOILS * BUMPS], y[FOILS * BUMPS];
  memset(f, 0, sizeof *f);
  for (size_t k = 0; k < FOILS; k++) {
    double level = between * random_gaussian(&seed);
    for (size_t b = 0; b < BUMPS; b++) {
      size_t i = k * BUMPS + b;
      foil[i] = (double)k + 1;
      bump[i] = (double)b + 1;
      batch[i] = 1 + floor((double)k / 5);
      y[i] = 3.4 + level + coil * batch[i] + decay * exp(-(double)b / 2) +
             0.02 * random_gaussian(&seed);
    }
  }
  add(f, "foil", foil, FOILS * BUMPS);
  add(f, "bump", bump, FOILS * BUMPS);
  add(f, "coil", batch, FOILS * BUMPS);
  add(f, "radius", y, FOILS * BUMPS);
  f->spec.response = "radius";
  f->spec.model = "1";
  f->spec.group = "foil";
}

static void the_lip_decay_of_a_lot_is_found(void **state) {
  fixture f;
  (void)state;
  make_lot(&f, 81, 0.1, 0.02, 0);
  run(&f);
  assert_int_equal(f.result.claims, 1);
  assert_string_equal(f.result.claim[0].name, "part.lip_decay(bump)");
  assert_near(f.result.claim[0].shape[0], 2, 0.5);
  assert_int_equal(f.result.claim[0].held_out, 1);
  clear(&f);
}

/* Foils differ by chance: 126 bumps are no 126 witnesses of a column that is constant in a foil. */
static void foils_that_differ_by_chance_are_no_effect(void **state) {
  size_t suspected = 0;
  (void)state;
  for (uint64_t seed = 91; seed <= 96; seed += test_step(3)) {
    fixture f;
    make_lot(&f, seed, 0, 0.05, 0);
    run(&f);
    count_suspected(&f.result, &suspected);
    assert_true(f.result.noise.lambda > 1);
    clear(&f);
  }
  assert_true(suspected <= 2);
}

static void stretch_is_found_beside_arc_length(void **state) {
  double radius[FOILS * BUMPS], angle[FOILS * BUMPS], foil[FOILS * BUMPS], bump[FOILS * BUMPS];
  uint64_t seed = 101;
  fixture f = {0};
  (void)state;
  for (size_t i = 0; i < FOILS * BUMPS; i++) {
    foil[i] = 1 + floor((double)i / BUMPS);
    bump[i] = 1 + (double)(i % BUMPS);
    radius[i] = 3.32 * (1.03 + 0.01 * random_gaussian(&seed));
    angle[i] = 63.15 * 3.32 / radius[i] * 1.01 + 0.05 * random_gaussian(&seed);
  }
  add(&f, "foil", foil, FOILS * BUMPS);
  add(&f, "bump", bump, FOILS * BUMPS);
  add(&f, "bump_radius_mm", radius, FOILS * BUMPS);
  add(&f, "bump_angle_deg", angle, FOILS * BUMPS);
  f.spec.response = "bump_angle_deg";
  f.spec.model = "arc_length";
  f.spec.group = "foil";
  run(&f);
  assert_int_equal(f.result.claims, 1);
  assert_string_equal(f.result.claim[0].name, "part.stretch(constant)");
  assert_near(f.result.claim[0].amplitude, 0.63, 0.04);
  clear(&f);
}

static void the_same_seed_gives_the_same(void **state) {
  fixture a, b;
  runs_data data;
  (void)state;
  make_runs(111, &data);
  load_runs(&a, &data);
  load_runs(&b, &data);
  run(&a);
  run(&b);
  assert_int_equal(a.result.rejects, b.result.rejects);
  for (size_t i = 0; i < a.result.rejects; i++)
    assert_memory_equal(&a.result.rejected[i].p_value, &b.result.rejected[i].p_value,
                        sizeof(double));
  clear(&a);
  clear(&b);
}

static double smallest_of(const fixture *f, const char *name) {
  for (size_t i = 0; i < f->result.rejects; i++)
    if (!strcmp(f->result.rejected[i].name, name)) return f->result.rejected[i].smallest_detectable;
  fail_msg("%s is not among what was rejected", name);
  return NAN;
}

/* The level that a claim must pass also sets the smallest effect that would have shown: a trend,
 * and one wrong row. */
static void smallest_detectable_effect_follows_the_level(void **state) {
  static const double level[] = {0.05, 0, 0.005}; /* 0: 0.01 */
  double trend[3], outlier[3];
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    fixture f;
    runs_data data;
    make_runs(5, &data);
    load_runs(&f, &data);
    run_at(&f, level[k]);
    assert_int_equal(f.result.claims, 0);
    trend[k] = smallest_of(&f, "table.linear(humidity_pct)");
    outlier[k] = NAN;
    for (size_t i = 0; i < f.result.rejects; i++)
      if (f.result.rejected[i].candidate.effect->outlier == FG_LOOP_WRONG_ROW)
        outlier[k] = f.result.rejected[i].smallest_detectable;
    clear(&f);
  }
  assert_true(trend[0] < trend[1] && trend[1] < trend[2]);
  assert_true(outlier[0] < outlier[1] && outlier[1] < outlier[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(clean_runs_are_clean),
      cmocka_unit_test(a_trend_is_found_with_its_size),
      cmocka_unit_test(a_drift_is_no_correlation),
      cmocka_unit_test(exchanged_runs_are_named),
      cmocka_unit_test(a_copy_is_no_second_candidate),
      cmocka_unit_test(an_unlisted_effect_is_unattributed),
      cmocka_unit_test(the_lip_decay_of_a_lot_is_found),
      cmocka_unit_test(foils_that_differ_by_chance_are_no_effect),
      cmocka_unit_test(stretch_is_found_beside_arc_length),
      cmocka_unit_test(the_same_seed_gives_the_same),
      cmocka_unit_test(smallest_detectable_effect_follows_the_level),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
