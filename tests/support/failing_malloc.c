/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Preloaded into the program: the allocation of a given number, counted from main, fails.
 *
 * FOILGAUGE_FAIL_AT=N: the Nth fails, and all those after it when FOILGAUGE_FAIL_ON is set; 0:
 * none, and the number of allocations goes to standard error at the end.
 */
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *block, size_t size);

static atomic_long counted;
static atomic_bool counting;
static long fail_at;
static int fail_on;
static int (*real_main)(int, char **, char **);

static int fails(void) {
  if (!atomic_load(&counting)) return 0;
  long number = atomic_fetch_add(&counted, 1) + 1;
  if (!fail_at || (fail_on ? number < fail_at : number != fail_at)) return 0;
  errno = ENOMEM;
  return 1;
}

void *malloc(size_t size) {
  return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
  return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
  return fails() ? NULL : __libc_realloc(block, size);
}

static int counted_main(int argc, char **argv, char **environment) {
  const char *text = getenv("FOILGAUGE_FAIL_AT");
  fail_at = text ? atol(text) : 0;
  fail_on = getenv("FOILGAUGE_FAIL_ON") != NULL;
  atomic_store(&counting, 1);
  int code = real_main(argc, argv, environment);
  atomic_store(&counting, 0);
  if (!fail_at) fprintf(stderr, "allocations: %ld\n", atomic_load(&counted));
  return code;
}

int __libc_start_main(int (*main)(int, char **, char **), int argc, char **argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void *stack_end) {
  typedef int start(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void),
                    void (*)(void), void *);
  start *real = NULL;
  *(void **)&real = dlsym(RTLD_NEXT, "__libc_start_main");
  real_main = main;
  return real(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}
