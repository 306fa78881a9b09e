/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stations where dust, a speck or a burr lies on the strip or beside it. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"
#include "vision/edge_work.h"

/* Number of stations to either side in a misfit, and the limit above the usual misfit, in units of
 * its scatter. */
enum { MISFIT_REACH = 2 };
#define MISFIT_SPREADS 5.0
/* Additional misfit of the model itself where the curvature changes, as a share of the contrast's
 * square. */
#define MISFIT_SHARE 6e-5
#define MARGIN_BLURS 2.0

/* Misfit of the pixels around a station, per pixel. */
static double misfit_around(const fg_edge_work *work, size_t i) {
  size_t from = i > MISFIT_REACH ? i - MISFIT_REACH : 0;
  double sum = 0, used = 0;
  for (size_t k = from; k <= i + MISFIT_REACH && k < work->reference->count; k++) {
    const fg_edge_station *s = &work->stations[k];
    sum += s->misfit;
    used += s->used;
  }
  return used > 0 ? sum / used : NAN;
}

/* Returns the usual misfit along the strip, and its scatter: of its logarithm, since general errors
 * of the model (halo, JPEG blocks) raise it by a factor. */
static double usual_misfit(const double *misfit, size_t count, double *work, double *spread) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    if (misfit[i] > 0) work[n++] = log(misfit[i]);
  if (!n) return NAN;
  double median = fg_select(work, n, n / 2);
  for (size_t i = 0; i < n; i++)
    work[i] = fabs(work[i] - median);
  *spread = fg_robust_sd(work, n);
  return median;
}

/* Drops the stations whose neighbourhood has a misfit beyond chance, and those within two blurs of
 * them. Dust near an edge moves it long before its pixels are outliers, and blur carries it to
 * stations where no pixel stands out. */
fg_status fg_edges_drop_disturbed(fg_context *ctx, fg_edge_work *work, size_t *found) {
  size_t count = work->reference->count;
  double *misfit = NULL, spread = 0;
  *found = 0;
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *misfit, (void **)&misfit));
  for (size_t i = 0; i < count; i++)
    misfit[i] = misfit_around(work, i);
  double usual = usual_misfit(misfit, count, misfit + count, &spread);
  double limit =
      exp(usual + MISFIT_SPREADS * spread) + MISFIT_SHARE * work->contrast * work->contrast;
  double blur_px = fmax(work->blur_px[0], work->blur_px[1]);
  size_t margin = (size_t)ceil(MARGIN_BLURS * blur_px / work->reference->step_px);
  for (size_t i = 0; i < count; i++) {
    if (!(misfit[i] > limit)) continue;
    size_t from = i > margin ? i - margin : 0;
    for (size_t k = from; k <= i + margin && k < count; k++)
      work->stations[k].facts |= FG_STATION_DISTURBED;
  }
  for (size_t i = 0; i < count; i++) {
    if (!(work->stations[i].facts & FG_STATION_DISTURBED)) continue;
    work->stations[i].weight = 0;
    ++*found;
  }
  free(misfit);
  return FG_OK;
}
