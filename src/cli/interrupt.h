/* Ctrl-C leaves no temporary files behind. */
#ifndef FG_CLI_INTERRUPT_H
#define FG_CLI_INTERRUPT_H

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "core/file.h"

/* From start to stop, SIGINT, SIGTERM and SIGHUP go to a thread that removes the temporary files
 * and ends the program with exit code 130. Start before other threads, so that they inherit the
 * blocked signals. A file size limit then is a write error and no signal. */
typedef struct fg_interrupt {
  char **temporaries; /* copies: an output forgets its own when it is committed */
  size_t count;
  sigset_t signals, before;
  pthread_t thread;
  atomic_bool stopping;
  bool running;
} fg_interrupt;

fg_status fg_interrupt_start(fg_context *ctx, const fg_output *outputs, size_t count,
                             fg_interrupt *interrupt);
void fg_interrupt_stop(fg_interrupt *interrupt); /* all zero is fine */

#endif
