/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The measurand: least-squares circles through arcs and lands of the part as it is, with its
 * ovality, spiral, crown, skew and dents, and how far it deviates from them (ISO 12181: associated
 * circle, peak-to-valley roundness deviation). */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "render/spec.h"

static const double pi = 3.14159265358979323846;

/* Distance of the points on a midline. */
#define STEP_MM 0.02
/* Length beside a fillet or a cut that no measurement can use: blur mixes the two. */
#define MARGIN_MM 0.03
enum { ITERATIONS = 30 };

typedef struct points {
  fg_point *at;
  size_t count;
} points;

static void append_points(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                          const fg_segment *segment, points *p) {
  double length = segment->length_mm - 2 * MARGIN_MM;
  if (!(length > STEP_MM)) return;
  size_t count = (size_t)ceil(length / STEP_MM);
  for (size_t i = 0; i < count; i++) {
    double t = MARGIN_MM + length * ((double)i + 0.5) / (double)count;
    p->at[p->count++] = fg_segment_part_point(spec, drawn, segment, t);
  }
}

/* Solves a symmetric system of three equations by Cramer's rule; returns false for a singular one.
 */
static bool solve_three(double a[3][3], const double b[3], double x[3]) {
#define MINOR(i, k)                                                                                \
  (a[((i) + 1) % 3][((k) + 1) % 3] * a[((i) + 2) % 3][((k) + 2) % 3] -                             \
   a[((i) + 1) % 3][((k) + 2) % 3] * a[((i) + 2) % 3][((k) + 1) % 3])
  double whole = a[0][0] * MINOR(0, 0) + a[0][1] * MINOR(0, 1) + a[0][2] * MINOR(0, 2);
  if (!(fabs(whole) > 0)) return false;
  for (int k = 0; k < 3; k++)
    x[k] = (MINOR(0, k) * b[0] + MINOR(1, k) * b[1] + MINOR(2, k) * b[2]) / whole;
#undef MINOR
  return true;
}

/* Gauss-Newton on the orthogonal distances, from the ideal circle. */
static void fit_circle(const points *p, double radius_mm, fg_point *centre, double *fitted_mm) {
  *fitted_mm = radius_mm;
  for (int round = 0; round < ITERATIONS; round++) {
    double normal[3][3] = {{0}}, right[3] = {0}, step[3];
    for (size_t i = 0; i < p->count; i++) {
      double dx = p->at[i].x - centre->x, dy = p->at[i].y - centre->y, r = hypot(dx, dy);
      const double row[3] = {dx / r, dy / r, 1};
      for (int a = 0; a < 3; a++) {
        right[a] += row[a] * (r - *fitted_mm);
        for (int b = 0; b < 3; b++)
          normal[a][b] += row[a] * row[b];
      }
    }
    if (!solve_three(normal, right, step)) return;
    centre->x += step[0];
    centre->y += step[1];
    *fitted_mm += step[2];
    if (fabs(step[0]) + fabs(step[1]) + fabs(step[2]) < 1e-13 * radius_mm) return;
  }
}

static double peak_to_valley_um(const points *p, fg_point centre) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    double r = hypot(p->at[i].x - centre.x, p->at[i].y - centre.y);
    low = fmin(low, r);
    high = fmax(high, r);
  }
  return 1e3 * (high - low);
}

/* Finds the circle through the points, from the ideal one. */
static fg_render_measurand find_measurand(const fg_render_spec *spec, const points *p,
                                          fg_point centre_px, double radius_mm) {
  fg_point centre = {centre_px.x * spec->pixel_mm[0], centre_px.y * spec->pixel_mm[1]};
  fg_render_measurand circle = {.radius_mm = NAN, .form_error_um = NAN, .centre_px = {NAN, NAN}};
  if (p->count < 3) return circle;
  fit_circle(p, radius_mm, &centre, &circle.radius_mm);
  circle.form_error_um = peak_to_valley_um(p, centre);
  circle.centre_px = (fg_point){centre.x / spec->pixel_mm[0], centre.y / spec->pixel_mm[1]};
  return circle;
}

/* Lands lie about O at R0, beside the fillets. */
static bool is_land(const fg_drawn_foil *drawn, const fg_segment *segment, double radius_mm) {
  return !segment->line && !segment->bump && !segment->joins &&
         hypot(segment->x - drawn->x, segment->y - drawn->y) < 1e-9 &&
         fabs(segment->radius - radius_mm) < 1e-9;
}

/* X, h, alpha and theta follow from the two circles. */
static void derive_bump(const fg_render_spec *spec, const fg_render_measurand *overall,
                        fg_render_measurand *bump) {
  double r = bump->radius_mm, r0 = overall->radius_mm;
  double x = hypot((bump->centre_px.x - overall->centre_px.x) * spec->pixel_mm[0],
                   (bump->centre_px.y - overall->centre_px.y) * spec->pixel_mm[1]);
  bump->centre_to_centre_mm = x;
  bump->height_mm = r0 - (x - r);
  bump->bump_angle_deg = 360 / pi * acos((x * x + r * r - r0 * r0) / (2 * x * r));
  bump->intersection_angle_deg = 180 / pi * acos((x * x - r * r - r0 * r0) / (2 * r * r0));
}

static void find_bump(const fg_render_spec *spec, const fg_drawn_foil *drawn,
                      const fg_render_measurand *overall, points *p, fg_render_bump *bump) {
  p->count = 0;
  for (size_t i = 0; i < drawn->segment_count; i++) {
    const fg_segment *segment = &spec->scene.segments[drawn->first_segment + i];
    if (segment->bump == bump->index) append_points(spec, drawn, segment, p);
  }
  bump->measurand = find_measurand(spec, p, bump->centre_px, bump->radius_mm);
  derive_bump(spec, overall, &bump->measurand);
}

/* Returns true when an effect deforms the part: else the ideal circles are the measurand. */
static bool is_deformed(const fg_render_effect_list *effects) {
  return fg_render_effects_have(effects, FG_RENDER_EFFECT_PART) ||
         fg_render_effects_have(effects, FG_RENDER_EFFECT_NORMAL) ||
         fg_render_effects_have(effects, FG_RENDER_EFFECT_BUMP) ||
         fg_render_effects_have(effects, FG_RENDER_EFFECT_LIFT);
}

static void copy_ideal(fg_render_foil *truth, fg_render_bump *bumps) {
  truth->measurand = (fg_render_measurand){.radius_mm = truth->overall_radius_mm,
                                           .centre_px = truth->overall_centre_px};
  for (size_t b = 0; b < truth->bump_count; b++)
    bumps[b].measurand =
        (fg_render_measurand){.radius_mm = bumps[b].radius_mm,
                              .centre_px = bumps[b].centre_px,
                              .centre_to_centre_mm = bumps[b].centre_to_centre_mm,
                              .height_mm = bumps[b].height_mm,
                              .bump_angle_deg = bumps[b].bump_angle_deg,
                              .intersection_angle_deg = bumps[b].intersection_angle_deg};
}

fg_status fg_measurand_build(fg_context *ctx, fg_render_spec *spec, size_t foil) {
  const fg_drawn_foil *drawn = &spec->scene.drawn[foil];
  fg_render_foil *truth = &spec->scene.foils[foil];
  fg_render_bump *bumps = (fg_render_bump *)truth->bumps;
  points p = {NULL, 0};
  if (drawn->sheet) return FG_OK;
  if (!is_deformed(&spec->effects)) {
    copy_ideal(truth, bumps);
    return FG_OK;
  }
  size_t capacity = (size_t)(drawn->length_mm / STEP_MM) + drawn->segment_count + 1;
  FG_TRY(fg_memory_allocate(ctx, capacity, sizeof *p.at, (void **)&p.at));
  for (size_t i = 0; i < drawn->segment_count; i++) {
    const fg_segment *segment = &spec->scene.segments[drawn->first_segment + i];
    if (is_land(drawn, segment, truth->overall_radius_mm)) append_points(spec, drawn, segment, &p);
  }
  truth->measurand = find_measurand(spec, &p, truth->overall_centre_px, truth->overall_radius_mm);
  for (size_t b = 0; b < truth->bump_count; b++)
    find_bump(spec, drawn, &truth->measurand, &p, &bumps[b]);
  free(p.at);
  return FG_OK;
}
