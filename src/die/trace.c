/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One trace: stations, segments, circles, and their values on the design's datum line. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "die/form_error.h"
#include "die/levelled.h"
#include "die/plausible.h"
#include "foilgauge/die.h"
#include "geometry/bump_places.h"
#include "geometry/labels.h"

/* Length over which neighbouring points are averaged to a station: far too short to bend the line
 * (its points lie 2 nm inside a radius of 2 mm), and a bump's arc has the 300 to 400 stations that
 * a strip's has at 4800 dpi, for which the noise along it is estimated (geometry/arc_noise.c). */
#define STATION_MM 0.01
/* Whole lands are off one circle when chance would show it less often than this (as on a strip). */
#define LANDS_P 0.005
/* A bump counts as seen whole when its arc reaches over this share of the design's angle. */
#define WHOLE_SHARE 0.6

/* Returns an upper limit of the number of stations: each has at least one point, and the next one
 * lies STATION_MM further. The length is compared before conversion: a stray value may make it
 * larger than any size_t. */
static size_t count_stations_max(const fg_die_profile *p) {
  double length = 0;
  for (size_t i = 1; i < p->count; i++)
    length += hypot(p->points[i].x - p->points[i - 1].x, p->points[i].y - p->points[i - 1].y);
  double stations = length / STATION_MM + 2;
  return stations < (double)p->count ? (size_t)stations : p->count;
}

/* y points down, as in a scan: the material lies on the side of the normal. */
static fg_status make_strip(fg_context *ctx, const fg_die_profile *p, fg_strip *strip) {
  size_t i = 0;
  memset(strip, 0, sizeof *strip);
  FG_TRY(fg_memory_allocate(ctx, count_stations_max(p), sizeof *strip->stations,
                            (void **)&strip->stations));
  double s = 0;
  while (i < p->count) {
    fg_point first = p->points[i], sum = {0, 0};
    size_t n = 0;
    for (; i < p->count &&
           (n == 0 || hypot(p->points[i].x - first.x, p->points[i].y - first.y) < STATION_MM);
         i++, n++) {
      sum.x += p->points[i].x;
      sum.y += p->points[i].y;
    }
    fg_station *station = &strip->stations[strip->count++];
    station->left = station->right = (fg_point){sum.x / (double)n, -sum.y / (double)n};
    station->weight = 1;
    if (strip->count > 1)
      s += hypot(station->left.x - station[-1].left.x, station->left.y - station[-1].left.y);
    station->s_mm = s;
  }
  strip->step_mm = strip->count > 1 ? s / (double)(strip->count - 1) : STATION_MM;
  return FG_OK;
}

/* A bump's arc is no circle when its scatter exceeds the median one by this factor, and a stylus'
 * own noise. */
#define POOR_SCATTER 4.0
#define POOR_MIN_MM  0.0002
enum { BUMPS_MAX = 512 };
/* A bump's crown is away from the lands by more than this share of its height. */
#define CROWN_SHARE 0.5
enum { CROWNS_MAX = 1000 };

/* Slope over some stations to both sides, where single points scatter. */
enum { SLOPE_STATIONS = 4 };

static size_t leave_out_steep(double max_slope_deg, fg_strip *strip) {
  size_t steep = 0;
  double limit = tan(max_slope_deg * M_PI / 180);
  for (size_t i = 0; i < strip->count; i++) {
    size_t a = i > SLOPE_STATIONS ? i - SLOPE_STATIONS : 0, b = i + SLOPE_STATIONS;
    if (b >= strip->count) b = strip->count - 1;
    fg_point p = strip->stations[a].left, q = strip->stations[b].left;
    if (fabs(q.y - p.y) <= limit * (q.x - p.x)) continue;
    strip->stations[i].weight = 0;
    steep++;
  }
  return steep;
}

/* Seen whole: neither cut by an end of the trace nor by a flank that is too steep. */
static bool is_complete_arc(const fg_layout *layout, size_t i, double angle_deg) {
  if (!layout->fitted[i]) return false;
  const fg_arc *arc = &layout->bumps[i];
  const fg_strip *strip = layout->line.strip;
  const fg_turn *turns = &layout->turning.bumps[i];
  fg_range r = arc->ranges[0];
  if (turns->first == 0 || turns->last + 1 >= strip->count) return false;
  size_t a = r.first, b = r.last;
  while (a < b && !(strip->stations[a].weight > 0))
    a++;
  while (b > a && !(strip->stations[b].weight > 0))
    b--;
  double length = strip->stations[b].s_mm - strip->stations[a].s_mm;
  return length > WHOLE_SHARE * angle_deg * M_PI / 180 * arc->circle.radius;
}

/* Drops arcs that continue as a straight line on a flank, where the tip's cone or the arm touched:
 * such a bump has large residuals. */
static void drop_bent_arcs(double angle_deg, fg_layout *layout) {
  double rms[BUMPS_MAX];
  size_t n = 0;
  for (size_t i = 0; i < layout->turning.bump_count && n < BUMPS_MAX; i++)
    if (is_complete_arc(layout, i, angle_deg)) rms[n++] = layout->bumps[i].rms_mm;
  if (n < 3) return;
  double limit = POOR_SCATTER * fg_select(rms, n, n / 2);
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    if (layout->bumps[i].rms_mm > fmax(limit, POOR_MIN_MM)) layout->fitted[i] = false;
}

static fg_status find_covariances(fg_context *ctx, fg_layout *layout, double angle_deg,
                                  fg_die_trace *trace) {
  fg_noise_model noise;
  fg_arc **whole = NULL;
  size_t n = 0;
  FG_TRY(fg_memory_allocate(ctx, layout->turning.bump_count, sizeof *whole, (void **)&whole));
  double square = 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    if (is_complete_arc(layout, i, angle_deg)) {
      whole[n++] = &layout->bumps[i];
      square += layout->bumps[i].rms_mm * layout->bumps[i].rms_mm;
    }
  trace->noise_um = 1000 * sqrt(square / (double)n);
  fg_status status = fg_die_form_error_find(ctx, &layout->line, whole, n, &trace->form_error);
  free(whole);
  fg_noise_estimate(&layout->line, &layout->overall, 1, FG_NOISE_OF_LINE, &noise);
  fg_arc_covariance(&layout->line, &noise, &layout->overall);
  fg_arc_cluster_covariance(&layout->line, LANDS_P, &layout->overall);
  return status;
}

/* Returns the length that is added to a bump's traced radius, and subtracted from that of the
 * lands: the tip's radius, outside of the material, and the distance from the surface to the datum
 * line, outside too. Outward from the material the datum line lies t/2 (mid) off each half's
 * surface, at 0 or t for the strip's faces; in that direction a groove's radius shrinks, a ridge's
 * grows. */
static double datum_shift(const fg_design *design, const fg_die_profile *p) {
  double t = design->thickness_mm, above = t / 2;
  bool inner = p->half == FG_DIE_CONCAVE; /* this half touches the strip's inner face */
  if (design->datum != FG_DATUM_MID) above = (design->datum == FG_DATUM_INNER) == inner ? 0 : t;
  double outwards = above - p->tip_um / 1000;
  /* Grooves lie open towards their centre. */
  return p->half == FG_DIE_CONVEX ? outwards : -outwards;
}

static void shift_circles(fg_layout *layout, double shift_mm) {
  layout->overall.circle.radius -= shift_mm;
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    layout->bumps[i].circle.radius += shift_mm;
}

static void fill_bump(const fg_layout *layout, size_t i, const fg_design *design,
                      const fg_nominal *nominal, const fg_overall *overall, fg_bump *bump) {
  const fg_arc *arc = &layout->bumps[i];
  const fg_station *stations = layout->line.strip->stations;
  const fg_thickness strip = {.mm = design->thickness_mm};
  *bump = (fg_bump){.radius_mm = arc->circle.radius,
                    .centre_mm = {arc->circle.x, arc->circle.y},
                    .rms_um = 1000 * arc->rms_mm,
                    .points = arc->points,
                    .arc_start_mm = stations[arc->ranges[0].first].s_mm,
                    .arc_end_mm = stations[arc->ranges[0].last].s_mm};
  memcpy(bump->covariance, arc->covariance, sizeof bump->covariance);
  fg_bump_derive(design, nominal, overall, &strip, bump);
}

static double direction_deg(const fg_layout *layout, fg_point at) {
  const fg_circle *o = &layout->overall.circle;
  return atan2(at.y - o->y, at.x - o->x) * 180 / M_PI;
}

static double bump_direction_deg(const fg_layout *layout, size_t i) {
  const fg_circle *c = &layout->bumps[i].circle;
  return direction_deg(layout, (fg_point){c->x, c->y});
}

/* The station in a direction; false where the trace does not reach so far. */
static bool find_station(const fg_layout *layout, double at_deg, size_t *station) {
  const fg_strip *strip = layout->line.strip;
  double near = 180;
  size_t nearest = 0;
  for (size_t k = 0; k < strip->count; k++) {
    double off = fabs(fg_places_turn(direction_deg(layout, strip->stations[k].left), at_deg));
    if (off < near) {
      near = off;
      nearest = k;
    }
  }
  *station = nearest;
  return nearest > 0 && nearest + 1 < strip->count;
}

/* True where the trace reaches a bump's direction and leaves the lands there. */
static bool has_crown(const fg_layout *layout, double at_deg, double height_mm) {
  const fg_circle *o = &layout->overall.circle;
  size_t station;
  if (!find_station(layout, at_deg, &station)) return false;
  fg_point p = layout->line.strip->stations[station].left;
  return fabs(hypot(p.x - o->x, p.y - o->y) - o->radius) > CROWN_SHARE * height_mm;
}

/* Returns true when the trace shows both feet of a bump whose crown lies in that direction. */
static bool is_traced(const fg_layout *layout, const fg_nominal *nominal, double at_deg) {
  size_t station;
  double half_deg =
      asin(fmin(1, nominal->half_chord_mm / layout->overall.circle.radius)) * 180 / M_PI;
  return find_station(layout, at_deg - half_deg, &station) &&
         find_station(layout, at_deg + half_deg, &station);
}

/* Counts the visible crowns before (`way` -1) or after (1) a bump of the layout, in the order of x.
 * They count so that a trace that begins within a bump has the same numbers as one that begins
 * before it. */
static int crowns_beyond(const fg_design *design, const fg_nominal *nominal,
                         const fg_layout *layout, size_t i, int way) {
  double rising = layout->turning.sense < 0 ? 1 : -1; /* of the direction along x: dome, bowl */
  double pitch = rising * way * design->bumps.pitch_deg, from = bump_direction_deg(layout, i);
  int count = 0;
  while (count < CROWNS_MAX && has_crown(layout, from + (count + 1) * pitch, nominal->height_mm))
    count++;
  return count;
}

/* Places from one bump to a later one. */
static int places_between(const fg_design *design, const fg_layout *layout, size_t a, size_t b) {
  double turn = fabs(fg_places_turn(bump_direction_deg(layout, a), bump_direction_deg(layout, b)));
  return (int)lround(turn / design->bumps.pitch_deg);
}

static int bump_number_at(const fg_die_source *source, int along, int last) {
  return (source->first_bump ? source->first_bump : 1) + (source->reversed ? last - along : along);
}

/* From numbers that count along x from 0. */
static void number_bumps(const fg_die_source *source, int last, fg_die_trace *trace) {
  size_t n = trace->bump_count;
  for (size_t i = 0; i < n; i++)
    trace->bumps[i].number = bump_number_at(source, trace->bumps[i].number, last);
  for (size_t i = 0; source->reversed && i < n / 2; i++) {
    fg_bump swap = trace->bumps[i];
    trace->bumps[i] = trace->bumps[n - 1 - i];
    trace->bumps[n - 1 - i] = swap;
  }
}

/* Places of bumps along x, at the design's pitch from a bump that was measured. */
typedef struct bump_places {
  double pitch_deg; /* rises with x */
  double from_deg;  /* direction of the measured bump */
  int from, last;   /* its place; the last place of the trace */
} bump_places;

/* Lists bumps that were traced but not measured, except those cut by an end of the trace. */
static fg_status list_lost_bumps(fg_context *ctx, const fg_layout *layout,
                                 const fg_nominal *nominal, const fg_die_source *source,
                                 const bump_places *places, fg_die_trace *trace) {
  FG_TRY(fg_memory_allocate(ctx, (size_t)places->last + 1, sizeof *trace->lost,
                            (void **)&trace->lost));
  for (int place = 0; place <= places->last; place++) {
    bool measured = false;
    for (size_t b = 0; b < trace->bump_count; b++)
      measured = measured || trace->bumps[b].number == place;
    double at_deg = places->from_deg + places->pitch_deg * (place - places->from);
    if (!measured && is_traced(layout, nominal, at_deg))
      trace->lost[trace->lost_count++] = bump_number_at(source, place, places->last);
  }
  return FG_OK;
}

static fg_status fill_bumps(fg_context *ctx, const fg_design *design, const fg_layout *layout,
                            const fg_die_source *source, fg_die_trace *trace) {
  fg_nominal nominal;
  size_t count = layout->turning.bump_count, before = 0;
  int along = 0;
  FG_TRY(fg_design_derive(ctx, design, &nominal));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *trace->bumps, (void **)&trace->bumps));
  for (size_t i = 0; i < count; i++) {
    if (!is_complete_arc(layout, i, design->bumps.angle_deg)) continue;
    fg_bump *bump = &trace->bumps[trace->bump_count++];
    fill_bump(layout, i, design, &nominal, &trace->overall, bump);
    along += trace->bump_count == 1 ? crowns_beyond(design, &nominal, layout, i, -1)
                                    : places_between(design, layout, before, i);
    bump->number = along;
    before = i;
  }
  if (!trace->bump_count) return FG_OK;
  along += crowns_beyond(design, &nominal, layout, before, 1);
  trace->cut_bumps = (size_t)along + 1 - trace->bump_count;
  trace->last_number = along + (source->first_bump ? source->first_bump : 1);
  const bump_places places = {.pitch_deg =
                                  (layout->turning.sense < 0 ? 1 : -1) * design->bumps.pitch_deg,
                              .from_deg = bump_direction_deg(layout, before),
                              .from = trace->bumps[trace->bump_count - 1].number,
                              .last = along};
  FG_TRY(list_lost_bumps(ctx, layout, &nominal, source, &places, trace));
  number_bumps(source, along, trace);
  return FG_OK;
}

static void label_range(const fg_layout *layout, const fg_arc *arc, fg_range range, int bump,
                        fg_die_trace *trace) {
  for (size_t k = range.first; k <= range.last; k++) {
    if (!fg_arc_used(&layout->line, arc, k)) continue;
    trace->stations[k].bump = bump;
    trace->stations[k].residual_um = 1000 * fg_arc_residual(&layout->line, &arc->circle, k);
  }
}

/* Before the circles are shifted: residuals are of the line as traced. */
static fg_status fill_stations(fg_context *ctx, const fg_layout *layout, fg_die_trace *trace) {
  const fg_strip *strip = layout->line.strip;
  FG_TRY(fg_memory_allocate(ctx, strip->count, sizeof *trace->stations, (void **)&trace->stations));
  trace->station_count = strip->count;
  for (size_t k = 0; k < strip->count; k++)
    trace->stations[k] =
        (fg_die_station){strip->stations[k].left.x, -strip->stations[k].left.y, NAN, -1};
  for (size_t i = 0; i < layout->land_count; i++)
    label_range(layout, &layout->overall, layout->lands[i], 0, trace);
  return FG_OK;
}

/* The number of a bump of the layout is known by the place of its circle. */
static void label_bumps(const fg_layout *layout, fg_die_trace *trace) {
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    for (size_t b = 0; layout->fitted[i] && b < trace->bump_count; b++)
      if (trace->bumps[b].centre_mm.x == layout->bumps[i].circle.x)
        label_range(layout, &layout->bumps[i], layout->bump_ranges[i], trace->bumps[b].number,
                    trace);
}

/* Turns z upward for reports. */
static void turn_up(fg_die_trace *trace) {
  trace->overall.centre_mm.y = -trace->overall.centre_mm.y;
  for (size_t i = 0; i < trace->bump_count; i++)
    trace->bumps[i].centre_mm.y = -trace->bumps[i].centre_mm.y;
}

static fg_status take_layout(fg_context *ctx, const fg_design *design, const fg_die_source *source,
                             const fg_die_profile *profile, fg_layout *layout,
                             fg_die_trace *trace) {
  FG_TRY(fg_die_check_half(ctx, source->path, profile, layout));
  drop_bent_arcs(design->bumps.angle_deg, layout);
  FG_TRY(find_covariances(ctx, layout, design->bumps.angle_deg, trace));
  FG_TRY(fill_stations(ctx, layout, trace));
  trace->lands = layout->land_count;
  trace->shift_mm = datum_shift(design, profile);
  shift_circles(layout, trace->shift_mm);
  fg_layout_overall(layout, design, &trace->overall);
  FG_TRY(fill_bumps(ctx, design, layout, source, trace));
  shift_circles(layout, -trace->shift_mm);
  FG_TRY(fg_die_check_levelled(ctx, source->path, layout, trace));
  label_bumps(layout, trace);
  turn_up(trace);
  return fg_die_check_trace(ctx, design, source->path, profile, trace);
}

static fg_status measure_strip(fg_context *ctx, const fg_design *design,
                               const fg_die_source *source, const fg_die_profile *profile,
                               const fg_strip *strip, fg_die_trace *trace) {
  fg_layout layout;
  fg_design traced = *design;
  const char *error;
  traced.datum = FG_DATUM_MID; /* a strip without width: every line of it is the trace */
  FG_TRY(fg_layout_find(ctx, &traced, strip, 1, &layout, &error));
  fg_status status =
      error ? fg_fail(ctx, FG_ERR_DATA,
                      "%s: %s; a trace of a die shows three bumps or more with the lands between "
                      "them (x read in %s, z in %s)",
                      source->path, error, fg_die_unit_word(profile->unit[0]),
                      fg_die_unit_word(profile->unit[1]))
            : take_layout(ctx, design, source, profile, &layout, trace);
  fg_layout_free(&layout);
  return status;
}

fg_status fg_die_trace_measure(fg_context *ctx, const fg_design *design,
                               const fg_die_options *options, const fg_die_source *source,
                               const fg_die_profile *profile, fg_die_trace *trace) {
  fg_strip strip = {0};
  fg_status status = FG_OK;
  *trace =
      (fg_die_trace){.path = source->path,
                     .half = profile->half,
                     .unit = {profile->unit[0], profile->unit[1]},
                     .tip_um = profile->tip_um,
                     .reversed = source->reversed,
                     .points = profile->count,
                     .length_mm = profile->points[profile->count - 1].x - profile->points[0].x};
  memcpy(trace->sha256, profile->sha256, sizeof trace->sha256);
  double steepest = options->max_slope_deg > 0 ? options->max_slope_deg : FG_DIE_MAX_SLOPE_DEG;
  FG_TRY(fg_die_check_size(ctx, design, source->path, profile));
  FG_TRY(fg_die_check_tip(ctx, design, source->path, profile));
  FG_TRY_EXIT(make_strip(ctx, profile, &strip));
  size_t steep = leave_out_steep(steepest, &strip);
  trace->steep_share = (double)steep / (double)strip.count;
  trace->step_um = 1000 * strip.step_mm;
  status = measure_strip(ctx, design, source, profile, &strip, trace);
exit:
  fg_strip_free(&strip);
  return status;
}
