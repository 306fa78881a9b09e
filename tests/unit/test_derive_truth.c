/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derived quantities against the truth tables of the rendered scans. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "foilgauge/foil.h"
#include "support/data.h"
#include "support/test.h"
#include <cjson/cJSON.h>

static const char *const scans[] = {
    "p1_classical", "p2_dark_on_light", "p3_sinusoidal_16bit", "p4_lip_springback", "p5_scale_y",
    "p6_ripple",    "p7_rough",         "p8_side_wall",
};

static char *read_truth(const char *scan) {
  char path[100];
  snprintf(path, sizeof path, "truth/%s.truth.json", scan);
  return data_read(path);
}

static double number(const cJSON *object, const char *name) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  assert_true(cJSON_IsNumber(item));
  return item->valuedouble;
}

static void check_nominal(const cJSON *truth, fg_design *design, fg_nominal *nominal) {
  const cJSON *stated = cJSON_GetObjectItem(truth, "design");
  const cJSON *derived = cJSON_GetObjectItem(truth, "nominal");
  fg_design_default(design);
  design->bumps.radius_mm = number(stated, "bump_radius_mm");
  design->bumps.angle_deg = number(stated, "bump_angle_deg");
  design->bumps.fillet_radius_mm = number(stated, "fillet_radius_mm");
  design->overall_radius_mm = design->bumps.sleeve_radius_mm = number(stated, "overall_radius_mm");
  assert_ok(&test_context, fg_design_derive(&test_context, design, nominal));
  assert_true(fabs(nominal->centre_to_centre_mm - number(derived, "centre_to_centre_mm")) < 1e-9);
  assert_true(fabs(nominal->height_mm - number(derived, "height_mm")) < 1e-9);
  assert_true(fabs(nominal->clearance_mm - number(derived, "clearance_mm")) < 1e-9);
}

static void check_bump(const fg_design *design, const fg_nominal *nominal,
                       const fg_overall *overall, const cJSON *truth) {
  fg_bump bump = {.radius_mm = number(truth, "radius_mm")};
  bump.centre_mm.x = -number(truth, "centre_to_centre_mm");
  const fg_thickness strip = {.mm = design->thickness_mm};
  fg_bump_derive(design, nominal, overall, &strip, &bump);
  assert_true(fabs(bump.bump_angle_deg - number(truth, "bump_angle_deg")) < 1e-9);
  assert_true(fabs(bump.intersection_angle_deg - number(truth, "intersection_angle_deg")) < 1e-9);
  assert_true(fabs(bump.height_mm - number(truth, "height_mm")) < 1e-9);
}

static void truth_tables(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof scans / sizeof *scans; i++) {
    in_row("scans[%zu]", i);
    char *text = read_truth(scans[i]);
    fg_design design;
    fg_nominal nominal;
    int bumps = 0;
    cJSON *truth = cJSON_Parse(text);
    assert_non_null(truth);
    check_nominal(truth, &design, &nominal);
    fg_overall overall = {.radius_mm = number(truth, "overall_radius_mm")};
    const cJSON *bump;
    cJSON_ArrayForEach(bump, cJSON_GetObjectItem(truth, "bumps")) {
      check_bump(&design, &nominal, &overall, bump);
      bumps++;
    }
    assert_true(bumps >= 9);
    cJSON_Delete(truth);
    free(text);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(truth_tables)};
  return cmocka_run_group_tests_name("derive truth", tests, NULL, NULL);
}
