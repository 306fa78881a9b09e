/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sanitizers make tests many times slower: what only adds cases is left to the other tree. */
#ifndef FG_TESTS_BRIEF_H
#define FG_TESTS_BRIEF_H

#include <stdlib.h>

/* 1; under sanitizers `brief`: the step of a loop over many cases. */
static inline unsigned test_step(unsigned brief) {
  return getenv("FOILGAUGE_TEST_BRIEF") ? brief : 1;
}

#endif
