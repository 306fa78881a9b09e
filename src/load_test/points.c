/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places where the strokes pass the threshold. */
#include <math.h>

#include "core/small_solve.h"
#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Minimum length, relative to the longest, of strokes with both turns. */
static const double whole_share = 0.9;

enum { RECORDS_MAX = FG_SMALL_MAX - 3, PUSH = 0, PULL, DRIFT, OFFSETS };

double fg_load_birge(const fg_load_scatter *scatter) {
  return scatter->dof > 0 ? fmax(1, sqrt(scatter->chi2 / scatter->dof)) : 1;
}

typedef struct point {
  bool found;
  int side; /* PUSH, PULL */
  double x, u;
} point;

/* Plan of the fit through the points. */
typedef struct plan {
  size_t count[2], repeats; /* points of each side; of one side in one record at most */
  bool apart;               /* every record has points of both sides: each may have an offset */
  size_t records, first_record;
} plan;

/* Up strokes load at +T, down strokes at -T. */
static point find_point(const fg_load_stroke *stroke, fg_load_levels levels) {
  fg_local_fit fit;
  point p = {.side = stroke->sense > 0 ? PUSH : PULL};
  double level = levels.zero_n + (p.side == PUSH ? 1 : -1) * levels.threshold_n;
  p.found = fg_local_crossing(stroke, level, &p.x, &p.u, &fit);
  return p;
}

static plan make_plan(const fg_load_strokes *strokes, fg_load_levels levels) {
  plan all = {.apart = true};
  size_t in_record[2] = {0};
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    point p = find_point(s, levels);
    if (!i) all.first_record = s->record;
    if (p.found) {
      all.count[p.side]++;
      if (++in_record[p.side] > all.repeats) all.repeats = in_record[p.side];
    }
    if (i + 1 < strokes->count && strokes->stroke[i + 1].record == s->record) continue;
    all.apart = all.apart && in_record[0] && in_record[1];
    in_record[0] = in_record[1] = 0;
    all.records = s->record - all.first_record + 1;
  }
  all.apart = all.apart && all.records > 1 && all.records <= RECORDS_MAX;
  return all;
}

typedef struct joined {
  double drift;
  fg_load_scatter scatter;
} joined;

static double middle_between_turns(const fg_load_stroke *s) {
  return (fg_load_stroke_turn(s, false) + fg_load_stroke_turn(s, true)) / 2;
}

static bool has_both_turns(const fg_load_stroke *s, const fg_load_strokes *strokes) {
  double longest = 0;
  for (size_t i = 0; i < strokes->count; i++)
    longest = fmax(longest, strokes->stroke[i].high_mm - strokes->stroke[i].low_mm);
  return s->high_mm - s->low_mm > whole_share * longest;
}

/* Aligns single strokes by the drift that both their points and the middles of their turns support.
 * Points alone may differ because a foil deflects differently when first loaded, middles alone
 * because the turns do; a difference within its uncertainty is no evidence. */
static void align(fg_load_strokes *strokes, fg_load_levels levels, const double *x,
                  double variance) {
  double middle = 0, count = 0;
  for (size_t i = 0; i < strokes->count; i++) {
    if (!has_both_turns(&strokes->stroke[i], strokes)) continue;
    middle += middle_between_turns(&strokes->stroke[i]);
    count++;
  }
  for (size_t i = 0; i < strokes->count; i++) {
    fg_load_stroke *s = &strokes->stroke[i];
    point p = find_point(s, levels);
    if (!p.found || !has_both_turns(s, strokes)) continue;
    double share = variance / (variance + p.u * p.u);
    double by_point = share * (p.x - x[p.side] - s->shift_mm);
    double by_middle = middle_between_turns(s) - middle / count;
    if (by_point * by_middle <= 0) continue;
    s->shift_mm += fabs(by_point) < fabs(by_middle) ? by_point : by_middle;
  }
}

/* Fits the points of all strokes, with their drift; false when a side has none. */
static bool fit_points(fg_load_strokes *strokes, fg_load_levels levels, joined *out) {
  fg_normal_equations system;
  plan all = make_plan(strokes, levels);
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  if (!all.count[PUSH] || !all.count[PULL]) return false;
  bool drifts = all.repeats > 1;
  size_t unknowns = drifts ? OFFSETS : DRIFT, first = unknowns;
  if (all.apart) unknowns += all.records - 1;
  fg_normal_clear(&system, unknowns);
  double weights = 0;
  *out = (joined){0};
  for (size_t i = 0; i < strokes->count; i++) {
    const fg_load_stroke *s = &strokes->stroke[i];
    point p = find_point(s, levels);
    double row[FG_SMALL_MAX] = {0};
    if (!p.found) continue;
    row[p.side] = 1;
    if (drifts) row[DRIFT] = (double)i - 0.5 * (double)(strokes->count - 1);
    if (all.apart && s->record > all.first_record)
      row[first + s->record - all.first_record - 1] = 1;
    fg_normal_add(&system, row, p.x, 1 / (p.u * p.u));
    weights += 1 / (p.u * p.u);
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return false;
  out->drift = drifts ? x[DRIFT] : NAN;
  out->scatter.dof = (double)(all.count[0] + all.count[1]) - (double)unknowns;
  out->scatter.chi2 = system.sum_squares;
  for (size_t k = 0; k < unknowns; k++)
    out->scatter.chi2 -= x[k] * system.right[k];
  double excess = pow(fg_load_birge(&out->scatter), 2) - 1;
  double variance = excess * (double)(all.count[0] + all.count[1]) / weights;
  for (size_t i = 0; i < strokes->count; i++) {
    fg_load_stroke *s = &strokes->stroke[i];
    if (drifts) s->drift_mm = x[DRIFT];
    if (drifts) s->shift_mm = x[DRIFT] * ((double)i - 0.5 * (double)(strokes->count - 1));
    if (all.apart && s->record > all.first_record)
      s->shift_mm += x[first + s->record - all.first_record - 1];
  }
  align(strokes, levels, x, variance);
  return true;
}

/* Places where all strokes of one sense pass a force. */
typedef struct passed {
  bool found;
  double x, u, u_unsampled, slope;
} passed;

static fg_status find_passed(fg_context *ctx, const fg_load_strokes *strokes, int sense,
                             double level_n, passed *p) {
  fg_load_stroke merged = {0};
  fg_local_fit fit;
  *p = (passed){0};
  fg_status status = fg_load_strokes_merge_sense(ctx, strokes, sense, &merged);
  if (status == FG_OK && fg_local_crossing(&merged, level_n, &p->x, &p->u, &fit)) {
    p->found = true;
    p->slope = fit.slope;
    p->u_unsampled = fit.u_unsampled_mm;
  }
  fg_load_stroke_free(&merged);
  return status;
}

/* One unsampled stretch may hold both places: their uncertainties in it add up. */
static fg_load_value travel(const passed side[2]) {
  const passed *push = &side[PUSH], *pull = &side[PULL];
  if (!push->found || !pull->found) return (fg_load_value){NAN, NAN, NAN};
  double both = push->u_unsampled + pull->u_unsampled;
  double variance = push->u * push->u - push->u_unsampled * push->u_unsampled + pull->u * pull->u -
                    pull->u_unsampled * pull->u_unsampled;
  return (fg_load_value){push->x - pull->x, NAN, hypot(both, sqrt(fmax(0, variance)))};
}

fg_status fg_load_find_points(fg_context *ctx, fg_load_strokes *strokes, fg_load_levels levels,
                              fg_load_direction *direction, fg_load_findings *findings) {
  joined all;
  passed loading[2], unloading[2];
  fg_load_value none = {NAN, NAN, NAN};
  direction->clearance = direction->unloading = none;
  direction->push_mm = direction->pull_mm = direction->drift_um_cycle = NAN;
  if (!fit_points(strokes, levels, &all)) return FG_OK;
  direction->drift_um_cycle = 2000 * all.drift;
  findings->points = all.scatter;
  for (int side = PUSH; side <= PULL; side++) {
    int sense = side == PUSH ? 1 : -1;
    double level = levels.zero_n + sense * levels.threshold_n;
    FG_TRY(find_passed(ctx, strokes, sense, level, &loading[side]));
    FG_TRY(find_passed(ctx, strokes, -sense, level, &unloading[side]));
    if (loading[side].found) findings->compliance_mm_n += 1 / loading[side].slope;
    if (loading[side].found && loading[side].u_unsampled > 0) direction->flags |= FG_LOAD_UNSAMPLED;
  }
  direction->clearance = travel(loading);
  direction->unloading = travel(unloading);
  if (loading[PUSH].found) direction->push_mm = loading[PUSH].x;
  if (loading[PULL].found) direction->pull_mm = loading[PULL].x;
  return FG_OK;
}
