/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Common null of all tests: residuals of the null model in another order (Freedman and Lane 1983),
 * which keeps their tails, scored as the data are. All scores are put on one scale by their own
 * draws, so that their maximum over the candidates of a kind is a fair statistic (Westfall and
 * Young 1993); family.c combines the kinds. */
#include "table_loop/assess.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "table_loop/noise_scores.h"
#include "table_loop/null_residual.h"
#include "table_loop/row_tails.h"
#include "table_loop/tails.h"

/* Minimum residual dof for permutations: below it a new order of the residuals is no new sample,
 * and normal numbers are drawn. */
enum { PERMUTED_DOF = 12 };
/* Rows up to which the scatter's null has drawn errors; more rows have enough sizes to reorder. */
enum { REDRAWN_ROWS = 24 };
/* Number of draws of a first pass, which decides when its p-value differs from the level by this
 * factor. */
enum { FIRST_DRAWS = 399, UNCERTAINTY = 8 };
/* A candidate's scale: from its median draw to this quantile. */
#define UPPER 0.95
static const double upper_normal = 1.6448536269514722;

typedef struct drawing {
  const fg_score_workspace *workspace;
  const fg_engine_noise_scores *noise_scores;
  const fg_engine_exchange *exchange; /* NULL: none */
  const fg_engine_null *null;
  fg_engine_noise noise;
  const double *white;          /* n: the null's residual of each row alone, of unit variance */
  const double *own;            /* n: share of the row's own error in its residual's variance */
  double tail[FG_ENGINE_TAILS]; /* weights of the tails of that residual */
  double sd;                    /* of the null's residual */
  bool permuted;
  size_t scores;            /* of means, of noises, of the exchange */
  const fg_loop_kind *kind; /* scores */
  double *z;                /* draws × scores */
} drawing;

static void draw_one(const drawing *d, uint64_t *seed, double *y) {
  const fg_engine_training *training = d->workspace->training;
  size_t n = training->n;
  for (size_t i = 0; i < n; i++)
    y[i] = d->permuted ? d->white[i] : d->sd * fg_splitmix_normal(seed);
  for (size_t i = n; d->permuted && i > 1; i--) {
    size_t k = (size_t)(fg_splitmix_uniform(seed) * (double)i);
    double other = y[k];
    y[k] = y[i - 1];
    y[i - 1] = other;
  }
  fg_engine_colour_rows(training, d->noise, seed, y);
}

/* Scatter is drawn anew with the tails that the residuals have: in another order they would keep
 * the sizes that the scatter gave them, and a ratio of 20 in 16 rows would be no surprise. */
static void score_noise(const drawing *d, const double *y, uint64_t *seed, double *work,
                        double *z) {
  const fg_engine_training *training = d->workspace->training;
  double *own = work + 3 * training->n;
  if (d->permuted && training->n <= REDRAWN_ROWS) {
    fg_engine_tails_draw(d->tail, training->n, seed, own);
    fg_engine_colour_rows(training, d->noise, seed, own);
    y = own;
  }
  fg_engine_noise_scores_of(d->noise_scores, y, work, z);
}

/* Noise and exchange of one draw, behind the means' scores. */
static void score_rest(const drawing *d, const double *y, uint64_t *seed, double *work, double *z) {
  const fg_score_workspace *workspace = d->workspace;
  size_t n = workspace->training->n, noises = d->noise_scores->count, pair[2];
  score_noise(d, y, seed, work, z + workspace->candidates);
  if (!d->exchange) return;
  double *response = work + 3 * n;
  for (size_t i = 0; i < n; i++)
    response[i] = d->exchange->mean[i] + y[i];
  double ratio = fg_engine_exchange_best(d->exchange, y, response, work, pair);
  z[workspace->candidates + noises] =
      isfinite(ratio) ? fg_engine_deviate(fmin(ratio, 1), 1, (double)workspace->dof) : NAN;
}

/* Draws of one seed. */
enum { ONE_SEED = 8 };

static fg_status draw_batch(fg_context *ctx, void *shared, size_t item) {
  const drawing *d = shared;
  const fg_score_workspace *workspace = d->workspace;
  size_t n = workspace->training->n, first = item * FG_ENGINE_BATCH, count = d->null->draws - first;
  uint64_t seed = 0;
  fg_engine_score *score = NULL;
  uint64_t noise_seed = ~(d->null->seed * 0x9e3779b97f4a7c15u + item);
  double *y = NULL, *work = NULL;
  fg_status status = FG_OK;
  if (count > FG_ENGINE_BATCH) count = FG_ENGINE_BATCH;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, n * sizeof *y, (void **)&y));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, 4 * sizeof *work, (void **)&work));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, workspace->candidates + 1, count * sizeof *score, (void **)&score));
  for (size_t b = 0; b < count; b++) {
    if (b % ONE_SEED == 0)
      seed = (d->null->seed + 1) * 0x5851f42d4c957f2du + (first + b) / ONE_SEED;
    draw_one(d, &seed, y + b * n);
  }
  FG_TRY_EXIT(fg_score_workspace_score(ctx, workspace, count, y, score));
  for (size_t b = 0; b < count; b++) {
    double *z = d->z + (first + b) * d->scores;
    for (size_t c = 0; c < workspace->candidates; c++)
      z[c] = score[b * workspace->candidates + c].z;
    score_rest(d, y + b * n, &noise_seed, work, z);
  }
exit:
  free(y);
  free(work);
  free(score);
  return status;
}

/* Location of one score in its own draws. */
typedef struct own_scale {
  double middle, spread;
} own_scale;

static double quantile(const double *sorted, size_t count, double share) {
  double place = share * (double)(count - 1);
  size_t below = (size_t)place;
  if (below + 1 >= count) return sorted[count - 1];
  return sorted[below] + (place - (double)below) * (sorted[below + 1] - sorted[below]);
}

static own_scale scale_of(const drawing *d, size_t at, double *sorted) {
  size_t count = 0, draws = d->null->draws;
  for (size_t b = 0; b < draws; b++)
    if (isfinite(d->z[b * d->scores + at])) sorted[count++] = d->z[b * d->scores + at];
  if (count < draws / 2) return (own_scale){NAN, NAN};
  fg_sort(sorted, count);
  own_scale scale = {quantile(sorted, count, 0.5), 0};
  scale.spread = (quantile(sorted, count, UPPER) - scale.middle) / upper_normal;
  if (!(scale.spread > 0)) scale.spread = NAN;
  return scale;
}

/* The family of the draws: the maximum of each kind in each. */
static fg_status fit_family(fg_context *ctx, const drawing *d, const own_scale *scale,
                            fg_engine_family *family) {
  size_t draws = d->null->draws;
  double *maxima = NULL;
  FG_TRY(fg_memory_allocate(ctx, draws, FG_LOOP_KINDS * sizeof *maxima, (void **)&maxima));
  for (size_t b = 0; b < draws; b++) {
    double *max = maxima + b * FG_LOOP_KINDS;
    for (size_t k = 0; k < FG_LOOP_KINDS; k++)
      max[k] = -INFINITY;
    for (size_t c = 0; c < d->scores; c++) {
      double z = (d->z[b * d->scores + c] - scale[c].middle) / scale[c].spread;
      if (z > max[d->kind[c]]) max[d->kind[c]] = z;
    }
  }
  fg_status status = fg_engine_family_fit(ctx, draws, maxima, family);
  free(maxima);
  return status;
}

static void take_critical(const fg_score_workspace *workspace, const fg_engine_null *null,
                          const own_scale *scale, fg_engine_judgement *judgement) {
  double critical[FG_LOOP_KINDS];
  for (size_t k = 0; k < FG_LOOP_KINDS; k++)
    critical[k] = fg_engine_family_critical(&judgement->family, (fg_loop_kind)k, null->accept_p);
  for (size_t c = 0; c < judgement->means; c++) {
    if (!isfinite(judgement->z[c])) continue;
    const fg_engine_version *version = &workspace->version[judgement->score[c].version];
    double k = fg_engine_version_dof(workspace, version), edge = critical[judgement->kind[c]];
    judgement->z_critical[c] = scale ? scale[c].middle + edge * scale[c].spread : edge;
    judgement->f_critical[c] = fg_engine_deviate_to_f(
        judgement->z_critical[c], k, fg_engine_version_whole(workspace, version) - k);
  }
}

/* `raw` are the data's deviates before scaling by the draws. */
static fg_status assess_drawn(fg_context *ctx, drawing *d, const double *raw,
                              fg_engine_judgement *judgement) {
  size_t draws = d->null->draws, batches = (draws + FG_ENGINE_BATCH - 1) / FG_ENGINE_BATCH;
  fg_status status = FG_OK;
  own_scale *scale = NULL;
  double *sorted = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, draws, d->scores * sizeof *d->z, (void **)&d->z));
  FG_TRY_EXIT(fg_memory_allocate(ctx, d->scores, sizeof *scale, (void **)&scale));
  FG_TRY_EXIT(fg_memory_allocate(ctx, draws, sizeof *sorted, (void **)&sorted));
  FG_TRY_EXIT(fg_parallel_run(ctx, 0, batches, draw_batch, d));
  for (size_t c = 0; c < d->scores; c++)
    scale[c] = scale_of(d, c, sorted);
  FG_TRY_EXIT(fit_family(ctx, d, scale, &judgement->family));
  for (size_t c = 0; c < d->scores; c++)
    judgement->z[c] = (raw[c] - scale[c].middle) / scale[c].spread;
  take_critical(d->workspace, d->null, scale, judgement);
exit:
  free(d->z);
  d->z = NULL;
  free(scale);
  free(sorted);
  return status;
}

static double over_family(const fg_engine_judgement *judgement, size_t c) {
  return fg_engine_family_p(&judgement->family, judgement->kind[c], judgement->z[c]);
}

static double smallest_p(const fg_engine_judgement *judgement) {
  double smallest = 1;
  for (size_t c = 0; c <= judgement->candidates; c++)
    smallest = fmin(smallest, over_family(judgement, c));
  return smallest;
}

/* Assesses with few draws first, and with all of them if that leaves a doubt. */
static fg_status assess_in_turns(fg_context *ctx, drawing *d, fg_engine_judgement *judgement) {
  size_t all = judgement->candidates + 1;
  fg_engine_null first = *d->null, whole = *d->null;
  double *raw = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, all, sizeof *raw, (void **)&raw));
  memcpy(raw, judgement->z, all * sizeof *raw);
  if (first.draws > FIRST_DRAWS) first.draws = FIRST_DRAWS;
  d->null = &first;
  fg_score_workspace_tell(d->workspace, 1, 3);
  FG_TRY_EXIT(assess_drawn(ctx, d, raw, judgement));
  double p = smallest_p(judgement);
  if (first.draws == whole.draws || p < whole.accept_p / UNCERTAINTY ||
      p > whole.accept_p * UNCERTAINTY)
    goto exit;
  d->null = &whole;
  fg_score_workspace_tell(d->workspace, 2, 3);
  FG_TRY_EXIT(assess_drawn(ctx, d, raw, judgement));
exit:
  free(raw);
  return status;
}

/* Assesses many rows: every version of every candidate counts as one test of a normal deviate. */
static void assess_by_count(const fg_score_workspace *workspace, const fg_engine_null *null,
                            fg_engine_judgement *judgement) {
  double tests[FG_LOOP_KINDS] = {0};
  for (size_t v = 0; v < workspace->versions; v++)
    tests[judgement->kind[workspace->version[v].candidate]]++;
  for (size_t c = judgement->means; c < judgement->candidates; c++)
    tests[judgement->kind[c]]++;
  fg_engine_family_count(tests, &judgement->family);
  take_critical(workspace, null, NULL, judgement);
}

/* Weighs the tails of the null's residual. */
static void weigh_tails(const fg_engine_span *span, drawing *d) {
  double square = 0, size[REDRAWN_ROWS];
  if (span->n > REDRAWN_ROWS) return;
  for (size_t i = 0; i < span->n; i++)
    square += d->white[i] * d->white[i] / (double)span->n;
  for (size_t i = 0; i < span->n; i++)
    size[i] = square > 0 ? d->white[i] / sqrt(square) : NAN;
  const fg_engine_tail_rows rows = {.n = span->n, .size = size, .own = d->own};
  fg_engine_tails_weigh(&rows, d->tail);
}

static fg_status allocate_assessment(fg_context *ctx, size_t means, size_t noises,
                                     fg_engine_judgement *judgement) {
  size_t all = means + noises + 1, size = sizeof(double);
  *judgement =
      (fg_engine_judgement){.means = means, .candidates = means + noises, .exchange_ratio = NAN};
  FG_TRY(fg_memory_allocate(ctx, means + 1, sizeof *judgement->score, (void **)&judgement->score));
  FG_TRY(fg_memory_allocate(ctx, all, size, (void **)&judgement->z));
  FG_TRY(fg_memory_allocate(ctx, all, size, (void **)&judgement->p));
  FG_TRY(fg_memory_allocate(ctx, all, size, (void **)&judgement->z_critical));
  FG_TRY(fg_memory_allocate(ctx, all, size, (void **)&judgement->f_critical));
  FG_TRY(fg_memory_allocate(ctx, all, sizeof *judgement->kind, (void **)&judgement->kind));
  for (size_t c = 0; c < all; c++) {
    judgement->z[c] = judgement->z_critical[c] = NAN;
    judgement->f_critical[c] = INFINITY;
    judgement->p[c] = 1;
  }
  return FG_OK;
}

static void take_kinds(const fg_score_workspace *workspace, const fg_loop_candidate *noise,
                       const fg_engine_null *null, fg_engine_judgement *judgement) {
  const fg_loop_problem *problem = workspace->training->problem;
  for (size_t c = 0; c < judgement->candidates; c++)
    judgement->kind[c] = fg_loop_kind_of(
        problem, c < judgement->means ? &workspace->candidate[c] : &noise[c - judgement->means]);
  judgement->kind[judgement->candidates] = FG_LOOP_KIND_EXCHANGES;
  memcpy(judgement->family.share, null->share, sizeof judgement->family.share);
}

/* Beside correlation the exchanges cost rows² a draw. */
enum { EXCHANGED_CORRELATED = 250 };

static bool may_exchange(const fg_engine_training *training) {
  bool whole = training->serial || training->levels;
  size_t max = whole ? EXCHANGED_CORRELATED : FG_ENGINE_SMALL_ROWS;
  return training->problem->exchangeable && training->n >= training->columns + 4 &&
         training->n <= max;
}

/* The scores of the data themselves. */
static fg_status score_data(fg_context *ctx, const fg_score_workspace *workspace,
                            const fg_engine_noise_scores *noise_scores,
                            const fg_engine_exchange *exchange, fg_engine_judgement *judgement) {
  const fg_engine_training *training = workspace->training;
  size_t n = training->n, noises = noise_scores->count;
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, n, 4 * sizeof *work, (void **)&work));
  for (size_t c = 0; c < judgement->means; c++)
    judgement->z[c] = judgement->score[c].z;
  fg_engine_noise_scores_of(noise_scores, training->y, work, judgement->z + judgement->means);
  if (exchange) {
    for (size_t i = 0; i < n; i++)
      work[3 * n + i] = fg_engine_response(training, i);
    double ratio =
        fg_engine_exchange_best(exchange, training->y, work + 3 * n, work, judgement->exchanged);
    judgement->has_exchange = isfinite(ratio);
    judgement->exchange_ratio = fmin(ratio, 1);
    if (judgement->has_exchange)
      judgement->z[judgement->means + noises] =
          fg_engine_deviate(judgement->exchange_ratio, 1, (double)workspace->dof);
  }
  free(work);
  return FG_OK;
}

/* Share of the error rate of an exchange by likelihood. The bound is wide: with it 1 in 50 tables
 * of heavy tails reach a p-value of 0.01 even if their two farthest rows fit each other's places,
 * which few do (tests/unit/test_loop_tails.c). */
#define LIKELIHOOD_SHARE 0.25

/* The p-value of the exchange by likelihood, against one tail of all rows: a ratio above 1 / p
 * comes by chance less often than p. The draws hold the two rows as they are, which a fixed model
 * would nearly always find to fit in each other's places somewhere. */
static fg_status exchange_likelihood(fg_context *ctx, const drawing *d,
                                     fg_engine_judgement *judgement) {
  const fg_engine_training *training = d->workspace->training;
  size_t n = training->n, *pair = judgement->exchanged;
  double *y = NULL;
  FG_TRY(fg_memory_allocate(ctx, n, 4 * sizeof *y, (void **)&y));
  double change = fg_engine_response(training, pair[1]) - fg_engine_response(training, pair[0]);
  memcpy(y, training->y, n * sizeof *y);
  y[pair[0]] += change;
  y[pair[1]] -= change;
  fg_engine_null_residual(training, d->noise, &d->workspace->null[judgement->noise], y, y + n);
  double pairs = (double)n * ((double)n - 1) / 2;
  double ratio = fg_engine_exchanged_over_tail(n, d->white, y + n) - log(pairs);
  double *p = &judgement->p[judgement->candidates];
  *p = fmin(*p, fmin(exp(-ratio) / LIKELIHOOD_SHARE, 1));
  free(y);
  return FG_OK;
}

fg_status fg_engine_judge(fg_context *ctx, const fg_score_workspace *workspace,
                          const fg_loop_candidate *noise, size_t noises, const fg_engine_null *null,
                          fg_engine_judgement *judgement) {
  const fg_engine_training *training = workspace->training;
  fg_engine_noise_scores noise_scores = {0};
  fg_engine_exchange exchange = {0};
  double *white = NULL;
  fg_status status = FG_OK;
  bool few = training->n <= FG_ENGINE_SMALL_ROWS, exchanges = may_exchange(training);
  FG_TRY_EXIT(allocate_assessment(ctx, workspace->candidates, noises, judgement));
  take_kinds(workspace, noise, null, judgement);
  if (workspace->dof < 2) goto exit;
  fg_score_workspace_score_data(workspace, judgement->score, &judgement->noise);
  fg_engine_noise at = workspace->noise[judgement->noise];
  const fg_engine_span *span = &workspace->null[judgement->noise];
  FG_TRY_EXIT(fg_engine_noise_scores_open(ctx, training, at, span, noise, noises, &noise_scores));
  if (exchanges) FG_TRY_EXIT(fg_engine_exchange_open(ctx, training, at, span, &exchange));
  FG_TRY_EXIT(score_data(ctx, workspace, &noise_scores, exchanges ? &exchange : NULL, judgement));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->n, 3 * sizeof *white, (void **)&white));
  if (few) fg_engine_null_residual(training, at, span, training->y, white);
  drawing d = {
      .workspace = workspace,
      .noise_scores = &noise_scores,
      .exchange = exchanges ? &exchange : NULL,
      .null = null,
      .noise = at,
      .white = white,
      .own = white + training->n,
      .sd = sqrt(workspace->rss[judgement->noise] / (double)workspace->dof),
      .permuted = workspace->dof >= PERMUTED_DOF,
      .scores = judgement->candidates + exchanges,
      .kind = judgement->kind,
  };
  if (few) weigh_tails(span, &d);
  if (few)
    FG_TRY_EXIT(assess_in_turns(ctx, &d, judgement));
  else
    assess_by_count(workspace, null, judgement);
  fg_score_workspace_tell(workspace, 3, 3);
  for (size_t c = 0; c <= judgement->candidates; c++)
    judgement->p[c] = over_family(judgement, c);
  if (few && judgement->has_exchange) FG_TRY_EXIT(exchange_likelihood(ctx, &d, judgement));
exit:
  free(white);
  fg_engine_noise_scores_close(&noise_scores);
  fg_engine_exchange_close(&exchange);
  if (status != FG_OK) fg_engine_judgement_free(judgement);
  return status;
}

void fg_engine_judgement_free(fg_engine_judgement *judgement) {
  free(judgement->score);
  free(judgement->z);
  free(judgement->p);
  free(judgement->z_critical);
  free(judgement->f_critical);
  free(judgement->kind);
  fg_engine_family_free(&judgement->family);
  *judgement = (fg_engine_judgement){0};
}
