/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Area of the loops, and the loss factors.
 *
 * The mean loop is that of the whole strokes of each sense, merged: a dropout in one of them is
 * covered by the others. Single loops give the scatter. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Ends of a loop that lie nearer to each other than this share of the travel close it. */
static const double close_share = 0.05;

/* Strokes of one cycle that begins and ends in the middle. */
enum { CYCLE_STROKES_MAX = 3 };

/* Number of u by which a loop's area must be negative for the flag of released energy, U = 2 u. */
static const double gained_reach = 2;

typedef struct tally {
  double sum, squares, count;
} tally;

static void add_area(tally *t, double area) {
  t->sum += area;
  t->squares += area * area;
  t->count++;
}

/* Loops, as means of neighbours that share a stroke. A drift of the force adds to a loop that
 * begins with an up stroke as much as it removes from one that begins with a down stroke: their
 * mean is free of it. */
typedef struct loops {
  tally single, pair;
  double noise; /* variance of one loop by the samples' scatter */
} loops;

/* Area of the polygon of samples first ... last, closed; positive where energy is lost. */
static double polygon(const fg_load_sample *s, const bool *left_out, size_t first, size_t last) {
  double area = 0, f0 = s[first].force_n;
  size_t before = first;
  for (size_t i = first + 1; i <= last + 1; i++) {
    size_t next = i <= last ? i : first;
    if (i < last && left_out[i]) continue;
    area += ((s[before].force_n + s[next].force_n) / 2 - f0) * (s[next].x_mm - s[before].x_mm);
    before = next;
  }
  return area;
}

/* Samples that loops are found in. */
typedef struct loop_samples {
  const fg_load_sample *sample;
  const bool *left_out;
  double travel_mm, variance; /* of the direction; of a sample's force */
} loop_samples;

/* Adds the loop of samples first ... last. Returns its area; NaN: its ends do not meet. */
static double add_loop(const loop_samples *from, size_t first, size_t last, loops *all) {
  const fg_load_sample *s = from->sample;
  if (fabs(s[last].x_mm - s[first].x_mm) > close_share * from->travel_mm) return NAN;
  double area = polygon(s, from->left_out, first, last), noise = 0;
  for (size_t i = first + 1; i < last; i++)
    noise += from->variance * pow((s[i + 1].x_mm - s[i - 1].x_mm) / 2, 2);
  add_area(&all->single, area);
  all->noise = noise;
  return area;
}

static double mean_variance(const fg_load_strokes *strokes) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < strokes->count; i++)
    for (size_t k = 0; k < strokes->stroke[i].count; k += 8, count++)
      sum += strokes->stroke[i].variance[k];
  return sum / count;
}

static bool follows(const fg_load_strokes *strokes, size_t i) {
  return strokes->stroke[i].last == strokes->stroke[i + 1].first &&
         strokes->stroke[i].record == strokes->stroke[i + 1].record;
}

static double find_widest(const fg_load_strokes *strokes) {
  double widest = 0;
  for (size_t i = 0; i < strokes->count; i++)
    widest = fmax(widest, strokes->stroke[i].high_mm - strokes->stroke[i].low_mm);
  return widest;
}

/* A loop on the way that is deep enough for strokes of its own is none of the test's. */
static bool is_loop(const fg_load_strokes *strokes, size_t i, double widest) {
  const fg_load_stroke *a = &strokes->stroke[i], *b = &strokes->stroke[i + 1];
  return follows(strokes, i) &&
         fmin(a->high_mm - a->low_mm, b->high_mm - b->low_mm) > (1 - 2 * close_share) * widest;
}

static loops find_loops(const fg_load_sample *samples, const fg_load_strokes *strokes,
                        const fg_load_direction *direction) {
  loops all = {0};
  const loop_samples from = {samples, strokes->left_out, direction->travel_mm,
                             mean_variance(strokes)};
  double last = NAN, widest = find_widest(strokes);
  const fg_load_stroke *stroke = strokes->stroke;
  for (size_t i = 0; i + 1 < strokes->count; i++) {
    double area = is_loop(strokes, i, widest)
                      ? add_loop(&from, stroke[i].first, stroke[i + 1].last, &all)
                      : NAN;
    if (isfinite(area + last)) add_area(&all.pair, (area + last) / 2);
    last = area;
  }
  /* One cycle from the middle back to the middle has no turning point twice. */
  if (!(all.single.count > 0) && strokes->count && strokes->count <= CYCLE_STROKES_MAX)
    add_loop(&from, stroke[0].first, stroke[strokes->count - 1].last, &all);
  return all;
}

/* Returns the variance of a stroke's share, s², from the scatter of areas. A pair of loops is s_i /
 * 2 + s_j + s_k / 2 of three strokes: 3/2 s². Its neighbour shares s² of that, the next one s² / 4,
 * and their scatter about the mean is smaller by so much. */
static double stroke_variance(const loops *all) {
  const tally *t = all->pair.count > 0 ? &all->pair : &all->single;
  double n = t->count, mean = t->sum / n, own = 2;
  if (!(n > 1)) return 0;
  if (all->pair.count > 0) own = 1.5 - (2 * (n - 1) + (n - 2) / 2) / (n * (n - 1));
  return fmax(0, t->squares - n * mean * mean) / (n - 1) / own;
}

/* Returns the standard uncertainty of the mean area by the scatter of loops: the mean is twice the
 * mean of its n strokes' shares, so its variance is 4 s² / n. */
static double u_of_scatter(const loops *all) {
  const tally *t = all->pair.count > 0 ? &all->pair : &all->single;
  double strokes = t->count + (all->pair.count > 0 ? 2 : 1);
  return sqrt(4 * fmax(stroke_variance(all), all->noise / 2) / strokes);
}

/* Number of u by which the mean area of single loops may differ from that of the mean loop. */
static const double loops_apart = 3;

/* The mean loop lies over strokes whose drift was subtracted. A displacement that jumps between
 * strokes is no drift: it parts the branches, and no scatter tells. Single loops, in the order of
 * time, contain no such correction, but lose the area of a dropout. Where both differ, either may
 * be right. */
static double widen_by_loops(const fg_load_value *area, const loops *all) {
  const tally *t = all->pair.count > 0 ? &all->pair : &all->single;
  double apart = t->count > 0 ? fabs(t->sum / t->count - area->value) : 0;
  return apart > loops_apart * area->u_repeat ? hypot(area->u_repeat, apart) : area->u_repeat;
}

/* ---- the mean loop ---- */

enum { UP, DOWN, SENSES };

typedef struct mean_loop {
  fg_load_stroke branch[SENSES];
  fg_load_turn turn[FG_LOAD_SIDES];
} mean_loop;

static bool is_whole_loop_stroke(const fg_load_stroke *s, const fg_load_direction *direction) {
  return s->high_mm - s->low_mm > (1 - 2 * close_share) * direction->travel_mm;
}

/* Whole strokes; all of them where a sense has none, as in one cycle from the middle to the middle.
 */
static void choose_loop_strokes(const fg_load_strokes *strokes, const fg_load_direction *direction,
                                fg_load_loop_strokes *c) {
  bool has[SENSES] = {false};
  for (size_t i = 0; i < strokes->count; i++)
    if (is_whole_loop_stroke(&strokes->stroke[i], direction))
      has[strokes->stroke[i].sense < 0] = true;
  for (size_t i = 0; i < strokes->count; i++)
    if (!(has[UP] && has[DOWN]) || is_whole_loop_stroke(&strokes->stroke[i], direction))
      c->stroke[c->count++] = &strokes->stroke[i];
}

static fg_status merge_branch(fg_context *ctx, const fg_load_loop_strokes *c, int sense,
                              fg_load_stroke *branch) {
  const fg_load_stroke **of;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, c->count + 1, sizeof *of, (void **)&of));
  for (size_t i = 0; i < c->count; i++)
    if ((c->stroke[i]->sense < 0) == sense) of[count++] = c->stroke[i];
  fg_status status = fg_load_strokes_merge(ctx, of, count, branch);
  free(of);
  return status;
}

static fg_status make_loop(fg_context *ctx, const fg_load_sample *samples,
                           const fg_load_strokes *strokes, const fg_load_direction *direction,
                           mean_loop *loop) {
  fg_load_loop_strokes c = {.noise_mm = strokes->noise_mm};
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, strokes->count, sizeof(fg_load_stroke *), (void **)&c.stroke));
  choose_loop_strokes(strokes, direction, &c);
  for (int sense = UP; sense < SENSES; sense++)
    FG_TRY_EXIT(merge_branch(ctx, &c, sense, &loop->branch[sense]));
  for (int side = 0; side < FG_LOAD_SIDES; side++)
    FG_TRY_EXIT(
        fg_load_find_turn(ctx, samples, &c, side == FG_LOAD_PUSH ? 1 : -1, &loop->turn[side]));
exit:
  free(c.stroke);
  return status;
}

/* ---- work along a branch ---- */

typedef struct work {
  double value, variance; /* by the samples' noise */
  double unsampled;       /* u by unsampled stretches, where the force is only known to rise */
} work;

static double force_between(const fg_load_stroke *s, size_t i, double x) {
  double width = s->x[i + 1] - s->x[i], share = width > 0 ? (x - s->x[i]) / width : 0.5;
  return s->f[i] + share * (s->f[i + 1] - s->f[i]);
}

/* Integral of the force less `base` from `from` to `to`, both within the samples. */
static work integrate(const fg_load_stroke *s, double base, double from, double to) {
  work w = {0};
  size_t i = fg_load_stroke_from(s, from);
  for (i -= i > 0; i + 1 < s->count && s->x[i] < to; i++) {
    double a = fmax(from, s->x[i]), b = fmin(to, s->x[i + 1]);
    if (!(b > a)) continue;
    w.value += ((force_between(s, i, a) + force_between(s, i, b)) / 2 - base) * (b - a);
    double around = (s->x[i + 1] - (i ? s->x[i - 1] : s->x[i])) / 2;
    w.variance += s->variance[i] * around * around;
    if (s->after_hole[i + 1]) w.unsampled += fabs(s->f[i + 1] - s->f[i]) * (b - a) / sqrt(12);
  }
  return w;
}

/* One end of the loop: the tip's force on the loading branch, and the distance from it of both
 * branches' samples, as those near a turn are left out. */
typedef struct tip {
  bool found;
  double force_n, u_force_n;
  double sampled_mm, rest_mm; /* last place of both branches; from there to the turn */
  double apart_n;             /* of both branches there */
} tip;

static tip find_tip(const mean_loop *loop, int side) {
  bool push = side == FG_LOAD_PUSH;
  const fg_load_stroke *load = &loop->branch[push ? UP : DOWN];
  const fg_load_stroke *unload = &loop->branch[push ? DOWN : UP];
  double turn = loop->turn[side].place_mm;
  fg_local_fit a, b;
  tip t = {.force_n = loop->turn[side].force_n, .u_force_n = loop->turn[side].u_force_n};
  if (!loop->turn[side].found || !load->count || !unload->count) return t;
  double last = push ? fmin(turn, load->x[load->count - 1]) : fmax(turn, load->x[0]);
  t.sampled_mm = push ? fmin(last, unload->x[unload->count - 1]) : fmax(last, unload->x[0]);
  t.rest_mm = fabs(turn - t.sampled_mm);
  t.found = fg_local_fit_near(load, t.sampled_mm, 0, &a) &&
            fg_local_fit_near(unload, t.sampled_mm, 0, &b);
  t.apart_n = t.found ? fabs(a.value - b.value) : 0;
  return t;
}

/* Computes the area between both ends. Beyond the last samples half of the branches' distance is
 * used: they meet somewhere before the turn. */
static fg_load_value area_of(const mean_loop *loop, const tip end[FG_LOAD_SIDES]) {
  double low = end[FG_LOAD_PULL].sampled_mm, high = end[FG_LOAD_PUSH].sampled_mm;
  work up = integrate(&loop->branch[UP], 0, low, high);
  work down = integrate(&loop->branch[DOWN], 0, low, high);
  double tips = 0, variance = up.variance + down.variance;
  for (int side = 0; side < FG_LOAD_SIDES; side++) {
    double max = end[side].apart_n * end[side].rest_mm;
    tips += max / 2;
    variance += max * max / 12;
  }
  double u = hypot(sqrt(variance), up.unsampled + down.unsampled);
  return (fg_load_value){up.value - down.value + tips, NAN, u};
}

/* ---- the foils alone ---- */

/* Begin of the compression, as a multiple of the local compliance's distance before the threshold:
 * earlier there is almost no force. */
static const double before_threshold = 1.5;

typedef struct energy {
  double lost, elastic, travel, u_elastic;
} energy;

/* The loop that the work of the foils is found from, both ends of it, and the force from which on a
 * foil is touched. */
typedef struct foil_work {
  const mean_loop *loop;
  const tip *ends;
  const fg_load_zero *zero;
  double threshold;
} foil_work;

/* Adds lost and elastic work of one side's foil, the rig's friction and the load cell's zero left
 * out. False: the contact is not seen. */
static bool add_side_work(const foil_work *from, const fg_load_direction *d, int side,
                          energy *sum) {
  const mean_loop *loop = from->loop;
  const tip *end = &from->ends[side];
  const fg_load_zero *zero = from->zero;
  int sign = side == FG_LOAD_PUSH ? 1 : -1;
  const fg_load_stroke *load = &loop->branch[sign > 0 ? UP : DOWN];
  const fg_load_stroke *unload = &loop->branch[sign > 0 ? DOWN : UP];
  double contact = sign > 0 ? d->push_mm : d->pull_mm, middle = (d->push_mm + d->pull_mm) / 2;
  fg_local_fit fit;
  if (!fg_local_fit_near(load, contact, 0, &fit) && !fg_local_across(load, contact, &fit))
    return false;
  if (!(fit.slope > 0)) return false;
  double reach = fmin(before_threshold * from->threshold / fit.slope, sign * (contact - middle));
  double begin = contact - sign * reach, to = end->sampled_mm;
  if (!(sign * (to - begin) > 0)) return false;
  double base = zero->force_n + sign * zero->friction_n,
         unbase = zero->force_n - sign * zero->friction_n;
  work in = integrate(load, base, fmin(begin, to), fmax(begin, to));
  work out = integrate(unload, unbase, fmin(begin, to), fmax(begin, to));
  double tip_work = sign * (end->force_n - base) * end->rest_mm;
  double tip_lost = fmax(0, end->apart_n - 2 * zero->friction_n) * end->rest_mm / 2;
  sum->lost += sign * (in.value - out.value) + tip_lost;
  sum->elastic += sign * (in.value + out.value) / 2 + tip_work - tip_lost / 2;
  sum->travel += sign * (to - begin) + end->rest_mm;
  double noise = hypot(sqrt(in.variance + out.variance) / 2, end->u_force_n * end->rest_mm);
  sum->u_elastic += hypot(noise, (in.unsampled + out.unsampled) / 2);
  return true;
}

/* Loss factor: energy lost over 2 pi times the elastic work (E. E. Ungar, E. M. Kerwin, Loss
 * factors of viscoelastic systems in terms of energy concepts, J. Acoust. Soc. Am. 34, 1962). */
static void find_foil_loss(const mean_loop *loop, const tip end[FG_LOAD_SIDES],
                           const fg_load_zero *zero, double threshold, fg_load_direction *d) {
  energy sum = {0};
  if (!isfinite(d->clearance.value) || !isfinite(zero->force_n)) return;
  const foil_work from = {loop, end, zero, threshold};
  for (int side = 0; side < FG_LOAD_SIDES; side++)
    if (!add_side_work(&from, d, side, &sum)) return;
  if (!(sum.elastic > 0)) return;
  double value = sum.lost / (2 * M_PI * sum.elastic);
  double lost = hypot(d->area.u_repeat, 2 * zero->u_n * sum.travel) / (2 * M_PI * sum.elastic);
  double elastic = value * hypot(sum.u_elastic, zero->u_n * sum.travel) / sum.elastic;
  d->loss_foil = (fg_load_value){value, NAN, hypot(lost, elastic)};
}

/* An error of the force at the turn moves the place along the branch as well. */
static double u_of_secant(const mean_loop *loop, double k, double travel) {
  double variance = 0;
  for (int side = 0; side < FG_LOAD_SIDES; side++) {
    const fg_load_turn *t = &loop->turn[side];
    variance += pow(t->u_force_n * (1 - k * t->compliance_mm_n), 2) + pow(k * t->u_place_mm, 2);
  }
  return sqrt(variance) / travel;
}

static void find_mean(const mean_loop *loop, const loops *all, const fg_load_zero *zero,
                      double threshold, fg_load_direction *d) {
  tip end[FG_LOAD_SIDES] = {find_tip(loop, FG_LOAD_PULL), find_tip(loop, FG_LOAD_PUSH)};
  double travel = loop->turn[FG_LOAD_PUSH].place_mm - loop->turn[FG_LOAD_PULL].place_mm;
  double half = travel / 2;
  if (!end[FG_LOAD_PULL].found || !end[FG_LOAD_PUSH].found || !(travel > 0)) return;
  d->area = area_of(loop, end);
  d->area.u_repeat = hypot(d->area.u_repeat, all->single.count > 0 ? u_of_scatter(all) : 0);
  d->area.u_repeat = widen_by_loops(&d->area, all);
  if (d->area.value < -gained_reach * d->area.u_repeat) d->flags |= FG_LOAD_WRONG_WAY;
  double k = (end[FG_LOAD_PUSH].force_n - end[FG_LOAD_PULL].force_n) / travel;
  d->secant = (fg_load_value){k, NAN, u_of_secant(loop, k, travel)};
  d->loss.value = d->area.value / (M_PI * d->stiffness.value * half * half);
  d->loss_secant.value = d->area.value / (M_PI * k * half * half);
  find_foil_loss(loop, end, zero, threshold, d);
}

fg_status fg_load_find_loops(fg_context *ctx, const fg_load_test *test,
                             const fg_load_strokes *strokes, const fg_load_zero *zero,
                             fg_load_direction *direction) {
  const fg_load_value none = {NAN, NAN, NAN};
  mean_loop loop = {0};
  direction->area = direction->secant = none;
  direction->loss = direction->loss_secant = direction->loss_foil = none;
  if (!strokes->count || (direction->flags & FG_LOAD_SATURATED)) return FG_OK;
  loops all = find_loops(test->samples + direction->first, strokes, direction);
  fg_status status = make_loop(ctx, test->samples + direction->first, strokes, direction, &loop);
  if (status == FG_OK) find_mean(&loop, &all, zero, test->options.threshold_n, direction);
  for (int sense = UP; sense < SENSES; sense++)
    fg_load_stroke_free(&loop.branch[sense]);
  return status;
}
