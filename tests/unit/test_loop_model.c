/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model file: a written model loads again, and takes the effect out of another table. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "foilgauge/loop_model.h"
#include "support/random.h"
#include "support/test.h"

enum { RUNS = 30 };

static void make_table(fg_table *table, uint64_t seed, double humidity_slope, double sd) {
  double run[RUNS], t[RUNS], humidity[RUNS], y[RUNS];
  for (size_t i = 0; i < RUNS; i++) {
    run[i] = (double)i + 1;
    t[i] = 500 + 50 * (double)(i % 3);
    humidity[i] = i == 0 ? 20 : i == 1 ? 60 : 20 + 40 * random_uniform(&seed);
    y[i] = 3 + t[i] / 100 + humidity_slope * humidity[i] + sd * random_gaussian(&seed);
  }
  assert_ok(&test_context, fg_table_add_numbers(&test_context, table, "run", run, RUNS));
  assert_ok(&test_context, fg_table_add_numbers(&test_context, table, "t", t, RUNS));
  assert_ok(&test_context, fg_table_add_numbers(&test_context, table, "humidity", humidity, RUNS));
  assert_ok(&test_context, fg_table_add_numbers(&test_context, table, "y", y, RUNS));
}

static void write_model(const char *path) {
  fg_context ctx = {0};
  fg_table table = {0};
  fg_loop_table_problem problem;
  fg_loop_result result;
  fg_loop_table_spec spec = {.response = "y", .model = "1 + t", .seed = 1};
  fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
  make_table(&table, 7, 0.1, 0.2);
  assert_ok(&ctx, fg_loop_table_problem_build(&ctx, &table, &spec, &problem));
  assert_ok(&ctx, fg_loop_run(&ctx, &problem.problem, &options, &result));
  assert_int_equal(result.claims, 1);
  fg_loop_report report = {.path = "found.csv",
                           .sha256 = "",
                           .spec = &spec,
                           .problem = &problem,
                           .result = &result,
                           .seed = 1};
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_ok(&ctx, fg_loop_write_model(&ctx, &report, file));
  fclose(file);
  fg_loop_result_free(&result);
  fg_loop_table_problem_free(&problem);
  fg_table_free(&table);
}

/* Left in the response: t alone, and the constant that the effect's centre went into. */
static void the_effect_is_taken_out(void **state) {
  char path[] = "/tmp/foilgauge_loop_model_XXXXXX";
  fg_context ctx = {0};
  fg_table other = {0};
  fg_loop_model *model = NULL;
  (void)state;
  close(mkstemp(path));
  write_model(path);
  if (fg_loop_model_load(&ctx, path, &model) != FG_OK) fail_msg("%s", ctx.message);
  assert_string_equal(fg_loop_model_response(model), "y");
  assert_string_equal(fg_loop_model_formula(model), "1 + t");
  make_table(&other, 99, 0.1, 0);
  if (fg_loop_model_apply(&ctx, model, &other) != FG_OK) fail_msg("%s", ctx.message);
  for (size_t i = 0; i < RUNS; i++) {
    double expected = 3 + other.column[1].number[i].value / 100 + 0.1 * 40;
    assert_near(other.column[3].number[i].value, expected, 0.25);
  }
  other.column[2].number[4].value = 90;
  assert_status(&ctx, fg_loop_model_apply(&ctx, model, &other), FG_ERR_DATA);
  assert_has(ctx.message, "row 5: humidity is 90");
  fg_table_free(&other);
  fg_loop_model_free(model);
  unlink(path);
}

static void invalid_models_are_refused(void **state) {
  static const char *const texts[] = {"", "[]", "{}", "{\"schema\": \"foilgauge/loop/1\"}",
                                      "{\"schema\": \"foilgauge/loop-model/1\"}"};
  char path[] = "/tmp/foilgauge_loop_model_XXXXXX";
  (void)state;
  close(mkstemp(path));
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    in_row("texts[%zu]", i);
    fg_context ctx = {0};
    fg_loop_model *model = NULL;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(texts[i], file);
    fclose(file);
    assert_status(&ctx, fg_loop_model_load(&ctx, path, &model), FG_ERR_DATA);
    assert_null(model);
    assert_has(ctx.message, path);
  }
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_effect_is_taken_out),
      cmocka_unit_test(invalid_models_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
