/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "foilgauge/file.h"

/* Told of a signal where a command ends itself (fg_interrupt_defer); -1: none does. */
static atomic_int deferred = -1;

int fg_interrupt_defer(void) {
  int told = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  atomic_store(&deferred, told);
  return told;
}

/* A command that ends itself does so within the time it has, or when it is asked again. */
static void leave_time(const sigset_t *signals) {
  const struct timespec limit = {.tv_sec = FG_INTERRUPT_SECONDS};
  uint64_t one = 1;
  int told = atomic_load(&deferred);
  if (told >= 0 && write(told, &one, sizeof one) == (ssize_t)sizeof one)
    sigtimedwait(signals, NULL, &limit);
}

static void *wait_for_signal(void *argument) {
  static const char words[] = "\nfoilgauge: interrupted\n";
  const sigset_t *signals = argument;
  int number, code = fg_status_exit_code(FG_ERR_INTERRUPTED);
  if (sigwait(signals, &number) != 0) return NULL;
  leave_time(signals);
  fg_temporaries_remove();
  if (write(STDERR_FILENO, words, sizeof words - 1) < 0) _exit(code);
  _exit(code);
}

static bool is_ignored(int number) {
  struct sigaction action;
  return sigaction(number, NULL, &action) == 0 && action.sa_handler == SIG_IGN;
}

void fg_interrupt_start(void) {
  enum { STACK_BYTES = 1 << 18 };
  static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
  static sigset_t signals;
  pthread_attr_t attributes;
  pthread_t thread;
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
  sigemptyset(&signals);
  for (size_t i = 0; i < sizeof ending / sizeof *ending; i++)
    if (!is_ignored(ending[i])) sigaddset(&signals, ending[i]);
  if (pthread_attr_init(&attributes) != 0) return;
  pthread_attr_setstacksize(&attributes, STACK_BYTES);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_sigmask(SIG_BLOCK, &signals, NULL);
  /* Without the thread a signal ends the program at once, by its default. */
  if (pthread_create(&thread, &attributes, wait_for_signal, &signals) != 0)
    pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
  pthread_attr_destroy(&attributes);
}
