/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors on held-out bumps: an effect that exists is foretold, noise is not, and neither the copies
 * nor the threads that this takes leave a trace. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "effect_search/cross_fit.h"
#include "effect_search/joint_fit.h"
#include "support/odd_scan.h"
#include "support/test.h"

enum { BUMPS = 6, RIPPLE_UM = 5 };

typedef struct fixture {
  fg_context ctx;
  odd_input in;
  fg_measurement measurement[ODD_SCANS];
  fg_edge_fit edge_fit;
  fg_effect_set set;
  fg_explanations explanations;
} fixture;

/* One foil on every scan, turned by 90 degrees from one to the next. */
static void open_foil(fixture *f, size_t scans, int bumps, double ripple_um) {
  fg_edge_fit_view view[ODD_SCANS] = {{0}};
  *f = (fixture){.in = {.scans = scans}};
  fg_design_default(&f->in.design);
  for (size_t i = 0; i < scans; i++) {
    odd_scan *scan = &f->in.scan[i];
    scan->foils = 1;
    scan->foil[0] = odd_plain_foil(bumps);
    scan->foil[0].turn_deg += 90 * (double)i;
    scan->foil[0].seed += i;
    if (bumps < BUMPS) scan->foil[0].step_mm /= 3; /* rows enough */
    scan->scanner = (odd_scanner){.ripple_um = ripple_um, .period_mm = 3, .step_mm = 1e3};
  }
  odd_measure(&f->in, f->measurement);
  for (size_t i = 0; i < scans; i++)
    view[i] = (fg_edge_fit_view){
        .foil = &f->measurement[i].foils[0], .measurement = &f->measurement[i], .scan = i};
  if (fg_edge_fit_build(&f->ctx, view, scans, &f->edge_fit) != FG_OK)
    fail_msg("%s", f->ctx.message);
}

static void search(fixture *f) {
  double *residual_um = calloc(f->edge_fit.row_count, sizeof *residual_um);
  assert_non_null(residual_um);
  if (fg_search_run(&f->ctx, &f->edge_fit, &f->set, &f->explanations, residual_um) != FG_OK)
    fail_msg("%s", f->ctx.message);
  free(residual_um);
}

/* One effect of one number. */
static fg_effect_set set_of(const char *id) {
  return (fg_effect_set){.count = 1, .effects = {{.kind = fg_effect_find(id), .columns = 1}}};
}

static fg_cross_fit judge(fixture *f, unsigned threads) {
  fg_cross_fit result;
  assert_ok(&f->ctx, fg_search_cross_fit(&f->ctx, &f->edge_fit, &f->set, &f->explanations.barred,
                                         threads, &result));
  return result;
}

static void close_foil(fixture *f) {
  fg_edge_fit_free(&f->edge_fit);
  for (size_t i = 0; i < f->in.scans; i++)
    fg_measurement_free(&f->measurement[i]);
}

static void taking_a_subset_leaves_the_full_set_unchanged(void **state) {
  (void)state;
  fixture f;
  open_foil(&f, 1, BUMPS, 0);
  fg_edge_fit subset;
  bool *keep = calloc(f.edge_fit.row_count, sizeof *keep);
  assert_non_null(keep);
  size_t kept = 0;
  for (size_t i = 0; i < f.edge_fit.row_count; i++)
    kept += keep[i] = f.edge_fit.rows[i].bump == 2;
  assert_ok(&f.ctx, fg_edge_fit_subset(&f.ctx, &f.edge_fit, keep, &subset));
  assert_true(kept > 0);
  assert_int_equal(subset.row_count, kept);
  for (size_t i = 0; i < kept; i++)
    assert_int_equal(subset.rows[i].bump, 2);
  double radius_mm = f.edge_fit.parts[0].bumps[1].radius_mm, x_mm = f.edge_fit.poses[0].origin_mm.x;
  subset.parts[0].bumps[1].radius_mm = subset.poses[0].origin_mm.x = subset.rows[0].weight = -1;
  assert_near(f.edge_fit.parts[0].bumps[1].radius_mm, radius_mm, 0);
  assert_near(f.edge_fit.poses[0].origin_mm.x, x_mm, 0);
  for (size_t i = 0; i < f.edge_fit.row_count; i++)
    assert_true(f.edge_fit.rows[i].weight >= 0);
  fg_edge_fit_free(&subset);
  free(keep);
  close_foil(&f);
}

/* The search finds the same effect without its fold, and explains the fold as well. */
static void a_true_effect_survives_cross_fitting(void **state) {
  (void)state;
  for (size_t scans = 1; scans <= 2; scans++) {
    fixture f;
    open_foil(&f, scans, BUMPS, RIPPLE_UM);
    search(&f);
    assert_true(f.set.count > 0);
    fg_cross_fit one = judge(&f, 1), two = judge(&f, 2);
    assert_int_equal(one.folds, 5);
    assert_true(one.after_um < 0.1 * one.before_um);
    assert_true(one.gain > one.u_gain);
    assert_near(one.gain, one.before_um * one.before_um - one.after_um * one.after_um, 1e-9);
    assert_near(two.after_um, one.after_um, 0);
    assert_near(two.u_gain, one.u_gain, 0);
    close_foil(&f);
  }
}

/* A set that noise alone would have: its numbers, fitted to all rows, must not come along. */
static void noise_is_not_confirmed_by_cross_fitting(void **state) {
  (void)state;
  fixture f;
  open_foil(&f, 1, BUMPS, 0);
  search(&f);
  assert_int_equal(f.set.count, 0);
  f.set = set_of("scan.shear");
  assert_ok(&f.ctx, fg_joint_fit(&f.ctx, &f.edge_fit, &f.set, NULL));
  fg_cross_fit result = judge(&f, 1);
  assert_int_equal(result.folds, 5);
  assert_true(result.gain <= result.u_gain);
  assert_true(result.after_um > 0.999 * result.before_um);
  close_foil(&f);
}

/* Before, nothing but the geometry is fitted: the error is the rms of all rows. */
static void error_before_is_the_rms_of_all_rows(void **state) {
  (void)state;
  fixture f;
  open_foil(&f, 1, 3, RIPPLE_UM);
  f.set = set_of("scan.shear");
  fg_cross_fit result = judge(&f, 1);
  assert_int_equal(result.unit, FG_CROSS_FIT_BUMPS);
  assert_int_equal(result.folds, 3); /* a bump each */
  const fg_effect_set none = {.count = 0};
  double *residual_um = calloc(f.edge_fit.row_count, sizeof *residual_um), sum = 0, weight = 0;
  assert_non_null(residual_um);
  assert_ok(&f.ctx, fg_joint_fit_geometry(&f.ctx, &f.edge_fit, &none, residual_um));
  for (size_t i = 0; i < f.edge_fit.row_count; i++) {
    sum += f.edge_fit.rows[i].weight * residual_um[i] * residual_um[i];
    weight += f.edge_fit.rows[i].weight;
  }
  assert_near(result.before_um, sqrt(sum / weight), 1e-6);
  free(residual_um);
  close_foil(&f);
}

/* A curve over places tells nothing of a place without rows: of every arc some stretches stay. */
static void a_curve_is_judged_by_stretches(void **state) {
  (void)state;
  fixture f;
  open_foil(&f, 1, BUMPS, RIPPLE_UM);
  const fg_effect *curve = fg_effect_first();
  while (!(fg_effect_is_free(curve) && curve->coordinate == FG_EFFECT_Y))
    curve = fg_effect_next(curve);
  f.set = (fg_effect_set){.count = 1, .effects = {{.kind = curve, .columns = curve->columns}}};
  fg_cross_fit result = judge(&f, 1);
  assert_int_equal(result.unit, FG_CROSS_FIT_STRETCHES);
  assert_int_equal(result.folds, 5);
  assert_true(result.after_um < 0.5 * result.before_um);
  close_foil(&f);
}

static void one_bump_cannot_be_left_out(void **state) {
  (void)state;
  fixture f;
  open_foil(&f, 1, 1, 0);
  f.set = set_of("scan.shear");
  fg_cross_fit result = judge(&f, 1);
  assert_int_equal(result.folds, 0);
  assert_true(isnan(result.before_um) && isnan(result.after_um));
  close_foil(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(taking_a_subset_leaves_the_full_set_unchanged),
      cmocka_unit_test(a_true_effect_survives_cross_fitting),
      cmocka_unit_test(noise_is_not_confirmed_by_cross_fitting),
      cmocka_unit_test(error_before_is_the_rms_of_all_rows),
      cmocka_unit_test(a_curve_is_judged_by_stretches),
      cmocka_unit_test(one_bump_cannot_be_left_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
