/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of the loop depend neither on the units nor on the origin of its numbers, and no report
 * holds a number that is none, whatever the input. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/loop_model.h"
#include "support/random.h"
#include "support/test.h"

enum { RUNS = 24 };

typedef struct change {
  double scale, offset;               /* of the response */
  double column_scale, column_offset; /* of every column */
} change;

/* y = 20 - 0.03 T + 0.1 humidity + noise of sd 0.5. */
static void make_table(const change *by, fg_table *table) {
  double t[RUNS], humidity[RUNS], y[RUNS];
  fg_context ctx = {0};
  uint64_t seed = 5;
  for (size_t i = 0; i < RUNS; i++) {
    t[i] = 450 + 50 * floor(5 * random_uniform(&seed));
    humidity[i] = 15 + 45 * random_uniform(&seed);
    y[i] = 20 - 0.03 * t[i] + 0.1 * humidity[i] + 0.5 * random_gaussian(&seed);
    y[i] = (y[i] + by->offset) * by->scale;
    t[i] = (t[i] + by->column_offset) * by->column_scale;
    humidity[i] = (humidity[i] + by->column_offset) * by->column_scale;
  }
  *table = (fg_table){0};
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "t", t, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "humidity", humidity, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "y", y, RUNS));
}

static bool holds_word(const char *text, const char *word) {
  size_t length = strlen(word);
  for (const char *at = strcasestr(text, word); at; at = strcasestr(at + 1, word))
    if ((at == text || !isalpha((unsigned char)at[-1])) && !isalpha((unsigned char)at[length]))
      return true;
  return false;
}

typedef fg_status writer(fg_context *ctx, const fg_loop_report *report, FILE *out);

static void check_reports(const fg_loop_report *report) {
  writer *const writers[] = {fg_loop_write_json, fg_loop_write_text, fg_loop_write_html,
                             fg_loop_write_model};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
    in_row("writers[%zu]", i);
    fg_context ctx = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_ok(NULL, writers[i](&ctx, report, out));
    fclose(out);
    if (holds_word(text, "nan") || holds_word(text, "inf")) fail_msg("%s", text);
    free(text);
  }
}

static fg_status run(fg_context *ctx, const fg_table *table, fg_loop_table_spec *spec,
                     fg_loop_result *result) {
  fg_design design;
  fg_loop_table_problem problem;
  const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
  fg_design_default(&design);
  spec->design = &design;
  spec->seed = 1;
  *result = (fg_loop_result){0};
  FG_TRY(fg_loop_table_problem_build(ctx, table, spec, &problem));
  fg_status status = fg_loop_run(ctx, &problem.problem, &options, result);
  fg_loop_report report = {.path = "table.csv",
                           .sha256 = "",
                           .spec = spec,
                           .problem = &problem,
                           .result = result,
                           .seed = 1};
  if (status == FG_OK) check_reports(&report);
  fg_loop_table_problem_free(&problem);
  return status;
}

static void run_changed(const change *by, fg_loop_result *result) {
  fg_context ctx = {0};
  fg_table table;
  fg_loop_table_spec spec = {.response = "y", .model = "1 + t"};
  make_table(by, &table);
  if (run(&ctx, &table, &spec, result) != FG_OK) fail_msg("%s", ctx.message);
  fg_table_free(&table);
}

static void a_finding_does_not_depend_on_the_unit_or_the_origin(void **state) {
  static const change changes[] = {
      {1e-300, 0, 1, 0},   {1e-12, 0, 1, 0},        {1e12, 0, 1, 0},    {1e300, 0, 1, 0},
      {1, 1e6, 1, 0},      {1e-300, 1e6, 1, 0},     {1e280, 1e6, 1, 0}, {1, 0, 1e-290, 0},
      {1, 0, 1e-12, 0},    {1, 0, 1e12, 0},         {1, 0, 1e290, 0},   {1, 0, 1, 1e7},
      {1, 0, 1e-12, -1e6}, {1e200, 0, 1e-200, 1e6},
  };
  fg_loop_result plain, other;
  (void)state;
  run_changed(&(change){1, 0, 1, 0}, &plain);
  assert_int_equal(plain.claims, 1);
  assert_string_equal(plain.claim[0].name, "table.linear(humidity)");
  for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
    in_row("changes[%zu]", i);
    const change *by = &changes[i];
    run_changed(by, &other);
    assert_int_equal(other.verdict, plain.verdict);
    assert_int_equal(other.claims, plain.claims);
    assert_string_equal(other.claim[0].name, plain.claim[0].name);
    assert_int_equal(other.claim[0].verdict, plain.claim[0].verdict);
    assert_near(other.claim[0].p_value, plain.claim[0].p_value, 0.001);
    assert_near(other.claim[0].amplitude / by->scale / plain.claim[0].amplitude, 1, 1e-4);
    assert_near(other.claim[0].amplitude_u / by->scale / plain.claim[0].amplitude_u, 1, 1e-4);
    assert_near(other.after.rms / by->scale / plain.after.rms, 1, 1e-4);
    assert_near(other.noise.rho, plain.noise.rho, 0.01);
    fg_loop_result_free(&other);
  }
  fg_loop_result_free(&plain);
}

/* A table, how it is asked for, and what must be said: an error's words, or a verdict. */
static const struct odd_table {
  const char *response, *model, *group, *table, *words;
} odd[] = {
    {"y", "1", NULL, "x,y\n1,5\n2,5\n3,5\n4,5\n5,5\n6,5\n7,5\n8,5\n", NULL},
    {"y", "1", NULL, "x,y\n1,0\n2,0\n3,0\n4,0\n5,0\n6,0\n7,0\n8,0\n", NULL},
    {"y", "1", NULL, "x,y\n1,1\n1,2\n1,3\n1,2\n1,3\n1,1\n1,2\n1,4\n", NULL},
    {"y", "1", NULL, "y\n1\n2\n3\n2\n3\n1\n2\n4\n", NULL},
    {"y", "1", NULL, "x,y\n1,2\n", "measure more rows"},
    {"y", "1", NULL, "x,y\n1,2\n2,3\n", "measure more rows"},
    {"y", "1", NULL, "x,y\n1,2\n2,3\n3,5\n", "measure more rows"},
    {"y", "1", NULL, "x,y\n1,2\n2,3\n3,5\n4,4\n", NULL},
    {"y", "1 + x", NULL, "x,y\n1,2\n1,3\n1,5\n1,4\n1,3\n", NULL}, /* x is the constant again */
    {"y", "x - 1", NULL, "x,y\n0,2\n0,3\n0,5\n0,4\n0,3\n", NULL},
    {"y", "1", NULL, "x,y\n1,2\n2,nan\n3,5\n4,4\n", "row 2"},
    {"y", "1 + x", NULL, "x,y\n1,2\n2,3\ninf,5\n4,4\n", "row 3"},
    {"y", "1", NULL, "x,y\n1,2\n2,1e999\n3,5\n4,4\n", "row 2"},
    {"y", "1", NULL, "x,y\n1,1e306\n2,2e306\n3,3e306\n4,1e306\n5,2e306\n", "another unit"},
    {"y", "1", NULL, "x,y\n1,1e-306\n2,2e-306\n3,3e-306\n4,1e-306\n5,2e-306\n", "another unit"},
    {"y", "1", NULL, "x,y\n1e307,1\n-1e307,2\n1,3\n2,1\n3,2\n4,3\n", NULL}, /* x is left out */
    {"y", "1 + x^2", NULL, "x,y\n1e200,1\n2e200,2\n1,3\n2,1\n3,2\n4,3\n", "overflows"},
    {"y", "1 + x^2", NULL, "x,y\n1e-200,1\n2e-200,2\n1,3\n2,1\n3,2\n4,3\n", "too small"},
    {"y", "1", "g", "g,y\n1,2\n1,3\n1,2\n1,4\n1,3\n1,5\n1,2\n1,1\n", NULL}, /* one group */
    {"y", "1", "g", "g,y\nA,2\nB,3\nC,2\nD,4\nE,3\nF,5\nG,2\nH,1\n", NULL}, /* a row each */
    {"y", "1 + factor(g)", NULL, "g,y\n1,2\n2,3\n3,2\n4,4\n", "measure more rows"},
    {"y", "1", NULL,
     "x,y\n100000000000000000,1\n100000000000000016,2\n100000000000000064,1\n100000000000000128,3\n"
     "100000000000000016,2\n",
     NULL},
};

static void odd_tables_get_a_verdict_or_an_error(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
    in_row("odd[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_loop_result result;
    fg_loop_table_spec spec = {
        .response = odd[i].response, .model = odd[i].model, .group = odd[i].group, .hold_out = "0"};
    fg_status status = fg_table_parse(&ctx, "odd.csv", odd[i].table, strlen(odd[i].table), &table);
    assert_ok(NULL, status);
    status = run(&ctx, &table, &spec, &result);
    if (!odd[i].words && status != FG_OK) fail_msg("table %zu: %s", i, ctx.message);
    if (odd[i].words) {
      assert_status(NULL, status, FG_ERR_DATA);
      if (!strstr(ctx.message, odd[i].words)) fail_msg("table %zu: %s", i, ctx.message);
    }
    fg_loop_result_free(&result);
    fg_table_free(&table);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_finding_does_not_depend_on_the_unit_or_the_origin),
      cmocka_unit_test(odd_tables_get_a_verdict_or_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
