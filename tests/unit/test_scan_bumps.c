/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level `bumps` of the loop on scans, on measured foils made by formula: effects that exist are
 * found, others are not, and foils that are too small say so. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/splitmix.h"
#include "scan_loop/bumps.h"
#include "support/brief.h"
#include "support/test.h"

enum { FOILS = 12, BUMPS = 9 };

/* Contents of the made foils. */
typedef struct recipe {
  size_t foils, bumps;
  bool no_lip;
  double scatter, decay, decay_bumps, stretch, stretch_scatter, edge_deg, u_deg;
  int first, every;                         /* bumps that stand apart, by apart_deg */
  double apart_deg, cycle_deg, cycle_bumps; /* of their angle */
} recipe;

static const recipe plain = {.foils = 1, .bumps = BUMPS, .scatter = 0.01, .u_deg = 0.001};

typedef struct scans {
  fg_measurement one;
  fg_foil foil[FOILS];
  fg_bump bump[FOILS][BUMPS];
  fg_scan_loop_bumps bumps;
} scans;

static void make(const recipe *r, uint64_t seed, scans *s) {
  *s = (scans){.one = {.foils = s->foil, .foil_count = r->foils}};
  fg_design_default(&s->one.design);
  for (size_t f = 0; f < r->foils; f++) {
    s->foil[f] = (fg_foil){.bumps = s->bump[f],
                           .bump_count = r->bumps,
                           .flags = r->no_lip ? FG_FOIL_NO_LIP : 0,
                           .overall = {.radius_mm = 20.95}};
    for (size_t b = 0; b < r->bumps; b++) {
      fg_bump *p = &s->bump[f][b];
      p->number = (int)b + 1;
      p->radius_mm = 3.32 * (1.02 + r->scatter * fg_splitmix_normal(&seed)) *
                     (1 + r->decay * exp(-(double)b / (r->decay_bumps > 0 ? r->decay_bumps : 1)));
      double arc = 1 + r->stretch + r->stretch_scatter * fg_splitmix_normal(&seed);
      p->bump_angle_deg = 63.15 * 3.32 / p->radius_mm * arc + r->edge_deg +
                          0.3 * r->u_deg * fg_splitmix_normal(&seed);
      bool apart = r->first && p->number >= r->first && !((p->number - r->first) % r->every);
      if (apart) p->bump_angle_deg += r->apart_deg;
      if (r->cycle_bumps > 0)
        p->bump_angle_deg += r->cycle_deg * sin(2 * M_PI * p->number / r->cycle_bumps);
      p->height_mm = 0.55;
      p->u_radius_mm = 0.0001;
      p->u_bump_angle_deg = r->u_deg;
    }
  }
}

static void run(const recipe *r, uint64_t seed, scans *s) {
  static const bool none[1] = {false};
  fg_context ctx = {0};
  make(r, seed, s);
  const fg_scan_loop_bumps_request request = {
      .before = &s->one, .after = &s->one, .hold_out = none, .scan_count = 1, .seed = seed};
  assert_ok(&ctx, fg_scan_loop_bumps_run(&ctx, &request, &s->bumps));
}

/* The first claim of a response and its parameter. */
static double parameter(const scans *s, size_t response, const char *id, size_t index, double *u) {
  const fg_loop_result *result = &s->bumps.level[response].result;
  const char *name;
  double value;
  assert_int_equal(result->claims, 1);
  assert_string_equal(result->claim[0].candidate.effect->id, id);
  assert_true(fg_scan_loop_bumps_parameter(&s->bumps, response, &result->claim[0], index, &name,
                                           &value, u));
  return value;
}

static void a_decay_from_the_lip_is_found(void **state) {
  recipe r = plain;
  scans s;
  double u;
  (void)state;
  r.decay = 0.12;
  r.decay_bumps = 2;
  r.scatter = 0.004;
  run(&r, 3, &s);
  double value = parameter(&s, 0, "part.lip_decay", 0, &u);
  assert_true(fabs(value - 0.12) < 3 * u && u < 0.02);
  value = parameter(&s, 0, "part.lip_decay", 1, &u);
  assert_true(fabs(value - 2) < 3 * u && u < 1);
  assert_true(s.bumps.level[0].error.rms[1] < 0.3 * s.bumps.level[0].error.rms[0]);
  assert_int_equal(s.bumps.level[1].result.claims, 0);
  fg_scan_loop_bumps_free(&s.bumps);
}

static void a_stretch_is_found(void **state) {
  recipe r = plain;
  scans s;
  double u;
  (void)state;
  r.stretch = -0.006;
  r.stretch_scatter = 0.001;
  run(&r, 5, &s);
  double value = parameter(&s, 1, "part.stretch", 0, &u);
  assert_true(fabs(value + 0.006) < 3 * u && u < 0.001);
  assert_int_equal(s.bumps.level[0].result.claims, 0);
  fg_scan_loop_bumps_free(&s.bumps);
}

static void foils_are_the_units_of_a_lot(void **state) {
  recipe r = plain;
  scans s;
  double u;
  (void)state;
  r.foils = FOILS;
  r.decay = 0.03;
  r.decay_bumps = 1.5;
  run(&r, 7, &s);
  double value = parameter(&s, 0, "part.lip_decay", 0, &u);
  assert_true(fabs(value - 0.03) < 3 * u && u < 0.01);
  fg_scan_loop_bumps_free(&s.bumps);
}

/* A steady error of the edges, as all bumps share, is no stretch; nor is it silent. */
static void a_common_edge_error_is_no_claim(void **state) {
  recipe r = plain;
  scans s;
  (void)state;
  r.edge_deg = 0.0025;
  run(&r, 11, &s);
  assert_false(fg_scan_loop_bumps_claimed(&s.bumps));
  assert_int_equal(s.bumps.level[1].drops, 1);
  assert_int_equal(s.bumps.notes, 1);
  assert_has(s.bumps.note[0], "in doubt");
  assert_true(s.bumps.level[1].error.rms[0] == s.bumps.level[1].error.rms[1]);
  fg_scan_loop_bumps_free(&s.bumps);
}

static const fg_loop_curve *angle_curve(const scans *s) {
  size_t response;
  const fg_loop_curve *curve = fg_scan_loop_bumps_curve(&s->bumps, &response);
  assert_non_null(curve);
  assert_int_equal(response, 1);
  assert_false(fg_scan_loop_bumps_claimed(&s->bumps));
  return curve;
}

/* A bump that is raised with its flanks has another angle for its radius. */
static void single_bumps_are_told(void **state) {
  static const struct {
    int first, every;
    double apart_deg;
    const char *words;
  } cases[] = {{3, 3, 0.24, "of bumps 3, 6, 9, every 3rd, differs"},
               {5, 99, -0.1, "of bump 5 differs"},
               {2, 5, 0.1, "of bumps 2, 7 differs"}};
  (void)state;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    in_row("cases[%zu]", k);
    recipe r = plain;
    scans s;
    r.first = cases[k].first;
    r.every = cases[k].every;
    r.apart_deg = cases[k].apart_deg;
    run(&r, 21 + k, &s);
    const fg_loop_curve *curve = angle_curve(&s);
    for (int number = 1; number <= BUMPS; number++) {
      bool apart = number >= r.first && !((number - r.first) % r.every);
      assert_true(fabs(fg_loop_curve_at(curve, number) - (apart ? r.apart_deg : 0)) < 0.002);
    }
    assert_true(curve->p_value < 0.002);
    assert_true(s.bumps.level[1].error.rms[1] < 0.1 * s.bumps.level[1].error.rms[0]);
    bool said = false; /* a lone one may be called an outlier as well */
    for (size_t i = 0; i < s.bumps.notes; i++)
      said = said || strstr(s.bumps.note[i], cases[k].words);
    if (!said) fail_msg("not said: %s", cases[k].words);
    fg_scan_loop_bumps_free(&s.bumps);
  }
}

static void a_cycle_over_the_bumps_is_told(void **state) {
  recipe r = plain;
  scans s;
  (void)state;
  r.cycle_deg = 0.1;
  r.cycle_bumps = 2.7;
  run(&r, 31, &s);
  const fg_loop_curve *curve = angle_curve(&s);
  for (int number = 1; number <= BUMPS; number++) {
    double is = 0.1 * sin(2 * M_PI * number / 2.7);
    assert_true(fabs(fg_loop_curve_at(curve, number) - is) < 0.02);
  }
  assert_has(s.bumps.note[0], "repeats every 2.");
  fg_scan_loop_bumps_free(&s.bumps);
}

/* A deviation within the uncertainty of the edges is that of no bump, however steady it is. */
static void single_bumps_within_uncertainty_are_not_told(void **state) {
  recipe r = plain;
  scans s;
  size_t response;
  (void)state;
  r.first = r.every = 3;
  r.apart_deg = 0.0025;
  r.u_deg = 0.001;
  run(&r, 33, &s);
  assert_null(fg_scan_loop_bumps_curve(&s.bumps, &response));
  fg_scan_loop_bumps_free(&s.bumps);
}

static void small_foils_say_what_they_cannot_tell(void **state) {
  (void)state;
  for (size_t bumps = 0; bumps < BUMPS; bumps++) {
    recipe r = plain;
    scans s;
    r.bumps = bumps;
    r.decay = 0.3;
    run(&r, 13, &s);
    assert_int_equal(s.bumps.count, bumps);
    assert_int_equal(s.bumps.notes >= 1, 1);
    assert_has(s.bumps.note[0], bumps < 6 ? "no effect over them" : "no arc length");
    assert_int_equal(s.bumps.level[0].judged, bumps >= FG_SCAN_LOOP_BUMP_ROWS);
    if (bumps < 6) assert_false(fg_scan_loop_bumps_claimed(&s.bumps));
    fg_scan_loop_bumps_free(&s.bumps);
  }
}

static void without_a_lip_there_is_no_decay(void **state) {
  recipe r = plain;
  scans s;
  (void)state;
  r.no_lip = true;
  r.decay = 0.12;
  r.decay_bumps = 2;
  r.scatter = 0.004;
  run(&r, 3, &s);
  assert_false(fg_scan_loop_bumps_claimed(&s.bumps));
  for (size_t k = 0; k < s.bumps.level[0].result.rejects; k++)
    assert_int_not_equal(
        strncmp(s.bumps.level[0].result.rejected[k].candidate.effect->id, "part.", 5), 0);
  assert_has(s.bumps.note[0], "without a lip");
  fg_scan_loop_bumps_free(&s.bumps);
}

static void bumps_that_were_not_fitted_are_left_out(void **state) {
  static const bool none[1] = {false};
  fg_context ctx = {0};
  scans s;
  (void)state;
  make(&plain, 17, &s);
  s.bump[0][2].flags = FG_BUMP_CRUSHED;
  s.bump[0][4].radius_mm = NAN;
  const fg_scan_loop_bumps_request request = {
      .before = &s.one, .after = &s.one, .hold_out = none, .scan_count = 1, .seed = 1};
  assert_ok(&ctx, fg_scan_loop_bumps_run(&ctx, &request, &s.bumps));
  assert_int_equal(s.bumps.count, BUMPS - 2);
  fg_scan_loop_bumps_free(&s.bumps);
}

/* Two views of one foil are nine bumps, not eighteen. */
static void views_of_one_foil_are_averaged(void **state) {
  static const bool none[2] = {false, false};
  fg_context ctx = {0};
  scans s;
  (void)state;
  make(&plain, 19, &s);
  fg_measurement twice[2] = {s.one, s.one};
  fg_scan_loop_bumps_request request = {.before = twice,
                                        .after = twice,
                                        .hold_out = none,
                                        .scan_count = 2,
                                        .same_foil = true,
                                        .seed = 1};
  assert_ok(&ctx, fg_scan_loop_bumps_run(&ctx, &request, &s.bumps));
  assert_int_equal(s.bumps.count, BUMPS);
  assert_int_equal(s.bumps.parts, 1);
  assert_true(fabs(s.bumps.bump[3].value[0] - s.bump[0][3].radius_mm) < 1e-12);
  fg_scan_loop_bumps_free(&s.bumps);
  request.same_foil = false;
  assert_ok(&ctx, fg_scan_loop_bumps_run(&ctx, &request, &s.bumps));
  assert_int_equal(s.bumps.count, 2 * BUMPS);
  fg_scan_loop_bumps_free(&s.bumps);
}

/* One in a hundred would be right; with 200 draws more than 7 is one in a thousand. Of single bumps
 * two in a thousand, and three. */
static void scatter_alone_is_clean(void **state) {
  size_t claims = 0, curves = 0, response;
  (void)state;
  for (uint64_t seed = 1; seed <= 200; seed += test_step(7)) {
    recipe r = plain;
    scans s;
    r.foils = 1 + seed % 3;
    r.stretch_scatter = seed % 2 ? 0.002 : 0;
    run(&r, 1000 * seed, &s);
    claims += fg_scan_loop_bumps_claimed(&s.bumps);
    curves += fg_scan_loop_bumps_curve(&s.bumps, &response) != NULL;
    fg_scan_loop_bumps_free(&s.bumps);
  }
  print_message("claims on foils without any effect: %zu, single bumps: %zu\n", claims, curves);
  assert_true(claims <= 7 && curves <= 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_decay_from_the_lip_is_found),
      cmocka_unit_test(a_stretch_is_found),
      cmocka_unit_test(foils_are_the_units_of_a_lot),
      cmocka_unit_test(a_common_edge_error_is_no_claim),
      cmocka_unit_test(single_bumps_are_told),
      cmocka_unit_test(a_cycle_over_the_bumps_is_told),
      cmocka_unit_test(single_bumps_within_uncertainty_are_not_told),
      cmocka_unit_test(small_foils_say_what_they_cannot_tell),
      cmocka_unit_test(without_a_lip_there_is_no_decay),
      cmocka_unit_test(bumps_that_were_not_fitted_are_left_out),
      cmocka_unit_test(views_of_one_foil_are_averaged),
      cmocka_unit_test(scatter_alone_is_clean),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
