/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/numerics.h"

#include <gsl/gsl_errno.h>
#include <pthread.h>

static void turn_handler_off(void) {
  gsl_set_error_handler_off();
}

void fg_numerics_start(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, turn_handler_off);
}
