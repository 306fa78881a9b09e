/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise used in all tests, as the search estimated it beside the effects found. */
#include <math.h>

#include "core/memory.h"
#include "scan_loop/result.h"
#include "scan_loop/state.h"

static const char *model_of(const fg_scatter *scatter) {
  if (!(scatter->share > 0)) return "white";
  return scatter->model == FG_SCATTER_GAUSSIAN ? "gaussian" : "exponential";
}

/* A disc's rows weigh by their own noise: that of a whole row of the cleanest edge is the unit. */
static fg_status fill_disc_noise(fg_context *ctx, const fg_edge_fit *edge_fit,
                                 fg_scan_noise *noise) {
  FG_TRY(fg_memory_allocate(ctx, edge_fit->view_count, sizeof *noise->disc_um,
                            (void **)&noise->disc_um));
  noise->discs = edge_fit->view_count;
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    double max = 0;
    for (size_t i = 0; i < edge_fit->row_count; i++)
      if (edge_fit->rows[i].view == v) max = fmax(max, edge_fit->rows[i].weight);
    noise->disc_um[v] = max > 0 ? noise->sd_um / sqrt(max / FG_EDGE_FIT_BLOCK) : NAN;
  }
  return FG_OK;
}

fg_status fg_scan_result_put_noise(fg_context *ctx, const fg_scan_loop *loop,
                                   fg_scan_result *result) {
  const fg_scatter *scatter = &loop->edge_fit.scatter;
  fg_scan_noise *noise = &result->noise;
  double sd = loop->noise_floor_um;
  *noise = (fg_scan_noise){.model = model_of(scatter),
                           .sd_um = sd,
                           .white_um = sd * sqrt(1 - scatter->share),
                           .correlated_um = sd * sqrt(scatter->share),
                           .correlation = scatter->share,
                           .range_mm = scatter->share > 0 ? scatter->range_mm : 0,
                           .long_waves = fmax(scatter->swell, 1)};
  return loop->edge_fit.discs ? fill_disc_noise(ctx, &loop->edge_fit, noise) : FG_OK;
}
