/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges: every station against the true midline, the standard deviations against the scatter, and
 * findings about the scanner on the way. */
#include "support/brief.h"
#include "support/measured_render.h"
#include "support/test.h"

typedef struct line_error {
  double mean_px, sd_px, worst_px; /* of the midline, along the normal */
  double expected_px;              /* as the stations' own standard deviations say */
  size_t count;
} line_error;

/* True midline, densely sampled, in px. */
static fg_point *true_midline(const measured *m, double step_mm, size_t *count) {
  fg_context ctx = {0};
  fg_point *points = calloc(100000, sizeof *points);
  for (*count = 0; *count < 100000; ++*count)
    if (fg_render_midline(&ctx, m->picture.spec, 0, step_mm * (double)*count, &points[*count]) !=
        FG_OK)
      break;
  return points;
}

/* Signed distance of a point from a polyline, along a normal, and which vertex is near. */
static double distance_from(const fg_point *line, size_t count, size_t *near, fg_point p,
                            fg_point normal) {
  double min = INFINITY;
  size_t from = *near > 400 ? *near - 400 : 0, to = *near + 400 < count ? *near + 400 : count;
  if (*near == 0) to = count;
  for (size_t i = from; i < to; i++) {
    double d = hypot(line[i].x - p.x, line[i].y - p.y);
    if (d < min) {
      min = d;
      *near = i;
    }
  }
  size_t i = *near > 0 ? *near - 1 : 0, j = *near + 1 < count ? *near + 1 : *near;
  double tx = line[j].x - line[i].x, ty = line[j].y - line[i].y, length = hypot(tx, ty);
  double across = ((p.x - line[i].x) * ty - (p.y - line[i].y) * tx) / length;
  return (normal.x * ty - normal.y * tx) / length > 0 ? across : -across;
}

/* All stations that belong to an arc and are usable. The blur's shift towards the centre of
 * curvature (0.002 px at most here) stays in. */
static line_error compare_line(const measured *m) {
  const fg_foil *foil = &m->result.foils[0];
  double px = 25.4 / m->result.dpi[0];
  size_t count, near = 0;
  fg_point *line = true_midline(m, 0.002, &count);
  line_error e = {0};
  double sum = 0, square = 0, expected = 0;
  for (size_t k = 0; k < foil->strip.count; k++) {
    const fg_station *s = &foil->strip.stations[k];
    if (!(s->weight > 0) || !foil->labels[k].fitted) continue;
    fg_point p = {0.5 * (s->left.x + s->right.x) / px, 0.5 * (s->left.y + s->right.y) / px};
    double d = distance_from(line, count, &near, p, s->normal);
    sum += d;
    square += d * d;
    expected +=
        0.25 * (s->u_left_um * s->u_left_um + s->u_right_um * s->u_right_um) * 1e-6 / px / px;
    e.worst_px = fmax(e.worst_px, fabs(d));
    e.count++;
  }
  double n = (double)e.count;
  e.mean_px = sum / n;
  e.sd_px = sqrt(square / n - e.mean_px * e.mean_px);
  e.expected_px = sqrt(expected / n);
  free(line);
  return e;
}

static measured measure_scanner(const char *scanner) {
  char json[4096];
  small_foil(json, sizeof json, 2, ",\"rotate_deg\":-73", "%s", scanner);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  assert_int_equal(m.result.foils[0].bump_count, 2);
  return m;
}

/* sd of the blur that the stations should show: the pixel's own box adds 1/12 px². */
static double blur_seen(double blur_px) {
  return sqrt(blur_px * blur_px + 1.0 / 12);
}

static void edges_are_on_the_truth(void **state) {
  (void)state;
  static const struct {
    const char *scanner;
    double blur_px, gamma, thickness_um;
  } cases[] = {
      {"\"bits\":16,\"noise\":0.02,\"blur_px\":1.2", 1.2, 1, 0.03},
      {"\"bits\":16,\"noise\":0.02,\"blur_px\":0.7", 0.7, 1, 0.03},
      {"\"bits\":16,\"noise\":0.02,\"blur_px\":3", 3, 1, 0.05},
      {"\"bits\":16,\"noise\":0.02,\"contrast\":-175,\"background\":230", 1.2, 1, 0.03},
      {"\"noise\":1,\"blur_px\":2", 2, 1, 0.05},
      {"\"noise\":1,\"gamma\":2.2", 1.2, 2.2, 0.3},
      {"\"noise\":1,\"gamma\":0.45", 1.2, 0.45, 0.3},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += test_step(3)) {
    measured m = measure_scanner(cases[i].scanner);
    const fg_strip *strip = &m.result.foils[0].strip;
    line_error e = compare_line(&m);
    double px_um = 25400 / m.result.dpi[0];
    assert_true(e.count > 800);
    /* Blur moves the edges of a bump towards its centre by s²/(2R), R being 640 px. */
    assert_near(e.mean_px, 0, 0.003 + cases[i].blur_px * cases[i].blur_px / 1280);
    if (strstr(cases[i].scanner, "0.02")) {
      assert_near(e.sd_px, 0, 0.003 + cases[i].blur_px * cases[i].blur_px / 1280);
      /* At an arc's end half of what the blur does to a fillet (R 66 px) may show. */
      assert_near(e.worst_px, 0, 0.015 + cases[i].blur_px * cases[i].blur_px / 264);
    }
    assert_near(strip->blur_left_um / px_um, blur_seen(cases[i].blur_px), 0.02);
    assert_near(strip->blur_right_um / px_um, blur_seen(cases[i].blur_px), 0.02);
    assert_near(strip->gamma, cases[i].gamma, 0.03 * cases[i].gamma);
    assert_near(strip->thickness_mm * 1000, 100, cases[i].thickness_um);
    assert_int_equal(strip->facts, 0);
    measured_free(&m);
  }
}

/* The scatter of the line agrees with its standard deviations, and lies near the bound (n / A)
 * sqrt(2 s sqrt(pi)) / sqrt(px per station) of one edge, over sqrt(2) for two. */
static void standard_deviations_are_the_scatter(void **state) {
  (void)state;
  static const struct {
    const char *scanner;
    double noise, contrast, blur_px, most_of_bound;
  } cases[] = {
      {"\"noise\":2,\"blur_px\":1.2", 2, 175, 1.2, 1.15},
      {"\"noise\":5,\"blur_px\":2", 5, 175, 2, 1.15},
      {"\"noise\":1,\"contrast\":30,\"blur_px\":1.2", 1, 30, 1.2, 1.15},
      {"\"noise\":2,\"blur_px\":3", 2, 175, 3, 1.2},
      {"\"noise\":2,\"contrast\":-175,\"background\":230", 2, 175, 1.2, 1.15},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += test_step(3)) {
    measured m = measure_scanner(cases[i].scanner);
    line_error e = compare_line(&m);
    double noise = sqrt(cases[i].noise * cases[i].noise + 1.0 / 12), step_px = 2;
    double bound = noise / cases[i].contrast *
                   sqrt(2 * blur_seen(cases[i].blur_px) * sqrt(3.14159265358979)) /
                   sqrt(2 * step_px);
    assert_near(e.sd_px / e.expected_px, 1, 0.12);
    if (!(e.sd_px < cases[i].most_of_bound * bound))
      fail_msg("%s: scatter %.4f px, bound %.4f", cases[i].scanner, e.sd_px, bound);
    assert_near(m.result.foils[0].strip.noise * 255, noise, 0.25 * noise);
    assert_near(m.result.foils[0].strip.contrast * 255, cases[i].contrast,
                0.02 * cases[i].contrast);
    measured_free(&m);
  }
}

/* One-sided blur: each edge gets its own, and the radii do not suffer. */
static void two_blurs_are_told_apart(void **state) {
  (void)state;
  measured m = measure_scanner("\"rough\":{\"one_sided_blur_px\":1.8}");
  const fg_strip *strip = &m.result.foils[0].strip;
  assert_true(fabs(strip->blur_left_um - strip->blur_right_um) > 2);
  assert_near(compare_line(&m).mean_px, 0, 0.003);
  measured_free(&m);
}

static void clipping_is_flagged(void **state) {
  (void)state;
  const char *scanners[] = {
      "\"contrast\":225,\"clip_white\":235", /* below the end of the scale */
      "\"background\":250,\"contrast\":-200,\"clip_white\":240",
      "\"background\":254,\"contrast\":-200,\"noise\":3",
  };
  for (size_t i = 0; i < 3; i++) {
    measured m = measure_scanner(scanners[i]);
    const fg_foil *foil = &m.result.foils[0];
    if (!(foil->flags & FG_FOIL_CLIPPED)) fail_msg("%s: not flagged", scanners[i]);
    assert_near(compare_line(&m).mean_px, 0, 0.005);
    assert_near(foil->thickness.mm * 1000, 100, 2);
    measured_free(&m);
  }
}

static void a_side_wall_is_flagged(void **state) {
  (void)state;
  const double amplitudes[] = {0.35, -0.35};
  for (int i = 0; i < 2; i++) {
    char scanner[200];
    snprintf(scanner, sizeof scanner,
             "\"rough\":{\"side_wall\":{\"amplitude\":%g,\"direction_deg\":100,\"length_px\":15}}",
             amplitudes[i]);
    measured m = measure_scanner(scanner);
    assert_true(m.result.foils[0].flags & FG_FOIL_SIDE_BAND);
    measured_free(&m);
  }
}

/* The wall's light is neither taken for a driver's work nor for a wide blur. */
static void edges_beside_a_wall_are_on_the_truth(void **state) {
  (void)state;
  static const char *walls[] = {
      "{\"amplitude\":0.35,\"direction_deg\":90,\"length_px\":8,\"gap_px\":2}",
      "{\"amplitude\":0.55,\"direction_deg\":100,\"length_px\":10,\"gap_px\":1}",
  };
  for (size_t i = 0; i < 2; i++) {
    char scanner[400];
    snprintf(scanner, sizeof scanner,
             "\"blur_px\":2.1,\"gamma\":1.2,\"noise\":1.6,\"rough\":{\"side_wall\":%s,"
             "\"halo\":{\"fraction\":0.15,\"length_px\":15}}",
             walls[i]);
    measured m = measure_scanner(scanner);
    const fg_foil *foil = &m.result.foils[0];
    line_error e = compare_line(&m);
    assert_true(foil->flags & FG_FOIL_SIDE_BAND);
    assert_near(e.mean_px, 0, 0.3);
    assert_near(e.worst_px, 0, 0.4);
    assert_near(foil->strip.gamma, 1.2, 0.1);
    assert_near(foil->thickness.mm * 1000, 100, 2);
    measured_free(&m);
  }
}

/* Used as light, counts beside a halo show lower steps and wider blurs than the model, but about
 * the same width. */
static void a_width_without_a_model_is_that_of_the_truth(void **state) {
  (void)state;
  measured m = measure_scanner("\"blur_px\":2.1,\"noise\":1,"
                               "\"rough\":{\"halo\":{\"fraction\":0.15,\"length_px\":8}}");
  const fg_strip *strip = &m.result.foils[0].strip;
  double px_um = 25400 / m.result.dpi[0];
  assert_near(strip->blur_left_um / px_um, blur_seen(2.1), 0.03);
  assert_near(strip->plain_blur_um / px_um, blur_seen(2.1) + 0.1, 0.05);
  assert_true(strip->plain_counts < 0.97 * 255 * strip->contrast);
  assert_near(strip->plain_mm * 1000, 100, 0.5);
  measured_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_are_on_the_truth),
      cmocka_unit_test(standard_deviations_are_the_scatter),
      cmocka_unit_test(two_blurs_are_told_apart),
      cmocka_unit_test(clipping_is_flagged),
      cmocka_unit_test(a_side_wall_is_flagged),
      cmocka_unit_test(edges_beside_a_wall_are_on_the_truth),
      cmocka_unit_test(a_width_without_a_model_is_that_of_the_truth),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
