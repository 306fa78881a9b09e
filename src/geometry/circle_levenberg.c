/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "core/numerics.h"
#include "geometry/circle_scaled.h"

/* Deliberately not the parameters of the geometric fit: centre and radius themselves, so that the
 * two share nothing but the scaled points. */
static int fill_residuals(const gsl_vector *at, void *parameters, gsl_vector *out) {
  const fg_circle_scaled *scaled = parameters;
  double x = gsl_vector_get(at, 0), y = gsl_vector_get(at, 1), radius = gsl_vector_get(at, 2);
  for (size_t i = 0; i < scaled->count; i++) {
    double distance = hypot(scaled->x[i] - x, scaled->y[i] - y);
    gsl_vector_set(out, i, sqrt(scaled->weight[i]) * (distance - radius));
  }
  return GSL_SUCCESS;
}

static int fill_jacobian(const gsl_vector *at, void *parameters, gsl_matrix *out) {
  const fg_circle_scaled *scaled = parameters;
  double x = gsl_vector_get(at, 0), y = gsl_vector_get(at, 1);
  for (size_t i = 0; i < scaled->count; i++) {
    double dx = x - scaled->x[i], dy = y - scaled->y[i], root = sqrt(scaled->weight[i]);
    double distance = fmax(hypot(dx, dy), 1e-12);
    gsl_matrix_set(out, i, 0, root * dx / distance);
    gsl_matrix_set(out, i, 1, root * dy / distance);
    gsl_matrix_set(out, i, 2, -root);
  }
  return GSL_SUCCESS;
}

static fg_status publish_fit(fg_context *ctx, const fg_circle_scaled *scaled,
                             gsl_multifit_nlinear_workspace *work, fg_circle_fit *fit) {
  double flat[9];
  gsl_matrix_view covariance = gsl_matrix_view_array(flat, 3, 3);
  const gsl_vector *at = gsl_multifit_nlinear_position(work);
  fg_circle local = {gsl_vector_get(at, 0), gsl_vector_get(at, 1), gsl_vector_get(at, 2)};
  if (!isfinite(local.x) || !isfinite(local.y) || !(local.radius > 0) ||
      gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work), 0, &covariance.matrix))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: Levenberg-Marquardt found no circle");
  /* The scaled points are turned: rows and columns of the centre turn back. */
  const double turn[3][3] = {
      {scaled->axis_x, -scaled->axis_y, 0}, {scaled->axis_y, scaled->axis_x, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = 0;
      for (int k = 0; k < 9; k++)
        sum += turn[i][k / 3] * flat[k] * turn[j][k % 3];
      fit->covariance[i][j] = sum / scaled->weight_sum;
    }
  fit->circle = fg_circle_out_of_scaled(scaled, &local);
  fit->rms = scaled->scale * gsl_blas_dnrm2(gsl_multifit_nlinear_residual(work));
  fit->iterations = gsl_multifit_nlinear_niter(work);
  return FG_OK;
}

static fg_status run_levenberg(fg_context *ctx, fg_circle_scaled *scaled, const fg_circle *start,
                               fg_circle_fit *fit) {
  double at[3] = {start->x, start->y, start->radius};
  gsl_vector_view start_view = gsl_vector_view_array(at, 3);
  gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf problem = {
      .f = fill_residuals, .df = fill_jacobian, .n = scaled->count, .p = 3, .params = scaled};
  gsl_multifit_nlinear_workspace *work =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, scaled->count, 3);
  if (!work) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: Levenberg-Marquardt");
  int info, code = gsl_multifit_nlinear_init(&start_view.vector, &problem, work);
  if (code == GSL_SUCCESS)
    code = gsl_multifit_nlinear_driver(500, 1e-14, 1e-14, 0, NULL, NULL, &info, work);
  /* GSL_ENOPROG: no step improves, which is typical of an exact minimum. */
  fg_status status =
      code == GSL_SUCCESS || code == GSL_ENOPROG
          ? publish_fit(ctx, scaled, work, fit)
          : fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: Levenberg-Marquardt: %s", gsl_strerror(code));
  gsl_multifit_nlinear_free(work);
  return status;
}

fg_status fg_circle_fit_levenberg(fg_context *ctx, const fg_point *points, const double *weights,
                                  size_t count, const fg_circle *start, fg_circle_fit *fit) {
  fg_circle_scaled scaled;
  fg_circle local;
  fg_numerics_start();
  FG_TRY(fg_circle_scale_points(ctx, points, weights, count, &scaled));
  fg_status status = FG_OK;
  if (start)
    local = fg_circle_into_scaled(&scaled, start);
  else
    status = fg_circle_estimate_scaled(ctx, &scaled, &local);
  if (status == FG_OK) status = run_levenberg(ctx, &scaled, &local, fit);
  fg_circle_scaled_free(&scaled);
  return status;
}
