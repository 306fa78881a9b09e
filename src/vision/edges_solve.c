/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Both edges of every station from its pixels, the shape of the profile held. */
#include "vision/edge_work.h"

#include <math.h>

#include "core/parallel.h"

/* Limit for a pixel of dust or a burr: noise sd plus a share of the contrast. */
#define OUTLIER_SIGMAS 6.0
#define OUTLIER_SHARE  0.25

static void clear_sums(fg_edge_station *s) {
  s->m11 = s->m12 = s->m22 = s->g1 = s->g2 = s->misfit = 0;
  s->used = s->seen = 0;
}

/* Solves the 2 × 2 system of a station and moves its edges; u_px is for pixels of unit sd. */
static void move_edges(fg_edge_station *s) {
  double det = (double)s->m11 * s->m22 - (double)s->m12 * s->m12;
  s->weight = 0;
  s->u_px[0] = s->u_px[1] = NAN;
  if (!(det > 1e-6 * (double)s->m11 * s->m22) || s->used < s->seen * 3 / 4) return;
  double a = (s->m22 * (double)s->g1 - s->m12 * (double)s->g2) / det;
  double b = (s->m11 * (double)s->g2 - s->m12 * (double)s->g1) / det;
  s->u_px[0] = (float)sqrt(s->m22 / det);
  s->u_px[1] = (float)sqrt(s->m11 / det);
  if (fabs(a) > 3 || fabs(b) > 3) return;
  s->edge_px[0] += (float)a;
  s->edge_px[1] += (float)b;
  s->weight = 1;
}

static double estimate_noise(const fg_edge_work *work) {
  double sum = 0, dof = 0;
  for (size_t i = 0; i < work->reference->count; i++) {
    const fg_edge_station *s = &work->stations[i];
    if (s->used < 8) continue;
    sum += s->misfit;
    dof += s->used - 2;
  }
  return dof > 0 ? sqrt(sum / dof) : 1;
}

/* Drops stations whose pixels miss the model far more than usual: they carry dust or a burr. */
static void drop_misfits(fg_edge_work *work) {
  double limit = 9 * work->noise * work->noise + 0.001 * work->contrast * work->contrast;
  for (size_t i = 0; i < work->reference->count; i++) {
    fg_edge_station *s = &work->stations[i];
    if (s->used < 8 || s->misfit > limit * s->used) s->weight = 0;
  }
}

/* One round on the stations of one chunk. The variance of the pixels is set afterwards. */
static fg_status solve_task(fg_context *ctx, void *shared, size_t chunk) {
  fg_edge_work *work = shared;
  size_t first, last;
  fg_edges_chunk(work, chunk, &first, &last);
  for (size_t i = first; i <= last; i++)
    clear_sums(&work->stations[i]);
  float limit =
      (float)(work->round == 0 ? 1e9
                               : OUTLIER_SIGMAS * work->noise + OUTLIER_SHARE * work->contrast);
  if (work->driver)
    FG_TRY(fg_edges_add_driven(ctx, work, chunk, limit));
  else
    fg_edges_add_plain(work, chunk, limit);
  for (size_t i = first; i <= last; i++)
    move_edges(&work->stations[i]);
  return FG_OK;
}

fg_status fg_edges_solve(fg_context *ctx, fg_edge_work *work, int rounds) {
  for (work->round = 0; work->round < rounds; work->round++) {
    FG_TRY(fg_parallel_run(ctx, work->threads, work->chunk_count, solve_task, work));
    work->noise = estimate_noise(work);
  }
  for (size_t i = 0; i < work->reference->count; i++)
    for (int side = 0; side < 2; side++)
      work->stations[i].u_px[side] *= (float)work->noise;
  drop_misfits(work);
  return FG_OK;
}
