/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Independent items spread over threads. */
#ifndef FG_CORE_PARALLEL_H
#define FG_CORE_PARALLEL_H

#include <pthread.h>
#include <sched.h>
#include <stddef.h>

#include "foilgauge/status.h"

/* A thread that starts on another core than the caller's, where there is one, and may then run on
 * every core of the caller (taskset). A new thread is queued on its parent's core and waits there
 * for a time slice (some milliseconds) while other cores idle: that is as long as a whole stage of
 * a measurement. */
typedef struct fg_thread {
  pthread_t handle;
  void *(*run)(void *);
  void *argument;
  cpu_set_t allowed; /* the caller's cores */
} fg_thread;

/* `thread` must keep its address until it is joined. FG_ERR_MEMORY when the system gives no thread;
 * the caller can then do the work itself. */
fg_status fg_thread_start(fg_thread *thread, void *(*run)(void *), void *argument);
void fg_thread_join(fg_thread *thread);

/* Returns the number of cores that the caller may run on. */
unsigned fg_core_count(void);

/* Works on one item; items must not touch each other's data. */
typedef fg_status fg_parallel_task(fg_context *ctx, void *shared, size_t item);

/* Runs task on items 0 to count-1, on up to `threads` threads (the caller's is one of them; 0:
 * fg_core_count). The assignment of items to threads is not defined; results must not depend on it.
 * Returns the error of the lowest item that failed. */
fg_status fg_parallel_run(fg_context *ctx, unsigned threads, size_t count, fg_parallel_task *task,
                          void *shared);

#endif
