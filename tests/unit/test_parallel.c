/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Threads run where their process may. The calls that set and ask for cores are the test's own, so
 * that it does not matter how many the machine has. */
#include <pthread.h>
#include <sched.h>
#include <string.h>

#include "core/parallel.h"
#include "support/test.h"

static cpu_set_t allowed, started_on, running_on;

int pthread_getaffinity_np(pthread_t thread, size_t size, cpu_set_t *set) {
  (void)thread;
  assert_true(size >= sizeof *set);
  *set = allowed;
  return 0;
}

int pthread_setaffinity_np(pthread_t thread, size_t size, const cpu_set_t *set) {
  (void)thread;
  assert_true(size >= sizeof *set);
  running_on = *set;
  return 0;
}

int pthread_attr_setaffinity_np(pthread_attr_t *attributes, size_t size, const cpu_set_t *set) {
  (void)attributes;
  assert_true(size >= sizeof *set);
  started_on = *set;
  return 0;
}

int sched_getcpu(void) {
  return 3;
}

static void allow(const size_t *cores, size_t count) {
  CPU_ZERO(&allowed);
  for (size_t i = 0; i < count; i++)
    CPU_SET(cores[i], &allowed);
  CPU_ZERO(&started_on);
  CPU_ZERO(&running_on);
}

static void *nothing(void *argument) {
  return argument;
}

static void threads_keep_to_the_cores_of_their_process(void **state) {
  (void)state;
  fg_thread thread;
  allow((const size_t[]){1, 3, 5}, 3);
  assert_ok(NULL, fg_thread_start(&thread, nothing, NULL));
  fg_thread_join(&thread);
  assert_true(CPU_EQUAL(&running_on, &allowed));
  assert_int_equal(CPU_COUNT(&started_on), 2);
  assert_false(CPU_ISSET(3, &started_on));
  allow((const size_t[]){3}, 1);
  assert_ok(NULL, fg_thread_start(&thread, nothing, NULL));
  fg_thread_join(&thread);
  assert_int_equal(CPU_COUNT(&running_on), 0);
}

typedef struct meeting {
  pthread_mutex_t lock;
  pthread_t seen[8];
  size_t count;
} meeting;

static fg_status sign(fg_context *ctx, void *shared, size_t item) {
  meeting *m = shared;
  (void)ctx;
  (void)item;
  pthread_mutex_lock(&m->lock);
  size_t i = 0;
  while (i < m->count && !pthread_equal(m->seen[i], pthread_self()))
    i++;
  if (i == m->count && m->count < 8) m->seen[m->count++] = pthread_self();
  pthread_mutex_unlock(&m->lock);
  sched_yield();
  return FG_OK;
}

static void there_are_as_many_threads_as_cores(void **state) {
  (void)state;
  meeting m = {.lock = PTHREAD_MUTEX_INITIALIZER};
  allow((const size_t[]){1, 3, 5}, 3);
  assert_int_equal(fg_core_count(), 3);
  allow((const size_t[]){3}, 1);
  assert_int_equal(fg_core_count(), 1);
  assert_ok(&test_context, fg_parallel_run(&test_context, 0, 2000, sign, &m));
  assert_int_equal(m.count, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_keep_to_the_cores_of_their_process),
      cmocka_unit_test(there_are_as_many_threads_as_cores),
  };
  return cmocka_run_group_tests_name("parallel", tests, NULL, NULL);
}
