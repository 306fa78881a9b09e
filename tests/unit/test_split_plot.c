/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Split plots with missing runs, against R; where none is missing, the analysis of variance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/experiment.h"
#include "stats/mixed_model.h"
#include "support/data.h"
#include "support/random.h"
#include "support/test.h"

static fg_experiment analyse(const char *text, const char *formula) {
  fg_context ctx = {0};
  fg_table table;
  fg_experiment e;
  const fg_experiment_options options = {.response = "y", .formula = formula, .whole_plot = "load"};
  if (fg_table_parse(&ctx, "t", text, strlen(text), &table) != FG_OK ||
      fg_experiment_analyse(&ctx, &table, &options, &e) != FG_OK)
    fail_msg("%s", ctx.message);
  fg_table_free(&table);
  return e;
}

/* R writes (Intercept) and groupb. */
static bool is_named(const char *ours, const char *theirs) {
  if (!strcmp(ours, "(constant)")) return !strcmp(theirs, "(Intercept)");
  for (; *ours; ours++) {
    if (*ours == '[' || *ours == ']') continue;
    if (*ours != *theirs++) return false;
  }
  return !*theirs;
}

static double ours(const fg_experiment *e, const char *what, const char *name) {
  const fg_split_plot *s = &e->split_plot;
  if (!strcmp(what, "plot_variance")) return s->plot_variance;
  if (!strcmp(what, "run_variance")) return s->run_variance;
  if (!strcmp(what, "nlme_plot_sd")) return sqrt(s->plot_variance);
  for (size_t j = 0; j < e->regression.columns; j++) {
    if (!is_named(e->regression.coefficient[j].name, name)) continue;
    if (!strcmp(what, "estimate")) return e->regression.coefficient[j].estimate;
    if (!strcmp(what, "standard_error")) return e->effect[j].standard_error;
    if (!strcmp(what, "freedom")) return e->effect[j].dof;
  }
  for (size_t t = 0; t < s->terms; t++) {
    if (strcmp(s->term[t].row.name, name) != 0) continue;
    if (!strcmp(what, "term_f")) return s->term[t].row.f;
    if (!strcmp(what, "term_freedom")) return s->term[t].error_dof;
    if (!strcmp(what, "term_p")) return s->term[t].row.p_value;
  }
  fail_msg("no %s of %s", what, name);
  return NAN;
}

/* Lines plan,what,"name",value. */
static size_t check_plan(const fg_experiment *e, const char *plan, const char *reference) {
  size_t checked = 0;
  for (const char *line = reference; line;
       line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL) {
    char of[40], what[40], rest[80], name[40] = "";
    if (sscanf(line, "%39[^,],%39[^,],\"%79[^\n]", of, what, rest) != 3 || strcmp(of, plan) != 0)
      continue;
    char *end = strchr(rest, '"');
    snprintf(name, sizeof name, "%.*s", (int)(end - rest), rest);
    double theirs = strtod(end + 2, NULL), own = ours(e, what, name);
    double tolerance = !strcmp(what, "nlme_plot_sd") ? 1e-4 : 5e-6;
    if (!(fabs(own - theirs) <= tolerance * fmax(fabs(theirs), 1e-2)))
      fail_msg("%s: %s %s is %.12g, by R %.12g", plan, what, name, own, theirs);
    checked++;
  }
  return checked;
}

static void missing_runs_are_analysed_as_by_r(void **state) {
  (void)state;
  char *plans = data_read("split_plot/plans.txt"),
       *reference = data_read("split_plot/reference.csv");
  size_t checked = 0, border = 0;
  for (const char *line = plans; *line; line = strchr(line, '\n') + 1) {
    char name[40], model[40], path[80];
    assert_int_equal(sscanf(line, "%39[^\t]\t%39[^\n]", name, model), 2);
    snprintf(path, sizeof path, "split_plot/%s", name);
    char *text = data_read(path);
    fg_experiment e = analyse(text, model);
    assert_non_null(e.split_plot.mixed);
    checked += check_plan(&e, name, reference);
    border += e.split_plot.at_border;
    fg_experiment_free(&e);
    free(text);
  }
  assert_true(checked > 100 && border > 1);
  free(plans);
  free(reference);
}

enum { PLOTS = 8, PER_PLOT = 4 };

static char *complete_plan(uint64_t seed, double plot_sd, const char *drop) {
  char *text = calloc(1, 4096);
  size_t used = (size_t)snprintf(text, 4096, "T,D,P,load,y\n");
  for (int plot = 0; plot < PLOTS; plot++) {
    double shift = plot_sd * random_gaussian(&seed);
    for (int run = 0; run < PER_PLOT; run++) {
      int t = plot % 2 ? 1 : -1, d = run % 2 ? 1 : -1, p = run / 2 ? 1 : -1;
      char row[80];
      snprintf(row, sizeof row, "%d,%d,%d,%d,%.6f\n", t, d, p, plot + 1,
               20 + 3 * t + 2 * d - p + shift + random_gaussian(&seed));
      if (!drop || strncmp(row, drop, strlen(drop)) != 0)
        used += (size_t)snprintf(text + used, 4096 - used, "%s", row);
    }
  }
  return text;
}

/* Without missing runs restricted likelihood comes to the analysis of variance, in both signs of
 * the whole plots' variance; it is the latter that is used. */
static void complete_plans_agree_with_the_strata(void **state) {
  (void)state;
  int negative = 0;
  for (uint64_t seed = 1; seed <= 12; seed++) {
    char *text = complete_plan(seed, seed % 3 ? 0 : 1, NULL);
    fg_experiment e = analyse(text, "T*(D + P)");
    fg_levels plots;
    fg_mixed_model mixed;
    assert_null(e.split_plot.mixed);
    assert_ok(&test_context, fg_table_levels(&test_context, &e.table, "load", true, &plots));
    assert_ok(&test_context,
              fg_mixed_fit(&test_context, &e.model, &plots, &e.regression, false, &mixed));
    const fg_split_plot *s = &e.split_plot;
    assert_true(fabs(mixed.variance[FG_MIXED_RUNS] / s->run_ms - 1) < 1e-9);
    assert_true(fabs(mixed.variance[FG_MIXED_GROUPS] - (s->plot_ms - s->run_ms) / PER_PLOT) < 1e-9);
    negative += mixed.at_border;
    for (size_t j = 0; j < e.regression.columns; j++) {
      double row[8] = {0}, dof;
      row[j] = 1;
      double u = sqrt(fg_mixed_variance(&mixed, row, false, &dof));
      assert_true(fabs(u / e.effect[j].standard_error - 1) < 1e-9);
      assert_true(fabs(dof - e.effect[j].dof) < 1e-6);
      assert_true(fabs(mixed.estimate[j] - e.regression.coefficient[j].estimate) < 1e-9);
    }
    fg_mixed_free(&mixed);
    fg_levels_free(&plots);
    fg_experiment_free(&e);
    free(text);
  }
  assert_in_range(negative, 2, 10);
}

/* Each temperature in one whole plot: T cannot be told, D is told within the plots. */
static void factors_within_plots_are_estimated_without_whole_plot_dof(void **state) {
  (void)state;
  static const char text[] = "T,D,load,y\n-1,-1,1,11\n-1,1,1,15\n-1,-1,1,12\n"
                             "1,-1,2,20\n1,1,2,26\n1,1,2,25\n1,-1,2,21\n";
  fg_experiment e = analyse(text, "T + D");
  assert_non_null(e.split_plot.mixed);
  assert_true(isnan(e.effect[1].standard_error) && isnan(e.split_plot.plot_variance));
  /* Within plot 1: 3.5 / 2, weight 2/3; within plot 2: 5 / 2, weight 1. */
  double slope = (1.75 * 8 / 3 + 2.5 * 4) / (8.0 / 3 + 4);
  assert_true(fabs(e.regression.coefficient[2].estimate - slope) < 1e-5);
  assert_true(fabs(e.effect[2].dof - 4) < 1e-9);
  assert_true(e.effect[2].low < slope && e.effect[2].high > slope);
  fg_experiment_free(&e);
}

/* A fit without scatter, a whole plot that is one run, one that is gone: nothing is invented. */
static void odd_plans_are_analysed_or_say_why(void **state) {
  (void)state;
  fg_experiment e = analyse("T,D,load,y\n-1,-1,1,1\n-1,1,1,3\n-1,-1,2,1\n1,-1,3,5\n1,1,3,7\n"
                            "1,-1,4,5\n1,1,4,7\n",
                            "T + D");
  assert_true(e.regression.residual_ss < 1e-20);
  fg_experiment_free(&e);
  char *text = complete_plan(4, 1, "-1,1,");
  e = analyse(text, "T + D + P");
  assert_non_null(e.split_plot.mixed);
  for (size_t j = 0; j < e.regression.columns; j++)
    if (!e.regression.coefficient[j].aliased)
      assert_true(e.effect[j].standard_error > 0 && e.effect[j].dof > 1);
  assert_true(e.best.optimum.prediction.standard_error > 0);
  fg_experiment_free(&e);
  free(text);
}

/* Beside T:die the coefficient of T is that of the first die, which T does nothing to (F 0.157,
 * p = 0.70). Expected: F, dof and p of restricted likelihood with contrasts that add up to zero. */
static void terms_beside_words_are_tested_by_their_mean(void **state) {
  (void)state;
  static const char text[] = "T,die,load,y\n"
                             "-1,b,L1,20.088\n-1,a,L1,20.217\n-1,c,L1,19.922\n1,a,L2,19.989\n"
                             "1,b,L2,21.525\n1,c,L2,22.947\n1,a,L2,20.733\n1,b,L2,22.173\n"
                             "1,c,L2,22.985\n-1,a,L3,19.971\n-1,b,L3,18.485\n-1,a,L3,19.114\n"
                             "-1,b,L3,19.176\n1,a,L4,18.367\n1,b,L4,21.488\n1,c,L4,22.730\n"
                             "1,a,L4,19.797\n1,b,L4,22.080\n1,c,L4,23.407\n-1,a,L5,21.190\n"
                             "-1,c,L5,17.374\n-1,a,L5,20.394\n-1,b,L5,19.661\n-1,c,L5,17.437\n"
                             "1,a,L6,20.381\n1,b,L6,22.798\n1,a,L6,20.770\n1,b,L6,21.049\n"
                             "1,c,L6,23.041\n-1,a,L7,18.859\n-1,a,L7,19.561\n-1,b,L7,17.543\n"
                             "-1,c,L7,16.525\n1,b,L8,22.144\n1,a,L8,21.350\n1,b,L8,22.170\n"
                             "1,c,L8,23.162\n";
  static const struct {
    const char *term;
    double f, dof, p_value;
  } expected[] = {{"T", 33.8151692, 6.01278149, 0.00112751416},
                  {"die", 1.01125266, 25.6191908, 0.377826637},
                  {"T:die", 42.8622596, 25.6191908, 6.70183e-09}};
  fg_experiment e = analyse(text, "T*die");
  assert_non_null(e.split_plot.mixed);
  for (size_t i = 0; i < 3; i++) {
    const fg_split_plot_term *term = &e.split_plot.term[i];
    assert_string_equal(term->row.name, expected[i].term);
    assert_true(fabs(term->row.f / expected[i].f - 1) < 1e-6);
    assert_true(fabs(term->error_dof / expected[i].dof - 1) < 1e-6);
    assert_true(fabs(term->row.p_value / expected[i].p_value - 1) < 1e-5);
  }
  fg_experiment_free(&e);
}

/* The constant beside D^2, and predictions, have errors of both strata: by the strata they are
 * those of restricted likelihood. The constant had the whole plots' error alone, 28 % too wide. */
static void predictions_have_the_errors_of_both_strata(void **state) {
  (void)state;
  uint64_t seed = 3;
  char text[2048];
  size_t used = (size_t)snprintf(text, sizeof text, "T,D,load,y\n");
  for (int plot = 0; plot < PLOTS; plot++) {
    double shift = 2 * random_gaussian(&seed);
    for (int d = -1; d <= 1; d++)
      used +=
          (size_t)snprintf(text + used, sizeof text - used, "%d,%d,%d,%.6f\n", plot % 2 ? 1 : -1, d,
                           plot + 1, 20 + d + 3 * d * d + shift + random_gaussian(&seed));
  }
  fg_experiment e = analyse(text, "T*D + D^2");
  fg_levels plots;
  fg_mixed_model mixed;
  fg_prediction p;
  double row[8] = {0}, dof;
  const double setting[] = {0.2, -0.15};
  assert_null(e.split_plot.mixed);
  assert_false(e.split_plot.at_border);
  assert_ok(&test_context, fg_table_levels(&test_context, &e.table, "load", true, &plots));
  assert_ok(&test_context,
            fg_mixed_fit(&test_context, &e.model, &plots, &e.regression, false, &mixed));
  for (size_t j = 0; j < e.regression.columns; j++) {
    memset(row, 0, sizeof row);
    row[j] = 1;
    double u = sqrt(fg_mixed_variance(&mixed, row, false, &dof));
    assert_true(fabs(u / e.effect[j].standard_error - 1) < 1e-8);
    assert_true(fabs(dof - e.effect[j].dof) < 1e-5);
  }
  assert_true(e.effect[0].dof > (double)e.split_plot.plot_dof);
  assert_ok(&test_context, fg_experiment_predict(&test_context, &e, setting, &p));
  assert_ok(&test_context, fg_model_row(&test_context, &e.model, setting, row));
  assert_true(fabs(sqrt(fg_mixed_variance(&mixed, row, false, &dof)) / p.standard_error - 1) <
              1e-8);
  assert_true(fabs(dof - p.dof) < 1e-5);
  assert_true(fabs(sqrt(fg_mixed_variance(&mixed, row, true, &dof)) / p.run_standard_error - 1) <
              1e-8);
  assert_true(fabs(dof - p.run_dof) < 1e-5);
  fg_mixed_free(&mixed);
  fg_levels_free(&plots);
  fg_experiment_free(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(missing_runs_are_analysed_as_by_r),
      cmocka_unit_test(complete_plans_agree_with_the_strata),
      cmocka_unit_test(factors_within_plots_are_estimated_without_whole_plot_dof),
      cmocka_unit_test(terms_beside_words_are_tested_by_their_mean),
      cmocka_unit_test(predictions_have_the_errors_of_both_strata),
      cmocka_unit_test(odd_plans_are_analysed_or_say_why),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
