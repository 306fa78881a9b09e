/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements that pages may make: of a correction that others have overtaken, of a serial number
 * that another foil has, of a scan that came twice, of a file that is on its way, of crushed bumps,
 * and of their own age. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station/news.h"
#include "support/page_names.h"
#include "support/station_fixture.h"
#include "support/test.h"

#define HTML_FORM "form=0123456789abcdef0123456789abcdef&foil=1&"

static station_fixture fixture;
static char *page;
static char location[256];

static void sql(const char *text) {
  fg_context ctx;
  if (fg_sql_run(&ctx, fixture.station.database.writer, text) != FG_OK) fail_msg("%s", ctx.message);
}

/* A second foil, S-2, on a scan of its own that passed. */
static int open_fixture(void **state) {
  fg_context ctx = {0};
  (void)state;
  if (station_fixture_open(&ctx, &fixture, "S-1", "L1_S-1.png") != FG_OK) return -1;
  sql("INSERT INTO scans (id, sha256, setup, path, source, at, verdict, record) VALUES"
      " (2, 'y', 1, 'L1_S-2.png', 'folder', 1000000001000, 'pass', '');"
      "INSERT INTO foils (id, scan, number, serial, lot, die, operator, verdict, reasons) VALUES"
      " (2, 2, 1, 'S-2', 'L1', 'D1', '', 'pass', '');");
  return 0;
}

static int close_fixture(void **state) {
  (void)state;
  station_fixture_close(&fixture);
  free(page);
  page = NULL;
  return 0;
}

static int ask(const char *path, const char *fields, bool post) {
  fg_answer answer;
  fg_request request = {.path = path, .host = "127.0.0.1:8317", .last_event = -1, .post = post};
  assert_true(fg_request_read_fields(&request, fields, strlen(fields)));
  fg_station_answer(&fixture.station, &request, &answer);
  free(page);
  page = calloc(1, answer.size + 1);
  if (answer.body) memcpy(page, answer.body, answer.size);
  page_without_name_marks(page);
  free(answer.body);
  strcpy(location, answer.location);
  return answer.code;
}

static void expect_foil(const char *expected) {
  fg_context ctx;
  fg_query query;
  fg_query_begin(fixture.station.database.reader,
                 "SELECT serial || '|' || lot || '|' || die || '|' || operator FROM foils"
                 " WHERE id = 1",
                 &query);
  assert_true(fg_query_row(&query));
  assert_string_equal(fg_query_get_text(&query, 0), expected);
  assert_ok(&ctx, fg_query_end(&ctx, &query, "a foil"));
}

static void expect_words(const char *words) {
  if (!strstr(page, words)) fail_msg("'%s' is not in: %.6000s", words, page);
}

static void expect_no_words(const char *words) {
  if (strstr(page, words)) fail_msg("'%s' is in: %.6000s", words, page);
}

#define SHOWN "was_serial=S-1&was_lot=L1&was_die=D1&was_operator=&"

static void test_a_stale_html_form_changes_what_was_changed_in_it(void **state) {
  (void)state;
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-1&lot=L1&die=D1&operator=Ada", true),
                   303);
  expect_foil("S-1|L1|D1|Ada");
  /* Loaded before Ada was: its operator is empty. */
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-7&lot=L1&die=D1&operator=", true),
                   303);
  expect_foil("S-7|L1|D1|Ada");
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-7&lot=L2&die=D1&operator=Ada", true),
                   303);
  expect_foil("S-7|L2|D1|Ada");
}

static void test_a_change_over_a_change_is_asked_about(void **state) {
  (void)state;
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "operator=Ada&by=Ada", true), 303);
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-9&operator=Bea", true), 409);
  expect_foil("S-1|L1|D1|Ada");
  expect_words("Somebody else has changed the foil");
  expect_words("<b>operator</b></td><td class=\"text\" data-name=\"now\">Ada</td>"
               "<td data-name=\"by\">Ada, 20");
  expect_words("name=\"was_operator\" value=\"Ada\"");
  expect_words("name=\"operator\" maxlength=\"127\" autocomplete=\"off\" value=\"Bea\"");
  expect_words("required data-focus value=\"S-9\"");
  /* The same by somebody who has seen it. */
  assert_int_equal(
      ask("/correct", HTML_FORM "was_serial=S-1&was_operator=Ada&serial=S-9&operator=Bea", true),
      303);
  expect_foil("S-9|L1|D1|Bea");
  /* Two who want the same are of one mind. */
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "operator=Bea", true), 303);
}

static void test_a_serial_of_another_foil_is_asked_about(void **state) {
  (void)state;
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-2&lot=L9&back=/", true), 409);
  expect_foil("S-1|L1|D1|");
  expect_words("another foil has the serial number S-2");
  expect_words("<span class=\"tag pass\">PASS</span> <a href=\"/foil?id=2\">S-2</a>");
  expect_words("<button>Keep</button><button class=\"plain\" name=\"also\" value=\"S-2\">");
  expect_words("name=\"back\" value=\"/\"");
  /* Yes to another number is none to this one. */
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-2&also=S-3", true), 409);
  expect_foil("S-1|L1|D1|");
  assert_int_equal(ask("/correct", HTML_FORM SHOWN "serial=S-2&also=S-2&back=/", true), 303);
  assert_string_equal(location, "/");
  expect_foil("S-2|L1|D1|");
  /* It has it now: nothing is asked of what stays. */
  assert_int_equal(ask("/correct", HTML_FORM "was_serial=S-2&serial=S-2&lot=L9", true), 303);
  expect_foil("S-2|L9|D1|");
  assert_int_equal(ask("/foil", "id=1", false), 200);
  expect_words("The serial also has <a href=\"/foil?id=2\">");
}

static void test_a_scan_that_came_again_is_no_pass(void **state) {
  static const struct {
    const char *kind, *call, *step;
    bool foil;
  } rows[] = {
      {"duplicate", "again\" data-arrival=\"2\" data-words=\"SAME SCAN\"",
       "Put this foil on the glass", false},
      {"known", "none long\" data-arrival=\"2\" data-words=\"MEASURED BEFORE\"", "Nothing is new",
       true},
  };
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    char text[400];
    snprintf(text, sizeof text,
             "DELETE FROM arrivals WHERE id > 1; INSERT INTO arrivals (id, at, path, kind, message,"
             " scan) VALUES (2, 1000000002000, 'L1_S-5.png', '%s', 'is the scan', 2)",
             rows[i].kind);
    sql(text);
    assert_int_equal(ask("/", "", false), 200);
    expect_no_words("class=\"call pass");
    expect_words(rows[i].call);
    expect_words(rows[i].step);
    assert_int_equal(strstr(page, "id=\"foil2\"") != NULL, rows[i].foil);
  }
}

/* Another scan does not make the ± smaller that a scanner's unknown scale causes. */
static void test_an_open_verdict_says_why(void **state) {
  fg_calibration *calibration = &fixture.settings.lot.design.calibration;
  (void)state;
  sql("UPDATE scans SET verdict = 'cannot_tell' WHERE id = 2;"
      "UPDATE foils SET verdict = 'cannot_tell' WHERE id = 2;"
      "INSERT INTO arrivals (id, at, path, kind, message, scan) VALUES"
      " (2, 1000000002000, 'L1_S-2.png', 'measured', '', 2)");
  assert_int_equal(ask("/foil", "id=2", false), 200);
  expect_words("neither PASS nor FAIL is proven");
  assert_int_equal(ask("/", "", false), 200);
  expect_words("<p class=\"next\">A limit lies within the uncertainty");
  expect_no_words("the scanner's unknown scale decides");
  *calibration = fg_calibration_of_flatbed();
  assert_int_equal(ask("/", "", false), 200);
  expect_words("the scanner's unknown scale decides");
  sql("UPDATE scans SET verdict = 'pass' WHERE id = 2");
  assert_int_equal(ask("/", "", false), 200);
  expect_words("<p class=\"next calm\">Put the foil with the good ones");
  expect_no_words("the scanner's unknown scale decides");
}

/* No heading stands above nothing. */
static void test_the_first_card_has_none_before_it(void **state) {
  (void)state;
  assert_int_equal(ask("/", "", false), 200);
  expect_no_words(">Before</h2>");
  sql("INSERT INTO arrivals (id, at, path, kind, message, scan) VALUES"
      " (2, 1000000002000, 'L1_S-2.png', 'measured', '', 2)");
  assert_int_equal(ask("/", "", false), 200);
  expect_words(">Before</h2>");
}

static void test_what_is_on_its_way_stands_before_the_last_verdict(void **state) {
  static const char *const words[] = {"RECEIVING", "MEASURING"};
  fg_inspection *station = &fixture.station;
  (void)state;
  sql("INSERT INTO arrivals (id, at, path, kind, message, scan) VALUES"
      " (2, 1000000002000, 'L1_S-2.png', 'measured', '', 2)");
  for (int stage = FG_STAGE_RECEIVING; stage <= FG_STAGE_MEASURING; stage++) {
    long long news = fg_station_news(station);
    fg_station_set_stage(station, (fg_stage)stage, "L1_<b>.png");
    fg_station_set_stage(station, (fg_stage)stage, "L1_<b>.png");
    assert_int_equal(fg_station_news(station), news + 1);
    assert_int_equal(ask("/", "", false), 200);
    expect_words(words[stage - 1]);
    expect_words("L1_&lt;b&gt;.png");
    expect_no_words("class=\"call pass");
    expect_words("Before it: L1_S-2.png PASS");
    expect_words("id=\"foil2\""); /* whose serial number can be typed meanwhile */
  }
  fg_station_end_stage(station, "other.png");
  assert_int_equal(ask("/", "", false), 200);
  expect_words("MEASURING");
  fg_station_end_stage(station, "L1_<b>.png");
  assert_int_equal(ask("/", "", false), 200);
  expect_words("class=\"call pass");
}

/* An error of a moment ago is not lost behind the file that is on its way. */
static void test_the_message_of_the_card_before_stays(void **state) {
  (void)state;
  sql("INSERT INTO arrivals (id, at, path, kind, message) VALUES"
      " (2, 1000000002000, 'scan.png', 'unreadable', 'the scan command ended with exit code 3')");
  fg_station_set_stage(&fixture.station, FG_STAGE_MEASURING, "other.png");
  assert_int_equal(ask("/", "", false), 200);
  expect_words("Before it: scan.png SCAN AGAIN, 2001-");
  expect_words(": the scan command ended with exit code 3</p>");
}

/* The file that is received first is shown until it is gone; a round that does not see it ends it.
 */
static void test_of_two_files_one_is_shown(void **state) {
  fg_inspection *station = &fixture.station;
  fg_arriving shown;
  (void)state;
  fg_station_begin_round(station);
  fg_station_set_stage(station, FG_STAGE_RECEIVING, "a");
  fg_station_set_stage(station, FG_STAGE_RECEIVING, "b");
  fg_station_end_round(station);
  fg_station_read_stage(station, &shown);
  assert_string_equal(shown.file, "a");
  fg_station_begin_round(station);
  fg_station_set_stage(station, FG_STAGE_RECEIVING, "b");
  fg_station_end_round(station);
  fg_station_read_stage(station, &shown);
  assert_int_equal(shown.stage, FG_STAGE_NONE);
  fg_station_set_stage(station, FG_STAGE_RECEIVING, "b");
  fg_station_set_stage(station, FG_STAGE_MEASURING, "c");
  fg_station_read_stage(station, &shown);
  assert_string_equal(shown.file, "c");
}

static void test_crushed_is_said_of_crushed_bumps(void **state) {
  static const struct {
    const char *flags[3], *words;
  } rows[] = {
      {{"", "crushed poor_fit", ""}, "Bump 2 is crushed:"},
      {{"crushed", "", "poor_fit crushed"}, "Bumps 1, 3 are crushed:"},
      {{"poor_fit", "", "uncrushed"}, NULL},
      {{"crushed", "crushed", "crushed"}, "No bump has the height and radius of the design"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    char text[400];
    snprintf(text, sizeof text,
             "DELETE FROM bumps; INSERT INTO bumps VALUES (1, 1, 'fail', '%s'),"
             " (1, 2, 'fail', '%s'), (1, 3, 'fail', '%s')",
             rows[i].flags[0], rows[i].flags[1], rows[i].flags[2]);
    sql(text);
    assert_int_equal(ask("/", "", false), 200);
    if (rows[i].words) expect_words(rows[i].words);
    if (!rows[i].words || strstr(rows[i].words, "No bump")) expect_no_words("crushed:");
    assert_int_equal(ask("/foil", "id=1", false), 200);
    if (rows[i].words) expect_words(rows[i].words);
  }
}

/* Grey until a script has heard of the station, with its time; news are counted before reading. */
static void test_a_page_says_how_old_it_is(void **state) {
  static const char *const paths[] = {"/", "/history", "/trends", "/scanner", "/lots"};
  char expected[100];
  (void)state;
  for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
    in_row("paths[%zu]", i);
    assert_int_equal(ask(paths[i], "", false), 200);
    expect_words("<html lang=\"en\" class=\"unconfirmed\">");
    expect_words("This page shows what was known at 20");
    snprintf(expected, sizeof expected, "<main data-news=\"%lld\" data-form=\"",
             fg_station_news(&fixture.station));
    expect_words(expected);
  }
  assert_int_equal(ask("/alive", "", false), 200);
  snprintf(expected, sizeof expected, "%lld 20", fg_station_news(&fixture.station));
  assert_memory_equal(page, expected, strlen(expected));
  assert_int_equal(strlen(page), strlen(expected) - 2 + strlen("2026-01-01 00:00:00\n"));
  long long news = fg_station_news(&fixture.station);
  assert_int_equal(ask("/correct", HTML_FORM "serial=S-8", true), 303);
  assert_int_equal(fg_station_news(&fixture.station), news + 1); /* other browsers show it, too */
}

#define TEST(name) cmocka_unit_test_setup_teardown(test_##name, open_fixture, close_fixture)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_stale_html_form_changes_what_was_changed_in_it),
      TEST(a_change_over_a_change_is_asked_about),
      TEST(a_serial_of_another_foil_is_asked_about),
      TEST(a_scan_that_came_again_is_no_pass),
      TEST(what_is_on_its_way_stands_before_the_last_verdict),
      TEST(the_message_of_the_card_before_stays),
      TEST(of_two_files_one_is_shown),
      TEST(crushed_is_said_of_crushed_bumps),
      TEST(a_page_says_how_old_it_is),
      TEST(an_open_verdict_says_why),
      TEST(the_first_card_has_none_before_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
