/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Benefit of a correction, and the report where there is none. */
#include <math.h>
#include <stdlib.h>

#include "scan_loop/benefit.h"
#include "scan_loop/state.h"
#include "support/foil_rows.h"
#include "support/test.h"

enum { R0 = FG_CORRECTED_OVERALL_RADIUS, R = FG_CORRECTED_RADIUS, H = FG_CORRECTED_HEIGHT };
#define UM 1e-3

/* Two bumps and R0 alone, every own u 1 um; no explanation yet. */
enum { ITEMS = 3 };

static fg_benefit open_benefit(fg_benefit_item item[ITEMS]) {
  memset(item, 0, ITEMS * sizeof *item);
  for (int i = 0; i < ITEMS; i++)
    for (int k = 0; k < FG_CORRECTED; k++)
      item[i].u[k] = i + 1 < ITEMS || k == R0 ? UM : NAN;
  return (fg_benefit){.item = item, .items = ITEMS, .noises = 1};
}

/* An explanation that moves every R0, R and h alike. */
static void explain(fg_benefit *benefit, double overall_um, double radius_um, double height_um) {
  size_t at = benefit->explanations++;
  for (size_t i = 0; i < benefit->items; i++) {
    bool bump = i + 1 < benefit->items;
    benefit->item[i].move[at][R0] = overall_um * UM;
    benefit->item[i].move[at][R] = bump ? radius_um * UM : NAN;
    benefit->item[i].move[at][H] = bump ? height_um * UM : NAN;
  }
}

static void put_noise(fg_benefit *benefit, int k, double u_um) {
  for (size_t i = 0; i < benefit->items; i++)
    benefit->item[i].noise[k][k] = u_um * UM * u_um * UM;
}

static void decide(const fg_benefit *benefit, fg_benefit_decision *decision) {
  fg_benefit_decide(&benefit, 1, &decision);
}

static void choose(const fg_benefit *benefit, int k, fg_correction_reason reason, bool moved) {
  fg_benefit_decision decision;
  decide(benefit, &decision);
  assert_int_equal(decision.choice[k].reason, reason);
  assert_int_equal(decision.choice[k].moved, moved);
}

static void a_correction_helps_beyond_twice_its_variance(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  explain(&benefit, 1.5, 1.4, 0.5);
  for (int k = 0; k < FG_CORRECTED; k++)
    put_noise(&benefit, k, 1);
  choose(&benefit, R0, FG_CORRECTION_HELPS, true);
  choose(&benefit, R, FG_CORRECTION_DOUBTFUL, false);
  choose(&benefit, H, FG_CORRECTION_DOUBTFUL, false);
}

static void exactly_known_corrections_are_applied(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  explain(&benefit, 0.5, 2, -3);
  for (int k = 0; k < FG_CORRECTED; k++)
    choose(&benefit, k, FG_CORRECTION_HELPS, true);
}

/* It follows the others, either way. */
static void negligible_corrections_follow_the_others(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  explain(&benefit, 0, 5, 0.01);
  put_noise(&benefit, H, 0.02);
  choose(&benefit, R0, FG_CORRECTION_SMALL, true);
  choose(&benefit, H, FG_CORRECTION_SMALL, true);
  put_noise(&benefit, R, 5);
  choose(&benefit, R, FG_CORRECTION_DOUBTFUL, false);
  choose(&benefit, R0, FG_CORRECTION_SMALL, false);
  benefit = open_benefit(item);
  explain(&benefit, 0, 0, 0);
  choose(&benefit, R, FG_CORRECTION_SMALL, true);
}

static void unfitted_bumps_move_nothing(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  explain(&benefit, NAN, 5, 5);
  item[1].move[0][R] = NAN; /* one bump of two was not fitted */
  put_noise(&benefit, H, NAN);
  choose(&benefit, R0, FG_CORRECTION_NONE, false);
  choose(&benefit, R, FG_CORRECTION_HELPS, true);
  choose(&benefit, H, FG_CORRECTION_DOUBTFUL, false);
}

static void a_tie_moves_as_far_as_all_explanations_agree(void **state) {
  (void)state;
  static const struct {
    double one, other, moved; /* 0: left */
  } ties[] = {{10, 6, 8}, {10, 2, 2 + 1.41421356}, {-10, -10, -10}, {10, 1, 0}, {10, 0, 0},
              {10, -9, 0}};
  for (size_t i = 0; i < sizeof ties / sizeof *ties; i++) {
    in_row("ties[%zu]", i);
    fg_benefit_item item[ITEMS];
    fg_benefit benefit = open_benefit(item);
    fg_benefit_decision decision;
    double move[FG_CORRECTED];
    explain(&benefit, ties[i].one, ties[i].one, 0);
    explain(&benefit, ties[i].other, ties[i].other, 0);
    decide(&benefit, &decision);
    fg_benefit_move(&benefit, 0, &decision, move);
    for (int k = R0; k <= R; k++) {
      assert_int_equal(decision.choice[k].moved, ties[i].moved != 0);
      assert_int_equal(decision.choice[k].reason,
                       ties[i].moved != 0 ? FG_CORRECTION_HELPS : FG_CORRECTION_TIED);
      assert_near(move[k], ties[i].moved * UM, 1e-9);
    }
  }
}

/* The mean by weight, with the scatter about it in u. */
static void evidence_weighs_explanations(void **state) {
  (void)state;
  static const struct {
    double weight, moved, moment; /* of a move of 10 beside one of none */
  } ties[] = {{1, 10, 0}, {0.98, 9.8, 1.96}, {0.6, 6, 24}, {0.4, 0, 40}, {0, 0, 0}};
  for (size_t i = 0; i < sizeof ties / sizeof *ties; i++) {
    in_row("ties[%zu]", i);
    fg_benefit_item item[ITEMS];
    fg_benefit benefit = open_benefit(item);
    fg_benefits all = {.discs = benefit};
    fg_benefit_decision decision;
    double move[FG_CORRECTED], moment[FG_CORRECTED][FG_CORRECTED];
    const double weight[] = {ties[i].weight, 1 - ties[i].weight};
    fg_benefits_weigh(&all, &(fg_benefit_weights){weight, 2, .curve = false});
    explain(&all.discs, 10, 10, 10);
    explain(&all.discs, 0, 0, 0);
    decide(&all.discs, &decision);
    fg_benefit_move(&all.discs, 0, &decision, move);
    fg_benefit_moment(&all.discs, 0, &decision, moment);
    for (int k = R0; k <= H; k++) {
      assert_near(move[k], ties[i].moved * UM, 1e-9);
      assert_near(moment[k][k], ties[i].moment * UM * UM, 1e-12);
    }
    fg_benefits_weigh(&all, &(fg_benefit_weights){weight, 2, .curve = true, .loose = true});
    decide(&all.discs, &decision);
    if (ties[i].weight > 0) assert_false(fg_benefit_is_moved(decision.choice)); /* a loose curve */
  }
}

/* A move that both explanations agree about stays whole where they differ about another bump. */
static void one_undecided_bump_leaves_the_others_corrected(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  fg_benefit_decision decision;
  double move[FG_CORRECTED];
  explain(&benefit, 0, 0, 8);
  explain(&benefit, 0, 0, 8);
  item[1].move[0][H] = 5 * UM;
  item[1].move[1][H] = -3 * UM;
  decide(&benefit, &decision);
  fg_benefit_move(&benefit, 0, &decision, move);
  assert_near(move[H], 8 * UM, 1e-9);
  fg_benefit_move(&benefit, 1, &decision, move);
  assert_near(move[H], 1 * UM, 1e-9); /* their mean: neither loses by it */
}

/* The error falls whichever of three is true, and by at least the square of the move. */
static void no_explanation_is_made_worse(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  fg_benefit_decision decision;
  static const double moves[3][2] = {{9, 1}, {4, 6}, {2, -1}};
  double t[2], move[FG_CORRECTED];
  for (size_t e = 0; e < 3; e++) {
    explain(&benefit, 0, 0, 0);
    for (size_t i = 0; i < 2; i++)
      item[i].move[e][R] = moves[e][i] * UM;
  }
  decide(&benefit, &decision);
  assert_true(decision.choice[R].moved);
  for (size_t i = 0; i < 2; i++) {
    fg_benefit_move(&benefit, i, &decision, move);
    t[i] = move[R] / UM;
  }
  double size = t[0] * t[0] + t[1] * t[1];
  double shortest = pow(2 + 2 * 3 / 53., 2) + pow(21 / 53. - 1, 2); /* between the last two */
  for (size_t e = 0; e < 3; e++)
    assert_true(2 * (t[0] * moves[e][0] + t[1] * moves[e][1]) - size > 0.499 * shortest);
  assert_true(t[0] > 3); /* and towards the mean, (5, 2) */
}

/* Bumps that gain and bumps that lose are weighed together. */
static void all_bumps_of_a_kind_are_one_decision(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  explain(&benefit, 0, 3, 0);
  put_noise(&benefit, R, 1);
  item[1].move[0][R] = 0.1 * UM;
  choose(&benefit, R, FG_CORRECTION_HELPS, true); /* 9.01 > 2 × 2 */
  item[1].noise[R][R] = 16 * UM * UM;
  choose(&benefit, R, FG_CORRECTION_DOUBTFUL, false); /* 9.01 < 2 × 17 */
}

static void scans_of_one_foil_are_one_decision(void **state) {
  (void)state;
  fg_benefit_item item[2][ITEMS];
  fg_benefit benefit[2] = {open_benefit(item[0]), open_benefit(item[1])};
  fg_benefit_decision each[2];
  explain(&benefit[0], 1, 1, 1);
  explain(&benefit[1], -3, -3, -3);
  for (int i = 0; i < 2; i++)
    put_noise(&benefit[i], R0, 1);
  fg_benefit_decide((const fg_benefit *[]){&benefit[0], &benefit[1]}, 2,
                    (fg_benefit_decision *[]){&each[0], &each[1]});
  for (int i = 0; i < 2; i++)
    assert_true(each[i].choice[R0].moved); /* 10 > 2 × 2 */
  assert_near(each[0].choice[R0].move_mm, UM, 1e-12);
  assert_near(each[1].choice[R0].move_mm, -3 * UM, 1e-12);
  assert_near(each[1].choice[R].move_mm, 3 * UM, 1e-12);
  benefit[1].lost = true; /* one of them cannot be corrected: none is */
  fg_benefit_decide((const fg_benefit *[]){&benefit[0], &benefit[1]}, 2,
                    (fg_benefit_decision *[]){&each[0], &each[1]});
  assert_int_equal(each[0].choice[R0].reason, FG_CORRECTION_LOST);
  assert_false(each[0].choice[R0].moved);
}

static void u_belongs_to_the_reported_value(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  double moment[FG_CORRECTED][FG_CORRECTED];
  fg_benefit_decision decision = {.choice = {[R] = {.moved = true}}, .part = {[R] = {0.5, 0.5}}};
  explain(&benefit, 4, 10, 2);
  explain(&benefit, 2, 6, 4);
  put_noise(&benefit, R, 1);
  put_noise(&benefit, H, 1);
  fg_benefit_moment(&benefit, 0, &decision, moment);
  assert_near(moment[R][R], (1 + 4) * UM * UM, 1e-15);              /* noise, and ± 2 about 8 */
  assert_near(moment[H][H], (1 + 10) * UM * UM, 1e-15);             /* noise, and 2² and 4² */
  assert_near(moment[R][H], (2 * 2 - 2 * 4) / 2. * UM * UM, 1e-15); /* R is 2 above, then below */
  assert_near(moment[R0][R0], 10 * UM * UM, 1e-15);
}

/* Its own u says too little: that of the moment is reported. */
static void misfitting_corrections_are_not_whole(void **state) {
  (void)state;
  fg_benefit_item item[ITEMS];
  fg_benefit benefit = open_benefit(item);
  fg_benefit_decision decision;
  explain(&benefit, 5, 5, 5);
  decide(&benefit, &decision);
  assert_true(fg_benefit_is_whole(&benefit, &decision));
  benefit.misfit = true;
  assert_false(fg_benefit_is_whole(&benefit, &decision));
}

/* ---- reports ---- */

/* The synthetic foil, its correction by a scale and a shear, and the benefits of that. */
typedef struct fixture {
  foil_rows rows;
  fg_measurement corrected;
  fg_benefits benefits;
} fixture;

static void open_fixture(fixture *f) {
  fg_context ctx = {0};
  fg_field_list fields;
  foil_rows_open(&f->rows);
  const fg_effect *scale = fg_effect_find("scan.scale_y"), *shear = fg_effect_find("scan.shear");
  const fg_effect_set set = {.effects = {{.kind = scale, .columns = 1, .coefficient_um = {40}},
                                         {.kind = shear, .columns = 1, .coefficient_um = {25}}},
                             .count = 2};
  fg_effect_set_fields(&f->rows.edge_fit, &set, &fields);
  assert_ok(&ctx, fg_scan_loop_correct(&ctx, &f->rows.m, &fields, 1, &f->corrected));
  assert_ok(&ctx, fg_benefits_open(&ctx, &f->rows.m, &f->benefits));
  fg_benefits_add(&f->benefits, &f->rows.m, &f->corrected);
}

static void close_fixture(fixture *f) {
  fg_benefits_close(&f->benefits);
  fg_measurement_free(&f->corrected);
  foil_rows_close(&f->rows);
}

static void keep(fixture *f, const fg_benefit_decision *decision) {
  fg_context ctx = {0};
  const fg_benefit_foil of = {&f->rows.m, &f->rows.m.foils[0], &f->benefits.foil[0], decision};
  assert_ok(&ctx, fg_benefit_keep_foil(&ctx, &of, &f->corrected.foils[0]));
  fg_benefit_widen_foil(&of, &f->corrected.foils[0]);
}

/* Derived values of a report must be those that anyone derives from its circles. */
static void hold_together(const fg_foil *foil) {
  const fg_overall *o = &foil->overall;
  for (size_t b = 0; b < foil->bump_count; b++) {
    const fg_bump *bump = &foil->bumps[b];
    double x = hypot(bump->centre_mm.x - o->centre_mm.x, bump->centre_mm.y - o->centre_mm.y);
    double r = bump->radius_mm, half = (x * x + r * r - o->radius_mm * o->radius_mm) / (2 * x * r);
    assert_near(bump->centre_to_centre_mm, x, 1e-12);
    assert_near(bump->height_mm, o->radius_mm - (x - r), 1e-12);
    assert_near(bump->bump_angle_deg, 2 * acos(half) * 180 / synthetic_pi, 1e-9);
  }
}

static void one_dimension_moves_and_the_report_holds_together(void **state) {
  (void)state;
  for (int k = 0; k < FG_CORRECTED; k++) {
    fixture f;
    open_fixture(&f);
    fg_foil before = f.rows.m.foils[0], *after = &f.corrected.foils[0];
    double overall = after->overall.radius_mm, r = after->bumps[4].radius_mm,
           h = after->bumps[4].height_mm;
    assert_true(fabs(overall - before.overall.radius_mm) > 5 * UM);
    fg_benefit_decision decision = {.choice = {{.reason = FG_CORRECTION_TIED},
                                               {.reason = FG_CORRECTION_TIED},
                                               {.reason = FG_CORRECTION_TIED}}};
    decision.choice[k] = (fg_correction_choice){.reason = FG_CORRECTION_HELPS, .moved = true};
    decision.part[k][0] = 1;
    keep(&f, &decision);
    assert_near(after->overall.radius_mm, k == R0 ? overall : before.overall.radius_mm, 1e-12);
    assert_near(after->bumps[4].radius_mm, k == R ? r : before.bumps[4].radius_mm, 1e-12);
    assert_near(after->bumps[4].height_mm, k == H ? h : before.bumps[4].height_mm, 1e-12);
    hold_together(after);
    assert_int_equal(after->flags & (FG_FOIL_OVERALL_RADIUS_LEFT | FG_FOIL_RADIUS_LEFT),
                     (k == R0 ? 0 : FG_FOIL_OVERALL_RADIUS_LEFT) |
                         (k == R ? 0 : FG_FOIL_RADIUS_LEFT));
    close_fixture(&f);
  }
}

static void uncorrected_values_stay_with_a_wider_u(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f);
  const fg_foil *before = &f.rows.m.foils[0];
  fg_foil *after = &f.corrected.foils[0];
  double move = after->bumps[4].height_mm - before->bumps[4].height_mm;
  const fg_benefit_decision decision = {.choice = {{.reason = FG_CORRECTION_TIED},
                                                   {.reason = FG_CORRECTION_DOUBTFUL},
                                                   {.reason = FG_CORRECTION_TIED}}};
  keep(&f, &decision);
  for (size_t b = 0; b < before->bump_count; b++) {
    assert_near(after->bumps[b].radius_mm, before->bumps[b].radius_mm, 0);
    assert_near(after->bumps[b].height_mm, before->bumps[b].height_mm, 0);
    assert_near(after->bumps[b].clearance_mm, before->bumps[b].clearance_mm, 0);
    assert_near(after->bumps[b].centre_mm.x, before->bumps[b].centre_mm.x, 0);
  }
  assert_near(after->strip.stations[99].left.x, before->strip.stations[99].left.x, 0);
  assert_near(after->bumps[4].u_height_mm, hypot(before->bumps[4].u_height_mm, move), 1e-9);
  assert_near(after->overall.u_springback_error_pct / before->overall.u_springback_error_pct,
              after->overall.u_radius_mm / before->overall.u_radius_mm, 1e-9);
  close_fixture(&f);
}

static void a_wholly_beneficial_correction_is_kept(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f);
  fg_foil *after = &f.corrected.foils[0], was = *after;
  fg_bump bump = after->bumps[3];
  fg_benefit_decision decision;
  decide(&f.benefits.foil[0], &decision);
  for (int k = 0; k < FG_CORRECTED; k++)
    assert_true(decision.choice[k].moved);
  keep(&f, &decision);
  assert_ptr_equal(after->bumps, was.bumps);
  assert_memory_equal(&after->overall, &was.overall, sizeof was.overall);
  assert_memory_equal(&after->bumps[3], &bump, sizeof bump);
  assert_int_equal(after->flags, was.flags);
  close_fixture(&f);
}

static void other_bumps_after_the_correction_are_none(void **state) {
  (void)state;
  fixture f;
  fg_context ctx = {0};
  fg_benefit_decision decision;
  open_fixture(&f);
  fg_benefits_close(&f.benefits);
  assert_ok(&ctx, fg_benefits_open(&ctx, &f.rows.m, &f.benefits));
  f.corrected.foils[0].bumps[8].number = 11;
  fg_benefits_add(&f.benefits, &f.rows.m, &f.corrected);
  decide(&f.benefits.foil[0], &decision);
  assert_int_equal(decision.choice[R].reason, FG_CORRECTION_LOST);
  keep(&f, &decision);
  assert_int_equal(f.corrected.foils[0].bumps[8].number, 9);
  assert_near(f.corrected.foils[0].bumps[8].u_radius_mm, f.rows.m.foils[0].bumps[8].u_radius_mm, 0);
  close_fixture(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_correction_helps_beyond_twice_its_variance),
      cmocka_unit_test(exactly_known_corrections_are_applied),
      cmocka_unit_test(negligible_corrections_follow_the_others),
      cmocka_unit_test(unfitted_bumps_move_nothing),
      cmocka_unit_test(a_tie_moves_as_far_as_all_explanations_agree),
      cmocka_unit_test(evidence_weighs_explanations),
      cmocka_unit_test(one_undecided_bump_leaves_the_others_corrected),
      cmocka_unit_test(no_explanation_is_made_worse),
      cmocka_unit_test(all_bumps_of_a_kind_are_one_decision),
      cmocka_unit_test(scans_of_one_foil_are_one_decision),
      cmocka_unit_test(u_belongs_to_the_reported_value),
      cmocka_unit_test(misfitting_corrections_are_not_whole),
      cmocka_unit_test(one_dimension_moves_and_the_report_holds_together),
      cmocka_unit_test(uncorrected_values_stay_with_a_wider_u),
      cmocka_unit_test(a_wholly_beneficial_correction_is_kept),
      cmocka_unit_test(other_bumps_after_the_correction_are_none),
  };
  return cmocka_run_group_tests_name("what pays", tests, NULL, NULL);
}
