/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blur by direction: its own along x and y, the carriage's motion, and what one side gets more. */
#include "render_picture.h"
#include "support/test.h"

/* Sd of a disc's edge along a line through its middle, of what the profile climbs by: [0] where it
 * begins, [1] where it ends, along rising x or y. */
static void edge_sds(const char *scanner, int axis, double sd_px[2]) {
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":250,"
                          "\"height_px\":250,\"discs\":[{\"centre_mm\":[0.66,0.66],"
                          "\"radius_mm\":0.4}],\"scanner\":{" EXACT ",%s}}",
                          scanner);
  int64_t middle = llround(0.66 / pixel);
  for (int edge = 0; edge < 2; edge++) {
    double sum = 0, first = 0, second = 0;
    for (int64_t i = edge ? middle : 0; i + 1 < (edge ? 250 : middle); i++) {
      double step = axis ? coverage(&p, middle, i + 1) - coverage(&p, middle, i)
                         : coverage(&p, i + 1, middle) - coverage(&p, i, middle);
      sum += step;
      first += step * (double)i;
      second += step * (double)(i * i);
    }
    sd_px[edge] = sqrt(second / sum - first / sum * first / sum);
  }
  drop(&p);
}

/* Beside the optics: the pixel's own box, and that of the step that is looked at. */
static double with_pixel(double optics_px) {
  return sqrt(optics_px * optics_px + 1.0 / 6);
}

/* Bright-to-dark along the carriage's way is softer; where it goes the other way, the other edge.
 */
static void blur_is_one_sided(void **state) {
  (void)state;
  const char *scanner = "\"blur_px\":1.8,\"rough\":{\"one_sided_blur_px\":2.2%s}";
  const char *ways[] = {"", ",\"one_sided_way\":\"+y\"", ",\"one_sided_way\":\"-y\""};
  for (size_t i = 0; i < 3; i++) {
    char members[128];
    double sd[2];
    snprintf(members, sizeof members, scanner, ways[i]);
    edge_sds(members, 1, sd);
    int soft = i < 2 ? 1 : 0;
    assert_near(sd[!soft], with_pixel(1.8), 0.02);
    assert_near(sd[soft], with_pixel(hypot(1.8, 2.2)), 0.05);
    edge_sds(members, 0, sd);
    assert_near(sd[0], with_pixel(1.8), 0.02);
    assert_near(sd[1], with_pixel(1.8), 0.02);
  }
}

static void blur_has_its_own_size_along_each_axis(void **state) {
  (void)state;
  for (int axis = 0; axis < 2; axis++) {
    double sd[2];
    edge_sds("\"blur_px\":[0.9,2.4]", axis, sd);
    for (int i = 0; i < 2; i++)
      assert_near(sd[i], with_pixel(axis ? 2.4 : 0.9), 0.01);
  }
}

/* A box of 6 px beside a Gaussian of 1. */
static void motion_blurs_along_the_way(void **state) {
  (void)state;
  const char *scanner = "\"blur_px\":1,\"rough\":{\"motion_blur_px\":6}";
  for (int axis = 0; axis < 2; axis++) {
    double sd[2];
    edge_sds(scanner, axis, sd);
    for (int i = 0; i < 2; i++)
      assert_near(sd[i], with_pixel(axis ? sqrt(1 + 6 * 6 / 12.0) : 1), 0.01);
  }
}

/* Sd along its normal of a straight edge that faces `degrees`, without the pixel's box: of a disc
 * so large that it is straight. */
static double straight_edge_sd(const char *scanner, double degrees) {
  const double pi = 3.14159265358979323846, radius = 40;
  double c = cos(degrees * pi / 180), s = sin(degrees * pi / 180);
  int axis = fabs(s) > fabs(c);
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":121,\"height_px\":121,"
                          "\"discs\":[{\"centre_mm\":[%.9f,%.9f],\"radius_mm\":%g}],"
                          "\"scanner\":{" EXACT ",%s}}",
                          60 * pixel - radius * c, 60 * pixel - radius * s, radius, scanner);
  double sum = 0, first = 0, second = 0;
  for (int64_t i = 0; i < 120; i++) {
    double step = axis ? coverage(&p, 60, i + 1) - coverage(&p, 60, i)
                       : coverage(&p, i + 1, 60) - coverage(&p, i, 60);
    sum += step;
    first += step * (double)i;
    second += step * (double)(i * i);
  }
  drop(&p);
  double along = second / sum - first / sum * first / sum - 1 / 12.0; /* the step's box */
  return sqrt(along * fmax(c * c, s * s) - 1 / 12.0);
}

/* An ellipse along its own axes, which are turned against the rows; between them sd² is that of the
 * normal in its covariance. */
static void ellipse_is_turned(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846, angles[] = {30, -60, 90, 135};
  for (size_t i = 0; i < 4; i++)
    for (double normal = 0; normal < 180; normal += 15) {
      char members[96];
      snprintf(members, sizeof members, "\"blur_px\":[3,1],\"blur_angle_deg\":%g", angles[i]);
      double turn = (normal - angles[i]) * pi / 180;
      double expected = hypot(3 * cos(turn), sin(turn));
      assert_near(straight_edge_sd(members, normal), expected, 0.01);
    }
}

/* Along the rows, and where it is a circle, it is the blur that separates; the motion adds to it.
 */
static void turned_ellipse_meets_the_straight_one(void **state) {
  (void)state;
  const char *pairs[][2] = {
      {"\"blur_px\":[0.6,2.2],\"blur_angle_deg\":90", "\"blur_px\":[2.2,0.6]"},
      {"\"blur_px\":[1.5,1.5],\"blur_angle_deg\":20", "\"blur_px\":1.5"},
      {"\"blur_px\":[1,2],\"blur_angle_deg\":90,\"rough\":{\"motion_blur_px\":4}",
       "\"blur_px\":[2,1],\"rough\":{\"motion_blur_px\":4}"}};
  for (size_t i = 0; i < 3; i++) {
    picture both[2];
    for (int k = 0; k < 2; k++)
      both[k] = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":150,"
                            "\"height_px\":150,\"discs\":[{\"centre_mm\":[0.4,0.4],\"radius_mm\":"
                            "0.2}],\"scanner\":{" EXACT ",%s}}",
                            pairs[i][k]);
    for (int64_t k = 0; k < 150 * 150; k++)
      assert_near(both[0].dn[k], both[1].dn[k], 0.05);
    drop(&both[0]);
    drop(&both[1]);
  }
}

static void strips_of_any_height_give_one_picture(void **state) {
  (void)state;
  const char *json = "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"rotate_deg\":20,"
                     "\"design\":{\"bump_count\":1}}],\"scanner\":{\"dpi\":1200,\"rows_lost\":[{"
                     "\"y_mm\":2,\"count\":2}],\"blur_px\":[2.5,0.8],\"blur_angle_deg\":40}}";
  picture first = draw(64, json), other = draw(100000, json);
  assert_memory_equal(first.dn, other.dn, (size_t)(first.width * first.height) * sizeof *first.dn);
  drop(&first);
  drop(&other);
}

/* Blur makes no light: the sum over the picture stays. */
static void blur_keeps_the_light(void **state) {
  (void)state;
  const char *scanners[] = {"\"blur_px\":1", "\"blur_px\":[2.5,0.7]",
                            "\"blur_px\":1,\"rough\":{\"motion_blur_px\":5}",
                            "\"blur_px\":[2.5,0.7],\"blur_angle_deg\":25"};
  double sums[4] = {0};
  for (size_t i = 0; i < 4; i++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":250,"
                            "\"height_px\":250,\"discs\":[{\"centre_mm\":[0.66,0.66],"
                            "\"radius_mm\":0.4}],\"scanner\":{" EXACT ",%s}}",
                            scanners[i]);
    for (int64_t k = 0; k < p.width * p.height; k++)
      sums[i] += (p.dn[k] - 20) / 200;
    drop(&p);
  }
  assert_near(sums[1] / sums[0], 1, 1e-5);
  assert_near(sums[2] / sums[0], 1, 1e-5);
  assert_near(sums[3] / sums[0], 1, 1e-5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blur_is_one_sided),
      cmocka_unit_test(blur_has_its_own_size_along_each_axis),
      cmocka_unit_test(motion_blurs_along_the_way),
      cmocka_unit_test(ellipse_is_turned),
      cmocka_unit_test(turned_ellipse_meets_the_straight_one),
      cmocka_unit_test(strips_of_any_height_give_one_picture),
      cmocka_unit_test(blur_keeps_the_light),
  };
  return cmocka_run_group_tests_name("render blur", tests, NULL, NULL);
}
