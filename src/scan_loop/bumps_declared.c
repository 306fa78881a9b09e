/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declared values of the bumps: the design's springback, or a report of `foilgauge forming`.
 *
 * A forming predicts radius and angle of each bump. The radius is compared beside one level, which
 * is reported: a material's constants are known to some ten percent. The angle is compared through
 * the arc length R alpha, as with the design's springback, so that bumps that open more than
 * predicted keep their arc length. */
#include <math.h>

#include "foilgauge/foil_kind.h"
#include "scan_loop/bumps.h"

enum { RADIUS = FG_SCAN_LOOP_BUMP_RADIUS, ANGLE = FG_SCAN_LOOP_BUMP_ANGLE };

static const fg_bump *find_predicted_bump(const fg_forming_prediction *forming, int number) {
  for (size_t i = 0; i < forming->count; i++)
    if (forming->bump[i].number == number) return &forming->bump[i];
  return NULL;
}

fg_status fg_scan_loop_bumps_check_forming(fg_context *ctx, const fg_forming_prediction *forming,
                                           const fg_measurement *measured, size_t scan_count) {
  if (!forming || !fg_foil_traits_of(measured[0].design.kind)->has_lip) return FG_OK;
  for (size_t s = 0; s < scan_count; s++)
    for (size_t f = 0; f < measured[s].foil_count; f++) {
      const fg_foil *foil = &measured[s].foils[f];
      if (foil->flags & (FG_FOIL_NOT_MEASURED | FG_FOIL_NO_LIP)) continue;
      for (size_t b = 0; b < foil->bump_count; b++)
        if (!find_predicted_bump(forming, foil->bumps[b].number))
          return fg_fail(ctx, FG_ERR_DATA,
                         "%s: it has no bump %d, which foil %d of %s has; form a strip of that "
                         "many bumps (bump_count of its design)",
                         forming->path, foil->bumps[b].number, foil->number, measured[s].scan);
    }
  return FG_OK;
}

/* Radius and arc length, means over its bumps. */
static void find_predicted_means(const fg_forming_prediction *forming, double mean[2]) {
  mean[0] = mean[1] = 0;
  for (size_t i = 0; i < forming->count; i++) {
    const fg_bump *bump = &forming->bump[i];
    mean[0] += bump->radius_mm / (double)forming->count;
    mean[1] += bump->radius_mm * bump->bump_angle_deg / (double)forming->count;
  }
}

fg_status fg_scan_loop_bumps_declare(fg_context *ctx, const fg_design *design,
                                     fg_scan_loop_bumps *bumps) {
  double mean[2] = {0, design->bumps.radius_mm * design->bumps.angle_deg};
  if (bumps->forming) find_predicted_means(bumps->forming, mean);
  for (size_t i = 0; i < bumps->count; i++) {
    fg_scan_loop_bump *bump = &bumps->bump[i];
    const fg_bump *predicted =
        bumps->forming && bumps->lip ? find_predicted_bump(bumps->forming, bump->number) : NULL;
    bump->declared_mm = predicted ? predicted->radius_mm : mean[0];
    bump->declared_arc = predicted ? predicted->radius_mm * predicted->bump_angle_deg : mean[1];
  }
  if (!bumps->forming || bumps->lip) return FG_OK;
  return fg_scan_loop_bumps_note(ctx, bumps,
                                 "bumps: without a lip their numbers have no order: what the "
                                 "forming predicts is its mean over the bumps");
}

double fg_scan_loop_bumps_offset(const fg_design *design, const fg_scan_loop_bump *bump,
                                 size_t response) {
  if (response == RADIUS) return bump->declared_mm;
  double designed = design->bumps.radius_mm * design->bumps.angle_deg;
  return (bump->declared_arc - designed) / bump->value[RADIUS];
}

/* The independent units are the foils, or of one foil its bumps. `uncertainty` is common to all of
 * them. */
void fg_scan_loop_bumps_find_level(fg_scan_loop_bumps *bumps, size_t response) {
  fg_scan_loop_bump_level *level = &bumps->level[response];
  double mean = 0, square = 0, units = 0, uncertainty = 0, n = 0;
  level->level = level->u_level = NAN;
  if (!bumps->forming || response != RADIUS) return;
  for (size_t i = 0; i < bumps->count;) {
    double sum = 0, count = 0;
    size_t part = bumps->bump[i].part;
    for (; i < bumps->count && bumps->bump[i].part == part; i++) {
      const fg_scan_loop_bump *bump = &bumps->bump[i];
      if (bump->held_out) continue;
      double apart = bump->value[response] - bump->declared_mm;
      uncertainty += bump->uncertainty[response];
      n++;
      sum += apart;
      count++;
      if (bumps->parts > 1) continue;
      mean += apart, square += apart * apart, units++;
    }
    if (bumps->parts == 1 || !(count > 0)) continue;
    mean += sum / count, square += pow(sum / count, 2), units++;
  }
  mean /= units;
  double variance = units > 1 ? fmax(0, square / units - mean * mean) / (units - 1) : 0;
  level->level = mean;
  level->u_level = hypot(sqrt(variance), uncertainty / n);
}
