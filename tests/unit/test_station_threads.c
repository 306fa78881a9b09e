/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests that come at once: each gets an answer, and what may run once runs once. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station/close.h"
#include "support/station_fixture.h"
#include "support/test.h"

enum { THREADS = 8, ROUNDS = 60 };

static station_fixture fixture;
static pthread_barrier_t barrier; /* all ask at the same moment */

typedef struct client {
  pthread_t thread;
  int sent_on, refused, others; /* answers by their codes */
} client;

static void *close_again_and_again(void *user) {
  static const char fields[] = "form=0123456789abcdef0123456789abcdef&lot=L1&by=me&open=1";
  client *at = user;
  for (int i = 0; i < ROUNDS; i++) {
    fg_answer answer;
    fg_request request = {
        .post = true, .path = "/close", .host = "127.0.0.1:8317", .last_event = -1};
    fg_request_read_fields(&request, fields, strlen(fields));
    pthread_barrier_wait(&barrier);
    fg_station_answer(&fixture.station, &request, &answer);
    at->sent_on += answer.code == 303;
    at->refused += answer.code == 422;
    at->others += answer.code != 303 && answer.code != 422;
    free(answer.body);
  }
  return NULL;
}

/* Of those that come at once one closes the lot, and the others are told to wait. */
static void test_a_lot_is_closed_by_one(void **state) {
  client clients[THREADS] = {0};
  fg_context ctx = {0};
  int sent_on = 0, refused = 0;
  (void)state;
  assert_ok(&ctx, station_fixture_open(&ctx, &fixture, "S-1", "S-1.png"));
  pthread_barrier_init(&barrier, NULL, THREADS);
  pthread_mutex_init(&fixture.station.closing.mutex, NULL);
  for (int i = 0; i < THREADS; i++)
    assert_int_equal(pthread_create(&clients[i].thread, NULL, close_again_and_again, &clients[i]),
                     0);
  for (int i = 0; i < THREADS; i++) {
    pthread_join(clients[i].thread, NULL);
    assert_int_equal(clients[i].others, 0);
    sent_on += clients[i].sent_on;
    refused += clients[i].refused;
  }
  assert_int_equal(sent_on + refused, THREADS * ROUNDS);
  assert_true(sent_on > 0);
  fg_closing_end(&fixture.station.closing);
  station_fixture_close(&fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_lot_is_closed_by_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
