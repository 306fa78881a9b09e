/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evidence of models: rivals that no name has, shapes that must be just so, expectations. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "evidence/displacement.h"
#include "evidence/options.h"
#include "evidence/search.h"
#include "evidence/unnamed.h"
#include "evidence/unseen.h"
#include "evidence/verdict.h"
#include "support/foil_rows.h"
#include "support/test.h"

#define NOISE_UM 0.03

static void search(foil_rows *f, const fg_evidence_prior *prior, fg_evidence_search *s) {
  fg_context ctx = {0};
  const fg_evidence_request request = {.prior = *prior};
  assert_ok(&ctx,
            fg_evidence_search_open(&ctx, &f->edge_fit, &request, f->residual_um, f->jacobian, s));
  assert_ok(&ctx, fg_evidence_search_run(&ctx, s));
}

/* Every land bowed alike: three fields of the scanner at once could do it, at most. */
static void lands_that_deviate_alike_are_of_the_part(void **state) {
  (void)state;
  foil_rows f;
  fg_evidence_search s;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  for (size_t i = 0; i < f.edge_fit.row_count; i++) {
    double t = f.edge_fit.rows[i].phi;
    if (!f.edge_fit.rows[i].bump) f.residual_um[i] += t * (5 * t * t - 3);
  }
  search(&f, &(fg_evidence_prior){1, 1}, &s);
  const fg_evidence_part *first = s.models[0].part[0];
  if (s.models[0].parts != 1 || !first->rival || strcmp(first->rival->name, "land.phi"))
    fail_msg("%zu parts, first %s", s.models[0].parts,
             first->rival ? first->rival->name : first->effect->id);
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

/* A sharp period is one of many: it costs more than the choice among the starts. Expectations move
 * the score, and it alone, by their factor. */
static void a_shape_that_must_be_just_so_costs_more_than_a_start(void **state) {
  (void)state;
  const fg_effect *ripple = fg_effect_find("scan.carriage_ripple");
  const double um = 20, shape[FG_FIELD_SHAPES] = {2.31};
  foil_rows f;
  fg_evidence_search s;
  double score[2];
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  assert_true(foil_rows_add_effect(&f, ripple, shape, &um, 1) > 0);
  for (int k = 0; k < 2; k++) {
    search(&f, &(fg_evidence_prior){1, k ? 3 : 1}, &s);
    const fg_evidence_part *part = s.models[0].part[0];
    assert_true(s.models[0].parts == 1 && part->effect == ripple);
    double starts = (double)ripple->starts * FG_EVIDENCE_SIZES;
    assert_true(part->log_prior < log((k ? 3 : 1) * FG_EVIDENCE_PRIOR / starts));
    score[k] = s.models[0].score;
    fg_evidence_search_close(&s);
  }
  assert_true(fabs(score[1] - score[0] - log(3)) < 1e-6);
  foil_rows_close(&f);
}

static void put_pair(foil_rows *f, const char *const id[2], const double shape[2],
                     const double um[2]) {
  foil_rows_open(f);
  foil_rows_put_noise(f, NOISE_UM);
  fg_edge_fit_find_frame(&f->edge_fit);
  for (int k = 0; k < 2; k++) {
    const double own[FG_FIELD_SHAPES] = {shape[k]};
    assert_true(foil_rows_add_effect(f, fg_effect_find(id[k]), own, &um[k], 1) > 0);
  }
}

static bool is_pair(const fg_evidence_model *model, const char *const id[2]) {
  return model->parts == 2 && fg_evidence_holds(model, fg_effect_find(id[0])) &&
         fg_evidence_holds(model, fg_effect_find(id[1]));
}

/* Each alone explains less than several others do: the pair is reached from another one. */
static void a_pair_leads_of_which_neither_leads_alone(void **state) {
  (void)state;
  static const char *const id[2] = {"scan.carriage_start", "scan.shear"};
  foil_rows f;
  fg_evidence_search s;
  put_pair(&f, id, (const double[]){2.88, 0}, (const double[]){18, -8});
  search(&f, &(fg_evidence_prior){1, 1}, &s);
  if (!is_pair(&s.models[0], id))
    fail_msg("%zu parts, first %s", s.models[0].parts,
             s.models[0].part[0]->effect ? s.models[0].part[0]->effect->id
                                         : s.models[0].part[0]->rival->name);
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

static const fg_effect *unnamed(const char *id) {
  const fg_effect *one = fg_unnamed_effects;
  while (one->id && strcmp(one->id, id))
    one++;
  assert_non_null(one->id);
  return one;
}

/* The verdict on a foil that an effect has moved, from one of its starts, and the names in it. */
static void decide_on(const fg_effect *effect, size_t start, const double *um,
                      fg_evidence_verdict *v, char *names, size_t size) {
  fg_context ctx = {0};
  foil_rows f;
  fg_evidence_search s;
  double shape[FG_FIELD_SHAPES], reach[FG_FIELD_SHAPES];
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  fg_edge_fit_find_frame(&f.edge_fit);
  fg_evidence_find_start(&f.edge_fit, effect, start, shape, reach);
  assert_true(foil_rows_add_effect(&f, effect, shape, um, effect->columns) == effect->columns);
  search(&f, &(fg_evidence_prior){1, 1}, &s);
  assert_ok(&ctx, fg_evidence_decide(&ctx, &s, false, v));
  for (size_t k = 0, used = 0; k < v->ties; k++)
    for (size_t i = 0; i < v->tie[k].parts && used < size; i++) {
      const fg_evidence_part *part = v->tie[k].part[i];
      used += (size_t)snprintf(names + used, size - used, "%s + ",
                               part->effect ? part->effect->id : part->rival->name);
    }
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

/* A stop of the carriage that settles is no lost rows with dents beside them, and a carriage that
 * is shaken in the picture's middle is not three that swing, and two at most beside the one; one
 * that turns to and fro is no ripple that grows: each is one cause, without a name. */
static void one_cause_is_not_cut_into_named_pieces(void **state) {
  (void)state;
  static const char *id[] = {"scan.y.dy as an event", "scan.y.dx as a wave of changing size",
                             "scan.y.dy as a slanted wave"};
  static const size_t start[] = {10, 12, 20};
  static const double um[][6] = {{0, 10}, {2, 1, 0, 0, -2, -1}, {0, 0, 4, 2, 0, 0}};
  for (int k = 0; k < 3; k++) {
    char names[1000] = "";
    fg_evidence_verdict v;
    decide_on(unnamed(id[k]), start[k], um[k], &v, names, sizeof names);
    bool tied = k && v.outcome == FG_EVIDENCE_TIED && v.tie[0].parts == 1 && !v.tie[0].named;
    if ((v.outcome != FG_EVIDENCE_UNATTRIBUTED && !tied) || strstr(names, "scan.row_step"))
      fail_msg("%s: outcome %d, %s", id[k], (int)v.outcome, names);
  }
}

static bool is_option(const fg_evidence_search *s, const fg_effect *effect) {
  for (size_t o = 0; o < s->option_count; o++)
    if (s->options[o].effect == effect) return true;
  return false;
}

static bool has_row(const fg_effect *unnamed) {
  for (const fg_effect *one = fg_effect_first(); one; one = fg_effect_next(one))
    if (one->rival && !strcmp(one->rival, unnamed->id)) return true;
  return false;
}

/* One that finds no room is not weighed. */
static void every_unnamed_effect_is_an_option(void **state) {
  (void)state;
  foil_rows f;
  fg_evidence_search s;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  search(&f, &(fg_evidence_prior){1, 1}, &s);
  for (const fg_effect *one = fg_unnamed_effects; one->id; one++)
    if (fg_unnamed_shows(one, &f.edge_fit) && !has_row(one) && !is_option(&s, one))
      fail_msg("%s", one->id);
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

/* On one arc a fault at one place of the picture and a dent are alike. */
static void a_fault_at_one_place_is_no_dent(void **state) {
  (void)state;
  static const char *id[] = {"scan.x.dy as a pulse", "scan.xy at a small place",
                             "scan.xy at a large place"};
  static const size_t start[] = {58, 40, 40};
  static const double um[][2] = {{4}, {3, 3}, {3, 3}};
  for (int k = 0; k < 3; k++) {
    char names[1000] = "";
    fg_evidence_verdict v;
    decide_on(unnamed(id[k]), start[k], um[k], &v, names, sizeof names);
    if (v.outcome == FG_EVIDENCE_CLEAN || v.outcome == FG_EVIDENCE_FOUND || !strstr(names, "scan."))
      fail_msg("%s: outcome %d, %s", id[k], (int)v.outcome, names);
  }
}

/* A model of a search that is written by hand: rivals by their place in the table. */
static void put_model(fg_evidence_search *s, fg_evidence_part *part, double score,
                      const char *names) {
  fg_evidence_model *model = &s->models[s->count++];
  char list[200];
  *model = (fg_evidence_model){.score = score};
  snprintf(list, sizeof list, "%s", names);
  for (char *at = list, *name; (name = strtok(at, " ")) != NULL; at = NULL) {
    fg_evidence_part *one = &part[s->stored++];
    one->effect = fg_effect_find(name);
    for (const fg_rival *rival = fg_rivals; !one->effect && rival->name; rival++)
      if (!strcmp(rival->name, name)) one->rival = rival;
    assert_true(one->effect || one->rival);
    model->part[model->parts++] = one;
    model->named += one->effect != NULL;
  }
}

enum { WRITTEN = 4 };

/* The verdict on models of these scores, best first; the last of them is no cause. The columns were
 * taken about one effect, `about`, or none. */
static void decide_written_of(bool discs, const char *about, const double score[WRITTEN],
                              const char *const names[WRITTEN], fg_evidence_verdict *v) {
  fg_context ctx = {0};
  foil_rows f;
  fg_evidence_search s;
  static fg_evidence_part part[24];
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  fg_effect_set set = {.count = about != NULL};
  if (about) set.effects[0].kind = fg_effect_find(about);
  const fg_evidence_request request = {.prior = {1, 1}, .seed = &set, .seeds = 1};
  assert_ok(&ctx,
            fg_evidence_search_open(&ctx, &f.edge_fit, &request, f.residual_um, f.jacobian, &s));
  memset(part, 0, sizeof part);
  for (int m = 0; m < WRITTEN; m++)
    put_model(&s, part, score[m], names[m]);
  f.edge_fit.discs = discs;
  assert_ok(&ctx, fg_evidence_decide(&ctx, &s, false, v));
  f.edge_fit.discs = false;
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

static void decide_written(const double score[WRITTEN], const char *const names[WRITTEN],
                           fg_evidence_verdict *v) {
  decide_written_of(false, NULL, score, names, v);
}

static void a_name_beside_what_has_none_must_gain_more_than_the_columns_err(void **state) {
  (void)state;
  fg_evidence_verdict v;
  static const char *const names[] = {"scan.x.dx scan.row_step", "scan.x.dx scan.y.dy", "scan.x.dx",
                                      ""};
  decide_written((double[]){1e5, 1e5 - 4, 1e5 - 20, 0}, names, &v);
  assert_int_equal(v.outcome, FG_EVIDENCE_UNATTRIBUTED);
  assert_true(v.ties == 1 && v.tie[0].parts == 1 && !v.tie[0].named);
  decide_written((double[]){1e5, 1e5 - 40, 1e5 - 50, 0}, names, &v);
  assert_true(v.ties == 1 && v.tie[0].named == 1);
}

/* Smooth fields over x make no jump over y; a field over y may. */
static void a_jump_stays_beside_fields_where_none_does_without_it(void **state) {
  (void)state;
  static const struct {
    const char *best;
    double without;
    bool discs, certain;
  } cases[] = {
      {"scan.x.dx scan.row_step", 140, true, true},   {"scan.x.dx scan.row_step", 197, true, false},
      {"scan.y.dy scan.row_step", 140, true, false},  {"scan.x.dx scan.shear", 140, true, false},
      {"scan.x.dx scan.row_step", 140, false, false},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    fg_evidence_verdict v;
    const char *const names[] = {cases[k].best, "scan.y.dx", "scan.x.dy", ""};
    decide_written_of(cases[k].discs, NULL, (double[]){200, cases[k].without, 100, 0}, names, &v);
    assert_int_equal(v.outcome, FG_EVIDENCE_UNATTRIBUTED);
    if (v.certain[1] != cases[k].certain) fail_msg("case %zu", k);
  }
}

/* On sharp edges columns err by more than a small cause gains, but not beside the cause that they
 * were taken about. */
static void a_small_cause_is_told_beside_a_large_one(void **state) {
  (void)state;
  fg_evidence_verdict v;
  static const char *const names[] = {"part.bump_skew part.bump_crown", "part.bump_skew",
                                      "scan.x.dx", ""};
  static const double score[] = {1e6, 1e6 - 20, 1e5, 0};
  decide_written_of(false, "part.bump_skew", score, names, &v);
  assert_true(v.outcome == FG_EVIDENCE_FOUND && v.ties == 1 && v.tie[0].parts == 2);
  decide_written_of(false, "scan.shear", score, names, &v);
  assert_true(v.outcome == FG_EVIDENCE_FOUND && v.ties == 1 && v.tie[0].parts == 1);
}

/* Of two explanations of discs by the same effects, the one with fewer of them stays. */
static void one_step_is_told_before_two(void **state) {
  (void)state;
  fg_evidence_verdict v;
  static const char *const names[] = {"scan.row_step scan.row_step", "scan.row_step", "scan.xy",
                                      ""};
  decide_written_of(true, NULL, (double[]){1e3, 998, 800, 0}, names, &v);
  assert_int_equal(v.outcome, FG_EVIDENCE_FOUND);
  assert_true(v.ties == 1 && v.tie[0].parts == 1);
}

/* Each named cause is a chance of 3 %: of three, what has no name is as likely. A scale is none,
 * and lost rows are one. */
static void three_named_causes_at_once_are_tied(void **state) {
  (void)state;
  static const struct {
    const char *causes;
    fg_evidence_outcome outcome;
  } sets[] = {
      {"scan.row_step scan.carriage_ripple scan.yaw", FG_EVIDENCE_TIED},
      {"scan.row_step scan.carriage_ripple", FG_EVIDENCE_FOUND},
      {"scan.row_step scan.column_step scan.carriage_ripple", FG_EVIDENCE_FOUND},
      {"scan.shear scan.row_step scan.carriage_ripple", FG_EVIDENCE_FOUND},
  };
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
    fg_evidence_verdict v;
    const char *const names[] = {sets[k].causes, "scan.xy", "scan.y.dy", ""};
    decide_written((double[]){1e3, 900, 800, 0}, names, &v);
    if (v.outcome != sets[k].outcome || v.ties != (v.outcome == FG_EVIDENCE_TIED ? 2 : 1))
      fail_msg("%s: outcome %d, %zu ties", sets[k].causes, (int)v.outcome, v.ties);
  }
}

/* Found effects are corrected: a likelier model without one, which the verdict has refused, has no
 * weight. */
static void what_was_found_is_in_every_model_of_weight(void **state) {
  fg_context ctx = {0};
  foil_rows f;
  fg_evidence_search s;
  fg_evidence_window w;
  static fg_evidence_part part[24];
  (void)state;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  const fg_evidence_request request = {.prior = {1, 1}};
  assert_ok(&ctx,
            fg_evidence_search_open(&ctx, &f.edge_fit, &request, f.residual_um, f.jacobian, &s));
  memset(part, 0, sizeof part);
  put_model(&s, part, 1e3, "scan.carriage_quadratic scan.row_step");
  put_model(&s, part, 990, "scan.scale_y scan.shear scan.row_step");
  put_model(&s, part, 989, "scan.scale_y scan.shear");
  assert_ok(&ctx, fg_evidence_list_window(&ctx, &s, NULL, &w));
  assert_ptr_equal(w.model[0], &s.models[0]);
  assert_ok(&ctx, fg_evidence_list_window(&ctx, &s, &s.models[2], &w));
  assert_int_equal(w.count, 2);
  assert_ptr_equal(w.model[0], &s.models[1]);
  assert_near(w.weight[0], 1 / (1 + exp(-1)), 1e-12);
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

/* Without its size a keystone is a shear with a scale along x, which is no effect of the list. */
static void a_keystone_of_no_size_has_no_weight(void **state) {
  fg_context ctx = {0};
  foil_rows f;
  fg_evidence_search s;
  fg_evidence_window w;
  size_t nothings = 0;
  (void)state;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, NOISE_UM);
  fg_edge_fit_find_frame(&f.edge_fit);
  assert_true(foil_rows_add_effect(&f, fg_effect_find("scan.shear"), NULL, (double[]){18}, 1) == 1);
  search(&f, &(fg_evidence_prior){1, 1}, &s);
  for (size_t m = 0; m < s.count; m++) {
    bool bear;
    assert_ok(&ctx, fg_evidence_has_defining_columns(&ctx, &s, &s.models[m], &bear));
    nothings += !bear;
  }
  assert_true(nothings > 0);
  assert_ok(&ctx, fg_evidence_list_window(&ctx, &s, NULL, &w));
  for (size_t m = 0; m < w.count; m++) {
    bool bear;
    assert_ok(&ctx, fg_evidence_has_defining_columns(&ctx, &s, w.model[m], &bear));
    assert_true(bear);
  }
  fg_evidence_search_close(&s);
  foil_rows_close(&f);
}

/* Standard uncertainty of R0, um, that is left by what the scanner may do unseen. */
static double unseen_um(foil_rows *f) {
  fg_context ctx = {0};
  fg_evidence_search s;
  const fg_edge_fit *edge_fit = &f->edge_fit;
  fg_displacement_part part = {.bumps = calloc(edge_fit->parts[0].bump_count, sizeof *part.bumps)};
  search(f, &(fg_evidence_prior){1, 1}, &s);
  assert_ok(&ctx, fg_evidence_find_unseen(&ctx, &s, &part));
  for (size_t b = 0; b < edge_fit->parts[0].bump_count; b++)
    for (int i = 0; i < 3; i++)
      assert_true(part.bumps[b][i][i] >= 0);
  free(part.bumps);
  fg_evidence_search_close(&s);
  return 1000 * sqrt(part.overall);
}

/* The noisier the edges, the larger a map of the glass that they do not refute. */
static void what_edges_do_not_show_is_bounded_by_them(void **state) {
  (void)state;
  double um[2];
  for (int k = 0; k < 2; k++) {
    foil_rows f;
    foil_rows_open(&f);
    foil_rows_put_noise(&f, k ? 10 * NOISE_UM : NOISE_UM);
    um[k] = unseen_um(&f);
    foil_rows_close(&f);
  }
  if (!(um[0] > 0 && um[0] < 0.5 && um[1] > 4 * um[0] && um[1] < 20))
    fail_msg("u of R0, um: %g, %g with ten times the noise", um[0], um[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lands_that_deviate_alike_are_of_the_part),
      cmocka_unit_test(one_cause_is_not_cut_into_named_pieces),
      cmocka_unit_test(every_unnamed_effect_is_an_option),
      cmocka_unit_test(a_fault_at_one_place_is_no_dent),
      cmocka_unit_test(a_pair_leads_of_which_neither_leads_alone),
      cmocka_unit_test(a_name_beside_what_has_none_must_gain_more_than_the_columns_err),
      cmocka_unit_test(a_jump_stays_beside_fields_where_none_does_without_it),
      cmocka_unit_test(one_step_is_told_before_two),
      cmocka_unit_test(a_small_cause_is_told_beside_a_large_one),
      cmocka_unit_test(three_named_causes_at_once_are_tied),
      cmocka_unit_test(what_was_found_is_in_every_model_of_weight),
      cmocka_unit_test(a_keystone_of_no_size_has_no_weight),
      cmocka_unit_test(what_edges_do_not_show_is_bounded_by_them),
      cmocka_unit_test(a_shape_that_must_be_just_so_costs_more_than_a_start),
  };
  return cmocka_run_group_tests_name("evidence", tests, NULL, NULL);
}
