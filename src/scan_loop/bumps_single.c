/* Bumps that stand apart from the others by their numbers: a few of them, or a cycle over them. A
 * whole bump that is raised is taken by the geometry, which has a circle for every bump; here its
 * radius and its angle are held against those of the others.
 *
 * Every number's mean over the foils is one value. The null is normal scatter: the same search over
 * drawn values, as often. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/text.h"
#include "loop/engine_random.h"
#include "scan_loop/bumps.h"

/* Draws of the null; the probability over both forms and both responses below which a deviation is
 * told. A foil without any must not be given one: a fifth of what the listed effects may take. */
enum { DRAWS = 4999, LEAST_NUMBERS = 6, MOST_NUMBERS = 64 };
static const double accept_p = 0.2 * FG_LOOP_ACCEPT_P;
/* Of all bumps, at most this share stands apart from the others; more are two kinds of bumps. */
static const double largest_share = 1.0 / 3;
/* Cycles over the bumps are tried in such steps, from two cycles up to a period of two bumps. */
static const double cycle_step = 0.25;

typedef struct numbers {
  size_t n;
  double number[MOST_NUMBERS], value[MOST_NUMBERS];
} numbers;

/* What explains the values: some that stand apart by `by`, or a cycle. `gain`: its sum of squares
 * over what it leaves, each per degree of freedom. */
typedef struct pattern {
  double gain, by, period, cosine, sine;
  bool apart[MOST_NUMBERS];
  size_t count;
} pattern;

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double gain_of(double taken, double columns, double whole, size_t n) {
  double left = fmax(whole - taken, 1e-12 * whole);
  return whole > 0 ? taken / columns / (left / ((double)n - 1 - columns)) : 0;
}

static double square_about_mean(const double *value, size_t n, double *mean) {
  double sum = 0;
  *mean = 0;
  for (size_t i = 0; i < n; i++)
    *mean += value[i] / (double)n;
  for (size_t i = 0; i < n; i++)
    sum += (value[i] - *mean) * (value[i] - *mean);
  return sum;
}

/* The best few are the largest or the smallest. `limit`: the value from which on they stand apart,
 * above it for by > 0, below it for by < 0. */
static double best_apart(const double *value, size_t n, double *by, double *limit) {
  double sorted[MOST_NUMBERS], mean, best = 0;
  double whole = square_about_mean(value, n, &mean);
  for (size_t i = 0; i < n; i++)
    sorted[i] = value[i];
  qsort(sorted, n, sizeof *sorted, ascending);
  size_t most = (size_t)(largest_share * (double)n);
  for (int top = 0; top < 2; top++) {
    double sum = 0;
    for (size_t k = 1; k <= most; k++) {
      size_t last = top ? n - k : k - 1;
      sum += sorted[last] - mean;
      double of = (double)k * (double)(n - k) / (double)n; /* of the two means' difference */
      double d = sum / (double)k + sum / (double)(n - k);
      double gain = gain_of(of * d * d, 1, whole, n);
      if (gain <= best) continue;
      best = gain;
      *by = d;
      *limit = sorted[last];
    }
  }
  return best;
}

/* Least squares of a cosine and a sine beside the mean. */
static double cycle_gain(const numbers *at, const double *value, double period, pattern *to) {
  double c[MOST_NUMBERS], s[MOST_NUMBERS], mean[3], whole = square_about_mean(value, at->n, mean);
  for (size_t i = 0; i < at->n; i++) {
    c[i] = cos(2 * M_PI * at->number[i] / period);
    s[i] = sin(2 * M_PI * at->number[i] / period);
  }
  double cc = square_about_mean(c, at->n, &mean[1]), ss = square_about_mean(s, at->n, &mean[2]);
  double cs = 0, cv = 0, sv = 0;
  for (size_t i = 0; i < at->n; i++) {
    cs += (c[i] - mean[1]) * (s[i] - mean[2]);
    cv += (c[i] - mean[1]) * (value[i] - mean[0]);
    sv += (s[i] - mean[2]) * (value[i] - mean[0]);
  }
  double det = cc * ss - cs * cs;
  if (!(det > 1e-6 * cc * (double)at->n)) return 0; /* a period of two: one column */
  to->cosine = (cv * ss - sv * cs) / det;
  to->sine = (sv * cc - cv * cs) / det;
  to->period = period;
  return gain_of(to->cosine * cv + to->sine * sv, 2, whole, at->n);
}

static double best_cycle(const numbers *at, const double *value, pattern *best) {
  double range = at->number[at->n - 1] - at->number[0] + 1, most = 0;
  for (double cycles = 2; cycles <= range / 2; cycles += cycle_step) {
    pattern one = {0};
    double gain = cycle_gain(at, value, range / cycles, &one);
    if (gain <= most) continue;
    most = gain;
    *best = one;
  }
  return most;
}

static pattern find_apart(const numbers *at) {
  pattern found = {0};
  double limit = 0;
  found.gain = best_apart(at->value, at->n, &found.by, &limit);
  for (size_t i = 0; i < at->n; i++) {
    found.apart[i] = found.by > 0 ? at->value[i] >= limit : at->value[i] <= limit;
    found.count += found.apart[i];
  }
  return found;
}

static pattern find_cycle(const numbers *at) {
  pattern found = {0};
  double gain = best_cycle(at, at->value, &found);
  found.gain = gain;
  found.by = hypot(found.cosine, found.sine);
  return found;
}

/* Share of draws of normal scatter in which either form does as well as it does here. */
static void find_p(const numbers *at, uint64_t seed, const double gain[2], double p[2]) {
  size_t beyond[2] = {1, 1};
  for (size_t d = 0; d < DRAWS; d++) {
    double value[MOST_NUMBERS], by, limit;
    pattern one;
    for (size_t i = 0; i < at->n; i++)
      value[i] = fg_engine_random_normal(&seed);
    beyond[0] += best_apart(value, at->n, &by, &limit) >= gain[0];
    beyond[1] += best_cycle(at, value, &one) >= gain[1];
  }
  for (int form = 0; form < 2; form++)
    p[form] = (double)beyond[form] / (DRAWS + 1);
}

/* ---- of a level ---- */

/* Means of the numbers over the foils, each foil about its own mean, beside what was found. */
static bool collect(const fg_scan_loop_bumps *bumps, const fg_scan_loop_bump_level *level,
                    size_t coordinate, numbers *out) {
  const fg_loop_problem *problem = &level->problem.problem;
  const double *number = problem->coordinate[coordinate].value;
  double count[MOST_NUMBERS] = {0};
  *out = (numbers){0};
  for (size_t i = 0; i < problem->rows; i++) {
    size_t part = bumps->bump[level->problem.row[i]].part, k = 0;
    double mean = 0, n = 0;
    if (problem->aside[i]) continue;
    for (size_t j = 0; j < problem->rows; j++)
      if (!problem->aside[j] && bumps->bump[level->problem.row[j]].part == part) {
        mean += problem->residual[j] - level->result.effect_fit[j];
        n++;
      }
    while (k < out->n && out->number[k] < number[i])
      k++;
    if (k == out->n || out->number[k] != number[i]) {
      if (out->n == MOST_NUMBERS) return false;
      for (size_t m = out->n++; m > k; m--) {
        out->number[m] = out->number[m - 1];
        out->value[m] = out->value[m - 1];
        count[m] = count[m - 1];
      }
      out->number[k] = number[i];
      out->value[k] = count[k] = 0;
    }
    out->value[k] += problem->residual[i] - level->result.effect_fit[i] - mean / n;
    count[k]++;
  }
  for (size_t k = 0; k < out->n; k++)
    out->value[k] /= count[k];
  return out->n >= LEAST_NUMBERS;
}

static double value_of(const pattern *found, const numbers *at, size_t k) {
  double turn = found->period > 0 ? 2 * M_PI * at->number[k] / found->period : 0;
  return found->period > 0 ? found->cosine * cos(turn) + found->sine * sin(turn)
         : found->apart[k] ? found->by
                           : 0;
}

static fg_status put_curve(fg_context *ctx, const numbers *at, const pattern *found, double p_value,
                           size_t coordinate, fg_loop_result *result) {
  fg_loop_curve *curve = &result->curve;
  double square = 0;
  free(curve->shape);
  *curve = (fg_loop_curve){.coordinate = coordinate, .p_value = p_value};
  fg_text_clip(curve->name, sizeof curve->name, "bump");
  FG_TRY(fg_memory_allocate(ctx, at->n, sizeof *curve->shape, (void **)&curve->shape));
  for (size_t k = 0; k < at->n; k++) {
    curve->shape[k][0] = at->number[k];
    curve->shape[k][1] = value_of(found, at, k);
    square += curve->shape[k][1] * curve->shape[k][1];
  }
  curve->count = at->n;
  curve->rms = sqrt(square / (double)at->n);
  result->has_curve = true;
  return FG_OK;
}

/* "3, 6, 9 (every 3rd)" */
static void list_numbers(const pattern *found, const numbers *at, char *words, size_t size) {
  size_t used = 0, seen = 0;
  double last = 0, step = 0;
  bool even = true;
  words[0] = 0;
  for (size_t k = 0; k < at->n && used + 1 < size; k++) {
    if (!found->apart[k]) continue;
    used += (size_t)snprintf(words + used, size - used, "%s%g", used ? ", " : "", at->number[k]);
    if (seen == 1) step = at->number[k] - last;
    even = even && (seen < 2 || at->number[k] - last == step);
    last = at->number[k];
    seen++;
  }
  if (seen > 2 && even && step > 1 && used + 1 < size)
    snprintf(words + used, size - used, ", every %g%s,", step,
             step == 2   ? "nd"
             : step == 3 ? "rd"
                         : "th");
}

static fg_status say(fg_context *ctx, fg_scan_loop_bumps *bumps, size_t response, const numbers *at,
                     const pattern *found) {
  const fg_scan_loop_bump_response *what = &fg_scan_loop_bump_responses[response];
  char words[200];
  if (found->period > 0)
    return fg_scan_loop_bumps_note(ctx, bumps, "bumps: %s repeats every %.3g bumps, by +-%.3g %s",
                                   what->name, found->period, what->scale * found->by, what->unit);
  list_numbers(found, at, words, sizeof words);
  return fg_scan_loop_bumps_note(
      ctx, bumps, "bumps: %s of bump%s %s differs from that of the others by %.3g %s", what->name,
      found->count > 1 ? "s" : "", words, what->scale * found->by, what->unit);
}

static bool find_coordinate(const fg_loop_problem *problem, size_t *coordinate) {
  for (size_t c = 0; c < problem->coordinates; c++)
    if (problem->coordinate[c].roles & FG_LOOP_BUMP) {
      *coordinate = c;
      return true;
    }
  return false;
}

fg_status fg_scan_loop_bumps_find_single(fg_context *ctx, fg_scan_loop_bumps *bumps,
                                         size_t response, uint64_t seed) {
  enum { FORMS = 2 };
  fg_scan_loop_bump_level *level = &bumps->level[response];
  size_t coordinate;
  numbers at;
  if (level->result.has_curve || !find_coordinate(&level->problem.problem, &coordinate) ||
      !collect(bumps, level, coordinate, &at))
    return FG_OK;
  const pattern found[FORMS] = {find_apart(&at), find_cycle(&at)};
  const double gain[FORMS] = {found[0].gain, found[1].gain};
  double p[FORMS];
  find_p(&at, seed, gain, p);
  int best = p[1] < p[0] || (p[1] == p[0] && gain[1] > gain[0]);
  double p_value = fmin(1, FORMS * FG_SCAN_LOOP_BUMP_RESPONSES * p[best]);
  if (!(p_value < accept_p) || !(fabs(found[best].by) > level->least)) return FG_OK;
  FG_TRY(put_curve(ctx, &at, &found[best], p_value, coordinate, &level->result));
  return say(ctx, bumps, response, &at, &found[best]);
}
