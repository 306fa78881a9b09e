/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Factors that are not significant, and the experiment without them. A coefficient of noise alone
 * would send its factor to an edge of the region, and the best setting with it.
 *
 * A factor is a suspect when none of its coefficients is significant at the level of the intervals.
 * Suspects leave one by one, the largest p first, as long as all that left can be zero together:
 * Wald's F of their coefficients in the model as given, so that all are tested against the same
 * error.
 *
 * A factor whose settings follow those of the factors that stay does not leave: the runs cannot
 * tell which of them makes the difference, so no setting of it is known to be as good as another.
 */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/distribution.h"
#include "process/experiment_parts.h"

/* Of the variation of a factor's settings: variances of effects are ten times those of factors that
 * change independently. */
static const double FOLLOWED = 0.9;

typedef struct suspects {
  bool suspect[FG_FORMULA_VARIABLES], left[FG_FORMULA_VARIABLES];
} suspects;

static bool holds(const fg_experiment *e, size_t column, size_t variable) {
  size_t term = e->model.column[column].term;
  return term != FG_MODEL_CONSTANT && e->model.formula.term[term].power[variable] > 0;
}

static bool holds_any(const fg_experiment *e, size_t column, const bool *variable) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (variable[v] && holds(e, column, v)) return true;
  return false;
}

/* A coefficient that is aliased or has no error cannot speak for its factor. */
static bool is_suspect(const fg_experiment *e, size_t variable) {
  bool lenth = !e->regression.residual_dof;
  if (variable == e->block_variable) return false;
  for (size_t j = 0; j < e->regression.columns; j++) {
    if (!holds(e, j, variable)) continue;
    double p_value = lenth ? e->effect[j].lenth_p_value : e->effect[j].p_value;
    if (e->regression.coefficient[j].aliased || !(p_value >= 1 - e->confidence)) return false;
  }
  return true;
}

/* Correlation of two estimates, from rows of U of (X'X)^-1 = U U'. */
static double correlation(const fg_regression *r, size_t i, size_t j) {
  double cross = 0, square_i = 0, square_j = 0;
  for (size_t k = 0; k < r->columns; k++) {
    double a = r->inverse_root[i * r->columns + k].value,
           b = r->inverse_root[j * r->columns + k].value;
    cross += a * b;
    square_i += a * a;
    square_j += b * b;
  }
  return cross / sqrt(square_i * square_j);
}

/* t' C^-1 t of the columns' t values, C their correlation; NaN where C cannot be solved. */
static double wald(const fg_experiment *e, const size_t *column, size_t count, gsl_matrix *c,
                   gsl_vector *t, gsl_vector *x) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    gsl_vector_set(t, i, e->effect[column[i]].t);
    for (size_t k = 0; k < count; k++)
      gsl_matrix_set(c, i, k, correlation(&e->regression, column[i], column[k]));
  }
  if (gsl_linalg_cholesky_decomp1(c) != 0 || gsl_linalg_cholesky_solve(c, t, x) != 0) return NAN;
  for (size_t i = 0; i < count; i++)
    sum += gsl_vector_get(t, i) * gsl_vector_get(x, i);
  return sum;
}

/* Computes the p-value of the coefficients of these variables together; NaN: there is no error to
 * compare with. */
static fg_status joint_p(fg_context *ctx, const fg_experiment *e, const bool *variable,
                         double *p_value) {
  fg_status status = FG_OK;
  size_t *column = NULL, count = 0;
  double dof = INFINITY;
  gsl_matrix *c = NULL;
  gsl_vector *t = NULL, *x = NULL;
  *p_value = NAN;
  if (!e->regression.residual_dof) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, e->regression.columns, sizeof *column, (void **)&column));
  for (size_t j = 0; j < e->regression.columns; j++) {
    if (!holds_any(e, j, variable)) continue;
    column[count++] = j;
    dof = fmin(dof, e->effect[j].dof);
  }
  c = count ? gsl_matrix_alloc(count, count) : NULL;
  t = count ? gsl_vector_alloc(count) : NULL;
  x = count ? gsl_vector_alloc(count) : NULL;
  if (!c || !t || !x) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  double square = wald(e, column, count, c, t, x);
  *p_value = fg_distribution_f_upper(square / (double)count, (double)count, dof);
exit:
  free(column);
  gsl_matrix_free(c);
  gsl_vector_free(t);
  gsl_vector_free(x);
  return status;
}

/* Finds the suspect whose removal is least significant; FG_FORMULA_VARIABLES: none may leave. */
static fg_status next_to_leave(fg_context *ctx, const fg_experiment *e, const suspects *s,
                               size_t *next) {
  double max_p = 1 - e->confidence;
  *next = FG_FORMULA_VARIABLES;
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    bool with[FG_FORMULA_VARIABLES];
    double p_value;
    if (!s->suspect[v] || s->left[v]) continue;
    memcpy(with, s->left, sizeof with);
    with[v] = true;
    FG_TRY(joint_p(ctx, e, with, &p_value));
    if (!e->regression.residual_dof) p_value = 1;
    if (!(p_value >= max_p)) continue;
    max_p = p_value;
    *next = v;
  }
  return FG_OK;
}

static fg_status add_idle(fg_context *ctx, fg_experiment *e, size_t variable) {
  fg_idle_factor *idle = &e->idle.factor[e->idle.count++];
  bool alone[FG_FORMULA_VARIABLES] = {false};
  alone[variable] = true;
  *idle = (fg_idle_factor){.variable = variable};
  for (size_t j = 0; j < e->regression.columns; j++)
    idle->columns += holds(e, j, variable);
  return joint_p(ctx, e, alone, &idle->p_value);
}

/* Writes the formula of the other factors and blocks that stay, each by itself. */
static fg_status write_staying(fg_context *ctx, const fg_experiment *e, const suspects *s,
                               const char *column, size_t *terms, char **text) {
  fg_term term[FG_FORMULA_VARIABLES] = {{{0}}};
  fg_formula formula = e->model.formula;
  formula.response = NULL;
  formula.term = term;
  formula.terms = 0;
  formula.constant = true;
  for (size_t v = 0; v < formula.variables; v++)
    if (!s->left[v] && strcmp(formula.variable[v].column, column) != 0)
      term[formula.terms++].power[v] = 1;
  *terms = formula.terms;
  return fg_formula_format(ctx, &formula, text);
}

/* Finds the share of the variation of a factor's settings that follows those that stay; NaN: the
 * settings are words, or nothing stays. */
static fg_status find_share_followed(fg_context *ctx, const fg_experiment *e, const suspects *s,
                                     size_t variable, double *share) {
  const char *column = e->model.formula.variable[variable].column;
  char *formula = NULL;
  fg_context words = {0};
  fg_model model = {0};
  fg_regression fit = {0};
  size_t terms = 0;
  *share = NAN;
  if (e->model.levels[variable].count) return FG_OK;
  fg_status status = write_staying(ctx, e, s, column, &terms, &formula);
  if (status == FG_OK && terms) {
    status = fg_regression_analyse(&words, &e->table, formula, column, NULL, &model, &fit);
    if (status == FG_OK) *share = fit.r2;
    /* Settings that cannot be fitted follow nothing. */
    status = status == FG_ERR_MEMORY ? fg_fail(ctx, status, "out of memory") : FG_OK;
    fg_regression_free(&fit);
    fg_model_free(&model);
  }
  free(formula);
  return status;
}

/* Takes back the factors whose settings follow those that stay. One that is back makes others
 * follow it. */
static fg_status take_back_followers(fg_context *ctx, fg_experiment *e, suspects *s) {
  for (bool back = true; back;) {
    back = false;
    for (size_t v = 0; v < e->model.formula.variables; v++) {
      double share;
      if (!s->left[v]) continue;
      FG_TRY(find_share_followed(ctx, e, s, v, &share));
      if (!(share > FOLLOWED)) continue;
      s->left[v] = false;
      back = true;
      FG_TRY(fg_experiment_note(
          ctx, e,
          "the settings of %s follow those of the other factors in these runs (R² = %.4g): which "
          "of them makes the difference cannot be told, and the best setting sets them together; "
          "runs that change %s alone would tell",
          e->model.formula.variable[v].column, share, e->model.formula.variable[v].column));
    }
  }
  return FG_OK;
}

static fg_status find_idle(fg_context *ctx, fg_experiment *e, suspects *s) {
  size_t next, asked = 0;
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    s->suspect[v] = is_suspect(e, v);
    asked += v != e->block_variable;
  }
  do {
    FG_TRY(next_to_leave(ctx, e, s, &next));
    if (next < FG_FORMULA_VARIABLES) s->left[next] = true;
  } while (next < FG_FORMULA_VARIABLES);
  FG_TRY(take_back_followers(ctx, e, s));
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (s->left[v]) FG_TRY(add_idle(ctx, e, v));
  e->idle.all = e->idle.count && e->idle.count == asked;
  return FG_OK;
}

/* Writes the formula without the idle factors; the blocks return by their option. */
static fg_status write_formula(fg_context *ctx, const fg_experiment *e, const suspects *s,
                               char **text) {
  fg_formula formula = e->model.formula;
  formula.term = NULL;
  formula.terms = 0;
  FG_TRY(fg_memory_allocate(ctx, e->model.formula.terms, sizeof *formula.term,
                            (void **)&formula.term));
  for (size_t t = 0; t < e->model.formula.terms; t++) {
    const fg_term *term = &e->model.formula.term[t];
    bool keep = e->block_variable >= FG_FORMULA_VARIABLES || !term->power[e->block_variable];
    for (size_t v = 0; v < formula.variables; v++)
      keep = keep && !(s->left[v] && term->power[v]);
    if (keep) formula.term[formula.terms++] = *term;
  }
  fg_status status = fg_formula_format(ctx, &formula, text);
  free(formula.term);
  return status;
}

static bool is_left(const fg_experiment *e, const suspects *s, const char *column) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (s->left[v] && !strcmp(e->model.formula.variable[v].column, column)) return true;
  return false;
}

/* Repeats the analysis with the same options, without those of the idle factors. */
static fg_status analyse_without(fg_context *ctx, const fg_table *runs,
                                 const fg_experiment_options *asked, const suspects *s,
                                 const char *formula, fg_experiment *e) {
  fg_experiment_options options = *asked;
  fg_coding coding[FG_FORMULA_VARIABLES];
  fg_rounding round[FG_FORMULA_VARIABLES];
  options.response = e->response;
  options.formula = formula;
  options.coding = coding;
  options.codings = 0;
  options.round = round;
  options.rounds = 0;
  for (size_t k = 0; k < e->factors; k++)
    if (e->factor[k].coded && !s->left[e->factor[k].variable])
      coding[options.codings++] = e->factor[k].coding;
  for (size_t i = 0; i < asked->rounds && options.rounds < FG_FORMULA_VARIABLES; i++)
    if (!is_left(e, s, asked->round[i].name)) round[options.rounds++] = asked->round[i];
  FG_TRY(fg_experiment_fit(ctx, runs, &options, e->reduced));
  size_t known = e->reduced->notes;
  FG_TRY(fg_experiment_surface(ctx, &options, e, e->reduced));
  FG_TRY(fg_experiment_optimise(ctx, &options, e, e->reduced));
  for (size_t i = known; i < e->reduced->notes; i++)
    FG_TRY(fg_experiment_note(ctx, e, "%s", e->reduced->note[i]));
  return FG_OK;
}

fg_status fg_experiment_reduce(fg_context *ctx, const fg_table *runs,
                               const fg_experiment_options *options, fg_experiment *e) {
  suspects s = {0};
  char *formula = NULL;
  if (!e->has_surface) return FG_OK;
  FG_TRY(find_idle(ctx, e, &s));
  if (!e->idle.count || e->idle.all) return FG_OK;
  fg_status status = write_formula(ctx, e, &s, &formula);
  if (status == FG_OK)
    status = fg_memory_allocate(ctx, 1, sizeof *e->reduced, (void **)&e->reduced);
  if (status == FG_OK) {
    *e->reduced = (fg_experiment){0};
    status = analyse_without(ctx, runs, options, &s, formula, e);
  }
  free(formula);
  return status;
}

/* The surface's axis of that column; `factors`: none. */
static size_t axis_of(const fg_experiment *e, const char *column) {
  size_t k = 0;
  while (k < e->surface.factors &&
         strcmp(e->model.formula.variable[e->surface.variable[k]].column, column) != 0)
    k++;
  return k;
}

void fg_experiment_add_constraints(const fg_experiment *whole, fg_experiment *e) {
  const fg_region *from = &whole->region;
  fg_region *to = &e->region;
  for (size_t p = 0; p < from->planes; p++) {
    double normal[FG_SURFACE_FACTORS] = {0}, limit = from->limit[p];
    bool any = false;
    for (size_t k = 0; k < whole->surface.factors; k++) {
      const char *name = whole->model.formula.variable[whole->surface.variable[k]].column;
      size_t axis = axis_of(e, name);
      double weight = from->normal[p][k];
      if (axis == e->surface.factors) {
        limit -= fmin(weight * from->low[k], weight * from->high[k]);
        continue;
      }
      normal[axis] = weight;
      any = any || weight != 0;
    }
    if (!any) continue;
    memcpy(to->normal[to->planes], normal, sizeof normal);
    to->limit[to->planes++] = limit;
  }
}
