/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frame of a plot: ranges with room around the data, margins, axes, bands, limits, legend. */
#include "page/plot_frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/test.h"

static void a_range_holds_known_values_with_their_reach(void **state) {
  (void)state;
  double range[2] = {INFINITY, -INFINITY};
  fg_range_add(range, NAN, 1);
  fg_range_add(range, 2, NAN);
  assert_true(range[0] == 2 && range[1] == 2);
  fg_range_add(range, 3, 0.5);
  fg_range_add(range, INFINITY, 0);
  assert_true(range[0] == 2 && range[1] == 3.5);
}

static void a_range_gets_room(void **state) {
  (void)state;
  double wide[2] = {0, 10}, narrow[2] = {5, 5.01}, equal[2] = {-5, -5}, zero[2] = {0, 0};
  fg_range_pad(wide, 0.1, 0.05);
  fg_range_pad(narrow, 0.1, 0.05);
  assert_near(wide[0], -1, 1e-12);
  assert_near(wide[1], 11, 1e-12);
  assert_near(narrow[0], 4.95, 1e-12);
  assert_near(narrow[1], 5.06, 1e-12);
  fg_range_pad_by_size(equal, 0.1);
  fg_range_pad_by_size(zero, 0.1);
  assert_near(equal[0], -5.05, 1e-12);
  assert_near(zero[1], 1, 1e-12);
}

static void margins_left_out_have_defaults(void **state) {
  (void)state;
  char *text = NULL;
  size_t size;
  const double x[2] = {0, 10}, y[2] = {-1, 1};
  FILE *out = open_memstream(&text, &size);
  fg_plot plot =
      fg_plot_open(out, &(fg_plot_frame){"a < b", .height = 300, .left = 70, .x = x, .y = y});
  fclose(out);
  assert_string_equal(text, "<svg class=\"plot\" data-broad viewBox=\"0 0 1000 300\" role=\"img\" "
                            "aria-label=\"a &lt; b\">\n");
  assert_near(fg_plot_x(&plot, 0), 70, 1e-9);
  assert_near(fg_plot_x(&plot, 10), 985, 1e-9);
  assert_near(fg_plot_y(&plot, -1), 250, 1e-9);
  assert_near(fg_plot_y(&plot, 1), 14, 1e-9);
  assert_true(fg_plot_inside(&plot, 7) == 1 && fg_plot_inside(&plot, -7) == -1);
  free(text);
}

/* Writes a plot of 0 to 10 over -1 to 1 with the marks that plots share. */
static char *write_plot(fg_plot_ticks ticks) {
  char *text = NULL;
  size_t size;
  const double x[2] = {0, 10}, y[2] = {-1, 1}, band[2] = {-0.5, 0.5};
  const double at[2] = {0, 10}, low[2] = {-9, 0}, high[2] = {1, 9};
  FILE *out = open_memstream(&text, &size);
  fg_plot plot = fg_plot_frame_begin(
      out, &(fg_plot_frame){"plot", .width = 130, .height = 170, .left = 20, .right = 10, .top = 20,
                            .bottom = 50, .x = x, .y = y, .band = band, .band_style = "noise",
                            .y_title = "up", .x_title = "along", .ticks = ticks});
  fg_plot_tolerance(&plot, &(fg_tolerance){.lower = -2, .upper = 0.5});
  fg_plot_tolerance(&plot, NULL);
  fg_plot_ribbon(&plot, at, low, high, 2, "ci", "fill:red");
  fg_plot_interval(&plot, 5, 3, 0, 0.5, "s1");
  fg_plot_bump_band(&plot, 2, 4, 7);
  fg_plot_key(&plot, 80, "s2", "a < b");
  fg_plot_end(&plot);
  fclose(out);
  return text;
}

static void a_band_lies_below_the_axes(void **state) {
  (void)state;
  char *text = write_plot(FG_TICKS_NUMBERS);
  const char *band = strstr(
      text, "<rect class=\"noise\" x=\"20.0\" y=\"45.0\" width=\"100.0\" height=\"50.0\"/>\n");
  const char *axis = strstr(text, "rotate(-90)\">up</text>\n");
  assert_non_null(band);
  assert_non_null(axis);
  assert_true(band < axis);
  assert_has(text, "<text class=\"title\" x=\"70.0\" y=\"160.0\">along</text>\n");
  assert_has(text, "<text class=\"x\" x=\"40.0\" y=\"140.0\">2</text>\n");
  free(text);
  text = write_plot(FG_TICKS_OWN);
  assert_has_not(text, "<text class=\"x\" x");
  free(text);
}

static void marks_keep_within_the_plot(void **state) {
  (void)state;
  char *text = write_plot(FG_TICKS_OWN);
  assert_has(text, "<path class=\"limit\" d=\"M20.0 45.0L120.0 45.0\"/>\n");
  assert_null(strstr(strstr(text, "\"limit\"") + 1, "\"limit\"")); /* the other lies beyond */
  assert_has(text,
             "<path class=\"ci\" style=\"fill:red\" d=\"M20.0 20.0L120.0 20.0L120.0 70.0L20.0 "
             "120.0Z\"/>\n");
  assert_has(text, "<path class=\"s1\" d=\"M73.0 95.0V45.0M68.0 95.0h10M68.0 45.0h10\"/><circle "
                   "class=\"s1\" cx=\"73.0\" cy=\"70.0\" r=\"5\"/>\n");
  assert_has(text, "<rect class=\"band\" x=\"40.0\" y=\"20.0\" width=\"20.0\" height=\"100.0\"/>"
                   "<text class=\"x bump\" x=\"50.0\" y=\"14.0\">7</text>\n");
  assert_has(text,
             "<circle class=\"s2\" cx=\"80\" cy=\"14\" r=\"5\"/><text x=\"92\" y=\"19\">a &lt; "
             "b</text>\n");
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_range_holds_known_values_with_their_reach),
      cmocka_unit_test(a_range_gets_room),
      cmocka_unit_test(margins_left_out_have_defaults),
      cmocka_unit_test(a_band_lies_below_the_axes),
      cmocka_unit_test(marks_keep_within_the_plot),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
