/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die's profiles: how a text is read, and what a surface's form does to a circle's uncertainty.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "die/form_error.h"
#include "die/header.h"
#include "die/lines.h"
#include "support/random.h"
#include "support/test.h"

static void styles_of_numbers_are_told_apart(void **state) {
  static const struct {
    const char *text;
    char separator; /* 0: refused */
    bool comma;
  } rows[] = {
      {"1.0\t2.0\n1.5\t2.5\n", '\t', false},
      {"1,0\t2,0\n1,5\t2,5\n", '\t', true},
      {"1,0;2,0\r\n", ';', true},
      {"0;0\n0,5;1\n", ';', true}, /* a later line tells */
      {"1.0 2.0\n", ' ', false},
      {"  1,5   2,5\n", ' ', true},
      {"1.0,2.0\n", ',', false},
      {"1.0, 2.0\n", ',', false},
      {"0,0\n1.5,2.5\n", ',', false},
      {"1, 2\n", ',', false},
      {"1,25\n2,50\n", 0, false}, /* two whole numbers, or one? */
      {"0,5,1,25\n", 0, false},   /* both */
      {"1.234,5;2\n", 0, false},  /* thousands */
      {"1.0;2.0\n1,5;2\n", 0, false},
  };
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_die_style style;
    const char *uncertainty = fg_die_style_find(rows[i].text, &style);
    if ((uncertainty == NULL) != (rows[i].separator != 0)) fail_msg("row %zu: %s", i, uncertainty);
    if (uncertainty) continue;
    if (style.separator != rows[i].separator || style.comma_decimal != rows[i].comma)
      fail_msg("row %zu: '%c' %d", i, style.separator, style.comma_decimal);
  }
}

static bool number(const char *text, bool comma, double *value) {
  return fg_die_number(&(fg_die_field){text, strlen(text)}, comma, value);
}

static void numbers_are_numbers(void **state) {
  double value;
  (void)state;
  assert_true(number("-1.5e-3", false, &value));
  assert_near(value, -1.5e-3, 0);
  assert_true(number("+2,25", true, &value));
  assert_near(value, 2.25, 0);
  assert_false(number("2,25", false, &value));
  assert_false(number("2.25", true, &value));
  assert_false(number("nan", false, &value));
  assert_false(number("inf", false, &value));
  assert_false(number("0x10", false, &value));
  assert_false(number("1e999", false, &value));
  assert_false(number("-", false, &value));
  assert_false(number("", false, &value));
}

static void headers_say_units(void **state) {
  static const struct {
    const char *text;
    char separator;
    fg_die_unit x, z;
    size_t column_x, column_z;
    double tip_um; /* 0: not said */
  } rows[] = {
      {"X [mm]\tZ [\xc2\xb5m]\n", '\t', FG_DIE_MM, FG_DIE_UM, 1, 2, 0},
      {"Z (\xb5m);X (mm)\n", ';', FG_DIE_MM, FG_DIE_UM, 2, 1, 0},
      {"x_mm,z_mm\n", ',', FG_DIE_MM, FG_DIE_MM, 1, 2, 0},
      {"X Z\nmm um\n", ' ', FG_DIE_MM, FG_DIE_UM, 1, 2, 0},
      {"X [mm]   Z [um]\n", ' ', FG_DIE_MM, FG_DIE_UM, 0, 0, 0},
      {"Unit: mm\n", '\t', FG_DIE_MM, FG_DIE_MM, 0, 0, 0},
      {"X-Unit = mm\nZ-Unit = nm\n", '\t', FG_DIE_MM, FG_DIE_NM, 0, 0, 0},
      {"Einheit: Mikrometer\n", ';', FG_DIE_UM, FG_DIE_UM, 0, 0, 0},
      /* Texts that state no unit of the columns. */
      {"Length\t40 mm\nSpeed: 0.5 mm/s\n", '\t', FG_DIE_UNIT_NONE, FG_DIE_UNIT_NONE, 0, 0, 0},
      {"Tip radius: 0,005 mm\n", '\t', FG_DIE_UNIT_NONE, FG_DIE_UNIT_NONE, 0, 0, 5},
      {"Tastspitzenradius: 2 \xc2\xb5m\n", ';', FG_DIE_UNIT_NONE, FG_DIE_UNIT_NONE, 0, 0, 2},
      {"Tip radius: 2\n", ';', FG_DIE_UNIT_NONE, FG_DIE_UNIT_NONE, 0, 0, 0},
  };
  (void)state;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    fg_die_header header;
    const char *text = rows[i].text;
    fg_die_header_read(text, text + strlen(text), rows[i].separator, 2, &header);
    if (header.unit[0] != rows[i].x || header.unit[1] != rows[i].z)
      fail_msg("row %zu: %s, %s", i, fg_die_unit_word(header.unit[0]),
               fg_die_unit_word(header.unit[1]));
    if (header.column[0] != rows[i].column_x || header.column[1] != rows[i].column_z)
      fail_msg("row %zu: columns %zu, %zu", i, header.column[0], header.column[1]);
    if (rows[i].tip_um > 0 ? fabs(header.tip_um - rows[i].tip_um) > 1e-9 : !isnan(header.tip_um))
      fail_msg("row %zu: tip %g", i, header.tip_um);
  }
}

static void halves_are_named(void **state) {
  (void)state;
  assert_string_equal(fg_die_half_in("Die 3 KONKAV", 12), "concave");
  assert_string_equal(fg_die_half_in("a_convex.txt", 12), "convex");
  assert_null(fg_die_half_in("concave and convex", 18));
  assert_null(fg_die_half_in("", 0));
}

enum { STATIONS = 366, BUMPS = 7, DIES = 10 };
#define RADIUS 3.32
#define STEP   0.01

/* Noise with the correlation exp(-(d/length)²), and white noise. */
static void make_noise(uint64_t *seed, double length, double sd, double white, double *out) {
  enum { REACH = 400 };
  double source[STATIONS + 2 * REACH], squares = 0;
  for (int k = -REACH; k <= REACH; k++)
    squares += exp(-4 * pow(k * STEP / length, 2));
  for (size_t i = 0; i < STATIONS + 2 * REACH; i++)
    source[i] = random_gaussian(seed);
  for (size_t i = 0; i < STATIONS; i++) {
    double sum = 0;
    for (int k = -REACH; k <= REACH && sd > 0; k++)
      sum += exp(-2 * pow(k * STEP / length, 2)) * source[(int)i + REACH + k];
    out[i] = sd * sum / sqrt(squares) + white * random_gaussian(seed);
  }
}

/* rms of what u of R is said to be over that of R's errors, over many dies of some bumps each. */
static void try_form_error(double length, double sd, double white, double *ratio) {
  static fg_station stations[BUMPS * STATIONS];
  static fg_point points[BUMPS * STATIONS];
  fg_strip strip = {.stations = stations, .count = BUMPS * STATIONS, .step_mm = STEP};
  fg_datum_line line = {.strip = &strip, .points = points};
  double noise[STATIONS], errors = 0, claimed = 0;
  uint64_t seed = 7;
  for (size_t i = 0; i < BUMPS * STATIONS; i++)
    stations[i] = (fg_station){.s_mm = STEP * (double)i, .weight = 1};
  for (int die = 0; die < DIES; die++) {
    fg_arc arcs[BUMPS], *list[BUMPS];
    fg_range ranges[BUMPS];
    fg_die_form_error form_error;
    for (size_t b = 0; b < BUMPS; b++) {
      make_noise(&seed, length, sd, white, noise);
      for (size_t i = 0; i < STATIONS; i++) {
        double angle = ((double)i - STATIONS / 2.0) * STEP / RADIUS, r = RADIUS + noise[i];
        points[b * STATIONS + i] = (fg_point){r * sin(angle), r * cos(angle)};
      }
      ranges[b] = (fg_range){b * STATIONS, (b + 1) * STATIONS - 1};
      arcs[b] = (fg_arc){.ranges = &ranges[b], .range_count = 1};
      list[b] = &arcs[b];
      assert_ok(&test_context, fg_arc_fit(&test_context, &line, &arcs[b]));
    }
    assert_ok(&test_context,
              fg_die_form_error_find(&test_context, &line, list, BUMPS, &form_error));
    for (size_t b = 0; b < BUMPS; b++) {
      errors += pow(arcs[b].circle.radius - RADIUS, 2);
      claimed += arcs[b].covariance[2][2];
    }
  }
  *ratio = sqrt(claimed / errors);
}

/* Not too small; where waves are long it may be on the safe side. */
static void u_covers_the_form_error(void **state) {
  double ratio;
  (void)state;
  try_form_error(1, 0, 1e-4, &ratio); /* white */
  assert_near(ratio, 1, 0.15);
  try_form_error(0.2, 1e-4, 2e-5, &ratio);
  assert_near(ratio, 1.2, 0.35);
  try_form_error(0.5, 1e-4, 2e-5, &ratio);
  assert_near(ratio, 1.2, 0.4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(styles_of_numbers_are_told_apart),
      cmocka_unit_test(numbers_are_numbers),
      cmocka_unit_test(headers_say_units),
      cmocka_unit_test(halves_are_named),
      cmocka_unit_test(u_covers_the_form_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
