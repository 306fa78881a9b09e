/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/recognise.h"
#include "foilgauge/foil_kind.h"

#include <math.h>
#include <stdio.h>

/* Limits beyond which a part is not the design's foil, chosen so that no foil of the design exceeds
 * them, whatever its springback and damage and the scanner. */
#define OTHER_OVERALL 2.0 /* overall radius over the design's, or the inverse */
/* Chord of the bump nearest to the design's, over the design's, or the inverse. Springback of 40 %
 * in the radius and crushing move it by 5 % (the arc length stays), the radius itself by a factor
 * of three. */
#define OTHER_CHORD 2.0
/* Bumps over the design's count. Missing bumps make fewer; lands or touching objects that look like
 * bumps make a few more. */
#define OTHER_COUNT 2.0
#define FEW_BUMPS   4
/* u of the overall radius, relative: its lands lie on no circle. Foils have below 0.1 %. */
#define OTHER_U 0.1

/* Logarithm of a value over its design's; 0 when it is unknown. */
static double times_off(double value, double design) {
  return value > 0 ? fabs(log(value / design)) : 0;
}

static double chord_mm(double radius_mm, double angle_deg) {
  return 2 * radius_mm * sin(angle_deg / 2 * M_PI / 180);
}

/* Chord nearest to the design's: NaN when no bump has one. */
static double nearest_chord(double design_mm, const fg_foil *foil, size_t *fitted) {
  double nearest = NAN;
  *fitted = 0;
  for (size_t i = 0; i < foil->bump_count; i++) {
    double chord = chord_mm(foil->bumps[i].radius_mm, foil->bumps[i].bump_angle_deg);
    *fitted += isfinite(foil->bumps[i].radius_mm) != 0;
    if (!isfinite(chord)) continue;
    if (isnan(nearest) || times_off(chord, design_mm) < times_off(nearest, design_mm))
      nearest = chord;
  }
  return nearest;
}

/* Writes how a foil's bumps differ from the design's; nothing when they agree. */
static void tell_other_bumps(const fg_design *design, const fg_foil *foil, char *why, size_t size) {
  size_t fitted, stated = design->bumps.count, bumps = foil->bump_count;
  double design_mm = chord_mm(design->bumps.radius_mm, design->bumps.angle_deg);
  double bump_mm = nearest_chord(design_mm, foil, &fitted);
  if (2 * fitted < bumps)
    snprintf(why, size, "%zu of %zu bumps have no circle", bumps - fitted, bumps);
  else if (times_off(bump_mm, design_mm) > log(OTHER_CHORD))
    snprintf(why, size, "no bump is as wide as the design's (%.3g mm), the nearest has %.3g mm",
             design_mm, bump_mm);
  else if (stated && (double)bumps > OTHER_COUNT * (double)stated && bumps > stated + FEW_BUMPS)
    snprintf(why, size, "%zu bumps, where the design has %zu", bumps, stated);
}

/* The line of a foil that touches another part may end there, or go over to the other part: more
 * bumps than the design's are then no defect, nor are fewer, unless empty places explain them. */
static bool may_be_mixed(const fg_design *design, const fg_foil *foil) {
  int last = 0, stated = (int)design->bumps.count;
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number > last) last = foil->bumps[i].number;
  return foil->flags & FG_FOIL_TOUCHES_OTHER && stated && last != stated;
}

void fg_foil_recognise(const fg_design *design, fg_foil *foil) {
  const fg_overall *o = &foil->overall;
  char why[sizeof foil->error - 64] = "";
  if (times_off(o->radius_mm, design->overall_radius_mm) > log(OTHER_OVERALL))
    snprintf(why, sizeof why, "an overall radius of %.4g mm, where the design has %.4g mm",
             o->radius_mm, design->overall_radius_mm);
  else if (o->u_radius_mm > OTHER_U * o->radius_mm)
    snprintf(why, sizeof why, "an overall radius of %.4g mm that is uncertain by %.2g mm",
             o->radius_mm, o->u_radius_mm);
  else if (fg_foil_traits_of(design->kind)->has_bumps)
    tell_other_bumps(design, foil, why, sizeof why);
  bool mixed = fg_foil_traits_of(design->kind)->has_bumps && may_be_mixed(design, foil);
  if (!why[0] && !mixed) return;
  foil->flags |= FG_FOIL_NOT_THIS_DESIGN;
  if (why[0])
    snprintf(foil->error, sizeof foil->error,
             "no foil of the design (or the resolution is wrong): %s", why);
  else
    snprintf(foil->error, sizeof foil->error,
             "another part touches it, and its line has %zu bump%s where the design has %zu: lay "
             "the parts apart and scan them again",
             foil->bump_count, foil->bump_count == 1 ? "" : "s", design->bumps.count);
}
