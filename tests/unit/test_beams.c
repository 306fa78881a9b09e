/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beams from the stations of their edges, made of formulas: sizes, uncertainties, numbers, flags.
 * Rendered ones: tests/cli/test_beams.sh, reports/accuracy_beams.md. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/foil.h"
#include "support/random.h"
#include "support/test.h"

enum { LONG_STATIONS = 500, SHORT_STATIONS = 60, BEAMS = 4 };
static const double pi = 3.14159265358979323846;

static fg_design design_of_beams(void) {
  return (fg_design){.kind = FG_FOIL_CANTILEVER,
                     .beams.count = BEAMS,
                     .beams.length_mm = 4,
                     .beams.width_mm = 1,
                     .thickness_mm = 0.1,
                     .beams.sagitta_mm = 0.5};
}

/* A beam in its own frame: root line at y = 0, tip at y = length, x from -width / 2 on; then turned
 * and moved. */
typedef struct shape {
  double length, width, taper; /* taper: root less tip */
  double bow, noise;           /* mm */
  double turn;                 /* of the axis from straight up as seen, clockwise, rad */
  fg_point at;                 /* of the root */
  uint64_t seed;
} shape;

/* As seen with the tip up: x to the right, y up. The scan's y runs down. */
static fg_point place(const shape *s, double x, double y) {
  double u = x * cos(s->turn) + y * sin(s->turn), v = -x * sin(s->turn) + y * cos(s->turn);
  return (fg_point){s->at.x + u, s->at.y - v};
}

static double noise(shape *s) {
  return s->noise * random_gaussian(&s->seed);
}

/* Half of the width at a height, and how far its middle is moved by the bow. */
static fg_point side_at(shape *s, int side, double y) {
  double share = y / s->length - 0.5, width = s->width - s->taper * share;
  double bow = s->bow * (1 - 4 * share * share);
  return place(s, bow + (side ? 0.5 : -0.5) * width + noise(s), y);
}

static void allocate(fg_beam_edge *edge, size_t count) {
  edge->stations = calloc(count, sizeof *edge->stations);
  assert_non_null(edge->stations);
  edge->count = count;
}

static void put(fg_beam_edge *edge, size_t i, fg_point at) {
  edge->stations[i] = (fg_disc_point){.at = at, .u = 1e-4, .used = true};
}

/* In the order of the rim: up the left side, over the tip, down the right side. */
static fg_beam make_beam(shape s) {
  fg_beam beam = {0};
  for (int side = 0; side < FG_BEAM_SIDES; side++)
    allocate(&beam.edges[side], side < FG_BEAM_TIP ? LONG_STATIONS : SHORT_STATIONS);
  for (size_t i = 0; i < LONG_STATIONS; i++) {
    double up = s.length * ((double)i + 0.5) / LONG_STATIONS;
    put(&beam.edges[FG_BEAM_LEFT], i, side_at(&s, 0, up));
    put(&beam.edges[FG_BEAM_RIGHT], i, side_at(&s, 1, s.length - up));
  }
  for (size_t i = 0; i < SHORT_STATIONS; i++) {
    double share = ((double)i + 0.5) / SHORT_STATIONS - 0.5;
    put(&beam.edges[FG_BEAM_TIP], i, place(&s, 0.8 * share * s.width, s.length + noise(&s)));
    put(&beam.edges[FG_BEAM_ROOT_LEFT], i, place(&s, -s.width + 0.4 * share, noise(&s)));
    put(&beam.edges[FG_BEAM_ROOT_RIGHT], i, place(&s, s.width + 0.4 * share, noise(&s)));
  }
  return beam;
}

static void lose(fg_beam_edge *edge) {
  free(edge->stations);
  *edge = (fg_beam_edge){0};
}

static fg_foil foil_of(const fg_beam *beams, size_t count) {
  fg_foil foil = {.beams = calloc(count, sizeof *beams), .beam_count = count};
  assert_non_null(foil.beams);
  memcpy(foil.beams, beams, count * sizeof *beams);
  return foil;
}

static fg_foil measured(shape s) {
  const fg_design design = design_of_beams();
  fg_context ctx = {0};
  fg_beam beam = make_beam(s);
  fg_foil foil = foil_of(&beam, 1);
  assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
  return foil;
}

static void a_beam_has_its_size_however_it_lies(void **state) {
  (void)state;
  for (int k = 0; k < 12; k++) {
    shape s = {4.1, 0.95, 0.04, 0, 0, 2 * pi * k / 12 + 0.1, {20, 30}, 1};
    fg_foil foil = measured(s);
    const fg_beam *beam = &foil.beams[0];
    assert_near(beam->length_mm, 4.1, 1e-9);
    assert_near(beam->width_mm, 0.95, 1e-9);
    assert_near(beam->taper_um_per_mm, 1000 * 0.04 / 4.1, 1e-6);
    assert_near(beam->length_error_pct, 2.5, 1e-6);
    assert_near(beam->width_error_pct, -5, 1e-6);
    assert_near(beam->follows.compliance_error_pct, 100 * (pow(4.1 / 4, 3) / 0.95 - 1), 1e-6);
    assert_near(hypot(beam->root_mm.x - 20, beam->root_mm.y - 30), 0, 1e-9);
    assert_near(remainder(beam->direction_deg - (s.turn * 180 / pi - 90), 360), 0, 1e-6);
    assert_int_equal(beam->flags, 0);
    fg_foil_free(&foil);
  }
}

/* Of 200 drawn beams: U = 2 u holds the truth in 95 of 100, within what chance does. */
static void uncertainties_hold_the_truth(void **state) {
  (void)state;
  enum { DRAWN = 200 };
  int length = 0, width = 0, bow = 0;
  for (uint64_t k = 0; k < DRAWN; k++) {
    fg_foil foil = measured((shape){4, 1, 0, 0, 0.001, 0.3, {5, 5}, 100 + k});
    const fg_beam *beam = &foil.beams[0];
    length += fabs(beam->length_mm - 4) <= 2 * beam->u_length_mm;
    width += fabs(beam->width_mm - 1) <= 2 * beam->u_width_mm;
    bow += fabs(beam->bow_um) <= 2 * beam->u_bow_um;
    assert_near(beam->rms_um, 1, 0.15);
    fg_foil_free(&foil);
  }
  assert_in_range(length, 181, 199);
  assert_in_range(width, 181, 199);
  assert_in_range(bow, 181, 200);
}

static void a_bow_is_measured_and_flagged(void **state) {
  (void)state;
  fg_foil foil = measured((shape){4, 1, 0, 0.05, 0.0003, 0.7, {5, 5}, 3});
  assert_near(foil.beams[0].bow_um, 50, 0.3);
  assert_near(foil.beams[0].width_mm, 1, 1e-4);
  assert_int_equal(foil.beams[0].flags, FG_BEAM_BENT);
  fg_foil_free(&foil);
}

static void edges_that_are_not_there(void **state) {
  (void)state;
  const fg_design design = design_of_beams();
  const struct {
    int lost[3];
    int count;
    unsigned flags;
    bool length, width;
  } cases[] = {{{FG_BEAM_ROOT_LEFT}, 1, FG_BEAM_ONE_FLOOR, true, true},
               {{FG_BEAM_ROOT_LEFT, FG_BEAM_ROOT_RIGHT}, 2, FG_BEAM_NO_FLOOR, false, true},
               {{FG_BEAM_TIP}, 1, FG_BEAM_TORN_TIP, false, true},
               {{FG_BEAM_RIGHT}, 1, FG_BEAM_NOT_FITTED, false, false}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    in_row("cases[%zu]", k);
    fg_context ctx = {0};
    fg_beam beam = make_beam((shape){4, 1, 0, 0, 0.0003, 0.2, {5, 5}, k});
    for (int i = 0; i < cases[k].count; i++)
      lose(&beam.edges[cases[k].lost[i]]);
    fg_foil foil = foil_of(&beam, 1);
    assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
    assert_int_equal(foil.beams[0].flags, cases[k].flags);
    assert_int_equal(isfinite(foil.beams[0].length_mm), cases[k].length);
    assert_int_equal(isfinite(foil.beams[0].width_mm), cases[k].width);
    if (cases[k].length) assert_near(foil.beams[0].length_mm, 4, 5 * foil.beams[0].u_length_mm);
    assert_int_equal(isfinite(foil.beams[0].follows.compliance_error_pct), cases[k].length);
    fg_foil_free(&foil);
  }
}

static void burrs_are_left_out(void **state) {
  (void)state;
  const fg_design design = design_of_beams();
  fg_context ctx = {0};
  shape s = {4, 1, 0, 0, 0.0005, 0, {5, 5}, 9};
  fg_beam beam = make_beam(s);
  for (size_t i = 100; i < 140; i++)
    beam.edges[FG_BEAM_LEFT].stations[i].at.x -= 0.03;
  fg_foil foil = foil_of(&beam, 1);
  assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
  assert_near(foil.beams[0].width_mm, 1, 4 * foil.beams[0].u_width_mm);
  assert_true(foil.beams[0].flags & FG_BEAM_OUTLIERS);
  fg_foil_free(&foil);
}

/* Four beams in a row, in no order; widths say which is which. */
static void numbers_run_from_left_to_right(void **state) {
  (void)state;
  static const int order[BEAMS] = {2, 0, 3, 1};
  const fg_design design = design_of_beams();
  for (int k = 0; k < 8; k++) {
    fg_context ctx = {0};
    fg_beam beams[BEAMS];
    double turn = 2 * pi * k / 8 + 0.2;
    for (int i = 0; i < BEAMS; i++) {
      shape row = {.turn = turn, .at = {30, 30}};
      beams[i] = make_beam((shape){4, 1 + 0.01 * order[i], 0, 0, 0, turn,
                                   place(&row, 2.0 * order[i], 0.02 * order[i]), 1});
    }
    fg_foil foil = foil_of(beams, BEAMS);
    assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
    for (int i = 0; i < BEAMS; i++) {
      assert_int_equal(foil.beams[i].number, i + 1);
      assert_near(foil.beams[i].width_mm, 1 + 0.01 * i, 1e-9);
    }
    assert_near(remainder(foil.rotation_deg - (turn * 180 / pi - 90), 360), 0, 1e-6);
    assert_int_equal(foil.flags & FG_FOIL_BEAM_COUNT, 0);
    fg_foil_free(&foil);
  }
}

/* A comb of `stated` beams in `rows` rows without those of `lost` (bits), askew, in its box; widths
 * say which beam is which. */
static fg_foil comb_without(int stated, int rows, unsigned lost, double turn, bool boxed,
                            fg_design *design) {
  fg_context ctx = {0};
  fg_beam beams[16];
  size_t count = 0;
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  int each = stated / rows;
  shape row = {.turn = turn, .at = {60, 60}};
  *design = design_of_beams();
  design->beams.count = (size_t)stated;
  for (int i = 0; i < stated; i++)
    if (!(lost >> i & 1))
      beams[count++] = make_beam((shape){4, 1 + 0.01 * i, 0, 0, 0, turn,
                                         place(&row, 1.8 * (i % each), -8.0 * (i / each)), 1});
  /* The sheet reaches 1 mm beyond the outer beams and 3 mm below their roots. */
  for (int corner = 0; corner < 4; corner++) {
    fg_point p = place(&row, corner & 1 ? -1.5 : 1.8 * (each - 1) + 1.5,
                       corner & 2 ? -3 - 8.0 * (rows - 1) : 0);
    low[0] = fmin(low[0], p.x), high[0] = fmax(high[0], p.x);
    low[1] = fmin(low[1], p.y), high[1] = fmax(high[1], p.y);
  }
  for (size_t i = 0; i < count; i++)
    for (int side = FG_BEAM_LEFT; side <= FG_BEAM_RIGHT; side++)
      for (size_t k = 0; k < beams[i].edges[side].count; k++) {
        fg_point p = beams[i].edges[side].stations[k].at;
        low[0] = fmin(low[0], p.x), high[0] = fmax(high[0], p.x);
        low[1] = fmin(low[1], p.y), high[1] = fmax(high[1], p.y);
      }
  fg_foil foil = foil_of(beams, count);
  if (boxed)
    for (int k = 0; k < 2; k++) {
      foil.place_mm[k] = low[k];
      foil.place_mm[k + 2] = high[k] - low[k];
    }
  assert_ok(&ctx, fg_beams_measure(&ctx, design, &foil));
  return foil;
}

static void assert_numbers_are_widths(const fg_foil *foil) {
  for (size_t i = 0; i < foil->beam_count; i++)
    assert_int_equal(foil->beams[i].number, lround((foil->beams[i].width_mm - 1) / 0.01) + 1);
}

static void beam_numbers_skip_missing_beams(void **state) {
  (void)state;
  fg_design design;
  for (int k = 0; k < 8; k++)
    for (unsigned lost = 1; lost < 31; lost++) {
      int left = 0;
      for (int i = 0; i < 5; i++)
        left += !(lost >> i & 1);
      if (left < 3) continue;
      fg_foil foil = comb_without(5, 1, lost, 2 * pi * k / 8 + 0.2, true, &design);
      /* Three in a row, or every other one: both may be the other. */
      bool every_other = lost == 10 || lost == 3 || lost == 17 || lost == 24;
      if (foil.flags & FG_FOIL_BEAM_PLACES_UNKNOWN) {
        /* At 56 degrees from the scan's axes the first beam's tip makes two sides of the box. */
        assert_true(every_other || (k % 2 && lost & 1));
      } else {
        assert_numbers_are_widths(&foil);
        assert_true(foil.flags & FG_FOIL_MISSING_BEAM);
      }
      fg_foil_free(&foil);
    }
  fg_foil whole = comb_without(5, 1, 0, 1, true, &design);
  assert_numbers_are_widths(&whole);
  assert_int_equal(whole.flags & (FG_FOIL_MISSING_BEAM | FG_FOIL_BEAM_PLACES_UNKNOWN), 0);
  fg_foil_free(&whole);
}

/* Rows have common places: the other row says where the first one's end is. */
static void rows_share_their_places(void **state) {
  (void)state;
  fg_design design;
  for (int lost = 0; lost < 8; lost++) {
    fg_foil foil = comb_without(8, 2, 1u << lost, 0.7, false, &design);
    assert_true(foil.flags & FG_FOIL_MISSING_BEAM);
    assert_numbers_are_widths(&foil);
    fg_foil_free(&foil);
  }
}

/* An end beam of a foil whose box is not known, or cut by the scan's border, may be either. */
static void unknown_beam_places_are_flagged(void **state) {
  (void)state;
  fg_design design;
  fg_foil foil = comb_without(5, 1, 1, 0.3, false, &design);
  assert_true(foil.flags & FG_FOIL_BEAM_PLACES_UNKNOWN);
  assert_false(foil.flags & FG_FOIL_MISSING_BEAM);
  assert_int_equal(foil.beams[0].number, 1);
  fg_foil_free(&foil);
  foil = comb_without(5, 1, 2, 0.3, false, &design);
  assert_true(foil.flags & FG_FOIL_MISSING_BEAM);
  assert_numbers_are_widths(&foil);
  fg_foil_free(&foil);
}

static void one_of_parallel_beams_that_leans_is_bent(void **state) {
  (void)state;
  const fg_design design = design_of_beams();
  fg_context ctx = {0};
  fg_beam beams[BEAMS];
  for (int i = 0; i < BEAMS; i++)
    beams[i] = make_beam((shape){4, 1, 0, 0, 0.0002, i == 2 ? 0.02 : 0, {5 + 2 * i, 9}, 1});
  fg_foil foil = foil_of(beams, BEAMS);
  assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
  for (int i = 0; i < BEAMS; i++)
    assert_int_equal(foil.beams[i].flags, i == 2 ? FG_BEAM_BENT : 0);
  fg_foil_free(&foil);
}

/* Around a ring with a gap: clockwise from after the gap. */
static void beams_of_a_ring_run_clockwise(void **state) {
  (void)state;
  const fg_design design = design_of_beams();
  for (int k = 0; k < 5; k++) {
    fg_context ctx = {0};
    fg_beam beams[BEAMS];
    for (int i = 0; i < BEAMS; i++) {
      double turn = 2 * pi * (i / 5.0 + k / 7.0);
      shape middle = {.turn = turn, .at = {30, 30}};
      beams[i] = make_beam((shape){4, 1 + 0.01 * i, 0, 0, 0, turn, place(&middle, 0, 5), 1});
    }
    fg_foil foil = foil_of(beams, BEAMS);
    assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
    for (int i = 0; i < BEAMS; i++)
      assert_near(foil.beams[i].width_mm, 1 + 0.01 * i, 1e-9);
    assert_true(isnan(foil.rotation_deg));
    fg_foil_free(&foil);
  }
}

/* Six places at 40 degrees, the gap behind them 160: that of a missing beam is 80. */
static void beam_numbers_in_a_ring_skip_missing_beams(void **state) {
  (void)state;
  fg_design design = design_of_beams();
  design.beams.count = 6;
  for (int lost = 1; lost < 5; lost++) {
    fg_context ctx = {0};
    fg_beam beams[6];
    size_t count = 0;
    for (int i = 0; i < 6; i++) {
      double turn = 2 * pi * (i / 9.0 + 0.3);
      shape middle = {.turn = turn, .at = {30, 30}};
      if (i != lost)
        beams[count++] =
            make_beam((shape){4, 1 + 0.01 * i, 0, 0, 0, turn, place(&middle, 0, 5), 1});
    }
    fg_foil foil = foil_of(beams, count);
    assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
    assert_true(foil.flags & FG_FOIL_MISSING_BEAM);
    assert_numbers_are_widths(&foil);
    fg_foil_free(&foil);
  }
}

static void another_size_is_no_foil_of_the_design(void **state) {
  (void)state;
  fg_foil foil = measured((shape){8, 2, 0, 0, 0, 0, {5, 5}, 1});
  assert_true(foil.flags & FG_FOIL_NOT_THIS_DESIGN);
  assert_has(foil.error, "2 times the design's");
  assert_true(foil.flags & FG_FOIL_BEAM_COUNT);
  fg_foil_free(&foil);
  foil = measured((shape){8, 1, 0, 0, 0, 0, {5, 5}, 1});
  assert_false(foil.flags & FG_FOIL_NOT_THIS_DESIGN);
  fg_foil_free(&foil);
}

static void a_foil_without_beams_is_flagged(void **state) {
  (void)state;
  const fg_design design = design_of_beams();
  fg_context ctx = {0};
  fg_foil foil = {0};
  assert_ok(&ctx, fg_beams_measure(&ctx, &design, &foil));
  assert_true(foil.flags & FG_FOIL_BEAM_COUNT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_beam_has_its_size_however_it_lies),
      cmocka_unit_test(uncertainties_hold_the_truth),
      cmocka_unit_test(a_bow_is_measured_and_flagged),
      cmocka_unit_test(edges_that_are_not_there),
      cmocka_unit_test(burrs_are_left_out),
      cmocka_unit_test(numbers_run_from_left_to_right),
      cmocka_unit_test(beam_numbers_skip_missing_beams),
      cmocka_unit_test(rows_share_their_places),
      cmocka_unit_test(unknown_beam_places_are_flagged),
      cmocka_unit_test(beam_numbers_in_a_ring_skip_missing_beams),
      cmocka_unit_test(one_of_parallel_beams_that_leans_is_bent),
      cmocka_unit_test(beams_of_a_ring_run_clockwise),
      cmocka_unit_test(another_size_is_no_foil_of_the_design),
      cmocka_unit_test(a_foil_without_beams_is_flagged),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
