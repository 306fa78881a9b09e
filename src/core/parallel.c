/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/parallel.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <unistd.h>

enum { THREADS_MAX = 64 };

static void *run_where_allowed(void *argument) {
  fg_thread *thread = argument;
  pthread_setaffinity_np(pthread_self(), sizeof thread->allowed, &thread->allowed);
  return thread->run(thread->argument);
}

/* Many times a worker's stack; the usual 8 MiB matter where address space is limited. */
#define STACK_BYTES ((size_t)2 << 20)

/* Keeps a thread off the caller's core at its start. False: no other core. */
static bool avoid_this_core(pthread_attr_t *attributes, cpu_set_t *allowed) {
  int here = sched_getcpu();
  if (here < 0 || pthread_getaffinity_np(pthread_self(), sizeof *allowed, allowed) != 0)
    return false;
  cpu_set_t set = *allowed;
  CPU_CLR((size_t)here, &set);
  return CPU_COUNT(&set) > 0 && pthread_attr_setaffinity_np(attributes, sizeof set, &set) == 0;
}

fg_status fg_thread_start(fg_thread *thread, void *(*run)(void *), void *argument) {
  pthread_attr_t attributes;
  thread->run = run;
  thread->argument = argument;
  if (pthread_attr_init(&attributes) != 0) return FG_ERR_MEMORY;
  pthread_attr_setstacksize(&attributes, STACK_BYTES);
  int failed = 1;
  if (avoid_this_core(&attributes, &thread->allowed))
    failed = pthread_create(&thread->handle, &attributes, run_where_allowed, thread);
  pthread_attr_destroy(&attributes);
  if (!failed) return FG_OK;
  if (pthread_attr_init(&attributes) != 0) return FG_ERR_MEMORY;
  pthread_attr_setstacksize(&attributes, STACK_BYTES);
  failed = pthread_create(&thread->handle, &attributes, run, argument);
  pthread_attr_destroy(&attributes);
  return failed ? FG_ERR_MEMORY : FG_OK;
}

unsigned fg_core_count(void) {
  cpu_set_t allowed;
  if (pthread_getaffinity_np(pthread_self(), sizeof allowed, &allowed) == 0)
    return (unsigned)CPU_COUNT(&allowed);
  long cores = sysconf(_SC_NPROCESSORS_ONLN); /* more cores than the set has room for */
  return cores > 0 ? (unsigned)cores : 1;
}

void fg_thread_join(fg_thread *thread) {
  pthread_join(thread->handle, NULL);
}

typedef struct pool {
  fg_parallel_task *task;
  void *shared;
  size_t count;
  atomic_size_t next;
} pool;

typedef struct worker {
  pool *pool;
  fg_context context;
  fg_status status;
  size_t failed; /* item of the first error */
} worker;

static void *work_on_items(void *argument) {
  worker *w = argument;
  for (;;) {
    size_t item = atomic_fetch_add(&w->pool->next, 1);
    if (item >= w->pool->count) return NULL;
    fg_context context = {.message = ""};
    fg_status status = w->pool->task(&context, w->pool->shared, item);
    if (status != FG_OK && w->status == FG_OK) {
      w->status = status;
      w->failed = item;
      w->context = context;
    }
  }
}

fg_status fg_parallel_run(fg_context *ctx, unsigned threads, size_t count, fg_parallel_task *task,
                          void *shared) {
  pool p = {.task = task, .shared = shared, .count = count};
  worker workers[THREADS_MAX] = {0};
  fg_thread handles[THREADS_MAX];
  if (threads == 0) threads = fg_core_count();
  if (threads > THREADS_MAX) threads = THREADS_MAX;
  if (threads > count) threads = (unsigned)count;
  unsigned started = 0;
  for (unsigned i = 0; i < threads || i == 0; i++)
    workers[i].pool = &p;
  while (started + 1 < threads &&
         fg_thread_start(&handles[started], work_on_items, &workers[started + 1]) == FG_OK)
    started++;
  work_on_items(&workers[0]);
  const worker *first = NULL;
  for (unsigned i = 0; i < started; i++)
    fg_thread_join(&handles[i]);
  for (unsigned i = 0; i <= started; i++)
    if (workers[i].status != FG_OK && (!first || workers[i].failed < first->failed))
      first = &workers[i];
  return first ? fg_fail(ctx, first->status, "%s", first->context.message) : FG_OK;
}
