/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the bytes of a small scan (at 600 dpi) to its measurement, every report of it included. */
#include <stdio.h>

#include "foilgauge/measure.h"
#include "foilgauge/report.h"
#include "fuzz.h"

static void write_reports(const fg_measurement *measurement) {
  const fg_report_scan scan = {"scan", measurement, NULL, NULL};
  const fg_report report = {&measurement->design, &measurement->nominal, &scan, 1, NULL};
  fg_context ctx = {0};
  FILE *out = fopen("/dev/null", "w");
  if (!out) return;
  (void)fg_report_write_json(&ctx, &report, out);
  (void)fg_report_write_csv(&ctx, &report, out);
  (void)fg_report_write_table(&ctx, &report, out);
  fclose(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_design design;
  fg_measurement measurement;
  fg_design_default(&design);
  design.thickness_mm = 0.2;
  design.bumps.count = 3;
  const fg_measure_options options = {
      .dpi = 600, .threads = 1, .pixel_cap = 1 << 18, .memory_cap = 64 << 20};
  if (fg_measure_scan(&ctx, fuzz_file(data, size), &design, &options, &measurement) != FG_OK)
    return 0;
  write_reports(&measurement);
  fg_measurement_free(&measurement);
  return 0;
}
