/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports validate against the JSON Schemas in reports/schema (that these know every row of the
 * quantities: test_quantity.c). Skipped without python3-jsonschema. */

#include <sys/wait.h>
#include <unistd.h>

#include "foilgauge/report.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

enum { SKIPPED = 77 };

/* The exit code of the validator on what the report writes. */
static int validate(const fg_report *report) {
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge-report-XXXXXX", command[256];
  FILE *out = fdopen(mkstemp(path), "w");
  assert_non_null(out);
  assert_ok(&ctx, fg_report_write_json(&ctx, report, out));
  fclose(out);
  snprintf(command, sizeof command,
           "python3 tests/support/validate_schema.py reports/schema measure.schema.json %s", path);
  int status = system(command);
  unlink(path);
  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

static void assert_valid(const fg_report *report) {
  int code = validate(report);
  if (code == SKIPPED || code == 127) skip();
  assert_int_equal(code, 0);
}

static void a_foil_is_valid(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  synthetic_tolerance(&design, "height_mm", 0.5, INFINITY);
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  fg_report_scan scans[2] = {{"a.png", &measurement, NULL, NULL},
                             {"b.png", NULL, "b.png: broken", NULL}};
  fg_report report = {&design, &nominal, scans, 1, NULL};
  assert_valid(&report);
  report.scan_count = 2;
  assert_valid(&report);

  /* A foil without a single value. */
  fg_foil *foil = &measurement.foils[0];
  fg_foil_give_up(foil, "no arc was found");
  foil->bump_count = 0;
  assert_valid(&report);
  synthetic_free(&measurement);
}

static void discs_are_valid(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  design.discs.count = 2;
  design.discs.diameters_mm[0] = 3;
  design.discs.diameters_mm[1] = 5.5;
  synthetic_tolerance(&design, "roundness_um", -INFINITY, 5);
  fg_nominal nominal = {0};
  fg_disc discs[2] = {synthetic_disc(1, 1.5), synthetic_disc(2, 2.75)};
  fg_measurement measurement = {
      .file = {.width_px = 100, .height_px = 100, .bit_depth = 16, .dpi_file = {NAN, NAN}},
      .dpi = {1200, 1200},
      .discs = discs,
      .disc_count = 2};
  memset(measurement.sha256, '0', 64);
  fg_report_scan scan = {"discs.png", &measurement, NULL, NULL};
  assert_valid(&(fg_report){&design, &nominal, &scan, 1, NULL});
  for (int i = 0; i < 2; i++) {
    free(discs[i].edge);
    free(discs[i].residual_um);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_foil_is_valid),
      cmocka_unit_test(discs_are_valid),
  };
  return cmocka_run_group_tests_name("report schema", tests, NULL, NULL);
}
