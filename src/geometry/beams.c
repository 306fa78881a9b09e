/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beams of a flat foil from their edges: size, uncertainty, numbers, flags. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"
#include "geometry/beam_line.h"
#include "geometry/beam_numbers.h"
#include "geometry/beam_rows.h"

/* Share of omitted stations that is flagged. */
#define OUTLIER_SHARE   0.01
#define DISTURBED_SHARE 0.05
/* Min bow, in its u, and as a share of the length. */
#define BENT_DEVIATIONS 4.0
#define BENT_SHARE      0.002
/* Min ratio of a short edge's variance to that of the long ones. */
#define SPREAD_MIN 2.0
/* Limits of a torn tip: its scatter against the long edges', and as a share of the width. */
#define TORN_SPREAD 9.0
#define TORN_SHARE  0.002
/* Correlation length of a rough edge, in steps. */
#define ROUGH_STEPS 3.0

/* Beams are parallel when at least half of them (and so many) are, within this angle; a beam beyond
 * it leans. */
enum { PARALLEL_MIN = 4 };
#define PARALLEL_DEG 0.05
#define LEANING_DEG  0.25

/* Ratio of size beyond any cut's error when length and width share it, within this logarithm. */
#define SCALE_FACTOR 1.2
#define SAME_FACTOR  0.05

/* One beam in work. */
typedef struct beam_work {
  fg_beam *beam;
  fg_beam_line lines[FG_BEAM_SIDES];
  bool fitted[FG_BEAM_SIDES];
  fg_beam_noise noise;
  fg_point root, axis; /* a point of the axis and its direction, towards the tip */
  double length;
} beam_work;

static void clear_size(fg_beam *beam) {
  beam->length_mm = beam->u_length_mm = beam->width_mm = beam->u_width_mm = NAN;
  beam->taper_um_per_mm = beam->u_taper_um_per_mm = beam->bow_um = beam->u_bow_um = NAN;
  beam->rms_um = NAN;
}

static fg_point middle_between(fg_point a, fg_point b) {
  return (fg_point){0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
}

/* Coordinates along the axis, and across it to the left as seen with the tip up. */
static double along_axis(const beam_work *w, fg_point p) {
  return w->axis.x * (p.x - w->root.x) + w->axis.y * (p.y - w->root.y);
}

static double left_of_axis(const beam_work *w, fg_point p) {
  return w->axis.y * (p.x - w->root.x) - w->axis.x * (p.y - w->root.y);
}

static fg_point on_axis(const beam_work *w, double along, double left) {
  return (fg_point){w->root.x + along * w->axis.x + left * w->axis.y,
                    w->root.y + along * w->axis.y - left * w->axis.x};
}

/* Distance of a long edge's line to the left of the axis at a place along it, and the place along
 * the line itself. */
static double edge_at(const beam_work *w, fg_beam_side side, double along, double *on_line) {
  const fg_beam_line *line = &w->lines[side];
  double forward = w->axis.x * line->along.x + w->axis.y * line->along.y;
  *on_line = (along - along_axis(w, line->at)) / forward;
  fg_point p = {line->at.x + *on_line * line->along.x, line->at.y + *on_line * line->along.y};
  return left_of_axis(w, p);
}

static void find_axis(beam_work *w) {
  const fg_beam_line *l = &w->lines[FG_BEAM_LEFT], *r = &w->lines[FG_BEAM_RIGHT];
  fg_point sum = {l->along.x - r->along.x, l->along.y - r->along.y};
  double size = hypot(sum.x, sum.y);
  w->axis = (fg_point){sum.x / size, sum.y / size};
  w->root = middle_between(l->at, r->at);
  double on_line;
  double off =
      0.5 * (edge_at(w, FG_BEAM_LEFT, 0, &on_line) + edge_at(w, FG_BEAM_RIGHT, 0, &on_line));
  w->root = on_axis(w, 0, off);
}

/* A floor's place: the middle of its straight line, or the apex. */
static fg_point floor_place(const beam_work *w, fg_beam_side side) {
  const fg_beam_line *line = &w->lines[side];
  if (line->edge->round) return line->at;
  const fg_disc_point *s = line->edge->stations;
  fg_point mid = middle_between(s[0].at, s[line->edge->count - 1].at);
  double t = line->along.x * (mid.x - line->at.x) + line->along.y * (mid.y - line->at.y);
  return (fg_point){line->at.x + t * line->along.x, line->at.y + t * line->along.y};
}

/* Crossing of the root line and the axis, and the share of each floor in it. */
static double find_root(const beam_work *w, double share[2]) {
  double along[2] = {0, 0}, left[2] = {0, 0};
  for (int i = 0; i < 2; i++) {
    share[i] = w->fitted[FG_BEAM_ROOT_LEFT + i];
    if (!w->fitted[FG_BEAM_ROOT_LEFT + i]) continue;
    fg_point p = floor_place(w, (fg_beam_side)(FG_BEAM_ROOT_LEFT + i));
    along[i] = along_axis(w, p);
    left[i] = left_of_axis(w, p);
  }
  if (!w->fitted[FG_BEAM_ROOT_LEFT]) return along[1];
  if (!w->fitted[FG_BEAM_ROOT_RIGHT]) return along[0];
  share[0] = -left[1] / (left[0] - left[1]);
  share[1] = 1 - share[0];
  return share[0] * along[0] + share[1] * along[1];
}

/* Crossing of the tip's line and the axis, and its place along the line. */
static double find_tip(const beam_work *w, double *on_line) {
  const fg_beam_line *t = &w->lines[FG_BEAM_TIP];
  double rate = w->axis.y * t->along.x - w->axis.x * t->along.y;
  *on_line = -left_of_axis(w, t->at) / rate;
  fg_point p = {t->at.x + *on_line * t->along.x, t->at.y + *on_line * t->along.y};
  return along_axis(w, p);
}

static double square(double x) {
  return x * x;
}

static fg_status find_length(fg_context *ctx, beam_work *w) {
  fg_beam *beam = w->beam;
  double share[2], on_tip, variance, split = 0, uncertainty = 0, next = 0, sum;
  double root = find_root(w, share), tip = find_tip(w, &on_tip);
  const fg_beam_edge *edges = beam->edges;
  beam->length_mm = tip - root;
  FG_TRY(
      fg_beam_line_variance(ctx, &w->lines[FG_BEAM_TIP], &w->noise, FG_BEAM_PLACE, on_tip, &sum));
  for (int i = 0; i < 2; i++) {
    fg_beam_side side = (fg_beam_side)(FG_BEAM_ROOT_LEFT + i);
    if (share[i] == 0) continue;
    FG_TRY(fg_beam_line_variance(ctx, &w->lines[side], &w->noise, FG_BEAM_PLACE, 0, &variance));
    sum += square(share[i]) * variance;
    split += share[i] * edges[side].split_mm;
    uncertainty += share[i] * edges[side].u_mm_of_level;
    next += share[i] * edges[side].u_mm_of_next;
  }
  /* A move of the edges towards the void makes the beam longer at its tip and shorter at its root.
   */
  beam->u_length_mm = sqrt(sum + square(edges[FG_BEAM_TIP].split_mm - split) +
                           square(edges[FG_BEAM_TIP].u_mm_of_level - uncertainty) +
                           square(edges[FG_BEAM_TIP].u_mm_of_next - next));
  w->root = on_axis(w, root, 0);
  w->length = beam->length_mm;
  return FG_OK;
}

/* Ends the axis at the ends of the long edges, without tip or floor. */
static void end_axis_at_edges(beam_work *w) {
  const fg_beam_edge *edge = &w->beam->edges[FG_BEAM_LEFT];
  fg_point from = edge->stations[0].at, to = edge->stations[edge->count - 1].at;
  w->length = along_axis(w, to) - along_axis(w, from);
  w->root = on_axis(w, along_axis(w, from), 0);
}

static fg_status find_width(fg_context *ctx, beam_work *w) {
  fg_beam *beam = w->beam;
  double at[2], sum = 0, slopes = 0, variance, left[2], root[2], tip[2], uncertainty = 0, split = 0,
                next = 0, on;
  for (int i = 0; i < 2; i++) {
    left[i] = edge_at(w, (fg_beam_side)(FG_BEAM_LEFT + i), 0.5 * w->length, &at[i]);
    root[i] = edge_at(w, (fg_beam_side)(FG_BEAM_LEFT + i), 0, &on);
    tip[i] = edge_at(w, (fg_beam_side)(FG_BEAM_LEFT + i), w->length, &on);
    const fg_beam_line *line = &w->lines[FG_BEAM_LEFT + i];
    FG_TRY(fg_beam_line_variance(ctx, line, &w->noise, FG_BEAM_PLACE, at[i], &variance));
    sum += w->noise.long_range * variance;
    FG_TRY(fg_beam_line_variance(ctx, line, &w->noise, FG_BEAM_SLOPE, 0, &variance));
    slopes += w->noise.long_range * variance;
    uncertainty += beam->edges[FG_BEAM_LEFT + i].u_mm_of_level;
    next += beam->edges[FG_BEAM_LEFT + i].u_mm_of_next;
    split += beam->edges[FG_BEAM_LEFT + i].split_mm;
  }
  beam->width_mm = left[0] - left[1];
  beam->u_width_mm = sqrt(sum + square(uncertainty) + square(next) + square(split));
  beam->taper_um_per_mm = 1000 * (root[0] - root[1] - tip[0] + tip[1]) / w->length;
  beam->u_taper_um_per_mm = 1000 * sqrt(slopes);
  beam->root_mm = on_axis(w, 0, 0);
  beam->tip_mm = on_axis(w, w->length, 0);
  beam->corners_mm[0] = on_axis(w, 0, root[0]);
  beam->corners_mm[1] = on_axis(w, w->length, tip[0]);
  beam->corners_mm[2] = on_axis(w, w->length, tip[1]);
  beam->corners_mm[3] = on_axis(w, 0, root[1]);
  return FG_OK;
}

/* Finds the bow. Both long edges bow alike: the void is to the left of one and to the right of the
 * other. */
static fg_status find_bow(fg_context *ctx, beam_work *w) {
  double variance, sum = 0, parabola[2];
  for (int i = 0; i < 2; i++) {
    const fg_beam_line *line = &w->lines[FG_BEAM_LEFT + i];
    parabola[i] = fg_beam_line_parabola(line);
    FG_TRY(fg_beam_line_variance(ctx, line, &w->noise, FG_BEAM_PARABOLA, 0, &variance));
    sum += w->noise.long_range * variance;
  }
  w->beam->bow_um = 500 * (parabola[0] - parabola[1]);
  w->beam->u_bow_um = 500 * sqrt(sum);
  double size = fabs(w->beam->bow_um);
  if (size > BENT_DEVIATIONS * w->beam->u_bow_um && size > 1000 * BENT_SHARE * w->length)
    w->beam->flags |= FG_BEAM_BENT;
  return FG_OK;
}

static void count_points(beam_work *w) {
  double squares = 0, left_out = 0, stations = 0, unusable = 0, all = 0;
  for (int i = 0; i < FG_BEAM_SIDES; i++) {
    const fg_beam_line *line = &w->lines[i];
    if (!w->fitted[i]) continue;
    left_out += (double)(line->usable - line->used);
    unusable += (double)(line->edge->count - line->usable);
    all += (double)line->edge->count;
    if (i > FG_BEAM_RIGHT) continue;
    squares += square(line->rms_mm) * (double)line->used;
    stations += (double)line->used;
  }
  w->beam->rms_um = 1000 * sqrt(squares / stations);
  w->beam->points = (size_t)stations;
  if (left_out > OUTLIER_SHARE * all) w->beam->flags |= FG_BEAM_OUTLIERS;
  if (unusable > DISTURBED_SHARE * all) w->beam->flags |= FG_BEAM_DISTURBED_EDGE;
}

/* Finds the ratio by which a short edge scatters more than the long ones; it raises its variance.
 */
static void compare_spreads(beam_work *w) {
  for (int i = FG_BEAM_TIP; i < FG_BEAM_SIDES; i++) {
    fg_beam_line *line = &w->lines[i];
    if (!w->fitted[i]) continue;
    double dof = (double)line->used - (line->edge->round ? 3 : 2);
    if (dof < 1) continue;
    double ratio = square(line->rms_mm) * (double)line->used / dof / w->noise.covariance[0];
    line->spread = ratio > SPREAD_MIN ? ratio : 1;
  }
}

static fg_status fit_lines(fg_context *ctx, beam_work *w) {
  for (int i = 0; i < FG_BEAM_SIDES; i++) {
    const fg_beam_edge *edge = &w->beam->edges[i];
    if (!edge->count) continue;
    fg_status status = fg_beam_line_fit(ctx, edge, w->axis, &w->lines[i]);
    if (status == FG_ERR_MEMORY) return status;
    w->fitted[i] = status == FG_OK;
    if (i == FG_BEAM_RIGHT && w->fitted[FG_BEAM_LEFT] && w->fitted[i]) find_axis(w);
    if (i >= FG_BEAM_RIGHT && !(w->fitted[FG_BEAM_LEFT] && w->fitted[FG_BEAM_RIGHT])) return FG_OK;
  }
  return FG_OK;
}

static bool is_torn(const beam_work *w) {
  const fg_beam_line *tip = &w->lines[FG_BEAM_TIP];
  double width =
      edge_at(w, FG_BEAM_LEFT, 0, &(double){0}) - edge_at(w, FG_BEAM_RIGHT, 0, &(double){0});
  return !w->fitted[FG_BEAM_TIP] || (tip->spread > TORN_SPREAD && tip->rms_mm > TORN_SHARE * width);
}

static fg_status measure_lines(fg_context *ctx, beam_work *w) {
  fg_beam *beam = w->beam;
  if (!w->fitted[FG_BEAM_LEFT] || !w->fitted[FG_BEAM_RIGHT]) {
    beam->flags |= FG_BEAM_NOT_FITTED;
    return FG_OK;
  }
  FG_TRY(fg_beam_noise_find(ctx, &w->lines[FG_BEAM_LEFT], &w->lines[FG_BEAM_RIGHT], &w->noise));
  compare_spreads(w);
  bool left = w->fitted[FG_BEAM_ROOT_LEFT], right = w->fitted[FG_BEAM_ROOT_RIGHT];
  bool torn = is_torn(w);
  if (torn) beam->flags |= FG_BEAM_TORN_TIP;
  if (!left && !right) beam->flags |= FG_BEAM_NO_FLOOR;
  if (left != right) beam->flags |= FG_BEAM_ONE_FLOOR;
  if (!torn && (left || right))
    FG_TRY(find_length(ctx, w));
  else
    end_axis_at_edges(w);
  FG_TRY(find_width(ctx, w));
  FG_TRY(find_bow(ctx, w));
  count_points(w);
  beam->direction_deg = atan2(w->axis.y, w->axis.x) * 180 / M_PI;
  return FG_OK;
}

static void fill_beam_errors(const fg_design *design, fg_beam *beam) {
  beam->length_error_pct = 100 * (beam->length_mm / design->beams.length_mm - 1);
  beam->u_length_error_pct = 100 * beam->u_length_mm / design->beams.length_mm;
  beam->width_error_pct = 100 * (beam->width_mm / design->beams.width_mm - 1);
  beam->u_width_error_pct = 100 * beam->u_width_mm / design->beams.width_mm;
  const fg_beam_size size = {.length_mm = beam->length_mm,
                             .u_length_mm = beam->u_length_mm,
                             .width_mm = beam->width_mm,
                             .u_width_mm = beam->u_width_mm};
  beam->follows = fg_cantilever_of(design, &size);
}

static fg_status measure_beam(fg_context *ctx, const fg_design *design, const fg_beam_jumps *jumps,
                              fg_beam *beam, fg_beam_noise *noise) {
  beam_work w = {.beam = beam};
  beam->flags &= FG_BEAM_TOUCHES_BORDER | FG_BEAM_NARROW_CUT;
  clear_size(beam);
  fg_status status = fit_lines(ctx, &w);
  if (status == FG_OK) status = measure_lines(ctx, &w);
  fg_beam_jumps_widen(jumps, beam);
  fill_beam_errors(design, beam);
  *noise = w.noise;
  for (int i = 0; i < FG_BEAM_SIDES; i++)
    if (w.fitted[i]) fg_beam_line_free(&w.lines[i]);
  return status;
}

/* Sets the foil's scatter: the median of its beams'. */
static void fill_foil_noise(fg_foil *foil, const fg_beam_noise *noises, double *scratch) {
  size_t n = 0;
  foil->noise.sd_um = foil->noise.correlation_mm = NAN;
  for (size_t i = 0; i < foil->beam_count; i++)
    if (noises[i].lags) scratch[n++] = 1000 * sqrt(noises[i].covariance[0]);
  if (!n) return;
  foil->noise.sd_um = fg_upper_median(scratch, n);
  n = 0;
  for (size_t i = 0; i < foil->beam_count; i++)
    if (noises[i].lags) scratch[n++] = fg_beam_noise_length(&noises[i]) / noises[i].step_mm;
  double steps = fg_upper_median(scratch, n), step = 0;
  for (size_t i = 0; i < foil->beam_count; i++)
    if (noises[i].lags) step = noises[i].step_mm;
  foil->noise.correlation_mm = steps * step;
  if (steps > ROUGH_STEPS) foil->flags |= FG_FOIL_ROUGH_EDGE;
}

static double median_ratio(const fg_foil *foil, size_t offset, double design, double *scratch) {
  size_t n = 0;
  for (size_t i = 0; i < foil->beam_count; i++) {
    double value;
    memcpy(&value, (const char *)&foil->beams[i] + offset, sizeof value);
    if (isfinite(value)) scratch[n++] = value / design;
  }
  return fg_upper_median(scratch, n);
}

/* Detects beams of the design's shape in another size: the scan's resolution must be wrong. */
static void check_scale(const fg_design *design, double *scratch, fg_foil *foil) {
  double length =
      median_ratio(foil, offsetof(fg_beam, length_mm), design->beams.length_mm, scratch);
  double width = median_ratio(foil, offsetof(fg_beam, width_mm), design->beams.width_mm, scratch);
  double factor = sqrt(length * width);
  foil->flags &= ~(unsigned)FG_FOIL_NOT_THIS_DESIGN;
  foil->error[0] = '\0';
  if (!(fabs(log(factor)) > log(SCALE_FACTOR) && fabs(log(length / width)) < SAME_FACTOR)) return;
  foil->flags |= FG_FOIL_NOT_THIS_DESIGN;
  snprintf(foil->error, sizeof foil->error,
           "length and width of the beams are %.3g times the design's: the resolution of the scan "
           "(--dpi) or the design (--design) is wrong",
           factor);
}

static double direction_off(const fg_beam *beam, double direction_deg) {
  return fabs(remainder(beam->direction_deg - direction_deg, 360));
}

/* Flags the few beams that lean beside parallel ones. Foils whose beams point different ways by
 * design have none. */
static void flag_leaning(double *scratch, fg_foil *foil) {
  const fg_beam *beams = foil->beams;
  size_t count = foil->beam_count;
  if (count < PARALLEL_MIN || isnan(foil->rotation_deg)) return;
  for (size_t i = 0; i < count; i++)
    scratch[i] = remainder(beams[i].direction_deg - beams[0].direction_deg, 360);
  double direction = beams[0].direction_deg + fg_upper_median(scratch, count);
  for (size_t i = 0; i < count; i++)
    scratch[i] = direction_off(&beams[i], direction);
  if (fg_upper_median(scratch, count) > PARALLEL_DEG) return;
  for (size_t i = 0; i < count; i++)
    if (direction_off(&beams[i], direction) > LEANING_DEG) foil->beams[i].flags |= FG_BEAM_BENT;
}

static void fill_jumps(const fg_beam_jumps *jumps, fg_picture_state *picture) {
  double largest = 0;
  if (!(jumps->row_mm > 0)) return;
  for (size_t k = 0; k < jumps->count; k++)
    if (fabs(jumps->size_mm[k]) > fabs(largest)) largest = jumps->size_mm[k];
  picture->row_jumps = (double)jumps->count;
  picture->row_jump_px = largest / jumps->row_mm;
  if (jumps->count) picture->findings |= FG_PICTURE_ROW_JUMPS;
}

fg_status fg_beams_measure(fg_context *ctx, const fg_design *design, fg_foil *foil) {
  fg_beam_noise *noises = NULL;
  double *scratch = NULL;
  fg_status status = FG_OK;
  fg_beam_jumps jumps;
  foil->flags &= ~(unsigned)(FG_FOIL_BEAM_COUNT | FG_FOIL_ROUGH_EDGE);
  FG_TRY_EXIT(fg_beam_jumps_find(ctx, foil, &jumps));
  fill_jumps(&jumps, &foil->strip.picture);
  FG_TRY_EXIT(fg_memory_allocate(ctx, foil->beam_count, sizeof *noises, (void **)&noises));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foil->beam_count, sizeof *scratch, (void **)&scratch));
  for (size_t i = 0; i < foil->beam_count; i++)
    FG_TRY_EXIT(measure_beam(ctx, design, &jumps, &foil->beams[i], &noises[i]));
  fill_foil_noise(foil, noises, scratch);
  check_scale(design, scratch, foil);
  FG_TRY_EXIT(fg_beams_number(ctx, design, foil));
  flag_leaning(scratch, foil);
  if (design->beams.count && foil->beam_count != design->beams.count)
    foil->flags |= FG_FOIL_BEAM_COUNT;
exit:
  free(noises);
  free(scratch);
  return status;
}
