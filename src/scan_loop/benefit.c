/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/benefit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Size of a correction, as a share of the value's uncertainty, below which nothing is decided: with
 * its own uncertainty it changes u by half a percent. */
#define SMALL_SHARE 0.1
/* m² > 2 u² (see the header). */
#define BENEFIT_RATIO 2.0
/* For a free curve. The curve itself is significant, but its effect on a dimension is another sum
 * of its many coefficients than the one that was tested, so it must be significant by itself (chi²
 * of 1, 1 in 100). */
#define CURVE_BENEFIT_RATIO 6.63
/* Share of the mean move below which the agreed move counts as zero: moving by it would gain 6 % of
 * the mean's gain. */
#define AGREED_SHARE 0.25
/* Steps to the shortest point between explanations, and the share of its square that ends them. */
enum { SHORTEST_STEPS = 1000 };
#define SHORTEST_END 1e-9
/* Share of the shortest move's gain that every explanation keeps on the way to the mean; number of
 * bisections of that way. */
#define KEPT_GAIN 0.5
enum { AGREED_STEPS = 30 };

static bool is_measured(const fg_foil *foil) {
  return !(foil->flags & FG_FOIL_NOT_MEASURED);
}

static fg_status open_items(fg_context *ctx, size_t count, fg_benefit *benefit) {
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *benefit->item, (void **)&benefit->item));
  benefit->items = count;
  return FG_OK;
}

static fg_status open_foil(fg_context *ctx, const fg_foil *foil, fg_benefit *benefit) {
  FG_TRY(open_items(ctx, foil->bump_count + 1, benefit));
  for (size_t i = 0; i < benefit->items; i++) {
    const fg_bump *bump = i < foil->bump_count ? &foil->bumps[i] : NULL;
    benefit->item[i].u[FG_CORRECTED_OVERALL_RADIUS] = foil->overall.u_radius_mm;
    benefit->item[i].u[FG_CORRECTED_RADIUS] = bump ? bump->u_radius_mm : NAN;
    benefit->item[i].u[FG_CORRECTED_HEIGHT] = bump ? bump->u_height_mm : NAN;
  }
  return FG_OK;
}

fg_status fg_benefits_open(fg_context *ctx, const fg_measurement *before, fg_benefits *benefits) {
  fg_status status = FG_OK;
  *benefits = (fg_benefits){.foil = NULL};
  FG_TRY_EXIT(fg_memory_allocate(ctx, before->foil_count, sizeof *benefits->foil,
                                 (void **)&benefits->foil));
  for (; benefits->foils < before->foil_count; benefits->foils++)
    FG_TRY_EXIT(open_foil(ctx, &before->foils[benefits->foils], &benefits->foil[benefits->foils]));
  FG_TRY_EXIT(open_items(ctx, before->disc_count, &benefits->discs));
  for (size_t d = 0; d < before->disc_count; d++)
    for (int k = 0; k < FG_CORRECTED; k++)
      benefits->discs.item[d].u[k] = k == FG_CORRECTED_RADIUS ? before->discs[d].u_radius_mm : NAN;
exit:
  if (status != FG_OK) fg_benefits_close(benefits);
  return status;
}

void fg_benefits_close(fg_benefits *benefits) {
  for (size_t f = 0; f < benefits->foils; f++)
    free(benefits->foil[f].item);
  free(benefits->foil);
  free(benefits->discs.item);
  *benefits = (fg_benefits){.foil = NULL};
}

/* ---- moves ---- */

static bool same_bumps(const fg_foil *a, const fg_foil *b) {
  if (!is_measured(a) || !is_measured(b) || a->bump_count != b->bump_count) return false;
  for (size_t i = 0; i < a->bump_count; i++)
    if (a->bumps[i].number != b->bumps[i].number) return false;
  return true;
}

/* From one measurement of a foil to another; behind the bumps R0 alone. */
static void moves_of(const fg_foil *from, const fg_foil *to, size_t item,
                     double move[FG_CORRECTED]) {
  bool bump = item < from->bump_count;
  move[FG_CORRECTED_OVERALL_RADIUS] = to->overall.radius_mm - from->overall.radius_mm;
  move[FG_CORRECTED_RADIUS] = bump ? to->bumps[item].radius_mm - from->bumps[item].radius_mm : NAN;
  move[FG_CORRECTED_HEIGHT] = bump ? to->bumps[item].height_mm - from->bumps[item].height_mm : NAN;
}

/* Replaces the moves of an explanation that shows other bumps by those of the one in force, so that
 * scans of one foil have the same explanations. */
static void copy_moves_in_force(fg_benefit *benefit, size_t at) {
  benefit->centre[at] = benefit->centre[0];
  for (size_t i = 0; i < benefit->items; i++) {
    memcpy(benefit->item[i].move[at], benefit->item[i].move[0], sizeof benefit->item[i].move[at]);
    benefit->item[i].turn_deg[at] = benefit->item[i].turn_deg[0];
  }
}

static void add_foil_moves(fg_benefit *benefit, const fg_foil *before, const fg_foil *corrected) {
  if (!is_measured(before) || benefit->lost || benefit->explanations == FG_BENEFIT_EXPLANATIONS_MAX)
    return;
  size_t at = benefit->explanations++;
  if (!same_bumps(before, corrected)) {
    if (at) copy_moves_in_force(benefit, at);
    benefit->lost = !at;
    return;
  }
  benefit->centre[at] = (fg_point){corrected->overall.centre_mm.x - before->overall.centre_mm.x,
                                   corrected->overall.centre_mm.y - before->overall.centre_mm.y};
  for (size_t i = 0; i < benefit->items; i++) {
    moves_of(before, corrected, i, benefit->item[i].move[at]);
    if (i < before->bump_count)
      benefit->item[i].turn_deg[at] =
          remainder(corrected->bumps[i].position_deg - before->bumps[i].position_deg, 360);
  }
}

static void add_discs(fg_benefit *benefit, const fg_measurement *before,
                      const fg_measurement *corrected) {
  if (benefit->explanations == FG_BENEFIT_EXPLANATIONS_MAX) return;
  size_t at = benefit->explanations++;
  for (size_t d = 0; d < benefit->items; d++)
    for (int k = 0; k < FG_CORRECTED; k++)
      benefit->item[d].move[at][k] =
          k == FG_CORRECTED_RADIUS ? corrected->discs[d].radius_mm - before->discs[d].radius_mm
                                   : NAN;
}

void fg_benefits_add(fg_benefits *benefits, const fg_measurement *before,
                     const fg_measurement *corrected) {
  for (size_t f = 0; f < benefits->foils; f++)
    add_foil_moves(&benefits->foil[f], &before->foils[f], &corrected->foils[f]);
  add_discs(&benefits->discs, before, corrected);
}

static void weigh(fg_benefit *benefit, const fg_benefit_weights *weights) {
  benefit->mean = true;
  benefit->curve = weights->curve;
  benefit->misfit = weights->loose;
  for (size_t e = 0; e < FG_BENEFIT_EXPLANATIONS_MAX; e++)
    benefit->weight[e] = e < weights->count ? weights->weight[e] : 0;
}

void fg_benefits_weigh(fg_benefits *benefits, const fg_benefit_weights *weights) {
  for (size_t f = 0; f < benefits->foils; f++)
    weigh(&benefits->foil[f], weights);
  weigh(&benefits->discs, weights);
}

double fg_benefit_weight(const fg_benefit *benefit, size_t explanation) {
  double sum = 0;
  for (size_t e = 0; e < benefit->explanations; e++)
    sum += benefit->weight[e];
  return sum > 0 ? benefit->weight[explanation] / sum : 1 / (double)benefit->explanations;
}

/* ---- noise ---- */

void fg_benefit_add_noise(fg_benefit *benefit, size_t item,
                          double noise[FG_CORRECTED][FG_CORRECTED]) {
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++)
      benefit->item[item].noise[a][b] += noise[a][b];
}

static void add_step(fg_benefit *benefit, size_t item, const double step[FG_CORRECTED]) {
  double noise[FG_CORRECTED][FG_CORRECTED];
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++)
      noise[a][b] = isfinite(step[a] * step[b]) ? step[a] * step[b] : 0;
  fg_benefit_add_noise(benefit, item, noise);
}

void fg_benefits_add_step(fg_benefits *benefits, const fg_measurement *corrected,
                          const fg_measurement *stepped) {
  double step[FG_CORRECTED] = {0};
  for (size_t f = 0; f < benefits->foils; f++) {
    const fg_foil *from = &corrected->foils[f], *to = &stepped->foils[f];
    if (!same_bumps(from, to)) continue;
    benefits->foil[f].noises = 1;
    for (size_t i = 0; i < benefits->foil[f].items && i <= from->bump_count; i++) {
      moves_of(from, to, i, step);
      add_step(&benefits->foil[f], i, step);
    }
  }
  for (size_t d = 0; d < benefits->discs.items; d++) {
    memset(step, 0, sizeof step);
    step[FG_CORRECTED_RADIUS] = stepped->discs[d].radius_mm - corrected->discs[d].radius_mm;
    benefits->discs.noises = 1;
    add_step(&benefits->discs, d, step);
  }
}

/* ---- the rule ---- */

/* Sums of one dimension over all items and views, mm²: products of the explanations' moves, of
 * their noise, and of the values' own u². */
typedef struct sums {
  double items, noise, own;
  bool curve;   /* an explanation is a free curve */
  bool mean;    /* the mean of the moves is that over all models */
  bool misfit;  /* which do not follow all of the residual */
  bool refused; /* by known sizes */
  double product[FG_BENEFIT_EXPLANATIONS_MAX][FG_BENEFIT_EXPLANATIONS_MAX];
  double weight[FG_BENEFIT_EXPLANATIONS_MAX]; /* sum 1 */
  size_t explanations;
} sums;

static double noise_of(const fg_benefit *benefit, size_t item, int a, int b) {
  return benefit->noises > 0 ? benefit->item[item].noise[a][b] / benefit->noises : 0;
}

static bool is_known(const fg_benefit *benefit, size_t item, int k) {
  for (size_t e = 0; e < benefit->explanations; e++)
    if (!isfinite(benefit->item[item].move[e][k])) return false;
  return benefit->explanations > 0;
}

static void sum_up_dimension(const fg_benefit *benefit, int k, sums *s) {
  if (benefit->explanations > s->explanations) {
    s->explanations = benefit->explanations;
    for (size_t e = 0; e < s->explanations; e++)
      s->weight[e] = fg_benefit_weight(benefit, e);
  }
  s->curve = s->curve || benefit->curve;
  s->mean = s->mean || benefit->mean;
  s->misfit = s->misfit || benefit->misfit;
  s->refused = s->refused || benefit->refused;
  for (size_t i = 0; i < benefit->items; i++) {
    const fg_benefit_item *item = &benefit->item[i];
    if (!is_known(benefit, i, k)) continue;
    s->items++;
    s->noise += noise_of(benefit, i, k, k);
    s->own += item->u[k] * item->u[k];
    for (size_t a = 0; a < benefit->explanations; a++)
      for (size_t b = 0; b < benefit->explanations; b++)
        s->product[a][b] += item->move[a][k] * item->move[b][k];
  }
}

/* Products of the move that is made of these parts: with one explanation's, and with itself. */
static double move_products(const sums *s, const double *part, size_t explanation) {
  double sum = 0;
  for (size_t e = 0; e < s->explanations; e++)
    sum += part[e] * s->product[explanation][e];
  return sum;
}

static double size_of(const sums *s, const double *part) {
  double sum = 0;
  for (size_t e = 0; e < s->explanations; e++)
    sum += part[e] * move_products(s, part, e);
  return sum;
}

/* Weighted mean square of how far the explanations lie from the move. */
static double scatter_about(const sums *s, const double *part) {
  double sum = 0, size = size_of(s, part);
  if (s->explanations < 2) return 0;
  for (size_t e = 0; e < s->explanations; e++)
    sum += s->weight[e] * (s->product[e][e] - 2 * move_products(s, part, e) + size);
  return fmax(0, sum);
}

static void fill_mean(const sums *s, double *part) {
  for (size_t e = 0; e < FG_BENEFIT_EXPLANATIONS_MAX; e++)
    part[e] = e < s->explanations ? s->weight[e] : 0;
}

/* Finds the shortest move: steps towards the explanation of the smallest gain, until its gain
 * equals that of the others (Gilbert 1966). */
static void fill_shortest(const sums *s, double *part) {
  fill_mean(s, part);
  for (int step = 0; step < SHORTEST_STEPS && s->explanations > 1; step++) {
    size_t worst = 0;
    for (size_t e = 1; e < s->explanations; e++)
      if (move_products(s, part, e) < move_products(s, part, worst)) worst = e;
    double size = size_of(s, part), min = move_products(s, part, worst);
    double apart = size - 2 * min + s->product[worst][worst];
    if (!(size - min > SHORTEST_END * size) || !(apart > 0)) return;
    double share = fmin(1, (size - min) / apart);
    for (size_t e = 0; e < s->explanations; e++)
      part[e] = (1 - share) * part[e] + (e == worst ? share : 0);
  }
}

/* Returns true when every explanation gains at least `min`. */
static bool all_gain(const sums *s, const double *part, double min) {
  double size = size_of(s, part);
  for (size_t e = 0; e < s->explanations; e++)
    if (2 * move_products(s, part, e) - size < min) return false;
  return true;
}

/* Finds the agreed move: from the shortest one towards the mean, which is best on average, as far
 * as every explanation keeps its share of the shortest one's gain. Returns that gain. */
static double fill_agreed(const sums *s, double *part) {
  double shortest[FG_BENEFIT_EXPLANATIONS_MAX], mean[FG_BENEFIT_EXPLANATIONS_MAX];
  double low = 0, high = 1;
  fill_shortest(s, shortest);
  fill_mean(s, mean);
  memcpy(part, shortest, sizeof shortest);
  double gain = size_of(s, shortest);
  for (int step = 0; step < AGREED_STEPS && s->explanations > 1; step++) {
    double share = step ? 0.5 * (low + high) : high;
    double tried[FG_BENEFIT_EXPLANATIONS_MAX] = {0};
    for (size_t e = 0; e < s->explanations; e++)
      tried[e] = (1 - share) * shortest[e] + share * mean[e];
    bool good = all_gain(s, tried, KEPT_GAIN * gain);
    if (good) memcpy(part, tried, sizeof tried);
    if (good && !step) break;
    *(good ? &low : &high) = share;
  }
  return gain;
}

/* Decides: `part` gets the move that the explanations agree about, else their mean. */
static fg_correction_reason decide_move(const sums *s, double *part) {
  double agreed[FG_BENEFIT_EXPLANATIONS_MAX];
  fill_mean(s, part);
  if (s->items < 1) return FG_CORRECTION_NONE;
  if (s->refused) return FG_CORRECTION_DOUBTFUL;
  double mean = size_of(s, part), scatter = scatter_about(s, part);
  if (mean + s->noise + scatter <= SMALL_SHARE * SMALL_SHARE * s->own) return FG_CORRECTION_SMALL;
  if (s->mean) {
    bool helps = !s->misfit && mean > (s->curve ? CURVE_BENEFIT_RATIO : 1) * (s->noise + scatter);
    return helps ? FG_CORRECTION_HELPS : FG_CORRECTION_DOUBTFUL;
  }
  double gain = fill_agreed(s, agreed);
  double ratio = s->curve ? CURVE_BENEFIT_RATIO : BENEFIT_RATIO;
  if (!(gain > ratio * s->noise) || !(gain >= AGREED_SHARE * AGREED_SHARE * mean))
    return scatter > s->noise ? FG_CORRECTION_TIED : FG_CORRECTION_DOUBTFUL;
  memcpy(part, agreed, sizeof agreed);
  return FG_CORRECTION_HELPS;
}

static double move_of(const fg_benefit *benefit, size_t item, int k, const double *part) {
  double sum = 0;
  for (size_t e = 0; e < benefit->explanations; e++)
    sum += part[e] * benefit->item[item].move[e][k];
  return sum;
}

/* R0 has its sign; of many values the root of the mean square. */
static void report_choice(const fg_benefit *benefit, int k, const double *part,
                          fg_correction_choice *choice) {
  sums s = {.items = 0};
  sum_up_dimension(benefit, k, &s);
  choice->move_mm = sqrt(size_of(&s, part) / s.items);
  choice->u_move_mm = sqrt((s.noise + scatter_about(&s, part)) / s.items);
  if (k == FG_CORRECTED_OVERALL_RADIUS && s.items > 0)
    choice->move_mm = move_of(benefit, benefit->items - 1, k, part);
}

static void put_decision(const fg_benefit *benefit, int k, const double *part,
                         fg_benefit_decision *decision) {
  fg_correction_choice *choice = &decision->choice[k];
  report_choice(benefit, k, part, choice);
  for (size_t e = 0; e < FG_BENEFIT_EXPLANATIONS_MAX; e++)
    decision->part[k][e] = choice->moved ? part[e] : 0;
}

void fg_benefit_decide(const fg_benefit *const *benefit, size_t count,
                       fg_benefit_decision *const *decision) {
  fg_correction_reason reason[FG_CORRECTED];
  double part[FG_CORRECTED][FG_BENEFIT_EXPLANATIONS_MAX];
  bool moved = false, left = false, lost = false;
  for (size_t i = 0; i < count; i++)
    lost = lost || benefit[i]->lost;
  for (int k = 0; k < FG_CORRECTED; k++) {
    sums s = {.items = 0};
    for (size_t i = 0; i < count; i++)
      sum_up_dimension(benefit[i], k, &s);
    reason[k] = decide_move(&s, part[k]);
    if (lost) reason[k] = FG_CORRECTION_LOST;
    moved = moved || reason[k] == FG_CORRECTION_HELPS;
    left = left || reason[k] >= FG_CORRECTION_DOUBTFUL;
  }
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < FG_CORRECTED; k++) {
      bool follows = reason[k] == FG_CORRECTION_SMALL && (moved || !left);
      decision[i]->choice[k] = (fg_correction_choice){
          .reason = reason[k], .moved = reason[k] == FG_CORRECTION_HELPS || follows};
      put_decision(benefit[i], k, part[k], decision[i]);
    }
}

void fg_benefit_move(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                     double move[FG_CORRECTED]) {
  for (int k = 0; k < FG_CORRECTED; k++)
    move[k] = decision->choice[k].moved ? move_of(benefit, item, k, decision->part[k]) : 0;
}

void fg_benefit_moment(const fg_benefit *benefit, size_t item, const fg_benefit_decision *decision,
                       double moment[FG_CORRECTED][FG_CORRECTED]) {
  double made[FG_CORRECTED];
  fg_benefit_move(benefit, item, decision, made);
  for (int a = 0; a < FG_CORRECTED; a++)
    for (int b = 0; b < FG_CORRECTED; b++) {
      moment[a][b] = noise_of(benefit, item, a, b);
      for (size_t e = 0; e < benefit->explanations; e++) {
        const double *move = benefit->item[item].move[e];
        double product = (move[a] - made[a]) * (move[b] - made[b]);
        if (isfinite(product)) moment[a][b] += fg_benefit_weight(benefit, e) * product;
      }
    }
}

bool fg_benefit_is_whole(const fg_benefit *benefit, const fg_benefit_decision *decision) {
  if (benefit->explanations > 1 || benefit->misfit || benefit->refused || benefit->lost)
    return false;
  for (int k = 0; k < FG_CORRECTED; k++)
    if (!decision->choice[k].moved && decision->choice[k].reason != FG_CORRECTION_NONE)
      return false;
  return true;
}
