/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Place of a cross-section in each colour channel, on profiles with a known place. */

#include <math.h>

#include "measure/colour_profile.h"
#include "support/test.h"

enum { COUNT = 160 };

static fg_edge_tables tables;

/* Channel 0 lies `shift` further than 1; channel 2 shows nothing. */
static void draw(const fg_colour_known *known, double shift, double blur, fg_colour_pixel *pixels) {
  for (int i = 0; i < COUNT; i++) {
    double n = -20 + 40.0 * (i + 0.5) / COUNT, w = known->half_width_px;
    pixels[i] = (fg_colour_pixel){.across_px = (float)n, .value = {0, 0, 90}};
    for (int k = 0; k < 2; k++) {
      double v = n - (k ? 0 : shift);
      double inside = isinf(w) ? erfc(v / blur / sqrt(2))
                               : erfc(-(v + w) / blur / sqrt(2)) - erfc(-(v - w) / blur / sqrt(2));
      pixels[i].value[k] = (float)(k ? 200 - 40 * inside : 30 + 80 * inside);
    }
  }
}

static void assert_places(const fg_colour_known *known, double shift, double blur) {
  fg_colour_pixel pixels[COUNT];
  fg_colour_place place[3];
  draw(known, shift, blur, pixels);
  for (int k = 0; k < 3; k++)
    fg_colour_profile_fit(&tables, known, pixels, COUNT, k, &place[k]);
  assert_true(place[0].good && place[1].good);
  assert_float_equal(place[0].shift_px, shift, 1e-3);
  assert_float_equal(place[1].shift_px, 0, 1e-3);
  assert_float_equal(place[0].contrast, 160, 0.1);
  assert_float_equal(place[1].contrast, -80, 0.1);
  assert_true(place[0].variance > 0 && place[0].variance < place[1].variance);
  assert_false(place[2].good);
}

static void a_strip_is_found_at_its_place(void **state) {
  (void)state;
  for (double shift = -3.5; shift <= 3.5; shift += 0.5)
    assert_places(&(fg_colour_known){.half_width_px = 9.5, .blur_px = 1.2}, shift, 1.5);
}

static void a_strip_narrower_than_its_blur_is_found(void **state) {
  (void)state;
  fg_colour_pixel pixels[COUNT];
  fg_colour_place place;
  const fg_colour_known known = {.half_width_px = 1.2, .blur_px = 2};
  draw(&known, 0.7, 2.2, pixels);
  fg_colour_profile_fit(&tables, &known, pixels, COUNT, 0, &place);
  assert_true(place.good);
  assert_float_equal(place.shift_px, 0.7, 1e-3);
}

static void a_single_edge_is_found_at_its_place(void **state) {
  (void)state;
  for (double shift = -3; shift <= 3; shift += 0.5)
    assert_places(&(fg_colour_known){.half_width_px = INFINITY, .blur_px = 1.2}, shift, 1.4);
}

static void few_pixels_tell_nothing(void **state) {
  (void)state;
  fg_colour_pixel pixels[COUNT];
  fg_colour_place place = {.good = true};
  const fg_colour_known known = {.half_width_px = 9.5, .blur_px = 1.2};
  draw(&known, 0, 1.2, pixels);
  fg_colour_profile_fit(&tables, &known, pixels, 5, 0, &place);
  assert_false(place.good);
  fg_colour_profile_fit(&tables, &known, pixels, 0, 0, &place);
  assert_false(place.good);
}

int main(void) {
  fg_edge_tables_init(&tables, 1);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_strip_is_found_at_its_place),
      cmocka_unit_test(a_strip_narrower_than_its_blur_is_found),
      cmocka_unit_test(a_single_edge_is_found_at_its_place),
      cmocka_unit_test(few_pixels_tell_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
