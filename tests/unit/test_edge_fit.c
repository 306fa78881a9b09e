/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge rows of measured foils as the loop holds them against one geometry: their groups and parts,
 * for foils that are not as a design has them. */
#include <math.h>
#include <stdlib.h>

#include "rows/edge_fit.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

enum { LANDS = SYNTHETIC_BUMPS + 1 };

static fg_measurement measured(size_t foils) {
  fg_measurement m = {.design = synthetic_design(), .dpi = {4800, 4800}};
  m.nominal = synthetic_nominal(&m.design);
  m.file.width_px = m.file.height_px = 9000;
  m.foils = calloc(foils, sizeof *m.foils);
  m.foil_count = foils;
  for (size_t f = 0; f < foils; f++)
    m.foils[f] = synthetic_foil(&m.design, &m.nominal);
  return m;
}

/* No circle fits these bumps; their stations belong to no arc, the lands keep their numbers. */
static void lose_bumps(fg_foil *foil, int from) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number >= from) {
      foil->bumps[i].flags |= FG_BUMP_NOT_FITTED;
      foil->bumps[i].radius_mm = NAN;
    }
  for (size_t k = 0; k < foil->strip.count; k++)
    if (foil->labels[k].kind == FG_ARC_BUMP && foil->labels[k].number >= from)
      foil->labels[k] = (fg_station_label){.kind = FG_ARC_FILLET};
}

static fg_edge_fit build(const fg_measurement *m, bool same) {
  fg_context ctx = {0};
  fg_edge_fit edge_fit;
  fg_edge_fit_view *views = calloc(m->foil_count, sizeof *views);
  for (size_t f = 0; f < m->foil_count; f++)
    views[f] =
        (fg_edge_fit_view){.foil = &m->foils[f], .measurement = m, .part = same ? 0 : f, .scan = f};
  assert_ok(&ctx, fg_edge_fit_build(&ctx, views, m->foil_count, &edge_fit));
  free(views);
  return edge_fit;
}

/* Groups are numbered without a gap, and every one has rows of one part and one arc alone. */
static void check_groups(const fg_edge_fit *edge_fit) {
  size_t seen = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    assert_true(row->group == seen || row->group + 1 == seen);
    seen = row->group + 1;
    assert_true(row->part < edge_fit->part_count);
    for (size_t k = i; k-- > 0 && edge_fit->rows[k].group == row->group;)
      assert_true(edge_fit->rows[k].part == row->part && edge_fit->rows[k].bump == row->bump);
  }
  assert_int_equal(seen, edge_fit->group_count);
}

static void a_foil_may_have_more_lands_than_bumps(void **state) {
  (void)state;
  for (int fitted = 1; fitted <= SYNTHETIC_BUMPS; fitted++) {
    fg_measurement m = measured(1);
    lose_bumps(&m.foils[0], fitted + 1);
    fg_edge_fit edge_fit = build(&m, false);
    check_groups(&edge_fit);
    assert_int_equal(edge_fit.parts[0].bump_count, fitted);
    assert_int_equal(edge_fit.group_count, fitted + LANDS);
    fg_edge_fit_free(&edge_fit);
    synthetic_free(&m);
  }
}

static void views_of_one_part_share_its_groups(void **state) {
  (void)state;
  fg_measurement m = measured(2);
  fg_edge_fit edge_fit = build(&m, true);
  check_groups(&edge_fit);
  assert_int_equal(edge_fit.part_count, 1);
  assert_int_equal(edge_fit.group_count, SYNTHETIC_BUMPS + LANDS);
  fg_edge_fit_free(&edge_fit);
  synthetic_free(&m);
}

/* A foil that was not measured has no geometry, and bars nothing for the others. */
static fg_point turned(fg_point about, fg_point at, double angle) {
  double x = at.x - about.x, y = at.y - about.y;
  return (fg_point){about.x + x * cos(angle) - y * sin(angle),
                    about.y + x * sin(angle) + y * cos(angle)};
}

/* However the foil lies, and whether or not its first stations were usable. */
static void a_part_knows_the_angle_from_end_to_end(void **state) {
  (void)state;
  fg_measurement m = measured(1);
  fg_foil *foil = &m.foils[0];
  for (int turn = 0; turn < 8; turn++) {
    for (size_t k = 0; k < foil->strip.count; k++) {
      fg_station *s = &foil->strip.stations[k];
      s->left = turned(foil->overall.centre_mm, s->left, 0.8);
      s->right = turned(foil->overall.centre_mm, s->right, 0.8);
      if (k < 3) s->weight = 0;
    }
    fg_edge_fit edge_fit = build(&m, false);
    assert_true(fabs(edge_fit.parts[0].end_to_end_rad - 124 * synthetic_pi / 180) < 2e-3);
    fg_edge_fit_free(&edge_fit);
  }
  synthetic_free(&m);
}

static void a_foil_that_was_not_measured_is_no_part(void **state) {
  (void)state;
  fg_measurement m = measured(3);
  m.foils[1].flags |= FG_FOIL_NOT_MEASURED;
  fg_edge_fit edge_fit = build(&m, false);
  check_groups(&edge_fit);
  assert_int_equal(edge_fit.part_count, 2);
  assert_int_equal(edge_fit.view_count, 2);
  assert_int_equal(edge_fit.views[1].part, 1);
  assert_ptr_equal(edge_fit.views[1].foil, &m.foils[2]);
  for (size_t p = 0; p < edge_fit.part_count; p++)
    assert_true(edge_fit.parts[p].overall_radius_mm > 0);
  fg_edge_fit_free(&edge_fit);
  synthetic_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_foil_may_have_more_lands_than_bumps),
      cmocka_unit_test(views_of_one_part_share_its_groups),
      cmocka_unit_test(a_part_knows_the_angle_from_end_to_end),
      cmocka_unit_test(a_foil_that_was_not_measured_is_no_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
