/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of the response over its geometric mean, (y^p - 1) / p has the same unit at every power p, so
 * that residual sums are compared as they are (Box and Cox 1964). Claims of scatter, interaction
 * and wrong rows are left out of the model: the question is whether another scale makes them
 * needless. */
#include "table_loop/response_scale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/text.h"
#include "effect/table_effects.h"
#include "table_loop/accept_claim.h"
#include "table_loop/noise_scores.h"

/* Smallest ratio of the largest to the smallest response: below it every power is a straight line.
 */
#define RANGE_MIN 1.5
/* Powers of the profile, from -3 to 3. */
enum { POWERS = 121, DOF_MIN = 8, ROWS_MAX = 5000 };
#define POWER_LOW  (-3.0)
#define POWER_STEP 0.05
/* A claim does not show on the other scale when its test there, which it was chosen for among many,
 * has a larger p-value. */
#define GONE_P 0.01
/* A scale is claimed where its likelihood proves it and the sizes of the residuals, which tails
 * hardly move, see the scatter as well. */
#define SEEN_P 0.01
/* Beside the row that lies farthest out it must stay likely. */
#define HINGE_P 0.02
static const double simple_powers[] = {1, 0, -1, 0.5, -0.5, 2, -2};

typedef struct scale_fit {
  fg_engine_training training;
  double *response; /* n, over its geometric mean */
  double mean;      /* geometric */
} scale_fit;

static double on_scale(double y, double power) {
  return fabs(power) < POWER_STEP / 2 ? log(y) : (pow(y, power) - 1) / power;
}

static void put_scale(scale_fit *f, double power) {
  for (size_t i = 0; i < f->training.n; i++)
    f->training.y[i] = on_scale(f->response[i], power);
}

static bool may_vanish(const fg_loop_candidate *candidate) {
  return candidate->effect->scatter == FG_LOOP_SPREAD ||
         (candidate->effect->pair && !fg_engine_is_outlier(candidate));
}

static bool is_wrong_rows(const fg_loop_candidate *candidate) {
  return candidate->effect->outlier == FG_LOOP_WRONG_ROW && !candidate->effect->pair;
}

/* The set without scatter and interactions, and without wrong rows where `rows`, but with `keep`;
 * -1: none. */
static fg_engine_set set_without(const fg_engine_set *set, int keep, bool rows) {
  fg_engine_set left = {0};
  for (size_t m = 0; m < set->count; m++) {
    bool out = may_vanish(&set->candidate[m]) || (rows && is_wrong_rows(&set->candidate[m]));
    if (out && (int)m != keep) continue;
    left.candidate[left.count] = set->candidate[m];
    memcpy(left.shape[left.count++], set->shape[m], sizeof set->shape[m]);
  }
  return left;
}

static fg_status open_scale_of(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *set,
                               scale_fit *f) {
  double sum = 0;
  FG_TRY(fg_engine_training_build(ctx, run->problem, NULL, set, &f->training));
  size_t n = f->training.n;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *f->response, (void **)&f->response));
  for (size_t i = 0; i < n; i++)
    sum += log(f->response[i] = fg_engine_response(&f->training, i));
  f->mean = exp(sum / (double)n);
  for (size_t i = 0; i < n; i++)
    f->response[i] /= f->mean;
  return FG_OK;
}

static fg_status open_scale(fg_context *ctx, const fg_engine_run *run, int keep, scale_fit *f) {
  const fg_engine_set set = set_without(&run->set, keep, false);
  return open_scale_of(ctx, run, &set, f);
}

static void close_scale(scale_fit *f) {
  fg_engine_training_free(&f->training);
  free(f->response);
  f->response = NULL;
}

static fg_status fit_scale(fg_context *ctx, scale_fit *f, double power, double *rss, double *dof) {
  fg_engine_fit fit;
  put_scale(f, power);
  FG_TRY(fg_engine_least_squares(ctx, &f->training, (fg_engine_noise){0}, &fit));
  *rss = fit.rss;
  *dof = (double)f->training.n - (double)fit.rank;
  fg_engine_fit_free(&fit);
  return FG_OK;
}

/* The residual must be the response, but for an origin, and the model have a constant. */
static bool has_scale(const fg_engine_run *run) {
  const fg_loop_problem *problem = run->problem;
  double low = INFINITY, high = -INFINITY, origin = ldexp(problem->origin, -run->units->response);
  if (!run->worth || !problem->response || !problem->parameter_name || problem->group_level ||
      problem->rows > ROWS_MAX || problem->origin == 0)
    return false;
  for (size_t i = 0; i < problem->rows; i++) {
    double y = problem->response[i], moved = problem->residual[i] + origin;
    if (fabs(moved - y) > 1e-9 * fabs(y)) return false;
    low = fmin(low, y);
    high = fmax(high, y);
  }
  return low > 0 && high > RANGE_MIN * low;
}

static double choose_power(const fg_loop_response_scale *scale) {
  for (size_t k = 0; k < sizeof simple_powers / sizeof *simple_powers; k++)
    if (simple_powers[k] >= scale->interval[0] && simple_powers[k] <= scale->interval[1])
      return simple_powers[k];
  return scale->power;
}

/* Profile over the powers; the likelihood is of the residuals, by their dof. */
static fg_status profile(fg_context *ctx, scale_fit *f, fg_loop_response_scale *scale) {
  double criterion[POWERS], best = INFINITY, at_one = NAN, rss, dof = 0;
  for (size_t k = 0; k < POWERS; k++) {
    double power = POWER_LOW + (double)k * POWER_STEP;
    FG_TRY(fit_scale(ctx, f, power, &rss, &dof));
    if (!(rss > 0) || dof < DOF_MIN) return FG_OK;
    criterion[k] = dof * log(rss);
    if (fabs(power - 1) < POWER_STEP / 2) at_one = criterion[k];
    if (!(criterion[k] < best)) continue;
    best = criterion[k];
    scale->power = power;
  }
  double edge = gsl_cdf_chisq_Qinv(0.05, 1);
  scale->interval[0] = scale->interval[1] = scale->power;
  for (size_t k = 0; k < POWERS; k++) {
    double power = POWER_LOW + (double)k * POWER_STEP;
    if (criterion[k] - best > edge) continue;
    scale->interval[0] = fmin(scale->interval[0], power - POWER_STEP / 2);
    scale->interval[1] = fmax(scale->interval[1], power + POWER_STEP / 2);
  }
  scale->p_value = gsl_cdf_chisq_Q(at_one - best, 1);
  scale->chosen = choose_power(scale);
  scale->known = true;
  return FG_OK;
}

/* P-value of an interaction on another scale. */
static fg_status interaction_p(fg_context *ctx, const fg_engine_run *run, size_t m, double power,
                               double *p) {
  scale_fit without = {0}, with = {0};
  double rss[2], dof[2];
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_scale(ctx, run, -1, &without));
  FG_TRY_EXIT(open_scale(ctx, run, (int)m, &with));
  FG_TRY_EXIT(fit_scale(ctx, &without, power, &rss[0], &dof[0]));
  FG_TRY_EXIT(fit_scale(ctx, &with, power, &rss[1], &dof[1]));
  double added = dof[0] - dof[1];
  *p =
      added > 0 ? gsl_cdf_fdist_Q((rss[0] - rss[1]) / added / (rss[1] / dof[1]), added, dof[1]) : 1;
exit:
  close_scale(&without);
  close_scale(&with);
  return status;
}

/* P-value of a scatter on another scale. */
static fg_status spread_p(fg_context *ctx, const fg_engine_run *run,
                          const fg_loop_candidate *candidate, double power, double *p) {
  scale_fit f = {0};
  fg_engine_span span = {0};
  fg_engine_noise_scores scores = {0};
  double *work = NULL, z = NAN;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_scale(ctx, run, -1, &f));
  put_scale(&f, power);
  FG_TRY_EXIT(fg_engine_span_open(ctx, &f.training, (fg_engine_noise){0}, 0, &span));
  FG_TRY_EXIT(fg_engine_noise_scores_open(ctx, &f.training, (fg_engine_noise){0}, &span, candidate,
                                          1, &scores));
  FG_TRY_EXIT(fg_memory_allocate(ctx, f.training.n, 4 * sizeof *work, (void **)&work));
  fg_engine_noise_scores_of(&scores, f.training.y, work, &z);
  *p = gsl_cdf_chisq_Q(z * z, (double)fg_engine_candidate_columns(run->problem, candidate));
exit:
  free(work);
  fg_engine_noise_scores_close(&scores);
  fg_engine_span_close(&span);
  close_scale(&f);
  return status;
}

/* The scatter that shows most by itself, and its p-value alone. */
static fg_status choose_spread(fg_context *ctx, const fg_engine_run *run, size_t *best, double *p) {
  *p = 1;
  for (size_t c = run->means; c < run->candidates; c++) {
    double own = 1;
    if (run->candidate[c].effect->scatter != FG_LOOP_SPREAD) continue;
    FG_TRY(spread_p(ctx, run, &run->candidate[c], 1, &own));
    if (!(own < *p)) continue;
    *p = own;
    *best = c;
  }
  return FG_OK;
}

/* Adds the row that lies farthest from the others to a set. */
static fg_status add_farthest_row(fg_context *ctx, scale_fit *f, fg_engine_set *set) {
  const fg_engine_training *training = &f->training;
  fg_loop_candidate row = {.effect = &fg_loop_outlier_effects()[0], .rows = 1};
  fg_engine_span span = {0};
  double *residual = NULL, farthest = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_engine_span_open(ctx, training, (fg_engine_noise){0}, 0, &span));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->n, sizeof *residual, (void **)&residual));
  put_scale(f, 1);
  memcpy(residual, training->y, training->n * sizeof *residual);
  fg_engine_project_out(training->n, span.basis, span.rank, residual);
  for (size_t i = 0; i < training->n; i++) {
    double size = fabs(residual[i]) / fg_engine_span_kept_sd(&span, i);
    if (!(size > farthest)) continue;
    farthest = size;
    row.row[0] = training->row[i];
  }
  if (set->count <= FG_LOOP_CLAIMS) set->candidate[set->count++] = row;
exit:
  fg_engine_span_close(&span);
  free(residual);
  return status;
}

/* P-value of another scale over its kind, beside the row that lies farthest from the others. */
static fg_status scale_p_beside_row(fg_context *ctx, const fg_engine_run *run, scale_fit *f,
                                    double *p) {
  fg_engine_set set = set_without(&run->set, -1, false);
  fg_loop_response_scale scale = {.p_value = 1};
  scale_fit beside = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(add_farthest_row(ctx, f, &set));
  FG_TRY_EXIT(open_scale_of(ctx, run, &set, &beside));
  FG_TRY_EXIT(profile(ctx, &beside, &scale));
  *p = scale.p_value / run->share[FG_LOOP_KIND_SCATTER];
exit:
  close_scale(&beside);
  return status;
}

static bool has_rival(const fg_engine_run *run) {
  for (size_t m = 0; m < run->set.count; m++)
    if (may_vanish(&run->set.candidate[m])) return true;
  return false;
}

fg_status fg_engine_accept_scale(fg_context *ctx, fg_engine_run *run) {
  fg_loop_response_scale scale = {0};
  scale_fit f = {0};
  size_t best = 0;
  double alone = 1, beside = 1;
  fg_status status = FG_OK;
  if (!has_scale(run) || has_rival(run) || run->has_curve || run->result->claims == FG_LOOP_CLAIMS)
    return FG_OK;
  FG_TRY_EXIT(open_scale(ctx, run, -1, &f));
  FG_TRY_EXIT(profile(ctx, &f, &scale));
  double p = scale.p_value / run->share[FG_LOOP_KIND_SCATTER];
  if (!scale.known || scale.chosen == 1 || !(p < run->options.accept_p)) goto exit;
  FG_TRY_EXIT(choose_spread(ctx, run, &best, &alone));
  FG_TRY_EXIT(scale_p_beside_row(ctx, run, &f, &beside));
  if (!(alone < SEEN_P) || !(beside < HINGE_P)) goto exit;
  const fg_engine_stand stand = {.candidate = run->candidate[best]};
  fg_loop_claim claim = {.candidate = stand.candidate,
                         .p_value = p,
                         .retained_share = 1,
                         .cv_gain = NAN,
                         .cv_gain_se = NAN};
  fg_engine_candidate_name(run->problem, &claim.candidate, claim.name);
  fg_engine_take(run, &stand, &claim);
  run->result->family_p = fmin(run->result->family_p, p);
exit:
  close_scale(&f);
  return status;
}

void fg_loop_scale_name(double power, const char *response, char *text, size_t size) {
  if (power == -1)
    fg_text_clip(text, size, "1/%s", response);
  else if (fabs(power) < POWER_STEP / 2)
    fg_text_clip(text, size, "log(%s)", response);
  else
    fg_text_clip(text, size, "%s^%.3g", response, power);
}

/* P-value of wrong rows on the scale that all rows choose, over all that could have been wrong; 0
 * where the other rows need no such scale and the wrong rows explain more by Schwarz's criterion
 * over all choices of rows (Chen and Chen 2008). A skewed response has a long tail on its own
 * scale: its largest values lie far out, and are right. */
static fg_status wrong_rows_p(fg_context *ctx, const fg_engine_run *run, size_t m, double *p,
                              fg_loop_response_scale *scale) {
  const fg_engine_set none = set_without(&run->set, -1, true),
                      own = set_without(&run->set, (int)m, true);
  scale_fit f[2] = {0};
  double rss[2], dof[2], wrong, ignored;
  bool needed = scale->chosen != 1;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_scale_of(ctx, run, &none, &f[0]));
  FG_TRY_EXIT(open_scale_of(ctx, run, &own, &f[1]));
  FG_TRY_EXIT(profile(ctx, &f[0], scale));
  FG_TRY_EXIT(fit_scale(ctx, &f[1], 1, &wrong, &ignored));
  if (!scale->known || scale->chosen == 1) goto exit;
  for (size_t k = 0; k < 2; k++)
    FG_TRY_EXIT(fit_scale(ctx, &f[k], scale->chosen, &rss[k], &dof[k]));
  double n = (double)f[0].training.n, rows = (double)run->set.candidate[m].rows;
  double ways = lgamma(n + 1) - lgamma(rows + 1) - lgamma(n - rows + 1);
  bool explains = n * log(rss[0] / wrong) < rows * log(n) + 2 * ways;
  if (dof[1] < 1 || !(needed || explains)) goto exit;
  *p = gsl_cdf_fdist_Q((rss[0] - rss[1]) / rows / (rss[1] / dof[1]), rows, dof[1]) * exp(ways);
exit:
  for (size_t k = 0; k < 2; k++)
    close_scale(&f[k]);
  return status;
}

/* P-value of a claim on another scale; 0 for one that shows on every scale. *scale becomes the one
 * that shows it. */
static fg_status p_on_scale(fg_context *ctx, const fg_engine_run *run, size_t m, double *p,
                            fg_loop_response_scale *scale) {
  const fg_loop_candidate *candidate = &run->set.candidate[m];
  *p = 0;
  *scale = run->result->scale;
  if (is_wrong_rows(candidate)) return wrong_rows_p(ctx, run, m, p, scale);
  if (!may_vanish(candidate) || scale->chosen == 1) return FG_OK;
  return candidate->effect->scatter == FG_LOOP_SPREAD
             ? spread_p(ctx, run, candidate, scale->chosen, p)
             : interaction_p(ctx, run, m, scale->chosen, p);
}

static void tie_scale(const fg_engine_run *run, fg_loop_claim *claim) {
  const fg_loop_candidate scale = {.effect = fg_loop_scale_effect()};
  char name[FG_LOOP_NAME];
  if (claim->aliases == FG_LOOP_ALIASES) return;
  fg_engine_add_alias(run->problem, &scale, NAN, NAN, claim);
  fg_loop_scale_name(run->result->scale.chosen, "response", name, sizeof name);
  fg_text_clip(claim->alias[claim->aliases - 1].name, sizeof claim->alias[0].name, "%s(%s)",
               scale.effect->id, name);
  claim->verdict = FG_LOOP_TIED;
}

fg_status fg_engine_profile_scale(fg_context *ctx, fg_engine_run *run) {
  fg_loop_response_scale *scale = &run->result->scale;
  scale_fit f = {0};
  fg_status status = FG_OK;
  if (!has_scale(run)) return FG_OK;
  FG_TRY_EXIT(open_scale(ctx, run, -1, &f));
  FG_TRY_EXIT(profile(ctx, &f, scale));
  for (size_t m = 0; scale->known && m < run->result->claims; m++) {
    fg_loop_response_scale own;
    double p;
    FG_TRY_EXIT(p_on_scale(ctx, run, m, &p, &own));
    if (!(p > GONE_P)) continue;
    *scale = own;
    scale->removes++;
    tie_scale(run, &run->result->claim[m]);
  }
exit:
  close_scale(&f);
  return status;
}
