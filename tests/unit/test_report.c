/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports of a measurement made of formulas: written values are the measured ones. */
#include "core/json_writer.h"
#include "foilgauge/words.h"
#include "quantity/quantity_rows.h"
#include "support/report_fixture.h"
#include "support/test.h"

static void json_holds_every_field(void **state) {
  fixture *all = *state;
  const fg_foil *foil = &all->measurement.foils[0];
  cJSON *json = json_of(&all->report);
  same_fields(first_foil(json), FG_QUANTITY_OF_FOIL, foil);
  const cJSON *bumps = member(first_foil(json), "bumps");
  assert_int_equal(cJSON_GetArraySize(bumps), SYNTHETIC_BUMPS);
  for (int i = 0; i < SYNTHETIC_BUMPS; i++)
    same_fields(cJSON_GetArrayItem(bumps, i), FG_QUANTITY_OF_BUMP, &foil->bumps[i]);
  cJSON_Delete(json);
}

/* The names that users write, spelt out: the table must not drift from them. */
static void json_has_the_agreed_names(void **state) {
  fixture *all = *state;
  static const char *const bump_names[] = {"radius_mm",
                                           "centre_mm",
                                           "centre_to_centre_mm",
                                           "bump_angle_deg",
                                           "height_mm",
                                           "clearance_mm",
                                           "clearance_error",
                                           "height_fitted_mm",
                                           "clearance_fitted_mm",
                                           "intersection_angle_deg",
                                           "height_model_mm",
                                           "radius_error_pct",
                                           "rms_um",
                                           "bump_angle_error_pct",
                                           "points",
                                           "bump_angle_model_deg"};
  static const char *const overall_names[] = {"radius_mm", "u_radius_mm", "centre_mm", "rms_um",
                                              "springback_error_pct"};
  static const char *const foil_names[] = {"thickness_mm", "orientation", "flags", "bumps"};
  cJSON *json = json_of(&all->report);
  const cJSON *foil = first_foil(json);
  const cJSON *bump = cJSON_GetArrayItem(member(foil, "bumps"), 0);
  assert_string_equal(member(json, "schema")->valuestring, "foilgauge/measure/1");
  for (size_t i = 0; i < sizeof bump_names / sizeof *bump_names; i++)
    member(bump, bump_names[i]);
  for (size_t i = 0; i < sizeof overall_names / sizeof *overall_names; i++)
    member(member(foil, "overall"), overall_names[i]);
  for (size_t i = 0; i < sizeof foil_names / sizeof *foil_names; i++)
    member(foil, foil_names[i]);
  const cJSON *input = cJSON_GetArrayItem(member(json, "inputs"), 0);
  assert_int_equal(strlen(member(input, "sha256")->valuestring), 64);
  same_number(cJSON_GetArrayItem(member(input, "dpi_file"), 0), 4799.9904);
  cJSON_Delete(json);
}

static void unknown_is_null_and_flags_are_words(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  foil->flags = FG_FOIL_NO_LIP | FG_FOIL_GAP;
  foil->bumps[2].radius_mm = foil->bumps[2].u_radius_mm = NAN;
  foil->bumps[2].flags = FG_BUMP_NOT_FITTED;
  all->measurement.file.dpi_file[0] = INFINITY;
  cJSON *json = json_of(&all->report);
  const cJSON *flags = member(first_foil(json), "flags");
  assert_int_equal(cJSON_GetArraySize(flags), 2);
  assert_string_equal(cJSON_GetArrayItem(flags, 0)->valuestring, "no_lip");
  assert_string_equal(cJSON_GetArrayItem(flags, 1)->valuestring, "gap");
  const cJSON *bump = cJSON_GetArrayItem(member(first_foil(json), "bumps"), 2);
  assert_true(cJSON_IsNull(member(bump, "radius_mm")));
  assert_true(cJSON_IsNull(member(bump, "u_radius_mm")));
  assert_string_equal(cJSON_GetArrayItem(member(bump, "flags"), 0)->valuestring, "not_fitted");
  cJSON_Delete(json);
}

static void every_flag_has_its_words(void **state) {
  (void)state;
  unsigned foil = 0, bump = 0, beam = 0;
  for (const fg_flag_words *words = fg_foil_flag_words(); words->name; words++)
    foil |= words->flag;
  for (const fg_flag_words *words = fg_bump_flag_words(); words->name; words++)
    bump |= words->flag;
  assert_int_equal(foil, FG_FOIL_OVERALL_RADIUS_LEFT | FG_FOIL_RADIUS_LEFT | FG_FOIL_HEIGHT_LEFT |
                             FG_FOIL_BEYOND_MODEL_REGION | (2 * FG_FOIL_LAND_DEVIATES - 1));
  for (const fg_flag_words *words = fg_beam_flag_words(); words->name; words++)
    beam |= words->flag;
  assert_int_equal(beam, 2 * FG_BEAM_NARROW_CUT - 1);
  assert_int_equal(bump, FG_BUMP_BEYOND_MODEL_REGION | (2 * FG_BUMP_LOSSY - 1));
}

static void a_table_says_a_name_once(void **state) {
  fixture *all = *state;
  all->report.scan_count = 2;
  char *text = text_of(fg_report_write_table, &all->report);
  assert_has(text, "\nlost.png: not measured: cannot be opened\n");
  free(text);
}

/* It has none by design; what reads the JSON still learns how bumps are numbered. */
static void a_sinusoidal_foil_is_not_warned_of_its_lip(void **state) {
  fixture *all = *state;
  fg_design *design = &all->design;
  all->measurement.foils[0].flags = FG_FOIL_NO_LIP;
  char *warned = text_of(fg_report_write_table, &all->report);
  fg_foil_kind kind = design->kind;
  design->kind = FG_FOIL_SINUSOIDAL;
  char *told = text_of(fg_report_write_table, &all->report);
  char *json = text_of(fg_report_write_json, &all->report);
  design->kind = kind;
  assert_has(warned, "no_lip");
  assert_has_not(told, "no_lip");
  assert_has(json, "no_lip");
  free(warned);
  free(told);
  free(json);
}

static void any_path_gives_valid_json(void **state) {
  fixture *all = *state;
  all->scans[0].path = "tab\there \xC3\xA4 bad\xFF\xC0\xAF\xED\xA0\x80 \"q\\\x7F";
  cJSON *json = json_of(&all->report);
  const cJSON *path = member(cJSON_GetArrayItem(member(json, "inputs"), 0), "path");
  assert_string_equal(path->valuestring,
                      "tab\there \xC3\xA4 bad\\xFF\\xC0\\xAF\\xED\\xA0\\x80 \"q\\\x7F");
  cJSON_Delete(json);
}

static void several_scans_stand_in_scans(void **state) {
  fixture *all = *state;
  all->report.scan_count = 2;
  cJSON *json = json_of(&all->report);
  assert_null(cJSON_GetObjectItem(json, "foils"));
  assert_string_equal(member(json, "verdict")->valuestring, "not_measured");
  const cJSON *scans = member(json, "scans");
  assert_int_equal(cJSON_GetArraySize(scans), 2);
  same_fields(first_foil(cJSON_GetArrayItem(scans, 0)), FG_QUANTITY_OF_FOIL,
              &all->measurement.foils[0]);
  assert_string_equal(member(cJSON_GetArrayItem(scans, 1), "error")->valuestring,
                      "lost.png: cannot be opened");
  cJSON_Delete(json);
}

static void numbers_are_plain(void **state) {
  (void)state;
  static const struct {
    double value;
    const char *text;
  } cases[] = {{20.73, "20.73"},   {-0.0, "0"},     {NAN, "null"},
               {INFINITY, "null"}, {2e-5, "2e-05"}, {1.0 / 3, "0.3333333333"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    char text[32];
    fg_json_format(text, cases[i].value);
    assert_string_equal(text, cases[i].text);
  }
}

static size_t count_of(const char *text, char wanted) {
  size_t count = 0;
  for (; *text; text++)
    count += *text == wanted;
  return count;
}

static void csv_has_a_line_per_bump(void **state) {
  fixture *all = *state;
  char *text = text_of(fg_report_write_csv, &all->report);
  assert_int_equal(count_of(text, '\n'), SYNTHETIC_BUMPS + 1);
  char *second = strchr(text, '\n') + 1;
  second[-1] = '\0';
  *strchr(second, '\n') = '\0';
  const char *quoted = "\"foil, \"\"one\"\" <a&b>.png\",1,1,,3.39288342,0.00021,";
  assert_memory_equal(second, quoted, strlen(quoted));
  assert_int_equal(count_of(text, ','), count_of(second, ',') - 1); /* one is inside the quotes */
  assert_has(text, ",centre_x_mm,centre_y_mm,u_centre_x_mm,u_centre_y_mm,");
  free(text);
}

static void points_hold_both_edges_and_the_midline(void **state) {
  fixture *all = *state;
  char *text = text_of(fg_report_write_points, &all->report);
  assert_int_equal(count_of(text, '\n'), 3 * SYNTHETIC_STATIONS + 1);
  char wanted[200];
  const fg_station *station = &all->measurement.foils[0].strip.stations[3000];
  const fg_station_label *label = &all->measurement.foils[0].labels[3000];
  assert_int_equal(label->kind, FG_ARC_BUMP);
  snprintf(wanted, sizeof wanted, "\n1,1,3000,%.6f,right,%.6f,%.6f,0.1200,bump,5,1,%.4f\n",
           station->s_mm, station->right.x, station->right.y, label->residual_right_um);
  assert_has(text, wanted);
  free(text);
}

static void table_says_what_plus_minus_is(void **state) {
  fixture *all = *state;
  char *text = text_of(fg_report_write_table, &all->report);
  assert_has(text, "overall radius 20.9500 ± 0.0010 mm");
  assert_has(text, "3.39288 0.00042");
  assert_has(text, "C_fit: pressed into the sleeve");
  assert_has(text, "± is U = 2 u");
  free(text);
}

static void decimals_follow_the_uncertainty(void **state) {
  (void)state;
  const fg_quantity *radius = fg_quantity_find(FG_QUANTITY_OF_BUMP, "radius_mm");
  assert_int_equal(fg_report_decimals(radius, 0.0002), 5); /* U = 0.00040 */
  assert_int_equal(fg_report_decimals(radius, 0.5), 4);    /* never fewer than its own */
  assert_int_equal(fg_report_decimals(radius, NAN), 4);
  assert_int_equal(fg_report_decimals(radius, 0.00001), 5);  /* U = 0.00002 */
  assert_int_equal(fg_report_decimals(radius, 0.000001), 6); /* never ± 0 */
  assert_int_equal(fg_report_decimals(radius, 1e-12), 7);    /* never digits without end */
}

static void a_full_disk_is_an_error(void **state) {
  fixture *all = *state;
  report_writer *const writers[] = {fg_report_write_json, fg_report_write_csv,
                                    fg_report_write_points, fg_report_write_table};
  for (size_t i = 0; i < sizeof writers / sizeof *writers; i++) {
    in_row("writers[%zu]", i);
    fg_context ctx = {0};
    FILE *full = fopen("/dev/full", "w");
    if (!full) skip();
    assert_status(NULL, writers[i](&ctx, &all->report, full), FG_ERR_IO);
    assert_true(ctx.message[0] != '\0');
    fclose(full);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      REPORT_TEST(json_holds_every_field),
      REPORT_TEST(json_has_the_agreed_names),
      REPORT_TEST(unknown_is_null_and_flags_are_words),
      REPORT_TEST(every_flag_has_its_words),
      REPORT_TEST(any_path_gives_valid_json),
      REPORT_TEST(a_table_says_a_name_once),
      REPORT_TEST(a_sinusoidal_foil_is_not_warned_of_its_lip),
      REPORT_TEST(several_scans_stand_in_scans),
      REPORT_TEST(numbers_are_plain),
      REPORT_TEST(csv_has_a_line_per_bump),
      REPORT_TEST(points_hold_both_edges_and_the_midline),
      REPORT_TEST(table_says_what_plus_minus_is),
      REPORT_TEST(decimals_follow_the_uncertainty),
      REPORT_TEST(a_full_disk_is_an_error),
  };
  return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
