/* Independent items spread over threads. */
#ifndef FG_CORE_PARALLEL_H
#define FG_CORE_PARALLEL_H

#include <stddef.h>

#include "foilgauge/status.h"

/* Works on one item; items must not touch each other's data. */
typedef fg_status fg_parallel_task(fg_context *ctx, void *shared, size_t item);

/* Runs task on items 0 to count-1, on up to `threads` threads (the caller's is one of them; 0: as
 * many as there are cores). Which thread takes which item is not defined; results must not depend
 * on it. Returns the error of the lowest item that failed. */
fg_status fg_parallel_run(fg_context *ctx, unsigned threads, size_t count, fg_parallel_task *task,
                          void *shared);

#endif
