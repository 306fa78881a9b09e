/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/bump_misfit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"

/* A bump is no circle where its scatter exceeds the median by this share and by this many standard
 * deviations among the bumps. */
#define POOR_SHARE  0.3
#define POOR_SIGMAS 4.0

double fg_misfit_rms_limit(fg_context *ctx, const fg_layout *layout) {
  double *values = NULL, median = NAN;
  size_t bumps = layout->turning.bump_count, n = 0, m = 0;
  if (fg_memory_allocate(ctx, bumps, sizeof *values, (void **)&values) != FG_OK) return NAN;
  for (size_t i = 0; i < bumps; i++)
    if (layout->fitted[i]) values[n++] = layout->bumps[i].rms_mm;
  if (n) median = fg_select(values, n, n / 2);
  for (size_t i = 0; i < bumps; i++)
    if (layout->fitted[i]) values[m++] = fabs(layout->bumps[i].rms_mm - median);
  double limit = fg_spread_limit(values, m, POOR_SIGMAS);
  free(values);
  return median + fmax(POOR_SHARE * median, limit);
}

void fg_misfit_widen(const fg_datum_line *line, double rms_limit_mm, fg_arc *arc) {
  fg_noise_model own;
  fg_arc misfit = *arc;
  if (!(arc->rms_mm > rms_limit_mm)) return;
  fg_noise_estimate(line, arc, 1, FG_NOISE_OF_LINE, &own);
  fg_arc_covariance(line, &own, &misfit);
  if (misfit.covariance[2][2] > arc->covariance[2][2])
    memcpy(arc->covariance, misfit.covariance, sizeof arc->covariance);
}
