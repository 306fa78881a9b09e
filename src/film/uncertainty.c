/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of a measured bearing's results by that of its clearances (GUM supplement 1). */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "film/bearing.h"
#include "foilgauge/density.h"
#include "foilgauge/memory.h"

/* A standard uncertainty is known to 7 % by these. */
enum { U_DRAWS = 100 };

/* Standard deviation of one number of the results that are solved. */
static double find_sd(const fg_film_draws *draws, size_t offset) {
  double n = 0, mean = 0, square = 0;
  for (size_t i = 0; i < draws->count; i++) {
    const fg_film_result *result = &draws->result[i];
    double value = *(const double *)(const void *)((const char *)result + offset);
    if (result->outcome == FG_FILM_UNSOLVED || !isfinite(value)) continue;
    double off = value - mean;
    n++;
    mean += off / n;
    square += off * (value - mean);
  }
  return n > 1 ? sqrt(square / (n - 1)) : NAN;
}

/* Interval of 95 % of the critical mass; not known where bearings of it are stable at every mass.
 */
static fg_status find_mass_interval(fg_context *ctx, const fg_film_draws *draws,
                                    fg_film_uncertainty *u) {
  double *mass;
  size_t known = 0;
  void *block;
  u->mass_low_kg = u->mass_high_kg = NAN;
  FG_TRY(fg_memory_allocate(ctx, draws->count, sizeof *mass, &block));
  mass = block;
  for (size_t i = 0; i < draws->count; i++)
    if (isfinite(draws->result[i].critical_mass_kg))
      mass[known++] = draws->result[i].critical_mass_kg;
  fg_sort(mass, known);
  if (known == draws->count) {
    u->mass_low_kg = fg_sample_quantile(mass, known, 0.025);
    u->mass_high_kg = fg_sample_quantile(mass, known, 0.975);
  }
  free(mass);
  return FG_OK;
}

static bool has_u(const fg_film_report *r) {
  for (size_t i = 0; i < r->bearing.count; i++)
    if (r->u_own_mm[i] > 0 || r->u_shared_mm[i] > 0) return true;
  return false;
}

fg_status fg_film_find_uncertainty(fg_context *ctx, fg_film_report *r,
                                   const fg_film_workspace *workspace) {
  fg_film_uncertainty *u = &r->uncertainty;
  fg_film_draws draws;
  if (!has_u(r)) return FG_OK;
  fg_status status = fg_film_draw_measured(ctx, r, workspace, U_DRAWS, &draws);
  if (status == FG_OK) status = find_mass_interval(ctx, &draws, u);
  u->draws = draws.count;
  u->solved = draws.solved;
  u->eccentricity = find_sd(&draws, offsetof(fg_film_result, eccentricity));
  u->min_film_um = find_sd(&draws, offsetof(fg_film_result, min_film_um));
  u->max_pressure_kpa = find_sd(&draws, offsetof(fg_film_result, max_pressure_kpa));
  u->power_w = find_sd(&draws, offsetof(fg_film_result, power_w));
  u->critical_mass_kg = find_sd(&draws, offsetof(fg_film_result, critical_mass_kg));
  u->whirl_ratio = find_sd(&draws, offsetof(fg_film_result, whirl_ratio));
  free(draws.result);
  return status;
}
