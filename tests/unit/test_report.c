/* Reports of a measurement made of formulas: what is written is what was measured. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "report/words.h"
#include "quantity/quantity_rows.h"
#include "support/synthetic_foil.h"

typedef struct fixture {
  fg_design design;
  fg_nominal nominal;
  fg_measurement measurement;
  fg_report_scan scans[2];
  fg_report report;
} fixture;

static int set_up(void **state) {
  fixture *all = calloc(1, sizeof *all);
  all->design = synthetic_design();
  all->nominal = synthetic_nominal(&all->design);
  all->measurement = synthetic_measurement(&all->design);
  all->scans[0] = (fg_report_scan){all->measurement.scan, &all->measurement, NULL};
  all->scans[1] = (fg_report_scan){"lost.png", NULL, "lost.png: cannot be opened"};
  all->report = (fg_report){&all->design, &all->nominal, all->scans, 1};
  *state = all;
  return 0;
}

static int tear_down(void **state) {
  fixture *all = *state;
  synthetic_free(&all->measurement);
  free(all);
  return 0;
}

typedef fg_status report_writer(fg_context *ctx, const fg_report *report, FILE *out);

/* What a writer writes, as text; the caller frees it. */
static char *text_of(report_writer *write, const fg_report *report) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  assert_int_equal(write(&ctx, report, out), FG_OK);
  fclose(out);
  return text;
}

static cJSON *json_of(const fg_report *report) {
  char *text = text_of(fg_report_write_json, report);
  cJSON *json = cJSON_Parse(text);
  assert_non_null(json);
  free(text);
  return json;
}

static const cJSON *member(const cJSON *object, const char *name) {
  const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!found) print_error("no member '%s'\n", name);
  assert_non_null(found);
  return found;
}

static const cJSON *first_foil(const cJSON *json) {
  return cJSON_GetArrayItem(member(json, "foils"), 0);
}

static void same_number(const cJSON *json, double value) {
  if (isnan(value)) {
    assert_true(cJSON_IsNull(json));
    return;
  }
  assert_true(cJSON_IsNumber(json));
  assert_true(fabs(json->valuedouble - value) <= 1e-9 * fabs(value));
}

static void same_field(const cJSON *object, const fg_quantity *field, const void *values) {
  char u_name[64];
  const char *dot = strchr(field->name, '.'), *name = dot ? dot + 1 : field->name;
  if (dot) {
    char group[64];
    snprintf(group, sizeof group, "%.*s", (int)(dot - field->name), field->name);
    object = member(object, group);
  }
  snprintf(u_name, sizeof u_name, "u_%s", name);
  if (field->kind == FG_QUANTITY_PAIR) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    fg_quantity_numbers(field, values, numbers);
    for (int i = 0; i < 2; i++) {
      same_number(cJSON_GetArrayItem(member(object, name), i), numbers[i]);
      same_number(cJSON_GetArrayItem(member(object, u_name), i), numbers[2 + i]);
    }
    return;
  }
  same_number(member(object, name), fg_quantity_value(field, values));
  if (field->u_offset != FG_NO_UNCERTAINTY)
    same_number(member(object, u_name), fg_quantity_uncertainty(field, values));
}

static void same_fields(const cJSON *object, fg_quantity_owner owner, const void *values) {
  size_t count;
  const fg_quantity *fields = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++)
    same_field(object, &fields[i], values);
}

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
  all->measurement.dpi_file[0] = INFINITY;
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
  unsigned foil = 0, bump = 0;
  for (const fg_flag_words *words = fg_foil_flag_words(); words->name; words++)
    foil |= words->flag;
  for (const fg_flag_words *words = fg_bump_flag_words(); words->name; words++)
    bump |= words->flag;
  assert_int_equal(foil, FG_FOIL_BEYOND_MODEL_REGION | (2 * FG_FOIL_UNEQUAL_RESOLUTION - 1));
  assert_int_equal(bump, FG_BUMP_BEYOND_MODEL_REGION | (2 * FG_BUMP_TOUCHES_OTHER - 1));
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
    char text[32];
    fg_json_format(text, cases[i].value);
    assert_string_equal(text, cases[i].text);
  }
}

static void verdict_considers_the_uncertainty(void **state) {
  (void)state;
  const fg_tolerance both = {"x", 1.0, 2.0}, upper = {"x", -INFINITY, 2.0};
  static const struct {
    double value, u;
    fg_verdict verdict, with_upper;
  } cases[] = {
      {1.5, 0.2, FG_VERDICT_PASS, FG_VERDICT_PASS},
      {1.5, 0.3, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {1.9, 0.06, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {2.1, 0.06, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {2.1, 0.04, FG_VERDICT_FAIL, FG_VERDICT_FAIL},
      {0.9, 0.04, FG_VERDICT_FAIL, FG_VERDICT_PASS},
      {2.0, NAN, FG_VERDICT_PASS, FG_VERDICT_PASS},
      {2.0001, NAN, FG_VERDICT_FAIL, FG_VERDICT_FAIL},
      {NAN, 0.1, FG_VERDICT_NOT_MEASURED, FG_VERDICT_NOT_MEASURED},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    assert_int_equal(fg_judge_value(&both, cases[i].value, cases[i].u), cases[i].verdict);
    assert_int_equal(fg_judge_value(&upper, cases[i].value, cases[i].u), cases[i].with_upper);
  }
}

static fg_report_outcome outcome_of(const fixture *all) {
  fg_context ctx = {0};
  fg_report_outcome outcome;
  assert_int_equal(fg_report_judge(&ctx, &all->report, &outcome), FG_OK);
  return outcome;
}

static void a_bump_beyond_its_limit_is_flagged(void **state) {
  fixture *all = *state;
  const fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "radius_error_pct", -INFINITY, 2.0); /* bump 1: 2.195 */
  synthetic_tolerance(&all->design, "overall.radius_mm", 20.9, 21.0);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), FG_BUMP_OUT_OF_TOLERANCE);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[1]), 0);
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.exceeded, 1);
  assert_int_equal(outcome.not_measured, 0);
  assert_int_equal(outcome.verdict, FG_VERDICT_FAIL);
  assert_int_equal(fg_outcome_exit_code(&outcome), 1);

  all->design.tolerances[0].upper = 2.5;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_PASS);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), 0);
  all->design.tolerances[1].lower = 20.96;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_FAIL);
}

/* Beyond its limit, but within U: neither exceeded nor passed, wherever it is told. */
static void a_value_within_its_uncertainty_is_not_exceeded(void **state) {
  fixture *all = *state;
  const fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "radius_error_pct", -INFINITY, 2.19); /* 2.195 ± 0.013 */
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.exceeded, 0);
  assert_int_equal(outcome.undecided, 1);
  assert_int_equal(fg_outcome_exit_code(&outcome), 3);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), 0);
  cJSON *json = json_of(&all->report);
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  const cJSON *first = cJSON_GetArrayItem(member(first_foil(json), "judgements"), 0);
  assert_true(cJSON_IsFalse(member(first, "exceeded")));
  assert_string_equal(member(first, "verdict")->valuestring, "cannot_tell");
  cJSON_Delete(json);
  char *table = text_of(fg_report_write_table, &all->report);
  assert_non_null(strstr(table, "CANNOT TELL: a limit lies within ± of 1 value(s)"));
  assert_null(strstr(table, "out_of_tolerance"));
  free(table);
}

static void lose_bump(fg_foil *foil, size_t index) {
  foil->bump_count--;
  memmove(&foil->bumps[index], &foil->bumps[index + 1],
          (foil->bump_count - index) * sizeof *foil->bumps);
}

static void a_missing_bump_rejects_the_foil(void **state) {
  fixture *all = *state;
  fg_context ctx = {0};
  fg_foil *foil = &all->measurement.foils[0];
  fg_decision decision;
  char words[200];
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  lose_bump(foil, 3); /* number 4 */
  assert_int_equal(fg_foil_decide(&ctx, &all->design, foil, &decision), FG_OK);
  assert_int_equal(decision.count, 9);
  for (size_t i = 0; i < decision.count; i++) {
    assert_int_equal(decision.judgements[i].verdict, i == 3 ? FG_VERDICT_FAIL : FG_VERDICT_PASS);
    assert_int_equal(decision.judgements[i].missing, i == 3);
  }
  assert_int_equal(decision.outcome.verdict, FG_VERDICT_FAIL);
  assert_int_equal(decision.outcome.rejected, 1);
  assert_int_equal(decision.outcome.exceeded, 0);
  assert_int_equal(fg_outcome_exit_code(&decision.outcome), 1);
  fg_decision_free(&decision);
  assert_true(fg_foil_defect(&all->design, foil, words, sizeof words));
  assert_string_equal(words, "bump 4 is missing (8 found, the design has 9)");
}

/* Without tolerances nothing is judged but what is seen to be missing. */
static void other_counts_without_tolerances_are_a_flag(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  lose_bump(foil, 8);
  foil->flags = FG_FOIL_BUMP_COUNT;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_NONE);
  lose_bump(foil, 4);
  foil->flags |= FG_FOIL_MISSING_BUMP;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_FAIL);
}

/* A border may hide bumps behind the last one that was found. */
static void what_the_border_hides_is_not_measured(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  lose_bump(foil, 8);
  foil->flags = FG_FOIL_BUMP_COUNT | FG_FOIL_TOUCHES_BORDER;
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.verdict, FG_VERDICT_NOT_MEASURED);
  assert_int_equal(fg_outcome_exit_code(&outcome), 2);
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  assert_int_equal(outcome_of(all).not_measured, 1);
  assert_int_equal(outcome_of(all).rejected, 0);
}

/* What was not measured is null, and never within tolerance. */
static void a_foil_that_was_given_up_has_no_values(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  foil->bump_count = 0;
  fg_foil_give_up(foil, "no arc was found");
  assert_false(fg_foil_is_measured(foil));
  cJSON *json = json_of(&all->report);
  const cJSON *overall = member(first_foil(json), "overall");
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  assert_true(cJSON_IsNull(member(overall, "radius_mm")));
  assert_true(cJSON_IsNull(member(overall, "u_radius_mm")));
  assert_true(cJSON_IsNull(member(overall, "rms_um")));
  assert_true(cJSON_IsNull(member(first_foil(json), "thickness_mm")));
  assert_true(cJSON_IsNull(member(first_foil(json), "orientation")));
  cJSON_Delete(json);
  char *csv = text_of(fg_report_write_csv, &all->report);
  assert_non_null(strstr(csv, "\",1,,not_measured,,,,"));
  free(csv);
}

/* Its values stand and are not judged. */
static void a_part_of_another_design_passes_nothing(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  foil->flags = FG_FOIL_NOT_THIS_DESIGN;
  snprintf(foil->error, sizeof foil->error, "47 bumps where the design has 9");
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.verdict, FG_VERDICT_NOT_MEASURED);
  assert_int_equal(fg_bump_verdict(&all->design, foil, foil->bumps), FG_VERDICT_NOT_MEASURED);
  cJSON *json = json_of(&all->report);
  same_fields(first_foil(json), FG_QUANTITY_OF_FOIL, foil);
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  assert_null(cJSON_GetObjectItem(first_foil(json), "judgements"));
  cJSON_Delete(json);
  char *table = text_of(fg_report_write_table, &all->report);
  assert_non_null(strstr(table, "NOT MEASURED: 47 bumps where the design has 9"));
  free(table);
}

static void an_unknown_tolerance_is_refused(void **state) {
  fixture *all = *state;
  fg_context ctx = {0};
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  assert_int_equal(fg_report_check_tolerances(&ctx, &all->design), FG_OK);
  synthetic_tolerance(&all->design, "hight_mm", 0, 1);
  assert_int_equal(fg_report_check_tolerances(&ctx, &all->design), FG_ERR_DATA);
  assert_non_null(strstr(ctx.message, "tolerances.hight_mm"));
  assert_non_null(strstr(ctx.message, "height_mm,"));
  all->design.form = FG_FORM_DISCS;
  all->design.tolerance_count = 1;
  assert_int_equal(fg_report_check_tolerances(&ctx, &all->design), FG_ERR_DATA);
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
  assert_non_null(strstr(text, ",centre_x_mm,centre_y_mm,u_centre_x_mm,u_centre_y_mm,"));
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
  assert_non_null(strstr(text, wanted));
  free(text);
}

static void table_says_what_plus_minus_is(void **state) {
  fixture *all = *state;
  char *text = text_of(fg_report_write_table, &all->report);
  assert_non_null(strstr(text, "overall radius 20.9500 ± 0.0010 mm"));
  assert_non_null(strstr(text, "3.39288 0.00042"));
  assert_non_null(strstr(text, "C_fit: pressed into the sleeve"));
  assert_non_null(strstr(text, "± is U = 2 u"));
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
    fg_context ctx = {0};
    FILE *full = fopen("/dev/full", "w");
    if (!full) skip();
    assert_int_equal(writers[i](&ctx, &all->report, full), FG_ERR_IO);
    assert_true(ctx.message[0] != '\0');
    fclose(full);
  }
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(json_holds_every_field),
      TEST(json_has_the_agreed_names),
      TEST(unknown_is_null_and_flags_are_words),
      TEST(every_flag_has_its_words),
      TEST(any_path_gives_valid_json),
      TEST(several_scans_stand_in_scans),
      TEST(numbers_are_plain),
      TEST(verdict_considers_the_uncertainty),
      TEST(a_bump_beyond_its_limit_is_flagged),
      TEST(a_value_within_its_uncertainty_is_not_exceeded),
      TEST(a_missing_bump_rejects_the_foil),
      TEST(other_counts_without_tolerances_are_a_flag),
      TEST(what_the_border_hides_is_not_measured),
      TEST(a_foil_that_was_given_up_has_no_values),
      TEST(a_part_of_another_design_passes_nothing),
      TEST(an_unknown_tolerance_is_refused),
      TEST(csv_has_a_line_per_bump),
      TEST(points_hold_both_edges_and_the_midline),
      TEST(table_says_what_plus_minus_is),
      TEST(decimals_follow_the_uncertainty),
      TEST(a_full_disk_is_an_error),
  };
  return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
