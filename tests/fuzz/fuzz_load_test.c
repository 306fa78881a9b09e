/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load-displacement tests, from the text of a CSV file to every report. Half of the inputs are a
 * text; the other half a recipe: a sound record of which stretches are dropped and values replaced.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/load_report.h"
#include "foilgauge/load_test.h"
#include "fuzz.h"

/* Larger records are only slower. */
enum { TEXT = 16384, SAMPLES = 240, EDITS = 8 };

/* Force of foils behind a gap of 2 x 0.08 mm, with friction `h` against the way, N. */
static double force_n(double x_mm, double way, double h) {
  double pressed = fabs(x_mm) > 0.08 ? fabs(x_mm) - 0.08 : 0;
  return copysign(400 * pressed + 2e4 * pressed * pressed * pressed, x_mm) + h * (way > 0 ? 1 : -1);
}

static const char *write_recipe(fuzz_bytes *bytes) {
  static char text[SAMPLES * 64 + 64];
  static double sample[SAMPLES][2];
  static bool dropped[SAMPLES];
  double h = (double)fuzz_take(bytes) / 64;
  memset(dropped, 0, sizeof dropped);
  for (size_t i = 0; i < SAMPLES; i++) {
    double phase = 4 * M_PI * (double)i / SAMPLES;
    sample[i][0] = 0.14 * sin(phase);
    sample[i][1] = force_n(sample[i][0], cos(phase), h) + 0.01 * sin(7.7 * (double)(i * i % 997));
  }
  for (size_t edits = fuzz_take_below(bytes, EDITS); edits; edits--) {
    size_t at = fuzz_take_below(bytes, SAMPLES), column = fuzz_take(bytes) % 3;
    if (column < 2)
      sample[at][column] = fuzz_take_number(bytes, sample[at][column]);
    else
      for (size_t n = fuzz_take(bytes); n && at < SAMPLES; n--)
        dropped[at++] = true;
  }
  size_t length = (size_t)snprintf(text, sizeof text, "azimuth_deg,displacement_mm,force_N\n");
  for (size_t i = 0; i < SAMPLES; i++)
    if (!dropped[i])
      length += (size_t)snprintf(text + length, sizeof text - length, "%d,%.9g,%.9g\n",
                                 i < SAMPLES / 2 || h > 1 ? 0 : 60, sample[i][0], sample[i][1]);
  return fuzz_file((const uint8_t *)text, length);
}

static void write_reports(const fg_load_test *test, bool numbers) {
  typedef fg_status writer(fg_context *, const fg_load_test *, FILE *);
  writer *const writers[] = {fg_load_write_json, fg_load_write_text, fg_load_write_html,
                             fg_load_write_csv, fg_load_write_table};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
    fg_context ctx = {0};
    fuzz_report report;
    if (!fuzz_report_open(&report)) return;
    if (writers[i](&ctx, test, report.out) != FG_OK) abort();
    fuzz_report_close(&report, numbers);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_load_test test;
  fuzz_bytes bytes = {data, data + size};
  if (size > TEXT) return 0;
  bool recipe = fuzz_take(&bytes) & 1;
  fg_load_options options = fg_load_options_default();
  options.limit_count = 1;
  options.limits[0] = (fg_tolerance){.quantity = "clearance_mm", .lower = -INFINITY, .upper = 0.2};
  fg_load_source source = {.bearing = "b", .azimuth_deg = 0};
  source.path = recipe ? write_recipe(&bytes) : fuzz_file(bytes.at, (size_t)(bytes.end - bytes.at));
  if (recipe) source.azimuth_deg = NAN;
  if (fg_load_test_measure(&ctx, &options, &source, 1, &test) != FG_OK) return 0;
  write_reports(&test, recipe);
  fg_load_test_free(&test);
  return 0;
}
