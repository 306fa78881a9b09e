/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bearings drawn from a stock of foils: the shares against all draws there are, and the same draws
 * for the same seed. */
#include <string.h>

#include "foilgauge/report.h"
#include "lot/statistics/assembly.h"
#include "support/random.h"
#include "support/test.h"

enum { PADS = 3, BUMPS = 9 };

/* Foils of different mean, bumps that scatter about it. */
static fg_stock made_stock(size_t foils, double between, double inside) {
  fg_context ctx;
  fg_stock stock;
  uint64_t seed = 5;
  assert_ok(&ctx, fg_stock_allocate(&ctx, foils, BUMPS, &stock));
  for (size_t i = 0; i < foils; i++) {
    double mean = 0.02 + between * (random_uniform(&seed) - 0.5);
    for (size_t k = 0; k < BUMPS; k++) {
      stock.clearance_mm[i * BUMPS + k] = mean + inside * (random_uniform(&seed) - 0.5);
      stock.shared_mm[i * BUMPS + k] = 1e-3;
    }
  }
  return stock;
}

static fg_assembly_plan made_plan(size_t bearings, double circularity) {
  return (fg_assembly_plan){
      .layout = {PADS, BUMPS, 1, 40.0 / 3},
      .bearings = bearings,
      .seed = 1,
      .confidence = 0.95,
      .limit = {{fg_quantity_of_bearing_for("clearance_min_mm"), 0, INFINITY, false},
                {fg_quantity_of_bearing_for("clearance_centred_min_mm"), 0, INFINITY, true},
                {fg_quantity_of_bearing_for("circularity_mm"), -INFINITY, circularity, true}},
      .limits = 3};
}

static void assess(const fg_stock *stock, const fg_assembly_plan *plan, const size_t foil[PADS],
                   fg_bearing_clearance *bearing) {
  double angle[PADS * BUMPS], clearance[PADS * BUMPS];
  fg_context ctx;
  for (size_t i = 0; i < PADS * BUMPS; i++) {
    angle[i] = fg_bearing_angle_deg(&plan->layout, i / BUMPS, i % BUMPS);
    clearance[i] = stock->clearance_mm[foil[i / BUMPS] * BUMPS + i % BUMPS];
  }
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, PADS * BUMPS, bearing));
}

/* Every ordered choice of three different foils: what the draws are a sample of. */
static void enumerate(const fg_stock *stock, const fg_assembly_plan *plan, double share[4]) {
  size_t all = 0, foils = stock->foils;
  fg_bearing_clearance bearing;
  for (size_t i = 0; i < foils; i++)
    for (size_t j = 0; j < foils; j++)
      for (size_t k = 0; k < foils; k++) {
        if (i == j || i == k || j == k) continue;
        assess(stock, plan, (const size_t[]){i, j, k}, &bearing);
        bool room = bearing.centred_min_mm >= 0;
        bool round = bearing.circularity_mm <= plan->limit[2].upper;
        share[0] += bearing.min_mm >= 0;
        share[1] += room;
        share[2] += round;
        share[3] += room && round;
        all++;
      }
  for (int i = 0; i < 4; i++)
    share[i] /= (double)all;
}

/* Four foils, three pads: 24 bearings there are, 20,000 draws of them. Four standard errors. */
static void draws_agree_with_all_there_are(void **state) {
  (void)state;
  fg_context ctx;
  fg_stock stock = made_stock(4, 0.05, 0.03);
  fg_assembly_plan plan = made_plan(20000, 0.048);
  fg_assembly_result result;
  double share[4] = {0};
  enumerate(&stock, &plan, share);
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, false, &result));
  const double drawn[] = {result.within[0].share, result.within[1].share, result.within[2].share,
                          result.assembled.share};
  int between = 0;
  for (int i = 0; i < 4; i++) {
    between += share[i] > 0 && share[i] < 1;
    assert_near(drawn[i], share[i], 4 * sqrt(share[i] * (1 - share[i]) / 20000) + 1e-12);
  }
  assert_true(between >= 2); /* shares of 0 and 1 alone would prove nothing */
  assert_true(result.assembled.draws_low <= share[3] && share[3] <= result.assembled.draws_high);
  assert_int_equal(result.assembled.count + result.rejected[1] + result.rejected[2] -
                       (result.rejected[1] - result.alone[1]),
                   20000);
  fg_assembly_result_free(&result);
  fg_stock_free(&stock);
}

static void a_bearing_has_different_foils(void **state) {
  (void)state;
  size_t foil[PADS], seen[5] = {0};
  for (size_t draw = 0; draw < 3000; draw++) {
    fg_assembly_pick(3, draw, 5, PADS, foil);
    assert_true(foil[0] != foil[1] && foil[0] != foil[2] && foil[1] != foil[2]);
    for (size_t pad = 0; pad < PADS; pad++)
      seen[foil[pad]]++;
  }
  for (size_t i = 0; i < 5; i++)
    assert_near((double)seen[i], 1800, 4 * sqrt(1800 * 0.4));
}

static void a_seed_is_a_result(void **state) {
  (void)state;
  fg_context ctx;
  fg_stock stock = made_stock(9, 0.05, 0.03);
  fg_assembly_plan plan = made_plan(1000, 0.048), other = plan;
  fg_assembly_result a, b, c;
  other.seed = 2;
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &a));
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &b));
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &other, false, &c));
  assert_memory_equal(&a.assembled.share, &b.assembled.share, sizeof(double));
  assert_memory_equal(a.value[0], b.value[0], 1000 * sizeof(double));
  assert_memory_equal(&a.assembled.foils_low, &b.assembled.foils_low, sizeof(double));
  assert_memory_not_equal(a.value[0], c.value[0], 1000 * sizeof(double));
  fg_assembly_result_free(&a);
  fg_assembly_result_free(&b);
  fg_assembly_result_free(&c);
  fg_stock_free(&stock);
}

/* The interval by foils is wider than that by draws, and shrinks with more foils; a share of 1 of
 * few foils is not known to be 1. */
static void few_foils_are_an_interval(void **state) {
  (void)state;
  fg_context ctx;
  double width[2];
  for (int i = 0; i < 2; i++) {
    fg_stock stock = made_stock(i ? 60 : 9, 0.05, 0.03);
    fg_assembly_plan plan = made_plan(1000, 0.048);
    fg_assembly_result r;
    assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &r));
    assert_string_equal(r.assembled.foils_by, FG_ASSEMBLY_BY_BOOTSTRAP);
    assert_true(r.assembled.foils_low <= r.assembled.share);
    assert_true(r.assembled.foils_high >= r.assembled.share);
    width[i] = r.assembled.foils_high - r.assembled.foils_low;
    assert_true(width[i] > r.assembled.draws_high - r.assembled.draws_low);
    fg_assembly_result_free(&r);
    plan.limit[2].upper = 1;
    plan.limit[1].lower = -1;
    assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &r));
    assert_near(r.assembled.share, 1, 0);
    assert_string_equal(r.assembled.foils_by, FG_ASSEMBLY_BY_BEARINGS);
    /* All of n bearings: (1 - c) / 2 = low^n. */
    assert_near(pow(r.assembled.foils_low, i ? 20 : 3), 0.025, 1e-9);
    fg_assembly_result_free(&r);
    fg_stock_free(&stock);
  }
  assert_true(width[1] < 0.7 * width[0]);
}

/* Of many foils and few draws, what the foils tell is no narrower than what the draws tell. */
static void few_draws_of_many_foils(void **state) {
  (void)state;
  fg_context ctx;
  fg_stock stock = made_stock(600, 0.05, 0.03);
  fg_assembly_plan plan = made_plan(150, 1);
  fg_assembly_result r;
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &r));
  for (size_t k = 0; k < plan.limits; k++) {
    const fg_assembly_share *s = &r.within[k];
    if (!(s->share > 0.1 && s->share < 0.9)) continue;
    assert_true(s->foils_high - s->foils_low > s->draws_high - s->draws_low);
  }
  assert_true(r.within[0].share > 0.1 && r.within[0].share < 0.9);
  fg_assembly_result_free(&r);
  fg_stock_free(&stock);
}

/* Clopper and Pearson's table: 0 of 10 at 95 % is 0 to 30.85 %, 5 of 10 18.71 to 81.29 %. */
static void intervals_are_exact(void **state) {
  (void)state;
  double low, high;
  fg_assembly_interval(0, 10, 0.95, &low, &high);
  assert_near(low, 0, 0);
  assert_near(high, 0.3085, 5e-5);
  fg_assembly_interval(5, 10, 0.95, &low, &high);
  assert_near(low, 0.1871, 5e-5);
  assert_near(high, 0.8129, 5e-5);
  /* Shares that are no whole number of bearings, as of few foils: always an interval about them. */
  for (double of = 4.0 / 3; of < 40; of += 1.0 / 3)
    for (double share = 0.001; share < 1; share += 0.0173) {
      fg_assembly_interval(share * of, of, 0.95, &low, &high);
      assert_true(low >= 0 && low <= share && high >= share && high <= 1);
    }
}

/* Measurement uncertainty: a value within U of a limit is neither surely in nor surely out. */
static void uncertainty_is_a_share_of_its_own(void **state) {
  (void)state;
  fg_context ctx;
  /* Of 60 foils some have their smallest clearance within U of the limit. */
  fg_stock stock = made_stock(60, 0.05, 0.03);
  fg_assembly_plan plan = made_plan(1000, 1);
  fg_assembly_result r;
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, false, &r));
  assert_true(r.within[0].surely < r.within[0].share);
  size_t surely = 0, possibly = 0; /* all share 1 um: as if the limit were 2 um higher, lower */
  for (size_t i = 0; i < r.values[1]; i++) {
    surely += r.value[1][i] >= 2e-3;
    possibly += r.value[1][i] >= -2e-3;
  }
  assert_near(r.within[0].surely, (double)surely / 1000, 1e-12);
  assert_near(r.within[0].possibly, (double)possibly / 1000, 1e-12);
  fg_assembly_result_free(&r);
  fg_stock_free(&stock);
}

/* Within ± 7 % of 65.5 um nothing falls below 60.9 um, and circularity cannot exceed much more than
 * 9.2 um; sorted foils of one kind each make rounder bearings than mixed ones. */
static void design_and_sorting(void **state) {
  (void)state;
  fg_context ctx;
  fg_assembly_plan plan = made_plan(1000, 0.02);
  fg_assembly_result r;
  assert_ok(&ctx, fg_assembly_draw_design(&ctx, 0.0655, 0.07 * 0.0655, &plan, &r));
  assert_true(r.value[1][0] >= 0.93 * 0.0655 && r.value[1][0] < 0.93 * 0.0655 + 2e-5);
  assert_near(r.assembled.share, 1, 0);
  fg_assembly_result_free(&r);

  fg_stock stock = made_stock(6, 0, 0.004);
  for (size_t i = 0; i < 6 * BUMPS; i++)
    stock.clearance_mm[i] += i / BUMPS % 2 ? 0.05 : 0;
  size_t sorted;
  assert_ok(&ctx, fg_assembly_draw(&ctx, &stock, &plan, false, &r));
  assert_true(r.assembled.share < 0.3);
  assert_ok(&ctx, fg_assembly_draw_sorted(&ctx, &stock, &plan, 2, &sorted));
  assert_int_equal(sorted, 1000);
  fg_assembly_result_free(&r);
  fg_stock_free(&stock);
}

static void too_few_foils_are_refused(void **state) {
  (void)state;
  fg_context ctx;
  fg_stock stock = made_stock(2, 0.05, 0.03);
  fg_assembly_plan plan = made_plan(10, 0.05);
  fg_assembly_result r;
  assert_status(&ctx, fg_assembly_draw(&ctx, &stock, &plan, true, &r), FG_ERR_DATA);
  assert_has(ctx.message, "2 foils; a bearing takes 3");
  fg_stock_free(&stock);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(draws_agree_with_all_there_are),
      cmocka_unit_test(a_bearing_has_different_foils),
      cmocka_unit_test(a_seed_is_a_result),
      cmocka_unit_test(few_foils_are_an_interval),
      cmocka_unit_test(few_draws_of_many_foils),
      cmocka_unit_test(intervals_are_exact),
      cmocka_unit_test(uncertainty_is_a_share_of_its_own),
      cmocka_unit_test(design_and_sorting),
      cmocka_unit_test(too_few_foils_are_refused),
  };
  return cmocka_run_group_tests_name("assembly", tests, NULL, NULL);
}
