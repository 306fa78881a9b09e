/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coverage of a split plot's intervals when runs are missing. Writes a table in
 * Markdown. build/bench/split_plots [PLANS] >reports/split_plots.md */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/experiment.h"
#include "support/random.h"

enum { PLOTS = 8, PER_PLOT = 4, RUNS = PLOTS * PER_PLOT, MISSING_MAX = 8, EFFECTS = 6 };

/* 20 + 3 T + 2 D - P + 0.5 T D + 0 T P; T is the whole plots'. */
static const double truth[EFFECTS] = {20, 3, 2, -1, 0.5, 0};
static const char *const model = "T + D + P + T:D + T:P";

typedef struct tally {
  size_t held[2], asked[2]; /* within plots, of whole plots */
  size_t prediction, runs, border, failed;
} tally;

static void write_plan(double plot_sd, size_t missing, uint64_t *seed, char *text, size_t size) {
  bool gone[RUNS] = {false};
  size_t used = (size_t)snprintf(text, size, "T,D,P,load,y\n");
  for (size_t left = missing; left;) {
    size_t i = (size_t)(random_uniform(seed) * RUNS);
    left -= !gone[i];
    gone[i] = true;
  }
  for (int plot = 0; plot < PLOTS; plot++) {
    double shift = plot_sd * random_gaussian(seed);
    for (int run = 0; run < PER_PLOT; run++) {
      double t = plot % 2 ? 1 : -1, d = run % 2 ? 1 : -1, p = run / 2 ? 1 : -1;
      double y = truth[0] + truth[1] * t + truth[2] * d + truth[3] * p + truth[4] * t * d +
                 truth[5] * t * p + shift + random_gaussian(seed);
      if (gone[plot * PER_PLOT + run]) continue;
      used +=
          (size_t)snprintf(text + used, size - used, "%g,%g,%g,%d,%.6f\n", t, d, p, plot + 1, y);
    }
  }
}

static bool holds(double low, double high, double value) {
  return low <= value && value <= high;
}

static void score(const fg_experiment *e, double plot_sd, uint64_t *seed, tally *t) {
  static const char *const name[EFFECTS] = {"(constant)", "T", "D", "P", "T:D", "T:P"};
  double setting[FG_FORMULA_VARIABLES] = {1, 1, 1}, mean = 0;
  fg_prediction p;
  for (size_t k = 0; k < EFFECTS; k++) {
    mean += truth[k];
    for (size_t j = 0; j < e->regression.columns; j++) {
      if (strcmp(e->regression.coefficient[j].name, name[k]) != 0) continue;
      bool whole = k < 2;
      t->asked[whole]++;
      t->held[whole] += holds(e->effect[j].low, e->effect[j].high, truth[k]);
    }
  }
  if (fg_experiment_predict(NULL, e, setting, &p) != FG_OK) return;
  t->prediction += holds(p.low, p.high, mean);
  t->runs +=
      holds(p.run_low, p.run_high, mean + plot_sd * random_gaussian(seed) + random_gaussian(seed));
  t->border += e->split_plot.plot_variance <= 0;
}

static tally run(double plot_sd, size_t missing, size_t plans, uint64_t seed) {
  tally t = {0};
  char text[4096];
  for (size_t i = 0; i < plans; i++) {
    fg_context ctx = {0};
    fg_table table = {0};
    fg_experiment e;
    const fg_experiment_options options = {.response = "y", .formula = model, .whole_plot = "load"};
    write_plan(plot_sd, missing, &seed, text, sizeof text);
    if (fg_table_parse(&ctx, "plan", text, strlen(text), &table) != FG_OK ||
        fg_experiment_analyse(&ctx, &table, &options, &e) != FG_OK) {
      t.failed++;
      fprintf(stderr, "%s\n", ctx.message);
    } else {
      score(&e, plot_sd, &seed, &t);
      fg_experiment_free(&e);
    }
    fg_table_free(&table);
  }
  return t;
}

static double percent(size_t part, size_t all) {
  return 100 * (double)part / (double)all;
}

int main(int count, char **words) {
  static const double sds[] = {0, 0.5, 1, 2};
  size_t plans = count > 1 ? strtoul(words[1], NULL, 10) : 3000;
  printf(
      "# Split plots with missing runs\n\n`build/bench/split_plots %zu >reports/split_plots.md`: "
      "%d "
      "whole plots of %d runs, T set once for each, D and P within; runs missing at random; the "
      "runs scatter with a standard deviation of 1. How often 95 %% intervals hold the truth, "
      "%%.\n\n| sd of whole plots | runs missing | effects within (D, P, T:D, T:P) | of whole "
      "plots (T, constant) | expected response | one new run | variance of whole plots estimated "
      "as 0 |\n|---|---|---|---|---|---|---|\n",
      plans, PLOTS, PER_PLOT);
  for (size_t s = 0; s < sizeof sds / sizeof *sds; s++)
    for (size_t missing = 0; missing <= MISSING_MAX; missing++) {
      tally t = run(sds[s], missing, plans, 1000 * s + missing + 1);
      printf("| %.1f | %zu | %.1f | %.1f | %.1f | %.1f | %.1f |\n", sds[s], missing,
             percent(t.held[0], t.asked[0]), percent(t.held[1], t.asked[1]),
             percent(t.prediction, plans), percent(t.runs, plans), percent(t.border, plans));
      if (t.failed) printf("\n%zu plans could not be analysed\n", t.failed);
      fflush(stdout);
    }
  return 0;
}
