/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases that only add to others are left to the long tier; under sanitizers, which make tests many
 * times slower, there are fewer still. */
#ifndef FG_TESTS_BRIEF_H
#define FG_TESTS_BRIEF_H

#include <stdlib.h>

/* The step of a loop over many cases: 1 in the long tier, under sanitizers `brief`, else halfway.
 */
static inline unsigned test_step(unsigned brief) {
  if (getenv("FOILGAUGE_TEST_LONG")) return 1;
  return getenv("FOILGAUGE_TEST_BRIEF") ? brief : (brief + 1) / 2;
}

#endif
