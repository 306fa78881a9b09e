/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places in the rendered picture: areas, centres, edges, the strip's lands and crowns, effects. */
#include "render_picture.h"
#include "support/test.h"

#include <gsl/gsl_cdf.h>

typedef struct moments {
  double area, x, y;
} moments;

static moments picture_moments(const picture *p) {
  moments m = {0};
  for (int64_t y = 0; y < p->height; y++)
    for (int64_t x = 0; x < p->width; x++) {
      double c = coverage(p, x, y);
      m.area += c;
      m.x += c * (double)x;
      m.y += c * (double)y;
    }
  m.x /= m.area;
  m.y /= m.area;
  return m;
}

/* A low-pass keeps area and centre exactly, so both test the picture without any edge model. */
static void disc_has_its_area_and_centre(void **state) {
  (void)state;
  const double blurs[] = {0.4, 0.7, 1.2, 3.0};
  for (size_t i = 0; i < 4; i++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":260,\"height_px\":250,"
                            "\"discs\":[{\"centre_mm\":[0.6613,0.6429],\"radius_mm\":0.5}],"
                            "\"scanner\":{" EXACT ",\"blur_px\":%g}}",
                            blurs[i]);
    moments m = picture_moments(&p);
    assert_near(sqrt(m.area / 3.14159265358979) * pixel, 0.5, 5e-5 * pixel);
    assert_near(m.x, 0.6613 / pixel, 1e-3);
    assert_near(m.y, 0.6429 / pixel, 1e-3);
    drop(&p);
  }
}

static void a_hole_reduces_the_area(void **state) {
  (void)state;
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":260,\"height_px\":250,"
                          "\"discs\":[{\"centre_mm\":[0.66,0.64],\"radius_mm\":0.5},"
                          "{\"centre_mm\":[0.7,0.6],\"radius_mm\":0.25,\"hole\":true}],"
                          "\"scanner\":{" EXACT ",\"blur_px\":1.5}}");
  assert_near(picture_moments(&p).area * pixel * pixel, 3.14159265358979 * (0.25 - 0.0625), 1e-5);
  drop(&p);
}

/* Edge of a large disc that passes the picture's middle at `angle_deg`: half-level crossing of
 * every row or column against the circle, and the spread of the edge. */
static void check_edge(double angle_deg, double blur_px, const char *polarity) {
  double angle = angle_deg * 3.14159265358979323846 / 180, radius = 5.0;
  double middle = 60.3 * pixel;
  double cx = middle - radius * cos(angle), cy = middle - radius * sin(angle);
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":121,\"height_px\":121,"
                          "\"discs\":[{\"centre_mm\":[%.15g,%.15g],\"radius_mm\":%.15g}],"
                          "\"scanner\":{\"bits\":16,%s,\"noise\":0,\"blur_px\":%g}}",
                          cx, cy, radius, polarity, blur_px);
  bool light = strstr(polarity, "-") == NULL;
  double centre_sum = 0, level_sum = 0, spread_sum = 0, expected_sum = 0, largest = 0;
  double scale = light ? 1 / 200.0 : -1 / 200.0, base = light ? 20 : 220;
  double variance = blur_px * blur_px + 1.0 / 12;
  int64_t count = 0;
  for (int64_t y = 40; y <= 80; y++) {
    double mean = 0, square = 0, total = 0, crossing = NAN;
    for (int64_t x = 0; x + 1 < p.width; x++) {
      double a = (p.dn[y * p.width + x] - base) * scale;
      double b = (p.dn[y * p.width + x + 1] - base) * scale;
      total += a - b;
      mean += (a - b) * ((double)x + 0.5);
      square += (a - b) * ((double)x + 0.5) * ((double)x + 0.5);
      double pa = gsl_cdf_ugaussian_Pinv(a), pb = gsl_cdf_ugaussian_Pinv(b);
      if (a >= 0.5 && b < 0.5) crossing = (double)x + pa / (pa - pb);
    }
    double dy = (double)y * pixel - cy;
    double exact = (cx + sqrt(radius * radius - dy * dy)) / pixel;
    double normal = sqrt(1 - dy * dy / (radius * radius)); /* pixels along x to the normal */
    /* A row's integral is the mean of the chord's end over the blur: sd² / 2 times the curvature.
     */
    expected_sum += -variance / (2 * radius / pixel) / (normal * normal);
    centre_sum += (mean / total - exact) * normal;
    level_sum += (crossing - exact) * normal;
    largest = fmax(largest, fabs(crossing - exact) * normal);
    /* Steps between pixels widen the spread by a pixel's box along x once more. */
    spread_sum += (square / total - mean * mean / total / total - 1.0 / 12) * normal * normal;
    count++;
  }
  double n = (double)count;
  assert_near(centre_sum / n, expected_sum / n, 1e-3);
  assert_near(level_sum / n, -variance / (2 * radius / pixel), 0.004);
  assert_true(largest < 0.02);
  assert_near(sqrt(spread_sum / n), sqrt(variance), 0.005);
  drop(&p);
}

static void edges_are_where_they_should_be(void **state) {
  (void)state;
  const double angles[] = {0, 7.3, -21, 38};
  for (size_t i = 0; i < 4; i++) {
    check_edge(angles[i], 1.2, "\"background\":20,\"contrast\":200");
    check_edge(angles[i], 2.4, "\"background\":220,\"contrast\":-200");
    check_edge(angles[i], 0.7, "\"background\":20,\"contrast\":200");
  }
}

static void strip_agrees_with_the_truth(void **state) {
  (void)state;
  for (int mirror = 0; mirror < 2; mirror++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"foils\":[{"
                            "\"design\":{\"bump_count\":3},"
                            "\"overall_radius_mm\":20.95,\"mirror\":%s,"
                            "\"radius_springback\":{\"mean\":0.02,\"sd\":0.01}}],"
                            "\"scanner\":{" EXACT "}}",
                            mirror ? "true" : "false");
    const fg_render_foil *foil = &p.truth->foils[0];
    double thickness;
    assert_near(crown(&p, 1, &thickness), 0, 0.004);
    assert_near(thickness, 0.1 / pixel, 0.01);
    /* The crown is R0 - h from O, below the middle bump. */
    const fg_render_bump *bump = &foil->bumps[1];
    assert_near(foil->overall_centre_px.y - bump->centre_px.y, bump->centre_to_centre_mm / pixel,
                1e-6);
    assert_near(bump->height_mm, 20.95 - (bump->centre_to_centre_mm - bump->radius_mm), 1e-12);
    drop(&p);
  }
}

/* A land lies on the overall circle: turned by half a pitch, one stands upright. */
static void lands_lie_on_the_overall_circle(void **state) {
  (void)state;
  picture p =
      draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"rotate_deg\":-83.3333333333,"
              "\"overall_radius_mm\":20.95}],\"scanner\":{" EXACT "}}");
  const fg_render_foil *foil = &p.truth->foils[0];
  double expected = foil->overall_centre_px.y - 20.95 / pixel, centre, thickness;
  column(&p, llround(foil->overall_centre_px.x), llround(expected) - 40, llround(expected) + 40,
         &centre, &thickness);
  assert_near(centre, expected, 0.004);
  assert_near(thickness, 0.1 / pixel, 0.01);
  drop(&p);
}

/* The area of a strip of constant width is its length times its thickness, joints and fillets
 * included; nothing is drawn twice and nothing is left out. */
static void strip_has_its_area(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"rotate_deg\":20,"
                      "\"mirror\":true,\"missing\":[3],\"crushed\":[{\"bump\":6,"
                      "\"height_factor\":0.7}]}],\"scanner\":{" EXACT "}}");
  fg_context ctx = {0};
  fg_point last, point;
  double length = 0, step = 0.01;
  assert_ok(&ctx, fg_render_midline(&ctx, p.spec, 0, 0, &last));
  double s = step;
  while (fg_render_midline(&ctx, p.spec, 0, s, &point) == FG_OK) {
    length += hypot(point.x - last.x, point.y - last.y);
    last = point;
    s += step;
  }
  assert_near(picture_moments(&p).area, length * 0.1 / pixel, 0.6 * step / pixel * 0.1 / pixel);
  assert_int_equal(p.truth->foils[0].bump_count, 8);
  assert_true(p.truth->foils[0].bumps[4].crushed);
  drop(&p);
}

/* Everything is the same under different resolutions along x and y. */
static void unequal_resolution(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"width_px\":300,\"height_px\":250,"
                      "\"discs\":[{\"centre_mm\":[0.66,0.64],\"radius_mm\":0.5}],"
                      "\"scanner\":{\"dpi\":[4800,4200]," EXACT "}}");
  moments m = picture_moments(&p);
  assert_near(m.x, 0.66 * 4800 / 25.4, 2e-3);
  assert_near(m.y, 0.64 * 4200 / 25.4, 2e-3);
  assert_near(m.area, 3.14159265358979 * 0.25 * 4800 * 4200 / 25.4 / 25.4, 3);
  drop(&p);
}

typedef struct field_case {
  const char *effect;
  double dx_um, dy_um; /* d at the disc's true centre (8, 6) mm */
} field_case;

/* True = nominal + d: the disc shows where nominal = true - d. */
static void fields_move_the_picture(void **state) {
  (void)state;
  static const field_case cases[] = {
      {"{\"id\":\"scan.scale_y\",\"value\":0.001}", 0, 6 * 1e3 * (1 - 1 / 1.001)},
      {"{\"id\":\"scan.shear\",\"value\":0.002}", 12, 0},
      {"{\"id\":\"scan.carriage_ripple\",\"amplitude_um\":6,\"period_mm\":24}", 0, 5.9999},
      {"{\"id\":\"scan.row_step\",\"amplitude_um\":10.5,\"y_mm\":5}", 0, 10.5},
      {"{\"id\":\"scan.row_step\",\"amplitude_um\":10.5,\"y_mm\":6.7}", 0, 0},
      {"{\"id\":\"scan.optical_quadratic\",\"amplitude_um\":10,\"centre_mm\":4,"
       "\"half_width_mm\":4}",
       9.95, 0},
      {"{\"id\":\"scan.optical_cubic\",\"amplitude_um\":-10,\"centre_mm\":4,"
       "\"half_width_mm\":4}",
       -10.075, 0},
      {"{\"id\":\"scan.carriage_quadratic\",\"amplitude_um\":10,\"centre_mm\":2,"
       "\"half_width_mm\":4}",
       0, 9.95},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":1700,"
                            "\"height_px\":1300,\"discs\":[{\"centre_mm\":[8,6],"
                            "\"radius_mm\":0.1}],\"effects\":[%s],\"scanner\":{" EXACT "}}",
                            cases[i].effect);
    moments m = picture_moments(&p);
    assert_near((8 - m.x * pixel) * 1e3, cases[i].dx_um, 0.035);
    assert_near((6 - m.y * pixel) * 1e3, cases[i].dy_um, 0.035);
    drop(&p);
  }
}

/* Rows are lost after the optics: the rows below the jump are those that lie deeper, unblurred. */
static void lost_rows_are_sharp(void **state) {
  (void)state;
  const char *base = "{\"schema\":\"foilgauge/render/1\",\"width_px\":260,\"height_px\":250,"
                     "\"discs\":[{\"centre_mm\":[0.66,0.64],\"radius_mm\":0.5}],\"effects\":[%s],"
                     "\"scanner\":{" EXACT "}}";
  char step[128];
  snprintf(step, sizeof step, "{\"id\":\"scan.row_step\",\"amplitude_um\":%.12g,\"y_mm\":%.12g}",
           3e3 * pixel, 99.5 * pixel);
  char with[1024], without[1024];
  snprintf(with, sizeof with, base, step);
  snprintf(without, sizeof without, base, "");
  picture a = draw(0, with), b = draw(0, without);
  for (int64_t y = 0; y < 240; y++)
    for (int64_t x = 0; x < a.width; x++)
      assert_near(coverage(&a, x, y), coverage(&b, x, y < 100 ? y : y + 3), 3e-5);
  drop(&a);
  drop(&b);
}

/* The lip stands on the land at 90 degrees, outwards or inwards. */
static void lip_stands_on_the_land(void **state) {
  (void)state;
  for (int inwards = 0; inwards < 2; inwards++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"foils\":[{"
                            "\"design\":{\"bump_count\":1},\"lip\":{"
                            "\"length_mm\":1.5,\"bend_radius_mm\":0.4,\"side\":\"%s\"}}]}",
                            inwards ? "inwards" : "outwards");
    fg_point o = p.truth->foils[0].overall_centre_px, end, foot, land;
    fg_context ctx = {0};
    double bend_end = 1.5 + 0.2 * 3.14159265358979;
    assert_ok(&ctx, fg_render_midline(&ctx, p.spec, 0, 0, &end));
    assert_ok(&ctx, fg_render_midline(&ctx, p.spec, 0, 1.5, &foot));
    assert_ok(&ctx, fg_render_midline(&ctx, p.spec, 0, bend_end, &land));
    double ux = (land.x - o.x) * pixel / 20.73, uy = (land.y - o.y) * pixel / 20.73;
    double along = ((end.x - land.x) * ux + (end.y - land.y) * uy) * pixel;
    double across = ((foot.y - land.y) * ux - (foot.x - land.x) * uy) * pixel;
    assert_near(hypot(ux, uy), 1, 1e-9);
    assert_near(along, inwards ? -1.9 : 1.9, 1e-9);
    assert_near(across, -0.4, 1e-9); /* beyond the land's end, away from bump 1 */
    drop(&p);
  }
}

/* A bed places its foils apart: foils that overlap would have less area than their sum. */
static void foils_of_a_bed_lie_apart(void **state) {
  (void)state;
  picture one = draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"rotate_deg\":-90,"
                        "\"design\":{\"bump_count\":3}}],\"scanner\":{" EXACT "}}");
  picture bed = draw(
      0, "{\"schema\":\"foilgauge/render/1\",\"width_px\":9000,\"foils\":[{"
         "\"design\":{\"bump_count\":3},\"repeat\":3,\"rotate_deg\":-90,\"rotate_step_deg\":90}],"
         "\"scanner\":{" EXACT "}}");
  assert_int_equal(bed.truth->foil_count, 3);
  assert_near(picture_moments(&bed).area / picture_moments(&one).area, 3, 1e-5);
  drop(&one);
  drop(&bed);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(disc_has_its_area_and_centre),
      cmocka_unit_test(a_hole_reduces_the_area),
      cmocka_unit_test(edges_are_where_they_should_be),
      cmocka_unit_test(strip_agrees_with_the_truth),
      cmocka_unit_test(lands_lie_on_the_overall_circle),
      cmocka_unit_test(strip_has_its_area),
      cmocka_unit_test(unequal_resolution),
      cmocka_unit_test(fields_move_the_picture),
      cmocka_unit_test(lost_rows_are_sharp),
      cmocka_unit_test(lip_stands_on_the_land),
      cmocka_unit_test(foils_of_a_bed_lie_apart),
  };
  return cmocka_run_group_tests_name("render geometry", tests, NULL, NULL);
}
