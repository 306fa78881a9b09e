/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Test that scans given as scans of one foil show the same foil.
 *
 * Effects of a scanner or a part follow few numbers, or smooth curves; another foil differs bump by
 * bump, in radius, distance and direction. Under one geometry, scans of two foils leave a residual
 * that no set of effects explains, while a geometry for each scan leaves noise alone. Scans of one
 * foil with an effect that is not in the table are different: geometries of their own cannot follow
 * it either. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "scan_loop/state.h"

/* Minimum preference of Schwarz's criterion for a geometry per scan: on one foil it never exceeded
 * 40, on two it was hundreds (reports/loop_same_foil.md). */
#define PREFERENCE_MIN 60.0
/* Exact data leave no less. */
#define NOTHING_UM2 1e-8
/* With a geometry for each scan many effects are nearly collinear; so one is enough. */
enum { EFFECTS_MAX = 1 };

/* Residual of a search with a geometry for each scan. */
typedef struct apart {
  fg_edge_fit edge_fit;
  fg_effect_set set;
  fg_explanations explanations;
  double *residual_um;
} apart;

static double mean_square(const fg_edge_fit *edge_fit, const double *residual_um) {
  double sum = 0, weight = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    if (edge_fit->views[edge_fit->rows[i].view].held_out) continue;
    sum += edge_fit->rows[i].weight * residual_um[i] * residual_um[i];
    weight += edge_fit->rows[i].weight;
  }
  return weight > 0 ? sum / weight : 0;
}

static size_t rows_that_count(const fg_edge_fit *edge_fit) {
  size_t rows = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    rows += edge_fit->rows[i].weight > 0 && !edge_fit->views[edge_fit->rows[i].view].held_out;
  return rows;
}

static bool has_curve(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (fg_effect_is_free(set->effects[e].kind)) return true;
  return false;
}

static fg_status set_apart(fg_context *ctx, const fg_edge_fit *together, apart *a) {
  fg_edge_fit_view *views = NULL;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, together->view_count, sizeof *views, (void **)&views));
  for (size_t v = 0; v < together->view_count; v++) {
    if (together->views[v].held_out) continue;
    views[count] = together->views[v];
    views[count].part = count;
    count++;
  }
  fg_status status = fg_edge_fit_build(ctx, views, count, &a->edge_fit);
  free(views);
  if (status != FG_OK) return status;
  a->edge_fit.coarse = true; /* only few effects count here, and curves not at all */
  a->edge_fit.frame = together->frame;
  a->edge_fit.threads = together->threads;
  FG_TRY(fg_memory_allocate(ctx, a->edge_fit.row_count, sizeof *a->residual_um,
                            (void **)&a->residual_um));
  return fg_search_run(ctx, &a->edge_fit, &a->set, &a->explanations, a->residual_um);
}

static size_t numbers_of(const fg_edge_fit *edge_fit, const fg_effect_set *set) {
  size_t numbers = edge_fit->parameters;
  for (size_t e = 0; e < set->count; e++)
    numbers += set->effects[e].columns + set->effects[e].shapes;
  return numbers;
}

/* By how much Schwarz's criterion prefers them; they must leave less, too: few numbers alone prove
 * no second foil. */
static double preference(const fg_scan_loop *loop, const apart *a) {
  double together = fmax(mean_square(&loop->edge_fit, loop->residual_after), NOTHING_UM2);
  double alone = fmax(mean_square(&a->edge_fit, a->residual_um), NOTHING_UM2);
  if (alone >= together) return -INFINITY;
  double rows = (double)rows_that_count(&a->edge_fit) / a->explanations.integral;
  double more =
      (double)numbers_of(&a->edge_fit, &a->set) - (double)numbers_of(&loop->edge_fit, &loop->set);
  return rows * log(together / alone) - more * log(rows);
}

/* A bump on two scans; NULL: none. */
typedef struct bump_pair {
  const fg_bump *one, *other;
} bump_pair;

/* Replaces the pair by a bump of two scans whose radius differs more between them. */
static void compare_bumps(const fg_foil *one, const fg_foil *other, bump_pair *farthest) {
  for (size_t i = 0; i < other->bump_count; i++)
    for (size_t k = 0; k < one->bump_count; k++) {
      const bump_pair pair = {&one->bumps[k], &other->bumps[i]};
      if (pair.one->number != pair.other->number) continue;
      double apart_mm = fabs(pair.other->radius_mm - pair.one->radius_mm);
      if (!farthest->one || apart_mm > fabs(farthest->one->radius_mm - farthest->other->radius_mm))
        *farthest = pair;
    }
}

/* Names the bump that differs most between two scans of a part, as measured. */
static fg_status fail_two_foils(fg_context *ctx, const fg_scan_loop *loop, const apart *a) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  const fg_edge_fit_view *views = edge_fit->views;
  bump_pair farthest = {NULL, NULL};
  for (size_t v = 0; v < edge_fit->view_count; v++)
    for (size_t w = 0; w < v; w++)
      if (views[v].part == views[w].part) compare_bumps(views[w].foil, views[v].foil, &farthest);
  const fg_bump *one = farthest.one, *other = farthest.other;
  return fg_fail(ctx, FG_ERR_DATA,
                 "--same-foil: the scans are not of one foil: a geometry for each leaves %.3f um, "
                 "one for all of them %.3f um whatever the scanner does; bump %d is %.4f mm in one "
                 "scan and %.4f mm in another; without --same-foil the scans are searched as foils "
                 "of one scanner",
                 sqrt(mean_square(&a->edge_fit, a->residual_um)),
                 sqrt(mean_square(edge_fit, loop->residual_after)), one ? one->number : 0,
                 one ? one->radius_mm : NAN, one ? other->radius_mm : NAN);
}

/* Returns true where a geometry for each scan leaves nothing to explain, and what one for all
 * leaves beyond that is no error of the edge model itself. */
static bool explains_all(const fg_scan_loop *loop, const apart *a) {
  double error2 = loop->edge_error_um * loop->edge_error_um;
  double alone = mean_square(&a->edge_fit, a->residual_um);
  double together = mean_square(&loop->edge_fit, loop->residual_after);
  if (has_curve(&a->set) || a->set.count > EFFECTS_MAX) return false;
  return together - alone > error2 && (a->explanations.right || alone <= error2);
}

fg_status fg_scan_loop_check_one_foil(fg_context *ctx, const fg_scan_loop *loop) {
  apart a = {0};
  size_t views = 0;
  for (size_t v = 0; v < loop->edge_fit.view_count; v++)
    views += !loop->edge_fit.views[v].held_out;
  if (!loop->options.same_foil || views <= loop->edge_fit.part_count) return FG_OK;
  if (loop->explanations.right && !has_curve(&loop->set)) return FG_OK;
  fg_status status = set_apart(ctx, &loop->edge_fit, &a);
  bool told = status == FG_OK;
  if (status != FG_ERR_MEMORY) status = FG_OK; /* too few rows for a geometry each: no conclusion */
  if (told && explains_all(loop, &a) && preference(loop, &a) > PREFERENCE_MIN)
    status = fail_two_foils(ctx, loop, &a);
  fg_edge_fit_free(&a.edge_fit);
  free(a.residual_um);
  return status;
}
