/* How large the sizes of residuals are. */
#ifndef FG_CORE_SPREAD_H
#define FG_CORE_SPREAD_H

#include <stddef.h>

/* robust_sd: 1.4826 times the median (of an even number the mean of the two in the middle), the
 * standard deviation of a normal distribution that has this median of sizes; p95: the value at
 * place 0.95 (count - 1), rounded down, of the ascending sizes from place 0; the largest. */
typedef struct fg_spread {
  double robust_sd, p95, maximum;
} fg_spread;

/* Of |residual|; reorders them. All NaN when there are none. */
fg_spread fg_spread_of(double *sizes, size_t count);

/* So many robust standard deviations of what has these sizes (1.4826 times the upper median each);
 * INFINITY when there are none. Reorders them. */
double fg_spread_limit(double *sizes, size_t count, double deviations);

#endif
