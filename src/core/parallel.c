#include "core/parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

enum { THREADS_MAX = 64 };

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

static void *work(void *argument) {
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
  pthread_t handles[THREADS_MAX];
  if (threads == 0) threads = (unsigned)sysconf(_SC_NPROCESSORS_ONLN);
  if (threads > THREADS_MAX) threads = THREADS_MAX;
  if (threads > count) threads = (unsigned)count;
  unsigned started = 0;
  for (unsigned i = 0; i < threads || i == 0; i++) workers[i].pool = &p;
  while (started + 1 < threads &&
         pthread_create(&handles[started], NULL, work, &workers[started + 1]) == 0)
    started++;
  work(&workers[0]);
  const worker *first = NULL;
  for (unsigned i = 0; i < started; i++) pthread_join(handles[i], NULL);
  for (unsigned i = 0; i <= started; i++)
    if (workers[i].status != FG_OK && (!first || workers[i].failed < first->failed))
      first = &workers[i];
  return first ? fg_fail(ctx, first->status, "%s", first->context.message) : FG_OK;
}
