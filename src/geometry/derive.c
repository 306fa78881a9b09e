/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stddef.h>

#include "foilgauge/foil.h"
#include "geometry/foil_uncertainty.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* Arguments of every quantity: distance of the centres, the two radii, the strip's thickness, the
 * design. */
enum { BY_X, BY_R, BY_R0, BY_CIRCLES, BY_T = BY_CIRCLES, BY_COUNT };

typedef struct geometry {
  double x, r, r0, thickness; /* mm */
  const fg_design *design;
  const fg_nominal *nominal;
  fg_springback model;
} geometry;

/* Returns a quantity's value and fills its gradient by (X, R, R0, t), which comes zeroed: a
 * function that combines two others gives the second one zeros of its own. */
typedef double quantity_value(const geometry *g, double gradient[BY_COUNT]);

static double centre_to_centre(const geometry *g, double gradient[BY_COUNT]) {
  gradient[BY_X] = 1;
  return g->x;
}

/* alpha = 2 acos c, c = (X² + R² - R0²) / (2 X R); NaN when the circles do not cross. */
static double bump_angle(const geometry *g, double gradient[BY_COUNT]) {
  double c = (g->x * g->x + (g->r - g->r0) * (g->r + g->r0)) / (2 * g->x * g->r);
  double per_c = -2 / sqrt((1 - c) * (1 + c)) / rad_per_deg;
  gradient[BY_X] = per_c * (1 / g->r - c / g->x);
  gradient[BY_R] = per_c * (1 / g->x - c / g->r);
  gradient[BY_R0] = -per_c * g->r0 / (g->x * g->r);
  return 2 * acos(c) / rad_per_deg;
}

/* theta = acos c, c = (X² - R² - R0²) / (2 R R0). */
static double intersection_angle(const geometry *g, double gradient[BY_COUNT]) {
  double c = (g->x * g->x - g->r * g->r - g->r0 * g->r0) / (2 * g->r * g->r0);
  double per_c = -1 / sqrt((1 - c) * (1 + c)) / rad_per_deg;
  gradient[BY_X] = per_c * g->x / (g->r * g->r0);
  gradient[BY_R] = -per_c * (1 / g->r0 + c / g->r);
  gradient[BY_R0] = -per_c * (1 / g->r + c / g->r0);
  return acos(c) / rad_per_deg;
}

static double height(const geometry *g, double gradient[BY_COUNT]) {
  gradient[BY_X] = -1;
  gradient[BY_R] = gradient[BY_R0] = 1;
  return g->r0 - (g->x - g->r);
}

static double scale_gradient(double gradient[BY_COUNT], double factor) {
  for (int i = 0; i < BY_COUNT; i++)
    gradient[i] *= factor;
  return factor;
}

static double clearance(const geometry *g, double gradient[BY_COUNT]) {
  double h = height(g, gradient);
  scale_gradient(gradient, -1);
  gradient[BY_T] = -1;
  return fg_design_clearance_over(g->design, h, g->thickness);
}

static double clearance_error(const geometry *g, double gradient[BY_COUNT]) {
  double design = g->nominal->clearance_mm, local = clearance(g, gradient);
  scale_gradient(gradient, -1 / design);
  return (design - local) / design;
}

/* h = R (1 - cos phi) + R_s - sqrt(R_s² - l0²), l0 = R sin phi: the bump's arc over its chord, and
 * the sleeve's under it. dh/dR = 1 - cos phi + sin phi l0 / sqrt(...), dh/dphi = l0 + cos phi R l0
 * / sqrt(...), and phi follows X, R and R0 as alpha / 2 does. */
static double height_fitted(const geometry *g, double gradient[BY_COUNT]) {
  double phi = bump_angle(g, gradient) * rad_per_deg / 2;
  double sleeve = g->design->bumps.sleeve_radius_mm, chord = g->r * sin(phi);
  double root = sqrt((sleeve - chord) * (sleeve + chord)), half_sine = sin(phi / 2);
  double bump_arc = 2 * half_sine * half_sine;
  for (int i = 0; i < BY_COUNT; i++)
    gradient[i] *= rad_per_deg / 2 * (chord + cos(phi) * g->r * chord / root);
  gradient[BY_R] += bump_arc + sin(phi) * chord / root;
  return g->r * bump_arc + chord * chord / (sleeve + root);
}

static double clearance_fitted(const geometry *g, double gradient[BY_COUNT]) {
  double h = height_fitted(g, gradient);
  scale_gradient(gradient, -1);
  gradient[BY_T] = -1;
  return fg_design_clearance_over(g->design, h, g->thickness);
}

static double radius_error(const geometry *g, double gradient[BY_COUNT]) {
  double design = g->design->bumps.radius_mm;
  gradient[BY_R] = 100 / design;
  return 100 * (g->r - design) / design;
}

static double bump_angle_error(const geometry *g, double gradient[BY_COUNT]) {
  double design = g->design->bumps.angle_deg, angle = bump_angle(g, gradient);
  return scale_gradient(gradient, 100 / design) * (angle - design);
}

static double intersection_angle_error(const geometry *g, double gradient[BY_COUNT]) {
  double design = g->nominal->intersection_angle_deg, angle = intersection_angle(g, gradient);
  return scale_gradient(gradient, 100 / design) * (angle - design);
}

static double height_model(const geometry *g, double gradient[BY_COUNT]) {
  gradient[BY_R] = g->model.height_slope;
  return g->model.height_mm;
}

static double bump_angle_model(const geometry *g, double gradient[BY_COUNT]) {
  gradient[BY_R] = g->model.bump_angle_slope;
  return g->model.bump_angle_deg;
}

typedef struct quantity {
  quantity_value *value;
  size_t at, uncertainty_at; /* offsets in fg_bump */
} quantity;

#define QUANTITY(function, member)                                                                 \
  { function, offsetof(fg_bump, member), offsetof(fg_bump, u_##member) }
static const quantity quantities[] = {
    QUANTITY(centre_to_centre, centre_to_centre_mm),
    QUANTITY(bump_angle, bump_angle_deg),
    QUANTITY(intersection_angle, intersection_angle_deg),
    QUANTITY(height, height_mm),
    QUANTITY(clearance, clearance_mm),
    QUANTITY(clearance_error, clearance_error),
    QUANTITY(height_fitted, height_fitted_mm),
    QUANTITY(clearance_fitted, clearance_fitted_mm),
    QUANTITY(radius_error, radius_error_pct),
    QUANTITY(bump_angle_error, bump_angle_error_pct),
    QUANTITY(intersection_angle_error, intersection_angle_error_pct),
    QUANTITY(height_model, height_model_mm),
    QUANTITY(bump_angle_model, bump_angle_model_deg),
};
#undef QUANTITY

/* Covariance of (a·u, radius) where u is the unit vector from O to C: X = C·u - O·u to first
 * order, and the two circles are independent. */
typedef struct along {
  double centre, radius, both;
} along;

static along project_covariance(double covariance[3][3], double ux, double uy) {
  return (along){
      .centre =
          ux * ux * covariance[0][0] + 2 * ux * uy * covariance[0][1] + uy * uy * covariance[1][1],
      .radius = covariance[2][2],
      .both = ux * covariance[0][2] + uy * covariance[1][2],
  };
}

/* One circle's share: (a, b)' V (a, b) with weights a on its centre and b on its radius. Terms
 * without a weight are skipped, so that an unknown covariance (NaN) does not spoil quantities that
 * do not depend on it. Written as a square plus the remainder of the smaller term: R and the crown
 * correlate at -0.999, and a sum of three terms could come out negative. */
static double circle_share(const along *v, double a, double b) {
  if (a == 0) return b == 0 ? 0 : b * b * v->radius;
  if (b == 0 || v->radius == 0) return a * a * v->centre;
  double regression = v->both / v->radius;
  double rest = v->centre - regression * v->both;
  double slope = a * regression + b;
  return a * a * (rest < 0 ? 0 : rest) + slope * slope * v->radius;
}

static double sd_of_variance(double variance) {
  return variance < 0 ? 0 : sqrt(variance);
}

/* Contribution of the thickness, whose uncertainty may be unknown, only where the quantity depends
 * on it. */
static double by_thickness(double slope, double u_mm) {
  return slope == 0 ? 0 : slope * slope * u_mm * u_mm;
}

/* Common part of both radii and the thickness: the level of the edges, where one of them is the
 * datum. It is in the variance of each already; this adds the covariances. A height, which is
 * between two places of the same edge, does not depend on it. */
static double by_edges(const double gradient[BY_COUNT], const fg_thickness *strip) {
  double sign = strip->inner ? 1 : -1, t = strip->with_edge ? 2 * gradient[BY_T] : 0;
  double r = sign * gradient[BY_R], r0 = -sign * gradient[BY_R0];
  return 2 * strip->edge_mm * strip->edge_mm * (r * r0 + r * t + r0 * t);
}

static void fill_quantities(const geometry *g, const along *bump_along, const along *overall_along,
                            const fg_thickness *strip, fg_bump *bump) {
  for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
    double gradient[BY_COUNT] = {0};
    double value = quantities[i].value(g, gradient);
    double variance = circle_share(bump_along, gradient[BY_X], gradient[BY_R]) +
                      circle_share(overall_along, -gradient[BY_X], gradient[BY_R0]) +
                      by_thickness(gradient[BY_T], strip->u_mm);
    if (strip->edge_mm > 0) variance += by_edges(gradient, strip);
    bool defined = isfinite(value);
    *(double *)((char *)bump + quantities[i].at) = defined ? value : NAN;
    *(double *)((char *)bump + quantities[i].uncertainty_at) =
        defined ? sd_of_variance(variance) : NAN;
  }
}

static geometry geometry_of(const fg_design *design, const fg_nominal *nominal,
                            const fg_overall *overall, const fg_bump *bump) {
  geometry g = {.x = hypot(bump->centre_mm.x - overall->centre_mm.x,
                           bump->centre_mm.y - overall->centre_mm.y),
                .r = bump->radius_mm,
                .r0 = overall->radius_mm,
                .thickness = design->thickness_mm,
                .design = design,
                .nominal = nominal};
  fg_design_springback(design, nominal, g.r, &g.model);
  return g;
}

void fg_bump_widen(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                   double covariance[3][3], fg_bump *bump) {
  geometry g = geometry_of(design, nominal, overall, bump);
  for (size_t i = 0; i < sizeof quantities / sizeof *quantities; i++) {
    double gradient[BY_COUNT] = {0}, variance = 0;
    double *u = (double *)((char *)bump + quantities[i].uncertainty_at);
    quantities[i].value(&g, gradient);
    for (int a = 0; a < BY_CIRCLES; a++)
      for (int b = 0; b < BY_CIRCLES; b++)
        variance += gradient[a] * covariance[a][b] * gradient[b];
    if (isfinite(variance)) *u = hypot(*u, sd_of_variance(variance));
  }
  bump->u_radius_mm = hypot(bump->u_radius_mm, sd_of_variance(covariance[BY_R][BY_R]));
}

fg_thickness fg_foil_thickness(const fg_design *design, const fg_foil *foil) {
  if (!(foil->thickness.mm > 0) || !isfinite(foil->thickness.mm))
    return (fg_thickness){.mm = design->thickness_mm};
  bool edge = design->datum != FG_DATUM_MID;
  return (fg_thickness){.mm = foil->thickness.mm,
                        .u_mm = foil->thickness.u_mm,
                        .edge_mm = edge ? fg_foil_edge_u_mm(design, foil) : 0,
                        .inner = design->datum == FG_DATUM_INNER,
                        .with_edge = !(design->thickness_measured_mm > 0)};
}

bool fg_thickness_differs(const fg_design *design, const fg_thickness *strip) {
  return fabs(strip->mm - design->thickness_mm) > 2 * strip->u_mm;
}

void fg_bump_derive(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                    const fg_thickness *strip, fg_bump *bump) {
  double dx = bump->centre_mm.x - overall->centre_mm.x;
  double dy = bump->centre_mm.y - overall->centre_mm.y;
  geometry g = geometry_of(design, nominal, overall, bump);
  g.thickness = strip->mm;
  along bump_along = project_covariance(bump->covariance, dx / g.x, dy / g.x);
  fg_overall land = *overall; /* C has no implicit const for rows of a matrix */
  along overall_along = project_covariance(land.covariance, dx / g.x, dy / g.x);
  fill_quantities(&g, &bump_along, &overall_along, strip, bump);
  bump->u_radius_mm = sd_of_variance(bump->covariance[2][2]);
  for (int i = 0; i < 2; i++)
    bump->u_centre_mm[i] = sd_of_variance(bump->covariance[i][i]);
  bump->position_deg = atan2(dy, dx) / rad_per_deg;
  bump->flags &= ~(unsigned)FG_BUMP_NO_CROSSING;
  bool fitted = isfinite(g.x) && isfinite(g.r) && isfinite(g.r0);
  if (fitted && isnan(bump->bump_angle_deg)) bump->flags |= FG_BUMP_NO_CROSSING;
}
