/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trends and the scanner's health, from rows of a database to the words on the page. */
#include "station/check.h"
#include "station/scan_command.h"
#include "support/trend_station.h"

#define HOUR_MS INT64_C(3600000)

static size_t count(const char *text, const char *part) {
  size_t found = 0;
  for (const char *at = text; (at = strstr(at, part)); at++)
    found++;
  return found;
}

static void a_stable_process_has_a_capability(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 40, "L1", 3.4);
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "<h1>bump radius</h1>");
  assert_has(page, "40 foils, from ");
  assert_has(page, "<p class=\"next calm\">None: these foils vary as they would by chance alone.");
  assert_has(page, "<dt>Cpk</dt>");
  assert_has(page, "of 120 values of 40 foils against 3.3 to 3.5");
  assert_has(page, ">max 3.500</text>");
  assert_has(page, ">+3σ ");
  assert_int_equal(count(page, "class=\"zone\""), 4); /* beyond either limit, wide and narrow */
}

static void a_signal_that_chance_explains_withholds_nothing(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 60, "L1", 3.4);
  run_sql(f, "UPDATE measured SET value = value + 3.4205 - (SELECT avg(value) FROM measured"
             " WHERE foil = 30) WHERE foil = 30");
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "<b>one point beyond three sigma</b>");
  assert_has(page, "<dt>Cpk</dt>");
  assert_has(page, "Stated although 1 point has a signal: chance explains up to ");
  run_sql(f, "UPDATE measured SET value = value + 0.03 WHERE foil = 30");
  page = get(f, "/trends", "", 200);
  assert_has(page, "the chart is not stable: 1 point lies farther out than chance explains");
  assert_has_not(page, "<dt>Cpk</dt>");
}

/* The lower end of Ppk's interval. */
static double low_of_ppk(const char *page) {
  const char *at = strstr(page, "<dt>Ppk</dt>");
  assert_non_null(at);
  at = strstr(at, "<small>");
  assert_non_null(at);
  return strtod(at + strlen("<small>"), NULL);
}

static void the_error_that_all_foils_share_is_in_the_interval(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 40, "L1", 3.4);
  double narrow = low_of_ppk(get(f, "/trends", "", 200));
  run_sql(f, "UPDATE measured SET u = 0.05");
  double wide = low_of_ppk(get(f, "/trends", "", 200));
  assert_true(narrow > 1 && wide < narrow - 1);
  f->settings.lot.design.calibration.not_needed[0] = '\0';
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "Ppk and Cpk have no interval: nothing is known of the scanner's scale");
  assert_has_not(page, "nan");
}

static void too_few_foils_have_no_capability(void **state) {
  fixture *f = *state;
  assert_has(get(f, "/trends", "", 200), "0 foils with this quantity: a chart needs two");
  add_foils(f, 1, 20, "L1", 3.4);
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "20 foils: too few to say that the process is stable; it takes 25.");
  assert_has_not(page, "<dt>Cpk</dt>");
}

static void a_shift_is_told_since_its_first_foil(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 40, "L1", 3.4);
  for (int id = 41; id <= 52; id++)
    add_foil(f, id, "L1", "A", 3.43, 0);
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "<b>nine in a row on one side of the centre</b>: since <a href=\"/foil?id=41\">"
                   "S0041</a> (no. 41)</li>");
  assert_has(page, "Not stated: the chart is not stable: 12 points lie farther out");
  assert_has_not(page, "<dt>Cpk</dt>");
  for (int id = 53; id <= 80; id++)
    add_foil(f, id, "L1", "A", 3.4, 0.001);
  assert_has(
      get(f, "/trends", "", 200),
      "<b>nine in a row on one side of the centre</b>: from <a href=\"/foil?id=41\">S0041</a>"
      " (no. 41) to <a href=\"/foil?id=52\">S0052</a> (no. 52)</li>");
}

static void another_setup_is_marked_where_it_began(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 40, "L1", 3.4);
  assert_has_not(get(f, "/trends", "", 200), "class=\"change\"");
  run_sql(f, "INSERT INTO setups SELECT 2, 'y', 'v', recipe, NULL, 'm', 2 FROM setups;"
             "UPDATE scans SET setup = 2 WHERE id >= 31");
  const char *page = get(f, "/trends", "", 200);
  assert_int_equal(count(page, "class=\"change\""), 2); /* wide and narrow */
  assert_has(page, "measured in another way from there on: by another model of the scanner since "
                   "<a href=\"/foil?id=31\">S0031</a> (no. 31).");
  assert_has_not(get(f, "/trends", "from=31&to=40", 200), "class=\"change\"");
  assert_has_not(get(f, "/trends", "by=lots", 200), "class=\"change\"");
}

/* A part of another recipe lies between foils of the first: its tolerances are others. */
static void capability_is_of_foils_of_one_recipe(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 60, "L1", 3.4);
  run_sql(f, "UPDATE foils SET lot = 'L2' WHERE id %% 3 = 0");
  assert_has(get(f, "/trends", "", 200), "<dt>Cpk</dt>");
  run_sql(f,
          "INSERT INTO setups SELECT 2, 'y', 'v', replace(recipe, '3.3,', '3.25,'), NULL, NULL, 2"
          " FROM setups;"
          "UPDATE scans SET setup = 2 WHERE id %% 3 = 0");
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "Not stated: these foils were measured by more than one recipe");
  assert_has_not(page, "<dt>Cpk</dt>");
  assert_has(page, "Red: beyond the tolerance of the newest foil's recipe");
  page = get(f, "/trends", "lot=L1", 200);
  assert_has(page, "foils against 3.3 to 3.5.");
  assert_has(page, "Red: beyond the tolerance of the design");
  add_foils(f, 61, 120, "L3", 3.4);
  run_sql(f, "UPDATE scans SET setup = 2 WHERE id > 60");
  assert_has(get(f, "/trends", "lot=L3", 200), "foils against 3.25 to 3.5.");
}

static void a_crushed_bump_is_in_no_chart(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 30, "L1", 3.4);
  run_sql(f, "UPDATE bumps SET flags = 'poor_fit crushed' WHERE foil = 7 AND number = 2;"
             "UPDATE measured SET value = 9 WHERE foil = 7 AND bump = 2");
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "of 89 values of 30 foils");
  assert_has_not(page, "one point beyond");
  run_sql(f, "UPDATE bumps SET flags = 'poor_fit' WHERE foil = 7 AND number = 2");
  assert_has(get(f, "/trends", "", 200), "<b>one point beyond three sigma</b>: <a "
                                         "href=\"/foil?id=7\">S0007</a> (no. 7)</li>");
}

static void zooming_moves_no_limit_unless_asked_to(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 100, "L1", 3.4);
  const char *page = get(f, "/trends", "newest=all&from=31&to=45", 200);
  assert_has(page, "data-from=\"31\" data-to=\"45\"");
  assert_has(page, "100 foils, from ");
  assert_int_equal(count(page, "<circle"), 2 * 15);
  assert_has(page, "from=24&amp;to=38\">« earlier</a>");
  page = get(f, "/trends", "newest=all&from=31&to=45&limits=drawn", 200);
  assert_has(page, "15 foils, from <a href=\"/foil?id=31\">S0031</a> (no. 31)");
  page = get(f, "/trends", "newest=50", 200);
  assert_has(page, "50 foils, from <a href=\"/foil?id=51\">S0051</a> (no. 51)");
  page = get(f, "/trends", "newest=50&from=99999999999999999999&to=-3", 200);
  assert_has(page, "data-from=\"51\" data-to=\"100\"");
  page = get(f, "/trends", "from=90&to=20", 200);
  assert_has(page, "data-from=\"20\" data-to=\"20\"");
}

static void many_points_are_thinned_out_and_none_that_stands_out(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 1200, "L1", 3.4);
  size_t size = strlen(get(f, "/trends", "newest=all", 200));
  run_sql(f, "UPDATE measured SET value = 3.47 WHERE foil = 602");
  const char *page = get(f, "/trends", "newest=all", 200);
  assert_has(page, "<b>one point beyond three sigma</b>: <a href=\"/foil?id=602\">");
  /* The course of the chart goes through the signal. */
  double x, y;
  char corner[64];
  const char *signal = strstr(page, "<circle class=\"signal\"");
  assert_non_null(signal);
  assert_int_equal(sscanf(signal, "<circle class=\"signal\" cx=\"%lf\" cy=\"%lf\"", &x, &y), 2);
  snprintf(corner, sizeof corner, "L%.1f %.1f", x, y);
  assert_has(page, corner);
  assert_true(size < 60000);
}

static void lots_dies_and_single_bumps_are_chosen(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 20, "L1", 3.4);
  add_foils(f, 21, 40, "L2", 3.4);
  add_foils(f, 41, 60, "L0", 3.4); /* lots are in the order of their foils */
  add_foils(f, 61, 80, "L4", 3.4);
  add_foils(f, 81, 100, "L3", 3.408);
  const char *page = get(f, "/trends", "by=lots", 200);
  assert_has(page, "5 lots, from L1 (no. 1)");
  assert_has(page, "<b>one point beyond three sigma</b>: L3 (no. 5)");
  assert_has(page, "Not stated: it is a matter of single foils");
  assert_has(get(f, "/trends", "lot=L2", 200), "20 foils, from <a href=\"/foil?id=21\">S0021</a> "
                                               "(no. 1)");
  assert_has(get(f, "/trends", "die=A&lot=L3", 200), "10 foils, from <a href=\"/foil?id=81\">");
  assert_has(get(f, "/trends", "q=bump:radius_mm&bump=2&lot=L1", 200), "<h1>Bump 2: bump radius");
  assert_has(get(f, "/trends", "q=foil:thickness_mm", 200), "0 foils with this quantity");
  get(f, "/trends", "q=bump:nothing", 404);
  get(f, "/trends", "q=bump:centre_mm", 404);
}

/* Scans the first foils four times more. */
static void scan_again(fixture *f, int last) {
  for (int again = 1000; again <= 4000; again += 1000)
    run_sql(f,
            "INSERT INTO scans (id, sha256, setup, path, source, at, verdict) SELECT id + %1$d,"
            " sha256 || '-%1$d', setup, path, source, at, verdict FROM scans WHERE id <= %2$d;"
            "INSERT INTO foils SELECT id + %1$d, scan + %1$d, number, serial, lot, die, operator,"
            " verdict, reasons, coil, oven, scanner, order_id FROM foils WHERE id <= %2$d;"
            "INSERT INTO measured SELECT quantity, foil + %1$d, bump, value, u FROM measured"
            " WHERE foil <= %2$d",
            again, last);
}

/* Scans of one foil say little of how foils vary, and do not narrow the limits of lots. */
static void a_foil_counts_once_in_its_lot(void **state) {
  fixture *f = *state;
  char once[80];
  for (int lot = 0; lot < 5; lot++)
    add_foils(f, 1 + 4 * lot, 4 + 4 * lot, (const char *[]){"L1", "L2", "L3", "L4", "L5"}[lot],
              3.4);
  const char *page = get(f, "/trends", "by=lots", 200), *sigma = strstr(page, "(σ ");
  assert_non_null(sigma);
  assert_has(sigma, " mm).");
  snprintf(once, sizeof once, "%.*s", (int)strcspn(sigma, ")"), sigma);
  scan_again(f, 20);
  page = get(f, "/trends", "by=lots", 200);
  assert_has(page, once);
  assert_has(page, "5 lots, from L1 (no. 1)");
}

/* The newest scan counts, of those that measured the foil. */
static void a_foil_counts_once_in_its_chart(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 30, "L1", 3.4);
  scan_again(f, 10);
  const char *page = get(f, "/trends", "", 200);
  assert_has(page, "30 foils, from <a href=\"/foil?id=11\">S0011</a> (no. 1)");
  assert_has(page, "<a href=\"/foil?id=4010\">S0010</a> (no. 30)");
  run_sql(f, "UPDATE foils SET verdict = 'not_measured' WHERE id = 4010;"
             "DELETE FROM measured WHERE foil = 4010");
  assert_has(get(f, "/trends", "", 200), "30 foils, from ");
  run_sql(f, "UPDATE foils SET serial = '' WHERE id > 1000");
  assert_has(get(f, "/trends", "", 200), "69 foils, from ");
}

static void names_cannot_write_the_page(void **state) {
  fixture *f = *state;
  add_foils(f, 1, 3, "<script>&\"", 3.4);
  const char *page = get(f, "/trends", "by=lots&lot=%3Cscript%3E%26%22", 200);
  assert_has_not(page, "<script>");
  page = get(f, "/trends", "lot=%3Cscript%3E%26%22&die=%22%3E%3Cb%3E", 200);
  assert_has_not(page, "<script>");
  assert_has_not(page, "\"><b>");
  page = get(f, "/trends", "lot=%3Cscript%3E%26%22", 200);
  assert_has(page, "lot=%3Cscript%3E%26%22");
}

static void ask_for_checks(fixture *f, bool withhold) {
  strcpy(f->settings.check.design, "plate.json");
  f->settings.check.every_h = 12;
  f->settings.check.scale_max_ppm = 300;
  f->settings.check.withhold = withhold;
}

static void add_check(fixture *f, int number, int64_t at, double scale_y, const char *verdict) {
  run_sql(f,
          "INSERT INTO checks (at, path, sha256, discs, scale_x, u_scale_x, scale_y, u_scale_y,"
          " shear, u_shear, verdict, words) VALUES (%lld, 'check_%d.png', '%d', 4, 4e-5, 5e-6,"
          " %.9g, 1e-5, 2e-5, 1e-5, '%s', 'scanner <in> order')",
          (long long)at, number, number, scale_y, verdict);
}

static void a_check_is_due_and_done_and_due_again(void **state) {
  fixture *f = *state;
  char why[400];
  assert_has(get(f, "/scanner", "", 200), "The recipe asks for no checks.");
  assert_has_not(get(f, "/", "", 200), "class=\"banner\"");
  ask_for_checks(f, true);
  assert_has(get(f, "/scanner", "", 200), "<b>NOT CHECKED</b>");
  assert_has_not(get(f, "/scanner", "", 200), "Scan the plate</button>");
  strcpy(f->settings.scan_command, "true {file}");
  f->station.check_design_known = true;
  assert_has(get(f, "/scanner", "", 200), "Scan the plate</button>");
  assert_has(get(f, "/", "", 200), "The scanner was never checked.</b> No foil gets a verdict");
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  add_check(f, 1, fg_station_now() - HOUR_MS, 1e-4, "pass");
  assert_has(get(f, "/scanner", "", 200), "<b>IN ORDER</b>");
  assert_has_not(get(f, "/", "", 200), "class=\"banner\"");
  assert_false(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  run_sql(f, "UPDATE checks SET at = %lld", (long long)(fg_station_now() - 13 * HOUR_MS));
  assert_has(get(f, "/scanner", "", 200), "<b>CHECK DUE</b>");
  for (int i = 0; i < 5; i++) {
    static const char *const paths[] = {"/", "/history", "/trends", "/scanner", "/lots"};
    assert_has(get(f, paths[i], "", 200), "<b>The scanner's check is due.</b>");
  }
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  assert_has(why, "scan the plate, and then this foil again");
  f->settings.check.withhold = false;
  assert_false(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
}

static void a_failed_check_and_a_clock_set_back_withhold(void **state) {
  fixture *f = *state;
  char why[400];
  ask_for_checks(f, true);
  add_check(f, 1, fg_station_now() - 2 * HOUR_MS, 1e-4, "pass");
  add_check(f, 2, fg_station_now() - HOUR_MS, 4e-4, "fail");
  const char *page = get(f, "/scanner", "", 200);
  assert_has(page, "<b>OUT OF ORDER</b>");
  assert_has(page, "<dd>+400 ± 20 ppm<small>allowed ± 300 ppm</small>");
  assert_has(page, "<small>+300 ± 28 since the first that is drawn</small>");
  assert_int_equal(count(page, "class=\"signal\""), 3);
  assert_has_not(page, "<in>");
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  assert_has(why, "The last check of the scanner failed");
  add_check(f, 3, fg_station_now() + 48 * HOUR_MS, 1e-4, "pass");
  page = get(f, "/scanner", "", 200);
  assert_has(page, "<b>CHECK DUE</b>");
  assert_has(page, "it was set back, so nobody can say how old that check is");
  assert_has(get(f, "/", "", 200), "The clock was set back");
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  assert_has(why, "The clock was set back");
}

static void set_state(fixture *f, int check, double level_um, double blur_um) {
  run_sql(
      f,
      "UPDATE checks SET dpi = 2400 WHERE id = %d;"
      "INSERT INTO check_values VALUES (%d, 'level_um', %.9g, 0.02), (%d, 'blur_um', %.9g, 0.1)",
      check, check, level_um, check, blur_um);
}

static void press(fixture *f, const char *path, const char *fields, int code) {
  fg_request request = {.post = true, .path = path, .last_event = -1};
  fg_answer answer = {0};
  char whole[200];
  strcpy(f->station.csrf_token, "0123456789abcdef0123456789abcdef");
  snprintf(whole, sizeof whole, "form=%s&%s", f->station.csrf_token, fields);
  request.host = f->station.host;
  assert_true(fg_request_read_fields(&request, whole, strlen(whole)));
  fg_station_answer(&f->station, &request, &answer);
  assert_int_equal(answer.code, code);
  free(answer.body);
}

static void a_changed_picture_withholds_until_it_is_accepted(void **state) {
  fixture *f = *state;
  char why[400];
  ask_for_checks(f, true);
  add_check(f, 1, fg_station_now() - 2 * HOUR_MS, 1e-4, "pass");
  set_state(f, 1, 0.01, 11.05);
  assert_has(get(f, "/scanner", "", 200), "There is no baseline yet");
  run_sql(f, "UPDATE checks SET baseline = 1");
  const char *page = get(f, "/scanner", "", 200);
  assert_has(page, "Tone, sharpening and blur at 2400 dpi");
  assert_has(page, "This check is the baseline");
  assert_has_not(page, "as the new baseline");
  assert_false(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  add_check(f, 2, fg_station_now() - HOUR_MS, 1e-4, "pass");
  set_state(f, 2, -1.33, 11.1);
  run_sql(f, "UPDATE checks SET changes = 'edges' WHERE id = 2");
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  assert_has(why, "another tone, sharpening or blur than its baseline");
  page = get(f, "/scanner", "", 200);
  assert_has(page, "<b>CHANGED</b>");
  assert_has(page, "<b>−1.34</b></td><td>± 0.25</td><td class=\"words\">tone curve");
  assert_has(page, "<td>+0.05</td><td>± 1.11</td>");
  assert_has(page, "Take this check as the new baseline</button>");
  assert_has(page, "FAILED</span>");
  assert_has(get(f, "/", "", 200),
             "The scanner's tone, sharpening or blur has changed.</b> No foil");
  press(f, "/baseline", "id=1", 404);
  assert_true(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  press(f, "/baseline", "id=2", 303);
  assert_false(
      fg_station_check_withholds(&f->station, &f->station.settings->lot.design, why, sizeof why));
  assert_has(get(f, "/scanner", "", 200), "<b>IN ORDER</b>");
}

/* A scale that is out of order cannot be accepted. */
static void a_failed_check_becomes_no_baseline(void **state) {
  fixture *f = *state;
  ask_for_checks(f, true);
  add_check(f, 1, fg_station_now() - HOUR_MS, 4e-4, "fail");
  set_state(f, 1, 0.01, 11.05);
  run_sql(f, "UPDATE checks SET changes = 'edges'");
  assert_has(get(f, "/scanner", "", 200), "<b>CHANGED</b>");
  assert_has_not(get(f, "/scanner", "", 200), "as the new baseline</button>");
  press(f, "/baseline", "id=1", 404);
}

static void a_scan_of_the_plate_is_told_by_its_name(void **state) {
  (void)state;
  assert_true(fg_station_is_scanned_check("station-check-20261123-001605-310.png"));
  assert_true(fg_station_is_scanned("station-check-20261123-001605-310.png"));
  assert_true(fg_station_is_scanned("station-20261123-001605-310.png"));
  assert_false(fg_station_is_scanned_check("station-20261123-001605-310.png"));
  assert_false(fg_station_is_scanned_check("station-check-x.png"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, start, stop)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_stable_process_has_a_capability),
      TEST(a_signal_that_chance_explains_withholds_nothing),
      TEST(the_error_that_all_foils_share_is_in_the_interval),
      TEST(too_few_foils_have_no_capability),
      TEST(a_shift_is_told_since_its_first_foil),
      TEST(another_setup_is_marked_where_it_began),
      TEST(capability_is_of_foils_of_one_recipe),
      TEST(a_crushed_bump_is_in_no_chart),
      TEST(zooming_moves_no_limit_unless_asked_to),
      TEST(many_points_are_thinned_out_and_none_that_stands_out),
      TEST(lots_dies_and_single_bumps_are_chosen),
      TEST(a_foil_counts_once_in_its_lot),
      TEST(a_foil_counts_once_in_its_chart),
      TEST(names_cannot_write_the_page),
      TEST(a_check_is_due_and_done_and_due_again),
      TEST(a_changed_picture_withholds_until_it_is_accepted),
      TEST(a_failed_check_becomes_no_baseline),
      cmocka_unit_test(a_scan_of_the_plate_is_told_by_its_name),
      TEST(a_failed_check_and_a_clock_set_back_withhold),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
