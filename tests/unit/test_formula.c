/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas: canonical form, contrasts as in R, and the words of an error. */
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/formula.h"
#include "support/test.h"

static void formulas_are_canonical(void **state) {
  static const struct {
    const char *text, *canonical;
  } cases[] = {
      {"1 + T + D + T:D + T^2", "1 + T + D + T:D + T^2"},
      {"T*D", "1 + T + D + T:D"},
      {"T:D + T", "1 + T + T:D"},
      {"y ~ a*b*c", "1 + a + b + c + a:b + a:c + b:c + a:b:c"},
      {"(a + b + c)^2", "1 + a + b + c + a:b + a:c + b:c"},
      {"(a + b + c)^2 - a:b", "1 + a + b + c + a:c + b:c"},
      {"a*b - b", "1 + a + a:b"},
      {"a + b - 1", "0 + a + b"},
      {"0 + a", "0 + a"},
      {"a + 0", "0 + a"},
      {"-1 + a:b", "0 + a:b"},
      {"a/b", "1 + a + a:b"},
      {"a:a + a", "1 + a"},
      {"I(T^2) + T^2", "1 + T^2"},
      {"(T)^2 + T", "1 + T"},
      {"factor(m) + log(t):T^2", "1 + factor(m) + log(t):T^2"},
      {"`time, h` + x.1_a", "1 + time, h + x.1_a"},
      {"b:a + a:b", "1 + b:a"},
      {"1", "1"},
      {"\xce\xb8 + T", "1 + \xce\xb8 + T"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_formula formula;
    char *text = NULL;
    if (fg_formula_parse(&ctx, cases[i].text, &formula) != FG_OK) fail_msg("%s", ctx.message);
    assert_ok(&ctx, fg_formula_format(&ctx, &formula, &text));
    assert_string_equal(text, cases[i].canonical);
    free(text);
    fg_formula_free(&formula);
  }
}

static void errors_say_where(void **state) {
  static const struct {
    const char *text, *words;
  } cases[] = {
      {"", "character 1: the formula ends early"},
      {"T +", "character 4: the formula ends early"},
      {"T + * D", "character 5: a name is expected"},
      {"T D", "character 3: +, -, :, * or the end"},
      {"(T + D", "character 7: a ) is missing"},
      {"T + 2", "character 5: only 0 and 1"},
      {"T^0", "the power is a whole number"},
      {"T^99", "the power is a whole number"},
      {"T^D", "the power is a whole number"},
      {"sin(T)", "no other function"},
      {"`T", "a ` without its partner"},
      {"y z ~ T", "a ~ is expected"},
      {"T ~ y ~ D", "+, -, :, * or the end"},
      {"((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((T",
       "too many brackets"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_formula formula;
    assert_status(&ctx, fg_formula_parse(&ctx, cases[i].text, &formula), FG_ERR_USAGE);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("'%s': '%s' lacks '%s'", cases[i].text, ctx.message, cases[i].words);
  }
}

static const char TABLE[] = "x,f,g\n1,b,u\n2,a,v\n4,c,u\n8,a,u\n";

/* Column names joined by blanks; the names are R's model.matrix's, but for (constant). */
static void check_columns(const char *formula_text, const char *names) {
  fg_context ctx = {0};
  fg_table table;
  fg_formula formula;
  fg_model model;
  char *joined = NULL;
  assert_ok(&ctx, fg_table_parse(&ctx, "t", TABLE, strlen(TABLE), &table));
  assert_ok(&ctx, fg_formula_parse(&ctx, formula_text, &formula));
  if (fg_model_build(&ctx, &table, &formula, &model) != FG_OK) fail_msg("%s", ctx.message);
  for (size_t i = 0; i < model.columns; i++)
    assert_ok(&ctx, fg_text_append(&ctx, &joined, "%s%s", i ? " " : "", model.column[i].name));
  assert_string_equal(joined, names);
  free(joined);
  fg_model_free(&model);
  fg_formula_free(&formula);
  fg_table_free(&table);
}

static void factors_are_coded_as_in_r(void **state) {
  (void)state;
  check_columns("f", "(constant) fb fc");
  check_columns("0 + f", "fa fb fc");
  check_columns("0 + f + g", "fa fb fc gv");
  check_columns("0 + x + f", "x fa fb fc");
  check_columns("f*g", "(constant) fb fc gv fb:gv fc:gv");
  check_columns("f:g", "(constant) fa:gu fb:gu fc:gu fa:gv fb:gv fc:gv");
  check_columns("f/g", "(constant) fb fc fa:gv fb:gv fc:gv");
  check_columns("x*f", "(constant) x fb fc x:fb x:fc");
  check_columns("x:f", "(constant) x:fa x:fb x:fc");
  check_columns("0 + x:f", "x:fa x:fb x:fc");
  check_columns("f + x:f", "(constant) fb fc fa:x fb:x fc:x");
  check_columns("factor(x)", "(constant) factor(x)2 factor(x)4 factor(x)8");
  check_columns("f^2 + f + x^3", "(constant) fb fc x^3");
}

static void the_matrix_holds_products(void **state) {
  fg_context ctx = {0};
  fg_table table;
  fg_formula formula;
  fg_model model;
  (void)state;
  assert_ok(&ctx, fg_table_parse(&ctx, "t", TABLE, strlen(TABLE), &table));
  assert_ok(&ctx, fg_formula_parse(&ctx, "inverse(x) + x^2:g + sqrt(x)", &formula));
  assert_ok(&ctx, fg_model_build(&ctx, &table, &formula, &model));
  assert_int_equal(model.columns, 5);
  const double expected[4][5] = {{1, 1, 1, 1, 0},
                                 {1, 0.5, 1.4142135623730951, 0, 4},
                                 {1, 0.25, 2, 16, 0},
                                 {1, 0.125, 2.8284271247461903, 64, 0}};
  for (size_t i = 0; i < 4; i++)
    for (size_t j = 0; j < 5; j++)
      assert_true(model.matrix[j * 4 + i].value == expected[i][j]);
  double at[5];
  /* variables in order of appearance: inverse(x), x, g, sqrt(x) */
  assert_ok(&ctx, fg_model_row(&ctx, &model, (double[]){2, 2, 1, 2}, at));
  for (size_t j = 0; j < 5; j++)
    assert_true(at[j] == expected[1][j]);
  fg_model_free(&model);
  fg_formula_free(&formula);
  fg_table_free(&table);
}

static void bad_models_are_refused(void **state) {
  static const struct {
    const char *text, *formula, *words;
  } cases[] = {
      {"x,f\n1,a\n2,a\n", "f", "the factor 'f' has one level only ('a')"},
      {"x,f\n1,a\n2,b\n", "z", "there is no column 'z'; the columns are x, f"},
      {"x,f\n1,a\n0,b\n", "log(x)", "row 2, column 'x': log(x) of 0 is not a number"},
      {"x,f\n1,a\nten,b\n", "x", "row 2 (line 3), column 'x': 'ten' is not a number"},
      {"x,f\n1,a\n2,\n", "f", "row 2 (line 3), column 'f': the cell is empty"},
      {"x,f\n1,a\n2,b\n", "0", "the model has no terms"},
      {"x,f\n1,a\n1e200,b\n", "x^2", "row 2: the term x^2 overflows"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_formula formula;
    fg_model model;
    assert_ok(&ctx, fg_table_parse(&ctx, "t", cases[i].text, strlen(cases[i].text), &table));
    assert_ok(&ctx, fg_formula_parse(&ctx, cases[i].formula, &formula));
    assert_int_not_equal(fg_model_build(&ctx, &table, &formula, &model), FG_OK);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("case %zu: '%s' lacks '%s'", i, ctx.message, cases[i].words);
    fg_formula_free(&formula);
    fg_table_free(&table);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(formulas_are_canonical),    cmocka_unit_test(errors_say_where),
      cmocka_unit_test(factors_are_coded_as_in_r), cmocka_unit_test(the_matrix_holds_products),
      cmocka_unit_test(bad_models_are_refused),
  };
  return cmocka_run_group_tests_name("formula", tests, NULL, NULL);
}
