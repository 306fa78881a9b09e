/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scale of the response: rates that add make unequal scatter and interaction in times. */
#include <math.h>
#include <string.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/random.h"
#include "support/test.h"

enum { DRUGS = 4, DOSES = 3, REPEATS = 6, ROWS = DRUGS * DOSES * REPEATS };

typedef struct outcome {
  fg_context ctx;
  fg_table table;
  fg_loop_table_problem problem;
  fg_loop_result result;
} outcome;

/* Rates of drugs and doses add; the response is the rate, or the time. */
static void search(bool times, double wrong, uint64_t seed, outcome *out) {
  double drug[ROWS], dose[ROWS], y[ROWS];
  const fg_loop_options options = {.effects = fg_loop_table_effects()};
  const fg_loop_table_spec spec = {.response = "y", .model = "factor(drug) + factor(dose)"};
  *out = (outcome){0};
  for (size_t i = 0; i < ROWS; i++) {
    drug[i] = (double)(i % DRUGS);
    dose[i] = (double)(i / DRUGS % DOSES);
    double rate = 2.2 - 0.35 * drug[i] + 0.9 * dose[i] + 0.25 * random_gaussian(&seed);
    y[i] = times ? 1 / rate : rate;
  }
  y[10] += wrong;
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "drug", drug, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "dose", dose, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "y", y, ROWS));
  assert_ok(&out->ctx, fg_loop_table_problem_build(&out->ctx, &out->table, &spec, &out->problem));
  assert_ok(&out->ctx, fg_loop_run(&out->ctx, &out->problem.problem, &options, &out->result));
}

static void clear_outcome(outcome *out) {
  fg_loop_result_free(&out->result);
  fg_loop_table_problem_free(&out->problem);
  fg_table_free(&out->table);
}

static bool is_tied_with_scale(const fg_loop_claim *claim) {
  for (size_t k = 0; k < claim->aliases; k++)
    if (!strcmp(claim->alias[k].name, "table.response_scale(1/response)")) return true;
  return false;
}

static void times_whose_rates_add_are_tied_with_their_scale(void **state) {
  outcome out;
  (void)state;
  search(true, 0, 4, &out);
  const fg_loop_response_scale *scale = &out.result.scale;
  assert_true(scale->known && scale->chosen == -1 && scale->p_value < 1e-4);
  assert_true(scale->interval[0] < -1 && scale->interval[1] > -1 && scale->interval[1] < 0.5);
  assert_true(out.result.claims > 0 && scale->removes > 0);
  assert_true(is_tied_with_scale(&out.result.claim[0]));
  assert_int_equal(out.result.claim[0].verdict, FG_LOOP_TIED);
  clear_outcome(&out);
}

static void rates_stay_as_they_are(void **state) {
  outcome out;
  (void)state;
  search(false, 0, 4, &out);
  assert_true(out.result.scale.known && out.result.scale.chosen == 1);
  assert_int_equal(out.result.scale.removes, 0);
  clear_outcome(&out);
}

/* Neither the search for scatter nor the scale may rest on it. */
static void one_wrong_row_is_no_scale(void **state) {
  outcome out;
  (void)state;
  search(false, 3, 6, &out);
  for (size_t m = 0; m < out.result.claims; m++)
    assert_string_not_equal(out.result.claim[m].candidate.effect->id, "table.spread");
  assert_int_equal(out.result.scale.removes, 0);
  clear_outcome(&out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(times_whose_rates_add_are_tied_with_their_scale),
      cmocka_unit_test(rates_stay_as_they_are),
      cmocka_unit_test(one_wrong_row_is_no_scale),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
