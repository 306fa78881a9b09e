/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stylus traces of a die, from their text to every report. Half of the inputs are a text; the other
 * half a recipe: a sound trace whose values are replaced one by one, so that what lies behind the
 * reading of numbers is reached. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/die.h"
#include "foilgauge/die_report.h"
#include "fuzz.h"

/* Larger traces are only slower. */
enum { TEXT = 16384, POINTS = 480, EDITS = 8 };

/* z of a dome of lands with three grooves for bumps: the concave half's surface, mm. */
static double height_mm(const fg_design *design, double x_mm) {
  fg_context ctx = {0};
  fg_nominal nominal;
  (void)fg_design_derive(&ctx, design, &nominal);
  double lands = design->overall_radius_mm - design->thickness_mm / 2;
  double groove = design->bumps.radius_mm + design->thickness_mm / 2;
  double z = sqrt(lands * lands - x_mm * x_mm);
  for (int i = -1; i <= 1; i++) {
    double at = i * design->bumps.pitch_deg * M_PI / 180;
    double off = x_mm - nominal.centre_to_centre_mm * sin(at);
    if (fabs(off) < groove)
      z = fmin(z, nominal.centre_to_centre_mm * cos(at) - sqrt(groove * groove - off * off));
  }
  return z;
}

static const char *write_recipe(fuzz_bytes *bytes, const fg_design *design) {
  static char text[POINTS * 48];
  static double point[POINTS][2];
  double span = 16 + (double)fuzz_take(bytes) / 16;
  for (size_t i = 0; i < POINTS; i++) {
    point[i][0] = span * ((double)i / (POINTS - 1) - 0.5);
    point[i][1] = height_mm(design, point[i][0]) + 1e-4 * sin(12.9 * (double)(i * i % 1013));
  }
  for (size_t edits = fuzz_take_below(bytes, EDITS); edits; edits--) {
    double *value = &point[fuzz_take_below(bytes, POINTS)][fuzz_take(bytes) & 1];
    *value = fuzz_take_number(bytes, *value);
  }
  size_t length = 0, count = POINTS - fuzz_take_below(bytes, POINTS) * (fuzz_take(bytes) & 1);
  for (size_t i = 0; i < count; i++)
    length += (size_t)snprintf(text + length, sizeof text - length, "%.9g\t%.9g\n", point[i][0],
                               point[i][1]);
  return fuzz_file((const uint8_t *)text, length);
}

static void write_reports(const fg_die *die) {
  typedef fg_status writer(fg_context *, const fg_die *, FILE *);
  writer *const writers[] = {fg_die_write_json, fg_die_write_table, fg_die_write_html};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
    fg_context ctx = {0};
    fuzz_report report;
    if (!fuzz_report_open(&report)) return;
    if (writers[i](&ctx, die, report.out) != FG_OK) abort();
    fuzz_report_close(&report, true);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fg_context ctx = {0};
  fg_design design;
  fg_die die;
  fuzz_bytes bytes = {data, data + size};
  if (size > TEXT) return 0;
  fg_design_default(&design);
  uint8_t how = fuzz_take(&bytes);
  const fg_die_options options = {.u_tip_um = 0.1, .u_scale_ppm = 50};
  fg_die_source source = {.half = how & 2 ? "convex" : "concave", .unit = {FG_DIE_MM, FG_DIE_MM}};
  source.reversed = how & 4;
  source.first_bump = how & 8 ? 3 : 0;
  source.path =
      how & 1 ? write_recipe(&bytes, &design) : fuzz_file(bytes.at, (size_t)(bytes.end - bytes.at));
  if (fg_die_measure(&ctx, &design, &options, &source, 1, &die) != FG_OK) return 0;
  write_reports(&die);
  fg_die_free(&die);
  return 0;
}
