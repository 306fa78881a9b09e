/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of every station of a round feature from its pixels, the shape held. */
#include "vision/disc_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

enum { ROUNDS = 4 };
/* Limit for a pixel of dust or damage: noise sd plus a share of the contrast. */
#define OUTLIER_SIGMAS 6.0
#define OUTLIER_SHARE  0.25
/* Reach of an edge, in blurs: pixels beyond it do not depend on the edge's place. */
#define REACH_BLURS 4.0f
#define MOVE_MAX_PX 3.0f
/* Half width of the core, in blurs: its pixels hold half of the information about the edge. */
#define CORE_BLURS 0.48f

static void clear_sums(fg_disc_station *s) {
  s->m[0] = s->m[1] = s->g[0] = s->g[1] = s->misfit = 0;
  s->used = s->seen = 0;
}

/* Adds one pixel whose model is known. */
static inline void add_residual(fg_disc_station *s, float value, float model, float by_edge,
                                bool core, float limit) {
  if ((model >= 254.5f && value >= 254.5f) || (model <= 0.5f && value <= 0.5f)) return;
  s->seen++; /* a pixel cut off at an end of the scale is neither evidence nor an outlier */
  float residual = value - model;
  if (fabsf(residual) > limit) return;
  s->m[!core] += by_edge * by_edge;
  s->g[!core] += by_edge * residual;
  s->misfit += residual * residual;
  s->used++;
}

static void add_pixel(const fg_edge_tables *tables, fg_disc_station *s, const fg_ring_pixel *p,
                      float limit) {
  float d = p->across_px - s->edge_px, blur = s->shape[FG_STEP_BLUR], t = d / blur;
  if (fabsf(t) > REACH_BLURS) return;
  float density, cumulative, model, rate;
  const float *shape = s->shape;
  float g = shape[FG_STEP_SLOPE_IN], h = shape[FG_STEP_SLOPE_OUT];
  fg_edge_normal(tables, t, &density, &cumulative);
  float step = shape[FG_STEP_OUTSIDE] - shape[FG_STEP_INSIDE];
  float light =
      shape[FG_STEP_INSIDE] + g * d + (step + (h - g) * d) * cumulative + (h - g) * blur * density;
  fg_edge_tone(tables, light, &model, &rate);
  add_residual(s, p->value, model, -rate * step * density / blur, fabsf(t) <= CORE_BLURS, limit);
}

/* Moves a station's edge; u and split are for pixels of unit sd. */
static void move_edge(fg_disc_station *s) {
  float m = s->m[0] + s->m[1];
  s->weight = 0;
  s->u_px = NAN;
  if (!(m > 0) || s->used < s->seen * 3 / 4) return;
  float move = (s->g[0] + s->g[1]) / m;
  s->u_px = 1 / sqrtf(m);
  s->split_px = s->u_split_px = NAN;
  if (s->m[0] > 0.05f * m && s->m[1] > 0.05f * m) {
    s->split_px = 0.5f * (s->g[1] / s->m[1] - s->g[0] / s->m[0]);
    s->u_split_px = 0.5f * sqrtf(1 / s->m[0] + 1 / s->m[1]);
  }
  if (fabsf(move) > MOVE_MAX_PX) return;
  s->edge_px += move;
  s->weight = 1;
}

/* Robust sd of a pixel: the median over the stations' mean squares. */
static double estimate_noise(const fg_disc_edge *edge, double *scratch) {
  size_t n = 0;
  for (size_t i = 0; i < edge->count; i++) {
    const fg_disc_station *s = &edge->stations[i];
    if (s->used >= 4 && s->weight > 0) scratch[n++] = s->misfit / (float)(s->used - 1);
  }
  if (!n) return 1;
  double median = fg_select(scratch, n, n / 2), sum = 0, count = 0;
  for (size_t i = 0; i < n; i++) {
    if (scratch[i] > 6 * median) continue;
    sum += scratch[i];
    count++;
  }
  return sqrt(sum / count) + 1e-4;
}

static void add_driven(const fg_disc_work *work, const fg_driven_tables *tables, fg_disc_edge *edge,
                       float limit) {
  for (size_t i = 0; i < work->ring.count; i++) {
    const fg_ring_pixel *p = &work->ring.pixels[i];
    fg_disc_station *s = &edge->stations[p->station];
    float d = p->across_px - s->edge_px, model, by_edge;
    if (!fg_disc_driven_at(work, tables, (size_t)p->station, s, d, &model, &by_edge)) continue;
    bool core = fabsf(d) <= CORE_BLURS * s->shape[FG_STEP_BLUR];
    add_residual(s, p->value, model, by_edge, core, limit);
  }
}

static void solve_round(const fg_disc_work *work, const fg_edge_tables *tables,
                        const fg_driven_tables *driven, float limit, fg_disc_edge *edge) {
  for (size_t i = 0; i < edge->count; i++)
    clear_sums(&edge->stations[i]);
  if (work->driver) add_driven(work, driven, edge, limit);
  for (size_t i = 0; i < work->ring.count && !work->driver; i++) {
    const fg_ring_pixel *p = &work->ring.pixels[i];
    add_pixel(tables, &edge->stations[p->station], p, limit);
  }
  for (size_t i = 0; i < edge->count; i++)
    move_edge(&edge->stations[i]);
}

/* Twice the shift of a curved edge of radius 1 towards its centre: s² for a blur s. An unsharp
 * mask weighs the level at the edge and the slope there alike for its two blurs. */
static double blur_shift(const fg_disc_work *work, double blur) {
  double amount = work->driver ? work->driver->values[FG_DRIVER_AMOUNT] : 0;
  if (amount == 0) return blur * blur;
  double wide = hypot(blur, work->driver->values[FG_DRIVER_RADIUS]);
  return ((1 + amount) * blur - amount * wide) / ((1 + amount) / blur - amount / wide);
}

/* Scales the deviations, drops stations whose pixels miss the model far more than usual or that lie
 * in a sector without an edge, and corrects the blur's shift. */
static void finish_stations(const fg_disc_work *work, fg_disc_edge *edge) {
  size_t per_sector = edge->count / work->ring.sector_count;
  double contrast = fabs(edge->outside - edge->inside);
  double limit = 9 * edge->noise * edge->noise + 0.002 * contrast * contrast;
  for (size_t i = 0; i < edge->count; i++) {
    fg_disc_station *s = &edge->stations[i];
    s->u_px *= (float)edge->noise;
    s->u_split_px *= (float)edge->noise;
    if (s->used < 2 || s->misfit > limit * s->used || !work->sectors[i / per_sector].good)
      s->weight = 0;
    float blur = s->shape[FG_STEP_BLUR];
    s->edge_px += (float)blur_shift(work, (double)blur) / (2 * (float)edge->circle.radius);
  }
}

fg_status fg_disc_solve(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge) {
  fg_edge_tables *tables = NULL;
  double *scratch = NULL;
  fg_driven_tables driven = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *tables, (void **)&tables));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge->count, sizeof *scratch, (void **)&scratch));
  fg_edge_tables_init(tables, work->gamma);
  if (work->driver) FG_TRY_EXIT(fg_disc_fill_tables(ctx, work, edge, &driven));
  float limit = 1e9f;
  for (int round = 0; round < ROUNDS; round++) {
    solve_round(work, tables, &driven, limit, edge);
    edge->noise = estimate_noise(edge, scratch);
    limit =
        (float)(OUTLIER_SIGMAS * edge->noise + OUTLIER_SHARE * fabs(edge->outside - edge->inside));
  }
  finish_stations(work, edge);
exit:
  free(tables);
  fg_driven_tables_free(&driven);
  free(scratch);
  return status;
}
