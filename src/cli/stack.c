/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/stack.h"

#include <stddef.h>
#include <sys/mman.h>
#include <sys/resource.h>

/* SLACK: the stack in use already, and the gap below it. */
enum { RESERVED_BYTES = 2 << 20, SLACK_BYTES = 1 << 17 };

static __attribute__((noinline)) void touch_far_end(void) {
  char block[RESERVED_BYTES];
  __asm__ volatile("" : : "r"(block) : "memory"); /* it is there, for all that the compiler knows */
  *(volatile char *)block = 0;
}

bool fg_stack_reserve(void) {
  struct rlimit stack;
  if (getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < 2 * RESERVED_BYTES) return true;
  /* Growing would be fatal where it fails; asking for as much is not. */
  void *probe = mmap(NULL, RESERVED_BYTES + SLACK_BYTES, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED) return false;
  munmap(probe, RESERVED_BYTES + SLACK_BYTES);
  touch_far_end();
  return true;
}
