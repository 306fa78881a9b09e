/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/form_error_draws.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/splitmix.h"

enum { DRAWS = 64 };
#define SEED 1

fg_form_error_moments fg_form_error_moments_in(double *numbers, const fg_circles *c) {
  return (fg_form_error_moments){
      .mean = numbers, .square = numbers + c->count, .ends = numbers + 2 * c->count};
}

void fg_form_error_deviations_close(fg_form_error_deviations *d) {
  free(d->columns);
  free(d->mean);
  free(d->lower);
  *d = (fg_form_error_deviations){.count = 0};
}

fg_status fg_form_error_deviations_open(fg_context *ctx, const fg_circles *c, size_t count,
                                        fg_form_error_deviations *d) {
  fg_status status = FG_OK;
  *d = (fg_form_error_deviations){.count = count};
  FG_TRY_EXIT(fg_memory_allocate(ctx, count * c->rows + 1, sizeof(double), (void **)&d->columns));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + 1, sizeof(double), (void **)&d->mean));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count * count + 1, sizeof(double), (void **)&d->lower));
exit:
  if (status != FG_OK) fg_form_error_deviations_close(d);
  return status;
}

/* Every draw writes to a place of its own. */
typedef struct drawing {
  const fg_circles *circles;
  const fg_form_error_deviations *deviations;
  double *normal;    /* owned; DRAWS × deviations */
  double *um, *sure; /* DRAWS × circles: over all rows, over the sure ones */
} drawing;

static void fill_normals(size_t count, double *normal) {
  uint64_t state = SEED;
  for (size_t i = 0; i < DRAWS * count; i++)
    normal[i] = fg_splitmix_normal(&state);
}

static fg_status draw_one(fg_context *ctx, void *shared, size_t draw) {
  const drawing *all = shared;
  const fg_circles *c = all->circles;
  const fg_form_error_deviations *d = all->deviations;
  const double *normal = all->normal + draw * d->count;
  double *values = NULL;
  FG_TRY(fg_memory_allocate(ctx, c->rows + 1, sizeof *values, (void **)&values));
  for (size_t k = 0; k < d->count; k++) {
    const double *column = d->columns + k * c->rows;
    double um = d->mean[k];
    for (size_t i = 0; i <= k; i++)
      um += d->lower[k * d->count + i] * normal[i];
    for (size_t i = 0; i < c->rows; i++)
      values[i] += um * column[i];
  }
  for (size_t k = 0; k < c->count; k++) {
    all->um[draw * c->count + k] = fg_circles_peak_to_valley(c, k, values);
    all->sure[draw * c->count + k] = fg_circles_sure_peak_to_valley(c, k, values);
  }
  free(values);
  return FG_OK;
}

/* By how much of itself a deviation may grow over what its arc may be longer. A shape that is
 * nearly all at the ends tells no more than that. */
static double growth(double um, double sure) {
  return sure > 0 ? fmin(1, fabs(um / sure - 1)) : 0;
}

static void add_draw(size_t circles, const double *um, const double *sure,
                     fg_form_error_moments *m) {
  for (size_t k = 0; k < circles; k++) {
    m->mean[k] += um[k] / DRAWS;
    m->square[k] += um[k] * um[k] / DRAWS;
    m->ends[k] += um[k] * growth(um[k], sure[k]) / DRAWS;
  }
}

fg_status fg_form_error_draw(fg_context *ctx, const fg_circles *c,
                             const fg_form_error_deviations *d, fg_form_error_moments *m) {
  drawing all = {.circles = c, .deviations = d};
  fg_status status = FG_OK;
  if (!d->count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, DRAWS * (d->count + 2 * c->count), sizeof *all.normal,
                            (void **)&all.normal));
  all.um = all.normal + DRAWS * d->count;
  all.sure = all.um + DRAWS * c->count;
  fill_normals(d->count, all.normal);
  FG_TRY_EXIT(fg_parallel_run(ctx, c->edge_fit->threads, DRAWS, draw_one, &all));
  for (size_t draw = 0; draw < DRAWS; draw++)
    add_draw(c->count, all.um + draw * c->count, all.sure + draw * c->count, m);
exit:
  free(all.normal);
  return status;
}
