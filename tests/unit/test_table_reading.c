/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table's cells beside its model: moments, and oddities that no model sees. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/table.h"
#include "foilgauge/table_remarks.h"
#include "foilgauge/table_times.h"
#include "support/test.h"

static fg_status parse(fg_context *ctx, const char *text, fg_table *table) {
  return fg_table_parse(ctx, "made.csv", text, strlen(text), table);
}

/* Moments of a table whose rows are out of order: days where hardly one recurs, whatever their
 * number; the day or the month first as all rows allow, or as has them in order of time. */
static void moments_are_counted(void **state) {
  static const struct {
    const char *cells[6], *words; /* NULL: they stay words */
    double last;
    bool order;
  } cases[] = {
      {{"2026-03-05", "2026-03-01", "2026-03-04", "2026-03-02", "2026-03-09", "2026-03-07"},
       "days since 2026-03-01",
       6,
       true},
      {{"2026-03-05", "2026-03-05", "2026-03-05", "2026-03-02", "2026-03-02", "2026-03-02"},
       NULL,
       0,
       false},
      {{"03/05/2026", "03/12/2026", "04/01/2026", "05/04/2026", "07/06/2026", "08/02/2026"},
       "since 03/05/2026, read with the month first, which has the rows in order",
       150,
       true},
      {{"3/5/2026", "12/5/2026", "1/6/2026", "4/7/2026", "6/9/2026", "2/10/2026"},
       "with the day first, which has the rows in order",
       152,
       true},
      {{"03/05/2026", "03/12/2026", "04/01/2026", "05/04/2026", "04/06/2026", "08/02/2026"},
       NULL,
       0,
       false},
      {{"03/05/2026", "03/13/2026", "04/01/2026", "05/04/2026", "04/06/2026", "08/02/2026"},
       "with the month first",
       150,
       true},
      {{"02/03/2026 8:15 AM", "02/03/2026 1:15 PM", "02/04/2026 7:15 AM", "02/05/2026 8:15 AM",
        "02/05/2026 9:15 AM", "02/06/2026 8:15 AM"},
       "with the month first, which has them close together",
       3,
       true},
      {{"20260305", "20260301", "20260304", "20260302", "20260309", "20260307"},
       "days since 20260301",
       6,
       false},
      {{"20260305", "20260301", "20260304", "20260302", "20260309", "20260337"},
       "",
       20260337,
       false},
      {{"07:30", "8:15", "8:50:30", "10:00 am", "1:45 PM", "14:00"}, "hours of the day", 14, true},
      {{"21:30", "22:15", "23:50", "0:30", "1:45", "2:00"}, "hours of the day", 2, false},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    const fg_column *w = NULL;
    char text[300], *said = NULL;
    const char *times = NULL, *const *cell = cases[i].cells;
    snprintf(text, sizeof text, "x,date\n1,%s\n2,%s\n3,%s\n4,%s\n5,%s\n6,%s\n", cell[0], cell[1],
             cell[2], cell[3], cell[4], cell[5]);
    assert_ok(&ctx, parse(&ctx, text, &table));
    assert_ok(&ctx, fg_table_count_times(&ctx, &table, NULL, &times, &said));
    assert_ok(&ctx, fg_table_find(&ctx, &table, "date", &w));
    assert_int_equal(w->word_count == 0, cases[i].words != NULL);
    assert_int_equal(times != NULL, cases[i].order);
    if (cases[i].words && *cases[i].words) {
      assert_non_null(said);
      assert_non_null(strstr(said, cases[i].words));
      assert_true(fabs(w->number[5].value - cases[i].last) < 1e-9);
    } else if (said) {
      assert_non_null(strstr(said, "such as 03/05/2026 may have the day or the month first"));
    }
    free(said);
    fg_table_free(&table);
  }
}

/* Each oddity is told with its rows; what resembles it is not. */
static void oddities_are_told(void **state) {
  static const struct {
    const char *text, *words; /* NULL: nothing is told */
  } cases[] = {
      {"run,a,y\n1,5,2.1\n2,5,2.2\n2,5,2.2\n3,6,2.5\n", "rows 2 and 3 are alike in every cell"},
      {"a,y\n5,2\n5,2\n6,3\n6,3\n6,2\n5,3\n", NULL}, /* repeats that came out the same */
      {"a,y\n98,2\n99,3\n100,2.5\n3.93,4\n101,3.5\n98.5,2\n99.5,3\n100.5,2.5\n101.5,4\n102,1\n",
       "a is 3.93 in row 4, and 98 to 102 in all others"},
      {"a,y\n5,2\n6,3\n8,2.5\n-999,4\n7,3.5\n5,2\n6,3\n8,2.5\n7,4\n5,1\n", "a is -999 in row 4"},
      {"a,y\n1,2\n10,3\n1,2.5\n100,4\n10,3.5\n1,2\n10,3\n100,2.5\n1000,4\n1000,1\n", NULL},
      {"a,y\n5,2\n6,3\n8,2.5\n7,3.5\n5,2\n6,3\n8,2.5\n7,4\n5,1\n14,4\n", NULL},
      {"a,y\n1,7.5\n2,8.1\n3,7.5\n4,8.3\n1,7.5\n2,7.9\n3,7.5\n4,9\n1,7.5\n2,8.2\n",
       "y is 7.5, its lowest value, in 5 of 10 rows"},
      {"a,y\n1,7\n2,8\n3,7\n4,8\n1,7\n2,9\n3,7\n4,9\n1,7\n2,8\n", NULL},
      {"who,y\nAnna,1\nanna,2\nBert,3\nK 17,4\nK17,5\nk-17,6\n",
       "'Anna' and 'anna', 'K 17' and 'K17'"},
      {"who,y\n1.1,1\nA-1,2\nA-2,3\nB-1,4\n", NULL},
      {"t,y\n500 K,1\n550 K,2\n600 K,3\n500 K,2\n", "t holds words such as '500 K'"},
      {"t,y\n1st,1\n2nd,2\n3rd,3\n1st,2\n", NULL},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_table table;
    char *said = NULL;
    assert_ok(&ctx, parse(&ctx, cases[i].text, &table));
    assert_ok(&ctx, fg_table_remark(&ctx, &table, "y", &said));
    if (!cases[i].words && said) fail_msg("told: %s", said);
    if (cases[i].words && (!said || !strstr(said, cases[i].words)))
      fail_msg("'%s' lacks '%s'", said ? said : "", cases[i].words);
    free(said);
    fg_table_free(&table);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(moments_are_counted),
      cmocka_unit_test(oddities_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
