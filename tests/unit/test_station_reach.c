/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For which names a station answers, and from where its forms may come. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "station/answer.h"
#include "station/reach.h"
#include "support/test.h"

static const char *const hosts[] = {"scanner.example.com", "Other.example:443", "[2001:db8::7]"};

static fg_inspection make_station(const fg_station_request *request, fg_reach reach,
                                  const char *host) {
  fg_inspection station = {.request = request, .reach = reach};
  strcpy(station.host, host);
  return station;
}

static void test_given_names(void **state) {
  static const struct {
    const char *host;
    bool ours;
  } rows[] = {
      {"127.0.0.1:8317", true},
      {"scanner.example.com", true},
      {"SCANNER.example.com:8317", true},
      {"scanner.example.com:443", false},
      {"scanner.example.com:", false},
      {"scanner.example.com:8317:8317", false},
      {"x.scanner.example.com", false},
      {"scanner.example.com.evil", false},
      {"other.example:443", true},
      {"other.example", false},
      {"other.example:8317", false},
      {"[2001:db8::7]:8317", true},
      {"[2001:db8::7]", true},
      {"[2001:db8::7", false},
      {"2001:db8::7", false},
      {"[]", false},
      {":8317", false},
      {"localhost:8317", true},
      {"localhost", false},
      {"127.0.0.1:0008317", true}, /* the same port */
      {"127.0.0.1:-1", false},
      {"127.0.0.1:99999999999999999999", false},
      {"127.0.0.2:8317", false},
  };
  const fg_station_request request = {.hosts = hosts, .host_count = 3};
  const fg_inspection station = make_station(&request, FG_REACH_LOCAL, "127.0.0.1:8317");
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    if (fg_reach_is_host(&station, rows[i].host) != rows[i].ours)
      fail_msg("'%s' is %s", rows[i].host, rows[i].ours ? "refused" : "taken");
  assert_false(fg_reach_is_host(&station, NULL));
}

static void test_port_80_needs_no_number(void **state) {
  const fg_station_request request = {.token = "x"};
  const fg_inspection station = make_station(&request, FG_REACH_ADDRESS, "192.168.1.20:80");
  (void)state;
  assert_true(fg_reach_is_host(&station, "192.168.1.20"));
  assert_true(fg_reach_is_host(&station, "192.168.1.20:80"));
  assert_false(fg_reach_is_host(&station, "192.168.1.21"));
}

/* At every address: those of the machine, and its names; at one: its names; on this machine alone:
 * neither. */
static void test_names_of_the_machine(void **state) {
  char name[256], host[300];
  const fg_station_request request = {.token = "x"};
  const fg_inspection any = make_station(&request, FG_REACH_ANY, "0.0.0.0:8317");
  const fg_inspection one = make_station(&request, FG_REACH_ADDRESS, "192.0.2.7:8317");
  const fg_inspection local = make_station(&request, FG_REACH_LOCAL, "127.0.0.1:8317");
  (void)state;
  assert_int_equal(gethostname(name, sizeof name), 0);
  snprintf(host, sizeof host, "%s:8317", name);
  assert_true(fg_reach_is_host(&any, host));
  assert_true(fg_reach_is_host(&one, host));
  if (strncmp(name, "localhost", 9) != 0) assert_false(fg_reach_is_host(&local, host));
  assert_true(fg_reach_is_host(&any, "127.0.0.1:8317"));
  assert_false(fg_reach_is_host(&one, "127.0.0.1:8317"));
  assert_false(fg_reach_is_host(&any, "192.0.2.99:8317"));
  assert_false(fg_reach_is_host(&any, "evil.example:8317"));
}

static void test_origins(void **state) {
  const fg_station_request request = {.token = "x", .origin = "https://scanner.example.com"};
  const fg_inspection station = make_station(&request, FG_REACH_LOCAL, "127.0.0.1:8317");
  (void)state;
  assert_true(fg_reach_is_host(&station, "scanner.example.com"));
  assert_false(fg_reach_is_host(&station, "scanner.example.com:444"));
  assert_true(fg_reach_is_origin(&station, "127.0.0.1:8317", "https://scanner.example.com"));
  assert_true(fg_reach_is_origin(&station, "127.0.0.1:8317", "http://127.0.0.1:8317"));
  assert_false(fg_reach_is_origin(&station, "127.0.0.1:8317", "http://scanner.example.com"));
  assert_false(fg_reach_is_origin(&station, "127.0.0.1:8317", "https://scanner.example.com.evil"));
  assert_false(fg_reach_is_origin(&station, "127.0.0.1:8317", "null"));
}

static void test_unsafe_station_requests_are_refused(void **state) {
  static const char token[] = "a-token-of-this-test";
  static const char *const wrong[] = {"not a name", "https://a"};
  static const fg_station_request rows[] = {
      {.listen = "0.0.0.0"},
      {.listen = "::"},
      {.listen = "192.168.1.20"},
      {.listen = "scanner", .token = token},
      {.listen = "1.2.3", .token = token},
      {.listen = "", .token = token},
      {.token = "short"},
      {.token = "with a blank in it"},
      {.origin = "https://a.example"},
      {.origin = "https://", .token = token},
      {.origin = "ftp://a.example", .token = token},
      {.origin = "https://a.example/", .token = token},
      {.origin = "https://a.example:0", .token = token},
      {.origin = "https://me@a.example", .token = token},
      {.hosts = &wrong[0], .host_count = 1},
      {.hosts = &wrong[1], .host_count = 1},
  };
  struct sockaddr_storage address;
  fg_reach reach;
  fg_context ctx;
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    ctx.message[0] = '\0';
    if (fg_reach_find(&ctx, &rows[i], &address, &reach) != FG_ERR_USAGE)
      fail_msg("row %zu is taken", i);
    assert_string_not_equal(ctx.message, "");
  }
  const fg_station_request good = {.listen = "::1", .hosts = hosts, .host_count = 3};
  assert_ok(&ctx, fg_reach_find(&ctx, &good, &address, &reach));
  assert_int_equal(reach, FG_REACH_LOCAL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_given_names),
      cmocka_unit_test(test_port_80_needs_no_number),
      cmocka_unit_test(test_names_of_the_machine),
      cmocka_unit_test(test_origins),
      cmocka_unit_test(test_unsafe_station_requests_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
