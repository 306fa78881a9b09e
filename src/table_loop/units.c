/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/units.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/memory.h"

/* The exponent of the largest magnitude; false where one is not finite. */
static bool largest_exponent(const double *value, size_t count, double *largest, int *exponent) {
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(value[i])) return false;
    *largest = fmax(*largest, fabs(value[i]));
  }
  frexp(*largest, exponent);
  return true;
}

static fg_status scaled_copy(fg_context *ctx, const double *from, size_t count, int exponent,
                             double **copy) {
  FG_TRY(fg_memory_allocate(ctx, count, sizeof **copy, (void **)copy));
  for (size_t i = 0; i < count; i++)
    (*copy)[i] = ldexp(from[i], -exponent);
  return FG_OK;
}

static fg_status scale_response(fg_context *ctx, const fg_loop_problem *problem,
                                fg_engine_units *units) {
  double largest = 0;
  const double *response = problem->response;
  if (!largest_exponent(problem->residual, problem->rows, &largest, &units->response) ||
      (response && problem->origin == 0 &&
       !largest_exponent(response, problem->rows, &largest, &units->response)))
    return fg_fail(ctx, FG_ERR_DATA, "the response less the declared model is not finite");
  FG_TRY(scaled_copy(ctx, problem->residual, problem->rows, units->response,
                     &units->problem.residual));
  if (!response) return FG_OK;
  return scaled_copy(ctx, response, problem->rows, units->response, &units->problem.response);
}

static fg_status scale_columns(fg_context *ctx, const fg_loop_problem *problem,
                               fg_engine_units *units) {
  size_t rows = problem->rows, count = problem->parameters;
  double *jacobian = NULL;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *units->column, (void **)&units->column));
  FG_TRY(fg_memory_allocate(ctx, count, rows * sizeof *jacobian, (void **)&jacobian));
  units->problem.jacobian = jacobian;
  for (size_t k = 0; k < count; k++) {
    double largest = 0;
    const double *column = problem->jacobian + k * rows;
    if (!largest_exponent(column, rows, &largest, &units->column[k]))
      return fg_fail(ctx, FG_ERR_DATA, "column '%s' of the declared model is not finite",
                     problem->parameter_name ? problem->parameter_name[k] : "");
    for (size_t i = 0; i < rows; i++)
      jacobian[k * rows + i] = ldexp(column[i], -units->column[k]);
  }
  return FG_OK;
}

fg_status fg_engine_units_open(fg_context *ctx, const fg_loop_problem *problem,
                               fg_engine_units *units) {
  *units = (fg_engine_units){.problem = *problem};
  units->problem.residual = units->problem.response = units->problem.jacobian = NULL;
  fg_status status = scale_response(ctx, problem, units);
  if (status == FG_OK) status = scale_columns(ctx, problem, units);
  if (status != FG_OK) fg_engine_units_close(units);
  return status;
}

void fg_engine_units_close(fg_engine_units *units) {
  free(units->problem.residual);
  free(units->problem.response);
  free(units->problem.jacobian);
  free(units->column);
  *units = (fg_engine_units){0};
}

static void restore(double *value, size_t count, int exponent) {
  for (size_t i = 0; value && i < count; i++)
    value[i] = ldexp(value[i], exponent);
}

/* Restores a sum of squares: NaN where the caller's unit cannot represent it. */
static void restore_square(double *value, int exponent) {
  double before = *value;
  *value = ldexp(before, 2 * exponent);
  if (before != 0 && !isnormal(*value)) *value = NAN;
}

static void restore_error(fg_loop_error *error, int exponent) {
  restore(&error->rms, 1, exponent);
  restore(&error->robust_sd, 1, exponent);
  restore(&error->p95, 1, exponent);
  restore(&error->maximum, 1, exponent);
  restore(&error->held_out_rms, 1, exponent);
  restore(&error->cross_validated_rms, 1, exponent);
}

static void restore_claim(fg_loop_claim *claim, int exponent) {
  restore(claim->coefficient, claim->columns, exponent);
  restore(claim->coefficient_u, claim->columns, exponent);
  restore(&claim->slopes_u, 1, exponent);
  for (size_t k = 0; k < claim->orders; k++) {
    restore(&claim->order[k].amplitude, 1, exponent);
    restore(&claim->order[k].amplitude_u, 1, exponent);
  }
  if (claim->candidate.effect && claim->candidate.effect->scatter == FG_LOOP_LEVELS) {
    restore(&claim->noise_value, 1, exponent);
    restore(&claim->noise_value_u, 1, exponent);
  }
  restore(&claim->amplitude, 1, exponent);
  restore(&claim->amplitude_u, 1, exponent);
  restore(claim->interval, 2, exponent);
  restore_square(&claim->cv_gain, exponent);
  restore_square(&claim->cv_gain_se, exponent);
}

void fg_engine_units_restore(const fg_engine_units *units, fg_loop_result *result) {
  size_t rows = units->problem.rows;
  int exponent = units->response;
  restore(&result->noise.sd, 1, exponent);
  restore(&result->noise_floor, 1, exponent);
  restore_error(&result->before, exponent);
  restore_error(&result->after, exponent);
  for (size_t m = 0; m < result->claims; m++)
    restore_claim(&result->claim[m], exponent);
  for (size_t i = 0; i < result->suspects; i++)
    restore_claim(&result->suspect[i].claim, exponent);
  restore(result->suspect_fit, rows, exponent);
  for (size_t i = 0; i < result->curve.count; i++)
    restore(&result->curve.shape[i][1], 1, exponent);
  restore(&result->curve.rms, 1, exponent);
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++)
    restore(&result->check[k].rms, 1, exponent);
  for (size_t i = 0; i < result->rejects; i++)
    restore(&result->rejected[i].smallest_detectable, 1, exponent);
  for (size_t k = 0; k < units->problem.parameters; k++) {
    restore(&result->parameter[k], 1, exponent - units->column[k]);
    restore(&result->parameter_u[k], 1, exponent - units->column[k]);
  }
  for (size_t i = 0; i < result->influences; i++) {
    fg_loop_influence *influence = &result->influence[i];
    int unit = exponent - units->column[influence->parameter];
    bool constant = units->problem.origin != 0 && influence->parameter == units->problem.constant;
    restore(&influence->change, 1, unit);
    restore(&influence->without, 1, unit);
    if (constant) influence->without += units->problem.origin;
  }
  if (units->problem.origin != 0 && result->parameter)
    result->parameter[units->problem.constant] += units->problem.origin;
  restore(result->before_fit, rows, exponent);
  restore(result->after_fit, rows, exponent);
  restore(result->effect_fit, rows, exponent);
}
