/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a context by serial numbers, as they are written. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "station/context.h"
#include "support/test.h"

static void long_serials_have_their_own_rows(void **state) {
  (void)state;
  static const struct {
    const char *serial;
    double value;
  } rows[] = {{"90071992547409921", 1},
              {"90071992547409922", 2},
              {"90071992547409923", 3},
              {"0471", 4},
              {"000472", 4.5},
              {"1e3", 5},
              {"A-7", 6},
              {"90", 7},
              {"9007199254740992100000000", 8}};
  static const struct {
    const char *serial;
    double value;
  } foils[] = {{"90071992547409921", 1},
               {"90071992547409922", 2},
               {"90071992547409923", 3},
               {"90071992547409924", NAN},
               {"471", 4},
               {"472", 4.5},
               {"00472", 4.5},
               {"1000", NAN},
               {"1e3", 5},
               {"A-7", 6},
               {"A-8", NAN},
               {"090", 7},
               {"", NAN},
               {"9007199254740992100000000", 8},
               {"9007199254740992100000001", NAN}};
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge_context_XXXXXX";
  const char *paths[] = {path};
  int descriptor = mkstemp(path);
  FILE *out = fdopen(descriptor, "w");
  fputs("serial,force_N\n", out);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    fprintf(out, "%s,%g\n", rows[i].serial, rows[i].value);
  fclose(out);
  const fg_station_request request = {.contexts = paths, .context_count = 1};
  fg_station_contexts contexts;
  assert_ok(&ctx, fg_station_contexts_load(&ctx, &request, &contexts));
  for (size_t i = 0; i < sizeof foils / sizeof *foils; i++) {
    in_row("%s", foils[i].serial);
    fg_context_value value = fg_station_context_value(&contexts.one[0], 1, foils[i].serial, 0);
    if (isnan(foils[i].value))
      assert_true(isnan(value.number) && !value.word);
    else
      assert_true(value.number == foils[i].value);
  }
  fg_station_contexts_free(&contexts);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(long_serials_have_their_own_rows)};
  return cmocka_run_group_tests_name("contexts of a station", tests, NULL, NULL);
}
