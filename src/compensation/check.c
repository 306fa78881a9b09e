/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lot against its prediction, and the law updated with it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <gsl/gsl_linalg.h>

#include "compensation/draws.h"
#include "compensation/expected.h"
#include "compensation/inputs.h"
#include "compensation/residual.h"
#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"

enum { REPORT_BYTES = 64 << 20, DISTANCE_DRAWS = 2000 };

/* Reads the target out of the report. */
static fg_status read_target(fg_context *ctx, const char *path, fg_expected_check *check) {
  char *text = NULL, *design = NULL;
  cJSON *root;
  FG_TRY(fg_file_read_text(ctx, path, REPORT_BYTES, &text));
  fg_sha256_text(text, check->sha256);
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/next_die/1") != 0)
    status = fg_fail(ctx, FG_ERR_DATA, "%s: no report of `foilgauge die --target -o`", path);
  else
    design = cJSON_PrintUnformatted(cJSON_GetObjectItemCaseSensitive(root, "target"));
  fg_design_default(&check->next.target);
  if (status == FG_OK)
    status = design ? fg_design_parse(ctx, path, design, &check->next.target)
                    : fg_fail(ctx, FG_ERR_DATA,
                              "%s: the member target is missing: write the report again with "
                              "`foilgauge die --target -o`",
                              path);
  cJSON_free(design);
  cJSON_Delete(root);
  return status == FG_OK ? fg_design_derive(ctx, &check->next.target, &check->next.nominal)
                         : status;
}

static size_t count_predicted_bumps(const fg_springback_law *law, const fg_design *target) {
  int highest = 0;
  if (!fg_foil_traits_of(target->kind)->has_bumps) return 0;
  if (target->bumps.count) return target->bumps.count;
  for (size_t i = 0; i < law->sets; i++)
    for (size_t k = 0; k < law->set[i].of[FG_FORMED_RADIUS].places; k++)
      if (law->set[i].of[FG_FORMED_RADIUS].place[k].number > highest)
        highest = law->set[i].of[FG_FORMED_RADIUS].place[k].number;
  return (size_t)highest;
}

/* Reads the prediction: sets, die, target; finds its law again. */
static fg_status read_prediction(fg_context *ctx, const char *path, fg_expected_check *check) {
  fg_next_die *next = &check->next;
  fg_formed_sets sets = {.count = 0};
  FG_TRY(read_target(ctx, path, check));
  fg_text_clip(check->path, sizeof check->path, "%s", path);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *next->law, (void **)&next->law));
  fg_status status = FG_OK;
  fg_die_origin origin;
  FG_TRY_EXIT(fg_prior_read(ctx, path, &sets));
  next->law->sets = sets.count;
  memcpy(next->law->set, sets.set, sets.count * sizeof *sets.set);
  check->bumps = count_predicted_bumps(next->law, &next->target);
  FG_TRY_EXIT(fg_die_dimensions_load(ctx, path, &next->target, check->bumps, &next->die, &origin));
  next->present = next->die;
  FG_TRY_EXIT(fg_formed_laws_find(ctx, check->bumps, next));
  memcpy(check->before, next->law->of, sizeof check->before);
exit:
  fg_formed_sets_free(&sets);
  return status;
}

/* ---- what the lot shows ---- */

/* Sums of the foils' values of one bump; scans of a foil are one foil. */
typedef struct bump_sums {
  double radius, angle, height, count;
} bump_sums;

static void sum_bumps(const fg_formed_sets *sets, const fg_die_dimensions *die, size_t bumps,
                      bump_sums *sums) {
  for (size_t f = 0; f < sets->foils; f++)
    for (size_t i = 0; i < bumps; i++) {
      const fg_formed_foil *foil = &sets->foil[f];
      double arc = foil->log_ratio[FG_FORMED_ARC_LENGTH][i],
             radius = foil->log_ratio[FG_FORMED_RADIUS][i];
      if (!isfinite(arc) || !isfinite(radius)) continue;
      sums[i].radius += die->bump[i].radius_mm * exp(radius);
      sums[i].angle += die->bump[i].bump_angle_deg * exp(arc - radius);
      sums[i].height += foil->height_mm[i];
      sums[i].count++;
    }
}

static void hold_value(const fg_expected_value *expected, double measured, fg_expected_check *check,
                       fg_expected_held *held) {
  *held = (fg_expected_held){.expected = expected->value,
                             .low = expected->low,
                             .high = expected->high,
                             .measured = measured};
  held->inside = measured >= held->low && measured <= held->high;
  if (!isfinite(measured)) return;
  check->of++;
  check->inside += held->inside;
}

static double formed_mean(const fg_formed_data *data) {
  return data->places ? data->place[0].die * exp(data->place[0].log_ratio) : NAN;
}

static void hold_values(const fg_formed_sets *sets, fg_expected_check *check) {
  const fg_formed_set *set = &sets->set[0];
  bump_sums sums[FG_COMPENSATION_BUMPS] = {{0}};
  const fg_expected_lot *expected = &check->next.expected;
  sum_bumps(sets, &check->next.die, check->bumps, sums);
  for (size_t i = 0; i < check->bumps; i++) {
    const bump_sums *sum = &sums[i];
    const fg_expected_bump *bump = &expected->bump[i];
    fg_expected_held_bump *held = &check->bump[i];
    held->number = (int)i + 1;
    hold_value(&bump->radius_mm, sum->radius / sum->count, check, &held->radius_mm);
    hold_value(&bump->bump_angle_deg, sum->angle / sum->count, check, &held->bump_angle_deg);
    hold_value(&bump->height_mm, sum->height / sum->count, check, &held->height_mm);
  }
  hold_value(&expected->overall_radius_mm, formed_mean(&set->of[FG_FORMED_OVERALL]), check,
             &check->overall_radius_mm);
  if (check->bumps)
    hold_value(&expected->pitch_deg, formed_mean(&set->of[FG_FORMED_PITCH]), check,
               &check->pitch_deg);
}

/* ---- all radii together ---- */

/* Logarithms of the lots' mean radii as drawn, with their moments. */
typedef struct radius_draws {
  size_t bumps;
  double log_radius[DISTANCE_DRAWS][FG_COMPENSATION_BUMPS];
  double mean[FG_COMPENSATION_BUMPS];
  double root[FG_COMPENSATION_BUMPS * FG_COMPENSATION_BUMPS];
} radius_draws;

static fg_status find_moments(fg_context *ctx, radius_draws *draws) {
  size_t n = draws->bumps;
  gsl_matrix_view root = gsl_matrix_view_array(draws->root, n, n);
  for (size_t d = 0; d < DISTANCE_DRAWS; d++)
    for (size_t i = 0; i < n; i++)
      draws->mean[i] += draws->log_radius[d][i] / DISTANCE_DRAWS;
  for (size_t d = 0; d < DISTANCE_DRAWS; d++)
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k < n; k++)
        draws->root[i * n + k] += (draws->log_radius[d][i] - draws->mean[i]) *
                                  (draws->log_radius[d][k] - draws->mean[k]) / DISTANCE_DRAWS;
  if (gsl_linalg_cholesky_decomp1(&root.matrix) == 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "the predicted radii have no spread");
}

/* Squared Mahalanobis distance, by the triangle. */
static double squared_distance(const radius_draws *draws, const double *log_radius) {
  double solved[FG_COMPENSATION_BUMPS], sum = 0;
  for (size_t i = 0; i < draws->bumps; i++) {
    double left = log_radius[i] - draws->mean[i];
    for (size_t k = 0; k < i; k++)
      left -= draws->root[i * draws->bumps + k] * solved[k];
    solved[i] = left / draws->root[i * draws->bumps + i];
    sum += solved[i] * solved[i];
  }
  return sum;
}

/* Share of drawn lots that are farther off than this one. The draws are a mixture with wide tails,
 * so they are their own distribution. */
static fg_status find_p_value(fg_context *ctx, fg_expected_check *check) {
  radius_draws *draws;
  fg_drawer drawer;
  double measured[FG_COMPENSATION_BUMPS];
  size_t farther = 0;
  check->p_value = NAN;
  for (size_t i = 0; i < check->bumps; i++) {
    measured[i] = log(check->bump[i].radius_mm.measured);
    if (!isfinite(measured[i])) return FG_OK;
  }
  if (!check->bumps) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *draws, (void **)&draws));
  draws->bumps = check->bumps;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_drawer_begin(ctx, check->next.laws, &check->next.die, NULL, &drawer));
  for (size_t d = 0; d < DISTANCE_DRAWS; d++) {
    fg_drawn_process process;
    fg_drawn_foil mean;
    fg_draw_process(&drawer, &process);
    fg_draw_mean(&drawer, &process, (double)check->foils, &mean);
    for (size_t i = 0; i < check->bumps; i++)
      draws->log_radius[d][i] = log(mean.radius_mm[i]);
  }
  fg_drawer_end(&drawer);
  FG_TRY_EXIT(find_moments(ctx, draws));
  double limit = squared_distance(draws, measured);
  for (size_t d = 0; d < DISTANCE_DRAWS; d++)
    farther += squared_distance(draws, draws->log_radius[d]) >= limit;
  check->p_value = (double)(farther + 1) / (DISTANCE_DRAWS + 1);
exit:
  free(draws);
  return status;
}

/* ---- the law goes on ---- */

static void fill_iteration(const fg_formed_set *set, const fg_design *target, bool bumps,
                           fg_iteration *iteration) {
  const fg_formed_data *data = &set->of[bumps ? FG_FORMED_RADIUS : FG_FORMED_OVERALL];
  double size = bumps ? target->bumps.radius_mm : target->overall_radius_mm, squares = 0;
  *iteration = (fg_iteration){.lot = set->lot, .foils = set->foils};
  for (size_t i = 0; i < data->places; i++) {
    double error = 100 * (data->place[i].die * exp(data->place[i].log_ratio) / size - 1);
    iteration->mean_error_pct += error / (double)data->places;
    iteration->springback_pct += 100 * data->place[i].log_ratio / (double)data->places;
    squares += error * error / (double)data->places;
  }
  iteration->rms_error_pct = sqrt(squares);
}

/* The posterior of the sets before, with these as well, is the posterior of all. */
static fg_status update_law(fg_context *ctx, const fg_formed_sets *sets, fg_expected_check *check) {
  fg_springback_law *law = check->next.law;
  size_t drop = law->sets + sets->count > FG_COMPENSATION_SETS
                    ? law->sets + sets->count - FG_COMPENSATION_SETS
                    : 0;
  memmove(law->set, law->set + drop, (law->sets - drop) * sizeof *law->set);
  law->sets -= drop;
  for (size_t i = 0; i < sets->count; i++)
    law->set[law->sets++] = sets->set[i];
  fg_formed_laws_free(check->next.laws);
  check->next.laws = NULL;
  FG_TRY(fg_formed_laws_find(ctx, check->bumps, &check->next));
  check->iterations = law->sets;
  for (size_t i = 0; i < law->sets; i++)
    fill_iteration(&law->set[i], &check->next.target, check->bumps > 0, &check->iteration[i]);
  return FG_OK;
}

/* The lot's foils are one set: they were all to come from the die of the report. */
static fg_status hold_lot(fg_context *ctx, const fg_formed_lot *lot, fg_expected_check *check) {
  fg_formed_sets sets = {.count = 0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(
      fg_compensation_check_lot(ctx, lot->folder, &lot->lot.settings.design, &check->next.target));
  for (size_t i = 0; i < check->next.law->sets; i++)
    if (!strcmp(check->next.law->set[i].scans_sha256, lot->scans_sha256))
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA,
                          "%s: the prediction rests on this lot, which cannot test it",
                          lot->folder));
  FG_TRY_EXIT(fg_formed_sets_add(ctx, lot, &check->next.die, FG_DIE_AS_CUT, check->bumps, &sets));
  check->foils = check->next.expected.foils = sets.set[0].foils;
  FG_TRY_EXIT(fg_expected_lot_find(ctx, NULL, &check->next));
  hold_values(&sets, check);
  FG_TRY_EXIT(find_p_value(ctx, check));
  FG_TRY_EXIT(update_law(ctx, &sets, check));
  FG_TRY_EXIT(fg_springback_loop(ctx, check));
exit:
  fg_formed_sets_free(&sets);
  return status;
}

fg_status fg_expected_check_file(fg_context *ctx, const char *path) {
  fg_expected_check check = {.path = ""};
  fg_status status = read_prediction(ctx, path, &check);
  fg_expected_check_free(&check);
  return status;
}

fg_status fg_expected_check_run(fg_context *ctx, const char *path, const char *folder,
                                fg_expected_check *check) {
  fg_formed_lot lot;
  *check = (fg_expected_check){.path = ""};
  fg_text_clip(check->folder, sizeof check->folder, "%s", folder);
  fg_status status = read_prediction(ctx, path, check);
  if (status == FG_OK) status = fg_formed_lot_read(ctx, folder, &lot);
  if (status == FG_OK) {
    status = hold_lot(ctx, &lot, check);
    fg_formed_lot_free(&lot);
  }
  if (status != FG_OK) fg_expected_check_free(check);
  return status;
}

void fg_expected_check_free(fg_expected_check *check) {
  fg_next_die_free(&check->next);
}
