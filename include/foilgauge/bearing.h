/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness and clearance of a bearing from the shapes of its bumps.
 *
 * STIFFNESS. A bump is a thin arc of radius R (midline), bump angle alpha = 2 phi and thickness t,
 * of any width (plane strain; all values are per mm of width):
 *   D = E t³ / (12 (1 - nu²)),  EA = E t / (1 - nu²).
 * psi runs from the crown, x = R sin psi, y = R (cos psi - cos phi) above the feet. The crown
 * carries W. A foot gives V upwards and H inwards. Its land lies on the sleeve and turns freely.
 * Right of a cut at psi (both ways of bending counted; m = M / R, n the compression):
 *   V at the right foot   m = sin phi - sin psi       n = sin psi
 *   H at the right foot   m = -(cos psi - cos phi)    n = cos psi
 *   W at the crown        m = sin psi, n = -sin psi   for psi < 0, nothing for psi > 0
 * Castigliano: the displacement along load i is the derivative of the strain energy by it,
 *   u_i = sum over j of f_ij P_j,  f_ij = R³/D (∫ m_i m_j dpsi + e ∫ n_i n_j dpsi),
 *   e = D / (EA R²) = t² / (12 R²).
 * m and n are sums of 1, sin psi, cos psi. Shear is neglected: it is below three times e. Other
 * models of the same bump: foilgauge/stiffness.h.
 *
 * Free bump (both feet slide; W = 2 V, and half of the arc suffices): the crown sinks by
 *   delta = f_VV V + f_VH H,   a foot moves outwards by   -(f_VH V + f_HH H).
 * Coulomb: a foot that slides outwards feels H = mu V. It cannot slide when mu reaches
 * -f_VH / f_HH: then it sticks, with H = -f_VH V / f_HH, and the bump is a two-hinged arch.
 *   K = W / delta = 2 / (f_VV + f_VH H/V).
 * During unloading friction is reversed, H = -mu V: the difference is damping.
 *
 * Welded bump (left end clamped, right foot slides; Iordanoff 1999 has the same two kinds;
 * integrals over the whole arc): the right foot stays on the sleeve,
 *   0 = f_VV V + f_VH H + f_VW W,   H = mu V,   or with the foot stuck also
 *   0 = f_VH V + f_HH H + f_HW W,
 * and delta = f_WV V + f_WH H + f_WW W. The top foil follows the crown sideways.
 *
 * The arch is that of a classical bump. A sinusoidal foil's long fillets bend as well, which the
 * model neglects: results for such a foil carry that reservation.
 *
 * For small phi bending scales with (R phi)³: at constant arc length the vertical stiffness
 * hardly changes with springback, while f_HH ~ R³ phi⁵ makes the feet's sideways stiffness grow
 * with R².
 *
 * CLEARANCE. The local clearances (thesis eq 5.8) at the bumps around the bearing: `pads` foils
 * equally spaced, `bumps_per_pad` of each at the pitch of its bumps (Gen II: 3 × 9, 13 1/3
 * degrees; thesis figures 5.13 and 6.3: 3 × 7, 17.14 degrees). A rotor shifted by (a, b) changes
 * them by -(a cos + b sin), to first order (an error below shift² / D).
 *
 * UNCERTAINTY. Every result r of a bearing is a sum of clearances, sum of g_i c_i, as long as the
 * same places stay lowest, highest or touched. The uncertainty common to all places (of the strip's
 * thickness, by the scanner's tone curve, the same in every scan) adds (sum g_i s_i)²: its full
 * size to a clearance, 0 to a circularity. The remainder of a clearance's u is partly the bump's
 * own and partly that of its foil's overall circle. The shares are unknown, so the larger of two
 * sums is used: independent places, sum (g_i u_i)², and one error for all places of a pad, sum over
 * pads of (sum g_i u_i)².
 */
#ifndef FOILGAUGE_BEARING_H
#define FOILGAUGE_BEARING_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_arch_material {
  double youngs_modulus_gpa;
  double poisson_ratio;
  double friction; /* Coulomb, foot on sleeve */
} fg_arch_material;

typedef struct fg_arch {
  double radius_mm; /* midline */
  double bump_angle_deg;
  double thickness_mm;
} fg_arch;

typedef struct fg_arch_stiffness {
  double stiffness_n_mm2; /* of the crown, N per mm and mm of width, during loading */
  double unloading_n_mm2; /* at the start of unloading, feet sliding inward; NaN where stuck */
  double foot_n_mm2;      /* of a foot sideways: 1 / f_HH */
  double foot_share;      /* V / W of the sliding foot: 1/2 for a free bump */
  bool stuck;             /* friction holds the foot */
} fg_arch_stiffness;

/* FG_ERR_DATA for impossible values (angle outside 0 to 180 degrees, thickness above R). */
fg_status fg_arch_free(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                       fg_arch_stiffness *stiffness);
fg_status fg_arch_welded(fg_context *ctx, const fg_arch *arch, const fg_arch_material *material,
                         fg_arch_stiffness *stiffness);

/* Percent of stiffness (free bump) per percent of: radius alone, angle alone, radius at constant
 * arc length, thickness. */
typedef struct fg_arch_sensitivity {
  double radius, angle, radius_at_arc_length, thickness;
} fg_arch_sensitivity;
fg_status fg_arch_sensitivities(fg_context *ctx, const fg_arch *arch,
                                const fg_arch_material *material, fg_arch_sensitivity *sensitivity);

typedef struct fg_bearing_layout {
  size_t pads;          /* foils in a bearing */
  size_t bumps_per_pad; /* of each foil, from first_bump on */
  size_t first_bump;    /* bump 1 is next to the lip */
  double pitch_deg;     /* distance of bumps of a pad; 0: all bumps equally spaced around */
} fg_bearing_layout;

enum { FG_BEARING_BUMPS_MAX = 96 };

/* Distance of bumps of a pad. */
double fg_bearing_pitch_deg(const fg_bearing_layout *layout);

/* Returns the direction of a place of the bearing, degrees: pad and bump count from 0. */
double fg_bearing_angle_deg(const fg_bearing_layout *layout, size_t pad, size_t bump);

typedef struct fg_bearing_clearance {
  size_t count; /* number of known places */
  double mean_mm, min_mm, max_mm;
  double min_at_deg;
  double offset_mm[2];     /* centre of the least-squares circle through the crowns, about O */
  double circularity_mm;   /* peak to valley about that circle */
  double centred_min_mm;   /* largest possible minimum clearance, over positions of the rotor; NaN
                              when the crowns leave half of the bearing open */
  double centred_at_mm[2]; /* axis of the rotor there */
  /* Standard uncertainties; NaN where none was given. */
  double u_mean_mm, u_min_mm, u_max_mm, u_circularity_mm, u_centred_min_mm;
} fg_bearing_clearance;

/* Standard uncertainty of every clearance: the part common to all, and the remainder. */
typedef struct fg_bearing_uncertainty {
  const double *shared_mm, *own_mm; /* of each place; finite where the clearance is */
  const size_t *pad;                /* index of its pad, below FG_BEARING_BUMPS_MAX */
} fg_bearing_uncertainty;

/* Assesses `clearance_mm` at directions `angle_deg`; NaN marks an unknown place. FG_ERR_DATA for
 * fewer than three known places or more than FG_BEARING_BUMPS_MAX. */
fg_status fg_bearing_assess(fg_context *ctx, const double *angle_deg, const double *clearance_mm,
                            size_t count, fg_bearing_clearance *result);

/* As fg_bearing_assess, with the uncertainties of the results; `uncertainty` NULL: none. */
fg_status fg_bearing_assess_uncertainty(fg_context *ctx, const double *angle_deg,
                                        const double *clearance_mm, size_t count,
                                        const fg_bearing_uncertainty *uncertainty,
                                        fg_bearing_clearance *result);

#ifdef __cplusplus
}
#endif
#endif
