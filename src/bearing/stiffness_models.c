/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of a bump's stiffness, one row each; derived in foilgauge/stiffness.h. */
#include "foilgauge/stiffness.h"

#include <math.h>
#include <stdio.h>

#include "bearing/arch.h"
#include "foilgauge/foil_kind.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* Minimum change of the stiffness by a neglected influence that is reported. */
static const double matters_share = 0.05;

/* Ratio of length to thickness below which shear matters: shear makes a beam of length L, loaded in
 * its middle, softer by 2.4 (1 + nu) (t / L)², which is 3 % at a ratio of ten. */
static const double slender_ratio = 10;

fg_arch_material fg_arch_material_default(void) {
  return (fg_arch_material){.youngs_modulus_gpa = 200, .poisson_ratio = 0.3, .friction = 0.1};
}

fg_arch fg_design_arch(const fg_design *design, double thickness_mm, double radius_mm,
                       double angle_deg) {
  double shift = design->datum == FG_DATUM_INNER ? -0.5 : design->datum == FG_DATUM_OUTER ? 0.5 : 0;
  return (fg_arch){radius_mm + shift * thickness_mm, angle_deg, thickness_mm};
}

double fg_design_pitch_mm(const fg_design *design) {
  return design->bumps.pitch_deg * rad_per_deg * design->bumps.sleeve_radius_mm;
}

static fg_status arch_stiffness(fg_context *ctx, const fg_arch *arch,
                                const fg_arch_material *material, double *n_mm2) {
  fg_arch_stiffness stiffness = {0};
  FG_TRY(fg_arch_free(ctx, arch, material, &stiffness));
  *n_mm2 = stiffness.stiffness_n_mm2;
  return FG_OK;
}

static void arch_reserve(const fg_arch *arch, const fg_arch_material *material, char *words,
                         size_t size) {
  fg_arch_stiffness stiffness;
  fg_context unused;
  if (fg_arch_free(&unused, arch, material, &stiffness) != FG_OK) return;
  if (stiffness.stuck) snprintf(words, size, "Friction holds the feet: a two-hinged arch.");
}

static fg_status heshmat_stiffness(fg_context *ctx, const fg_arch *arch,
                                   const fg_arch_material *material, double *n_mm2) {
  FG_TRY(fg_arch_check(ctx, arch, material));
  double half_chord_mm = arch->radius_mm * sin(fg_arch_half_angle(arch));
  *n_mm2 = 6 * fg_arch_bending(arch, material) / pow(half_chord_mm, 3);
  return FG_OK;
}

/* Writes the ratio of a simplified model to the arch under the same friction. */
static void put_against_arch(double stiffness_n_mm2, const fg_arch *arch,
                             const fg_arch_material *material, const char *what, char *words,
                             size_t size) {
  double exact;
  fg_context unused;
  if (arch_stiffness(&unused, arch, material, &exact) != FG_OK) return;
  double more = stiffness_n_mm2 / exact - 1;
  if (fabs(more) < matters_share) return;
  snprintf(words, size, "%s: %.3g %% %s than an arch of this angle%s.", what, 100 * fabs(more),
           more > 0 ? "stiffer" : "softer",
           material->friction > 0 ? " with this friction" : " without friction");
}

static void heshmat_reserve(const fg_arch *arch, const fg_arch_material *material, char *words,
                            size_t size) {
  double stiffness = 0;
  fg_context unused;
  if (heshmat_stiffness(&unused, arch, material, &stiffness) != FG_OK) return;
  put_against_arch(stiffness, arch, material,
                   "A straight beam as long as the chord, and no friction", words, size);
}

/* Flexibility of the arc under the horizontal force of a foot, over R³/D: the closed form, or for
 * flat arcs, where that is a difference of nearly equal numbers, its series. */
static double horizontal_flexibility(double phi) {
  static const double flat = 0.05;
  double square = phi * phi;
  if (phi < flat) return pow(phi, 5) * (2. / 15 - square * (8. / 315 - square * 2. / 945));
  return phi * (0.5 + pow(cos(phi), 2)) - 0.75 * sin(2 * phi);
}

static fg_status link_spring_stiffness(fg_context *ctx, const fg_arch *arch,
                                       const fg_arch_material *material, double *n_mm2) {
  FG_TRY(fg_arch_check(ctx, arch, material));
  double phi = fg_arch_half_angle(arch), rise = tan(phi / 2);
  double held = material->friction * rise;
  if (held >= 1)
    return fg_fail(ctx, FG_ERR_DATA,
                   "friction %g holds links that rise by a quarter of %g degrees; it must be below "
                   "%.3g",
                   material->friction, arch->bump_angle_deg, 1 / rise);
  double spring =
      fg_arch_bending(arch, material) / (pow(arch->radius_mm, 3) * horizontal_flexibility(phi));
  *n_mm2 = 2 * spring * rise * rise / (1 - held);
  return FG_OK;
}

static void link_spring_reserve(const fg_arch *arch, const fg_arch_material *material, char *words,
                                size_t size) {
  double stiffness = 0;
  fg_context why = {0};
  if (link_spring_stiffness(&why, arch, material, &stiffness) == FG_OK)
    put_against_arch(stiffness, arch, material,
                     "Links do not bend: only the feet's spring gives way", words, size);
  else
    snprintf(words, size, "%s", why.message);
}

static const fg_stiffness_model models[FG_STIFFNESS_MODELS] = {
    {"arch", "arch on sliding feet",
     "K = 2 / (f_VV + μ f_VH), f_ij = R³/D ∫ (m_i m_j + e n_i n_j) dψ over half the arc",
     "Castigliano's theorem, derived in include/foilgauge/bearing.h", arch_stiffness, arch_reserve},
    {"heshmat", "Heshmat, Walowit and Anno",
     "K = E t³ / (2 (1 − ν²) l0³), l0 = R sin(α/2); over the pitch s per area",
     "Walowit and Anno 1975; Heshmat, Walowit and Pinkus, J. Lubrication Technology 105 (1983)",
     heshmat_stiffness, heshmat_reserve},
    {"link_spring", "link-spring",
     "K = 2 k tan²(α/4) / (1 − μ tan(α/4)), k = D / (R³ (φ (1/2 + cos²φ) − 3/4 sin 2φ)), φ = α/2",
     "after the description in Feng and Kaneko, J. Tribology 132 (2010) 021706; closed form "
     "derived "
     "in include/foilgauge/stiffness.h",
     link_spring_stiffness, link_spring_reserve},
};

const fg_stiffness_model *fg_stiffness_models(void) {
  return models;
}

const char *fg_stiffness_absent_note(void) {
  return "Not a row: I. Iordanoff, J. Tribology 121 (1999) 816, closed forms for bumps with both "
         "ends free and with one welded. No text of them was at hand to hold a formula against, "
         "and none is written from memory. The arch solves both cases with friction.";
}

/* d ln K / d ln x by a central difference over exp(± step). */
static fg_status slope_of(fg_context *ctx, const fg_stiffness_model *model, const fg_arch *arch,
                          const fg_arch_material *material, const double power[3], double *slope) {
  static const double step = 1e-4;
  double logarithm[2];
  for (int side = 0; side < 2; side++) {
    double change = side ? step : -step, stiffness;
    fg_arch moved = {arch->radius_mm * exp(change * power[0]),
                     arch->bump_angle_deg * exp(change * power[1]),
                     arch->thickness_mm * exp(change * power[2])};
    FG_TRY(model->stiffness(ctx, &moved, material, &stiffness));
    logarithm[side] = log(stiffness);
  }
  *slope = (logarithm[1] - logarithm[0]) / (2 * step);
  return FG_OK;
}

fg_status fg_stiffness_sensitivities(fg_context *ctx, const fg_stiffness_model *model,
                                     const fg_arch *arch, const fg_arch_material *material,
                                     fg_arch_sensitivity *sensitivity) {
  static const double powers[][3] = {{1, 0, 0}, {0, 1, 0}, {1, -1, 0}, {0, 0, 1}};
  double *const slopes[] = {&sensitivity->radius, &sensitivity->angle,
                            &sensitivity->radius_at_arc_length, &sensitivity->thickness};
  for (size_t i = 0; i < sizeof slopes / sizeof *slopes; i++)
    FG_TRY(slope_of(ctx, model, arch, material, powers[i], slopes[i]));
  return FG_OK;
}

fg_status fg_arch_sensitivities(fg_context *ctx, const fg_arch *arch,
                                const fg_arch_material *material,
                                fg_arch_sensitivity *sensitivity) {
  return fg_stiffness_sensitivities(ctx, &models[0], arch, material, sensitivity);
}

/* Writes the influence that all models neglect; returns true when it matters. */
static bool is_stout(const fg_arch *arch, char *words, size_t size) {
  double ratio = 2 * fg_arch_half_angle(arch) * arch->radius_mm / arch->thickness_mm;
  if (ratio >= slender_ratio) return false;
  snprintf(
      words, size,
      "The arc is only %.2g times as long as thick: shear, which is left out, makes such a bump "
      "softer.",
      ratio);
  return true;
}

void fg_stiffness_compare(const fg_arch *arch, const fg_arch_material *material,
                          fg_stiffness_line lines[FG_STIFFNESS_MODELS]) {
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    fg_stiffness_line *line = &lines[i];
    fg_context why = {0};
    *line = (fg_stiffness_line){.stiffness_n_mm2 = NAN, .sensitivity = {NAN, NAN, NAN, NAN}};
    if (models[i].stiffness(&why, arch, material, &line->stiffness_n_mm2) != FG_OK) {
      line->stiffness_n_mm2 = NAN;
      snprintf(line->words, sizeof line->words, "%.*s", FG_STIFFNESS_WORDS - 1, why.message);
      continue;
    }
    if (!is_stout(arch, line->words, sizeof line->words))
      models[i].reserve(arch, material, line->words, sizeof line->words);
    if (fg_stiffness_sensitivities(&why, &models[i], arch, material, &line->sensitivity) != FG_OK)
      line->sensitivity = (fg_arch_sensitivity){NAN, NAN, NAN, NAN};
  }
}
