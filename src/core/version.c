/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/version.h"

const char *fg_version(void) {
  return FOILGAUGE_VERSION;
}
