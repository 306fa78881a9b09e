/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Overlay and page: pixels where they belong, words that cannot break out of their place. */

#include <unistd.h>

#include "foilgauge/report.h"
#include "page/canvas.h"
#include "page/page.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

enum { WIDTH = 1100, HEIGHT = 620 };

/* A gray level that is linear in x and y, so that the mean over any box is its middle's level. */
static double ramp(double x, double y) {
  return 20 + 0.15 * x + 0.1 * y;
}

static void write_ramp(char path[]) {
  fg_context ctx = {0};
  uint8_t *gray = malloc((size_t)WIDTH * HEIGHT), *png;
  size_t size;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++)
      gray[y * WIDTH + x] = (uint8_t)lround(ramp(x, y));
  assert_ok(&ctx, fg_png_encode(&ctx, gray, WIDTH, HEIGHT, 1, &png, &size));
  FILE *file = fdopen(mkstemp(path), "w");
  assert_int_equal(fwrite(png, 1, size, file), size);
  fclose(file);
  free(png);
  free(gray);
}

static fg_measurement measurement_of(const char *path) {
  fg_measurement measurement = {.file = {.width_px = WIDTH, .height_px = HEIGHT, .bit_depth = 8},
                                .dpi = {600, 600}};
  snprintf(measurement.scan, sizeof measurement.scan, "%s", path);
  return measurement;
}

static void a_picture_averages_over_boxes(void **state) {
  (void)state;
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge-ramp-XXXXXX";
  write_ramp(path);
  const fg_measurement measurement = measurement_of(path);
  const int64_t boxes[][4] = {{0, 0, WIDTH, HEIGHT}, {37, 11, 900, 601}};
  const int32_t widths[] = {WIDTH, 1099, 373, 64};
  for (size_t b = 0; b < 2; b++)
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
      in_row("widths[%zu]", i);
      fg_picture picture;
      assert_ok(&ctx, fg_picture_load(&ctx, &measurement, boxes[b], widths[i], 1e9, &picture));
      assert_true(picture.width <= widths[i] && picture.width >= widths[i] * 9 / 10 - 200);
      for (int32_t y = 0; y < picture.height; y++)
        for (int32_t x = 0; x < picture.width; x++) {
          double middle_x = (double)boxes[b][0] + (x + 0.5) / picture.reduction[0] - 0.5;
          double middle_y = (double)boxes[b][1] + (y + 0.5) / picture.reduction[1] - 0.5;
          double gray = picture.gray[(size_t)y * (size_t)picture.width + (size_t)x];
          assert_true(fabs(gray - ramp(middle_x, middle_y)) < 1.1);
        }
      fg_picture_free(&picture);
    }
  unlink(path);
}

static void a_scan_that_changed_is_refused(void **state) {
  (void)state;
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge-ramp-XXXXXX";
  write_ramp(path);
  fg_measurement measurement = measurement_of(path);
  const int64_t box[4] = {0, 0, WIDTH, HEIGHT};
  fg_picture picture;
  measurement.file.height_px++;
  assert_status(&ctx, fg_picture_load(&ctx, &measurement, box, 100, 1e9, &picture), FG_ERR_DATA);
  assert_null(picture.gray);
  unlink(path);
}

/* The mean column of the pixels that a line of this colour changed. */
static double column_of(const fg_rgb *rgb) {
  double weight = 0, sum = 0;
  for (int32_t i = 0; i < rgb->width * rgb->height; i++) {
    weight += rgb->pixels[3 * i];
    sum += rgb->pixels[3 * i] * (double)(i % rgb->width);
  }
  return sum / weight;
}

/* A vertical line through scan pixel 437.0 lies in the picture where that pixel's centre is. */
static void a_line_lies_where_its_pixels_are(void **state) {
  (void)state;
  fg_context ctx = {0};
  const int64_t box[4] = {100, 50, 800, 400};
  for (int32_t width = 200; width <= 800; width += 300) {
    fg_picture picture = {.width = width, .height = width / 2, .origin_px = {box[0], box[1]}};
    picture.reduction[0] = picture.reduction[1] = width / 800.0;
    fg_measurement measurement = measurement_of("-");
    fg_rgb rgb = {calloc(3, (size_t)(width * width / 2)), width, width / 2};
    fg_canvas canvas = fg_canvas_over(&picture, &measurement);
    canvas.rgb = &rgb;
    double mm = 437.0 * 25.4 / 600;
    const fg_point ends[2] = {{mm, 100 * 25.4 / 600}, {mm, 300 * 25.4 / 600}};
    assert_ok(&ctx, fg_canvas_line(&ctx, &canvas, ends, 2, (fg_pen){0xff0000, 1, 0}));
    double expected = (437.0 - 100 + 0.5) * width / 800.0 - 0.5;
    assert_true(fabs(column_of(&rgb) - expected) < 0.08);
    free(rgb.pixels);
  }
}

/* Not inline: gcc takes what the stream allocates for its variable, and warns of the page as
 * dangling. */
__attribute__((noinline)) static char *page_of(const fg_report *report) {
  fg_context ctx = {0};
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  assert_ok(&ctx, fg_report_write_html(&ctx, report, out));
  fclose(out);
  return text;
}

static bool stands_before(const char *page, const char *first, const char *second) {
  const char *one = strstr(page, first);
  return one && strstr(one, second) && strstr(page, second) > one;
}

static void a_page_escapes_every_name(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  synthetic_tolerance(&design, "radius_error_pct", -INFINITY, 2.0);
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  snprintf(design.name, sizeof design.name, "<script>alert(1)</script>");
  fg_report_scan scans[2] = {{"<b>\"&'.png", &measurement, NULL, NULL},
                             {"x/<i>", NULL, "<u>broken</u>", NULL}};
  snprintf(measurement.scan, sizeof measurement.scan, "-"); /* no pixels: the drawing alone */
  char *page = page_of(&(fg_report){&design, &nominal, scans, 2, NULL});
  assert_has_not(page, "<script");
  assert_has_not(page, "<b>\"");
  assert_has_not(page, "<i></h1>");
  assert_has_not(page, "<u>");
  assert_has(page, "&lt;script&gt;alert(1)&lt;/script&gt;");
  assert_has(page, "&lt;u&gt;broken&lt;/u&gt;");
  assert_has(page, "&lt;b&gt;&quot;&amp;&#39;.png");
  assert_has_not(page, "http://");
  assert_has_not(page, "https://");
  assert_has_not(page, "nan");
  /* The summary of all parts stands before the first. */
  assert_true(stands_before(page, "<h1>2 foils</h1>", "id=\"part1\""));
  free(page);
  synthetic_free(&measurement);
}

static void a_page_says_the_verdict_and_why(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  synthetic_tolerance(&design, "radius_error_pct", -INFINITY, 2.0); /* bump 1 has 2.195 */
  fg_nominal nominal = synthetic_nominal(&design);
  fg_measurement measurement = synthetic_measurement(&design);
  snprintf(measurement.scan, sizeof measurement.scan, "-");
  fg_foil *foil = &measurement.foils[0];
  foil->flags = FG_FOIL_SIDE_BAND;
  fg_report_scan scan = {"-", &measurement, NULL, NULL};
  const fg_report report = {&design, &nominal, &scan, 1, NULL};
  char *page = page_of(&report);
  assert_has(page, "<span class=\"verdict fail\">Out of tolerance</span>");
  assert_has(page, "springback error of the bump radius: bump 1 (2.195 %, max 2).</p>");
  assert_has(page, "class=\"limits-of\"");          /* the limit is in the plot */
  assert_has(page, "1: e_R 2.195 %, max 2</text>"); /* and the value on the picture */
  assert_has(page, "The wall of the foil shows beside one edge");
  assert_has(page, "<td class=\"fail\">2.195 <i>± 0.013</i></td>");
  free(page);

  foil->bumps[1].flags = FG_BUMP_NOT_FITTED;
  foil->bumps[1].radius_mm = foil->bumps[1].radius_error_pct = NAN;
  page = page_of(&report);
  assert_has(page, "not fitted: it has no values");
  free(page);

  fg_foil_give_up(foil, "no arc was found");
  foil->bump_count = 0;
  foil->strip.count = 0;
  page = page_of(&report);
  assert_has(page, "<span class=\"verdict not_measured\">");
  assert_true(stands_before(page, "no arc was found", "<svg class=\"picture"));
  free(page);
  synthetic_free(&measurement);
}

static void a_page_of_discs_lists_them(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  synthetic_tolerance(&design, "roundness_um", -INFINITY, 5); /* 4.2 ± 1.2: either */
  fg_measurement measurement = measurement_of("-");
  measurement.discs = calloc(2, sizeof *measurement.discs);
  measurement.disc_count = 2;
  measurement.discs[0] = synthetic_disc(1, 1.5);
  measurement.discs[1] = synthetic_disc(2, 2.75);
  fg_report_scan scan = {"-", &measurement, NULL, NULL};
  char *page = page_of(&(fg_report){&design, NULL, &scan, 1, NULL});
  assert_has(page, "2 round features");
  assert_has_not(page, "bump circle"); /* no legend of a foil */
  assert_has(page, "the circle that was fitted to each feature");
  assert_has(page, "<span class=\"verdict cannot_tell\">");
  assert_has(page, "<td class=\"no_tolerance\">5.5000 <i>± 0.0020</i></td>");
  assert_has(page, "<td class=\"cannot_tell\">4.2 <i>± 1.2</i></td>");
  free(page);
  synthetic_free(&measurement);
}

static void pictures_have_ascii_only(void **state) {
  (void)state;
  char ascii[64];
  fg_text_to_ascii("α 1 ± 2 µm × 3° \xFF☃", ascii, sizeof ascii);
  assert_string_equal(ascii, "alpha 1 +- 2 um x 3deg ??");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_picture_averages_over_boxes),
      cmocka_unit_test(a_scan_that_changed_is_refused),
      cmocka_unit_test(a_line_lies_where_its_pixels_are),
      cmocka_unit_test(a_page_escapes_every_name),
      cmocka_unit_test(a_page_says_the_verdict_and_why),
      cmocka_unit_test(a_page_of_discs_lists_them),
      cmocka_unit_test(pictures_have_ascii_only),
  };
  return cmocka_run_group_tests_name("report pictures", tests, NULL, NULL);
}
