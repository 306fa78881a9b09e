/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pixels' part in the equations of every station, eight pixels at a time. */
#include <math.h>
#include <string.h>

#include "vision/edge_work.h"

/* All functions on eight numbers are inlined, so that none is handed over in registers that a
 * machine may not have. */
#pragma GCC diagnostic ignored "-Wpsabi"

/* Numbers of eight pixels of one station. */
enum { LANES = 8, TOGETHER = 64 };
typedef float eight __attribute__((vector_size(32)));
typedef int32_t eight_bits __attribute__((vector_size(32)));

/* Ends of the counts' scale: a model and a pixel beyond the same end do not differ. */
static const float DARK_END = 0.5f, BRIGHT_END = 254.5f;

static inline __attribute__((always_inline)) eight even(float x) {
  return (eight){x, x, x, x, x, x, x, x};
}

static inline __attribute__((always_inline)) eight choose_each(eight_bits mask, eight yes,
                                                               eight no) {
  return (eight)((mask & (eight_bits)yes) | (~mask & (eight_bits)no));
}

static inline __attribute__((always_inline)) eight largest(eight a, eight b) {
  return choose_each(a > b, a, b);
}

/* exp(-t²/2) / sqrt(2 pi), relative error below 1e-6: 2^n 2^f with f between -1/2 and 1/2. */
static inline __attribute__((always_inline)) eight density_of(eight t) {
  const float round = 12582912; /* 1.5 × 2^23: a sum with it has no fraction */
  eight power = largest(t * t * -0.72134752f, even(-120));
  eight whole = power + round - round;
  eight f = (power - whole) * 0.69314718f;
  eight part =
      1 + f * (1 + f * (0.5f + f * (1.6666667e-1f + f * (4.1666668e-2f + f * 8.333334e-3f))));
  eight_bits exponent = __builtin_convertvector(whole, eight_bits) << 23;
  return (eight)((eight_bits)(part * 0.39894228f) + exponent);
}

/* Phi(t), error below 1e-7, from phi(t). Abramowitz and Stegun, Handbook of Mathematical Functions,
 * 26.2.17. */
static inline __attribute__((always_inline)) eight cumulative_of(eight t, eight density) {
  eight k = 1 / (1 + 0.2316419f * largest(t, -t));
  eight tail = density * k *
               (0.319381530f +
                k * (-0.356563782f + k * (1.781477937f + k * (-1.821255978f + k * 1.330274429f))));
  return choose_each(t > 0, 1 - tail, tail);
}

/* Counts of light, and their rate. */
static inline __attribute__((always_inline)) eight tone_of(const fg_edge_tables *tables,
                                                           eight light, eight *rate) {
  const float scale = FG_TONE_STEPS / 255.0f;
  *rate = even(1);
  if (tables->linear) return light;
  eight x = largest(light * scale, even(0));
  x = choose_each(x > FG_TONE_STEPS, even(FG_TONE_STEPS), x);
  eight_bits step = __builtin_convertvector(x, eight_bits);
  eight low, high;
  for (int k = 0; k < LANES; k++) {
    low[k] = tables->tone[step[k]];
    high[k] = tables->tone[step[k] + 1];
  }
  *rate = (high - low) * scale;
  return low + (x - __builtin_convertvector(step, eight)) * (high - low);
}

typedef struct sums {
  eight m11, m12, m22, g1, g2, misfit;
  eight_bits used, seen; /* less by 1 with each pixel */
} sums;

/* Adds eight pixels; `across` is NaN where there is none. */
static inline __attribute__((always_inline)) void add_eight(const fg_edge_tables *tables,
                                                            const fg_edge_station *s, eight across,
                                                            eight value, float limit, sums *out) {
  float i1 = 1.0f / s->blur_px[0], i2 = 1.0f / s->blur_px[1];
  eight d1 = s->edge_px[0] - across, d2 = across - s->edge_px[1];
  eight t1 = d1 * i1, t2 = d2 * i2;
  eight_bits inside = across == across;
  eight p1 = density_of(t1), p2 = density_of(t2);
  eight light = s->plateau + (s->step[0] + s->slope[0] * d1) * cumulative_of(t1, p1) +
                s->slope[0] * s->blur_px[0] * p1 +
                (s->step[1] + s->slope[1] * d2) * cumulative_of(t2, p2) +
                s->slope[1] * s->blur_px[1] * p2;
  eight rate, model = tone_of(tables, light, &rate);
  /* A pixel cut off at an end of the scale is neither evidence nor an outlier. */
  eight_bits cut =
      ((model >= BRIGHT_END) & (value >= BRIGHT_END)) | ((model <= DARK_END) & (value <= DARK_END));
  eight residual = value - model;
  eight_bits seen = inside & ~cut;
  eight_bits used = seen & (largest(residual, -residual) <= limit);
  out->seen += seen;
  out->used += used;
  /* The filters omit the slopes: a slope is the least certain part of the shape. */
  eight none = even(0);
  eight f1 = choose_each(used, rate * s->step[0] * p1 * i1, none);
  eight f2 = choose_each(used, -rate * s->step[1] * p2 * i2, none);
  residual = choose_each(used, residual, none);
  out->m11 += f1 * f1;
  out->m12 += f1 * f2;
  out->m22 += f2 * f2;
  out->g1 += f1 * residual;
  out->g2 += f2 * residual;
  out->misfit += residual * residual;
}

static inline __attribute__((always_inline)) float total(eight x) {
  return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

static inline __attribute__((always_inline)) int32_t count_of(eight_bits x) {
  int32_t sum = 0;
  for (int k = 0; k < LANES; k++)
    sum -= x[k];
  return sum;
}

/* Adds a station's pixels, within the reach of both edges, to its sums. */
__attribute__((target_clones("avx2", "default"))) static void
add_station(const fg_edge_tables *tables, const fg_pixel_band *band, size_t k,
            const float ends_px[2], float limit, fg_edge_station *s) {
  sums sum;
  memset(&sum, 0, sizeof sum);
  size_t end = band->begin[k + 1];
  for (size_t i = band->begin[k]; i < end;) {
    float across[TOGETHER + LANES], value[TOGETHER + LANES];
    size_t held = 0;
    for (; i < end && held < TOGETHER; i++) {
      across[held] = band->across_px[i];
      value[held] = band->value[i];
      held += (band->across_px[i] >= ends_px[0]) & (band->across_px[i] <= ends_px[1]);
    }
    for (size_t j = 0; j < LANES; j++) {
      across[held + j] = NAN;
      value[held + j] = 0;
    }
    for (size_t j = 0; j < held; j += LANES) {
      eight a, v;
      memcpy(&a, across + j, sizeof a);
      memcpy(&v, value + j, sizeof v);
      add_eight(tables, s, a, v, limit, &sum);
    }
  }
  s->m11 = total(sum.m11);
  s->m12 = total(sum.m12);
  s->m22 = total(sum.m22);
  s->g1 = total(sum.g1);
  s->g2 = total(sum.g2);
  s->misfit = total(sum.misfit);
  s->used = count_of(sum.used);
  s->seen = count_of(sum.seen);
}

void fg_edges_add_plain(const fg_edge_work *work, size_t chunk, float limit) {
  const fg_pixel_band *band = &work->bands[chunk];
  float outer = fg_edges_outer(work);
  for (size_t k = 0; k < band->stations; k++) {
    fg_edge_station *s = &work->stations[band->first + k];
    if (band->begin[k] == band->begin[k + 1]) continue;
    const float ends_px[2] = {s->edge_px[0] - fminf((float)FG_REACH_BLURS * s->blur_px[0], outer),
                              s->edge_px[1] + fminf((float)FG_REACH_BLURS * s->blur_px[1], outer)};
    add_station(work->tables, band, k, ends_px, limit, s);
  }
}
