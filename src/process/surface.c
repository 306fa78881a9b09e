/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/surface.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

enum { MAX = FG_SURFACE_FACTORS };

/* Below this share of the largest curvature there is no telling a ridge from a slope. */
static const double FLAT = 1e-9;

/* Returns the variable's index among the surface's factors; a new one is appended. */
static fg_status find_or_add_factor(fg_context *ctx, const fg_model *model, size_t variable,
                                    fg_surface *s, size_t *factor) {
  const fg_variable *v = &model->formula.variable[variable];
  for (*factor = 0; *factor < s->factors; ++*factor)
    if (s->variable[*factor] == variable) return FG_OK;
  if (v->transform != FG_TRANSFORM_NONE)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "the model holds %s: a response surface needs the plain factors", v->name);
  if (s->factors == MAX)
    return fg_fail(ctx, FG_ERR_USAGE, "more than 12 numeric factors in the response surface");
  s->variable[s->factors++] = variable;
  return FG_OK;
}

/* Adds estimate × product of the column's numbers to the polynomial. */
static fg_status add_column(fg_context *ctx, const fg_model *model, const fg_model_column *column,
                            double estimate, const double *setting, fg_surface *s) {
  size_t factor[2] = {0, 0}, degree = 0;
  for (size_t k = 0; k < column->parts; k++) {
    const fg_part *part = &column->part[k];
    if (part->level != FG_PART_NUMBER) {
      double level = setting ? setting[part->variable] : 0;
      if (level != (double)part->level) estimate = 0;
      continue;
    }
    size_t index = 0;
    FG_TRY(find_or_add_factor(ctx, model, part->variable, s, &index));
    for (unsigned p = 0; p < part->power; p++) {
      if (degree == 2)
        return fg_fail(ctx, FG_ERR_USAGE,
                       "the term %s is of degree three or more: a response surface has two at most",
                       column->name);
      factor[degree++] = index;
    }
  }
  if (degree == 0) s->constant += estimate;
  if (degree == 1) s->linear[factor[0]] += estimate;
  if (degree == 2) {
    s->quadratic[factor[0]][factor[1]] += estimate / 2;
    s->quadratic[factor[1]][factor[0]] += estimate / 2;
  }
  return FG_OK;
}

static fg_status find_eigenvalues(fg_context *ctx, fg_surface *s) {
  fg_status status = FG_OK;
  size_t n = s->factors;
  gsl_matrix *b = gsl_matrix_alloc(n, n), *vectors = gsl_matrix_alloc(n, n);
  gsl_vector *values = gsl_vector_alloc(n);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
  if (!b || !vectors || !values || !work) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(b, i, j, s->quadratic[i][j]);
  if (gsl_eigen_symmv(b, values, vectors, work) != 0 ||
      gsl_eigen_symmv_sort(values, vectors, GSL_EIGEN_SORT_VAL_DESC) != 0)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_NUMERIC, "the eigenvalues did not converge"));
  for (size_t k = 0; k < n; k++) {
    s->eigenvalue[k] = gsl_vector_get(values, k);
    for (size_t i = 0; i < n; i++)
      s->eigenvector[k][i] = gsl_matrix_get(vectors, i, k);
  }
exit:
  gsl_matrix_free(b);
  gsl_matrix_free(vectors);
  gsl_vector_free(values);
  gsl_eigen_symmv_free(work);
  return status;
}

static fg_surface_kind kind_of(const fg_surface *s) {
  double largest = 0, smallest = INFINITY;
  size_t positive = 0;
  for (size_t k = 0; k < s->factors; k++) {
    largest = fmax(largest, fabs(s->eigenvalue[k]));
    smallest = fmin(smallest, fabs(s->eigenvalue[k]));
    positive += s->eigenvalue[k] > 0;
  }
  if (largest == 0) return FG_SURFACE_PLANE;
  if (smallest <= FLAT * largest) return FG_SURFACE_RIDGE;
  if (positive == s->factors) return FG_SURFACE_MINIMUM;
  return positive ? FG_SURFACE_SADDLE : FG_SURFACE_MAXIMUM;
}

/* b'v_k: the slope along an eigenvector. */
static double slope_along(const fg_surface *s, size_t k) {
  double slope = 0;
  for (size_t i = 0; i < s->factors; i++)
    slope += s->linear[i] * s->eigenvector[k][i];
  return slope;
}

/* Along the eigenvectors the surface is sum (g_k u_k + e_k u_k²): x = sum u_k v_k with u_k = -g_k /
 * (2 (e_k - shift)); shift 0 is the stationary point. The shift is edge - distance: two numbers, so
 * that a distance far below the rounding of the edge still counts. */
static void shifted_point(const fg_surface *s, double edge, double distance, double *x) {
  for (size_t i = 0; i < s->factors; i++)
    x[i] = 0;
  for (size_t k = 0; k < s->factors; k++) {
    double slope = slope_along(s, k), curvature = (s->eigenvalue[k] - edge) + distance;
    if (slope == 0) continue;
    for (size_t i = 0; i < s->factors; i++)
      x[i] -= slope / (2 * curvature) * s->eigenvector[k][i];
  }
}

double fg_surface_value(const fg_surface *s, const double *x) {
  double value = s->constant;
  for (size_t i = 0; i < s->factors; i++) {
    value += s->linear[i] * x[i];
    for (size_t j = 0; j < s->factors; j++)
      value += s->quadratic[i][j] * x[i] * x[j];
  }
  return value;
}

fg_status fg_surface_make(fg_context *ctx, const fg_model *model, const fg_regression *regression,
                          const double *setting, fg_surface *surface) {
  *surface = (fg_surface){0};
  for (size_t j = 0; j < model->columns; j++) {
    if (regression->coefficient[j].aliased) continue;
    FG_TRY(add_column(ctx, model, &model->column[j], regression->coefficient[j].estimate, setting,
                      surface));
  }
  if (!surface->factors)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "the model has no numeric factor whose effect can be told: there is no surface");
  FG_TRY(find_eigenvalues(ctx, surface));
  surface->kind = kind_of(surface);
  surface->has_stationary = surface->kind != FG_SURFACE_PLANE && surface->kind != FG_SURFACE_RIDGE;
  for (size_t i = 0; i < surface->factors; i++)
    surface->stationary[i] = NAN;
  surface->stationary_value = NAN;
  if (!surface->has_stationary) return FG_OK;
  shifted_point(surface, 0, 0, surface->stationary);
  surface->stationary_value = fg_surface_value(surface, surface->stationary);
  return FG_OK;
}

/* Bound of each factor on a face of the box. */
typedef enum hold { HOLD_FREE, HOLD_LOW, HOLD_HIGH, HOLDS } hold;

/* Elimination with row pivoting, the solution in `right`; false when singular. (GSL's version
 * allocates memory without checking.) */
static bool eliminate(double *matrix, double *right, size_t n) {
  for (size_t k = 0; k < n; k++) {
    size_t pivot = k;
    for (size_t i = k + 1; i < n; i++)
      if (fabs(matrix[i * n + k]) > fabs(matrix[pivot * n + k])) pivot = i;
    if (matrix[pivot * n + k] == 0) return false;
    for (size_t j = 0; j < n; j++) {
      double held = matrix[k * n + j];
      matrix[k * n + j] = matrix[pivot * n + j];
      matrix[pivot * n + j] = held;
    }
    double held = right[k];
    right[k] = right[pivot];
    right[pivot] = held;
    for (size_t i = k + 1; i < n; i++) {
      double factor = matrix[i * n + k] / matrix[k * n + k];
      for (size_t j = k; j < n; j++)
        matrix[i * n + j] -= factor * matrix[k * n + j];
      right[i] -= factor * right[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; j++)
      right[k] -= matrix[k * n + j] * right[j];
    right[k] /= matrix[k * n + k];
  }
  return true;
}

/* Finds the stationary point over the free factors, the others held; false when singular. */
static bool face_point(const fg_surface *s, const hold *holds, const double *low,
                       const double *high, double *x) {
  double matrix[MAX * MAX], right[MAX];
  size_t free_factor[MAX], n = 0;
  for (size_t i = 0; i < s->factors; i++) {
    if (holds[i] == HOLD_FREE)
      free_factor[n++] = i;
    else
      x[i] = holds[i] == HOLD_LOW ? low[i] : high[i];
  }
  if (n == 0) return true;
  for (size_t a = 0; a < n; a++) {
    size_t i = free_factor[a];
    right[a] = -s->linear[i];
    for (size_t j = 0; j < s->factors; j++)
      if (holds[j] != HOLD_FREE) right[a] -= 2 * s->quadratic[i][j] * x[j];
    for (size_t b = 0; b < n; b++)
      matrix[a * n + b] = 2 * s->quadratic[i][free_factor[b]];
  }
  if (!eliminate(matrix, right, n)) return false;
  for (size_t a = 0; a < n; a++)
    x[free_factor[a]] = right[a];
  return true;
}

static bool inside(const fg_surface *s, const double *low, const double *high, const double *x) {
  for (size_t i = 0; i < s->factors; i++)
    if (!(x[i] >= low[i] && x[i] <= high[i])) return false;
  return true;
}

/* The next face, as a number in base three; false after the last. */
static bool next_face(hold *holds, size_t factors) {
  for (size_t i = 0; i < factors; i++) {
    if (holds[i] != HOLD_HIGH) {
      holds[i]++;
      return true;
    }
    holds[i] = HOLD_FREE;
  }
  return false;
}

fg_status fg_surface_optimum_box(fg_context *ctx, const fg_surface *s, bool highest,
                                 const double *low, const double *high, double *x) {
  hold holds[MAX] = {HOLD_FREE};
  double candidate[MAX], best = INFINITY;
  for (size_t i = 0; i < s->factors; i++)
    if (!(low[i] <= high[i]) || !isfinite(low[i]) || !isfinite(high[i]))
      return fg_fail(ctx, FG_ERR_USAGE, "the region is empty or not bounded: %.15g to %.15g",
                     low[i], high[i]);
  do {
    if (!face_point(s, holds, low, high, candidate) || !inside(s, low, high, candidate)) continue;
    double value = fg_surface_value(s, candidate) * (highest ? -1 : 1);
    if (!(value < best)) continue;
    best = value;
    for (size_t i = 0; i < s->factors; i++)
      x[i] = candidate[i];
  } while (next_face(holds, s->factors));
  return FG_OK;
}

static double norm(const double *x, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += x[i] * x[i];
  return sqrt(sum);
}

/* On the sphere the best x solves (B - shift I) x = -b / 2 with the shift beyond the outermost
 * eigenvalue (Draper 1963; the trust-region equation): |x| falls from infinity to 0 as the shift
 * moves away from it, so bisection on 1 / distance finds the radius. Worked as a minimum. */
static bool sphere_point(const fg_surface *s, double radius, double *x) {
  double edge = s->eigenvalue[s->factors - 1], scale = norm(s->linear, s->factors) / 2;
  double near = 0, far = scale / radius * (1 + 1e-12);
  if (!(far > 0)) return false;
  for (int i = 0; i < 200; i++) {
    double middle = (near + far) / 2;
    shifted_point(s, edge, middle, x);
    if (norm(x, s->factors) > radius)
      near = middle;
    else
      far = middle;
  }
  shifted_point(s, edge, far, x);
  return true;
}

/* The hard case: the slope along the lowest eigenvector vanishes; the remainder of the radius is
 * covered along it. */
static void complete_radius(const fg_surface *s, double radius, double *x) {
  const double *v = s->eigenvector[s->factors - 1];
  double missing = radius * radius - pow(norm(x, s->factors), 2), along = 0;
  if (missing <= 1e-12 * radius * radius) return;
  for (size_t i = 0; i < s->factors; i++)
    along += v[i] * x[i];
  double step = -along + sqrt(along * along + missing);
  for (size_t i = 0; i < s->factors; i++)
    x[i] += step * v[i];
}

static fg_surface turned_over(const fg_surface *s) {
  fg_surface t = *s;
  t.constant = -s->constant;
  for (size_t i = 0; i < s->factors; i++) {
    t.linear[i] = -s->linear[i];
    t.eigenvalue[i] = -s->eigenvalue[s->factors - 1 - i];
    for (size_t j = 0; j < s->factors; j++) {
      t.quadratic[i][j] = -s->quadratic[i][j];
      t.eigenvector[i][j] = s->eigenvector[s->factors - 1 - i][j];
    }
  }
  return t;
}

static void best_on_sphere(const fg_surface *s, bool highest, double radius, double *x) {
  fg_surface down = highest ? turned_over(s) : *s;
  for (size_t i = 0; i < s->factors; i++)
    x[i] = 0;
  if (!(radius > 0)) return;
  if (!sphere_point(&down, radius, x))
    for (size_t i = 0; i < s->factors; i++)
      x[i] = 0;
  complete_radius(&down, radius, x);
}

fg_status fg_surface_optimum_ball(fg_context *ctx, const fg_surface *s, bool highest, double radius,
                                  double *x) {
  if (!(radius >= 0) || !isfinite(radius))
    return fg_fail(ctx, FG_ERR_USAGE, "the radius %.15g is not positive", radius);
  fg_surface_kind wanted = highest ? FG_SURFACE_MAXIMUM : FG_SURFACE_MINIMUM;
  if (s->kind == wanted && norm(s->stationary, s->factors) <= radius) {
    for (size_t i = 0; i < s->factors; i++)
      x[i] = s->stationary[i];
    return FG_OK;
  }
  best_on_sphere(s, highest, radius, x);
  return FG_OK;
}

fg_status fg_surface_ridge_path(fg_context *ctx, const fg_surface *s, bool highest,
                                const double *radii, size_t count, double *path) {
  for (size_t i = 0; i < count; i++) {
    if (!(radii[i] >= 0) || !isfinite(radii[i]))
      return fg_fail(ctx, FG_ERR_USAGE, "the radius %.15g is not positive", radii[i]);
    best_on_sphere(s, highest, radii[i], path + i * s->factors);
  }
  return FG_OK;
}
