/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/cycles.h"

#include <math.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

/* P-value of the periods' distance from orders of one base, above which they are one effect. */
#define JOINED_P 0.001
/* Largest distance of a ratio of periods from one of whole numbers, relative. */
#define OFF_RATIO 0.1
/* Largest order of the longer of two periods in their base. */
enum { BASE_ORDER = 4 };
/* Other orders of a known base, and other periods, that stand beside a cycle where a curve is held
 * against it. */
enum { KNOWN_ORDERS = 6, OTHER_PERIODS = 2 };
/* A sought period that returns less often may be the stretch of a bend. */
enum { REPEATS = 3 };

bool fg_engine_is_over_order(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  const fg_loop_effect *effect = candidate->effect;
  bool sequence = problem->coordinate[candidate->a].roles & (FG_LOOP_ORDER | FG_LOOP_BUMP);
  return !strcmp(effect->frame, "order") || (effect->cycle && sequence);
}

bool fg_engine_has_orders(const fg_loop_candidate *candidate) {
  return (candidate->orders & (candidate->orders - 1)) != 0;
}

static uint64_t order_bit(size_t k) {
  return (uint64_t)1 << (k - 1);
}

static size_t nearest_order(double base, double period) {
  double k = round(base / period);
  return k >= 1 && k <= FG_LOOP_ORDER_MAX ? (size_t)k : 0;
}

/* Returns the cycles that the range has in a start value's period, in half cycles. */
static size_t half_cycles(const fg_loop_coordinate *at, double period) {
  return (size_t)round(2 * (at->high - at->low) / period);
}

/* Gain of a candidate by order: of its known base, or of twice the range. */
static void list_gains(const fg_engine_run *run, const fg_engine_step *step, size_t c,
                       double gain[FG_LOOP_ORDER_MAX + 2]) {
  const fg_score_workspace *workspace = &step->workspace;
  const fg_loop_coordinate *at = &run->problem->coordinate[run->candidate[c].a];
  const double *own = workspace->gain + step->judgement.noise * workspace->versions;
  bool held = run->candidate[c].effect->held;
  for (size_t k = 0; k <= FG_LOOP_ORDER_MAX + 1; k++)
    gain[k] = 0;
  for (size_t v = 0; v < workspace->versions; v++) {
    if (workspace->version[v].candidate != c) continue;
    double period = workspace->shape[v][0];
    size_t k = held ? nearest_order(at->period, period) : half_cycles(at, period);
    if (k <= FG_LOOP_ORDER_MAX) gain[k] = own[v];
  }
}

/* Moves the largest gain to the orders, and forgets it. */
static size_t take_largest(double gain[FG_LOOP_ORDER_MAX + 2], size_t lowest) {
  size_t best = 0;
  for (size_t k = lowest; k <= FG_LOOP_ORDER_MAX; k++)
    if (gain[k] > (best ? gain[best] : 0)) best = k;
  if (best) gain[best] = 0;
  return best;
}

/* A period between two half cycles shows in both. */
static uint64_t take_peak(double gain[FG_LOOP_ORDER_MAX + 2]) {
  size_t k = take_largest(gain, 2 * REPEATS);
  if (!k) return 0;
  size_t beside = gain[k - 1] > gain[k + 1] || k == FG_LOOP_ORDER_MAX ? k - 1 : k + 1;
  gain[k - 1] = gain[k + 1] = gain[beside] = 0;
  return order_bit(k) | order_bit(beside);
}

void fg_engine_cycle_with_others(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                                 fg_engine_stand *whole) {
  const fg_engine_stand *cycle = &step->stand[stand];
  const fg_loop_coordinate *at = &run->problem->coordinate[cycle->candidate.a];
  double gain[FG_LOOP_ORDER_MAX + 2];
  *whole = *cycle;
  if (!cycle->candidate.effect->cycle) return;
  bool held = cycle->candidate.effect->held;
  size_t own = held ? nearest_order(at->period, cycle->shape[0]) : half_cycles(at, cycle->shape[0]);
  if (!own || own > FG_LOOP_ORDER_MAX || (!held && own < 2 * REPEATS)) return;
  list_gains(run, step, stand, gain);
  whole->shape[0] = held ? at->period : cycle->shape[0] * (double)own;
  whole->candidate.orders = order_bit(own);
  gain[own] = 0;
  if (!held) gain[own - 1] = gain[own + 1] = 0;
  for (size_t i = 0; i < (held ? KNOWN_ORDERS : OTHER_PERIODS); i++) {
    size_t k = held ? take_largest(gain, 1) : 0;
    whole->candidate.orders |= !held ? take_peak(gain) : k ? order_bit(k) : 0;
  }
}

static bool may_replace(const fg_engine_run *run, const fg_loop_candidate *winner,
                        const fg_loop_candidate *other) {
  if (!winner->effect->cycle || winner->effect->held || !other->effect->cycle) return false;
  if (other->effect->held && other->a == winner->a) return true;
  return fg_engine_is_over_order(run->problem, winner) &&
         !fg_engine_is_over_order(run->problem, other);
}

fg_status fg_engine_prefer_base(fg_context *ctx, const fg_engine_run *run,
                                const fg_engine_step *step, fg_engine_noise noise, size_t *winner) {
  const fg_engine_stand *searched = &step->stand[*winner];
  double best = -INFINITY;
  size_t known = run->means;
  for (size_t c = 0; c < run->means; c++) {
    double p;
    if (!may_replace(run, &searched->candidate, &run->candidate[c]) || !(step->stand[c].z > best) ||
        !(fg_engine_stand_p(run, step, c) < run->options.accept_p))
      continue;
    FG_TRY(fg_engine_beside(ctx, &step->training, noise, &step->stand[c], searched, &p));
    if (p < FG_ENGINE_SHOWS) continue;
    best = step->stand[c].z;
    known = c;
  }
  if (known < run->means) *winner = known;
  return FG_OK;
}

/* One cycle that may stand for two of a set. */
typedef struct joint_cycle {
  fg_engine_stand stand;
  double freed; /* numbers that the two had, and the one has not */
} joint_cycle;

/* The orders of a cycle, each multiplied by a factor; 0 where one would be too high. */
static uint64_t multiply_orders(const fg_loop_candidate *cycle, size_t factor) {
  uint64_t orders = 0;
  for (size_t k = 1; k <= FG_LOOP_ORDER_MAX; k++) {
    if (!fg_loop_has_order(cycle, k)) continue;
    if (k * factor > FG_LOOP_ORDER_MAX) return 0;
    orders |= order_bit(k * factor);
  }
  return orders;
}

static size_t count_orders(uint64_t orders) {
  size_t count = 0;
  for (; orders; orders &= orders - 1)
    count++;
  return count;
}

/* The n-th base in which `first` is order p and `second` order q of the same period; false where
 * their ratio is not nearly p / q. */
static bool join_at(const fg_engine_stand *first, const fg_engine_stand *second, size_t p,
                    joint_cycle *joint) {
  double ratio = first->shape[0] * (double)p / second->shape[0];
  size_t q = nearest_order(ratio, 1);
  if (!q || fabs(ratio / (double)q - 1) > OFF_RATIO) return false;
  uint64_t a = multiply_orders(&first->candidate, p), b = multiply_orders(&second->candidate, q);
  if (!a || !b || a & b || count_orders(a | b) > FG_LOOP_ORDERS) return false;
  joint->stand = *first;
  joint->stand.candidate.orders = a | b;
  joint->stand.shape[0] = first->shape[0] * (double)p;
  joint->freed = !first->candidate.effect->held + !second->candidate.effect->held -
                 !joint->stand.candidate.effect->held;
  return true;
}

static void put_joint(const fg_engine_set *from, size_t a, size_t b, const joint_cycle *joint,
                      fg_engine_set *set) {
  *set = *from;
  set->candidate[a] = joint->stand.candidate;
  memcpy(set->shape[a], joint->stand.shape, sizeof set->shape[a]);
  fg_engine_set_remove(set, b);
}

/* Tests whether one base loses nothing that the data can show. */
static fg_status one_base_suffices(fg_context *ctx, const fg_engine_run *run, size_t a, size_t b,
                                   joint_cycle *joint, bool *suffices) {
  fg_engine_set set;
  double free_sum, sum, dof = -(double)run->problem->parameters;
  for (size_t i = 0; i < run->problem->rows; i++)
    dof += run->train[i];
  put_joint(&run->set, a, b, joint, &set);
  for (size_t m = 0; m < run->set.count; m++)
    dof -= (double)fg_engine_candidate_columns(run->problem, &run->set.candidate[m]);
  FG_TRY(fg_engine_refine(ctx, run->problem, run->train, run->noise, &set));
  FG_TRY(fg_engine_residual_sum(ctx, run->problem, run->train, run->noise, &run->set, &free_sum));
  FG_TRY(fg_engine_residual_sum(ctx, run->problem, run->train, run->noise, &set, &sum));
  size_t at = a < b ? a : a - 1;
  memcpy(joint->stand.shape, set.shape[at], sizeof joint->stand.shape);
  dof = fmax(dof - 2, 1);
  double f = (sum - free_sum) / joint->freed / (free_sum / dof);
  *suffices = joint->freed < 1 || gsl_cdf_fdist_Q(fmax(f, 0), joint->freed, dof) > JOINED_P;
  return FG_OK;
}

/* Without the other claims' columns, what could be meant instead of the joint cycle? */
static fg_status find_class(fg_context *ctx, fg_engine_run *run, size_t m) {
  fg_loop_claim *claim = &run->result->claim[m];
  fg_engine_set others = run->set;
  fg_engine_stand own = {.candidate = run->set.candidate[m]};
  fg_engine_step step;
  memcpy(own.shape, run->set.shape[m], sizeof own.shape);
  fg_engine_set_remove(&others, m);
  FG_TRY(fg_engine_step_open(ctx, run, &others, false, &step));
  claim->aliases = claim->aliases_unlisted = 0;
  fg_status status =
      fg_engine_alias_class(ctx, &step.training, run->noise, step.stand, step.stands, &own, claim);
  claim->verdict = claim->aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
  fg_engine_step_close(&step);
  return status;
}

static fg_status join_claims(fg_context *ctx, fg_engine_run *run, size_t a, size_t b,
                             const joint_cycle *joint) {
  fg_engine_set set;
  fg_loop_claim *kept = &run->result->claim[a], *gone = &run->result->claim[b];
  put_joint(&run->set, a, b, joint, &set);
  kept->candidate = joint->stand.candidate;
  kept->p_value = fmin(kept->p_value, gone->p_value);
  kept->cv_gain += gone->cv_gain;
  kept->cv_gain_se = hypot(kept->cv_gain_se, gone->cv_gain_se);
  fg_engine_candidate_name(run->problem, &kept->candidate, kept->name);
  fg_engine_drop_claim(run, b);
  run->set = set;
  return find_class(ctx, run, a < b ? a : a - 1);
}

/* Joins two claims, if they are orders of one base; one of a known base is the first. */
static fg_status join_two(fg_context *ctx, fg_engine_run *run, size_t a, size_t b, bool *joined) {
  fg_engine_stand one[2] = {{.candidate = run->set.candidate[a]},
                            {.candidate = run->set.candidate[b]}};
  size_t highest = one[0].candidate.effect->held ? 1 : BASE_ORDER;
  memcpy(one[0].shape, run->set.shape[a], sizeof one[0].shape);
  memcpy(one[1].shape, run->set.shape[b], sizeof one[1].shape);
  for (size_t p = 1; p <= highest; p++) {
    joint_cycle joint;
    bool suffices;
    if (!join_at(&one[0], &one[1], p, &joint)) continue;
    FG_TRY(one_base_suffices(ctx, run, a, b, &joint, &suffices));
    if (!suffices) continue;
    *joined = true;
    return join_claims(ctx, run, a, b, &joint);
  }
  return FG_OK;
}

/* A claim of a known base has that base as its shape, and its order. */
static void name_orders(fg_engine_run *run) {
  for (size_t m = 0; m < run->result->claims; m++) {
    fg_loop_candidate *candidate = &run->set.candidate[m];
    double base = run->problem->coordinate[candidate->a].period;
    if (!candidate->effect->held || candidate->orders) continue;
    size_t k = nearest_order(base, run->set.shape[m][0]);
    if (!k) continue;
    candidate->orders = order_bit(k);
    run->result->claim[m].candidate = *candidate;
    run->set.shape[m][0] = base;
  }
}

fg_status fg_engine_join_cycles(fg_context *ctx, fg_engine_run *run) {
  name_orders(run);
  for (size_t a = 0; a < run->result->claims; a++)
    for (size_t b = 0; b < run->result->claims; b++) {
      const fg_loop_candidate *x = &run->set.candidate[a], *y = &run->set.candidate[b];
      bool joined = false, known = x->effect->held || y->effect->held;
      if (a == b || !fg_engine_same_cycle(x, y) || (known ? !x->effect->held : a > b)) continue;
      FG_TRY(join_two(ctx, run, a, b, &joined));
      if (!joined) continue;
      FG_TRY(fg_engine_refine(ctx, run->problem, run->train, run->noise, &run->set));
      return fg_engine_join_cycles(ctx, run);
    }
  return FG_OK;
}
