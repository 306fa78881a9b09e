/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/profile.h"

#include <math.h>

#include "core/file.h"

static const double radians = 3.14159265358979323846 / 180;

/* Of a plain strip nothing states the angle: a half turn. */
static const double plain_half_turn_deg = 90;

double fg_profile_offset(const fg_design *design, fg_profile_line line) {
  static const double inner[] = {
      [FG_DATUM_MID] = -0.5, [FG_DATUM_INNER] = 0, [FG_DATUM_OUTER] = -1};
  double concave = inner[design->datum] * design->thickness_mm;
  if (line == FG_PROFILE_DATUM) return 0;
  return line == FG_PROFILE_CONCAVE ? concave : concave + design->thickness_mm;
}

static void add_arc(fg_die_profile_arcs *profile, double x, double y, double radius, double from,
                    double to) {
  profile->arc[profile->count++] = (fg_profile_arc){{x, y}, radius, from, to};
}

/* Adds the land from direction `at` on, a bump and the fillets beside it; `at` is then the end of
 * the second one. A fillet touches the lands from within and the bump from outside. */
static fg_status add_bump_arcs(fg_context *ctx, const fg_die_dimensions *die, size_t i,
                               double offset, double *at, fg_die_profile_arcs *profile) {
  const fg_die_bump_dimensions *bump = &die->bump[i];
  double overall = die->overall_radius_mm, fillet = die->fillet_radius_mm;
  double half = bump->bump_angle_deg / 2 * radians, chord = bump->radius_mm * sin(half);
  double x = bump->radius_mm * cos(half) + sqrt(overall * overall - chord * chord);
  double lands = overall + offset, radius = bump->radius_mm - offset, f = fillet + offset;
  double inner = lands - f, outer = radius + f, psi = bump->place_deg * radians;
  double turn = acos((x * x + inner * inner - outer * outer) / (2 * x * inner));
  double open = acos((x * x + outer * outer - inner * inner) / (2 * x * outer));
  if (!(f > 0) || !isfinite(turn) || !isfinite(open) || psi - turn < *at)
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump %d of the die: fillets of %g mm do not fit beside it: choose another "
                   "fillet_radius_mm of the target",
                   bump->number, fillet);
  add_arc(profile, 0, 0, lands, *at, psi - turn);
  add_arc(profile, inner * sin(psi - turn), inner * cos(psi - turn), f, psi - turn, psi + open);
  add_arc(profile, x * sin(psi), x * cos(psi), radius, psi + M_PI + open, psi + M_PI - open);
  add_arc(profile, inner * sin(psi + turn), inner * cos(psi + turn), f, psi - open, psi + turn);
  *at = psi + turn;
  return FG_OK;
}

fg_status fg_profile_make(fg_context *ctx, const fg_die_dimensions *die, double offset_mm,
                          fg_die_profile_arcs *profile) {
  double half_turn = die->bumps ? 0.5 * (double)die->bumps * die->pitch_deg : plain_half_turn_deg;
  double at = -half_turn * radians;
  profile->count = 0;
  for (size_t i = 0; i < die->bumps; i++)
    FG_TRY(add_bump_arcs(ctx, die, i, offset_mm, &at, profile));
  add_arc(profile, 0, 0, die->overall_radius_mm + offset_mm, at, half_turn * radians);
  return FG_OK;
}

/* ---- DXF, release 12: the oldest that all read ---- */

static const char *const layers[FG_PROFILE_LINES] = {"DATUM", "CONCAVE", "CONVEX"};

static void put_dxf_head(FILE *out) {
  fputs("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n"
        "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n3\n",
        out);
  for (int line = 0; line < FG_PROFILE_LINES; line++)
    fprintf(out, "0\nLAYER\n2\n%s\n70\n0\n62\n%d\n6\nCONTINUOUS\n", layers[line], line + 1);
  fputs("0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n", out);
}

/* DXF turns counterclockwise from the x axis. */
static void put_dxf_arc(FILE *out, const char *layer, const fg_profile_arc *arc) {
  double from = 90 - fmax(arc->from, arc->to) / radians;
  double to = 90 - fmin(arc->from, arc->to) / radians;
  fprintf(out, "0\nARC\n8\n%s\n10\n%.7f\n20\n%.7f\n30\n0.0\n40\n%.7f\n50\n%.8f\n51\n%.8f\n", layer,
          arc->centre.x, arc->centre.y, arc->radius, fmod(from + 720, 360), fmod(to + 720, 360));
}

fg_status fg_next_die_write_dxf(fg_context *ctx, const fg_next_die *next, FILE *out) {
  fg_die_profile_arcs profile;
  put_dxf_head(out);
  for (int line = 0; line < FG_PROFILE_LINES; line++) {
    double offset = fg_profile_offset(&next->target, (fg_profile_line)line);
    FG_TRY(fg_profile_make(ctx, &next->die, offset, &profile));
    for (size_t i = 0; i < profile.count; i++)
      put_dxf_arc(out, layers[line], &profile.arc[i]);
  }
  fputs("0\nENDSEC\n0\nEOF\n", out);
  return fg_stream_finish(ctx, out, "the DXF");
}

/* ---- the trace that a stylus should see ---- */

/* Distance of the points of a trace. */
static const double trace_step_mm = 0.002;

/* A direction of the arc, moved by turns to lie between its ends. */
static bool is_on_arc(const fg_profile_arc *arc, double direction) {
  double low = fmin(arc->from, arc->to), high = fmax(arc->from, arc->to);
  double turned = low + fmod(fmod(direction - low, 2 * M_PI) + 2 * M_PI, 2 * M_PI);
  return turned <= high + 1e-12;
}

/* Highest point of the profile above x; `up` is the sign of z along y. -INFINITY: none. */
static double height_at(const fg_die_profile_arcs *profile, double x, double up) {
  double highest = -INFINITY;
  for (size_t i = 0; i < profile->count; i++) {
    const fg_profile_arc *arc = &profile->arc[i];
    double dx = x - arc->centre.x, square = arc->radius * arc->radius - dx * dx;
    for (int sign = -1; square >= 0 && sign <= 1; sign += 2) {
      double dy = sign * sqrt(square);
      if (is_on_arc(arc, atan2(dx, dy))) highest = fmax(highest, up * (arc->centre.y + dy));
    }
  }
  return highest;
}

fg_status fg_next_die_write_trace(fg_context *ctx, const fg_next_die *next, bool convex,
                                  double tip_um, FILE *out) {
  fg_die_profile_arcs profile;
  double up = convex ? -1 : 1, tip = tip_um / 1000;
  double offset = fg_profile_offset(&next->target, convex ? FG_PROFILE_CONVEX : FG_PROFILE_CONCAVE);
  FG_TRY(fg_profile_make(ctx, &next->die, offset + up * tip, &profile));
  double reach = 0;
  for (size_t i = 0; i < profile.count; i++) {
    const fg_profile_arc *arc = &profile.arc[i];
    reach = fmax(reach, arc->centre.x + arc->radius * sin(arc->to));
  }
  fprintf(out, "Half: %s\nX [mm]; Z [mm]\nTip radius: %g um\n", convex ? "convex" : "concave",
          tip_um);
  for (double x = -reach; x <= reach; x += trace_step_mm) {
    double z = height_at(&profile, x, up);
    if (isfinite(z)) fprintf(out, "%.6f;%.6f\n", x, z - tip);
  }
  return fg_stream_finish(ctx, out, "the trace");
}
