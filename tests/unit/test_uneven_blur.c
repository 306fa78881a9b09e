/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A blur that is longer along one axis moves a curved edge by its extent along the edge: circles
 * and heights against renders of known truth. */
#include "support/brief.h"
#include "support/measured_render.h"
#include "support/test.h"

/* Limits for errors of the model: there is no noise to speak of. Errors that both circles have in
 * common leave heights alone. */
#define HEIGHT_UM 0.05
#define ANGLE_DEG 0.01

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

static void check_turn(int degrees, const char *blur) {
  char json[4096], foil[64];
  snprintf(foil, sizeof foil, ",\"rotate_deg\":%d", degrees);
  small_foil(json, sizeof json, 3, foil,
             "\"dpi\":4800,\"bits\":16,\"noise\":0.3,\"background\":45,\"contrast\":150,%s", blur);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  const fg_foil *f = &m.result.foils[0];
  assert_true(f->strip.picture.findings & FG_PICTURE_UNEVEN_BLUR);
  assert_false(f->strip.picture.findings & FG_PICTURE_SHADOW);
  for (size_t i = 0; i < f->bump_count; i++) {
    const fg_render_bump *truth = drawn(&m, &f->bumps[i]);
    double h = 1000 * (f->bumps[i].height_mm - truth->height_mm);
    double angle = f->bumps[i].bump_angle_deg - truth->bump_angle_deg;
    if (getenv("FOILGAUGE_TEST_SHOW"))
      printf("%d %s: h %+.3f um, alpha %+.4f deg, R %+.3f um, u %.3f\n", degrees, blur, h, angle,
             1000 * (f->bumps[i].radius_mm - truth->radius_mm), 1000 * f->bumps[i].u_radius_mm);
    if (fabs(h) > HEIGHT_UM || fabs(angle) > ANGLE_DEG)
      fail_msg("%d deg, %s: h off by %.3f um, alpha by %.4f deg", degrees, blur, h, angle);
    double off = f->bumps[i].radius_mm - truth->radius_mm;
    if (fabs(off) > 2.5 * f->bumps[i].u_radius_mm)
      fail_msg("%d deg, %s: R off by %.3f um, u %.3f um", degrees, blur, 1000 * off,
               1000 * f->bumps[i].u_radius_mm);
  }
  measured_free(&m);
}

static void curved_edges_stay_in_place(void **state) {
  (void)state;
  static const int turns[] = {-90, 0, 130};
  for (unsigned i = 0; i < 3; i += test_step(2))
    check_turn(turns[i], "\"blur_px\":[4,1.3]");
}

static void along_any_axis(void **state) {
  (void)state;
  check_turn(-60, "\"blur_px\":[4,1.3],\"blur_angle_deg\":50");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(curved_edges_stay_in_place),
      cmocka_unit_test(along_any_axis),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
