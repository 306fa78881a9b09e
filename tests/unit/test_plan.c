/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans: the runs that the books print, orthogonality, random order by seed, whole plots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/plan.h"
#include "foilgauge/regression.h"
#include "support/test.h"

static const fg_plan_factor FIVE[] = {
    {"A", -1, 1, false, 0}, {"B", -1, 1, false, 0}, {"C", -1, 1, false, 0}, {"D", -1, 1, false, 0},
    {"E", -1, 1, false, 0}, {"F", -1, 1, false, 0}, {"G", -1, 1, false, 0}};

static void make(const fg_plan_options *options, fg_plan *plan) {
  fg_context ctx = {0};
  if (fg_plan_make(&ctx, options, plan) != FG_OK) fail_msg("%s", ctx.message);
}

static double inner(const fg_plan *plan, size_t a, size_t b) {
  double sum = 0;
  for (size_t i = 0; i < plan->runs; i++)
    sum += plan->run[i].coded[a] * plan->run[i].coded[b];
  return sum;
}

static size_t count_points(const fg_plan *plan, const char *point) {
  size_t count = 0;
  for (size_t i = 0; i < plan->runs; i++)
    count += strcmp(plan->run[i].point, point) == 0;
  return count;
}

/* The 2^(7-4) of resolution III and the 2^(5-1) of resolution V (Box, Hunter and Hunter). */
static void fractions_have_their_resolution(void **state) {
  static const char *const four[] = {"D=A:B", "E=A:C", "F=B:C", "G=A:B:C"};
  static const char *const one[] = {"E=-A:B:C:D"};
  fg_context ctx = {0};
  fg_plan plan;
  char *text = NULL;
  (void)state;
  make(&(fg_plan_options){.factor = FIVE, .factors = 7, .generator = four, .generators = 4}, &plan);
  assert_int_equal(plan.runs, 8);
  assert_int_equal(plan.words, 15);
  assert_int_equal(plan.resolution, 3);
  for (size_t a = 0; a < 7; a++)
    for (size_t b = 0; b < 7; b++)
      assert_true(inner(&plan, a, b) == (a == b ? 8 : 0));
  assert_ok(&ctx, fg_plan_alias_text(&ctx, &plan, 1, 2, &text));
  assert_has(text, "A = B:D = C:E = F:G\n");
  free(text);
  fg_plan_free(&plan);
  make(&(fg_plan_options){.factor = FIVE, .factors = 5, .generator = one, .generators = 1}, &plan);
  assert_int_equal(plan.runs, 16);
  assert_int_equal(plan.resolution, 5);
  assert_ok(&ctx, fg_plan_relation_text(&ctx, &plan, &text));
  assert_string_equal(text, "I = -A:B:C:D:E");
  free(text);
  assert_ok(&ctx, fg_plan_alias_text(&ctx, &plan, 2, 3, &text));
  assert_has(text, "A:B = -C:D:E\n");
  free(text);
  for (size_t i = 0; i < plan.runs; i++) {
    const double *x = plan.run[i].coded;
    assert_true(x[4] == -x[0] * x[1] * x[2] * x[3]);
  }
  fg_plan_free(&plan);
}

/* Table 5.4 of the thesis: corners, axial points at 3, one centre point. */
static void the_modified_composite_is_the_thesis_one(void **state) {
  static const fg_plan_factor factors[] = {{"T", 500, 600, false, 0}, {"D", 3, 5, false, 0}};
  static const double runs[9][2] = {{500, 3}, {600, 3}, {500, 5}, {600, 5}, {400, 4},
                                    {700, 4}, {550, 1}, {550, 7}, {550, 4}};
  fg_context ctx = {0};
  fg_plan plan;
  fg_table table;
  (void)state;
  make(&(fg_plan_options){.kind = FG_PLAN_COMPOSITE,
                          .factor = factors,
                          .factors = 2,
                          .axial = 3,
                          .centre_points = 1,
                          .seed = 5},
       &plan);
  assert_ok(&ctx, fg_plan_table(&ctx, &plan, &table));
  assert_int_equal(table.rows, 9);
  assert_int_equal(table.columns, 5);
  const fg_extended *order = NULL, *t = NULL, *d = NULL;
  assert_ok(&ctx, fg_table_numbers(&ctx, &table, "standard_order", &order));
  assert_ok(&ctx, fg_table_numbers(&ctx, &table, "T", &t));
  assert_ok(&ctx, fg_table_numbers(&ctx, &table, "D", &d));
  for (size_t i = 0; i < 9; i++) {
    const double *run = runs[(size_t)order[i].value - 1];
    assert_true(t[i].value == run[0] && d[i].value == run[1]);
  }
  fg_table_free(&table);
  fg_plan_free(&plan);
}

/* Rotatable: sum x^4 = 3 sum x1² x2². */
static void composites_are_rotatable(void **state) {
  fg_plan plan;
  double fourth = 0, mixed = 0;
  (void)state;
  make(&(fg_plan_options){.kind = FG_PLAN_COMPOSITE,
                          .factor = FIVE,
                          .factors = 4,
                          .centre_points = 3,
                          .composite_blocks = true},
       &plan);
  assert_int_equal(plan.runs, 16 + 8 + 6);
  assert_int_equal(plan.blocks, 2);
  for (size_t i = 0; i < plan.runs; i++) {
    const double *x = plan.run[i].coded;
    fourth += pow(x[0], 4);
    mixed += x[0] * x[0] * x[1] * x[1];
    if (strcmp(plan.run[i].point, "axial") == 0) assert_int_equal(plan.run[i].block, 2);
  }
  assert_true(fabs(fourth - 3 * mixed) < 1e-9);
  fg_plan_free(&plan);
}

static void box_behnken_sizes(void **state) {
  static const size_t edges[] = {12, 24, 40, 48, 56};
  (void)state;
  for (size_t k = 3; k <= 7; k++) {
    fg_plan plan;
    make(
        &(fg_plan_options){
            .kind = FG_PLAN_BOX_BEHNKEN, .factor = FIVE, .factors = k, .centre_points = 3},
        &plan);
    assert_int_equal(count_points(&plan, "edge"), edges[k - 3]);
    assert_int_equal(count_points(&plan, "centre"), 3);
    for (size_t a = 0; a < k; a++) {
      assert_true(inner(&plan, a, a) == inner(&plan, 0, 0));
      for (size_t b = 0; b < a; b++)
        assert_true(inner(&plan, a, b) == 0);
    }
    fg_plan_free(&plan);
  }
}

/* Blocks by A:B:C: the block carries the interaction, and nothing else. */
static void blocks_take_one_interaction(void **state) {
  static const char *const blocks[] = {"A:B:C"};
  fg_plan plan;
  (void)state;
  make(&(fg_plan_options){.factor = FIVE,
                          .factors = 3,
                          .block_generator = blocks,
                          .block_generators = 1,
                          .replicates = 2,
                          .centre_points = 1},
       &plan);
  assert_int_equal(plan.runs, 18);
  assert_int_equal(plan.blocks, 2);
  double main_effect = 0;
  for (size_t i = 0; i < plan.runs; i++) {
    const double *x = plan.run[i].coded;
    double sign = plan.run[i].block == 2 ? 1 : -1;
    if (i) assert_true(plan.run[i].block >= plan.run[i - 1].block);
    main_effect += sign * x[0];
    if (strcmp(plan.run[i].point, "corner") == 0) assert_true(x[0] * x[1] * x[2] == sign);
  }
  assert_true(main_effect == 0);
  fg_plan_free(&plan);
}

static void the_seed_is_the_order(void **state) {
  fg_plan a, b, c;
  size_t moved = 0;
  (void)state;
  make(&(fg_plan_options){.factor = FIVE, .factors = 5, .seed = 1}, &a);
  make(&(fg_plan_options){.factor = FIVE, .factors = 5, .seed = 1}, &b);
  make(&(fg_plan_options){.factor = FIVE, .factors = 5, .seed = 2}, &c);
  bool seen[33] = {false};
  for (size_t i = 0; i < 32; i++) {
    assert_int_equal(a.run[i].standard, b.run[i].standard);
    moved += a.run[i].standard != c.run[i].standard;
    seen[a.run[i].standard] = true;
  }
  for (size_t i = 1; i <= 32; i++)
    assert_true(seen[i]);
  assert_true(moved > 20);
  fg_plan_free(&a);
  fg_plan_free(&b);
  fg_plan_free(&c);
}

/* Over many seeds every run comes first about equally often: chi² on 7 below its 1e-4 point. */
static void the_order_is_fair(void **state) {
  enum { SEEDS = 4000 };
  double first[8] = {0}, chi2 = 0;
  (void)state;
  for (uint64_t seed = 0; seed < SEEDS; seed++) {
    fg_plan plan;
    make(&(fg_plan_options){.factor = FIVE, .factors = 3, .seed = seed}, &plan);
    first[plan.run[0].standard - 1]++;
    fg_plan_free(&plan);
  }
  for (size_t i = 0; i < 8; i++)
    chi2 += pow(first[i] - SEEDS / 8.0, 2) / (SEEDS / 8.0);
  assert_true(chi2 < 29.9);
}

/* Temperature is hard to change: each load holds one temperature, loads of one replicate each. */
static void hard_factors_make_whole_plots(void **state) {
  static const fg_plan_factor factors[] = {
      {"T", 500, 600, true, 0}, {"D", 3, 5, false, 0}, {"P", 300, 400, false, 0}};
  fg_plan plan;
  (void)state;
  make(&(fg_plan_options){.factor = factors, .factors = 3, .replicates = 3, .seed = 11}, &plan);
  assert_int_equal(plan.runs, 24);
  assert_int_equal(plan.plots, 6);
  for (size_t i = 1; i < plan.runs; i++) {
    const fg_plan_run *now = &plan.run[i], *before = &plan.run[i - 1];
    assert_true(now->plot == before->plot || now->plot == before->plot + 1);
    if (now->plot == before->plot) assert_true(now->coded[0] == before->coded[0]);
  }
  fg_plan_free(&plan);
}

static void impossible_plans_are_refused(void **state) {
  static const fg_plan_factor same[] = {{"A", 1, 1, false, 0}};
  static const fg_plan_factor twice[] = {{"A", 0, 1, false, 0}, {"A", 0, 1, false, 0}};
  static const char *const unknown[] = {"D=A:X"}, *const no_equals[] = {"ABC"},
                           *const doubled[] = {"D=A:B", "D=A:C"},
                           *const alike[] = {"C=A:B", "D=A:B"},
                           *const chained[] = {"C=A:B", "D=A:C"};
  const struct {
    fg_plan_options options;
    const char *words;
  } cases[] = {
      {{.factor = FIVE, .factors = 0}, "0 factors"},
      {{.factor = same, .factors = 1}, "the low level must be below"},
      {{.factor = twice, .factors = 2}, "two factors are called 'A'"},
      {{.factor = FIVE, .factors = 4, .generator = unknown, .generators = 1}, "no factor 'X'"},
      {{.factor = FIVE, .factors = 4, .generator = no_equals, .generators = 1},
       "D=A:B:C is expected"},
      {{.factor = FIVE, .factors = 4, .generator = doubled, .generators = 2}, "has two generators"},
      {{.factor = FIVE, .factors = 4, .generator = chained, .generators = 2}, "basic ones only"},
      {{.kind = FG_PLAN_BOX_BEHNKEN, .factor = FIVE, .factors = 2}, "needs 3 to 7 factors"},
      {{.kind = FG_PLAN_COMPOSITE, .factor = FIVE, .factors = 2, .axial = NAN}, "axial distance"},
      {{.factor = FIVE, .factors = 7, .replicates = 100000}, "more than 100000 runs"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_plan plan;
    assert_status(&ctx, fg_plan_make(&ctx, &cases[i].options, &plan), FG_ERR_USAGE);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("case %zu: '%s' lacks '%s'", i, ctx.message, cases[i].words);
  }
  fg_plan plan;
  make(&(fg_plan_options){.factor = FIVE, .factors = 4, .generator = alike, .generators = 2},
       &plan);
  assert_int_equal(plan.resolution, 2); /* C and D are one column: allowed, and said */
  fg_plan_free(&plan);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(fractions_have_their_resolution),
      cmocka_unit_test(the_modified_composite_is_the_thesis_one),
      cmocka_unit_test(composites_are_rotatable),
      cmocka_unit_test(box_behnken_sizes),
      cmocka_unit_test(blocks_take_one_interaction),
      cmocka_unit_test(the_seed_is_the_order),
      cmocka_unit_test(the_order_is_fair),
      cmocka_unit_test(hard_factors_make_whole_plots),
      cmocka_unit_test(impossible_plans_are_refused),
  };
  return cmocka_run_group_tests_name("plan", tests, NULL, NULL);
}
