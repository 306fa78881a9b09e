/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dust, specks, cuts and other foils on the edges: spoiled values are left out or flagged. */
#include "support/brief.h"
#include "support/measured_render.h"
#include "support/test.h"

/* A single value of many may lie this many standard uncertainties off: 1 in 150,000. */
static const double many_u = 4.5;

static measured measure_foil(const char *members, const char *scanner) {
  char json[4096];
  small_foil(json, sizeof json, 9, members, "%s", scanner);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  return m;
}

/* Every bump is there, and its radius and height are within their uncertainty, or it has one of the
 * flags. */
static void check_bumps(const measured *m, unsigned flags) {
  const fg_foil *f = &m->result.foils[0];
  const fg_render_foil *t = &m->picture.truth->foils[0];
  assert_int_equal(f->bump_count, t->bump_count);
  for (size_t i = 0; i < f->bump_count; i++) {
    const fg_bump *b = &f->bumps[i];
    if (b->flags & flags) continue;
    double radius = fabs(b->radius_mm - t->bumps[i].radius_mm) / b->u_radius_mm;
    double height = fabs(b->height_mm - t->bumps[i].height_mm) / b->u_height_mm;
    if (!(fmax(radius, height) < many_u))
      fail_msg("bump %d: R is off by %.1f u, h by %.1f u", b->number, radius, height);
  }
}

/* Dust and specks beside the edges and on them, darker or lighter. */
static void dust_does_not_move_a_bump(void **state) {
  (void)state;
  static const char *scanners[] = {
      "\"dpi\":2400,\"blur_px\":2,\"background\":207,\"contrast\":-169,\"dust\":{\"count\":1300,"
      "\"radius_px\":4,\"contrast\":-119},\"specks\":{\"count\":8,\"radius_px\":9,\"contrast\":-"
      "80}",
      "\"dpi\":2400,\"blur_px\":1.2,\"background\":43,\"contrast\":155,\"dust\":{\"count\":900,"
      "\"radius_px\":3,\"contrast\":-73},\"specks\":{\"count\":25,\"radius_px\":8,\"contrast\":-"
      "117}",
      "\"dpi\":2400,\"blur_px\":1.3,\"background\":218,\"contrast\":-167,\"dust\":{\"count\":1400,"
      "\"radius_px\":4.4,\"contrast\":90},\"specks\":{\"count\":3,\"radius_px\":12,\"contrast\":"
      "85}",
      "\"dpi\":2400,\"blur_px\":1.7,\"background\":215,\"contrast\":-169,\"dust\":{\"count\":1200,"
      "\"radius_px\":4.4,\"contrast\":52},\"specks\":{\"count\":17,\"radius_px\":8,\"contrast\":"
      "100}",
  };
  for (size_t i = 0; i < sizeof scanners / sizeof scanners[0]; i += test_step(2)) {
    char members[100];
    snprintf(members, sizeof members, ",\"rotate_deg\":%zu", 31 + 77 * i);
    measured m = measure_foil(members, scanners[i]);
    check_bumps(&m, 0);
    measured_free(&m);
  }
}

/* Crown of bump i, or the middle of the lip's leg (i < 0), px. */
static fg_point place_of(const fg_render_spec *spec, int i) {
  const fg_render_foil *t = &fg_render_get_truth(spec)->foils[0];
  fg_context ctx = {0};
  fg_point p;
  if (i < 0) {
    assert_ok(&ctx, fg_render_midline(&ctx, spec, 0, 1.0, &p));
    return p;
  }
  const fg_render_bump *b = &t->bumps[i];
  double share = (b->centre_to_centre_mm - b->radius_mm) / b->centre_to_centre_mm;
  fg_point o = t->overall_centre_px, c = b->centre_px;
  return (fg_point){o.x + share * (c.x - o.x), o.y + share * (c.y - o.y)};
}

/* Rows that are lost across the crown of a bump or across the lip: the foil is said to have a gap,
 * and a bump that is off by more than its uncertainty has a flag of its own. */
static void lost_rows_are_seen(void **state) {
  (void)state;
  for (int at = -1; at < 5; at += 1 + (at > 0))
    for (int rows = 1; rows <= 5; rows += 2 * (int)test_step(3)) {
      char json[4096];
      small_foil(json, sizeof json, 9, "", "\"dpi\":2400,\"background\":30");
      rendered picture = render_open(json);
      fg_point p = place_of(picture.spec, at);
      picture.background = 30;
      picture.blank[0] = (int64_t)p.y - rows / 2;
      picture.blank[1] = picture.blank[0] + rows;
      measured m = measure_picture(picture, NULL);
      assert_int_equal(m.result.foil_count, 1);
      if (!(m.result.foils[0].flags & FG_FOIL_GAP))
        fail_msg("%d rows across bump %d: no gap", rows, at + 1);
      check_bumps(&m, FG_BUMP_GAP | FG_BUMP_DISTURBED_EDGE);
      measured_free(&m);
    }
}

/* A gap that parts the picture of a strip does not make two foils of it. */
static void a_parted_strip_is_one_foil(void **state) {
  (void)state;
  for (int rows = 8; rows <= 12; rows += 2 * (int)test_step(3)) {
    char json[4096];
    small_foil(json, sizeof json, 9, "", "\"dpi\":2400,\"background\":30");
    rendered picture = render_open(json);
    picture.background = 30;
    picture.blank[0] = (int64_t)place_of(picture.spec, 1).y;
    picture.blank[1] = picture.blank[0] + rows;
    measured m = measure_picture(picture, NULL);
    assert_int_equal(m.result.foil_count, 1);
    assert_true(m.result.foils[0].flags & FG_FOIL_GAP);
    measured_free(&m);
  }
}

/* The true bump of any foil whose centre is next to that of a measured one. */
static const fg_render_bump *true_bump(const measured *m, const fg_bump *bump) {
  for (size_t i = 0; i < m->picture.truth->foil_count; i++)
    for (size_t k = 0; k < m->picture.truth->foils[i].bump_count; k++) {
      const fg_render_bump *t = &m->picture.truth->foils[i].bumps[k];
      double mm = 25.4 / m->result.dpi[0];
      if (hypot(t->centre_px.x * mm - bump->centre_mm.x, t->centre_px.y * mm - bump->centre_mm.y) <
          0.5)
        return t;
    }
  return NULL;
}

/* Foils that lie across each other: a bump whose arc or land is touched has a flag of its own. */
static void overlapping_foils_flag_their_bumps(void **state) {
  (void)state;
  static const struct {
    double x_mm, y_mm, rotate_deg;
  } others[] = {{30, 24, -90}, {20, 21, -60}, {16, 25.5, -95}, {18, 27, -120}, {14.6, 24.2, -88}};
  size_t silent = 0, touched = 0, sound_bumps = 0, step = test_step(2);
  fg_design design;
  fg_design_default(&design);
  design.bumps.count = 4;
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i += step) {
    char json[1024];
    snprintf(json, sizeof json,
             "{\"schema\":\"foilgauge/render/1\",\"seed\":1,\"width_px\":3900,\"height_px\":2600,"
             "\"scanner\":{\"dpi\":2400},\"foils\":[{\"design\":{\"bump_count\":4},\"centre_mm\":"
             "[14,24]},{\"design\":{\"bump_count\":4},\"centre_mm\":[%g,%g],\"rotate_deg\":%g}]}",
             others[i].x_mm, others[i].y_mm, others[i].rotate_deg);
    measured m = measure_render(json, &design);
    assert_ok(NULL, m.status);
    for (size_t k = 0; k < m.result.foil_count; k++)
      for (size_t b = 0; b < m.result.foils[k].bump_count; b++) {
        const fg_bump *bump = &m.result.foils[k].bumps[b];
        const fg_render_bump *t = true_bump(&m, bump);
        bool sound = t && fabs(bump->height_mm - t->height_mm) < many_u * bump->u_height_mm &&
                     fabs(bump->radius_mm - t->radius_mm) < many_u * bump->u_radius_mm;
        touched += !!(bump->flags & FG_BUMP_TOUCHES_OTHER);
        sound_bumps += sound && !bump->flags;
        if (!sound && !bump->flags) {
          silent++;
          print_message("case %zu, foil %zu, bump %zu: %s\n", i, k + 1, b + 1,
                        t ? "off without a flag" : "is no bump");
        }
      }
    measured_free(&m);
  }
  assert_int_equal(silent, 0);
  assert_true(touched * step > 4);
  assert_true(sound_bumps * step > 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(dust_does_not_move_a_bump),
      cmocka_unit_test(lost_rows_are_seen),
      cmocka_unit_test(a_parted_strip_is_one_foil),
      cmocka_unit_test(overlapping_foils_flag_their_bumps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
