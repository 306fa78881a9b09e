/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/statistics/assembly.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "foilgauge/density.h"
#include "foilgauge/distribution.h"
#include "foilgauge/report.h"

const double fg_assembly_probability[FG_ASSEMBLY_QUANTILES] = {0.05, 0.25, 0.5, 0.75, 0.95};

/* Size of the bootstrap: sets of foils, and bearings of each. The scatter of the bearings is
 * subtracted, so that 200 × 250 tell as much about the foils as many more would. */
enum { SETS = 200, BEARINGS_OF_A_SET = 250 };

const fg_quantity *fg_assembly_row(size_t value) {
  static const char *const names[FG_ASSEMBLY_VALUES] = {"circularity_mm", "min_mm",
                                                        "centred_min_mm"};
  return fg_quantity_find(FG_QUANTITY_OF_BEARING, names[value]);
}

/* Returns the quantile of a beta distribution by bisection: GSL's own inverse does not always
 * converge. */
static double beta_quantile(double probability, double a, double b) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; i++) {
    double middle = (low + high) / 2;
    if (gsl_cdf_beta_P(middle, a, b) < probability)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

void fg_assembly_interval(double count, double of, double confidence, double *low, double *high) {
  double tail = (1 - confidence) / 2;
  *low = count > 0 ? beta_quantile(tail, count, of - count + 1) : 0;
  *high = count < of ? beta_quantile(1 - tail, count + 1, of - count) : 1;
}

/* Gives every purpose and draw a random stream of its own. */
static uint64_t seed_stream(uint64_t seed, uint64_t purpose, uint64_t draw) {
  uint64_t state = seed ^ purpose * 0xd1342543de82ef95u;
  state = fg_splitmix_next(&state) ^ draw;
  return fg_splitmix_next(&state);
}

enum { FOR_BEARING = 1, FOR_SORTED, FOR_DESIGN, FOR_SET, FOR_SET_BEARING };

static size_t draw_below(uint64_t *state, size_t count) {
  size_t drawn = (size_t)(fg_splitmix_uniform(state) * (double)count);
  return drawn < count ? drawn : count - 1;
}

/* Draws `pads` different numbers below `foils`; a repeated one is drawn again. */
static void pick_different(uint64_t *state, size_t foils, size_t pads, size_t *foil) {
  for (size_t pad = 0; pad < pads; pad++) {
    bool taken = true;
    while (taken) {
      foil[pad] = draw_below(state, foils);
      taken = false;
      for (size_t i = 0; i < pad; i++)
        taken = taken || foil[i] == foil[pad];
    }
  }
}

void fg_assembly_pick(uint64_t seed, size_t draw, size_t foils, size_t pads, size_t *foil) {
  uint64_t state = seed_stream(seed, FOR_BEARING, draw);
  pick_different(&state, foils, pads, foil);
}

/* Arrays of one bearing while it is built. */
typedef struct workspace {
  const fg_stock *stock;
  const fg_assembly_plan *plan;
  double angle_deg[FG_BEARING_BUMPS_MAX], clearance_mm[FG_BEARING_BUMPS_MAX];
  double shared_mm[FG_BEARING_BUMPS_MAX], own_mm[FG_BEARING_BUMPS_MAX];
  size_t pad[FG_BEARING_BUMPS_MAX];
} workspace;

static workspace make_workspace(const fg_stock *stock, const fg_assembly_plan *plan) {
  const fg_bearing_layout *layout = &plan->layout;
  workspace b = {.stock = stock, .plan = plan};
  for (size_t pad = 0; pad < layout->pads; pad++)
    for (size_t bump = 0; bump < layout->bumps_per_pad; bump++) {
      b.angle_deg[pad * layout->bumps_per_pad + bump] = fg_bearing_angle_deg(layout, pad, bump);
      b.pad[pad * layout->bumps_per_pad + bump] = pad;
    }
  return b;
}

static size_t count_places(const workspace *b) {
  return b->plan->layout.pads * b->plan->layout.bumps_per_pad;
}

static fg_status build_bearing(fg_context *ctx, workspace *b, const size_t *foil, bool uncertainty,
                               fg_bearing_clearance *result) {
  size_t places = b->stock->places, bytes = places * sizeof(double);
  for (size_t pad = 0; pad < b->plan->layout.pads; pad++) {
    memcpy(b->clearance_mm + pad * places, b->stock->clearance_mm + foil[pad] * places, bytes);
    memcpy(b->shared_mm + pad * places, b->stock->shared_mm + foil[pad] * places, bytes);
    memcpy(b->own_mm + pad * places, b->stock->own_mm + foil[pad] * places, bytes);
  }
  const fg_bearing_uncertainty known = {b->shared_mm, b->own_mm, b->pad};
  return fg_bearing_assess_uncertainty(ctx, b->angle_deg, b->clearance_mm, count_places(b),
                                       uncertainty ? &known : NULL, result);
}

static bool is_within_limit(const fg_assembly_limit *limit, double value) {
  return value >= limit->lower && value <= limit->upper;
}

static bool is_assembled(const fg_assembly_plan *plan, const fg_bearing_clearance *bearing) {
  for (size_t i = 0; i < plan->limits; i++)
    if (plan->limit[i].asked &&
        !is_within_limit(&plan->limit[i], fg_quantity_value(plan->limit[i].row, bearing)))
      return false;
  return true;
}

/* Counts a bearing. */
static void count_bearing(const fg_assembly_plan *plan, const fg_bearing_clearance *bearing,
                          size_t counts[2], fg_assembly_result *result) {
  bool out[FG_ASSEMBLY_LIMITS_MAX], surely = true, possibly = true;
  size_t rejecting = 0;
  for (size_t i = 0; i < plan->limits; i++) {
    const fg_assembly_limit *limit = &plan->limit[i];
    fg_assembly_share *share = &result->within[i];
    double value = fg_quantity_value(limit->row, bearing);
    double u = fg_quantity_uncertainty(limit->row, bearing);
    const fg_tolerance asked = {.lower = limit->lower, .upper = limit->upper};
    fg_verdict verdict = fg_judge_value(&asked, value, u);
    out[i] = !is_within_limit(limit, value);
    share->count += !out[i];
    share->surely += verdict == FG_VERDICT_PASS;
    share->possibly += verdict == FG_VERDICT_PASS || verdict == FG_VERDICT_UNDECIDED;
    rejecting += limit->asked && out[i];
    surely = surely && (!limit->asked || verdict == FG_VERDICT_PASS);
    possibly = possibly &&
               (!limit->asked || verdict == FG_VERDICT_PASS || verdict == FG_VERDICT_UNDECIDED);
  }
  for (size_t i = 0; i < plan->limits; i++) {
    result->rejected[i] += plan->limit[i].asked && out[i];
    result->alone[i] += plan->limit[i].asked && out[i] && rejecting == 1;
  }
  result->assembled.count += rejecting == 0;
  counts[0] += surely;
  counts[1] += possibly;
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++) {
    double value = fg_quantity_value(fg_assembly_row(i), bearing);
    if (isfinite(value)) result->value[i][result->values[i]++] = value;
  }
}

static void finish_share(const fg_assembly_plan *plan, fg_assembly_share *share) {
  double of = (double)plan->bearings;
  share->share = (double)share->count / of;
  share->surely /= of;
  share->possibly /= of;
  share->foils_low = share->foils_high = NAN;
  fg_assembly_interval((double)share->count, of, plan->confidence, &share->draws_low,
                       &share->draws_high);
}

static void finish_result(const fg_assembly_plan *plan, const size_t counts[2],
                          fg_assembly_result *result) {
  result->assembled.surely = (double)counts[0];
  result->assembled.possibly = (double)counts[1];
  finish_share(plan, &result->assembled);
  for (size_t i = 0; i < plan->limits; i++)
    finish_share(plan, &result->within[i]);
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++) {
    fg_sort(result->value[i], result->values[i]);
    for (size_t k = 0; k < FG_ASSEMBLY_QUANTILES; k++)
      result->quantile[i][k] =
          result->values[i]
              ? fg_sample_quantile(result->value[i], result->values[i], fg_assembly_probability[k])
              : NAN;
  }
}

static fg_status begin_result(fg_context *ctx, const fg_assembly_plan *plan,
                              fg_assembly_result *result) {
  *result = (fg_assembly_result){.assembled = {.count = 0}};
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++) {
    void *block;
    fg_status status = fg_memory_allocate(ctx, plan->bearings, sizeof(double), &block);
    if (status != FG_OK) {
      fg_assembly_result_free(result);
      return status;
    }
    result->value[i] = block;
  }
  return FG_OK;
}

void fg_assembly_result_free(fg_assembly_result *result) {
  for (size_t i = 0; i < FG_ASSEMBLY_VALUES; i++)
    free(result->value[i]);
  *result = (fg_assembly_result){.assembled = {.count = 0}};
}

/* Finds the share within every limit, and within all, of one set of foils drawn with replacement.
 */
static fg_status draw_set_share(fg_context *ctx, workspace *b, size_t set,
                                double share[FG_ASSEMBLY_LIMITS_MAX + 1]) {
  const fg_assembly_plan *plan = b->plan;
  size_t foils = b->stock->foils, foil[FG_BEARING_BUMPS_MAX];
  void *block;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof(size_t), &block));
  size_t *member = block;
  uint64_t state = seed_stream(plan->seed, FOR_SET, set),
           draws = seed_stream(plan->seed, FOR_SET_BEARING, set);
  fg_status status = FG_OK;
  for (size_t i = 0; i < foils; i++)
    member[i] = draw_below(&state, foils);
  for (size_t i = 0; i < BEARINGS_OF_A_SET && status == FG_OK; i++) {
    fg_bearing_clearance bearing;
    pick_different(&draws, foils, plan->layout.pads, foil);
    for (size_t pad = 0; pad < plan->layout.pads; pad++)
      foil[pad] = member[foil[pad]];
    status = build_bearing(ctx, b, foil, false, &bearing);
    if (status != FG_OK) break;
    for (size_t k = 0; k < plan->limits; k++)
      share[k] += is_within_limit(&plan->limit[k], fg_quantity_value(plan->limit[k].row, &bearing));
    share[plan->limits] += is_assembled(plan, &bearing);
  }
  for (size_t k = 0; k <= plan->limits; k++)
    share[k] /= BEARINGS_OF_A_SET;
  free(member);
  return status;
}

/* Interval of a share by the number of foils. Shares of SETS sets scatter by the foils and by their
 * BEARINGS_OF_A_SET bearings; the second part is known. The first is the scatter of a share of a
 * number of independent bearings, reduced because few foils tell little of their own scatter (Korn
 * and Graubard 1998). The exact interval is that of this number. Where the sets do not tell it,
 * bearings without a common foil are counted. The share itself is of a limited number of draws,
 * whose scatter comes on top. */
static void find_foils_interval(const double *share, const fg_assembly_plan *plan, double foils,
                                fg_assembly_share *target) {
  double mean = 0, variance = 0, tail = (1 - plan->confidence) / 2;
  double drawn = (double)plan->bearings;
  for (size_t i = 0; i < SETS; i++)
    mean += share[i] / SETS;
  for (size_t i = 0; i < SETS; i++)
    variance += (share[i] - mean) * (share[i] - mean) / (SETS - 1);
  double of_draws = mean * (1 - mean) / BEARINGS_OF_A_SET,
         bearings = fmin(foils / (double)plan->layout.pads, drawn);
  bool shows = target->share > 0 && target->share < 1 && variance > of_draws && foils > 1;
  target->foils_by = shows ? FG_ASSEMBLY_BY_BOOTSTRAP : FG_ASSEMBLY_BY_BEARINGS;
  if (shows) {
    double of_foils = (variance - of_draws) * foils / (foils - 1);
    double wider =
        fg_distribution_t_quantile(tail, foils - 1) / fg_distribution_normal_quantile(tail);
    bearings = 1 / (of_foils * wider * wider / (target->share * (1 - target->share)) + 1 / drawn);
  }
  fg_assembly_interval(target->share * bearings, bearings, plan->confidence, &target->foils_low,
                       &target->foils_high);
}

static fg_status resample_foils(fg_context *ctx, workspace *b, fg_assembly_result *result) {
  const fg_assembly_plan *plan = b->plan;
  size_t limits = plan->limits;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, SETS * (limits + 1), sizeof(double), &block));
  double *all = block;
  fg_status status = FG_OK;
  for (size_t set = 0; set < SETS && status == FG_OK; set++) {
    double share[FG_ASSEMBLY_LIMITS_MAX + 1] = {0};
    status = draw_set_share(ctx, b, set, share);
    for (size_t k = 0; k <= limits; k++)
      all[k * SETS + set] = share[k];
  }
  for (size_t k = 0; k <= limits && status == FG_OK; k++)
    find_foils_interval(all + k * SETS, plan, (double)b->stock->foils,
                        k < limits ? &result->within[k] : &result->assembled);
  free(all);
  return status;
}

static fg_status draw_all(fg_context *ctx, workspace *b, fg_assembly_result *result) {
  const fg_assembly_plan *plan = b->plan;
  size_t foil[FG_BEARING_BUMPS_MAX], counts[2] = {0};
  for (size_t i = 0; i < plan->bearings; i++) {
    fg_bearing_clearance bearing;
    fg_assembly_pick(plan->seed, i, b->stock->foils, plan->layout.pads, foil);
    FG_TRY(build_bearing(ctx, b, foil, true, &bearing));
    count_bearing(plan, &bearing, counts, result);
  }
  finish_result(plan, counts, result);
  return FG_OK;
}

static fg_status check_stock(fg_context *ctx, const fg_stock *stock, const fg_assembly_plan *plan) {
  if (stock->foils >= plan->layout.pads) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%zu foils; a bearing takes %zu different ones", stock->foils,
                 plan->layout.pads);
}

fg_status fg_assembly_draw(fg_context *ctx, const fg_stock *stock, const fg_assembly_plan *plan,
                           bool resample, fg_assembly_result *result) {
  workspace b = make_workspace(stock, plan);
  *result = (fg_assembly_result){.assembled = {.count = 0}};
  FG_TRY(check_stock(ctx, stock, plan));
  FG_TRY(begin_result(ctx, plan, result));
  fg_status status = draw_all(ctx, &b, result);
  if (status == FG_OK && resample) status = resample_foils(ctx, &b, result);
  if (status != FG_OK) fg_assembly_result_free(result);
  return status;
}

fg_status fg_assembly_draw_design(fg_context *ctx, double clearance_mm, double deviation_mm,
                                  const fg_assembly_plan *plan, fg_assembly_result *result) {
  workspace b = make_workspace(NULL, plan);
  size_t counts[2] = {0};
  fg_status status = FG_OK;
  FG_TRY(begin_result(ctx, plan, result));
  for (size_t i = 0; i < plan->bearings && status == FG_OK; i++) {
    uint64_t state = seed_stream(plan->seed, FOR_DESIGN, i);
    fg_bearing_clearance bearing;
    for (size_t k = 0; k < count_places(&b); k++)
      b.clearance_mm[k] = clearance_mm + deviation_mm * (2 * fg_splitmix_uniform(&state) - 1);
    status = fg_bearing_assess(ctx, b.angle_deg, b.clearance_mm, count_places(&b), &bearing);
    if (status == FG_OK) count_bearing(plan, &bearing, counts, result);
  }
  if (status == FG_OK) finish_result(plan, counts, result);
  if (status != FG_OK) fg_assembly_result_free(result);
  return status;
}

typedef struct ranked {
  double mean;
  size_t foil;
} ranked;

static int compare_means(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->mean != y->mean) return x->mean < y->mean ? -1 : 1;
  return x->foil < y->foil ? -1 : x->foil > y->foil;
}

fg_status fg_assembly_draw_sorted(fg_context *ctx, const fg_stock *stock,
                                  const fg_assembly_plan *plan, size_t classes, size_t *assembled) {
  workspace b = make_workspace(stock, plan);
  size_t pads = plan->layout.pads, foil[FG_BEARING_BUMPS_MAX];
  void *block;
  *assembled = 0;
  FG_TRY(check_stock(ctx, stock, plan));
  FG_TRY(fg_memory_allocate(ctx, stock->foils, sizeof(ranked), &block));
  ranked *order = block;
  fg_status status = FG_OK;
  for (size_t i = 0; i < stock->foils; i++) {
    order[i].foil = i;
    for (size_t k = 0; k < stock->places; k++)
      order[i].mean += stock->clearance_mm[i * stock->places + k];
  }
  fg_sort_items(order, stock->foils, sizeof *order, compare_means);
  for (size_t i = 0; i < plan->bearings && status == FG_OK; i++) {
    uint64_t state = seed_stream(plan->seed, FOR_SORTED, i);
    /* Box of a random foil: a box is drawn as often as it has foils. */
    size_t box = draw_below(&state, stock->foils) * classes / stock->foils;
    size_t from = (box * stock->foils + classes - 1) / classes;
    size_t to = ((box + 1) * stock->foils + classes - 1) / classes;
    fg_bearing_clearance bearing;
    pick_different(&state, to - from, pads, foil);
    for (size_t pad = 0; pad < pads; pad++)
      foil[pad] = order[from + foil[pad]].foil;
    status = build_bearing(ctx, &b, foil, false, &bearing);
    *assembled += status == FG_OK && is_assembled(plan, &bearing);
  }
  free(order);
  return status;
}

fg_status fg_stock_allocate(fg_context *ctx, size_t foils, size_t places, fg_stock *stock) {
  double **const parts[] = {&stock->clearance_mm, &stock->shared_mm, &stock->own_mm};
  *stock = (fg_stock){.foils = foils, .places = places};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    void *block;
    fg_status status = fg_memory_allocate(ctx, foils * places, sizeof(double), &block);
    if (status != FG_OK) {
      fg_stock_free(stock);
      return status;
    }
    *parts[i] = block;
  }
  return FG_OK;
}

fg_status fg_stock_copy(fg_context *ctx, const fg_stock *stock, fg_stock *copy) {
  size_t bytes = stock->foils * stock->places * sizeof(double);
  FG_TRY(fg_stock_allocate(ctx, stock->foils, stock->places, copy));
  memcpy(copy->clearance_mm, stock->clearance_mm, bytes);
  memcpy(copy->shared_mm, stock->shared_mm, bytes);
  memcpy(copy->own_mm, stock->own_mm, bytes);
  return FG_OK;
}

void fg_stock_free(fg_stock *stock) {
  free(stock->clearance_mm);
  free(stock->shared_mm);
  free(stock->own_mm);
  *stock = (fg_stock){0};
}
