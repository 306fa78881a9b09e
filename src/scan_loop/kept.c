/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reported values of a foil whose correction has a benefit for some dimensions only, or for none.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan_loop/benefit.h"

static fg_status copy_array(fg_context *ctx, const void *from, size_t count, size_t size,
                            void **to) {
  *to = NULL;
  if (!from) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, size, to));
  memcpy(*to, from, count * size);
  return FG_OK;
}

static fg_status copy_foil(fg_context *ctx, const fg_foil *from, fg_foil *to) {
  fg_foil copy = *from;
  const fg_strip *strip = &from->strip;
  void *bumps = NULL, *labels = NULL, *stations = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(copy_array(ctx, from->bumps, from->bump_count, sizeof *from->bumps, &bumps));
  FG_TRY_EXIT(copy_array(ctx, from->labels, strip->count, sizeof *from->labels, &labels));
  FG_TRY_EXIT(copy_array(ctx, strip->stations, strip->count, sizeof *strip->stations, &stations));
  copy.bumps = bumps;
  copy.labels = labels;
  copy.strip.stations = stations;
  *to = copy;
exit:
  if (status != FG_OK) {
    free(bumps);
    free(labels);
    free(stations);
  }
  return status;
}

/* Centre and directions go with R0. */
static double turn_deg(const fg_benefit *benefit, size_t item,
                       const fg_benefit_decision *decision) {
  double sum = 0;
  for (size_t e = 0; e < benefit->explanations; e++)
    sum += decision->part[FG_CORRECTED_OVERALL_RADIUS][e] * benefit->item[item].turn_deg[e];
  return sum;
}

static fg_point centre_move(const fg_benefit *benefit, const fg_benefit_decision *decision) {
  fg_point sum = {0, 0};
  for (size_t e = 0; e < benefit->explanations; e++) {
    sum.x += decision->part[FG_CORRECTED_OVERALL_RADIUS][e] * benefit->centre[e].x;
    sum.y += decision->part[FG_CORRECTED_OVERALL_RADIUS][e] * benefit->centre[e].y;
  }
  return sum;
}

static void put_overall(const fg_benefit_foil *of, fg_overall *overall) {
  const fg_overall *from = &of->before->overall;
  double designed = of->m->design.overall_radius_mm, move[FG_CORRECTED];
  fg_benefit_move(of->benefit, of->benefit->items - 1, of->decision, move);
  fg_point centre = centre_move(of->benefit, of->decision);
  overall->radius_mm = from->radius_mm + move[FG_CORRECTED_OVERALL_RADIUS];
  overall->centre_mm = (fg_point){from->centre_mm.x + centre.x, from->centre_mm.y + centre.y};
  overall->u_radius_mm = sqrt(overall->covariance[2][2]);
  overall->springback_error_pct = 100 * (designed - overall->radius_mm) / designed;
  overall->u_springback_error_pct = 100 * overall->u_radius_mm / designed;
}

/* Sets R and h as decided, X = R0 + R - h, in the direction that belongs to R0. A bump whose move
 * is unknown stays as corrected. */
static void set_bump(const fg_benefit_foil *of, size_t item, const fg_overall *overall,
                     fg_bump *bump) {
  const fg_bump *from = &of->before->bumps[item];
  double move[FG_CORRECTED];
  fg_benefit_move(of->benefit, item, of->decision, move);
  double radius = from->radius_mm + move[FG_CORRECTED_RADIUS];
  double height = from->height_mm + move[FG_CORRECTED_HEIGHT];
  double distance = overall->radius_mm + radius - height;
  double direction = (from->position_deg + turn_deg(of->benefit, item, of->decision)) * M_PI / 180;
  if (!isfinite(distance) || !isfinite(direction)) return;
  bump->radius_mm = radius;
  bump->centre_mm = (fg_point){overall->centre_mm.x + distance * cos(direction),
                               overall->centre_mm.y + distance * sin(direction)};
}

/* (R0, R, h) to (X, R, R0), X = R0 + R - h. */
static void turn_moment(double from[FG_CORRECTED][FG_CORRECTED], double to[3][3]) {
  static const double turn[3][FG_CORRECTED] = {{1, 1, -1}, {0, 1, 0}, {1, 0, 0}};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) {
      to[i][k] = 0;
      for (int a = 0; a < FG_CORRECTED; a++)
        for (int b = 0; b < FG_CORRECTED; b++)
          to[i][k] += turn[i][a] * from[a][b] * turn[k][b];
    }
}

void fg_benefit_widen_foil(const fg_benefit_foil *of, fg_foil *after) {
  double moment[FG_CORRECTED][FG_CORRECTED], covariance[3][3];
  if (!of->benefit->explanations || fg_benefit_is_whole(of->benefit, of->decision)) return;
  double share = after->overall.u_springback_error_pct / after->overall.u_radius_mm;
  for (size_t b = 0; b < after->bump_count; b++) {
    fg_benefit_moment(of->benefit, b, of->decision, moment);
    turn_moment(moment, covariance);
    fg_bump_widen(&of->m->design, &of->m->nominal, &after->overall, covariance, &after->bumps[b]);
  }
  fg_benefit_moment(of->benefit, after->bump_count, of->decision, moment);
  double added = moment[FG_CORRECTED_OVERALL_RADIUS][FG_CORRECTED_OVERALL_RADIUS];
  after->overall.u_radius_mm = hypot(after->overall.u_radius_mm, sqrt(added));
  after->overall.u_springback_error_pct = share * after->overall.u_radius_mm;
}

static void put_dimensions(const fg_benefit_foil *of, fg_foil *foil) {
  const fg_thickness strip = fg_foil_thickness(&of->m->design, foil);
  put_overall(of, &foil->overall);
  for (size_t b = 0; b < foil->bump_count; b++) {
    set_bump(of, b, &foil->overall, &foil->bumps[b]);
    fg_bump_derive(&of->m->design, &of->m->nominal, &foil->overall, &strip, &foil->bumps[b]);
  }
}

bool fg_benefit_is_moved(const fg_correction_choice choice[FG_CORRECTED]) {
  for (int k = 0; k < FG_CORRECTED; k++)
    if (choice[k].moved) return true;
  return false;
}

static void flag_left(fg_foil *foil) {
  static const unsigned flags[FG_CORRECTED] = {
      [FG_CORRECTED_OVERALL_RADIUS] = FG_FOIL_OVERALL_RADIUS_LEFT,
      [FG_CORRECTED_RADIUS] = FG_FOIL_RADIUS_LEFT,
      [FG_CORRECTED_HEIGHT] = FG_FOIL_HEIGHT_LEFT,
  };
  for (int k = 0; k < FG_CORRECTED; k++)
    if (foil->choice[k].reason > FG_CORRECTION_SMALL && !foil->choice[k].moved)
      foil->flags |= flags[k];
}

fg_status fg_benefit_keep_foil(fg_context *ctx, const fg_benefit_foil *of, fg_foil *after) {
  if (!fg_benefit_is_whole(of->benefit, of->decision)) {
    if (fg_benefit_is_moved(of->decision->choice)) {
      put_dimensions(of, after);
    } else {
      fg_foil copy;
      FG_TRY(copy_foil(ctx, of->before, &copy));
      fg_foil_free(after);
      *after = copy;
    }
  }
  memcpy(after->choice, of->decision->choice, sizeof after->choice);
  flag_left(after);
  return FG_OK;
}

/* Roundness and residuals stay those of the corrected edge, on which the effects were found. */
static void keep_circle(const fg_disc *from, fg_disc *disc) {
  memcpy(disc->covariance, from->covariance, sizeof disc->covariance);
  disc->centre_mm = from->centre_mm;
  memcpy(disc->u_centre_mm, from->u_centre_mm, sizeof disc->u_centre_mm);
}

void fg_benefit_keep_discs(const fg_measurement *before, const fg_benefit *benefit,
                           const fg_benefit_decision *decision, fg_measurement *after) {
  for (size_t d = 0; d < after->disc_count && d < benefit->items; d++) {
    fg_disc *disc = &after->discs[d];
    const fg_disc *from = &before->discs[d];
    double move[FG_CORRECTED];
    disc->choice = decision->choice[FG_CORRECTED_RADIUS];
    if (fg_benefit_is_whole(benefit, decision)) continue;
    if (!disc->choice.moved) keep_circle(from, disc);
    fg_benefit_move(benefit, d, decision, move);
    disc->radius_mm = from->radius_mm + move[FG_CORRECTED_RADIUS];
    disc->u_radius_mm = disc->choice.moved ? sqrt(disc->covariance[2][2]) : from->u_radius_mm;
    disc->diameter_mm = 2 * disc->radius_mm;
    disc->u_diameter_mm = 2 * disc->u_radius_mm;
  }
}

void fg_benefit_widen_discs(const fg_benefit *benefit, const fg_benefit_decision *decision,
                            fg_measurement *after) {
  const int k = FG_CORRECTED_RADIUS;
  double moment[FG_CORRECTED][FG_CORRECTED];
  if (fg_benefit_is_whole(benefit, decision)) return;
  for (size_t d = 0; d < after->disc_count && d < benefit->items; d++) {
    fg_benefit_moment(benefit, d, decision, moment);
    after->discs[d].u_radius_mm = hypot(after->discs[d].u_radius_mm, sqrt(moment[k][k]));
    after->discs[d].u_diameter_mm = 2 * after->discs[d].u_radius_mm;
  }
}
