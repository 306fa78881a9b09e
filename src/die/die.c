/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traces brought together: repeats to a half, halves to the die. */
#include "foilgauge/die.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "die/values.h"

/* Values of one bump from the traces of one half. */
typedef struct repeats {
  const fg_die_trace **trace; /* owned; `count` of them */
  const fg_bump **bump;       /* owned */
  size_t count;
} repeats;

static const fg_bump *find_trace_bump(const fg_die_trace *trace, int number) {
  for (size_t i = 0; i < trace->bump_count; i++)
    if (trace->bumps[i].number == number) return &trace->bumps[i];
  return NULL;
}

static void find_repeats(const fg_die *die, fg_die_half half, int number, repeats *of) {
  of->count = 0;
  for (size_t i = 0; i < die->trace_count; i++) {
    const fg_die_trace *trace = &die->traces[i];
    const fg_bump *bump = trace->half == half ? find_trace_bump(trace, number) : NULL;
    if (!bump) continue;
    of->trace[of->count] = trace;
    of->bump[of->count++] = bump;
  }
}

/* Computes mean and sd over repeats; v->u: root mean square of the traces' own u. */
static void sum_up_repeats(const fg_design *design, const repeats *of, fg_die_quantity q,
                           fg_die_value *v) {
  double n = (double)of->count, sum = 0, square = 0, u_square = 0, u;
  for (size_t i = 0; i < of->count; i++) {
    sum += fg_die_value_of(design, of->trace[i], of->bump[i], q, &u);
    u_square += u * u;
  }
  v->value = sum / n;
  for (size_t i = 0; i < of->count; i++) {
    double d = fg_die_value_of(design, of->trace[i], of->bump[i], q, &u) - v->value;
    square += d * d;
  }
  v->sd = n > 1 ? sqrt(square / (n - 1)) : NAN;
  v->u = sqrt(u_square / n);
}

/* Returns the sd of one repeat pooled over all bumps, because a few repeats of one bump determine
 * it poorly. */
static double pooled_sd(const fg_die_side *side, fg_die_quantity q) {
  double square = 0, dof = 0;
  for (size_t i = 0; i < side->bump_count; i++) {
    const fg_die_bump *bump = &side->bumps[i];
    if (bump->count < 2) continue;
    square += bump->value[q].sd * bump->value[q].sd * (double)(bump->count - 1);
    dof += (double)(bump->count - 1);
  }
  return dof > 0 ? sqrt(square / dof) : NAN;
}

/* Returns the u of a mean of `count` repeats: the scatter of repeats is averaged; the remainder of
 * each trace's own u is the surface's form error, the same in every repeat. */
static double u_of_mean(double own, double pooled, size_t count) {
  double seen = isfinite(pooled) ? pooled * pooled : own * own;
  return sqrt(fmax(own * own - seen, 0) + seen / (double)count);
}

/* Returns true for the radius, which depends on the bump's own circle only; all other quantities
 * depend on the overall circle too, whose error is common to all bumps. */
static bool is_own(fg_die_quantity q) {
  return q == FG_DIE_RADIUS || q == FG_DIE_RADIUS_ERROR;
}

static void mean_over_bumps(fg_die_side *side) {
  double n = (double)side->bump_count;
  for (int q = 0; q < FG_DIE_QUANTITIES; q++) {
    double sum = 0, square = 0, u = 0, u_square = 0;
    for (size_t i = 0; i < side->bump_count; i++) {
      const fg_die_value *v = &side->bumps[i].value[q];
      sum += v->value;
      u += v->u;
      u_square += v->u * v->u;
    }
    for (size_t i = 0; i < side->bump_count; i++)
      square += pow(side->bumps[i].value[q].value - sum / n, 2);
    side->mean[q] = (fg_die_value){sum / n, n > 1 ? sqrt(square / (n - 1)) : NAN,
                                   is_own((fg_die_quantity)q) ? sqrt(u_square) / n : u / n};
  }
}

static void add_systematic(const fg_die *die, fg_die_half half, repeats *of, fg_die_side *side) {
  double alike[FG_DIE_QUANTITIES];
  for (size_t i = 0; i < side->bump_count; i++) {
    find_repeats(die, half, side->bumps[i].number, of);
    fg_die_systematic_u(die, of->trace[0], of->bump[0], alike);
    for (int q = 0; q < FG_DIE_QUANTITIES; q++) {
      side->bumps[i].value[q].u = hypot(side->bumps[i].value[q].u, alike[q]);
      if (i == 0) side->mean[q].u = hypot(side->mean[q].u, alike[q]);
    }
  }
}

static void sum_up_overall(const fg_die *die, fg_die_half half, fg_die_side *side) {
  double n = 0, sum = 0, square = 0, own = 0, design_mm = die->design.overall_radius_mm;
  for (size_t i = 0; i < die->trace_count; i++) {
    const fg_overall *o = &die->traces[i].overall;
    if (die->traces[i].half != half) continue;
    n++;
    sum += o->radius_mm;
    own += o->u_radius_mm * o->u_radius_mm;
  }
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half) square += pow(die->traces[i].overall.radius_mm - sum / n, 2);
  double mean = sum / n, sd = n > 1 ? sqrt(square / (n - 1)) : NAN;
  double u = u_of_mean(sqrt(own / n), sd, (size_t)n);
  u = hypot(hypot(u, die->options.u_tip_um / 1000), die->options.u_scale_ppm * 1e-6 * mean);
  side->overall_radius_mm = (fg_die_value){mean, sd, u};
  side->overall_error_pct = (fg_die_value){100 * (mean - design_mm) / design_mm,
                                           100 * sd / design_mm, 100 * u / design_mm};
}

/* The numbers that a half's traces show, ascending. */
static fg_status list_numbers(fg_context *ctx, const fg_die *die, fg_die_half half,
                              fg_die_side *side) {
  int low = 0, high = -1;
  for (size_t i = 0; i < die->trace_count; i++) {
    const fg_die_trace *trace = &die->traces[i];
    if (trace->half != half) continue;
    int first = trace->bumps[0].number, last = trace->bumps[trace->bump_count - 1].number;
    low = side->traces == 0 || first < low ? first : low;
    high = side->traces == 0 || last > high ? last : high;
    side->traces++;
  }
  if (!side->traces) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, (size_t)(high - low + 1), sizeof *side->bumps,
                            (void **)&side->bumps));
  for (int number = low; number <= high; number++)
    for (size_t i = 0; i < die->trace_count; i++)
      if (die->traces[i].half == half && find_trace_bump(&die->traces[i], number)) {
        side->bumps[side->bump_count++].number = number;
        break;
      }
  return FG_OK;
}

static fg_status bring_half_together(fg_context *ctx, fg_die *die, fg_die_half half, repeats *of) {
  fg_die_side *side = &die->half[half];
  FG_TRY(list_numbers(ctx, die, half, side));
  if (!side->traces) return FG_OK;
  for (size_t i = 0; i < side->bump_count; i++) {
    find_repeats(die, half, side->bumps[i].number, of);
    side->bumps[i].count = of->count;
    for (int q = 0; q < FG_DIE_QUANTITIES; q++)
      sum_up_repeats(&die->design, of, (fg_die_quantity)q, &side->bumps[i].value[q]);
  }
  for (int q = 0; q < FG_DIE_QUANTITIES; q++) {
    double pooled = pooled_sd(side, (fg_die_quantity)q);
    for (size_t i = 0; i < side->bump_count; i++) {
      fg_die_value *v = &side->bumps[i].value[q];
      v->u = u_of_mean(v->u, pooled, side->bumps[i].count);
    }
  }
  mean_over_bumps(side);
  sum_up_overall(die, half, side);
  add_systematic(die, half, of, side);
  return FG_OK;
}

static const fg_die_bump *side_bump(const fg_die_side *side, int number) {
  for (size_t i = 0; i < side->bump_count; i++)
    if (side->bumps[i].number == number) return &side->bumps[i];
  return NULL;
}

/* Half way between the halves; of one half alone, its value. */
static fg_die_value mean_of_halves(const fg_die_value *a, const fg_die_value *b) {
  if (!a || !b)
    return a ? (fg_die_value){a->value, NAN, a->u} : (fg_die_value){b->value, NAN, b->u};
  return (fg_die_value){0.5 * (a->value + b->value), fabs(a->value - b->value) * M_SQRT1_2,
                        0.5 * hypot(a->u, b->u)};
}

static void join_bump(const fg_die_bump *a, const fg_die_bump *b, fg_die_bump *out) {
  out->number = a ? a->number : b->number;
  out->count = (size_t)(a != NULL) + (size_t)(b != NULL);
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    out->value[q] = mean_of_halves(a ? &a->value[q] : NULL, b ? &b->value[q] : NULL);
}

static fg_status join_halves(fg_context *ctx, fg_die *die) {
  const fg_die_side *a = &die->half[FG_DIE_CONCAVE], *b = &die->half[FG_DIE_CONVEX];
  fg_die_side *whole = &die->whole;
  size_t i = 0, k = 0;
  FG_TRY(fg_memory_allocate(ctx, a->bump_count + b->bump_count, sizeof *whole->bumps,
                            (void **)&whole->bumps));
  whole->traces = a->traces + b->traces;
  while (i < a->bump_count || k < b->bump_count) {
    int left = i < a->bump_count ? a->bumps[i].number : INT32_MAX;
    int right = k < b->bump_count ? b->bumps[k].number : INT32_MAX;
    int number = left < right ? left : right;
    join_bump(side_bump(a, number), side_bump(b, number), &whole->bumps[whole->bump_count++]);
    i += left == number;
    k += right == number;
  }
  bool both = a->traces && b->traces;
  const fg_die_side *only = a->traces ? a : b;
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    whole->mean[q] = both ? mean_of_halves(&a->mean[q], &b->mean[q]) : only->mean[q];
  whole->overall_radius_mm =
      both ? mean_of_halves(&a->overall_radius_mm, &b->overall_radius_mm) : only->overall_radius_mm;
  whole->overall_error_pct =
      both ? mean_of_halves(&a->overall_error_pct, &b->overall_error_pct) : only->overall_error_pct;
  return FG_OK;
}

static fg_status measure_trace(fg_context *ctx, fg_die *die, const fg_die_source *source) {
  fg_die_profile profile;
  fg_die_trace *trace = &die->traces[die->trace_count];
  FG_TRY(fg_die_profile_load(ctx, source, &profile));
  fg_status status =
      fg_die_trace_measure(ctx, &die->design, &die->options, source, &profile, trace);
  fg_die_profile_free(&profile);
  die->trace_count++; /* a partly filled trace is freed with the others */
  for (size_t i = 0; i < die->trace_count; i++)
    trace->repeat += die->traces[i].half == trace->half;
  return status;
}

static fg_status bring_together(fg_context *ctx, fg_die *die) {
  repeats of = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, die->trace_count, sizeof(fg_die_trace *), (void **)&of.trace));
  FG_TRY_EXIT(fg_memory_allocate(ctx, die->trace_count, sizeof(fg_bump *), (void **)&of.bump));
  for (int half = 0; half < FG_DIE_HALVES; half++)
    FG_TRY_EXIT(bring_half_together(ctx, die, (fg_die_half)half, &of));
  status = join_halves(ctx, die);
exit:
  free(of.trace);
  free(of.bump);
  return status;
}

fg_status fg_die_measure(fg_context *ctx, const fg_design *design, const fg_die_options *options,
                         const fg_die_source *sources, size_t count, fg_die *die) {
  fg_status status = FG_OK;
  fg_numerics_start();
  *die = (fg_die){.design = *design, .options = *options};
  FG_TRY(fg_design_derive(ctx, design, &die->nominal));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *die->traces, (void **)&die->traces));
  for (size_t i = 0; i < count; i++)
    FG_TRY_EXIT(measure_trace(ctx, die, &sources[i]));
  status = bring_together(ctx, die);
exit:
  if (status != FG_OK) fg_die_free(die);
  return status;
}

static void free_side(fg_die_side *side) {
  free(side->bumps);
}

void fg_die_free(fg_die *die) {
  if (!die) return;
  for (size_t i = 0; i < die->trace_count; i++) {
    free(die->traces[i].bumps);
    free(die->traces[i].lost);
    free(die->traces[i].stations);
  }
  free(die->traces);
  for (int half = 0; half < FG_DIE_HALVES; half++)
    free_side(&die->half[half]);
  free_side(&die->whole);
  memset(die, 0, sizeof *die);
}
