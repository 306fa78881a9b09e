/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shadow or a lit wall beside edges of some bearings: u of every circle holds the error that it
 * causes, against renders of known truth. */
#include "support/brief.h"
#include "support/measured_render.h"
#include "support/test.h"

enum { FINE = 4800, COARSE = 2400 };

/* Chance and model together: none may be farther off, and their mean square is no more than that of
 * a u that holds. */
#define MAX_SIGMAS 3.2
#define MAX_RMS    1.3

/* Errors over their u. */
typedef struct errors {
  double squares, count, worst, worst_u_um;
} errors;

static void add_error(errors *e, double off, double u) {
  assert_true(u > 0);
  double z = fabs(off) / u;
  e->squares += z * z;
  e->count++;
  if (z > e->worst) e->worst = z;
  e->worst_u_um = fmax(e->worst_u_um, 1000 * u);
}

/* The bump as drawn that lies where one was measured. */
static const fg_render_bump *drawn(const measured *m, const fg_bump *bump) {
  const fg_render_foil *foil = &m->picture.truth->foils[0];
  double pixel = 25.4 / m->picture.truth->dpi[0];
  for (size_t i = 0; i < foil->bump_count; i++)
    if (hypot(foil->bumps[i].centre_px.x * pixel - bump->centre_mm.x,
              foil->bumps[i].centre_px.y * pixel - bump->centre_mm.y) < 0.5)
      return &foil->bumps[i];
  fail_msg("no bump there");
  return NULL;
}

static measured measure_case(int dpi, int degrees, bool dark, const char *scanner) {
  char json[4096], foil[64];
  snprintf(foil, sizeof foil, ",\"rotate_deg\":%d", degrees);
  small_foil(json, sizeof json, 3, foil, "\"dpi\":%d,\"noise\":1.2,\"blur_px\":%g,%s%s", dpi,
             dpi == FINE ? 1.4 : 1.0,
             dark ? "\"background\":205,\"contrast\":-165," : "\"background\":45,\"contrast\":150,",
             scanner);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  return m;
}

static void add_case(const measured *m, errors *e) {
  const fg_foil *foil = &m->result.foils[0];
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *b = &foil->bumps[i];
    const fg_render_bump *truth = drawn(m, b);
    add_error(&e[0], b->radius_mm - truth->radius_mm, b->u_radius_mm);
    add_error(&e[1], b->bump_angle_deg - truth->bump_angle_deg, b->u_bump_angle_deg);
    add_error(&e[2], b->height_mm - truth->height_mm, b->u_height_mm);
  }
  add_error(&e[3], foil->overall.radius_mm - m->picture.truth->foils[0].overall_radius_mm,
            foil->overall.u_radius_mm);
}

static void check_errors(const char *what, int dpi, const errors e[4]) {
  static const char *const names[] = {"radius", "angle", "height", "overall radius"};
  for (int i = 0; i < 4; i++) {
    double rms = sqrt(e[i].squares / e[i].count);
    if (getenv("FOILGAUGE_TEST_SHOW"))
      printf("%s %d %s: worst %.2f u, rms %.2f u, u up to %.2f\n", what, dpi, names[i], e[i].worst,
             rms, e[i].worst_u_um);
    if (e[i].worst > MAX_SIGMAS || rms > MAX_RMS)
      fail_msg("%s, %d dpi: %s off by up to %.2f u, rms %.2f u", what, dpi, names[i], e[i].worst,
               rms);
  }
}

/* Every direction of light is that of some bearing of the foil. */
static void check_kind(const char *what, const char *scanner) {
  static const int turns[] = {-73, 20, 140};
  for (int dpi = COARSE; dpi <= FINE; dpi += FINE - COARSE) {
    errors e[4] = {{0}};
    for (int dark = 0; dark < 2; dark++)
      for (unsigned i = 0; i < 3; i += test_step(2)) {
        measured m = measure_case(dpi, turns[i], dark, scanner);
        if (!(m.result.foils[0].strip.picture.findings & FG_PICTURE_SHADOW))
          fail_msg("%s, %d dpi, %d deg, %s: no shadow is found", what, dpi, turns[i],
                   dark ? "dark" : "bright");
        add_case(&m, e);
        measured_free(&m);
      }
    check_errors(what, dpi, e);
  }
}

static void a_shadow_is_in_u(void **state) {
  (void)state;
  check_kind("shadow", "\"shadow\":{\"amplitude\":-0.25,\"direction_deg\":-70,\"width_deg\":75,"
                       "\"length_px\":7}");
}

static void a_lit_wall_is_in_u(void **state) {
  (void)state;
  check_kind("wall", "\"rough\":{\"side_wall\":{\"amplitude\":0.15,\"direction_deg\":-90,"
                     "\"length_px\":10}}");
}

/* A height lies between two places that face the same way: it is as good as it was. */
static void heights_stay_sharp(void **state) {
  (void)state;
  measured m = measure_case(FINE, -73, false,
                            "\"rough\":{\"side_wall\":{\"amplitude\":0.15,\"direction_deg\":-90,"
                            "\"length_px\":10}}");
  const fg_foil *foil = &m.result.foils[0];
  for (size_t i = 0; i < foil->bump_count; i++)
    assert_true(foil->bumps[i].u_height_mm < 0.3 * foil->bumps[i].u_radius_mm);
  measured_free(&m);
}

/* Without one no bearing is in doubt. */
static void plain_edges_have_no_shadow(void **state) {
  (void)state;
  measured m = measure_case(COARSE, 20, false, "\"gamma\":1");
  const fg_picture_state *picture = &m.result.foils[0].strip.picture;
  assert_false(picture->findings & FG_PICTURE_SHADOW);
  for (int i = 0; i < FG_PICTURE_BEARINGS; i++)
    assert_true(picture->shadow_at[i] == 0);
  assert_true(1000 * m.result.foils[0].bumps[0].u_radius_mm < 0.4);
  measured_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_shadow_is_in_u),
      cmocka_unit_test(a_lit_wall_is_in_u),
      cmocka_unit_test(heights_stay_sharp),
      cmocka_unit_test(plain_edges_have_no_shadow),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
