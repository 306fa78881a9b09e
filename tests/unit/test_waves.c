/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sines and cosines that are computed several at a time are those of the C library, and the columns
 * of a wave those that its sine and cosine at every place of a row give. */
#include <math.h>
#include <string.h>

#include "core/sincos.h"
#include "evidence/unnamed.h"
#include "support/foil_rows.h"

enum { ANGLES = 1001 };

static void sines_are_those_of_the_library(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (double size = 1e-6; size < 1e6; size *= 3) {
    double angle[ANGLES], sine[ANGLES], cosine[ANGLES];
    for (size_t i = 0; i < ANGLES; i++)
      angle[i] = size * (2 * random_uniform(&seed) - 1);
    fg_sincos(ANGLES, angle, sine, cosine);
    for (size_t i = 0; i < ANGLES; i++) {
      assert_true(fabs(sine[i] - sin(angle[i])) < 4e-16);
      assert_true(fabs(cosine[i] - cos(angle[i])) < 4e-16);
    }
  }
}

static void what_is_no_angle_has_no_sine(void **state) {
  (void)state;
  const double angle[5] = {NAN, INFINITY, 0, -M_PI / 2, M_PI};
  double sine[5], cosine[5];
  fg_sincos(5, angle, sine, cosine);
  assert_true(isnan(sine[0]) && isnan(cosine[1]));
  assert_true(sine[2] == 0 && cosine[2] == 1 && sine[3] == -1 && cosine[4] == -1);
}

/* Returns 1 for an effect with a wave, whose columns have been compared. */
static size_t compare(foil_rows *f, const fg_effect *effect) {
  const double shape[FG_FIELD_SHAPES] = {0.7};
  size_t rows = f->edge_fit.row_count;
  fg_effect by_places = *effect;
  double *columns = f->columns, *other = calloc(2 * rows, sizeof *other);
  memset(&by_places.wave, 0, sizeof by_places.wave);
  bool wave = memcmp(&by_places.wave, &effect->wave, sizeof effect->wave) != 0;
  if (wave) {
    assert_int_equal(fg_effect_columns(&f->edge_fit, effect, shape, columns), 2);
    assert_int_equal(fg_effect_columns(&f->edge_fit, &by_places, shape, other), 2);
    for (size_t i = 0; i < 2 * rows; i++)
      assert_true(fabs(columns[i] - other[i]) < 1e-12);
  }
  free(other);
  return wave;
}

static void a_wave_at_a_row_is_its_mean_over_the_places(void **state) {
  (void)state;
  foil_rows f;
  size_t waves = 0;
  foil_rows_open(&f);
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    waves += compare(&f, effect);
  for (const fg_effect *effect = fg_unnamed_effects; effect->id; effect++)
    waves += compare(&f, effect);
  assert_int_equal(waves, 5);
  foil_rows_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sines_are_those_of_the_library),
      cmocka_unit_test(what_is_no_angle_has_no_sine),
      cmocka_unit_test(a_wave_at_a_row_is_its_mean_over_the_places),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
