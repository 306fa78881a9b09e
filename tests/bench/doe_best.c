/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coverage of the intervals at a best setting that the same runs chose. Writes a table in Markdown.
 * build/bench/doe_best [EXPERIMENTS] >reports/doe_best.md */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/distribution.h"
#include "foilgauge/experiment.h"
#include "support/random.h"

enum { FACTORS_MAX = 3, RUNS_MAX = 32, MODELS = 4, SDS = 4, GOALS = 2 };

static const char *const names[FACTORS_MAX] = {"a", "b", "c"};

/* Response 10 + sum of linear, quadratic and the first two factors' product. */
typedef struct truth {
  const char *words, *formula;
  size_t factors, centres;
  double linear[FACTORS_MAX], quadratic[FACTORS_MAX], product;
} truth;

static const truth truths[MODELS] = {
    {"composite, 2 factors, a bowl", "a*b + a^2 + b^2", 2, 5, {1, -0.5}, {0.8, 0.6}, 0.3},
    {"composite, 2 factors, a saddle", "a*b + a^2 + b^2", 2, 5, {0.5, 0}, {0.8, -0.6}, 0},
    {"composite, 3 factors, a bowl",
     "a*b + a*c + b*c + a^2 + b^2 + c^2",
     3,
     6,
     {1, -0.5, 0.7},
     {0.8, 0.6, 0.5},
     0.3},
    {"factorial with centre runs, 3 factors", "a*b + a*c + b*c", 3, 4, {1, -0.5, 0.7}, {0}, 0.3},
};

static double response(const truth *t, const double *x) {
  double y = 10 + t->product * x[0] * x[1];
  for (size_t k = 0; k < t->factors; k++)
    y += t->linear[k] * x[k] + t->quadratic[k] * x[k] * x[k];
  return y;
}

static size_t make_runs(const truth *t, double run[RUNS_MAX][FACTORS_MAX]) {
  size_t corners = (size_t)1 << t->factors, count = 0;
  double axial = t->quadratic[0] > 0 ? pow((double)corners, 0.25) : 0;
  memset(run, 0, RUNS_MAX * sizeof *run);
  for (size_t corner = 0; corner < corners; corner++, count++)
    for (size_t k = 0; k < t->factors; k++)
      run[count][k] = corner >> k & 1 ? 1 : -1;
  for (size_t k = 0; axial > 0 && k < t->factors; k++)
    for (int side = -1; side <= 1; side += 2)
      run[count++][k] = side * axial;
  return count + t->centres;
}

/* The response there; of factors that the best setting leaves open, the mean over the runs. */
static double response_at(const truth *t, double run[RUNS_MAX][FACTORS_MAX], size_t runs,
                          const fg_experiment *e, const fg_optimum *best) {
  double sum = 0;
  for (size_t i = 0; i < runs; i++) {
    double x[FACTORS_MAX];
    memcpy(x, run[i], sizeof x);
    for (size_t k = 0; k < t->factors; k++)
      for (size_t f = 0; f < e->surface.factors; f++)
        if (!strcmp(fg_surface_factor(e, f)->name, names[k])) x[k] = best->x[f];
    sum += response(t, x);
  }
  return sum / (double)runs;
}

typedef struct tally {
  size_t asked, none, reduced, student, held, run;
  double factor;
} tally;

static void score(const truth *t, double run[RUNS_MAX][FACTORS_MAX], size_t runs, double sd,
                  const fg_experiment *whole, uint64_t *seed, tally *out) {
  const fg_experiment *e = fg_experiment_best(whole);
  const fg_prediction *p = &e->best.optimum.prediction;
  double mean = response_at(t, run, runs, e, &e->best.optimum);
  double student = fg_distribution_t_quantile(0.975, p->dof) * p->standard_error;
  out->none += whole->idle.all;
  if (whole->idle.all) return;
  out->asked++;
  out->reduced += e != whole;
  out->student += fabs(p->mean - mean) <= student;
  out->held += p->low <= mean && mean <= p->high;
  double one = mean + sd * random_gaussian(seed);
  out->run += p->run_low <= one && one <= p->run_high;
  out->factor += (p->high - p->mean) / p->standard_error;
}

static void experiment(const truth *t, double sd, fg_goal goal, uint64_t *seed, tally *out) {
  const fg_coding coding[] = {{.name = "a", .low = {-1, 0}, .high = {1, 0}},
                              {.name = "b", .low = {-1, 0}, .high = {1, 0}},
                              {.name = "c", .low = {-1, 0}, .high = {1, 0}}};
  const fg_experiment_options options = {.response = "y",
                                         .formula = t->formula,
                                         .coding = coding,
                                         .codings = t->factors,
                                         .goal = goal,
                                         .target = 10.5};
  double run[RUNS_MAX][FACTORS_MAX];
  char text[4096];
  size_t runs = make_runs(t, run),
         used = (size_t)snprintf(text, sizeof text, "a,b%s,y\n", t->factors > 2 ? ",c" : "");
  for (size_t i = 0; i < runs; i++) {
    for (size_t k = 0; k < t->factors; k++)
      used += (size_t)snprintf(text + used, sizeof text - used, "%.12g,", run[i][k]);
    used += (size_t)snprintf(text + used, sizeof text - used, "%.9f\n",
                             response(t, run[i]) + sd * random_gaussian(seed));
  }
  fg_context ctx = {0};
  fg_table table = {0};
  fg_experiment e;
  if (fg_table_parse(&ctx, "runs", text, strlen(text), &table) == FG_OK &&
      fg_experiment_analyse(&ctx, &table, &options, &e) == FG_OK) {
    score(t, run, runs, sd, &e, seed, out);
    fg_experiment_free(&e);
  } else {
    fprintf(stderr, "%s\n", ctx.message);
  }
  fg_table_free(&table);
}

static double percent(size_t part, size_t all) {
  return all ? 100 * (double)part / (double)all : NAN;
}

int main(int count, char **words) {
  static const double sds[SDS] = {0.1, 0.3, 1, 2};
  static const fg_goal goals[GOALS] = {FG_GOAL_LOWEST, FG_GOAL_TARGET};
  size_t experiments = count > 1 ? strtoul(words[1], NULL, 10) : 1000;
  printf(
      "# The best setting's intervals\n\n`build/bench/doe_best %zu >reports/doe_best.md`: made-up "
      "experiments with known truth, whose runs scatter with the standard deviation given. How "
      "often 95 %% intervals at the best setting, that the same runs chose, hold the truth, "
      "%%: Student's interval of one setting, the interval that is reported (it holds for every "
      "setting of the region at once), and the reported interval of one new run. Effects are "
      "0.3 to 1. Where a factor is not told from the scatter, the truth is the mean over its "
      "values in the runs; where none is, no best setting is named.\n\n| experiment | goal | "
      "sd | Student's | reported | one new run | coverage factor | best settings named | of "
      "these without a factor |\n|---|---|---|---|---|---|---|---|---|\n",
      experiments);
  for (size_t m = 0; m < MODELS; m++)
    for (size_t g = 0; g < GOALS; g++)
      for (size_t s = 0; s < SDS; s++) {
        tally t = {0};
        uint64_t seed = 1000 * m + 100 * g + s + 1;
        for (size_t i = 0; i < experiments; i++)
          experiment(&truths[m], sds[s], goals[g], &seed, &t);
        printf("| %s | %s | %.1f | %.1f | %.1f | %.1f | %.2f | %zu | %zu |\n", truths[m].words,
               g ? "10.5" : "lowest", sds[s], percent(t.student, t.asked), percent(t.held, t.asked),
               percent(t.run, t.asked), t.factor / (double)t.asked, t.asked, t.reduced);
        fflush(stdout);
      }
  return 0;
}
