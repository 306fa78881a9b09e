/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The correction: edges that a known scanner moved are put back, and no others. */
#include <math.h>
#include <stdlib.h>

#include "scan_loop/state.h"
#include "support/foil_rows.h"
#include "support/test.h"

/* Room for rounding, and for what a fit of circles stops at. */
#define EDGE_MM   1e-9
#define CIRCLE_MM 2e-6

static fg_field_list scanner(const foil_rows *f) {
  static const struct {
    const char *id;
    double amplitude_um;
  } effects[] = {{"scan.scale_y", 40}, {"scan.shear", 25}, {"scan.carriage_ripple", 5}};
  fg_effect_set set = {.count = 0};
  fg_field_list fields;
  for (size_t e = 0; e < sizeof effects / sizeof *effects; e++) {
    in_row("effects[%zu]", e);
    const fg_effect *kind = fg_effect_find(effects[e].id);
    assert_non_null(kind);
    set.effects[set.count++] = (fg_effect_found){.kind = kind,
                                                 .columns = kind->columns,
                                                 .shapes = kind->shapes,
                                                 .coefficient_um = {effects[e].amplitude_um},
                                                 .shape = {3.1}};
  }
  fg_effect_set_fields(&f->edge_fit, &set, &fields);
  assert_int_equal(fields.count, 3);
  return fields;
}

/* Place at which a scanner with this field sees a true one: true = seen + d(seen). */
static fg_point seen_at(const fg_field_list *fields, fg_point truth) {
  fg_point seen = truth;
  for (int k = 0; k < 12; k++) {
    fg_point d = fg_field_at(fields, seen);
    seen = (fg_point){truth.x - d.x, truth.y - d.y};
  }
  return seen;
}

/* A measurement of the synthetic foil as a scanner with the fields sees it (NULL: a perfect one),
 * corrected by `correction` (NULL: not). */
static fg_measurement measure(const foil_rows *f, const fg_field_list *fields,
                              const fg_field_list *correction) {
  fg_context ctx = {0};
  fg_measurement m = f->m, corrected;
  fg_foil foil = f->m.foils[0];
  size_t bytes = foil.strip.count * sizeof *foil.strip.stations;
  foil.strip.stations = malloc(bytes);
  memcpy(foil.strip.stations, f->m.foils[0].strip.stations, bytes);
  for (size_t k = 0; fields && k < foil.strip.count; k++) {
    fg_station *s = &foil.strip.stations[k];
    s->left = seen_at(fields, s->left);
    s->right = seen_at(fields, s->right);
  }
  m.foils = &foil;
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &m, correction, 1, &corrected));
  free(foil.strip.stations);
  return corrected;
}

static void same_edges(const fg_strip *got, const fg_strip *wanted, double tolerance_mm) {
  assert_int_equal(got->count, wanted->count);
  for (size_t k = 0; k < got->count; k++) {
    assert_near(got->stations[k].left.x, wanted->stations[k].left.x, tolerance_mm);
    assert_near(got->stations[k].left.y, wanted->stations[k].left.y, tolerance_mm);
    assert_near(got->stations[k].right.x, wanted->stations[k].right.x, tolerance_mm);
    assert_near(got->stations[k].right.y, wanted->stations[k].right.y, tolerance_mm);
  }
}

static void same_circles(const fg_foil *got, const fg_foil *wanted, double tolerance_mm) {
  assert_int_equal(got->bump_count, wanted->bump_count);
  assert_int_equal(got->bump_count, SYNTHETIC_BUMPS);
  assert_near(got->overall.radius_mm, wanted->overall.radius_mm, tolerance_mm);
  assert_near(got->overall.centre_mm.x, wanted->overall.centre_mm.x, tolerance_mm);
  assert_near(got->overall.centre_mm.y, wanted->overall.centre_mm.y, tolerance_mm);
  for (size_t b = 0; b < got->bump_count; b++) {
    assert_int_equal(got->bumps[b].number, wanted->bumps[b].number);
    assert_near(got->bumps[b].radius_mm, wanted->bumps[b].radius_mm, tolerance_mm);
    assert_near(got->bumps[b].centre_mm.x, wanted->bumps[b].centre_mm.x, tolerance_mm);
    assert_near(got->bumps[b].centre_mm.y, wanted->bumps[b].centre_mm.y, tolerance_mm);
    assert_near(got->bumps[b].height_mm, wanted->bumps[b].height_mm, tolerance_mm);
  }
}

static void a_scanner_s_shift_of_a_foil_is_corrected(void **state) {
  (void)state;
  foil_rows f;
  foil_rows_open(&f);
  fg_field_list fields = scanner(&f);
  fg_measurement truth = measure(&f, NULL, NULL);
  fg_measurement wrong = measure(&f, &fields, NULL), right = measure(&f, &fields, &fields);
  assert_true(fabs(wrong.foils[0].overall.radius_mm - truth.foils[0].overall.radius_mm) > 5e-3);
  same_edges(&right.foils[0].strip, &f.m.foils[0].strip, EDGE_MM);
  same_circles(&right.foils[0], &truth.foils[0], CIRCLE_MM);
  fg_measurement_free(&truth);
  fg_measurement_free(&wrong);
  fg_measurement_free(&right);
  foil_rows_close(&f);
}

/* The circle that the synthetic foil was made of, not only the one that was measured. */
static void the_corrected_foil_is_the_one_that_was_drawn(void **state) {
  (void)state;
  foil_rows f;
  foil_rows_open(&f);
  fg_field_list fields = scanner(&f);
  fg_measurement right = measure(&f, &fields, &fields);
  const fg_foil *drawn = &f.m.foils[0], *got = &right.foils[0];
  const double residual_mm = 0.4e-3; /* that the synthetic midline has */
  assert_near(got->overall.radius_mm, drawn->overall.radius_mm, residual_mm);
  for (size_t b = 0; b < got->bump_count; b++)
    assert_near(got->bumps[b].radius_mm, drawn->bumps[b].radius_mm, 4 * residual_mm);
  fg_measurement_free(&right);
  foil_rows_close(&f);
}

/* A part's deviation is its form: no edge moves, and no number or uncertainty of a circle. */
static void a_part_s_own_deviation_stays(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  const fg_effect_set set = {.effects = {{.kind = fg_effect_find("part.ovality"), .columns = 2}},
                             .count = 1};
  fg_joint_fit_result fit;
  fg_measurement plain, after;
  assert_ok(&ctx, fg_joint_fit_open(&ctx, &f.edge_fit, &set, &fit));
  assert_true(fabs(fit.set.effects[0].coefficient_um[0]) > 1e-3);
  assert_true(fit.set.effects[0].u_coefficient_um[0] > 0);
  assert_near(fit.parts[0].overall, 0, 0);
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &f.m, NULL, 1, &plain));
  assert_ok(&ctx, fg_scan_loop_correct_fitted(&ctx, &f.m, &fit, 1, &after));
  same_edges(&after.foils[0].strip, &plain.foils[0].strip, 0);
  same_circles(&after.foils[0], &plain.foils[0], 0);
  assert_near(after.foils[0].overall.u_radius_mm, plain.foils[0].overall.u_radius_mm, 0);
  fg_measurement_free(&plain);
  fg_measurement_free(&after);
  fg_joint_fit_close(&fit);
  foil_rows_close(&f);
}

/* Beside a part's effect of like shape, a scanner's effect is less sure, and so is its
 * correction. */
static void a_part_s_effect_makes_the_correction_less_sure(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  const fg_effect *oval = fg_effect_find("part.ovality"), *shear = fg_effect_find("scan.shear");
  fg_effect_set alone = {.effects = {{.kind = shear, .columns = 1}}, .count = 1};
  fg_effect_set both = {.effects = {{.kind = shear, .columns = 1}, {.kind = oval, .columns = 2}},
                        .count = 2};
  fg_joint_fit_result one, two;
  assert_ok(&ctx, fg_joint_fit_open(&ctx, &f.edge_fit, &alone, &one));
  assert_ok(&ctx, fg_joint_fit_open(&ctx, &f.edge_fit, &both, &two));
  assert_true(one.parts[0].overall > 0);
  assert_true(two.parts[0].overall > 2 * one.parts[0].overall);
  fg_joint_fit_close(&one);
  fg_joint_fit_close(&two);
  foil_rows_close(&f);
}

/* A fit corrects as it did, whatever is fitted to the same points after it. */
static void a_later_fit_changes_no_correction(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  const fg_effect *oval = fg_effect_find("part.ovality"), *shear = fg_effect_find("scan.shear");
  fg_effect_set set = {.effects = {{.kind = shear, .columns = 1}, {.kind = oval, .columns = 2}},
                       .count = 2};
  fg_effect_set none = {.count = 0};
  fg_joint_fit_result fit;
  fg_measurement before, after;
  assert_ok(&ctx, fg_joint_fit_open(&ctx, &f.edge_fit, &set, &fit));
  assert_true(fabs(fit.set.effects[0].coefficient_um[0]) > 1e-3);
  assert_ok(&ctx, fg_scan_loop_correct_fitted(&ctx, &f.m, &fit, 1, &before));
  assert_ok(&ctx, fg_joint_fit(&ctx, &f.edge_fit, &none, NULL));
  assert_ok(&ctx, fg_scan_loop_correct_fitted(&ctx, &f.m, &fit, 1, &after));
  same_edges(&after.foils[0].strip, &before.foils[0].strip, 0);
  same_circles(&after.foils[0], &before.foils[0], 0);
  assert_near(after.foils[0].overall.u_radius_mm, before.foils[0].overall.u_radius_mm, 0);
  fg_measurement_free(&before);
  fg_measurement_free(&after);
  fg_joint_fit_close(&fit);
  foil_rows_close(&f);
}

static void a_scanner_s_shift_of_a_disc_is_corrected(void **state) {
  (void)state;
  enum { STATIONS = 720 };
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  fg_field_list fields = scanner(&f);
  const fg_point centre = {17, 25};
  const double radius_mm = 4;
  fg_disc_point seen[STATIONS];
  for (int k = 0; k < STATIONS; k++) {
    double angle = 2 * synthetic_pi * k / STATIONS;
    fg_point at = {centre.x + radius_mm * cos(angle), centre.y + radius_mm * sin(angle)};
    seen[k] = (fg_disc_point){
        .at = seen_at(&fields, at), .u = 1e-4, .split = NAN, .u_split = NAN, .used = true};
  }
  fg_disc disc = {.number = 1, .stations = seen, .station_count = STATIONS};
  fg_measurement m = {.disc_count = 1, .discs = &disc}, wrong, right;
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &m, NULL, 1, &wrong));
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &m, &fields, 1, &right));
  assert_true(fabs(wrong.discs[0].radius_mm - radius_mm) > 1e-3);
  assert_near(right.discs[0].radius_mm, radius_mm, EDGE_MM);
  assert_near(right.discs[0].centre_mm.x, centre.x, EDGE_MM);
  assert_near(right.discs[0].centre_mm.y, centre.y, EDGE_MM);
  fg_measurement_free(&wrong);
  fg_measurement_free(&right);
  foil_rows_close(&f);
}

/* Why it could not be measured stays as it is. */
static void a_foil_that_was_not_measured_stays_so(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  fg_field_list fields = scanner(&f);
  fg_measurement corrected;
  f.m.foils[0].flags = FG_FOIL_NOT_MEASURED | FG_FOIL_COARSE_RESOLUTION;
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &f.m, &fields, 1, &corrected));
  assert_int_equal(corrected.foils[0].flags, f.m.foils[0].flags);
  assert_true(isnan(corrected.foils[0].overall.radius_mm));
  fg_measurement_free(&corrected);
  foil_rows_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_scanner_s_shift_of_a_foil_is_corrected),
      cmocka_unit_test(the_corrected_foil_is_the_one_that_was_drawn),
      cmocka_unit_test(a_part_s_own_deviation_stays),
      cmocka_unit_test(a_part_s_effect_makes_the_correction_less_sure),
      cmocka_unit_test(a_later_fit_changes_no_correction),
      cmocka_unit_test(a_scanner_s_shift_of_a_disc_is_corrected),
      cmocka_unit_test(a_foil_that_was_not_measured_stays_so),
  };
  return cmocka_run_group_tests_name("correction", tests, NULL, NULL);
}
