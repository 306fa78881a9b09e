/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Both edges of every station from its pixels, the shape of the profile held. */
#include "vision/edge_work.h"

#include <math.h>
#include <string.h>

#include "core/parallel.h"

/* Limit for a pixel of dust or a burr: noise sd plus a share of the contrast. */
#define OUTLIER_SIGMAS 6.0
#define OUTLIER_SHARE  0.25

/* Values of a station that all its pixels share. */
typedef struct held {
  float edge_px[2], blur_inverse[2], plateau, step[2], slope[2], slope_blur[2], reach[2];
} held;

static held held_of_station(const fg_edge_work *work, const fg_edge_station *s) {
  float outer = fg_edges_outer(work);
  return (held){.edge_px = {s->edge_px[0], s->edge_px[1]},
                .blur_inverse = {1.0f / s->blur_px[0], 1.0f / s->blur_px[1]},
                .plateau = s->plateau,
                .step = {s->step[0], s->step[1]},
                .slope = {s->slope[0], s->slope[1]},
                .slope_blur = {s->slope[0] * s->blur_px[0], s->slope[1] * s->blur_px[1]},
                .reach = {fminf((float)FG_REACH_BLURS, outer / s->blur_px[0]),
                          fminf((float)FG_REACH_BLURS, outer / s->blur_px[1])}};
}

/* Adds one pixel to its station. */
static inline void add_pixel(const fg_edge_tables *tables, const held *h, fg_edge_station *s,
                             float across, float value, float limit) {
  float d1 = h->edge_px[0] - across, d2 = across - h->edge_px[1];
  float i1 = h->blur_inverse[0], i2 = h->blur_inverse[1];
  float t1 = d1 * i1, t2 = d2 * i2;
  if (t1 > h->reach[0] || t2 > h->reach[1]) return;
  float p1, c1, p2, c2;
  fg_edge_normal(tables, t1, &p1, &c1);
  fg_edge_normal(tables, t2, &p2, &c2);
  float light = h->plateau + (h->step[0] + h->slope[0] * d1) * c1 + h->slope_blur[0] * p1 +
                (h->step[1] + h->slope[1] * d2) * c2 + h->slope_blur[1] * p2;
  float model, rate;
  fg_edge_tone(tables, light, &model, &rate);
  if ((model >= 254.5f && value >= 254.5f) || (model <= 0.5f && value <= 0.5f)) return;
  s->seen++; /* a pixel cut off at an end of the scale is neither evidence nor an outlier */
  float residual = value - model;
  if (fabsf(residual) > limit) return;
  /* The filters omit the slopes: a slope is the least certain part of the shape. */
  float f1 = rate * h->step[0] * p1 * i1, f2 = -rate * h->step[1] * p2 * i2;
  s->m11 += f1 * f1;
  s->m12 += f1 * f2;
  s->m22 += f2 * f2;
  s->g1 += f1 * residual;
  s->g2 += f2 * residual;
  s->misfit += residual * residual;
  s->used++;
}

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

/* Adds all pixels of a chunk to their stations. */
static void add_plain(const fg_edge_work *work, size_t chunk, size_t first, size_t last,
                      float limit) {
  held holds[FG_CHUNK_STATIONS];
  for (size_t i = first; i <= last; i++)
    holds[i - first] = held_of_station(work, &work->stations[i]);
  const fg_pixel_band *band = &work->bands[chunk];
  for (size_t i = 0; i < band->count; i++) {
    const fg_band_pixel *p = &band->pixels[i];
    size_t station = (size_t)p->station;
    add_pixel(work->tables, &holds[station - first], &work->stations[station], p->across_px,
              p->value, limit);
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
    add_plain(work, chunk, first, last, limit);
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
