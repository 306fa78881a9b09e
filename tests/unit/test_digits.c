/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Digits of numbers against those of printf. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/digits.h"
#include "support/test.h"

static void check_digits(int digits, double value) {
  char own[FG_DIGITS_TEXT], expected[FG_DIGITS_TEXT];
  fg_digits_format(own, digits, value);
  snprintf(expected, sizeof expected, "%.*g", digits, value + 0.0);
  if (strcmp(own, expected) != 0) print_error("%d digits of %a\n", digits, value);
  assert_string_equal(own, expected);
}

static uint64_t draw_bits(uint64_t *state) {
  *state ^= *state << 13;
  *state ^= *state >> 7;
  return *state ^= *state << 17;
}

/* Ends of the range that is scaled exactly, ties, and carries to one more digit. */
static void digits_of_edges_are_those_of_printf(void **state) {
  static const double values[] = {0,      -0.0,   1,       -1,       9.5,   0.5,     2.5,
                                  1e-4,   1e-5,   9.99e-5, 99999.5,  1e10,  1e9,     1e-17,
                                  9e-18,  1e300,  1e-300,  5e-324,   1e22,  0.1,     1.0 / 3,
                                  1234.5, 1235.5, 0x1p-13, 0x1.8p60, 1e100, 9999.95, 0.00099999995};
  (void)state;
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    for (int digits = 1; digits <= 17; digits++)
      for (int side = -1; side <= 1; side++)
        check_digits(digits, side ? nextafter(values[i], side * (double)INFINITY) : values[i]);
}

static void digits_of_drawn_numbers_are_those_of_printf(void **state) {
  uint64_t seed = 88172645463325252u;
  (void)state;
  for (int i = 0; i < 200000; i++) {
    double any;
    uint64_t bits = draw_bits(&seed);
    memcpy(&any, &bits, sizeof any);
    int digits = i % 2 ? 10 : 1 + (int)(draw_bits(&seed) % 17);
    if (isfinite(any)) check_digits(digits, any);
    check_digits(digits, ldexp((double)(int64_t)bits, -(int)(draw_bits(&seed) % 120)));
    check_digits(digits, (double)(bits % 200001) / 1000 - 100);
  }
}

static void exact_digits_read_as_the_same_number(void **state) {
  uint64_t seed = 1;
  char text[FG_DIGITS_TEXT];
  (void)state;
  for (int i = 0; i < 20000; i++) {
    double value = ldexp((double)(int64_t)draw_bits(&seed), -(int)(draw_bits(&seed) % 200));
    fg_digits_format_exactly(text, value);
    assert_true(strtod(text, NULL) == value);
  }
  fg_digits_format_exactly(text, 0.1);
  assert_string_equal(text, "0.1");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(digits_of_edges_are_those_of_printf),
      cmocka_unit_test(digits_of_drawn_numbers_are_those_of_printf),
      cmocka_unit_test(exact_digits_read_as_the_same_number),
  };
  return cmocka_run_group_tests_name("digits", tests, NULL, NULL);
}
