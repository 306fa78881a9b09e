#include "core/spread.h"

#include <math.h>

#include "core/select.h"

static const double sd_per_median = 1.4826;

fg_spread fg_spread_of(double *sizes, size_t count) {
  if (!count) return (fg_spread){NAN, NAN, NAN};
  size_t last = count - 1;
  double low = fg_select(sizes, count, last / 2), high = fg_select(sizes, count, count / 2);
  return (fg_spread){.robust_sd = sd_per_median * (low + high) / 2,
                     .p95 = fg_select(sizes, count, last * 95 / 100),
                     .maximum = fg_select(sizes, count, last)};
}

double fg_spread_limit(double *sizes, size_t count, double deviations) {
  return count ? deviations * sd_per_median * fg_select(sizes, count, count / 2) : INFINITY;
}
