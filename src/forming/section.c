/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "forming/section.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

static const double gas_constant = 8.31446261815324e-3; /* kJ / (mol K) */
static const double kelvin = 273.15;
static const double plane = 1.15470053837925152902; /* 2 / sqrt 3 */

fg_status fg_section_make(fg_context *ctx, double thickness_mm, size_t layers,
                          fg_section *section) {
  *section = (fg_section){.layers = layers, .thickness_mm = thickness_mm};
  FG_TRY(fg_memory_allocate(ctx, 2 * (layers + 1), sizeof *section->elastic,
                            (void **)&section->elastic));
  section->plastic = section->elastic + layers + 1;
  return FG_OK;
}

void fg_section_free(fg_section *section) {
  free(section->elastic);
  *section = (fg_section){0};
}

double fg_section_plane_modulus(const fg_forming_material *material, double temperature_C) {
  const double *value = material->value;
  double nu = value[FG_FORMING_POISSON];
  double share = 1 - value[FG_FORMING_MODULUS_SLOPE] * (temperature_C - FG_FORMING_COLD_C);
  return 1000 * value[FG_FORMING_MODULUS] * share / (1 - nu * nu);
}

double fg_section_yield_share(const fg_forming_material *material, double temperature_C) {
  const double *t = material->curve_temperature_C, *share = material->curve_share;
  size_t n = material->curve_count;
  if (!n || temperature_C <= t[0]) return n ? share[0] : 1;
  for (size_t i = 1; i < n; i++)
    if (temperature_C <= t[i])
      return share[i - 1] +
             (share[i] - share[i - 1]) * (temperature_C - t[i - 1]) / (t[i] - t[i - 1]);
  return NAN;
}

/* Distance of a layer's middle from the midline; the last one is the face. */
static double height_of(const fg_section *section, size_t layer) {
  double half = 0.5 * section->thickness_mm;
  return layer == section->layers ? half : half * ((double)layer + 0.5) / (double)section->layers;
}

/* Stress above the yield stress flows: with p the plastic strain before and d its increment, E' (e
 * - d) = f (S Y + S² H (p + d)), S = 2 / sqrt 3. */
static void flow(const fg_forming_material *material, double temperature_C, fg_section *section) {
  double modulus = fg_section_plane_modulus(material, temperature_C);
  double share = fg_section_yield_share(material, temperature_C);
  double yield = share * plane * material->value[FG_FORMING_YIELD];
  double hardening = share * plane * plane * material->value[FG_FORMING_HARDENING];
  for (size_t i = 0; i <= section->layers; i++) {
    double beyond = modulus * section->elastic[i] - yield - hardening * section->plastic[i];
    if (!(beyond > 0)) continue;
    double flown = beyond / (modulus + hardening);
    section->plastic[i] += flown;
    section->elastic[i] -= flown;
  }
}

void fg_section_bend(const fg_forming_material *material, double curvature, fg_section *section) {
  section->curvature = fabs(curvature);
  for (size_t i = 0; i <= section->layers; i++) {
    section->elastic[i] = section->curvature * height_of(section, i);
    section->plastic[i] = 0;
  }
  flow(material, FG_FORMING_COLD_C, section);
}

/* Strain per hour at 100 MPa in plane strain. */
static double creep_rate(const fg_forming_material *material, double temperature_C) {
  const double *value = material->value;
  double inverse = 1 / (temperature_C + kelvin) - 1 / (FG_FORMING_CREEP_TEMP_C + kelvin);
  return value[FG_FORMING_CREEP_RATE] *
         exp(-value[FG_FORMING_CREEP_ENERGY] / gas_constant * inverse) *
         pow(plane, -(value[FG_FORMING_CREEP_EXPONENT] + 1));
}

/* With e the elastic strain and s = 100 MPa: de/dt = -B(T) (E'(T) e / s)^n, so
 *   e = e0 (1 + (n - 1) x)^(-1 / (n - 1)), x = e0^(n - 1) * integral of B (E' / s)^n dt,
 * and e0 exp(-x) for n = 1. The integral over a linear change of T by Gauss's two points: exact on
 * a hold, of fourth order on a ramp. */
static void creep(const fg_forming_material *material, double from_C, double rise_C, double hours,
                  fg_section *section) {
  static const double place[] = {0.21132486540518712, 0.78867513459481288};
  double n = material->value[FG_FORMING_CREEP_EXPONENT], more = n - 1, reach = 0;
  for (int i = 0; i < 2; i++) {
    double temperature = from_C + place[i] * rise_C;
    double modulus = fg_section_plane_modulus(material, temperature);
    reach +=
        0.5 * hours * creep_rate(material, temperature) * pow(modulus / FG_FORMING_CREEP_MPA, n);
  }
  for (size_t i = 0; i <= section->layers; i++) {
    double x = reach * pow(section->elastic[i], more);
    section->elastic[i] *= exp(more > 1e-9 ? -log1p(more * x) / more : -x);
  }
}

void fg_section_treat(const fg_forming_material *material, const fg_forming_schedule *schedule,
                      size_t steps, fg_section *section) {
  for (size_t k = 0; k < schedule->count; k++) {
    flow(material, schedule->temperature_C[k], section);
    if (k + 1 == schedule->count) break;
    double from = schedule->temperature_C[k], rise = schedule->temperature_C[k + 1] - from;
    double hours = schedule->time_h[k + 1] - schedule->time_h[k];
    /* A hold is exact in one step. */
    size_t parts = rise == 0 ? 1 : steps;
    for (size_t i = 0; i < parts; i++) {
      double part = rise / (double)parts, start = from + part * (double)i;
      if (rise > 0) flow(material, start + part / 2, section);
      creep(material, start, part, hours / (double)parts, section);
    }
  }
}

double fg_section_moment(const fg_forming_material *material, double temperature_C,
                         const fg_section *section) {
  double sum = 0, layer = 0.5 * section->thickness_mm / (double)section->layers;
  for (size_t i = 0; i < section->layers; i++)
    sum += section->elastic[i] * height_of(section, i);
  return 2 * fg_section_plane_modulus(material, temperature_C) * layer * sum;
}

double fg_section_stiffness(const fg_forming_material *material, const fg_section *section) {
  double sum = 0, layer = 0.5 * section->thickness_mm / (double)section->layers;
  for (size_t i = 0; i < section->layers; i++)
    sum += height_of(section, i) * height_of(section, i);
  return 2 * fg_section_plane_modulus(material, FG_FORMING_COLD_C) * layer * sum;
}

double fg_section_face_stress(const fg_forming_material *material, double temperature_C,
                              const fg_section *section) {
  return fg_section_plane_modulus(material, temperature_C) * section->elastic[section->layers];
}

bool fg_section_yields_back(const fg_forming_material *material, double change,
                            const fg_section *section) {
  double modulus = fg_section_plane_modulus(material, FG_FORMING_COLD_C);
  double yield = plane * material->value[FG_FORMING_YIELD];
  for (size_t i = 0; i <= section->layers; i++)
    if (fabs(modulus * (section->elastic[i] - change * height_of(section, i))) > yield * (1 + 1e-9))
      return true;
  return false;
}
