/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random deviation of each edge, correlated along the strip or around a disc. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/spec.h"

static const double pi = 3.14159265358979323846;

/* Values of a drawn sequence per correlation length, and per sd of the smoothing. Samples of the
 * picture are smoothed across the edge (sampler.h), and with the same Gaussian along it: else
 * scatter finer than a sample would enter by points, and not by its mean. */
enum { STEPS_PER_CORRELATION = 4, STEPS_PER_SMOOTHING = 2 };

static const double SAMPLED_PX = 0.3; /* sd of the sampling */

typedef struct sequence {
  double length_mm, smooth_mm, step_mm; /* correlation length; sd of the smoothing */
  bool exponential, closed;
  size_t count;
  int half; /* of the kernel */
  double *kernel;
  float *white;
} sequence;

static void free_sequence(sequence *q) {
  free(q->kernel);
  free(q->white);
}

/* White noise through a Gaussian of sd L/2 has the autocorrelation exp(-(d/L)²); the smoothing
 * widens that Gaussian in squares. For the exponential form it is the whole kernel. */
static fg_status make_kernel(fg_context *ctx, sequence *q) {
  double own = q->exponential ? 0 : 0.5 * q->length_mm;
  double sd = hypot(own, q->smooth_mm) / q->step_mm;
  q->half = (int)lround(4 * sd);
  FG_TRY(fg_memory_allocate(ctx, 2 * (size_t)q->half + 1, sizeof *q->kernel, (void **)&q->kernel));
  for (int k = -q->half; k <= q->half; k++) {
    double u = k / sd;
    q->kernel[k + q->half] = exp(-0.5 * u * u);
  }
  return FG_OK;
}

/* Length of the white noise. A closed sequence may be shorter than the kernel, which then goes
 * round more than once. */
static size_t white_count(const sequence *q) {
  return q->closed ? q->count : q->count + 2 * (size_t)q->half;
}

static double white_at(const sequence *q, size_t i, int k) {
  if (!q->closed) return (double)q->white[i + (size_t)(k + q->half)];
  int64_t count = (int64_t)q->count, at = ((int64_t)i + k) % count;
  return (double)q->white[at < 0 ? at + count : at];
}

/* Factor that gives the smoothed sequence its variance: 1 for the edge before the smoothing. */
static double gaussian_scale(const sequence *q) {
  double squares = 0;
  if (!q->closed) {
    for (int k = 0; k <= 2 * q->half; k++)
      squares += q->kernel[k] * q->kernel[k];
  } else {
    for (size_t i = 0; i < q->count; i++) { /* folded */
      double sum = 0;
      for (int64_t k = (int64_t)i; k <= 2 * q->half; k += (int64_t)q->count)
        sum += q->kernel[k];
      squares += sum * sum;
    }
  }
  double widened = hypot(q->length_mm, 2 * q->smooth_mm);
  return sqrt(q->length_mm / widened / squares);
}

/* Turns white noise of variance 1 into an autoregression of first order: exactly exp(-d/L) at the
 * steps. A closed sequence continues at its begin. */
static void make_exponential(sequence *q) {
  size_t count = white_count(q);
  double rho = exp(-q->step_mm / q->length_mm), fresh = sqrt(1 - rho * rho);
  double at = (double)q->white[0];
  if (q->closed) {
    double round = 0, lap = exp(-q->step_mm * (double)count / q->length_mm);
    for (size_t i = 0; i < count; i++)
      round = rho * round + fresh * (double)q->white[i];
    /* An endless repetition has the variance (1 + lap) / (1 - lap). */
    double scale = sqrt((1 - lap) / (1 + lap));
    fresh *= scale;
    at = scale * round / (1 - lap);
    at = rho * at + fresh * (double)q->white[0];
  }
  for (size_t i = 0; i < count; i++) {
    if (i > 0) at = rho * at + fresh * (double)q->white[i];
    q->white[i] = (float)at;
  }
}

static double kernel_sum(const sequence *q) {
  double sum = 0;
  for (int k = 0; k <= 2 * q->half; k++)
    sum += q->kernel[k];
  return sum;
}

static void draw_sequence(fg_random *random, sequence *q, double sd, float *out) {
  size_t count = white_count(q);
  for (size_t i = 0; i < count; i++)
    q->white[i] = (float)fg_random_normal(random);
  if (q->exponential) make_exponential(q);
  double scale = sd * (q->exponential ? 1 / kernel_sum(q) : gaussian_scale(q));
  for (size_t i = 0; i < q->count; i++) {
    double sum = 0;
    for (int k = -q->half; k <= q->half; k++)
      sum += q->kernel[k + q->half] * white_at(q, i, k);
    out[i] = (float)(scale * sum);
  }
}

static sequence describe_sequence(const fg_render_spec *spec, bool closed) {
  sequence q = {.length_mm = 1e-3 * spec->scanner.edge_correlation_um,
                .smooth_mm = SAMPLED_PX * fmax(spec->sensor.pixel_mm[0], spec->sensor.pixel_mm[1]),
                .exponential = spec->scanner.edge_exponential,
                .closed = closed};
  q.step_mm = q.length_mm / STEPS_PER_CORRELATION;
  if (q.exponential) q.step_mm = fmin(q.step_mm, q.smooth_mm / STEPS_PER_SMOOTHING);
  return q;
}

static fg_status prepare_sequence(fg_context *ctx, sequence *q) {
  FG_TRY(make_kernel(ctx, q));
  return fg_memory_allocate(ctx, white_count(q), sizeof *q->white, (void **)&q->white);
}

/* Draws the cuts' roughness after that of the edges, which so does not change. `q` is the edges',
 * whose kernel and noise buffers serve here too: a strip is thinner than it is long. */
static fg_status build_cuts(fg_context *ctx, fg_random *random, sequence q,
                            const fg_scanner *scanner, fg_drawn_foil *drawn) {
  double sd = 1e-3 * hypot(scanner->edge_roughness_um, scanner->edge_common_um);
  size_t count = (size_t)(2 * drawn->half_thickness_mm / q.step_mm) + 4;
  if (count > q.count) return FG_OK;
  drawn->cut_count = q.count = count;
  for (int end = 0; end < 2; end++) {
    FG_TRY(fg_memory_allocate(ctx, count, sizeof(float), (void **)&drawn->cut[end]));
    draw_sequence(random, &q, sd, drawn->cut[end]);
  }
  return FG_OK;
}

/* A sheet's outlines have one edge, which scatters by both. */
static double edge_sd_mm(const fg_scanner *scanner, const fg_drawn_foil *drawn) {
  double common_um = drawn->sheet ? scanner->edge_common_um : 0;
  return 1e-3 * hypot(scanner->edge_roughness_um, common_um);
}

fg_status fg_roughness_build(fg_context *ctx, const fg_render_spec *spec, size_t foil,
                             fg_drawn_foil *drawn) {
  const fg_scanner *scanner = &spec->scanner;
  if (scanner->edge_roughness_um <= 0 && scanner->edge_common_um <= 0) return FG_OK;
  float *common = NULL;
  fg_status status = FG_OK;
  fg_random random;
  fg_random_seed(&random, spec->seed, FG_STREAM_ROUGHNESS, foil);
  sequence q = describe_sequence(spec, false);
  q.count = (size_t)(drawn->length_mm / q.step_mm) + 4;
  drawn->roughness_step_mm = q.step_mm;
  drawn->roughness_count = q.count;
  FG_TRY_EXIT(prepare_sequence(ctx, &q));
  FG_TRY_EXIT(fg_memory_allocate(ctx, q.count, sizeof *common, (void **)&common));
  draw_sequence(&random, &q, 1e-3 * scanner->edge_common_um, common);
  for (int edge = 0; edge < (drawn->sheet ? 1 : 2); edge++) {
    FG_TRY_EXIT(fg_memory_allocate(ctx, q.count, sizeof(float), (void **)&drawn->roughness[edge]));
    draw_sequence(&random, &q, edge_sd_mm(scanner, drawn), drawn->roughness[edge]);
    for (size_t i = 0; !drawn->sheet && i < q.count; i++)
      drawn->roughness[edge][i] += common[i];
  }
  if (drawn->rough_cuts) FG_TRY_EXIT(build_cuts(ctx, &random, q, scanner, drawn));
exit:
  free_sequence(&q);
  free(common);
  return status;
}

/* A disc has one edge, which scatters by both. */
fg_status fg_roughness_build_disc(fg_context *ctx, const fg_render_spec *spec, size_t disc,
                                  fg_shape *shape) {
  enum { MIN_COUNT = 8 };
  double sd = 1e-3 * hypot(spec->scanner.edge_roughness_um, spec->scanner.edge_common_um);
  if (sd <= 0) return FG_OK;
  fg_status status = FG_OK;
  fg_random random;
  fg_random_seed(&random, spec->seed, FG_STREAM_ROUGHNESS, FG_RENDER_FOILS_MAX + disc);
  sequence q = describe_sequence(spec, true);
  double round_mm = 2 * pi * shape->radius;
  q.count = (size_t)fmax(MIN_COUNT, ceil(round_mm / q.step_mm));
  q.step_mm = round_mm / (double)q.count;
  FG_TRY_EXIT(prepare_sequence(ctx, &q));
  FG_TRY_EXIT(fg_memory_allocate(ctx, q.count + 4, sizeof(float), (void **)&shape->roughness));
  draw_sequence(&random, &q, sd, shape->roughness + 1);
  shape->roughness[0] = shape->roughness[q.count];
  for (size_t i = 1; i <= 3; i++)
    shape->roughness[q.count + i] = shape->roughness[i];
  shape->roughness_count = q.count;
exit:
  free_sequence(&q);
  return status;
}

double fg_roughness_at(const float *values, double place) {
  size_t i = (size_t)place;
  double t = place - (double)i;
  const float *v = values + i - 1;
  double a = (double)v[0], b = (double)v[1], c = (double)v[2], d = (double)v[3];
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}
