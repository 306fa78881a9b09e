/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/relabelled_spread.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/splitmix.h"
#include "core/spread.h"

enum {
  VALUES_MIN = 3,       /* the distances of two values from their median are equal */
  ALL_MAX = 10000,      /* relabellings that are all counted */
  EXCEEDED_MAX = 100,   /* a p-value to a tenth of itself */
  EXCEEDED_FEW = 10,    /* a p-value that is hardly known */
  DEALT_MAX = 50000000, /* values dealt in all relabellings of large samples */
  DRAWS_MIN = 500
};

/* Statistics that differ by rounding only are the same. */
static const double ROUNDING = 1e-9;

enum { VARIANCES, LEVENE, STATISTICS };

typedef struct deal {
  double *value; /* deviations; the first sample's come first */
  size_t *order; /* of the values; its first `first` are the first sample's */
  double *dealt, *sorted;
  size_t first, count;
} deal;

/* Replaces the values by their distances from the median. */
static void replace_by_distances(double *value, double *sorted, size_t count) {
  memcpy(sorted, value, count * sizeof *sorted);
  double median = fg_median(sorted, count);
  for (size_t i = 0; i < count; i++)
    value[i] = fabs(value[i] - median);
}

static double or_zero(double value) {
  return isnan(value) ? 0 : value;
}

/* Levene's statistic without its constant factor, which relabelling leaves as it is. */
static void find_statistics(const deal *d, double statistic[STATISTICS]) {
  double *a = d->dealt, *b = a + d->first;
  size_t na = d->first, nb = d->count - d->first;
  for (size_t i = 0; i < d->count; i++)
    a[i] = d->value[d->order[i]];
  double va = fg_squares_about(a, na, fg_mean(a, na)) / (double)(na - 1),
         vb = fg_squares_about(b, nb, fg_mean(b, nb)) / (double)(nb - 1);
  statistic[VARIANCES] = or_zero(fabs(log(va / vb)));
  replace_by_distances(a, d->sorted, na);
  replace_by_distances(b, d->sorted, nb);
  double ma = fg_mean(a, na), mb = fg_mean(b, nb);
  statistic[LEVENE] =
      or_zero((ma - mb) * (ma - mb) / (fg_squares_about(a, na, ma) + fg_squares_about(b, nb, mb)));
}

typedef struct tally {
  double own[STATISTICS];
  double squares[STATISTICS]; /* sum over the relabelled samples, of deviates */
  size_t exceeded[STATISTICS], dealt[STATISTICS];
} tally;

/* Square of the deviate that a statistic is the size of: ln F; Levene's statistic is a square. */
static double square_of(int statistic, double value) {
  return statistic == VARIANCES ? value * value : value;
}

/* True where every statistic has been exceeded often enough. */
static bool count_exceeded(const deal *d, size_t enough, tally *t) {
  double statistic[STATISTICS];
  bool done = true;
  find_statistics(d, statistic);
  for (int s = 0; s < STATISTICS; s++) {
    if (t->exceeded[s] >= enough) continue;
    t->dealt[s]++;
    t->squares[s] += square_of(s, statistic[s]);
    t->exceeded[s] += statistic[s] >= t->own[s] * (1 - ROUNDING);
    done = done && t->exceeded[s] >= enough;
  }
  return done;
}

/* Returns true when the first sample can be chosen in at most ALL_MAX ways. */
static bool can_deal_all(size_t count, size_t first) {
  size_t chosen = first < count - first ? first : count - first;
  double ways = 1;
  for (size_t i = 0; i < chosen && ways <= ALL_MAX; i++)
    ways *= (double)(count - i) / (double)(i + 1);
  return ways <= ALL_MAX;
}

/* The next choice of the first sample in lexical order, the others behind it; false after the last.
 */
static bool choose_next(const deal *d) {
  size_t *chosen = d->order, i = d->first;
  while (i > 0 && chosen[i - 1] == d->count - d->first + i - 1)
    i--;
  if (!i) return false;
  chosen[i - 1]++;
  for (; i < d->first; i++)
    chosen[i] = chosen[i - 1] + 1;
  size_t *other = d->order + d->first;
  for (size_t k = 0, at = 0; k < d->count; k++) {
    if (at < d->first && chosen[at] == k)
      at++;
    else
      *other++ = k;
  }
  return true;
}

static size_t draw_below(uint64_t *seed, size_t limit) {
  return (size_t)((double)(fg_splitmix_next(seed) >> 11) * 0x1p-53 * (double)limit);
}

/* Shuffles the values: their order stays as it was at the begin. */
static void shuffle(const deal *d, uint64_t *seed) {
  for (size_t i = 0; i < d->first; i++) {
    size_t k = i + draw_below(seed, d->count - i);
    double kept = d->value[i];
    d->value[i] = d->value[k];
    d->value[k] = kept;
  }
}

/* The original labels count among those drawn, unless the drawing ended before; the complete
 * enumeration includes them. */
static double counted_p(const tally *t, int s, bool complete) {
  double exceeded = (double)t->exceeded[s], dealt = (double)t->dealt[s];
  bool own = !complete && t->exceeded[s] < EXCEEDED_MAX;
  return own ? (exceeded + 1) / (dealt + 1) : fmax(exceeded, 1) / dealt;
}

/* The deviate of a relabelled sample tends to a normal one as the samples grow (Hoeffding 1951).
 * The draws tell its scatter well, but far tails only by many more. */
static double tail_p(const tally *t, int s) {
  double scatter = t->squares[s] / (double)t->dealt[s];
  return erfc(sqrt(square_of(s, t->own[s]) / scatter / 2));
}

/* `t` holds the statistics of the original labels. */
static void relabel(const deal *d, size_t draws, tally *t, fg_relabelled_spread *result) {
  uint64_t seed = 1;
  double p[STATISTICS];
  size_t few = d->count > DEALT_MAX / DRAWS_MIN ? DRAWS_MIN : DEALT_MAX / d->count;
  bool cut = draws > few;
  result->complete = can_deal_all(d->count, d->first);
  if (result->complete) do
      count_exceeded(d, SIZE_MAX, t);
    while (choose_next(d));
  else
    for (size_t i = 0; i < (cut ? few : draws); i++) {
      shuffle(d, &seed);
      if (count_exceeded(d, EXCEEDED_MAX, t)) break;
    }
  for (int s = 0; s < STATISTICS; s++)
    p[s] = cut && t->exceeded[s] < EXCEEDED_FEW ? tail_p(t, s) : counted_p(t, s, result->complete);
  result->p_variances = p[VARIANCES];
  result->p_levene = p[LEVENE];
}

/* Returns the share of the difference of means that is removed, its significant part: 1 - 4 / t²,
 * and 0 below two standard errors. Removed completely, the values would lie nearer to their own
 * sample's median than any relabelled ones (Levene's p below 0.05 in 7 % of cases); left in, it
 * would widen the relabelled samples. */
static double share_taken(fg_sample a, fg_sample b, double mean_a, double mean_b) {
  static const double chance = 4;
  double na = (double)a.count, nb = (double)b.count;
  double square = fg_squares_about(a.values, a.count, mean_a) / (na * (na - 1)) +
                  fg_squares_about(b.values, b.count, mean_b) / (nb * (nb - 1));
  double t2 = (mean_a - mean_b) * (mean_a - mean_b) / square;
  return t2 > chance ? 1 - chance / t2 : 0;
}

/* About the common mean; a mean of its own that is taken out leaves (n - 1) / n of the variance. */
static void put_deviations(fg_sample sample, double mean, double common, double share,
                           double *value) {
  double n = (double)sample.count, widened = 1 + share * (sqrt(n / (n - 1)) - 1);
  for (size_t i = 0; i < sample.count; i++)
    value[i] = (sample.values[i] - common - share * (mean - common)) * widened;
}

/* False: there is no spread. */
static bool align(fg_sample a, fg_sample b, double *value) {
  double na = (double)a.count, nb = (double)b.count, mean_a = fg_mean(a.values, a.count),
         mean_b = fg_mean(b.values, b.count), common = (na * mean_a + nb * mean_b) / (na + nb);
  if (!(fg_squares_about(a.values, a.count, mean_a) + fg_squares_about(b.values, b.count, mean_b) >
        0))
    return false;
  double share = share_taken(a, b, mean_a, mean_b);
  put_deviations(a, mean_a, common, share, value);
  put_deviations(b, mean_b, common, share, value + a.count);
  return true;
}

fg_status fg_relabel_spreads(fg_context *ctx, fg_sample a, fg_sample b, size_t draws,
                             fg_relabelled_spread *result) {
  deal d = {.first = a.count, .count = a.count + b.count};
  tally t = {0};
  fg_status status = FG_OK;
  *result = (fg_relabelled_spread){.p_variances = NAN, .p_levene = NAN};
  if (a.count < VALUES_MIN || b.count < VALUES_MIN) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 3 * d.count, sizeof *d.value, (void **)&d.value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, d.count, sizeof *d.order, (void **)&d.order));
  d.dealt = d.value + d.count;
  d.sorted = d.dealt + d.count;
  for (size_t i = 0; i < d.count; i++)
    d.order[i] = i;
  memcpy(d.value, a.values, a.count * sizeof *d.value);
  memcpy(d.value + a.count, b.values, b.count * sizeof *d.value);
  find_statistics(&d, t.own);
  if (align(a, b, d.value)) relabel(&d, draws, &t, result);
exit:
  free(d.value);
  free(d.order);
  return status;
}
