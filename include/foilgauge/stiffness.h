/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a bump by the common models, side by side, and its sensitivities.
 *
 * Everything is per bump and per mm of width, in N/mm²; over the pitch s of the bumps (mm along the
 * bearing) it is the stiffness per area of a bump foil, N/mm³. A bump is a thin arc of radius R,
 * bump angle alpha = 2 phi and thickness t; D = E t³ / (12 (1 - nu²)).
 *
 * ARCH. foilgauge/bearing.h: bending and compression of the arc, feet that slide with friction.
 *
 * HESHMAT. J. A. Walowit, J. N. Anno, Modern Developments in Lubrication Mechanics (1975), chapter
 * 7, and H. Heshmat, J. A. Walowit, O. Pinkus (ASME J. Lubrication Technology 105, 1983, 647-655)
 * give the compliance of a bump foil of pitch s and half bump length l0 as
 *   2 s / E (l0 / t)³ (1 - nu²)   of the deflection over the pressure,
 * so per area K = E t³ / (2 (1 - nu²) s l0³), and per bump and width
 *   K = E t³ / (2 (1 - nu²) l0³) = 48 D / (2 l0)³,   l0 = R sin(alpha / 2)   (thesis eq 5.2):
 * a straight beam on two supports a chord apart, loaded in its middle. No height, no friction.
 *
 * LINK-SPRING. K. Feng, S. Kaneko (ASME J. Tribology 132, 2010, 021706) model a bump as two rigid
 * links from the crown to the feet and a horizontal spring between the feet, whose stiffness
 * follows from Castigliano's theorem. That much is in their summary; the closed form is derived
 * here, and may differ from theirs in the load that defines the spring. Here that load is the
 * feet's horizontal force: from a foot to the middle k = 1 / f_HH,   f_HH = R³/D ∫ (cos psi - cos
 * phi)² dpsi from 0 to phi (bending only) = R³/D (phi (1/2 + cos² phi) - 3/4 sin 2 phi). A link
 * rises by beta with tan beta = (1 - cos phi) / sin phi = tan(phi / 2), so beta = alpha / 4. The
 * crown's W = 2 V presses the feet apart by V cot beta, reduced by friction mu V; a foot moves by u
 * = V (cot beta - mu) / k, and the crown sinks by u cot beta: K = W / delta = 2 k tan²beta / (1 -
 * mu tan beta). For mu >= cot(alpha / 4) friction holds the links and the model has no stiffness.
 *
 * IORDANOFF. I. Iordanoff (ASME J. Tribology 121, 1999, 816-822) gives closed forms with friction
 * for a bump whose ends are both free and for one with a welded end. They have no row: no text of
 * theirs was available to check a formula against. (The analytic formulas in use for these two
 * cases are reported to differ from numerics: M. Arghir, About the stiffness of bumps in
 * aerodynamic foil bearings, STLE annual meeting 2015.) Both cases are solved by fg_arch_free and
 * fg_arch_welded of foilgauge/bearing.h, as curved beams with friction at their feet.
 *
 * SLENDER BENDING. In each of them, and in every model of a slender arc that bends, R enters by
 * K = D / R³ g(alpha) alone: strain energy is M²/2D over R dpsi, and M is R times a force times a
 * function of angles. For small alpha g goes with alpha⁻³: 6 / phi³ for arch (no friction) and
 * Heshmat, 15 / 4 / phi³ for the links. So where the arc length R alpha stays, K hardly changes. */
#ifndef FOILGAUGE_STIFFNESS_H
#define FOILGAUGE_STIFFNESS_H

#include "foilgauge/bearing.h"
#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Steel, with the friction of steel on steel that runs in: E 200 GPa, nu 0.3, mu 0.1. */
fg_arch_material fg_arch_material_default(void);

/* Makes the arch of a bump: radii of design and measurement are those of the datum line, an arch
 * bends about its midline. */
fg_arch fg_design_arch(const fg_design *design, double thickness_mm, double radius_mm,
                       double angle_deg);

/* s: distance of bumps along the sleeve. */
double fg_design_pitch_mm(const fg_design *design);

/* Returns the reservation about bumps of this foil kind; NULL: none. */
const char *fg_stiffness_kind_note(fg_foil_kind kind);

typedef struct fg_stiffness_model {
  const char *id;      /* in JSON */
  const char *title;   /* for people */
  const char *formula; /* in plain text */
  const char *source;
  /* N per mm and mm of width. FG_ERR_DATA where the model has no stiffness. */
  fg_status (*stiffness)(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                         double *n_mm2);
  /* Writes the neglected influence that matters for this bump; "" when it is small. */
  void (*reserve)(const fg_arch *arch, const fg_arch_material *material, char *words, size_t size);
} fg_stiffness_model;

enum { FG_STIFFNESS_MODELS = 3, FG_STIFFNESS_WORDS = 240 };

/* Reason that a model named in the field has no row. */
const char *fg_stiffness_absent_note(void);

/* The arch comes first. */
const fg_stiffness_model *fg_stiffness_models(void);

/* Percent of a model's stiffness per percent of the parameters in fg_arch_sensitivity. */
fg_status fg_stiffness_sensitivities(fg_context *ctx, const fg_stiffness_model *model,
                                     const fg_arch *arch, const fg_arch_material *material,
                                     fg_arch_sensitivity *sensitivity);

/* Result of one model for a bump; where it has none, the numbers are NaN and the words have the
 * reason. */
typedef struct fg_stiffness_line {
  double stiffness_n_mm2;
  fg_arch_sensitivity sensitivity;
  char words[FG_STIFFNESS_WORDS]; /* its reserve */
} fg_stiffness_line;

/* Computes every model's result, in their order. */
void fg_stiffness_compare(const fg_arch *arch, const fg_arch_material *material,
                          fg_stiffness_line lines[FG_STIFFNESS_MODELS]);

#ifdef __cplusplus
}
#endif
#endif
