/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_choice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"

/* A misfit counts above so many sd of chance, and above this share of the contrast. */
#define MISSED_SDS   6.0
#define MISSED_SHARE 0.0004
/* Number of cells within a blur of each other, whose misfits are not independent. */
#define CELLS_TOGETHER 2.0

/* Min amount of sharpening, and min slope of a tone curve. */
#define AMOUNT_MIN 0.05
#define SLOPE_MIN  0.05
/* Difference of two information criteria from which the data decide for one model (exp(-5)). */
#define SCORE_CLEAR 10.0

#define FREE(value) (1u << (value))
#define GAMMA       FREE(FG_DRIVER_LN_GAMMA)
#define CENTRE      FREE(FG_DRIVER_CENTRE)
#define S_CURVE     (FREE(FG_DRIVER_STEEPNESS) | CENTRE)
#define HALO        (FREE(FG_DRIVER_HALO) | FREE(FG_DRIVER_HALO_PX))
#define MASK        (FREE(FG_DRIVER_AMOUNT) | FREE(FG_DRIVER_RADIUS))

/* The models, from the simplest on: the free values, the one of two simpler models that it starts
 * from (-1: the plain fit), and the start values. A stage is fitted only when no earlier one
 * explains the profiles. Neighbours that do not start from each other are fitted at once.
 *
 * S and unsharp mask make an edge steeper, so they start from wider blurs. A steeper S of a wider
 * edge looks much like a flatter one of a narrower edge, along a valley that is not straight: the
 * models of given steepness sum over it, where the free one's standard deviation is too small. */
static const struct family {
  unsigned free;
  int stage, from[2];
  double steepness, amount, halo, blurs;
} families[] = {
    {0, 0, {-1, -1}, 0, 0, 0, 1},
    {GAMMA, 0, {-1, -1}, 0, 0, 0, 1},
    {HALO, 0, {0, 0}, 0, 0, 0.1, 1},
    {HALO | GAMMA, 0, {1, 2}, 0, 0, 0.1, 1},
    {S_CURVE, 1, {0, 0}, 3, 0, 0, 1},
    {MASK, 1, {0, 0}, 0, 0.5, 0, 1},
    {S_CURVE | GAMMA, 1, {1, 4}, 2, 0, 0, 1},
    {MASK | GAMMA, 1, {5, 5}, 0, 0.5, 0, 1},
    {MASK | S_CURVE, 2, {4, 5}, 2, 0.3, 0, 1},
    {MASK | S_CURVE, 2, {-1, -1}, 8, 0.5, 0, 2.3},
    {MASK | CENTRE, 2, {-1, -1}, 2.5, 0.5, 0, 1.4},
    {MASK | CENTRE, 2, {-1, -1}, 4, 0.5, 0, 1.6},
    {MASK | CENTRE, 2, {-1, -1}, 5.5, 0.5, 0, 1.8},
    {MASK | CENTRE, 2, {-1, -1}, 7.5, 0.5, 0, 2.1},
    {MASK | CENTRE, 2, {-1, -1}, 10, 0.5, 0, 2.5},
};
enum { FAMILIES = sizeof families / sizeof families[0], STAGES = 3 };
#define START_RADIUS     1.2
#define VALLEY_SHARPNESS 0.25

void fg_driver_describe(const fg_driver *driver, fg_picture_state *state) {
  state->gamma = exp(driver->values[FG_DRIVER_LN_GAMMA]);
  state->tone_s = fg_driver_extra_slope(driver);
  state->sharpen_amount = fmax(driver->values[FG_DRIVER_AMOUNT], 0);
  if (state->tone_s > SLOPE_MIN) state->findings |= FG_PICTURE_TONE_CURVE;
  if (!(state->sharpen_amount > AMOUNT_MIN)) return;
  /* A mask also makes up for other defects: an S of another shape, or blocks. Only overshoot, or
   * that no other model does as well, proves it. */
  bool seen = state->findings & FG_PICTURE_SHARPENED;
  if (!seen && (!driver->sharpens || state->findings & FG_PICTURE_BLOCK_NOISE)) {
    state->sharpen_amount = NAN;
    return;
  }
  state->sharpen_radius_px = driver->values[FG_DRIVER_RADIUS];
  /* Clipped levels make an edge as steep as an unsharp mask does, and cut its overshoot off, too:
   * then a mask cannot be told from them. */
  if (!(state->findings & FG_PICTURE_CLIPPED)) state->findings |= FG_PICTURE_SHARPENED;
}

bool fg_driver_is_missed(const fg_driver_misfit *misfit, double contrast) {
  double chance = misfit->expected * (1 + MISSED_SDS * sqrt(2 / fmax(misfit->cells, 1)));
  return misfit->squares > chance && misfit->rms > MISSED_SHARE * contrast;
}

/* Fit and score of one model. */
typedef struct candidate {
  fg_driver_fit fit;
  fg_driver_misfit misfit;
  double score; /* Bayesian information criterion */
  fg_driven_profile profiles[FG_DRIVER_PROFILES];
} candidate;

static double count_free(unsigned free) {
  double n = 0;
  for (; free; free &= free - 1)
    n++;
  return n;
}

/* Score of a model. The pooled misfit stands for `misfit->cells / CELLS_TOGETHER` independent
 * cells; its own chance stays in it, so that a model gains nothing below the noise. */
static double score_of(const fg_driver_misfit *misfit, unsigned free) {
  double n = misfit->cells / CELLS_TOGETHER;
  return n * log((misfit->squares + misfit->expected) / n) + count_free(free) * log(n);
}

/* Starts a model from the better of its simpler ones, with its own values added. */
static void start_family(const struct family *family, const candidate *candidates,
                         const candidate *start, candidate *c) {
  const int *from = family->from;
  if (from[0] >= 0)
    start = &candidates[candidates[from[1]].score < candidates[from[0]].score ? from[1] : from[0]];
  unsigned added = family->free & ~start->fit.free;
  double noise = c->fit.noise;
  *c = *start;
  c->fit.noise = noise;
  c->fit.free = family->free;
  if (!(family->free & FREE(FG_DRIVER_LN_GAMMA))) c->fit.driver.values[FG_DRIVER_LN_GAMMA] = 0;
  if (added & CENTRE) c->fit.driver.values[FG_DRIVER_STEEPNESS] = family->steepness;
  if (added & FREE(FG_DRIVER_HALO)) c->fit.driver.values[FG_DRIVER_HALO] = family->halo;
  if (added & FREE(FG_DRIVER_AMOUNT)) {
    c->fit.driver.values[FG_DRIVER_AMOUNT] = family->amount;
    c->fit.driver.values[FG_DRIVER_RADIUS] = START_RADIUS;
  }
  for (size_t i = 0; i < FG_DRIVER_PROFILES; i++)
    for (int side = 0; side < 2; side++)
      c->profiles[i].values[FG_DRIVEN_BLUR_L + side] *= family->blurs;
}

/* Families that are fitted at once. */
typedef struct wave {
  size_t first, last;
  candidate *candidates; /* of all families, then the start */
  size_t count;          /* of profiles */
  bool linear;
} wave;

static fg_status try_family(fg_context *ctx, void *shared, size_t item) {
  const wave *w = shared;
  const struct family *family = &families[w->first + item];
  const candidate *start = &w->candidates[FAMILIES];
  candidate *c = &w->candidates[w->first + item];
  fg_driver_scratch *scratch = NULL;
  fg_status status = FG_OK;
  if (w->linear && family->free & (GAMMA | S_CURVE)) return FG_OK;
  FG_TRY_EXIT(fg_driver_scratch_create(ctx, &scratch));
  c->fit.noise = start->fit.noise;
  start_family(family, w->candidates, start, c);
  FG_TRY_EXIT(fg_driver_fit_profiles(ctx, c->profiles, w->count, &c->fit));
  fg_driver_find_misfit(c->profiles, w->count, &c->fit.driver, scratch, &c->misfit);
  c->score = c->fit.good ? score_of(&c->misfit, family->free) : INFINITY;
exit:
  fg_driver_scratch_free(scratch);
  return status;
}

/* Returns true when a family starts from one of `first` or later. */
static bool starts_within(const struct family *family, size_t first) {
  return family->from[0] >= (int)first || family->from[1] >= (int)first;
}

/* Fits the families of one stage, from w->last on. */
static fg_status try_stage(fg_context *ctx, unsigned threads, int stage, wave *w) {
  while (w->last < FAMILIES && families[w->last].stage == stage) {
    w->first = w->last++;
    while (w->last < FAMILIES && families[w->last].stage == stage &&
           !starts_within(&families[w->last], w->first))
      w->last++;
    FG_TRY(fg_parallel_run(ctx, threads, w->last - w->first, try_family, w));
  }
  return FG_OK;
}

/* Models from `first` on that miss by more than a simpler one before them are out: those of wider
 * edges have more cells, and would lead by their number. */
static void leave_out_worse(candidate *candidates, size_t first, size_t last) {
  double rms = INFINITY;
  for (size_t i = 0; i < first; i++)
    if (candidates[i].fit.good) rms = fmin(rms, candidates[i].misfit.rms);
  for (size_t i = first; i < last; i++)
    if (!(candidates[i].misfit.rms < rms)) candidates[i].score = INFINITY;
}

/* Returns the best model, and the edges' place over all models, each weighing exp(-score/2). Where
 * S and unsharp mask compete every model misses a little, by as much as they differ. `sharpness`
 * below 1 lets more of them count. */
static size_t weigh_models(const candidate *candidates, double sharpness, double *u_edge_px) {
  size_t best = 0;
  double weights = 0, square = 0;
  for (size_t i = 1; i < FAMILIES; i++)
    if (candidates[i].fit.good && candidates[i].score < candidates[best].score) best = i;
  for (size_t i = 0; i < FAMILIES; i++) {
    const candidate *c = &candidates[i];
    double weight = exp(-0.5 * sharpness * (c->score - candidates[best].score));
    if (!c->fit.good || !isfinite(weight)) continue;
    double off = c->fit.edge_px - candidates[best].fit.edge_px;
    weights += weight;
    square += weight * (off * off + c->fit.u_edge_px * c->fit.u_edge_px);
  }
  *u_edge_px = sqrt(square / weights);
  return best;
}

/* Returns true when the best model has a mask, and those without one are far behind. When the best
 * misses too, the order among models means nothing. */
static bool is_sharpened(const candidate *candidates, size_t best, bool missed) {
  double without = INFINITY;
  for (size_t i = 0; i < FAMILIES; i++)
    if (candidates[i].fit.good && !(candidates[i].fit.free & FREE(FG_DRIVER_AMOUNT)))
      without = fmin(without, candidates[i].score);
  return !missed && candidates[best].score + SCORE_CLEAR < without;
}

fg_status fg_driver_choose(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                           const double ends[2], double gamma, double noise,
                           fg_driver_choice *choice) {
  candidate *candidates = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, FAMILIES + 1, sizeof *candidates, (void **)&candidates));
  candidate *start = &candidates[FAMILIES];
  start->fit = (fg_driver_fit){.driver = fg_driver_none(ends), .noise = noise};
  start->fit.driver.values[FG_DRIVER_LN_GAMMA] = log(gamma);
  memcpy(start->profiles, profiles, count * sizeof *profiles);
  wave w = {.candidates = candidates, .count = count, .linear = choice->linear};
  size_t best = 0;
  choice->missed = true;
  for (int stage = 0; stage < STAGES && choice->missed; stage++) {
    size_t first = w.last;
    FG_TRY_EXIT(try_stage(ctx, choice->threads, stage, &w));
    leave_out_worse(candidates, first, w.last);
    best = weigh_models(candidates, stage == STAGES - 1 ? VALLEY_SHARPNESS : 1, &choice->u_edge_px);
    choice->missed = fg_driver_is_missed(&candidates[best].misfit, ends[1] - ends[0]);
  }
  choice->fit = candidates[best].fit;
  choice->fit.driver.sharpens = is_sharpened(candidates, best, choice->missed);
  choice->misfit = candidates[best].misfit;
  memcpy(profiles, candidates[best].profiles, count * sizeof *profiles);
exit:
  free(candidates);
  return status;
}
