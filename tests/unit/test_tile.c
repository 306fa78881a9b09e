/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles: a value with its U, an unknown value, counts with a verdict. */
#include "page/tile.h"

#include <math.h>
#include <stdlib.h>

#include "support/test.h"

static void assert_tile(const fg_tile *tile, const char *wanted) {
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  fg_html_tile(out, tile);
  fclose(out);
  assert_string_equal(text, wanted);
  free(text);
}

static void a_value_has_decimals_unit_and_u(void **state) {
  (void)state;
  fg_tile tile = {"Gap", .value = -12.346, .u = 0.126, .unit = "µm", .decimals = 2};
  assert_tile(&tile, "<div><dt>Gap</dt><dd>−12.35 µm</dd></div>\n");
  tile.u_words = "";
  assert_tile(&tile, "<div><dt>Gap</dt><dd>−12.35 µm<small>± 0.25</small></dd></div>\n");
  tile.u_words = FG_TILE_U_IS_2U;
  tile.small = "at 30°";
  assert_tile(&tile,
              "<div><dt>Gap</dt><dd>−12.35 µm<small>± 0.25 (U = 2 u), at 30°</small></dd></div>\n");
  tile = (fg_tile){"R", .value = 1.5, .decimals = 1, .plus = true};
  assert_tile(&tile, "<div><dt>R</dt><dd>+1.5</dd></div>\n");
  tile.value = -1.5;
  assert_tile(&tile, "<div><dt>R</dt><dd>−1.5</dd></div>\n");
  tile.value = -0.04; /* 0.0 has no sign */
  assert_tile(&tile, "<div><dt>R</dt><dd>0.0</dd></div>\n");
  tile = (fg_tile){"R", .value = 12.34567, .digits = 5, .unit = "mm"};
  assert_tile(&tile, "<div><dt>R</dt><dd>12.346 mm</dd></div>\n");
}

static void an_unknown_value_is_a_dash_with_its_reason(void **state) {
  (void)state;
  fg_tile tile = {"Gap", .value = NAN, .u = 1, .unit = "µm", .u_words = "", .small = "at 30°"};
  assert_tile(&tile, "<div><dt>Gap</dt><dd>–<small>at 30°</small></dd></div>\n");
  tile.unknown = "no gap";
  assert_tile(&tile, "<div><dt>Gap</dt><dd>–<small>no gap</small></dd></div>\n");
  tile = (fg_tile){"Gap", .value = 1, .u = NAN, .u_words = ""};
  assert_tile(&tile, "<div><dt>Gap</dt><dd>1</dd></div>\n");
}

static void a_bad_count_has_a_cross(void **state) {
  (void)state;
  assert_tile(&(fg_tile){"Foils", .value = 12, .look = FG_TILE_BAD, .small = ""},
              "<div class=\"bad\"><dt>Foils</dt><dd>✗ 12</dd></div>\n");
  assert_tile(&(fg_tile){NULL, .value = 12}, "");
  assert_tile(&(fg_tile){"Along", .text = "1° and 2°", .value = NAN, .unknown = "why"},
              "<div><dt>Along</dt><dd>1° and 2°</dd></div>\n");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_value_has_decimals_unit_and_u),
      cmocka_unit_test(an_unknown_value_is_a_dash_with_its_reason),
      cmocka_unit_test(a_bad_count_has_a_cross),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
