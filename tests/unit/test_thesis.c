/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thesis's own analysis: tables 5.2 and 5.3 from table 5.1 to the last printed digit, table 5.5
 * from table 5.4 beside the printed one.
 *
 *     test_thesis --report DIR    writes DIR/thesis_doe.md as well
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/doe.h"
#include "support/data.h"
#include "support/test.h"

static const char RESPONSE[] = "springback_error_pct";
enum { TERMS_MAX = 8, QUANTITIES = 5 };
static const char *const QUANTITY[QUANTITIES] = {"coef", "relative_effect_pct", "se", "t", "p_pct"};

/* A table of the thesis beside the same quantities computed. */
typedef struct comparison {
  const char *title;
  size_t terms;
  char name[TERMS_MAX][24];
  double ours[TERMS_MAX][QUANTITIES], printed[TERMS_MAX][QUANTITIES]; /* NAN: not printed */
} comparison;

static comparison comparisons[4];

static void read_table(const char *name, fg_table *table) {
  fg_context ctx = {0};
  char path[80];
  snprintf(path, sizeof path, "thesis/%s.csv", name);
  char *text = data_read(path);
  if (fg_table_parse(&ctx, name, text, strlen(text), table) != FG_OK) fail_msg("%s", ctx.message);
  free(text);
}

static void code_column(fg_table *table, const char *from, const char *to, const char *range) {
  fg_context ctx = {0};
  fg_coding coding;
  const fg_extended *x = NULL;
  char text[80];
  snprintf(text, sizeof text, "%s=%s", to, range);
  assert_ok(&ctx, fg_coding_parse(&ctx, text, &coding));
  assert_ok(&ctx, fg_table_numbers(&ctx, table, from, &x));
  assert_ok(&ctx, fg_table_add_extended(&ctx, table, to, x, table->rows));
  assert_ok(&ctx, fg_coding_apply(&ctx, &coding, table));
}

/* Finds the row of the printed table that carries each term, and reads its values. */
static void read_printed(const fg_table *printed, comparison *c) {
  fg_context ctx = {0};
  for (size_t i = 0; i < c->terms; i++) {
    const fg_column *terms = &printed->column[0], *column = NULL;
    size_t row = 0;
    while (row < printed->rows && strcmp(terms->words[terms->word[row]], c->name[i]) != 0)
      row++;
    assert_true(row < printed->rows);
    for (size_t q = 0; q < QUANTITIES; q++) {
      assert_ok(&ctx, fg_table_find(&ctx, printed, QUANTITY[q], &column));
      bool missing = column->word && column->word[row] == FG_TABLE_MISSING;
      c->printed[i][q] = missing ? NAN : column->number[row].value;
    }
  }
}

static void compare(fg_table *runs, const char *formula, const char *printed_name, comparison *c) {
  fg_context ctx = {0};
  fg_model model;
  fg_regression reg;
  fg_table printed;
  assert_ok(&ctx, fg_response_apply(&ctx, FG_RESPONSE_MAGNITUDE, RESPONSE, runs));
  if (fg_regression_analyse(&ctx, runs, formula, RESPONSE, NULL, &model, &reg) != FG_OK)
    fail_msg("%s", ctx.message);
  c->title = printed_name;
  c->terms = reg.columns;
  for (size_t i = 0; i < reg.columns; i++) {
    const fg_coefficient *k = &reg.coefficient[i];
    snprintf(c->name[i], sizeof c->name[i], "%s", i ? k->name : "Mean");
    c->ours[i][0] = k->estimate;
    c->ours[i][1] = fg_doe_relative_effect_pct(&reg, i);
    c->ours[i][2] = k->standard_error;
    c->ours[i][3] = k->t;
    c->ours[i][4] = 100 * k->p_value;
  }
  read_table(printed_name, &printed);
  read_printed(&printed, c);
  fg_table_free(&printed);
  fg_regression_free(&reg);
  fg_model_free(&model);
}

/* Printed with two decimals (t of T with one). */
static void check_printed(const comparison *c) {
  for (size_t i = 0; i < c->terms; i++)
    for (size_t q = 0; q < QUANTITIES; q++) {
      if (isnan(c->printed[i][q])) continue;
      bool tenths = fabs(c->printed[i][q] * 10 - round(c->printed[i][q] * 10)) < 1e-9;
      double tolerance = tenths && q == 3 ? 0.05 : 0.005;
      if (!(fabs(c->ours[i][q] - c->printed[i][q]) <= tolerance + 1e-9))
        fail_msg("%s, %s, %s: %.6f, printed %.6f", c->title, c->name[i], QUANTITY[q], c->ours[i][q],
                 c->printed[i][q]);
    }
}

static void read_table_5_1(fg_table *runs) {
  read_table("table_5_1", runs);
  code_column(runs, "pressure_bar", "P", "300:400");
  code_column(runs, "temperature_C", "T", "500:600");
  code_column(runs, "duration_h", "D", "3:5");
}

static void table_5_2(void **state) {
  fg_table runs;
  (void)state;
  read_table_5_1(&runs);
  compare(&runs, "P + T + D + P:T + P:D + T:D", "table_5_2", &comparisons[0]);
  check_printed(&comparisons[0]);
  fg_table_free(&runs);
}

static void table_5_3(void **state) {
  fg_table runs;
  (void)state;
  read_table_5_1(&runs);
  compare(&runs, "T + D + T:D", "table_5_3", &comparisons[1]);
  check_printed(&comparisons[1]);
  fg_table_free(&runs);
}

static void read_table_5_4(fg_table *runs) {
  read_table("table_5_4", runs);
  code_column(runs, "temperature_C", "T", "400:700");
  code_column(runs, "duration_h", "D", "1:7");
}

/* The numbers of a column, to be changed. */
static fg_extended *own_numbers(fg_table *table, const char *name) {
  for (size_t i = 0; i < table->columns; i++)
    if (strcmp(table->column[i].name, name) == 0) return table->column[i].number;
  fail_msg("no column %s", name);
  return NULL;
}

static const char SECOND_ORDER[] = "T + D + T:D + T^2 + D^2";

/* With the axial points at ±1 the corners lie at ±1/3. */
static void table_5_5(void **state) {
  fg_table runs;
  (void)state;
  read_table_5_4(&runs);
  compare(&runs, SECOND_ORDER, "table_5_5", &comparisons[2]);
  for (size_t i = 0; i < comparisons[2].terms; i++)
    for (size_t q = 0; q < QUANTITIES; q++) {
      double ours = comparisons[2].ours[i][q], printed = comparisons[2].printed[i][q];
      if (!isnan(printed)) assert_true(fabs(ours - printed) < 0.03 * fabs(printed) + 0.01);
    }
  /* b_TD = 9/4 × (13.65 - 9.69 - 2.67 + 4.23), as the corners are orthogonal to the rest. */
  assert_true(fabs(comparisons[2].ours[3][0] - 12.42) < 1e-12);
  fg_table_free(&runs);
}

/* The thesis rounded 1/3 to 0.33: so coded, its table comes out to the last digit. */
static void table_5_5_as_printed(void **state) {
  static const char *const factors[] = {"T", "D"};
  fg_table runs;
  (void)state;
  read_table_5_4(&runs);
  for (size_t k = 0; k < 2; k++) {
    fg_extended *x = own_numbers(&runs, factors[k]);
    for (size_t i = 0; i < runs.rows; i++)
      x[i] = (fg_extended){round(100 * x[i].value) / 100, 0};
  }
  compare(&runs, SECOND_ORDER, "table_5_5", &comparisons[3]);
  comparisons[3].title = "table_5_5, corners coded 0.33 instead of 1/3";
  check_printed(&comparisons[3]);
  fg_table_free(&runs);
}

/* Experiments 1, 3, 5 and 7 of table 5.4 carry what table 5.1 prints for 1, 2, 3 and 4. */
static void table_5_4_with_the_responses_of_5_1(void **state) {
  fg_table runs, first;
  fg_context ctx = {0};
  fg_model model;
  fg_regression wrong, right;
  (void)state;
  read_table_5_4(&runs);
  read_table("table_5_1", &first);
  fg_extended *y = own_numbers(&runs, RESPONSE);
  const fg_extended *printed = own_numbers(&first, RESPONSE);
  assert_ok(&ctx, fg_regression_analyse(&ctx, &runs, SECOND_ORDER, RESPONSE, NULL, &model, &wrong));
  fg_model_free(&model);
  for (size_t i = 0; i < 4; i++) {
    assert_true(y[i].value == printed[i].value);
    y[i] = printed[2 * i];
  }
  assert_ok(&ctx, fg_regression_analyse(&ctx, &runs, SECOND_ORDER, RESPONSE, NULL, &model, &right));
  assert_true(fabs(wrong.coefficient[1].standard_error - 2.7358) < 5e-5);
  assert_true(fabs(right.coefficient[1].standard_error - 0.6882) < 5e-5);
  assert_true(right.coefficient[1].p_value < 0.001 && right.coefficient[4].p_value < 0.03);
  fg_model_free(&model);
  fg_regression_free(&wrong);
  fg_regression_free(&right);
  fg_table_free(&runs);
  fg_table_free(&first);
}

/* The thesis's optimum, printed without a duration: 675 °C with a springback error of 2.2 %. */
static const double OPTIMUM_C = 675, OPTIMUM_PCT = 2.2;
enum { DURATIONS = 7, SURFACES = 2, TERMS = 6 };

/* Eq 5.4 at one duration: a parabola in T, and its value and slope at the printed optimum. */
typedef struct section {
  double duration_h, vertex_C, vertex_pct, at_optimum_pct, slope; /* % per 10 °C, at 675 °C */
} section;

typedef struct optimum_check {
  const char *title;
  double coef[TERMS]; /* 1, T, D, T:D, T^2, D^2, coded */
  section at[DURATIONS];
} optimum_check;

static optimum_check optimum_checks[SURFACES] = {
    {.title = "eq 5.4 as table 5.5 prints it", .coef = {7.47, -7.85, -4.38, 12.67, 4.08, -1}},
    {.title = "eq 5.4, fitted to table 5.4"},
};

static double eq_5_4(const double *b, double t, double d) {
  return b[0] + b[1] * t + b[2] * d + b[3] * t * d + b[4] * t * t + b[5] * d * d;
}

/* y = b0 + b1 t + ... + b4 t²: lowest at t = -(b1 + b3 d) / (2 b4), as b4 > 0. */
static void check_optimum(optimum_check *c) {
  const double *b = c->coef, optimum = (OPTIMUM_C - 550) / 150;
  for (int i = 0; i < DURATIONS; i++) {
    double d = (i - 3) / 3.0, vertex = -(b[1] + b[3] * d) / (2 * b[4]);
    c->at[i] = (section){.duration_h = 1 + i,
                         .vertex_C = 550 + 150 * vertex,
                         .vertex_pct = eq_5_4(b, vertex, d),
                         .at_optimum_pct = eq_5_4(b, optimum, d),
                         .slope = (b[1] + b[3] * d + 2 * b[4] * optimum) / 15};
  }
}

/* At the duration whose parabola is lowest at 675 °C it is 4.2 to 4.4 % there, not 2.2 %; where the
 * value at 675 °C is 2.2 % the parabola still falls towards 740 °C. */
static void optimum_does_not_follow_from_eq_5_4(void **state) {
  (void)state;
  for (size_t k = 0; k < comparisons[2].terms; k++)
    optimum_checks[1].coef[k] = comparisons[2].ours[k][0];
  for (int k = 0; k < SURFACES; k++) {
    optimum_check *c = &optimum_checks[k];
    const double *b = c->coef, t = (OPTIMUM_C - 550) / 150;
    check_optimum(c);
    double d = -(b[1] + 2 * b[4] * t) / b[3];
    assert_true(4 + 3 * d > 4 && 4 + 3 * d < 4.5);
    assert_true(eq_5_4(b, t, d) > 4 && eq_5_4(b, t, d) < 4.5);
    for (int i = 0; i < DURATIONS; i++) {
      bool value = fabs(c->at[i].at_optimum_pct - OPTIMUM_PCT) < 0.5;
      bool place = fabs(c->at[i].vertex_C - OPTIMUM_C) < 15;
      assert_false(value || place);
    }
  }
}

/* The sign is the user's choice and turns every coefficient over. */
static void sign_is_a_choice(void **state) {
  fg_context ctx = {0};
  fg_table runs;
  fg_model model;
  fg_regression reg;
  (void)state;
  read_table_5_1(&runs);
  assert_ok(&ctx, fg_regression_analyse(&ctx, &runs, "T + D + T:D", RESPONSE, NULL, &model, &reg));
  assert_true(fabs(reg.coefficient[0].estimate - -7.10875) < 1e-12);
  assert_true(fabs(reg.coefficient[1].estimate - 3.39375) < 1e-12);
  assert_true(fabs(fg_doe_relative_effect_pct(&reg, 1) - -47.7404607) < 1e-6);
  fg_regression_free(&reg);
  fg_model_free(&model);
  fg_table_free(&runs);
}

static void write_comparison(FILE *page, const comparison *c) {
  fprintf(page,
          "## %s\n\n| term | quantity | computed | printed | difference |\n"
          "|---|---|---|---|---|\n",
          c->title);
  for (size_t i = 0; i < c->terms; i++)
    for (size_t q = 0; q < QUANTITIES; q++)
      if (!isnan(c->printed[i][q]))
        fprintf(page, "| %s | %s | %.4f | %g | %+.4f |\n", c->name[i], QUANTITY[q], c->ours[i][q],
                c->printed[i][q], c->ours[i][q] - c->printed[i][q]);
  fputs("\n", page);
}

static void write_optimum(FILE *page) {
  fputs("## The optimum of section 5\n\n"
        "The thesis names an optimum at 675 °C with a springback error of 2.2 %, and adopts 650 °C "
        "and 5 h. It does not\n"
        "follow from eq 5.4. At one duration D eq 5.4 is a parabola in T; coded (t = (T - 550) / "
        "150, "
        "d = (D - 4) / 3) it is\n"
        "lowest at t = -(b_T + b_TD d) / (2 b_TT):\n\n",
        page);
  for (int k = 0; k < SURFACES; k++) {
    const optimum_check *c = &optimum_checks[k];
    fprintf(page,
            "%s:\n\n| D, h | lowest at T, °C | error there, %% | error at 675 °C, %% | slope "
            "there, %% per 10 °C |\n|---|---|---|---|---|\n",
            c->title);
    for (int i = 0; i < DURATIONS; i++)
      fprintf(page, "| %g | %.0f | %.2f | %.2f | %+.2f |\n", c->at[i].duration_h, c->at[i].vertex_C,
              c->at[i].vertex_pct, c->at[i].at_optimum_pct, c->at[i].slope);
    fputs("\n", page);
  }
  fputs("No row has both its lowest point at 675 °C and 2.2 % there, nor has any duration between: "
        "at 4.2 h the lowest point\n"
        "lies at 675 °C and the error is 4.2 %; at 3.2 h the error at 675 °C is 2.2 % and still "
        "falls with the temperature.\n"
        "Over T and D together there is no lowest point at all: the surface is a saddle (612 °C, "
        "5.1 h, 5.1 %). Within the\n"
        "ball about the runs it is lowest on the border, at 669 °C and 2.2 h, with 0.1 %; the "
        "nearest run (600 °C, 3 h) gave\n"
        "9.69 %. There 2.2 is the duration in hours, not the error in %: whether the two were "
        "exchanged in print cannot be\n"
        "told from the tables.\n\n"
        "None of this can be told from scatter: eq 5.4 as a whole has p = 0.24 with three degrees "
        "of freedom, and the responses\n"
        "stand in the wrong rows of table 5.4 (above). reports/thesis/doe_table_5_5.html says so: "
        "no best setting.\n",
        page);
}

static void write_report(const char *folder) {
  char path[600];
  snprintf(path, sizeof path, "%s/thesis_doe.md", folder);
  FILE *page = fopen(path, "w");
  assert_non_null(page);
  fputs(
      "# The thesis's tables 5.2, 5.3 and 5.5, computed from tables 5.1 and 5.4\n\n"
      "The response is the magnitude of the springback error, as in the thesis.\n"
      "Tables 5.2 and 5.3 agree to the last printed digit.\n\n"
      "Table 5.5: with the axial points coded to -1 and +1 the corners lie at -1/3 and +1/3, and\n"
      "the computed table differs from the printed one, by 2 % in T:D. The thesis rounded 1/3 to\n"
      "0.33: with corners coded so, its table comes out to the last printed digit (below).\n"
      "The program codes exactly.\n\n"
      "Beware of table 5.4 itself: its four corner rows (experiments 1, 3, 5 and 7) carry the\n"
      "responses of experiments 1, 2, 3 and 4 of table 5.1. With the responses that table 5.1\n"
      "gives for experiments 1, 3, 5 and 7 (-13.65, -2.67, -9.26, -4.63) the standard error of T\n"
      "falls from 2.74 to 0.69, and T (p = 0.08 %) and T^2 (p = 2.8 %) become significant.\n\n"
      "    build/tests/test_thesis --report reports\n\n",
      page);
  for (size_t i = 0; i < 4; i++)
    write_comparison(page, &comparisons[i]);
  write_optimum(page);
  fclose(page);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(table_5_2),
      cmocka_unit_test(table_5_3),
      cmocka_unit_test(table_5_5),
      cmocka_unit_test(table_5_5_as_printed),
      cmocka_unit_test(table_5_4_with_the_responses_of_5_1),
      cmocka_unit_test(optimum_does_not_follow_from_eq_5_4),
      cmocka_unit_test(sign_is_a_choice),
  };
  int failures = cmocka_run_group_tests_name("thesis", tests, NULL, NULL);
  if (!failures && argc == 3 && strcmp(argv[1], "--report") == 0) write_report(argv[2]);
  return failures;
}
