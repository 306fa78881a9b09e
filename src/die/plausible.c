/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "die/plausible.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"

/* A die's radii are within this factor of the design's, however badly it was made. */
#define RADIUS_FACTOR 1.25
/* A trace is not longer than the overall circle is wide; a die may have a rim. */
#define LENGTH_DIAMETERS 1.3
/* A trace must show at least three bumps, with the lands between them. */
enum { BUMPS_MIN = 3, POINTS_PER_BUMP = 60 };

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* Between the crowns of the first and last of `bumps`. */
static double span_mm(const fg_design *design, double bumps) {
  double half = 0.5 * (bumps - 1) * design->bumps.pitch_deg * rad_per_deg;
  return 2 * (design->overall_radius_mm - design->bumps.radius_mm * 0.2) *
         sin(half < M_PI / 2 ? half : M_PI / 2);
}

/* Returns true when a length is plausible for a trace of this design. */
static bool length_fits(const fg_design *design, double mm) {
  return mm > 0.7 * span_mm(design, 2) && mm < 2 * LENGTH_DIAMETERS * design->overall_radius_mm;
}

static fg_status fail_length(fg_context *ctx, const fg_design *design, const char *path,
                             const fg_die_profile *p, double mm) {
  static const double per_mm[] = {0, 1, 1e-3, 1e-6};
  for (int unit = FG_DIE_MM; unit <= FG_DIE_NM; unit++)
    if (length_fits(design, mm / per_mm[p->unit[0]] * per_mm[unit]))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: in %s the trace is %.4g mm long, which no trace of this design (%s, R0 "
                     "%.4g mm) is; in %s it would be: --unit, or the header, is wrong",
                     path, fg_die_unit_word(p->unit[0]), mm, design->name,
                     design->overall_radius_mm, fg_die_unit_word((fg_die_unit)unit));
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the trace is %.4g mm long; a trace of this design (%s, R0 %.4g mm) has %d "
                 "bumps or more, %.3g mm: check --design, and trace further",
                 path, mm, design->name, design->overall_radius_mm, BUMPS_MIN,
                 span_mm(design, BUMPS_MIN) + design->bumps.radius_mm);
}

/* Refuses impossible heights: they differ by less than the diameter of the die's overall circle. A
 * larger difference marks a lost contact, or another unit. */
static fg_status check_heights(fg_context *ctx, const fg_design *design, const char *path,
                               const fg_die_profile *p) {
  double limit = 2 * LENGTH_DIAMETERS * design->overall_radius_mm, z;
  double *heights = NULL;
  FG_TRY(fg_memory_allocate(ctx, p->count, sizeof *heights, (void **)&heights));
  for (size_t i = 0; i < p->count; i++)
    heights[i] = p->points[i].y;
  double middle = fg_select(heights, p->count, p->count / 2);
  free(heights);
  for (size_t i = 0; i < p->count; i++)
    if (z = p->points[i].y, !(fabs(z - middle) <= limit))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: point %zu (x %.6g mm): z is %.6g mm, where the trace's median is %.6g "
                     "mm: no die of this design (%s, R0 %.4g mm) is so high; take out points that "
                     "the instrument has lost, or correct --unit",
                     path, i + 1, p->points[i].x, z, middle, design->name,
                     design->overall_radius_mm);
  return FG_OK;
}

fg_status fg_die_check_size(fg_context *ctx, const fg_design *design, const char *path,
                            const fg_die_profile *p) {
  double mm = p->points[p->count - 1].x - p->points[0].x;
  if (!length_fits(design, mm)) return fail_length(ctx, design, path, p, mm);
  double per_bump = (double)p->count * design->bumps.radius_mm / mm;
  if (per_bump >= POINTS_PER_BUMP) return check_heights(ctx, design, path, p);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: %zu points over %.4g mm are too few; a bump needs %d, so trace with a point "
                 "every %.2g mm or closer",
                 path, p->count, mm, POINTS_PER_BUMP, design->bumps.radius_mm / POINTS_PER_BUMP);
}

fg_status fg_die_check_tip(fg_context *ctx, const fg_design *design, const char *path,
                           const fg_die_profile *p) {
  double tip = p->tip_um / 1000, surface = design->bumps.radius_mm + design->thickness_mm / 2;
  if (!(tip >= surface / RADIUS_FACTOR)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: a tip of %g mm does not fit a bump of %g mm; --tip-um (or the header) is the "
                 "tip's radius in um",
                 path, tip, design->bumps.radius_mm);
}

/* The overall circle's centre lies below a dome of lands, above a bowl. */
fg_status fg_die_check_half(fg_context *ctx, const char *path, const fg_die_profile *p,
                            const fg_layout *layout) {
  const fg_circle *circle = &layout->overall.circle;
  bool ridges = layout->turning.sense > 0;
  bool bowl = circle->y < layout->line.points[layout->line.strip->count / 2].y;
  fg_die_half seen = ridges ? FG_DIE_CONVEX : FG_DIE_CONCAVE;
  if (ridges != bowl)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: %s on a %s; of this die's halves one has grooves on a dome, the other "
                   "ridges in a bowl. Does z run upwards?",
                   path, ridges ? "ridges" : "grooves", bowl ? "bowl" : "dome");
  if (seen == p->half) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: said to be the %s half, but the trace shows %s: the %s half. Either the half "
                 "is the other one (halves are named by their bumps), or z runs downwards in the "
                 "file: turn its sign",
                 path, fg_die_half_word(p->half), ridges ? "ridges in a bowl" : "grooves on a dome",
                 fg_die_half_word(seen));
}

static fg_status fail_radius(fg_context *ctx, const char *path, const fg_die_profile *p,
                             const char *what, double seen, double wanted) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: %s has a radius of %.5g mm, %.3g times the design's %.5g mm (x read in %s, z "
                 "in %s, tip %g um): the unit of an axis, the tip or --design is wrong",
                 path, what, seen, seen / wanted, wanted, fg_die_unit_word(p->unit[0]),
                 fg_die_unit_word(p->unit[1]), p->tip_um);
}

static bool is_far(double seen, double wanted) {
  return !(seen < RADIUS_FACTOR * wanted && seen > wanted / RADIUS_FACTOR);
}

fg_status fg_die_check_trace(fg_context *ctx, const fg_design *design, const char *path,
                             const fg_die_profile *p, const fg_die_trace *trace) {
  if (is_far(trace->overall.radius_mm, design->overall_radius_mm))
    return fail_radius(ctx, path, p, "the overall circle", trace->overall.radius_mm,
                       design->overall_radius_mm);
  if (trace->bump_count < BUMPS_MIN)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: %zu bump%s seen whole%s; the overall circle needs %d and the lands between "
                   "them: trace further, or with the die tilted",
                   path, trace->bump_count, trace->bump_count == 1 ? " is" : "s are",
                   trace->cut_bumps ? " (others are cut off or too steep)" : "", BUMPS_MIN);
  if (design->bumps.count && trace->last_number > (int)design->bumps.count)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the bumps that are seen would have numbers up to %d, and the design has "
                   "%zu: --first-bump (the lowest whose crown is seen) or --design is wrong",
                   path, trace->last_number, design->bumps.count);
  for (size_t i = 0; i < trace->bump_count; i++)
    if (is_far(trace->bumps[i].radius_mm, design->bumps.radius_mm))
      return fail_radius(ctx, path, p, "a bump", trace->bumps[i].radius_mm,
                         design->bumps.radius_mm);
  return FG_OK;
}
