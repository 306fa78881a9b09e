/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV tables: every kind of bad text gets an error that names the place; good text is exact. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "foilgauge/table.h"
#include "support/test.h"

static fg_status parse(fg_context *ctx, const char *text, fg_table *table) {
  return fg_table_parse(ctx, "runs.csv", text, strlen(text), table);
}

static void bad_text_is_named(void **state) {
  static const struct {
    const char *text, *words;
  } cases[] = {
      {"", "runs.csv: empty"},
      {"\n\n", "runs.csv: empty"},
      {"T,D\n", "a header, but no rows"},
      {"T,D\n\n,\n", "a header, but no rows"},
      {"T,D,T\n1,2,3\n", "columns 1 and 3 are both called 'T'"},
      {"T,,D\n1,2,3\n", "column 2 has no name"},
      {"T,D\n1,2\n3\n", "row 2 (line 3) has 1 cells, the header names 2"},
      {"T,D\n1,2\n\n3,4,5\n", "row 2 (line 4) has 3 cells"},
      {"T,D\n1,5,2\n", "decimal commas? Then separate the cells by semicolons"},
      {"T,D\n1,\"2\n3,4\n", "quote that is not closed"},
      {"T,D\n1,2\"3\n", "line 2: a quote"},
      {"\xff\xfeT", "UTF-16"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    assert_status(&ctx, parse(&ctx, cases[i].text, &table), FG_ERR_DATA);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("case %zu: '%s' lacks '%s'", i, ctx.message, cases[i].words);
    assert_null(table.column);
  }
  fg_context ctx = {0};
  fg_table table;
  assert_status(&ctx, fg_table_parse(&ctx, "runs.csv", "T,D\n1,\0\n", 8, &table), FG_ERR_DATA);
  assert_has(ctx.message, "NUL byte");
}

static void bad_cells_are_named_where_used(void **state) {
  static const struct {
    const char *text, *words;
  } cases[] = {
      {"T,D\n1,2\n3,oven\n", "runs.csv: row 2 (line 3), column 'D': 'oven' is not a number"},
      {"T,D\n1,2\n3,\n", "row 2 (line 3), column 'D': the cell is empty"},
      {"T,D\n1,NaN\n3,4\n", "row 1 (line 2), column 'D': the cell is empty or not a finite"},
      {"T,D\n1,1\n\n3,inf\n", "row 2 (line 4), column 'D'"},
      {"T,D\n1,1e999\n", "row 1 (line 2), column 'D': '1e999' is not a number"},
      {"T,d\n1,2\n", "there is no column 'D'; the columns are T, d"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    const fg_extended *numbers = NULL;
    assert_ok(&ctx, parse(&ctx, cases[i].text, &table));
    assert_status(&ctx, fg_table_numbers(&ctx, &table, "D", &numbers), FG_ERR_DATA);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("case %zu: '%s' lacks '%s'", i, ctx.message, cases[i].words);
    fg_table_free(&table);
  }
}

/* Mark, line ends, quotes, separators: one and the same table. */
static void dialects_are_read(void **state) {
  static const char *const texts[] = {
      "T,name\n1.5,\"a, \"\"b\"\"\"\n-2e3,c\n",
      "\xef\xbb\xbfT,name\r\n1.5,\"a, \"\"b\"\"\"\r\n-2e3,c",
      "\"T\";name\n1.5;\"a, \"\"b\"\"\"\n\n-2e3; c \n;\n",
      "T\tname\r1.5\t\"a, \"\"b\"\"\"\r-2e3\tc\r",
  };
  (void)state;
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    in_row("texts[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    const fg_extended *numbers = NULL;
    fg_levels levels;
    char *text = NULL;
    assert_ok(&ctx, parse(&ctx, texts[i], &table));
    assert_int_equal(table.rows, 2);
    assert_ok(&ctx, fg_table_numbers(&ctx, &table, "T", &numbers));
    assert_true(numbers[0].value == 1.5 && numbers[1].value == -2000);
    assert_ok(&ctx, fg_table_levels(&ctx, &table, "name", false, &levels));
    assert_int_equal(levels.count, 2);
    assert_string_equal(levels.name[0], "a, \"b\"");
    assert_int_equal(levels.index[1], 1);
    assert_ok(&ctx, fg_table_format(&ctx, &table, &text));
    assert_string_equal(text, "T,name\n1.5,\"a, \"\"b\"\"\"\n-2000,c\n");
    free(text);
    fg_levels_free(&levels);
    fg_table_free(&table);
  }
}

/* 0.1 = 3602879701896397 / 2^55 - 5.55e-18; the tail is that difference, and the value equals that
 * of strtod for any text. */
static void decimals_keep_their_digits(void **state) {
  static const char *const numbers[] = {"0.1",
                                        "1000000000000.4",
                                        "-3.14159265358979323846264338327950288",
                                        "6.02214076e23",
                                        "1e-300",
                                        "179769313486231570000e288",
                                        "4.9e-3",
                                        "00012.500",
                                        "+7",
                                        ".5",
                                        "5.",
                                        "123456789012345678901234567890123456789"};
  static const char *const others[] = {"",     "-",   ".",   "1e", "1e+",
                                       "0x10", "1 2", "1,5", "e5", "nan"};
  (void)state;
  fg_extended tenth = {0, 0}, a = {0, 0};
  assert_true(fg_extended_parse("0.1", 3, &tenth));
  assert_true(fabs(tenth.tail - -5.5511151231257827e-18) < 1e-33);
  assert_true(fg_extended_parse("3.141592653589793238462643383279", 32, &a));
  assert_true(fabs(a.tail - 1.2246467991473532e-16) < 1e-30);
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    in_row("numbers[%zu]", i);
    assert_true(fg_extended_parse(numbers[i], strlen(numbers[i]), &a));
    assert_true(a.value == strtod(numbers[i], NULL));
  }
  for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    assert_false(fg_extended_parse(others[i], strlen(others[i]), &a));
}

/* (a / b) b - a and sqrt(a)² - a vanish to 30 digits on seeded numbers. */
static void arithmetic_has_thirty_digits(void **state) {
  unsigned seed = 7;
  (void)state;
  for (int i = 0; i < 10000; i++) {
    fg_extended x[2];
    for (int k = 0; k < 2; k++) {
      seed = seed * 1664525u + 1013904223u;
      double head = 0.5 + seed / 4294967296.0;
      seed = seed * 1664525u + 1013904223u;
      x[k] = fg_extended_sum(head, head * (seed / 4294967296.0 - 0.5) * 1.1e-16);
    }
    fg_extended back = fg_extended_multiply(fg_extended_divide(x[0], x[1]), x[1]);
    assert_true(fabs(fg_extended_subtract(back, x[0]).value) < 1e-30);
    back = fg_extended_square(fg_extended_sqrt(x[0]));
    assert_true(fabs(fg_extended_subtract(back, x[0]).value) < 1e-30);
    back = fg_extended_subtract(fg_extended_add(x[0], x[1]), x[1]);
    assert_true(fabs(fg_extended_subtract(back, x[0]).value) < 1e-30);
  }
}

static void words_among_numbers_need_factor(void **state) {
  fg_context ctx = {0};
  fg_table table;
  fg_levels levels;
  (void)state;
  assert_ok(&ctx, parse(&ctx, "m\n10\n9\nspare\n9\n", &table));
  assert_status(&ctx, fg_table_levels(&ctx, &table, "m", false, &levels), FG_ERR_DATA);
  assert_has(ctx.message, "row 3 (line 4), column 'm': 'spare' is not a number");
  assert_has(ctx.message, "factor(name)");
  assert_ok(&ctx, fg_table_levels(&ctx, &table, "m", true, &levels));
  assert_int_equal(levels.count, 3);
  assert_string_equal(levels.name[0], "9");
  assert_string_equal(levels.name[2], "spare");
  fg_levels_free(&levels);
  fg_table_free(&table);
}

/* A million rows: the sum of 0.001 i is exact to the digits of the text. */
static void a_million_rows(void **state) {
  enum { ROWS = 1000000 };
  (void)state;
  fg_context ctx = {0};
  fg_table table;
  const fg_extended *numbers = NULL;
  char *text = malloc(24u * ROWS);
  assert_non_null(text);
  size_t length = (size_t)sprintf(text, "x,w\n");
  for (int i = 0; i < ROWS; i++)
    length += (size_t)sprintf(text + length, "%d.%03d,w%d\n", i / 1000, i % 1000, i % 7);
  assert_ok(&ctx, fg_table_parse(&ctx, "big.csv", text, length, &table));
  assert_int_equal(table.rows, ROWS);
  assert_ok(&ctx, fg_table_numbers(&ctx, &table, "x", &numbers));
  fg_extended sum = {0, 0};
  for (size_t i = 0; i < table.rows; i++)
    sum = fg_extended_add(sum, numbers[i]);
  assert_true(sum.value == 499999500.0 && fabs(sum.tail) < 1e-18);
  assert_int_equal(table.column[1].word_count, 7);
  fg_table_free(&table);
  free(text);
}

/* Decimal commas between semicolons and tabs: the same digits as with points. */
static void decimal_commas_are_read(void **state) {
  static const char *const texts[] = {
      "T;D;n\n0,1;-1,25e-3;3\n+,5;1234,;NA\n",
      "\xef\xbb\xbfT;D;n\r\n\"0,1\"; -1,25e-3 ;3\r\n+,5;1234,;\r\n;;\r\n",
      "sep=;\r\nT;D;n\r\n0,1;-1,25e-3;3\r\n0,5;1234,0;n/a",
      "\"T\"\t\"D\"\tn\n0,1\t-1,25e-3\t3\n0,500\t1234\t\n",
  };
  (void)state;
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    in_row("texts[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    fg_extended tenth;
    const fg_extended *t = NULL, *d = NULL;
    assert_ok(&ctx, parse(&ctx, texts[i], &table));
    assert_int_equal(table.rows, 2);
    assert_ok(&ctx, fg_table_numbers(&ctx, &table, "T", &t));
    assert_ok(&ctx, fg_table_numbers(&ctx, &table, "D", &d));
    assert_true(fg_extended_parse("0.1", 3, &tenth));
    assert_true(t[0].value == tenth.value && t[0].tail == tenth.tail && t[1].value == 0.5);
    assert_true(d[0].value == -1.25e-3 && d[1].value == 1234);
    assert_int_equal(table.column[2].missing_count, 1);
    assert_int_equal(table.line[0], i == 2 ? 3 : 2);
    fg_table_free(&table);
  }
}

/* Commas and semicolons in names do not decide; what separates every row does. */
static void separators_are_told_by_the_rows(void **state) {
  static const struct {
    const char *text, *second;
  } cases[] = {
      {"\"a;b;c\",d\n1,2\n", "d"},
      {"Radius, mm;Winkel, Grad\n1,5;2,5\n", "Winkel, Grad"},
      {"x;y, z, u\n1,5;2\n7;8\n", "y, z, u"},
      {"scan,die\na.png;b.png,1\nc.png,2\n", "die"},
      {"a,b;\n1,2\n3,4\n", "b;"},
      {"a\tb, c\n1,5\t2,5\n", "b, c"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    if (parse(&ctx, cases[i].text, &table) != FG_OK) fail_msg("case %zu: %s", i, ctx.message);
    assert_int_equal(table.columns, 2);
    assert_string_equal(table.column[1].name, cases[i].second);
    fg_table_free(&table);
  }
}

/* Numbers that may mean something else, and words among numbers, are refused where they are used,
 * and nowhere else; factor(name) takes them as names. */
static void ambiguous_columns_are_refused(void **state) {
  static const struct {
    const char *text, *words;
  } cases[] = {
      {"x,D\n1,\"1,5\"\n2,\"2,5\"\n", "row 1 (line 2), column 'D': '1,5' is a number to people"},
      {"x,D\n1,1.5\n2,\"2,5\"\n", "row 2 (line 3), column 'D': '2,5'"},
      {"x,D\n1,\"1,234\"\n2,7\n", "needs semicolons"},
      {"x;D\n1;1.5\n\n2;2,5\n",
       "row 1 (line 2), column 'D': a point, but a comma in line 4, column 'D'"},
      {"x;D\n1;2\n2;1.234\n0,5;3\n", "row 2 (line 3), column 'D': a point, but a comma in line 4, "
                                     "column 'x'"},
      {"x;D\n1;1.000\n2;0,5\n", "row 1 (line 2), column 'D': a point, but a comma in line 3"},
      {"x;D\n1;1.234,5\n2;2,5\n", "row 1 (line 2), column 'D': '1.234,5' is a number"},
      {"x;D\n1;1.234.567\n2;2\n", "without separators of thousands"},
      {"x;D\n1;1'234\n2;-5\n", "without separators of thousands"},
      {"x;D\n1;1\xc2\xa0"
       "234,5\n2;5\n",
       "without separators of thousands"},
      {"x;D\n1;2\n2;oven\n", "row 2 (line 3), column 'D': 'oven' is not a number"},
      {"x;D\n1;2,5\n2;-\n", "row 2 (line 3), column 'D': '-' is not a number"},
      {"x\tD\n1\t1,234\n2\t2,345\n", "a decimal mark or thousands?"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table, copy;
    fg_levels levels;
    const fg_extended *numbers = NULL;
    assert_ok(&ctx, parse(&ctx, cases[i].text, &table));
    assert_status(&ctx, fg_table_check(&ctx, &table, "D"), FG_ERR_DATA);
    if (!strstr(ctx.message, cases[i].words))
      fail_msg("case %zu: '%s' lacks '%s'", i, ctx.message, cases[i].words);
    assert_status(&ctx, fg_table_numbers(&ctx, &table, "D", &numbers), FG_ERR_DATA);
    assert_status(&ctx, fg_table_levels(&ctx, &table, "D", false, &levels), FG_ERR_DATA);
    assert_ok(&ctx, fg_table_levels(&ctx, &table, "D", true, &levels));
    fg_levels_free(&levels);
    assert_ok(&ctx, fg_table_numbers(&ctx, &table, "x", &numbers));
    assert_ok(&ctx, fg_table_copy(&ctx, &table, &copy));
    assert_status(&ctx, fg_table_check(&ctx, &copy, "D"), FG_ERR_DATA);
    fg_table_free(&copy);
    fg_table_free(&table);
  }
}

/* Sound columns that resemble refused ones: words, dates, names of samples, numbers with missing
 * ones. */
static void sound_columns_are_not_refused(void **state) {
  static const char *const texts[] = {
      "x,D\n1,2.5\n2,\n3,NA\n",       "x,D\n1,01.02.2024\n2,2.2.2024\n",
      "x,D\n1,\"a, b\"\n2,\"c\"\n",   "x;D\n1,5;A7\n2;A8,5\n",
      "x;D\n1;1.234\n2;2.345\n",      "x;D\n1;12:30\n2;1,2,3\n",
      "x\tD\n0,5\t1,234\n2\t2,345\n", "x;D\n1;1,234\n2;\n",
  };
  (void)state;
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    in_row("texts[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    assert_ok(&ctx, parse(&ctx, texts[i], &table));
    if (fg_table_check(&ctx, &table, "D") != FG_OK) fail_msg("case %zu: %s", i, ctx.message);
    fg_table_free(&table);
  }
}

/* Dates become days, serial numbers their digits; other cells stay words. */
static void words_that_count_are_numbers(void **state) {
  static const struct {
    const char *cells[4];
    double first, last; /* NaN: the column stays words */
  } cases[] = {
      {{"2024-02-28", "2024-03-01", "", "2023-12-31"}, 59, 0},
      {{"2100-02-28", "2100-03-01", "2100-02-27", "2100-02-26"}, 2, 0},
      {{"31.12.2023", "01.01.2024", "01.03.2024", "29.02.2024"}, 0, 60},
      {{"2024-05-01T06:00", "2024-05-01 18:00:36", "2024-05-02", "2024-05-02T12:00Z"}, 0, 1.25},
      {{"2/3/2026 8:15 AM", "02/28/2026 12:15 PM", "3/1/26 12:15 AM", "03/01/2026 8:15 PM"},
       0,
       26.5},
      {{"28/02/2026", "1/3/2026", "2/3/2026", "31/03/2026"}, 0, 31},
      {{"31-Dec-2025", "1-Jan-2026", "", "1-Mrz-26"}, 0, 60},
      {{"\"May 31, 2024\"", "June 2 2024", "3 Juni 2024", "4. Okt. 2024"}, 0, 126},
      {{"31.12.25", "01.01.26", "02.01.26", "03.01.26"}, 0, 3},
      {{"2026/02/28", "2026/03/01", "2026/03/02", "2026/03/03"}, 0, 3},
      {{"31/02/2026", "1/3/2026", "2/3/2026", "30/03/2026"}, NAN, NAN},
      {{"1/3/2026 13:15 PM", "1/3/2026", "2/3/2026", "30/03/2026"}, NAN, NAN},
      {{"F001", "F002", "", "F010"}, 1, 10},
      {{"2023-02-29", "2023-03-01", "2023-03-02", "2023-03-03"}, NAN, NAN},
      {{"03/04/2024", "05/04/2024", "04/07/2024", "06/05/2024"}, NAN, NAN},
      {{"2024-05-01", "2024-05-02", "later", "2024-05-03"}, NAN, NAN},
      {{"F001", "F002", "G003", "F004"}, NAN, NAN},
      {{"A", "A", "B", "A"}, NAN, NAN},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    const fg_column *w = NULL;
    char text[200], *said = NULL;
    const char *const *cells = cases[i].cells;
    snprintf(text, sizeof text, "x,w\n1,%s\n2,%s\n3,%s\n4,%s\n", cells[0], cells[1], cells[2],
             cells[3]);
    assert_ok(&ctx, parse(&ctx, text, &table));
    assert_ok(&ctx, fg_table_count_words(&ctx, &table, 2, &said));
    assert_ok(&ctx, fg_table_find(&ctx, &table, "w", &w));
    assert_int_equal(w->word_count == 0, isfinite(cases[i].first));
    assert_int_equal(said && strstr(said, " counts "), isfinite(cases[i].first));
    if (isfinite(cases[i].first)) {
      assert_true(fabs(w->number[0].value - cases[i].first) < 1e-9);
      assert_true(fabs(w->number[3].value - cases[i].last) < 1e-9);
      assert_int_equal(w->number_count + w->missing_count, 4);
    }
    free(said);
    fg_table_free(&table);
  }
}

static void columns_are_dropped(void **state) {
  fg_context ctx = {0};
  fg_table table;
  const fg_column *column;
  (void)state;
  assert_ok(&ctx, parse(&ctx, "a,b,c\n1,x,2\n3,y,4\n", &table));
  assert_status(&ctx, fg_table_drop(&ctx, &table, "d"), FG_ERR_DATA);
  assert_ok(&ctx, fg_table_drop(&ctx, &table, "b"));
  assert_status(&ctx, fg_table_find(&ctx, &table, "b", &column), FG_ERR_DATA);
  assert_ok(&ctx, fg_table_find(&ctx, &table, "c", &column));
  assert_true(column->number[1].value == 4);
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "b", (double[]){5, 6}, 2));
  assert_status(&ctx, fg_table_add_numbers(&ctx, &table, "c", (double[]){5, 6}, 2), FG_ERR_USAGE);
  assert_ok(&ctx, fg_table_find(&ctx, &table, "b", &column));
  fg_table_free(&table);
}

static void rows_are_selected(void **state) {
  fg_context ctx = {0};
  fg_table table, part;
  (void)state;
  assert_ok(&ctx, parse(&ctx, "x,w\n1,a\n2,b\n3,\n", &table));
  assert_ok(&ctx, fg_table_select(&ctx, &table, (size_t[]){2, 0}, 2, &part));
  assert_true(part.column[0].number[0].value == 3 && part.column[0].number[1].value == 1);
  assert_true(part.column[1].word[0] == FG_TABLE_MISSING && part.column[1].missing_count == 1);
  assert_string_equal(part.column[1].words[part.column[1].word[1]], "a");
  assert_int_equal(part.line[0], 4);
  fg_table_free(&part);
  assert_status(&ctx, fg_table_select(&ctx, &table, (size_t[]){3}, 1, &part), FG_ERR_USAGE);
  fg_table_free(&table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bad_text_is_named),
      cmocka_unit_test(bad_cells_are_named_where_used),
      cmocka_unit_test(dialects_are_read),
      cmocka_unit_test(decimals_keep_their_digits),
      cmocka_unit_test(arithmetic_has_thirty_digits),
      cmocka_unit_test(words_among_numbers_need_factor),
      cmocka_unit_test(a_million_rows),
      cmocka_unit_test(decimal_commas_are_read),
      cmocka_unit_test(separators_are_told_by_the_rows),
      cmocka_unit_test(ambiguous_columns_are_refused),
      cmocka_unit_test(sound_columns_are_not_refused),
      cmocka_unit_test(words_that_count_are_numbers),
      cmocka_unit_test(columns_are_dropped),
      cmocka_unit_test(rows_are_selected),
  };
  return cmocka_run_group_tests_name("table", tests, NULL, NULL);
}
