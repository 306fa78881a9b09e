/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/numerics.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <pthread.h>

#include "foilgauge/design.h"

static void turn_handler_off(void) {
  gsl_set_error_handler_off();
}

void fg_numerics_start(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, turn_handler_off);
}

fg_margin fg_margin_to(double lower, double upper, double value) {
  double below = value - lower, above = upper - value;
  bool is_upper = isfinite(upper) && !(isfinite(lower) && below < above);
  if (!isfinite(lower) && !isfinite(upper)) is_upper = true;
  return (fg_margin){is_upper ? upper : lower, is_upper ? above : below, is_upper};
}
