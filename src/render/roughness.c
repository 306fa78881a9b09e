/* Random deviation of each edge, correlated along the strip. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "render/random.h"
#include "render/spec.h"

enum { STEPS_PER_CORRELATION = 4, HALF_WIDTH = 8 };

/* White noise through a Gaussian of sd L/2 has the autocorrelation exp(-(d/L)²). */
static void smooth_noise(fg_random *random, double sd, float *white, float *out, size_t count) {
  double kernel[2 * HALF_WIDTH + 1], squares = 0;
  for (int k = -HALF_WIDTH; k <= HALF_WIDTH; k++) {
    double u = 2.0 * k / STEPS_PER_CORRELATION;
    kernel[k + HALF_WIDTH] = exp(-0.5 * u * u);
    squares += kernel[k + HALF_WIDTH] * kernel[k + HALF_WIDTH];
  }
  for (size_t i = 0; i < count + 2 * HALF_WIDTH; i++)
    white[i] = (float)fg_random_normal(random);
  for (size_t i = 0; i < count; i++) {
    double sum = 0;
    for (int k = 0; k <= 2 * HALF_WIDTH; k++)
      sum += kernel[k] * (double)white[i + (size_t)k];
    out[i] = (float)(sd * sum / sqrt(squares));
  }
}

fg_status fg_roughness_build(fg_context *ctx, const fg_scanner *scanner, uint64_t seed, size_t foil,
                             fg_drawn_foil *drawn) {
  if (scanner->edge_roughness_um <= 0 && scanner->edge_common_um <= 0) return FG_OK;
  float *white = NULL, *common = NULL;
  fg_status status = FG_OK;
  fg_random random;
  fg_random_seed(&random, seed, FG_STREAM_ROUGHNESS, foil);
  drawn->roughness_step_mm = 1e-3 * scanner->edge_correlation_um / STEPS_PER_CORRELATION;
  size_t count = (size_t)(drawn->length_mm / drawn->roughness_step_mm) + 4;
  drawn->roughness_count = count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + 2 * HALF_WIDTH, sizeof *white, (void **)&white));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *common, (void **)&common));
  smooth_noise(&random, 1e-3 * scanner->edge_common_um, white, common, count);
  for (int edge = 0; edge < 2; edge++) {
    FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(float), (void **)&drawn->roughness[edge]));
    smooth_noise(&random, 1e-3 * scanner->edge_roughness_um, white, drawn->roughness[edge], count);
    for (size_t i = 0; i < count; i++)
      drawn->roughness[edge][i] += common[i];
  }
exit:
  free(white);
  free(common);
  return status;
}
