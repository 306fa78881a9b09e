/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random levels in the loop on tables: a column of many words is tested by one variance, and once
 * found it groups the rows. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/random.h"
#include "support/test.h"

enum { WAFERS = 12, PLACES = 4, ROWS = WAFERS * PLACES, BATCHES = 3 };

typedef struct outcome {
  fg_context ctx;
  fg_table table;
  fg_loop_table_problem problem;
  fg_loop_result result;
} outcome;

typedef struct wafer_rows {
  double heat[ROWS], y[ROWS];
  size_t wafer[ROWS];
} wafer_rows;

/* Rows of a wafer are not neighbours, and have one heat. Wafers lie in batches that are alike:
 * their levels within batches are no interaction. */
static wafer_rows make_rows(double level_sd, uint64_t seed) {
  wafer_rows rows;
  double level[WAFERS], heat[WAFERS];
  for (size_t w = 0; w < WAFERS; w++) {
    level[w] = level_sd * random_gaussian(&seed);
    heat[w] = (double)(w * 7 % WAFERS) + 0.5 * random_uniform(&seed);
  }
  for (size_t i = 0; i < ROWS; i++) {
    size_t w = i * 5 % WAFERS;
    rows.wafer[i] = w;
    rows.heat[i] = heat[w];
    rows.y[i] = 0.02 * (3 + 0.1 * heat[w] + level[w] + 0.5 * random_gaussian(&seed));
  }
  return rows;
}

static void search(const wafer_rows *rows, const char *model, outcome *out) {
  static char names[ROWS][8], batches[ROWS][8];
  const char *name[ROWS], *batch[ROWS];
  const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
  const fg_loop_table_spec spec = {.response = "y", .model = model, .seed = 1};
  *out = (outcome){0};
  for (size_t i = 0; i < ROWS; i++) {
    snprintf(names[i], sizeof names[i], "W%zu", rows->wafer[i] + 1);
    snprintf(batches[i], sizeof batches[i], "B%zu", rows->wafer[i] % BATCHES + 1);
    name[i] = names[i];
    batch[i] = batches[i];
  }
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "heat", rows->heat, ROWS));
  assert_ok(&out->ctx, fg_table_add_words(&out->ctx, &out->table, "batch", batch, ROWS));
  assert_ok(&out->ctx, fg_table_add_words(&out->ctx, &out->table, "wafer", name, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "y", rows->y, ROWS));
  assert_ok(&out->ctx, fg_loop_table_problem_build(&out->ctx, &out->table, &spec, &out->problem));
  assert_ok(&out->ctx, fg_loop_run(&out->ctx, &out->problem.problem, &options, &out->result));
}

static void clear(outcome *out) {
  fg_loop_result_free(&out->result);
  fg_loop_table_problem_free(&out->problem);
  fg_table_free(&out->table);
}

/* Mean squares of the rows within wafers, and between them beside a slope over heat, in rows; the
 * heats' sum of squares over the rows. */
typedef struct strata {
  double within, between, heats;
} strata;

static strata find_strata(const wafer_rows *rows) {
  double mean[WAFERS] = {0}, heat[WAFERS], all = 0, middle = 0, cross = 0, squares = 0;
  strata found = {0};
  for (size_t i = 0; i < ROWS; i++) {
    mean[rows->wafer[i]] += rows->y[i] / PLACES;
    heat[rows->wafer[i]] = rows->heat[i];
    all += rows->y[i] / ROWS;
    middle += rows->heat[i] / ROWS;
  }
  for (size_t i = 0; i < ROWS; i++)
    found.within += pow(rows->y[i] - mean[rows->wafer[i]], 2) / (ROWS - WAFERS);
  for (size_t w = 0; w < WAFERS; w++) {
    cross += (heat[w] - middle) * (mean[w] - all);
    squares += pow(heat[w] - middle, 2);
  }
  for (size_t w = 0; w < WAFERS; w++)
    found.between +=
        PLACES * pow(mean[w] - all - cross / squares * (heat[w] - middle), 2) / (WAFERS - 2);
  found.heats = PLACES * squares;
  return found;
}

/* In wafers of as many rows restricted likelihood is the analysis of variance. */
static void levels_have_their_variance_and_the_slope_their_stratum(void **state) {
  outcome out;
  (void)state;
  wafer_rows rows = make_rows(1.5, 7);
  strata exact = find_strata(&rows);
  search(&rows, "1 + heat", &out);
  assert_int_equal(out.result.claims, 1);
  const fg_loop_claim *claim = &out.result.claim[0];
  double sd = sqrt((exact.between - exact.within) / PLACES);
  assert_string_equal(claim->name, "table.random_levels(wafer)");
  assert_near(claim->noise_value, sd, 0.01 * sd);
  assert_near(claim->amplitude, sd, 0.01 * sd);
  assert_true(claim->interval[0] < sd && claim->interval[1] > sd);
  double u = sqrt(exact.between / exact.heats);
  assert_near(out.result.parameter_u[1], u, 0.01 * u);
  assert_true(out.result.notes > 0);
  assert_has(out.result.note[0], "Before the levels of wafer were found");
  assert_has(out.result.note[0], "had a standard uncertainty of");
  assert_near(out.result.noise.lambda, sd * sd / exact.within, 0.02 * sd * sd / exact.within);
  clear(&out);
}

/* The column that is constant in wafers is tested between them: over rows alone, which repeat every
 * wafer's level, it would be claimed in most of such tables. */
static void what_is_constant_in_a_level_is_tested_between_levels(void **state) {
  enum { TABLES = 12 };
  size_t claimed = 0;
  (void)state;
  for (uint64_t seed = 0; seed < TABLES; seed++) {
    outcome out;
    wafer_rows rows = make_rows(1.5, 100 + seed);
    search(&rows, "1", &out);
    for (size_t m = 0; m < out.result.claims; m++)
      claimed += strstr(out.result.claim[m].name, "heat") != NULL;
    clear(&out);
  }
  assert_true(claimed <= 1);
}

static void levels_that_are_alike_are_no_finding(void **state) {
  outcome out;
  (void)state;
  wafer_rows rows = make_rows(0, 9);
  search(&rows, "1 + heat", &out);
  assert_int_equal(out.result.claims, 0);
  clear(&out);
}

/* ---- two strata ---- */

enum { OUTER = 10, CASKS = 3, SAMPLES = 2, NESTED = OUTER * CASKS * SAMPLES };

typedef struct nested_rows {
  double heat[NESTED], y[NESTED];
  char batch[NESTED][8], cask[NESTED][12];
} nested_rows;

/* Samples of casks of batches; the heat is one of a batch. */
static nested_rows make_nested(double batch_sd, double cask_sd, uint64_t seed) {
  nested_rows rows;
  size_t i = 0;
  for (size_t b = 0; b < OUTER; b++) {
    double of_batch = batch_sd * random_gaussian(&seed), heat = random_uniform(&seed);
    for (size_t c = 0; c < CASKS; c++) {
      double of_cask = cask_sd * random_gaussian(&seed);
      for (size_t s = 0; s < SAMPLES; s++, i++) {
        snprintf(rows.batch[i], sizeof rows.batch[i], "B%zu", b + 1);
        snprintf(rows.cask[i], sizeof rows.cask[i], "B%zuC%zu", b + 1, c + 1);
        rows.heat[i] = heat;
        rows.y[i] = 7 + heat + of_batch + of_cask + random_gaussian(&seed);
      }
    }
  }
  return rows;
}

static void search_nested(const nested_rows *rows, const char *group, outcome *out) {
  const char *batch[NESTED], *cask[NESTED];
  const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
  const fg_loop_table_spec spec = {.response = "y", .model = "1 + heat", .group = group, .seed = 1};
  *out = (outcome){0};
  for (size_t i = 0; i < NESTED; i++) {
    batch[i] = rows->batch[i];
    cask[i] = rows->cask[i];
  }
  assert_ok(&out->ctx, fg_table_add_words(&out->ctx, &out->table, "batch", batch, NESTED));
  assert_ok(&out->ctx, fg_table_add_words(&out->ctx, &out->table, "cask", cask, NESTED));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "heat", rows->heat, NESTED));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "y", rows->y, NESTED));
  assert_ok(&out->ctx, fg_loop_table_problem_build(&out->ctx, &out->table, &spec, &out->problem));
  assert_ok(&out->ctx, fg_loop_run(&out->ctx, &out->problem.problem, &options, &out->result));
}

/* Variances of batches beside the slope over heat, of casks within them, and of samples, by the
 * analysis of variance; u of the slope. */
typedef struct nested_truth {
  double batch, cask, sample, slope_u;
} nested_truth;

static nested_truth analyse(const nested_rows *rows) {
  enum { OF_BATCH = CASKS * SAMPLES };
  double batch[OUTER] = {0}, all = 0, middle = 0, cross = 0, squares = 0, within = 0, between = 0,
         batches = 0;
  for (size_t i = 0; i < NESTED; i++) {
    batch[i / OF_BATCH] += rows->y[i] / OF_BATCH;
    all += rows->y[i] / NESTED;
    middle += rows->heat[i] / NESTED;
  }
  for (size_t i = 0; i < NESTED; i += SAMPLES) {
    double mean = (rows->y[i] + rows->y[i + 1]) / 2;
    within += pow(rows->y[i] - rows->y[i + 1], 2) / 2 / (OUTER * CASKS);
    between += SAMPLES * pow(mean - batch[i / OF_BATCH], 2) / (OUTER * (CASKS - 1));
  }
  for (size_t b = 0; b < OUTER; b++) {
    double heat = rows->heat[b * OF_BATCH] - middle;
    cross += heat * (batch[b] - all);
    squares += heat * heat;
  }
  for (size_t b = 0; b < OUTER; b++) {
    double heat = rows->heat[b * OF_BATCH] - middle;
    batches += OF_BATCH * pow(batch[b] - all - cross / squares * heat, 2) / (OUTER - 2);
  }
  return (nested_truth){(batches - between) / OF_BATCH, (between - within) / SAMPLES, within,
                        sqrt(batches / OF_BATCH / squares)};
}

static const fg_loop_claim *claim_named(const fg_loop_result *result, const char *name) {
  for (size_t m = 0; m < result->claims; m++)
    if (!strcmp(result->claim[m].name, name)) return &result->claim[m];
  return NULL;
}

/* In equal numbers restricted likelihood is the analysis of variance, with two strata as well. */
static void casks_in_batches_have_a_variance_each(void **state) {
  outcome out;
  (void)state;
  nested_rows rows = make_nested(3, 2, 5);
  nested_truth exact = analyse(&rows);
  search_nested(&rows, NULL, &out);
  assert_int_equal(out.result.claims, 2);
  const fg_loop_claim *batch = claim_named(&out.result, "table.random_levels(batch)");
  const fg_loop_claim *cask = claim_named(&out.result, "table.random_levels(cask)");
  assert_non_null(batch);
  assert_non_null(cask);
  assert_near(batch->noise_value, sqrt(exact.batch), 0.01 * sqrt(exact.batch));
  assert_near(cask->noise_value, sqrt(exact.cask), 0.01 * sqrt(exact.cask));
  assert_true(batch->interval[0] < 3 && batch->interval[1] > 3);
  assert_true(cask->interval[0] < 2 && cask->interval[1] > 2);
  assert_near(out.result.parameter_u[1], exact.slope_u, 0.01 * exact.slope_u);
  assert_has(out.result.note[0], "cask within batch: of the variance that is left");
  clear(&out);
}

/* The same where the casks were declared as groups, and the batches were not. */
static void batches_are_found_beside_declared_groups(void **state) {
  outcome out;
  (void)state;
  nested_rows rows = make_nested(3, 2, 5);
  nested_truth exact = analyse(&rows);
  search_nested(&rows, "cask", &out);
  assert_int_equal(out.result.claims, 1);
  const fg_loop_claim *batch = claim_named(&out.result, "table.random_levels(batch)");
  assert_non_null(batch);
  assert_near(batch->noise_value, sqrt(exact.batch), 0.01 * sqrt(exact.batch));
  assert_near(out.result.parameter_u[1], exact.slope_u, 0.01 * exact.slope_u);
  assert_has(out.result.note[0], "groups within batch");
  clear(&out);
}

/* Casks that scatter give batches' means a scatter of their own, which is no finding. */
static void batches_that_are_alike_are_no_finding(void **state) {
  enum { TABLES = 3 };
  size_t claimed = 0, casks = 0;
  (void)state;
  for (uint64_t seed = 0; seed < TABLES; seed++) {
    outcome out;
    nested_rows rows = make_nested(0, 3, 40 + seed);
    search_nested(&rows, NULL, &out);
    claimed += claim_named(&out.result, "table.random_levels(batch)") != NULL;
    casks += claim_named(&out.result, "table.random_levels(cask)") != NULL;
    clear(&out);
  }
  assert_int_equal(claimed, 0);
  assert_int_equal(casks, TABLES);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(levels_have_their_variance_and_the_slope_their_stratum),
      cmocka_unit_test(what_is_constant_in_a_level_is_tested_between_levels),
      cmocka_unit_test(levels_that_are_alike_are_no_finding),
      cmocka_unit_test(casks_in_batches_have_a_variance_each),
      cmocka_unit_test(batches_are_found_beside_declared_groups),
      cmocka_unit_test(batches_that_are_alike_are_no_finding),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
