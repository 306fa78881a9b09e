/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/digits.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 5^27 is the largest power of five below 2^63: times a mantissa of 53 bits it fits into 128, so
 * that scaling by such a power of ten is exact, ties included. Other values are left to printf. */
enum { FRACTION_BITS = 52, EXPONENT_BIAS = 1023, POWERS = 28, DIGITS_MAX = 17 };

__extension__ typedef unsigned __int128 wide;

static const uint64_t power_of_five[POWERS] = {
    1u,
    5u,
    25u,
    125u,
    625u,
    3125u,
    15625u,
    78125u,
    390625u,
    1953125u,
    9765625u,
    48828125u,
    244140625u,
    1220703125u,
    6103515625u,
    30517578125u,
    152587890625u,
    762939453125u,
    3814697265625u,
    19073486328125u,
    95367431640625u,
    476837158203125u,
    2384185791015625u,
    11920928955078125u,
    59604644775390625u,
    298023223876953125u,
    1490116119384765625u,
    7450580596923828125u,
};

static const uint64_t power_of_ten[DIGITS_MAX + 1] = {1u,
                                                      10u,
                                                      100u,
                                                      1000u,
                                                      10000u,
                                                      100000u,
                                                      1000000u,
                                                      10000000u,
                                                      100000000u,
                                                      1000000000u,
                                                      10000000000u,
                                                      100000000000u,
                                                      1000000000000u,
                                                      10000000000000u,
                                                      100000000000000u,
                                                      1000000000000000u,
                                                      10000000000000000u,
                                                      100000000000000000u};

/* `value` as its first digits, a whole number, times 10^(exponent + 1 - digits). */
typedef struct decimal {
  uint64_t first;
  int exponent;
} decimal;

/* Scales mantissa × 2^binary by 10^power and rounds it to nearest, ties to even. *whole: cut off in
 * place of rounded. */
static uint64_t scale(uint64_t mantissa, int binary, int power, uint64_t *whole) {
  wide product = (wide)mantissa * power_of_five[power];
  int shift = -(binary + power); /* of the product to the right */
  if (shift <= 0) return *whole = (uint64_t)(product << -shift);
  wide below = product >> shift, rest = product - (below << shift), half = (wide)1 << (shift - 1);
  *whole = (uint64_t)below;
  return *whole + (rest > half || (rest == half && *whole & 1));
}

/* False: beyond the powers of five. `value` is above 0. */
static bool find_decimal(double value, int digits, decimal *d) {
  uint64_t bits, whole;
  memcpy(&bits, &value, sizeof bits);
  uint64_t hidden = (uint64_t)1 << FRACTION_BITS, mantissa = (bits & (hidden - 1)) | hidden;
  int binary = (int)(bits >> FRACTION_BITS) - EXPONENT_BIAS;
  if (binary == -EXPONENT_BIAS) return false;             /* subnormal */
  d->exponent = (int)floor(binary * 0.30102999566398120); /* that of 2^binary; or it is one more */
  for (int turn = 0; turn < 2; turn++, d->exponent++) {
    int power = digits - 1 - d->exponent;
    if (power < 0 || power >= POWERS) return false;
    d->first = scale(mantissa, binary - FRACTION_BITS, power, &whole);
    if (whole < power_of_ten[digits]) break;
  }
  if (d->first == power_of_ten[digits]) {
    d->first = power_of_ten[digits - 1];
    d->exponent++;
  }
  return true;
}

/* Writes the digits and returns how many are left without trailing zeros. */
static int write_first(char first[DIGITS_MAX], int digits, uint64_t number) {
  for (int i = digits; i-- > 0; number /= 10)
    first[i] = (char)('0' + number % 10);
  while (digits > 1 && first[digits - 1] == '0')
    digits--;
  return digits;
}

static char *put_fraction(char *at, const char *first, int count) {
  if (count <= 0) return at;
  *at++ = '.';
  memcpy(at, first, (size_t)count);
  return at + count;
}

/* Writes 0.0001 to 10^digits without an exponent, as %g does. */
static char *put_decimal(char *at, const char *first, int count, int exponent) {
  if (exponent < 0) {
    memcpy(at, "0.0000", 6);
    at += 1 - exponent;
    memcpy(at, first, (size_t)count);
    return at + count;
  }
  int before = exponent + 1, there = count < before ? count : before;
  memcpy(at, first, (size_t)there);
  memset(at + there, '0', (size_t)(before - there));
  return put_fraction(at + before, first + there, count - there);
}

static char *put_exponent(char *at, int exponent) {
  *at++ = 'e';
  *at++ = exponent < 0 ? '-' : '+';
  exponent = exponent < 0 ? -exponent : exponent;
  *at++ = (char)('0' + exponent / 10);
  *at++ = (char)('0' + exponent % 10);
  return at;
}

static void print_digits(char text[FG_DIGITS_TEXT], int digits, double value) {
  snprintf(text, FG_DIGITS_TEXT, "%.*g", digits, value + 0.0); /* + 0.0: never "-0" */
}

/* A host program's locale may write a comma. */
static void write_point(char text[FG_DIGITS_TEXT]) {
  char *comma = strchr(text, ',');
  if (comma) *comma = '.';
}

void fg_digits_format(char text[FG_DIGITS_TEXT], int digits, double value) {
  char first[DIGITS_MAX], *at = text;
  decimal d;
  if (value == 0) {
    strcpy(text, "0");
    return;
  }
  if (!find_decimal(fabs(value), digits, &d)) {
    print_digits(text, digits, value);
    write_point(text);
    return;
  }
  int count = write_first(first, digits, d.first);
  if (value < 0) *at++ = '-';
  if (d.exponent >= -4 && d.exponent < digits) {
    at = put_decimal(at, first, count, d.exponent);
  } else {
    *at = first[0];
    at = put_exponent(put_fraction(at + 1, first + 1, count - 1), d.exponent);
  }
  *at = '\0';
}

void fg_digits_format_exactly(char text[FG_DIGITS_TEXT], double value) {
  int digits = 10;
  do
    print_digits(text, digits, value);
  while (digits++ < DIGITS_MAX && strtod(text, NULL) != value);
  write_point(text);
}
