/* SPDX-License-Identifier: GPL-3.0-or-later */
/* After the search: errors before and after, confirmation, parameters, the curve, the verdict. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "core/spread.h"
#include "core/text.h"
#include "table_loop/grid.h"
#include "table_loop/influence.h"
#include "table_loop/response_scale.h"
#include "table_loop/run.h"

/* Upper limit of the reported noise floor, as a multiple of the rows' rms: strong correlation makes
 * the sd of a row larger than the scatter that these rows show. */
#define FLOOR_OVER_RMS 1.25

static fg_status measure_error(fg_context *ctx, const fg_engine_run *run, const double *residual,
                               fg_loop_error *error) {
  size_t count = 0, rows = run->problem->rows, held = 0;
  double *size = NULL, squares = 0, held_squares = 0;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *size, (void **)&size));
  for (size_t i = 0; i < rows; i++) {
    if (run->train[i]) {
      size[count++] = fabs(residual[i]);
      squares += residual[i] * residual[i];
    } else {
      held++;
      held_squares += residual[i] * residual[i];
    }
  }
  fg_spread spread = fg_spread_of(size, count);
  error->rms = sqrt(squares / (double)count);
  error->robust_sd = spread.robust_sd;
  error->p95 = spread.p95;
  error->maximum = spread.maximum;
  error->held_out_rms = held ? sqrt(held_squares / (double)held) : NAN;
  free(size);
  return FG_OK;
}

static fg_status cross_validated(fg_context *ctx, const fg_engine_run *run,
                                 const fg_engine_set *set, fg_engine_noise noise, double *rms) {
  double *residual = NULL, squares = 0;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, run->problem->rows, sizeof *residual, (void **)&residual));
  fg_status status = fg_engine_cross_validate(ctx, run->problem, run->train, set, noise, residual);
  for (size_t i = 0; i < run->problem->rows; i++)
    count += run->train[i];
  for (size_t i = 0; i < count; i++)
    squares += residual[i] * residual[i];
  *rms = sqrt(squares / (double)count);
  free(residual);
  return status;
}

/* Number of groups above which neighbouring groups are joined: as good, and a thousand draws of a
 * hundred thousand groups would cost as much as the search. */
enum { DRAWN_MAX = 5000 };

/* Sums neighbouring groups so that at most DRAWN_MAX are left; returns their number. */
static size_t join_groups(size_t count, size_t *group, double *sum) {
  size_t together = (count + DRAWN_MAX - 1) / DRAWN_MAX, joined = 0;
  for (size_t i = 0; together > 1 && i < count; i++) {
    if (i % together == 0) {
      group[joined++] = group[i];
      continue;
    }
    for (size_t k = 0; k < 2; k++)
      sum[2 * group[joined - 1] + k] += sum[2 * group[i] + k];
  }
  return together > 1 ? joined : count;
}

/* Computes the 95 % interval of after / before: groups drawn with replacement, held-out ones if
 * there are enough of them, else all others. */
static fg_status bootstrap(fg_context *ctx, fg_engine_run *run, double interval[2]) {
  enum { DRAWS = 999, ENOUGH = 8 };
  const fg_loop_problem *problem = run->problem;
  const fg_loop_result *result = run->result;
  uint64_t seed = run->options.seed ^ 0xb0075;
  double *sum = NULL, ratio[DRAWS];
  size_t *group = NULL, count = 0, held = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->groups, 2 * sizeof *sum, (void **)&sum));
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->groups, sizeof *group, (void **)&group));
  for (size_t i = 0; i < problem->rows; i++)
    if (!run->train[i] && (i == 0 || problem->group[i] != problem->group[i - 1])) held++;
  for (size_t i = 0; i < problem->rows; i++) {
    if (run->train[i] == (held >= ENOUGH)) continue;
    if (count == 0 || group[count - 1] != problem->group[i]) group[count++] = problem->group[i];
    sum[2 * problem->group[i]] += result->before_fit[i] * result->before_fit[i];
    sum[2 * problem->group[i] + 1] += result->after_fit[i] * result->after_fit[i];
  }
  count = join_groups(count, group, sum);
  for (size_t b = 0; b < DRAWS; b++) {
    double before = 0, after = 0;
    for (size_t i = 0; i < count; i++) {
      size_t g = group[(size_t)(fg_splitmix_uniform(&seed) * (double)count)];
      before += sum[2 * g];
      after += sum[2 * g + 1];
    }
    ratio[b] = before > 0 ? sqrt(after / before) : 1;
  }
  fg_sort(ratio, DRAWS);
  interval[0] = ratio[DRAWS * 25 / 1000];
  interval[1] = ratio[DRAWS * 975 / 1000];
exit:
  free(sum);
  free(group);
  return status;
}

/* Returns +1 when the held-out error falls by more than one standard error of the change
 * (confirmed), -2 when it rises by more than two (contradicted), -1 when no row is held out, else
 * 0. */
static int confirm_held_out(const fg_engine_run *run) {
  const fg_loop_problem *problem = run->problem;
  const double *before = run->result->before_fit, *after = run->result->after_fit;
  double sum = 0, squares = 0, group_sum = 0;
  size_t groups = 0;
  for (size_t i = 0; i < problem->rows; i++) {
    if (run->train[i]) continue;
    group_sum += before[i] * before[i] - after[i] * after[i];
    if (i + 1 < problem->rows && problem->group[i + 1] == problem->group[i]) continue;
    sum += group_sum;
    squares += group_sum * group_sum;
    group_sum = 0;
    groups++;
  }
  if (groups == 0) return -1;
  if (groups < 2) return sum > 0;
  double mean = sum / (double)groups, count = (double)groups;
  double se = sqrt(fmax(squares - count * mean * mean, 0) / (count - 1) * count);
  if (sum > se) return 1;
  return groups >= 5 && sum < -2 * se ? -2 : 0;
}

/* Computes the mean of the curve over the rows, its rms about it, and the rows with the largest
 * displacement. */
static fg_status describe_curve(fg_context *ctx, const fg_loop_problem *problem,
                                const fg_loop_claim *fit, double *mean, fg_loop_curve *curve) {
  double *effect = NULL, squares = 0;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *effect, (void **)&effect));
  fg_status status = fg_loop_claim_evaluate(ctx, problem, fit, effect);
  *mean = 0;
  for (size_t i = 0; i < problem->rows; i++)
    *mean += effect[i] / (double)problem->rows;
  for (size_t i = 0; i < problem->rows; i++)
    squares += (effect[i] - *mean) * (effect[i] - *mean);
  curve->rms = sqrt(squares / (double)problem->rows);
  curve->nearest_count = 0;
  for (size_t k = 0; k < 5 && k < problem->rows; k++) {
    size_t best = problem->rows;
    for (size_t i = 0; i < problem->rows; i++)
      if (isfinite(effect[i]) &&
          (best == problem->rows || fabs(effect[i] - *mean) > fabs(effect[best] - *mean)))
        best = i;
    if (best == problem->rows) break;
    curve->nearest[curve->nearest_count++] = best;
    effect[best] = NAN;
  }
  free(effect);
  return status;
}

/* The curve alone, drawn over its coordinate's range, its mean over the rows taken out. */
static fg_status draw_curve(fg_context *ctx, fg_engine_run *run, const fg_loop_claim *fit) {
  enum { POINTS = 61 };
  const fg_loop_problem *problem = run->problem;
  const fg_loop_coordinate *at = &problem->coordinate[run->curve_at];
  fg_loop_curve *curve = &run->result->curve;
  double *value = NULL, effect[POINTS], mean = 0;
  fg_loop_problem grid = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, POINTS, sizeof *curve->shape, (void **)&curve->shape));
  FG_TRY_EXIT(describe_curve(ctx, problem, fit, &mean, curve));
  FG_TRY_EXIT(fg_engine_grid_open(ctx, problem, POINTS, &grid));
  FG_TRY_EXIT(fg_engine_grid_axis(ctx, &grid, run->curve_at, &value));
  for (size_t i = 0; i < POINTS; i++)
    value[i] = at->low + (at->high - at->low) * (double)i / (POINTS - 1);
  FG_TRY_EXIT(fg_loop_claim_evaluate(ctx, &grid, fit, effect));
  for (size_t i = 0; i < POINTS; i++) {
    curve->shape[i][0] = value[i];
    curve->shape[i][1] = effect[i] - mean;
  }
  curve->count = POINTS;
  curve->coordinate = run->curve_at;
  curve->p_value = run->curve_p;
  curve->dof = (double)fit->columns;
  fg_text_clip(curve->name, sizeof curve->name, "%s", at->name);
  run->result->has_curve = true;
exit:
  fg_engine_grid_close(&grid);
  return status;
}

/* Subtracts from each row's error the prediction by the row before it, where neighbours are
 * correlated. */
static fg_status innovations(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise) {
  fg_engine_training all;
  double *residual = run->result->after_fit;
  if (noise.rho == 0) return FG_OK;
  FG_TRY(fg_engine_training_build(ctx, run->problem, NULL, &run->set, &all));
  for (size_t b = 0; b < all.blocks; b++)
    for (size_t i = all.start[b + 1] - 1; i > all.start[b]; i--) {
      double share = all.scale ? all.scale[i] / all.scale[i - 1] : 1;
      residual[i] -= noise.rho * share * residual[i - 1];
    }
  fg_engine_training_free(&all);
  return FG_OK;
}

static fg_status errors(fg_context *ctx, fg_engine_run *run, fg_engine_noise *noise) {
  fg_loop_result *result = run->result;
  fg_engine_set none = {0};
  fg_engine_noise first = {0}; /* as its owner would fit it */
  FG_TRY(fg_engine_fit_set(ctx, run->problem, run->train, &none, false, &first, result->before_fit,
                           NULL, NULL));
  FG_TRY(fg_engine_fit_set(ctx, run->problem, run->train, &run->set, true, noise, result->after_fit,
                           result->effect_fit, &result->noise.sd));
  FG_TRY(innovations(ctx, run, *noise));
  if (run->set.count == 0) /* no effect found: before and after are the same fit */
    memcpy(result->after_fit, result->before_fit, run->problem->rows * sizeof(double));
  result->noise.rho = noise->rho;
  result->noise.lambda = noise->lambda;
  FG_TRY(measure_error(ctx, run, result->before_fit, &result->before));
  FG_TRY(measure_error(ctx, run, result->after_fit, &result->after));
  result->noise_floor = fmin(result->noise.sd, FLOOR_OVER_RMS * result->after.rms);
  FG_TRY(cross_validated(ctx, run, &none, first, &result->before.cross_validated_rms));
  FG_TRY(cross_validated(ctx, run, &run->set, run->set.count ? *noise : first,
                         &result->after.cross_validated_rms));
  if (isnan(result->before.held_out_rms) && run->options.search_once) {
    result->before.held_out_rms = result->before.cross_validated_rms;
    result->after.held_out_rms = result->after.cross_validated_rms;
    run->fell = result->after.held_out_rms < result->before.held_out_rms;
  } else if (isnan(result->before.held_out_rms) && run->set.count)
    FG_TRY(fg_engine_cross_fit(ctx, run, &result->before.held_out_rms, &result->after.held_out_rms,
                               &run->fell));
  else if (isnan(result->before.held_out_rms))
    result->before.held_out_rms = result->after.held_out_rms = result->before.cross_validated_rms;
  double before = result->before.rms;
  result->ratio_rms = before > 0 ? result->after.rms / before : 1;
  result->ratio_held_out = result->before.held_out_rms > 0
                               ? result->after.held_out_rms / result->before.held_out_rms
                               : NAN;
  return bootstrap(ctx, run, result->ratio_interval);
}

void fg_engine_claim_take_fit(fg_loop_claim *claim, const fg_loop_claim *fit) {
  claim->columns = fit->columns;
  memcpy(claim->shape, fit->shape, sizeof fit->shape);
  memcpy(claim->shape_u, fit->shape_u, sizeof fit->shape_u);
  memcpy(claim->coefficient, fit->coefficient, sizeof fit->coefficient);
  memcpy(claim->coefficient_u, fit->coefficient_u, sizeof fit->coefficient_u);
  claim->slopes_u = fit->slopes_u;
  claim->orders = fit->orders;
  memcpy(claim->order, fit->order, sizeof fit->order);
  claim->amplitude = fit->amplitude;
  claim->amplitude_u = fit->amplitude_u;
  memcpy(claim->interval, fit->interval, sizeof fit->interval);
  claim->noise_value = fit->noise_value;
  claim->noise_value_u = fit->noise_value_u;
}

/* Fits the parameters to all rows: held-out rows have served their purpose. */
static fg_status parameters(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise) {
  fg_loop_result *result = run->result;
  fg_loop_claim fit[FG_LOOP_CLAIMS + 1] = {0};
  FG_TRY(fg_engine_fit_claims(ctx, run->problem, NULL, &run->set, noise, fit, result->parameter,
                              result->parameter_u));
  for (size_t m = 0; m < result->claims; m++)
    fg_engine_claim_take_fit(&result->claim[m], &fit[m]);
  return run->has_curve ? draw_curve(ctx, run, &fit[run->set.count - 1]) : FG_OK;
}

/* Returns true when an error can fall: effects of the spread and random levels do not change it. */
static bool may_lower(const fg_loop_result *result) {
  bool lowers = false;
  for (size_t m = 0; m < result->claims; m++)
    lowers |= result->claim[m].candidate.effect->scatter != FG_LOOP_SPREAD &&
              result->claim[m].candidate.effect->scatter != FG_LOOP_LEVELS;
  return lowers;
}

static bool error_fell(const fg_engine_run *run) {
  const fg_loop_result *result = run->result;
  return may_lower(result) && result->ratio_rms < 1 && run->fell;
}

/* Adds a note when effects were found but the error did not fall. */
static fg_status note_verdict(fg_context *ctx, const fg_engine_run *run) {
  fg_loop_result *result = run->result;
  if (!may_lower(result) || error_fell(run) || run->has_curve) return FG_OK;
  return fg_engine_note(ctx, result,
                        "What was found does not lower the error of rows that took no part "
                        "beyond chance (%.3g before, %.3g after): it is there, but do not predict "
                        "by it.",
                        ldexp(result->before.held_out_rms, run->units->response),
                        ldexp(result->after.held_out_rms, run->units->response));
}

fg_status fg_engine_finish(fg_context *ctx, fg_engine_run *run) {
  fg_loop_result *result = run->result;
  fg_engine_noise noise = {0};
  FG_TRY(errors(ctx, run, &noise));
  int confirmed = confirm_held_out(run);
  if (confirmed == -2 && run->set.count) {
    FG_TRY(fg_engine_note(ctx, result,
                          "What was found made the kept-aside rows worse by more than two standard "
                          "errors; it is withdrawn."));
    result->claims = 0;
    run->has_curve = false;
    run->set.count = 0;
    FG_TRY(errors(ctx, run, &noise));
  }
  if (confirmed == -1 && isfinite(result->ratio_held_out) && run->set.count)
    confirmed = run->fell;
  else if (confirmed >= 0)
    run->fell = confirmed == 1;

  for (size_t m = 0; m < result->claims; m++)
    result->claim[m].held_out = confirmed;
  FG_TRY(parameters(ctx, run, noise));
  FG_TRY(fg_engine_note_levels(ctx, run, noise));
  FG_TRY(fg_engine_find_influence(ctx, run, noise));
  FG_TRY(fg_engine_profile_scale(ctx, run));
  run->noise = noise;
  run->sd = result->noise.sd;
  FG_TRY(fg_engine_check(ctx, run, noise));
  bool more = run->has_curve || result->fails; /* than the claims */
  result->verdict = more              ? result->claims ? FG_LOOP_PARTLY : FG_LOOP_UNATTRIBUTED
                    : !result->claims ? FG_LOOP_CLEAN
                    : error_fell(run) ? FG_LOOP_EXPLAINED
                                      : FG_LOOP_PARTLY;
  return note_verdict(ctx, run);
}
