/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers of a station, and who gets them: fields, names of files, hosts, forms, tokens, hostile
 * texts. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station/naming.h"
#include "support/station_fixture.h"
#include "support/test.h"

#define HOSTILE   "<script>alert(1)</script>\"'&"
#define HTML_FORM "form=0123456789abcdef0123456789abcdef&"

static station_fixture fixture;

static int open_fixture(void **state) {
  fg_context ctx = {0};
  (void)state;
  fg_status status = station_fixture_open(&ctx, &fixture, HOSTILE, "a" HOSTILE ".png");
  if (status != FG_OK) print_error("%s\n", ctx.message);
  return status == FG_OK ? 0 : -1;
}

static int close_fixture(void **state) {
  (void)state;
  station_fixture_close(&fixture);
  return 0;
}

static fg_request make_request(const char *path, const char *fields) {
  fg_request request = {.path = path, .host = "127.0.0.1:8317", .last_event = -1};
  assert_true(fg_request_read_fields(&request, fields, strlen(fields)));
  return request;
}

/* The code; the page is in `page`, which the next call frees. */
static char *page;
static fg_answer told;
static int ask(const fg_request *request) {
  free(page);
  fg_station_answer(&fixture.station, request, &told);
  page = calloc(1, told.size + 1);
  if (told.body) memcpy(page, told.body, told.size);
  free(told.body);
  told.body = NULL;
  return told.code;
}

static int get(const char *path, const char *fields) {
  fg_request request = make_request(path, fields);
  return ask(&request);
}

static int post(const char *path, const char *fields) {
  fg_request request = make_request(path, fields);
  request.post = true;
  return ask(&request);
}

static const char *serial_now(void) {
  static char text[256];
  fg_query query;
  fg_context ctx;
  fg_query_begin(fixture.station.database.reader, "SELECT serial FROM foils WHERE id = 1", &query);
  assert_true(fg_query_row(&query));
  snprintf(text, sizeof text, "%s", fg_query_get_text(&query, 0));
  assert_ok(&ctx, fg_query_end(&ctx, &query, "serial"));
  return text;
}

static void test_fields(void **state) {
  (void)state;
  static const struct {
    const char *text;
    bool good;
    const char *name, *value;
  } rows[] = {
      {"", true, "a", ""},
      {"a=b", true, "a", "b"},
      {"a=b+c%20d&e=f", true, "a", "b c d"},
      {"a=%C3%A4", true, "a", "\xC3\xA4"},
      {"a=b=c", true, "a", "b=c"},
      {"a=1&a=2", true, "a", "1"},
      {"&&a", true, "a", ""},
      {"=b&a=c", true, "a", "c"},
      {"a=%26%3D", true, "a", "&="},
      {"a=%C3", false, 0, 0},       /* half a character */
      {"a=%C0%AF", false, 0, 0},    /* overlong */
      {"a=%ED%A0%80", false, 0, 0}, /* a surrogate */
      {"a=%00", false, 0, 0},
      {"a=%0a", false, 0, 0},
      {"a=%7f", false, 0, 0},
      {"a=%4", false, 0, 0},
      {"a=%", false, 0, 0},
      {"a=%zz", false, 0, 0},
      {"a%ff=1", false, 0, 0},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_request request = {0};
    bool good = fg_request_read_fields(&request, rows[i].text, strlen(rows[i].text));
    if (good != rows[i].good) fail_msg("'%s' is %s", rows[i].text, good ? "taken" : "refused");
    if (good) assert_string_equal(fg_request_get(&request, rows[i].name), rows[i].value);
  }
}

static void test_fields_that_are_too_much(void **state) {
  (void)state;
  char many[3 * FG_FIELDS_MAX + 8] = "", wide[FG_FIELD_BYTES + 8];
  for (int i = 0; i < FG_FIELDS_MAX; i++)
    strcat(many, "a&");
  fg_request request = {0};
  assert_true(fg_request_read_fields(&request, many, strlen(many)));
  assert_false(fg_request_add_field(&request, "a", NULL));
  strcat(many, "a");
  request.fields = 0;
  assert_false(fg_request_read_fields(&request, many, strlen(many)));
  memset(wide, 'b', sizeof wide);
  memcpy(wide, "a=", 2);
  request.fields = 0;
  assert_true(fg_request_read_fields(&request, wide, 2 + FG_FIELD_BYTES - 1));
  request.fields = 0;
  assert_false(fg_request_read_fields(&request, wide, 2 + FG_FIELD_BYTES));
  request.fields = 0;
  assert_true(fg_request_add_field(&request, "a&b", "c%3D+d"));
  assert_string_equal(fg_request_get(&request, "a&b"), "c= d");
  assert_false(fg_request_add_field(&request, "a", "%FF"));
}

static void test_names_of_files(void **state) {
  (void)state;
  static const struct {
    const char *pattern, *file;
    bool fits;
    const char *serial, *lot, *die;
  } rows[] = {
      {"{serial}", "A-1.png", true, "A-1", "", ""},
      {"{serial}", "A.1.png", true, "A.1", "", ""},
      {"{serial}_{lot}", "A_7.tif", true, "A", "7", ""},
      {"{serial}_{lot}", "A_7_8.tif", true, "A", "7_8", ""},
      {"{lot}-{die}-{serial}", "7-2-A.png", true, "A", "7", "2"},
      {"*_{serial}", "scan 3_A.png", true, "A", "", ""},
      {"{serial}_{lot}", "A.png", false, "A", "", ""},
      {"{serial}_{lot}", "_7.png", false, "_7", "", ""},
      {"x{serial}", "A.png", false, "A", "", ""},
      {"{serial}", ".png", true, ".png", "", ""},
      {"{serial}_{lot}", HOSTILE "_..", true, HOSTILE, ".", ""},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_named named;
    if (fg_naming_split(rows[i].pattern, rows[i].file, &named) != rows[i].fits)
      fail_msg("%s %s", rows[i].pattern, rows[i].file);
    assert_string_equal(named.serial, rows[i].serial);
    assert_string_equal(named.lot, rows[i].lot);
    assert_string_equal(named.die, rows[i].die);
  }
  static const char *const bad[] = {
      "", "{", "{serial", "{weight}", "{serial}{lot}", "*{serial}", "{serial}-{serial}"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    in_row("bad[%zu]", i);
    fg_context ctx = {0};
    if (fg_naming_check(&ctx, bad[i]) != FG_ERR_DATA) fail_msg("'%s' is taken", bad[i]);
    assert_string_not_equal(ctx.message, "");
  }
}

static void test_hosts(void **state) {
  (void)state;
  static const struct {
    const char *host;
    int code;
  } rows[] = {
      {"127.0.0.1:8317", 200},
      {"localhost:8317", 200},
      {NULL, 421},
      {"", 421},
      {"127.0.0.1", 421},
      {"127.0.0.1:83170", 421},
      {"evil.example:8317", 421},
      {"localhost", 421},
      {"localhost:8317.evil", 421},
      {"127.0.0.1:8317@evil", 421},
      {"127.0.0.1:8317, evil", 421},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_request request = make_request("/", "");
    request.host = rows[i].host;
    if (ask(&request) != rows[i].code) fail_msg("%s: %d", rows[i].host, told.code);
  }
}

static void test_html_forms(void **state) {
  (void)state;
  static const struct {
    const char *fields, *origin, *site;
    int code;
  } rows[] = {
      {HTML_FORM "foil=1&serial=A", NULL, NULL, 303},
      {HTML_FORM "foil=1&serial=A", "http://127.0.0.1:8317", "same-origin", 303},
      {HTML_FORM "foil=1&serial=B", "http://evil.example", NULL, 403},
      {HTML_FORM "foil=1&serial=B", "null", NULL, 403},
      {HTML_FORM "foil=1&serial=B", "http://127.0.0.1:8317.evil", NULL, 403},
      {HTML_FORM "foil=1&serial=B", NULL, "cross-site", 403},
      {HTML_FORM "foil=1&serial=B", NULL, "same-site", 403},
      {"foil=1&serial=B", NULL, NULL, 403},
      {"form=&foil=1&serial=B", NULL, NULL, 403},
      {"form=0123456789abcdef0123456789abcdee&foil=1&serial=B", NULL, NULL, 403},
      {"form=0123456789abcdef0123456789abcdef0&foil=1&serial=B", NULL, NULL, 403},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_request request = make_request("/correct", rows[i].fields);
    request.post = true;
    request.origin = rows[i].origin;
    request.site = rows[i].site;
    if (ask(&request) != rows[i].code) fail_msg("row %zu: %d", i, told.code);
    assert_string_equal(serial_now(), "A");
  }
  assert_int_equal(get("/correct", HTML_FORM "foil=1&serial=B"), 404);
  assert_string_equal(serial_now(), "A");
}

static void test_token(void **state) {
  (void)state;
  static const char token[] = "a-token-of-a-station";
  static const struct {
    const char *path, *fields, *cookie;
    int code;
    const char *location;
  } rows[] = {
      {"/", "", NULL, 401, ""},
      {"/style.css", "", NULL, 401, ""},
      {"/events", "", NULL, 401, ""},
      {"/alive", "", NULL, 401, ""},
      {"/", "token=a-token-of-a-statio", NULL, 401, ""},
      {"/", "token=", NULL, 401, ""},
      {"/", "token=a-token-of-a-station", NULL, 303, "/"},
      {"/history", "token=a-token-of-a-station", NULL, 303, "/history"},
      {"//evil.example/", "token=a-token-of-a-station", NULL, 303, "/"},
      {"history", "token=a-token-of-a-station", NULL, 303, "/"},
      {"", "token=a-token-of-a-station", NULL, 303, "/"},
      {"/", "", "foilgauge=a-token-of-a-station", 200, ""},
      {"/", "", "other=1; foilgauge=a-token-of-a-station", 200, ""},
      {"/", "", "notfoilgauge=a-token-of-a-station", 401, ""},
      {"/", "", "foilgauge=", 401, ""},
      {"/", "", "foilgauge=a-token-of-a-stationx", 401, ""},
      {"/", "",
       "foilgauge=aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 401,
       ""},
  };
  fixture.request.token = token;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_request request = make_request(rows[i].path, rows[i].fields);
    request.cookie = rows[i].cookie;
    if (ask(&request) != rows[i].code) fail_msg("row %zu: %d", i, told.code);
    assert_string_equal(told.location, rows[i].location);
    assert_int_equal(told.cookie[0] != '\0', rows[i].code == 303);
  }
  fg_request request =
      make_request("/correct", HTML_FORM "token=a-token-of-a-station&foil=1&serial=C");
  request.post = true;
  assert_int_equal(ask(&request), 401); /* a form proves itself by the cookie alone */
  fixture.request.token = NULL;
}

static void test_nothing_else_is_served(void **state) {
  (void)state;
  static const char *const paths[] = {"",
                                      "/..",
                                      "/../foilgauge.sqlite",
                                      "/foilgauge.sqlite",
                                      "/%2e%2e/etc/passwd",
                                      "//",
                                      "/style.css/",
                                      "/history/../foil",
                                      "*",
                                      "http://127.0.0.1:8317/"};
  for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
    if (get(paths[i], "") != 404) fail_msg("'%s': %d", paths[i], told.code);
  static const char *const ids[] = {
      "", "0", "-1", "2", "1 ", "1x", "9223372036854775808", "1;DROP TABLE foils", "../1"};
  for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
    in_row("ids[%zu]", i);
    fg_request request = {.path = "/foil", .host = "127.0.0.1:8317"};
    request.fields = 1;
    strcpy(request.field[0].name, "id");
    strcpy(request.field[0].value, ids[i]);
    if (ask(&request) != 404) fail_msg("foil '%s': %d", ids[i], told.code);
    strcpy(request.field[0].name, "foil");
    request.path = "/report";
    if (ask(&request) != 404) fail_msg("report '%s': %d", ids[i], told.code);
  }
}

/* On every page that shows it, as a text and in an attribute. */
static void test_script_in_names(void **state) {
  (void)state;
  assert_int_equal(post("/correct",
                        HTML_FORM "foil=1&serial=%3Cscript%3Ealert(1)%3C/script%3E%22%27%26"
                                  "&lot=%3Cscript%3Ex&die=%22+onfocus%3D%221&operator=%3Cscript%3E"
                                  "&by=%3Cscript%3Eby"),
                   303);
  assert_string_equal(serial_now(), HOSTILE);
  static const char *const asked[][2] = {{"/", ""},
                                         {"/history", ""},
                                         {"/history", "serial=%3Cscript%3E&lot=%22%3E%3Cscript%3E"},
                                         {"/foil", "id=1"},
                                         {"/report", "foil=1"},
                                         {"/trends", ""},
                                         {"/lots", ""}};
  for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
    in_row("asked[%zu]", i);
    if (get(asked[i][0], asked[i][1]) != 200) fail_msg("%s: %d", asked[i][0], told.code);
    if (strstr(page, "<script>") || strstr(page, "\" onfocus="))
      fail_msg("%s?%s: a script", asked[i][0], asked[i][1]);
    if (i < 2 && !strstr(page, "&lt;script&gt;")) fail_msg("%s: no name", asked[i][0]);
  }
}

static void test_corrections(void **state) {
  (void)state;
  static const struct {
    const char *fields;
    int code;
    const char *serial, *location;
  } rows[] = {
      {"foil=1&serial=+S-1+&by=Eva", 303, "S-1", "/foil?id=1"},
      {"foil=1&serial=S-2&back=/", 303, "S-2", "/"},
      {"foil=1&serial=S-2&back=//evil.example", 303, "S-2", "/foil?id=1"},
      {"foil=1&serial=S-2&back=http://evil", 303, "S-2", "/foil?id=1"},
      {"foil=1&serial=", 422, "S-2", ""},
      {"foil=1&serial=+++", 422, "S-2", ""},
      {"foil=1&lot=L9", 303, "S-2", "/foil?id=1"},
      {"foil=2&serial=x", 404, "S-2", ""},
      {"foil=&serial=x", 404, "S-2", ""},
      {"serial=x", 404, "S-2", ""},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    char fields[200];
    snprintf(fields, sizeof fields, HTML_FORM "%s", rows[i].fields);
    if (post("/correct", fields) != rows[i].code) fail_msg("row %zu: %d", i, told.code);
    assert_string_equal(serial_now(), rows[i].serial);
    assert_string_equal(told.location, rows[i].location);
  }
  char wide[400] = HTML_FORM "foil=1&serial=";
  memset(wide + strlen(wide), 'x', 200);
  assert_int_equal(post("/correct", wide), 422);
  /* The record of a change holds who made it and the values before and after; a value that did not
   * change leaves none. */
  fg_query query;
  fg_context ctx;
  fg_query_begin(fixture.station.database.reader,
                 "SELECT count(*), sum(by = 'Eva' AND after = 'S-1'),"
                 " sum(before = 'S-1' AND after = 'S-2') FROM corrections"
                 " WHERE field = 'serial' AND after LIKE 'S-%'",
                 &query);
  assert_true(fg_query_row(&query));
  for (int i = 0; i < 3; i++)
    assert_int_equal(fg_query_get_integer(&query, i), i ? 1 : 2);
  assert_ok(&ctx, fg_query_end(&ctx, &query, "trail"));
  assert_int_equal(get("/foil", "id=1"), 200);
  assert_has(page, "Eva");
}

static void test_searches(void **state) {
  (void)state;
  static const struct {
    const char *fields;
    bool found;
  } rows[] = {
      {"", true},
      {"serial=s-2", true},
      {"serial=-2", true},
      {"serial=S-3", false},
      {"serial=%25", false}, /* no pattern of SQL */
      {"serial=%27+OR+1%3D1+--", false},
      {"lot=l9", true},
      {"lot=L", false},
      {"verdict=fail", true},
      {"verdict=pass", false},
      {"verdict=nonsense", true},
      {"from=2001-09-08", true},
      {"from=2001-09-11", false},
      {"to=2001-09-10", true},
      {"to=2001-09-07", false},
      {"from=nonsense&to=2001-13-99", true},
      {"page=99", true},
      {"page=-1", true},
      {"page=99999999999999999999", true},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    assert_int_equal(get("/history", rows[i].fields), 200);
    if ((strstr(page, "href=\"/foil?id=1\"") != NULL) != rows[i].found)
      fail_msg("'%s'", rows[i].fields);
  }
}

/* Without a command, and of another program's record, the words say so. */
static void test_answers_hold_without_scan_command_and_files(void **state) {
  (void)state;
  assert_int_equal(post("/scan", HTML_FORM), 404);
  assert_int_equal(get("/foil", "id=1"), 200);
  assert_has(page, "cannot be read");
  assert_int_equal(get("/report", "foil=1"), 200);
  assert_has(page, "From the record");
  assert_true(told.own_style);
}

int main(void) {
  static const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_fields),
      cmocka_unit_test(test_fields_that_are_too_much),
      cmocka_unit_test(test_names_of_files),
      cmocka_unit_test(test_hosts),
      cmocka_unit_test(test_html_forms),
      cmocka_unit_test(test_token),
      cmocka_unit_test(test_nothing_else_is_served),
      cmocka_unit_test(test_script_in_names),
      cmocka_unit_test(test_corrections),
      cmocka_unit_test(test_searches),
      cmocka_unit_test(test_answers_hold_without_scan_command_and_files),
  };
  int failed = cmocka_run_group_tests(tests, open_fixture, close_fixture);
  free(page);
  return failed;
}
