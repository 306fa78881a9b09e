/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plausible measurement made of formulas, without a scan: what the reports' tests print. */
#ifndef FG_TEST_SYNTHETIC_FOIL_H
#define FG_TEST_SYNTHETIC_FOIL_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/foil.h"

enum { SYNTHETIC_BUMPS = 9, SYNTHETIC_STATIONS = 6000 };

static const double synthetic_pi = 3.14159265358979323846;

static inline double synthetic_deg(double rad) {
  return rad * 180 / synthetic_pi;
}

/* The Gen II numbers, written out: the tests do not lean on the library's default. */
static inline fg_design synthetic_design(void) {
  fg_design design = {.name = "Gen II <test> & \"quoted\"",
                      .kind = FG_FOIL_CLASSICAL,
                      .datum = FG_DATUM_MID,
                      .bumps.count = SYNTHETIC_BUMPS,
                      .bumps.radius_mm = 3.32,
                      .bumps.angle_deg = 63.15,
                      .overall_radius_mm = 20.73,
                      .bumps.sleeve_radius_mm = 20.73,
                      .bumps.pitch_deg = 40.0 / 3,
                      .bumps.fillet_radius_mm = 0.35,
                      .thickness_mm = 0.1,
                      .bumps.rotor_diameter_mm = 40.0,
                      .calibration.not_needed = "the foil is synthetic"};
  return design;
}

static inline void synthetic_tolerance(fg_design *design, const char *quantity, double lower,
                                       double upper) {
  fg_tolerance *tolerance = &design->tolerances[design->tolerance_count++];
  snprintf(tolerance->quantity, sizeof tolerance->quantity, "%s", quantity);
  tolerance->lower = lower;
  tolerance->upper = upper;
}

static inline fg_nominal synthetic_nominal(const fg_design *design) {
  double half = design->bumps.angle_deg * synthetic_pi / 360, radius = design->bumps.radius_mm;
  double overall = design->overall_radius_mm;
  double x = radius * cos(half) + sqrt(overall * overall - pow(radius * sin(half), 2));
  double height = radius - (x - design->bumps.sleeve_radius_mm);
  return (fg_nominal){.centre_to_centre_mm = x,
                      .half_chord_mm = radius * sin(half),
                      .arc_length_mm = 2 * half * radius,
                      .intersection_angle_deg = synthetic_deg(acos(
                          (x * x - radius * radius - overall * overall) / (2 * radius * overall))),
                      .height_mm = height,
                      .die_height_mm = design->thickness_mm + radius - radius * cos(half),
                      .clearance_mm = design->bumps.sleeve_radius_mm - height -
                                      design->bumps.rotor_diameter_mm / 2 - design->thickness_mm};
}

static inline double synthetic_psi(const fg_design *design, int number) {
  return (design->bumps.pitch_deg * (number - 5) - 90) * synthetic_pi / 180;
}

static inline fg_bump synthetic_bump(const fg_design *design, const fg_nominal *nominal,
                                     const fg_overall *overall, int number) {
  double radius = 3.32 * (1.022 - 0.0035 * number + 0.004 * sin(2.1 * number));
  double angle = 63.15 * 3.32 / radius * synthetic_pi / 180, r0 = overall->radius_mm;
  double x = radius * cos(angle / 2) + sqrt(r0 * r0 - pow(radius * sin(angle / 2), 2));
  double psi = synthetic_psi(design, number);
  fg_bump bump = {
      .number = number,
      .radius_mm = radius,
      .u_radius_mm = 0.00021,
      .centre_mm = {overall->centre_mm.x + x * cos(psi), overall->centre_mm.y + x * sin(psi)},
      .u_centre_mm = {0.0002, 0.0002},
      .centre_to_centre_mm = x,
      .u_centre_to_centre_mm = 0.00022,
      .bump_angle_deg = synthetic_deg(angle),
      .u_bump_angle_deg = 0.004,
      .intersection_angle_deg =
          synthetic_deg(acos((x * x - radius * radius - r0 * r0) / (2 * radius * r0))),
      .u_intersection_angle_deg = 0.002,
      .height_mm = r0 - (x - radius),
      .u_height_mm = 0.00002,
      .u_clearance_mm = 0.00002,
      .u_clearance_error = 0.0003,
      .u_height_fitted_mm = 0.00003,
      .u_clearance_fitted_mm = 0.00003,
      .radius_error_pct = 100 * (radius - 3.32) / 3.32,
      .u_radius_error_pct = 0.0063,
      .bump_angle_error_pct = 100 * (synthetic_deg(angle) - 63.15) / 63.15,
      .u_bump_angle_error_pct = 0.0063,
      .u_intersection_angle_error_pct = 0.005,
      .height_model_mm = r0 - (x - radius) + 0.001,
      .u_height_model_mm = 0.0002,
      .bump_angle_model_deg = synthetic_deg(angle) + 0.05,
      .u_bump_angle_model_deg = 0.004,
      .rms_um = 0.13,
      .points = 380,
      .position_deg = synthetic_deg(psi),
      .covariance = {{4e-8, 0, 0}, {0, 4e-8, -3.9e-8}, {0, -3.9e-8, 4.4e-8}}};
  bump.clearance_mm = 20.73 - bump.height_mm - 20 - 0.1;
  bump.intersection_angle_error_pct =
      100 * (bump.intersection_angle_deg / nominal->intersection_angle_deg - 1);
  double chord = radius * sin(angle / 2), sleeve = design->bumps.sleeve_radius_mm;
  bump.height_fitted_mm =
      radius * (1 - cos(angle / 2)) + sleeve - sqrt(sleeve * sleeve - chord * chord);
  bump.clearance_fitted_mm = sleeve - bump.height_fitted_mm - 20 - 0.1;
  bump.clearance_error = (nominal->clearance_mm - bump.clearance_mm) / nominal->clearance_mm;
  return bump;
}

/* Distance of the midline from O in the direction psi, and what lies there. */
static inline double synthetic_midline(const fg_foil *foil, double psi, fg_station_label *label) {
  double r0 = foil->overall.radius_mm;
  *label = (fg_station_label){.kind = FG_ARC_LAND, .number = 1, .fitted = true};
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    double x = bump->centre_to_centre_mm, r = bump->radius_mm;
    double delta = psi - bump->position_deg * synthetic_pi / 180;
    double half = acos((x * x + r0 * r0 - r * r) / (2 * x * r0));
    double beyond_mm = (fabs(delta) - half) * r0;
    if (fabs(beyond_mm) < 0.25) {
      label->kind = FG_ARC_FILLET;
      label->fitted = false;
      label->number = 0;
    } else if (beyond_mm < 0) {
      label->kind = FG_ARC_BUMP;
      label->number = bump->number;
    } else if (delta > 0 && label->kind == FG_ARC_LAND) {
      label->number = bump->number + 1;
    }
    if (beyond_mm < 0) return x * cos(delta) - sqrt(r * r - pow(x * sin(delta), 2));
  }
  return r0;
}

static inline void synthetic_station(fg_foil *foil, size_t index, double psi, double *s_mm) {
  fg_station *station = &foil->strip.stations[index];
  fg_station_label *label = &foil->labels[index];
  double rho = synthetic_midline(foil, psi, label);
  double step = 1e-6;
  fg_station_label unused;
  double slope = (synthetic_midline(foil, psi + step, &unused) - rho) / step;
  double c = cos(psi), s = sin(psi);
  double tangent_x = slope * c - rho * s, tangent_y = slope * s + rho * c;
  double length = hypot(tangent_x, tangent_y);
  *s_mm += length * 124 * synthetic_pi / 180 / SYNTHETIC_STATIONS;
  station->s_mm = *s_mm;
  station->normal = (fg_point){-tangent_y / length, tangent_x / length};
  double residual_um = 0.4 * sin(3.1 * *s_mm) + 0.15 * sin(71.0 * *s_mm);
  double half = foil->thickness.mm / 2, mid = residual_um * 1e-3;
  double x = foil->overall.centre_mm.x + rho * c, y = foil->overall.centre_mm.y + rho * s;
  station->left =
      (fg_point){x - station->normal.x * (half + mid), y - station->normal.y * (half + mid)};
  station->right =
      (fg_point){x + station->normal.x * (half - mid), y + station->normal.y * (half - mid)};
  station->u_left_um = station->u_right_um = 0.12f;
  station->weight = 1;
  bool known = label->kind == FG_ARC_LAND || label->kind == FG_ARC_BUMP;
  label->residual_um = known ? (float)residual_um : NAN;
  label->residual_left_um = known ? (float)(residual_um + 0.1) : NAN;
  label->residual_right_um = known ? (float)(residual_um - 0.1) : NAN;
}

static inline fg_foil synthetic_foil(const fg_design *design, const fg_nominal *nominal) {
  fg_foil foil = {.number = 1,
                  .orientation = FG_CLOCKWISE,
                  .rotation_deg = -90,
                  .thickness = {.mm = 0.1003, .u_mm = 0.00004},
                  .noise = {.sd_um = 0.13, .correlation_mm = 0.011, .edge_model_um = 0.05},
                  .bump_count = SYNTHETIC_BUMPS};
  foil.overall = (fg_overall){.centre_mm = {22.0, 24.0},
                              .u_centre_mm = {0.0004, 0.0006},
                              .radius_mm = 20.95,
                              .u_radius_mm = 0.0005,
                              .springback_error_pct = 100 * (20.73 - 20.95) / 20.73,
                              .u_springback_error_pct = 0.0024,
                              .rms_um = 0.12,
                              .points = 1900,
                              .covariance = {{1.6e-7, 0, 0}, {0, 3.6e-7, 1e-7}, {0, 1e-7, 2.5e-7}}};
  foil.bumps = calloc(SYNTHETIC_BUMPS, sizeof *foil.bumps);
  for (int i = 0; i < SYNTHETIC_BUMPS; i++)
    foil.bumps[i] = synthetic_bump(design, nominal, &foil.overall, i + 1);
  foil.strip = (fg_strip){.count = SYNTHETIC_STATIONS,
                          .step_mm = 0.008,
                          .thickness_mm = 0.1003,
                          .u_thickness_mm = 0.00004,
                          .blur_left_um = 6.3,
                          .blur_right_um = 6.4,
                          .contrast = 0.7,
                          .noise = 0.008,
                          .gamma = 1,
                          .box_px = {200, 600, 7300, 2900}};
  foil.strip.stations = calloc(SYNTHETIC_STATIONS, sizeof *foil.strip.stations);
  foil.labels = calloc(SYNTHETIC_STATIONS, sizeof *foil.labels);
  double s_mm = 0;
  for (size_t i = 0; i < SYNTHETIC_STATIONS; i++) {
    double psi = (-152 + 124.0 * (double)i / SYNTHETIC_STATIONS) * synthetic_pi / 180;
    synthetic_station(&foil, i, psi, &s_mm);
    fg_station_label *label = &foil.labels[i];
    if (label->kind != FG_ARC_BUMP) continue;
    fg_bump *bump = &foil.bumps[label->number - 1];
    if (bump->arc_start_mm == 0) bump->arc_start_mm = s_mm;
    bump->arc_end_mm = s_mm;
  }
  return foil;
}

/* A measurement of one foil. Free with synthetic_free. */
static inline fg_measurement synthetic_measurement(const fg_design *design) {
  fg_measurement measurement = {.scan = "foil, \"one\" <a&b>.png",
                                .file = {.width_px = 8124,
                                         .height_px = 8040,
                                         .bit_depth = 8,
                                         .dpi_file = {4799.9904, 4799.9904}},
                                .dpi = {4800, 4800},
                                .design = *design,
                                .light_on_dark = true,
                                .foil_count = 1,
                                .specks = 3};
  memset(measurement.sha256, 'a', 64);
  measurement.nominal = synthetic_nominal(design);
  measurement.foils = calloc(1, sizeof *measurement.foils);
  measurement.foils[0] = synthetic_foil(design, &measurement.nominal);
  return measurement;
}

static inline fg_disc synthetic_disc(int number, double radius_mm) {
  size_t points = 720;
  fg_disc disc = {.number = number,
                  .hole = true,
                  .bright = true,
                  .centre_mm = {10.0 * number, 12},
                  .u_centre_mm = {0.0004, 0.0004},
                  .radius_mm = radius_mm,
                  .u_radius_mm = 0.0005,
                  .diameter_mm = 2 * radius_mm,
                  .u_diameter_mm = 0.001,
                  .roundness_um = 4.2,
                  .u_roundness_um = 0.6,
                  .rms_um = 1.1,
                  .coverage_deg = 360,
                  .blur_um = 9,
                  .points = points,
                  .covariance = {{1.6e-7, 0, 0}, {0, 1.6e-7, 0}, {0, 0, 2.5e-7}}};
  disc.edge = calloc(points, sizeof *disc.edge);
  disc.residual_um = calloc(points, sizeof *disc.residual_um);
  for (size_t i = 0; i < points; i++) {
    double angle = 2 * synthetic_pi * (double)i / (double)points;
    double residual = 1.5 * cos(3 * angle) + 0.4 * sin(40 * angle);
    disc.residual_um[i] = (float)residual;
    disc.edge[i] = (fg_point){disc.centre_mm.x + (radius_mm + residual * 1e-3) * cos(angle),
                              disc.centre_mm.y + (radius_mm + residual * 1e-3) * sin(angle)};
  }
  return disc;
}

static inline void synthetic_free(fg_measurement *measurement) {
  for (size_t i = 0; i < measurement->foil_count; i++) {
    free(measurement->foils[i].bumps);
    free(measurement->foils[i].labels);
    free(measurement->foils[i].strip.stations);
  }
  for (size_t i = 0; i < measurement->disc_count; i++) {
    free(measurement->discs[i].edge);
    free(measurement->discs[i].residual_um);
  }
  free(measurement->foils);
  free(measurement->discs);
}

#endif
