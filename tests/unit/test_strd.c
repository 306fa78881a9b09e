/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NIST StRD: every linear regression, ANOVA and univariate set, digits reached against the
 * certified values.
 *
 *     test_strd                 checks 13 digits
 *     test_strd --report DIR    writes DIR/strd.csv and DIR/strd.md as well
 *
 * Digits are -log10 |x - c| / |c| (-log10 |x| for c = 0), at most 15, as many as are certified.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/anova.h"
#include "foilgauge/distribution.h"
#include "foilgauge/regression.h"
#include "support/data.h"
#include "support/test.h"

enum { MAX_FIELDS = 16, FIRST_DATA_LINE = 61, MAX_SETS = 64 };

/* The fewest digits over each kind of number; NAN where the set has none. */
typedef struct digits_row {
  const char *set, *kind, *difficulty;
  double estimate, standard_error, residual_sd, r2, squares, f;
} digits_row;

static digits_row results[MAX_SETS];
static size_t result_count;

static double digits(double x, double certified) {
  if (x == certified) return 15;
  if (!isfinite(x) || !isfinite(certified)) return 0;
  double error = certified == 0 ? fabs(x) : fabs(x - certified) / fabs(certified);
  return fmax(0, fmin(15, -log10(error)));
}

static void lower(double *min, double value) {
  *min = isnan(*min) ? value : fmin(*min, value);
}

/* One line cut into its fields. */
typedef struct line {
  char text[400];
  char *field[MAX_FIELDS];
  size_t fields;
} line;

/* The next line of *at; false at the end. */
static bool next_line(const char **at, line *l) {
  if (!**at) return false;
  size_t length = strcspn(*at, "\n");
  size_t kept = length < sizeof l->text ? length : sizeof l->text - 1;
  memcpy(l->text, *at, kept);
  l->text[kept] = 0;
  *at += length + ((*at)[length] != 0);
  l->fields = 0;
  char *rest = NULL;
  for (char *f = strtok_r(l->text, " \t\r", &rest); f && l->fields < MAX_FIELDS;
       f = strtok_r(NULL, " \t\r", &rest))
    l->field[l->fields++] = f;
  return true;
}

static bool is_number(const char *text) {
  char *end = NULL;
  strtod(text, &end);
  return *text && !*end;
}

static double last_number(const line *l) {
  return strtod(l->field[l->fields - 1], NULL);
}

static char *read_set(const char *name) {
  char path[80];
  snprintf(path, sizeof path, "strd/%s.dat", name);
  return data_read(path);
}

/* The data lines as CSV text, and that as a table: the way a user's numbers come in. */
static void read_regression_table(const char *text, fg_table *table) {
  fg_context ctx = {0};
  char *csv = NULL;
  line l;
  for (size_t number = 1; next_line(&text, &l); number++) {
    if (number < FIRST_DATA_LINE || l.fields < 2 || !is_number(l.field[0])) continue;
    if (!csv) {
      assert_ok(&ctx, fg_text_append(&ctx, &csv, l.fields == 2 ? "y,x" : "y"));
      for (size_t i = 1; l.fields > 2 && i < l.fields; i++)
        assert_ok(&ctx, fg_text_append(&ctx, &csv, ",x%zu", i));
    }
    for (size_t i = 0; i < l.fields; i++)
      assert_ok(&ctx, fg_text_append(&ctx, &csv, "%s%s", i ? "," : "\n", l.field[i]));
  }
  assert_ok(&ctx, fg_table_parse(&ctx, "strd", csv, strlen(csv), table));
  free(csv);
}

/* Compares with every line of the certificate that is about a regression. */
static void compare_regression(const char *text, const fg_regression *reg, digits_row *row) {
  line l;
  size_t coefficient = 0;
  bool residual_line = false;
  for (size_t number = 1; number < FIRST_DATA_LINE && next_line(&text, &l); number++) {
    if (l.fields == 3 && l.field[0][0] == 'B' && is_number(l.field[1])) {
      const fg_coefficient *c = &reg->coefficient[coefficient++];
      lower(&row->estimate, digits(c->estimate, strtod(l.field[1], NULL)));
      lower(&row->standard_error, digits(c->standard_error, strtod(l.field[2], NULL)));
    } else if (l.fields == 3 && strcmp(l.field[0], "Standard") == 0 && is_number(l.field[2])) {
      row->residual_sd = digits(reg->residual_sd, last_number(&l));
    } else if (l.fields == 2 && strcmp(l.field[0], "R-Squared") == 0) {
      row->r2 = digits(reg->r2, last_number(&l));
    } else if (l.fields == 5 && strcmp(l.field[0], "Regression") == 0) {
      lower(&row->squares, digits(reg->model_ss, strtod(l.field[2], NULL)));
      row->f = digits(reg->model_f, strtod(l.field[4], NULL));
    } else if (l.fields == 4 && strcmp(l.field[0], "Residual") == 0) {
      residual_line = true;
      assert_int_equal(reg->residual_dof, strtoul(l.field[1], NULL, 10));
      lower(&row->squares, digits(reg->residual_ss, strtod(l.field[2], NULL)));
    }
  }
  assert_true(residual_line);
  assert_int_equal(coefficient, reg->columns);
}

static digits_row *new_row(const char *set, const char *kind, const char *difficulty) {
  digits_row *row = &results[result_count++];
  *row = (digits_row){set, kind, difficulty, NAN, NAN, NAN, NAN, NAN, NAN};
  return row;
}

static void assert_digits(const digits_row *row, double min) {
  const double all[] = {row->estimate, row->standard_error, row->residual_sd,
                        row->r2,       row->squares,        row->f};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    if (!isnan(all[i]) && all[i] < min)
      fail_msg("%s: %.2f digits in quantity %zu, %.1f are wanted", row->set, all[i], i, min);
}

static void regressions(void **state) {
  static const struct {
    const char *set, *formula, *difficulty;
  } sets[] = {
      {"Norris", "y ~ x", "lower"},
      {"Pontius", "y ~ x + x^2", "lower"},
      {"NoInt1", "y ~ 0 + x", "average"},
      {"NoInt2", "y ~ x - 1", "average"},
      {"Filip", "y ~ x+x^2+x^3+x^4+x^5+x^6+x^7+x^8+x^9+x^10", "higher"},
      {"Longley", "y ~ x1+x2+x3+x4+x5+x6", "higher"},
      {"Wampler1", "y ~ x+x^2+x^3+x^4+x^5", "higher"},
      {"Wampler2", "y ~ x+x^2+x^3+x^4+x^5", "higher"},
      {"Wampler3", "y ~ x+x^2+x^3+x^4+x^5", "higher"},
      {"Wampler4", "y ~ x+x^2+x^3+x^4+x^5", "higher"},
      {"Wampler5", "y ~ x+x^2+x^3+x^4+x^5", "higher"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
    in_row("sets[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_model model;
    fg_regression reg;
    char *text = read_set(sets[i].set);
    read_regression_table(text, &table);
    assert_ok(&ctx, fg_regression_analyse(&ctx, &table, sets[i].formula, NULL, NULL, &model, &reg));
    digits_row *row = new_row(sets[i].set, "regression", sets[i].difficulty);
    compare_regression(text, &reg, row);
    assert_digits(row, 13);
    fg_regression_free(&reg);
    fg_model_free(&model);
    fg_table_free(&table);
    free(text);
  }
}

/* The columns of the file are the groups: "group,y" lines. */
static void read_anova_table(const char *text, fg_table *table) {
  fg_context ctx = {0};
  line l;
  size_t used = 10, capacity = 16u << 20;
  char *csv = malloc(capacity);
  assert_non_null(csv);
  strcpy(csv, "group,y\n");
  used = strlen(csv);
  for (size_t number = 1; next_line(&text, &l); number++) {
    bool labels = l.fields > 1 && strcmp(l.field[0], "1") == 0 && strcmp(l.field[1], "2") == 0;
    if (number < FIRST_DATA_LINE - 2 || l.fields < 2 || labels || !is_number(l.field[0])) continue;
    for (size_t i = 0; i < l.fields; i++)
      used += (size_t)snprintf(csv + used, capacity - used, "t%zu,%s\n", i + 1, l.field[i]);
  }
  assert_ok(&ctx, fg_table_parse(&ctx, "strd", csv, used, table));
  free(csv);
}

static void compare_anova(const char *text, const fg_anova_oneway *a, digits_row *row) {
  line l;
  size_t lines = 0;
  for (size_t number = 1; number < FIRST_DATA_LINE && next_line(&text, &l); number++) {
    if (l.fields == 6 && strcmp(l.field[0], "Between") == 0) {
      lower(&row->squares, digits(a->between_ss, strtod(l.field[3], NULL)));
      lower(&row->squares, digits(a->between_ms, strtod(l.field[4], NULL)));
      row->f = digits(a->f, strtod(l.field[5], NULL));
      lines++;
    } else if (l.fields == 5 && strcmp(l.field[0], "Within") == 0) {
      assert_int_equal(a->within_dof, strtoul(l.field[2], NULL, 10));
      lower(&row->squares, digits(a->within_ss, strtod(l.field[3], NULL)));
      lower(&row->squares, digits(a->within_ms, strtod(l.field[4], NULL)));
      lines++;
    } else if (l.fields == 3 && strcmp(l.field[1], "R-Squared") == 0) {
      row->r2 = digits(a->r2, last_number(&l));
      lines++;
    } else if (l.fields == 3 && strcmp(l.field[0], "Standard") == 0 && is_number(l.field[2])) {
      row->residual_sd = digits(a->residual_sd, last_number(&l));
      lines++;
    }
  }
  assert_int_equal(lines, 4);
}

/* The same sums of squares by the regression on the factor. */
static void compare_factor_regression(const fg_table *table, const fg_anova_oneway *a) {
  fg_context ctx = {0};
  fg_model model;
  fg_regression reg;
  assert_ok(&ctx, fg_regression_analyse(&ctx, table, "y ~ group", NULL, NULL, &model, &reg));
  assert_true(digits(reg.sequential[0].sum_of_squares, a->between_ss) > 14);
  assert_true(digits(reg.sequential[0].f, a->f) > 14);
  assert_true(digits(reg.partial[0].sum_of_squares, a->between_ss) > 14);
  assert_true(digits(reg.residual_ss, a->within_ss) > 14);
  fg_regression_free(&reg);
  fg_model_free(&model);
}

static void anovas(void **state) {
  static const struct {
    const char *set, *difficulty;
  } sets[] = {
      {"SiRstvt", "lower"},   {"SmLs01t", "lower"},    {"SmLs02t", "lower"},
      {"SmLs03t", "lower"},   {"AtmWtAgt", "average"}, {"SmLs04t", "average"},
      {"SmLs05t", "average"}, {"SmLs06t", "average"},  {"SmLs07t", "higher"},
      {"SmLs08t", "higher"},  {"SmLs09t", "higher"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
    in_row("sets[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_anova_oneway anova;
    char *text = read_set(sets[i].set);
    read_anova_table(text, &table);
    assert_ok(&ctx, fg_anova_oneway_compute(&ctx, &table, "y", "group", &anova));
    digits_row *row = new_row(sets[i].set, "ANOVA", sets[i].difficulty);
    compare_anova(text, &anova, row);
    assert_digits(row, 13);
    compare_factor_regression(&table, &anova);
    fg_anova_oneway_free(&anova);
    fg_table_free(&table);
    free(text);
  }
}

/* The column under the dashes. */
static void read_numbers(const char *text, fg_table *table) {
  fg_context ctx = {0};
  char *csv = NULL;
  const char *dashes = strstr(text, "\n-----");
  assert_non_null(dashes);
  const char *data = strchr(dashes + 1, '\n') + 1;
  assert_ok(&ctx, fg_text_print(&ctx, &csv, "y\n%s", data));
  assert_ok(&ctx, fg_table_parse(&ctx, "strd", csv, strlen(csv), table));
  free(csv);
}

static void summaries_have_the_certified_digits(void **state) {
  static const char *const sets[] = {"Lottery", "Lew",     "Mavro",   "Michelso",
                                     "NumAcc1", "NumAcc2", "NumAcc3", "NumAcc4"};
  static const char *const difficulty[] = {"lower", "lower",   "lower",   "lower",
                                           "lower", "average", "average", "higher"};
  (void)state;
  for (size_t i = 0; i < sizeof sets / sizeof *sets; i++) {
    in_row("sets[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_summary summary;
    line l;
    char *text = read_set(sets[i]);
    read_numbers(text, &table);
    assert_ok(&ctx, fg_summary_compute(&ctx, table.column[0].number, table.rows, &summary));
    digits_row *row = new_row(sets[i], "summary", difficulty[i]);
    const char *at = text;
    while (next_line(&at, &l)) {
      if (l.fields && strcmp(l.field[l.fields - 1], "(exact)") == 0) l.fields--;
      if (l.fields < 3 || strcmp(l.field[0], "Sample") != 0 || !is_number(l.field[l.fields - 1]))
        continue;
      if (strncmp(l.field[1], "Mean", 4) == 0)
        row->estimate = digits(summary.mean, last_number(&l));
      if (strcmp(l.field[1], "Standard") == 0)
        row->residual_sd = digits(summary.sd, last_number(&l));
      if (strcmp(l.field[1], "Autocorrelation") == 0)
        row->r2 = digits(summary.autocorrelation, last_number(&l));
    }
    assert_false(isnan(row->estimate) || isnan(row->residual_sd) || isnan(row->r2));
    assert_digits(row, 13);
    fg_table_free(&table);
    free(text);
  }
}

static FILE *open_report(const char *folder, const char *name) {
  char path[600];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  return file;
}

static void write_cells(FILE *file, const digits_row *row, const char *separator) {
  const double all[] = {row->estimate, row->standard_error, row->residual_sd,
                        row->r2,       row->squares,        row->f};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    in_row("all[%zu]", i);
    fputs(separator, file);
    if (!isnan(all[i])) fprintf(file, "%.1f", all[i]);
  }
}

static void write_report(const char *folder) {
  FILE *csv = open_report(folder, "strd.csv"), *page = open_report(folder, "strd.md");
  fputs("set,kind,difficulty,estimate_digits,standard_error_digits,residual_sd_digits,"
        "r2_digits,squares_digits,f_digits\n",
        csv);
  fputs("# Digits reached on the NIST Statistical Reference Datasets\n\n"
        "Digits are -log10 of the relative error against the certified value (of the absolute one\n"
        "where it is zero), the fewest over the numbers of a kind, at most 15: no more are\n"
        "certified. A summary's columns are mean, standard deviation and autocorrelation.\n\n"
        "    build/tests/test_strd --report reports\n\n"
        "| set | kind | difficulty | estimates | standard errors | residual sd | R² or "
        "autocorrelation | sums of squares | F |\n|---|---|---|---|---|---|---|---|---|\n",
        page);
  for (size_t i = 0; i < result_count; i++) {
    const digits_row *row = &results[i];
    fprintf(csv, "%s,%s,%s", row->set, row->kind, row->difficulty);
    write_cells(csv, row, ",");
    fputs("\n", csv);
    fprintf(page, "| %s | %s | %s", row->set, row->kind, row->difficulty);
    write_cells(page, row, " | ");
    fputs(" |\n", page);
  }
  fclose(csv);
  fclose(page);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(regressions),
      cmocka_unit_test(anovas),
      cmocka_unit_test(summaries_have_the_certified_digits),
  };
  int failures = cmocka_run_group_tests_name("strd", tests, NULL, NULL);
  if (!failures && argc == 3 && strcmp(argv[1], "--report") == 0) write_report(argv[2]);
  return failures;
}
