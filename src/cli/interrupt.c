#include "cli/interrupt.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/memory.h"

/* Wakes the thread to its end. pthread_cancel would load a library first, which fails, and ends the
 * program, where there is no memory. */
enum { STOP = SIGUSR1 };

static void *wait_for_signal(void *argument) {
  static const char words[] = "\nfoilgauge: interrupted\n";
  const fg_interrupt *interrupt = argument;
  int number;
  do
    if (sigwait(&interrupt->signals, &number) != 0) return NULL;
  while (number == STOP && !atomic_load(&interrupt->stopping));
  if (number == STOP) return NULL;
  for (size_t i = 0; i < interrupt->count; i++)
    if (interrupt->temporaries[i]) unlink(interrupt->temporaries[i]);
  if (write(STDERR_FILENO, words, sizeof words - 1) < 0) _exit(130);
  _exit(130);
}

fg_status fg_interrupt_start(fg_context *ctx, const fg_output *outputs, size_t count,
                             fg_interrupt *interrupt) {
  void *block;
  *interrupt = (fg_interrupt){0};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *interrupt->temporaries, &block));
  interrupt->temporaries = block;
  interrupt->count = count;
  for (size_t i = 0; i < count; i++) {
    if (!outputs[i].temporary) continue;
    interrupt->temporaries[i] = strdup(outputs[i].temporary);
    if (!interrupt->temporaries[i]) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a path");
  }
  signal(SIGXFSZ, SIG_IGN);
  sigemptyset(&interrupt->signals);
  sigaddset(&interrupt->signals, SIGINT);
  sigaddset(&interrupt->signals, SIGTERM);
  sigaddset(&interrupt->signals, SIGHUP);
  sigaddset(&interrupt->signals, STOP);
  pthread_sigmask(SIG_BLOCK, &interrupt->signals, &interrupt->before);
  interrupt->running = pthread_create(&interrupt->thread, NULL, wait_for_signal, interrupt) == 0;
  if (!interrupt->running) pthread_sigmask(SIG_SETMASK, &interrupt->before, NULL);
  return FG_OK;
}

void fg_interrupt_stop(fg_interrupt *interrupt) {
  if (interrupt->running) {
    atomic_store(&interrupt->stopping, true);
    pthread_kill(interrupt->thread, STOP);
    pthread_join(interrupt->thread, NULL);
    pthread_sigmask(SIG_SETMASK, &interrupt->before, NULL);
  }
  for (size_t i = 0; i < interrupt->count; i++)
    free(interrupt->temporaries[i]);
  free(interrupt->temporaries);
  *interrupt = (fg_interrupt){0};
}
