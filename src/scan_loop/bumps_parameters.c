/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters of a claim about the bumps, in a drawing's quantities. */
#include <math.h>
#include <string.h>

#include "scan_loop/bumps.h"

enum { RADIUS = FG_SCAN_LOOP_BUMP_RADIUS };

bool fg_scan_loop_bumps_claimed(const fg_scan_loop_bumps *bumps) {
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++)
    if (bumps->level[r].result.claims) return true;
  return false;
}

const fg_loop_curve *fg_scan_loop_bumps_curve(const fg_scan_loop_bumps *bumps, size_t *response) {
  for (*response = 0; *response < FG_SCAN_LOOP_BUMP_RESPONSES; (*response)++) {
    const fg_loop_result *result = &bumps->level[*response].result;
    if (result->has_curve) return &result->curve;
  }
  return NULL;
}

typedef struct parameters {
  const char *name[2];
  double value[2], u[2];
  size_t count;
} parameters;

/* The basis is 1 at the lip and -1 far from it: c - (-c) above a base of mean - c. */
static parameters decay_parameters(const fg_scan_loop_bump_level *level, size_t response,
                                   const fg_loop_claim *claim) {
  double height = 2 * claim->coefficient[0], u = 2 * claim->coefficient_u[0];
  double far = response == RADIUS ? level->base - claim->coefficient[0] : 1;
  return (parameters){{response == RADIUS ? "amplitude_rel" : "amplitude_deg", "decay_bumps"},
                      {height / far, claim->shape[0]},
                      {u / fabs(far), claim->shape_u[0]},
                      2};
}

static parameters drift_parameters(const fg_loop_coordinate *at, size_t response,
                                   const fg_loop_claim *claim) {
  double scale = fg_scan_loop_bump_responses[response].scale * 2 / (at->high - at->low);
  return (parameters){{response == RADIUS ? "slope_um_per_bump" : "slope_deg_per_bump"},
                      {scale * claim->coefficient[0]},
                      {scale * claim->coefficient_u[0]},
                      1};
}

/* The basis is the angle's change by one unit of stretch over its largest size. */
static parameters stretch_parameters(const fg_loop_coordinate *at, const fg_loop_claim *claim) {
  double scale = fmax(fabs(at->low), fabs(at->high));
  bool constant = !strcmp(at->name, "constant");
  return (parameters){{constant ? "arc_length_rel" : "arc_length_rel_per_radius_rel"},
                      {claim->coefficient[0] / scale},
                      {claim->coefficient_u[0] / scale},
                      1};
}

bool fg_scan_loop_bumps_parameter(const fg_scan_loop_bumps *bumps, size_t response,
                                  const fg_loop_claim *claim, size_t i, const char **name,
                                  double *value, double *u) {
  const fg_scan_loop_bump_level *level = &bumps->level[response];
  const fg_loop_coordinate *at = &level->problem.problem.coordinate[claim->candidate.a];
  parameters p;
  switch (claim->candidate.effect->over_bumps) {
  case FG_LOOP_BUMP_DECAY:
    p = decay_parameters(level, response, claim);
    break;
  case FG_LOOP_BUMP_STRETCH:
    p = stretch_parameters(at, claim);
    break;
  default:
    p = drift_parameters(at, response, claim);
  }
  if (i >= p.count) return false;
  *name = p.name[i];
  *value = p.value[i];
  *u = p.u[i];
  return true;
}
