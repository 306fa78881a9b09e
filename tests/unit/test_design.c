/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Designs: nominal values against hand calculation, the declared model against the law of cosines,
 * and refused designs, whose messages name the member. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/design.h"
#include "support/test.h"

#define SCHEMA "\"schema\": \"foilgauge/design/1\""
#define CORE                                                                                       \
  "\"bump_radius_mm\": 3.2, \"bump_angle_deg\": 60, \"overall_radius_mm\": 20.7, "                 \
  "\"thickness_mm\": 0.1"

static const double pi = 3.14159265358979323846;

/* Table 5.6; eq 5.1, 5.2, 5.5 and 5.8. */
static void default_design_has_known_values(void **state) {
  (void)state;
  fg_design design;
  fg_nominal nominal;
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &nominal));
  assert_near(nominal.centre_to_centre_mm, 23.48547331077125, 1e-13);
  assert_near(nominal.height_mm, 0.564526689228749, 1e-13);
  assert_near(nominal.clearance_mm, 0.065473310771251, 1e-13);
  assert_near(nominal.half_chord_mm, 3.32 * sin(31.575 * pi / 180), 1e-14);
  assert_near(nominal.arc_length_mm, 3.32 * 63.15 * pi / 180, 1e-14);
  assert_near(nominal.die_height_mm, 0.1 + 3.32 * (1 - cos(31.575 * pi / 180)), 1e-14);
  /* At the crossing the angles of the triangle O, C, crossing: theta = alpha/2 + the half angle of
   * the bump seen from O. */
  assert_near(nominal.intersection_angle_deg,
              31.575 + asin(nominal.half_chord_mm / 20.73) * 180 / pi, 1e-11);
}

static void sleeve_and_datum_enter_where_they_should(void **state) {
  (void)state;
  fg_design design;
  fg_nominal plain, wide;
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &plain));
  design.bumps.sleeve_radius_mm += 0.05;
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &wide));
  assert_near(wide.centre_to_centre_mm, plain.centre_to_centre_mm, 0);
  assert_near(wide.height_mm, plain.height_mm + 0.05, 1e-14);
  assert_near(wide.clearance_mm, plain.clearance_mm, 1e-14);
}

/* Every clearance is less by the top foil's thickness, and nothing else changes. */
static void top_foil_is_taken_off_every_clearance(void **state) {
  (void)state;
  fg_design design;
  fg_nominal plain, covered;
  fg_springback model;
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &plain));
  double over = fg_design_clearance_over(&design, 0.5, 0.12);
  design.bumps.top_foil_thickness_mm = 0.05;
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &covered));
  assert_near(covered.clearance_mm, plain.clearance_mm - 0.05, 1e-14);
  assert_near(fg_design_clearance_over(&design, 0.5, 0.12), over - 0.05, 1e-14);
  fg_design_springback(&design, &covered, design.bumps.radius_mm, &model);
  assert_near(model.clearance_mm, covered.clearance_mm, 1e-10);
  covered.clearance_mm = plain.clearance_mm;
  assert_memory_equal(&covered, &plain, sizeof plain);
}

/* The model written out as in the thesis, over the curve's range. */
static void declared_model_is_the_law_of_cosines(void **state) {
  (void)state;
  fg_design design;
  fg_nominal nominal;
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &nominal));
  for (int percent = -5; percent <= 30; percent++) {
    fg_springback model, next;
    double r = 3.32 * (1 + percent / 100.0), alpha = 63.15 * 3.32 / r;
    double x = nominal.centre_to_centre_mm + r - 3.32;
    double m = sqrt(x * x + r * r - 2 * x * r * cos(alpha * pi / 360));
    fg_design_springback(&design, &nominal, r, &model);
    fg_design_springback(&design, &nominal, r + 1e-6, &next);
    assert_near(model.bump_angle_deg, alpha, 1e-12);
    assert_near(model.height_mm, nominal.height_mm - (20.73 - m), 1e-12);
    assert_near(model.clearance_mm, 20.73 - model.height_mm - 20 - 0.1, 1e-13);
    assert_near(model.height_slope, (next.height_mm - model.height_mm) / 1e-6, 1e-6);
    assert_near(model.bump_angle_slope, (next.bump_angle_deg - model.bump_angle_deg) / 1e-6, 1e-4);
  }
}

/* Chapter 5 prints about +33 % at +5 % radius and about +160 % at +30 %. */
static void clearance_grows_as_the_model_says(void **state) {
  (void)state;
  fg_design design;
  fg_nominal nominal;
  fg_springback model;
  fg_design_default(&design);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &nominal));
  fg_design_springback(&design, &nominal, 3.32 * 1.05, &model);
  assert_near(100 * (model.clearance_mm / nominal.clearance_mm - 1), 32.9, 0.1);
  fg_design_springback(&design, &nominal, 3.32 * 1.30, &model);
  assert_near(100 * (model.clearance_mm / nominal.clearance_mm - 1), 161.8, 0.1);
  fg_design_springback(&design, &nominal, 3.32, &model);
  assert_near(model.height_mm, nominal.height_mm, 1e-13);
}

static void file_is_read(void **state) {
  (void)state;
  fg_design design;
  fg_context ctx = {0};
  fg_design_default(&design);
  const char *json = "{ " SCHEMA ", \"name\": \"sheet 7\", \"form\": \"sinusoidal\","
                     "\"datum\": \"outer\", \"bump_count\": 7, " CORE ", \"pitch_deg\": 14,"
                     "\"fillet_radius_mm\": 1.1, \"rotor_diameter_mm\": 39.9, \"tolerances\":"
                     "{ \"height_mm\": {\"min\": 0.4, \"max\": 0.6},"
                     "\"overall.radius_mm\": {\"max\": 21}}}\n";
  if (fg_design_parse(&ctx, "x", json, &design) != FG_OK) fail_msg("%s", ctx.message);
  assert_string_equal(design.name, "sheet 7");
  assert_int_equal(design.kind, FG_FOIL_SINUSOIDAL);
  assert_int_equal(design.datum, FG_DATUM_OUTER);
  assert_int_equal(design.bumps.count, 7);
  assert_near(design.bumps.radius_mm, 3.2, 0);
  assert_near(design.bumps.sleeve_radius_mm, 20.7, 0); /* follows the overall radius */
  assert_near(design.bumps.pitch_deg, 14, 0);
  assert_near(design.bumps.rotor_diameter_mm, 39.9, 0);
  assert_int_equal(design.tolerance_count, 2);
  assert_string_equal(design.tolerances[1].quantity, "overall.radius_mm");
  assert_near(design.tolerances[0].lower, 0.4, 0);
  assert_near(design.tolerances[0].upper, 0.6, 0);
  assert_true(isinf(design.tolerances[1].lower) && design.tolerances[1].upper == 21);
}

static void absent_members_keep_their_values(void **state) {
  (void)state;
  fg_design design;
  fg_design_default(&design);
  design.bumps.pitch_deg = 15;
  assert_ok(&test_context, fg_design_parse(&test_context, "x",
                                           "{" SCHEMA ", \"fillet_radius_mm\": 0.4}", &design));
  assert_near(design.bumps.pitch_deg, 15, 0);
  assert_near(design.bumps.fillet_radius_mm, 0.4, 0);
  assert_near(design.bumps.radius_mm, 3.32, 0);
}

static void discs_need_no_bump_values(void **state) {
  (void)state;
  fg_design design = {.kind = FG_FOIL_CLASSICAL};
  fg_nominal nominal;
  const char *json = "{" SCHEMA ", \"form\": \"discs\", \"diameters_mm\": [4, 6.5]}";
  assert_ok(&test_context, fg_design_parse(&test_context, "x", json, &design));
  assert_int_equal(design.discs.count, 2);
  assert_near(design.discs.diameters_mm[1], 6.5, 0);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &nominal));
  assert_true(isnan(nominal.height_mm));
}

#define CANTILEVER(length, width)                                                                  \
  "{" SCHEMA ", \"form\": \"cantilever\", \"thickness_mm\": 0.1, \"beam_length_mm\": " #length     \
  ", \"beam_width_mm\": " #width

static void cantilever_is_read(void **state) {
  (void)state;
  fg_design design;
  fg_nominal nominal;
  fg_design_default(&design);
  const char *json = CANTILEVER(9, 3) ", \"beam_count\": 8, \"sagitta_mm\": 1, "
                                      "\"clearance_mm\": 0.126, \"elastic_modulus_gpa\": 214}";
  assert_ok(&test_context, fg_design_parse(&test_context, "x", json, &design));
  assert_int_equal(design.kind, FG_FOIL_CANTILEVER);
  assert_int_equal(design.beams.count, 8);
  assert_string_equal(design.name, "cantilever");
  assert_near(design.beams.clearance_mm, 0.126, 0);
  assert_ok(&test_context, fg_design_derive(&test_context, &design, &nominal));
  assert_true(isnan(nominal.height_mm));
}

/* A text, and what the message must say; the design must stay as it was. */
static void bad_files_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *json, *words;
  } rows[] = {
      {"", "line 1"},
      {"[]", "object"},
      {"{" SCHEMA "", "JSON"},
      {"{" SCHEMA "} x", "JSON"},
      {"{" SCHEMA ",\n \"bump_radius_mm\": NaN}",
       "line 2, column 20: this is not JSON: \"bump_rad"},
      {"{" SCHEMA ", \"bump_radius_mm\": -Infinity}", "bump_radius_mm"},
      {"{\"name\": \"x\"}", "schema: is missing"},
      {"{\"schema\": \"foilgauge/measure/1\"}", "schema: must be"},
      {"{\"schema\": 1}", "schema: must be"},
      {"{" SCHEMA ", " SCHEMA "}", "schema: is given twice"},
      {"{" SCHEMA ", \"pitch_deg\": 13, \"pitch_deg\": 14}", "pitch_deg: is given twice"},
      {"{" SCHEMA ", \"bump_radius\": 3}", "bump_radius: is not known; there are schema, name"},
      {"{" SCHEMA ", \"Pitch_deg\": 13}", "Pitch_deg: is not known"},
      {"{" SCHEMA ", \"pitch_deg\": \"13\"}", "pitch_deg: must be a number"},
      {"{" SCHEMA ", \"pitch_deg\": null}", "pitch_deg: must be a number"},
      {"{" SCHEMA ", \"pitch_deg\": 1e999}", "pitch_deg: the number is too large"},
      {"{" SCHEMA ", \"pitch_deg\": 0}", "pitch_deg is 0"},
      {"{" SCHEMA ", \"fillet_radius_mm\": -1}", "fillet_radius_mm is -1"},
      {"{" SCHEMA ", \"rotor_diameter_mm\": -40}", "rotor_diameter_mm is -40"},
      {"{" SCHEMA ", \"bump_count\": 2.5}", "bump_count: is 2.5"},
      {"{" SCHEMA ", \"bump_count\": -1}", "bump_count: is -1"},
      {"{" SCHEMA ", \"bump_count\": 28}", "bump_count is 28"},
      {"{" SCHEMA ", \"name\": 3}", "name: must be a text"},
      {"{" SCHEMA ", \"name\": \"a\\u0007\"}", "name: holds a control"},
      {"{" SCHEMA
       ", \"name\": \"0123456789012345678901234567890123456789012345678901234567890123\"}",
       "name: is too long; at most 63 bytes"},
      {"{" SCHEMA ", \"form\": \"round\"}", "form: must be \"classical\""},
      {"{" SCHEMA ", \"datum\": 1}", "datum: must be \"mid\""},
      {"{" SCHEMA ", \"bump_radius_mm\": 3.3}", "bump_angle_deg: is missing"},
      {"{" SCHEMA ", \"overall_radius_mm\": 20}", "bump_radius_mm: is missing"},
      {"{" SCHEMA ", \"bump_radius_mm\": 15, \"bump_angle_deg\": 170, \"thickness_mm\": 0.1, "
       "\"overall_radius_mm\": 14.9}",
       "bump_radius_mm is 15"},
      {"{" SCHEMA ", \"bump_radius_mm\": 3.3, \"bump_angle_deg\": 190, \"thickness_mm\": 0.1, "
       "\"overall_radius_mm\": 20.73}",
       "bump_angle_deg is 190"},
      {"{" SCHEMA ", \"bump_radius_mm\": 3.3, \"bump_angle_deg\": 100, \"thickness_mm\": 0.1, "
       "\"overall_radius_mm\": 20.73}",
       "pitch_deg is 13.3333: bumps overlap"},
      {"{" SCHEMA ", \"fillet_radius_mm\": 4}", "pitch_deg is 13.3333: bumps overlap"},
      {"{" SCHEMA ", \"fillet_radius_mm\": 400}", "fillet_radius_mm is 400"},
      {"{" SCHEMA ", \"rotor_diameter_mm\": 42}", "rotor_diameter_mm is 42"},
      {"{" SCHEMA ", \"top_foil_thickness_mm\": -0.1}", "top_foil_thickness_mm is -0.1"},
      {"{" SCHEMA ", \"top_foil_thickness_mm\": null}", "top_foil_thickness_mm: must be a number"},
      {"{" SCHEMA ", \"top_foil_thickness_mm\": 0.1}", "the rotor must be below 39.9309"},
      {"{" SCHEMA ", \"diameters_mm\": [1]}", "diameters_mm belongs to"},
      {"{" SCHEMA ", \"form\": \"discs\", \"diameters_mm\": 1}", "diameters_mm: must be an array"},
      {"{" SCHEMA ", \"form\": \"discs\", \"diameters_mm\": [1, \"2\"]}", "diameters_mm[1]: must"},
      {"{" SCHEMA ", \"form\": \"discs\", \"diameters_mm\": [1, 0]}", "diameters_mm[1] is 0"},
      {"{" SCHEMA ", \"beam_length_mm\": 9}", "beam_length_mm belongs to form \"cantilever\""},
      {"{" SCHEMA ", \"clearance_mm\": 0.1}", "clearance_mm belongs to form \"cantilever\""},
      {"{" SCHEMA ", \"form\": \"cantilever\"}", "beam_length_mm: is missing; a cantilever must"},
      {CANTILEVER(9, 3) ", \"bump_count\": 9}", "bump_count: belongs to a foil with bumps"},
      {CANTILEVER(9, 3) ", \"datum\": \"mid\"}", "datum: belongs to a foil with bumps"},
      {CANTILEVER(9, 3) ", \"subtended_angle_deg\": 40}", "subtended_angle_deg belongs to"},
      {CANTILEVER(-9, 3) "}", "beam_length_mm is -9"},
      {CANTILEVER(9, 0) "}", "beam_width_mm is 0"},
      {CANTILEVER(3, 9) "}", "beam_width_mm is 9; it must be below beam_length_mm 3"},
      {CANTILEVER(9, 0.05) "}", "thickness_mm is 0.1; it must be below beam_width_mm 0.05"},
      {CANTILEVER(9, 3) ", \"beam_count\": 2.5}", "beam_count: is 2.5"},
      {CANTILEVER(9, 3) ", \"sagitta_mm\": 4.5}", "sagitta_mm is 4.5; it must be below half"},
      {CANTILEVER(9, 3) ", \"sagitta_mm\": -1}", "sagitta_mm is -1"},
      {CANTILEVER(9, 3) ", \"clearance_mm\": 0.1}", "clearance_mm is 0.1 without sagitta_mm"},
      {CANTILEVER(9, 3) ", \"elastic_modulus_gpa\": -5}", "elastic_modulus_gpa is -5"},
      {CANTILEVER(9, 3) ", \"u_thickness_mm\": 0.06}", "u_thickness_mm is 0.06"},
      {"{" SCHEMA ", \"tolerances\": []}", "tolerances: must be an object"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": 1}}", "tolerances.height_mm: must be"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": {}}}", "tolerances.height_mm: must be"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": {\"low\": 1}}}",
       "tolerances.height_mm.low: is"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": {\"min\": 1, \"min\": 1}}}",
       "tolerances.height_mm.min: is given twice"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": {\"min\": 2, \"max\": 1}}}",
       "tolerances.height_mm: min 2 is above max 1"},
      {"{" SCHEMA ", \"tolerances\": {\"height_mm\": {\"min\": 2}, \"height_mm\": {\"min\": 2}}}",
       "tolerances.height_mm: is given twice"},
      {"{" SCHEMA ", \"tolerances\": {\"heigth_mm\": {\"min\": 2}}}", "tolerances.heigth_mm"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_context ctx = {0};
    fg_design design, before;
    memset(&design, 0, sizeof design);
    fg_design_default(&design);
    before = design;
    if (fg_design_parse(&ctx, "d.json", rows[i].json, &design) != FG_ERR_DATA)
      fail_msg("%s: not refused", rows[i].json);
    if (!strstr(ctx.message, rows[i].words) || strncmp(ctx.message, "d.json: ", 8) != 0)
      fail_msg("%s: '%s' does not say '%s'", rows[i].json, ctx.message, rows[i].words);
    assert_memory_equal(&design, &before, sizeof design);
  }
}

/* Values that only a program can set: numbers that JSON cannot hold, and a bump whose chord is
 * longer than the overall circle is wide. */
static void check_refuses_senseless_values(void **state) {
  (void)state;
  const double values[] = {0, -1, NAN, INFINITY};
  for (size_t i = 0; i < 4; i++) {
    fg_design design;
    fg_context ctx = {0};
    fg_design_default(&design);
    design.thickness_mm = values[i];
    assert_status(&ctx, fg_design_check(&ctx, &design), FG_ERR_DATA);
    assert_has(ctx.message, "thickness_mm is");
  }
  fg_design design;
  fg_nominal nominal;
  fg_design_default(&design);
  design.tolerances[0] = (fg_tolerance){"height_mm", NAN, 1};
  design.tolerance_count = 1;
  assert_status(NULL, fg_design_derive(NULL, &design, &nominal), FG_ERR_DATA);
}

static void missing_file_is_an_io_error(void **state) {
  (void)state;
  fg_design design;
  fg_context ctx = {0};
  assert_status(&ctx, fg_design_load(&ctx, "no/such/file.json", &design), FG_ERR_IO);
  assert_has(ctx.message, "no/such/file.json");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(default_design_has_known_values),
      cmocka_unit_test(sleeve_and_datum_enter_where_they_should),
      cmocka_unit_test(top_foil_is_taken_off_every_clearance),
      cmocka_unit_test(declared_model_is_the_law_of_cosines),
      cmocka_unit_test(clearance_grows_as_the_model_says),
      cmocka_unit_test(file_is_read),
      cmocka_unit_test(absent_members_keep_their_values),
      cmocka_unit_test(discs_need_no_bump_values),
      cmocka_unit_test(cantilever_is_read),
      cmocka_unit_test(bad_files_are_refused),
      cmocka_unit_test(check_refuses_senseless_values),
      cmocka_unit_test(missing_file_is_an_io_error),
  };
  return cmocka_run_group_tests_name("design", tests, NULL, NULL);
}
