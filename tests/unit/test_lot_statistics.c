/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values that enter a lot's statistics, and the arch that a bump is taken for. */
#include "report/lot/files.h"
#include "report/lot/plots.h"
#include "support/made_lot.h"
#include "support/test.h"

enum { FOILS = 6, BUMPS = 9 };

static fg_lot sound_lot(const fg_design *design) {
  fg_lot lot = made_lot(design, FOILS, BUMPS, "", NULL);
  for (size_t i = 0; i < FOILS; i++)
    for (size_t k = 0; k < BUMPS; k++) {
      double radius = 3.36 + 0.01 * (double)((i * 5 + k * 3) % 11);
      made_bump(&lot, i, k, radius, 63.15 * 3.32 / radius + 0.02 * (double)(i % 3));
    }
  return lot;
}

static char *text_of(const fg_lot_analysis *analysis, fg_lot_writer *writer) {
  char *text;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_ok(NULL, writer(NULL, analysis, out));
  fclose(out);
  return text;
}

static char *map_of(const fg_lot_analysis *analysis) {
  char *text;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  fg_lot_plot_map(out, analysis);
  fclose(out);
  return text;
}

/* A bump that was trodden on: every statistic is as if it were not there, and it is counted. */
static void crushed_bumps_are_in_no_statistics(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis sound, with;
  fg_design_default(&design);
  fg_lot lot = sound_lot(&design);
  lot.records[2].foils[0].bump_count = 8;
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &sound));
  lot.records[2].foils[0].bump_count = 9;
  made_bump(&lot, 2, 8, 6.5, 20);
  lot.records[2].foils[0].bumps[8].flags |= FG_BUMP_CRUSHED;
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &with));
  assert_int_equal(sound.left_out, 0);
  assert_int_equal(with.left_out, 1);
  assert_int_equal(with.part_count, FOILS * BUMPS);
  for (size_t i = 0; i < sound.quantity_count; i++) {
    const fg_lot_quantity *a = &sound.quantities[i], *b = &with.quantities[i];
    assert_int_equal(a->count, b->count);
    if (a->count && !(a->mean == b->mean && a->max == b->max && a->min == b->min))
      fail_msg("%s: mean %.9g became %.9g", a->row->name, a->mean, b->mean);
    if (a->places && a->place[8].mean != b->place[8].mean)
      fail_msg("%s of bump 9: %.9g became %.9g", a->row->name, a->place[8].mean, b->place[8].mean);
  }
  assert_true(sound.correlation.log_slope == with.correlation.log_slope);
  assert_true(sound.correlation.arc_length_sd_pct == with.correlation.arc_length_sd_pct);
  assert_true(sound.stiffness.measured.mean == with.stiffness.measured.mean);
  assert_int_equal(with.bearings[0].clearance.count, 26);
  assert_true(sound.bearings[0].clearance.max_mm == with.bearings[0].clearance.max_mm);
  char *json = text_of(&with, fg_lot_write_json), *page = text_of(&with, fg_lot_write_page);
  assert_has(json, "\"bumps_crushed\": 1");
  assert_has(page, "1 of 54 bumps crushed:");
  free(json);
  free(page);
  fg_lot_analysis_free(&sound);
  fg_lot_analysis_free(&with);
  made_lot_free(&lot);
}

/* Whatever line of the strip the radii are of, the arch bends about the midline: the same foil has
 * the same stiffness by its inner edge, its midline and its outer edge, and the map shifts too. */
static void arches_bend_about_the_midline(void **state) {
  (void)state;
  static const fg_datum datums[] = {FG_DATUM_MID, FG_DATUM_INNER, FG_DATUM_OUTER};
  static const double shift[] = {0, 0.05, -0.05};
  char *map[3];
  for (int i = 0; i < 3; i++) {
    fg_design design;
    fg_lot_analysis analysis;
    fg_design_default(&design);
    design.datum = datums[i];
    fg_arch arch = fg_design_arch(&design, 0.1, 3.32 + shift[i], 63.15);
    assert_near(arch.radius_mm, 3.32, 1e-12);
    assert_near(fg_design_arch(&design, 0.12, 3.32 + 1.2 * shift[i], 63.15).radius_mm, 3.32, 1e-12);
    fg_lot lot = sound_lot(&design); /* the same numbers, of another line */
    assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
    map[i] = map_of(&analysis);
    fg_lot_analysis_free(&analysis);
    made_lot_free(&lot);
  }
  assert_string_not_equal(map[0], map[1]);
  assert_string_not_equal(map[0], map[2]);
  for (int i = 0; i < 3; i++)
    free(map[i]);
}

/* Strips of 0.105 mm where the design says 0.1: clearances are 5 um smaller, stiffness goes with
 * t³, and both are said beside what the design's thickness would give. */
static void strips_are_as_thick_as_they_are(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis thin, thick;
  fg_design_default(&design);
  fg_lot lot = sound_lot(&design), other = made_lot(&design, FOILS, BUMPS, "", NULL);
  for (size_t i = 0; i < FOILS; i++) {
    other.records[i].foils[0].thickness.mm = 0.105;
    other.records[i].foils[0].thickness.u_mm = 0.0002;
    for (size_t k = 0; k < BUMPS; k++) {
      const fg_bump *bump = &lot.records[i].foils[0].bumps[k];
      made_bump(&other, i, k, bump->radius_mm, bump->bump_angle_deg);
    }
  }
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &thin));
  assert_ok(&test_context, fg_lot_analyse(&test_context, &other, &thick));
  assert_false(thin.thickness.differs);
  assert_true(thick.thickness.differs);
  assert_near(thick.bearings[0].clearance.min_mm, thin.bearings[0].clearance.min_mm - 0.005, 1e-9);
  double slope = thick.stiffness.sensitivity.thickness;
  assert_near(thick.stiffness.measured.mean / thin.stiffness.measured.mean, pow(1.05, slope), 2e-3);
  assert_near(thick.stiffness.at_design_thickness.mean, thin.stiffness.measured.mean, 1e-9);
  assert_near(thick.stiffness.u_by_thickness / thick.stiffness.measured.mean,
              slope * 0.0002 / 0.105, 1e-9);
  assert_true(fabs(slope - 3) < 0.1);
  char *json = text_of(&thick, fg_lot_write_json), *page = text_of(&thick, fg_lot_write_page);
  char *plain = text_of(&thin, fg_lot_write_page);
  assert_has(json, "\"normalised_at_design_thickness\"");
  assert_has(page, "0.105 ± 0.0004 mm and not 0.1 as the design says");
  assert_has(page, "clearances would be 5 µm larger");
  assert_has(page, "strips as thick as designed</td>");
  assert_has_not(plain, "as the design says");
  free(json);
  free(page);
  free(plain);
  fg_lot_analysis_free(&thin);
  fg_lot_analysis_free(&thick);
  made_lot_free(&lot);
  made_lot_free(&other);
}

static void sinusoidal_foils_have_their_reserve(void **state) {
  (void)state;
  for (int kind = FG_FOIL_CLASSICAL; kind <= FG_FOIL_SINUSOIDAL; kind++) {
    fg_design design;
    fg_lot_analysis analysis;
    fg_design_default(&design);
    fg_lot lot = sound_lot(&design);
    lot.settings.design.kind = (fg_foil_kind)kind;
    assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
    char *json = text_of(&analysis, fg_lot_write_json),
         *page = text_of(&analysis, fg_lot_write_page);
    bool said = kind == FG_FOIL_SINUSOIDAL;
    assert_int_equal(strstr(json, "long fillets of these sinusoidal foils") != NULL, said);
    assert_int_equal(strstr(page, "long fillets of these sinusoidal foils") != NULL, said);
    free(json);
    free(page);
    fg_lot_analysis_free(&analysis);
    made_lot_free(&lot);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(crushed_bumps_are_in_no_statistics),
      cmocka_unit_test(arches_bend_about_the_midline),
      cmocka_unit_test(strips_are_as_thick_as_they_are),
      cmocka_unit_test(sinusoidal_foils_have_their_reserve),
  };
  return cmocka_run_group_tests_name("statistics of a lot", tests, NULL, NULL);
}
