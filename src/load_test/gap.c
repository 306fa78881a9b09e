/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gap: free travel between the places of foil contact, by extrapolating each side's loaded branch
 * to zero force. */
#include <math.h>

#include "core/small_solve.h"
#include "load_test/analysis.h"

/* Number of exponents tried. A foil's force over its compression y is c y^n with a second term for
 * curvature: n is 1 for a spring, more where bumps are touched one after the other, and at most 2.
 */
enum { EXPONENTS = 11 };
static const double exponent_min = 1, exponent_max = 2;

/* Range of forces of the fit. Low, because the branch is extrapolated to zero; but above the noise
 * and friction of a rotor in the gap, where up strokes read +a and down strokes -a. */
static const double noise_reach = 5, friction_reach = 2, low_share = 0.02;
static const double span = 8, high_share_min = 0.15, high_share_max = 0.7, span_min = 2,
                    span_growth = 1.25;

/* Maximum distance of a load cell's zero from the middle of the force's range, as a share of it.
 * Further out the flat place is a softer part of the foils, as behind an interference. */
static const double zero_share_max = 0.25;

/* Limit, in units of noise, of a negative friction at the zero (up strokes below down strokes).
 * Beyond it the zero is wrong: few samples of a rotor that jumps through the gap. */
static const double friction_noise = 3;

/* Minimum number of samples of each sense in a branch; it is extended until it has them. */
enum { SAMPLES_MIN = 10 };

/* x = x0 + p e + q e² + s (g + h e), e = F^(1/n), s the stroke's sense: the last two terms are the
 * friction between loading and unloading. */
enum { CONTACT, GROWTH, BEND, PARTED, PARTED_GROWTH, TERMS };

/* One side's branch, its force and travel outwards. */
typedef struct branch {
  const fg_load_strokes *strokes;
  int side; /* +1: push, -1: pull */
  double zero_n, low_n, high_n, origin_mm;
  double from_mm;  /* the foil is touched no further inwards */
  double count[2]; /* samples of loading, of unloading */
} branch;

/* A sample of the branch; false: it is none. */
static bool sample_of_branch(const branch *b, const fg_load_stroke *s, size_t k, double *force,
                             double *x) {
  *force = b->side * (s->f[k] - b->zero_n);
  double out = b->side * (s->x[k] - s->shift_mm);
  *x = out - b->origin_mm;
  return *force > b->low_n && *force < b->high_n && out > b->from_mm;
}

/* Returns true when the branch has enough samples. Their mean becomes the origin, so that sums of
 * squares keep their digits. */
static bool count_samples(branch *b) {
  double force, x, sum = 0;
  b->count[0] = b->count[1] = b->origin_mm = 0;
  for (size_t i = 0; i < b->strokes->count; i++)
    for (size_t k = 0; k < b->strokes->stroke[i].count; k++)
      if (sample_of_branch(b, &b->strokes->stroke[i], k, &force, &x)) {
        b->count[b->strokes->stroke[i].sense != b->side]++;
        sum += x;
      }
  b->origin_mm = sum / (b->count[0] + b->count[1]);
  return b->count[0] >= SAMPLES_MIN && b->count[1] >= SAMPLES_MIN;
}

/* `yield_mm`: maximum deflection of the foils under the threshold. */
static branch make_branch(const fg_load_strokes *strokes, int side, fg_load_zero zero,
                          double yield_mm, const fg_load_direction *d) {
  branch b = {.strokes = strokes, .side = side};
  b.from_mm = (side > 0 ? d->push_mm : -d->pull_mm) - yield_mm;
  if (!isfinite(b.from_mm)) b.from_mm = -INFINITY;
  double range = d->force_high_n - d->force_low_n, middle = (d->force_high_n + d->force_low_n) / 2;
  bool known = fabs(zero.force_n - middle) < zero_share_max * range &&
               zero.friction_n > -friction_noise * strokes->noise_n;
  double friction = known ? fmax(0, zero.friction_n) : 0;
  b.zero_n = known ? zero.force_n : 0;
  double max = side > 0 ? d->force_high_n - b.zero_n : b.zero_n - d->force_low_n;
  b.low_n = fmax(fmax(friction_reach * friction, friction + noise_reach * strokes->noise_n),
                 low_share * max);
  b.high_n = fmin(fmax(span * b.low_n, high_share_min * max), high_share_max * max);
  while (!count_samples(&b) && b.high_n < high_share_max * max)
    b.high_n = fmin(span_growth * b.high_n, high_share_max * max);
  return b;
}

typedef struct branch_fit {
  double contact, variance; /* x0, and of x0 over the samples' variance */
  double parted, squares;   /* g; of the residuals */
} branch_fit;

static bool fit_exponent(const branch *b, double exponent, branch_fit *fit) {
  fg_normal_equations system;
  double solution[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], force, x;
  fg_normal_clear(&system, TERMS);
  for (size_t i = 0; i < b->strokes->count; i++) {
    const fg_load_stroke *s = &b->strokes->stroke[i];
    double sense = s->sense == b->side ? 1 : -1;
    for (size_t k = 0; k < s->count; k++) {
      if (!sample_of_branch(b, s, k, &force, &x)) continue;
      double e = pow(force / b->high_n, 1 / exponent);
      fg_normal_add(&system, (const double[TERMS]){1, e, e * e, sense, sense * e}, x, 1);
    }
  }
  if (!fg_normal_solve(&system, 0, solution, inverse)) return false;
  fit->contact = solution[CONTACT];
  fit->variance = inverse[CONTACT][CONTACT];
  fit->parted = solution[PARTED];
  fit->squares = system.sum_squares;
  for (int k = 0; k < TERMS; k++)
    fit->squares -= solution[k] * system.right[k];
  fit->squares = fmax(0, fit->squares);
  return true;
}

/* Contact with one foil: its place outward, its u by noise and friction, and half of the range over
 * the exponents, an error common to both sides. */
typedef struct touched {
  double x_mm, u_mm, model_mm;
} touched;

/* Weights exponents by their fit. But friction that reverses at the contact bends the branch as an
 * exponent does, so half of the weight is equal for all of them. */
static touched weigh_exponents(const branch *b, const branch_fit fits[EXPONENTS]) {
  double min = INFINITY, low = INFINITY, high = -INFINITY, weights = 0;
  double contact = 0, variance = 0, parted = 0, plain = 0;
  for (int i = 0; i < EXPONENTS; i++) {
    min = fmin(min, fits[i].squares);
    low = fmin(low, fits[i].contact), high = fmax(high, fits[i].contact);
    plain += fits[i].contact / EXPONENTS;
  }
  double noise = min / (b->count[0] + b->count[1] - TERMS);
  for (int i = 0; i < EXPONENTS; i++) {
    double more = fits[i].squares - min, w = more > 0 ? exp(-more / (2 * noise)) : 1;
    weights += w;
    contact += w * fits[i].contact;
    variance += w * noise * fits[i].variance;
    parted += w * fits[i].parted;
  }
  return (touched){b->origin_mm + (contact / weights + plain) / 2,
                   hypot(sqrt(variance / weights), parted / weights), (high - low) / 2};
}

/* False: too few samples. */
static bool find_touched(const branch *b, touched *out) {
  branch_fit fits[EXPONENTS];
  if (b->count[0] < SAMPLES_MIN || b->count[1] < SAMPLES_MIN) return false;
  if (!(b->high_n > span_min * b->low_n)) return false;
  for (int i = 0; i < EXPONENTS; i++) {
    double exponent = exponent_min + (exponent_max - exponent_min) * i / (EXPONENTS - 1);
    if (!fit_exponent(b, exponent, &fits[i])) return false;
  }
  *out = weigh_exponents(b, fits);
  return isfinite(out->x_mm + out->u_mm);
}

void fg_load_find_gap(const fg_load_strokes *strokes, fg_load_zero zero, double yield_mm,
                      fg_load_direction *d) {
  touched push, pull;
  d->gap = (fg_load_value){NAN, NAN, NAN};
  branch out = make_branch(strokes, 1, zero, yield_mm, d);
  branch back = make_branch(strokes, -1, zero, yield_mm, d);
  if (!find_touched(&out, &push) || !find_touched(&back, &pull)) return;
  d->gap.value = push.x_mm + pull.x_mm;
  d->gap.u_repeat =
      sqrt(pow(push.u_mm, 2) + pow(pull.u_mm, 2) + pow(push.model_mm + pull.model_mm, 2));
}
