/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/heap.h"

#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MIB = 1 << 20, HUGE_PAGE = 2 * MIB, FIRST_HEAP = 16 * MIB };

/* One foil takes some 10 MiB, in pages of 4 KiB each of which the system clears when it is first
 * touched: a twentieth of the time of a measurement. Huge pages take a fifth of that. Where the
 * system has none, all is as without. */
static void ask_for_huge_pages(void) {
  mallopt(M_TOP_PAD, FIRST_HEAP);
  void *first = malloc(MIB);
  uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), begin = (uintptr_t)first / page * page,
            end = (uintptr_t)sbrk(0) / HUGE_PAGE * HUGE_PAGE;
  if (first && begin < end && end - begin <= 2 * FIRST_HEAP)
    madvise((void *)begin, end - begin, MADV_HUGEPAGE);
  free(first);
}

void fg_heap_start(void) {
  /* Else every thread reserves 64 MiB of address space for itself, which counts where that is
   * limited. */
  mallopt(M_ARENA_MAX, 2);
  /* Memory that is given back to the system after every step is cleared by it for the next. */
  mallopt(M_TRIM_THRESHOLD, 64 * MIB);
  mallopt(M_MMAP_THRESHOLD, 4 * MIB);
  ask_for_huge_pages();
  mallopt(M_TOP_PAD, MIB);
}
