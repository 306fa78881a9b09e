/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The distance of a value to its limits. */
#include <math.h>

#include "foilgauge/design.h"

fg_margin fg_margin_to(double lower, double upper, double value) {
  double below = value - lower, above = upper - value;
  bool is_upper = isfinite(upper) && !(isfinite(lower) && below < above);
  if (!isfinite(lower) && !isfinite(upper)) is_upper = true;
  return (fg_margin){is_upper ? upper : lower, is_upper ? above : below, is_upper};
}
