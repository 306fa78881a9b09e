/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two numbers that must agree within a tolerance; cmocka 1.1.5 knows only float. */
#ifndef FG_TESTS_NEAR_H
#define FG_TESTS_NEAR_H

#include <math.h>

#define assert_near(got, wanted, tolerance)                                                        \
  do {                                                                                             \
    double got_ = (got), wanted_ = (wanted);                                                       \
    if (!(fabs(got_ - wanted_) <= (tolerance)))                                                    \
      fail_msg("%s is %.12g, not %.12g", #got, got_, wanted_);                                     \
  } while (0)

#endif
