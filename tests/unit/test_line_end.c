/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ends of narrow cuts from their pixels: square ones, whose blurred light is known in closed form,
 * and round ones by a sum over the cut's lines. Both are found on their kind and at their place,
 * down to cuts of six pixels. */
#include "vision/line_end.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "support/random.h"
#include "support/test.h"

enum { SIZE = 192, LINES = 400 };
static const double dark = 30, bright = 205, blur = 1.2;

typedef struct cut {
  double half_width, turn_rad, noise;
  fg_point apex;
  bool round;
} cut;

/* Share of the void at a place towards the material, and across the cut. */
static double void_share(const cut *c, double towards, double across) {
  double w = c->half_width, sum = 0;
  if (!c->round)
    return (gsl_cdf_ugaussian_P((w - across) / blur) - gsl_cdf_ugaussian_P((-w - across) / blur)) *
           gsl_cdf_ugaussian_P(-towards / blur);
  for (int i = 0; i < LINES; i++) {
    double t = w * (2 * (i + 0.5) / LINES - 1), end = sqrt(w * w - t * t) - w;
    sum += exp(-0.5 * pow((across - t) / blur, 2)) * gsl_cdf_ugaussian_P((end - towards) / blur);
  }
  return sum * 2 * w / LINES / (blur * sqrt(2 * M_PI));
}

static fg_point towards_material(const cut *c) {
  return (fg_point){cos(c->turn_rad), sin(c->turn_rad)};
}

static fg_tiles draw(const cut *c) {
  fg_context ctx = {0};
  static uint16_t rows[SIZE][SIZE];
  fg_tiles tiles;
  uint64_t seed = 7;
  fg_point d = towards_material(c);
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++) {
      double dx = x - c->apex.x, dy = y - c->apex.y;
      double u = dx * d.x + dy * d.y, v = dx * d.y - dy * d.x;
      bool far = fabs(v) > c->half_width + 8 * blur || u > 8 * blur;
      double share = far ? 0 : void_share(c, u, v);
      double value = bright + (dark - bright) * share + c->noise * random_gaussian(&seed);
      rows[y][x] = (uint16_t)lround(fmin(fmax(value, 0), 255) * 257);
    }
  assert_ok(&ctx, fg_tiles_create(&ctx, SIZE, SIZE, 2, NULL, &tiles));
  for (int strip = 0; strip * FG_TILE_PX < SIZE; strip++)
    assert_ok(&ctx, fg_tiles_add_strip(&ctx, &tiles, (uint8_t *)rows[strip * FG_TILE_PX],
                                       sizeof rows[0]));
  assert_ok(&ctx, fg_tiles_finish(&ctx, &tiles));
  return tiles;
}

/* A start: the arc of half the cut's width, a part of a pixel off. */
static fg_stretch start_of(const cut *c) {
  double r = c->half_width, sine = FG_END_SHARE, off = r - 0.4;
  fg_point d = towards_material(c), along = {d.y, -d.x};
  fg_point centre = {c->apex.x - off * d.x, c->apex.y - off * d.y};
  double forward = r * sqrt(1 - sine * sine), sideways = r * sine;
  return (fg_stretch){{centre.x + forward * d.x - sideways * along.x,
                       centre.y + forward * d.y - sideways * along.y},
                      {centre.x + forward * d.x + sideways * along.x,
                       centre.y + forward * d.y + sideways * along.y},
                      r,
                      r};
}

/* Mean distance of the stations beyond the true end, in the material. */
static double apex_error(const cut *c, const fg_stretch *s, const fg_disc_edge *edge) {
  fg_point d = towards_material(c);
  double sum = 0, used = 0;
  for (size_t i = 0; i < edge->count; i++) {
    double share = ((double)i + 0.5) / (double)edge->count;
    if (!(edge->stations[i].weight > 0)) continue;
    fg_point p = fg_stretch_point(s, share, (double)edge->stations[i].edge_px);
    double along = (p.x - c->apex.x) * d.x + (p.y - c->apex.y) * d.y;
    double across = (p.x - c->apex.x) * d.y - (p.y - c->apex.y) * d.x;
    double depth =
        c->round ? c->half_width - sqrt(c->half_width * c->half_width - across * across) : 0;
    sum += along + depth;
    used++;
  }
  assert_true(used >= 4);
  return sum / used;
}

static double measure_end(const cut *c, bool *flat) {
  fg_context ctx = {0};
  fg_tiles tiles = draw(c);
  const double dpi[2] = {1200, 1200};
  const fg_found_driver none = {.found = false};
  const fg_line_view view = {
      .tiles = &tiles, .shape = fg_pixel_shape_of(dpi), .middle = 0.5 * (dark + bright)};
  const fg_line_tone tone = {
      .tone = fg_tone_linear(), .driver = &none, .blur_along = blur, .blur_across = blur};
  fg_stretch stretch = start_of(c);
  fg_line_found found;
  assert_ok(&ctx, fg_line_end_measure(&ctx, &view, &tone, &stretch, &found));
  double error = apex_error(c, &stretch, &found.edge);
  *flat = fg_line_end_is_flat(&stretch);
  fg_disc_edge_free(&found.edge);
  fg_tiles_free(&tiles);
  return error;
}

static void check_ends(bool round, double noise, double tolerance) {
  static const double half_widths[] = {3, 3.5, 4, 4.6, 6, 10};
  for (size_t i = 0; i < sizeof half_widths / sizeof *half_widths; i++)
    for (int turn = 0; turn < 4; turn++) {
      bool flat;
      const cut c = {half_widths[i],
                     0.09 + 0.37 * turn,
                     noise,
                     {96.3 + 0.21 * turn, 95.6 + 0.17 * (double)i},
                     round};
      double error = measure_end(&c, &flat);
      if (flat == round || fabs(error) > tolerance)
        fail_msg("half width %g, turn %g: %s, off by %g px", c.half_width, c.turn_rad,
                 flat ? "flat" : "round", error);
    }
}

static void square_ends_are_flat_and_at_their_place(void **unused) {
  (void)unused;
  check_ends(false, 0.05, 0.01);
  check_ends(false, 2, 0.1);
}

static void round_ends_stay_round(void **unused) {
  (void)unused;
  check_ends(true, 0.05, 0.02);
  check_ends(true, 2, 0.1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(square_ends_are_flat_and_at_their_place),
      cmocka_unit_test(round_ends_stay_round),
  };
  return cmocka_run_group_tests_name("line_end", tests, NULL, NULL);
}
