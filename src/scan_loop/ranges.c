/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ranges of the dimensions over all explanations of a tie. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "scan_loop/state.h"

/* Standard uncertainties that a range reaches beyond its values: 95 %. */
#define COVERAGE 2.0

static void widen_range(double range[2], double value) {
  if (!isfinite(value)) return;
  if (!(value >= range[0])) range[0] = value;
  if (!(value <= range[1])) range[1] = value;
}

static void widen_ranges(const fg_measurement *m, fg_scan_loop_range *ranges, size_t foil) {
  const fg_foil *f = &m->foils[foil];
  for (size_t b = 0; b < f->bump_count; b++) {
    /* A range includes its value's own uncertainty: it shall contain the true value, not only the
     * fits. */
    double ur = COVERAGE * f->bumps[b].u_radius_mm, uh = COVERAGE * f->bumps[b].u_height_mm;
    widen_range(ranges[b].radius_mm, f->bumps[b].radius_mm - ur);
    widen_range(ranges[b].radius_mm, f->bumps[b].radius_mm + ur);
    widen_range(ranges[b].height_mm, f->bumps[b].height_mm - uh);
    widen_range(ranges[b].height_mm, f->bumps[b].height_mm + uh);
  }
  widen_range(ranges[f->bump_count].radius_mm,
              f->overall.radius_mm - COVERAGE * f->overall.u_radius_mm);
  widen_range(ranges[f->bump_count].radius_mm,
              f->overall.radius_mm + COVERAGE * f->overall.u_radius_mm);
}

static fg_status allocate_ranges(fg_context *ctx, fg_scan_loop *loop) {
  size_t foils = 0;
  for (size_t i = 0; i < loop->scan_count; i++)
    foils += loop->before[i].foil_count;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof *loop->ranges, (void **)&loop->ranges));
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++) {
      size_t count = loop->before[i].foils[f].bump_count + 1;
      FG_TRY(fg_memory_allocate(ctx, count, sizeof **loop->ranges, (void **)&loop->ranges[k]));
      for (size_t b = 0; b < count; b++)
        loop->ranges[k][b] = (fg_scan_loop_range){{NAN, NAN}, {NAN, NAN}};
    }
  return FG_OK;
}

/* The corrected discs carry their ranges at once. */
static void widen_discs(fg_measurement *after, const fg_measurement *m) {
  for (size_t d = 0; d < after->disc_count && d < m->disc_count; d++) {
    double *range = after->discs[d].radius_range_mm;
    if (range[0] == 0 && range[1] == 0) range[0] = range[1] = NAN;
    widen_range(range, m->discs[d].radius_mm - COVERAGE * m->discs[d].u_radius_mm);
    widen_range(range, m->discs[d].radius_mm + COVERAGE * m->discs[d].u_radius_mm);
  }
}

static void widen_all(fg_scan_loop *loop, const fg_measurement *measurements) {
  for (size_t i = 0; i < loop->scan_count; i++)
    widen_discs(&loop->after[i], &measurements[i]);
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++)
      if (f < measurements[i].foil_count &&
          measurements[i].foils[f].bump_count == loop->before[i].foils[f].bump_count)
        widen_ranges(&measurements[i], loop->ranges[k], f);
}

void fg_scan_loop_put_ranges(fg_scan_loop *loop) {
  for (size_t i = 0, k = 0; i < loop->scan_count; i++)
    for (size_t f = 0; f < loop->before[i].foil_count; f++, k++) {
      if (f >= loop->after[i].foil_count) continue;
      fg_foil *foil = &loop->after[i].foils[f];
      size_t count = loop->before[i].foils[f].bump_count;
      for (size_t b = 0; b < foil->bump_count && foil->bump_count == count; b++) {
        widen_range(loop->ranges[k][b].radius_mm, foil->bumps[b].radius_mm);
        widen_range(loop->ranges[k][b].height_mm, foil->bumps[b].height_mm);
        memcpy(foil->bumps[b].radius_range_mm, loop->ranges[k][b].radius_mm, 2 * sizeof(double));
        memcpy(foil->bumps[b].height_range_mm, loop->ranges[k][b].height_mm, 2 * sizeof(double));
      }
      widen_range(loop->ranges[k][count].radius_mm, foil->overall.radius_mm);
      memcpy(foil->overall.radius_range_mm, loop->ranges[k][count].radius_mm, 2 * sizeof(double));
    }
  for (size_t i = 0; i < loop->scan_count; i++)
    for (size_t d = 0; d < loop->after[i].disc_count; d++)
      widen_range(loop->after[i].discs[d].radius_range_mm, loop->after[i].discs[d].radius_mm);
}

/* A step that may lie elsewhere: its place is known to the interval's uniform distribution. */
static void widen_step_place(fg_effect_set *set, const fg_effect_set *other) {
  for (size_t e = 0; e < set->count; e++)
    for (size_t k = 0; k < other->count; k++) {
      fg_effect_found *step = &set->effects[e];
      if (!step->kind->jumps || other->effects[k].kind != step->kind) continue;
      double apart = fabs(other->effects[k].shape[0] - step->shape[0]);
      step->u_shape[0] = fmax(step->u_shape[0], apart / sqrt(3));
    }
}

/* A tie's explanations, each fitted to rows of its own. */
typedef struct tie_fits {
  const fg_scan_loop *loop;
  fg_joint_fit_result *fit; /* by explanation; of the winner, and of one that cannot be fitted: 0 */
} tie_fits;

static fg_status fit_explanation(fg_context *ctx, void *shared, size_t item) {
  const tie_fits *tie = shared;
  fg_joint_fit_result *fit = &tie->fit[item];
  fg_edge_fit rows;
  fg_effect_set set;
  if (item == 0) return FG_OK;
  fg_explanations_get_set(&tie->loop->explanations, item, &set);
  FG_TRY(fg_edge_fit_subset(ctx, &tie->loop->edge_fit, NULL, &rows));
  fg_status status = fg_joint_fit_open(ctx, &rows, &set, fit);
  if (status == FG_OK) fit->edge_fit = &tie->loop->edge_fit;
  fg_edge_fit_free(&rows);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Extends the ranges by one explanation other than the winner; by none that leaves no circle of a
 * part. */
static fg_status widen_by(fg_context *ctx, fg_scan_loop *loop, size_t explanation,
                          const fg_joint_fit_result *fit, fg_measurement *tried) {
  if (!fit->edge_fit) return FG_OK;
  loop->tie_excess[loop->tie_count] =
      fg_scan_loop_excess_over_best(&loop->explanations, explanation);
  loop->tie[loop->tie_count++] = fit->set;
  fg_status status = fg_scan_loop_correct_all(ctx, loop, fit, tried);
  if (status == FG_OK) widen_all(loop, tried);
  if (status == FG_OK && !loop->by_evidence) /* its mean is over all of them */
    status = fg_scan_loop_record_moves(ctx, loop, explanation, fit, tried);
  for (size_t i = 0; i < loop->scan_count; i++)
    fg_measurement_free(&tried[i]);
  if (status != FG_ERR_NUMERIC) return status;
  loop->tie_count--;
  return FG_OK;
}

fg_status fg_scan_loop_find_ranges(fg_context *ctx, fg_scan_loop *loop) {
  fg_status status = FG_OK;
  fg_measurement *tried = NULL;
  size_t count = loop->explanations.count;
  tie_fits tie = {.loop = loop};
  FG_TRY_EXIT(allocate_ranges(ctx, loop));
  FG_TRY_EXIT(fg_memory_allocate(ctx, loop->scan_count, sizeof *tried, (void **)&tried));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *tie.fit, (void **)&tie.fit));
  widen_all(loop, loop->after);
  FG_TRY_EXIT(fg_parallel_run(ctx, loop->options.threads, count, fit_explanation, &tie));
  for (size_t m = 1; m < count; m++)
    FG_TRY_EXIT(widen_by(ctx, loop, m, &tie.fit[m], tried));
  for (size_t k = 0; k < loop->tie_count; k++)
    widen_step_place(&loop->set, &loop->tie[k]);
exit:
  for (size_t m = 0; tie.fit && m < count; m++)
    fg_joint_fit_close(&tie.fit[m]);
  free(tie.fit);
  free(tried);
  return status;
}
