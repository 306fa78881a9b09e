/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "forming/strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/foil_kind.h"

#define RAD (M_PI / 180)

enum {
  SINE_PIECES = 400, /* of a pitch of a sine, of one curvature each; even: the crown lies between */
};
static const double end_land_mm = 1;    /* beyond the outer half lands, for their circle's sake */
static const double step_mm = 0.008;    /* of stations: a scan of 4800 dpi has about as many */
static const double station_u_um = 0.1; /* all alike: it is a weight */

/* One bump of the die, of the midline. */
typedef struct crest {
  int number;
  double radius_mm;
  double land_rad; /* about O, from the axis to the fillet's end */
  double arc_rad;  /* about C, from the axis to the fillet */
} crest;

/* Returns the distance of the midline from the datum line: lines along its normal are parallel.
 * Towards the shaft a bump's radius grows, those of lands and fillets shrink. */
static double inwards_mm(const fg_design *design) {
  double half = 0.5 * design->thickness_mm;
  return design->datum == FG_DATUM_MID ? 0 : design->datum == FG_DATUM_INNER ? half : -half;
}

static double overall_mm(const fg_forming *forming) {
  double radius =
      forming->options.die ? forming->die.overall_radius_mm : forming->design.overall_radius_mm;
  return radius + inwards_mm(&forming->design);
}

static void find_die_bump(const fg_forming *forming, int number, double *radius, double *angle) {
  const fg_forming_die *die = &forming->die;
  *radius = forming->options.die ? die->mean_radius_mm : forming->design.bumps.radius_mm;
  *angle = forming->options.die ? die->mean_angle_deg : forming->design.bumps.angle_deg;
  for (size_t i = 0; forming->options.die && i < die->count; i++)
    if (die->bump[i].number == number) {
      *radius = die->bump[i].radius_mm;
      *angle = die->bump[i].bump_angle_deg;
    }
}

/* X from the datum's circles holds for the midline's, which have the same centres; the fillet's
 * centre is R0 - r from O and R + r from C. */
static fg_status plan_crest(fg_context *ctx, const fg_forming *forming, double radius,
                            double angle_deg, crest *plan) {
  double in = inwards_mm(&forming->design), overall = overall_mm(forming) - in;
  double half = angle_deg * RAD / 2, chord = radius * sin(half);
  double x = radius * cos(half) + sqrt(overall * overall - chord * chord);
  double fillet = forming->design.bumps.fillet_radius_mm + in;
  plan->radius_mm = radius - in;
  double from_o = overall_mm(forming) - fillet, from_c = plan->radius_mm + fillet;
  plan->land_rad = acos((from_o * from_o + x * x - from_c * from_c) / (2 * from_o * x));
  plan->arc_rad = acos((x * x + from_c * from_c - from_o * from_o) / (2 * x * from_c));
  double room = forming->design.bumps.pitch_deg * RAD / 2;
  if (plan->radius_mm > 0 && fillet > 0 && plan->land_rad < room && plan->arc_rad > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "bump %d of the die (radius %g mm, angle %g degrees) does not fit into the pitch "
                 "of %g degrees with fillets of %g mm",
                 plan->number, radius, angle_deg, forming->design.bumps.pitch_deg,
                 forming->design.bumps.fillet_radius_mm);
}

static void add_piece(fg_forming *forming, fg_arc_kind kind, int number, double curvature,
                      double length) {
  forming->pieces[forming->count++] = (fg_forming_piece){.kind = kind,
                                                         .number = number,
                                                         .start_mm = forming->length_mm,
                                                         .length_mm = length,
                                                         .curvature_die = curvature};
  forming->length_mm += length;
}

static void add_arcs(fg_forming *forming, const crest *plan) {
  double in = inwards_mm(&forming->design), overall = overall_mm(forming);
  double fillet = forming->design.bumps.fillet_radius_mm + in;
  double land = (forming->design.bumps.pitch_deg * RAD / 2 - plan->land_rad) * overall;
  double joint = (plan->land_rad + plan->arc_rad) * fillet;
  add_piece(forming, FG_ARC_LAND, plan->number, 1 / overall, land);
  add_piece(forming, FG_ARC_FILLET, plan->number, 1 / fillet, joint);
  add_piece(forming, FG_ARC_BUMP, plan->number, -1 / plan->radius_mm,
            2 * plan->arc_rad * plan->radius_mm);
  add_piece(forming, FG_ARC_FILLET, plan->number, 1 / fillet, joint);
  add_piece(forming, FG_ARC_LAND, plan->number + 1, 1 / overall, land);
}

/* r = R0 - h (1 + cos N psi) / 2 about the bump's axis, psi from -1/2 to 1/2 of a pitch; curvature
 * (r² + 2 r'² - r r'') / (r² + r'²)^(3/2). */
static void add_sine(fg_forming *forming, int number) {
  double overall = overall_mm(forming), height = forming->nominal.height_mm;
  double pitch = forming->design.bumps.pitch_deg * RAD, waves = 2 * M_PI / pitch;
  for (int i = 0; i < SINE_PIECES; i++) {
    double psi = pitch * ((i + 0.5) / SINE_PIECES - 0.5), wave = waves * psi;
    double r = overall - 0.5 * height * (1 + cos(wave));
    double r1 = 0.5 * height * waves * sin(wave), r2 = 0.5 * height * waves * waves * cos(wave);
    double square = r * r + r1 * r1;
    double curvature = (square + r1 * r1 - r * r2) / (square * sqrt(square));
    bool bump = curvature < 0;
    add_piece(forming, bump ? FG_ARC_BUMP : FG_ARC_LAND, number + (!bump && psi > 0), curvature,
              sqrt(square) * pitch / SINE_PIECES);
  }
}

static fg_status add_bumps(fg_context *ctx, fg_forming *forming) {
  double overall = overall_mm(forming);
  add_piece(forming, FG_ARC_LAND, 1, 1 / overall, end_land_mm);
  for (size_t i = 0; i < forming->bump_count; i++) {
    fg_forming_bump *bump = &forming->bumps[i];
    crest plan = {.number = (int)i + 1};
    bump->number = plan.number;
    find_die_bump(forming, plan.number, &bump->die_radius_mm, &bump->die_angle_deg);
    if (forming->options.shape == FG_FORMING_SINE) {
      add_sine(forming, plan.number);
      continue;
    }
    FG_TRY(plan_crest(ctx, forming, bump->die_radius_mm, bump->die_angle_deg, &plan));
    add_arcs(forming, &plan);
  }
  add_piece(forming, FG_ARC_LAND, (int)forming->bump_count + 1, 1 / overall, end_land_mm);
  return FG_OK;
}

static fg_status lay_arc(fg_context *ctx, fg_forming *forming) {
  double overall = overall_mm(forming);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *forming->pieces, (void **)&forming->pieces));
  add_piece(forming, FG_ARC_LAND, 1, 1 / overall,
            overall * forming->design.arc.subtended_angle_deg * RAD);
  return FG_OK;
}

fg_status fg_forming_lay_out(fg_context *ctx, fg_forming *forming) {
  const fg_design *design = &forming->design;
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  if (kind->is_plain_strip) return lay_arc(ctx, forming);
  if (!kind->has_bumps)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "the design's foil is not bent in a die (its form), so that it cannot be formed");
  forming->bump_count = design->bumps.count ? design->bumps.count : FG_FORMING_BUMPS_DEFAULT;
  if (forming->bump_count > FG_FORMING_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "bump_count is %zu; at most %d here", forming->bump_count,
                   FG_FORMING_BUMPS_MAX);
  size_t each = forming->options.shape == FG_FORMING_SINE ? SINE_PIECES : 5;
  FG_TRY(fg_memory_allocate(ctx, forming->bump_count, sizeof *forming->bumps,
                            (void **)&forming->bumps));
  FG_TRY(fg_memory_allocate(ctx, 2 + each * forming->bump_count, sizeof *forming->pieces,
                            (void **)&forming->pieces));
  return add_bumps(ctx, forming);
}

/* ---- the curve ---- */

typedef struct pose {
  double x, y, heading;
} pose;

/* Along an arc: its chord is 2 sin(turn / 2) / curvature, half a turn ahead. */
static pose move_along_arc(pose at, double curvature, double length) {
  double turn = curvature * length, half = turn / 2;
  double chord = fabs(half) < 1e-8 ? length : length * sin(half) / half;
  return (pose){at.x + chord * cos(at.heading + half), at.y + chord * sin(at.heading + half),
                at.heading + turn};
}

static double curvature_of(const fg_forming_piece *piece, bool of_die) {
  return of_die ? piece->curvature_die : piece->curvature;
}

static void put_station(pose at, double s, double half, fg_station *station) {
  double nx = -sin(at.heading), ny = cos(at.heading);
  *station = (fg_station){.s_mm = s,
                          .left = {at.x - half * nx, at.y - half * ny},
                          .right = {at.x + half * nx, at.y + half * ny},
                          .normal = {nx, ny},
                          .u_left_um = (float)station_u_um,
                          .u_right_um = (float)station_u_um,
                          .weight = 1};
}

fg_status fg_forming_draw(fg_context *ctx, const fg_forming *forming, bool of_die,
                          fg_strip *strip) {
  size_t count = (size_t)(forming->length_mm / step_mm) + 1, piece = 0;
  double thickness = forming->design.thickness_mm;
  *strip = (fg_strip){.count = count,
                      .step_mm = forming->length_mm / (double)(count - 1),
                      .thickness_mm = thickness,
                      .u_thickness_mm = 0,
                      .contrast = 1,
                      .gamma = 1};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *strip->stations, (void **)&strip->stations));
  pose at = {0};
  for (size_t k = 0; k < count; k++) {
    double s = strip->step_mm * (double)k;
    const fg_forming_piece *here = &forming->pieces[piece];
    while (piece + 1 < forming->count && s > here->start_mm + here->length_mm) {
      at = move_along_arc(at, curvature_of(here, of_die), here->length_mm);
      here = &forming->pieces[++piece];
    }
    put_station(move_along_arc(at, curvature_of(here, of_die), s - here->start_mm), s,
                thickness / 2, &strip->stations[k]);
  }
  return FG_OK;
}

/* Pitches begin and end where the pieces of a bump do: at the middles of lands. */
fg_forming_pitch fg_forming_pitch_of(const fg_forming *forming, bool of_die) {
  size_t ends = forming->bump_count ? 1 : 0,
         pitches = forming->bump_count ? forming->bump_count : 1;
  size_t each = (forming->count - 2 * ends) / pitches;
  fg_forming_pitch mean = {0, 0};
  for (size_t p = 0; p < pitches; p++) {
    pose at = {0};
    for (size_t i = 0; i < each; i++) {
      const fg_forming_piece *piece = &forming->pieces[ends + p * each + i];
      at = move_along_arc(at, curvature_of(piece, of_die), piece->length_mm);
    }
    mean.turn_rad += at.heading / (double)pitches;
    mean.chord_mm += hypot(at.x, at.y) / (double)pitches;
  }
  return mean;
}
