/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cantilevers as drawn: widths, lengths and area in the picture against the truth, defects, and the
 * specs that must be refused. */
#include "render_picture.h"

#include "render/spec.h"
#include "support/brief.h"
#include "support/test.h"

#define HEAD "{\"schema\":\"foilgauge/render/1\",\"seed\":9,"
/* Four beams of 5 by 1.5 mm, at 1200 dpi. */
#define DESIGN                                                                                     \
  "\"design\":{\"form\":\"cantilever\",\"beam_count\":4,\"beam_length_mm\":5,\"beam_width_mm\":1." \
  "5,\"thickness_mm\":0.1,\"sagitta_mm\":0.5,\"clearance_mm\":0.1}"
#define SCANNER "\"scanner\":{\"dpi\":1200," EXACT

static const double pixel_mm = 25.4 / 1200, quarter = 0.25 * 3.14159265358979323846;

static picture draw_sheet(const char *foil, const char *scanner) {
  return draw_format(HEAD "\"foils\":[{" DESIGN "%s}]," SCANNER "%s}}", foil, scanner);
}

/* Material along a row or column of pixels, px, from one place to another. */
static double material(const picture *p, int64_t x, int64_t y, int64_t to, bool down) {
  double sum = 0;
  for (int64_t k = down ? y : x; k <= to; k++)
    sum += down ? coverage(p, x, k) : coverage(p, k, y);
  return sum;
}

/* Beams along x: across the middle of one there is its width; in a sheet what the slits leave. */
static void check_width(const char *layout) {
  char foil[512];
  snprintf(foil, sizeof foil,
           ",\"rotate_deg\":0,\"beams\":{\"layout\":\"%s\",\"width_um\":[0,-32,50,7],"
           "\"length_um\":[0,22,-100,300]}",
           layout);
  picture p = draw_sheet(foil, "");
  const fg_render_foil *truth = &p.truth->foils[0];
  assert_int_equal(truth->beam_count, 4);
  for (size_t i = 0; i < 4; i++) {
    const fg_render_beam *beam = &truth->beams[i];
    int64_t x = llround(0.5 * (beam->root_px.x + beam->tip_px.x)), y = llround(beam->root_px.y);
    int64_t half = (int64_t)(0.5 * (beam->width_mm + 0.2) / pixel_mm);
    assert_near(material(&p, x, y - half, y + half, true), beam->width_mm / pixel_mm, 2e-3);
    /* From within the base to beyond the free end, before the rest of the sheet. */
    int64_t from = llround(beam->root_px.x) - 40, to = llround(beam->tip_px.x + 0.1 / pixel_mm);
    assert_near(material(&p, from, y, to, false), beam->tip_px.x - ((double)from - 0.5), 2e-3);
    assert_near(beam->tip_px.x - beam->root_px.x, beam->length_mm / pixel_mm, 1e-9);
  }
  assert_near(truth->beams[1].width_mm, 1.468, 1e-12);
  assert_near(truth->beams[3].length_mm, 5.3, 1e-12);
  drop(&p);
}

static void comb_has_its_widths_and_lengths(void **state) {
  (void)state;
  check_width("comb");
}

static void slits_leave_their_widths_and_lengths(void **state) {
  (void)state;
  check_width("slits");
}

/* Place of the base's edge, half way between two beams, and of the end of a slit, in the slit. */
static void beam_roots_agree_with_the_truth(void **state) {
  (void)state;
  for (int slits = 0; slits < 2; slits++) {
    picture p = draw_sheet(slits ? ",\"rotate_deg\":0,\"beams\":{\"layout\":\"slits\"}"
                                 : ",\"rotate_deg\":0,\"beams\":{\"root_radius_mm\":0.1}",
                           ",\"blur_px\":0.5");
    const fg_render_beam *beam = &p.truth->foils[0].beams[1];
    double gap = slits ? beam->root_px.y + (0.75 + 0.1) / pixel_mm
                       : 0.5 * (beam->root_px.y + p.truth->foils[0].beams[2].root_px.y);
    int64_t from = llround(beam->root_px.x) - 40, to = llround(beam->root_px.x) + 40;
    double edge = material(&p, from, llround(gap), to, false) + (double)from - 0.5;
    /* A slit's round end of radius r seen beside its middle; blur of variance v moves it by
     * v / (2 r), the pixel's square adds 1/12. */
    double radius = 0.1 / pixel_mm, beside = (double)llround(gap) - gap;
    double moved = slits ? (beside * beside + 0.5 * 0.5 + 1.0 / 12) / (2 * radius) : 0;
    assert_near(edge, beam->root_px.x + moved, slits ? 5e-3 : 2e-3);
    drop(&p);
  }
}

/* Area by the shoelace and by what rounding takes off and adds, against the sum over the picture:
 * the inside is filled, at any angle, whatever lies near. */
static void comb_has_its_area(void **state) {
  (void)state;
  static const double angles[] = {0, -90, 33, 200};
  for (size_t i = 0; i < 4; i += test_step(2)) {
    char foil[256];
    snprintf(foil, sizeof foil,
             ",\"rotate_deg\":%g,\"mirror\":%s,\"beams\":{\"pitch_mm\":2.5,\"base_mm\":3,"
             "\"shoulder_mm\":1,\"corner_radius_mm\":0.2,\"root_radius_mm\":0.4}",
             angles[i], i % 2 ? "true" : "false");
    picture p = draw_sheet(foil, "");
    double sum = 0, row = 3 * 2.5 + 1.5 + 2;
    for (int64_t k = 0; k < p.width * p.height; k++)
      sum += (p.dn[k] - 20) / 200;
    double area =
        row * 3 + 4 * 5 * 1.5 - (4 + 8) * (1 - quarter) * 0.2 * 0.2 + 8 * (1 - quarter) * 0.4 * 0.4;
    assert_near(sum * pixel_mm * pixel_mm / area, 1, 2e-5);
    drop(&p);
  }
}

/* The inside is the same in strips of any height, with effects of the scanner, and where the sheet
 * goes beyond the picture. */
static void strips_do_not_show(void **state) {
  (void)state;
  const char *json =
      HEAD "\"foils\":[{" DESIGN ",\"centre_mm\":[3,6],\"rotate_deg\":-100,\"beams\":{\"layout\":"
           "\"slits\"}}],\"width_px\":400,\"height_px\":500,\"scanner\":{\"dpi\":1200,\"noise\":0,"
           "\"rough\":{\"halo\":{\"fraction\":0.1,\"length_px\":12},\"edge_roughness_um\":4,"
           "\"side_wall\":{\"amplitude\":0.3,\"direction_deg\":45,\"length_px\":8}},"
           "\"chip_seams\":[{\"x_mm\":4,\"shift_um\":50}]},"
           "\"effects\":[{\"id\":\"scan.carriage_ripple\",\"amplitude_um\":20,\"period_mm\":3}]}";
  picture a = draw(0, json), b = draw(64, json);
  assert_memory_equal(a.dn, b.dn, (size_t)(a.width * a.height) * sizeof *a.dn);
  assert_near(a.dn[1], 205, 1); /* within the sheet, that goes on beyond the picture */
  drop(&a);
  drop(&b);
}

static void scanner_effects_move_the_edges(void **state) {
  (void)state;
  picture p = draw_format(HEAD "\"foils\":[{" DESIGN ",\"rotate_deg\":0}]," SCANNER
                               "},\"effects\":[{\"id\":\"scan.scale_y\",\"value\":0.004}]}");
  const fg_render_beam *beam = &p.truth->foils[0].beams[2];
  int64_t x = llround(beam->root_px.x) + 100, y = llround(beam->root_px.y);
  assert_near(material(&p, x, y - 45, y + 45, true), 1.5 / pixel_mm / 1.004, 2e-3);
  drop(&p);
}

/* Edges scatter each by itself, by both sds together: the width along a beam by sqrt(2) of that. */
static void edges_scatter(void **state) {
  (void)state;
  picture p = draw_sheet(",\"rotate_deg\":0",
                         ",\"blur_px\":0.6,\"rough\":{\"edge_roughness_um\":8,\"edge_common_um\":6,"
                         "\"correlation_um\":150}");
  double sum = 0, squares = 0;
  int count = 0;
  for (size_t i = 0; i < 4; i++) {
    const fg_render_beam *beam = &p.truth->foils[0].beams[i];
    int64_t y = llround(beam->root_px.y);
    for (int64_t x = llround(beam->root_px.x) + 25; x < beam->tip_px.x - 10; x++, count++) {
      double off = material(&p, x, y - 50, y + 50, true) - 1.5 / pixel_mm;
      sum += off;
      squares += off * off;
    }
  }
  double sd_um = 1e3 * pixel_mm * sqrt(squares / count);
  assert_near(sd_um / (10 * sqrt(2)), 1, 0.2);
  assert_near(1e3 * pixel_mm * sum / count, 0, 3);
  drop(&p);
}

/* A bright band goes on from the edges that face it, across the slit. */
static void walls_stand_beside_edges_that_face_them(void **state) {
  (void)state;
  picture p = draw_sheet(",\"rotate_deg\":0,\"beams\":{\"pitch_mm\":4}",
                         ",\"rough\":{\"side_wall\":{\"amplitude\":0.5,\"direction_deg\":90,"
                         "\"length_px\":10}}");
  const fg_render_beam *beam = &p.truth->foils[0].beams[1];
  int64_t x = llround(beam->root_px.x) + 120;
  double low = beam->root_px.y + 0.75 / pixel_mm, high = beam->root_px.y - 0.75 / pixel_mm;
  assert_near(coverage(&p, x, llround(low) + 10), 0.5 * exp(-1), 0.03);
  assert_near(coverage(&p, x, llround(high) - 10), 0, 1e-3);
  drop(&p);
}

static void defects_are_drawn_and_told(void **state) {
  (void)state;
  picture p = draw_sheet(",\"rotate_deg\":0,\"beams\":{\"pitch_mm\":3,\"missing\":[1],\"taper_um\":"
                         "[0,100,0,0],\"torn\":[{\"beam\":3,\"length_factor\":0.6}],"
                         "\"bent\":[{\"beam\":4,\"angle_deg\":6}]}",
                         "");
  const fg_render_foil *truth = &p.truth->foils[0];
  assert_int_equal(truth->beam_count, 3);
  const fg_render_beam *taper = &truth->beams[0], *torn = &truth->beams[1],
                       *bent = &truth->beams[2];
  assert_int_equal(taper->number, 2);
  assert_near(taper->taper_um, 100, 1e-9);
  int64_t y = llround(taper->root_px.y), x = llround(taper->root_px.x);
  double wide = material(&p, x + 40, y - 60, y + 60, true);
  double narrow = material(&p, x + 200, y - 60, y + 60, true);
  assert_near((wide - narrow) / 160, 0.1 / 5, 1e-4);
  assert_true(torn->torn && !bent->torn);
  assert_near(torn->length_mm, 3, 1e-12);
  y = llround(torn->root_px.y);
  double sum = 0;
  for (int64_t k = y - 34; k <= y + 34; k++)
    sum += material(&p, x - 40, k, x + 236, false) - 40.5 - (double)x + torn->root_px.x;
  assert_near(sum / 69 * pixel_mm, 3, 0.1);
  assert_near(bent->tip_px.x - bent->root_px.x, 5 * cos(0.1047197551) / pixel_mm, 1e-4);
  assert_near(bent->tip_px.y - bent->root_px.y, 5 * sin(0.1047197551) / pixel_mm, 1e-4);
  int64_t at = llround(0.5 * (bent->tip_px.x + bent->root_px.x));
  y = llround(0.5 * (bent->tip_px.y + bent->root_px.y));
  assert_near(material(&p, at, y - 60, y + 60, true), 1.5 / cos(0.1047197551) / pixel_mm, 5e-3);
  drop(&p);
}

/* Numbers run along y where beams point along x, the other way round in a mirrored foil; the same
 * deviations whatever is missing. */
static void numbers_and_draws_stay(void **state) {
  (void)state;
  const char *random = "\"length\":{\"mean_um\":10,\"sd_um\":40},\"width\":{\"sd_um\":30}";
  char foil[256];
  snprintf(foil, sizeof foil, ",\"rotate_deg\":0,\"beams\":{%s}", random);
  picture a = draw_sheet(foil, "");
  snprintf(foil, sizeof foil, ",\"rotate_deg\":0,\"mirror\":true,\"beams\":{%s,\"missing\":[2]}",
           random);
  picture b = draw_sheet(foil, "");
  const fg_render_beam *all = a.truth->foils[0].beams, *rest = b.truth->foils[0].beams;
  assert_true(all[0].root_px.y < all[1].root_px.y && all[0].length_mm != all[1].length_mm);
  assert_true(rest[0].root_px.y > rest[1].root_px.y);
  assert_int_equal(rest[1].number, 3);
  assert_near(rest[1].length_mm, all[2].length_mm, 0);
  assert_near(rest[1].width_mm, all[2].width_mm, 0);
  drop(&a);
  drop(&b);
}

static void truth_holds_derived_values(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  char *json = NULL;
  /* +0.44 % of length, -2.19 % of width. */
  const char *text = HEAD "\"foils\":[{" DESIGN ",\"beams\":{\"length_um\":[22,0,0,0],"
                          "\"width_um\":[-32.85,0,0,0]}}]}";
  assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", text, &spec));
  assert_ok(&ctx, fg_render_truth_json(&ctx, spec, &json));
  assert_has(json, "\"form\": \"cantilever\"");
  assert_near(strtod(strstr(json, "compliance_error_pct\":") + 22, NULL), 3.5939, 1e-3);
  assert_near(strtod(strstr(json, "sagitta_error_pct\":") + 19, NULL), 0.8819, 1e-3);
  assert_near(strtod(strstr(json, "clearance_change_pct\":") + 22, NULL), -4.4097, 1e-3);
  assert_status(&ctx, fg_render_midline(&ctx, spec, 0, 0, &(fg_point){0}), FG_ERR_USAGE);
  free(json);
  fg_render_free(spec);
}

static void bad_beams_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *foil, *words;
  } table[] = {
      {"\"beams\":{}", "foils[0].beams is missing: belongs to form \"cantilever\" only"},
      {DESIGN ",\"missing\":[1]", "missing is missing: belongs to foils that are bent"},
      {DESIGN ",\"beams\":[]", "must be an object"},
      {DESIGN ",\"beams\":{\"layout\":\"fan\"}", "must be \"comb\" or \"slits\""},
      {DESIGN ",\"beams\":{\"kerf_mm\":0.1}", "belongs to layout \"slits\" only"},
      {DESIGN ",\"beams\":{\"layout\":\"slits\",\"root_radius_mm\":0.1}", "layout \"comb\" only"},
      {DESIGN ",\"beams\":{\"length_um\":[1,2,3]}", "must be an array of 4 to 4 numbers"},
      {DESIGN ",\"beams\":{\"taper_um\":\"no\"}", "taper_um"},
      {DESIGN ",\"beams\":{\"missing\":[5]}", "missing[0] is 5"},
      {DESIGN ",\"beams\":{\"torn\":[{\"length_factor\":0.5}]}", "say which beam, from 1"},
      {DESIGN ",\"beams\":{\"torn\":[{\"beam\":1,\"angle_deg\":3}]}", "there is no such member"},
      {DESIGN ",\"beams\":{\"bent\":{}}", "bent is {}: must be an array"},
      {DESIGN ",\"beams\":{\"pitch_mm\":1.4}", "beam 2 meets the one before it"},
      {DESIGN ",\"beams\":{\"pitch_mm\":1.6}", "no room is left for the corners"},
      {DESIGN ",\"beams\":{\"bent\":[{\"beam\":1,\"angle_deg\":20}]}", "beam 2 meets the one"},
      {DESIGN ",\"beams\":{\"layout\":\"slits\",\"bent\":[{\"beam\":1}],\"kerf_mm\":0.1}",
       "beam 1 is bent beyond its slit"},
      {DESIGN ",\"beams\":{\"corner_radius_mm\":2}", "no room is left for the corners"},
      {DESIGN ",\"beams\":{\"width\":{\"mean_um\":-1600}}", "beam 1 has no length or no width"},
      {"\"design\":{\"form\":\"cantilever\",\"beam_count\":0}", "beam_count is 0"},
  };
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    in_row("table[%zu]", i);
    fg_context ctx = {0};
    fg_render_spec *spec = NULL;
    char json[1024];
    snprintf(json, sizeof json, HEAD "\"foils\":[{%s}]}", table[i].foil);
    if (fg_render_parse(&ctx, "spec.json", json, &spec) != FG_ERR_DATA)
      fail_msg("not refused: %s", json);
    if (!strstr(ctx.message, table[i].words))
      fail_msg("%s: '%s' does not say '%s'", json, ctx.message, table[i].words);
    assert_null(spec);
  }
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  assert_status(&ctx,
                fg_render_parse(&ctx, "spec.json",
                                HEAD "\"foils\":[{" DESIGN "}],\"effects\":[{\"id\":"
                                     "\"part.ovality\",\"amplitude_um\":5}]}",
                                &spec),
                FG_ERR_DATA);
  assert_has(ctx.message, "effects[0] is part.ovality");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(comb_has_its_widths_and_lengths),
      cmocka_unit_test(slits_leave_their_widths_and_lengths),
      cmocka_unit_test(beam_roots_agree_with_the_truth),
      cmocka_unit_test(comb_has_its_area),
      cmocka_unit_test(strips_do_not_show),
      cmocka_unit_test(scanner_effects_move_the_edges),
      cmocka_unit_test(edges_scatter),
      cmocka_unit_test(walls_stand_beside_edges_that_face_them),
      cmocka_unit_test(defects_are_drawn_and_told),
      cmocka_unit_test(numbers_and_draws_stay),
      cmocka_unit_test(truth_holds_derived_values),
      cmocka_unit_test(bad_beams_are_refused),
  };
  return cmocka_run_group_tests_name("render_beams", tests, NULL, NULL);
}
