/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Free-form curves of scanner and part: what moves, by how much, and where. */
#include "render_picture.h"
#include "support/test.h"

typedef struct field_case {
  const char *effect;
  double dx_um, dy_um; /* d at the disc's true centre (1.6, 1.2) mm */
} field_case;

/* True = nominal + d: the disc shows where nominal = true - d. */
static void curves_move_the_picture(void **state) {
  (void)state;
  static const field_case cases[] = {
      {"{\"id\":\"free.scan.x\",\"knots\":[[0.2,1],[1.6,7],[3,1],[20,30]]}", 7, 0},
      {"{\"id\":\"free.scan.x\",\"moves\":\"y\",\"knots\":[[0.2,1],[1.6,-7],[3,1]]}", 0, -7},
      {"{\"id\":\"free.scan.x\",\"knots\":[[1.8,9],[2.5,4]]}", 9, 0},
      {"{\"id\":\"free.scan.x\",\"knots\":[[0.2,4],[1.2,-9]]}", -9, 0},
      {"{\"id\":\"free.scan.y\",\"knots\":[[-1,0],[0,1],[0.6,3],[1.2,5],[3,0]]}", 0, 5},
      /* Half way between knots: the natural spline through 0, 16, 0 has there 11. */
      {"{\"id\":\"free.scan.y\",\"moves\":\"x\",\"knots\":[[0,0],[2.4,16],[4.8,0]]}", 11, 0},
      /* A disc's edge moves by the direction that it looks to: 5 to the right on both sides. */
      {"{\"id\":\"free.edge.normal\",\"knots\":[[0,5],[60,2.5],[120,-2.5],[180,-5],[240,-2.5],[300,"
       "2.5]]}",
       -5, 0},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":420,"
                            "\"height_px\":340,\"discs\":[{\"centre_mm\":[1.6,1.2],"
                            "\"radius_mm\":0.1}],\"effects\":[%s],\"scanner\":{" EXACT "}}",
                            cases[i].effect);
    double area = 0, mx = 0, my = 0;
    for (int64_t y = 0; y < p.height; y++)
      for (int64_t x = 0; x < p.width; x++) {
        area += coverage(&p, x, y);
        mx += coverage(&p, x, y) * (double)x;
        my += coverage(&p, x, y) * (double)y;
      }
    /* The mean of a curve over the disc is not its value at the centre: r²/8 of its bend. */
    assert_near((1.6 - mx / area * pixel) * 1e3, cases[i].dx_um, 0.06);
    assert_near((1.2 - my / area * pixel) * 1e3, cases[i].dy_um, 0.06);
    drop(&p);
  }
}

/* Column through the crown of the middle bump of an upright foil: where its midline is, and the
 * strip's thickness. */
static double middle_crown(const picture *p, double *thickness_px) {
  const fg_render_bump *bump = &p->truth->foils[0].bumps[4];
  double expected = bump->centre_px.y + bump->radius_mm / pixel, centre = 0;
  int64_t x = llround(bump->centre_px.x);
  *thickness_px = 0;
  for (int64_t y = llround(expected) - 40; y <= llround(expected) + 40; y++) {
    *thickness_px += coverage(p, x, y);
    centre += coverage(p, x, y) * (double)y;
  }
  return centre / *thickness_px - expected;
}

static double crown_with(const char *effect) {
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"effects\":[%s],"
                          "\"scanner\":{" EXACT "}}",
                          effect);
  double thickness, moved = middle_crown(&p, &thickness);
  drop(&p);
  return moved * pixel * 1e3;
}

/* Free-form curves at the same place: the foil's middle, the bump's, the edge that looks up. */
static void curves_move_the_crown(void **state) {
  (void)state;
  const char *across =
      "{\"id\":\"free.bump.phi\",\"knots\":[[-1,-4],[-0.3,2],[0,%g],[0.6,-5],[1,3]]}";
  const char *along = "{\"id\":\"free.foil.s\",\"knots\":[[-1,9],[-0.4,-3],[0,%g],[0.7,8],[1,0]]}";
  const char *looks = "{\"id\":\"free.edge.normal\",\"knots\":[[10,4],[90,%g],[200,-3],[260,2]]}";
  char effect[256];
  snprintf(effect, sizeof effect, across, 6.0);
  assert_near(crown_with(effect), 6, 0.03);
  snprintf(effect, sizeof effect, along, 7.0);
  assert_near(crown_with(effect), -7, 0.03);
  snprintf(effect, sizeof effect, looks, 5.0);
  assert_near(crown_with(effect), 5, 0.03);
}

static void edges_move_apart(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"effects\":[{\"id\":"
                      "\"free.edge.normal\",\"edges\":\"apart\",\"knots\":[[0,0],[90,4],[180,1]]}],"
                      "\"scanner\":{" EXACT "}}");
  double thickness, moved = middle_crown(&p, &thickness);
  assert_near(moved, 0, 0.004);
  assert_near(thickness, 0.108 / pixel, 0.01);
  drop(&p);
}

/* Distance of a foil's midline from that of the same foil without the effect, all along it: the
 * field at that place, joined at the fillets. */
static void midline_follows_the_curve(void **state) {
  (void)state;
  fg_context ctx = {0};
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"centre_mm\":[20,30]}],"
                       "\"effects\":[%s]}";
  const char *effects[] = {
      "",
      "{\"id\":\"free.foil.s\",\"knots\":[[-1,5],[-0.5,5],[0.25,5],[1,5]]}",
      "{\"id\":\"free.edge.normal\",\"knots\":[[0,5],[90,5],[180,5]]}",
      "{\"id\":\"free.bump.phi\",\"knots\":[[-1,5],[0,5],[1,5]]}",
  };
  fg_render_spec *specs[4];
  for (int i = 0; i < 4; i++) {
    char json[512];
    snprintf(json, sizeof json, format, effects[i]);
    assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", json, &specs[i]));
  }
  fg_point plain, moved, last = {0, 0};
  double steepest = 0, min = INFINITY, max = 0;
  for (double s = 4; s < 40; s += 0.01) {
    assert_ok(&ctx, fg_render_midline(&ctx, specs[0], 0, s, &plain));
    assert_ok(&ctx, fg_render_midline(&ctx, specs[1], 0, s, &moved));
    assert_near(hypot(moved.x - 20 / pixel, moved.y - 30 / pixel) -
                    hypot(plain.x - 20 / pixel, plain.y - 30 / pixel),
                5e-3 / pixel, 1e-9);
    assert_ok(&ctx, fg_render_midline(&ctx, specs[2], 0, s, &moved));
    assert_near(hypot(moved.x - plain.x, moved.y - plain.y) * pixel, 5e-3, 1e-9);
    assert_ok(&ctx, fg_render_midline(&ctx, specs[3], 0, s, &moved));
    double shift = hypot(moved.x - plain.x, moved.y - plain.y) * pixel * 1e3;
    if (s > 4) steepest = fmax(steepest, fabs(shift - last.x));
    last.x = shift;
    min = fmin(min, shift);
    max = fmax(max, shift);
  }
  /* Full on the bumps, none on the lands, and no step between: a fillet is 0.22 mm long, and the
   * steepest slope of a cubic that fades over it is 1.5 times the mean. */
  assert_near(max, 5, 1e-9);
  assert_near(min, 0, 1e-9);
  assert_near(steepest, 1.5 * 5 * 0.01 / 0.22, 0.03);
  for (int i = 0; i < 4; i++)
    fg_render_free(specs[i]);
}

static void stretch_lengthens_the_arcs(void **state) {
  (void)state;
  picture p =
      draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"radius_mm\":[3.32,3.35,3.38,"
              "3.4,3.42,3.32,3.32,3.32,3.32]}],\"effects\":[{\"id\":\"part.stretch\","
              "\"value_rel\":0.01,\"slope_rel_per_mm\":0.2}]}");
  const fg_render_bump *bumps = p.truth->foils[0].bumps;
  for (int i = 0; i < 9; i++) {
    double beyond = bumps[i].radius_mm - 3.32;
    assert_near(bumps[i].bump_angle_deg * bumps[i].radius_mm, 63.15 * 3.32 * (1.01 + 0.2 * beyond),
                1e-9);
  }
  drop(&p);
}

/* Two bumps of one curve in a row leave the strip whole: where its fillets fade the curve out, the
 * area is that of the longer midline. */
static void strip_stays_whole(void **state) {
  (void)state;
  picture p =
      draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"design\":{\"bump_count\":2}}],"
              "\"effects\":[{\"id\":\"free.bump.phi\",\"knots\":[[-1,20],[0,-5],[1,-20]]}],"
              "\"scanner\":{" EXACT "}}");
  fg_context ctx = {0};
  fg_point last, point;
  double length = 0, area = 0, step = 0.002;
  assert_ok(&ctx, fg_render_midline(&ctx, p.spec, 0, 0, &last));
  for (double s = step; fg_render_midline(&ctx, p.spec, 0, s, &point) == FG_OK; s += step) {
    length += hypot(point.x - last.x, point.y - last.y);
    last = point;
  }
  for (int64_t i = 0; i < p.width * p.height; i++)
    area += (p.dn[i] - 20) / 200;
  /* The edges are moved along the undisturbed normal: the strip's width shrinks by the cosine of
   * the slope, at most 0.01, on the fillets. */
  assert_near(area / (length * 0.1 / pixel), 1, 1.5e-3);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(curves_move_the_picture),    cmocka_unit_test(curves_move_the_crown),
      cmocka_unit_test(edges_move_apart),           cmocka_unit_test(midline_follows_the_curve),
      cmocka_unit_test(stretch_lengthens_the_arcs), cmocka_unit_test(strip_stays_whole),
  };
  return cmocka_run_group_tests_name("render curves", tests, NULL, NULL);
}
