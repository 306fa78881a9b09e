/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wrong rows against heavy tails: how often the loop on tables calls a row wrong (p below 0.01 over
 * everything, and below 0.1) in tables without one, by the noise's tail, and how often it calls the
 * wrong one in normal noise. The constants of table_loop/outlier.c and tails.c are chosen by it.
 *
 *   loop_rows [TABLES] [SEED] */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/splitmix.h"
#include "table_loop/assess.h"
#include "table_loop/engine.h"

enum { ROWS_MAX = 400, SIZES = 5 };

static const size_t row_counts[SIZES] = {16, 24, 48, 126, 200};
/* Dof of Student's t; 0: normal, -1: Laplace's. */
static const int tails[] = {0, -1, 10, 6, 4, 3};
static const char *const tail_words[] = {"normal", "Laplace", "t10", "t6", "t4", "t3"};

static double draw(int tail, uint64_t *seed) {
  double normal = fg_splitmix_normal(seed), squares = 0;
  if (tail == 0) return normal;
  if (tail < 0) {
    double u = fg_splitmix_uniform(seed) - 0.5;
    return copysign(log1p(-2 * fabs(u)), u);
  }
  for (int k = 0; k < tail; k++) {
    double other = fg_splitmix_normal(seed);
    squares += other * other;
  }
  return normal / sqrt(squares / tail);
}

/* A constant and a slope are declared; the wrong row, number `wrong`, is `size` standard errors of
 * its own amplitude away. */
static fg_engine_outlier assess(size_t n, int tail, size_t wrong, double size, uint64_t *seed) {
  static double y[ROWS_MAX], x[2 * ROWS_MAX];
  static size_t group[ROWS_MAX], series[ROWS_MAX];
  fg_context ctx = {0};
  for (size_t i = 0; i < n; i++) {
    y[i] = draw(tail, seed);
    x[i] = 1;
    x[n + i] = (double)i / (double)n;
    group[i] = i;
  }
  fg_loop_problem problem = {.rows = n,
                             .parameters = 2,
                             .residual = y,
                             .response = y,
                             .jacobian = x,
                             .group = group,
                             .groups = n,
                             .series = series,
                             .exchangeable = true};
  fg_engine_training training;
  fg_engine_span span;
  fg_engine_outlier outlier;
  const fg_engine_level level = {0.01, 0.2};
  if (fg_engine_training_build(&ctx, &problem, NULL, NULL, &training) != FG_OK) exit(1);
  if (fg_engine_span_open(&ctx, &training, (fg_engine_noise){0}, 0, &span) != FG_OK) exit(1);
  training.y[wrong] += size / sqrt(span.kept[wrong]);
  if (fg_engine_assess_outlier(&ctx, &training, (fg_engine_noise){0}, &span, level, &outlier) !=
      FG_OK)
    exit(1);
  fg_engine_span_close(&span);
  fg_engine_training_free(&training);
  return outlier;
}

int main(int argc, char **argv) {
  size_t tables = argc > 1 ? strtoul(argv[1], NULL, 10) : 2000;
  uint64_t seed = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
  printf(
      "# Wrong rows and heavy tails in the loop on tables\n\n"
      "How often a row is called wrong (p < 0.01 over everything) or suspected (p < 0.1) in tables "
      "without a wrong one, by the tail of their noise, and how often the wrong one is found in "
      "normal noise; %zu tables each, a constant and a slope declared. The constants of the test "
      "are chosen by it: with t of 3 or 4 dof about 2 in 100 are called wrong.\n\n"
      "    build/bench/loop_rows %zu %" PRIu64 " >reports/loop_rows.md\n\n",
      tables, tables, seed);
  printf("| rows | noise | p < 0.01 | p < 0.1 |\n|---|---|---|---|\n");
  for (size_t s = 0; s < SIZES; s++)
    for (size_t k = 0; k < sizeof tails / sizeof *tails; k++) {
      size_t claimed = 0, suspected = 0;
      for (size_t t = 0; t < tables; t++) {
        fg_engine_outlier found = assess(row_counts[s], tails[k], 0, 0, &seed);
        claimed += found.p_value < 0.01;
        suspected += found.p_value < 0.1;
      }
      printf("| %zu | %s | %.2f %% | %.1f %% |\n", row_counts[s], tail_words[k],
             100.0 * (double)claimed / (double)tables, 100.0 * (double)suspected / (double)tables);
    }
  printf("\nA size is in standard errors of the wrong row's amplitude.\n\n"
         "| rows | size | found, p < 0.01 | p < 0.1 |\n|---|---|---|---|\n");
  for (size_t s = 0; s < SIZES; s++)
    for (double size = 6; size <= 10; size += 2) {
      size_t found = 0, suspected = 0;
      for (size_t t = 0; t < tables; t++) {
        size_t wrong = (size_t)(fg_splitmix_uniform(&seed) * (double)row_counts[s]);
        fg_engine_outlier outlier = assess(row_counts[s], 0, wrong, size, &seed);
        bool right = outlier.candidate.rows == 1 && outlier.candidate.row[0] == wrong;
        found += right && outlier.p_value < 0.01;
        suspected += right && outlier.p_value < 0.1;
      }
      printf("| %zu | %.0f | %.1f %% | %.1f %% |\n", row_counts[s], size,
             100.0 * (double)found / (double)tables, 100.0 * (double)suspected / (double)tables);
    }
  return 0;
}
